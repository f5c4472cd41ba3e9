/* Private to following/: the spacing follows the liquid (-spacing_follow), as an Adaptive of the domain. */
#ifndef ISPH_FOLLOWING_IMPL_H
#define ISPH_FOLLOWING_IMPL_H

#include "../base/shared.h"
#include "../operators/operators.h"

/* The spacing that is wanted, in cells over the box, which the ranks of a machine share: see grid.c. */
typedef struct {
  PetscInt       n[DIM], count;    /* of cells */
  PetscReal      lower[DIM], size; /* m */
  PetscReal      unit;             /* m; a step between cells is 3, 4 or 5 'third', so that no sum is rounded */
  PetscInt       third;
  Shared         shared; /* both arrays */
  PetscInt      *value;  /* [count] in 'unit' */
  unsigned char *liquid; /* [count] 1: there is liquid in the cell */
} Target;

typedef struct {
  /* all free surfaces, or where they are curved; auto is replaced by one of these */
  enum { FOLLOW_NONE, FOLLOW_SURFACE, FOLLOW_CURVATURE, FOLLOW_AUTO } what;
  PetscInt particles_most; /* of all ranks: a target that needs more is made coarser; 0: no bound */
  Target   target;
} Follow;

extern const Adaptive FollowingAdaptive;

static inline Follow *FollowOf(Domain domain)
{
  return (Follow *)domain->adaptive_data;
}
static inline Target *TargetOf(Scene scene)
{
  return &FollowOf(SceneDomain(scene))->target;
}

/* Members of the record: TargetBodies - the target for the bodies at the start. TargetFind - that for the liquid and
   solids as they are, and the sizes ([n_total], 1) that it wants. TargetWalls - the dummy particles of the box's walls.
   Collective. TargetAt - the spacing (m) wanted at x (m), between the centres of the cells around it. Not collective.
 */
PetscErrorCode TargetBodies(Domain domain, Scene scene);
PetscErrorCode TargetFind(Cloud cloud, PetscReal size[]);
PetscErrorCode TargetWalls(Cloud cloud);
PetscReal      TargetAt(Domain domain, const PetscReal x[DIM]);

/* TargetClear forgets the sources. TargetSolids adds solids, where they are now, and emitters; the ranks share the
   cells. TargetSpread finishes the target; only the sources of this rank need to have been added. TargetFilled ends
   TargetFill. Collective. TargetAdd - adds a source at x (m), whose spacing (m) holds over BAND around it; a
   source that wants hardly less than the coarse spacing counts for nothing. TargetFill - tells that there is liquid at
   x (m), a particle of this spacing (m). TargetSpacing - after TargetFilled, the spacing (m) wanted at a point x (m) of
   the liquid's surface with this sum of the magnitudes of the principal curvatures (1/m); into: unit vector into the
   liquid. Not collective. */
PetscErrorCode TargetClear(Scene scene);
PetscErrorCode TargetSolids(Scene scene);
PetscErrorCode TargetSpread(Scene scene);
PetscErrorCode TargetFilled(Scene scene);
void           TargetAdd(Scene scene, const PetscReal x[DIM], PetscReal spacing);
void           TargetFill(Scene scene, const PetscReal x[DIM], PetscReal spacing);
PetscReal      TargetSpacing(Scene scene, const PetscReal x[DIM], const PetscReal into[DIM], PetscReal curvature);

#endif
