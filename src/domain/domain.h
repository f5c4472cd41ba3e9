/* Floor 1: the box, its faces, and its partition between the ranks. */
#ifndef ISPH_DOMAIN_H
#define ISPH_DOMAIN_H

#include "../base/json.h"

/* Points closer to a face or a surface than this (in spacings) lie on it. The tolerance is far above the rounding of
   decimal input and far below the distance of particles. */
#define POINT_TOLERANCE 1e-6

typedef enum { FACE_OPEN, FACE_PERIODIC, FACE_WALL, FACE_SYMMETRY } FaceType;
extern const char *const FaceTypes[];       /* "open", "periodic", "wall", "symmetry" */
extern const char *const FaceNames[DIM][2]; /* "xmin" ... "zmax" */

/* The box. In two dimensions its third extent is [-spacing/2, spacing/2] and the faces there are open. Only
   DomainPartition changes the box after DomainSetUp.

   Rings (-dimension axisymmetric): an axisymmetric scene in two dimensions, x the distance from the axis and y the
   position along the axis; the face x = 0 is a symmetry face. A particle is a ring of constant volume. Its cross
   section, the ring area, is the volume over the length of the ring. Sums over neighbours are those of two dimensions
   with ring areas as the particles' volumes. Volumes, masses and energies are those of whole rings.

   Graded spacing (-spacing_coarse): the spacing grows from 'spacing' to 'spacing_coarse' with the distance from the
   regions of -fine (SceneSpacing). A particle keeps its initial volume s^dim and smoothing length (in spacings)
   wherever it moves. Rings join and split, so a ring keeps its smoothing length only. An adaptive spacing
   (-spacing_follow) changes during the run, and all particles join and split for it (resampling/). */
typedef struct _p_Domain *Domain;
typedef struct _p_Scene  *Scene; /* of higher floors, passed on */
typedef struct _p_Cloud  *Cloud;

/* What adapts the spacing, a record of the list adaptive.c. All but 'name' and 'at' are collective. */
typedef struct {
  /* reads its options; if they ask for it, makes itself domain->adaptive, with its data */
  PetscErrorCode (*options)(Domain domain);
  const char *(*name)(Domain domain); /* what it is, in -spacing_follow */
  /* finds the spacing wanted for the bodies of the scene at the start, or for the liquid as it is: then the size
     ([n_total], 1) that each particle should have */
  PetscErrorCode (*start)(Domain domain, Scene scene);
  PetscErrorCode (*find)(Cloud cloud, PetscReal size[]);
  PetscReal (*at)(Domain domain, const PetscReal x[DIM]); /* the spacing (m) wanted at x (m) */
  /* makes the dummy particles of the box's walls those that it wants, the first time all; CloudResync has to follow */
  PetscErrorCode (*walls)(Cloud cloud);
  PetscErrorCode (*destroy)(Domain domain); /* frees what its data hold */
} Adaptive;

/* Properties: options that a feature gives to what a scene has, by the owner's name: -<body>_temperature, or
   -box_<face>_temperature. A feature brings a table of them, whose last has no rows. Whatever reads, compares, tells or
   writes an owner walks all of its properties. */
typedef enum { OWNER_SCENE, OWNER_FACE, OWNER_BODY, OWNER_SOLID, OWNER_HOLE } Owner;
typedef struct {
  Owner            owner;
  size_t           size; /* of the data of one owner, bytes; zero before the defaults */
  const OptionRow *rows; /* read into them */
  void (*defaults)(void *data);
  /* completes the data, and refuses (UserError) contradictions. prefix: of the owner's options. Collective. */
  PetscErrorCode (*check)(Domain domain, const char prefix[], void *data);
} Property;
/* The properties of one owner. */
typedef struct {
  Owner owner;
  char *data; /* NULL: not read */
} Properties;

struct _p_Domain {
  MPI_Comm  comm;
  PetscInt  dim;                    /* 2 or 3 */
  PetscBool rings;                  /* dim is 2, particles are rings about x = 0 */
  PetscReal spacing;                /* particle spacing d0, m */
  PetscReal volume;                 /* of a particle of spacing d0, d0^dim, m^dim; of rings the initial ring area */
  PetscBool graded;                 /* the spacing is graded */
  PetscReal spacing_coarse, growth; /* largest spacing, m, = spacing if not graded; its increase per distance, 1 */
  const Adaptive  *adaptive;        /* what adapts the spacing; NULL: nothing */
  void            *adaptive_data;
  PetscReal        lower[DIM];                 /* m */
  PetscReal        upper[DIM];                 /* m */
  FaceType         face[DIM][2];               /* lower and upper face of each direction */
  PetscReal        wall_velocity[DIM][2][DIM]; /* of a wall face, m/s */
  PetscInt         property_count;
  const Property **property;    /* [property_count] of all owners, borrowed */
  Properties       own[DIM][2]; /* of the faces */
  /* Partition: a grid of cells over the box, each owned by one rank. */
  PetscInt     cells[DIM];     /* number of cells a direction */
  PetscReal    cell_size[DIM]; /* m */
  PetscMPIInt *cell_rank;      /* [cells0*cells1*cells2] owner */
};

