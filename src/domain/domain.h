/* Floor 1: the box, its faces, and who owns which part of it. */
#ifndef ISPH_DOMAIN_H
#define ISPH_DOMAIN_H

#include "../base/base.h"

/* Points this close to a face or a surface, in spacings, count as on it: far above the rounding of decimal input, far
   below any distance of particles. */
#define POINT_TOLERANCE 1e-6

typedef enum { FACE_OPEN, FACE_PERIODIC, FACE_WALL, FACE_SYMMETRY } FaceType;
extern const char *const FaceTypes[]; /* "open", "periodic", "wall", "symmetry" and PETSc's two trailing strings */

/* The box. In two dimensions the third extent is [-spacing/2, spacing/2] and its faces are open. Read-only after
   DomainSetUp.

   Rings (-dimension axisymmetric): a scene that is the same all around an axis, as two dimensions. x is the distance
   from the axis, y is along it; the face x = 0 is a mirror. A particle is a ring of a constant volume, whose cross
   section, the ring area, is this volume over its length; sums over neighbours are those of two dimensions, with ring
   areas in place of the one volume of all particles. Volumes, masses and energies are those of whole rings.

   Graded spacing (-spacing_coarse): the spacing grows from 'spacing' to 'spacing_coarse' with the distance from the
   regions of -fine (SceneSpacing). A particle keeps the volume s^dim and the smoothing length (in spacings) that it was
   made with, wherever it goes; rings, which join and split, the smoothing length alone. */
typedef struct {
  MPI_Comm  comm;
  PetscInt  dim;                        /* 2 or 3 */
  PetscBool rings;                      /* dim is 2, particles are rings about x = 0 */
  PetscReal spacing;                    /* particle spacing d0, m */
  PetscReal volume;                     /* of one particle, d0^dim, m^dim; ring area of one as it is made */
  PetscBool graded;                     /* particles differ in size */
  PetscReal spacing_coarse, growth;     /* the largest spacing, m, 'spacing' if not graded; its growth a length, 1 */
  PetscReal lower[DIM];                 /* m */
  PetscReal upper[DIM];                 /* m */
  FaceType  face[DIM][2];               /* lower and upper face of each direction */
  PetscReal wall_velocity[DIM][2][DIM]; /* velocity of a wall face, m/s, at the time set last */
  PetscReal wall_mean[DIM][2][DIM], wall_amplitude[DIM][2][DIM], wall_rate[DIM][2]; /* what it swings around and by,
                                                                                       m/s; rad/s */
  /* Partition: a grid of cells over the box, each owned by one rank. */
  PetscInt     cells[DIM];     /* number of cells a direction */
  PetscReal    cell_size[DIM]; /* m */
  PetscMPIInt *cell_rank;      /* [cells0*cells1*cells2] owner */
} * Domain;

/* DomainSize - the size s/d0 (1) of a particle of this volume (m^dim): its spacing over 'spacing'. DomainSizeMost - the
   largest that there is: packings make no larger ones. Not collective. */
#define SIZE_MARGIN 1.1 /* a packing that fits its volume to a body's may exceed the coarse spacing by so much */
static inline PetscReal DomainSize(Domain domain, PetscReal volume)
{
  const PetscReal share = volume / domain->volume;

  return domain->dim == 2 ? PetscSqrtReal(share) : cbrt(share);
}
static inline PetscReal DomainSizeMost(Domain domain)
{
  return domain->graded ? SIZE_MARGIN * domain->spacing_coarse / domain->spacing : 1;
}

/* DomainCreate - an empty domain. Collective on comm. */
PetscErrorCode DomainCreate(MPI_Comm comm, Domain *domain);
/* DomainSetFromOptions - reads -dimension 2|3|axisymmetric, -spacing, -spacing_coarse (m), -spacing_growth, -box_lower,
   -box_upper (m), -box_x|y|z (both faces), -box_xmin
   ... -box_zmax (one face, overrides) and -box_<face>_velocity (m/s). Refuses (UserError) a missing or non-positive
   spacing, a missing or empty box, an unknown face type, a periodic face opposite another type, and a velocity of a
   face that is no wall or not tangential; rings: a box that does not begin at x = 0. Collective. */
