/* Floor 2: the particles, held by a DMSwarm (DMSWARM_BASIC). The one folder that touches DMSwarm.

   THE field table. Stored fields live in the swarm: they migrate, are written to checkpoints and define the state
   completely. Work fields live only in the Cloud (floor 3), over owned particles and ghosts, during a step. A line:
   identifier, name, width (numbers a particle), parity under a mirror, unit, meaning. */
#ifndef ISPH_PARTICLES_H
#define ISPH_PARTICLES_H

#include "../domain/domain.h"

/* How a field changes in the image of a particle behind a periodic or symmetry face. */
typedef enum {
  PARITY_SCALAR, /* unchanged */
  PARITY_POINT,  /* shifted or mirrored as a point */
  PARITY_VECTOR, /* the component normal to the mirror changes sign */
  PARITY_AXIAL,  /* a torque or a rotation: the components along the mirror change sign */
  PARITY_TENSOR, /* symmetric, xx yy zz xy xz yz: off-diagonals change sign with each mirror they are normal to */
  PARITY_NONE    /* has no image: owned particles only */
} Parity;

#define STORED_REALS(X)                                                                                                \
  X(POSITION, "position", 3, PARITY_POINT, "m", "position")                                                            \
  X(VELOCITY, "velocity", 3, PARITY_VECTOR, "m/s", "velocity")                                                         \
  X(PRESSURE, "pressure", 1, PARITY_SCALAR, "Pa", "pressure of the last projection; start value of the next")          \
  X(DENSITY, "density", 1, PARITY_SCALAR, "kg/m3", "summed density, Eq. (4) of Kuri et al.")                           \
  X(LAMBDA, "lambda", 1, PARITY_SCALAR, "1", "smallest eigenvalue of the renormalisation matrix (Marrone et al.)")     \
  X(VOLUME, "volume", 1, PARITY_SCALAR, "m3", "volume, of a ring the whole; stored where they differ")                 \
  X(SIZE, "size", 1, PARITY_SCALAR, "1", "spacing over the finest, of graded rings: that which their areas are about") \
  X(VISCOSITY, "viscosity", 1, PARITY_SCALAR, "Pa s",                                                                  \
    "viscosity in the last step; stored where the shear rate changes that of a body")

#define STORED_INTS(X)                                                                                                 \
  X(ID, "id", "identity, unique and permanent")                                                                        \
  X(BODY, "body", "index of the body in -bodies; -1: dummy of a wall of the box; -2, -3, ...: of a solid")             \
  X(LAYER, "layer", "0: fluid; 1: top layer of a wall, solved; 2, 3, ...: deeper layers, slaved")                      \
  X(PARENT, "parent", "id of the top-layer particle a deeper wall particle takes its pressure from; own id otherwise") \
  X(SURFACE, "surface", "1: on the free surface, 2: near it, 0: inside")

/* Ids of the particles that emitters bring start here: the same after a restart, and whatever else makes particles. */
#define EMITTED_ID (PETSC_MAX_INT / 2)

#define BODY_WALL  (-1)
#define BODY_SOLID (-2) /* of the first of -solids; -3 of the second, and so on */

#define WORK_REALS(X)                                                                                                  \
  X(POSITION_NEW, "position_new", 3, PARITY_POINT, "m", "position at the end of the step")                             \
  X(VELOCITY_STAR, "velocity_star", 3, PARITY_VECTOR, "m/s", "velocity after all forces but the pressure")             \
  X(VELOCITY_NEW, "velocity_new", 3, PARITY_VECTOR, "m/s", "velocity at the end of the step")                          \
  X(ACCELERATION, "acceleration", 3, PARITY_VECTOR, "m/s2", "sum of viscosity, tension and body force")                \
  X(CORRECTION, "correction", 6, PARITY_TENSOR, "1", "renormalisation matrix B")                                       \
  X(NORMAL, "normal", 3, PARITY_VECTOR, "1/m", "sum of V grad W: points into the liquid")                              \
  X(CROWDING, "crowding", 3, PARITY_VECTOR, "1/m", "sum of V (1 + 0.2 (W/W(d0))^4) grad W: shifting goes against it")  \
  X(DIVERGENCE, "divergence", 1, PARITY_NONE, "1/s", "corrected divergence of velocity_star")                          \
  X(VELOCITY_GRADIENT, "velocity_gradient", 9, PARITY_NONE, "1/s",                                                     \
    "sum V (v_b - v_a)_i grad_j W over the fluid, of velocity_star")                                                   \
  X(VELOCITY_JUMP, "velocity_jump", 1, PARITY_NONE, "m/s", "largest |v_b - v_a| of neighbours, of velocity_star")      \
  X(CAPILLARY, "capillary", 1, PARITY_SCALAR, "Pa", "pressure of surface tension on the free surface, sigma kappa")    \
  X(CAPILLARY_SLOPE, "capillary_slope", 3, PARITY_VECTOR, "Pa/m", "its gradient along the surface")

#define FIELD_ENUM_REAL(id, name, width, parity, unit, meaning) FIELD_##id,
#define FIELD_ENUM_INT(id, name, meaning)                       INT_##id,
typedef enum {
  STORED_REALS(FIELD_ENUM_REAL) FIELD_STORED_COUNT,
  FIELD_STORED_LAST = FIELD_STORED_COUNT - 1,
  WORK_REALS(FIELD_ENUM_REAL) FIELD_COUNT
} FieldId;
typedef enum { STORED_INTS(FIELD_ENUM_INT) INT_COUNT } IntFieldId;

