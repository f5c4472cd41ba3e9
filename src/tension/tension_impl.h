/* Private to tension/. */
#ifndef ISPH_TENSION_TYPES_H
#define ISPH_TENSION_TYPES_H

#include "../neighbors/sorted_cells.h"
#include "../operators/operators.h"
#include "tension.h"

#define WALL_TABLE 256 /* intervals of the tables over a depth or a filled fraction */
#define SHEET_CORE 0.5 /* range of the repulsion in thin sheets, over H: see sheet.c */

/* Columns of the sorted liquid (SortedCells) that always hold the same: the cloud's weights, where it has any, of rings
   the area over V_0; the local index, where solids have a contact angle: see contact.c. */
#define WEIGHT_COLUMN 8
#define SOLID_COLUMN  9

/* --- the models --- */

/* A linear fit to values at the neighbours of a particle whose normals point to the same side. */
typedef struct {
  PetscBool enough;    /* neighbours for a slope */
  PetscReal x[DIM];    /* weighted mean position of the neighbours relative to the particle, m */
  PetscReal B[6];      /* inverse of their weighted second moments about that mean, 1/m2 */
  PetscReal inverse_w; /* 1/sum W */
  PetscInt  count;     /* of neighbours */
} NormalFit;

/* --- contact.c, contact_solid.c: the liquid goes on behind walls, under their contact angles --- */

typedef struct {
  PetscReal angle, cosine, sine; /* in the liquid, rad */
  PetscReal slant;               /* by how much images are moved along the wall, over their distance */
  PetscReal rest;                /* 1/(cot(angle) - slant) */
  PetscReal stick;               /* (cos r - cos a)/2 of the receding and the advancing angle: see hysteresis.c */
} ContactAngle;

/* The images that one wall, or all solids, add to the collected particles: those from begin to end - 1. */
typedef struct {
  PetscInt            begin, end, axis;
  PetscReal           wall, inward[DIM]; /* of a face, its place along the axis, m; unit vector into the liquid */
  const ContactAngle *contact;           /* of a face; NULL: each particle in a solid has its own, see ContactOf */
} WallImages;

/* What is collected around the particles of one cell: 'real' particles, then the images of 'images' walls, n in all. */
typedef struct {
  PetscInt   cell, real, n, images;
  WallImages image[2 * DIM + 1];
} Around;

/* Of each of these images. */
typedef struct {
  PetscBool used;                       /* not of mere mirror images */
  PetscInt  capacity, *parent, *origin; /* [capacity] of which candidate it is one, and of which particle in the end */
  float    *share;                      /* [capacity] its volume over that of this particle */
} Images;

/* Of the particles near solids that have a contact angle. */
typedef struct {
  Scene         scene; /* borrowed */
  PetscInt      count; /* of solids; 0: none has a contact angle */
  ContactAngle *angle; /* [count] those without one have the angle 0 */
  PetscReal    *place; /* [n_total][3] distance (m) from the nearest solid; volume of the image in it over that of the
                          particle, 0: there is none; index of the solid, negative: none is near, or it has no angle */
  PetscReal  *normal;  /* [n_total][3] out of it, and ... */
  PetscReal  *meeting; /* [n_total][3] ... the same where the free surface next to the particle is */
  PetscReal  *index;   /* [n_total] local indices, for SOLID_COLUMN */
  SortedCells dummies; /* particles of all solids */
} SolidContact;

struct _p_Tension {
  MPI_Comm  comm;
  PetscBool active; /* the scene has tension and the model is not none */
  PetscInt  dim;
  PetscBool rings, weighted; /* the cloud's weights are not all 1 */
  PetscReal size, size_most; /* of the particle whose sums are made, 1; largest of all */
  char      type[64];
  PetscReal step_limit; /* see TensionStepLimit */
  /* Of the model: its options, its tables, and what TensionApply does. May be NULL. */
  PetscErrorCode (*setfromoptions)(Tension, OptionItems);
  PetscErrorCode (*setup)(Tension);
  PetscErrorCode (*apply)(Tension, Cloud);

