/* Floor 3: the cloud, what one rank sees of the particles: its own, then ghosts (of other ranks, of periodic images, of
   mirror images behind symmetry faces), with a list of neighbours for every particle that has a row.

   The swarm holds the accepted state; the cloud's arrays hold the step in progress. CloudCommit writes back; not
   calling it is the rollback. Local order: fluid [0,n_fluid), top wall layer [n_fluid,n_rows), deeper wall layers
   [n_rows,n_owned), ghosts [n_owned,n_total). */
#ifndef ISPH_CLOUD_H
#define ISPH_CLOUD_H

#include "../kernel/kernel.h"
#include "../particles/particles.h"
#include "../scene/scene.h"
#include "cells.h"

typedef struct _p_Halo *Halo;

#define SIZE_LEVELS   5                       /* of graded particles by factors of sqrt(2) in size: see CloudLevel */
#define SEARCH_LEVELS ((SIZE_LEVELS + 1) / 2) /* by factors of 2: the first, then two of these each */

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
     of the whole particle, m^dim (m3 of a ring): mass = rest density * volume. Sums over neighbours weight with V_0 =
     d0^dim (Domain's volume) times 'weight', of a ring its area over V_0. The pair of particles of different sizes has
     the smoothing length (h_a + h_b)/2 in all sums: then a pair's kernel is the same for both, and the first-order
     error that differing lengths make in a Laplacian vanishes. weight, length and share are those of the positions of
     the last search. */
  PetscReal *volume;       /* [n_total] FIELD_VOLUME, = V_0 weight length */
  PetscReal *size;         /* [n_total] spacing over d0, 1 */
  PetscReal *weight;       /* [n_total] 1 */
  PetscReal *length;       /* [n_total] m, of rings DomainRingLength; of other particles 1 */
  PetscReal *share;        /* [n_total] weight over size^dim: about 1 of rings, whose areas change, of others 1 */
  PetscReal  size_most;    /* 1; of all ranks and times: supports are at most so much wider than the kernel's */
  PetscReal  volume_most;  /* m^dim, largest volume of a particle of any rank */
  PetscReal *rest_density; /* [n_total] rho_0 of the particle's body, kg/m3; of the first body for walls */
  PetscReal
    *solid_normal; /* [n_total][3] out of the solid, at its dummy particles, zero elsewhere; NULL without solids */
  /* Two liquids that do not mix, with a tension between them; NULL otherwise. The pressure jumps across their interface
     by 'jump' on the one side less that on the other (see CloudJump). Set by TensionApply, of wall particles by the
     pressure solver. */
  PetscInt  *liquid;     /* [n_total] 0 or 1; of a wall particle that of the liquid next to it, negative: none */
  PetscInt  *meets;      /* [n_total] 1: it has neighbours of the other liquid, else 0 */
  PetscReal *jump;       /* [n_total] Pa */
  PetscReal *jump_slope; /* [n_total][3] of it along the interface, Pa/m */
  /* The neighbours of particle a < n_owned are list[first[a] .. first[a+1]), local indices, without the particle
     itself. pairs.h shows how to write loops over them. */
  PetscInt64 *first, list_capacity; /* a rank may have more pairs than 32 bits count */
  PetscInt   *list;
  /* Factors of the pairs, in the order of the list, at the positions of the last search; without weights the same for
     both particles of a pair (see KernelGradient). slope: F = W'/r over KernelScales' scale_f, times the weight of the
     neighbour: sums take V_0 as if it were the volume of all. laplacian, of rings without weights: the pair's part in a
     Laplacian, -F r2/(r2 + eta2) over scale_f laplacian_unit, of graded particles times size^dim of both, and 0 between
     two wall particles. It is rounded to sixteen bits because the solver reads it in every iteration; a Laplacian with
     80 such weights is right to 3e-6. */
  float     *slope;
  uint16_t  *laplacian;
  PetscInt  *laplacian_sum;       /* [n_owned], of each row */
  PetscReal  laplacian_unit;      /* slope at r = 0 over the largest number of sixteen bits */
  CellGrid   grid[SEARCH_LEVELS]; /* of the last search, over all n_total points, by their sizes */
  WorkArray *work;                /* of CloudGetWork, a list */
  PetscReal  slack;               /* m, twice the distance that particles may move before the halo is built again */
  PetscReal  reach;               /* m, largest kernel support in use, of size 1 */
  PetscReal *reference;           /* [n_owned][3] positions when the halo was built, m */
  PetscReal  distance_outside;    /* m, how far particles were outside their rank's cells when the halo was built */
  PetscInt   sort_interval, since_sort; /* steps between sorts, steps since the last */
  PetscInt   layout;               /* counts changes of the local order: a preconditioner is valid for one layout */
  PetscInt   written[FIELD_COUNT]; /* of each work field the layout in which it was last written: see CloudWrote */
  PetscInt   halo_builds, migrations, repartitions; /* statistics */
} * Cloud;

