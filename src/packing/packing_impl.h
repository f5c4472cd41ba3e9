/* Private to packing/: what a type of packing provides, and how particles are made. */
#ifndef ISPH_PACKING_TYPES_H
#define ISPH_PACKING_TYPES_H

#include "../neighbors/pairs.h"
#include "samples.h"

/* A type: one file and one line in packing.c. Entries other than visit may be NULL. */
typedef struct {
  Choice choice;                                                   /* its owner is the packing */
  PetscErrorCode (*setup)(Packing packing, PackingReport *report); /* before the visits; collective */
  SampleSource visit; /* the fluid, with the ids 0, 1, ...; the source is the packing */
  PetscErrorCode (*improve)(Packing packing, PackingReport *report); /* moves the particles in the cloud; collective */
  PetscErrorCode (*destroy)(Packing packing);
} PackingOps;

struct _p_Packing {
  Cloud             cloud; /* borrowed */
  char              type[OPTION_WORD_LENGTH];
  const PackingOps *ops;
  void             *data; /* of the type */
  PetscInt          seed;
  PetscBool         rough; /* see PackingSetRough */
  PetscInt          count; /* fluid particles, over all ranks */
  char              cache[PETSC_MAX_PATH_LEN];
  PetscInt          graded_count[2]; /* with -spacing_coarse: particles of liquid and of walls */
  Sample           *graded[2];       /* [graded_count], NULL until GradedSetUp */
};

extern const PackingOps PackingLattice, PackingPoisson;

/* A lattice: point i of direction d is at origin[d] + i pitch[d] (m), 0 <= i < n[d]. Its points are numbered as the
   cells of a box are (CellIndex). */
typedef struct {
  PetscInt  n[DIM];
  PetscReal origin[DIM], pitch[DIM];
} Lattice;

static inline PetscInt LatticeCount(const Lattice *lattice)
{
  return lattice->n[0] * lattice->n[1] * lattice->n[2];
}

#define POINTS_ALIVE 65536
/* LatticePoint - the position x (m) of a point; a sign of life now and then, since a loop over all may take minutes.
   Not collective. */
static inline void LatticePoint(const Lattice *lattice, PetscInt point, PetscReal x[DIM])
{
  PetscInt at[DIM];

  if (point % POINTS_ALIVE == 0) InterruptAlive(NULL);
  CellCoordinates(lattice->n, point, at);
  for (PetscInt d = 0; d < DIM; d++) x[d] = lattice->origin[d] + at[d] * lattice->pitch[d];
}

/* LatticeOfBox - the lattice of the spacing (m) inside the box. Between two closed faces the pitch is fitted to the
   box; else it is the spacing, and the lattice starts at the closed face, if there is one. LatticeOfBody - see
   lattice.c. Not collective. */
void LatticeOfBox(Domain domain, PetscReal spacing, Lattice *lattice);
void LatticeOfBody(Domain domain, PetscReal spacing, Body body, Lattice *lattice);
/* LatticeShake - displaces a sample of a body at random, by at most the jitter times its own spacing (m), ROUGH_JITTER
   of it within a spacing of the body's surface, where the body holds its liquid and with PackingSetRough, and into the
   box. LatticeFit - finds the level of each body (FitLevel), and length: the length (m) of all rings of each body, its
   volume over the area of a lattice cell. Collective. LatticeBelongs - whether point number 'point' of body b's
   lattice, at x (m), is a particle of the body. Not collective. */
void           LatticeShake(Packing packing, PetscReal spacing, Sample *sample);
PetscErrorCode LatticeFit(Packing packing, PetscReal level[SCENE_MAX_BODIES], PetscReal length[SCENE_MAX_BODIES]);
PetscBool LatticeBelongs(Packing packing, const PetscReal level[], PetscInt b, PetscInt point, const PetscReal x[DIM]);

/* Dummy particles, 'layers' deep: the source of WallVisit and SolidVisit. WallVisit - of all wall faces: the box's
   lattice, continued beyond the box, edges and corners included; the parent of a deeper particle is the nearest
   particle of the top layer, 1. SolidVisit - of the solids, each on points of its own (solids.c), each with a pressure
   of its own. Each rank passes its share of the points. Collective. */
typedef struct {
  Cloud    cloud;
  PetscInt layers;
} Dummies;
PetscErrorCode WallVisit(void *source, SampleVisitor visitor, void *context);
PetscErrorCode SolidVisit(void *source, SampleVisitor visitor, void *context);
/* A part of space to be filled with particles of the spacing RegionSpacing: a body, or a face, edge or corner of the
   box, behind which the walls continue it. */
