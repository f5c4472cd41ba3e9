/* The walls of the box with -spacing_follow: dummy particles that serve liquid of the target spacing in front of them
   (grid.c). They have its smoothing length, and their layers its spacing. In front of finer layers the first
   layer of liquid would not find its place, half a spacing away, but settle on the wall: calm liquid four times as
   coarse as its wall lost 40 to 90 % of the energy exchanged.

   Along a face the dummy particles stand in squares of 1, 2, 4, ... fine spacings, in columns behind their middles. A
   square divides into four if the target is too fine for it, and four join again. Behind an edge squares are pieces of
   its length, behind a corner there is one. So the target tells which columns a wall should have, and the particles
   tell which it has: nothing else is kept. A column is on one rank. */
#include "following_impl.h"

#define LEVELS_MOST 8   /* widths of squares */
#define FINER       0.7 /* widths of a square: a finer target divides it */
#define STAYS       0.6 /* the same for a square that is there: one at the limit does not come and go */
#define PARTS       27  /* of the box and its surroundings */

/* A part of the surroundings: behind a face (outward 1), an edge (2) or a corner (3). Its squares are numbered level by
   level, the widest first. */
typedef struct {
  PetscInt  side[DIM]; /* 0: along the box, 1: behind the lower face, 2: behind the upper face */
  PetscInt  outward;   /* number of sides; 0: no walls here */
  PetscInt  levels, first[LEVELS_MOST];
  PetscReal area[LEVELS_MOST]; /* of a square, m^(dim - outward) */
} Part;

typedef struct {
  Cloud      cloud;
  PetscInt   layers, squares;
  PetscInt   n[LEVELS_MOST][DIM]; /* squares along the box */
  Part       part[PARTS];
  PetscBool *there, *wanted; /* [squares] whether a square has a column, on any rank; whether it should */
} Walls;

typedef struct {
  const Part *part;
  PetscInt    level, at[DIM];
} Square;

static PetscBool IsAlong(const Walls *walls, const Part *part, PetscInt d)
{
  return (PetscBool)(d < walls->cloud->domain->dim && !part->side[d]);
}

/* Numbers of the squares of a level along the axes. */
static void Along(const Walls *walls, const Part *part, PetscInt level, PetscInt along[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) along[d] = IsAlong(walls, part, d) ? walls->n[level][d] : 1;
}

static PetscInt Number(const Walls *walls, const Square *square)
{
  PetscInt along[DIM];

  Along(walls, square->part, square->level, along);
  return square->part->first[square->level] + CellIndex(along, square->at[0], square->at[1], square->at[2]);
}

/* The middle of a square, on the face, m. */
static void Middle(const Walls *walls, const Square *square, PetscReal x[DIM])
{
  const Domain domain = walls->cloud->domain;

  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal part = (square->at[d] + 0.5) / walls->n[square->level][d];

    if (d >= domain->dim)
      x[d] = 0;
    else if (square->part->side[d])
      x[d] = square->part->side[d] == 1 ? domain->lower[d] : domain->upper[d];
    else
      x[d] = domain->lower[d] + part * (domain->upper[d] - domain->lower[d]);
  }
}

/* The squares of the next level in a square: the block from first to last. */
static void Quarters(const Walls *walls, const Square *square, Square *first, PetscInt last[DIM])
{
  *first = (Square){.part = square->part, .level = square->level + 1};
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscInt along = IsAlong(walls, square->part, d);

    first->at[d] = 2 * along * square->at[d];
    last[d]      = first->at[d] + along;
  }
}

static void SetPart(Walls *walls, const PetscInt side[DIM], PetscInt levels, Part *part)
{
  const Domain domain = walls->cloud->domain;

  *part = (Part){.levels = levels};
  for (PetscInt d = 0; d < DIM; d++) {
    part->side[d] = side[d];
    part->outward += side[d] > 0;
  }
  if (part->outward == domain->dim) part->levels = 1;
  for (PetscInt d = 0; d < DIM; d++)
    if (side[d] && domain->face[d][side[d] - 1] != FACE_WALL) part->outward = 0;
  for (PetscInt l = 0; l < part->levels && part->outward; l++) {
    PetscInt along[DIM];

    Along(walls, part, l, along);
    part->area[l] = 1;
    for (PetscInt d = 0; d < domain->dim; d++)
      if (!side[d]) part->area[l] *= (domain->upper[d] - domain->lower[d]) / along[d];
    part->first[l] = walls->squares;
    walls->squares += along[0] * along[1] * along[2];
  }
}

