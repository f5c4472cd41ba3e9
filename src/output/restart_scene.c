/* The scene a checkpoint was made for, as lines of text in it, so that a restart with another one is refused. A line is
   "<name> = <value>", or "<name> ~ <number>" where the number stands for a function and would tell a user nothing. What
   may change at a restart is left out: end, output, solver, gravity, viscosity, velocity of walls and emitters. */
#include "output_impl.h"

#define LINE_LENGTH     512
#define DIFFERENCES     1024 /* characters of the list of differences */
#define SAMPLES         5    /* points along each side of the box at which a function is sampled */
#define SAMPLE_SHIFT    0.37 /* of a sample in its cell: off all symmetries of a scene */
#define WEIGHTS         7    /* the samples are summed with weights 1 to 7 in turn */
#define SAMPLE_DECIMALS 1e6  /* shares of a sum are rounded to one over this, well above the rounding of processors */

typedef struct {
  char  *text;
  size_t used, room;
} Lines;

static PetscErrorCode AddLine(Lines *lines, const char format[], ...)
{
  char    line[LINE_LENGTH];
  size_t  length;
  va_list arguments;

  PetscFunctionBegin;
  va_start(arguments, format);
  (void)vsnprintf(line, sizeof(line), format, arguments);
  va_end(arguments);
  PetscCall(PetscStrlen(line, &length));
  if (lines->used + length + 2 > lines->room) {
    lines->room = 2 * (lines->used + length + 2);
    PetscCall(PetscRealloc(lines->room, &lines->text));
  }
  lines->used += (size_t)sprintf(lines->text + lines->used, "%s\n", line);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* "a,b" or "a,b,c". */
static const char *Vector(Domain domain, const PetscReal x[DIM], char text[LINE_LENGTH])
{
  size_t used = 0;

  for (PetscInt d = 0; d < domain->dim; d++)
    used += (size_t)snprintf(text + used, LINE_LENGTH - used, "%s%.9g", d ? "," : "", (double)x[d]);
  return text;
}

/* The sum of the sizes of a function's values at points of the box, and its weighted sum over that: the distance to a
   body in spacings, or its initial velocity in m/s. */
static void Sample(Domain domain, Body body, PetscBool velocity, PetscReal *size, PetscReal *share)
{
  const PetscInt last = domain->dim == DIM ? SAMPLES : 1;
  PetscReal      sum  = 0;
  PetscInt       n    = 0;

  *size = 0;
  for (PetscInt k = 0; k < SAMPLES * SAMPLES * last; k++) {
    const PetscInt place[DIM] = {k % SAMPLES, k / SAMPLES % SAMPLES, k / SAMPLES / SAMPLES};
    PetscReal      x[DIM] = {0, 0, 0}, value[DIM] = {0, 0, 0};

    for (PetscInt d = 0; d < domain->dim; d++)
      x[d] = domain->lower[d] +
             (domain->upper[d] - domain->lower[d]) * ((PetscReal)place[d] + SAMPLE_SHIFT) / (PetscReal)SAMPLES;
    if (velocity)
      BodyVelocity(body, x, value);
    else
      value[0] = BodyDistance(body, x) / domain->spacing;
    for (PetscInt d = 0; d < DIM; d++) {
      sum += (PetscReal)(1 + n++ % WEIGHTS) * value[d];
      *size += PetscAbsReal(value[d]);
    }
  }
  *share = *size > 0 ? PetscFloorReal(sum / *size * SAMPLE_DECIMALS + 0.5) / SAMPLE_DECIMALS + 0.0 : 0;
}

static PetscErrorCode AddShape(Lines *lines, Domain domain, Body body)
{
  PetscReal lower[DIM], upper[DIM], size, share;
  char      low[LINE_LENGTH], high[LINE_LENGTH];

  PetscFunctionBegin;
  BodyBounds(body, lower, upper);
  PetscCall(
    AddLine(lines, "extent of %s = %s to %s", BodyName(body), Vector(domain, lower, low), Vector(domain, upper, high)));
  Sample(domain, body, PETSC_FALSE, &size, &share);
  PetscCall(AddLine(lines, "shape of %s ~ %.6g %g", BodyName(body), (double)size, (double)share));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers that follow from samples are rounded. */
static PetscErrorCode AddFree(Lines *lines, Domain domain, Body solid)
{
  const char *name = BodyName(solid);
  PetscReal   center[DIM], inertia[DIM];
  PetscBool   turns;
  char        text[LINE_LENGTH];

  PetscFunctionBegin;
  FreeStart(solid, center, inertia, &turns);
  for (PetscInt d = 0; d < DIM; d++)
    center[d] =
      domain->spacing * (PetscFloorReal(center[d] / domain->spacing * SAMPLE_DECIMALS + 0.5) / SAMPLE_DECIMALS + 0.0);
  PetscCall(AddLine(lines, "-%s_mass = %.9g", name, (double)BodyMass(solid)));
  PetscCall(AddLine(lines, "-%s_turns = %d", name, (int)turns));
  PetscCall(AddLine(lines, "centre of mass of %s = %s", name, Vector(domain, center, text)));
  PetscCall(AddLine(lines, "moments of inertia of %s = %.6g,%.6g,%.6g", name, (double)inertia[0], (double)inertia[1],
                    (double)inertia[2]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where two corners of the box would be if they moved with a solid, at times of each scale, that no motion has a period
 * of. */
static PetscErrorCode AddMotion(Lines *lines, Domain domain, Body solid)
{
  const PetscReal times[5] = {0.7390851332, 0.1618033989, 2.718281828e-2, 3.141592654e-3, 5.772156649e-4}; /* s */
  PetscReal       sum      = 0;

  PetscFunctionBegin;
  if (!BodyMoves(solid)) PetscFunctionReturn(PETSC_SUCCESS);
  if (BodyMass(solid) > 0) {
    PetscCall(AddFree(lines, domain, solid));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt k = 0; k < (PetscInt)PETSC_STATIC_ARRAY_LENGTH(times); k++) {
    PetscReal x[2][DIM];

    for (PetscInt d = 0; d < DIM; d++) {
      x[0][d] = domain->lower[d];
      x[1][d] = domain->upper[d];
    }
    for (PetscInt c = 0; c < 2; c++) {
      BodyMove(solid, 0, times[k], x[c]);
      for (PetscInt d = 0; d < domain->dim; d++) sum += (PetscReal)(1 + c + 2 * d + 6 * k) * x[c][d] / domain->spacing;
    }
  }
  PetscCall(AddLine(lines, "motion of %s ~ %.9g", BodyName(solid), (double)sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddBodies(Lines *lines, Domain domain, Scene scene)
{
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    const Body  body = SceneBody(scene, b);
    const char *name = BodyName(body);
    PetscReal   size, share;

    PetscCall(AddLine(lines, "body %d of -bodies = %s", (int)b + 1, name));
    PetscCall(AddLine(lines, "-%s_type = %s", name, BodyEmits(body) ? "emitter" : "liquid"));
    PetscCall(AddLine(lines, "-%s_density = %.9g", name, (double)BodyMaterial(body)->density));
    if (BodyViscosityVaries(body))
      PetscCall(AddLine(lines, "-%s_viscosity_model = %s", name, BodyViscosityModel(body)));
    PetscCall(AddLine(lines, "-%s_tension = %.9g", name, (double)BodyMaterial(body)->tension));
    PetscCall(AddShape(lines, domain, body));
    if (BodyEmits(body)) continue;
    Sample(domain, body, PETSC_TRUE, &size, &share);
    PetscCall(AddLine(lines, "initial velocity of %s ~ %.6g %g", name, (double)size, (double)share));
  }
  return PETSC_SUCCESS;
}

/* Nothing of liquids that mix. */
static PetscErrorCode AddLiquids(Lines *lines, Scene scene)
{
  char names[LINE_LENGTH];

  PetscFunctionBegin;
  if (SceneInterfaceTension(scene) == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(AddLine(lines, "-interface_tension = %.9g", (double)SceneInterfaceTension(scene)));
  PetscCall(SceneInterfaceBodies(scene, names, sizeof(names)));
  PetscCall(AddLine(lines, "-interface_bodies = %s", names));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RestartSceneText(Output output, char **text)
{
  const Cloud     cloud  = output->cloud;
  const Domain    domain = cloud->domain;
  const Scene     scene  = cloud->scene;
  const PetscReal time   = SceneSolidTime(scene);
  Lines           lines  = {.text = NULL};
  char            number[LINE_LENGTH];

  PetscFunctionBegin;
  if (domain->rings) PetscCall(AddLine(&lines, "-dimension = axisymmetric"));
  if (domain->graded) PetscCall(AddLine(&lines, "-spacing_coarse = %.9g", (double)domain->spacing_coarse));
  PetscCall(AddLine(&lines, "-box_lower = %s", Vector(domain, domain->lower, number)));
  PetscCall(AddLine(&lines, "-box_upper = %s", Vector(domain, domain->upper, number)));
  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt s = 0; s < 2; s++)
      PetscCall(AddLine(&lines, "-box_%c%s = %s", "xyz"[d], s ? "max" : "min", FaceTypes[domain->face[d][s]]));
  PetscCall(AddLine(&lines, "-kernel_ratio = %.9g", (double)(KernelSmoothingLength(cloud->kernel) / domain->spacing)));
  PetscCall(
    AddLine(&lines, "-kernel_type ~ %.9g %.9g",
            (double)(KernelSupport(cloud->kernel) / KernelSmoothingLength(cloud->kernel)),
            (double)(KernelSelf(cloud->kernel) * PetscPowRealInt(KernelSmoothingLength(cloud->kernel), domain->dim))));
  PetscCall(AddBodies(&lines, domain, scene));
  PetscCall(AddLiquids(&lines, scene));
  SceneSolidsAtStart(scene);
  for (PetscInt b = 0; b < SceneSolidCount(scene); b++) {
    PetscCall(AddLine(&lines, "solid %d of -solids = %s", (int)b + 1, BodyName(SceneSolid(scene, b))));
    PetscCall(AddShape(&lines, domain, SceneSolid(scene, b)));
    PetscCall(AddMotion(&lines, domain, SceneSolid(scene, b)));
  }
  SceneMoveSolids(scene, time);
  *text = lines.text;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The line of a text that begins like another line, for so many characters; NULL if there is none. */
static const char *FindLine(const char text[], const char line[], size_t beginning)
{
  while (*text && strncmp(text, line, beginning)) {
    text += strcspn(text, "\n");
    if (*text) text++;
  }
  return *text ? text : NULL;
}

/* Adds what differs between the lines of 'text' and those of 'other'. missing: only what 'other' does not have. A text
   from a file may be anything: what is no such line is passed over. */
static void Compare(const char text[], const char other[], PetscBool missing, char differences[DIFFERENCES])
{
  for (const char *line = text, *next; *line; line = next) {
    const size_t name = strcspn(line, "=~\n"), value = name + 2, length = strcspn(line, "\n");
    const size_t used = strlen(differences), room = DIFFERENCES - used;
    const char  *found = length < value ? NULL : FindLine(other, line, value), *comma = used ? ", " : "";
    const size_t found_length = found ? strcspn(found, "\n") : 0;
    char        *end          = differences + used;

    next = line + length + (line[length] == '\n');
    if (name == 0 || length < value) continue;
    if (found && (missing || (length == found_length && !strncmp(line, found, length)))) continue;
    if (line[name] == '~')
      (void)snprintf(end, room, "%s%.*s", comma, (int)name - 1, line);
    else if (!found)
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
  PetscCall(RestartSceneText(output, &text));
  if (!output->rank && stored[0]) {
    Compare(text, stored, PETSC_FALSE, differences);
    Compare(stored, text, PETSC_TRUE, differences);
  }
  PetscCall(PetscFree(text));
  PetscCallMPI(MPI_Bcast(differences, DIFFERENCES, MPI_CHAR, 0, output->comm));
  PetscCheckUser(!differences[0], output->comm,
                 "The checkpoint %s is of another scene, which cannot go on as this one; "
                 "what differs: %s.",
                 file, differences);
  if (!output->rank && !stored[0])
    PetscCall(PetscPrintf(PETSC_COMM_SELF,
                          "The checkpoint %s is of an older version and does not describe its scene: "
                          "it is taken to be this one.\n",
                          file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Options that say how a run begins. Emitters need the packing's later, too. */
static PetscBool OnlyAtStart(Scene scene, const char line[])
{
  static const char start[] = "-time_start", packing[] = "-packing_", cache[] = "-packing_cache";

  if (!strncmp(line, cache, strlen(cache))) return PETSC_FALSE;
  if (!strncmp(line, packing, strlen(packing))) return (PetscBool)!SceneEmits(scene);
  return (PetscBool)(!strncmp(line, start, strlen(start)));
}

/* The line of a text of options that is of the same option as this line, or NULL. name: the length of its name. */
static const char *SameOption(const char text[], const char line[], size_t name)
{
  const char *found = FindLine(text, line, name);

  while (found && found[name] && found[name] != ' ' && found[name] != '\n') { /* a longer name */
    found += strcspn(found, "\n");
    found = FindLine(found + (*found == '\n'), line, name);
  }
  return found;
}

/* Prints the lines of a text of options that another text has not, or has with another value if 'values'. */
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
