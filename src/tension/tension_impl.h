/* Private to tension/. */
#ifndef ISPH_TENSION_TYPES_H
#define ISPH_TENSION_TYPES_H

#include "../operators/operators.h"
#include "tension.h"

#define WALL_TABLE 256
#define SHEET_CORE 0.5 /* range of the repulsion in thin sheets, over H */

/* The liquid (fluid particles, ghosts too) sorted into cells, with columns of whatever a pass sums over. */
#define LIQUID_WIDTH 9
/* Cells a support: small enough that the cells around a particle are not much more than its sphere, large enough that
   the particles of one share the work of collecting them. */
#define LIQUID_CELLS 2
typedef struct {
  CellGrid   grid;
  PetscReal  support; /* m */
  PetscInt   capacity, count, stride;
  PetscInt   reach, along[LIQUID_CELLS + 2][LIQUID_CELLS + 2]; /* cells within the support: see CellsAlong */
  PetscReal *sorted; /* [LIQUID_WIDTH][count] x, y, z, then a payload, in the grid's order */
  PetscReal *near;   /* [LIQUID_WIDTH][stride] the same columns of what LiquidCollect found */
  PetscInt  *index;  /* [count] local index, before sorting: see LiquidParticle */
} Liquid;

/* CellsAlong - how many cells of a size (m) further along x may hold points within 'radius' (m) of a cell that is dy,
   dz cells away; -1: none. */
static inline PetscInt CellsAlong(PetscReal size, PetscReal radius, PetscInt dy, PetscInt dz)
{
  const PetscReal y = PetscMax(PetscAbsInt(dy) - 1, 0) * size, z = PetscMax(PetscAbsInt(dz) - 1, 0) * size,
                  rest = radius * radius - y * y - z * z;

  return rest > 0 ? (PetscInt)(PetscSqrtReal(rest) / size) + 1 : -1;
}

/* LiquidSort - sorts the fluid particles whose keep flag ([n_total], NULL: all) is true. Not collective. */
PetscErrorCode LiquidSort(Liquid *liquid, Cloud cloud, PetscReal support, const PetscBool keep[]);
/* LiquidLoad - fills columns from a field ([n_total][width]). */
void LiquidLoad(Liquid *liquid, PetscInt column, PetscInt width, const PetscReal field[]);
/* LiquidCollect - copies the columns whose bits are set, of all particles within the support of cell c, to near; *n of
   them, and room for copies times as many. */
#define COLUMNS(first, count) (((1 << (count)) - 1) << (first))
PetscErrorCode LiquidCollect(Liquid *liquid, PetscInt c, PetscInt columns, PetscInt copies, PetscInt *n);
PetscErrorCode LiquidReset(Liquid *liquid);

/* The local index of the particle at a place of the sorted order. */
static inline PetscInt LiquidParticle(const Liquid *liquid, PetscInt place)
{
  return liquid->index[liquid->grid.order[place]];
}

typedef PetscErrorCode (*TensionFunction)(Tension, Cloud);

#define BAND_CELLS 4 /* a radius; fewer if that were too many cells */

typedef struct {
  MPI_Comm       comm;
  PetscInt       dim;
  PetscBool      shared;                                       /* ranks tell each other of their surface particles */
  PetscReal      radius, lower[DIM], upper[DIM];               /* m; points beyond these count as on them */
  PetscReal      size;                                         /* of a cell, m */
  PetscInt       reach, along[BAND_CELLS + 2][BAND_CELLS + 2]; /* cells within the radius: see CellsAlong */
  PetscInt       first[DIM], n[DIM], capacity;                 /* the cells around the surface particles */
  unsigned char *surface, *near; /* [n[2]][n[1]][n[0]] holds a surface particle; is within the radius of one */
} Band;

/* BandCreate - for a distance 'radius' (m), over the box and 'pad' (m) around it. A rank has all particles within
   'known' (m) of its own, which may suffice. Not collective. */
PetscErrorCode BandCreate(Domain domain, PetscReal radius, PetscReal known, PetscReal pad, Band *band);
/* BandMark - finds the cells within the radius of the surface particles (INT_SURFACE is 1) of all ranks and their
   images, of which those are known to a rank that its own particles may be in. Collective. */
PetscErrorCode BandMark(Band *band, Cloud cloud);
PetscErrorCode BandDestroy(Band *band);

static inline PetscReal BandClamp(const Band *band, PetscInt d, PetscReal x)
{
  return PetscMax(band->lower[d], PetscMin(band->upper[d], x));
}

