/* The registries of shapes and of types of bodies. */
#include "scene_impl.h"

const Choice *const Shapes[] = {&ShapeBox.choice,       &ShapeSphere.choice,    &ShapeCylinder.choice,
                                &ShapeEllipsoid.choice, &ShapeHalfSpace.choice, &ShapeStl.choice,
                                &ShapeThread.choice,    &ShapeWave.choice,      NULL};

static const BodyTypeOps TypeLiquid = {{"liquid", 0, NULL, NULL, NULL}, PETSC_FALSE, NULL, NULL};

const Choice *const BodyTypes[] = {&TypeLiquid.choice, &BodyTypeEmitter.choice, NULL};
