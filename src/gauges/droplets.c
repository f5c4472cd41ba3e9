/* Droplets: all connected pieces of liquid (CONNECTION), except the largest. They fill four columns of the
   series, and each droplet a row of droplets.csv. */
#include "gauges_impl.h"
#include <stdlib.h>

#define NONE          (-1) /* count of pieces that are not known */
#define DROPLET_LEAST 2    /* default of -gauge_droplet_least: single particles are spray */
#define SAME_VOLUME   0.25 /* change of a droplet's volume between two times */
#define SAME_PLACE    3.0  /* spacings: change of its way */
#define ALIKE         1e-9 /* relative difference of equal volumes: sums over another number of ranks round otherwise */

/* Columns of the series, and of a row of droplets.csv. */
enum { DROPLETS, DROPLET_VOLUME, LARGEST, SPRAY, QUANTITIES };
enum { ROW_PARTICLES, ROW_VOLUME, ROW_CENTER, ROW_VELOCITY = ROW_CENTER + DIM, ROW_NUMBER = ROW_VELOCITY + DIM, ROW };

/* A connected piece of liquid. All members are reals, so that MPI sends it as reals. */
typedef struct {
  PetscReal label;                      /* smallest id of its particles */
  PetscReal particles, volume;          /* volume: m3, in two dimensions m2 */
  PetscReal number;                     /* copies of this piece in the whole scene (-gauge_multiplicity) */
  PetscReal center[DIM], velocity[DIM]; /* means over the volume, m and m/s */
  PetscReal mirror[DIM];                /* -1, 1: the piece touches the mirror at the lower, upper face; 0: neither */
} Piece;

/* The options, and what -gauge_pinch_off keeps. */
typedef struct {
  PetscBool wanted, main, pinch_off;
  PetscInt  least;  /* particles of the smallest droplet; smaller pieces are spray */
  Piece    *before; /* [count] pieces at the last time of the series */
  PetscInt  count;
  PetscReal time; /* s, of these pieces */
} Droplets;

#define PIECE_REALS ((PetscMPIInt)(sizeof(Piece) / sizeof(PetscReal)))

static int CompareLabels(const void *a, const void *b)
{
  const PetscReal x = ((const Piece *)a)->label, y = ((const Piece *)b)->label;

  return (x > y) - (x < y);
}

static int CompareSizes(const void *a, const void *b)
{
  const PetscReal x = ((const Piece *)a)->volume, y = ((const Piece *)b)->volume;

  return PetscAbsReal(x - y) > ALIKE * (x + y) ? (x < y) - (x > y) : CompareLabels(a, b);
}

/* Adds a part to a piece. */
static void Join(Piece *to, const Piece *part)
{
  to->particles += part->particles;
  to->volume += part->volume;
  for (PetscInt d = 0; d < DIM; d++) {
    to->center[d] += part->center[d];
    to->velocity[d] += part->velocity[d];
    if (part->mirror[d] != 0) to->mirror[d] = part->mirror[d];
  }
}

/* Sorts the pieces by label and adds up those of one label; returns the number of labels. Centres and velocities are
   sums weighted by volume here. */
static PetscInt Merge(PetscInt n, Piece piece[])
{
  PetscInt count = 0;

  if (n) qsort(piece, (size_t)n, sizeof(*piece), CompareLabels);
  for (PetscInt k = 0; k < n; k++) {
    if (count && piece[count - 1].label == piece[k].label)
      Join(&piece[count - 1], &piece[k]);
    else
      piece[count++] = piece[k];
  }
  return count;
}

static Piece SingleParticle(Cloud cloud, PetscInt a, PetscReal label, PetscReal touch)
{
  const Domain    domain = cloud->domain;
  const PetscReal volume = cloud->volume[a];
  Piece           piece  = {.label = label, .particles = 1, .volume = volume};

  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal x = cloud->field[FIELD_POSITION][DIM * a + d];

    piece.center[d]   = volume * x;
    piece.velocity[d] = volume * cloud->field[FIELD_VELOCITY][DIM * a + d];
    if (domain->face[d][0] == FACE_SYMMETRY && x - domain->lower[d] < touch) piece.mirror[d] = -1;
    if (domain->face[d][1] == FACE_SYMMETRY && domain->upper[d] - x < touch) piece.mirror[d] = 1;
  }
  return piece;
}

