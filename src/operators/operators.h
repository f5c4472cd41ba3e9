/* Floor 4: particle operators, sums over the neighbours of owned particles at the positions of the cloud. The caller
   updates the ghosts of the fields that a function reads. A function updates ghosts, and is collective, only if its
   text says so. */
#ifndef ISPH_OPERATORS_H
#define ISPH_OPERATORS_H

#include "../neighbors/cloud.h"

/* EtaSquared - eta^2 (m2), which regularises the square of a distance, r^2 + eta^2: see ETA_OVER_H. */
static inline PetscReal EtaSquared(Kernel kernel)
{
  return PetscSqr(ETA_OVER_H * KernelSmoothingLength(kernel));
}

/* TensorApply - B v for a symmetric matrix B, stored as xx yy zz xy xz yz, and v = (x, y, z). */
static inline void TensorApply(const PetscReal B[6], PetscReal x, PetscReal y, PetscReal z, PetscReal out[DIM])
{
  out[0] = B[0] * x + B[3] * y + B[4] * z;
  out[1] = B[3] * x + B[1] * y + B[5] * z;
  out[2] = B[4] * x + B[5] * y + B[2] * z;
}

/* OperatorsNearWall - whether the kernel's support around x (m) may hold dummy particles. */
static inline PetscBool OperatorsNearWall(Cloud cloud, const PetscReal x[DIM])
{
  const Domain    domain = cloud->domain;
  const PetscReal reach  = cloud->size_most * KernelSupport(cloud->kernel);

  if (cloud->solid_normal && SceneSolidWithin(cloud->scene, reach, x, NULL) < reach) return PETSC_TRUE;
  for (PetscInt d = 0; d < domain->dim; d++)
    if ((domain->face[d][0] == FACE_WALL && x[d] < domain->lower[d] + reach) ||
        (domain->face[d][1] == FACE_WALL && x[d] > domain->upper[d] - reach))
      return PETSC_TRUE;
  return PETSC_FALSE;
}

/* lambda, the smallest eigenvalue of a particle's moments M (OperatorsMoments), is 1 inside the liquid, about 1/2 on a
   flat free surface and 0 for an isolated particle. Spray has at most SPRAY_LAMBDA: an almost isolated particle, or a
   sheet or thread of one particle (Marrone et al. 2010). Spray is on the free surface without a scan; no pressure
   acts on it, it is not shifted, and no neighbour compensates for it. */
#define SPRAY_LAMBDA 0.2
/* A particle with lambda at most this has too few neighbours for B = M^-1: B is the identity. With 0.2 the angular
   momentum of drops that collide off centre changes by 1.7 %, with 0.3 by 0.9 % of R sum m v; with 0.4 a patch of
   liquid that turns clumps by 6.4 %, with 0.3 by 3.8 %. */
#define MOMENT_MINIMUM 0.3

/* SymmetricSmallestEigenvalue - the smallest eigenvalue of M (xx yy zz xy xz yz); with dim 2, of its upper left 2 x 2
   block. */
PetscReal SymmetricSmallestEigenvalue(PetscInt dim, const PetscReal M[6]);

/* SymmetricInverse - B = M^-1; with dim 2, of the upper left block, and B_zz = 1. */
void SymmetricInverse(PetscInt dim, const PetscReal M[6], PetscReal B[6]);

/* Forms of the viscous term. */
typedef enum {
  VISCOSITY_MOMENT, /* forces along the line of centres, as in Eq. (1), but a pair counts in proportion to r^2, and the
                       second moment of the kernel divides the sum: near pairs, on which the order of the particles
                       tells most, count less. Layers that slide along each other have 1.00 of their viscosity, a square
                       lattice 1.01, rows of hexagons 1.03. Conserves angular momentum */
  VISCOSITY_CLEARY, /* Eq. (1) of Kuri et al. (Cleary & Ha): zeta = dim + 2, in 3-d the 5 of the paper; in 2-d 5 would
                       be 25 % too viscous. Layers that slide have 0.91 of their viscosity in 2-d, a square lattice
                       0.87. Conserves angular momentum */
  VISCOSITY_MORRIS  /* Morris et al. 1997: the plain Laplacian, exact for shear; angular momentum is not conserved. A
                       free surface is not free of stress: an oscillating drop dissipates half of the exact rate, a drop
                       of rings a third */
} ViscosityForm;

/* Spacings: a particle closer to a wall has the wall factor of this distance. */
#define WALL_CLOSEST 0.25
/* The viscous term: its form, and the factors on pairs of fluid and wall. wall_factor[k] holds for a particle at the
   distance k/WALL_FACTORS of the kernel's support from the wall. The struct may be copied. */
#define WALL_FACTORS 64
typedef struct {
  ViscosityForm form;
  PetscBool     no_slip; /* otherwise all factors are 1 */
  PetscReal     wall_factor[WALL_FACTORS + 1];
} Viscosity;

