/* Shared by the shapes with waves: maps along a flow, and Bessel functions. */
#include "scene_impl.h"

#define TERMS 24    /* of the series: exact to rounding for arguments up to 2 pi */
#define LEAST 1e-20 /* the terms behind a smaller one do not count either */

void BesselSeries(PetscReal q, PetscReal *order_0, PetscReal *order_1_over_x)
{
  PetscReal term = 1;

  *order_0        = 1;
  *order_1_over_x = 0.5;
  for (PetscInt m = 1; m < TERMS && PetscAbsReal(term) > LEAST; m++) {
    term *= q / (m * m);
    *order_0 += term;
    *order_1_over_x += 0.5 * term / (m + 1);
  }
}

void MoveAlong(const void *shape, ShapeFlow flow, PetscReal time, PetscInt steps, PetscReal x[DIM])
{
  const PetscReal step = time / steps;

  for (PetscInt n = 0; n < steps; n++) {
    PetscReal a[DIM], b[DIM], c[DIM], e[DIM], y[DIM];

    flow(shape, x, a);
    for (PetscInt d = 0; d < DIM; d++) y[d] = x[d] + 0.5 * step * a[d];
    flow(shape, y, b);
    for (PetscInt d = 0; d < DIM; d++) y[d] = x[d] + 0.5 * step * b[d];
    flow(shape, y, c);
    for (PetscInt d = 0; d < DIM; d++) y[d] = x[d] + step * c[d];
    flow(shape, y, e);
    for (PetscInt d = 0; d < DIM; d++) x[d] += step / 6 * (a[d] + 2 * b[d] + 2 * c[d] + e[d]);
  }
}
