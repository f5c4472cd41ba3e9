/* A cloud of particles from a text of options, for the tests of what works on one. */
#ifndef ISPH_SETUP_H
#define ISPH_SETUP_H

#include "../../src/packing/packing_impl.h"
#include "../../src/pressure/pressure.h"
#include "../../src/stepper/stepper.h"
#include "../../src/tension/tension.h"
#include "../../src/operators/operators.h"

typedef struct {
  Domain    domain;
  Kernel    kernel;
  Scene     scene;
  Tension   tension;
  Particles particles;
  Cloud     cloud;
  Pressure  pressure; /* NULL until asked for */
  /* of SetupPack */
  PackingReport report;
  PetscInt      global; /* particles of all ranks */
} Setup;

/* SetupOpenWith - everything below the particles, as the program does it; the swarm is empty. more: properties besides
   those of the program, as those of an edge; NULL: none. SetupOpenOn - without. SetupOpen - on all ranks. Nothing evens
   a packing out there, so its jitter is half of the default unless the options name one. */
static inline PetscErrorCode SetupOpenWith(MPI_Comm comm, const char options[], const Property more[], Setup *s)
{
  PetscFunctionBegin;
  PetscCall(PetscMemzero(s, sizeof(*s)));
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscOptionsInsertString(NULL, options));
  PetscCall(DomainCreate(comm, &s->domain));
  PetscCall(StepperProperties(s->domain));
  for (; more && more->rows; more++) PetscCall(DomainAddProperty(s->domain, more));
  PetscCall(DomainSetFromOptions(s->domain));
  PetscCall(KernelCreate(comm, s->domain->dim, &s->kernel));
  PetscCall(KernelSetFromOptions(s->kernel, s->domain->spacing));
  PetscCall(SceneCreate(s->domain, &s->scene));
  PetscCall(SceneSetFromOptions(s->scene));
  PetscCall(TensionCreate(s->domain, s->scene, s->kernel, &s->tension));
  PetscCall(TensionSetFromOptions(s->tension));
  PetscCall(StepperParticles(s->scene, s->tension, &s->particles));
  PetscCall(CloudCreate(s->domain, s->scene, s->kernel, s->particles,
                        PetscMax(KernelSupport(s->kernel), TensionReach(s->tension)), &s->cloud));
  PetscCall(CloudSetFromOptions(s->cloud));
  PetscCall(DomainSetUp(s->domain, s->cloud->size_most * s->cloud->reach + s->cloud->slack));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscErrorCode SetupOpenOn(MPI_Comm comm, const char options[], Setup *s)
{
  PetscFunctionBegin;
  PetscCall(SetupOpenWith(comm, options, NULL, s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscErrorCode SetupOpen(const char options[], Setup *s)
{
  char all[4096];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(all, sizeof(all), "-packing_jitter 0.1 %s", options));
  PetscCall(SetupOpenOn(PETSC_COMM_WORLD, all, s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* SetupPackIn - fills the bodies and the walls of what is open by the packing that the options name. SetupPackOn,
   SetupPack - opens and fills. */
static inline PetscErrorCode SetupPackIn(Setup *s)
{
  Packing packing;

  PetscFunctionBegin;
  PetscCall(PackingCreate(s->cloud, &packing));
  PetscCall(PackingSetFromOptions(packing));
  PetscCall(PackingRun(packing, &s->report));
  PetscCall(PackingDestroy(&packing));
  PetscCall(ParticlesGlobalSize(s->particles, &s->global));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscErrorCode SetupPackOn(MPI_Comm comm, const char options[], Setup *s)
{
  PetscFunctionBegin;
  PetscCall(SetupOpenOn(comm, options, s));
  PetscCall(SetupPackIn(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscErrorCode SetupPack(const char options[], Setup *s)
{
  PetscFunctionBegin;
  PetscCall(SetupOpen(options, s));
  PetscCall(SetupPackIn(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* SetupFill - n fluid particles of the first body and of size 1 at x ([n][3], m, the same on every rank), ids 0 .. n-1,
   and 'layers' layers of wall particles behind them and in solids. */
static inline PetscErrorCode SetupFill(const char options[], PetscInt n, const PetscReal x[], PetscInt layers, Setup *s)
{
  ParticleArrays arrays;
  PetscMPIInt    rank;
  PetscInt       walls, solids;
  Dummies        dummies = {.layers = layers};

  PetscFunctionBegin;
  PetscCall(SetupOpen(options, s));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(ParticlesAppend(s->particles, rank ? 0 : n));
  PetscCall(ParticlesOpen(s->particles, &arrays));
  PetscCall(PetscArraycpy(arrays.real[FIELD_POSITION], x, DIM * arrays.n));
  for (PetscInt a = 0; a < arrays.n; a++) {
    arrays.integer[INT_ID][a] = arrays.integer[INT_PARENT][a] = a;
    if (arrays.real[FIELD_SIZE]) arrays.real[FIELD_SIZE][a] = 1;
    if (arrays.real[FIELD_VOLUME])
      arrays.real[FIELD_VOLUME][a] = s->domain->volume * DomainRingLength(s->domain, x + DIM * a, 1);
  }
  PetscCall(ParticlesClose(s->particles, &arrays));
  if (layers) {
    dummies.cloud = s->cloud;
    PetscCall(SamplesAppend(s->particles, s->domain, WallVisit, &dummies, n, &walls));
    PetscCall(SamplesAppend(s->particles, s->domain, SolidVisit, &dummies, n + walls, &solids));
  }
  PetscCall(CloudResync(s->cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* SetupMoments - density, moments, surface flags, and the ghosts' densities. */
static inline PetscErrorCode SetupMoments(Setup *s)
{
  PetscFunctionBegin;
  PetscCall(OperatorsMoments(s->cloud, NULL));
  PetscCall(CloudUpdate(s->cloud, FIELD_DENSITY));
  PetscCall(OperatorsFreeSurface(s->cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* SetupDivergence - of FIELD_VELOCITY_STAR, whose ghosts are updated: what the divergence source reads. */
static inline PetscErrorCode SetupDivergence(Setup *s)
{
  PetscFunctionBegin;
  PetscCall(CloudUpdate(s->cloud, FIELD_VELOCITY_STAR));
  PetscCall(OperatorsDivergence(s->cloud, s->cloud->field[FIELD_VELOCITY_STAR], PETSC_TRUE, 0,
                                s->cloud->field[FIELD_DIVERGENCE], s->cloud->field[FIELD_VELOCITY_GRADIENT],
                                s->cloud->field[FIELD_VELOCITY_JUMP]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscErrorCode SetupClose(Setup *s)
{
  PetscFunctionBegin;
  if (s->pressure) PetscCall(PressureDestroy(&s->pressure));
  PetscCall(CloudDestroy(&s->cloud));
  PetscCall(ParticlesDestroy(&s->particles));
  PetscCall(TensionDestroy(&s->tension));
  PetscCall(SceneDestroy(&s->scene));
  PetscCall(KernelDestroy(&s->kernel));
  PetscCall(DomainDestroy(&s->domain));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* SetupSum, SetupMax - over all ranks. */
static inline PetscReal SetupSum(PetscReal value)
{
  (void)MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPIU_REAL, MPIU_SUM, PETSC_COMM_WORLD);
  return value;
}

static inline PetscReal SetupMax(PetscReal value)
{
  (void)MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPIU_REAL, MPIU_MAX, PETSC_COMM_WORLD);
  return value;
}

/* SetupTakenAlong - largest difference of the viscous term that OperatorsMoments takes along to that of
   OperatorsViscosity, which FIELD_ACCELERATION holds, over the largest of it. */
static inline PetscErrorCode SetupTakenAlong(Cloud cloud, const Viscosity *viscosity, PetscReal *difference)
{
  const PetscInt n    = DIM * cloud->n_fluid;
  PetscReal      most = 0, *own;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &own));
  PetscCall(PetscArraycpy(own, cloud->field[FIELD_ACCELERATION], n));
  PetscCall(OperatorsMoments(cloud, viscosity));
  PetscCall(CloudUpdate(cloud, FIELD_DENSITY));
  PetscCall(OperatorsViscosityRemainder(cloud, viscosity));
  *difference = 0;
  for (PetscInt k = 0; k < n; k++) {
    most        = PetscMax(most, PetscAbsReal(own[k]));
    *difference = PetscMax(*difference, PetscAbsReal(own[k] - cloud->field[FIELD_ACCELERATION][k]));
  }
  PetscCall(PetscFree(own));
  *difference = SetupMax(*difference) / SetupMax(most);
  PetscFunctionReturn(PETSC_SUCCESS);
}

#endif
