/* What a gauge provides, for those who make one, here or in the folder of an edge. */
#ifndef ISPH_GAUGE_COLUMNS_H
#define ISPH_GAUGE_COLUMNS_H

#include "gauges.h"

/* A growing list of rows. */
typedef struct {
  PetscInt count, capacity;
  Column  *row;
} ColumnList;

/* A table of its own that a gauge fills. */
typedef struct {
  const char *file;
  PetscErrorCode (*columns)(Gauges gauges, const void *data, ColumnList *list); /* adds none: no table is written */
  PetscErrorCode (*rows)(Gauges gauges, void *data, PetscReal time, PetscInt *count, PetscReal **values);
  PetscBool events; /* it has rows at the times of the series, not of the snapshots */
} GaugeTable;

/* A kind of gauge: one file, and one line in gauges.c or in the record of an edge. Entries may be NULL. data: 'bytes'
   bytes of its own, zero at first. */
typedef struct GaugeKind {
  size_t           bytes;
  const OptionRow *options;                                                          /* read into the data */
  void (*defaults)(Gauges gauges, void *data);                                       /* before */
  PetscErrorCode (*more)(Gauges gauges, OptionItems PetscOptionsObject, void *data); /* reads what the table has not */
  PetscErrorCode (*check)(Gauges gauges, void *data); /* refuses bad values, after the block */
  PetscErrorCode (*columns)(Gauges gauges, const void *data, ColumnList *list);   /* adds its rows of the series */
  PetscErrorCode (*measure)(Gauges gauges, const void *data, PetscReal values[]); /* of the simulated part */
  PetscBool         needs_sums;          /* 'measure' reads fields that OperatorsMoments and TensionApply write */
  const GaugeTable *tables;              /* the last has no file */
  PetscErrorCode (*destroy)(void *data); /* what the data point to */
} GaugeKind;

/* ColumnAdd - adds a row; the name is printed by the format. ColumnAddVector - adds a row for each of the components
   first .. last of a vector, named "<name>_x" or "x" if the name is empty. ColumnAddFields - adds a row for each of n
   scalar fields. Not collective. */
PetscErrorCode ColumnAdd(ColumnList *list, Column row, const char format[], ...);
PetscErrorCode ColumnAddFields(ColumnList *list, Column row, PetscInt n, const FieldId fields[], const char prefix[]);
PetscErrorCode ColumnAddVector(ColumnList *list, Column row, PetscInt first, PetscInt last, const char name[]);

/* GaugesCloud - borrowed. GaugesRun - what GaugesSetRun told, or NULL. GaugeWallFace - the number of wall faces of the
   box, which are the first receivers of forces; direction and side are those of wall face 'index', if it exists.
   GaugesMultiplicity - -gauge_multiplicity. Not collective. */
Cloud     GaugesCloud(Gauges gauges);
void     *GaugesRun(Gauges gauges);
PetscReal GaugesMultiplicity(Gauges gauges);
PetscInt  GaugeWallFace(Domain domain, PetscInt index, PetscInt *direction, PetscInt *side);

/* GaugeReceivers - the number of walls and solids. GaugeReceiverName - "zmin" or the name of a solid. Not collective.
 */
PetscInt    GaugeReceivers(Gauges gauges);
const char *GaugeReceiverName(Gauges gauges, PetscInt receiver);

/* GaugeMirror - where a mirror of direction d doubles the liquid (m): the axis of rings; a symmetry face while *copies
   of -gauge_multiplicity are at least 2, and then *copies is halved. NAN: there is none. Not collective. */
PetscReal GaugeMirror(Domain domain, PetscInt d, PetscReal *copies);
/* GaugeWhole - what a piece is in the whole scene of -gauge_multiplicity if it touches the mirrors at its lower (-1) or
   upper (1) faces in 'mirror' (0: neither): a piece that touches one is connected with its image, so the whole piece is
   twice as large, its center (m) is on the mirror, where its velocity (m/s; NULL: not wanted) across is 0, and half as
   many of it are in the scene, *number. Without -gauge_multiplicity the image does not count. Returns how many times as
   large it is. Not collective. */
PetscReal GaugeWhole(Gauges gauges, const PetscReal mirror[DIM], PetscReal center[DIM], PetscReal velocity[DIM],
                     PetscReal *number);
#define ANY_BODY (-1)
/* ConnectedLargest - in [n_fluid of the cloud]: whether a particle is in the piece with the most liquid of a body
   (ANY_BODY: of all). Collective. */
PetscErrorCode ConnectedLargest(Gauges gauges, PetscInt body, PetscBool in[]);

#endif
