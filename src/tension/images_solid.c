/* Images of particles in solids.

   A solid mirrors each particle at the point of its surface that is nearest to it: at the distance s, n the unit vector
   out of the solid, the image is at x - 2 s n. With div n = k at that point and d dimensions, the volume of the image
   is (1 - s k/(1 + s k/(d - 1)))^2 of the particle's, as for a map of one side of a curved surface to the other; behind
   a convex edge it is 0. An image outside the solid is left out: the solid is thinner than the kernel's support.

   Normals are mirrored with n at the free surface next to the particle. In the liquid below the surface n differs by
   depth over radius, and the contact angle would have this error.

   Dummy particles fill a solid on the box's lattice. So their surface, and the liquid at it, is up to half a spacing
   away from the surface of the shape. Images are mirrored in the surface of the dummy particles (Offset). A particle
   too far away for a rank to know those at its foot takes the mean over those near: without any, a plane at 45 degrees
   to the lattice had a curvature 10 % too large beside the line. */
#include "curvature.h"

#define DIVERGENCE_STEP 0.5 /* spacings, of the finite differences of div n */
/* Distances from a solid, spacings: up to OFFSET_ALL the offset of its dummy particles counts in full, beyond
   OFFSET_NONE not at all. Within OFFSET_NONE a rank knows all dummy particles around the foot of a particle. */
#define OFFSET_ALL   1.25
#define OFFSET_NONE  2.25
#define LENGTH_LEAST 0.5 /* a particle nearer to the centre of a hollow than half of its radius has no image */
#define NO_SOLID     -1. /* in place of the index of a solid */

/* div n (1/m) of a solid's surface at its point y (m). */
static PetscReal SurfaceDivergence(Scene scene, PetscInt dim, PetscReal step, const PetscReal y[DIM])
{
  const PetscReal s   = SceneSolidDistance(scene, y, NULL);
  PetscReal       sum = 0;

  for (PetscInt d = 0; d < dim; d++)
    for (PetscInt side = -1; side <= 1; side += 2) {
      PetscReal x[DIM] = {y[0], y[1], y[2]};

      x[d] += side * step;
      sum += SceneSolidDistance(scene, x, NULL) - s;
    }
  return sum / PetscSqr(step);
}

/* Sorts the dummy particles of solids. */
static PetscErrorCode SortDummies(Tension tension, Cloud cloud)
{
  Curvature      *data    = tension->data;
  const PetscReal support = KernelSupport(data->core);
  PetscInt       *of, n = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(cloud->n_total, &of));
  for (PetscInt a = 0; a < cloud->n_total; a++)
    if (cloud->integer[INT_LAYER][a] != 0 && cloud->integer[INT_BODY][a] <= BODY_SOLID) of[n++] = a;
  PetscCall(SortedCellsBuild(&data->solid.dummies, cloud, n, of, support, support));
  PetscCall(PetscFree(of));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The fraction of the kernel at x (m) that dummy particles fill. */
static PetscReal Filled(Tension tension, PetscReal volume, const PetscReal x[DIM])
{
  Curvature       *data    = tension->data;
  SortedCells     *dummies = &data->solid.dummies;
  const PetscReal *cx = dummies->sorted, *cy = cx + dummies->count, *cz = cy + dummies->count;
  PetscReal        sum = 0, r2[CHUNK], W[CHUNK];

  SortedCellsLines(dummies, x, dummies->support);
  for (PetscInt l = 0; l < dummies->lines; l++) {
    const PetscInt end = dummies->line[l].begin + dummies->line[l].length;

    for (PetscInt begin = dummies->line[l].begin; begin < end; begin += CHUNK) {
      const PetscInt m = PetscMin(CHUNK, end - begin);

      for (PetscInt k = 0; k < m; k++) {
        const PetscReal r[DIM] = {x[0] - cx[begin + k], x[1] - cy[begin + k], x[2] - cz[begin + k]};

        r2[k] = Dot(r, r);
      }
      KernelEvaluate(data->core, m, r2, W, NULL);
      for (PetscInt k = 0; k < m; k++) sum += volume * W[k];
    }
  }
  return sum;
}

/* How far a particle at the distance s (m) from a solid has the offset at its own foot: 1 or more: in full. */
static inline PetscReal Nearness(Tension tension, PetscReal s)
{
  return (OFFSET_NONE - s / tension->spacing) / (OFFSET_NONE - OFFSET_ALL);
}

/* The height (m) of the surface of a solid's dummy particles above that of its shape, at a point 'foot' of the shape.
   div_n (1/m): of the shape there. */
static PetscReal Offset(Tension tension, PetscReal volume, const PetscReal foot[DIM], PetscReal div_n)
{
  const Curvature *data   = tension->data;
  const PetscReal  filled = Filled(tension, volume, foot) + 0.5 * div_n * KernelPlaneMoment(data->core),
                  offset  = (filled - 0.5) * SHEET_CORE / data->plane;

  return PetscMax(-0.5, PetscMin(0.5, offset / tension->spacing)) * tension->spacing;
}

/* Takes the offsets ([n_fluid], m) from the distances in mirror: of a particle far from a solid the mean of those near
   it. */
