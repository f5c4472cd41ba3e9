/* Checks each particle of a checkpoint by itself before it is used. The seal shows that the file is as it was written:
   no particle is missing or there twice. */
#include "output_impl.h"

#define FLAW_LENGTH   256
#define WALL_MARGIN   2 /* in supports plus coarse spacings: dummies of walls are nearer to the box */
#define LIQUID_MARGIN 2 /* spacings: a negative -wall_guard lets liquid one spacing behind a wall */

/* Keeps the first flaw that is found. */
static void Note(char flaw[FLAW_LENGTH], const char format[], ...)
{
  va_list arguments;

  if (flaw[0]) return;
  va_start(arguments, format);
  (void)vsnprintf(flaw, FLAW_LENGTH, format, arguments);
  va_end(arguments);
}

/* Refuses the file on all ranks with what the first of them found. */
static PetscErrorCode Refuse(Output output, const char file[], char flaw[FLAW_LENGTH])
{
  PetscMPIInt own = flaw[0] ? output->rank : output->size, first;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(&own, &first, 1, MPI_INT, MPI_MIN, output->comm));
  if (first == output->size) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Bcast(flaw, FLAW_LENGTH, MPI_CHAR, first, output->comm));
  PetscCheckUser(PETSC_FALSE, output->comm, "The checkpoint %s cannot be used: %s; restart from another one.", file,
                 flaw);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void CheckReals(const ParticleArrays *arrays, PetscInt a, char flaw[FLAW_LENGTH])
{
  const int id = (int)arrays->integer[INT_ID][a];

  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
    for (PetscInt c = 0; arrays->real[f] && c < Fields[f].width; c++)
      if (PetscIsInfOrNanReal(arrays->real[f][Fields[f].width * a + c]))
        Note(flaw, "the %s of particle %d is not finite", Fields[f].name, id);
  if (arrays->real[FIELD_DENSITY][a] < 0) Note(flaw, "the density of particle %d is negative", id);
  if (arrays->real[FIELD_VISCOSITY] && arrays->real[FIELD_VISCOSITY][a] < 0)
    Note(flaw, "the viscosity of particle %d is negative", id);
  if (arrays->real[FIELD_VOLUME] && arrays->real[FIELD_VOLUME][a] <= 0) Note(flaw, "particle %d has no volume", id);
  if (arrays->real[FIELD_SIZE] && arrays->real[FIELD_SIZE][a] <= 0) Note(flaw, "particle %d has no size", id);
}

static void CheckKind(Scene scene, const ParticleArrays *arrays, PetscInt a, char flaw[FLAW_LENGTH])
{
  const PetscInt id = arrays->integer[INT_ID][a], body = arrays->integer[INT_BODY][a],
                 layer = arrays->integer[INT_LAYER][a], surface = arrays->integer[INT_SURFACE][a];
  const PetscBool known = (PetscBool)(body < SceneCount(scene) && body > BODY_SOLID - SceneSolidCount(scene));

  if (id < 0) Note(flaw, "a particle has the id %d", (int)id);
  if (!known || layer < 0 || (layer == 0) != (body >= 0))
    Note(flaw, "particle %d is of body %d, layer %d, which this scene does not have", (int)id, (int)body, (int)layer);
  if (surface < 0 || surface > 2)
    Note(flaw, "particle %d has the mark %d of the free surface, not 0, 1 or 2", (int)id, (int)surface);
}

static void CheckPlace(Cloud cloud, const ParticleArrays *arrays, PetscInt a, char flaw[FLAW_LENGTH])
{
  const Domain     domain = cloud->domain;
  const PetscReal *x = arrays->real[FIELD_POSITION] + DIM * a, *v = arrays->real[FIELD_VELOCITY] + DIM * a;
  const PetscBool  liquid = (PetscBool)(arrays->integer[INT_LAYER][a] == 0);
  const PetscReal  wall   = WALL_MARGIN * (cloud->size_most * KernelSupport(cloud->kernel) + domain->spacing_coarse);

  for (PetscInt d = 0; d < DIM; d++) {
    const PetscBool real   = (PetscBool)(d < domain->dim);
    const PetscReal margin = !liquid ? wall : domain->face[d][0] == FACE_PERIODIC ? 0 : LIQUID_MARGIN * domain->spacing;

    if (real ? x[d] < domain->lower[d] - margin || x[d] > domain->upper[d] + margin : x[d] != 0 || v[d] != 0)
      Note(flaw, "particle %d is out of the box: %c = %g m", (int)arrays->integer[INT_ID][a], "xyz"[d], (double)x[d]);
  }
}

PetscErrorCode RestartCheckParticles(Output output, const char file[])
{
  const Cloud    cloud = output->cloud;
  ParticleArrays arrays;
  char           flaw[FLAW_LENGTH] = "";

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n && !flaw[0]; a++) {
    CheckReals(&arrays, a, flaw);
    CheckKind(cloud->scene, &arrays, a, flaw);
    CheckPlace(cloud, &arrays, a, flaw);
  }
  PetscCall(Refuse(output, file, flaw));
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}
