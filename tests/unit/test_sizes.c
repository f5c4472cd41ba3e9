/* Liquid whose particles have twice the spacing is liquid of twice that spacing, in all that a step does: what forgets
   the size of a particle differs. A blob of disordered liquid on a mirror, whose weight is carried. On one rank. */
#include "../../src/stepper/stepper_impl.h"
#include "check.h"
#include "setup.h"

#define BLOB                                                                                                           \
  "-dimension 2 -box_lower -60,0 -box_upper 60,90 -box_xmax wall -box_ymin symmetry -gravity 0,-10 -bodies a "         \
  "-a_tension 20 "                                                                                                     \
  "-a_viscosity 5 -time_step 0.02 -ksp_rtol 1e-12 -fine c -c_lower -60,80 -c_upper -50,90 "
#define FINE   BLOB "-spacing 2 -spacing_coarse 4 -pressure_relaxation_time 1 "
#define COARSE BLOB "-spacing 1 -spacing_coarse 2 -pressure_relaxation_time 0.5 " /* in proportion to the size */
#define ACROSS 14
#define UP     12
#define JITTER 0.4 /* m, up to */

/* What one step gives, sorted by id. */
typedef struct {
  PetscReal velocity[DIM * ACROSS * UP], place[DIM * ACROSS * UP], pressure[ACROSS * UP], depth[ACROSS * UP], guarded;
  PetscInt  surface[ACROSS * UP], piece[ACROSS * UP];
} Fate;

static PetscErrorCode Fill(Setup *s)
{
  PetscRandom    random;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(PetscRandomCreate(PETSC_COMM_SELF, &random));
  PetscCall(PetscRandomSetSeed(random, 1));
  PetscCall(PetscRandomSeed(random));
  PetscCall(ParticlesAppend(s->particles, ACROSS * UP));
  PetscCall(ParticlesOpen(s->particles, &arrays));
  for (PetscInt a = 0; a < ACROSS * UP; a++) {
    const PetscReal middle[DIM] = {2 * (a % ACROSS) - ACROSS + (a % ACROSS >= ACROSS / 2 ? 3.5 : 0),
                                   2 * (a / ACROSS) + 1, 0};
    PetscReal      *x           = arrays.real[FIELD_POSITION] + DIM * a;

    for (PetscInt d = 0; d < DIM; d++) {
      PetscReal shift;

      PetscCall(PetscRandomGetValueReal(random, &shift));
      x[d]                                     = middle[d] + (d < 2 ? JITTER * (2 * shift - 1) : 0);
      arrays.real[FIELD_VELOCITY][DIM * a + d] = d == 2 ? 0 : 0.1 * (d ? -x[1] : x[0]);
    }
    arrays.integer[INT_ID][a] = arrays.integer[INT_PARENT][a] = a;
    arrays.real[FIELD_CARRIED][a]                             = 1;
    arrays.real[FIELD_VOLUME][a]                              = 4;
  }
  PetscCall(ParticlesClose(s->particles, &arrays));
  PetscCall(PetscRandomDestroy(&random));
  PetscCall(CloudResync(s->cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Run(const char options[], Fate *fate)
{
  StepTrial trial = {0};
  PetscInt *parent;
  Stepper   stepper;
  Setup     s;
  Cloud     cloud;

  PetscFunctionBegin;
  PetscCall(SetupOpen(options, &s));
  cloud = s.cloud;
  PetscCall(Fill(&s));
  PetscCall(PressureCreate(cloud, &s.pressure));
  PetscCall(StepperCreate(cloud, s.tension, s.pressure, &stepper));
  PetscCall(StepperSetFromOptions(stepper));
  PetscCall(stepper->ops->step(stepper, 0.02, &trial));
  PetscCall(PetscMalloc1(cloud->n_total, &parent));
  OperatorsConnect(cloud, 1.5 * s.domain->spacing, parent);
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscInt id = cloud->integer[INT_ID][a];

    PetscCall(PetscArraycpy(fate->velocity + DIM * id, cloud->field[FIELD_VELOCITY_NEW] + DIM * a, DIM));
    PetscCall(PetscArraycpy(fate->place + DIM * id, cloud->field[FIELD_POSITION_NEW] + DIM * a, DIM));
    fate->pressure[id] = cloud->field[FIELD_PRESSURE][a];
    fate->surface[id]  = cloud->integer[INT_SURFACE][a];
    fate->depth[id]    = PressureDepth(s.pressure, a);
    fate->piece[id]    = cloud->integer[INT_ID][parent[a] < cloud->n_fluid ? parent[a] : a];
  }
  PetscCall(PetscFree(parent));
  cloud->field[FIELD_POSITION_NEW][0] = s.domain->upper[0] - 0.1; /* any of them, too close to a wall */
  PetscCall(
    WallGuard(stepper, 0.5 * s.domain->spacing, cloud->field[FIELD_POSITION_NEW], cloud->field[FIELD_VELOCITY_NEW]));
  fate->guarded = s.domain->upper[0] - cloud->field[FIELD_POSITION_NEW][0];
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest difference over the largest value. */
static PetscReal Apart(PetscInt n, const PetscReal a[], const PetscReal b[])
{
  PetscReal most = 0, apart = 0;

  for (PetscInt k = 0; k < n; k++) {
    most  = PetscMax(most, PetscAbsReal(a[k]));
    apart = PetscMax(apart, PetscAbsReal(a[k] - b[k]));
  }
  return apart / most;
}

int main(int argc, char **argv)
{
  static Fate fine, coarse;
  PetscInt    flags = 0, pieces = 0, on_surface = 0;

  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(Run(FINE, &fine));
  PetscCall(Run(COARSE, &coarse));
  for (PetscInt k = 0; k < ACROSS * UP; k++) {
    on_surface += fine.surface[k] == 1;
    flags += fine.surface[k] != coarse.surface[k];
    pieces += fine.piece[k] != coarse.piece[k];
  }
  CHECK(on_surface > 20, "a_blob_with_a_surface");
  CHECK_CLOSE(flags, 0, 0, "surface_of_another_size");
  CHECK_CLOSE(pieces, 0, 0, "pieces_of_another_size");
  CHECK_CLOSE(Apart(ACROSS * UP, fine.depth, coarse.depth), 0, 1e-5, "depth_of_another_size");
  CHECK_CLOSE(Apart(ACROSS * UP, fine.pressure, coarse.pressure), 0, 1e-4, "pressure_of_another_size");
  CHECK_CLOSE(Apart(DIM * ACROSS * UP, fine.velocity, coarse.velocity), 0, 1e-4, "velocity_of_another_size");
  CHECK_CLOSE(Apart(DIM * ACROSS * UP, fine.place, coarse.place), 0, 1e-5, "places_of_another_size");
  CHECK_CLOSE(fine.guarded, 1, 1e-9, "half_a_spacing_from_a_wall");
  CHECK_CLOSE(coarse.guarded, 1, 1e-9, "guard_of_another_size");
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
