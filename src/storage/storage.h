/* Floor 1: files. HDF5 files whose data sets are rows spread over the ranks, with attributes; a checksum for files that
   must not be trusted when damaged; folders and names. */
#ifndef ISPH_STORAGE_H
#define ISPH_STORAGE_H

#include "../base/base.h"
#include <hdf5.h>

/* --- storage.c: HDF5 files. What goes wrong is collected in 'failed' and agreed upon when the file is closed. --- */

/* An HDF5 file that is open. Rank 0 writes it for all ranks; every rank reads it. */
typedef struct {
  MPI_Comm    comm;
  PetscMPIInt rank, size;
  PetscBool   owns_file;                /* this rank touches the file: all ranks when reading, rank 0 when writing */
  char        path[PETSC_MAX_PATH_LEN]; /* where the file goes when it is closed; empty when reading */
  hid_t       id;                       /* HDF5's; negative: could not be made or opened, or another rank's */
  hsize_t     length;                   /* bytes of the file when it was opened for reading */
  PetscInt    compression;              /* of data sets written from now on, HDF5's deflate level; 0: none */
  PetscBool   failed;                   /* on this rank */
  PetscBool   strays;                   /* a data set to be read lies elsewhere; the same on every rank */
  H5E_auto2_t handler;                  /* HDF5's error printer, put back when the file is closed */
  void       *client;
} H5File;

/* How the rows of a data set lie on the ranks: n on this one, from row start of total; width numbers each. */
typedef struct {
  PetscInt n, start, total, width;
} Rows;

/* RowsSet - n rows on this rank, behind those of lower ranks. Collective. */
PetscErrorCode RowsSet(MPI_Comm comm, PetscInt n, PetscInt width, Rows *rows);

/* HDF5's name of PetscInt in memory. */
#define H5FILE_INT (sizeof(PetscInt) == sizeof(int) ? H5T_NATIVE_INT : H5T_NATIVE_LLONG)

/* H5FileCreate - a new file for writing. H5FileOpen - an existing one for reading. Collective on comm. */
PetscErrorCode H5FileCreate(MPI_Comm comm, const char path[], H5File *h5);
PetscErrorCode H5FileOpen(MPI_Comm comm, const char path[], H5File *h5);
/* H5FileClose - *failed: whether anything went wrong on any rank since the file was opened. Collective. */
PetscErrorCode H5FileClose(H5File *h5, PetscBool *failed);
/* H5FileWrite - a data set of rows with its unit and meaning; type: H5T_NATIVE_DOUBLE, H5T_NATIVE_FLOAT or H5FILE_INT;
   values [n][width]. Collective. */
PetscErrorCode H5FileWrite(H5File *h5, const char name[], hid_t type, const Rows *rows, const void *values,
                           const char unit[], const char meaning[]);
/* H5FileRead - this rank's rows of a data set into values [n][width]; a data set of another shape is a failure, and so
   is one that leads out of the file: links, external storage and virtual data sets are not followed. Collective. */
PetscErrorCode H5FileRead(H5File *h5, const char name[], hid_t type, const Rows *rows, void *values);
/* H5FileHolds - whether the file is long enough for so many rows of so many bytes: to be asked before room is made for
   them. Not collective, same answer on all ranks. */
PetscBool H5FileHolds(H5File *h5, PetscInt64 rows, size_t bytes);
/* H5FileNote - what HDF5 said of something done to the file: negative is a failure. Not collective. */
void H5FileNote(H5File *h5, hid_t status);
/* H5FileHas - whether there is a data set of this name. Not collective. */
PetscBool H5FileHas(H5File *h5, const char name[]);
/* H5FilePut... - an attribute of the file; the values of rank 0 count. Not collective. */
void H5FilePutReal(H5File *h5, const char name[], PetscInt n, const PetscReal values[]);
void H5FilePutInt(H5File *h5, const char name[], PetscInt64 value);
void H5FilePutText(H5File *h5, const char name[], const char text[]);
/* H5FilePutAttribute - n values of a type in memory as an attribute of an object of the file. Rank 0. */
void H5FilePutAttribute(H5File *h5, hid_t object, const char name[], hid_t file_type, hid_t type, hsize_t n,
                        const void *values);
/* H5FileGet... - whether there is such an attribute of this kind; if not, the value stays as it is (a text, of at most
   size - 1 bytes, becomes empty). Not collective. */
PetscBool H5FileGetReal(H5File *h5, const char name[], PetscReal *value);
PetscBool H5FileGetInt(H5File *h5, const char name[], PetscInt64 *value);
PetscBool H5FileGetText(H5File *h5, const char name[], char text[], size_t size);

/* --- checksum.c: HDF5 1.10 does not notice all damage, so a finished file is sealed --- */

typedef enum { SEAL_NONE, SEAL_WRONG, SEAL_GOOD } Seal;
/* FileSeal - appends a checksum of the whole file, which HDF5 ignores; *failed: it could not be written. Collective on
   comm, whose ranks each read a share of the file. */
PetscErrorCode FileSeal(MPI_Comm comm, const char path[], PetscBool *failed);
/* FileCheckSeal - whether a checksum is there and right; SEAL_NONE also when the file cannot be read. Collective on
   comm, whose ranks each read a share of the file. */
PetscErrorCode FileCheckSeal(MPI_Comm comm, const char path[], Seal *found);

/* --- files.c: each returns an errno, 0 when all is well. Not collective. --- */

/* FolderCreate - makes the folder and those above it, as mkdir -p. */
int FolderCreate(const char folder[]);
/* FileSync - waits until a file or a folder has reached the disk. */
int FileSync(const char path[]);

#endif
