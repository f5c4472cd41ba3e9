/* Private to tension/. */
#ifndef ISPH_TENSION_TYPES_H
#define ISPH_TENSION_TYPES_H

#include "../neighbors/sorted_cells.h"
#include "../operators/operators.h"
#include "tension.h"

#define WALL_TABLE 256 /* intervals of the tables over a depth or a filled fraction */
#define SHEET_CORE 0.5 /* range of the repulsion in thin sheets, over H: see sheet.c */

/* Columns of the sorted liquid (SortedCells) with fixed contents: the cloud's weights, if they differ (for rings the
   area over V_0); the local index, if solids have a contact angle (contact.c); FIELD_LINE (moving_line.c). */
#define DEPTH_COLUMN  7
#define WEIGHT_COLUMN 8
#define SOLID_COLUMN  9
#define LINE_COLUMN   10

/* --- the models --- */

/* A linear fit to values at the neighbours of a particle whose normals point to the same side. */
typedef struct {
  PetscBool enough;    /* enough neighbours for a slope */
  PetscReal x[DIM];    /* weighted mean position of the neighbours relative to the particle, m */
  PetscReal B[6];      /* inverse of their weighted second moments about this mean, 1/m2 */
  PetscReal inverse_w; /* 1/sum W */
  PetscInt  count;     /* number of neighbours */
} NormalFit;

/* --- contact.c, contact_solid.c: images of the liquid behind walls, with their contact angles --- */

typedef struct {
  PetscReal angle, cosine, sine; /* in the liquid, rad */
  PetscReal image_tilt;          /* half of the displacement of images along the wall, over their distance from it */
  PetscReal residual_tan;        /* 1/(cot(angle) - image_tilt) */
  PetscReal hysteresis_force;    /* (cos r - cos a)/2, over sigma: see hysteresis.c */
} ContactAngle;

#define LINE_TABLE 1024

/* Contact lines that move, moving_line.c. */
typedef struct {
  int              law;               /* of the angle; 0: as at rest */
  PetscReal        slip;              /* m */
  PetscReal        x[LINE_TABLE + 1]; /* X over the angle */
  const PetscReal *of;                /* [n_total] borrowed: FIELD_LINE of the cloud */
  PetscReal        fastest;           /* largest capillary number of a line on this rank, at the last TensionApply */
  PetscReal       *start, *wanted;    /* [n_fluid] FIELD_LINE before the step, and what it tends to */
} MovingLine;

/* The images that one wall, or all solids, add to the collected particles: begin to end - 1. */
typedef struct {
  PetscInt            begin, end, axis;
  PetscReal           wall, inward[DIM]; /* of a face: position along the axis, m; unit vector into the liquid */
  const ContactAngle *contact;           /* of a face; NULL: solids, where each particle has its own, see ContactOf */
} WallImages;

/* The particles collected around those of one cell: 'real' particles, then the images of 'images' walls, n in all. */
typedef struct {
  PetscInt   cell, width, real, n, images; /* width: the first columns */
  WallImages image[2 * DIM + 1];
} Around;

/* Data of each of these images. */
typedef struct {
  PetscBool used;                      /* false if all are plain mirror images */
  PetscInt capacity, *parent, *origin; /* [capacity] the candidate that it mirrors, and the real particle behind that */
  float   *volume;                     /* [capacity] its volume over that of the real particle */
} Images;

/* Data of the particles near solids with a contact angle. */
typedef struct {
  Scene         scene; /* borrowed */
  PetscInt      count; /* number of solids; 0: none has a contact angle */
  ContactAngle *angle; /* [count] angle 0: no contact angle */
  PetscReal *mirror; /* [n_total][3] distance (m) from the nearest solid; volume of the image over the particle's, 0: no
                        image; index of the solid, negative: none near, or without contact angle */
  PetscReal  *normal;  /* [n_total][3] outward normal of the solid ... */
  PetscReal  *meeting; /* [n_total][3] ... and the same at the free surface next to the particle */
  PetscReal  *index;   /* [n_total] local indices, for SOLID_COLUMN */
  SortedCells dummies; /* particles of all solids */
} SolidContact;

/* A model: its options, which are read into the tension, its tables and the work of TensionApply. Members may be NULL.
 */
