/* Droplets: all connected pieces of liquid (CONNECTION), except the largest. They fill four columns of the
   series, and each droplet a row of droplets.csv. */
#include "gauges_impl.h"
#include <stdlib.h>

#define DROPLET_LEAST   2    /* default of -gauge_droplet_least: single particles are spray */
#define DROPLET_COLUMNS 4    /* of the series */
#define SAME_VOLUME     0.25 /* change of a droplet's volume between two times */
#define SAME_PLACE      3.0  /* spacings: change of its way */
#define ALIKE           1e-9 /* relative difference of equal volumes: sums over another number of ranks round otherwise */
#define ROW_COLUMNS     9    /* of droplets.csv: particles, volume, centre, velocity, number */

/* A connected piece of liquid. All members are reals, so that MPI sends it as reals. */
typedef struct {
  PetscReal label;                      /* smallest id of its particles */
  PetscReal particles, volume;          /* volume: m3, in two dimensions m2 */
  PetscReal number;                     /* copies of this piece in the whole scene (-gauge_multiplicity) */
  PetscReal center[DIM], velocity[DIM]; /* means, m and m/s */
  PetscReal mirror[DIM];                /* -1, 1: the piece touches the mirror at the lower, upper face; 0: neither */
} Piece;

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

/* Sorts the pieces by label and adds up those of one label; returns the number of labels. Centres and velocities are
   sums weighted by volume here. */