PetscErrorCode DomainSetFromOptions(Domain domain);
/* DomainSetUp - cells of the partition, at least 'reach' (m) wide where the box allows (as wide as the finest particles
   of graded ones need), owned by the ranks in contiguous blocks of the cell index until DomainPartition is called.
   Refuses a box narrower than 'reach' between periodic or symmetry faces. Collective. */
PetscErrorCode DomainSetUp(Domain domain, PetscReal reach);
PetscErrorCode DomainView(Domain domain, PetscViewer viewer);
PetscErrorCode DomainDestroy(Domain *domain);

/* What the three numbers of an option are: the third number of a point is ignored in two dimensions, that of a
   direction must be zero. Rings have two. */
typedef enum { VECTOR_POINT, VECTOR_DIRECTION } VectorKind;
/* DomainOptionsVector - reads an option of dim or three finite numbers inside an options block; value ([3], unit as in
   the help text) holds the default on entry and always has a zero third component in two dimensions on return. set may
   be NULL. Refuses (UserError) another count of numbers. Collective. */
PetscErrorCode DomainOptionsVector(Domain domain, OptionItems PetscOptionsObject, VectorKind kind, const char option[],
                                   const char help[], const char manual[], PetscReal value[DIM], PetscBool *set);

/* DomainRingLength - 2 pi R (m) of the ring at x (m), which may be an image; 1 where particles are no rings. R is the
   distance from the axis; nearer than half a spacing, of a ring of this size (1), the mean of that and half a spacing:
   as far out as the ring's pairs act (a pair has the length of its middle, |r_a + r_b|/2 with images at -r), so that
   the first ring of a lattice is as wide as all others and no ring has a cross section without bound. Not collective.
 */
static inline PetscReal DomainRingLength(Domain domain, const PetscReal x[DIM], PetscReal size)
{
  const PetscReal r = PetscAbsReal(x[0]), half = 0.5 * domain->spacing * size;

  return domain->rings ? 2 * PETSC_PI * (r < half ? 0.5 * (r + half) : r) : 1;
}

/* DomainPairLength - 2 pi |r_a + r_b|/2 (m), the length of the ring in the middle between x and y (m); r is negative in
   an image, so the pair of a particle with its own image has none. 1 where particles are no rings. Not collective. */
static inline PetscReal DomainPairLength(Domain domain, const PetscReal x[DIM], const PetscReal y[DIM])
{
  return domain->rings ? PETSC_PI * PetscAbsReal(x[0] + y[0]) : 1;
}

/* DomainCell - index of the cell that holds point x (m); points outside the box belong to the nearest cell, so that
   dummy particles of a wall live with the fluid next to them. Not collective. */
PetscInt DomainCell(Domain domain, const PetscReal x[DIM]);
/* DomainWrap - takes x (m) back into the box through periodic faces. Not collective. */
void DomainWrap(Domain domain, PetscReal x[DIM]);
/* DomainNearest - makes a difference of two places (m) that between the nearest of their periodic images. Not
   collective. */
void DomainNearest(Domain domain, PetscReal difference[DIM]);
/* DomainConfine - takes x (m) back into the box: through periodic faces, mirrored at symmetry faces, just inside an
   open face or a wall. Not collective. */
void DomainConfine(Domain domain, PetscReal x[DIM]);
/* DomainOutside - whether x (m) has left the box through an open face. Not collective. */
PetscBool DomainOutside(Domain domain, const PetscReal x[DIM]);
/* DomainWallsSwing - whether the velocity of any wall face depends on the time; DomainSetTime - it is that of this time
   (s) from here on, 0 at first; DomainWallSpeed - no wall is ever faster than this (m/s). Not collective. */
PetscBool DomainWallsSwing(Domain domain);
void      DomainSetTime(Domain domain, PetscReal time);
PetscReal DomainWallSpeed(Domain domain);
/* DomainWallVelocity - the velocity v (m/s) of the walls at x (m) outside of the box: that of the face; behind an edge
   or a corner zero in each component in which the faces differ. Not collective. */
void DomainWallVelocity(Domain domain, const PetscReal x[DIM], PetscReal v[DIM]);
/* DomainPartition - METIS on the cell graph, so that every rank gets its share of each of 'constraints' kinds of work:
   weight is [cells][constraints], summed over all ranks by this call. The same answer on every rank. Collective. */
PetscErrorCode DomainPartition(Domain domain, PetscInt constraints, PetscInt weight[]);

#endif
