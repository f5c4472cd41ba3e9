/* The pressure projection as an object: its types, options, view. */
#include "pressure_impl.h"

typedef enum { POSITIVE, NOT_NEGATIVE, AT_LEAST_ONE } Range;

static const char *const RangeSentences[] = {"it must be positive", "it must not be negative", "it must be at least 1"};

/* An option that is a number: where it is kept, its default and the values allowed. */
typedef struct {
  const char *name, *help, *unit;
  size_t      offset; /* in struct _p_Pressure */
  PetscReal   value;
  Range       range;
} Number;

#define DEFAULT_RELAXATION_TIME 1e-3 /* s, where neither the user nor the stepper chooses */

#define PLACE(member) offsetof(struct _p_Pressure, member)

static const Number Numbers[] = {
  {"-pressure_closure_factor",
   "factor of what full_diagonal adds to the diagonal (1): 1 is Nair and Tomar's, 2 puts p = 0 on the surface", "",
   PLACE(closure_factor), 2, POSITIVE},
  {"-pressure_regularization",
   "background pressure of the corrected gradient that spreads particles, over h |grad p| (1)", "",
   PLACE(regularization), 2, NOT_NEGATIVE},
  {"-pressure_relaxation_time",
   "time in which the divergence source repairs density errors (s); 0: from the scene's velocity and h", " s",
   PLACE(relaxation_option), 0, NOT_NEGATIVE},
  {"-pressure_rebuild_growth", "growth of the iterations that makes the preconditioner anew (1)", "",
   PLACE(rebuild_growth), 1.5, AT_LEAST_ONE},
  {"-pressure_density_tolerance",
   "largest relative density error the solver may leave in a step (1); 0: PETSc's own test, -ksp_rtol and the others",
   "", PLACE(density_tolerance), 0, NOT_NEGATIVE},
};

/* What these do and where their defaults come from is said where they are used: source.c, closure.c, gradient.c. */
static const Number Advanced[] = {
  {"-pressure_relaxation_steps", "least number of steps in which the divergence source repairs density errors (1)", "",
   PLACE(relaxation_steps), 5, POSITIVE},
  {"-pressure_closure_lambda", "lambda of fluid below which full_diagonal fills up the diagonal (1)", "",
   PLACE(closure_lambda), 0.9, NOT_NEGATIVE},
  {"-pressure_closure_least",
   "least that full_diagonal adds on the surface, over n.B n V/rho, n the sum of V grad W (1); less than 1 diverges",
   "", PLACE(closure_least), 2.5, NOT_NEGATIVE},
  {"-pressure_pairing_moving", "part of the term against pairing in the background pressure, liquid in motion (1)", "",
   PLACE(pairing_moving), 0.1, NOT_NEGATIVE},
  {"-pressure_pairing_loaded", "the same where a body force makes the pressure (1)", "", PLACE(pairing_loaded), 0.5,
   NOT_NEGATIVE},
};

#define COUNT(table) ((PetscInt)PETSC_STATIC_ARRAY_LENGTH(table))

/* Where a pressure keeps a number. */
static PetscReal *NumberOf(Pressure pressure, const Number *number)
{
  return (PetscReal *)((char *)pressure + number->offset);
}

static void SetDefaults(Pressure pressure, PetscInt n, const Number numbers[])
{
  for (PetscInt k = 0; k < n; k++) *NumberOf(pressure, numbers + k) = numbers[k].value;
}

