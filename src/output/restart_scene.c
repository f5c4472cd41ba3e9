/* Whether a checkpoint is of this scene, from the lines of CloudIdentity in it, and which options have changed. */
#include "output_impl.h"
#include <stdlib.h>

#define DIFFERENCES 1024 /* characters of the list of differences */

/* The line of 'text' whose first 'beginning' characters are those of 'line'; NULL if there is none. */
static const char *FindLine(const char text[], const char line[], size_t beginning)
{
  while (*text && strncmp(text, line, beginning)) {
    text += strcspn(text, "\n");
    if (*text) text++;
  }
  return *text ? text : NULL;
}

/* Adds to 'differences' the lines of 'text' that 'other' lacks or, unless 'missing', has with another value. A text
   from a file may be anything: lines of another form are passed over. */
static void Compare(const char text[], const char other[], PetscBool missing, char differences[DIFFERENCES])
{
  for (const char *line = text, *next; *line; line = next) {
    const size_t name = strcspn(line, "=\n"), value = name + 2, length = strcspn(line, "\n");
    const size_t used = strlen(differences), room = DIFFERENCES - used;
    const char  *found = length < value ? NULL : FindLine(other, line, value), *comma = used ? ", " : "";
    const size_t found_length = found ? strcspn(found, "\n") : 0;
    char        *end          = differences + used;

    next = line + length + (line[length] == '\n');
    if (name == 0 || length < value) continue;
    if (found && (missing || (length == found_length && !strncmp(line, found, length)))) continue;
    if (!found)
      (void)snprintf(end, room, "%s%.*s (%s: %.*s)", comma, (int)name - 1, line, missing ? "there" : "here only",
                     (int)(length - value), line + value);
    else
      (void)snprintf(end, room, "%s%.*s (there %.*s, here %.*s)", comma, (int)name - 1, line,
                     (int)(found_length - value), found + value, (int)(length - value), line + value);
  }
}

PetscErrorCode RestartSceneCheck(Output output, const char file[], const char stored[])
{
  char  differences[DIFFERENCES] = "";
  char *text;

  PetscFunctionBegin;
  PetscCall(CloudIdentity(output->cloud, &text));
  if (!output->rank && stored[0]) {
    Compare(text, stored, PETSC_FALSE, differences);
    Compare(stored, text, PETSC_TRUE, differences);
  }
  free(text);
  PetscCallMPI(MPI_Bcast(differences, DIFFERENCES, MPI_CHAR, 0, output->comm));
  PetscCheckUser(!differences[0], output->comm, "The checkpoint %s is of another scene; what differs: %s.", file,
                 differences);
  if (!output->rank && !stored[0])
    PetscCall(PetscPrintf(
      PETSC_COMM_SELF,
      "The checkpoint %s is of an older version and does not describe its scene; the run takes it for this scene.\n",
      file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the option acts at the start of a run only. Emitters need those of the packing later, too. */
static PetscBool OnlyAtStart(Scene scene, const char line[])
{
  static const char start[] = "-time_start", packing[] = "-packing_", cache[] = "-packing_cache";

  if (!strncmp(line, cache, strlen(cache))) return PETSC_FALSE;
  if (!strncmp(line, packing, strlen(packing))) return (PetscBool)!SceneComesLater(scene);
  return (PetscBool)(!strncmp(line, start, strlen(start)));
}

/* The line of 'text' with the option of 'line', whose name has 'name' characters; NULL if there is none. */
static const char *SameOption(const char text[], const char line[], size_t name)
{
  const char *found = FindLine(text, line, name);

  while (found && found[name] && found[name] != ' ' && found[name] != '\n') { /* a longer name */
    found += strcspn(found, "\n");
    found = FindLine(found + (*found == '\n'), line, name);
  }
  return found;
}

/* Prints the options of 'text' that 'other' lacks or, with 'values', has with another value. */
static PetscErrorCode SayOptions(Scene scene, const char text[], const char other[], PetscBool values, PetscInt *said)
{
  PetscFunctionBegin;
  for (const char *line = text, *next; *line; line = next) {
    const size_t name = strcspn(line, " \n"), length = strcspn(line, "\n");
    const char  *found  = line[0] == '-' ? SameOption(other, line, name) : line;
    const size_t before = found ? strcspn(found, "\n") : 0;

    next = line + length + (line[length] == '\n');
    if (found && (!values || (before == length && !strncmp(line, found, length)))) continue;
    if (!(*said)++) PetscCall(PetscPrintf(PETSC_COMM_SELF, "Options changed since the checkpoint was written:\n"));
    PetscCall(PetscPrintf(PETSC_COMM_SELF, "  %.*s", (int)length, line));
    if (found)
      PetscCall(PetscPrintf(PETSC_COMM_SELF, " (was%.*s)", (int)(before - name), found + name));
    else
      PetscCall(PetscPrintf(PETSC_COMM_SELF, values ? " (was not given)" : " (not given any more)"));
    PetscCall(
      PetscPrintf(PETSC_COMM_SELF, "%s\n", OnlyAtStart(scene, line) ? ": acts at the start of a run only" : ""));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RestartOptionsSay(Output output, const char stored[])
{
  PetscInt said = 0;

  PetscFunctionBegin;
  if (output->rank || !stored[0] || !output->options) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SayOptions(output->cloud->scene, output->options, stored, PETSC_TRUE, &said));
  PetscCall(SayOptions(output->cloud->scene, stored, output->options, PETSC_FALSE, &said));
  PetscFunctionReturn(PETSC_SUCCESS);
}
