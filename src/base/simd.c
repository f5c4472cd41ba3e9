/* The table wide_front of simd.h. */
#include "simd.h"

uint64_t wide_front[1 << 8];

void WideStart(void)
{
  if (wide_front[1 << 1]) return;
  for (uint32_t bits = 0; bits < 1 << 8; bits++) {
    PetscInt n = 0;

    wide_front[bits] = 0;
    for (uint64_t k = 0; k < 8; k++)
      if (bits >> k & 1) wide_front[bits] |= k << (8 * n++);
  }
}