/* DomainSize - the size s/d0 (1) of a particle of this volume (m^dim): its spacing over 'spacing'. DomainSizeMax - an
   upper bound of the sizes that a packing makes. Not collective. */
#define SIZE_MARGIN 1.1 /* factor by which a packing may exceed the coarse spacing to fit the volume of a body */
static inline PetscReal DomainSize(Domain domain, PetscReal volume)
{
  const PetscReal share = volume / domain->volume;

  return domain->dim == 2 ? PetscSqrtReal(share) : cbrt(share);
}
/* DomainStoresSizes - whether the size of a particle is not that of its volume: graded rings keep their smoothing
   length, and dummy particles have that of the liquid in front of them if the spacing adapts. Not collective. */
static inline PetscBool DomainStoresSizes(Domain domain)
{
  return (PetscBool)(domain->adaptive || (domain->rings && domain->graded));
}
/* DomainVolumesDiffer - whether particles have volumes of their own. DomainIsFlat - whether the scene is a plane, where
   volumes, forces and energies are per metre. DomainIsRadial - whether direction d is the distance from the axis of
   rings. DomainFirstStraight - the first direction that is not. Not collective. */
static inline PetscBool DomainVolumesDiffer(Domain domain)
{
  return (PetscBool)(domain->rings || domain->graded);
}
static inline PetscBool DomainIsFlat(Domain domain)
{
  return (PetscBool)(domain->dim == 2 && !domain->rings);
}
static inline PetscBool DomainIsRadial(Domain domain, PetscInt d)
{
  return (PetscBool)(domain->rings && d == 0);
}
static inline PetscInt DomainFirstStraight(Domain domain)
{
  return domain->rings ? 1 : 0;
}
static inline PetscReal DomainSizeMax(Domain domain)
{
  return domain->graded ? SIZE_MARGIN * domain->spacing_coarse / domain->spacing : 1;
}

/* AdaptiveSetFromOptions - asks the records whether one adapts the spacing. Collective. */
PetscErrorCode AdaptiveSetFromOptions(Domain domain);
/* DomainCreate - a domain without options. Collective on comm. */
PetscErrorCode DomainCreate(MPI_Comm comm, Domain *domain);
/* DomainSetFromOptions - reads -dimension 2|3|axisymmetric, -spacing, -spacing_coarse (m), -spacing_growth, -box_lower,
   -box_upper (m), -box_x|y|z (both faces), -box_xmin ... -box_zmax (one face, overrides -box_x|y|z) and
   -box_<face>_velocity (m/s). Refuses (UserError) a missing or non-positive spacing, a missing or empty box, an unknown
   face type, a periodic face opposite another type, a velocity of a face that is no wall, a velocity that is not
   tangential, and with rings a box that does not begin at x = 0. Collective. */
PetscErrorCode DomainSetFromOptions(Domain domain);
/* DomainAddProperty - gives its kind of owner a property (borrowed), before any options are read. Not collective. */
PetscErrorCode DomainAddProperty(Domain domain, const Property *property);
/* PropertiesMake - makes the data of an owner, with the defaults. PropertiesRead - the same, and reads them in the
   block of its options. PropertiesNote - notes the options of another kind of owner, see OptionsNote. Collective.
   PropertiesFree - frees the data. PropertyOf - the data of a property of an owner (borrowed); NULL: it has none.
   PropertiesWalk - property k of an owner and its data; NULL: there are only k. PropertiesSame - whether two owners
   have the same properties. PropertiesIdentity, PropertiesJson - OptionsIdentity and OptionsValues of all. Not
   collective. */
PetscErrorCode  PropertiesMake(Domain domain, Owner owner, Properties *own);
PetscErrorCode  PropertiesRead(Domain domain, OptionItems items, Owner owner, Properties *own);
PetscErrorCode  PropertiesNote(Domain domain, const char prefix[], const char why[], Owner owner);
PetscErrorCode  PropertiesFree(Properties *own);
void           *PropertyOf(Domain domain, const Properties *own, const Property *property);
const Property *PropertiesWalk(Domain domain, const Properties *own, PetscInt k, void **data);
PetscBool       PropertiesSame(Domain domain, const Properties *one, const Properties *other);
void            PropertiesIdentity(Domain domain, const Properties *own, const char prefix[], FILE *text);
void            PropertiesJson(Domain domain, const Properties *own, Json *json);
/* DomainReadFaces - reads the rows of a table for each face of the box, "-box_<face>_<row>", into structs of 'stride'
   bytes, the first of the lower face of x, the second of the upper one; rows NULL: the properties of faces into structs
   Properties. Collective. */
