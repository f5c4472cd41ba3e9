/* A correction of the density of surface rows, for particles of different sizes.

   At rest the first layer of a lattice has a pressure that is too high by 0.15 to 0.2 rho g s. Where the spacing s
   changes along the surface this is a slope of the pressure, which drives particles from coarse to fine. The cause
   follows from the lattice itself: the filled fraction of a continuous half-space at the lattice's |sum V grad W| is
   0.04 to 0.047 less than the lattice's, so that the first layer counts as compressed.

   The corrected share of the error is the ratio of the largest size to the smallest less 1, at most 1: the remaining
   error drives little where sizes differ little. With one size the error is the same all along the surface and moves
   nothing; a correction there, too, would make waves grow (cases/piston/README.md). */
#include "pressure_impl.h"

void SurfaceLattice(Pressure pressure)
{
  const Cloud    cloud  = pressure->cloud;
  const Domain   domain = cloud->domain;
  const PetscInt reach  = (PetscInt)(KernelSupport(cloud->kernel) / domain->spacing) + 1,
                 across = domain->dim == 3 ? reach : 0;
  const PetscReal d0 = domain->spacing, V = domain->volume;
  PetscReal       fraction = 0, normal = 0, place;
  PetscInt        at;

  for (PetscInt z = 0; z <= reach; z++) /* downwards */
    for (PetscInt y = -across; y <= across; y++)
      for (PetscInt x = -reach; x <= reach; x++) {
        const PetscReal r2 = d0 * d0 * (x * x + y * y + z * z);
        PetscReal       W, F;

        KernelEvaluate(cloud->kernel, 1, &r2, &W, &F);
        fraction += V * W / pressure->lattice_sum;
        normal -= V * F * z * d0 * d0;
      }
  place = normal / (d0 * pressure->surface_plane) * SURFACE_TABLE;
  at    = (PetscInt)PetscMin(place, (PetscReal)(SURFACE_TABLE - 1));
  place = PetscMin(place - at, 1.0);

  pressure->layer_share  = PetscMin(1, domain->spacing_coarse / d0 - 1);
  pressure->layer_normal = normal;
  pressure->layer_density =
    fraction - (1 - place) * pressure->surface_fraction[at] - place * pressure->surface_fraction[at + 1];
}

PetscReal SurfaceDensity(Pressure pressure, PetscInt a)
{
  const Cloud     cloud = pressure->cloud;
  const PetscReal own   = Norm(cloud->field[FIELD_NORMAL] + DIM * a) * cloud->size[a] * cloud->domain->spacing;

  if (pressure->layer_share == 0) return 0;
  return pressure->layer_share * pressure->layer_density * PetscMin(1, own / pressure->layer_normal);
}
