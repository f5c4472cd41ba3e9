/* Floor 0, which every file includes: PETSc and a shim for its versions, errors, options, log events, vectors. */
#ifndef ISPH_BASE_H
#define ISPH_BASE_H

#include <petsc.h>

#if PETSC_VERSION_LT(3, 19, 0)
  #define PETSC_SUCCESS 0
#endif

/* The type of PetscOptionsObject, for functions that read options inside a PetscOptionsBegin block. */
#if PETSC_VERSION_LT(3, 23, 0)
typedef PetscOptionItems *OptionItems;
#else
typedef PetscOptionItems OptionItems;
#endif

#define ISPH_VERSION "0.1.0"

/* Vectors have three components in two dimensions, too; the third is zero there. */
#define DIM 3

/* Marks a loop that the compiler must vectorise. A clause reduction(+ : s) lets it reorder the sum s. */
#define SIMD_LOOP(clauses) _Pragma_(omp simd clauses)
#define _Pragma_(text)     _Pragma(#text)

/* Log events and stages of -log_view: an event for each sub-step (drift to guard) and for each expensive part of one, a
   stage for each phase of the run. */
typedef enum {
  EVENT_DRIFT,
  EVENT_SEARCH,
  EVENT_FORCES,
  EVENT_DIVERGENCE,
  EVENT_PROJECT,
  EVENT_KICK,
  EVENT_SHIFT,
  EVENT_GUARD,
  EVENT_RESAMPLING,
  EVENT_HALO,
  EVENT_MIGRATE,
  EVENT_NEIGHBORS,
  EVENT_MOMENTS,
  EVENT_SURFACE,
  EVENT_VISCOSITY,
  EVENT_TENSION,
  EVENT_SOURCE,
  EVENT_ASSEMBLE,
  EVENT_SOLVE,
  EVENT_RESIDUAL,
  EVENT_GRADIENT,
  EVENT_PACKING,
  EVENT_OUTPUT,
  EVENT_GAUGES,
  EVENT_COUNT
} EventId;

typedef enum { STAGE_PACKING, STAGE_STEPS, STAGE_OUTPUT, STAGE_COUNT } StageId;

/* LogRegister - registers the events and stages, once; call it after PetscInitialize. Collective. */
PetscErrorCode LogRegister(void);
/* LogEvent, LogStage - the PETSc handles of an event or a stage. Not collective. */
PetscLogEvent LogEvent(EventId event);
PetscLogStage LogStage(StageId stage);
/* LogPairFlops - adds 'each' floating-point operations for each of n pairs to -log_view. Not collective. */
PetscErrorCode LogPairFlops(PetscInt64 n, PetscInt each);

static inline PetscReal Dot(const PetscReal a[DIM], const PetscReal b[DIM])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Cross - c = a x b. */
static inline void Cross(const PetscReal a[DIM], const PetscReal b[DIM], PetscReal c[DIM])
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

static inline PetscReal Norm(const PetscReal a[DIM])
{
  return PetscSqrtReal(Dot(a, a));
}

/* A grid of n[0] by n[1] by n[2] cells is numbered with x fastest. CellIndex - the number of cell (x, y, z).
   CellCoordinates - the inverse. CellNext - advances 'cell' within the block first[d] <= cell[d] <= last[d], which must
   not be empty; false after the last cell. A loop over a block:

     PetscInt cell[DIM] = {first[0], first[1], first[2]};

     do {
       const PetscInt index = CellIndex(n, cell[0], cell[1], cell[2]);
       ...
     } while (CellNext(first, last, cell)); */
static inline PetscInt CellIndex(const PetscInt n[DIM], PetscInt x, PetscInt y, PetscInt z)
{
  return (z * n[1] + y) * n[0] + x;
}

static inline void CellCoordinates(const PetscInt n[DIM], PetscInt index, PetscInt cell[DIM])
{
  cell[0] = index % n[0];
  cell[1] = index / n[0] % n[1];
  cell[2] = index / (n[0] * n[1]);
}

static inline PetscBool CellNext(const PetscInt first[DIM], const PetscInt last[DIM], PetscInt cell[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    if (cell[d]++ < last[d]) return PETSC_TRUE;
    cell[d] = first[d];
  }
  return PETSC_FALSE;
}

/* UserError - refuses bad input: prints one sentence (what is wrong, where, what is allowed) on standard error and
   returns an error code that makes main exit with a non-zero status. Every rank must call it with the same message.
   Collective. Use it as  PetscCheckUser(condition, comm, "format", ...). */
PetscErrorCode UserError(MPI_Comm comm, const char format[], ...);
#define PetscCheckUser(condition, comm, ...)                                                                           \
  do {                                                                                                                 \
    if (PetscUnlikely(!(condition))) return UserError(comm, __VA_ARGS__);                                              \
  } while (0)
