/* Liquid of rings becomes particles in space: a restart of a scene in space from a run with -dimension axisymmetric.

   The rings' sections are cut into columns along the axis, as wide as the spacing wanted there. Liquid that hangs
   together in a column is divided into layers of equal volume, about a spacing high: so the layers end at floor and
   surface, wherever these are. A layer becomes particles at its centre of volume, at equal angles about the axis; what
   volume is left over is that of the next layer. LatticeShake displaces them, as it does other packings:
   -packing_jitter is the disturbance from which fingers grow. Settling evens them out (stepper/settle.c), and then they
   get all that the rings carry at their places. */
#include <stdlib.h>
#include "packing_impl.h"

#define PARTS 2   /* a ring's section is divided into parts of at most this part of the spacing */
#define GAP   1.  /* spacings between parts of a column that do not hang together */
#define REACH 2.5 /* sizes of a ring within which it tells what it carries: some twenty rings */

/* A part of a ring's section. */
typedef struct {
  PetscInt  body, column;
  PetscReal spacing, r, z, height, volume; /* m: wanted; place; of the part; m3, of all around */
} Part;

static int InColumns(const void *one, const void *other)
{
  const Part *a = (const Part *)one, *b = (const Part *)other;

  if (a->body != b->body) return a->body < b->body ? -1 : 1;
  if (a->spacing != b->spacing) return a->spacing < b->spacing ? -1 : 1;
  if (a->column != b->column) return a->column < b->column ? -1 : 1;
  if (a->z != b->z) return a->z < b->z ? -1 : 1;
  return a->r < b->r ? -1 : a->r > b->r;
}

/* The spacing wanted at a ring of this section (m2): the finest times a power of two, so that columns are wide. */
static PetscReal Wanted(Packing packing, const PetscReal x[DIM], PetscReal section)
{
  const Domain    domain = packing->cloud->domain;
  const PetscReal at[] = {x[0], 0, x[1]}, most = domain->spacing_coarse,
                  wanted = !domain->graded    ? domain->spacing
                           : domain->adaptive ? PetscSqrtReal(section)
                                              : SceneSpacing(packing->cloud->scene, at);
  PetscReal spacing      = domain->spacing;

  while (PETSC_SQRT2 * spacing < wanted && 2 * spacing <= SIZE_MARGIN * most) spacing *= 2;
  return spacing;
}

/* The parts of all rings, in columns, to be freed. */
static PetscErrorCode Divide(Packing packing, PetscInt *count, Part **parts)
{
  const ParticleArrays *rings = packing->rings;
  PetscSegBuffer        all;
  size_t                total;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferCreate(sizeof(Part), 1024, &all));
  for (PetscInt a = 0; a < rings->n; a++) {
    const PetscReal *x       = rings->real[FIELD_POSITION] + DIM * a;
    const PetscReal  section = rings->real[FIELD_VOLUME][a] / (2 * PETSC_PI * x[0]), side = PetscSqrtReal(section);
    const PetscReal  spacing = Wanted(packing, x, section);
    const PetscInt   n       = PetscMax(PARTS, (PetscInt)PetscCeilReal(PARTS * side / spacing));

    for (PetscInt i = 0; i < n; i++)
      for (PetscInt k = 0; k < n; k++) {
        const PetscReal r = x[0] + ((i + 0.5) / n - 0.5) * PetscMin(side, 2 * x[0]);
        Part           *part;

        PetscCall(PetscSegBufferGet(all, 1, &part));
        *part = (Part){.body    = rings->integer[INT_BODY][a],
                       .column  = (PetscInt)(r / spacing),
                       .spacing = spacing,
                       .r       = r,
                       .z       = x[1] + ((k + 0.5) / n - 0.5) * side,
                       .height  = side / n,
                       .volume  = rings->real[FIELD_VOLUME][a] * r / (x[0] * n * n)};
      }
  }
  PetscCall(PetscSegBufferGetSize(all, &total));
  PetscCall(PetscSegBufferExtractAlloc(all, parts));
  PetscCall(PetscSegBufferDestroy(&all));
  *count = (PetscInt)total;
  qsort(*parts, total, sizeof(Part), InColumns);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mirrors that hold the axis: first and last angle of the liquid about it. */
static void Angles(Domain domain, PetscReal angle[2])
{
  PetscReal sign[2];

  for (PetscInt d = 0; d < 2; d++) {
    sign[d] = 0;
    for (PetscInt side = 0; side < 2; side++)
      if (domain->face[d][side] == FACE_SYMMETRY &&
          PetscAbsReal(side ? domain->upper[d] : domain->lower[d]) < POINT_TOLERANCE * domain->spacing)
        sign[d] = side ? -1 : 1;
  }
  angle[0] = sign[0] != 0 && sign[1] != 0
               ? (sign[0] > 0 ? (sign[1] > 0 ? 0 : -0.5) : (sign[1] > 0 ? 0.5 : 1)) * PETSC_PI
             : sign[0] != 0 ? (sign[0] > 0 ? -0.5 : 0.5) * PETSC_PI
             : sign[1] != 0 ? (sign[1] > 0 ? 0 : 1) * PETSC_PI
                            : 0;
  angle[1] = angle[0] + 2 * PETSC_PI / ((sign[0] != 0 ? 2 : 1) * (sign[1] != 0 ? 2 : 1));
}