/* The widest squares have a power of two of fine spacings, at most the coarse spacing. */
static void LayOut(Cloud cloud, Walls *walls)
{
  const Domain domain = cloud->domain;
  PetscInt first[DIM] = {0, 0, 0}, last[DIM] = {2, 2, domain->dim == DIM ? 2 : 0}, side[DIM] = {0, 0, 0}, levels = 1,
           part    = 0;
  PetscReal widest = domain->spacing;

  *walls = (Walls){.cloud = cloud, .layers = CloudWallLayers(cloud)};
  for (; levels < LEVELS_MOST && 2 * widest <= (1 + POINT_TOLERANCE) * domain->spacing_coarse; levels++) widest *= 2;
  for (PetscInt l = 0; l < levels; l++)
    for (PetscInt d = 0; d < DIM; d++)
      walls->n[l][d] = PetscMax(1, (PetscInt)PetscFloorReal((domain->upper[d] - domain->lower[d]) / widest + 0.5)) << l;
  do SetPart(walls, side, levels, &walls->part[part++]);
  while (CellNext(first, last, side));
}

/* Finds the square of dummy particle a, and its layers behind the sides. */
static void FindSquare(const Walls *walls, const ParticleArrays *arrays, PetscInt a, Square *square,
                       PetscInt layer[DIM])
{
  const Domain     domain = walls->cloud->domain;
  const PetscReal *x = arrays->real[FIELD_POSITION] + DIM * a, size = arrays->real[FIELD_SIZE][a];
  const PetscInt   three[]   = {3, 3, 3};
  PetscInt         side[DIM] = {0, 0, 0};
  PetscReal        area;
  const Part      *part;

  for (PetscInt d = 0; d < domain->dim; d++) side[d] = x[d] < domain->lower[d] ? 1 : x[d] > domain->upper[d] ? 2 : 0;
  part    = &walls->part[CellIndex(three, side[0], side[1], side[2])];
  *square = (Square){.part = part};
  area    = ParticleSumVolume(domain, arrays, a) / PetscPowRealInt(size * domain->spacing, (int)part->outward);
  while (square->level < part->levels - 1 &&
         area < PetscSqrtReal(part->area[square->level] * part->area[square->level + 1]))
    square->level++;
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal below = x[d] - domain->lower[d], above = domain->upper[d] - x[d];

    if (!side[d]) square->at[d] = (PetscInt)(below / (below + above) * walls->n[square->level][d]);
    layer[d] = side[d] ? (PetscInt)PetscCeilReal(-PetscMin(below, above) / (size * domain->spacing)) : 0;
  }
  for (PetscInt d = domain->dim; d < DIM; d++) layer[d] = 0;
}

/* Puts dummy particle a into its place, with the smoothing length and spacing of layers that the target wants. */
static void Place(const Walls *walls, const Square *square, const PetscInt layer[DIM], ParticleArrays *arrays,
                  PetscInt a)
{
  const Domain domain = walls->cloud->domain;
  const Part  *part   = square->part;
  PetscReal    middle[DIM], spacing, *x = arrays->real[FIELD_POSITION] + DIM * a;

  Middle(walls, square, middle);
  spacing = SceneSpacing(walls->cloud->scene, middle);
  for (PetscInt d = 0; d < DIM; d++)
    x[d] = middle[d] + (part->side[d] == 0 ? 0 : part->side[d] == 1 ? -1 : 1) * (layer[d] - 0.5) * spacing;
  arrays->real[FIELD_SIZE][a]   = spacing / domain->spacing;
  arrays->real[FIELD_VOLUME][a] = part->area[square->level] * PetscPowRealInt(spacing, (int)part->outward) *
                                  DomainRingLength(domain, x, spacing / domain->spacing);
}

