/* The table of features that cannot be used together, for the refusals, the end of -help and the list in
   options/README.md. A feature has the name that the user writes. A feature that is an option is on if the option is
   given, with the value if the name has one. Features has all others. Edges have rows of their own. */
#include "../stepper/edge.h"
#include "sim_impl.h"
#include <string.h>
#include <strings.h>

static PetscBool Rings(Sim sim)
{
  return sim->domain->rings;
}

static PetscBool Graded(Sim sim)
{
  return sim->domain->graded;
}

static PetscBool Fixed(Sim sim)
{
  return (PetscBool)(sim->domain->graded && !sim->domain->adaptive);
}

static PetscBool Densities(Sim sim)
{
  return (PetscBool)(sim->scene && SceneCount(sim->scene) > 0 && !SceneOneDensity(sim->scene));
}

static PetscBool ViscosityVaries(Sim sim)
{
  return (PetscBool)(sim->scene && SceneViscosityVaries(sim->scene));
}

#define RINGS      "-dimension axisymmetric"
#define GRADED     "-spacing_coarse"
#define FIXED      FEATURE_FIXED
#define DENSITIES  FEATURE_DENSITIES
#define THINNING   "a viscosity that depends on the shear rate"
#define FRAME      FEATURE_FRAME
#define POISSON    FEATURE_POISSON
#define CONSISTENT FEATURE_CONSISTENT
#define PRINTED    "-scheme " SCHEME_DENSITY_INVARIANT
#define SOUND      "-scheme " SCHEME_WEAKLY_COMPRESSIBLE
#define PHASES     "-tension_type " TENSION_CAHN_HILLIARD
#define DENSITY    "-pressure_source " SOURCE_DENSITY
#define CONSERVED  "-pressure_gradient " GRADIENT_CONSERVED

static const struct {
  const char *name;
  PetscBool (*on)(Sim sim);
} Features[] = {
  {RINGS, Rings}, {GRADED, Graded}, {FIXED, Fixed}, {DENSITIES, Densities}, {THINNING, ViscosityVaries},
};

static const char *const Relations[] = {"cannot be used with", "needs", "needs"};

static const Refusal Refusals[] = {
  {PRINTED, NOT_WITH, RINGS, ": its pressure gradient, Eq. (9), drives rings off the axis; " SCHEME_CONSISTENT " can"},
  {SOUND, NOT_WITH, RINGS, ": sound waves focus at the axis and stay there; " SCHEME_CONSISTENT " can"},
  {DENSITY, NOT_WITH, RINGS,
   ": the density jumps where rings join or split, and this source would remove the jump within one "
   "step; " SOURCE_DIVERGENCE " can"},
  {CONSERVED, NOT_WITH, RINGS, ": it conserves momentum in a plane, not with rings; " GRADIENT_CORRECTED " can"},
  {"-shifting_conserved", NOT_WITH, RINGS, ": it conserves momentum and angular momentum in a plane, not with rings"},
  {FRAME, NOT_WITH, RINGS, ": the Coriolis force needs a velocity around the axis, which rings do not have"},
  {PHASES, NOT_WITH, RINGS, ": its sums in a plane miss the curvature around the axis; " TENSION_CURVATURE " can"},
  {POISSON, NOT_WITH, RINGS, ": its particles have one volume, rings do not; use -packing_type lattice"},
  {PRINTED, NOT_WITH, GRADED, " yet; " SCHEME_CONSISTENT " can"},
  {SOUND, NOT_WITH, GRADED, " yet; " SCHEME_CONSISTENT " can"},
  {DENSITY, NOT_WITH, GRADED, " yet; " SOURCE_DIVERGENCE " can"},
  {CONSERVED, NOT_WITH, GRADED, " yet; " GRADIENT_CORRECTED " can"},
  {"-shifting_conserved", NOT_WITH, GRADED, " yet"},
  {"-bodies_overlap", NOT_WITH, GRADED, " yet"},
  {THINNING, NOT_WITH, GRADED, " yet"},
  {PHASES, NOT_WITH, GRADED, ": its sums are for particles of one size; " TENSION_CURVATURE " can"},
  {POISSON, NOT_WITH, GRADED,
   ": its particles have one size; use -packing_type lattice, which fills the grading between two lattices"},
  {"-spectrum", NOT_WITH, GRADED, " yet: its limits are for one spacing"},
  {POISSON, NOT_WITH, "-solids", "; use -packing_type lattice"},
  {POISSON, NOT_WITH, "-bodies_overlap", "; use -packing_type lattice"},
  {FRAME, NEEDS, CONSISTENT, ", the default"},
  {"-restart_disturbance", NEEDS_GIVEN, "-restart", ": it disturbs rings that become particles in space"},
  {.one = NULL},
};

