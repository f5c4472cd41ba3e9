/* The class Pressure: types, options, view. */
#include "pressure_impl.h"
#include <string.h>

#define MATRIX_TYPES                                                                                                   \
  "shell aij aijperm aijsell aijcrl baij sbaij sell dense is hypre" /* types that the assembled matrix can have */

#define DEFAULT_RELAXATION_TIME 1e-3 /* s, if neither the user nor the stepper chooses */
#define REGULARIZATION          2    /* see gradient.c */

static PetscFunctionList SourceList = NULL, ClosureList = NULL, GradientList = NULL;

static PetscErrorCode PressureFinalizePackage(void)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListDestroy(&SourceList));
  PetscCall(PetscFunctionListDestroy(&ClosureList));
  PetscCall(PetscFunctionListDestroy(&GradientList));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PressureRegisterAll(void)
{
  PetscFunctionBegin;
  if (SourceList) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscRegisterFinalize(PressureFinalizePackage));
  PetscCall(PCTwoLevelRegister());
  PetscCall(PetscFunctionListAdd(&SourceList, SOURCE_DENSITY, SourceDensity));
  PetscCall(PetscFunctionListAdd(&SourceList, SOURCE_DIVERGENCE, SourceDivergence));
  PetscCall(PetscFunctionListAdd(&ClosureList, CLOSURE_DOUBLED, ClosureDoubled));
  PetscCall(PetscFunctionListAdd(&ClosureList, CLOSURE_FULL, ClosureFull));
  PetscCall(PetscFunctionListAdd(&GradientList, GRADIENT_SYMMETRIC, GradientSymmetric));
  PetscCall(PetscFunctionListAdd(&GradientList, GRADIENT_CORRECTED, GradientCorrected));
  PetscCall(PetscFunctionListAdd(&GradientList, GRADIENT_CONSERVED, GradientConserved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureCreate(Cloud cloud, Pressure *pressure)
{
  Pressure p;

  PetscFunctionBegin;
  PetscCall(PressureRegisterAll());
  PetscCall(PetscNew(&p));
  p->cloud           = cloud;
  p->kept            = KEPT_NONE;
  p->relaxation_time = DEFAULT_RELAXATION_TIME;
  p->repair          = 1;
  p->regularization  = REGULARIZATION;
  PetscCall(PressureSetTypes(p, SOURCE_DIVERGENCE, CLOSURE_FULL, GRADIENT_SYMMETRIC, PETSC_FALSE));
  *pressure = p;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureSetTypes(Pressure pressure, const char source[], const char closure[], const char gradient[],
                                PetscBool summed)
{
  PetscFunctionBegin;
  PetscCall(PetscStrncpy(pressure->source_type, source, sizeof(pressure->source_type)));
  PetscCall(PetscStrncpy(pressure->closure_type, closure, sizeof(pressure->closure_type)));
  PetscCall(PetscStrncpy(pressure->gradient_type, gradient, sizeof(pressure->gradient_type)));
  PetscCall(PetscFunctionListFind(SourceList, source, &pressure->source));
  PetscCall(PetscFunctionListFind(ClosureList, closure, &pressure->closure));
  PetscCall(PetscFunctionListFind(GradientList, gradient, &pressure->gradient));
  PetscCheckUser(pressure->source, pressure->cloud->comm,
                 "-pressure_source %s does not exist; choose from " SOURCE_DENSITY " and " SOURCE_DIVERGENCE, source);
  PetscCheckUser(pressure->closure, pressure->cloud->comm,
                 "-pressure_closure %s does not exist; choose from " CLOSURE_DOUBLED " and " CLOSURE_FULL, closure);
  PetscCheckUser(pressure->gradient, pressure->cloud->comm,
                 "-pressure_gradient %s does not exist; choose from " GRADIENT_SYMMETRIC ", " GRADIENT_CORRECTED
                 " and " GRADIENT_CONSERVED,
                 gradient);
  pressure->summed = summed;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureSetRelaxationTime(Pressure pressure, PetscReal time)
{
  PetscFunctionBegin;
  if (pressure->relaxation_option == 0) pressure->relaxation_time = time;
  PetscFunctionReturn(PETSC_SUCCESS);
}

void PressureSetRepair(Pressure pressure, PetscReal share)
{
  pressure->repair = share;
}

PetscReal PressureRelaxationTime(Pressure pressure)
{
  return pressure->relaxation_time;
}

/* Reads the types, and by which density the operators divide. Call it between PetscOptionsBegin and PetscOptionsEnd. */
static PetscErrorCode ReadTypes(Pressure pressure, OptionItems PetscOptionsObject)
{
  const char *const choices[] = {"rest", "summed"};
  char              source[TYPE_LENGTH], closure[TYPE_LENGTH], gradient[TYPE_LENGTH];
  PetscInt          choice = pressure->summed;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(source, pressure->source_type, sizeof(source)));
  PetscCall(PetscStrncpy(closure, pressure->closure_type, sizeof(closure)));
  PetscCall(PetscStrncpy(gradient, pressure->gradient_type, sizeof(gradient)));
  PetscCall(PetscOptionsFList("-pressure_source", "what the pressure must remove", "PressureSetTypes", SourceList,
                              source, source, sizeof(source), NULL));
  PetscCall(PetscOptionsFList("-pressure_closure", "how the free surface closes the equation", "PressureSetTypes",
                              ClosureList, closure, closure, sizeof(closure), NULL));
  PetscCall(PetscOptionsFList("-pressure_gradient", "form of the pressure gradient", "PressureSetTypes", GradientList,
                              gradient, gradient, sizeof(gradient), NULL));
  PetscCall(PetscOptionsEList("-pressure_density", "density by which the operators divide", "PressureSetTypes", choices,
                              2, choices[choice], &choice, NULL));
  PetscCall(PressureSetTypes(pressure, source, closure, gradient, (PetscBool)choice));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Call it between PetscOptionsBegin and PetscOptionsEnd, like ReadTypes. */
static PetscErrorCode ReadNumbers(Pressure p, OptionItems PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(OptionReal("-pressure_regularization",
                       "background pressure of the corrected gradient that spreads particles, over h |grad p| (1)",
                       "[0, inf)", &p->regularization));
  PetscCall(
    OptionReal("-pressure_relaxation_time",
               "time in which the divergence source corrects density errors (s); 0: from the scene's velocity and h",
               "[0, inf)", &p->relaxation_option));
  PetscCall(PetscOptionsBool("-pressure_wall_suction",
                             "the density source of walls may be negative, as printed: walls may pull",
                             "PressureSetFromOptions", p->wall_suction, &p->wall_suction, NULL));
  PetscCall(OptionInt(
    "-pressure_rebuild_interval",
    "steps after which the preconditioner is rebuilt (1); 0: 10 for twolevel, jacobi and none, 50 for all others",
    "[0, inf)", &p->rebuild_interval));
  PetscCall(OptionReal("-pressure_density_tolerance",
                       "largest relative density error that the solver may leave in a step (1); 0: PETSc's own test, "
                       "-ksp_rtol and the others",
                       "[0, inf)", &p->density_tolerance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses types that the assembled matrix cannot have. A type for one or for many ranks, seqaij or mpiaij, becomes the
   type for both, aij. */
static PetscErrorCode CheckMatrixType(Pressure pressure)
{
  char      *type = pressure->mat_type;
  PetscToken token;
  char      *word;
  PetscBool  good = (PetscBool)!type[0];

  PetscFunctionBegin;
  if (!strncmp(type, "seq", 3) || !strncmp(type, "mpi", 3)) memmove(type, type + 3, strlen(type + 3) + 1);
  PetscCall(PetscTokenCreate(MATRIX_TYPES, ' ', &token));
  PetscCall(PetscTokenFind(token, &word));
  while (word && !good) {
    PetscCall(PetscStrcmp(word, type, &good));
    PetscCall(PetscTokenFind(token, &word));
  }
  PetscCall(PetscTokenDestroy(&token));
  PetscCheckUser(good, pressure->cloud->comm,
                 "-mat_type %s: the pressure matrix cannot have this type; choose from " MATRIX_TYPES, type);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureSetFromOptions(Pressure pressure)
{
  Cloud cloud = pressure->cloud;

  PetscFunctionBegin;
  PetscOptionsBegin(cloud->comm, NULL, "Pressure projection", "Pressure");
  PetscCall(ReadTypes(pressure, PetscOptionsObject));
  PetscCall(ReadNumbers(pressure, PetscOptionsObject));
  PetscCall(PetscOptionsString("-mat_type",
                               "PETSc type of the pressure matrix: " MATRIX_TYPES
                               "; default: shell, the sum of pairs without a matrix, if the preconditioner needs no "
                               "entries, else aij",
                               "MatSetType", pressure->mat_type, pressure->mat_type, sizeof(pressure->mat_type), NULL));
  PetscOptionsEnd();
  PetscCall(CheckMatrixType(pressure));
  if (pressure->relaxation_option > 0) pressure->relaxation_time = pressure->relaxation_option;
  PressureLattice(cloud, &pressure->lattice_diagonal, &pressure->lattice_sum);
  pressure->row_scale = 1 / (cloud->domain->volume * BodyMaterial(SceneBody(cloud->scene, 0))->density);
  KernelHalfSpace(cloud->kernel, 0, &pressure->surface_plane, NULL);
  KernelSurfaceTable(cloud->kernel, SURFACE_TABLE, pressure->surface_fraction);
  SurfaceLattice(pressure);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool PressureGradientCorrected(Pressure pressure)
{
  return (PetscBool)(pressure->gradient == GradientCorrected);
}

PetscErrorCode PressureView(Pressure pressure, PetscViewer viewer)
{
  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "Pressure: source %s, closure %s, gradient %s, %s density",
                                   pressure->source_type, pressure->closure_type, pressure->gradient_type,
                                   pressure->summed ? "summed" : "rest"));
  if (pressure->source == SourceDivergence)
    PetscCall(PetscViewerASCIIPrintf(viewer, ", relaxation time %g s", (double)pressure->relaxation_time));
  PetscCall(PetscViewerASCIIPrintf(viewer, "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureDestroy(Pressure *pressure)
{
  Pressure p = *pressure;

  PetscFunctionBegin;
  if (!p) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PressureReset(p));
  for (PetscInt s = 0; s < 2; s++) PetscCall(MatrixStoreReset(&p->store[s]));
  PetscCall(PetscFree(p->closure_diagonal));
  PetscCall(PetscFree(p->pair_diagonal));
  PetscCall(PetscFree(p->pair_weight));
  PetscCall(PetscFree(p->weight_sum));
  PetscCall(PetscFree(p->parent_row));
  PetscCall(ColumnsReset(&p->columns));
  PetscCall(PetscFree(*pressure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureAddLowRank(Pressure pressure, const LowRank *term, void *context)
{
  PetscFunctionBegin;
  PetscCheck(pressure->low_ranks < LOW_RANKS_MOST, pressure->cloud->comm, PETSC_ERR_PLIB, "Too many terms of low rank");
  pressure->low_rank[pressure->low_ranks].term      = term;
  pressure->low_rank[pressure->low_ranks++].context = context;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt PressureRow(Pressure pressure, PetscInt a)
{
  const PetscInt row = a < pressure->cloud->n_rows ? a : ParentRow(pressure, a);

  return pressure->pair_diagonal[row] == 0 ? -1 : row;
}

PetscReal PressureRowScale(Pressure pressure)
{
  return pressure->row_scale;
}
