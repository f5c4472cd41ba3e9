/* libisph: incompressible smoothed particle hydrodynamics as a library. The program isph is a client of it; so are
   programs in other languages: the types are plain C. options/library.md has an example.

   A run is made from options, as the command line of the program has them, and makes steps; between them the fields of
   the particles and the columns of the series can be read. Units are SI. A process has one run at a time.

   Each function that returns an int returns 0, or the code of an error; IsphError then has a sentence for the user, and
   of the run only IsphDestroy may be called. Functions are collective, with the same arguments on every process, unless
   they say that they are not. A run prints nothing; with -output_dir it writes a run folder, else no file. */
#ifndef ISPH_H
#define ISPH_H

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
  #define ISPH_PUBLIC __attribute__((visibility("default")))
#else
  #define ISPH_PUBLIC
#endif

typedef struct _p_Isph *Isph;

/* IsphCreate - a run of options in one text, "cases/couette/case.opts -spacing 0.01". Words are split at blanks outside
   quotation marks; names that come first are files of options. options = NULL: those of PETSc's database. comm: the
   processes, as MPI_Comm_c2f(comm) and mpi4py's comm.py2f() give them, or ISPH_WORLD, all processes. Starts MPI and
   PETSc if nobody has; PETSc, once started on some processes, allows no others. */
#define ISPH_WORLD (-1)
ISPH_PUBLIC int IsphCreate(const char options[], int comm, Isph *run);
/* IsphSetUp - makes the particles, or reads them from -restart. */
ISPH_PUBLIC int IsphSetUp(Isph run);
/* IsphStep - a step, at most to the time 'end' (s), then the callback; refused at the end of the run. IsphRun - steps
   to the time 'end', then what the program does at its end: the last line of the series, snapshot and checkpoint. Both
   end at -time_end and after -steps_max steps, too. INFINITY: no other end. */
ISPH_PUBLIC int IsphStep(Isph run, double end);
ISPH_PUBLIC int IsphRun(Isph run, double end);
/* IsphEnded - whether the run is at -time_end, has made -steps_max steps, or a signal or -wall_clock_limit ends it. Not
   collective. */
ISPH_PUBLIC int IsphEnded(Isph run);
/* IsphSetCallback - 'after' is called after each step; if it returns another number than 0, IsphStep and IsphRun return
   this number. It may read fields and columns. NULL: none. Not collective. */
typedef int (*IsphCallback)(void *context, Isph run);
ISPH_PUBLIC int IsphSetCallback(Isph run, IsphCallback after, void *context);
/* IsphCheckpoint - writes a checkpoint into the run folder; needs -output_dir. */
ISPH_PUBLIC int IsphCheckpoint(Isph run);
/* IsphDestroy - *run becomes NULL; refused in a callback of the run. IsphFinalize - ends PETSc and MPI if IsphCreate
   has started them; after it there can be no run in the process. */
ISPH_PUBLIC int IsphDestroy(Isph *run);
ISPH_PUBLIC int IsphFinalize(void);

/* IsphError - the sentence of the last error, on process 0 at least; "": there was none. Lasts until the next call. Not
   collective. */
ISPH_PUBLIC const char *IsphError(void);
/* IsphVersion - "0.1.0". Not collective. */
ISPH_PUBLIC const char *IsphVersion(void);

/* IsphTime, IsphTimeStep - the time and the size of the last step (s). IsphSteps - steps so far, those before a restart
   included. NAN, NAN and 0 without a run, which IsphEnded calls ended. Not collective. */
ISPH_PUBLIC double IsphTime(Isph run);
ISPH_PUBLIC double IsphTimeStep(Isph run);
ISPH_PUBLIC long   IsphSteps(Isph run);

/* An array of numbers of the particles of this process, not a copy: [count][components], each number of so many bytes,
   double or (integer) int in an ordinary PETSc. It lasts until the next step, after which particles stand in another
   order: "id" tells them apart. */
typedef struct {
  const void *data;
  long        count;
  int         components, bytes, integer;
  const char *unit; /* "m/s"; "1": a pure number */
} IsphArray;

/* IsphField - a field by its name: position, velocity, pressure, density, lambda, id, body, layer (0: liquid; others
   are particles of walls), parent, surface, and where the run has them volume, size, viscosity, colour,
   line_capillary_number. IsphFieldName - name k of those that the run has; NULL: there are only k. Not collective. */
ISPH_PUBLIC int         IsphField(Isph run, const char name[], IsphArray *array);
ISPH_PUBLIC const char *IsphFieldName(Isph run, int k);
/* IsphSetField - gives the liquid of this process other positions (m) or velocities (m/s) before the next step: name is
   "position" or "velocity", values as in its array, [count][3]; rows of walls are not read. Energy that the liquid gets
   so is in the column outside_work. Refuses what is no number and places outside of the box. Arrays of fields end. */
ISPH_PUBLIC int IsphSetField(Isph run, const char name[], const double values[]);
/* IsphColumn - a column of the series now, by its name in series.csv, with or without the unit ("kinetic_energy_J");
   gauges add columns. NAN: it has no value now. IsphColumnName, not collective - the name of column k with its unit;
   NULL: there are only k. */
ISPH_PUBLIC int         IsphColumn(Isph run, const char name[], double *value);
ISPH_PUBLIC const char *IsphColumnName(Isph run, int k);
/* IsphScene - scene.json as a text on process 0 ("" on others), see options/scene_json.md. It lasts until the next
   IsphScene or IsphDestroy. */
ISPH_PUBLIC int IsphScene(Isph run, const char **json);

/* IsphMain - the program isph. Returns its exit code. */
ISPH_PUBLIC int IsphMain(int argc, char *argv[]);

#ifdef __cplusplus
}
#endif

#endif
