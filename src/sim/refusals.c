/* The table of features that cannot be used together, for the refusals, the end of -help and the list in
   options/README.md. A feature has the name that the user writes. A feature that is an option is on if the option is
   given, with the value if the name has one. Features has all others. */
#include "../bodies/bodies.h"
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
  return (PetscBool)(sim->domain->graded && !sim->domain->follow);
}

static PetscBool Emits(Sim sim)
{
  return (PetscBool)(sim->scene && SceneComesLater(sim->scene));
}

static PetscBool SolidsMove(Sim sim)
{
  return (PetscBool)(sim->scene && SceneSolidsMove(sim->scene));
}

static PetscBool SolidsFree(Sim sim)
{
  return (PetscBool)(sim->scene && SceneHasFree(sim->scene));
}

static PetscBool SolidsHaveAngles(Sim sim)
{
  for (PetscInt b = 0; sim->scene && b < SceneSolidCount(sim->scene); b++)
    if (BodyContactAngle(SceneSolid(sim->scene, b)) > 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscBool Densities(Sim sim)
{
  return (PetscBool)(sim->scene && SceneCount(sim->scene) > 0 && !SceneOneDensity(sim->scene));
}

static PetscBool ViscosityVaries(Sim sim)
{
  return (PetscBool)(sim->scene && SceneViscosityVaries(sim->scene));
}

static PetscBool HasAngles(Sim sim)
{
  return (PetscBool)(sim->tension && TensionHasAngles(sim->tension));
}

static PetscBool HasHysteresis(Sim sim)
{
  return (PetscBool)(sim->tension && TensionHasHysteresis(sim->tension));
}

static PetscBool HasLaw(Sim sim)
{
  return (PetscBool)(sim->tension && TensionHasLaw(sim->tension));
}

#define RINGS      "-dimension axisymmetric"
#define GRADED     "-spacing_coarse"
#define FIXED      "-spacing_coarse without -spacing_follow"
#define EMITTERS   "-<body>_type emitter"
#define MOVING     "a solid that moves"
#define FREE       "-<solid>_mass"
#define WET        "-<solid>_contact_angle"
#define DENSITIES  "bodies of different -<body>_density"
#define THINNING   "a viscosity that depends on the shear rate"
#define ANGLES     "contact angles other than 90 degrees or hysteresis"
#define HYSTERESIS "a contact angle with hysteresis"
#define LAW        "-wall_contact_law"
#define FRAME      "-frame_rotation_rate"
#define INTERFACE  "-interface_tension"
#define POISSON    "-packing_type poisson"
#define CONSISTENT "-scheme " SCHEME_CONSISTENT
#define PRINTED    "-scheme " SCHEME_DENSITY_INVARIANT
#define SOUND      "-scheme " SCHEME_WEAKLY_COMPRESSIBLE
#define PHASES     "-tension_type " TENSION_CAHN_HILLIARD
#define CURVATURE  "-tension_type " TENSION_CURVATURE
#define DENSITY    "-pressure_source " SOURCE_DENSITY
#define DIVERGENCE "-pressure_source " SOURCE_DIVERGENCE
#define CONSERVED  "-pressure_gradient " GRADIENT_CONSERVED
#define CENTERED   "-time_centered"

static const struct {
  const char *name;
  PetscBool (*on)(Sim sim);
} Features[] = {
  {RINGS, Rings},
  {GRADED, Graded},
  {FIXED, Fixed},
  {EMITTERS, Emits},
  {MOVING, SolidsMove},
  {FREE, SolidsFree},
  {WET, SolidsHaveAngles},
  {DENSITIES, Densities},
  {THINNING, ViscosityVaries},
  {ANGLES, HasAngles},
  {HYSTERESIS, HasHysteresis},
  {LAW, HasLaw},
};

typedef enum { NOT_WITH, NEEDS } Relation;
static const char *const Relations[] = {"cannot be used with", "needs"};

/* 'one' cannot be used with 'other', or needs it, where 'other' is a default; 'rest' ends the sentence. */
static const struct {
  const char *one;
  Relation    relation;
  const char *other, *rest;
} Refusals[] = {
  {PRINTED, NOT_WITH, RINGS, ": its pressure gradient, Eq. (9), drives rings off the axis; " SCHEME_CONSISTENT " can"},
  /* tried with the gradient of a plane, with the gradient of rings that conserves energy with the divergence, and with
     one between: a drop of 16 spacings oscillates at 0.98 to 1.16 of its frequency and loses up to nine times the
     energy that it should, or clumps */
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
  {INTERFACE, NOT_WITH, GRADED, " yet"},
  {MOVING, NOT_WITH, FIXED, ": it would leave the fine region"},
  {THINNING, NOT_WITH, GRADED, " yet"},
  {PHASES, NOT_WITH, GRADED, ": its sums are for particles of one size; " TENSION_CURVATURE " can"},
  {POISSON, NOT_WITH, GRADED,
   ": its particles have one size; use -packing_type lattice, which fills the grading between two lattices"},
  {"-spectrum", NOT_WITH, GRADED, " yet: its limits are for one spacing"},
  {POISSON, NOT_WITH, "-solids", "; use -packing_type lattice"},
  {POISSON, NOT_WITH, EMITTERS, "; use -packing_type lattice"},
  {POISSON, NOT_WITH, "-bodies_overlap", "; use -packing_type lattice"},
  {FREE, NOT_WITH, DENSITIES, " yet"},
  {FREE, NOT_WITH, FRAME, " yet"},
  {"-ksp_type preonly", NOT_WITH, FREE,
   ": the body's part of the pressure equation is not in the preconditioner; -ksp_type cg can"},
  {"-ksp_type none", NOT_WITH, FREE,
   ": the body's part of the pressure equation is not in the preconditioner; -ksp_type cg can"},
  {INTERFACE, NOT_WITH, ANGLES, " yet: the interface would have another angle than the free surface"},
  {MOVING, NEEDS, CONSISTENT, ", the default"},
  {MOVING, NEEDS, CENTERED, ", the default"},
  {FREE, NEEDS, DIVERGENCE, ", the default"},
  {FRAME, NEEDS, CONSISTENT, ", the default"},
  {INTERFACE, NEEDS, CONSISTENT, ", the default"},
  {INTERFACE, NEEDS, CURVATURE, ", the default"},
  {HYSTERESIS, NEEDS, CONSISTENT, ", the default"},
  {LAW, NEEDS, CONSISTENT, ", the default"},
  {WET, NEEDS, CURVATURE, ", the default"},
};

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
  PetscCall(FindOption(feature, given));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether row k refuses this run. If one feature is an option, it is queried only if the other is on: to PETSc a
   queried option counts as read. */
static PetscErrorCode Refuses(Sim sim, size_t k, PetscBool *refuses)
{
  const Given       bad[2]   = {GIVEN, Refusals[k].relation == NEEDS ? OPPOSED : GIVEN};
  const char *const names[2] = {Refusals[k].one, Refusals[k].other};
  const PetscInt    first    = names[0][0] == '-' ? 1 : 0;
  Given             given;

  PetscFunctionBegin;
  PetscCall(Find(sim, names[first], &given));
  *refuses = (PetscBool)(given == bad[first]);
  if (!*refuses) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Find(sim, names[1 - first], &given));
  *refuses = (PetscBool)(given == bad[1 - first]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RefuseCombinations(Sim sim)
{
  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(Refusals); k++) {
    PetscBool refuses = PETSC_FALSE;

    PetscCall(Refuses(sim, k, &refuses));
    PetscCheckUser(!refuses, sim->comm, "%s %s %s%s", Refusals[k].one, Relations[Refusals[k].relation],
                   Refusals[k].other, Refusals[k].rest);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RefusalsHelp(MPI_Comm comm)
{
  PetscFunctionBegin;
  PetscCall((*PetscHelpPrintf)(comm, "----------------------------------------\nWhat cannot be used together:\n"));
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(Refusals); k++)
    PetscCall((*PetscHelpPrintf)(comm, "    %s %s %s%s\n", Refusals[k].one, Relations[Refusals[k].relation],
                                 Refusals[k].other, Refusals[k].rest));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void RefusalsJson(Json *json)
{
  JsonArray(json, "refusals");
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(Refusals); k++) {
    JsonObject(json, NULL);
    JsonText(json, "one", Refusals[k].one);
    JsonText(json, "relation", Relations[Refusals[k].relation]);
    JsonText(json, "other", Refusals[k].other);
    JsonText(json, "rest", Refusals[k].rest);
    JsonEnd(json);
  }
  JsonEnd(json);
}
