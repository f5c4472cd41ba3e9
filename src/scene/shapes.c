/* The registry of the shapes. */
#include "scene_impl.h"

const Choice *const Shapes[] = {&ShapeBox.choice,       &ShapeSphere.choice,    &ShapeCylinder.choice,
                                &ShapeEllipsoid.choice, &ShapeHalfSpace.choice, &ShapeStl.choice,
                                &ShapeThread.choice,    &ShapeWave.choice,      NULL};
