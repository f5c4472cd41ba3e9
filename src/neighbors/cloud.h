/* Floor 3: the cloud, one rank's view of the particles: its own, then ghosts (of other ranks, of periodic images, of
   mirror images behind symmetry faces), and a list of neighbours for each owned particle.

   The swarm holds the accepted state; the cloud's arrays hold the step in progress. CloudCommit writes back; a rollback
   does not call it. Local order: fluid [0,n_fluid), top wall layer [n_fluid,n_rows), deeper wall layers
   [n_rows,n_owned), ghosts [n_owned,n_total). */
#ifndef ISPH_CLOUD_H
#define ISPH_CLOUD_H

#include "../kernel/kernel.h"
#include "../particles/particles.h"
#include "../scene/scene.h"
#include "cells.h"

typedef struct _p_Halo *Halo;

#define AXIS_TABLE  64 /* of Cloud's axis */
#define SIZE_LEVELS 7  /* levels of sizes of graded particles, by factors of sqrt(2): see CloudLevel */
#define SEARCH_LEVELS                                                                                                  \
  ((SIZE_LEVELS + 1) / 2) /* the search's levels, by factors of 2: the first, then pairs of these levels */

typedef struct _p_WorkArray WorkArray;

typedef struct _p_Cloud {
  MPI_Comm   comm;
  Domain     domain;    /* borrowed */
  Scene      scene;     /* borrowed */
  Kernel     kernel;    /* borrowed */
  Particles  particles; /* borrowed */
  Halo       halo;
  PetscInt   n_fluid, n_rows, n_owned, n_total, capacity;
  PetscReal *field[FIELD_COUNT]; /* [n_total][width], see the table in particles.h */
  PetscInt  *integer[INT_COUNT]; /* [n_total] */
  /* The metric, with which an operator has one text for particles of one size, graded particles and rings. 'volume' is
     of the whole particle, m^dim (m3 of a ring): mass = rest density * volume. Sums over neighbours have the weight V_0
     = d0^dim (Domain's volume) times 'weight', which for a ring is its area over V_0. A pair of particles of different
     sizes has the smoothing length (h_a + h_b)/2 in all sums: then both particles have the same kernel, and a Laplacian
     has no first-order error of the differing lengths. weight, length and relative_weight are at the positions of the
     last search. */
  PetscReal *volume;               /* [n_total] FIELD_VOLUME, = V_0 weight length */
  PetscReal *size;                 /* [n_total] spacing over d0, 1 */
  PetscReal *weight;               /* [n_total] 1 */
  PetscReal *length;               /* [n_total] m, DomainRingLength of a ring; 1 for other particles */
  PetscReal  axis[AXIS_TABLE + 1]; /* 1, of rings: KernelAxisTable */
  PetscReal *relative_weight;      /* [n_total] weight over size^dim: about 1 for rings, whose areas change; of dummy
                                      particles that serve larger liquid (CloudWeighs) less than 1; 1 for others */
  PetscReal  size_most;    /* 1; largest size on all ranks at all times: the largest support over the kernel's */
  PetscReal  volume_most;  /* m^dim, largest volume of a particle on all ranks */
  PetscReal *rest_density; /* [n_total] rho_0 of the particle's body, kg/m3; walls: see OperatorsMoments */
  PetscReal
    *solid_normal; /* [n_total][3] outward normal at dummy particles of solids, zero elsewhere; NULL without solids */
  /* For two immiscible liquids with interface tension; else NULL. The pressure jumps across their interface by the
     difference of pressure_jump on both sides (see CloudPressureJump). TensionApply sets the arrays, the pressure
     solver those of wall particles. */
  PetscInt  *liquid;              /* [n_total] 0 or 1; for a wall particle the liquid next to it, negative: none */
  PetscInt  *at_interface;        /* [n_total] 1: has neighbours of the other liquid, else 0 */
  PetscReal *pressure_jump;       /* [n_total] Pa */
  PetscReal *pressure_jump_slope; /* [n_total][3] its gradient along the interface, Pa/m */
  /* Liquid that pushes: fluid particles with a given velocity, which are boundaries of the pressure equation like dummy
     particles of a wall (1; else 0), [n_total], ghosts too. NULL: none. Owned by the edge that sets it in 'predict'. */
  PetscInt *pushing;
  /* The surface tension of each particle, [n_total] N/m, if it is not that of its body; else NULL. Owned by the edge
     that sets it in 'force' and takes it back in 'surround'. */
  PetscReal *tension;
  /* The neighbours of particle a < n_owned are list[first[a] .. first[a+1]), local indices, without the particle
     itself. pairs.h shows how to write loops over them. */
  PetscInt64 *first, list_capacity; /* a rank may have more pairs than 32 bits count */
  PetscInt   *list;
  /* Factors of the pairs, in the order of the list, at the positions of the last search; without weights the same for
     both particles of a pair (see KernelGradient). slope: F = W'/r over KernelScales' scale_f, times the weight of the
     neighbour; sums multiply with V_0 for all particles. laplacian: the pair's part in a Laplacian, -F r2/(r2 + eta2)
     over scale_f laplacian_unit, for graded particles times size^dim of both, without relative weights; 0
     between two wall particles. It is rounded to sixteen bits because the solver reads it in each iteration; a
     Laplacian with 80 of these weights is exact to 3e-6. */
  float     *slope;
  uint16_t  *laplacian;
  PetscInt  *laplacian_sum;       /* [n_owned] sum over each row */
  PetscReal  laplacian_unit;      /* slope at r = 0 over the largest number of sixteen bits */
  CellGrid   grid[SEARCH_LEVELS]; /* of the last search, over all n_total points, for each level of sizes */
  WorkArray *work;                /* arrays of CloudGetWork, a list */
  PetscReal  margin;              /* m, by which the lists of CloudSearch reach beyond the kernel's support, 0 */
  PetscReal  slack;               /* m, twice the distance that particles may move before the halo is rebuilt */
  PetscReal  reach;               /* m, largest kernel support in use, at size 1 */
  PetscReal *reference;           /* [n_owned][3] positions when the halo was built, m */
  PetscInt   exits[2 * DIM];      /* particles on all ranks that left by each open face since the program's start */
  PetscReal  distance_outside;    /* m, largest distance of particles from their rank's cells when the halo was built */
  PetscInt   sort_interval, since_sort; /* steps between sorts, steps since the last */
  PetscInt   keep_order;                /* steps that keep the local order: 2 in the first of a pair, 1 in the second */
  PetscInt   layout;               /* counts changes of the local order: a preconditioner is valid for one layout */
  PetscInt   written[FIELD_COUNT]; /* layout in which each work field was last written: see CloudWrote */
  PetscInt   halo_builds, migrations, repartitions; /* statistics */
} * Cloud;

