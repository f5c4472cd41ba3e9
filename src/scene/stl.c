/* A closed surface of triangles. A table holds its signed distance: exact near the surface, constant beyond. The number
   of triangles that a ray crosses gives the sign. */
#include "stl.h"

#define MUCH_LARGER 30   /* times the box: a part of such a size in mm is at most a thirtieth of it in m */
#define FARTHEST    1e6  /* sizes of the box: the rounding of 32-bit numbers there is as large as the box */
#define BAND        4    /* spacings from the surface within which the distance is exact; its constant size beyond */
#define TILT        1e-4 /* cells by which rays pass the nodes, so that they miss edges and corners at nodes */
#define MAX_NODES   2e8  /* of the table: 0.8 GB */

/* Changes the sign of the nodes behind a triangle along x. After all triangles the sign of a node is the parity of the
   crossings. */
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

/* Makes the table, around the part of the surface within the box and BAND of it. */
static PetscErrorCode Tabulate(Body body, PetscInt n, const PetscReal corner[], const PetscReal lower[DIM],
                               const PetscReal upper[DIM])
{
  Domain    domain = body->domain;
  Stl       head   = *(const Stl *)body->shape_data, *stl;
  PetscReal nodes  = 1, margin;

  PetscFunctionBegin;
  head.cell = STL_CELL * domain->spacing;
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
    "the shape of %s needs a table of %.3g numbers; at most %.3g are allowed: use a larger -spacing or a smaller shape",
    body->name, (double)nodes, MAX_NODES);
  PetscCall(PetscCalloc(sizeof(Stl) + (size_t)nodes * sizeof(float), &stl));
  *stl = head;
  PetscCall(PetscFree(body->shape_data));
  body->shape_data = stl;
  for (PetscInt k = 0; k < (PetscInt)nodes; k++) stl->distance[k] = (float)head.band;
  PetscCall(StlDistances(stl, n, corner));
  for (PetscInt t = 0; t < n; t++) AddCrossings(stl, corner + 9 * t);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow options[] = {
  {"-file", "STL file with a closed surface, binary or text", NULL, NULL, ROW_FILE, offsetof(Stl, file),
   .fallback = OPTION_REQUIRED},
  {"-scale", "Length unit of an STL file", "m", "(0, inf)", ROW_REAL, offsetof(Stl, scale)},
  {"-offset", "Position of the origin of an STL file", "m", NULL, ROW_POINT, offsetof(Stl, offset)},
  {.name = NULL},
};

static void StlDefaults(void *owner)
{
  Body body                        = (Body)owner;
  ((Stl *)body->shape_data)->scale = 1;
}

/* Says that a surface much larger than the box may be in millimetres. */
static PetscErrorCode DoubtScale(Body body, const PetscReal lower[DIM], const PetscReal upper[DIM])
{
  const Domain domain = body->domain;
  const Stl   *stl    = (const Stl *)body->shape_data;
  PetscReal    size = 0, box = 0;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < domain->dim; d++) {
    size = PetscMax(size, upper[d] - lower[d]);
    box  = PetscMax(box, domain->upper[d] - domain->lower[d]);
  }
  if (stl->scale == 1 && size > MUCH_LARGER * box)
    PetscCall(
      PetscPrintf(domain->comm,
                  "warning: the surface in %s is %.3g m long, %.0f times the box: if its lengths are in mm, give "
                  "-%sscale 1e-3\n",
                  stl->file.path, (double)size, (double)(size / box), body->prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode StlSetUp(void *owner)
{
  Body            body   = (Body)owner;
  const Domain    domain = body->domain;
  Stl            *stl    = (Stl *)body->shape_data;
  const char     *path   = stl->file.path;
  const PetscReal scale  = stl->scale;
  PetscReal      *corner, lower[DIM], upper[DIM], farthest = 0;
  PetscInt        n;

  PetscFunctionBegin;
  PetscCheckUser(path[0], domain->comm, "-%sfile is missing: the name of the shape's STL file must be given",
                 body->prefix);
  PetscCall(StlRead(domain->comm, path, &n, &corner));
  stl->file.checksum = HashBytes(HASH_START, corner, 9 * (size_t)n * sizeof(*corner));
  for (PetscInt d = 0; d < DIM; d++) {
    lower[d] = PETSC_MAX_REAL;
    upper[d] = PETSC_MIN_REAL;
    farthest = PetscMax(farthest, FARTHEST * (domain->upper[d] - domain->lower[d]));
  }
  for (PetscInt k = 0; k < 9 * n; k++) {
    corner[k] = scale * corner[k] + stl->offset[k % DIM];
    PetscCheckUser(corner[k] - domain->lower[k % DIM] <= farthest && domain->lower[k % DIM] - corner[k] <= farthest,
                   domain->comm,
                   "the STL file %s has a corner at %c = %g m in triangle %" PetscInt_FMT
                   ", far from the box; check the file and -%sscale",
                   path, "xyz"[k % DIM], (double)corner[k], k / 9 + 1, body->prefix);
  }
  PetscCall(StlClose(domain->comm, path, &n, corner));
  for (PetscInt k = 0; k < 9 * n; k++) {
    const PetscInt d = k % DIM;

    lower[d] = PetscMin(lower[d], corner[k]);
    upper[d] = PetscMax(upper[d], corner[k]);
  }
  PetscCall(DoubtScale(body, lower, upper));
  for (PetscInt d = 0; d < domain->dim; d++)
    PetscCheckUser(lower[d] < domain->upper[d] && upper[d] > domain->lower[d], domain->comm,
                   "the body %s is wholly outside the box: the surface in %s reaches from %g to %g m along %c",
                   body->name, path, (double)lower[d], (double)upper[d], (char)('x' + d));
  PetscCall(Tabulate(body, n, corner, lower, upper));
  PetscCall(PetscFree(corner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Linear between the nodes. Outside the table the distance to the table is added. */
static PetscReal StlDistance(Body body, const PetscReal x[DIM])
{
  const Stl *stl = (const Stl *)body->shape_data;
  PetscReal  t[DIM], out = 0, sum = 0;
  PetscInt   at[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal node = (x[d] - stl->origin[d]) / stl->cell, inside = PetscMax(0, PetscMin(node, stl->n[d] - 1));

    out += PetscSqr((node - inside) * stl->cell);
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

const ShapeOps ShapeStl = {{"stl", sizeof(Stl), options, StlDefaults, StlSetUp}, StlDistance, StlBounds, NULL, NULL};
