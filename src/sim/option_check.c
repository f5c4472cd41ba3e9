/* Refuses options that nothing has read, and says what is known about them. */
#include "sim_impl.h"
#include <stdio.h>
#include <string.h>

#define SENTENCE 512

/* Options that PETSc reads during the run or at its end. */
static const char *const late[] = {
  "options_left", "options_view",         "malloc_view_threshold",        "nox", "checkstack", "citations",
  "mpi_linger",   "ksp_converged_reason", "viscous_ksp_converged_reason",
};
#define LATE_PREFIX "spectrum_" /* SLEPc's options of the spectrum at the end */

/* Beginnings of the names of options of PETSc's objects, which may stand behind a prefix. */
static const char *const objects[] = {"ksp_", "pc_", "mat_", "tao_", "eps_", "st_", "bv_", "ds_"};

PetscErrorCode RefuseTraps(MPI_Comm comm)
{
  PetscBool trap = PETSC_FALSE, view;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-fp_trap", &trap, NULL));
  if (trap) PetscCall(PetscSetFPTrap(PETSC_FP_TRAP_OFF));
  PetscCheckUser(!trap, comm,
                 "-fp_trap cannot be used: loops over pairs also compute values that they drop, some of them with a "
                 "division by zero");
  PetscCall(PetscOptionsHasName(NULL, NULL, "-dm_view", &view));
  PetscCheckUser(!view, comm,
                 "-dm_view shows nothing of the particles, a DMSwarm without a grid: the log has their number, "
                 "-snapshot_interval writes them");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The name of an option of a PETSc object without its prefix; NULL if 'name' is no such option. */
static const char *BehindPrefix(const char name[])
{
  const char *last = NULL;

  for (const char *part = name; part; part = strchr(part, '_')) {
    part += *part == '_';
    for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(objects); k++)
      if (!strncmp(part, objects[k], strlen(objects[k]))) last = part;
  }
  return last;
}

/* A name of PETSc's, also without its prefix; NULL if there is none. */
static const char *FindPetsc(const PetscNames *names, const char name[])
{
  const char *part = BehindPrefix(name);

  for (PetscInt k = 0; k < names->n; k++)
    if (!strcmp(names->name[k], name) || (part && !strcmp(names->name[k], part))) return names->name[k];
  return NULL;
}

/* Keeps the candidate if it is nearer to a misspelt name than the nearest so far. */
static void Nearer(const char name[], const char candidate[], const char **nearest, PetscInt *distance)
{
  const PetscInt d = WordDistance(name, candidate);

  if (d >= *distance) return;
  *distance = d;
  *nearest  = candidate;
}

/* PETSc's name nearest to a misspelt one. */
static const char *NearestPetsc(const PetscNames *names, const char name[], PetscInt *distance)
{
  const char *nearest = NULL;

  for (PetscInt k = 0; k < names->n; k++) Nearer(name, names->name[k], &nearest, distance);
  return nearest;
}

