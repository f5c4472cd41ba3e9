/* Private to packing/: what a type of packing provides, and the lattice that fluid and walls share. */
#ifndef ISPH_PACKING_TYPES_H
#define ISPH_PACKING_TYPES_H

#include "../neighbors/pairs.h"
#include "packing.h"

/* Points this close to a boundary, in spacings, count as on it: far below any jitter, far above rounding. */
#define ROUNDING 1e-6

/* Sees one sample: its id, the index of its body, its position (m). */
typedef void (*PackingVisitor)(void *context, PetscInt id, PetscInt body, const PetscReal x[DIM]);

/* What an emitter brings each time. */
typedef struct {
  PetscInt   n, done; /* points; emissions so far */
  PetscReal *x;       /* [n][3] m; NULL: not yet known */
} Emission;

/* A type: one file and one line in packing.c. Entries other than visit may be NULL. */
typedef struct {
  PetscErrorCode (*setfromoptions)(Packing     packing,
                                   OptionItems PetscOptionsObject); /* reads, inside an options block */
  PetscErrorCode (*check)(Packing packing);                         /* refuses bad numbers */
  PetscErrorCode (*setup)(Packing packing, PackingReport *report);  /* before the visits; collective */
  /* Shows every sample of the scene to the visitor, in the order of the ids 0, 1, ...; all of them on each rank. */
  PetscErrorCode (*visit)(Packing packing, PackingVisitor visitor, void *context);
  PetscErrorCode (*improve)(Packing packing, PackingReport *report); /* moves the particles in the cloud; collective */
  PetscErrorCode (*destroy)(Packing packing);
} PackingOps;

struct _p_Packing {
  Cloud      cloud; /* borrowed */
  char       type[64];
  PackingOps ops;
  void      *data; /* of the type */
  PetscInt   seed;
  PetscInt   count; /* samples of the scene, over all ranks */
  char       cache[PETSC_MAX_PATH_LEN];
  Emission   emission[SCENE_MAX_BODIES];
};

PetscErrorCode PackingCreate_Lattice(Packing packing);
PetscErrorCode PackingCreate_Poisson(Packing packing);

/* The lattice of the box: point i of direction d is at origin[d] + i pitch[d] (m), 0 <= i < n[d] inside the box.
   Between two closed faces the pitch is fitted to the box, else it is the spacing, counted from the closed face if
   there is one. */
typedef struct {
  PetscInt  n[DIM];
  PetscReal origin[DIM], pitch[DIM];
} BoxLattice;

/* BoxLatticeSetUp - not collective. */
void BoxLatticeSetUp(Domain domain, BoxLattice *lattice);
/* PackingConfine - takes x (m) back into the box: wraps, mirrors, or puts it just inside an open face or a wall. Not
   collective. */
void PackingConfine(Domain domain, PetscReal x[DIM]);
/* PackingWallLayers - layers of dummy particles that fill the support of the kernel. Not collective. */
PetscInt PackingWallLayers(Cloud cloud);
/* WallWeigh - adds the dummy particles of the walls to the number of particles of each cell, weight [cells]. Not
   collective. */
void WallWeigh(Domain domain, PetscInt layers, PetscInt weight[]);

/* LatticeVisitBody - shows the lattice points of one body. Collective. */
PetscErrorCode LatticeVisitBody(Packing packing, PetscInt body, PackingVisitor visitor, void *context);
/* EmissionsDestroy - frees what emitters bring. */
PetscErrorCode EmissionsDestroy(Packing packing);
/* SolidWeigh, SolidCreateParticles - as WallWeigh and WallCreateParticles, of the solids: points of the box's lattice
   inside them, at most 'layers' spacings deep; each is a top layer with a pressure of its own. */
void           SolidWeigh(Domain domain, Scene scene, PetscInt layers, PetscInt weight[]);
PetscErrorCode SolidCreateParticles(Particles particles, Domain domain, Scene scene, PetscInt layers, PetscInt first_id,
                                    PetscInt *count);

/* PackingRow - loads the row of particle a at the cloud's positions, with kernel values W. Returns the volume fraction
   V_0 (W(0) + sum_b W_ab), dimensionless: the density over rho_0. Not collective. */
PetscReal PackingRow(Cloud cloud, PetscInt a, PairRow *row);

/* Shown to the optimiser and given back by it. */
typedef struct {
  PetscReal distance;   /* smallest allowed, in spacings */
  PetscReal tolerance;  /* standard deviation to reach, over rho_0 */
  PetscReal deviation;  /* reached, over rho_0 */
  PetscInt  iterations; /* of TAO */
} PackingTarget;

/* PackingOptimise - moves the fluid particles of the cloud until the standard deviation of their density is small and
   none is closer to another than the smallest distance; leaves the result in the swarm. Collective. */
PetscErrorCode PackingOptimise(Cloud cloud, PackingTarget *target);

/* PoissonSample - random samples of all bodies, V / d0^dim each, as far apart as darts get them. The caller frees x
   ([n][3], m) and body ([n]) by PetscFree. Not collective; the same everywhere. */
PetscErrorCode PoissonSample(Packing packing, PetscInt *n, PetscReal **x, PetscInt **body);

/* Dummy particles of walls and solids are visited twice: DummyWeigh counts them, in all, of this rank and a cell of the
   domain; then room is made and they are filled in. */
typedef struct {
  Domain         domain;
  PetscMPIInt    rank;
  PetscInt      *weight;     /* [cells] or NULL */
  PetscInt       own, count; /* seen: of this rank, of all */
  PetscInt       next, first_id;
  ParticleArrays arrays;
} DummyFilling;

static inline void DummyWeigh(DummyFilling *filling, const PetscReal x[DIM])
{
  const PetscInt cell = DomainCell(filling->domain, x);

  filling->count++;
  if (filling->domain->cell_rank[cell] == filling->rank) filling->own++;
  if (filling->weight) filling->weight[cell]++;
}

/* PackingHash - 64 bits of everything that determines a packing: box, kernel, shapes, and the 'n' numbers of the type.
   Not collective. */
PetscErrorCode PackingHash(Packing packing, PetscInt n, const PetscReal numbers[], unsigned long long *hash);
/* HashText - the hash continued with a text. Not collective. */
void HashText(unsigned long long *hash, const char text[]);
/* CacheRead - positions ([n][3], m) and bodies ([n]) of the packing of this hash; n = 0 if there is no sound file. The
   caller frees by PetscFree. Collective. */
PetscErrorCode CacheRead(MPI_Comm comm, const char folder[], unsigned long long hash, PetscInt *n, PetscReal **x,
                         PetscInt **body);
/* CacheWrite - writes the fluid particles of the swarm, 'count' over all ranks; a folder that cannot be written is no
   error. Collective. */
PetscErrorCode CacheWrite(Particles particles, MPI_Comm comm, const char folder[], unsigned long long hash,
                          PetscInt count);

#endif