PetscErrorCode DomainReadFaces(Domain domain, const OptionRow rows[], const char function[], size_t stride, void *data);
/* DomainIdentity - writes the box as lines of SceneIdentity. Not collective. */
void DomainIdentity(Domain domain, FILE *text);
/* DomainSetUp - makes the cells of the partition. reach: the radius of support of the largest particles (m). A cell is
   at least as wide as the support of the finest particles unless the box is narrower. Each rank owns a contiguous block
   of cell indices until DomainPartition is called. Refuses (UserError) a box narrower than 'reach' between periodic or
   symmetry faces. Collective. */
PetscErrorCode DomainSetUp(Domain domain, PetscReal reach);
PetscErrorCode DomainView(Domain domain, PetscViewer viewer);
/* DomainJson - writes box, spacing and faces into the open object of scene.json. Not collective. */
void           DomainJson(Domain domain, Json *json);
PetscErrorCode DomainDestroy(Domain *domain);

/* DomainUnit - the unit, in the dimensions of the scene, of an extensive quantity whose unit in space is J, N, m3, m2
   or m3/s: J/m, N/m, m2, m or m2/s in two dimensions, per metre across the plane; rings are whole. Not collective. */
const char *DomainUnit(Domain domain, const char unit[]);

/* DomainReadOptions - OptionsReadVectors with this dimension: a vector has dim or three finite numbers, with rings two.
   In two dimensions the third number of a point is ignored, that of a direction must be zero. Refuses (UserError)
   directions that are none. Collective. */
PetscErrorCode DomainReadOptions(Domain domain, OptionItems PetscOptionsObject, const OptionRow rows[],
                                 const char function[], void *data);

/* DomainRingLength - the length 2 pi R (m) of a ring of this size (1) at x (m), which may be an image; 1 without rings.
   R is the distance from the axis r. If r is less than half the ring's spacing, R is the mean of r and half the
   spacing: this is the mean radius at which the pairs of that ring act (see DomainPairLength, images at -r). Then the
   first ring of a lattice is as wide as the others, and the ring area stays finite at the axis. Not collective. */
static inline PetscReal DomainRingLength(Domain domain, const PetscReal x[DIM], PetscReal size)
{
  const PetscReal r = PetscAbsReal(x[0]), half = 0.5 * domain->spacing * size;

  return domain->rings ? 2 * PETSC_PI * (r < half ? 0.5 * (r + half) : r) : 1;
}

/* DomainNearAxis - whether there are rings, and r (m) is at most 'reach' from their axis. Not collective. */
static inline PetscBool DomainNearAxis(Domain domain, PetscReal r, PetscReal reach)
{
  return (PetscBool)(domain->rings && r <= reach);
}
/* DomainLengthening - the rate (1/s) at which the ring at x (m) gets longer with the velocity v (m/s), over its length;
   0 without rings. Not collective. */
static inline PetscReal DomainLengthening(Domain domain, const PetscReal x[DIM], const PetscReal v[DIM])
{
  return domain->rings && x[0] != 0 ? v[0] / x[0] : 0;
}

/* DomainPairLength - 2 pi |r_a + r_b|/2 (m), the length of the ring half-way between x and y (m); 1 without rings. r is
   negative in an image, so the pair of a particle with its own image has length zero. Not collective. */
static inline PetscReal DomainPairLength(Domain domain, const PetscReal x[DIM], const PetscReal y[DIM])
{
  return domain->rings ? PETSC_PI * PetscAbsReal(x[0] + y[0]) : 1;
}

/* DomainCell - index of the cell that contains x (m). A point outside the box belongs to the nearest cell, so a dummy
   particle of a wall is on the rank of the liquid next to it. Not collective. */
PetscInt DomainCell(Domain domain, const PetscReal x[DIM]);
/* DomainWrap - takes x (m) back into the box through periodic faces. Not collective. */
void DomainWrap(Domain domain, PetscReal x[DIM]);
/* DomainNearest - replaces the difference of two positions (m) by the one between their nearest periodic images. Not
   collective. */
void DomainNearest(Domain domain, PetscReal difference[DIM]);
/* DomainConfine - takes x (m) back into the box: through periodic faces, by reflection at symmetry faces, and to just
   inside open faces and walls. Not collective. */
void DomainConfine(Domain domain, PetscReal x[DIM]);
/* DomainExit - the number of the open face, 2 d + side, through which x (m) has left the box; -1: it has not. Not
   collective. */
PetscInt DomainExit(Domain domain, const PetscReal x[DIM]);
/* DomainWallSpeed - of the fastest wall (m/s). Not collective. */
PetscReal DomainWallSpeed(Domain domain);
/* DomainWallVelocity - the velocity v (m/s) of the wall face that x (m), outside the box, lies behind. Behind an edge
   or a corner a component in which the faces differ is zero. Not collective. */
void DomainWallVelocity(Domain domain, const PetscReal x[DIM], PetscReal v[DIM]);
/* DomainPartition - assigns the cells to the ranks by METIS so that every rank gets an equal share of each kind of
   work. constraints: number of kinds; weight: [cells][constraints] work of this rank's particles, on return summed over
   the ranks. Every rank gets the same partition. Collective. */
PetscErrorCode DomainPartition(Domain domain, PetscInt constraints, PetscInt weight[]);

#endif