typedef struct {
  Choice choice;
  PetscErrorCode (*more)(Tension, OptionItems); /* reads options that are not in the table */
  PetscErrorCode (*apply)(Tension, Cloud);
  PetscReal step_limit, step_most; /* see TensionStepLimits */
} TensionModel;

extern const TensionModel TensionCahnHilliard, TensionCurvature;
#define STEP_LIMIT_PLAIN 0.25 /* with twice this limit a capillary wave of cahn_hilliard grows */

struct _p_Tension {
  MPI_Comm            comm;
  PetscBool           active; /* the scene has tension and the model is not none */
  PetscInt            dim;
  PetscBool           rings, weighted; /* the cloud's weights are not all 1 */
  PetscReal           size, size_most; /* of the particle being summed, 1; largest of all */
  char                type[OPTION_WORD_LENGTH];
  const TensionModel *model;
  PetscReal           spacing, smoothing, ratio; /* d0, h (m); H/h */
  Kernel              kernel;                    /* W^H */
  Kernel              core;                      /* with smoothing length SHEET_CORE H: sheet.c */
  /* Each level of sizes of graded particles (CloudLevel) has its own cells; else there is one level. */
  PetscInt        levels;
  PetscReal       largest[SIZE_LEVELS];          /* largest size in the level, 1 */
  SortedCells     liquids[SIZE_LEVELS], *liquid; /* fluid particles, ghosts too; the level in use */
  SortedCells     surface[SIZE_LEVELS];          /* surface particles */
  unsigned char  *close;                         /* [n_owned] of TensionSort */
  const PetscInt *also;                 /* [n_total] 1: counts as a surface particle, too; NULL: none; borrowed */
  PetscReal       wall[WALL_TABLE + 1]; /* w1 over depth, 1/m */

  PetscReal calibration, band; /* cahn_hilliard */
  CellMask  near;              /* cahn_hilliard: where the model is evaluated */
  PetscBool summed;            /* cahn_hilliard: summed density, not rest density */

  PetscBool    sheets;          /* curvature: sheet.c is used */
  PetscReal    slender;         /* for rings: see loose.c */
  PetscBool   *loose;           /* [n_owned] rings in flight that count as rows of drops; NULL without rings */
  PetscReal    sharpening;      /* of the curvature */
  FaceType     face[DIM][2];    /* of the box */
  ContactAngle contact[DIM][2]; /* of its walls */
  PetscBool    interface;       /* the scene has two immiscible liquids */
  /* curvature with two liquids, see interface.c: bits of the liquids whose surface is evaluated, 0 if liquids mix;
     their part of the tension, N/m; [n_total] bits of the particles */
  PetscInt       phase;
  PetscReal      part;
  unsigned char *phases;
  SolidContact   solid;
  MovingLine     line;
  Images         images;
  PetscBool      tilted;                   /* a contact angle is not 90 degrees: see ContactTilt */
  PetscBool      hysteresis;               /* some contact angle has hysteresis: see hysteresis.c */
  PetscBool      walls;                    /* the box has walls */
  PetscReal      depth[WALL_TABLE + 1];    /* depth (m) over the filled fraction 0.5 to 1 */
  PetscReal      fraction[WALL_TABLE + 1]; /* F over w1/w1(0) */
  PetscReal      plane, moment;            /* w1(0), 1/m; int x^2 W dA over a plane, m */
  NormalFit     *fit[SIZE_LEVELS];         /* [fit_capacity], by place in the sorted liquid of the level */
  PetscInt       fit_capacity[SIZE_LEVELS];
  float         *weight; /* [weight_capacity] weights of the fits' neighbours ... */
  int32_t       *place;  /* [weight_capacity] ... and their places among the collected particles */
  PetscInt64     weight_capacity;
};

/* A particle has a normal only within SURFACE_REACH H of a surface particle. Below a flat surface |grad phi| H falls
   below THRESHOLD 0.9 H deep. Where two surfaces meet, particles between them have a normal at larger distances: at
   most one in a hundred of those that a wider search finds, and none beyond 1.35 H. */
#define SURFACE_REACH 1.35
static inline PetscReal TensionSurfaceReach(Tension tension)
{
  return SURFACE_REACH * KernelSmoothingLength(tension->kernel);
}
#define CHUNK 512 /* collected candidates in one pass of a loop: their arrays fit into the first cache */

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

/* TensionLevel - makes the liquid of a level of sizes the current one and returns it. TensionOwns - whether particle a
   is owned and in the level. */
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