typedef struct {
  const char *name;
  PetscInt    width;
  Parity      parity;
  const char *unit;
  const char *meaning;
} FieldInfo;

extern const FieldInfo   Fields[FIELD_COUNT];
extern const char *const IntFieldNames[INT_COUNT];
extern const char *const IntFieldMeanings[INT_COUNT];

typedef struct _p_Particles *Particles;

/* The stored fields, opened: arrays over the n owned particles of this rank. real[f] is [n][width], NULL for a field
   that the swarm does not have (ParticlesHave); integer[f] is [n]. */
typedef struct {
  PetscInt   n;
  PetscReal *real[FIELD_STORED_COUNT];
  PetscInt  *integer[INT_COUNT];
} ParticleArrays;

/* ParticlesHave - whether a swarm has field f of the table, f < FIELD_STORED_COUNT. Volumes are stored where they
   differ; elsewhere all are the domain's. Sizes are stored of graded rings; other graded particles have that of their
   volume. Viscosities are stored where they vary. Not collective. */
PetscBool ParticlesHave(Particles particles, PetscInt f);

/* ParticleVolume - of a particle, from its fields, m3 (m2 in two dimensions). Not collective. */
static inline PetscReal ParticleVolume(Domain domain, const ParticleArrays *arrays, PetscInt a)
{
  return arrays->real[FIELD_VOLUME] ? arrays->real[FIELD_VOLUME][a] : domain->volume;
}

/* ParticleSize - its spacing over the domain's (1): see DomainSize; 1 where particles are all of one size. Not
   collective. */
static inline PetscReal ParticleSize(Domain domain, const ParticleArrays *arrays, PetscInt a)
{
  if (arrays->real[FIELD_SIZE]) return arrays->real[FIELD_SIZE][a];
  return domain->graded ? DomainSize(domain, arrays->real[FIELD_VOLUME][a]) : 1;
}

/* ParticleShare - the volume that it has in sums over neighbours, m^dim: of a ring its area. Not collective. */
static inline PetscReal ParticleShare(Domain domain, const ParticleArrays *arrays, PetscInt a)
{
  const PetscReal volume = ParticleVolume(domain, arrays, a), *x = arrays->real[FIELD_POSITION] + DIM * a;

  return domain->rings ? volume / DomainRingLength(domain, x, ParticleSize(domain, arrays, a)) : volume;
}

/* ParticlesCreate - an empty swarm with the fields of the table; viscosity: also that of each particle. Collective on
   the domain's communicator. */
PetscErrorCode ParticlesCreate(Domain domain, PetscBool viscosity, Particles *particles);
PetscErrorCode ParticlesDestroy(Particles *particles);
PetscErrorCode ParticlesView(Particles particles, PetscViewer viewer);
/* ParticlesAppend - makes room for count more particles on this rank, at the end; their fields are zero, to be filled
   through ParticlesOpen (also id, body, layer, parent). Collective. */
PetscErrorCode ParticlesAppend(Particles particles, PetscInt count);
/* ParticlesCheckRoom - refuses (UserError) if n, own particles and ghosts of a rank, are more on any rank than
   PETSC_MAX_INT over NUMBERS_A_PARTICLE: the indices of whatever has up to so many numbers a particle then fit a
   PetscInt, with some spare room. Collective. */
#define NUMBERS_A_PARTICLE 32
PetscErrorCode ParticlesCheckRoom(MPI_Comm comm, PetscInt64 n);
/* ParticlesOpen / ParticlesClose - the one accessor. Between the two no other call on the swarm is allowed. Not
 * collective. */
PetscErrorCode ParticlesOpen(Particles particles, ParticleArrays *arrays);
PetscErrorCode ParticlesClose(Particles particles, ParticleArrays *arrays);
PetscErrorCode ParticlesLocalSize(Particles particles, PetscInt *n);
PetscErrorCode ParticlesGlobalSize(Particles particles, PetscInt *n);
/* ParticlesRemove - drops the particles whose keep flag ([n local]) is false. Collective. */
PetscErrorCode ParticlesRemove(Particles particles, const PetscBool keep[]);
/* ParticlesMigrate - sends every particle to the rank that owns its cell (deep wall particles live with their parent,
   whose nearest cell is the same) and checks that none was lost. Collective. */
PetscErrorCode ParticlesMigrate(Particles particles);
/* ParticlesSetPortion - the most particles that ParticlesMigrate sends to a rank at once, for tests; by default those
   whose bytes fit an int. Not collective. */
PetscErrorCode ParticlesSetPortion(Particles particles, PetscInt portion);
/* ParticlesBalanceSurface - whether work near the free surface is to be divided evenly too. Not collective. */
PetscErrorCode ParticlesBalanceSurface(Particles particles, PetscBool surface);
/* ParticlesImbalance - largest over mean number a rank, of particles and (if it is divided too) of particles on or near
   the free surface: the larger of the two, 1 if perfect. Collective. */
PetscErrorCode ParticlesImbalance(Particles particles, PetscReal *imbalance);
/* ParticlesRepartition - METIS on the particles of each cell, then migrates. Collective. */
PetscErrorCode ParticlesRepartition(Particles particles);
/* ParticlesSort - canonical local order: fluid, top wall layer, deeper wall layers; within each by cell of a grid of
   the given size (m), then id. The order depends on positions and ids only. Not collective. */
PetscErrorCode ParticlesSort(Particles particles, PetscReal cell_size);

#endif
