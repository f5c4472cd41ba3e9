#include "sim_impl.h"

/* Options that PETSc reads during the run or at its end. */
static const char *const late[] = {
  "options_left", "options_view",         "malloc_view_threshold",        "nox", "checkstack", "citations",
  "mpi_linger",   "ksp_converged_reason", "viscous_ksp_converged_reason",
};
#define LATE_PREFIX "spectrum_" /* SLEPc's options of the spectrum at the end */

#define FAR 1000

/* Levenshtein distance of two short words. */
static PetscInt EditDistance(const char a[], const char b[])
{
  PetscInt row[128], n = 0;

  while (n < 126 && b[n]) n++;
  for (PetscInt j = 0; j <= n; j++) row[j] = j;
  for (PetscInt i = 0; a[i]; i++) {
    PetscInt diagonal = row[0];

    row[0] = i + 1;
    for (PetscInt j = 0; j < n; j++) {
      const PetscInt best = PetscMin(PetscMin(row[j], row[j + 1]) + 1, diagonal + (a[i] != b[j]));

      diagonal   = row[j + 1];
      row[j + 1] = best;
    }
  }
  return row[n];
}

/* The option names that the classes of this program read are in the executable's help; here those of the table below
 * serve for a suggestion. */
static const char *const known[] = {
#include "names.h"
};

PetscErrorCode RefuseTraps(MPI_Comm comm)
{
  PetscBool trap = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-fp_trap", &trap, NULL));
  if (trap) PetscCall(PetscSetFPTrap(PETSC_FP_TRAP_OFF));
  PetscCheckUser(!trap, comm,
                 "-fp_trap cannot be used: loops over pairs also compute what they then drop, among it divisions by "
                 "zero");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RefuseUnusedOptions(MPI_Comm comm)
{
  PetscInt n;
  char   **names, **values;

  PetscFunctionBegin;
  PetscCall(PetscOptionsLeftGet(NULL, &n, &names, &values));
  for (PetscInt k = 0; k < n; k++) {
    const char *nearest  = NULL;
    PetscInt    distance = FAR;
    PetscBool   skip     = PETSC_FALSE;

    for (size_t l = 0; l < PETSC_STATIC_ARRAY_LENGTH(late) && !skip; l++)
      PetscCall(PetscStrcmp(names[k], late[l], &skip));
    if (!skip) PetscCall(PetscStrncmp(names[k], LATE_PREFIX, sizeof(LATE_PREFIX) - 1, &skip));
    if (skip) continue;
    for (size_t l = 0; l < sizeof(known) / sizeof(*known); l++) {
      const PetscInt d = EditDistance(names[k], known[l]);

      if (d < distance) {
        distance = d;
        nearest  = known[l];
      }
    }
    PetscCheckUser(distance, comm,
                   "nothing reads the option -%s here: it belongs to a choice that this scene does not make; -help "
                   "lists all options",
                   names[k]);
    PetscCheckUser(PETSC_FALSE, comm, "nothing reads the option -%s%s%s%s; -help lists all options", names[k],
                   distance <= 4 ? " (did you mean -" : "", distance <= 4 ? nearest : "", distance <= 4 ? "?)" : "");
  }
  {
    PetscInt count = n;

    PetscCall(PetscOptionsLeftRestore(NULL, &count, &names, &values));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
