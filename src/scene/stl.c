/* A closed surface of triangles. Its signed distance is tabulated: exact near the surface, capped beyond; the sign by
   the number of triangles a ray meets. */
#include "stl.h"

#define CELL      0.5  /* distance of the table's nodes, spacings */
#define BAND      4    /* the distance is exact so many spacings from the surface, and has that size beyond */
#define TILT      1e-4 /* rays pass the nodes by so many cells, and so miss edges and corners that lie on nodes */
#define MAX_NODES 2e8  /* of the table: 0.8 GB */

/* The table: nodes lower + (i, j, k) cell, x fastest, 0 <= i < n[0] and so on; the band's width around the surface. */
typedef struct {
  char      path[PETSC_MAX_PATH_LEN];
  PetscReal scale, offset[DIM];      /* of the file's unit, m */
  PetscReal lower[DIM], upper[DIM];  /* of the surface, m */
  PetscReal origin[DIM], cell, band; /* m */
  PetscInt  n[DIM];
  float     distance[]; /* [n2][n1][n0] m */
} Stl;

/* Squared distance of p to the triangle a, b, c (Ericson 2005, Real-Time Collision Detection, 5.1.5). */
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

/* Lowers the distances of the nodes within the band around a triangle. */
static void AddDistance(Stl *stl, const PetscReal corner[9])
{
  PetscInt first[DIM], last[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal low  = PetscMin(corner[d], PetscMin(corner[DIM + d], corner[2 * DIM + d])),
                    high = PetscMax(corner[d], PetscMax(corner[DIM + d], corner[2 * DIM + d]));

    first[d] = PetscMax(0, (PetscInt)PetscCeilReal((low - stl->band - stl->origin[d]) / stl->cell));
    last[d]  = PetscMin(stl->n[d] - 1, (PetscInt)PetscFloorReal((high + stl->band - stl->origin[d]) / stl->cell));
  }
  for (PetscInt k = first[2]; k <= last[2]; k++)
    for (PetscInt j = first[1]; j <= last[1]; j++)
      for (PetscInt i = first[0]; i <= last[0]; i++) {
        const PetscReal p[DIM] = {stl->origin[0] + i * stl->cell, stl->origin[1] + j * stl->cell,
                                  stl->origin[2] + k * stl->cell};
        float          *s      = &stl->distance[(k * stl->n[1] + j) * stl->n[0] + i];

        *s = (float)PetscMin((PetscReal)*s, PetscSqrtReal(TriangleDistance2(p, corner)));
      }
}

/* Changes the sign of the nodes behind a triangle, seen along x: after all triangles a node has the sign of the number
   of crossings. */
static void AddCrossings(Stl *stl, const PetscReal corner[9])
{
  const PetscReal *a = corner, *b = corner + DIM, *c = corner + 2 * DIM;
  const PetscReal  area = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
  PetscInt         first[DIM], last[DIM];

  if (area == 0) return;
  for (PetscInt d = 1; d < DIM; d++) {
    first[d] =
      PetscMax(0, (PetscInt)PetscFloorReal((PetscMin(a[d], PetscMin(b[d], c[d])) - stl->origin[d]) / stl->cell));
    last[d] = PetscMin(stl->n[d] - 1,
                       (PetscInt)PetscCeilReal((PetscMax(a[d], PetscMax(b[d], c[d])) - stl->origin[d]) / stl->cell));
  }
  for (PetscInt k = first[2]; k <= last[2]; k++)
    for (PetscInt j = first[1]; j <= last[1]; j++) {
      const PetscReal y = stl->origin[1] + (j + TILT) * stl->cell,
                      z = stl->origin[2] + (k + TILT * PETSC_PI) * stl->cell;
      const PetscReal v = ((y - a[1]) * (c[2] - a[2]) - (z - a[2]) * (c[1] - a[1])) / area,
                      w = ((b[1] - a[1]) * (z - a[2]) - (b[2] - a[2]) * (y - a[1])) / area;
      const PetscReal x = a[0] + v * (b[0] - a[0]) + w * (c[0] - a[0]);

      if (v < 0 || w < 0 || v + w > 1) continue;
      for (PetscInt i = PetscMax(0, (PetscInt)PetscCeilReal((x - stl->origin[0]) / stl->cell)); i < stl->n[0]; i++) {
        float *s = &stl->distance[(k * stl->n[1] + j) * stl->n[0] + i];

        *s = -*s;
      }
    }
}

