/* Snapshots as ParaView and VTK read them: one XDMF file for all, and a group VTKHDF in each. */
#include "output_impl.h"
#include <errno.h>

#define XDMF_FILE  "snapshots.xdmf"
#define VTK_GROUP  "VTKHDF"       /* in a snapshot */
#define VTK_POINTS "Connectivity" /* in the group: 0, 1, 2, ...; XDMF's topology too */

/* --- XDMF --- */

static void XdmfItem(FILE *file, const SnapshotEntry *entry, const char name[], PetscInt width, const char number[],
                     PetscInt precision)
{
  char source[64];

  SnapshotName(entry->index, source);
  fprintf(file,
          "        <DataItem Dimensions=\"%d%s\" NumberType=\"%s\" Precision=\"%d\" Format=\"HDF\">%s:/%s</DataItem>\n",
          (int)entry->n,
          width > DIM ? " 6"
          : width > 1 ? " 3"
                      : "",
          number, (int)precision, source, name);
}

static void XdmfAttribute(FILE *file, const SnapshotEntry *entry, const char name[], PetscInt width,
                          const char number[], PetscInt precision)
{
  fprintf(file, "      <Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"Node\">\n", name,
          width > DIM ? "Matrix"
          : width > 1 ? "Vector"
                      : "Scalar");
  XdmfItem(file, entry, name, width, number, precision);
  fprintf(file, "      </Attribute>\n");
}

static void XdmfSnapshot(FILE *file, const SnapshotEntry *entry)
{
  fprintf(file, "    <Grid Name=\"step %d\" GridType=\"Uniform\">\n", (int)entry->step);
  fprintf(file, "      <Time Value=\"%.12g\"/>\n", (double)entry->time);
  /* without the connectivity ParaView 5.11 makes points without cells, which it does not draw */
  fprintf(file, "      <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"%d\" NodesPerElement=\"1\">\n",
          (int)entry->n);
  XdmfItem(file, entry, VTK_GROUP "/" VTK_POINTS, 1, "Int", sizeof(PetscInt64));
  fprintf(file, "      </Topology>\n");
  fprintf(file, "      <Geometry GeometryType=\"XYZ\">\n");
  XdmfItem(file, entry, Fields[FIELD_POSITION].name, 3, "Float", entry->precision);
  fprintf(file, "      </Geometry>\n");
  for (PetscInt f = 0; f < SNAPSHOT_FIELDS; f++) {
    const SnapshotField field = SnapshotFieldAt(f);
    const PetscBool     whole = (PetscBool)(field.integer >= 0);

    if (f != FIELD_POSITION && entry->fields & 1U << f)
      XdmfAttribute(file, entry, field.column.name, field.width, whole ? "Int" : "Float",
                    whole ? (PetscInt)sizeof(PetscInt) : entry->precision);
  }
  fprintf(file, "    </Grid>\n");
}

