/* A restart of a scene in space from rings about the axis x = y = 0. Rings finer than the scene's particles become one
   in each cell as wide as these; then a ring becomes particles at equal angles, about as far apart as its section is
   wide, with all that it carries: as many in each quarter, so that mirrors through the axis cut none. They are settled
   as a packing is, and join and split to the spacing that the scene wants in the run's own time (resampling/). */
#include "output_impl.h"
#include <stdio.h>
#include <stdlib.h>

#define FLAW     512  /* characters */
#define QUARTERS 4    /* of a turn */
#define SPARE    2    /* a ring as wide as this times the coarse spacing splits at once */
#define ASIDE    0.25 /* sizes: least distance from the sides of the box, whose mirrors have images */

PetscBool RestartTurns(Output output, const char stored[])
{
  return (PetscBool)(output->cloud->domain->dim == 3 && strstr(stored, "-dimension = axisymmetric\n") != NULL);
}

/* Finds the first line of 'text' on bodies and densities that 'stored' lacks. */
static void CompareLiquid(const char text[], const char stored[], char flaw[FLAW])
{
  for (const char *line = text; *line && !flaw[0]; line += strcspn(line, "\n") + 1) {
    const int length = (int)strcspn(line, "\n");
    char      wanted[FLAW / 2];

    (void)snprintf(wanted, sizeof(wanted), "\n%.*s\n", length, line);
    if ((!strncmp(line, "body ", 5) || strstr(wanted, "_density = ")) && !strstr(stored, wanted))
      (void)snprintf(flaw, FLAW, "its rings are of other liquid, without %.*s", FLAW / 2, line);
    flaw[strcspn(flaw, "\n")] = 0;
  }
}

/* The rings have to fill the box: down to its floor, and as far as its corners. */
static void CompareBoxes(Domain domain, const char stored[], char flaw[FLAW])
{
  const char *lower = strstr(stored, "-box_lower = "), *upper = strstr(stored, "-box_upper = ");
  double      floor = 0, outer = 0;
  PetscReal   corner = 0;

  for (PetscInt d = 0; d < 2; d++)
    corner += PetscSqr(PetscMax(PetscAbsReal(domain->lower[d]), PetscAbsReal(domain->upper[d])));
  corner = PetscSqrtReal(corner);
  if (lower) (void)sscanf(lower, "-box_lower = %*[^,],%lf", &floor);
  if (upper) (void)sscanf(upper, "-box_upper = %lf", &outer);
  if (outer < corner)
    (void)snprintf(flaw, FLAW, "its box is %g m wide, and the corners of this box are %g m from its axis x = y = 0",
                   outer, (double)corner);
  else if (PetscAbsReal(floor - domain->lower[2]) > POINT_TOLERANCE * domain->spacing)
    (void)snprintf(flaw, FLAW, "its box begins at a height of %g m, this box at %g m", floor, (double)domain->lower[2]);
}

/* Whether particles have a field even if their rings carry none: those of bodies that do not mix, or of one size. */
static PetscBool NeedNot(PetscInt f)
{
  return (PetscBool)(f == FIELD_COLOUR || f == FIELD_SIZE);
}

void RestartFillIn(FieldId f, const ParticleArrays *rows)
{
  for (PetscInt a = 0; f == FIELD_COLOUR && a < rows->n; a++)
    rows->real[f][a] = rows->integer[INT_BODY][a] == 0 ? 1 : 0;
}

PetscErrorCode RestartRingsCheck(Output output, const char file[], const char stored[], H5File *h5)
{
  char flaw[FLAW] = "", *text;

  PetscFunctionBegin;
  PetscCall(CloudIdentity(output->cloud, &text));
  if (!output->rank) {
    CompareLiquid(text, stored, flaw);
    if (!flaw[0]) CompareBoxes(output->cloud->domain, stored, flaw);
    if (!flaw[0] && !DomainStoresSizes(output->cloud->domain))
      (void)snprintf(flaw, FLAW, "particles of rings join and split to a spacing that needs -spacing_follow");
  }
  free(text);
  PetscCallMPI(MPI_Bcast(flaw, FLAW, MPI_CHAR, 0, output->comm));
  for (PetscInt f = 0; f < FIELD_STORED_COUNT && !flaw[0]; f++)
    if (ParticlesHave(output->cloud->particles, f) && !NeedNot(f) && !H5FileHas(h5, Fields[f].name))
      (void)snprintf(flaw, FLAW, "its rings carry no %s (%s)", Fields[f].name, Fields[f].meaning);
  PetscCheckUser(!flaw[0], output->comm, "The checkpoint %s cannot be turned into this scene: %s.", file, flaw);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A ring that is finer than the scene's particles, and the cell, a finest spacing wide, of its section. */
typedef struct {
  PetscInt row, at[3]; /* body, and along r and z */
} Fine;

static int InCells(const void *one, const void *other)
{
  const Fine *a = (const Fine *)one, *b = (const Fine *)other;

  for (PetscInt d = 0; d < 3; d++)
    if (a->at[d] != b->at[d]) return a->at[d] < b->at[d] ? -1 : 1;
  return a->row < b->row ? -1 : 1;
}

/* Row a takes in row b: sums, and means weighted by volume. */
static void TakeIn(const ParticleArrays *rows, PetscInt a, PetscInt b)
{
  const PetscReal part = rows->real[FIELD_VOLUME][b] / (rows->real[FIELD_VOLUME][a] + rows->real[FIELD_VOLUME][b]);

  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++) {
    const PetscInt width = Fields[f].width;

    for (PetscInt i = 0; rows->real[f] && i < width; i++) {
      PetscReal *own = rows->real[f] + width * a + i, taken = rows->real[f][width * b + i];

      *own += Fields[f].carry == CARRY_SUM ? taken : part * (taken - *own);
    }
  }
  rows->integer[INT_BODY][b] = BODY_WALL; /* as dummies, which stay behind */
}

