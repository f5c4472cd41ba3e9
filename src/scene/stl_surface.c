/* Makes a closed surface of the triangles of an STL file, which repeats a corner in each triangle that meets there. */
#include "stl.h"
#include <stdlib.h>

#define WELD          1e-4  /* corners closer than this fraction of the shortest edges at both are joined */
#define SMALLEST_CELL 1e-12 /* of Weld's cells, over the coordinates: cell numbers fit into 64 bits */

/* Triangles as numbers of points. Corners at the same position, to the last bit, are one point. */
typedef struct {
  PetscInt   n, points;
  PetscReal *x;      /* [points][3] m */
  PetscInt (*of)[3]; /* [n] points of a triangle */
} Mesh;

/* A hash table of point numbers with linear probing: a slot holds the number plus 1, or 0. 'size' is a power of two. */
typedef struct {
  size_t    size;
  PetscInt *number;
} Table;

static PetscErrorCode TableMake(PetscInt n, Table *table)
{
  PetscFunctionBegin;
  for (table->size = 16; table->size < 2 * (size_t)n; table->size *= 2) {
  }
  PetscCall(PetscCalloc1(table->size, &table->number));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Hashes three numbers of eight bytes. */
static unsigned long long HashOf(const void *three)
{
  unsigned long long word[DIM];

  memcpy(word, three, sizeof(word));
  return SplitMix64(word[0] ^ SplitMix64(word[1] ^ SplitMix64(word[2])));
}

static PetscErrorCode NumberCorners(PetscInt n, const PetscReal corner[], Mesh *mesh)
{
  Table table;

  PetscFunctionBegin;
  PetscCall(TableMake(3 * n, &table));
  PetscCall(PetscMalloc2(9 * n, &mesh->x, n, &mesh->of));
  mesh->n      = n;
  mesh->points = 0;
  for (PetscInt k = 0; k < 3 * n; k++) {
    const PetscReal x[DIM] = {corner[3 * k] + 0.0, corner[3 * k + 1] + 0.0, corner[3 * k + 2] + 0.0}; /* no -0 */
    size_t          slot   = HashOf(x) & (table.size - 1);

    while (table.number[slot] && memcmp(mesh->x + DIM * (table.number[slot] - 1), x, sizeof(x)))
      slot = (slot + 1) & (table.size - 1);
    if (!table.number[slot]) {
      PetscCall(PetscArraycpy(mesh->x + DIM * mesh->points, x, DIM));
      table.number[slot] = ++mesh->points;
    }
    mesh->of[k / 3][k % 3] = table.number[slot] - 1;
  }
  PetscCall(PetscFree(table.number));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal PointDistance(const Mesh *mesh, PetscInt a, PetscInt b)
{
  const PetscReal *x = mesh->x + DIM * a, *y = mesh->x + DIM * b;
  const PetscReal  r[DIM] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};

  return Norm(r);
}

/* The representative of the points that are joined to a point (union-find). */
static PetscInt Root(PetscInt joined[], PetscInt a)
{
  while (joined[a] != a) a = joined[a] = joined[joined[a]];
  return a;
}

/* Joins points closer to each other than WELD times the shortest edges at both. A grid whose cells are as large as the
   largest of these distances finds the candidates: a slot of the table holds the first point of a cell, next[] the
   others. */
static PetscErrorCode Weld(Mesh *mesh)
{
  PetscReal *reach, cell = 0;
  PetscInt  *joined, *next;
  Table      table;

  PetscFunctionBegin;
  PetscCall(TableMake(mesh->points, &table));
  PetscCall(PetscMalloc3(mesh->points, &reach, mesh->points, &joined, mesh->points, &next));
  for (PetscInt a = 0; a < mesh->points; a++) {
    reach[a]  = PETSC_MAX_REAL;
    joined[a] = a;
  }
  for (PetscInt k = 0; k < 3 * mesh->n; k++) {
    const PetscInt  a = mesh->of[k / 3][k % 3], b = mesh->of[k / 3][(k + 1) % 3];
    const PetscReal length = WELD * PointDistance(mesh, a, b);

    if (a == b) continue;
    reach[a] = PetscMin(reach[a], length);
    reach[b] = PetscMin(reach[b], length);
  }
  for (PetscInt a = 0; a < mesh->points; a++) {
    const PetscReal *x = mesh->x + DIM * a;

    if (reach[a] < PETSC_MAX_REAL) cell = PetscMax(cell, reach[a]);
    for (PetscInt d = 0; d < DIM; d++) cell = PetscMax(cell, SMALLEST_CELL * PetscAbsReal(x[d]));
  }
  for (PetscInt a = 0; a < mesh->points && cell > 0; a++) {
    const PetscReal *x = mesh->x + DIM * a;
    long long        at[DIM];

    for (PetscInt c = 0; c < 27; c++) { /* the cells around the point; its own cell, which receives it, is last */
      const PetscInt shift[DIM] = {(c + 14) % 3 - 1, (c / 3 + 5) % 3 - 1, (c / 9 + 2) % 3 - 1};
      size_t         slot;

      for (PetscInt d = 0; d < DIM; d++) at[d] = (long long)PetscFloorReal(x[d] / cell) + shift[d];
      slot = HashOf(at) & (table.size - 1);
      for (PetscInt b = table.number[slot] - 1; b >= 0; b = next[b])
        if (PointDistance(mesh, a, b) < PetscMin(reach[a], reach[b])) joined[Root(joined, a)] = Root(joined, b);
      if (c < 26) continue;
      next[a]            = table.number[slot] - 1;
      table.number[slot] = a + 1;
    }
  }
  for (PetscInt k = 0; k < 3 * mesh->n; k++) mesh->of[k / 3][k % 3] = Root(joined, mesh->of[k / 3][k % 3]);
  PetscCall(PetscFree3(reach, joined, next));
  PetscCall(PetscFree(table.number));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A triangle with its points in ascending order; orientation: 1 or -1, the sign of the permutation. */
typedef struct {
  PetscInt point[3], triangle;
  int      orientation;
} Face;

static int CompareFaces(const void *left, const void *right)
{
  const Face *a = (const Face *)left, *b = (const Face *)right;

  for (PetscInt c = 0; c < 3; c++)
    if (a->point[c] != b->point[c]) return a->point[c] < b->point[c] ? -1 : 1;
  return a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

static void Order(PetscInt *a, PetscInt *b, int *orientation)
{
  const PetscInt kept = *a;

  if (*a <= *b) return;
  *a           = *b;
  *b           = kept;
  *orientation = -*orientation;
}

/* Keeps one of the triangles with the same three points, or none if as many have one orientation as the other: then the
   same medium is on both sides. Removes triangles without area. repeated: number of triangles that repeat others. */
static PetscErrorCode RemoveRepeated(Mesh *mesh, PetscInt *repeated)
{
  Face      *face;
  PetscBool *keep;
  PetscInt   faces = 0, kept = 0;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(mesh->n, &face, mesh->n, &keep));
  for (PetscInt t = 0; t < mesh->n; t++) {
    Face f = {.point = {mesh->of[t][0], mesh->of[t][1], mesh->of[t][2]}, .triangle = t, .orientation = 1};

    Order(&f.point[0], &f.point[1], &f.orientation);
    Order(&f.point[1], &f.point[2], &f.orientation);
    Order(&f.point[0], &f.point[1], &f.orientation);
    if (f.point[0] != f.point[1] && f.point[1] != f.point[2]) face[faces++] = f;
  }
  if (faces) qsort(face, (size_t)faces, sizeof(*face), CompareFaces);
  for (PetscInt k = 0, next; k < faces; k = next) {
    int sum = 0; /* of the orientations */

    for (next = k; next < faces && !memcmp(face[next].point, face[k].point, sizeof(face[k].point)); next++)
      sum += face[next].orientation;
    keep[face[k].triangle] = (PetscBool)(sum != 0);
    kept += sum != 0;
  }
  for (PetscInt t = 0, next = 0; t < mesh->n; t++) /* in the order of the file */
    if (keep[t]) PetscCall(PetscArraycpy(mesh->of[next++], mesh->of[t], 3));
  *repeated = faces - kept;
  mesh->n   = kept;
  PetscCall(PetscFree2(face, keep));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static int CompareKeys(const void *left, const void *right)
{
  const unsigned long long a = *(const unsigned long long *)left, b = *(const unsigned long long *)right;

  return a < b ? -1 : a > b;
}

/* Counts the edges that belong to an odd number of triangles. */
static PetscErrorCode CountOpen(const Mesh *mesh, PetscInt *open)
{
  unsigned long long *edge; /* the lower point number in the upper 32 bits, the other in the lower 32 */
  const PetscInt      edges = 3 * mesh->n;

  PetscFunctionBegin;
  *open = 0;
  PetscCall(PetscMalloc1(edges, &edge));
  for (PetscInt k = 0; k < edges; k++) {
    const unsigned long long a = (unsigned)mesh->of[k / 3][k % 3], b = (unsigned)mesh->of[k / 3][(k + 1) % 3];

    edge[k] = PetscMin(a, b) << 32 | PetscMax(a, b);
  }
  if (edges) qsort(edge, (size_t)edges, sizeof(*edge), CompareKeys);
  for (PetscInt k = 0, same; k < edges; k += same) {
    for (same = 1; k + same < edges && edge[k] == edge[k + same]; same++) {
    }
    *open += same % 2;
  }
  PetscCall(PetscFree(edge));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StlClose(MPI_Comm comm, const char path[], PetscInt *n, PetscReal corner[])
{
  const PetscInt all = *n;
  Mesh           mesh;
  PetscInt       open, repeated;

  PetscFunctionBegin;
  PetscCall(NumberCorners(all, corner, &mesh));
  PetscCall(RemoveRepeated(&mesh, &repeated));
  PetscCall(CountOpen(&mesh, &open));
  if (open) { /* corners of one point may differ in their last digits */
    PetscInt more;

    PetscCall(Weld(&mesh));
    PetscCall(RemoveRepeated(&mesh, &more));
    PetscCall(CountOpen(&mesh, &open));
    repeated += more;
  }
  *n = mesh.n;
  for (PetscInt k = 0; k < 3 * mesh.n; k++)
    PetscCall(PetscArraycpy(corner + DIM * k, mesh.x + DIM * mesh.of[k / 3][k % 3], DIM));
  PetscCall(PetscFree2(mesh.x, mesh.of));
  PetscCheckUser(open == 0, comm,
                 "the surface in the STL file %s is not closed: %" PetscInt_FMT " edges belong to an odd number of "
                 "triangles; repair the surface",
                 path, open);
  PetscCheckUser(
    mesh.n > 0, comm,
    "the surface in the STL file %s encloses no volume: its triangles are points or lines, or triangles of "
    "opposite orientation cancel",
    path);
  if (repeated)
    PetscCall(PetscPrintf(comm,
                          "The STL file %s: %" PetscInt_FMT " of its %" PetscInt_FMT
                          " triangles repeat others and are left out\n",
                          path, repeated, all));
  PetscFunctionReturn(PETSC_SUCCESS);
}