  PetscReal spacing, smoothing, ratio; /* d0, h (m); H/h */
  Kernel    kernel;                    /* W^H */
  Kernel    core;                      /* of SHEET_CORE H: sheet.c */
  /* Each level of sizes of graded particles (CloudLevel) has its own cells, otherwise there is one level. */
  PetscInt        levels;
  PetscReal       largest[SIZE_LEVELS];          /* size in the level, 1 */
  SortedCells     liquids[SIZE_LEVELS], *liquid; /* fluid particles, ghosts too; those in use */
  SortedCells     surface[SIZE_LEVELS];          /* surface particles: see TensionNear */
  const PetscInt *also;                 /* [n_total] 1: counts as a surface particle, too; NULL: none. Borrowed */
  PetscReal       wall[WALL_TABLE + 1]; /* w1 over depth, 1/m */

  PetscReal calibration, band; /* cahn_hilliard */
  CellMask  near;              /* cahn_hilliard: where it is evaluated */
  PetscBool summed;            /* cahn_hilliard: the summed density, not that at rest */

  PetscBool    sheets;          /* curvature: sheet.c is used */
  PetscReal    slender;         /* of rings: see loose.c */
  PetscBool   *loose;           /* [n_owned] of rings: part of a row of drops; else NULL */
  PetscReal    sharpening;      /* of the curvature */
  FaceType     face[DIM][2];    /* of the box */
  ContactAngle contact[DIM][2]; /* of its walls */
  PetscBool    interface;       /* the scene has two liquids that do not mix */
  /* curvature: of two liquids, the one whose surface is looked at (see interface.c): bits of phases, 0 where
     liquids mix; its part of the tension, N/m; [n_total] bits */
  PetscInt       phase;
  PetscReal      part;
  unsigned char *phases;
  SolidContact   solid;
  Images         images;
  PetscBool      slanted;                  /* a contact angle is not 90 degrees: see ContactSlant */
  PetscBool      sticks;                   /* a contact line does: see hysteresis.c */
  PetscBool      walls;                    /* the box has any */
  PetscReal      depth[WALL_TABLE + 1];    /* depth (m) over the filled fraction 0.5 to 1 */
  PetscReal      fraction[WALL_TABLE + 1]; /* F over w1/w1(0) */
  PetscReal      plane, moment;            /* w1(0), 1/m; int x^2 W dA over a plane, m */
  NormalFit     *fit[SIZE_LEVELS];         /* [fit_capacity], by place in the sorted liquid of the level */
  PetscInt       fit_capacity[SIZE_LEVELS];
  float         *weight; /* [weight_capacity] of the fits' neighbours, and ... */
  int32_t       *place;  /* [weight_capacity] ... their places among what is collected around the particle */
  PetscInt64     weight_capacity;
};

/* A particle has a normal only within SURFACE_REACH H of a surface particle. Below a flat surface |grad phi| H falls
   below THRESHOLD 0.9 H deep. Where two surfaces meet, particles between them have a normal from further
   away: of those that a wider search finds, one in a hundred at most and none beyond 1.35 H. */
#define SURFACE_REACH 1.35
static inline PetscReal TensionSurfaceReach(Tension tension)
{
  return SURFACE_REACH * KernelSmoothingLength(tension->kernel);
}
#define CHUNK 512 /* collected candidates that a loop takes at once: their arrays fit into the first cache */

/* Distances - s[k] = |x - c_k|^2/H^2 of the m <= CHUNK collected candidates c_k from 'begin' on. */
static inline void Distances(Tension tension, PetscInt begin, PetscInt m, const PetscReal x[DIM], PetscReal inverse_h2,
                             float *restrict s)
{
  const PetscReal *restrict cx = tension->liquid->near + begin, *restrict cy = cx + tension->liquid->stride,
                            *restrict cz = cy + tension->liquid->stride;
  const PetscReal x0 = x[0], y0 = x[1], z0 = x[2];

  SIMD_LOOP()
  for (PetscInt k = 0; k < m; k++)
    s[k] = (float)((PetscSqr(x0 - cx[k]) + PetscSqr(y0 - cy[k]) + PetscSqr(z0 - cz[k])) * inverse_h2);
}