/* OperatorsMoments - finds the neighbours (CloudSearch), and sums each row while it is in the cache (moments.c):
     FIELD_DENSITY     kg/m3: rho_a = m_a/V_a sum_b V_b W_ab, self included; for one liquid Eq. (4) of Kuri et al.
     FIELD_NORMAL      sum V grad W, 1/m: points into the liquid
     FIELD_CROWDING    sum V (1 + 0.2 (W/W(d0))^4) grad W, 1/m: points to where particles crowd (Lind et al. 2012)
     FIELD_LAMBDA      the smallest eigenvalue of M = -sum V grad W (x) r_ab (Marrone et al. 2010)
     FIELD_CORRECTION  B = M^-1, the identity where lambda <= MOMENT_MINIMUM (Randles & Libersky 1996)
   viscosity: NULL, or a viscosity of the form VISCOSITY_MOMENT. Then the sums also set FIELD_ACCELERATION (m/s2) of the
   fluid to the viscous term without OperatorsViscosityRemainder, for half the cost of OperatorsViscosity. This requires
   OperatorsOneLiquid, at rest density. Where bodies differ in density, cloud->rest_density of walls becomes that of the
   liquid before them; FIELD_DENSITY of walls follows. */
PetscErrorCode OperatorsMoments(Cloud cloud, const Viscosity *viscosity);
/* OperatorsOneLiquid - whether all bodies have the same density and the same constant viscosity: then all pairs have
   one coefficient. */
PetscBool OperatorsOneLiquid(Cloud cloud);
/* OperatorsFreeSurface - sets INT_SURFACE of the rows a < n_rows, and of ghosts: 1 on the free surface, 2 near it, 0
   inside (Marrone et al. 2010; no reference for class 2). On the surface: spray, and particles with lambda below 0.75
   and no neighbour in the cone along the normal. Near it: other fluid particles with lambda below 0.75, and particles
   with lambda below 0.95 within 1.5 spacings of a fluid particle on the surface. Needs OperatorsMoments. Collective. */
PetscErrorCode OperatorsFreeSurface(Cloud cloud);
/* OperatorsSurfaceArea - area of a particle's part of the free surface, m2, where the sum of its curvatures is kappa,
   1/m; kappa 0 leaves a curved one too small. Needs OperatorsFreeSurface. Not collective. */
PetscReal OperatorsSurfaceArea(Cloud cloud, PetscInt a, PetscReal kappa);
/* OperatorsSmoothNormals - n ([n_fluid][3]): unit normals into the liquid of particles at and near the free surface,
   smooth; zero: inside. OperatorsCurvatures - kappa ([n_fluid], 1/m) for OperatorsSurfaceArea, from these normals;
   tension has a better one. Need OperatorsFreeSurface. Collective. */
PetscErrorCode OperatorsSmoothNormals(Cloud cloud, PetscReal n[]);
PetscErrorCode OperatorsCurvatures(Cloud cloud, PetscReal kappa[]);
/* OperatorsViscosityFactor - the factor zeta of a form: dim/int r^2 W (1/m2), dim + 2, 1. Without order in the
   particles sum V F r_i r_j r_k r_l is M (d_ij d_kl + d_ik d_jl + d_il d_jk)/dim for the second moment M = int r^2 W,
   so that 2 dim nu/M sum V F (v.r) r is nu lap v of a velocity without divergence. Not collective. */
PetscReal OperatorsViscosityFactor(Cloud cloud, ViscosityForm form);
/* OperatorsNoSlip - sets the wall factors of a viscosity with a given form for no slip. Dummy particles at rest, as in
   the paper, put the plane of no slip behind the wall's face, and the first layer of particles slides. The factor
   extrapolates the velocity linearly through zero at the face (Morris et al. 1997). It depends on the particle's
   distance from the wall alone, at least WALL_CLOSEST, so the term remains a symmetric, dissipative sum over pairs. Not
   collective. */
void OperatorsNoSlip(Cloud cloud, Viscosity *viscosity);
/* OperatorsDepths - depth (m, [n_total]) of each dummy particle of a solid below the solid's surface; 0 for other
   particles. Not collective. */
void OperatorsDepths(Cloud cloud, PetscReal depth[]);
/* OperatorsApparentViscosity - sets FIELD_VISCOSITY (Pa s) of the fluid, ghosts too, from the shear rates of
   FIELD_VELOCITY at the positions of the last search. The velocity gradient is exact for a velocity that is linear up
   to the faces of walls. viscosity: whether the liquid slips there. No effect in scenes without varying viscosity
   (SceneViscosityVaries), which do not have the field. Collective. */
