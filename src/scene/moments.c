/* The times at which a scene is looked at if what holds at the start may not hold later. */
#include "scene_impl.h"

/* Adds the moments of a body or solid; whether it depends on the time. */
static PetscBool Add(Body body, Moments *moments)
{
  if (body->motion) SolidMotion.moments(body, moments);
  if (body->kind && body->kind->moments) body->kind->moments(body, moments);
  return (PetscBool)(body->motion || (body->kind && body->kind->moments));
}

PetscInt BodyMoments(Body body, PetscReal start, PetscReal end, PetscInt most, PetscReal moment[])
{
  Moments moments = {.start = start, .end = end, .most = most, .time = moment};

  (void)Add(body, &moments);
  (void)PetscSortReal(moments.n, moment);
  return moments.n;
}

PetscInt SceneMoments(Scene scene, PetscReal start, PetscReal end, PetscInt most, PetscReal moment[])
{
  Moments   moments = {.start = start, .end = end, .most = most, .time = moment};
  PetscBool any     = ForcesMoments(scene, &moments);

  for (PetscInt b = 0; b < scene->count; b++)
    if (Add(scene->body[b], &moments)) any = PETSC_TRUE;
  for (PetscInt b = 0; b < scene->solids; b++)
    if (Add(scene->solid[b], &moments)) any = PETSC_TRUE;
  if (!any) return 0;
  MomentAdd(&moments, start);
  (void)PetscSortReal(moments.n, moment);
  return moments.n;
}