/* TensionLevel - takes the liquid of a level of sizes into use and returns it. TensionOwns - whether the sums of
   particle a are made here and with those of the level. */
static inline SortedCells *TensionLevel(Tension tension, PetscInt level)
{
  tension->liquid = &tension->liquids[level];
  return tension->liquid;
}
static inline PetscBool TensionOwns(Cloud cloud, PetscInt level, PetscInt a)
{
  return (PetscBool)(a < cloud->n_owned && CloudLevel(cloud, a) == level);
}

/* --- sort.c --- */

/* TensionSort - finds for each level where its particles are near the surface, and sorts the liquid for these.
   LiquidSort - sorts the liquid of a level, with its weights, and takes it into use: the fluid particles whose keep
   flags ([n_total], NULL: all) are set, of tension->phase alone if there is one. LiquidAround - sets the keep flags of
   what may be within a radius (m) of the 'count' particles of (local indices). SurfaceList - the local indices of the
   surface particles, kept as by LiquidSort. Not collective. */
PetscErrorCode TensionSort(Tension tension, Cloud cloud);
PetscErrorCode LiquidSort(Tension tension, Cloud cloud, PetscInt level, const unsigned char keep[]);
PetscErrorCode LiquidAround(Cloud cloud, PetscReal radius, PetscInt count, const PetscInt of[], unsigned char keep[]);
PetscErrorCode SurfaceList(Tension tension, Cloud cloud, const unsigned char keep[], PetscInt of[], PetscInt *count);

/* TensionNear - whether particle a of a level is within SURFACE_REACH H of a surface particle: exactly, so that it does
   not depend on where the cells are. After TensionSort. Not collective. */
static inline PetscBool TensionNear(Tension tension, Cloud cloud, PetscInt level, PetscInt a)
{
  return SortedCellsWithin(&tension->surface[level], cloud->field[FIELD_POSITION] + DIM * a,
                           cloud->size[a] * TensionSurfaceReach(tension));
}

/* TensionScales - KernelScales of W^H, or another kernel, at the size of the particle whose sums are made. */
static inline void TensionScales(Tension tension, Kernel kernel, PetscReal *scale_w, PetscReal *scale_f,
                                 PetscReal *inverse_h2)
{
  const PetscReal square = PetscSqr(tension->size);

  KernelScales(kernel, scale_w, scale_f, inverse_h2);
  *scale_w /= PetscPowRealInt(tension->size, (int)tension->dim);
  *scale_f /= PetscPowRealInt(tension->size, (int)tension->dim) * square;
  *inverse_h2 /= square;
}

/* ContactCreate - takes over -<s>_contact_angle of the scene's solids. ContactSetFromOptions - -wall_contact_angle,
   -box_<face>_contact_angle, inside an options block; refuses (UserError) that of a face that is no wall. Collective.
 */
PetscErrorCode ContactCreate(Tension tension, Domain domain, Scene scene);
PetscErrorCode ContactSetFromOptions(Tension tension, OptionItems PetscOptionsObject);
/* ContactView - the angles of walls and solids, and a warning of those that look like radians. Collective. */
PetscErrorCode ContactView(Tension tension, PetscViewer viewer);
/* ContactFindSolids - place, normal and index of SolidContact, ghosts too. ContactFindMeeting - its meeting, from
   normals ([n_total][3]) and depths ([n_total], m) of the particles near the free surface. ContactRestore - ends what
   ContactFindSolids began. Collective. */