/* The cell of x (m); -1 if it is none of those around the surface particles. */
static inline PetscInt BandCell(const Band *band, const PetscReal x[DIM])
{
  PetscInt cell[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    cell[d] = (PetscInt)PetscFloorReal((BandClamp(band, d, x[d]) - band->lower[d]) / band->size) - band->first[d];
    if (cell[d] < 0 || cell[d] >= band->n[d]) return -1;
  }
  return (cell[2] * band->n[1] + cell[1]) * band->n[0] + cell[0];
}

/* BandNear - whether x (m) may be within the radius of a surface particle: true if it is, false if it is beyond the
   radius and the diagonals of two cells. Not collective. */
static inline PetscBool BandNear(const Band *band, const PetscReal x[DIM])
{
  const PetscInt cell = BandCell(band, x);

  return (PetscBool)(cell >= 0 && band->near[cell]);
}

/* A linear fit to values at the places around a particle whose normals look the same way: weighted mean place relative
   to it (m), inverse of the second moments about that mean (1/m2) if there are enough, 1/sum W. */
typedef struct {
  PetscReal B[6], x[DIM], inverse_w;
  PetscBool enough;
} NormalFit;

struct _p_Tension {
  MPI_Comm        comm;
  PetscBool       active;
  PetscInt        dim;
  char            type[64];
  TensionFunction apply;
  PetscReal       spacing, smoothing, ratio, calibration, band;
  PetscReal       sharpening;               /* of the curvature */
  PetscReal       threshold;                /* of |grad phi| H: the surface is near */
  PetscReal       angle;                    /* contact angle, rad */
  PetscBool       walls;                    /* the box has any */
  Kernel          kernel;                   /* W^H */
  Kernel          core;                     /* of SHEET_CORE H: sheet.c */
  PetscReal       wall[WALL_TABLE + 1];     /* w1 over depth, 1/m */
  PetscReal       depth[WALL_TABLE + 1];    /* depth (m) over the filled fraction 0.5 to 1 */
  PetscReal       fraction[WALL_TABLE + 1]; /* F over w1/w1(0) */
  PetscReal       plane, moment;            /* w1(0), 1/m; int x^2 W dA over a plane, m */
  Liquid          liquid;
  NormalFit      *fit; /* [fit_capacity], by place in the sorted liquid */
  PetscInt        fit_capacity;
  float          *weight; /* [weight_capacity] of the fits' candidates, in the order in which they are collected */
  PetscInt        weight_capacity;
  Band            band_cells;
  PetscBool       has_band, sheets; /* sheet.c is used */
};

#define CHUNK 512 /* candidates a loop takes at once */

/* s[k] = |x - c_k|^2/H^2 of m <= CHUNK collected candidates from 'begin' on. */
static inline void Distances(Tension tension, PetscInt begin, PetscInt m, const PetscReal x[DIM], PetscReal inverse_h2,
                             float *restrict s)
{
  const PetscReal *restrict cx = tension->liquid.near + begin, *restrict cy = cx + tension->liquid.stride,
                            *restrict cz = cy + tension->liquid.stride;
  const PetscReal x0 = x[0], y0 = x[1], z0 = x[2];

  SIMD_LOOP()
  for (PetscInt k = 0; k < m; k++)
    s[k] = (float)((PetscSqr(x0 - cx[k]) + PetscSqr(y0 - cy[k]) + PetscSqr(z0 - cz[k])) * inverse_h2);
}

/* TensionBand - brings band_cells up to date: cells within the radius (m) of a surface particle. Collective. */
PetscErrorCode TensionBand(Tension tension, Cloud cloud, PetscReal radius);
/* CurvatureSetUp - the tables of the depth. */
PetscErrorCode CurvatureSetUp(Tension tension);

/* SheetSlope - dS/dphi (m2) of the surface S that a particle of this volume (m3), phi and |grad phi| (1/m) has in a
   sheet. Not collective. */
PetscReal SheetSlope(Tension tension, PetscReal volume, PetscReal phi, PetscReal gradient);
/* SheetPull - adds the forces between thin particles and all others to FIELD_ACCELERATION; from the liquid, sorted, and
 * sigma S' in FIELD_CAPILLARY, which is zero afterwards. Collective. */
PetscErrorCode SheetPull(Tension tension, Cloud cloud);
PetscErrorCode TensionApply_CahnHilliard(Tension tension, Cloud cloud);
PetscErrorCode TensionApply_Curvature(Tension tension, Cloud cloud);
PetscErrorCode TensionApply_None(Tension tension, Cloud cloud);

#endif
