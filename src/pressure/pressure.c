/* The class Pressure: types, options, view. */
#include "pressure_impl.h"
#include <string.h>

#define MATRIX_TYPES                                                                                                   \
  "shell aij aijperm aijsell aijcrl baij sbaij sell dense is hypre" /* types that the assembled matrix can have */

#define DEFAULT_RELAXATION_TIME 1e-3 /* s, if neither the user nor the stepper chooses */
#define REGULARIZATION          2    /* see gradient.c */

static const SourceChoice   Density    = {{.name = SOURCE_DENSITY}, SourceDensity};
static const SourceChoice   Divergence = {{.name = SOURCE_DIVERGENCE}, SourceDivergence};
static const ClosureChoice  Doubled    = {{.name = CLOSURE_DOUBLED}, ClosureDoubled};
static const ClosureChoice  Full       = {{.name = CLOSURE_FULL}, ClosureFull};
static const GradientChoice Symmetric  = {{.name = GRADIENT_SYMMETRIC}, GradientSymmetric};
static const GradientChoice Corrected  = {{.name = GRADIENT_CORRECTED}, GradientCorrected};
static const GradientChoice Conserved  = {{.name = GRADIENT_CONSERVED}, GradientConserved};

static const Choice *const Sources[]   = {&Density.choice, &Divergence.choice, NULL};
static const Choice *const Closures[]  = {&Doubled.choice, &Full.choice, NULL};
static const Choice *const Gradients[] = {&Symmetric.choice, &Corrected.choice, &Conserved.choice, NULL};

