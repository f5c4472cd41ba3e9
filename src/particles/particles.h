/* Floor 2: the particles, in a DMSwarm (DMSWARM_BASIC). Only this folder calls DMSwarm.

   The table of all fields. The swarm stores the stored fields: they migrate, checkpoints hold them, and they define the
   state completely. The Cloud (floor 3) holds the work fields during a step, for owned particles and ghosts. A row:
   identifier, name, width (numbers per particle), parity under a mirror, how particles that join or split carry it
   (stored fields), unit, meaning. */
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
  PARITY_NONE    /* no image: owned particles only */
} Parity;

/* What two particles that join have of both, and the halves of one that splits of it. */
typedef enum {
  CARRY_OWN,       /* nothing but that of the particle that stays: found anew in the next step; halves: the same */
  CARRY_MEAN,      /* the mean, weighted by volume; halves: the same */
  CARRY_SUM,       /* the sum; halves: half of it */
  CARRY_SCALAR,    /* as the mean; a property of the liquid, which gauges take at points and along lines */
  CARRY_LOGARITHM, /* the mean of the logarithms, weighted by volume: a value over decades; halves: the same */
} Carry;

#define STORED_REALS(X)                                                                                                \
  X(POSITION, "position", 3, PARITY_POINT, CARRY_MEAN, "m", "position")                                                \
  X(VELOCITY, "velocity", 3, PARITY_VECTOR, CARRY_MEAN, "m/s", "velocity")                                             \
  X(PRESSURE, "pressure", 1, PARITY_SCALAR, CARRY_MEAN, "Pa",                                                          \
    "pressure of the last projection, start value of the next")                                                        \
  X(DENSITY, "density", 1, PARITY_SCALAR, CARRY_OWN, "kg/m3", "summed density, Eq. (4) of Kuri et al.")                \
  X(CARRIED, "carried", 1, PARITY_SCALAR, CARRY_MEAN, "1",                                                             \
    "share of the body force that the pressure carried in the last step")                                              \
  X(LAMBDA, "lambda", 1, PARITY_SCALAR, CARRY_OWN, "1",                                                                \
    "smallest eigenvalue of the renormalisation matrix (Marrone et al.)")                                              \
  X(VOLUME, "volume", 1, PARITY_SCALAR, CARRY_SUM, "m3",                                                               \
    "volume of the particle or the whole ring; stored if volumes differ")                                              \
  X(SIZE, "size", 1, PARITY_SCALAR, CARRY_OWN, "1", "spacing over the finest spacing; stored for graded rings")        \
  X(VISCOSITY, "viscosity", 1, PARITY_SCALAR, CARRY_LOGARITHM, "Pa s",                                                 \
    "viscosity in the last step; stored if the viscosity of a body depends on the shear rate")                         \
  X(COLOUR, "colour", 1, PARITY_SCALAR, CARRY_MEAN, "1",                                                               \
    "part of the volume that was of the first body at the start; stored if bodies mix (-spacing_follow)")              \
  X(TEMPERATURE, "temperature", 1, PARITY_SCALAR, CARRY_SCALAR, "K", "temperature; stored with -<body>_temperature")   \
  X(CONCENTRATION, "concentration", 1, PARITY_SCALAR, CARRY_SCALAR, "1",                                               \
    "concentration; stored with -<body>_concentration or -<body>_diffusivity")                                         \
  X(STRETCH, "stretch", 6, PARITY_TENSOR, CARRY_MEAN, "1",                                                             \
    "conformation of polymers less that at rest, xx yy zz xy xz yz; stored with -<body>_polymer_modulus")              \
  X(LINE, "line_capillary_number", 1, PARITY_SCALAR, CARRY_MEAN, "1",                                                  \
    "mu U/sigma of the contact line nearby, positive if it advances; stored with -wall_contact_law")

#define STORED_INTS(X)                                                                                                 \
  X(ID, "id", "identity, unique and permanent")                                                                        \
  X(BODY, "body", "index of the body in -bodies; -1: dummy particle of a wall of the box; -2, -3, ...: of a solid")    \
  X(LAYER, "layer", "0: fluid; 1: top layer of a wall, solved; 2, 3, ...: deeper layers, slaved")                      \
  X(PARENT, "parent", "id of the top-layer particle that gives a deeper wall particle its pressure; else the own id")  \
  X(SURFACE, "surface", "1: on the free surface, 2: near it, 0: inside")

/* First id of emitted particles: their ids stay the same after a restart, whatever else makes particles. */
#define EMITTED_ID (PETSC_MAX_INT / 2)

#define BODY_WALL  (-1)
#define BODY_SOLID (-2) /* the first of -solids; -3: the second, and so on */