/* Divides the sums by the volume, and makes it a piece of the whole scene. */
static void FinishPiece(Gauges gauges, Piece *piece)
{
  PetscReal larger;

  for (PetscInt d = 0; d < DIM; d++) {
    piece->center[d] /= piece->volume;
    piece->velocity[d] /= piece->volume;
  }
  larger = GaugeWhole(gauges, piece->mirror, piece->center, piece->velocity, &piece->number);
  piece->particles *= larger;
  piece->volume *= larger;
}

/* All pieces on rank 0, as far as they are of a body (ANY_BODY: of all), the largest first; none elsewhere. Free them
   with PetscFree. label [n_total]: of each particle. Collective. */
static PetscErrorCode LabelPieces(Gauges gauges, PetscInt body, PetscReal label[], PetscInt *count, Piece **piece)
{
  Cloud           cloud = gauges->cloud;
  const PetscReal touch = 0.5 * CONNECTION * cloud->domain->spacing; /* half the distance to the image */
  PetscInt        n     = 0, total;
  Piece          *own;

  PetscFunctionBegin;
  PetscCall(ConnectedLabels(gauges, label));
  PetscCall(PetscMalloc1(cloud->n_fluid, &own));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    if (body != ANY_BODY && cloud->integer[INT_BODY][a] != body) continue;
    own[n] = SingleParticle(cloud, a, label[a], cloud->size[a] * touch);
    if (n && own[n - 1].label == label[a]) /* most are: few are left to sort */
      Join(&own[n - 1], &own[n]);
    else
      n++;
  }
  PetscCall(GatherTo(gauges->comm, PETSC_FALSE, PIECE_REALS * Merge(n, own), own, MPIU_REAL, &total, piece));
  PetscCall(PetscFree(own));
  *count = Merge(total / PIECE_REALS, *piece);
  for (PetscInt k = 0; k < *count; k++) FinishPiece(gauges, &(*piece)[k]);
  if (*count) qsort(*piece, (size_t)*count, sizeof(**piece), CompareSizes);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindPieces(Gauges gauges, PetscInt *count, Piece **piece)
{
  PetscReal *label;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(gauges->cloud, 1, &label));
  PetscCall(LabelPieces(gauges, ANY_BODY, label, count, piece));
  PetscCall(CloudRestoreWork(gauges->cloud, &label));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConnectedLargest(Gauges gauges, PetscInt body, PetscBool in[])
{
  PetscReal *label, largest = -1;
  PetscInt   count;
  Piece     *piece;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(gauges->cloud, 1, &label));
  PetscCall(LabelPieces(gauges, body, label, &count, &piece));
  if (count) largest = piece[0].label;
  PetscCall(PetscFree(piece));
  PetscCallMPI(MPI_Bcast(&largest, 1, MPIU_REAL, 0, gauges->comm));
  for (PetscInt a = 0; a < gauges->cloud->n_fluid; a++) in[a] = (PetscBool)(label[a] == largest);
  PetscCall(CloudRestoreWork(gauges->cloud, &label));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow options[] = {
  {"-gauge_droplets",
   "Write number and volume of the droplets to the series, and a row for each to droplets.csv at each snapshot: "
   "droplets are all connected pieces but the largest",
   NULL, NULL, ROW_BOOL, offsetof(Droplets, wanted)},
  {"-gauge_droplet_least", "Particles of the smallest droplet; smaller ones are spray", "1", "[1, inf)", ROW_INT,
   offsetof(Droplets, least)},
  {"-gauge_droplet_main", "Write the largest piece to droplets.csv too, as the first row of a block", NULL, NULL,
   ROW_BOOL, offsetof(Droplets, main)},
  {"-gauge_pinch_off",
   "Write a row to pinch_off.csv for each droplet that was not there at the previous line of the series", NULL, NULL,
   ROW_BOOL, offsetof(Droplets, pinch_off)},
  {.name = NULL},
};