PetscErrorCode OperatorsApparentViscosity(Cloud cloud, const Viscosity *viscosity);
/* OperatorsVelocityGradient - L ([n_fluid][9], 1/s): L_ij = d v_i/dx_j of FIELD_VELOCITY, the same fit; of rings L_zz
   is v_r/r. Collective. OperatorsWallFraction - of the way from fluid particle a to dummy particle b: the part in front
   of the wall's face, at which that fit has the wall's velocity. a counts as WALL_CLOSEST from the face at least, as in
   the wall's friction. depth: of OperatorsDepths. Not collective. */
PetscErrorCode OperatorsVelocityGradient(Cloud cloud, const Viscosity *viscosity, PetscReal L[]);
/* OperatorsShearRate - the shear rate sqrt(2 D:D) of a velocity gradient L, 1/s. Not collective. */
PetscReal OperatorsShearRate(const PetscReal L[DIM][DIM]);
PetscReal OperatorsWallFraction(Cloud cloud, PetscInt a, PetscInt b, const PetscReal depth[]);
/* OperatorsViscosity - adds the viscous term to FIELD_ACCELERATION of the fluid, m/s2. density: [n_total] kg/m3. With
   the rest density, pairs weigh more where neighbours are missing (FIELD_DENSITY of owned particles and ghosts), so
   that thin sheets have their full viscosity. Walls have their own velocity and the viscosity of their neighbour. A
   varying viscosity is FIELD_VISCOSITY, here and in the linear operator. The form of Morris is divided by the second
   moment in FIELD_CORRECTION: its error on a lattice thus vanishes with the spacing. Collective. */
PetscErrorCode OperatorsViscosity(Cloud cloud, const Viscosity *viscosity, const PetscReal density[]);
/* OperatorsWallDrag - drag[] ([n_total][3], N): the viscous force of this rank's fluid on each dummy particle, ghosts
   too, at rest density. velocity: [n_total][3], m/s. The fluid loses the same momentum through its pairs. Collective.
 */
PetscErrorCode OperatorsWallDrag(Cloud cloud, const Viscosity *viscosity, const PetscReal velocity[], PetscReal drag[]);
#define RIGID_MOTIONS (2 * DIM) /* numbers of the velocity and the angular velocity of a rigid body */
/* OperatorsSolidDivergence - slope[]: derivatives of the divergence (1/s, OperatorsDivergence) of the owned particle a
   by the velocities of a solid (RIGID_MOTIONS, about 'center', m). a is fluid, or a dummy particle of the solid. body:
   of the solid's dummy particles. Not collective. */
void OperatorsSolidDivergence(Cloud cloud, PetscInt a, PetscInt body, const PetscReal center[DIM],
                              PetscReal slope[RIGID_MOTIONS]);
/* OperatorsWallForce - force[] ([n_total][3]): the pressure force (N; N/m in two dimensions) of this rank's fluid on
   each dummy particle and particle that pushes (CloudPushes), ghosts too: -sum V_a V_b (p_a + p_b) grad W over the
   fluid a, the reaction to the force of Adami, Hu and Adams (2012) on the fluid. For rings, the radial component is the
   sum all around. corrected: the pressure gradient is corrected, and the walls receive all momentum that it takes from
   the fluid. Needs OperatorsMoments and the pressures of ghosts. Collective. */
PetscErrorCode OperatorsWallForce(Cloud cloud, PetscBool corrected, PetscReal force[]);
/* OperatorsBeside - u[] ([n_total][3], of owned particles): velocities of liquid that pushes or of solids that move, 0
   elsewhere. Sets them at ghosts, too, and at dummy particles beside, so that the work of the pressure is that of
   OperatorsWallForce times u. The sum of pairs of the liquid in front is the force on a face only with the dummy
   particles beside the face: a column was lifted by 4 % too little, a quarter of a spacing at each wall. So these have,
   along their wall, the mean over the liquid and what moves around them. Collective. */
PetscErrorCode OperatorsBeside(Cloud cloud, PetscReal u[]);
/* OperatorsGrowthFriction - the rate (1/s) of the friction -nu v_r/r^2 of ring a's growth, in forms along the line of
   centres; 0 for other particles. nu: m2/s. The pairs in the plane dissipate mu (2 S:S + (tr S)^2), with the rate of
   strain S in the plane. The liquid is incompressible, so tr S = -v_r/r. The full dissipation is mu (2 S:S + 2
   (v_r/r)^2); mu (v_r/r)^2 remains for the growth. Near the axis the pairs of VISCOSITY_MOMENT have less of it
   (KernelAxisTable), and so has the growth, so that a strain is free of forces. Not collective. */
PetscReal OperatorsGrowthFriction(Cloud cloud, ViscosityForm form, PetscInt a, PetscReal nu);
/* OperatorsViscosityRemainder - adds to FIELD_ACCELERATION the part of the viscous term that OperatorsMoments omits:
   pairs with walls times (wall factor - 1), and the additional weight of pairs where neighbours are missing. Needs
   OperatorsMoments and the densities of ghosts. Not collective. */
