/* What goes into the snapshots: -snapshot_fields, -snapshot_lower and so on. */
#include "output_impl.h"

#define DEFLATE 1 /* default: halves the files; 4 or 9 save 1 % more */

/* Integer fields of a snapshot. */
static const IntFieldId int_fields[] = {INT_ID, INT_BODY, INT_SURFACE, INT_LAYER};

SnapshotField SnapshotFieldAt(PetscInt f)
{
  const PetscBool real  = (PetscBool)(f < FIELD_STORED_COUNT);
  const PetscInt  id    = real ? -1 : (PetscInt)int_fields[f - FIELD_STORED_COUNT];
  SnapshotField   field = {.column  = {.counts = real ? COUNTS_VALUE : COUNTS_RUN, .of = OF_PARTICLE},
                           .meaning = real ? Fields[f].meaning : IntFieldMeanings[id],
                           .width   = real ? Fields[f].width : 1,
                           .integer = id};

  (void)snprintf(field.column.name, sizeof(field.column.name), "%s", real ? Fields[f].name : IntFieldNames[id]);
  if (real && strcmp(Fields[f].unit, "1")) field.column.unit = Fields[f].unit;
  if (f == FIELD_VOLUME) field.column.counts = COUNTS_SUM;
  if (f == FIELD_PRESSURE) field.column.needs = NEEDS_PRESSURE;
  return field;
}

const char *SnapshotUnit(Output output, PetscInt f)
{
  const SnapshotField field = SnapshotFieldAt(f);
  ColumnWords         words = {.unit = ""};

  (void)GaugesColumnWords(output->gauges, &field.column, &words);
  return words.unit[0] ? words.unit : "1";
}

void SnapshotName(PetscInt index, char name[64])
{
  (void)snprintf(name, 64, "snapshot_%06d.h5", (int)index);
}

/* Fields of every snapshot: they identify a particle. */
static PetscBool Always(PetscInt f)
{
  const PetscInt integer = SnapshotFieldAt(f).integer;

  return (PetscBool)(f == FIELD_POSITION || integer == INT_ID || integer == INT_BODY);
}

#define WORD(id, name, width, parity, carry, unit, meaning) name,
static const char *const words[] = {STORED_REALS(WORD) "surface", "layer", "none", NULL};

static const OptionRow options[] = {
  {"-snapshot_walls",
   "Write particles of walls and solids at rest into the snapshots too; those of moving solids always are", NULL, NULL,
   ROW_BOOL, offsetof(SnapshotSetup, walls)},
  {"-snapshot_double", "Snapshots in double precision", NULL, NULL, ROW_BOOL, offsetof(SnapshotSetup, precise)},
  {"-snapshot_fields", "Fields of a snapshot, of those that the run has; position, id and body are always in it", NULL,
   NULL, ROW_NAMES, offsetof(SnapshotSetup, named), .fallback = "all", .words = words, .most = SNAPSHOT_FIELDS + 1},
  {"-snapshot_lower", "Lower corner of the region in the snapshots", "m", NULL, ROW_POINT,
   offsetof(SnapshotSetup, corner[0]), .fallback = "-box_lower"},
  {"-snapshot_upper", "Upper corner of the region in the snapshots", "m", NULL, ROW_POINT,
   offsetof(SnapshotSetup, corner[1]), .fallback = "-box_upper"},
  {"-snapshot_compression", "Deflate level of the snapshots, 0: none, 9: smallest, slow", "1", "[0, 9]", ROW_INT,
   offsetof(SnapshotSetup, compression)},
  {.name = NULL},
};

PetscErrorCode SnapshotSetFromOptions(Output output, OptionItems PetscOptionsObject)
{
  const Domain   domain  = output->cloud->domain;
  SnapshotSetup *content = &output->content;
  PetscBool      set[2];

  PetscFunctionBegin;
  content->compression = DEFLATE;
  for (PetscInt d = 0; d < DIM; d++) {
    content->corner[0][d] = domain->lower[d];
    content->corner[1][d] = domain->upper[d];
  }
  PetscCall(DomainReadOptions(domain, PetscOptionsObject, options, "OutputSetFromOptions", content));
  PetscCall(PetscOptionsHasName(NULL, NULL, "-snapshot_lower", &set[0]));
  PetscCall(PetscOptionsHasName(NULL, NULL, "-snapshot_upper", &set[1]));
  content->region = (PetscBool)(set[0] || set[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the particles have field f. */
static PetscBool Present(Output output, PetscInt f)
{
  return (PetscBool)(f >= FIELD_STORED_COUNT || ParticlesHave(output->cloud->particles, f));
}

/* The names of the fields that the run has, with commas. */
static const char *Names(Output output, char names[NAMES_LENGTH])
{
  names[0] = 0;
  for (PetscInt f = 0; f < SNAPSHOT_FIELDS; f++) {
    if (!Present(output, f)) continue;
    if (names[0]) TextAppend(names, NAMES_LENGTH, ", ");
    TextAppend(names, NAMES_LENGTH, SnapshotFieldAt(f).column.name);
  }
  return names;
}

/* The bits of the fields that the user named. */
static PetscErrorCode CheckFields(Output output)
{
  SnapshotSetup *content = &output->content;
  PetscBool      none    = PETSC_FALSE;
  char           names[NAMES_LENGTH];

  PetscFunctionBegin;
  content->fields = 0;
  if (content->named.count == 1) PetscCall(PetscStrcmp(content->named.name[0], "none", &none));
  for (PetscInt f = 0; f < SNAPSHOT_FIELDS; f++)
    if (Always(f) || (content->named.count == 0 && Present(output, f) &&
                      (SnapshotFieldAt(f).integer != INT_LAYER || content->walls)))
      content->fields |= 1U << f;
  for (PetscInt k = 0; k < content->named.count && !none; k++) {
    PetscBool found = PETSC_FALSE;

    for (PetscInt f = 0; f < SNAPSHOT_FIELDS && !found; f++) {
      PetscCall(PetscStrcmp(content->named.name[k], SnapshotFieldAt(f).column.name, &found));
      found = (PetscBool)(found && Present(output, f));
      if (found) content->fields |= 1U << f;
    }
    PetscCheckUser(found, output->comm, "-snapshot_fields names %s; this run has %s, or none.", content->named.name[k],
                   Names(output, names));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SnapshotCheck(Output output)
{
  const Domain         domain  = output->cloud->domain;
  const SnapshotSetup *content = &output->content;

  PetscFunctionBegin;
  PetscCall(CheckFields(output));
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal lower = content->corner[0][d], upper = content->corner[1][d];

    PetscCheckUser(lower < upper && lower < domain->upper[d] && upper > domain->lower[d], output->comm,
                   "-snapshot_lower and -snapshot_upper leave %c from %g to %g m; some part of the box, from %g to %g "
                   "m, must remain.",
                   'x' + (int)d, (double)lower, (double)upper, (double)domain->lower[d], (double)domain->upper[d]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
