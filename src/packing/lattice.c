/* Bodies filled from a lattice of the particle spacing, with a jitter. */
#include "types.h"

typedef struct {
  PetscReal jitter; /* largest displacement a component, in spacings */
} Lattice;

void BoxLatticeSetUp(Domain domain, BoxLattice *lattice)
{
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal length = domain->upper[d] - domain->lower[d], spacing = domain->spacing;
    const PetscBool below  = (PetscBool)(domain->face[d][0] != FACE_OPEN);
    const PetscBool above  = (PetscBool)(domain->face[d][1] != FACE_OPEN);
    const PetscBool fitted = (PetscBool)(below && above); /* the nearest number of points; else those inside the box */

    if (d >= domain->dim) { /* the plane z = 0 */
      lattice->n[d]      = 1;
      lattice->pitch[d]  = spacing;
      lattice->origin[d] = 0;
      continue;
    }
    lattice->n[d]      = PetscMax(1, (PetscInt)PetscFloorReal(length / spacing + 0.5 + (fitted ? ROUNDING : -ROUNDING)));
    lattice->pitch[d]  = fitted ? length / lattice->n[d] : spacing;
    lattice->origin[d] = above && !below ? domain->upper[d] - (lattice->n[d] - 0.5) * spacing : domain->lower[d] + 0.5 * lattice->pitch[d];
  }
}

/* The part of the lattice that may be inside a body. Where the body touches a closed face it is the box's, which the walls and images continue;
   elsewhere it has the spacing and is symmetric about the middle of the body. */
static void BodyLattice(Domain domain, const BoxLattice *box, Body body, BoxLattice *lattice)
{
  const PetscReal tiny = ROUNDING * domain->spacing;
  PetscReal       lower[DIM], upper[DIM];

  BodyBounds(body, lower, upper);
  *lattice = *box;
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscBool below = (PetscBool)(domain->face[d][0] != FACE_OPEN && lower[d] <= domain->lower[d] + tiny);
    const PetscBool above = (PetscBool)(domain->face[d][1] != FACE_OPEN && upper[d] >= domain->upper[d] - tiny);

    if (below || above) {
      const PetscInt first = PetscMax(0, (PetscInt)PetscCeilReal((lower[d] - box->origin[d]) / box->pitch[d] - ROUNDING));
      const PetscInt last  = PetscMin(box->n[d] - 1, (PetscInt)PetscFloorReal((upper[d] - box->origin[d]) / box->pitch[d] + ROUNDING));

      lattice->n[d]      = PetscMax(0, last - first + 1);
      lattice->origin[d] = box->origin[d] + first * box->pitch[d];
    } else {
      lattice->n[d]      = PetscMax(1, (PetscInt)PetscFloorReal((upper[d] - lower[d]) / domain->spacing + 0.5));
      lattice->pitch[d]  = domain->spacing;
      lattice->origin[d] = 0.5 * (lower[d] + upper[d]) - 0.5 * (lattice->n[d] - 1) * domain->spacing;
    }
  }
}

/* Whether point x (m) belongs to body number b: inside it by more than rounding, and to no earlier body. */
static PetscBool Belongs(Scene scene, PetscInt b, PetscReal spacing, const PetscReal x[DIM])
{
  if (!BodyContains(SceneBody(scene, b), x) || BodyDistance(SceneBody(scene, b), x) > -ROUNDING * spacing) return PETSC_FALSE;
  for (PetscInt other = 0; other < b; other++)
    if (BodyContains(SceneBody(scene, other), x)) return PETSC_FALSE;
  return PETSC_TRUE;
}

static PetscErrorCode Visit_Lattice(Packing packing, PackingVisitor visitor, void *context)
{
  const Domain    domain = packing->cloud->domain;
  const Scene     scene  = packing->cloud->scene;
  const PetscReal jitter = ((Lattice *)packing->data)->jitter * domain->spacing; /* m */
  BoxLattice      box, lattice;
  PetscInt        id = 0;

  PetscFunctionBegin;
  BoxLatticeSetUp(domain, &box);
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    BodyLattice(domain, &box, SceneBody(scene, b), &lattice);
    for (PetscInt k = 0; k < lattice.n[2]; k++) {
      for (PetscInt j = 0; j < lattice.n[1]; j++) {
        for (PetscInt i = 0; i < lattice.n[0]; i++) {
          const PetscInt index[DIM] = {i, j, k};
          PetscReal      x[DIM];

          for (PetscInt d = 0; d < DIM; d++) x[d] = lattice.origin[d] + index[d] * lattice.pitch[d];
          if (!Belongs(scene, b, domain->spacing, x)) continue;
          for (PetscInt d = 0; d < domain->dim; d++) {
            x[d] += jitter * (2 * RandomUnit((unsigned long long)packing->seed, (unsigned long long)id * DIM + (unsigned long long)d) - 1);
          }
          PackingConfine(domain, x);
          visitor(context, id++, b, x);
        }
      }
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetFromOptions_Lattice(Packing packing, PetscOptionItems *PetscOptionsObject)
{
  Lattice *lattice = (Lattice *)packing->data;

  PetscFunctionBegin;
  PetscCall(PetscOptionsReal("-packing_jitter", "largest random displacement from the lattice, a component (spacings)", "PackingSetFromOptions", lattice->jitter,
                             &lattice->jitter, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Check_Lattice(Packing packing)
{
  const PetscReal jitter = ((Lattice *)packing->data)->jitter;

  PetscFunctionBegin;
  PetscCheckUser(jitter >= 0 && jitter < 0.5, packing->cloud->comm, "-packing_jitter is %g; it must lie in [0, 0.5) spacings", (double)jitter);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy_Lattice(Packing packing)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(packing->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingCreate_Lattice(Packing packing)
{
  Lattice *lattice;

  PetscFunctionBegin;
  PetscCall(PetscNew(&lattice));
  lattice->jitter             = 0.1; /* an equilibrium of the consistent scheme; 0.25 already costs kinetic energy at impact */
  packing->data               = lattice;
  packing->ops.setfromoptions = SetFromOptions_Lattice;
  packing->ops.check          = Check_Lattice;
  packing->ops.visit          = Visit_Lattice;
  packing->ops.destroy        = Destroy_Lattice;
  PetscFunctionReturn(PETSC_SUCCESS);
}
