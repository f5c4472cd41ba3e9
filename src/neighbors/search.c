/* The neighbour search: the list of the pairs within the kernel's support, and the factors of the pairs. Rows of
   particles of one size and of graded particles are two instances of one text, chosen by the constant 'sized'. flat:
   two dimensions. */
#include "search.h"

#define PAIR_FLOPS    29 /* of a pair for -log_view: distance, kernel, factors */
#define VISITED_FLOPS 77 /* with the visitor's sums: W, normal, crowding, six moments */
#define INSTANCE      static inline __attribute__((always_inline))

/* WIDE local indices, which are below 2^31 even if integers have 64 bits. */
INSTANCE WideInteger LoadIndices(const PetscInt from[])
{
  WideInteger t = {0};

  if (sizeof(PetscInt) == sizeof(int32_t))
    (void)memcpy(&t, from, sizeof(t));
  else
    for (PetscInt k = 0; k < WIDE; k++) t[k] = (int32_t)from[k];
  return t;
}

INSTANCE void PackIndices(WideKept kept, WideInteger index, PetscInt to[])
{
  int32_t t[WIDE];

  if (sizeof(PetscInt) == sizeof(int32_t)) {
    WidePackIntegers(kept, index, (int32_t *)to);
    return;
  }
  WidePackIntegers(kept, index, t);
  for (PetscInt k = 0; k < WIDE; k++) to[k] = t[k];
}

/* Stores in list, s and near the candidates of a run that are neighbours of particle a at the integer position p: s =
   r2/h2 is below the limit times the square of the mean size. Omits the particle itself. near: their sizes. Returns
   their number. Reads LANES candidates, and may write as many. */
INSTANCE PetscInt KeepNear(PetscBool sized, PetscBool flat, Run run, Candidates all, const float unit[DIM], float own,
                           float limit, PetscInt a, const int32_t p[DIM], PetscInt *restrict list, float *restrict s,
                           float *restrict near)
{
  const PetscInt count = RUN_COUNT(run), n = all.n;
  PetscInt       k = 0, found = 0;

  do {
    const PetscInt begin = RUN_BEGIN(run) + k;
    const int32_t *x     = all.position + begin;
    const Wide     dx = unit[0] * WideApart(p[0], x), dy = unit[1] * WideApart(p[1], x + n),
               dz = flat ? WideSet(0) : unit[2] * WideApart(p[2], x + 2 * n), in_plane = dy * dy + dx * dx,
               s2    = flat ? in_plane : dz * dz + in_plane;
    const Wide other = sized ? WideLoad(all.size + begin) : WideSet(1), both = own + other,
               most        = sized ? both * both * (0.25f * limit) : WideSet(limit);
    const WideInteger b    = LoadIndices(all.index + begin);
    const WideKept    kept = WideKeep(WideBelow(s2, most) & WideOther(b, (int32_t)a), count - k);

    PackIndices(kept, b, list + found);
    WidePack(kept, s2, s + found);
    if (sized) WidePack(kept, other, near + found);
    found += WideCount(kept);
    k += WIDE;
  } while (WIDE < LANES && k < count);
  return found;
}

/* Appends the neighbours in the runs of a level to the 'found' neighbours of particle a; see KeepNear. Returns more
   than ROW_CAPACITY if there is no room. Local variables stay in registers: otherwise the loop's stores might
   alias *search. */
INSTANCE PetscInt KeepRuns(PetscBool sized, PetscBool flat, Candidates all, const Run *restrict run, PetscInt runs,
                           const float unit[DIM], float own, float limit, PetscInt a, const int32_t p[DIM],
                           PetscInt *restrict list, float *restrict s, float *restrict near, PetscInt found)
{
  for (PetscInt r = 0; r < runs && found <= ROW_CAPACITY;) {
    const PetscInt fit = PetscMin(runs, r + 1 + (ROW_CAPACITY - found) / LANES); /* the room suffices up to this run */

    for (; r < fit; r++)
      found += KeepNear(sized, flat, run[r], all, unit, own, limit, a, p, list + found, s + found, near + found);
  }
  return found;
}

/* Finds the neighbours of particle a; returns their number. Writes to list, search->s and search->size. */
INSTANCE PetscInt FindNeighbors(PetscBool sized, PetscBool flat, Cloud cloud, Search *search, PetscInt a,
                                PetscInt list[])
{
  const PetscReal *x         = cloud->field[FIELD_POSITION] + DIM * a;
  const PetscInt   own       = sized ? SearchLevel(cloud, a) : 0;
  const float      size      = sized ? (float)cloud->size[a] : 1;
  const Units     *units     = &search->units;
  const int32_t    p[DIM]    = {(int32_t)IntegerPosition(units, 0, x[0]), (int32_t)IntegerPosition(units, 1, x[1]),
                                (int32_t)IntegerPosition(units, 2, x[2])};
  const float      unit[DIM] = {units->unit[0], units->unit[1], units->unit[2]}, limit = search->limit;
  PetscInt         found = 0, block = -1; /* block in the finer of both levels */

  for (PetscInt l = 0; l < (sized ? SEARCH_LEVELS : 1); l++) {
    const Level *level = &search->level[l];
    PetscInt     runs;

    if (sized && !level->all.n) continue;
    if (sized && l <= own) block = CellBoxFind(&level->blocks.box, x);
    runs  = sized ? SearchLevelRuns(cloud, search, a, own, l, block)
                  : FindRuns(level->grid, level->lines, PETSC_FALSE, x, search->support, search->run);
    found = KeepRuns(sized, flat, level->all, search->run, runs, unit, size, limit, a, p, list, search->s, search->size,
                     found);
  }
  return found;
}

