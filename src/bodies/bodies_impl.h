/* Private to bodies/: bodies that move freely, an edge of the step. */
#ifndef ISPH_BODIES_IMPL_H
#define ISPH_BODIES_IMPL_H

#include "../stepper/edge.h"

#define FREE_EDGE "free" /* the name of FreeEdge */

/* The data of FreeEdge. */
typedef struct {
  PetscReal           drag[RIGID_MOTIONS * SCENE_MAX_BODIES]; /* viscous force and torque on each free solid, N, N m */
  PetscReal           impulse[RIGID_MOTIONS * SCENE_MAX_BODIES];                /* of 'push' in this step, N s, N m s */
  PetscReal           follow[RIGID_MOTIONS * RIGID_MOTIONS * SCENE_MAX_BODIES]; /* the inverses of FreeViscousHold */
  Cloud               cloud;                                                    /* borrowed */
  PetscInt            couplings;                                                /* free solids */
  struct _p_Coupling *coupling;                                                 /* [couplings], coupling.c */
} FreeData;

static inline FreeData *FreeDataOf(Stepper stepper)
{
  return (FreeData *)StepEdgeData(stepper, FREE_EDGE);
}

/* FreeSetVelocities - sets velocity ([n_owned][3], m/s) of the dummy particles of a free solid, by its index, to that
   of a motion. Not collective. FreeSum - sum[solids][RIGID_MOTIONS]: force and torque on each free solid, over all
   ranks, from the forces each ([n_total][3], N) on dummy particles; 0 for other solids. normal ([n_total][3]): see
   FreeAddForce, or NULL. FreeViscousHold, FreeViscousFollow, FreeViscousDrag - the hooks. Collective. */
void FreeSetVelocities(Cloud cloud, PetscInt solid, const PetscReal motion[RIGID_MOTIONS], PetscReal velocity[]);
PetscErrorCode FreeSum(Cloud cloud, const PetscReal each[], const PetscReal normal[], PetscReal sum[]);
PetscErrorCode FreeViscousHold(Stepper stepper, PetscReal dt);
PetscErrorCode FreeViscousFollow(Stepper stepper, PetscBool own, PetscReal dt, PetscReal u[]);
PetscErrorCode FreeViscousDrag(Stepper stepper, PetscReal dt, const PetscReal velocity[], StepTrial *trial);

/* SolidsMove - the hook 'drift' of solids that move and of their dummy particles. Not collective. */
PetscErrorCode SolidsMove(Cloud cloud, PetscReal from, PetscReal to, PetscReal end);

/* CouplingCreate - couples the free solids to the equation of the pressure, if there are any. CouplingForces - force
   and torque [couplings][RIGID_MOTIONS] (N, N m) of the cloud's pressure on each free solid, as in the equation.
   Collective. */
PetscErrorCode CouplingCreate(FreeData *data, Cloud cloud, Pressure pressure);
PetscErrorCode CouplingForces(FreeData *data, Pressure pressure, PetscReal force[]);
PetscErrorCode CouplingDestroy(FreeData *data);

#endif