/* Row k: of the core, then of the edges; NULL: there are no more. */
static const Refusal *RefusalRow(PetscInt k)
{
  const Refusal *row = Refusals;

  for (const Edge *const *edge = StepEdges;; edge++) {
    for (; row && row->one; row++)
      if (k-- == 0) return row;
    if (!*edge) return NULL;
    row = (*edge)->refusals;
  }
}

/* Whether the user gives a feature, gives its opposite, or says nothing. */
typedef enum { GIVEN, OPPOSED, UNSAID } Given;

/* feature: the name of an option and, behind a blank, its value. Zeros and words for 'no' do not switch it on. */
static PetscErrorCode FindOption(const char feature[], Given *given)
{
  char        name[OPTION_NAME_LENGTH], value[OPTION_NAME_LENGTH] = "";
  const char *wanted = strchr(feature, ' ');
  PetscBool   set, same;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(name, feature, wanted ? (size_t)(wanted - feature) + 1 : sizeof(name)));
  PetscCall(PetscOptionsGetString(NULL, NULL, name, value, sizeof(value), &set));
  if (wanted)
    PetscCall(PetscStrcmp(value, wanted + 1, &same));
  else
    same = (PetscBool) !((value[0] && !value[strspn(value, "0.,-+")]) || !strcasecmp(value, "no") ||
                         !strcasecmp(value, "off") || !strcasecmp(value, "false"));
  *given = !set ? UNSAID : same ? GIVEN : OPPOSED;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Find(Sim sim, const char feature[], Given *given)
{
  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(Features); k++)
    if (!strcmp(feature, Features[k].name)) {
      *given = Features[k].on(sim) ? GIVEN : UNSAID;
      PetscFunctionReturn(PETSC_SUCCESS);
    }
  for (const Edge *const *edge = StepEdges; *edge; edge++)
    for (const Feature *row = (*edge)->features; row && row->name; row++)
      if (!strcmp(feature, row->name)) {
        *given = row->on(sim->scene, sim->tension) ? GIVEN : UNSAID;
        PetscFunctionReturn(PETSC_SUCCESS);
      }
  PetscCall(FindOption(feature, given));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether what is given of a row's feature, one or other (1), is what the row refuses. */
static PetscBool Bad(const Refusal *row, PetscInt other, Given given)
{
  if (!other || row->relation == NOT_WITH) return (PetscBool)(given == GIVEN);
  return (PetscBool)(given == OPPOSED || (row->relation == NEEDS_GIVEN && given == UNSAID));
}

/* Whether a row refuses this run. If one feature is an option, it is queried only if the other is on: to PETSc a
   queried option counts as read. */
static PetscErrorCode Refuses(Sim sim, const Refusal *row, PetscBool *refuses)
{
  const char *const names[2] = {row->one, row->other};
  const PetscInt    first    = names[0][0] == '-' ? 1 : 0;
  Given             given;

  PetscFunctionBegin;
  *refuses = PETSC_FALSE;
  for (PetscInt k = 0; k < 2; k++) {
    const PetscInt of = k ? 1 - first : first;

    PetscCall(Find(sim, names[of], &given));
    if (!Bad(row, of, given)) PetscFunctionReturn(PETSC_SUCCESS);
  }
  *refuses = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RefuseCombinations(Sim sim)
{
  const Refusal *row;

  PetscFunctionBegin;
  for (PetscInt k = 0; (row = RefusalRow(k)); k++) {
    PetscBool refuses = PETSC_FALSE;

    PetscCall(Refuses(sim, row, &refuses));
    PetscCheckUser(!refuses, sim->comm, "%s %s %s%s", row->one, Relations[row->relation], row->other, row->rest);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RefusalsHelp(MPI_Comm comm)
{
  const Refusal *row;

  PetscFunctionBegin;
  PetscCall((*PetscHelpPrintf)(comm, "----------------------------------------\nWhat cannot be used together:\n"));
  for (PetscInt k = 0; (row = RefusalRow(k)); k++)
    PetscCall((*PetscHelpPrintf)(comm, "    %s %s %s%s\n", row->one, Relations[row->relation], row->other, row->rest));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void RefusalsJson(Json *json)
{
  const Refusal *row;

  JsonArray(json, "refusals");
  for (PetscInt k = 0; (row = RefusalRow(k)); k++) {
    JsonObject(json, NULL);
    JsonText(json, "one", row->one);
    JsonText(json, "relation", Relations[row->relation]);
    JsonText(json, "other", row->other);
    JsonText(json, "rest", row->rest);
    JsonEnd(json);
  }
  JsonEnd(json);
}
