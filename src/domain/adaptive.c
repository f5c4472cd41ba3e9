/* The records of what may adapt the spacing. */
#include "domain.h"

extern const Adaptive FollowingAdaptive;

static const Adaptive *const all[] = {&FollowingAdaptive};

PetscErrorCode AdaptiveSetFromOptions(Domain domain)
{
  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(all); k++) PetscCall(all[k]->options(domain));
  PetscFunctionReturn(PETSC_SUCCESS);
}
