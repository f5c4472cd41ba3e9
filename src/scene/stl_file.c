/* Reads STL files, binary or text, and checks that their surface is closed. */
#include "stl.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define HEADER_BYTES   80
#define TRIANGLE_BYTES 50   /* of a binary file: normal, three corners, two bytes */
#define WELD           1e-6 /* of the size of the surface: corners closer than this in each coordinate are one */

/* The whole file; NULL if it cannot be read. */
static char *ReadAll(const char path[], long *size)
{
  struct stat info;
  FILE       *file;
  char       *text = NULL;

  *size = -1;
  if (stat(path, &info) || !S_ISREG(info.st_mode)) return NULL; /* a pipe may never be written to */
  file = fopen(path, "rb");
  if (!file) return NULL;
  if (!fseek(file, 0, SEEK_END) && (*size = ftell(file)) >= 0 && !fseek(file, 0, SEEK_SET)) {
    text = (char *)malloc((size_t)*size + 1);
    if (text && fread(text, 1, (size_t)*size, file) != (size_t)*size) {
      free(text);
      text = NULL;
    }
    if (text) text[*size] = 0;
  }
  (void)fclose(file);
  return text;
}

/* Corners of a binary file, 12 floats of 50 bytes each; little-endian as the format demands and the machine is. */
static PetscErrorCode ParseBinary(const char *bytes, PetscInt n, PetscReal corner[])
{
  PetscFunctionBegin;
  for (PetscInt t = 0; t < n; t++) {
    float number[12];

    memcpy(number, bytes + HEADER_BYTES + 4 + TRIANGLE_BYTES * t, sizeof(number));
    for (PetscInt k = 0; k < 9; k++) corner[9 * t + k] = (PetscReal)number[3 + k];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Corners of a text file: the three numbers after each word "vertex". Returns how many corners there are, or minus the
   number of the corner that is broken, from 1 on. corner may be NULL. */
static PetscInt ParseText(const char *text, PetscReal corner[])
{
  PetscInt n = 0;

  for (const char *at = strstr(text, "vertex"); at; at = strstr(at, "vertex")) {
    at += strlen("vertex");
    for (PetscInt k = 0; k < DIM; k++) {
      char           *end;
      const PetscReal number = (PetscReal)strtod(at, &end);

      if (end == at) return -(n + 1);
      if (corner) corner[DIM * n + k] = number;
      at = end;
    }
    n++;
  }
  return n;
}

PetscErrorCode StlRead(MPI_Comm comm, const char path[], PetscInt *n, PetscReal **corner)
{
  long      size;
  char     *text     = ReadAll(path, &size);
  unsigned  count    = 0;
  PetscBool binary   = PETSC_FALSE;
  PetscInt  vertices = 0;

  PetscFunctionBegin;
  PetscCheckUser(text, comm, "the STL file %s cannot be read", path);
  if (size >= HEADER_BYTES + 4) {
    memcpy(&count, text + HEADER_BYTES, sizeof(count));
    binary = (PetscBool)(size == HEADER_BYTES + 4 + (long)TRIANGLE_BYTES * (long)count);
  }
  if (!binary) vertices = strncmp(text, "solid", 5) ? 0 : ParseText(text, NULL);
  if (!binary && (vertices <= 0 || vertices % 3)) {
    free(text);
    PetscCheckUser(vertices >= 0, comm, "the STL file %s is broken at its vertex number %" PetscInt_FMT, path,
                   -vertices);
    PetscCheckUser(vertices == 0, comm,
                   "the STL file %s has %" PetscInt_FMT " vertices, which is no whole number of triangles", path,
                   vertices);
    PetscCheckUser(PETSC_FALSE, comm,
                   "%s is no STL file: neither text with 'solid' and 'vertex' nor binary of the length it says", path);
  }
  *n = binary ? (PetscInt)count : vertices / 3;
  PetscCall(PetscMalloc1(9 * *n + 1, corner));
  if (binary)
    PetscCall(ParseBinary(text, *n, *corner));
  else
    (void)ParseText(text, *corner);
  free(text);
  PetscCheckUser(*n > 0, comm, "the STL file %s has no triangle", path);
  for (PetscInt k = 0; k < 9 * *n; k++)
    PetscCheckUser(!PetscIsInfOrNanReal((*corner)[k]), comm,
                   "the STL file %s has a number that is not finite in triangle "
                   "%" PetscInt_FMT,
                   path, k / 9 + 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An edge between two corners, given as whole numbers of the welding length; low before high. */
typedef struct {
  long long end[2 * DIM];
} Edge;

static int CompareCorners(const long long a[], const long long b[])
{
  for (PetscInt d = 0; d < DIM; d++)
    if (a[d] != b[d]) return a[d] < b[d] ? -1 : 1;
  return 0;
}

static int CompareEdges(const void *a, const void *b)
{
  const long long *x = ((const Edge *)a)->end, *y = ((const Edge *)b)->end;
  const int        first = CompareCorners(x, y);

  return first ? first : CompareCorners(x + DIM, y + DIM);
}

PetscErrorCode StlCheckClosed(MPI_Comm comm, const char path[], PetscInt n, const PetscReal corner[],
                              const PetscReal lower[DIM], const PetscReal upper[DIM])
{
  const PetscReal weld = WELD * PetscMax(upper[0] - lower[0], PetscMax(upper[1] - lower[1], upper[2] - lower[2]));
  Edge           *edge;
  PetscInt        edges = 0, open = 0;

  PetscFunctionBegin;
  PetscCheckUser(weld > 0, comm, "the surface in the STL file %s is a single point", path);
  PetscCall(PetscMalloc1(3 * n, &edge));
  for (PetscInt t = 0; t < n; t++) {
    long long place[3][DIM];

    for (PetscInt c = 0; c < 3; c++)
      for (PetscInt d = 0; d < DIM; d++)
        place[c][d] = (long long)PetscFloorReal((corner[9 * t + DIM * c + d] - lower[d]) / weld + 0.5);
    for (PetscInt c = 0; c < 3; c++) {
      const long long *p = place[c], *q = place[(c + 1) % 3];
      const int        order = CompareCorners(p, q);

      if (order == 0) continue; /* a triangle of no area */
      memcpy(edge[edges].end, order < 0 ? p : q, sizeof(place[0]));
      memcpy(edge[edges++].end + DIM, order < 0 ? q : p, sizeof(place[0]));
    }
  }
  qsort(edge, (size_t)edges, sizeof(*edge), CompareEdges);
  for (PetscInt k = 0; k < edges;) {
    PetscInt same = 1;

    while (k + same < edges && !CompareEdges(&edge[k], &edge[k + same])) same++;
    open += same % 2;
    k += same;
  }
  PetscCall(PetscFree(edge));
  PetscCheckUser(open == 0, comm,
                 "the surface in the STL file %s is not closed: %" PetscInt_FMT " edges belong to an odd number of "
                 "triangles; repair it, so that inside and outside differ",
                 path, open);
  PetscFunctionReturn(PETSC_SUCCESS);
}
