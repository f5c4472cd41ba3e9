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

PetscErrorCode RateCheck(Domain domain, const char prefix[], const OptionNumbers *given, PetscReal rate[DIM])
{
  const PetscBool flat = (PetscBool)(domain->dim == 2);

  PetscFunctionBegin;
  PetscCheckUser(given->count == 0 || given->count == DIM || (flat && given->count == 1), domain->comm,
                 "-%srotation_rate must have %s", prefix,
                 flat ? "one number, or three numbers of which the first two are 0" : "three numbers");
  for (PetscInt d = 0; d < DIM; d++) rate[d] = given->count == DIM ? given->value[d] : 0;
  if (given->count == 1) rate[2] = given->value[0];
  PetscCheckUser(!flat || (rate[0] == 0 && rate[1] == 0), domain->comm,
                 "-%srotation_rate must be about z in two dimensions: its first two numbers must be 0", prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}