PetscErrorCode XdmfWrite(Output output)
{
  char  path[PETSC_MAX_PATH_LEN];
  FILE *file;
  int   error = 0;

  PetscFunctionBegin;
  PetscCall(OutputPath(output, XDMF_FILE ".tmp", path));
  if (!output->rank) {
    file = fopen(path, "w");
    if (!file)
      error = errno;
    else {
      fprintf(file, "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n  <Grid Name=\"snapshots\" "
                    "GridType=\"Collection\" CollectionType=\"Temporal\">\n");
      for (PetscInt e = 0; e < output->entries; e++) XdmfSnapshot(file, &output->entry[e]);
      fprintf(file, "  </Grid>\n</Domain>\n</Xdmf>\n");
      if (fflush(file) || ferror(file)) error = errno ? errno : EIO;
      if (fclose(file) && !error) error = errno;
    }
  }
  PetscCall(FolderStatus(output, error, "write", path));
  PetscCall(FolderCommit(output, XDMF_FILE, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- VTKHDF (VTK's file format of that name, version 1.0, type UnstructuredGrid) --- */

#define VTK_POLY_VERTEX 2 /* vtkCellType.h: one cell of all points */

/* A data set of n integers. Rank 0. */
static void Integers(H5File *h5, hid_t group, const char name[], hid_t type, PetscInt n, const PetscInt64 values[])
{
  const hsize_t size  = (hsize_t)n;
  const hid_t   space = H5Screate_simple(1, &size, NULL),
              set     = H5Dcreate2(group, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);

  H5FileNote(h5, set < 0 ? set : H5Dwrite(set, H5T_NATIVE_LLONG, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
  if (set >= 0) (void)H5Dclose(set);
  (void)H5Sclose(space);
}

/* Makes 'group', VTKHDF, an unstructured grid of one cell with all n points. Rank 0. */
static void VtkCell(H5File *h5, hid_t group, PetscInt n)
{
  const PetscInt64 points = n, cells = n > 0, offsets[2] = {0, n}, version[2] = {1, 0}, type = VTK_POLY_VERTEX;
  const char       grid[] = "UnstructuredGrid";
  const hid_t      text   = H5Tcopy(H5T_C_S1);

  H5FileNote(h5, H5Tset_size(text, sizeof(grid) - 1));
  H5FileNote(h5, H5Tset_strpad(text, H5T_STR_NULLPAD));
  H5FilePutAttribute(h5, group, "Version", H5T_STD_I64LE, H5T_NATIVE_LLONG, 2, version);
  H5FilePutAttribute(h5, group, "Type", text, text, 1, grid);
  (void)H5Tclose(text);
  Integers(h5, group, "NumberOfPoints", H5T_STD_I64LE, 1, &points);
  Integers(h5, group, "NumberOfCells", H5T_STD_I64LE, 1, &cells);
  Integers(h5, group, "NumberOfConnectivityIds", H5T_STD_I64LE, 1, &points);
  Integers(h5, group, "Offsets", H5T_STD_I64LE, (PetscInt)cells + 1, offsets);
  Integers(h5, group, "Types", H5T_STD_U8LE, (PetscInt)cells, &type);
}

/* The group of the fields' links. Rank 0. */
static void VtkGroup(H5File *h5, const SnapshotEntry *entry)
{
  const hid_t group = H5Gcreate2(h5->id, VTK_GROUP, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
              point = group < 0 ? group : H5Gcreate2(group, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);

  H5FileNote(h5, point);
  if (!h5->failed) VtkCell(h5, group, entry->n);
  for (PetscInt f = 0; f < SNAPSHOT_FIELDS && !h5->failed; f++) {
    const char *name = SnapshotFieldAt(f).column.name;

    if (f == FIELD_POSITION)
      H5FileNote(h5, H5Lcreate_hard(h5->id, name, group, "Points", H5P_DEFAULT, H5P_DEFAULT));
    else if (entry->fields & 1U << f)
      H5FileNote(h5, H5Lcreate_hard(h5->id, name, point, name, H5P_DEFAULT, H5P_DEFAULT));
  }
  if (point >= 0) (void)H5Gclose(point);
  if (group >= 0) (void)H5Gclose(group);
}

PetscErrorCode VtkWrite(H5File *h5, const SnapshotEntry *entry, Rows *rows)
{
  PetscInt64 *index;

  PetscFunctionBegin;
  if (h5->owns_file && h5->id >= 0 && !h5->failed) VtkGroup(h5, entry);
  PetscCall(PetscMalloc1(rows->n, &index));
  for (PetscInt k = 0; k < rows->n; k++) index[k] = rows->start + k;
  rows->width     = 1;
  h5->compression = PetscMax(1, h5->compression);
  PetscCall(H5FileWrite(h5, VTK_GROUP "/" VTK_POINTS, H5T_NATIVE_LLONG, rows, index, "1", "the particles of the cell"));
  PetscCall(PetscFree(index));
  PetscFunctionReturn(PETSC_SUCCESS);
}