/* A step writes POSITION_NEW and VELOCITY_NEW when it no longer reads ACCELERATION and CAPILLARY_SLOPE: they have one
   memory each (cloud.c). */
#define WORK_REALS(X)                                                                                                  \
  X(POSITION_NEW, "position_new", 3, PARITY_POINT, "m", "position at the end of the step")                             \
  X(VELOCITY_STAR, "velocity_star", 3, PARITY_VECTOR, "m/s", "velocity after all forces except pressure")              \
  X(VELOCITY_NEW, "velocity_new", 3, PARITY_VECTOR, "m/s", "velocity at the end of the step")                          \
  X(ACCELERATION, "acceleration", 3, PARITY_VECTOR, "m/s2", "sum of viscosity, tension and body force")                \
  X(CORRECTION, "correction", 6, PARITY_TENSOR, "1", "renormalisation matrix B")                                       \
  X(NORMAL, "normal", 3, PARITY_VECTOR, "1/m", "sum of V grad W: points into the liquid")                              \
  X(CROWDING, "crowding", 3, PARITY_VECTOR, "1/m", "sum of V (1 + 0.2 (W/W(d0))^4) grad W: shifting opposes it")       \
  X(DIVERGENCE, "divergence", 1, PARITY_NONE, "1/s", "corrected divergence of velocity_star")                          \
  X(VELOCITY_GRADIENT, "velocity_gradient", 9, PARITY_NONE, "1/s",                                                     \
    "sum V (v_b - v_a)_i grad_j W over the fluid, of velocity_star")                                                   \
  X(VELOCITY_JUMP, "velocity_jump", 1, PARITY_NONE, "m/s", "largest |v_b - v_a| of neighbours, of velocity_star")      \
  X(CAPILLARY, "capillary", 1, PARITY_SCALAR, "Pa", "pressure of surface tension on the free surface, sigma kappa")    \
  X(CAPILLARY_SLOPE, "capillary_slope", 3, PARITY_VECTOR, "Pa/m", "its gradient along the surface")                    \
  X(BENDING, "bending", 1, PARITY_SCALAR, "1/m", "|k1| + |k2| of the free surface, for a spacing that adapts")

#define FIELD_ENUM_STORED(id, name, width, parity, carry, unit, meaning) FIELD_##id,
#define FIELD_ENUM_REAL(id, name, width, parity, unit, meaning)          FIELD_##id,
#define FIELD_ENUM_INT(id, name, meaning)                                INT_##id,
typedef enum {
  STORED_REALS(FIELD_ENUM_STORED) FIELD_STORED_COUNT,
  FIELD_STORED_LAST = FIELD_STORED_COUNT - 1,
  WORK_REALS(FIELD_ENUM_REAL) FIELD_COUNT
} FieldId;
typedef enum { STORED_INTS(FIELD_ENUM_INT) INT_COUNT } IntFieldId;

typedef struct {
  const char *name;
  PetscInt    width;
  Parity      parity;
  Carry       carry; /* of a stored field */
  const char *unit;
  const char *meaning;
} FieldInfo;

extern const FieldInfo   Fields[FIELD_COUNT];
extern const char *const IntFieldNames[INT_COUNT];
extern const char *const IntFieldMeanings[INT_COUNT];

typedef struct _p_Particles *Particles;

/* The stored fields of the n owned particles of this rank. real[f]: [n][width], NULL if the swarm does not store the
   field (ParticlesHave); integer[f]: [n]. */
typedef struct {
  PetscInt   n;
  PetscReal *real[FIELD_STORED_COUNT];
  PetscInt  *integer[INT_COUNT];
} ParticleArrays;

/* A set of stored fields. */
typedef unsigned FieldMask;
#define FIELD_BIT(f) (1U << (f))

/* ParticlesHave - whether the swarm stores field f < FIELD_STORED_COUNT: those of the rows up to lambda always, volumes
   if they differ (else every particle has the domain's), sizes if DomainStoresSizes (else that of a graded particle
   follows from its volume), colours with -spacing_follow, the others if ParticlesCreate says so. Not collective. */
PetscBool ParticlesHave(Particles particles, PetscInt f);

/* ParticleVolume - volume of particle a, m3 (m2 in two dimensions). Not collective. */
static inline PetscReal ParticleVolume(Domain domain, const ParticleArrays *arrays, PetscInt a)
{
  return arrays->real[FIELD_VOLUME] ? arrays->real[FIELD_VOLUME][a] : domain->volume;
}

/* ParticleSize - spacing of particle a over the domain's (1): see DomainSize; 1 without graded spacing. Not collective.
 */
