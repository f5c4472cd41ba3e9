/* Forces of the liquid on the walls of the box and on solids. */
#include "../neighbors/pairs.h"
#include "output_impl.h"

static const char *const FaceNames[DIM][2] = {{"xmin", "xmax"}, {"ymin", "ymax"}, {"zmin", "zmax"}};

/* The wall faces of the box in order: direction and side of number 'index'; returns their number. */
static PetscInt WallFace(Domain domain, PetscInt index, PetscInt *direction, PetscInt *side)
{
  PetscInt count = 0;

  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt s = 0; s < 2; s++) {
      if (domain->face[d][s] != FACE_WALL) continue;
      if (count == index) {
        *direction = d;
        *side      = s;
      }
      count++;
    }
  return count;
}

PetscInt ForcesCount(Output output)
{
  return WallFace(output->cloud->domain, -1, NULL, NULL) + SceneSolidCount(output->cloud->scene);
}

const char *ForcesName(Output output, PetscInt index)
{
  PetscInt       d = 0, s = 0;
  const PetscInt faces = WallFace(output->cloud->domain, index, &d, &s);

  return index < faces ? FaceNames[d][s] : BodyName(SceneSolid(output->cloud->scene, index - faces));
}

/* Which of the forces a dummy particle's goes to: a solid's, or that of the face it is deepest behind. */
static PetscInt Receiver(Output output, PetscInt body, const PetscReal x[DIM])
{
  const Domain   domain  = output->cloud->domain;
  const PetscInt faces   = WallFace(domain, -1, NULL, NULL);
  PetscInt       best    = 0;
  PetscReal      deepest = PETSC_MIN_REAL;

  if (body <= BODY_SOLID) return faces + BODY_SOLID - body;
  for (PetscInt f = 0; f < faces; f++) {
    PetscInt  d = 0, s = 0;
    PetscReal depth;

    (void)WallFace(domain, f, &d, &s);
    depth = s ? x[d] - domain->upper[d] : domain->lower[d] - x[d];
    if (depth > deepest) {
      deepest = depth;
      best    = f;
    }
  }
  return best;
}

PetscErrorCode ForcesMeasure(Output output, PetscReal force[])
{
  Cloud            cloud = output->cloud;
  const PetscInt   dim = cloud->domain->dim, count = ForcesCount(output);
  const PetscReal *x = cloud->field[FIELD_POSITION], *p = cloud->field[FIELD_PRESSURE];
  PairRow         *row;

  PetscFunctionBegin;
  PetscCall(PetscNew(&row));
  PetscCall(CloudUpdate(cloud, FIELD_POSITION));
  PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  PetscCall(PetscArrayzero(force, count * dim));
  for (PetscInt b = cloud->n_fluid; b < cloud->n_owned; b++) {
    PetscReal sum[DIM] = {0, 0, 0};
    PetscInt  to;

    PairRowLoad(cloud, x, b, row);
    KernelGradient(cloud->kernel, row->n, row->r2, row->F);
    for (PetscInt k = 0; k < row->n; k++) {
      const PetscInt  a = row->index[k];
      const PetscReal c =
        cloud->integer[INT_LAYER][a] ? 0 : cloud->volume[a] * cloud->volume[b] * (p[a] + p[b]) * row->F[k];

      sum[0] -= c * row->dx[k];
      sum[1] -= c * row->dy[k];
      sum[2] -= c * row->dz[k];
    }
    to = Receiver(output, cloud->integer[INT_BODY][b], x + DIM * b);
    for (PetscInt d = 0; d < dim; d++) force[dim * to + d] += sum[d];
  }
  PetscCall(PetscFree(row));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, force, (PetscMPIInt)(count * dim), MPIU_REAL, MPIU_SUM, output->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}
