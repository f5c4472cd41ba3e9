/* The edges that add to a step. */
#include "stepper_impl.h"

const StepHooks *const StepEdges[] = {&MovingHooks, &ContactHooks, &FreeHooks, &EmitterHooks, &ResamplingHooks, NULL};
