/* Floor 4: particle operators. Sums over the neighbours of owned particles at the positions of the cloud; ghosts must
   be current for the fields a function reads, and are not updated by it unless it says so. None is collective unless it
   says so. */
#ifndef ISPH_OPERATORS_H
#define ISPH_OPERATORS_H

#include "../neighbors/cloud.h"

/* EtaSquared - eta2 (m2) of the regularised square of a distance, r2 + eta2: see ETA_OVER_H. */
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

/* OperatorsNearWall - whether dummy particles of walls may be within the kernel's support of x (m). */
static inline PetscBool OperatorsNearWall(Cloud cloud, const PetscReal x[DIM])
{
  const Domain    domain = cloud->domain;
  const PetscReal reach  = cloud->size_most * KernelSupport(cloud->kernel);

  if (cloud->solid_normal && SceneSolidDistance(cloud->scene, x, NULL) < reach) return PETSC_TRUE;
  for (PetscInt d = 0; d < domain->dim; d++)
    if ((domain->face[d][0] == FACE_WALL && x[d] < domain->lower[d] + reach) ||
        (domain->face[d][1] == FACE_WALL && x[d] > domain->upper[d] - reach))
      return PETSC_TRUE;
  return PETSC_FALSE;
}

/* lambda, the smallest eigenvalue of a particle's moments M (see OperatorsMoments), is 1 inside the liquid, about 1/2
   on a flat surface and 0 for a lone particle. Spray has at most SPRAY_LAMBDA: it is almost alone, or a sheet or thread
   of one particle (Marrone et al. 2010). It is on the surface without a scan, meets no pressure from its surroundings,
   is not shifted, and no neighbour compensates for it. */
#define SPRAY_LAMBDA 0.2
/* With lambda at most this a particle has too few neighbours for B = M^-1, which then is the identity (no reference).
 */
#define MOMENT_MINIMUM 0.3

/* SymmetricSmallestEigenvalue - of M (xx yy zz xy xz yz), of its upper left 2 x 2 block if dim is 2. */
PetscReal SymmetricSmallestEigenvalue(PetscInt dim, const PetscReal M[6]);

/* SymmetricInverse - B = M^-1 (of the upper left block in 2-d, with B_zz = 1). */
void SymmetricInverse(PetscInt dim, const PetscReal M[6], PetscReal B[6]);

/* Forms of the viscous term. */
typedef enum {
  VISCOSITY_CLEARY, /* Eq. (1) of Kuri et al. (Cleary & Ha), zeta = dim + 2 (5 in 3-d as in the paper, whose 5 would be
                       25 % too viscous in 2-d): along the line of centres, keeps angular momentum */
  VISCOSITY_MORRIS  /* Morris et al. 1997: the plain Laplacian, exact for shear, does not keep angular momentum. At a
                       free surface it is not free of stress: a drop's oscillation loses half of what it should, one of
                       rings a third */
} ViscosityForm;

/* Spacings: nearer to a wall than this the factor on wall friction grows no further. */
#define WALL_CLOSEST 0.25
/* The viscous term: its form, and what pairs of the fluid with walls count for, at distances k/WALL_FACTORS of the
   kernel's support from the wall. A copy of the whole is as good as the original. */
#define WALL_FACTORS 64
typedef struct {
  ViscosityForm form;
  PetscBool     no_slip; /* otherwise all factors are 1 */
  PetscReal     wall_factor[WALL_FACTORS + 1];
} Viscosity;

/* OperatorsDensity - FIELD_DENSITY of owned particles, kg/m3: rho_a = m_a/V_a sum_b V_b W_ab, self included; for one
 * liquid Eq. (4) of Kuri et al. */
PetscErrorCode OperatorsDensity(Cloud cloud);
/* OperatorsMoments - finds the neighbours (CloudSearch) and sums, while each row is in the cache (see moments.c), for
   every owned particle:
     FIELD_DENSITY     as of OperatorsDensity
     FIELD_NORMAL      sum V grad W, 1/m: points into the liquid
     FIELD_CROWDING    sum V (1 + 0.2 (W/W(d0))^4) grad W, 1/m: points to where particles crowd (Lind et al. 2012)
     FIELD_LAMBDA      the smallest eigenvalue of M = -sum V grad W (x) r_ab (Marrone et al. 2010)
     FIELD_CORRECTION  B = M^-1, the identity where lambda <= MOMENT_MINIMUM (Randles & Libersky 1996)
   viscosity: NULL, or one in the form of Cleary; FIELD_ACCELERATION (m/s2) of the fluid then becomes what
   OperatorsViscosity would add to it, but for OperatorsFrictionRest, for half the price; only for OperatorsOneLiquid at
   its rest density. */
