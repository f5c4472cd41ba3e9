/* STREAM's triad a = b + 3 c: bytes a second of one process, the best of some passes. Several at a time measure what
   the cores share. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define LENGTH 20000000
#define PASSES 10
#define BYTES  24.0 /* two reads and a write; what the cache fetches before it writes is not counted, as in STREAM */

int main(void)
{
  double *a = malloc(LENGTH * sizeof(*a)), *b = malloc(LENGTH * sizeof(*b)), *c = malloc(LENGTH * sizeof(*c)), best = 0;

  if (!a || !b || !c) return 1;
  for (size_t k = 0; k < LENGTH; k++) a[k] = b[k] = c[k] = (double)k;
  for (int pass = 0; pass < PASSES; pass++) {
    struct timespec begin, end;
    double          seconds;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &begin);
    for (size_t k = 0; k < LENGTH; k++) a[k] = b[k] + 3 * c[k];
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    seconds = (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
    if (BYTES * LENGTH / seconds > best) best = BYTES * LENGTH / seconds;
    b[pass] = a[pass];
  }
  printf("%g\n", best);
  return 0;
}