/* CloudCreate - borrows the four; reach = largest kernel support any operator will use (m), of size 1.
   Collective. */
PetscErrorCode CloudCreate(Domain domain, Scene scene, Kernel kernel, Particles particles, PetscReal reach,
                           Cloud *cloud);
/* CloudSetFromOptions - -halo_slack (in spacings), -sort_interval. Collective. */
PetscErrorCode CloudSetFromOptions(Cloud cloud);
PetscErrorCode CloudDestroy(Cloud *cloud);
/* CloudIdentity - the lines of SceneIdentity and the same of the kernel: what a checkpoint and a packing must have been
   made for to be used; to be freed with free(). Not collective, the same on every rank. */
PetscErrorCode CloudIdentity(Cloud cloud, char **text);

/* CloudResync - canonical state from the swarm: partition, migrate, sort, load, halo, neighbours. What happens
   afterwards depends on the stored fields only, so a run continued from a checkpoint written right after this equals
   the uninterrupted one. Collective. */
PetscErrorCode CloudResync(Cloud cloud);
/* CloudBegin - starts a step: loads the swarm's state, migrates when particles have strayed too far, chooses the ghosts
   again when the slack is used up. Collective. */
PetscErrorCode CloudBegin(Cloud cloud);
/* CloudMoved - call after positions of owned particles changed: updates the ghosts' positions (all fields of a step's
   start if they had to be chosen again). Collective. */
PetscErrorCode CloudMoved(Cloud cloud);
/* CloudFindSolidNormals - solid_normal, ghosts too, at the positions of the cloud: again after solids have moved.
   Collective. */
PetscErrorCode CloudFindSolidNormals(Cloud cloud);
/* CloudPairSize - the size of a pair: its smoothing length over the kernel's. CloudPairMeasure - V_a V_b of a pair in
   sums over the plane, m^2dim; of rings times the length of the ring half-way between, m^(2dim + 1). Not collective. */
static inline PetscReal CloudPairSize(Cloud cloud, PetscInt a, PetscInt b)
{
  return 0.5 * (cloud->size[a] + cloud->size[b]);
}
static inline PetscReal CloudPairMeasure(Cloud cloud, PetscInt a, PetscInt b)
{
  const PetscReal *x = cloud->field[FIELD_POSITION];

  return cloud->weight[a] * (cloud->weight[b] * PetscSqr(cloud->domain->volume)) *
         DomainPairLength(cloud->domain, x + DIM * a, x + DIM * b);
}

/* CloudJump - by how much (Pa) the pressure is higher in the liquid of particle a than in that of b, a neighbour of the
   other liquid, at the place x_a + t (x_b - x_a) between them, 0 <= t <= 1. Not collective. */
static inline PetscReal CloudJump(Cloud cloud, PetscInt a, PetscInt b, PetscReal t)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *xa = x + DIM * a, *xb = x + DIM * b,
                  *own = cloud->jump_slope + DIM * a, *other = cloud->jump_slope + DIM * b;
  PetscReal jump = cloud->jump[a] - cloud->jump[b];

  for (PetscInt d = 0; d < DIM; d++) jump += (t * own[d] + (1 - t) * other[d]) * (xb[d] - xa[d]);
  return jump;
}
/* CloudMeets - whether neighbours a and b are of different liquids that do not mix. Not collective. */
static inline PetscBool CloudMeets(Cloud cloud, PetscInt a, PetscInt b)
{
  return (PetscBool)(cloud->liquid[a] + cloud->liquid[b] == 1 && cloud->liquid[a] >= 0 && cloud->liquid[b] >= 0);
}