/* UserErrorSaid - returns the code of UserError after another rank or function has printed the sentence. Not
   collective. */
PetscErrorCode UserErrorSaid(void);
/* The code that UserError returns. PetscCall hands it up without printing a stack trace. */
#define ISPH_USER_ERROR PETSC_ERR_USER_INPUT

/* Of a list of names, or a text of help. */
#define NAMES_LENGTH 1024
/* TextAppend - appends to a text as much as its room of 'size' bytes holds. PetscStrlcat of PETSc 3.18 writes beyond
   the room. Not collective. */
void TextAppend(char text[], size_t size, const char more[]);
/* VectorText - writes the first dim numbers of a vector, "1, 2"; returns the text. Not collective. */
#define VECTOR_TEXT 64
const char *VectorText(PetscInt dim, const PetscReal x[], char text[VECTOR_TEXT]);
/* AxesText - the same of what belongs to the axes of a rotation: in a plane the one across it. Not collective. */
const char *AxesText(PetscInt dim, const PetscReal x[DIM], char text[VECTOR_TEXT]);

/* UserErrorHandlerPush - pushes a PETSc error handler (pop it with PetscPopErrorHandler). The handler is silent while
   the code of a UserError travels up through PetscCall. For any other error it collects PETSc's message and the calls,
   which ErrorFinish prints as one sentence. An option value that PETSc cannot read gives one sentence, too, with the
   option. Call once, before PetscInitialize, which reads options files. PETSc aborts when a PetscCall in main itself
   fails: let main call one function and pass its code to ErrorFinish. Not collective. */
PetscErrorCode UserErrorHandlerPush(void);
/* UserErrorHandlerFirst - after PetscInitialize: with -on_error_abort and its like, which act on errors, pushes the
   handler again, so that they do not act on a UserError. Not collective. */
PetscErrorCode UserErrorHandlerFirst(void);

/* ErrorsKeep - from 'true' to 'false' errors return their code and print nothing, for a program that asks for the
   sentence: pushes the error handler, and pops it. ErrorSentence - the sentence of the last error since 'true', on rank
   0 at least; "" without one. Not collective. */
PetscErrorCode ErrorsKeep(PetscBool keep);
const char    *ErrorSentence(void);
/* UserErrorsMute - stops (true) or resumes (false) the printing of user errors: a trial of the program's own must not
   print any. Not collective. */
void UserErrorsMute(PetscBool mute);
/* ErrorsCapture - from 'true' to 'false' errors that start in PETSc are stored instead of printed; needs
   UserErrorHandlerPush. CapturedError - the first line of the last stored error; "" if there is none. Not
   collective. */
void        ErrorsCapture(PetscBool capture);
const char *CapturedError(void);

/* ErrorFinish - main's last call before it ends MPI. With an error, rank 0 prints the sentence unless it is printed
   already, and the ranks that do not come to this call in time are aborted, since they wait for the failed rank.
   Returns the exit code. Collective. */
int ErrorFinish(PetscErrorCode code);
/* RanksMeet - finds out whether ranks failed alone. *first: the lowest rank that calls with 'failed', or the number of
   ranks if none does. *all: whether all ranks have called within PATIENCE seconds; a rank that did not fail waits
   without limit. 'meeting': a communicator for this alone, since a stuck rank may be within another message.
   Collective over the ranks that are not stuck. */
PetscErrorCode RanksMeet(MPI_Comm meeting, PetscBool failed, PetscMPIInt *first, PetscMPIInt *all);

/* ProgramStart - main's first call. It starts the program's clock, opens /dev/null for each closed standard stream, and
   lets Open MPI's ranks yield if there are more of them than processors. Freed arrays of many megabytes leave the
   process.
   From then on the signals HUP, INT, QUIT, PIPE, TERM, USR1 and XCPU are recorded instead of ending the program. A
   second signal of the same kind, SIGNAL_AGAIN or more later (s), ends the program at once: a closed window and
   timeout(1) send two. A signal that was ignored at the start stays ignored.
   InterruptBlock - blocks these signals until InterruptWatch records them again: PetscInitialize sets handlers of its
   own in between. Not collective. */
#define SIGNAL_AGAIN 0.5
void ProgramStart(void);
void InterruptBlock(void);
void InterruptWatch(void);
/* DisplaysIgnore - call it before MPI_Init. Open MPI's look at the machine (hwloc) asks the X servers 0 to 9 for
   graphics cards, and a server that ends meanwhile ends the program. HWLOC_COMPONENTS of the user's stays. Not
   collective. */
