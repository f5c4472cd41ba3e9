/* Work arrays for functions, so that no field of the cloud serves as scratch memory. */
#include "work.h"

struct _p_WorkArray {
  PetscReal *values;
  PetscInt   size; /* numbers for which it has room */
  PetscBool  in_use;
  WorkArray *next;
};

PetscErrorCode CloudGetWork(Cloud cloud, PetscInt width, PetscReal **array)
{
  const PetscInt size = cloud->capacity * width;
  WorkArray     *work = NULL;

  PetscFunctionBegin;
  for (WorkArray *w = cloud->work; w; w = w->next)
    if (!w->in_use && (!work || (work->size < size ? w->size > work->size : w->size >= size && w->size < work->size)))
      work = w; /* the smallest array that is large enough, else the largest */
  if (!work) {
    PetscCall(PetscNew(&work));
    work->next  = cloud->work;
    cloud->work = work;
  }
  if (work->size < size) {
    PetscCall(PetscFree(work->values));
    PetscCall(PetscMalloc1(size, &work->values));
    work->size = size;
  }
  work->in_use = PETSC_TRUE;
  *array       = work->values;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudRestoreWork(Cloud cloud, PetscReal **array)
{
  WorkArray *work = cloud->work;

  PetscFunctionBegin;
  while (work && !(work->in_use && work->values == *array)) work = work->next;
  PetscCheck(work, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "not an array of CloudGetWork, or restored twice");
  work->in_use = PETSC_FALSE;
  *array       = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudFreeWork(Cloud cloud)
{
  PetscFunctionBegin;
  while (cloud->work) {
    WorkArray *work = cloud->work;

    cloud->work = work->next;
    PetscCall(PetscFree(work->values));
    PetscCall(PetscFree(work));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
