/* Private to tension/: the model curvature, its data and its parts. */
#ifndef ISPH_CURVATURE_H
#define ISPH_CURVATURE_H

#include "contact.h"
#include "tension_impl.h"

#define SHEET_CORE 0.5 /* range of the repulsion in thin sheets, over H: see sheet.c */

/* More columns of the sorted liquid with fixed contents: depths, if images are moved; the local index, if solids have a
   contact angle; bend. */
#define DEPTH_COLUMN 7
#define SOLID_COLUMN 9
#define LINE_COLUMN  10

/* A linear fit to values at the neighbours of a particle whose normals point to the same side. */
typedef struct {
  PetscBool enough;    /* enough neighbours for a slope */
  PetscBool sorted;    /* no images were collected: the neighbours' places are those in the sorted liquid */
  PetscReal x[DIM];    /* weighted mean position of the neighbours relative to the particle, m */
  PetscReal B[6];      /* inverse of their weighted second moments about this mean, 1/m2 */
  PetscReal inverse_w; /* 1/sum W */
  PetscInt  count;     /* number of neighbours */
} NormalFit;

/* --- images.c, images_solid.c: images of the liquid behind walls, with their contact angles --- */

/* The images that one wall, or all solids, add to the collected particles: begin to end - 1. */
typedef struct {
  PetscInt            begin, end, axis;
  PetscReal           wall, inward[DIM]; /* of a face: position along the axis, m; unit vector into the liquid */
  const ContactAngle *contact;           /* of a face; NULL: solids, where each particle has its own, see ImagesAngle */
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
  PetscReal *mirror; /* [n_total][3] distance (m) from the nearest solid; volume of the image over the particle's, 0: no
                        image; index of the solid, negative: none near, or without contact angle */
  PetscReal  *normal;  /* [n_total][3] outward normal of the solid ... */
  PetscReal  *meeting; /* [n_total][3] ... and the same at the free surface next to the particle */
  PetscReal  *index;   /* [n_total] local indices, for SOLID_COLUMN */
  SortedCells dummies; /* particles of all solids */
} SolidImages;

/* The data of the model. */
typedef struct {
  PetscBool   sheets; /* sheet.c is used */
  Contacts    contact;
  Images      images;
  SolidImages solid;
  /* tables */
  Kernel    core;                     /* W^H with the smoothing length SHEET_CORE H: sheet.c */
  PetscReal depth[WALL_TABLE + 1];    /* depth (m) over the filled fraction 0.5 to 1 */
  PetscReal fraction[WALL_TABLE + 1]; /* F over w1/w1(0) */
  PetscReal plane;                    /* w1(0), 1/m */
  /* of the last TensionApply */
  SortedCells    surface[SIZE_LEVELS]; /* surface particles */
  unsigned char *close;                /* [n_owned] of SortNearSurface */
  PetscBool     *loose;                /* [n_owned] rings in flight that count as rows of drops; NULL without rings */
  NormalFit     *fit[SIZE_LEVELS];     /* [fit_capacity], by place in the sorted liquid of the level */
  PetscInt       fit_capacity[SIZE_LEVELS];
  float         *weight; /* [weight_capacity] weights of the fits' neighbours ... */
  int32_t       *place;  /* [weight_capacity] ... and their places: see NormalFit's 'sorted' */
  PetscInt64     weight_capacity;
} Curvature;

/* CurvatureOf - the data; NULL: the model is another one. SortNearSurface - marks in 'close' the fluid particles within
   SURFACE_REACH H of a surface particle, independent of the cells, and sorts the liquid around them for each level. */
static inline Curvature *CurvatureOf(Tension tension)
{
  return tension->model->on_surface ? (Curvature *)tension->data : NULL;
}
PetscErrorCode SortNearSurface(Tension tension, Cloud cloud, const Phase *phase);

/* ImagesFindSolids - finds mirror, normal and index of SolidImages, ghosts too. ImagesFindMeeting - finds meeting,
   from normals ([n_total][3]) and depths ([n_total], m) of the particles near the free surface. ImagesRestore -
   returns the work arrays of ImagesFindSolids. Collective. */
PetscErrorCode ImagesFindSolids(Tension tension, Cloud cloud);
PetscErrorCode ImagesFindMeeting(Tension tension, Cloud cloud, const PetscReal normal[], const PetscReal depth[]);
PetscErrorCode ImagesRestore(Tension tension, Cloud cloud);
PetscErrorCode ImagesDestroy(Tension tension);
/* ImagesCollect - collects the columns of the liquid around a particle, and of images in walls, with their first
   'width' columns; once for each cell. Columns 3 to 5 are normals if width > 3. Not collective. */
PetscErrorCode ImagesCollect(Tension tension, Domain domain, const At *at, PetscInt columns, PetscInt width,
                             Around *around);
/* ImagesTilt - moves the collected images for a particle along the wall, in the direction of 'outward', a vector out
   of the liquid. They move less if its part along the wall is shorter than that of a vector of length 'full' of a
   surface that meets the wall. ImagesVolume - the volume of the collected image k over that of its particle, as seen
   from a particle; only if images.used. ImagesAngle - the contact angle of a group of images at a particle, and the
   unit vector from the wall into the liquid; false: no solid is near. Not collective. */
void      ImagesTilt(Tension tension, const At *at, const Around *around, const PetscReal outward[DIM], PetscReal full);
float     ImagesVolume(Tension tension, const At *at, PetscInt k);
PetscBool ImagesAngle(Tension tension, const At *at, const WallImages *image, PetscReal inward[DIM],
                      ContactAngle *contact);

/* SheetShare - the degree to which a particle with phi and |grad phi| (1/m) is in a sheet too thin for normals: 0: not,
   1: wholly. Not collective. */
PetscReal SheetShare(Tension tension, const At *at, PetscReal phi, PetscReal gradient);
/* SheetSlope - dS/dphi (m2), with S the surface of a particle of volume V_0 and this phi in a sheet. Not collective. */
PetscReal SheetSlope(Tension tension, const At *at, PetscReal phi);
/* SheetHoop - adds the pull of ring a's sheet towards the axis, a hoop, to FIELD_ACCELERATION. slope (Pa m2): sigma
   times SheetSlope times SheetShare. Not collective. */
void SheetHoop(Tension tension, Cloud cloud, PetscInt a, PetscReal slope, PetscReal phi);
/* SheetPlane - finds the plane of the sheet around a thin particle from the first n collected particles, as the matrix
   that projects onto it. slope (Pa m2), share: its sigma times SheetSlope times SheetShare, and that share; both become
   zero in threads. Not collective. */
void SheetPlane(Tension tension, const At *at, PetscInt n, PetscReal *slope, PetscReal *share, PetscReal plane[6]);
/* SheetPull - adds the forces between particles of thin sheets and all others to FIELD_ACCELERATION. slope ([n_total]),
   plane ([n_total][6]): of SheetPlane, zero slopes of other particles; values of ghosts are overwritten. Sorts the
   liquid anew. Collective. */
PetscErrorCode SheetPull(Tension tension, Cloud cloud, const Phase *phase, PetscReal slope[], PetscReal plane[]);

/* LooseFind - sets 'loose' from the rings' positions and neighbours. Collective. LooseHas - whether ring a is
   loose; false for other particles. Not collective. */
PetscErrorCode          LooseFind(Tension tension, Cloud cloud);
static inline PetscBool LooseHas(Tension tension, PetscInt a)
{
  const Curvature *data = tension->data;

  return (PetscBool)(data->loose && data->loose[a]);
}

#endif
