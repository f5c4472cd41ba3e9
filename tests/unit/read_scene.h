/* A scene from a text of options, for the tests of scenes. */
#ifndef ISPH_READ_SCENE_H
#define ISPH_READ_SCENE_H

#include "../../src/scene/scene.h"
#include "refuse.h"

#define CUBE   "-spacing 0.1 -box_lower -1,-1,-1 -box_upper 1,1,1 "
#define SQUARE "-dimension 2 " CUBE
#define BALL   "-bodies a -a_shape sphere -a_radius 0.5 "

/* A scene from a text of options; what was made is returned whatever the code. */
static inline PetscErrorCode Read(const char options[], Domain *domain, Scene *scene)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscOptionsInsertString(NULL, options));
  PetscCall(DomainCreate(PETSC_COMM_WORLD, domain));
  PetscCall(DomainSetFromOptions(*domain));
  PetscCall(SceneCreate(*domain, scene));
  PetscCall(SceneSetFromOptions(*scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscErrorCode Free(Domain *domain, Scene *scene)
{
  PetscFunctionBegin;
  if (*scene) PetscCall(SceneDestroy(scene));
  PetscCall(DomainDestroy(domain));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refused - the scene must be refused with a line that holds 'word'. */
static inline PetscErrorCode Refused(const char options[], const char word[], const char name[])
{
  Domain         domain = NULL;
  Scene          scene  = NULL;
  PetscErrorCode code;

  PetscFunctionBegin;
  RefuseBegin();
  code = Read(options, &domain, &scene);
  RefuseEnd(code, word, name);
  PetscCall(Free(&domain, &scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#endif
