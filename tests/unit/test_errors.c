/* How the program says what went wrong, and what it prints. 'test_errors alone' on two ranks is the fault of one of
   them, for tests/faults/signals.py. */
#include "refuse.h"
#include <signal.h>

static PetscErrorCode Fails(void)
{
  PetscFunctionBegin;
  PetscCheck(PETSC_FALSE, PETSC_COMM_SELF, PETSC_ERR_PLIB, "seven\nand more");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Calls(PetscMPIInt failing)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == failing) PetscCall(Fails());
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD)); /* without end where one rank has failed */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A print into what cannot be written is no error, and what follows is dropped. */
static PetscErrorCode TestPrinter(void)
{
  const int out = dup(STDOUT_FILENO);

  PetscFunctionBegin;
  PrinterStart();
  CHECK(!PrinterLost(), "standard output is there");
  fflush(stdout);
  CHECK(freopen("/dev/full", "w", stdout) != NULL, "a full device");
  RefuseBegin();
  PetscCall(PetscPrintf(PETSC_COMM_SELF, "nobody reads this %g\n", 1.));
  PetscCall(PetscViewerASCIIPrintf(PETSC_VIEWER_STDOUT_SELF, "nor that\n"));
  fflush(stderr);
  (void)dup2(refuse_stderr, STDERR_FILENO);
  (void)dup2(out, STDOUT_FILENO);
  CHECK(PrinterLost(), "standard output is lost and the program goes on");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestDuration(void)
{
  const double      seconds[] = {0, 59.6, 61, 3600, 7261};
  const char *const texts[]   = {"0 s", "1 min 00 s", "1 min 01 s", "1 h 00 min", "2 h 01 min"};
  char              text[64];
  PetscBool         same, all = PETSC_TRUE;

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(seconds); k++) {
    PetscCall(FormatDuration(seconds[k], text, sizeof(text)));
    PetscCall(PetscStrcmp(text, texts[k], &same));
    all = (PetscBool)(all && same);
  }
  CHECK(all, "durations");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Signals are noted by name, and so is the clock. */
static PetscErrorCode TestInterrupts(void)
{
  const char    *reason;
  PetscErrorCode code;
  PetscBool      same;

  PetscFunctionBegin;
  PetscCall(InterruptCheck(PETSC_COMM_WORLD, NULL, &reason));
  CHECK(!reason, "nothing asks for the end");
  InterruptLimit(1e-9);
  PetscCall(InterruptCheck(PETSC_COMM_WORLD, NULL, &reason));
  PetscCall(PetscStrcmp(reason, "-wall_clock_limit", &same));
  CHECK(same, "the clock asks for the end");
  InterruptLimit(0);
  (void)raise(SIGHUP);
  PetscCall(InterruptCheck(PETSC_COMM_WORLD, NULL, &reason));
  PetscCall(PetscStrcmp(reason, "SIGHUP", &same));
  CHECK(same, "a signal asks for the end");
  ProgressBegin("this test", "all of it is left");
  RefuseBegin();
  code = ProgressWork(PETSC_COMM_WORLD, 0.5, "half of it");
  RefuseEnd(code, "ended by SIGHUP during this test: all of it is left", "work ends at a signal");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a unit is worth in SI by its letters: factors behind a blank or a slash, each a prefix, a name and a power. */
static double Worth(const char unit[])
{
  static const struct {
    const char *name;
    double      value;
  } bases[]    = {{"degrees", PETSC_PI / 180},
                  {"rad", 1},
                  {"rpm", PETSC_PI / 30},
                  {"deg", PETSC_PI / 180},
                  {"min", 60},
                  {"bar", 1e5},
                  {"dyn", 1e-5},
                  {"Pa", 1},
                  {"Hz", 1},
                  {"P", 0.1},
                  {"N", 1},
                  {"m", 1},
                  {"s", 1},
                  {"h", 3600},
                  {"g", 1e-3},
                  {"1", 1}},
    prefixes[] = {{"", 1}, {"n", 1e-9}, {"u", 1e-6}, {"m", 1e-3}, {"c", 1e-2}, {"h", 1e2}, {"k", 1e3}, {"M", 1e6}};
  double value = 1;

  for (const char *part = unit, *end; *part; part = end) {
    const double below = part > unit && part[-1] == '/' ? -1 : 1;
    double       worth = NAN;
    size_t       letters;

    end     = part + strcspn(part, " /");
    letters = strcspn(part, " /23");
    for (size_t p = 0; p < PETSC_STATIC_ARRAY_LENGTH(prefixes) && worth != worth; p++)
      for (size_t b = 0; b < PETSC_STATIC_ARRAY_LENGTH(bases); b++) {
        const size_t first = strlen(prefixes[p].name);

        if (letters == first + strlen(bases[b].name) && !strncmp(part, prefixes[p].name, first) &&
            !strncmp(part + first, bases[b].name, letters - first))
          worth = prefixes[p].value * bases[b].value;
      }
    value *= pow(worth, below * (part + letters < end ? part[letters] - '0' : 1));
    if (*end) end++;
  }
  return value;
}

/* Each word of each unit is worth what its letters say. */
static PetscErrorCode TestWords(void)
{
  static const char *const units[] = {"m",       "s",   "m/s",  "m/s2", "1/s", "Hz",    "rad/s",
                                      "degrees", "N/m", "Pa s", "Pa",   "kg",  "kg/m3", "kg m2"};
  int                      words   = 0;

  PetscFunctionBegin;
  for (size_t u = 0; u < PETSC_STATIC_ARRAY_LENGTH(units); u++) {
    char list[256] = "", number[64], text[64];

    UnitsList(units[u], list, sizeof(list));
    for (char *word = strtok(list, ","); word; word = strtok(NULL, ","), words++) {
      const double wanted = Worth(word + 1) / Worth(units[u]);
      PetscBool    any;

      (void)snprintf(number, sizeof(number), "1%s", word);
      CHECK(UnitsConvert(units[u], number, text, sizeof(text), &any), word + 1);
      CHECK_CLOSE(strtod(text, NULL), wanted, 1e-14 * wanted, word + 1);
    }
  }
  CHECK(words == 35, "no word is without a unit here");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A power of ten changes the exponent alone; a list has the unit of its last number. */
static PetscErrorCode TestUnits(void)
{
  static const char *const cases[][3] = {
    {"m", "0.1mm", "0.1e-3"},   {"m", "-1.5e2 cm", "-1.5e0"},   {"m", "1,2um", "1e-6,2e-6"},
    {"m", "5 mm, 0", "5e-3,0"}, {"m", "1cm,2nm,3", NULL},       {"m", "1m,2,3mm", "1,2e-3,3e-3"},
    {"m", "3cP", NULL},         {"m", "1 mm mm", NULL},         {"m", "mm", NULL},
    {"m", "0x10mm", NULL},      {"m", "infmm", NULL},           {"m", "1e4294967296mm", NULL},
    {"s", "2min", "120"},       {"Pa s", "3mPas", "3e-3"},      {"Pa s", "3 mPa s", "3e-3"},
    {"Pa s", "3mPa.s", "3e-3"}, {"Pa s", "3 Pa s", "3"},        {"degrees", "40deg", "40"},
    {"m/s", "-36 km/h", "-10"}, {"kg/m3", "0.9g/cm3", "0.9e3"}, {"spacings", "1mm", NULL},
  };
  char      text[64];
  PetscBool any, good, same;

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(cases); k++) {
    good = UnitsConvert(cases[k][0], cases[k][1], text, sizeof(text), &any);
    PetscCall(PetscStrcmp(text, cases[k][2] ? cases[k][2] : text, &same));
    CHECK(good == (PetscBool)(cases[k][2] != NULL) && same && (!good || any), cases[k][1]);
  }
  good = UnitsConvert("m", "1e-3,2", text, sizeof(text), &any);
  CHECK(good && !any && !text[0], "numbers without units");
  CHECK(!UnitsConvert("m", "1mm,2mm,3mm,4mm", text, 16, &any), "no room");
  CHECK(UnitsConvert("rad/s", "60rpm", text, sizeof(text), &any) && any, "a factor");
  CHECK_CLOSE(strtod(text, NULL), 2 * PETSC_PI, 1e-15, "turns");
  CHECK(UnitIs("mm") && UnitIs("kg m2") && !UnitIs("my.opts"), "what is a unit");
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscErrorCode  code  = PETSC_SUCCESS;
  const PetscBool alone = (PetscBool)(argc > 1 && !strcmp(argv[1], "alone"));

  (void)signal(SIGHUP, SIG_DFL); /* nohup ignores it */
  ProgramStart();
  if (MPI_Init(&argc, &argv) || UserErrorHandlerPush()) return 2;
  InterruptBlock();
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  InterruptWatch();
  if (alone) {
    code = Calls(1);
    (void)ErrorFinish(code);
  } else {
    PetscCall(TestDuration());
    PetscCall(TestUnits());
    PetscCall(TestWords());
    PetscCall(TestInterrupts());
    PetscCall(TestPrinter());
    RefuseBegin();
    (void)Calls(0);
    (void)ErrorFinish(ISPH_USER_ERROR);
    RefuseEnd(ISPH_USER_ERROR, "\"seven\" (error 77 in Fails, line", "PETSc's error is one sentence with its calls");
  }
  PetscCall(PetscFinalize());
  (void)MPI_Finalize();
  return CHECK_DONE();
}
