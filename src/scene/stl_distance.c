/* The distances of a table's nodes to the triangles of a surface, for nodes within the band around the surface. */
#include "stl.h"
#include <stdlib.h>

#define GROUP_CELL   1.0        /* edge of the cells whose triangles make a group, spacings */
#define BOUND_EXCESS (1 + 1e-6) /* factor of upper bounds of distances: more than their rounding */

/* Squared distance of p to a triangle a, b, c (Ericson 2005, Real-Time Collision Detection, 5.1.5). */
static PetscReal TriangleDistance2(const PetscReal p[DIM], const PetscReal corner[9])
{
  PetscReal        ab[DIM], ac[DIM], ap[DIM], bp[DIM], cp[DIM], near[DIM], d1, d2, d3, d4, d5, d6, va, vb, vc, v, w;
  const PetscReal *a = corner, *b = corner + DIM, *c = corner + 2 * DIM;

  for (PetscInt d = 0; d < DIM; d++) {
    ab[d] = b[d] - a[d];
    ac[d] = c[d] - a[d];
    ap[d] = p[d] - a[d];
    bp[d] = p[d] - b[d];
    cp[d] = p[d] - c[d];
  }
  d1 = Dot(ab, ap);
  d2 = Dot(ac, ap);
  d3 = Dot(ab, bp);
  d4 = Dot(ac, bp);
  d5 = Dot(ab, cp);
  d6 = Dot(ac, cp);
  va = d3 * d6 - d5 * d4;
  vb = d5 * d2 - d1 * d6;
  vc = d1 * d4 - d3 * d2;
  if (d1 <= 0 && d2 <= 0)
    v = w = 0; /* a */
  else if (d3 >= 0 && d4 <= d3) {
    v = 1; /* b */
    w = 0;
  } else if (d6 >= 0 && d5 <= d6) {
    v = 0; /* c */
    w = 1;
  } else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    v = d1 / (d1 - d3); /* edge ab */
    w = 0;
  } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    v = 0;
    w = d2 / (d2 - d6); /* edge ac */
  } else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    w = (d4 - d3) / ((d4 - d3) + (d5 - d6)); /* edge bc */
    v = 1 - w;
  } else {
    v = vb / (va + vb + vc);
    w = vc / (va + vb + vc);
  }
  for (PetscInt d = 0; d < DIM; d++) near[d] = ap[d] - v * ab[d] - w * ac[d];
  return Dot(near, near);
}

/* A triangle with the group cell of its centre and its bounding sphere, m. */
typedef struct {
  PetscInt64       cell;
  const PetscReal *corner; /* [3][3] */
  PetscReal        centre[DIM], radius;
} Triangle;

/* The triangles of a group cell and their bounding box, m. */
typedef struct {
  const Triangle *triangle;
  PetscInt        n;
  PetscReal       lower[DIM], upper[DIM];
} Group;

/* The nodes first[d] <= i[d] <= last[d], which include those within the band around a group. */
static void NodesAround(const Stl *stl, const Group *group, PetscInt first[DIM], PetscInt last[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    first[d] = (PetscInt)PetscMax(0, PetscCeilReal((group->lower[d] - stl->band - stl->origin[d]) / stl->cell));
    last[d] =
      (PetscInt)PetscMin(stl->n[d] - 1, PetscFloorReal((group->upper[d] + stl->band - stl->origin[d]) / stl->cell));
  }
}

/* Lowers the distances of nodes to an upper bound: the distance to one corner of a group, times BOUND_EXCESS. */
static void AddCorner(Stl *stl, const Group *group)
{
  const PetscReal *x = group->triangle->corner;
  PetscInt         first[DIM], last[DIM];

  NodesAround(stl, group, first, last);
  for (PetscInt k = first[2]; k <= last[2]; k++)
    for (PetscInt j = first[1]; j <= last[1]; j++) {
      float          *s = &stl->distance[(k * stl->n[1] + j) * stl->n[0]];
      const PetscReal y = stl->origin[1] + j * stl->cell - x[1], z = stl->origin[2] + k * stl->cell - x[2],
                      square = y * y + z * z;

      for (PetscInt i = first[0]; i <= last[0]; i++) {
        const PetscReal r     = stl->origin[0] + i * stl->cell - x[0];
        const float     bound = (float)(BOUND_EXCESS * PetscSqrtReal(square + r * r));

        s[i] = s[i] < bound ? s[i] : bound;
      }
    }
}

