/* Where arrays live. The kernel maps memory in pages of 4 kB, or of 2 MB where a program asks for it; with large pages
   the loops over pairs take a tenth less time, for the processor finds the neighbours' values without a walk through
   the tables of pages. */
#define _DEFAULT_SOURCE
#include "base.h"
#include <malloc.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#define LARGE_ARRAY (1 << 23) /* bytes; the step's work arrays of small scenes stay on the heap, which is faster */
#define HEAP_GROWTH (1 << 26) /* bytes, by which the heap grows; large pages do not span two growths */

/* SuperLU_DIST, which PETSc loads, has told malloc to keep all on one heap that never shrinks, where an array that
   grows leaves a hole of its former size. */
void MemoryStart(void)
{
#if defined(M_MMAP_MAX)
  (void)mallopt(M_MMAP_MAX, 1 << 16);
  (void)mallopt(M_MMAP_THRESHOLD, LARGE_ARRAY);
  (void)mallopt(M_TOP_PAD, HEAP_GROWTH);
#endif
}

#if defined(MADV_HUGEPAGE)
static char *HeapEnd; /* so far large pages have been asked for */

static void Advise(char *from, const char *to)
{
  const size_t page = (size_t)sysconf(_SC_PAGESIZE), skip = (page - (size_t)from % page) % page;

  if (to > from + skip) (void)madvise(from + skip, (size_t)(to - from) - skip, MADV_HUGEPAGE);
}

/* Asks for large pages for what malloc has got from the kernel: more heap, or a map of its own for the array. */
static PetscErrorCode Check(void *array, size_t bytes, int line, const char function[], const char file[])
{
  char *end = (char *)sbrk(0);

  if (bytes && !array)
    return PetscError(PETSC_COMM_SELF, line, function, file, PETSC_ERR_MEM, PETSC_ERROR_INITIAL,
                      "there is no memory for an array of %.0f bytes", (double)bytes);
  if (end > HeapEnd) Advise(HeapEnd, end);
  HeapEnd = end;
  if (bytes >= LARGE_ARRAY) Advise((char *)array, (char *)array + bytes);
  return PETSC_SUCCESS;
}

/* PETSc's allocators. A new map is zero, so calloc does not touch it. */
static PetscErrorCode Allocate(size_t bytes, PetscBool clear, int line, const char function[], const char file[],
                               void **array)
{
  *array = !bytes ? NULL : clear ? calloc(1, bytes) : malloc(bytes);
  return Check(*array, bytes, line, function, file);
}

static PetscErrorCode Reallocate(size_t bytes, int line, const char function[], const char file[], void **array)
{
  void          *larger = bytes ? realloc(*array, bytes) : NULL;
  PetscErrorCode code   = Check(larger, bytes, line, function, file);

  if (!bytes) free(*array);
  if (!code) *array = larger;
  return code;
}

static PetscErrorCode Free(void *array, int line, const char function[], const char file[])
{
  free(array);
  return PETSC_SUCCESS;
}
#endif

PetscErrorCode MemoryUseLargePages(void)
{
  PetscFunctionBegin;
#if defined(MADV_HUGEPAGE)
  PetscBool debug;

  PetscCall(PetscMallocGetDebug(&debug, NULL, NULL));
  HeapEnd = (char *)sbrk(0);
  if (!debug) PetscCall(PetscMallocSet(Allocate, Free, Reallocate));
#endif
  PetscFunctionReturn(PETSC_SUCCESS);
}
