/* The times at which a scene is looked at if what holds at the start may not hold later. */
#include "scene_impl.h"

#define TURN        0.01 /* of a column's range, by which it must turn back: less is noise of what was measured */
#define TURNS_LEAST 3    /* of a column that swings: a pulse turns twice */

void MomentTable(Moments *moments, const PetscReal table[], PetscInt rows, PetscInt columns, PetscInt c)
{
  PetscReal least = PETSC_MAX_REAL, most = PETSC_MIN_REAL, first = 0, last = 0;
  PetscInt  turns = 0, extreme = 0, way = 0; /* the row from which it may have turned; 1: it rises, -1: it falls */

  for (PetscInt k = 0; k < rows; k++) {
    least = PetscMin(least, table[columns * k + c]);
    most  = PetscMax(most, table[columns * k + c]);
  }
  for (PetscInt k = 0; k < rows; k++) {
    const PetscReal change = table[columns * k + c] - table[columns * extreme + c];

    if (change * way <= 0 && PetscAbsReal(change) > TURN * (most - least)) { /* back from the extreme */
      if (way != 0) {
        last  = table[columns * extreme];
        first = turns++ == 0 ? last : first;
      }
      way     = change > 0 ? 1 : -1;
      extreme = k;
    } else if (change * way > 0)
      extreme = k;
  }
  if (turns >= TURNS_LEAST) moments->frequency = PetscMax(moments->frequency, 0.5 * (turns - 1) / (last - first));
}

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

/* The same of all that the scene has. */
static PetscBool AddAll(Scene scene, Moments *moments)
{
  PetscBool any = ForcesMoments(scene, moments);

  for (PetscInt b = 0; b < scene->count; b++)
    if (Add(scene->body[b], moments)) any = PETSC_TRUE;
  for (PetscInt b = 0; b < scene->solids; b++)
    if (Add(scene->solid[b], moments)) any = PETSC_TRUE;
  return any;
}

PetscInt SceneMoments(Scene scene, PetscReal start, PetscReal end, PetscInt most, PetscReal moment[])
{
  Moments moments = {.start = start, .end = end, .most = most, .time = moment};

  if (!AddAll(scene, &moments)) return 0;
  MomentAdd(&moments, start);
  (void)PetscSortReal(moments.n, moment);
  return moments.n;
}

PetscReal SceneFrequency(Scene scene)
{
  Moments moments = {.most = 0};

  (void)AddAll(scene, &moments);
  return moments.frequency;
}
