/* Sums over the fluid: energies, volume, number of particles; the highest liquid, and the level of heights. */
#include "gauges_impl.h"

PetscReal GaugeMirror(Domain domain, PetscInt d, PetscReal *copies)
{
  const PetscBool lower = (PetscBool)(domain->face[d][0] == FACE_SYMMETRY);

  if (DomainIsRadial(domain, d)) return 0;
  if (d >= domain->dim || *copies < 2 || (!lower && domain->face[d][1] != FACE_SYMMETRY)) return NAN;
  *copies /= 2;
  return lower ? domain->lower[d] : domain->upper[d];
}

PetscReal GaugesLevel(Gauges gauges)
{
  return gauges->level;
}

void GaugesSetLevel(Gauges gauges, PetscReal level)
{
  if (!gauges->level_given && !PetscIsInfOrNanReal(level)) gauges->level = level;
}

PetscReal HeightOverLevel(Gauges gauges, PetscReal top)
{
  const Domain    domain = gauges->cloud->domain;
  const PetscInt  up     = domain->dim - 1;
  const PetscReal most   = domain->face[up][1] == FACE_PERIODIC ? domain->upper[up] : PETSC_MAX_REAL;

  return top > -PETSC_MAX_REAL ? PetscMin(top + 0.5 * domain->spacing, most) - gauges->level : NAN;
}

PetscErrorCode GaugesTotals(Gauges gauges, GaugeTotals *totals)
{
  const Domain   domain  = gauges->cloud->domain;
  const Scene    scene   = gauges->cloud->scene;
  PetscReal      sum[4]  = {0, 0, 0, 0}; /* kinetic energy, potential energy, particles, stored volumes */
  PetscReal      highest = -PETSC_MAX_REAL;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(gauges->cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscReal *x = arrays.real[FIELD_POSITION] + DIM * a, *v = arrays.real[FIELD_VELOCITY] + DIM * a;
    PetscReal        mass;

    if (arrays.integer[INT_LAYER][a]) continue;
    mass = ParticleVolume(domain, &arrays, a) * BodyMaterial(SceneBody(scene, arrays.integer[INT_BODY][a]))->density;
    sum[0] += 0.5 * mass * Dot(v, v);
    sum[1] += mass * SceneForcePotential(scene, x);
    sum[2] += 1;
    sum[3] += ParticleVolume(domain, &arrays, a) / domain->volume;
    highest = PetscMax(highest, x[domain->dim - 1] + 0.5 * (ParticleSize(domain, &arrays, a) - 1) * domain->spacing);
  }
  PetscCall(ParticlesClose(gauges->cloud->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 4, MPIU_REAL, MPIU_SUM, gauges->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &highest, 1, MPIU_REAL, MPIU_MAX, gauges->comm));
  totals->multiplicity     = gauges->multiplicity;
  totals->kinetic_energy   = sum[0];
  totals->potential_energy = sum[1];
  totals->volume           = sum[3] * domain->volume;
  totals->particles        = (PetscInt)sum[2];
  totals->highest          = HeightOverLevel(gauges, highest);
  PetscFunctionReturn(PETSC_SUCCESS);
}