PetscErrorCode OperatorsViscosityRemainder(Cloud cloud, const Viscosity *viscosity);
/* The viscous term as a linear operator, for implicit steps.
   OperatorsViscosityRoom - length of pair[]. Not collective.
   OperatorsViscosityPairs - computes pair[] ([OperatorsViscosityRoom]): a coefficient for each pair in the neighbour
   lists of the fluid (cloud->first), as in sum pair (v_ab.r_ab) r_ab (cleary) or sum pair v_ab (morris), then for each
   fluid particle the friction of a ring's growth, 1/s. Uses the factors and positions of the last search. Collective.
   OperatorsViscosityApply - out ([n_fluid][3], m/s2): the operator times a velocity ([n_total][3], m/s), whose ghosts
   it updates. Collective. OperatorsViscosityRow - the same of fluid particle a, with ghosts that are up to date. Not
   collective. OperatorsViscosityDiagonal - the diagonal ([n_fluid][3], 1/s, not positive) of the operator.
 */
PetscInt64     OperatorsViscosityRoom(Cloud cloud);
PetscErrorCode OperatorsViscosityPairs(Cloud cloud, const Viscosity *viscosity, const PetscReal density[],
                                       PetscReal pair[]);
void           OperatorsViscosityRow(Cloud cloud, const Viscosity *viscosity, const PetscReal pair[], PetscInt a,
                                     const PetscReal velocity[], PetscReal out[DIM]);
PetscErrorCode OperatorsViscosityApply(Cloud cloud, const Viscosity *viscosity, const PetscReal pair[],
                                       PetscReal velocity[], PetscReal out[]);
PetscErrorCode OperatorsViscosityDiagonal(Cloud cloud, const Viscosity *viscosity, const PetscReal pair[],
                                          PetscReal diagonal[]);
/* OperatorsCompensationWeights - weight[a] ([n_total], ghosts too) = s_a = m_a/sum_b m_b W_ab over the neighbours b in
   the fluid; 0 for walls and spray. Collective. */
PetscErrorCode OperatorsCompensationWeights(Cloud cloud, PetscReal weight[]);
/* OperatorsCompensate - makes changes ([n_fluid][3], of velocity or acceleration) conserve momentum and angular
   momentum of the fluid at the positions x (m, ghosts current): the neighbours of each particle share the opposite of
   its change, with the compensation weights. dr ([n_fluid][3], m): displacements compensated before in the same way, at
   the velocities u ([n_total][3]); their torque is cancelled, too. NULL: none. Collective. */
PetscErrorCode OperatorsCompensate(Cloud cloud, const PetscReal weight[], const PetscReal x[], const PetscReal dr[],
                                   const PetscReal u[], PetscReal change[]);
/* OperatorsDivergence - div[a] = sum V (v_b - v_a).(B_a grad W_ab), 1/s, for owned particles. corrected: the fluid
   takes B_a, else the identity; walls take the identity, and only their pairs with fluid count. Between fluid and wall
   only the velocity normal to the wall's faces counts: otherwise liquid sliding past the lattice of dummy particles
   would meet a friction that no finer spacing removes (a dam break lost a third of its energy); nor does liquid count
   that leaves a face of a solid that it does not cover. Liquid that pushes
   (CloudPushes) is like a wall, with the whole velocity. velocity: [n_total][3],
   a field of the cloud. time_offset (s): the fluid's divergence is extrapolated to the positions after this time, to
   first order: div v - time_offset tr (grad v)^2. Also for the fluid: gradient [n_owned][9] = sum V (v_b - v_a)_i
   grad_j W, 1/s, without B and walls; jump [n_owned] = largest |v_b - v_a|, m/s. div, gradient and jump may be NULL.
   Collective. */
PetscErrorCode OperatorsDivergence(Cloud cloud, const PetscReal velocity[], PetscBool corrected, PetscReal time_offset,
                                   PetscReal div[], PetscReal gradient[], PetscReal jump[]);

/* OperatorsConnect - finds the pieces of fluid that neighbours closer than 'distance' connect (m; for graded particles
   times the pair's size). parent: [n_total] union-find forest, ghosts too; pieces of other ranks are not yet united. */
void OperatorsConnect(Cloud cloud, PetscReal distance, PetscInt parent[]);
/* OperatorsComponentMinimum - sets each of the 'width' values of a particle, value [n_total][width], to the least in
   its connected piece, over all ranks. The caller sets the values of owned particles. width: 1, 3 or 6. Collective. */
PetscErrorCode OperatorsComponentMinimum(Cloud cloud, const PetscInt parent[], PetscInt width, PetscReal value[]);

#endif