static inline PetscReal ParticleSize(Domain domain, const ParticleArrays *arrays, PetscInt a)
{
  if (arrays->real[FIELD_SIZE]) return arrays->real[FIELD_SIZE][a];
  return domain->graded ? DomainSize(domain, arrays->real[FIELD_VOLUME][a]) : 1;
}

/* ParticleSumVolume - volume of particle a in sums over neighbours, m^dim; for a ring, its cross-section area. Not
   collective. */
static inline PetscReal ParticleSumVolume(Domain domain, const ParticleArrays *arrays, PetscInt a)
{
  const PetscReal volume = ParticleVolume(domain, arrays, a), *x = arrays->real[FIELD_POSITION] + DIM * a;

  return volume / DomainRingLength(domain, x, ParticleSize(domain, arrays, a));
}

/* ParticlesCreate - makes an empty swarm with the stored fields, those of the mask, too. Collective on the domain's
   communicator. ParticlesSetStart - names what gives new particles the start values of their fields: particles from
   'first' on, which have places, volumes, bodies and layers. ParticlesStart - calls it, for what makes particles. Not
   collective. */
typedef void (*ParticlesStarter)(void *context, PetscInt first, ParticleArrays *arrays);
PetscErrorCode ParticlesCreate(Domain domain, FieldMask more, Particles *particles);
void           ParticlesSetStart(Particles particles, ParticlesStarter start, void *context);
void           ParticlesStart(Particles particles, PetscInt first, ParticleArrays *arrays);
PetscErrorCode ParticlesDestroy(Particles *particles);
PetscErrorCode ParticlesView(Particles particles, PetscViewer viewer);
/* ParticlesAppend - appends 'count' particles on this rank, with all fields zero. The caller sets their fields (id,
   body, layer and parent, too) through ParticlesOpen. Collective. */
PetscErrorCode ParticlesAppend(Particles particles, PetscInt count);
/* ParticlesCheckRoom - refuses (UserError) if a rank has more than PETSC_MAX_INT/NUMBERS_A_PARTICLE particles, n: owned
   particles and ghosts. An array of up to so many numbers per particle then has indices that fit a PetscInt.
   Collective. */
#define NUMBERS_A_PARTICLE 32
PetscErrorCode ParticlesCheckRoom(MPI_Comm comm, PetscInt64 n);
/* ParticlesOpen - gives access to the stored fields. ParticlesClose - ends it. Between the two, no other function may
   use the swarm. Not collective. */
PetscErrorCode ParticlesOpen(Particles particles, ParticleArrays *arrays);
PetscErrorCode ParticlesClose(Particles particles, ParticleArrays *arrays);
PetscErrorCode ParticlesLocalSize(Particles particles, PetscInt *n);
PetscErrorCode ParticlesGlobalSize(Particles particles, PetscInt *n);
/* ParticlesLastId - the largest of the ids ([n]) of all ranks, emitted particles aside; -1: there are none. Collective.
 */
PetscErrorCode ParticlesLastId(MPI_Comm comm, PetscInt n, const PetscInt id[], PetscInt *last);
/* ParticlesRemove - removes the particles whose keep[] ([n local]) is false. Collective. */
PetscErrorCode ParticlesRemove(Particles particles, const PetscBool keep[]);
/* ParticlesMigrate - sends every particle to the rank that owns its cell, and checks that no particle is lost. A deep
   wall particle has the same nearest cell as its parent, so both live on one rank. Collective. */
PetscErrorCode ParticlesMigrate(Particles particles);
/* ParticlesSetPortion - for tests: the most particles that ParticlesMigrate sends to a rank in one message. Default:
   the number whose bytes fit an int. Not collective. */
PetscErrorCode ParticlesSetPortion(Particles particles, PetscInt portion);
/* ParticlesBalanceSurface - surface: the partition also divides the work near the free surface evenly. Not collective.
 */
PetscErrorCode ParticlesBalanceSurface(Particles particles, PetscBool surface);
/* ParticlesImbalance - the largest number of particles of a rank over the mean, 1 if perfect. With
   ParticlesBalanceSurface the larger of this ratio and that of particles on or near the free surface. Collective. */
PetscErrorCode ParticlesImbalance(Particles particles, PetscReal *imbalance);
/* ParticlesRepartition - divides the cells among the ranks by METIS, weighted by their particles, and migrates.
   Collective. */
PetscErrorCode ParticlesRepartition(Particles particles);
/* ParticlesSort - sorts the local particles: fluid, top wall layer, deeper wall layers; within each by the cell of a
   grid of cell_size (m), then by id. Positions and ids alone determine the order. Not collective. */
PetscErrorCode ParticlesSort(Particles particles, PetscReal cell_size);

#endif