/* CloudLevelSize - the largest size in a level of sizes: a little more than a power of sqrt(2), so that the fine
   spacing is alone in the first. CloudLevel - the level of particle a; the last has all that are larger, too. Not
   collective. */
static inline PetscReal CloudLevelSize(PetscInt level)
{
  static const PetscReal largest[SIZE_LEVELS] = {1.05, 1.485, 2.1, 2.97, 4.2};

  return largest[level];
}
static inline PetscInt CloudLevel(Cloud cloud, PetscInt a)
{
  PetscInt level = 0;

  while (level < SIZE_LEVELS - 1 && cloud->size[a] > CloudLevelSize(level)) level++;
  return level;
}

/* RowVisitor - what CloudSearch calls for each owned particle a as soon as its row is found, while the row is in the
   cache. w ([n]) are KernelSingle's values of W; slope_over_r2 ([n]) are its F over r2/h2 + eta2/h2; both times the
   weight of the neighbour, as the cloud's slope is. The row is padded
   to a multiple of eight with pairs that weigh nothing, here too (see PairRowLoadFactors). */
typedef void (*RowVisitor)(Cloud cloud, PetscInt a, const float w[], const float slope_over_r2[], void *context);
/* CloudSearch - finds the neighbours of each owned particle, which are all particles within the kernel's support, from
   the positions of the cloud, and the factors of the pairs; weight, length and share, ghosts too. visit may be NULL.
   Not collective. */
PetscErrorCode CloudSearch(Cloud cloud, RowVisitor visit, void *context);
/* CloudUpdate - ghosts take the values of a field from their owners, with the sign of their image; refuses fields that
   have none. Collective. */
PetscErrorCode CloudUpdate(Cloud cloud, FieldId field);
/* CloudUpdateArray - the same for an array of [n_total][width] numbers of this parity. Collective. */
PetscErrorCode CloudUpdateArray(Cloud cloud, PetscInt width, Parity parity, PetscReal array[]);
/* CloudUpdateInt - the same for an integer field. Collective. */
PetscErrorCode CloudUpdateInt(Cloud cloud, IntFieldId field);
/* CloudUpdateIntArray - the same for an array of [n_total] integers. Collective. */
PetscErrorCode CloudUpdateIntArray(Cloud cloud, PetscInt array[]);
/* CloudCommit - the step is accepted: stored fields go back to the swarm. Positions beyond periodic faces are wrapped
   with the next migration. Particles that left through an open face are removed; their number on all ranks is added to
   *lost, their kinetic and potential energy (J) to *energy (NULL: not wanted). Collective. */
PetscErrorCode CloudCommit(Cloud cloud, PetscInt *lost, PetscReal *energy);

/* CloudWrote - for the operator that writes a work field of all particles of this rank: its numbers are those of the
   present local order. CloudIsCurrent - whether those of a work field still are: a new order leaves all work fields NAN
   until they are written again. Not collective. */
static inline void CloudWrote(Cloud cloud, FieldId field)
{
  cloud->written[field] = cloud->layout;
}
static inline PetscBool CloudIsCurrent(Cloud cloud, FieldId field)
{
  return (PetscBool)(cloud->written[field] == cloud->layout);
}

/* CloudCheckUnknowns - refuses (UserError) 'width' unknowns for each fluid particle of n on this rank if PETSc cannot
   number those of all ranks; what: needs them, for the sentence. Collective. */
PetscErrorCode CloudCheckUnknowns(MPI_Comm comm, PetscInt n, PetscInt width, const char what[]);

/* CloudGetWork - an array with room for [n_total][width] numbers and a vector behind them, contents undefined, for the
   use of one function, which gives it back with CloudRestoreWork. The arrays are kept for the next caller. Ghosts
   chosen anew in between may be more than it has room for; its first n_owned rows stay. Not collective. */
PetscErrorCode CloudGetWork(Cloud cloud, PetscInt width, PetscReal **array);
PetscErrorCode CloudRestoreWork(Cloud cloud, PetscReal **array);

#endif