PetscErrorCode OperatorsMoments(Cloud cloud, const Viscosity *viscosity);
/* OperatorsOneLiquid - whether all bodies have one density and one viscosity, which does not vary, so that every pair
   has the same coefficient. */
PetscBool OperatorsOneLiquid(Cloud cloud);
/* OperatorsFreeSurface - the free-surface test of Marrone et al. 2010, with a class for particles near the surface (no
   reference): INT_SURFACE of the rows a < n_rows, 1 on the surface (spray, or lambda below 0.75 and no neighbour in the
   cone along the normal), 2 near it, 0 inside. Near it are fluid particles with lambda below 0.75, or below 0.95 and
   within 1.5 spacings of a fluid particle on the surface. Needs OperatorsMoments; updates INT_SURFACE of the ghosts.
   Collective. */
PetscErrorCode OperatorsFreeSurface(Cloud cloud);
/* OperatorsNoSlip - sets the wall factors of a viscosity whose form is known, so that there is no slip: as if the
   velocity went on straight behind the wall's face, at which the liquid sticks (Morris et al. 1997). Dummy particles
   that are at rest as a whole, as the paper has them, put the plane of no slip behind the face, and the first layer of
   particles slides. The factor depends only on the particle's distance from the wall, and is that of a quarter of a
   spacing for nearer ones; so the term remains a symmetric sum over pairs that takes energy. Not collective. */
void OperatorsNoSlip(Cloud cloud, Viscosity *viscosity);
/* OperatorsApparentViscosity - FIELD_VISCOSITY (Pa s) of the fluid, ghosts too, from the shear rates of FIELD_VELOCITY
   at the positions of the last search: the velocity gradient is exact for velocities that are linear up to the faces of
   walls. viscosity: whether liquid slips there. Does nothing where no viscosity varies (SceneViscosityVaries): such
   scenes have no such field. Collective. */
PetscErrorCode OperatorsApparentViscosity(Cloud cloud, const Viscosity *viscosity);
/* OperatorsViscosity - adds the viscous term to FIELD_ACCELERATION of the fluid, m/s2. density: [n_total] kg/m3; with
   the rest density it counts what neighbours are missing at a free surface, by FIELD_DENSITY of owned particles and
   ghosts, so that thin sheets resist with all of their viscosity. Walls have their own velocity and the viscosity of
   their neighbour; a viscosity that varies is FIELD_VISCOSITY, here and in the linear operator. The form of Morris is
   divided by the second moments of FIELD_CORRECTION, so that its error on a lattice vanishes with the spacing.
   Collective. */
PetscErrorCode OperatorsViscosity(Cloud cloud, const Viscosity *viscosity, const PetscReal density[]);
/* OperatorsWallDrag - the viscous force of the fluid of this rank at these velocities ([n_total][3], m/s) on each dummy
   particle of walls, drag[] ([n_total][3], N), ghosts too: what the pairs with it take from the fluid, at rest density.
   Collective. */
PetscErrorCode OperatorsWallDrag(Cloud cloud, const Viscosity *viscosity, const PetscReal velocity[], PetscReal drag[]);
/* OperatorsSolidDivergence - by how much each velocity of a solid (FREE_MOTIONS, about 'center', m) changes the
   divergence (1/s) of OperatorsDivergence of the owned particle a, of the fluid or a dummy of the solid. body: of its
   dummy particles. Not collective. */
void OperatorsSolidDivergence(Cloud cloud, PetscInt a, PetscInt body, const PetscReal center[DIM],
                              PetscReal slope[FREE_MOTIONS]);
/* OperatorsWallPressure - the force (N; N/m in two dimensions) of the fluid's pressure on the dummy particle b of this
   rank: -sum V_a V_b (p_a + p_b) grad W over the fluid a, as Adami, Hu and Adams (2012) have it for the fluid, and the
   force whose work is what the velocity of b adds to sum V p div v. Of rings, the part away from the axis is summed all
   around. Not collective. */
void OperatorsWallPressure(Cloud cloud, PetscInt b, PetscReal force[DIM]);
/* OperatorsWallForce - the same force on each dummy particle, force[] ([n_total][3]), ghosts too, of the fluid of this
   rank; corrected: the gradient of pressure is corrected, and the walls hold what it takes from the fluid. After
   OperatorsMoments; the pressures of ghosts must be current. Collective. */