static PetscErrorCode TakeOffsets(Tension tension, Cloud cloud, const PetscReal offset[])
{
  Curvature   *data                      = tension->data;
  SolidImages *solid                     = &data->solid;
  PetscReal    sum[2 * SCENE_MAX_BODIES] = {0}; /* of each solid: offsets; particles */

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *mirror = solid->mirror + DIM * a;

    if (mirror[2] < 0 || Nearness(tension, mirror[0]) < 1) continue;
    sum[2 * (PetscInt)mirror[2]] += offset[a];
    sum[2 * (PetscInt)mirror[2] + 1]++;
  }
  PetscCallMPI(
    MPI_Allreduce(MPI_IN_PLACE, sum, (PetscMPIInt)(2 * data->contact.solids), MPIU_REAL, MPI_SUM, cloud->comm));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal *mirror = solid->mirror + DIM * a;

    if (mirror[2] >= 0) {
      const PetscReal *of = sum + 2 * (PetscInt)mirror[2], mean = of[1] > 0 ? of[0] / of[1] : 0,
                      near = PetscMax(0, PetscMin(1, Nearness(tension, mirror[0])));

      mirror[0] -= near * offset[a] + (1 - near) * mean;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds mirror and normal (see SolidImages) of the particle at x (m) for solids within 'reach' (m), but for the offset
   (m) in the distance. */
static void FindSolid(Tension tension, Cloud cloud, const PetscReal x[DIM], PetscReal reach, PetscReal mirror[DIM],
                      PetscReal normal[DIM], PetscReal *offset)
{
  const Curvature *data    = tension->data;
  PetscInt         nearest = 0;
  const PetscReal  s       = SceneSolidDistance(cloud->scene, x, &nearest);
  PetscReal        image[DIM], foot[DIM], div_n, length;

  *offset   = 0;
  mirror[2] = NO_SOLID;
  if (s > reach || data->contact.solid[nearest].angle == 0) return;
  SceneSolidNormal(cloud->scene, x, normal);
  if (Norm(normal) == 0) return;
  for (PetscInt d = 0; d < DIM; d++) {
    foot[d]  = x[d] - s * normal[d];
    image[d] = x[d] - 2 * s * normal[d];
  }
  div_n     = SurfaceDivergence(cloud->scene, tension->dim, DIVERGENCE_STEP * tension->spacing, foot);
  mirror[0] = s;
  if (Nearness(tension, s) > 0) *offset = Offset(tension, cloud->domain->volume, foot, div_n);
  mirror[2] = (PetscReal)nearest;
  if (SceneSolidDistance(cloud->scene, image, NULL) > 0) return;
  length    = 1 + s * div_n / (tension->dim - 1); /* of the parallel surface at x over that at the foot */
  mirror[1] = length > LENGTH_LEAST ? PetscSqr(PetscMax(0, 1 - s * div_n / length)) : 0;
}

PetscErrorCode ImagesFindSolids(Tension tension, Cloud cloud)
{
  Curvature   *data  = tension->data;
  SolidImages *solid = &data->solid;
  PetscReal   *offset;

  PetscFunctionBegin;
  if (data->contact.solids == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SortDummies(tension, cloud));
  PetscCall(CloudGetWork(cloud, DIM, &solid->mirror));
  PetscCall(CloudGetWork(cloud, DIM, &solid->normal));
  PetscCall(CloudGetWork(cloud, DIM, &solid->meeting));
  PetscCall(CloudGetWork(cloud, 1, &solid->index));
  PetscCall(PetscArrayzero(solid->mirror, DIM * cloud->n_total));
  PetscCall(PetscArrayzero(solid->normal, DIM * cloud->n_total));
  PetscCall(CloudGetWork(cloud, 1, &offset));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    FindSolid(tension, cloud, cloud->field[FIELD_POSITION] + DIM * a,
              tension->size_most * KernelSupport(tension->kernel), solid->mirror + DIM * a, solid->normal + DIM * a,
              &offset[a]);
  PetscCall(TakeOffsets(tension, cloud, offset));
  PetscCall(CloudRestoreWork(cloud, &offset));
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, solid->normal));
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_SCALAR, solid->mirror));
  PetscCall(PetscArraycpy(solid->meeting, solid->normal, DIM * cloud->n_total));
  for (PetscInt a = 0; a < cloud->n_total; a++) solid->index[a] = (PetscReal)a;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ImagesFindMeeting(Tension tension, Cloud cloud, const PetscReal normal[], const PetscReal depth[])
{
  Curvature   *data  = tension->data;
  SolidImages *solid = &data->solid;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid && data->contact.solids; a++) {
    const PetscReal *n = normal + DIM * a, *x = cloud->field[FIELD_POSITION] + DIM * a;
    const PetscReal  y[DIM] = {x[0] + depth[a] * n[0], x[1] + depth[a] * n[1], x[2] + depth[a] * n[2]};
    PetscReal        meeting[DIM];

    if (solid->mirror[DIM * a + 2] < 0 || Norm(n) == 0) continue;
    SceneSolidNormal(cloud->scene, y, meeting);
    for (PetscInt d = 0; d < DIM && Norm(meeting) > 0; d++) solid->meeting[DIM * a + d] = meeting[d];
  }
  if (data->contact.solids) PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, solid->meeting));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ImagesRestore(Tension tension, Cloud cloud)
{
  Curvature   *data  = tension->data;
  SolidImages *solid = &data->solid;

  PetscFunctionBegin;
  if (data->contact.solids == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudRestoreWork(cloud, &solid->index));
  PetscCall(CloudRestoreWork(cloud, &solid->meeting));
  PetscCall(CloudRestoreWork(cloud, &solid->normal));
  PetscCall(CloudRestoreWork(cloud, &solid->mirror));
  PetscFunctionReturn(PETSC_SUCCESS);
}
