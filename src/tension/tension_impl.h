/* Private to tension/: what the models share. curvature.h has the data of that model. */
#ifndef ISPH_TENSION_TYPES_H
#define ISPH_TENSION_TYPES_H

#include "../neighbors/sorted_cells.h"
#include "../operators/operators.h"
#include "tension.h"

#define WALL_TABLE 256 /* intervals of the tables over a depth or a filled fraction */

/* Column of the sorted liquid (SortedCells) for the cloud's weights, if they differ (for rings the area over V_0). */
#define WEIGHT_COLUMN 8

/* The particle around which a sum is taken. */
typedef struct {
  SortedCells *liquid; /* of its level of sizes */
  PetscInt     p, a;   /* its place there; its local index */
  PetscReal    x[DIM]; /* m */
  PetscReal    size;   /* 1 */
} At;

/* A model: its data (tension->data) with their options, tables and the work of TensionApply; the tension is the owner.
   Members may be NULL. */
typedef struct {
  Choice choice;
  PetscErrorCode (*more)(Tension, OptionItems); /* reads options that are not in the table */
  PetscErrorCode (*apply)(Tension, Cloud);
  PetscErrorCode (*destroy)(Tension); /* frees what the data hold */
  PetscBool on_surface;               /* see TensionOnSurface; the data are Curvature */
  PetscReal step_limit, step_most;    /* see TensionStepLimits */
} TensionModel;

extern const TensionModel TensionCahnHilliard, TensionCurvature;
#define STEP_LIMIT_PLAIN 0.25 /* with twice this limit a capillary wave of cahn_hilliard grows */

/* What TensionApplyAhead keeps: of the n particles that have some, ascending, in a local order; see pair.c. */
typedef struct {
  PetscInt   layout, n, capacity, *of;
  PetscReal *value;
} Kept;

struct _p_Tension {
  MPI_Comm            comm;
  Scene               scene;  /* borrowed */
  PetscBool           active; /* the scene has tension and the model is not none */
  PetscInt            dim;
  PetscBool           rings, weighted; /* the cloud's weights are not all 1 */
  TensionSurfaces     surfaces;        /* of TensionSetSurfaces; NULL: that of all liquid */
  FaceType            face[DIM][2];    /* of the box */
  char                type[OPTION_WORD_LENGTH];
  const TensionModel *model;
  void               *data;
  PetscReal           spacing, smoothing, ratio; /* d0, h (m); H/h */
  Kernel              kernel;                    /* W^H */
  /* Each level of sizes of graded particles (CloudLevel) has its own cells; else there is one level. */
  PetscInt    levels;
  PetscReal   size_most, largest[SIZE_LEVELS]; /* largest size; the same in the level, 1 */
  SortedCells liquid[SIZE_LEVELS];             /* fluid particles, ghosts too */
  Kept        kept;
};

/* TensionClear - zero tension, but for FIELD_ACCELERATION. Not collective. */
void TensionClear(Cloud cloud);

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
static inline void Distances(const At *at, PetscInt begin, PetscInt m, PetscReal inverse_h2, float *restrict s)
{
  const PetscReal *restrict cx = at->liquid->near + begin, *restrict cy = cx + at->liquid->stride,
                            *restrict cz = cy + at->liquid->stride;
  const PetscReal x0 = at->x[0], y0 = at->x[1], z0 = at->x[2];

  SIMD_LOOP()
  for (PetscInt k = 0; k < m; k++)
    s[k] = (float)((PetscSqr(x0 - cx[k]) + PetscSqr(y0 - cy[k]) + PetscSqr(z0 - cz[k])) * inverse_h2);
}

/* TensionOwns - whether the particle at place p of the liquid of a level is owned and in the level. TensionAt - that
   particle. Not collective. */
static inline PetscBool TensionOwns(Tension tension, Cloud cloud, PetscInt level, PetscInt p)
{
  const PetscInt a = tension->liquid[level].index[p];

  return (PetscBool)(a < cloud->n_owned && CloudLevel(cloud, a) == level);
}
static inline At TensionAt(Tension tension, Cloud cloud, PetscInt level, PetscInt p)
{
  At at = {.liquid = &tension->liquid[level], .p = p, .a = tension->liquid[level].index[p]};

  SortedPosition(at.liquid, p, at.x);
  at.size = cloud->size[at.a];
  return at;
}

/* --- sort.c --- */

/* LiquidSort - sorts the liquid of a level, with its weights: fluid particles of the phase with keep flags ([n_total],
   NULL: all). LiquidAround - sets the keep flags of fluid particles that may be within a radius (m) of the 'count'
   particles 'of' (local indices). SurfaceList - the local indices of the surface particles that LiquidSort would keep.
   Not collective. */
PetscErrorCode LiquidSort(Tension tension, Cloud cloud, const Phase *phase, PetscInt level, const unsigned char keep[]);
PetscErrorCode LiquidAround(Cloud cloud, PetscReal radius, PetscInt count, const PetscInt of[], unsigned char keep[]);
PetscErrorCode SurfaceList(Cloud cloud, const Phase *phase, const unsigned char keep[], PetscInt of[], PetscInt *count);

/* AtScales - KernelScales of W^H, or another kernel, at the size of the particle. */
static inline void AtScales(const At *at, PetscInt dim, Kernel kernel, PetscReal *scale_w, PetscReal *scale_f,
                            PetscReal *inverse_h2)
{
  const PetscReal square = PetscSqr(at->size);

  KernelScales(kernel, scale_w, scale_f, inverse_h2);
  *scale_w /= PetscPowRealInt(at->size, (int)dim);
  *scale_f /= PetscPowRealInt(at->size, (int)dim) * square;
  *inverse_h2 /= square;
}

/* --- cahn_hilliard.c --- */
typedef struct {
  PetscReal calibration;
  PetscBool summed;               /* density; else rest density */
  CellMask  near;                 /* where the model is evaluated */
  PetscReal wall[WALL_TABLE + 1]; /* w1 over depth, 1/m */
} CahnHilliard;

/* CahnHilliardMark - sets 'near': all within a radius (m) of the surface particles of all ranks. Collective. */
PetscErrorCode CahnHilliardMark(Tension tension, Cloud cloud, PetscReal radius);
/* CahnHilliardGradient - g = root(kappa) grad phi ([n_owned][3], root of N/m2), zero beyond the band; Eq. (7) is S =
   |g|^2 I - g (x) g. With summed densities g has the factor root(rho_0)/rho besides, and FIELD_ACCELERATION gets the
   part of a particle's own S. The liquid stays sorted. Collective. */
PetscErrorCode CahnHilliardGradient(Tension tension, Cloud cloud, PetscReal g[]);

#endif