PetscErrorCode OperatorsWallForce(Cloud cloud, PetscBool corrected, PetscReal force[]);
/* OperatorsFrictionRest - adds to FIELD_ACCELERATION what the viscosity of OperatorsMoments leaves out: the walls' part
   times the wall factor - 1, and what pairs weigh more where neighbours are missing. After OperatorsMoments; densities
   of ghosts must be current. Not collective. */
PetscErrorCode OperatorsFrictionRest(Cloud cloud, const Viscosity *viscosity);
/* The same term as a linear operator, for an implicit solve.
   OperatorsViscosityRoom - how many numbers pair[] has; not collective.
   OperatorsViscosityPairs - pair[] ([OperatorsViscosityRoom]) has a coefficient for each place of the neighbour lists
   of the fluid (cloud->first): cleary sum pair (v_ab.r_ab) r_ab, morris sum pair v_ab; behind them a number for each
   particle of the fluid, 1/s, for the growth of rings; from the factors of the last search, at its positions;
   collective. OperatorsViscosityApply - out ([n_fluid][3], m/s2) of a velocity ([n_total][3], m/s), whose ghosts it
   updates; collective. OperatorsViscosityDiagonal - the operator's diagonal ([n_fluid][3], 1/s, not positive). */
PetscInt64     OperatorsViscosityRoom(Cloud cloud);
PetscErrorCode OperatorsViscosityPairs(Cloud cloud, const Viscosity *viscosity, const PetscReal density[],
                                       PetscReal pair[]);
PetscErrorCode OperatorsViscosityApply(Cloud cloud, const Viscosity *viscosity, const PetscReal pair[],
                                       PetscReal velocity[], PetscReal out[]);
PetscErrorCode OperatorsViscosityDiagonal(Cloud cloud, const Viscosity *viscosity, const PetscReal pair[],
                                          PetscReal diagonal[]);
/* OperatorsCompensationWeights - weight[a] ([n_total]) s_a = m_a/sum_b m_b W_ab over the neighbours b in the fluid, 0
   for walls and spray; ghosts too. Collective. */
PetscErrorCode OperatorsCompensationWeights(Cloud cloud, PetscReal weight[]);
/* OperatorsCompensate - spreads the opposite of each particle's change ([n_fluid][3], of velocity or acceleration) over
   its neighbours, with those weights, and adds what each particle receives to its change: momentum and angular momentum
   of the fluid are kept at positions x (m, ghosts current). dr ([n_fluid][3], m): displacements that were compensated
   in the same way, at velocities u ([n_total][3]), and whose torque is cancelled too; NULL: none. Collective. */
PetscErrorCode OperatorsCompensate(Cloud cloud, const PetscReal weight[], const PetscReal x[], const PetscReal dr[],
                                   const PetscReal u[], PetscReal change[]);
/* OperatorsDivergence - div[a] = sum V (v_b - v_a).(B_a grad W_ab), 1/s, for owned particles; corrected selects B_a or
   the identity for the fluid; walls always take the identity and only pairs with fluid count. Between fluid and wall
   only the velocity normal to the wall's faces counts: liquid that slides past the lattice of dummy particles would
   otherwise see it approach and leave, a friction no finer spacing removes (a dam break lost a third of its energy).
   velocity: [n_total][3], a field of the cloud. time_offset (s): the fluid's divergence is that after the particles
   have moved on for so long with these velocities, to first order: div v - time_offset tr (grad v)^2. On the way, of
   the fluid: gradient [n_owned][9] = sum V (v_b - v_a)_i grad_j W, without B and without walls, 1/s; jump [n_owned] =
   largest |v_b - v_a|, m/s. Each of the three may be NULL. */
PetscErrorCode OperatorsDivergence(Cloud cloud, const PetscReal velocity[], PetscBool corrected, PetscReal time_offset,
                                   PetscReal div[], PetscReal gradient[], PetscReal jump[]);

/* OperatorsJoin - parent [n_total] of the trees of sets: fluid particles, ghosts too, that chains of owned ones connect
   whose neighbours are closer than 'distance' (m; of graded particles times the pair's size). */
void OperatorsJoin(Cloud cloud, PetscReal distance, PetscInt parent[]);
/* OperatorsSpreadLeast - each of the 'width' numbers of a particle, value [n_total][width], given of owned ones,
   becomes the least of its set, on whatever ranks that lies; width: 1, 3 or 6. Collective. */
PetscErrorCode OperatorsSpreadLeast(Cloud cloud, PetscInt parent[], PetscInt width, PetscReal value[]);

#endif