typedef struct {
  PetscReal x[DIM], measure; /* m; m^dim of the region */
  PetscBool fixed;           /* on a lattice */
  PetscInt  layer;           /* of a solid: it stays layer - 1/2 spacings below the surface; 0: it is free */
} RegionPoint;
typedef struct {
  Packing          packing;
  PetscInt         dim;                    /* number of directions in which the region extends */
  PetscBool        along[DIM];             /* these directions */
  PetscReal        lower[DIM], upper[DIM]; /* m */
  PetscInt         body;                   /* -1: the block from lower to upper, or the solid */
  Body             solid;                  /* NULL: no solid */
  const PetscReal *level;                  /* of LatticeFit */
  PetscReal        coarsest;               /* largest spacing, m */
  Lattice          fine, coarse;           /* with one point in other directions */
  PetscInt         n;
  RegionPoint     *point; /* [n] */
} Region;
/* RegionSpacing - the spacing (m) of the region's particles at x (m): SceneSpacing, at most the coarsest. Not
   collective. */
static inline PetscReal RegionSpacing(const Region *region, const PetscReal x[DIM])
{
  return PetscMin(region->coarsest, SceneSpacing(region->packing->cloud->scene, x));
}
/* RegionFill - makes the points of the region: on the fine lattice where RegionSpacing is fine, on the coarse lattice
   where it is coarse, between them at that spacing. The caller frees 'point' with PetscFree. The same on every rank.
   Collective. */
PetscErrorCode RegionFill(Region *region);
/* RegionSpread - moves the points that are not fixed, which come last, until they are spread evenly. The same on every
 * rank. Collective. */
PetscErrorCode RegionSpread(Region *region);

/* GradedSetUp - the particles of liquid and walls with -spacing_coarse, the same on every rank. GradedVisit,
   GradedVisitWalls - SampleSources of the liquid and of the walls. GradedDestroy - frees the particles. */
PetscErrorCode GradedSetUp(Packing packing);
PetscErrorCode GradedVisit(void *source, SampleVisitor visitor, void *context);
PetscErrorCode GradedVisitWalls(void *source, SampleVisitor visitor, void *context);
PetscErrorCode GradedDestroy(Packing packing);

/* PackingCheckMemory - refuses (UserError) a scene with more particles than the ranks' machines have memory for.
   Collective. */
PetscErrorCode PackingCheckMemory(Packing packing);
/* PackingMeasure - sums the densities of all particles of the cloud, Eq. (4) of Kuri et al. with the particle's own
   rest density, so that two liquids in contact are at rest; fills the report. Collective. */
PetscErrorCode PackingMeasure(Packing packing, PackingReport *report);

/* The goal of the optimiser, and what it reached. */
typedef struct {
  PetscReal distance;   /* smallest allowed, in spacings */
  PetscReal tolerance;  /* standard deviation of the density to reach, over rho_0 */
  PetscReal deviation;  /* reached, over rho_0 */
  PetscInt  iterations; /* of TAO */
} PackingTarget;

/* PackingOptimise - moves the fluid particles of the cloud until the standard deviation of their density is small and
   no two are closer than the smallest distance. The swarm gets the result. Collective. */
PetscErrorCode PackingOptimise(Cloud cloud, PackingTarget *target);

/* PoissonSample - random samples of all bodies, V / d0^dim in each body, as far apart as darts get them; the samples
   nearest to a free surface are half a spacing deep. The same on every rank. The caller frees x ([n][3], m) and body
   ([n]) with PetscFree. Not collective. */
PetscErrorCode PoissonSample(Packing packing, PetscInt *n, PetscReal **x, PetscInt **body);

/* PackingHash - a hash of all that determines a packing: CloudIdentity, and a text 'how' it is made. Not collective. */
PetscErrorCode PackingHash(Packing packing, const char how[], unsigned long long *hash);
/* CacheRead - positions ([n][3], m) and bodies ([n]) of the packing with this hash; n = 0 without a file that holds a
   packing of the scene. The caller frees both with PetscFree. Collective. */
PetscErrorCode CacheRead(Cloud cloud, const char folder[], unsigned long long hash, PetscInt *n, PetscReal **x,
                         PetscInt **body);
/* CacheWrite - writes the fluid particles of the swarm, 'count' over all ranks. A folder that cannot be written is no
   error. Collective. */
PetscErrorCode CacheWrite(Particles particles, MPI_Comm comm, const char folder[], unsigned long long hash,
                          PetscInt count);

#endif