void DisplaysIgnore(void);
/* ProgramSeconds - wall-clock time since ProgramStart (s). Not collective. */
double ProgramSeconds(void);
/* ProcessorsCrowded - whether this host's ranks, of several, and the programs that ran before the start are more than
   its processors. *load: those programs, a mean of a minute. Not collective. */
PetscBool ProcessorsCrowded(double *load, int *processors);
/* RanksLaunch - with -ranks N, N > 1, on the command line runs the program by mpiexec on N processes, to which it
   passes on the signals that end a run, and returns the exit code; otherwise, and in a process of mpiexec, -1. Call it
   after ProgramStart, before MPI_Init. Not collective. */
#define RANKS_OPTION "-ranks"
int RanksLaunch(int argc, char *argv[]);
/* InterruptLimit - sets the wall-clock limit of the run (s); 0: none. InterruptCheck - *reason: why the run should end
   now, or NULL; the same on every rank. *wanted becomes the logical or of its values on all ranks (may be NULL). A
   signal that no check follows for half a second is confirmed on standard error. InterruptCheck is collective.
   InterruptPatience - mpiexec leaves the run its time after a signal: -ranks has started it. InterruptStopFile - the
   run ends when a file of this name appears; one that is there is removed first. */
void           InterruptLimit(double seconds);
void           InterruptPatience(void);
void           InterruptStopFile(const char path[]);
PetscErrorCode InterruptCheck(MPI_Comm comm, PetscBool *wanted, const char **reason);
/* InterruptSilence - sets the time without a sign of life (s) after which rank 0 says so in one sentence and exits,
   which makes mpiexec end the run; 0: never. InterruptAlive - a sign of life; doing: what begins now, borrowed, or
   NULL. A step, ProgressBegin and InterruptCheck give one; call it in whatever else may take rank 0 minutes.
   InterruptCheckpoint - names the last complete checkpoint for that sentence. Not collective. */
void InterruptSilence(double seconds);
void InterruptAlive(const char doing[]);
void InterruptCheckpoint(const char path[]);

/* ListGrow - makes room for one more entry of 'bytes' behind the 'count' entries of *list (its address is given; free
   it with PetscFree). Not collective. */
PetscErrorCode ListGrow(PetscInt count, PetscInt *capacity, size_t bytes, void *list);

/* GatherAll - all: the address of an array (free it with PetscFree) that gets the n numbers 'own' of each rank, in the
   order of the ranks; *total: how many. GatherTo - the same, or unless 'every' on rank 0 alone: none elsewhere.
   Collective. */
PetscErrorCode GatherTo(MPI_Comm comm, PetscBool every, PetscInt n, const void *own, MPI_Datatype type, PetscInt *total,
                        void *all);
PetscErrorCode GatherAll(MPI_Comm comm, PetscInt n, const void *own, MPI_Datatype type, PetscInt *total, void *all);
/* FormatDuration - "2 h 05 min", "3 min 20 s" or "12 s". Not collective. */
PetscErrorCode FormatDuration(double seconds, char text[], size_t length);
/* ProgressInterval - sets the time between lines of progress (s); 0: no lines. ProgressBegin - starts work that may
   take long; outcome: the end of the sentence that is printed if the run is interrupted during this work. Both texts
   are borrowed. Not collective.
   ProgressWork - call it repeatedly during the work. It prints a line when one is due; share: of the work that is done
   (negative: unknown). It raises a UserError after a signal or at the wall-clock limit. Collective on comm;
   PETSC_COMM_SELF for work of one rank. */
void           ProgressInterval(double seconds);
void           ProgressBegin(const char what[], const char outcome[]);
PetscErrorCode ProgressWork(MPI_Comm comm, PetscReal share, const char format[], ...);
/* ProgressDue - whether a line is due; last: always due. ProgressPrint - prints the line. ProgressWork calls both.
   Collective. */
PetscErrorCode ProgressDue(MPI_Comm comm, PetscBool last, PetscBool *due);
PetscErrorCode ProgressPrint(MPI_Comm comm, PetscReal share, const char format[], ...);

/* PrinterStart - makes this program's function print for PETSc. It ends a line of progress before any other text. When
   standard output fails (a closed pipe, a full disk), it says so once on standard error and drops further output.
   PrinterQuiet - from 'true' to 'false' PETSc's prints go into the journal alone.
   PrinterLost - whether standard output has failed. PrinterBreak - ends a line of progress. Not collective. */
void      PrinterStart(void);
void      PrinterBreak(void);
void      PrinterQuiet(PetscBool quiet);
PetscBool PrinterLost(void);

/* JournalOpen - opens the journal of a run on rank 0. The file receives what the program has printed since its start,
   further output and the sentence of a UserError, but no line of progress that a terminal overwrites. JournalClose -
   closes the file. Collective. JournalText - adds a text; before JournalOpen the text is buffered. JournalFile - the
   descriptor of the open file, or -1. Not collective. */