static void Defaults_Droplets(Gauges gauges, void *data)
{
  Droplets *droplets = data;

  droplets->least = DROPLET_LEAST;
  droplets->count = NONE;
}

static PetscErrorCode Columns_Droplets(Gauges gauges, const void *data, ColumnList *list)
{
  static const Column rows[QUANTITIES] = {[DROPLETS]       = {.name = "droplets", .counts = COUNTS_SUM},
                                          [DROPLET_VOLUME] = {.name = "droplet_volume", "m3", COUNTS_SUM},
                                          [LARGEST]        = {.name = "largest_droplet", "m3", COUNTS_SUM, OF_PIECE},
                                          [SPRAY]          = {.name = "spray", .counts = COUNTS_SUM}};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < QUANTITIES && ((const Droplets *)data)->wanted; k++)
    PetscCall(ColumnAdd(list, rows[k], "%s", rows[k].name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* On rank 0, of the simulated part: number of droplets, those that a mirror cuts in part; their volume, and that of the
   largest whole droplet (m3, in two dimensions m2); number of spray particles. */
static PetscErrorCode Measure_Droplets(Gauges gauges, const void *data, PetscReal value[])
{
  PetscInt count;
  Piece   *piece;

  PetscFunctionBegin;
  PetscCall(FindPieces(gauges, &count, &piece));
  for (PetscInt c = 0; c < QUANTITIES; c++) value[c] = 0;
  for (PetscInt k = 0; k < count; k++) { /* images of the largest piece are droplets */
    const PetscReal number = (piece[k].number - (k ? 0 : 1)) / gauges->multiplicity;

    if (number <= 0) continue;
    if (piece[k].particles < ((const Droplets *)data)->least) {
      value[SPRAY] += number * piece[k].particles;
      continue;
    }
    value[DROPLETS] += number;
    value[DROPLET_VOLUME] += number * piece[k].volume;
    value[LARGEST] = PetscMax(value[LARGEST], piece[k].volume);
  }
  PetscCall(PetscFree(piece));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- tables --- */

static PetscErrorCode ColumnsPieces(ColumnList *list)
{
  const Column place = {.unit = "m", .counts = COUNTS_VALUE, .of = OF_PIECE},
               speed = {.unit = "m/s", .counts = COUNTS_VALUE, .of = OF_PIECE};

  PetscFunctionBegin;
  PetscCall(ColumnAdd(list, (Column){.counts = COUNTS_RUN, .of = OF_PIECE}, "particles"));
  PetscCall(ColumnAdd(list, (Column){.unit = "m3", .counts = COUNTS_SUM, .of = OF_PIECE}, "volume"));
  PetscCall(ColumnAddVector(list, place, 0, DIM - 1, ""));
  PetscCall(ColumnAddVector(list, speed, 0, DIM - 1, "velocity"));
  PetscCall(ColumnAdd(list, (Column){.counts = COUNTS_VALUE, .of = OF_PIECE}, "number"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ColumnsTable_Droplets(Gauges gauges, const void *data, ColumnList *list)
{
  return ((const Droplets *)data)->wanted ? ColumnsPieces(list) : PETSC_SUCCESS;
}

static PetscErrorCode ColumnsTable_PinchOff(Gauges gauges, const void *data, ColumnList *list)
{
  return ((const Droplets *)data)->pinch_off ? ColumnsPieces(list) : PETSC_SUCCESS;
}

/* Rows of droplets.csv or pinch_off.csv for wanted pieces of at least 'least' particles. */
static PetscErrorCode PieceRows(PetscInt least, PetscInt pieces, const Piece piece[], const PetscBool wanted[],
                                PetscInt *count, PetscReal **values)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(pieces * ROW, values));
  *count = 0;
  for (PetscInt k = 0; k < pieces; k++) {
    PetscReal *row = *values + ROW * *count;

    if (!wanted[k] || piece[k].particles < least) continue;
    row[ROW_PARTICLES] = piece[k].particles;
    row[ROW_VOLUME]    = piece[k].volume;
    PetscCall(PetscArraycpy(row + ROW_CENTER, piece[k].center, DIM));
    PetscCall(PetscArraycpy(row + ROW_VELOCITY, piece[k].velocity, DIM));
    row[ROW_NUMBER] = piece[k].number;
    (*count)++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Rows_Droplets(Gauges gauges, void *data, PetscReal time, PetscInt *count, PetscReal **values)
{
  const Droplets *droplets = data;
  PetscInt        pieces;
  Piece          *piece;
  PetscBool      *wanted;

  PetscFunctionBegin;
  PetscCall(FindPieces(gauges, &pieces, &piece));
  PetscCall(PetscMalloc1(pieces, &wanted));
  if (pieces && !droplets->main) piece[0].number--; /* its images are droplets */
  for (PetscInt k = 0; k < pieces; k++) wanted[k] = (PetscBool)(piece[k].number > 0);
  PetscCall(PieceRows(droplets->least, pieces, piece, wanted, count, values));
  PetscCall(PetscFree(wanted));
  PetscCall(PetscFree(piece));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- pieces that come off --- */

static PetscBool HasLabel(PetscInt n, const Piece piece[], PetscReal label)
{
  for (PetscInt k = 0; k < n; k++)
    if (piece[k].label == label) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Whether droplet 'now' was among the pieces of the previous time: its label was, or a droplet of nearly its volume
   has moved here, whose particles have new ids since they joined or split. A droplet that takes its label from the
   largest piece is new: 'taken' tells that the label of the largest piece is new. */
static PetscBool WasThere(Gauges gauges, const Droplets *droplets, PetscReal time, const Piece *now, PetscBool taken)
{
  for (PetscInt k = 0; k < droplets->count; k++) {
    const Piece *before = &droplets->before[k];
    PetscReal    r[DIM];

    if (before->label == now->label) return (PetscBool)(k > 0 || !taken);
    for (PetscInt d = 0; d < DIM; d++)
      r[d] = before->center[d] + (time - droplets->time) * before->velocity[d] - now->center[d];
    if (k > 0 && PetscAbsReal(now->volume - before->volume) < SAME_VOLUME * before->volume &&
        Dot(r, r) < PetscSqr(SAME_PLACE * gauges->cloud->domain->spacing))
      return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* The first call, at the start or after a restart, has no rows: it only keeps the pieces. */
static PetscErrorCode Rows_PinchOff(Gauges gauges, void *data, PetscReal time, PetscInt *count, PetscReal **values)
{
  Droplets  *droplets = data;
  Piece     *piece;
  PetscInt   pieces;
  PetscBool *wanted, taken;

  PetscFunctionBegin;
  PetscCall(FindPieces(gauges, &pieces, &piece));
  PetscCall(PetscCalloc1(pieces, &wanted));
  taken = (PetscBool)(pieces > 0 && !HasLabel(droplets->count, droplets->before, piece[0].label));
  for (PetscInt k = 1; k < pieces && droplets->count != NONE; k++)
    wanted[k] = (PetscBool)!WasThere(gauges, droplets, time, &piece[k], taken);
  PetscCall(PieceRows(droplets->least, pieces, piece, wanted, count, values));
  PetscCall(PetscFree(wanted));
  PetscCall(PetscFree(droplets->before));
  droplets->before = piece;
  droplets->count  = pieces;
  droplets->time   = time;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy_Droplets(void *data)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(((Droplets *)data)->before));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const GaugeTable tables[] = {
  {.file = "droplets.csv", .columns = ColumnsTable_Droplets, .rows = Rows_Droplets},
  {.file = "pinch_off.csv", .columns = ColumnsTable_PinchOff, .rows = Rows_PinchOff, .events = PETSC_TRUE},
  {.file = NULL}};

const GaugeKind GaugeDroplets = {.bytes    = sizeof(Droplets),
                                 .options  = options,
                                 .defaults = Defaults_Droplets,
                                 .columns  = Columns_Droplets,
                                 .measure  = Measure_Droplets,
                                 .tables   = tables,
                                 .destroy  = Destroy_Droplets};
