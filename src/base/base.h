/* Floor 0: what every file includes. PETSc, the version shim, log events and small vector helpers. */
#ifndef ISPH_BASE_H
#define ISPH_BASE_H

#include <petsc.h>

#if PETSC_VERSION_LT(3, 19, 0)
  #define PETSC_SUCCESS 0
#endif

/* What PetscOptionsBegin opens and functions that read options inside a block take. */
#if PETSC_VERSION_LT(3, 23, 0)
typedef PetscOptionItems *OptionItems;
#else
typedef PetscOptionItems OptionItems;
#endif

#define ISPH_VERSION "0.1.0"

/* Vectors are stored with three components in two dimensions too; the third is then zero. */
#define DIM 3

/* The loops the compiler must vectorise carry this mark; it allows the reordering of the sums named in it. */
#define SIMD_LOOP(clauses) _Pragma_(omp simd clauses)
#define _Pragma_(text)     _Pragma(#text)

/* One log event a sub-step (drift to guard) and one each part of it that takes time, one stage a phase of the run:
 * -log_view shows them. */
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

/* LogRegister - registers events and stages. Collective; call once after PetscInitialize. */
PetscErrorCode LogRegister(void);
/* LogEvent, LogStage - the PETSc handles of an event or a stage. Not collective. */
PetscLogEvent LogEvent(EventId event);
PetscLogStage LogStage(StageId stage);
/* LogPairFlops - counts 'each' operations for each of n pairs in -log_view. Not collective. */
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

/* Cells of a box, n[0] by n[1] by n[2] of them, are numbered with x fastest. CellIndex - the number of cell (x, y, z).
   CellCoordinates - the cell of a number. CellNext - takes cell on to the next one of the block first[d] <= cell[d] <=
   last[d], which must not be empty; false after the last. A loop over a block:

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

/* UserError - the one way to refuse bad input: one sentence (what, where, what is allowed) on standard error and a
   non-zero exit of all ranks through main's return. Collective in effect: every rank must reach it with the same
   message (options are the same on every rank). Use as  PetscCheckUser(condition, comm, "format", ...). */
PetscErrorCode UserError(MPI_Comm comm, const char format[], ...);
#define PetscCheckUser(condition, comm, ...)                                                                           \
  do {                                                                                                                 \
    if (PetscUnlikely(!(condition))) return UserError(comm, __VA_ARGS__);                                              \
  } while (0)
/* UserErrorSaid - the code of UserError where the sentence has been said already. Not collective. */
PetscErrorCode UserErrorSaid(void);
/* The code UserError returns: it travels up through PetscCallUser/PetscCall without a stack trace being printed. */
#define ISPH_USER_ERROR PETSC_ERR_USER_INPUT

/* ListNames - the registered names, for such a sentence: "a, b, c". Not collective. */
#define NAMES_LENGTH 1024
PetscErrorCode ListNames(PetscFunctionList list, char names[NAMES_LENGTH]);

/* UserErrorHandlerPush - pushes a PETSc error handler (pop it with PetscPopErrorHandler) that stays silent while the
   code of a UserError travels up through PetscCall, and hands every other error to PETSc's traceback. PETSc aborts
   when a PetscCall in main itself fails: let main call one function, test its code without PetscCall, finalize and
   return it. Values of options that PETSc itself cannot read become one sentence too, with the option. Not collective;
   call once, before PetscInitialize if a missing options file shall be refused as politely. */
PetscErrorCode UserErrorHandlerPush(void);

/* UserErrorsHold - from 'true' to 'false' user errors are not printed: what the caller tries, nobody has asked for. Not
   collective. */
void UserErrorsHold(PetscBool hold);
/* ErrorsKeep - from 'true' to 'false' errors that start in PETSc are not printed; under UserErrorHandlerPush. ErrorKept
   - the first line of the last one, or "" if there was none or a sentence has been said. Not collective. */
void        ErrorsKeep(PetscBool keep);
const char *ErrorKept(void);

/* ErrorFarewell - says what has not been said yet of an error that has come up to main, on rank 0, and ends the other
   ranks if they have not come to the same error: they wait for this one. Returns the exit code. For main, at its end,
   while MPI is there. */
int ErrorFarewell(PetscErrorCode code);
/* RanksMeet - for ranks that may have failed alone: *first: the lowest rank that calls with 'failed', or their number
   if none does; *all: whether all ranks came within PATIENCE seconds. Ranks that did not fail wait for all. 'meeting':
   a communicator for this alone, since stuck ranks are in the midst of other messages. Collective in effect. */
PetscErrorCode RanksMeet(MPI_Comm meeting, PetscBool failed, PetscMPIInt *first, PetscMPIInt *all);

/* ProgramStart - starts the program's clock, keeps file numbers of closed standard streams taken, and notes from now on
   the signals that end a program (HUP, INT, QUIT, PIPE, TERM, USR1, XCPU) instead of obeying; one that is ignored stays
   so, and a second one of a kind ends the program at once. First in main. InterruptHold - keeps them back until
   InterruptWatch, which notes them again: around PetscInitialize, which sets handlers of its own. Not collective. */
void ProgramStart(void);
void InterruptHold(void);
void InterruptWatch(void);
/* ProgramSeconds - since ProgramStart (s, wall clock). Not collective. */
double ProgramSeconds(void);
/* InterruptLimit - the program shall end after so many seconds; 0: no such limit. InterruptCheck - *reason: why it
   should end now, or NULL; the same on every rank. *wanted: whether this rank wants something, becomes whether any rank
   does (NULL: nobody asks). Where it is called rarely, a signal is confirmed on standard error when it comes.
   Collective. */
