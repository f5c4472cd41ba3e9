/* Floor 1: files. HDF5 files with attributes and with data sets whose rows are distributed over the ranks; a checksum
   that detects damaged files; folders. */
#ifndef ISPH_STORAGE_H
#define ISPH_STORAGE_H

#include "../base/base.h"
#include <hdf5.h>

/* --- storage.c: HDF5 files. Each rank records a failure in 'failed'; H5FileClose combines the ranks. --- */

/* An open HDF5 file. Rank 0 keeps the structure of a file that is written; every rank compresses its own rows, writes
   them where they are not compressed, and reads. */
typedef struct {
  MPI_Comm    comm;
  PetscMPIInt rank, size;
  PetscBool   owns_file;   /* HDF5 has the file open on this rank: on all to read, on rank 0 to write */
  hid_t       id;          /* HDF5's; negative: not open on this rank */
  int         file;        /* of this rank, to write rows; negative: open for reading */
  hsize_t     reserved;    /* bytes of the disk, on rank 0 */
  hsize_t     length;      /* bytes of a file that is open for reading */
  PetscInt    compression; /* HDF5's deflate level of the next data sets; 0: none */
  PetscBool   failed;      /* on this rank */
  PetscBool   external;    /* a data set that was read lies outside the file; the same on every rank */
  H5E_auto2_t handler;     /* HDF5's error printer, restored by H5FileClose */
  void       *client;
} H5File;

/* The distribution of a data set: this rank has n of 'total' rows, from row 'start' on; a row has 'width' numbers. */
typedef struct {
  PetscInt n, start, total, width;
} Rows;

/* RowsSet - n rows on this rank, after the rows of lower ranks. Collective. */
PetscErrorCode RowsSet(MPI_Comm comm, PetscInt n, PetscInt width, Rows *rows);

/* The HDF5 type of PetscInt. */
#define H5FILE_INT (sizeof(PetscInt) == sizeof(int) ? H5T_NATIVE_INT : H5T_NATIVE_LLONG)

/* H5FileCreate - creates a file for writing. H5FileOpen - opens a file for reading. Collective on comm. */
PetscErrorCode H5FileCreate(MPI_Comm comm, const char path[], H5File *h5);
PetscErrorCode H5FileOpen(MPI_Comm comm, const char path[], H5File *h5);
/* H5FileClose - *failed: whether any operation failed on any rank since the file was opened. Collective. */
PetscErrorCode H5FileClose(H5File *h5, PetscBool *failed);
/* H5FileWrite - writes a data set with its unit and meaning. type: H5T_NATIVE_DOUBLE, H5T_NATIVE_FLOAT or H5FILE_INT;
   values: [n][width]. Collective. */
PetscErrorCode H5FileWrite(H5File *h5, const char name[], hid_t type, const Rows *rows, const void *values,
                           const char unit[], const char meaning[]);
/* H5FileRead - reads this rank's rows of a data set into values [n][width]. A data set of another shape is a failure. A
   link, external storage and a virtual data set are failures, too, since they lead out of the file. Collective. */
PetscErrorCode H5FileRead(H5File *h5, const char name[], hid_t type, const Rows *rows, void *values);
/* H5FileHolds - whether the file is long enough for 'rows' rows of 'bytes' bytes; call it before memory is allocated
   for them. The same answer on all ranks. Not collective. */
PetscBool H5FileHolds(H5File *h5, PetscInt64 rows, size_t bytes);
/* H5FileNote - records a failure if the status that HDF5 returned is negative. Not collective. */
void H5FileNote(H5File *h5, hid_t status);
/* H5FileHas - whether there is a data set of this name. Not collective. */
PetscBool H5FileHas(H5File *h5, const char name[]);
/* H5FilePut... - writes an attribute of the file with the values of rank 0. Not collective. */
void H5FilePutReal(H5File *h5, const char name[], PetscInt n, const PetscReal values[]);
void H5FilePutInt(H5File *h5, const char name[], PetscInt64 value);
void H5FilePutText(H5File *h5, const char name[], const char text[]);
/* H5FilePutAttribute - rank 0 writes n values of 'type' as an attribute of an object in the file. Not collective. */
void H5FilePutAttribute(H5File *h5, hid_t object, const char name[], hid_t file_type, hid_t type, hsize_t n,
                        const void *values);
/* H5FileGet... - reads an attribute of the file; false if there is none of this name and type. Then a number keeps its
   value and a text becomes empty. A text has at most size - 1 bytes. Not collective. */
PetscBool H5FileGetReal(H5File *h5, const char name[], PetscReal *value);
PetscBool H5FileGetInt(H5File *h5, const char name[], PetscInt64 *value);
PetscBool H5FileGetText(H5File *h5, const char name[], char text[], size_t size);

/* --- checksum.c: HDF5 1.10 does not detect all damage, so a finished file gets a checksum, its seal --- */

typedef enum { SEAL_NONE, SEAL_WRONG, SEAL_GOOD } Seal;
/* FileSeal - appends a checksum of the whole file, which HDF5 ignores. *failed: the checksum could not be written. Each
   rank of comm reads a share of the file. Collective. */
PetscErrorCode FileSeal(MPI_Comm comm, const char path[], PetscBool *failed);
/* FileCheckSeal - compares the file with its checksum; SEAL_NONE if there is no checksum or no readable file. Each rank
   of comm reads a share of the file. Collective. */
PetscErrorCode FileCheckSeal(MPI_Comm comm, const char path[], Seal *found);

/* --- files.c: each function returns 0 or an errno. Not collective. --- */

/* FolderCreate - creates the folder and its parents, as mkdir -p does. */
int FolderCreate(const char folder[]);
/* FileSync - waits until a file or a folder has reached the disk. */
int FileSync(const char path[]);

#endif