/* Adds the particles of a layer, its volume (m3, of all around) at r and z (m). *rest: the volume (m3) of particles
   that is left over. */
static PetscErrorCode AddLayer(Packing packing, const Part *layer, const PetscReal angle[2], PetscReal *rest,
                               PetscSegBuffer samples)
{
  const Domain    domain = packing->cloud->domain;
  const PetscReal whole = layer->spacing * layer->spacing * layer->spacing, span = angle[1] - angle[0];
  const PetscReal volume = *rest + layer->volume * span / (2 * PETSC_PI);
  const PetscInt  n      = (PetscInt)(volume / whole + 0.5);

  PetscFunctionBegin;
  *rest = domain->graded && n ? 0 : volume - n * whole;
  for (PetscInt k = 0; k < n; k++) {
    const PetscReal turn   = angle[0] + span * (k + 0.5) / n;
    Sample          sample = {.body = layer->body,
                              .x    = {layer->r * PetscCosReal(turn), layer->r * PetscSinReal(turn), layer->z},
                              .area = (domain->graded ? volume / n : whole) / domain->volume};
    PetscBool       inside = PETSC_TRUE;

    for (PetscInt d = 0; d < DIM; d++)
      inside = (PetscBool)(inside && sample.x[d] >= domain->lower[d] && sample.x[d] <= domain->upper[d]);
    if (!inside) continue;
    sample.id = sample.parent = packing->graded_count[0]++;
    sample.size               = DomainSize(domain, sample.area * domain->volume);
    if (packing->ops == &PackingLattice) LatticeShake(packing, layer->spacing, &sample);
    PetscCall(SampleKeep(samples, &sample));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the layers of the n parts of a column that hang together. */
static PetscErrorCode AddRun(Packing packing, PetscInt n, const Part parts[], const PetscReal angle[2], PetscReal *rest,
                             PetscSegBuffer samples)
{
  const PetscReal height = parts[n - 1].z - parts[0].z + 0.5 * (parts[0].height + parts[n - 1].height);
  const PetscInt  layers = PetscMax(1, (PetscInt)(height / parts[0].spacing + 0.5));
  PetscReal       volume = 0, below = 0;
  PetscInt        k = 0;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < n; p++) volume += parts[p].volume;
  for (PetscInt l = 0; l < layers; l++) {
    Part layer = {.body = parts[0].body, .spacing = parts[0].spacing};

    for (; k < n && (l == layers - 1 || below + 0.5 * parts[k].volume < volume * (l + 1) / layers); k++) {
      below += parts[k].volume;
      layer.volume += parts[k].volume;
      layer.r += parts[k].volume * parts[k].r;
      layer.z += parts[k].volume * parts[k].z;
    }
    if (layer.volume <= 0) continue;
    layer.r /= layer.volume;
    layer.z /= layer.volume;
    PetscCall(AddLayer(packing, &layer, angle, rest, samples));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TurnedSetUp(Packing packing)
{
  PetscReal      angle[2], rest = 0;
  PetscSegBuffer samples;
  PetscInt       count = 0, n;
  Part          *parts;

  PetscFunctionBegin;
  Angles(packing->cloud->domain, angle);
  PetscCall(Divide(packing, &count, &parts));
  PetscCall(PetscSegBufferCreate(sizeof(Sample), 1024, &samples));
  for (PetscInt first = 0; first < count; first += n) {
    const Part *run = parts + first;

    for (n = 1; first + n < count; n++)
      if (run[n].body != run->body || run[n].spacing != run->spacing || run[n].column != run->column ||
          run[n].z - run[n - 1].z > GAP * run->spacing)
        break;
    PetscCall(AddRun(packing, n, run, angle, &rest, samples));
  }
  PetscCall(PetscFree(parts));
  PetscCall(SamplesTake(&samples, &packing->graded_count[0], &packing->graded[0]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Turns a field of rings (along r, along the axis, around it) to space, at a place whose radius has this cosine and
   sine. */
static void Turn(Parity parity, PetscReal c, PetscReal s, PetscReal f[])
{
  const PetscReal r = f[0], z = f[1];

  if (parity == PARITY_VECTOR) {
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

/* What rings around the place r, z tell: of each its weight and place relative to that one (m), for a linear fit. */
typedef struct {
  PetscReal weight, x, z;
  PetscInt  ring;
} Told;

/* The value at the place of a linear fit to a component of what n rings tell, between their least and largest. */
static PetscReal Fit(PetscInt n, const Told told[], const PetscReal field[], PetscInt width)
{
  PetscReal w = 0, x = 0, z = 0, f = 0, xx = 0, xz = 0, zz = 0, fx = 0, fz = 0, low = PETSC_MAX_REAL, high = -low, det;

  for (PetscInt k = 0; k < n; k++) {
    const PetscReal value = field[(size_t)width * (size_t)told[k].ring];

    w += told[k].weight;
    x += told[k].weight * told[k].x;
    z += told[k].weight * told[k].z;
    f += told[k].weight * value;
    low  = PetscMin(low, value);
    high = PetscMax(high, value);
  }
  x /= w;
  z /= w;
  f /= w;
  for (PetscInt k = 0; k < n; k++) {
    const PetscReal dx = told[k].x - x, dz = told[k].z - z, df = field[(size_t)width * (size_t)told[k].ring] - f;

    xx += told[k].weight * dx * dx;
    xz += told[k].weight * dx * dz;
    zz += told[k].weight * dz * dz;
    fx += told[k].weight * df * dx;
    fz += told[k].weight * df * dz;
  }
  det = xx * zz - xz * xz;
  if (det > 1e-3 * PetscSqr(xx + zz)) f -= ((zz * fx - xz * fz) * x + (xx * fz - xz * fx) * z) / det;
  return PetscMax(low, PetscMin(high, f));
}

/* The rings of a body that tell what is at r, z (m): those within REACH of their sizes, or the nearest. told:
   [rings]. Returns their number. */
static PetscInt Listen(const ParticleArrays *rings, const CellGrid *grid, PetscInt body, PetscReal r, PetscReal z,
                       Told told[])
{
  PetscInt  n = 0, cell[DIM], nearest = -1;
  PetscReal least = PETSC_MAX_REAL;

  cell[0] = (PetscInt)PetscFloorReal((r - grid->lower[0]) / grid->size);
  cell[1] = (PetscInt)PetscFloorReal((z - grid->lower[1]) / grid->size);
  for (PetscInt wide = 1; n == 0 && nearest < 0; wide = PetscMax(grid->n[0], grid->n[1]))
    for (PetscInt k = PetscMax(0, cell[1] - wide); k <= PetscMin(grid->n[1] - 1, cell[1] + wide); k++)
      for (PetscInt i = PetscMax(0, cell[0] - wide); i <= PetscMin(grid->n[0] - 1, cell[0] + wide); i++) {
        const PetscInt c = CellIndex(grid->n, i, k, 0);

        for (PetscInt p = grid->start[c]; p < grid->start[c + 1]; p++) {
          const PetscInt   a = grid->order[p];
          const PetscReal *x = rings->real[FIELD_POSITION] + DIM * a, dx = x[0] - r, dz = x[1] - z,
                          reach2 = PetscSqr(REACH) * rings->real[FIELD_VOLUME][a] / (2 * PETSC_PI * x[0]),
                          far    = dx * dx + dz * dz;

          if (rings->integer[INT_BODY][a] != body) continue;
          if (far < least) {
            least   = far;
            nearest = a;
          }
          if (far < reach2) told[n++] = (Told){PetscSqr(1 - far / reach2), dx, dz, a};
        }
      }
  if (n == 0 && nearest >= 0) told[n++] = (Told){1, 0, 0, nearest};
  return n;
}

PetscErrorCode TurnedCarry(Packing packing)
{
  const ParticleArrays *rings = packing->rings;
  PetscReal             reach = 0;
  CellGrid              grid  = {.count = 0};
  ParticleArrays        arrays;
  Told                 *told;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < rings->n; a++)
    reach = PetscMax(reach, REACH * PetscSqrtReal(rings->real[FIELD_VOLUME][a] /
                                                  (2 * PETSC_PI * rings->real[FIELD_POSITION][DIM * a])));
  PetscCall(CellGridBuild(&grid, 2, rings->n, rings->real[FIELD_POSITION], reach, 1));
  PetscCall(PetscMalloc1(rings->n, &told));
  PetscCall(ParticlesOpen(packing->cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscReal *x = arrays.real[FIELD_POSITION] + DIM * a, r = PetscSqrtReal(x[0] * x[0] + x[1] * x[1]);
    PetscInt         n;

    if (arrays.integer[INT_BODY][a] < 0) continue;
    n = Listen(rings, &grid, arrays.integer[INT_BODY][a], r, x[2], told);
    for (PetscInt f = FIELD_VELOCITY; f < FIELD_STORED_COUNT && n; f++) {
      const PetscInt width = Fields[f].width;
      PetscReal     *value = arrays.real[f] + (size_t)width * (size_t)a;

      if (!arrays.real[f] || !rings->real[f] || Fields[f].carry == CARRY_OWN || Fields[f].carry == CARRY_SUM) continue;
      for (PetscInt i = 0; i < width; i++) value[i] = Fit(n, told, rings->real[f] + i, width);
      Turn(Fields[f].parity, r > 0 ? x[0] / r : 1, r > 0 ? x[1] / r : 0, value);
    }
  }
  PetscCall(ParticlesClose(packing->cloud->particles, &arrays));
  PetscCall(PetscFree(told));
  PetscCall(CellGridReset(&grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}