/* TensionSort - marks in 'close' the fluid particles within SURFACE_REACH H of a surface particle, independent of the
   cells, and sorts the liquid around them for each level. LiquidSort -
   sorts the liquid of a level, with its weights, and makes it the current one: fluid particles with keep flags
   ([n_total], NULL: all), of tension->phase only if that is set. LiquidAround - sets the keep flags of fluid particles
   that may be within a radius (m) of the 'count' particles 'of' (local indices). SurfaceList - the local indices of the
   surface particles that LiquidSort would keep. Not collective. */
PetscErrorCode TensionSort(Tension tension, Cloud cloud);
PetscErrorCode LiquidSort(Tension tension, Cloud cloud, PetscInt level, const unsigned char keep[]);
PetscErrorCode LiquidAround(Cloud cloud, PetscReal radius, PetscInt count, const PetscInt of[], unsigned char keep[]);
PetscErrorCode SurfaceList(Tension tension, Cloud cloud, const unsigned char keep[], PetscInt of[], PetscInt *count);

/* TensionScales - KernelScales of W^H, or another kernel, at the size of the particle being summed. */
static inline void TensionScales(Tension tension, Kernel kernel, PetscReal *scale_w, PetscReal *scale_f,
                                 PetscReal *inverse_h2)
{
  const PetscReal square = PetscSqr(tension->size);

  KernelScales(kernel, scale_w, scale_f, inverse_h2);
  *scale_w /= PetscPowRealInt(tension->size, (int)tension->dim);
  *scale_f /= PetscPowRealInt(tension->size, (int)tension->dim) * square;
  *inverse_h2 /= square;
}

/* ContactCreate - takes -<s>_contact_angle from the scene's solids. ContactSetFromOptions - reads -wall_contact_angle
   and -box_<face>_contact_angle, inside an options block; refuses (UserError) a contact angle of a face that is no
   wall. Collective. */
PetscErrorCode ContactCreate(Tension tension, Domain domain, Scene scene);
PetscErrorCode ContactSetFromOptions(Tension tension, OptionItems PetscOptionsObject);
/* LineLaw - the name of the law of the angles of lines that move. Not collective. */
const char *LineLaw(Tension tension);
/* ContactView - prints the angles of walls and solids, and warns of angles that look like radians. Collective. */
PetscErrorCode ContactView(Tension tension, PetscViewer viewer);
/* ContactJson - writes the angles into the open object. Not collective. */
void ContactJson(Tension tension, Json *json);
/* ContactFindSolids - finds mirror, normal and index of SolidContact, ghosts too. ContactFindMeeting - finds meeting,
   from normals ([n_total][3]) and depths ([n_total], m) of the particles near the free surface. ContactRestore -
   returns the work arrays of ContactFindSolids. Collective. */
PetscErrorCode ContactFindSolids(Tension tension, Cloud cloud);
PetscErrorCode ContactFindMeeting(Tension tension, Cloud cloud, const PetscReal normal[], const PetscReal depth[]);
PetscErrorCode ContactRestore(Tension tension, Cloud cloud);
PetscErrorCode ContactDestroy(Tension tension);
/* ContactCollect - collects the columns of the liquid around the particle at place p and position x, and of images in
   walls, with their first 'width' columns; once for each cell. Columns 3 to 5 are normals if width > 3. Not
   collective. */
PetscErrorCode ContactCollect(Tension tension, Domain domain, PetscInt p, const PetscReal x[DIM], PetscInt columns,
                              PetscInt width, Around *around);
/* ContactTilt - moves the collected images for particle a at x (m) along the wall, in the direction of 'outward', a
   vector out of the liquid. They move less if its part along the wall is shorter than that of a vector of length 'full'
   of a surface that meets the wall. ContactVolume - the volume of the collected image k over that of its particle, as
   seen from x (m); only if images.used. ContactOf - the contact angle of a group of images at particle a, and the unit
   vector from the wall into the liquid; false: no solid is near. Not collective. */
void      ContactTilt(Tension tension, const Around *around, PetscInt a, const PetscReal x[DIM],
                      const PetscReal outward[DIM], PetscReal full);
float     ContactVolume(Tension tension, PetscInt k, const PetscReal x[DIM]);
PetscBool ContactOf(Tension tension, const WallImages *image, PetscInt a, PetscReal inward[DIM], ContactAngle *contact);