PetscErrorCode JournalOpen(MPI_Comm comm, const char path[]);
PetscErrorCode JournalClose(void);
void           JournalText(const char text[]);
int            JournalFile(void);

/* CommandLineCheck - call it between MPI_Init and PetscInitialize. It inserts -options_file before each name that comes
   before the first option, and replaces -h and --help by -help (argc and argv change). It answers -version and
   --version and then sets *stop. It refuses (UserError) an argument that is neither an option nor the value of one, and
   an options file, named here, in PETSC_OPTIONS or in .petscrc, that includes itself or is not a regular file.
   Collective. */
PetscErrorCode CommandLineCheck(MPI_Comm comm, int *argc, char ***argv, PetscBool *stop);
/* OptionsFileFind - a relative path at which there is no file becomes that of a file in the folder of an options file,
   the last one first. path: the same on all ranks. Collective. */
PetscErrorCode OptionsFileFind(MPI_Comm comm, char path[PETSC_MAX_PATH_LEN]);
/* WordsSplit - the words of a text as a vector of arguments behind the name of a program; words are split at blanks
   outside quotation marks. Free word[0] with free, then 'word': the texts are one. Returns their number, 0 without
   memory. Not collective. */
int WordsSplit(const char text[], char ***word);

/* UnitsConvert - writes numbers that may have units behind them, "1.5 mm,0", as the numbers in the unit of their row,
   "1.5e-3,0". In a list the last unit is that of all numbers without one, and 0 needs none. False: it is not that, or
   longer than 'size'. *any: whether there were units; without them 'text' stays empty. UnitsList - appends ", " and
   each unit that is allowed besides that of a row. UnitIs - whether a text is a unit of any row. Not collective. */
PetscBool UnitsConvert(const char unit[], const char given[], char text[], size_t size, PetscBool *any);
void      UnitsList(const char unit[], char text[], size_t size);
PetscBool UnitIs(const char text[]);

/* WordDistance - Damerau-Levenshtein distance of two words (optimal string alignment): the number of letters to insert,
   delete, replace or swap with the next one. Only the first 128 letters of b count. WordsAlike - the distance up to
   which a misspelt name is taken for this one. OptionMeant - " (is -nmae meant for it?)" if an option that nothing has
   read yet is like this one; else "". Not collective. */
PetscInt    WordDistance(const char a[], const char b[]);
PetscInt    WordsAlike(const char name[]);
const char *OptionMeant(const char option[]);

/* A formula, as what a stack does. FormulaRead - reads one until a comma or the end: numbers, pi, the variables that
   'names' has a letter for, + - * / ^, parentheses, sin, cos, tan, exp, log, sqrt, tanh, atan, abs, step (1 above 0,
   else 0). *text moves behind it, or to what cannot be read, where it returns false. FormulaValue - its value; x: the
   variables in the order of 'names'. Not collective. */
#define FORMULA_MOST 200
typedef struct {
  char      what;
  int       index;
  PetscReal value;
} FormulaPart;
typedef struct {
  PetscInt    count;
  FormulaPart part[FORMULA_MOST];
} Formula;
PetscBool FormulaRead(const char **text, const char names[], Formula *formula);
PetscReal FormulaValue(const Formula *formula, const PetscReal x[]);

/* SplitMix64 - a 64-bit hash: the output function of the generator SplitMix64 (Steele, Lea and Flood 2014). Not
   collective. */
static inline unsigned long long SplitMix64(unsigned long long z)
{
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

/* HashBytes - the hash FNV-1a of 64 bits (Fowler, Noll, Vo; http://www.isthe.com/chongo/tech/comp/fnv), continued with
   so many bytes; it begins with HASH_START. Not collective. */
#define HASH_START 0xCBF29CE484222325ULL
static inline unsigned long long HashBytes(unsigned long long hash, const void *data, size_t size)
{
  const unsigned char *bytes = (const unsigned char *)data;

  for (size_t k = 0; k < size; k++) hash = (hash ^ bytes[k]) * 0x100000001B3ULL;
  return hash;
}

/* RandomUnit - a uniform random number in [0,1) from a seed and a counter, independent of the number of ranks. Not
   collective. */
static inline PetscReal RandomUnit(unsigned long long seed, unsigned long long counter)
{
  const unsigned long long z = SplitMix64(seed * 0x9E3779B97F4A7C15ULL + (counter + 1) * 0xD1B54A32D192ED03ULL);

  return (PetscReal)(z >> 11) * (1.0 / 9007199254740992.0);
}

#include "option_rows.h"

#endif
