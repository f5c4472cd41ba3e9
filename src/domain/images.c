#include "images.h"

PetscInt DomainImages(Domain domain, const PetscReal at[], PetscReal reach, Image image[IMAGES_MOST])
{
  PetscInt count = 1;

  for (PetscInt d = 0; d < DIM; d++) {
    image[0].x[d]    = d < domain->dim ? at[d] : 0;
    image[0].sign[d] = 1;
  }
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscInt  before = count;
    const PetscReal length = domain->upper[d] - domain->lower[d];

    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal face = side ? domain->upper[d] : domain->lower[d];
      const FaceType  type = domain->face[d][side];

      if ((type != FACE_PERIODIC && type != FACE_SYMMETRY) || PetscAbsReal(at[d] - face) >= reach) continue;
      for (PetscInt k = 0; k < before; k++) {
        Image *copy = &image[count++];

        *copy = image[k];
        if (type == FACE_PERIODIC)
          copy->x[d] += side ? -length : length;
        else {
          copy->x[d]    = 2 * face - copy->x[d];
          copy->sign[d] = -1;
        }
      }
    }
  }
  return count;
}
