/* Fused multiply-adds: flops a second of one core, of single and of double precision, the best of some passes. Enough
   sums run at once that none waits for the one before it. */
#include <stdio.h>
#include <time.h>

#ifdef __AVX512F__
  #define WIDTH 64 /* bytes of a vector */
#else
  #define WIDTH 32
#endif
#define SUMS   12
#define ROUNDS 4000000
#define PASSES 5

/* A function NAME that returns the flops a second of TYPE. */
#define PEAK(NAME, TYPE)                                                                                               \
  static double NAME(void)                                                                                             \
  {                                                                                                                    \
    typedef TYPE Vector __attribute__((vector_size(WIDTH)));                                                           \
    const double flops = 2.0 * ROUNDS * SUMS * (WIDTH / sizeof(TYPE));                                                 \
    double       best  = 0;                                                                                            \
                                                                                                                       \
    for (int pass = 0; pass < PASSES; pass++) {                                                                        \
      struct timespec begin, end;                                                                                      \
      Vector          sum[SUMS], factor = {0}, term = {0};                                                             \
      double          seconds;                                                                                         \
                                                                                                                       \
      factor += (TYPE)0.999;                                                                                           \
      term += (TYPE)0.001;                                                                                             \
      for (int k = 0; k < SUMS; k++) sum[k] = term * (TYPE)(pass + k); /* all differ, or one would do for all */       \
      clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &begin);                                                                 \
      for (int round = 0; round < ROUNDS; round++)                                                                     \
        for (int k = 0; k < SUMS; k++) sum[k] = sum[k] * factor + term;                                                \
      clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);                                                                   \
      for (int k = 0; k < SUMS; k++) kept += (double)sum[k][0];                                                        \
      seconds = (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);                    \
      if (flops / seconds > best) best = flops / seconds;                                                              \
    }                                                                                                                  \
    return best;                                                                                                       \
  }

static volatile double kept; /* what is never read would not be computed */

PEAK(Single, float)
PEAK(Double, double)

int main(void)
{
  printf("%g %g\n", Single(), Double());
  return 0;
}