PetscErrorCode ContactFindSolids(Tension tension, Cloud cloud);
PetscErrorCode ContactFindMeeting(Tension tension, Cloud cloud, const PetscReal normal[], const PetscReal depth[]);
PetscErrorCode ContactRestore(Tension tension, Cloud cloud);
PetscErrorCode ContactDestroy(Tension tension);
/* ContactCollect - collects the columns of what is around the particle at place p and x, unless that has been done for
   its cell: of the liquid, and of its images in walls, which have the first 'width' columns. Columns 3 to 5 hold
   normals if width says that there are any. Not collective. */
PetscErrorCode ContactCollect(Tension tension, Domain domain, PetscInt p, const PetscReal x[DIM], PetscInt columns,
                              PetscInt width, Around *around);
/* ContactSlant - moves the collected images to where particle a sees them, along a vector out of the liquid; less where
   its part along the wall is shorter than that of a surface which meets the wall, if its length is 'full'.
   ContactShare - the volume, over that of its particle, of the collected image k around the particle at x (m); only
   where images.used. ContactOf - the contact angle of a group of images, and the unit vector from the wall into the
   liquid, at particle a; NULL: no solid is near it. Not collective. */
void  ContactSlant(Tension tension, const Around *around, PetscInt a, const PetscReal outward[DIM], PetscReal full);
float ContactShare(Tension tension, PetscInt k, const PetscReal x[DIM]);
const ContactAngle *ContactOf(Tension tension, const WallImages *image, PetscInt a, PetscReal inward[DIM]);

/* SheetShare - how far a particle with phi and |grad phi| (1/m) is one of a sheet too thin for normals: 0 not, 1 all.
   Here and below the sizes of graded particles are tension->size. Not collective. */
PetscReal SheetShare(Tension tension, PetscReal phi, PetscReal gradient);
/* SheetSlope - dS/dphi (m2) of the surface S that a particle of volume V_0 and this phi has in a sheet. Not collective.
 */
PetscReal SheetSlope(Tension tension, PetscReal phi);
/* SheetHoop - adds to FIELD_ACCELERATION of ring a the pull of its sheet towards the axis, a hoop; slope (Pa m2) is
   sigma times SheetSlope times SheetShare. Not collective. */
void SheetHoop(Tension tension, Cloud cloud, PetscInt a, PetscReal slope, PetscReal phi);
/* SheetPull - adds the forces between thin particles and all others to FIELD_ACCELERATION. The liquid must be sorted;
   slope ([n_total], Pa m2; that of ghosts is overwritten) is sigma times SheetSlope times share, and share ([n_owned])
   SheetShare, of the owned particles; both become zero in threads. Collective. */
PetscErrorCode SheetPull(Tension tension, Cloud cloud, PetscReal slope[], PetscReal share[]);

/* LooseFind - sets tension->loose from the rings' positions and neighbours. LooseHas - whether ring a is loose (never
   of particles that are no rings). LooseFind is collective. */
PetscErrorCode          LooseFind(Tension tension, Cloud cloud);
static inline PetscBool LooseHas(Tension tension, PetscInt a)
{
  return (PetscBool)(tension->loose && tension->loose[a]);
}

/* MarangoniAdd - adds to FIELD_ACCELERATION (m/s2) of the particles on the free surface its pull along itself where
   bodies of different tension share it; nothing if all have the same. Needs normals and correction of the last
   search. Not collective. */
void MarangoniAdd(Cloud cloud);

/* InterfaceApply - with two liquids in place of one pass of the model's apply, once for the surface of each liquid and
   once for that of both: sets what that sets, and the cloud's meets, jump and jump_slope. Collective. */
PetscErrorCode InterfaceApply(Tension tension, Cloud cloud);

/* CahnHilliardStress - S ([n_owned][6], N/m2) of Eq. (7), zero beyond the band; leaves the liquid sorted. Collective.
 */
PetscErrorCode CahnHilliardStress(Tension tension, Cloud cloud, PetscReal stress[]);
/* The constructors of the models set tension's functions. */
PetscErrorCode TensionCreate_CahnHilliard(Tension tension);
PetscErrorCode TensionCreate_Curvature(Tension tension);

#endif
