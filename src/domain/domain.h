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
   DomainSetUp. */
typedef struct {
  MPI_Comm  comm;
  PetscInt  dim;                        /* 2 or 3 */
  PetscReal spacing;                    /* particle spacing d0, m */
  PetscReal volume;                     /* of one particle, d0^dim, m^dim */
  PetscReal lower[DIM];                 /* m */
  PetscReal upper[DIM];                 /* m */
  FaceType  face[DIM][2];               /* lower and upper face of each direction */
  PetscReal wall_velocity[DIM][2][DIM]; /* velocity of a wall face, m/s */
  /* Partition: a grid of cells over the box, each owned by one rank. */
  PetscInt     cells[DIM];     /* number of cells a direction */
  PetscReal    cell_size[DIM]; /* m */
  PetscMPIInt *cell_rank;      /* [cells0*cells1*cells2] owner */
} * Domain;

/* DomainCreate - an empty domain. Collective on comm. */
PetscErrorCode DomainCreate(MPI_Comm comm, Domain *domain);
/* DomainSetFromOptions - reads -dimension, -spacing (m), -box_lower, -box_upper (m), -box_x|y|z (both faces), -box_xmin
   ... -box_zmax (one face, overrides) and -box_<face>_velocity (m/s). Refuses (UserError) a missing or non-positive
   spacing, a missing or empty box, an unknown face type, a periodic face opposite another type, and a velocity of a
   face that is no wall or not tangential. Collective. */
PetscErrorCode DomainSetFromOptions(Domain domain);
/* DomainSetUp - cells of the partition, at least 'reach' (m) wide where the box allows, owned by the ranks in
   contiguous blocks of the cell index until DomainPartition is called. Refuses a box narrower than 'reach' between
   periodic or symmetry faces. Collective. */
PetscErrorCode DomainSetUp(Domain domain, PetscReal reach);
PetscErrorCode DomainView(Domain domain, PetscViewer viewer);
PetscErrorCode DomainDestroy(Domain *domain);

/* What the three numbers of an option are: the third number of a point is ignored in two dimensions, that of a
   direction must be zero. */
typedef enum { VECTOR_POINT, VECTOR_DIRECTION } VectorKind;
/* DomainOptionsVector - reads an option of dim or three finite numbers inside an options block; value ([3], unit as in
   the help text) holds the default on entry and always has a zero third component in two dimensions on return. set may
   be NULL. Refuses (UserError) another count of numbers. Collective. */
PetscErrorCode DomainOptionsVector(Domain domain, OptionItems PetscOptionsObject, VectorKind kind, const char option[],
                                   const char help[], const char manual[], PetscReal value[DIM], PetscBool *set);

/* DomainCell - index of the cell that holds point x (m); points outside the box belong to the nearest cell, so that
   dummy particles of a wall live with the fluid next to them. Not collective. */
PetscInt DomainCell(Domain domain, const PetscReal x[DIM]);
/* DomainWrap - takes x (m) back into the box through periodic faces. Not collective. */
void DomainWrap(Domain domain, PetscReal x[DIM]);
/* DomainConfine - takes x (m) back into the box: through periodic faces, mirrored at symmetry faces, just inside an
   open face or a wall. Not collective. */
void DomainConfine(Domain domain, PetscReal x[DIM]);
/* DomainOutside - whether x (m) has left the box through an open face. Not collective. */
PetscBool DomainOutside(Domain domain, const PetscReal x[DIM]);
/* DomainPartition - METIS on the cell graph, so that every rank gets its share of each of 'constraints' kinds of work:
   weight is [cells][constraints], summed over all ranks by this call. The same answer on every rank. Collective. */
PetscErrorCode DomainPartition(Domain domain, PetscInt constraints, PetscInt weight[]);

#endif