/* CloudCreate - finds where the spacing is fine at the start; borrows its first four arguments. reach: largest kernel
   support of any operator (m), at size 1. Collective. */
PetscErrorCode CloudCreate(Domain domain, Scene scene, Kernel kernel, Particles particles, PetscReal reach,
                           Cloud *cloud);
/* CloudSetFromOptions - -sort_interval. Collective. */
PetscErrorCode CloudSetFromOptions(Cloud cloud);
PetscErrorCode CloudDestroy(Cloud *cloud);
/* CloudIdentity - the lines of SceneIdentity and those of the kernel, which must be equal for the use of a checkpoint
   or a packing; to be freed with free(). Not collective, the same on every rank. */
PetscErrorCode CloudIdentity(Cloud cloud, char **text);

/* CloudResync - makes the canonical state from the swarm: partition, migrate, sort, load, halo, neighbours. All that
   follows depends on the stored fields only, so a run continued from a checkpoint written right after this call equals
   the uninterrupted run. CloudReload - the same but for the neighbours, for a caller that searches them. Collective. */
PetscErrorCode CloudResync(Cloud cloud);
PetscErrorCode CloudReload(Cloud cloud);
/* CloudBegin - starts a step: loads the swarm's state, migrates particles when some have moved too far, and chooses the
   ghosts again when the slack is used up. Collective. */
PetscErrorCode CloudBegin(Cloud cloud);
/* CloudMoved - updates the ghosts' positions after those of owned particles changed; if ghosts are chosen again, all
   their fields of a step's start. Collective. */
PetscErrorCode CloudMoved(Cloud cloud);
/* CloudFindSolidNormals - finds solid_normal, ghosts too, at the positions of the cloud; call it again after solids
   have moved. Collective. */
PetscErrorCode CloudFindSolidNormals(Cloud cloud);
/* CloudWallLayers - layers of dummy particles that fill the support of the kernel. CloudWeighs - whether the relative
 * weights are not all 1. Not collective. */
static inline PetscInt CloudWallLayers(Cloud cloud)
{
  return (PetscInt)PetscCeilReal(KernelSupport(cloud->kernel) / cloud->domain->spacing - POINT_TOLERANCE);
}
static inline PetscBool CloudWeighs(Cloud cloud)
{
  return (PetscBool)(cloud->domain->rings || DomainStoresSizes(cloud->domain));
}

/* CloudPairSize - the size of a pair: its smoothing length over the kernel's. Not collective. */
static inline PetscReal CloudPairSize(Cloud cloud, PetscInt a, PetscInt b)
{
  return 0.5 * (cloud->size[a] + cloud->size[b]);
}

/* CloudPressureJump - the pressure (Pa) in the liquid of particle a less that in the liquid of b, a neighbour across
   the interface, at the point x_a + t (x_b - x_a), 0 <= t <= 1. Not collective. */