/* Squared distance of p to the bounding box of a group. */
static inline PetscReal BoxDistance2(const Group *group, const PetscReal p[DIM])
{
  PetscReal sum = 0;

  for (PetscInt d = 0; d < DIM; d++)
    sum += PetscSqr(PetscMax(0, PetscMax(group->lower[d] - p[d], p[d] - group->upper[d])));
  return sum;
}

/* Lowers the distances of the nodes around a group to those to its triangles. Skips groups and triangles that cannot be
   nearer to a node than the distance found so far. */
static void AddTriangles(Stl *stl, const Group *group)
{
  PetscInt first[DIM], last[DIM];

  NodesAround(stl, group, first, last);
  for (PetscInt k = first[2]; k <= last[2]; k++)
    for (PetscInt j = first[1]; j <= last[1]; j++)
      for (PetscInt i = first[0]; i <= last[0]; i++) {
        const PetscReal p[DIM] = {stl->origin[0] + i * stl->cell, stl->origin[1] + j * stl->cell,
                                  stl->origin[2] + k * stl->cell};
        float          *s      = &stl->distance[(k * stl->n[1] + j) * stl->n[0] + i];

        if (BoxDistance2(group, p) > PetscSqr((PetscReal)*s)) continue;
        for (const Triangle *t = group->triangle; t < group->triangle + group->n; t++) {
          const PetscReal r[DIM] = {p[0] - t->centre[0], p[1] - t->centre[1], p[2] - t->centre[2]};

          if (Dot(r, r) <= PetscSqr((PetscReal)*s + t->radius))
            *s = (float)PetscMin((PetscReal)*s, PetscSqrtReal(TriangleDistance2(p, t->corner)));
        }
      }
}

static void FindCell(const Stl *stl, const PetscReal corner[9], Triangle *t)
{
  const PetscReal size = stl->cell / STL_CELL * GROUP_CELL;

  *t = (Triangle){.corner = corner};
  for (PetscInt d = DIM - 1; d >= 0; d--) {
    const PetscReal cells = PetscFloorReal(stl->n[d] * stl->cell / size) + 1;

    t->centre[d] = (corner[d] + corner[DIM + d] + corner[2 * DIM + d]) / 3;
    t->cell      = t->cell * (PetscInt64)cells +
              (PetscInt64)PetscMax(0, PetscMin((t->centre[d] - stl->origin[d]) / size, cells - 1));
  }
  for (PetscInt c = 0; c < 3; c++) {
    const PetscReal *x = corner + DIM * c, r[DIM] = {x[0] - t->centre[0], x[1] - t->centre[1], x[2] - t->centre[2]};

    t->radius = PetscMax(t->radius, BOUND_EXCESS * Norm(r));
  }
}

static int CompareCells(const void *left, const void *right)
{
  const Triangle *a = (const Triangle *)left, *b = (const Triangle *)right;

  if (a->cell != b->cell) return a->cell < b->cell ? -1 : 1;
  return a->corner < b->corner ? -1 : a->corner > b->corner;
}

/* The group that begins with the first of n triangles. */
static Group GroupFrom(const Triangle triangle[], PetscInt n)
{
  Group group = {.triangle = triangle};

  for (PetscInt d = 0; d < DIM; d++) {
    group.lower[d] = PETSC_MAX_REAL;
    group.upper[d] = PETSC_MIN_REAL;
  }
  for (; group.n < n && triangle[group.n].cell == triangle->cell; group.n++)
    for (PetscInt c = 0; c < 9; c++) {
      const PetscReal x = triangle[group.n].corner[c];

      group.lower[c % DIM] = PetscMin(group.lower[c % DIM], x);
      group.upper[c % DIM] = PetscMax(group.upper[c % DIM], x);
    }
  return group;
}

/* The upper bounds come first: then AddTriangles can skip most triangles. */
PetscErrorCode StlDistances(Stl *stl, PetscInt n, const PetscReal corner[])
{
  Triangle *triangle;
  Group     group;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &triangle));
  for (PetscInt t = 0; t < n; t++) FindCell(stl, corner + 9 * t, &triangle[t]);
  qsort(triangle, (size_t)n, sizeof(*triangle), CompareCells);
  for (PetscInt k = 0; k < n; k += group.n) {
    group = GroupFrom(triangle + k, n - k);
    AddCorner(stl, &group);
  }
  for (PetscInt k = 0; k < n; k += group.n) {
    group = GroupFrom(triangle + k, n - k);
    AddTriangles(stl, &group);
  }
  PetscCall(PetscFree(triangle));
  PetscFunctionReturn(PETSC_SUCCESS);
}