static PetscInt Merge(PetscInt n, Piece piece[])
{
  PetscInt count = 0;

  if (n) qsort(piece, (size_t)n, sizeof(*piece), CompareLabels);
  for (PetscInt k = 0; k < n; k++) {
    Piece *to = &piece[count - 1];

    if (count == 0 || to->label != piece[k].label) {
      piece[count++] = piece[k];
      continue;
    }
    to->particles += piece[k].particles;
    to->volume += piece[k].volume;
    for (PetscInt d = 0; d < DIM; d++) {
      to->center[d] += piece[k].center[d];
      to->velocity[d] += piece[k].velocity[d];
      if (piece[k].mirror[d] != 0) to->mirror[d] = piece[k].mirror[d];
    }
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

/* Divides the sums by the volume. A piece that touches a mirror is connected with its image: the whole
   piece has twice the particles, its centre is on the mirror, and half as many copies are in the whole scene. Without
   -gauge_multiplicity the image does not count. */
static void FinishPiece(Gauges gauges, Piece *piece)
{
  const Domain domain = gauges->cloud->domain;

  for (PetscInt d = 0; d < DIM; d++) {
    piece->center[d] /= piece->volume;
    piece->velocity[d] /= piece->volume;
  }
  piece->number = gauges->multiplicity;
  for (PetscInt d = 0; d < domain->dim; d++) {
    if (piece->mirror[d] == 0 || piece->number < 2) continue;
    piece->number /= 2;
    piece->particles *= 2;
    piece->volume *= 2;
    piece->center[d]   = piece->mirror[d] < 0 ? domain->lower[d] : domain->upper[d];
    piece->velocity[d] = 0;
  }
}

/* All pieces on rank 0, the largest first; none elsewhere. Free them with PetscFree. label [n_total]: of each particle.
   Collective. */
static PetscErrorCode LabelPieces(Gauges gauges, PetscReal label[], PetscInt *count, Piece **piece)
{
  Cloud           cloud = gauges->cloud;
  const PetscReal touch = 0.5 * CONNECTION * cloud->domain->spacing; /* half the distance to the image */
  Piece          *own;
  PetscMPIInt     send, *number = NULL, *start = NULL, total = 0;

  PetscFunctionBegin;
  PetscCall(ConnectedLabels(gauges, label));
  PetscCall(PetscMalloc1(cloud->n_fluid, &own));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) own[a] = SingleParticle(cloud, a, label[a], cloud->size[a] * touch);
  send = PIECE_REALS * (PetscMPIInt)Merge(cloud->n_fluid, own);
  PetscCall(PetscMalloc2(gauges->size, &number, gauges->size, &start));
  PetscCallMPI(MPI_Gather(&send, 1, MPI_INT, number, 1, MPI_INT, 0, gauges->comm));
  for (PetscMPIInt r = 0; r < gauges->size && !gauges->rank; r++) {
    start[r] = total;
    total += number[r];
  }
  PetscCall(PetscMalloc1(total / PIECE_REALS, piece));
  PetscCallMPI(MPI_Gatherv(own, send, MPIU_REAL, *piece, number, start, MPIU_REAL, 0, gauges->comm));
  PetscCall(PetscFree2(number, start));
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
  PetscCall(LabelPieces(gauges, label, count, piece));
  PetscCall(CloudRestoreWork(gauges->cloud, &label));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConnectedLargest(Gauges gauges, PetscBool in[])
{
  PetscReal *label, largest = -1;
  PetscInt   count;
  Piece     *piece;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(gauges->cloud, 1, &label));
  PetscCall(LabelPieces(gauges, label, &count, &piece));
  if (count) largest = piece[0].label;
  PetscCall(PetscFree(piece));
  PetscCallMPI(MPI_Bcast(&largest, 1, MPIU_REAL, 0, gauges->comm));
  for (PetscInt a = 0; a < gauges->cloud->n_fluid; a++) in[a] = (PetscBool)(label[a] == largest);
  PetscCall(CloudRestoreWork(gauges->cloud, &label));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetFromOptions_Droplets(Gauges gauges, OptionItems PetscOptionsObject)
{
  PetscFunctionBegin;
  gauges->droplet_least = DROPLET_LEAST;
  PetscCall(PetscOptionsBool("-gauge_droplets",
                             "Write number and volume of the droplets to the series, and a row for each to "
                             "droplets.csv at each snapshot: droplets are all connected pieces but the largest",
                             "GaugesMeasure", gauges->droplets, &gauges->droplets, NULL));
  PetscCall(OptionInt("-gauge_droplet_least", "Particles of the smallest droplet (1); smaller ones are spray",
                      "[1, inf)", &gauges->droplet_least));
  PetscCall(PetscOptionsBool("-gauge_droplet_main",
                             "Write the largest piece to droplets.csv too, as the first row of a "
                             "block",
                             "GaugesTableRows", gauges->droplet_main, &gauges->droplet_main, NULL));
  PetscCall(PetscOptionsBool("-gauge_pinch_off",
                             "Write a row to pinch_off.csv for each droplet that was not there at the previous line of "
                             "the series",
                             "GaugesTableRows", gauges->pinch_off, &gauges->pinch_off, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt Columns_Droplets(Gauges gauges)
{
  return gauges->droplets ? DROPLET_COLUMNS : 0;
}

static PetscErrorCode Name_Droplets(Gauges gauges, PetscInt column, char name[], size_t length)
{
  static const char *const names[DROPLET_COLUMNS] = {"droplets", "droplet_volume_%s", "largest_droplet_%s", "spray"};

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, length, names[column], GaugeUnit(gauges->cloud->domain, "m3")));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* On rank 0: number of droplets, their volume and that of the largest droplet (m3, in two dimensions m2), number of
   spray particles. */
static PetscErrorCode Measure_Droplets(Gauges gauges, PetscReal value[])
{
  PetscInt count;
  Piece   *piece;

  PetscFunctionBegin;
  PetscCall(FindPieces(gauges, &count, &piece));
  for (PetscInt c = 0; c < DROPLET_COLUMNS; c++) value[c] = 0;
  for (PetscInt k = 1; k < count; k++) {
    if (piece[k].particles < gauges->droplet_least) {
      value[3] += piece[k].number * piece[k].particles;
      continue;
    }
    value[0] += piece[k].number;
    value[1] += piece[k].number * piece[k].volume;
    value[2] = PetscMax(value[2], piece[k].volume);
  }
  PetscCall(PetscFree(piece));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool Wanted_Droplets(Gauges gauges)
{
  return gauges->droplets;
}

static PetscErrorCode Head_Droplets(Gauges gauges, char head[], size_t length)
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(head, length,
                          "particles,volume_%s,x_m,y_m,z_m,velocity_x_m/s,velocity_y_m/s,velocity_z_m/s,number",
                          GaugeUnit(gauges->cloud->domain, "m3")));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows of droplets.csv or pinch_off.csv for wanted pieces of at least -gauge_droplet_least particles. */
static PetscErrorCode PieceRows(Gauges gauges, PetscInt pieces, const Piece piece[], const PetscBool wanted[],
                                PetscInt *count, PetscInt *width, PetscReal **values)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(pieces * ROW_COLUMNS, values));
  *count = 0;
  *width = ROW_COLUMNS;
  for (PetscInt k = 0; k < pieces; k++) {
    PetscReal *row = *values + ROW_COLUMNS * *count;

    if (!wanted[k] || piece[k].particles < gauges->droplet_least) continue;
    row[0] = piece[k].particles;
    row[1] = piece[k].volume;
    PetscCall(PetscArraycpy(row + 2, piece[k].center, DIM));
    PetscCall(PetscArraycpy(row + 2 + DIM, piece[k].velocity, DIM));
    row[2 + 2 * DIM] = piece[k].number;
    (*count)++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Rows_Droplets(Gauges gauges, PetscInt *count, PetscInt *width, PetscReal **values)
{
  PetscInt   pieces;
  Piece     *piece;
  PetscBool *wanted;

  PetscFunctionBegin;
  PetscCall(FindPieces(gauges, &pieces, &piece));
  PetscCall(PetscMalloc1(pieces, &wanted));
  for (PetscInt k = 0; k < pieces; k++) wanted[k] = (PetscBool)(k > 0 || gauges->droplet_main);
  PetscCall(PieceRows(gauges, pieces, piece, wanted, count, width, values));
  PetscCall(PetscFree(wanted));
  PetscCall(PetscFree(piece));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- pieces that come off --- */

static PetscBool Wanted_PinchOff(Gauges gauges)
{
  return gauges->pinch_off;
}

static PetscBool HasLabel(PetscInt n, const Piece piece[], PetscReal label)
{
  for (PetscInt k = 0; k < n; k++)
    if (piece[k].label == label) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Whether droplet 'now' was among the n pieces of the previous time: its label was, or a droplet of nearly its volume
   has moved here, whose particles have new ids since they joined or split. A droplet that takes its label from the
   largest piece is new: 'taken' tells that the label of the largest piece is new. */
static PetscBool WasThere(Gauges gauges, PetscInt n, const Piece before[], const Piece *now, PetscBool taken)
{
  const PetscReal time = gauges->time - gauges->before_time;

  for (PetscInt k = 0; k < n; k++) {
    PetscReal r[DIM];

    if (before[k].label == now->label) return (PetscBool)(k > 0 || !taken);
    for (PetscInt d = 0; d < DIM; d++) r[d] = before[k].center[d] + time * before[k].velocity[d] - now->center[d];
    if (k > 0 && PetscAbsReal(now->volume - before[k].volume) < SAME_VOLUME * before[k].volume &&
        Dot(r, r) < PetscSqr(SAME_PLACE * gauges->cloud->domain->spacing))
      return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* The first call, at the start or after a restart, has no rows: it only keeps the pieces. */
static PetscErrorCode Rows_PinchOff(Gauges gauges, PetscInt *count, PetscInt *width, PetscReal **values)
{
  Piece     *before = gauges->piece_before, *piece;
  PetscInt   pieces;
  PetscBool *wanted, taken;

  PetscFunctionBegin;
  PetscCall(FindPieces(gauges, &pieces, &piece));
  PetscCall(PetscCalloc1(pieces, &wanted));
  taken = (PetscBool)(pieces > 0 && !HasLabel(gauges->before, before, piece[0].label));
  for (PetscInt k = 1; k < pieces && gauges->before >= 0; k++)
    wanted[k] = (PetscBool)!WasThere(gauges, gauges->before, before, &piece[k], taken);
  PetscCall(PieceRows(gauges, pieces, piece, wanted, count, width, values));
  PetscCall(PetscFree(wanted));
  PetscCall(PetscFree(before));
  gauges->piece_before = piece;
  gauges->before       = pieces;
  gauges->before_time  = gauges->time;
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugePinchOff = {.file   = "pinch_off.csv",
                                 .wanted = Wanted_PinchOff,
                                 .head   = Head_Droplets,
                                 .rows   = Rows_PinchOff,
                                 .events = PETSC_TRUE};

const GaugeKind GaugeDroplets = {.setfromoptions = SetFromOptions_Droplets,
                                 .columns        = Columns_Droplets,
                                 .name           = Name_Droplets,
                                 .measure        = Measure_Droplets,
                                 .file           = "droplets.csv",
                                 .wanted         = Wanted_Droplets,
                                 .head           = Head_Droplets,
                                 .rows           = Rows_Droplets};