/* To be called between PetscOptionsBegin and PetscOptionsEnd. */
static PetscErrorCode ReadNumbers(Pressure pressure, OptionItems PetscOptionsObject, PetscInt n, const Number numbers[])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) {
    PetscReal *value = NumberOf(pressure, numbers + k);

    PetscCall(PetscOptionsReal(numbers[k].name, numbers[k].help, "PressureSetFromOptions", *value, value, NULL));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool InRange(PetscReal value, Range range)
{
  if (range == POSITIVE) return (PetscBool)(value > 0);
  return (PetscBool)(value >= (range == AT_LEAST_ONE ? 1 : 0));
}

static PetscErrorCode CheckNumbers(Pressure pressure, PetscInt n, const Number numbers[])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) {
    const PetscReal value = *NumberOf(pressure, numbers + k);

    PetscCheckUser(InRange(value, numbers[k].range), pressure->cloud->comm, "%s is %g%s; %s", numbers[k].name,
                   (double)value, numbers[k].unit, RangeSentences[numbers[k].range]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
  SetDefaults(p, COUNT(Numbers), Numbers);
  SetDefaults(p, COUNT(Advanced), Advanced);
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
                 "-pressure_source %s is not a source; there are " SOURCE_DENSITY " and " SOURCE_DIVERGENCE, source);
  PetscCheckUser(pressure->closure, pressure->cloud->comm,
                 "-pressure_closure %s is not a closure; there are " CLOSURE_DOUBLED " and " CLOSURE_FULL, closure);
  PetscCheckUser(pressure->gradient, pressure->cloud->comm,
                 "-pressure_gradient %s is not a gradient; there are " GRADIENT_SYMMETRIC ", " GRADIENT_CORRECTED
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

/* Makes -help list the options of the preconditioner, which the solver reads when it is made. */
static PetscErrorCode PreconditionerHelp(MPI_Comm comm)
{
  PC pc;

  PetscFunctionBegin;
  PetscCall(PCCreate(comm, &pc));
  PetscCall(PCSetType(pc, PCTWOLEVEL));
  PetscCall(PCSetFromOptions(pc));
  PetscCall(PCDestroy(&pc));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The types, and which density the operators divide by. To be called between PetscOptionsBegin and PetscOptionsEnd. */
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
  PetscCall(PetscOptionsEList("-pressure_density", "density the operators divide by: rest or summed",
                              "PressureSetTypes", choices, 2, choices[choice], &choice, NULL));
  PetscCall(PressureSetTypes(pressure, source, closure, gradient, (PetscBool)choice));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureSetFromOptions(Pressure pressure)
{
  Cloud cloud = pressure->cloud;

  PetscFunctionBegin;
  PetscOptionsBegin(cloud->comm, NULL, "Pressure projection", "Pressure");
  PetscCall(ReadTypes(pressure, PetscOptionsObject));
  PetscCall(ReadNumbers(pressure, PetscOptionsObject, COUNT(Numbers), Numbers));
  PetscCall(PetscOptionsInt("-pressure_rebuild_interval",
                            "steps after which the preconditioner is made anew; 0: 10 for twolevel, jacobi and none, "
                            "50 for all others",
                            "PressureSetFromOptions", pressure->rebuild_interval, &pressure->rebuild_interval, NULL));
  PetscCall(PetscOptionsFList("-mat_type",
                              "PETSc type of the pressure matrix; none given: shell, the sum of pairs without a "
                              "matrix, if the preconditioner does without entries, else aij",
                              "MatSetType", MatList, pressure->mat_type, pressure->mat_type, sizeof(pressure->mat_type),
                              NULL));
  PetscOptionsEnd();
  PetscOptionsBegin(cloud->comm, NULL, "Advanced: pressure projection", "Pressure");
  PetscCall(ReadNumbers(pressure, PetscOptionsObject, COUNT(Advanced), Advanced));
  PetscOptionsEnd();
  if (HelpWanted()) PetscCall(PreconditionerHelp(cloud->comm));
  PetscCall(CheckNumbers(pressure, COUNT(Numbers), Numbers));
  PetscCall(CheckNumbers(pressure, COUNT(Advanced), Advanced));
  PetscCheckUser(pressure->rebuild_interval >= 0, cloud->comm,
                 "-pressure_rebuild_interval is %" PetscInt_FMT "; it must not be negative",
                 pressure->rebuild_interval);
  if (pressure->relaxation_option > 0) pressure->relaxation_time = pressure->relaxation_option;
  PressureLattice(cloud, &pressure->lattice_diagonal, &pressure->lattice_sum);
  pressure->row_scale = 1 / (cloud->domain->volume * BodyMaterial(SceneBody(cloud->scene, 0))->density);
  KernelHalfSpace(cloud->kernel, 0, &pressure->surface_plane, NULL);
  KernelSurfaceTable(cloud->kernel, SURFACE_TABLE, pressure->surface_fraction);
  PetscFunctionReturn(PETSC_SUCCESS);
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
  PetscCall(PetscFree(p->parent_row));
  PetscCall(ColumnsReset(&p->columns));
  PetscCall(PetscFree(*pressure));
  PetscFunctionReturn(PETSC_SUCCESS);
}
