/* Images of a point through periodic faces and mirrors. */
#ifndef ISPH_IMAGES_H
#define ISPH_IMAGES_H

#include "domain.h"

#define IMAGES_MOST 27 /* of a point: 3 a direction */
/* An image of a point: its position x (m), and the sign of each velocity component there. */
typedef struct {
  PetscReal x[DIM], sign[DIM];
} Image;

/* DomainImages - the point at [dim] (m), and its images through periodic faces and mirrors that lie within reach (m) of
   the box. Returns their number. What is near an image is near the point in another copy of the liquid. Not
   collective. */
PetscInt DomainImages(Domain domain, const PetscReal at[], PetscReal reach, Image image[IMAGES_MOST]);

#endif