/* The choice that an option of PETSc belongs to, " -pc_type gamg"; empty if the name does not show it. */
static PetscErrorCode ChoiceOfPetsc(const char name[], char choice[], size_t length)
{
  const struct {
    const char       *kind;
    PetscFunctionList list;
  } kinds[] = {{"ksp_", KSPList}, {"pc_", PCList}};

  PetscFunctionBegin;
  choice[0] = 0;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(kinds); k++) {
    const char  *part = strstr(name, kinds[k].kind);
    const char **types;
    int          count;

    if (!part || (part > name && part[-1] != '_')) continue;
    PetscCall(PetscFunctionListGet(kinds[k].list, &types, &count));
    for (int t = 0; t < count && types[t]; t++) {
      const char  *type = part + strlen(kinds[k].kind);
      const size_t size = strlen(types[t]);

      if (!strncmp(type, types[t], size) && type[size] == '_')
        (void)snprintf(choice, length, " -%.*s%stype %s", (int)(part - name), name, kinds[k].kind, types[t]);
    }
    PetscCall(PetscFree(types));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For a name that is a body's option without the body's name: the options of all bodies, "-film_radius,
   -drop_radius". */
static void ForBodies(const char name[], char text[], size_t length)
{
  PetscInt          n;
  const OptionNote *note = OptionsNoted(&n);

  text[0] = 0;
  for (PetscInt k = 0; k < n; k++) {
    const size_t used = strlen(text);

    if (note[k].owner[0] && !strcmp(note[k].row.name + 1, name))
      (void)snprintf(text + used, length - used, "%s%s", used ? ", " : "", note[k].name);
  }
}

/* Says what is known about an option that nothing has read. */
static PetscErrorCode Explain(const PetscNames *petsc, const char name[], char text[])
{
  const char       *part = BehindPrefix(name), *nearest = NULL, *other;
  PetscInt          n, distance = WordsAlike(name) + 1, petsc_distance = distance, prefixed_distance = distance;
  const OptionNote *note = OptionsNoted(&n), *exact;
  char              choice[OPTION_NAME_LENGTH + 32], bodies[SENTENCE / 2], full[OPTION_NAME_LENGTH + 1];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(full, sizeof(full), "-%s", name));
  exact = OptionFind(full);
  PetscCall(ChoiceOfPetsc(name, choice, sizeof(choice)));
  ForBodies(name, bodies, sizeof(bodies));
  if (exact && exact->choice[0])
    (void)snprintf(text, SENTENCE, " here: it belongs to %s, which this %s", exact->choice,
                   exact->choice[0] == '-' ? "scene does not choose" : "is not");
  else if (FindPetsc(petsc, name))
    (void)snprintf(text, SENTENCE, " here: it belongs to%s%s, which this scene does not choose",
                   choice[0] ? "" : " a part of the program or of PETSc", choice);
  else if (bodies[0])
    (void)snprintf(text, SENTENCE, " (did you mean %s?)", bodies);
  else {
    for (PetscInt k = 0; k < n; k++) Nearer(name, note[k].name + 1, &nearest, &distance);
    other = NearestPetsc(petsc, name, &petsc_distance);
    if (petsc_distance < distance) nearest = other;
    distance = PetscMin(distance, petsc_distance);
    other    = part && part > name ? NearestPetsc(petsc, part, &prefixed_distance) : NULL;
    if (other && prefixed_distance < distance)
      (void)snprintf(text, SENTENCE, " (did you mean -%.*s%s?)", (int)(part - name), name, other);
    else if (nearest)
      (void)snprintf(text, SENTENCE, " (did you mean -%s?)", nearest);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether an option may be unread. early: PETSc's objects may read more later. petsc: filled when first needed, on rank
   0. */
static PetscErrorCode Forgive(const char name[], PetscBool early, PetscNames *petsc, PetscBool *forgiven)
{
  PetscFunctionBegin;
  *forgiven = PETSC_FALSE;
  for (size_t l = 0; l < PETSC_STATIC_ARRAY_LENGTH(late) && !*forgiven; l++)
    PetscCall(PetscStrcmp(name, late[l], forgiven));
  if (*forgiven || !(early || !strncmp(name, LATE_PREFIX, strlen(LATE_PREFIX)))) PetscFunctionReturn(PETSC_SUCCESS);
  if (!petsc->n) PetscCall(PetscNamesRead(petsc));
  *forgiven = (PetscBool)(!petsc->n || FindPetsc(petsc, name)); /* without a list, refuse none early */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first unread option to be refused, or empty. If there is one, all unread options are taken from the database, so
   that PETSc does not warn of them. */
static PetscErrorCode FindFault(MPI_Comm comm, PetscBool early, PetscNames *petsc, char fault[OPTION_NAME_LENGTH])
{
  PetscMPIInt rank;
  PetscInt    n, count;
  char      **names, **values;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscOptionsLeftGet(NULL, &n, &names, &values));
  fault[0] = 0;
  for (PetscInt k = 0; k < n && !rank && !fault[0]; k++) {
    PetscBool forgiven;

    PetscCall(Forgive(names[k], early, petsc, &forgiven));
    if (!forgiven) PetscCall(PetscStrncpy(fault, names[k], OPTION_NAME_LENGTH));
  }
  PetscCallMPI(MPI_Bcast(fault, OPTION_NAME_LENGTH, MPI_CHAR, 0, comm));
  for (PetscInt k = 0; k < n && fault[0]; k++) {
    char option[OPTION_NAME_LENGTH + 1];

    PetscCall(PetscSNPrintf(option, sizeof(option), "-%s", names[k]));
    PetscCall(PetscOptionsClearValue(NULL, option));
  }
  count = n;
  PetscCall(PetscOptionsLeftRestore(NULL, &count, &names, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RefuseUnusedOptions(MPI_Comm comm, PetscBool early)
{
  PetscNames  petsc = {0};
  PetscMPIInt rank;
  char        fault[OPTION_NAME_LENGTH], text[SENTENCE] = "";

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(FindFault(comm, early, &petsc, fault));
  if (fault[0] && !rank) {
    if (!petsc.n) PetscCall(PetscNamesRead(&petsc));
    PetscCall(Explain(&petsc, fault, text));
  }
  PetscCall(PetscNamesDestroy(&petsc));
  PetscCheckUser(!fault[0], comm, "nothing reads the option -%s%s; -help lists all options", fault, text);
  PetscFunctionReturn(PETSC_SUCCESS);
}