/* The table around the part of the surface that is in reach of the box. */
static PetscErrorCode Tabulate(Body body, PetscInt n, const PetscReal corner[], const PetscReal lower[DIM],
                               const PetscReal upper[DIM])
{
  Domain    domain = body->domain;
  Stl       head   = *(const Stl *)body->shape_data, *stl;
  PetscReal nodes  = 1, margin;

  PetscFunctionBegin;
  head.cell = CELL * domain->spacing;
  head.band = BAND * domain->spacing;
  margin    = head.band + 2 * head.cell;
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal low  = PetscMax(lower[d], domain->lower[d]) - margin,
                    high = PetscMin(upper[d], domain->upper[d]) + margin;

    head.lower[d]  = lower[d];
    head.upper[d]  = upper[d];
    head.origin[d] = low;
    head.n[d]      = (PetscInt)PetscMax(2, PetscCeilReal((high - low) / head.cell) + 1);
    nodes *= head.n[d];
  }
  PetscCheckUser(
    nodes <= MAX_NODES, domain->comm,
    "the shape of %s needs a table of %.3g numbers, more than the %.3g allowed: use a larger -spacing or a "
    "smaller shape",
    body->name, (double)nodes, MAX_NODES);
  PetscCall(PetscCalloc(sizeof(Stl) + (size_t)nodes * sizeof(float), &stl));
  *stl = head;
  PetscCall(PetscFree(body->shape_data));
  body->shape_data = stl;
  for (PetscInt k = 0; k < (PetscInt)nodes; k++) stl->distance[k] = (float)head.band;
  for (PetscInt t = 0; t < n; t++) AddDistance(stl, corner + 9 * t);
  for (PetscInt t = 0; t < n; t++) AddCrossings(stl, corner + 9 * t);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode StlSetFromOptions(Body body, OptionItems PetscOptionsObject)
{
  Stl *stl = (Stl *)body->shape_data;

  PetscFunctionBegin;
  stl->scale = 1;
  PetscCall(PetscOptionsString("-file", "STL file with a closed surface, binary or text, required", "ShapeStl",
                               stl->path, stl->path, sizeof(stl->path), NULL));
  PetscCall(OptionReal("-scale", "Length of the unit of an STL file (m)", "(0, inf)", &stl->scale));
  PetscCall(DomainOptionsVector(body->domain, PetscOptionsObject, VECTOR_POINT, "-offset",
                                "Where the origin of an STL file lies (m)", "ShapeStl", stl->offset, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode StlSetUp(Body body)
{
  const Domain    domain = body->domain;
  const Stl      *stl    = (const Stl *)body->shape_data;
  const char     *path   = stl->path;
  const PetscReal scale  = stl->scale;
  PetscReal      *corner, lower[DIM], upper[DIM];
  PetscInt        n;

  PetscFunctionBegin;
  PetscCheckUser(path[0], domain->comm, "-%sfile is missing: the STL file of the shape must be given", body->prefix);
  PetscCall(StlRead(domain->comm, path, &n, &corner));
  for (PetscInt d = 0; d < DIM; d++) {
    lower[d] = PETSC_MAX_REAL;
    upper[d] = PETSC_MIN_REAL;
  }
  for (PetscInt k = 0; k < 9 * n; k++) {
    const PetscInt d = k % DIM;

    corner[k] = scale * corner[k] + stl->offset[d];
    lower[d]  = PetscMin(lower[d], corner[k]);
    upper[d]  = PetscMax(upper[d], corner[k]);
  }
  PetscCall(StlCheckClosed(domain->comm, path, n, corner, lower, upper));
  for (PetscInt d = 0; d < domain->dim; d++)
    PetscCheckUser(lower[d] < domain->upper[d] && upper[d] > domain->lower[d], domain->comm,
                   "the body %s is wholly outside the box: the surface in %s reaches from %g to %g m along %c",
                   body->name, path, (double)lower[d], (double)upper[d], (char)('x' + d));
  PetscCall(Tabulate(body, n, corner, lower, upper));
  PetscCall(PetscFree(corner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Linear between the nodes; outside of the table the distance to it more. */
static PetscReal StlDistance(Body body, const PetscReal x[DIM])
{
  const Stl *stl = (const Stl *)body->shape_data;
  PetscReal  t[DIM], out = 0, sum = 0;
  PetscInt   at[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal place = (x[d] - stl->origin[d]) / stl->cell, inside = PetscMax(0, PetscMin(place, stl->n[d] - 1));

    out += PetscSqr((place - inside) * stl->cell);
    at[d] = PetscMin((PetscInt)inside, stl->n[d] - 2);
    t[d]  = inside - at[d];
  }
  for (PetscInt c = 0; c < 8; c++) {
    const PetscInt  i = c & 1, j = (c >> 1) & 1, k = c >> 2;
    const PetscReal weight = (i ? t[0] : 1 - t[0]) * (j ? t[1] : 1 - t[1]) * (k ? t[2] : 1 - t[2]);

    sum += weight * stl->distance[((at[2] + k) * stl->n[1] + at[1] + j) * stl->n[0] + at[0] + i];
  }
  return out > 0 ? PetscAbsReal(sum) + PetscSqrtReal(out) - stl->cell : sum;
}

static void StlBounds(Body body, PetscReal lower[DIM], PetscReal upper[DIM])
{
  const Stl *stl = (const Stl *)body->shape_data;

  for (PetscInt d = 0; d < DIM; d++) {
    lower[d] = stl->lower[d];
    upper[d] = stl->upper[d];
  }
}

const BodyChoice *ShapeStl(void)
{
  static const ShapeOps ops = {{sizeof(Stl), StlSetFromOptions, StlSetUp}, StlDistance, StlBounds, NULL};

  return &ops.choice;
}
