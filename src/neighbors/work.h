/* Private to neighbors/: the arrays of CloudGetWork. */
#ifndef ISPH_WORK_H
#define ISPH_WORK_H

#include "cloud.h"

/* CloudFreeWork - frees these arrays. Not collective. */
PetscErrorCode CloudFreeWork(Cloud cloud);

#endif