/* Makes one ring of those in a cell that are finer than the scene's particles. *bad: the last ring that no run leaves,
   or that is wider than the scene's particles. */
static PetscErrorCode Coarsen(Cloud cloud, const ParticleArrays *rows, PetscInt *bad)
{
  const Domain    domain  = cloud->domain;
  const PetscReal spacing = domain->spacing, widest = SPARE * domain->spacing_coarse;
  PetscInt        fine = 0;
  Fine           *ring;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(rows->n, &ring));
  for (PetscInt a = 0; a < rows->n; a++) {
    const PetscReal *x = rows->real[FIELD_POSITION] + DIM * a, z = (x[1] - domain->lower[2]) / spacing;
    const PetscReal  area = rows->real[FIELD_VOLUME][a] / (2 * PETSC_PI * x[0]);
    const PetscInt   body = rows->integer[INT_BODY][a];

    if (body < 0) continue;
    if (!(x[0] > 0 && x[0] < PETSC_MAX_INT * spacing && z > 0 && z < PETSC_MAX_INT && area > 0 &&
          area <= widest * widest))
      *bad = a;
    else if (area < spacing * spacing / 2)
      ring[fine++] = (Fine){a, {body, (PetscInt)(x[0] / spacing), (PetscInt)z}};
  }
  qsort(ring, (size_t)fine, sizeof(Fine), InCells);
  for (PetscInt k = 1, first = 0; k < fine; k++) {
    const PetscInt *one = ring[first].at, *other = ring[k].at;

    if (one[0] == other[0] && one[1] == other[1] && one[2] == other[2])
      TakeIn(rows, ring[first].row, ring[k].row);
    else
      first = k;
  }
  PetscCall(PetscFree(ring));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Turns a field of a ring (along r, along the axis, around it) to an angle of this cosine and sine. */
static void Turn(Parity parity, PetscReal c, PetscReal s, PetscReal f[])
{
  const PetscReal r = f[0], z = parity == PARITY_SCALAR ? 0 : f[1];

  if (parity == PARITY_VECTOR || parity == PARITY_POINT) {
    f[0] = r * c;
    f[1] = r * s;
    f[2] = z;
  } else if (parity == PARITY_TENSOR) { /* xx yy zz xy xz yz; of rings rr, axial, around, r axial */
    const PetscReal around = f[2], shear = f[3];

    f[0] = r * c * c + around * s * s;
    f[1] = r * s * s + around * c * c;
    f[2] = z;
    f[3] = (r - around) * c * s;
    f[4] = shear * c;
    f[5] = shear * s;
  }
}

/* Makes row b particle k of the n of ring a if that is in the box; b < 0: tells whether it is. */
static PetscBool TurnOne(Domain domain, const ParticleArrays *rows, PetscInt a, PetscInt k, PetscInt n, PetscInt b)
{
  const PetscReal angle = 2 * PETSC_PI * (k + 0.5) / n, c = PetscCosReal(angle), s = PetscSinReal(angle);
  PetscReal       x[DIM] = {rows->real[FIELD_POSITION][DIM * a], rows->real[FIELD_POSITION][DIM * a + 1], 0}, size;

  Turn(PARITY_POINT, c, s, x);
  for (PetscInt d = 0; d < 2; d++)
    if (x[d] < domain->lower[d] || x[d] > domain->upper[d]) return PETSC_FALSE;
  if (b < 0) return PETSC_TRUE;
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++) {
    const PetscInt width = Fields[f].width;

    if (!rows->real[f]) continue;
    for (PetscInt i = 0; i < width; i++)
      rows->real[f][width * b + i] = rows->real[f][width * a + i] / (Fields[f].carry == CARRY_SUM ? n : 1);
    Turn(Fields[f].parity, c, s, rows->real[f] + width * b);
  }
  for (PetscInt f = 0; f < INT_COUNT; f++) rows->integer[f][b] = rows->integer[f][a];
  size = rows->real[FIELD_SIZE][b] = PetscMin(DomainSizeMax(domain), DomainSize(domain, rows->real[FIELD_VOLUME][b]));
  for (PetscInt d = 0; d < 2; d++)
    rows->real[FIELD_POSITION][DIM * b + d] =
      PetscMax(domain->lower[d] + ASIDE * size * domain->spacing,
               PetscMin(domain->upper[d] - ASIDE * size * domain->spacing, x[d]));
  return PETSC_TRUE;
}