PetscErrorCode PressureCreate(Cloud cloud, Pressure *pressure)
{
  Pressure p;

  PetscFunctionBegin;
  PetscCall(PCTwoLevelRegister());
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

/* Finds the functions of the types that the pressure names. */
static PetscErrorCode FindTypes(Pressure p)
{
  const MPI_Comm comm = p->cloud->comm;
  const Choice  *choice;

  PetscFunctionBegin;
  PetscCall(ChoiceFind(comm, Sources, "-pressure_source", p->source_type, &choice));
  p->source = ((const SourceChoice *)choice)->apply;
  PetscCall(ChoiceFind(comm, Closures, "-pressure_closure", p->closure_type, &choice));
  p->closure = ((const ClosureChoice *)choice)->apply;
  PetscCall(ChoiceFind(comm, Gradients, "-pressure_gradient", p->gradient_type, &choice));
  p->gradient = ((const GradientChoice *)choice)->apply;
  p->balanced = (PetscBool)(p->gradient == GradientCorrected);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureSetTypes(Pressure pressure, const char source[], const char closure[], const char gradient[],
                                PetscBool summed)
{
  PetscFunctionBegin;
  PetscCall(PetscStrncpy(pressure->source_type, source, sizeof(pressure->source_type)));
  PetscCall(PetscStrncpy(pressure->closure_type, closure, sizeof(pressure->closure_type)));
  PetscCall(PetscStrncpy(pressure->gradient_type, gradient, sizeof(pressure->gradient_type)));
  PetscCall(FindTypes(pressure));
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

static const OptionRow types[] = {
  {"-pressure_source", "What the pressure must remove", NULL, NULL, ROW_CHOICE,
   offsetof(struct _p_Pressure, source_type), .choices = Sources},
  {"-pressure_closure", "How the free surface closes the equation", NULL, NULL, ROW_CHOICE,
   offsetof(struct _p_Pressure, closure_type), .choices = Closures},
  {"-pressure_gradient", "Form of the pressure gradient", NULL, NULL, ROW_CHOICE,
   offsetof(struct _p_Pressure, gradient_type), .choices = Gradients},
  {.name = NULL},
};

static const OptionRow numbers[] = {
  {"-pressure_regularization", "Background pressure of the corrected gradient that spreads particles, over h |grad p|",
   "1", "[0, inf)", ROW_REAL, offsetof(struct _p_Pressure, regularization)},
  {"-pressure_relaxation_time",
   "Time in which the divergence source corrects density errors; 0: 5 h/U of the scene, 25 h/U with -scheme "
   "weakly_compressible",
   "s", "[0, inf)", ROW_REAL, offsetof(struct _p_Pressure, relaxation_option)},
  {"-pressure_wall_suction", "Walls may pull by the density source, as printed", NULL, NULL, ROW_BOOL,
   offsetof(struct _p_Pressure, wall_suction)},
  {"-pressure_density_tolerance",
   "Largest relative density error that the solver may leave in a step; 0: PETSc's own test, -ksp_rtol and the others",
   "1", "[0, inf)", ROW_REAL, offsetof(struct _p_Pressure, density_tolerance)},
  {"-mat_type", "PETSc type of the pressure matrix: " MATRIX_TYPES, NULL, NULL, ROW_TEXT,
   offsetof(struct _p_Pressure, mat_type),
   .fallback = "shell, the sum of pairs without a matrix, if the preconditioner needs no entries, else aij"},
  {.name = NULL},
};

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
  PetscCall(OptionsRead(PetscOptionsObject, types, __func__, pressure));
  PetscCall(OptionsRead(PetscOptionsObject, numbers, __func__, pressure));
  PetscOptionsEnd();
  PetscCall(FindTypes(pressure));
  PetscCall(CheckMatrixType(pressure));
  if (pressure->relaxation_option > 0) pressure->relaxation_time = pressure->relaxation_option;
  PressureLattice(cloud, &pressure->lattice_diagonal, &pressure->lattice_sum);
  pressure->reference = BodyMaterial(SceneBody(cloud->scene, 0))->density;
  KernelHalfSpace(cloud->kernel, 0, &pressure->surface_plane, NULL);
  KernelSurfaceTable(cloud->kernel, SURFACE_TABLE, pressure->surface_fraction);
  SurfaceLattice(pressure);
  BalanceSetUp(pressure);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool PressureGradientCorrected(Pressure pressure)
{
  return pressure->balanced;
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
  PetscCall(PetscFree3(p->closure_diagonal, p->pair_diagonal, p->level_diagonal));
  PetscCall(PetscFree(p->pair_weight));
  PetscCall(PetscFree(p->weight_sum));
  PetscCall(PetscFree3(p->carried, p->place, p->load));
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

PetscErrorCode PressureLoad(Pressure pressure, PetscReal force[])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < pressure->low_ranks; k++)
    if (pressure->low_rank[k].term->load)
      PetscCall(pressure->low_rank[k].term->load(pressure->low_rank[k].context, pressure, force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureYield(Pressure pressure, const PetscReal force[], PetscReal acceleration[], PetscReal y[])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < pressure->low_ranks; k++)
    if (pressure->low_rank[k].term->yield)
      PetscCall(pressure->low_rank[k].term->yield(pressure->low_rank[k].context, pressure, force, acceleration, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool PressureYields(Pressure pressure)
{
  for (PetscInt k = 0; k < pressure->low_ranks; k++)
    if (pressure->low_rank[k].term->yield) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode PressureNumber(Pressure pressure)
{
  PetscFunctionBegin;
  PetscCall(RowsNumber(pressure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt PressureParent(Pressure pressure, PetscInt a)
{
  return a < pressure->cloud->n_rows ? a : ParentRow(pressure, a);
}

PetscInt PressureRow(Pressure pressure, PetscInt a)
{
  const PetscInt row = PressureParent(pressure, a);

  return pressure->pair_diagonal[row] == 0 ? -1 : row;
}

const PetscReal *PressureClosure(Pressure pressure)
{
  return pressure->closure_diagonal;
}

PetscReal PressureStep(Pressure pressure)
{
  return pressure->dt;
}

PetscReal PressureFull(Pressure pressure)
{
  return pressure->lattice_sum;
}
