/* Floor 8: solids that move, and bodies that move freely: edges of the step. */
#ifndef ISPH_BODIES_H
#define ISPH_BODIES_H

#include "../stepper/edge.h"

/* Free bodies, solids with -<s>_mass. A motion is a velocity (m/s), then an angular velocity (rad/s). An angular
   impulse about the centre of mass (N m s) follows an impulse (N s), and a torque (N m) follows a force (N).

   SceneHasFree - whether the scene has a free body. BodyMass - mass (kg; kg/m in two dimensions); 0: the solid is not
   free.

   FreeMotion - centre of mass (m) and motion at the time of SceneMoveSolids. FreeResponse - the change of the motion by
   an impulse at that time. FreePush - applies an impulse at that time, which 'time' must equal; the body moves on with
   the new motion. FreeAddForce - adds a force at x (m) to a sum of forces and torques. normal: only the component of
   the force along it has a torque, so that pressure does not turn a circle; NULL: all of the force has. FreeForces -
   the force of the pressure in the last step, and its excess over that of the projection; the stepper computes both,
   the body stores them. FreeKinetic - kinetic energy (J). FreeTurned - axis times angle (rad) of the rotation from the
   start to the last FreePush. FreeNumbers - the state of the body as an array, for a checkpoint.

   SceneStart - sets the time (s) at which free bodies begin to move. SceneFreeze - fixes all free bodies (true), or
   releases them with no forces of a last step (false). SceneSave - saves the states of the free bodies at the start of
   a step. SceneRestore - returns to the saved states. */
PetscBool  SceneHasFree(Scene scene);
PetscReal  BodyMass(Body solid);
void       FreeMotion(Body solid, PetscReal center[DIM], PetscReal motion[RIGID_MOTIONS]);
void       FreeResponse(Body solid, const PetscReal impulse[RIGID_MOTIONS], PetscReal change[RIGID_MOTIONS]);
void       FreePush(Body solid, PetscReal time, const PetscReal impulse[RIGID_MOTIONS]);
void       FreeForces(Body solid, PetscReal **force, PetscReal **excess);
void       FreeAddForce(Body solid, const PetscReal x[DIM], const PetscReal force[DIM], const PetscReal normal[],
                        PetscReal sum[RIGID_MOTIONS]);
void       FreeTurned(Body solid, PetscReal angle[DIM]);
PetscReal  FreeKinetic(Body solid);
PetscReal *FreeNumbers(Body solid, PetscInt *count);
void       SceneStart(Scene scene, PetscReal time);
void       SceneFreeze(Scene scene, PetscBool frozen);
void       SceneSave(Scene scene);
void       SceneRestore(Scene scene);

#endif
