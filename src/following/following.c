/* The record of the spacing that follows the liquid, and its options. */
#include "following_impl.h"

static const char *const Words[] = {"none", "surface", "curvature", "auto", NULL};

static const OptionRow what[] = {
  {"-spacing_follow",
   "What the spacing follows (adaptive resolution): it is -spacing at free surfaces, or where they are curved, and "
   "grows to -spacing_coarse away from them; auto: surface with -dimension axisymmetric, else curvature",
   NULL, NULL, ROW_WORD, offsetof(Follow, what), .words = Words},
  {.name = NULL},
};
static const OptionRow how[] = {
  {"-particles_most",
   "Particles of liquid that the spacing may ask for; more, and it is coarser everywhere; 0: no bound", "1", "[0, inf)",
   ROW_INT, offsetof(Follow, particles_most)},
  {.name = NULL},
};

static PetscErrorCode SetFromOptions(Domain domain)
{
  Follow follow = {FOLLOW_NONE};

  PetscFunctionBegin;
  PetscOptionsBegin(domain->comm, NULL, "Spacing that follows the liquid", "Following");
  PetscCall(OptionsRead(PetscOptionsObject, what, "DomainSetFromOptions", &follow));
  PetscCall(OptionsReadIf(PetscOptionsObject, (PetscBool)(follow.what != FOLLOW_NONE), "-spacing_follow", how,
                          "DomainSetFromOptions", &follow));
  PetscOptionsEnd();
  if (follow.what == FOLLOW_NONE) PetscFunctionReturn(PETSC_SUCCESS);
  if (follow.what == FOLLOW_AUTO) follow.what = domain->rings ? FOLLOW_SURFACE : FOLLOW_CURVATURE;
  domain->adaptive = &FollowingAdaptive;
  PetscCall(PetscCalloc(sizeof(follow), &domain->adaptive_data));
  *FollowOf(domain) = follow;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const char *Name(Domain domain)
{
  return Words[FollowOf(domain)->what];
}

static PetscErrorCode Destroy(Domain domain)
{
  PetscFunctionBegin;
  PetscCall(SharedDestroy(&FollowOf(domain)->target.shared));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const Adaptive FollowingAdaptive = {.options = SetFromOptions,
                                    .name    = Name,
                                    .start   = TargetBodies,
                                    .find    = TargetFind,
                                    .at      = TargetAt,
                                    .walls   = TargetWalls,
                                    .destroy = Destroy};