/* LineSetFromOptions - reads -wall_contact_law and -wall_contact_slip, inside an options block. LineAngle - the angle
   (rad) of a line with this angle at rest (rad) and capillary number, beside particles of tension->size. LineStart -
   gives ghosts their FIELD_LINE. LineFind - from the normals ([n_total][3]) out of the liquid, what TensionMoveLines
   needs, and the fastest line; INT_SURFACE of ghosts must be current. Only LineSetFromOptions and LineStart are
   collective. */
PetscErrorCode LineSetFromOptions(Tension tension, OptionItems PetscOptionsObject);
PetscReal      LineAngle(Tension tension, PetscReal at_rest, PetscReal capillary);
PetscErrorCode LineStart(Tension tension, Cloud cloud);
PetscErrorCode LineFind(Tension tension, Cloud cloud, const PetscReal normal[]);

/* SheetShare - the degree to which a particle with phi and |grad phi| (1/m) is in a sheet too thin for normals: 0: not,
   1: wholly. Here and below the size of a graded particle is tension->size. Not collective. */
PetscReal SheetShare(Tension tension, PetscReal phi, PetscReal gradient);
/* SheetSlope - dS/dphi (m2), with S the surface of a particle of volume V_0 and this phi in a sheet. Not collective. */
PetscReal SheetSlope(Tension tension, PetscReal phi);
/* SheetHoop - adds the pull of ring a's sheet towards the axis, a hoop, to FIELD_ACCELERATION. slope (Pa m2): sigma
   times SheetSlope times SheetShare. Not collective. */
void SheetHoop(Tension tension, Cloud cloud, PetscInt a, PetscReal slope, PetscReal phi);
/* SheetPull - adds the forces between particles of thin sheets and all others to FIELD_ACCELERATION. The liquid must be
   sorted. slope ([n_total], Pa m2; values of ghosts are overwritten): sigma times SheetSlope times share; share
   ([n_owned]): SheetShare. Both become zero in threads. Collective. */
PetscErrorCode SheetPull(Tension tension, Cloud cloud, PetscReal slope[], PetscReal share[]);

/* LooseFind - sets tension->loose from the rings' positions and neighbours. Collective. LooseHas - whether ring a is
   loose; false for other particles. Not collective. */
PetscErrorCode LooseFind(Tension tension, Cloud cloud);
/* LooseSetFromOptions - reads -tension_slender. Collective. */
PetscErrorCode          LooseSetFromOptions(Tension tension, OptionItems PetscOptionsObject);
static inline PetscBool LooseHas(Tension tension, PetscInt a)
{
  return (PetscBool)(tension->loose && tension->loose[a]);
}

/* MarangoniAdd - adds the pull grad_s sigma along a free surface that bodies of different tension share to
   FIELD_ACCELERATION (m/s2) of the particles on it; nothing if all have one tension. Needs normals and correction of
   the last search. Not collective. */
void MarangoniAdd(Cloud cloud);

/* InterfaceApply - with two liquids, in place of one pass of the model's apply: one pass for the surface of each
   liquid, and one for the surface of both together. Sets the same fields, and the cloud's at_interface, pressure_jump
   and pressure_jump_slope. Collective. */
PetscErrorCode InterfaceApply(Tension tension, Cloud cloud);

/* CahnHilliardGradient - g = root(kappa) grad phi ([n_owned][3], root of N/m2), zero beyond the band; Eq. (7) is S =
   |g|^2 I - g (x) g. With summed densities g has the factor root(rho_0)/rho besides, and FIELD_ACCELERATION gets the
   part of a particle's own S. The liquid stays sorted. Collective. */
PetscErrorCode CahnHilliardGradient(Tension tension, Cloud cloud, PetscReal g[]);
/* The constructors of the models set tension's functions. */

/* --- near_wall.c --- */
/* A wall face of the box, or the nearest solid with a contact angle. */
#define WALLS_NEAR (2 * DIM + 1)
typedef struct {
  const ContactAngle *contact;
  PetscReal           distance, inward[DIM], velocity[DIM]; /* m, negative inside a solid; into the liquid; m/s */
} LineWall;
/* WallsNear - those within 'reach' (m) of particle a; returns how many. Not collective. */
PetscInt WallsNear(Tension tension, Cloud cloud, PetscInt a, PetscReal reach, LineWall wall[WALLS_NEAR]);

#endif
