/* The table eight_front of simd.h. */
#include "simd.h"

uint64_t eight_front[1 << EIGHT];

void EightSet(void)
{
  if (eight_front[1 << 1]) return;
  for (uint32_t bits = 0; bits < 1 << EIGHT; bits++) {
    PetscInt n = 0;

    eight_front[bits] = 0;
    for (uint64_t k = 0; k < EIGHT; k++)
      if (bits >> k & 1) eight_front[bits] |= k << (8 * n++);
  }
}