/* Computes the factors of n padded pairs of particle a, with the weights of the neighbours, size^dim: see Cloud and
   RowVisitor. With q = h/h_ab, the pair's W is q^dim times W of h at r q, its F q^(dim + 2) times F. w may be NULL.
   Laplacian factors are in units of search->unit; returns their sum. -F is largest at r = 0, so all fit into sixteen
   bits. */
INSTANCE PetscInt PairFactors(PetscBool sized, PetscBool flat, Cloud cloud, Search *search, PetscInt a, PetscInt n,
                              float *restrict w, float *restrict slope, uint16_t *restrict laplacian)
{
  const float eta2 = ETA_OVER_H * ETA_OVER_H, inverse = 1 / search->unit, own = sized ? (float)cloud->size[a] : 1,
              own_weight = flat ? own * own : own * own * own;
  const PetscInt padded  = (n + LANES - 1) / LANES * LANES;
  float *restrict s = search->s, *restrict size = search->size, *restrict ratio = search->ratio;
  PetscInt sum = 0;

  for (PetscInt begin = 0; begin < padded && sized; begin += LANES) {
    SIMD_LOOP()
    for (PetscInt k = begin; k < begin + LANES; k++) {
      ratio[k] = 2 / (own + size[k]);
      s[k] *= ratio[k] * ratio[k];
    }
  }
  KernelSingle(cloud->kernel, n, s, w, slope);
  for (PetscInt begin = 0; begin < padded; begin += LANES) {
    SIMD_LOOP(reduction(+ : sum))
    for (PetscInt k = begin; k < begin + LANES; k++) {
      const float   q = sized ? ratio[k] : 1, q2 = q * q, q_dim = flat ? q2 : q2 * q, of = sized ? size[k] : 1;
      const float   weight = flat ? of * of : of * of * of, steep = slope[k] * q_dim * q2, over = steep / (s[k] + eta2);
      const int32_t code = (int32_t)(0.5f - inverse * over * s[k] * (own_weight * weight));

      if (w && sized) w[k] *= q_dim * weight;
      if (sized) slope[k] = steep * weight;
      laplacian[k] = (uint16_t)code;
      sum += code;
    }
  }
  return sum;
}

/* Finds all rows. */
INSTANCE PetscErrorCode FindRows(PetscBool sized, PetscBool flat, Cloud cloud, Search *search, RowVisitor visit,
                                 void *context)
{
  const PetscInt most = ROW_CAPACITY + LANES;
  PetscInt64     used = 0; /* pairs */
  float          w[ROW_CAPACITY + LANES];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    PetscInt found;

    if (used + most > cloud->list_capacity)
      PetscCall(ReserveList(cloud, CloudListRoom(used, cloud->n_owned - a, most)));
    found = FindNeighbors(sized, flat, cloud, search, a, cloud->list + used);
    PetscCall(RowCheck(cloud, a, found));
    PadRow(a, found, cloud->list + used, search->s);
    for (PetscInt k = found; k < found + LANES && sized; k++) search->size[k] = 1;
    cloud->laplacian_sum[a] =
      PairFactors(sized, flat, cloud, search, a, found, visit ? w : NULL, cloud->slope + used, cloud->laplacian + used);
    if (CloudWeighs(cloud)) WeightRow(cloud, found, cloud->list + used, visit ? w : NULL, cloud->slope + used);
    used = RowEnd(cloud, a, used, found, w, visit, context);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudSearch(Cloud cloud, RowVisitor visit, void *context)
{
  Search *search;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_NEIGHBORS), 0, 0, 0, 0));
  WideStart();
  PetscCall(PetscNew(&search));
  PetscCall(SearchCreate(cloud, search));
  FindWeights(cloud);
  cloud->laplacian_unit = search->unit;
  cloud->first[0]       = 0;
  if (!cloud->domain->graded && cloud->domain->dim == 2)
    PetscCall(FindRows(PETSC_FALSE, PETSC_TRUE, cloud, search, visit, context));
  else if (!cloud->domain->graded)
    PetscCall(FindRows(PETSC_FALSE, PETSC_FALSE, cloud, search, visit, context));
  else if (cloud->domain->dim == 2)
    PetscCall(FindRows(PETSC_TRUE, PETSC_TRUE, cloud, search, visit, context));
  else
    PetscCall(FindRows(PETSC_TRUE, PETSC_FALSE, cloud, search, visit, context));
  PetscCall(SearchDestroy(cloud, search));
  PetscCall(PetscFree(search));
  PetscCall(LogPairFlops(cloud->first[cloud->n_owned], visit ? VISITED_FLOPS : PAIR_FLOPS));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_NEIGHBORS), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