static inline PetscReal CloudPressureJump(Cloud cloud, PetscInt a, PetscInt b, PetscReal t)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *xa = x + DIM * a, *xb = x + DIM * b,
                  *own = cloud->pressure_jump_slope + DIM * a, *other = cloud->pressure_jump_slope + DIM * b;
  PetscReal jump = cloud->pressure_jump[a] - cloud->pressure_jump[b];

  for (PetscInt d = 0; d < DIM; d++) jump += (t * own[d] + (1 - t) * other[d]) * (xb[d] - xa[d]);
  return jump;
}
/* CloudAcross - whether neighbours a and b are of different immiscible liquids. Not collective. */
static inline PetscBool CloudAcross(Cloud cloud, PetscInt a, PetscInt b)
{
  return (PetscBool)(cloud->liquid[a] + cloud->liquid[b] == 1 && cloud->liquid[a] >= 0 && cloud->liquid[b] >= 0);
}
/* CloudPushes - whether a particle is liquid that pushes. CloudBounds - whether it is that or a dummy particle, so that
   no pressure acts between two such. Not collective. */
static inline PetscBool CloudPushes(Cloud cloud, PetscInt a)
{
  return (PetscBool)(cloud->pushing && cloud->pushing[a]);
}
static inline PetscBool CloudBounds(Cloud cloud, PetscInt a)
{
  return (PetscBool)(cloud->integer[INT_LAYER][a] > 0 || CloudPushes(cloud, a));
}

/* CloudLevelSize - the largest size of a level: a little more than a power of sqrt(2), so that the first level has the
   fine spacing alone. CloudLevel - the level of particle a; the last level has all larger particles, too. Not
   collective. */
static inline PetscReal CloudLevelSize(PetscInt level)
{
  static const PetscReal largest[SIZE_LEVELS] = {1.05, 1.485, 2.1, 2.97, 4.2, 5.94, 8.4};

  return largest[level];
}
static inline PetscInt CloudLevel(Cloud cloud, PetscInt a)
{
  PetscInt level = 0;

  while (level < SIZE_LEVELS - 1 && cloud->size[a] > CloudLevelSize(level)) level++;
  return level;
}

/* RowVisitor - called by CloudSearch for each owned particle a as soon as its row is found, while the row is in the
   cache. w ([n]): KernelSingle's values of W times the weight of the neighbour, like the cloud's slope. The row is
   padded to a multiple of eight with pairs of weight zero (see PairRowLoadFactors). */
typedef void (*RowVisitor)(Cloud cloud, PetscInt a, const float w[], void *context);
/* CloudSearch - finds, at the positions of the cloud, the neighbours of each owned particle (all particles within the
   kernel's support), the factors of the pairs, and weight, length and relative_weight, ghosts too. visit may be NULL.
   Not collective. */
PetscErrorCode CloudSearch(Cloud cloud, RowVisitor visit, void *context);
/* CloudUpdate - gives ghosts the values of a field from their owners, with the sign of the image; refuses fields that
   ghosts do not have. Collective. */
PetscErrorCode CloudUpdate(Cloud cloud, FieldId field);
/* CloudUpdateArray - the same for an array of [n_total][width] numbers of this parity. Collective. */
PetscErrorCode CloudUpdateArray(Cloud cloud, PetscInt width, Parity parity, PetscReal array[]);
/* CloudUpdateInt - the same for an integer field. Collective. */
PetscErrorCode CloudUpdateInt(Cloud cloud, IntFieldId field);
/* CloudUpdateIntArray - the same for an array of [n_total] integers. Collective. */
PetscErrorCode CloudUpdateIntArray(Cloud cloud, PetscInt array[]);
/* CloudCommit - accepts the step: writes the stored fields back to the swarm. The next migration wraps positions beyond
   periodic faces. Removes particles that left through an open face; adds their number on all ranks to *lost, and their
   kinetic and potential energy (J) to *energy unless this is NULL. Collective. */
PetscErrorCode CloudCommit(Cloud cloud, PetscInt *lost, PetscReal *energy);

/* CloudWrote - an operator that writes a work field of all particles of this rank calls it: the field is in the present
   local order. CloudIsCurrent - whether a work field is in the present local order; after a new order all work fields
   are NAN until they are written again. Not collective. */
static inline void CloudWrote(Cloud cloud, FieldId field)
{
  cloud->written[field] = cloud->layout;
}
static inline PetscBool CloudIsCurrent(Cloud cloud, FieldId field)
{
  return (PetscBool)(cloud->written[field] == cloud->layout);
}

/* CloudCheckUnknowns - refuses (UserError) 'width' unknowns for each of n fluid particles on this rank if PETSc cannot
   number the unknowns of all ranks. what: the part that needs them, for the message. Collective. */
PetscErrorCode CloudCheckUnknowns(MPI_Comm comm, PetscInt n, PetscInt width, const char what[]);

/* CloudGetWork - an array with room for [n_total][width] numbers and a vector behind them, contents undefined; give it
   back with CloudRestoreWork, which keeps it for the next caller. If ghosts are chosen again in between, there may be
   more of them than the array has room for; its first n_owned rows stay valid. Not collective. */
PetscErrorCode CloudGetWork(Cloud cloud, PetscInt width, PetscReal **array);
PetscErrorCode CloudRestoreWork(Cloud cloud, PetscReal **array);

#endif