/* Finds the squares that have columns. */
static PetscErrorCode FindThere(Walls *walls, const ParticleArrays *arrays)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < arrays->n; a++) {
    PetscInt layer[DIM];
    Square   square;

    if (arrays->integer[INT_BODY][a] != BODY_WALL) continue;
    FindSquare(walls, arrays, a, &square, layer);
    walls->there[Number(walls, &square)] = PETSC_TRUE;
  }
  PetscCallMPI(
    MPI_Allreduce(MPI_IN_PLACE, walls->there, (PetscMPIInt)walls->squares, MPIU_BOOL, MPI_LOR, walls->cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the squares that the target wants in a square, or the square itself. */
static void FindWanted(Walls *walls, const Square *square)
{
  const PetscInt k = Number(walls, square);
  PetscInt       last[DIM];
  PetscReal      x[DIM], width;
  Square         first, quarter;

  Middle(walls, square, x);
  if (square->level < square->part->levels - 1) {
    width = PetscPowReal(square->part->area[square->level], 1. / (walls->cloud->domain->dim - square->part->outward));
    if (SceneSpacing(walls->cloud->scene, x) < (walls->there[k] ? STAYS : FINER) * width) {
      Quarters(walls, square, &first, last);
      quarter = first;
      do FindWanted(walls, &quarter);
      while (CellNext(first.at, last, quarter.at));
      return;
    }
  }
  walls->wanted[k] = PETSC_TRUE;
}

/* Adds the column of a new square behind the n particles of this rank, of which the arrays have room for it; arrays
   NULL: only counts it. *id: of the next particle. Returns the number of its particles on this rank. */
static PetscInt AddColumn(const Walls *walls, const Square *square, ParticleArrays *arrays, PetscInt n, PetscInt *id)
{
  const Domain   domain = walls->cloud->domain;
  const PetscInt parent = *id, count = PetscPowRealInt(walls->layers, (int)square->part->outward);
  PetscInt       first[DIM], last[DIM], layer[DIM];
  PetscReal      middle[DIM];
  PetscMPIInt    rank;

  (void)MPI_Comm_rank(domain->comm, &rank);
  Middle(walls, square, middle);
  *id += count;
  if (domain->cell_rank[DomainCell(domain, middle)] != rank) return 0;
  if (!arrays) return count;
  for (PetscInt d = 0; d < DIM; d++) {
    first[d] = layer[d] = square->part->side[d] ? 1 : 0;
    last[d]             = square->part->side[d] ? walls->layers : 0;
  }
  for (PetscInt a = n; a < n + count; a++, (void)CellNext(first, last, layer)) {
    Place(walls, square, layer, arrays, a);
    DomainWallVelocity(domain, arrays->real[FIELD_POSITION] + DIM * a, arrays->real[FIELD_VELOCITY] + DIM * a);
    arrays->integer[INT_LAYER][a]  = PetscMax(layer[0], PetscMax(layer[1], layer[2]));
    arrays->integer[INT_ID][a]     = parent + a - n;
    arrays->integer[INT_PARENT][a] = parent;
    arrays->integer[INT_BODY][a]   = BODY_WALL;
  }
  return count;
}

/* Visits the squares that are wanted but not there, on every rank in the same order, and adds their columns behind the
   n particles of this rank; arrays NULL: only counts them. Returns the number of their particles on this rank. */
static PetscInt AddColumns(const Walls *walls, ParticleArrays *arrays, PetscInt n, PetscInt id)
{
  PetscInt added = 0;

  for (PetscInt p = 0; p < PARTS; p++) {
    Square square = {.part = &walls->part[p]};

    for (; square.level < square.part->levels && square.part->outward; square.level++) {
      PetscInt along[DIM];

      Along(walls, square.part, square.level, along);
      for (PetscInt k = 0; k < along[0] * along[1] * along[2]; k++) {
        const PetscInt number = square.part->first[square.level] + k;

        if (!walls->wanted[number] || walls->there[number]) continue;
        CellCoordinates(along, k, square.at);
        added += AddColumn(walls, &square, arrays, n + added, &id);
      }
    }
  }
  return added;
}

/* Puts the dummy particles of wanted squares into their places, removes those of others, and adds what is missing. */
static PetscErrorCode Replace(const Walls *walls, ParticleArrays *arrays)
{
  const Particles particles = walls->cloud->particles;
  PetscInt        n         = arrays->n, id;
  PetscBool      *keep;

  PetscFunctionBegin;
  PetscCall(ParticlesLastId(walls->cloud->comm, n, arrays->integer[INT_ID], &id));
  PetscCall(PetscMalloc1(n, &keep));
  for (PetscInt a = 0; a < n; a++) {
    PetscInt layer[DIM];
    Square   square;

    keep[a] = PETSC_TRUE;
    if (arrays->integer[INT_BODY][a] != BODY_WALL) continue;
    FindSquare(walls, arrays, a, &square, layer);
    keep[a] = walls->wanted[Number(walls, &square)];
    if (keep[a]) Place(walls, &square, layer, arrays, a);
  }
  PetscCall(ParticlesClose(particles, arrays));
  PetscCall(ParticlesRemove(particles, keep));
  PetscCall(PetscFree(keep));
  PetscCall(ParticlesLocalSize(particles, &n));
  PetscCall(ParticlesAppend(particles, AddColumns(walls, NULL, n, id + 1)));
  PetscCall(ParticlesOpen(particles, arrays));
  (void)AddColumns(walls, arrays, n, id + 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TargetWalls(Cloud cloud)
{
  ParticleArrays arrays;
  Walls          walls;

  PetscFunctionBegin;
  LayOut(cloud, &walls);
  PetscCall(PetscCalloc2(walls.squares, &walls.there, walls.squares, &walls.wanted));
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  PetscCall(FindThere(&walls, &arrays));
  for (PetscInt p = 0; p < PARTS; p++) {
    Square   square = {.part = &walls.part[p]};
    PetscInt along[DIM];

    Along(&walls, square.part, 0, along);
    for (PetscInt k = 0; k < along[0] * along[1] * along[2] && square.part->outward; k++) {
      CellCoordinates(along, k, square.at);
      FindWanted(&walls, &square);
    }
  }
  PetscCall(Replace(&walls, &arrays));
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscCall(PetscFree2(walls.there, walls.wanted));
  PetscFunctionReturn(PETSC_SUCCESS);
}