void           InterruptLimit(double seconds);
PetscErrorCode InterruptCheck(MPI_Comm comm, PetscBool *wanted, const char **reason);

/* FormatDuration - "2 h 05 min", "3 min 20 s" or "12 s". Not collective. */
PetscErrorCode FormatDuration(double seconds, char text[], size_t length);
/* ProgressInterval - the time between lines of progress (s); 0: none. ProgressBegin - work that may take long begins;
   left: what there is of the run if it is ended here, a part of a sentence. Texts are borrowed. Not collective.
   ProgressWork - again and again during the work: prints a line, when one is due, with the share of the work that is
   done (negative: unknown), and refuses (UserError) to go on when a signal or the limit says so.
   Collective; work of one rank alone takes PETSC_COMM_SELF. */
void           ProgressInterval(double seconds);
void           ProgressBegin(const char what[], const char left[]);
PetscErrorCode ProgressWork(MPI_Comm comm, PetscReal share, const char format[], ...);
/* ProgressDue - whether to print a line now; ProgressPrint - prints it. What ProgressWork is made of. Collective. */
PetscErrorCode ProgressDue(MPI_Comm comm, PetscBool last, PetscBool *due);
PetscErrorCode ProgressPrint(MPI_Comm comm, PetscReal share, const char format[], ...);

/* PrinterStart - a print after a line that the next one would overwrite begins a new line; and what is printed from
   here on never fails: when standard output is gone (a closed pipe, a full disk), a line on standard error says so
   once, and the rest is dropped. PrinterLost - whether that is so. PrinterBreak - ends a line that may be overwritten.
   Not collective. */
void      PrinterStart(void);
void      PrinterBreak(void);
PetscBool PrinterLost(void);

/* JournalOpen - all that is printed on standard output, from the start of the program on, and the sentence of a
   UserError is added to the file as well (rank 0), without lines that a terminal overwrites. JournalClose - ends that.
   JournalText - adds a text, also one for a journal that is not open yet. Collective, but for JournalText. */
PetscErrorCode JournalOpen(MPI_Comm comm, const char path[]);
PetscErrorCode JournalClose(void);
void           JournalText(const char text[]);

/* CommandLineCheck - refuses (UserError) options files on the command line, in PETSC_OPTIONS or .petscrc that include
   themselves, or are not regular files, and an argument that is neither an option nor its value; makes -h and --help
   PETSc's -help, and of names before the first option options files (argc and argv change). Answers -version
   and --version, which sets *stop. Collective; after MPI_Init and before PetscInitialize. */
PetscErrorCode CommandLineCheck(MPI_Comm comm, int *argc, char ***argv, PetscBool *stop);

/* HelpWanted - whether -help is given without -dump_options: then the options of all types are listed, also of those
   that the scene does not choose, and the program stops. Not collective. */
#define DUMP_OPTION "-dump_options"
PetscBool HelpWanted(void);

/* ReadTypeOptions - calls the reader with the chosen one of the registered types; with HelpWanted before that with
   every type, so that -help lists the options of them all. The reader makes the object one of that type and reads the
   type's options in a block whose title names the type; PETSc prints a block of the same title once. Collective. */
typedef PetscErrorCode (*TypeReader)(void *object, const char type[]);
PetscErrorCode ReadTypeOptions(PetscFunctionList list, const char chosen[], TypeReader reader, void *object);

/* OptionReal, OptionInt - a number inside a PetscOptionsBegin block, refused (UserError) if given outside an interval,
   which is text: "[0, 1)", "(0, inf)". The interval is part of what -help says. Collective. */
#define OptionReal(name, text, interval, value)                                                                        \
  OptionReadReal(PetscOptionsObject, name, text, interval, __func__, value)
#define OptionInt(name, text, interval, value) OptionReadInt(PetscOptionsObject, name, text, interval, __func__, value)
PetscErrorCode OptionReadReal(OptionItems PetscOptionsObject, const char name[], const char text[],
                              const char interval[], const char function[], PetscReal *value);
PetscErrorCode OptionReadInt(OptionItems PetscOptionsObject, const char name[], const char text[],
                             const char interval[], const char function[], PetscInt *value);

/* WordDistance - letters to be added, left out, replaced or swapped with the next that make one word of the other; of b
   128 letters count. WordsAlike - the distance up to which another name is likely to be meant by this one. OptionMeant
   - " (is -nmae meant for it?)" if the database has an option, not read yet, that is like this one, or "". Not
   collective. */
PetscInt    WordDistance(const char a[], const char b[]);
PetscInt    WordsAlike(const char name[]);
const char *OptionMeant(const char option[]);

/* SplitMix64 - a 64-bit hash of a number: the output function of the generator of that name (Steele, Lea and Flood
   2014). Not collective. */
static inline unsigned long long SplitMix64(unsigned long long z)
{
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

/* RandomUnit - a uniform number in [0,1) from a seed and a counter: the same on any number of ranks. Not collective. */
static inline PetscReal RandomUnit(unsigned long long seed, unsigned long long counter)
{
  const unsigned long long z = SplitMix64(seed * 0x9E3779B97F4A7C15ULL + (counter + 1) * 0xD1B54A32D192ED03ULL);

  return (PetscReal)(z >> 11) * (1.0 / 9007199254740992.0);
}

#endif
