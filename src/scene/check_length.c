/* What shapes check of their options. */
#include "scene_impl.h"

PetscErrorCode BodyCheckLength(Body body, const char option[], PetscReal length)
{
  char full[2 * SCENE_NAME_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(full, sizeof(full), "-%s%s", body->prefix, option + 1));
  PetscCheckUser(length > 0, body->domain->comm, "%s is missing%s: it must be given (m) and positive", full,
                 OptionMeant(full));
  PetscFunctionReturn(PETSC_SUCCESS);
}