/* Makes the particles of the first n rows, as rows behind these, or counts them. */
static PetscInt TurnAll(Domain domain, PetscInt n, const ParticleArrays *rows, PetscBool count)
{
  PetscInt made = 0;

  for (PetscInt a = 0; a < n; a++) {
    const PetscReal length = 2 * PETSC_PI * rows->real[FIELD_POSITION][DIM * a],
                    side   = PetscMax(domain->spacing, PetscSqrtReal(rows->real[FIELD_VOLUME][a] / length));
    const PetscInt around  = QUARTERS * (PetscInt)PetscMax(1, length / (QUARTERS * side) + 0.5);

    for (PetscInt k = 0; rows->integer[INT_BODY][a] >= 0 && k < around; k++)
      if (TurnOne(domain, rows, a, k, around, count ? -1 : n + made)) made++;
  }
  return made;
}

/* Scales the velocities of rows from 'first' on, all of which point away from the axis or along it. *bad: the last row
   where the formula is no number. */
static void Disturb(const Formula *disturbance, const ParticleArrays *rows, PetscInt first, PetscInt *bad)
{
  for (PetscInt a = first; a < rows->n; a++) {
    const PetscReal *x     = rows->real[FIELD_POSITION] + DIM * a;
    const PetscReal  at[]  = {PetscSqrtReal(x[0] * x[0] + x[1] * x[1]), x[2], PetscAtan2Real(x[1], x[0])};
    const PetscReal  share = FormulaValue(disturbance, at);

    if (PetscIsInfOrNanReal(share)) *bad = a;
    for (PetscInt d = 0; d < 2; d++) rows->real[FIELD_VELOCITY][DIM * a + d] *= 1 + share;
  }
}

PetscErrorCode RestartTurn(Output output, const char file[], const char disturbance[])
{
  const Cloud    cloud = output->cloud;
  ParticleArrays rows;
  PetscInt       made, n, bad = -1;
  PetscBool     *keep;
  Formula        share;
  const char    *text = disturbance;

  PetscFunctionBegin;
  PetscCheckUser(!*text || (FormulaRead(&text, "rza", &share) && !*text), output->comm,
                 "-restart_disturbance \"%s\" is not one formula of r, z and a that can be read, from \"%s\" on",
                 disturbance, text);
  PetscCall(ParticlesOpen(cloud->particles, &rows));
  n = rows.n;
  PetscCall(Coarsen(cloud, &rows, &bad));
  made = TurnAll(cloud->domain, n, &rows, PETSC_TRUE);
  PetscCall(ParticlesClose(cloud->particles, &rows));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &bad, 1, MPIU_INT, MPI_MAX, output->comm));
  PetscCheckUser(
    bad < 0, output->comm,
    "The checkpoint %s cannot be turned into this scene: some of its rings are wider than twice -spacing_coarse "
    "%g m, or none that a run leaves.",
    file, (double)cloud->domain->spacing_coarse);
  PetscCall(ParticlesAppend(cloud->particles, made));
  PetscCall(ParticlesOpen(cloud->particles, &rows));
  (void)TurnAll(cloud->domain, n, &rows, PETSC_FALSE);
  if (*disturbance) Disturb(&share, &rows, n, &bad);
  PetscCall(PetscMalloc1(rows.n, &keep));
  for (PetscInt a = 0; a < rows.n; a++) {
    keep[a]                 = (PetscBool)(a >= n);
    rows.integer[INT_ID][a] = rows.integer[INT_PARENT][a] = a - n;
  }
  PetscCall(ParticlesClose(cloud->particles, &rows));
  PetscCall(ParticlesRemove(cloud->particles, keep));
  PetscCall(PetscFree(keep));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &bad, 1, MPIU_INT, MPI_MAX, output->comm));
  PetscCheckUser(bad < 0, output->comm, "-restart_disturbance is no number at some of the particles");
  PetscFunctionReturn(PETSC_SUCCESS);
}
