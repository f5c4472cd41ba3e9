/* Rings of a checkpoint for a scene in space, whose liquid they become: see PackingTurn. */
#include "output_impl.h"
#include <stdio.h>
#include <stdlib.h>

#define FLAW 512 /* characters */

PetscBool RestartTurns(Output output, const char stored[])
{
  return (PetscBool)(output->cloud->domain->dim == 3 && strstr(stored, "-dimension = axisymmetric\n") != NULL);
}

/* Whether a line of CloudIdentity says who the liquid is and what it weighs: the same as rings and in space. */
static PetscBool OfLiquid(const char line[], size_t length)
{
  static const char density[] = "_density =";
  const char       *found     = strstr(line, density);

  return (PetscBool)(!strncmp(line, "body ", 5) || (found && found < line + length));
}

/* Finds the first line of 'text' about the liquid that 'stored' lacks. */
static void CompareLiquid(const char text[], const char stored[], char flaw[FLAW])
{
  for (const char *line = text; *line && !flaw[0]; line += strcspn(line, "\n") + 1) {
    const size_t length = strcspn(line, "\n");
    char         wanted[FLAW];

    (void)snprintf(wanted, sizeof(wanted), "\n%.*s\n", (int)length, line);
    if (OfLiquid(line, length) && !strstr(stored, wanted))
      (void)snprintf(flaw, FLAW, "its rings are of other liquid, without %.*s", (int)PetscMin(length, FLAW / 2), line);
  }
}

/* Rings that end at the outer face of their box cannot fill a wider one. */
static void CompareBoxes(Domain domain, const ParticleArrays *rings, const char stored[], char flaw[FLAW])
{
  static const char name[] = "\n-box_upper = ";
  const char       *found  = strstr(stored, name);
  const double      outer  = found ? atof(found + strlen(name)) : 0;
  PetscReal         widest = 0, corner = 0;

  for (PetscInt a = 0; a < rings->n; a++) {
    const PetscReal r = rings->real[FIELD_POSITION][DIM * a];

    widest = PetscMax(widest, r + PetscSqrtReal(rings->real[FIELD_VOLUME][a] / (2 * PETSC_PI * r)));
  }
  for (PetscInt d = 0; d < 2; d++)
    corner += PetscSqr(PetscMax(PetscAbsReal(domain->lower[d]), PetscAbsReal(domain->upper[d])));
  corner = PetscSqrtReal(corner);
  if (widest >= outer && outer < corner * (1 - POINT_TOLERANCE))
    (void)snprintf(flaw, FLAW,
                   "its rings reach to the side of their box, %g m from the axis, and the corners of this box are %g m "
                   "from x = y = 0: compute the rings in a box at least as wide",
                   outer, (double)corner);
}

/* Finds numbers that no run of rings leaves. */
static void CheckRings(Scene scene, const ParticleArrays *rings, char flaw[FLAW])
{
  for (PetscInt a = 0; a < rings->n && !flaw[0]; a++) {
    PetscBool good = (PetscBool)(rings->real[FIELD_POSITION][DIM * a] > 0 && rings->real[FIELD_VOLUME][a] > 0 &&
                                 rings->integer[INT_BODY][a] < SceneCount(scene));

    for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
      for (PetscInt i = 0; rings->real[f] && i < Fields[f].width; i++)
        good = (PetscBool)(good && !PetscIsInfOrNanReal(rings->real[f][(size_t)Fields[f].width * (size_t)a + i]));
    if (!good) (void)snprintf(flaw, FLAW, "ring %d of it cannot be", (int)a);
  }
}

/* Takes the dummy particles of walls out of the rows. */
static void KeepLiquid(ParticleArrays *rings)
{
  PetscInt n = 0;

  for (PetscInt a = 0; a < rings->n; a++) {
    if (rings->integer[INT_BODY][a] < 0) continue;
    rings->integer[INT_BODY][n] = rings->integer[INT_BODY][a];
    for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
      for (PetscInt i = 0; rings->real[f] && i < Fields[f].width; i++)
        rings->real[f][(size_t)Fields[f].width * (size_t)n + i] =
          rings->real[f][(size_t)Fields[f].width * (size_t)a + i];
    n++;
  }
  rings->n = n;
}

PetscErrorCode RestartRings(Output output, const char file[], const char stored[], PetscInt particles,
                            ParticleArrays *rings)
{
  const size_t row  = (DIM + DIM + 1) * sizeof(double) + sizeof(int32_t); /* bytes, of what all have */
  Rows         rows = {.n = particles, .start = 0, .total = particles, .width = 1};
  H5File       h5;
  PetscBool    failed, whole;
  char         flaw[FLAW] = "", *text;

  PetscFunctionBegin;
  PetscCall(H5FileOpen(output->comm, file, &h5));
  whole    = (PetscBool)(H5FileHolds(&h5, particles, row) && H5FileHas(&h5, Fields[FIELD_VOLUME].name));
  rings->n = whole ? particles : 0;
  rows.n = rows.total = rings->n;
  PetscCall(PetscMalloc1(rings->n + 1, &rings->integer[INT_BODY]));
  if (whole) PetscCall(H5FileRead(&h5, IntFieldNames[INT_BODY], H5FILE_INT, &rows, rings->integer[INT_BODY]));
  for (PetscInt f = 0; f < FIELD_STORED_COUNT && whole; f++) {
    if (!H5FileHas(&h5, Fields[f].name)) continue;
    rows.width = Fields[f].width;
    PetscCall(PetscMalloc1((size_t)rows.width * (size_t)rings->n + 1, &rings->real[f]));
    PetscCall(H5FileRead(&h5, Fields[f].name, H5T_NATIVE_DOUBLE, &rows, rings->real[f]));
  }
  whole = (PetscBool)(whole && !h5.external);
  PetscCall(H5FileClose(&h5, &failed));
  PetscCheckUser(whole && !failed, output->comm,
                 "The checkpoint %s is truncated or damaged; restart from the one before it.", file);
  KeepLiquid(rings);
  PetscCall(CloudIdentity(output->cloud, &text));
  if (!output->rank) {
    CheckRings(output->cloud->scene, rings, flaw);
    if (!flaw[0]) CompareLiquid(text, stored, flaw);
    if (!flaw[0]) CompareBoxes(output->cloud->domain, rings, stored, flaw);
  }
  free(text);
  PetscCallMPI(MPI_Bcast(flaw, FLAW, MPI_CHAR, 0, output->comm));
  PetscCheckUser(!flaw[0], output->comm, "The checkpoint %s cannot be turned into this scene: %s.", file, flaw);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputRingsDestroy(ParticleArrays *rings)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++) PetscCall(PetscFree(rings->real[f]));
  PetscCall(PetscFree(rings->integer[INT_BODY]));
  rings->n = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
