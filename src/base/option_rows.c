/* Tables of options: reading, and the notes of what was read. */
#include "json.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct {
  PetscInt    n, capacity;
  OptionNote *note;                       /* [n] */
  char        choice[OPTION_NAME_LENGTH]; /* to which what is read now belongs; an error may leave it */
  PetscBool   registered;                 /* PETSc's end removes the notes */
} Notes;

/* --- the notes --- */

const OptionNote *OptionsNoted(PetscInt *count)
{
  *count = Notes.n;
  return Notes.note;
}

PetscErrorCode OptionsForget(void)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < Notes.n; k++) PetscCall(PetscFree(Notes.note[k].text));
  PetscCall(PetscFree(Notes.note));
  Notes.n = Notes.capacity = 0;
  Notes.choice[0]          = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The note of a name, and of a choice and under a title if those are not NULL. */
static OptionNote *Find(const char name[], const char choice[], const char title[])
{
  for (PetscInt k = 0; k < Notes.n; k++)
    if (!strcmp(Notes.note[k].name, name) && (!choice || !strcmp(Notes.note[k].choice, choice)) &&
        (!title || !strcmp(Notes.note[k].title, title)))
      return &Notes.note[k];
  return NULL;
}

const OptionNote *OptionFind(const char name[])
{
  return Find(name, NULL, NULL);
}

static void TellNumbers(PetscInt count, const PetscReal value[], char text[OPTION_TEXT_LENGTH])
{
  text[0] = 0;
  for (PetscInt k = 0; k < count; k++)
    (void)snprintf(text + strlen(text), OPTION_TEXT_LENGTH - strlen(text), "%s%.9g", k ? "," : "", (double)value[k]);
}

/* The value of a row as the user would write it. */
static void Tell(const OptionRow *row, const void *data, char text[OPTION_TEXT_LENGTH])
{
  const void          *value   = (const char *)data + row->offset;
  const OptionNumbers *numbers = (const OptionNumbers *)value;
  const OptionList    *list    = (const OptionList *)value;
  const PetscReal     *v       = (const PetscReal *)value;

  text[0] = 0;
  switch (row->kind) {
  case ROW_REAL:
    if (row->fallback && *v == -PETSC_MAX_REAL) /* not given */
      (void)snprintf(text, OPTION_TEXT_LENGTH, "%s", row->fallback);
    else
      TellNumbers(1, v, text);
    break;
  case ROW_INT:
    (void)snprintf(text, OPTION_TEXT_LENGTH, "%" PetscInt_FMT, *(const PetscInt *)value);
    break;
  case ROW_BOOL:
    (void)snprintf(text, OPTION_TEXT_LENGTH, "%s", *(const PetscBool *)value ? "true" : "false");
    break;
  case ROW_WORD:
    (void)snprintf(text, OPTION_TEXT_LENGTH, "%s", row->words[*(const int *)value]);
    break;
  case ROW_CHOICE:
  case ROW_TEXT:
  case ROW_FILE: /* the path comes first */
    (void)snprintf(text, OPTION_TEXT_LENGTH, "%s", (const char *)value);
    break;
  case ROW_NUMBERS:
    TellNumbers(numbers->count, numbers->value, text);
    break;
  case ROW_NAMES:
    for (PetscInt k = 0; k < list->count; k++)
      (void)snprintf(text + strlen(text), OPTION_TEXT_LENGTH - strlen(text), "%s%s", k ? "," : "", list->text[k]);
    break;
  case ROW_AXIS:
  case ROW_NORMAL:
    for (PetscInt d = 0; d < DIM; d++)
      if (v[d] == 1) (void)snprintf(text, OPTION_TEXT_LENGTH, "%c", "xyz"[d]);
    if (text[0]) break; /* fall through */
  case ROW_POINT:
  case ROW_DIRECTION:
    TellNumbers(DIM, v, text);
    break;
  }
}

/* Notes an option. value: as given, or NULL. What is read replaces what was noted before. */
static PetscErrorCode Note(const OptionRow *row, const char prefix[], const char title[], const char place[],
                           PetscBool read, const char value[], const char standard[])
{
  char        name[OPTION_NAME_LENGTH];
  const char *texts[7];
  size_t      length[7], all = 0;
  OptionNote *note;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, sizeof(name), "-%s%s", prefix ? prefix : "", row->name + 1));
  note = Find(name, OptionsAll() ? Notes.choice : NULL,
              OptionsAll() ? title : NULL); /* choices, body and solid share names */
  if (note && !read) PetscFunctionReturn(PETSC_SUCCESS);
  if (!Notes.registered) PetscCall(PetscRegisterFinalize(OptionsForget));
  Notes.registered = PETSC_TRUE;
  if (!note) PetscCall(ListGrow(Notes.n, &Notes.capacity, sizeof(*Notes.note), &Notes.note));
  if (note) PetscCall(PetscFree(note->text));
  if (!note) note = &Notes.note[Notes.n++];
  *note    = (OptionNote){.row = *row, .place = place, .read = read, .given = (PetscBool)(value != NULL)};
  texts[0] = name;
  texts[1] = prefix ? prefix : "";
  texts[2] = title ? title : "";
  texts[3] = Notes.choice;
  texts[4] = value ? value : standard;
  texts[5] = standard;
  texts[6] = row->name; /* may be the caller's */
  for (int k = 0; k < 7; k++) all += length[k] = strlen(texts[k]) + 1;
  PetscCall(PetscMalloc1(all, &note->text));
  for (size_t k = 0, at = 0; k < 7; at += length[k++]) {
    const char **const field[] = {&note->name,  &note->owner,    &note->title,   &note->choice,
                                  &note->value, &note->standard, &note->row.name};

    PetscCall(PetscArraycpy(note->text + at, texts[k], length[k]));
    if (k == 1 && length[1] > 1) note->text[at + length[1] - 2] = 0; /* the underscore */
    *field[k] = note->text + at;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- reading --- */

PetscBool OptionsAll(void)
{
  PetscBool help = PETSC_FALSE, dump = PETSC_FALSE, list = PETSC_FALSE, word = PETSC_FALSE;

  (void)PetscOptionsHasHelp(NULL, &help);
  (void)PetscOptionsHasName(NULL, NULL, DUMP_OPTION, &dump);
  (void)PetscOptionsHasName(NULL, NULL, LIST_OPTION, &list);
  (void)PetscOptionsHasName(NULL, NULL, HELP_OPTION, &word);
  return (PetscBool)(list || word || (help && !dump));
}

static PetscErrorCode Words(const OptionRow *row, char list[NAMES_LENGTH])
{
  PetscFunctionBegin;
  list[0] = 0;
  for (PetscInt k = 0; row->words && row->words[k]; k++) {
    if (k) TextAppend(list, NAMES_LENGTH, ", ");
    TextAppend(list, NAMES_LENGTH, row->words[k]);
  }
  for (PetscInt k = 0; row->choices && row->choices[k]; k++) {
    if (k) TextAppend(list, NAMES_LENGTH, ", ");
    TextAppend(list, NAMES_LENGTH, row->choices[k]->name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OptionHelp(const OptionRow *row, char help[NAMES_LENGTH])
{
  const int       first    = (int)strcspn(row->text, ";"); /* the unit belongs to what comes before */
  const PetscBool required = (PetscBool)(row->fallback && !strcmp(row->fallback, OPTION_REQUIRED));
  char            list[NAMES_LENGTH], unit[OPTION_WORD_LENGTH] = "";

  PetscFunctionBegin;
  PetscCall(Words(row, list));
  if (row->unit) (void)snprintf(unit, sizeof(unit), " (%s)", row->unit);
  (void)snprintf(help, NAMES_LENGTH, "%.*s%s%s%s%s%s%s%s%.900s", first, row->text, unit, row->text + first,
                 row->interval ? ", in " : "", row->interval ? row->interval : "",
                 required        ? ", "
                 : row->fallback ? "; default: "
                                 : "",
                 row->fallback ? row->fallback : "", list[0] ? " (one of) " : "", list);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether x lies in the interval, a text like "[low, high)"; NaN lies in none. */
static PetscBool Inside(const char interval[], PetscReal x)
{
  double low, high;
  char   opens, closes;

  if (sscanf(interval, "%c%lf, %lf%c", &opens, &low, &high, &closes) != 4) return PETSC_FALSE;
  return (PetscBool)((opens == '[' ? x >= low : x > low) && (closes == ']' ? x <= high : x < high));
}

/* One option that is being read. */
typedef struct {
  const OptionRow *row;
  const char      *prefix, *place, *given; /* given: the text that the user gave, borrowed, or "" */
  char             help[NAMES_LENGTH];
  PetscBool        set;
  void            *value;
} Reading;

/* Gives the option another value in PETSc's database, for all who read it again: the dump, scene.json, a restart. */
static PetscErrorCode Replace(Reading *r, OptionItems items, const char value[])
{
  char name[OPTION_NAME_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, sizeof(name), "-%s%s", r->prefix, r->row->name + 1));
  PetscCall(PetscOptionsSetValue(items->options, name, value));
  PetscCall(PetscOptionsFindPair(items->options, items->prefix, r->row->name, &r->given, &r->set));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the text has numbers and nothing else. PETSc would skip a gap between commas. */
static PetscBool AreNumbers(const char text[], PetscBool whole, PetscBool several)
{
  char *end;

  do {
    if (whole)
      (void)strtoll(text, &end, 10);
    else
      (void)strtod(text, &end);
    if (end == text) return PETSC_FALSE;
    text = end + 1;
  } while (several && *end == ',');
  return (PetscBool) !*end;
}

/* Takes the units from the numbers, and refuses words that are none, which PETSc calls input strings without a numeric
   value. */
static PetscErrorCode CheckNumbers(Reading *r, OptionItems items)
{
  const PetscBool several = (PetscBool)(r->row->kind == ROW_NUMBERS || r->row->kind >= ROW_POINT);
  const char     *unit    = r->row->unit && strcmp(r->row->unit, "1") ? r->row->unit : NULL;
  char            text[OPTION_TEXT_LENGTH], units[NAMES_LENGTH] = "";
  PetscBool       good, any                                     = PETSC_FALSE;

  PetscFunctionBegin;
  if (!r->given[0] || (r->row->kind >= ROW_AXIS && isalpha((unsigned char)r->given[0])))
    PetscFunctionReturn(PETSC_SUCCESS);
  if (unit) UnitsList(unit, units, sizeof(units));
  good = (PetscBool)(!unit || UnitsConvert(unit, r->given, text, sizeof(text), &any));
  if (good && any) PetscCall(Replace(r, items, text));
  PetscCheckUser(good && AreNumbers(r->given, (PetscBool)(r->row->kind == ROW_INT), several), items->comm,
                 "-%s%s is %s; %s wanted%s%s%s%s%s", r->prefix, r->row->name + 1, r->given,
                 several                   ? "numbers with single commas between them are"
                 : r->row->kind == ROW_INT ? "a whole number is"
                                           : "a number is",
                 unit ? ", in " : "", unit ? unit : "", units[0] ? ", or with one of" : ", with nothing",
                 units[0] ? units + 1 : "", several ? " behind the last or each" : " behind it");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the words of an option are what holds without it: "none". */
static PetscBool IsFallback(const Reading *r)
{
  return (PetscBool)(r->set && r->row->kind == ROW_REAL && r->row->fallback && !strcmp(r->given, r->row->fallback));
}

static PetscErrorCode ReadReal(Reading *r, OptionItems PetscOptionsObject)
{
  PetscReal *value = (PetscReal *)r->value;

  PetscFunctionBegin;
  PetscCall(PetscOptionsReal(r->row->name, r->help, r->place, *value, value, NULL));
  PetscCheckUser(!r->set || !r->row->interval || Inside(r->row->interval, *value), PetscOptionsObject->comm,
                 "-%s%s is %g; it must lie in %s", r->prefix, r->row->name + 1, (double)*value, r->row->interval);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses an integer that does not fit PetscInt, which PETSc would truncate. */
static PetscErrorCode ReadInt(Reading *r, OptionItems PetscOptionsObject)
{
  const char     *interval = r->row->interval;
  PetscInt       *value    = (PetscInt *)r->value;
  char           *end;
  const long long number = strtoll(r->given, &end, 10);

  PetscFunctionBegin;
  PetscCheckUser(!r->set || *end || (number >= PETSC_MIN_INT && number <= PETSC_MAX_INT), PetscOptionsObject->comm,
                 "-%s%s is %s; it must lie in %s and have at most %d bits", r->prefix, r->row->name + 1, r->given,
                 interval, (int)(8 * sizeof(PetscInt)));
  PetscCall(PetscOptionsInt(r->row->name, r->help, r->place, *value, value, NULL));
  PetscCheckUser(!r->set || Inside(interval, (PetscReal)*value), PetscOptionsObject->comm,
                 "-%s%s is %" PetscInt_FMT "; it must lie in %s", r->prefix, r->row->name + 1, *value, interval);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadWord(Reading *r, OptionItems PetscOptionsObject)
{
  int      *value                    = (int *)r->value, k;
  char      word[OPTION_WORD_LENGTH] = "", list[NAMES_LENGTH];
  PetscBool same                     = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(Words(r->row, list));
  PetscCall(PetscOptionsString(r->row->name, r->help, r->place, r->row->words[*value], word, sizeof(word), NULL));
  for (k = 0; r->set && r->row->words[k]; k++) {
    PetscCall(PetscStrcasecmp(word, r->row->words[k], &same));
    if (same) break;
  }
  PetscCheckUser(!r->set || same, PetscOptionsObject->comm, "-%s%s %s does not exist; choose from %s", r->prefix,
                 r->row->name + 1, r->given, list);
  if (r->set) *value = k;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadChoice(Reading *r, OptionItems PetscOptionsObject)
{
  char          name[OPTION_NAME_LENGTH], *value = (char *)r->value;
  const Choice *choice;

  PetscFunctionBegin;
  PetscCall(PetscOptionsString(r->row->name, r->help, r->place, value, value, OPTION_WORD_LENGTH, NULL));
  PetscCall(PetscSNPrintf(name, sizeof(name), "-%s%s", r->prefix, r->row->name + 1));
  PetscCall(ChoiceFind(PetscOptionsObject->comm, r->row->choices, name, value, &choice));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the most entries that the list may have, after a check of those given: PETSc would drop what is beyond. */
static PetscErrorCode CheckLength(const Reading *r, MPI_Comm comm, PetscInt *most)
{
  PetscInt count = 1;

  PetscFunctionBegin;
  *most = r->row->most ? r->row->most : OPTION_NUMBERS_MOST;
  for (const char *c = r->given; c && *c; c++) count += *c == ',';
  PetscCheckUser(count <= *most, comm, "-%s%s has %" PetscInt_FMT " entries; at most %" PetscInt_FMT " are allowed",
                 r->prefix, r->row->name + 1, count, *most);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadNumbers(Reading *r, OptionItems PetscOptionsObject)
{
  OptionNumbers *numbers = (OptionNumbers *)r->value;
  PetscInt       count;

  PetscFunctionBegin;
  PetscCall(CheckLength(r, PetscOptionsObject->comm, &count));
  PetscCall(PetscOptionsRealArray(r->row->name, r->help, r->place, numbers->value, &count, NULL));
  if (r->set) numbers->count = count;
  for (PetscInt k = 0; k < numbers->count; k++)
    PetscCheckUser(!PetscIsInfOrNanReal(numbers->value[k]), PetscOptionsObject->comm, "-%s%s must have finite numbers",
                   r->prefix, r->row->name + 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadNames(Reading *r, OptionItems PetscOptionsObject)
{
  OptionList *list = (OptionList *)r->value;
  PetscInt    count;

  PetscFunctionBegin;
  PetscCall(CheckLength(r, PetscOptionsObject->comm, &count));
  PetscCall(PetscOptionsStringArray(r->row->name, r->help, r->place, list->text, &count, NULL));
  if (r->set) list->count = count;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The option names the file where it was found. */
static PetscErrorCode FindFile(Reading *r, OptionItems items)
{
  char path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(path, r->given, sizeof(path)));
  PetscCall(OptionsFileFind(items->comm, path));
  PetscCall(Replace(r, items, path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Read(Reading *r, OptionItems PetscOptionsObject)
{
  PetscBool *flag = (PetscBool *)r->value;

  PetscFunctionBegin;
  switch (r->row->kind) {
  case ROW_REAL:
    PetscCall(ReadReal(r, PetscOptionsObject));
    break;
  case ROW_INT:
    PetscCall(ReadInt(r, PetscOptionsObject));
    break;
  case ROW_BOOL:
    PetscCall(PetscOptionsBool(r->row->name, r->help, r->place, *flag, flag, NULL));
    break;
  case ROW_WORD:
    PetscCall(ReadWord(r, PetscOptionsObject));
    break;
  case ROW_CHOICE:
    PetscCall(ReadChoice(r, PetscOptionsObject));
    break;
  case ROW_TEXT:
  case ROW_FILE: /* the path comes first */
    PetscCall(PetscOptionsString(r->row->name, r->help, r->place, (char *)r->value, (char *)r->value,
                                 PETSC_MAX_PATH_LEN, NULL));
    break;
  case ROW_NUMBERS:
    PetscCall(ReadNumbers(r, PetscOptionsObject));
    break;
  case ROW_NAMES:
    PetscCall(ReadNames(r, PetscOptionsObject));
    break;
  default:
    SETERRQ(PetscOptionsObject->comm, PETSC_ERR_PLIB, "%s is a vector, which is not read here", r->row->name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OptionsReadVectors(OptionItems items, const OptionRow rows[], const char place[], void *data,
                                  OptionVector vector, void *context)
{
  PetscFunctionBegin;
  for (const OptionRow *row = rows; row && row->name; row++) {
    Reading r = {.row = row, .place = place, .value = (char *)data + row->offset};
    char    standard[OPTION_TEXT_LENGTH];

    r.prefix = items->prefix ? items->prefix : "";
    PetscCall(OptionHelp(row, r.help));
    Tell(row, data, standard);
    PetscCall(PetscOptionsFindPair(items->options, items->prefix, row->name, &r.given, &r.set)); /* of any length */
    if (!r.given) r.given = "";
    if (IsFallback(&r)) {
      PetscCall(Note(row, items->prefix, items->title, place, PETSC_TRUE, NULL, standard));
      continue;
    }
    if (row->kind <= ROW_INT || row->kind == ROW_NUMBERS || row->kind >= ROW_POINT) PetscCall(CheckNumbers(&r, items));
    if (row->kind == ROW_FILE && r.set) PetscCall(FindFile(&r, items));
    if (row->kind >= ROW_POINT && vector)
      PetscCall((*vector)(context, items, row, r.help, place, (PetscReal *)r.value));
    else
      PetscCall(Read(&r, items));
    PetscCall(Note(row, items->prefix, items->title, place, PETSC_TRUE, r.set ? r.given : NULL, standard));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OptionsRead(OptionItems items, const OptionRow rows[], const char place[], void *data)
{
  return OptionsReadVectors(items, rows, place, data, NULL, NULL);
}

PetscErrorCode OptionsReadBlock(MPI_Comm comm, const char title[], const OptionRow rows[], const char place[],
                                void *data)
{
  PetscFunctionBegin;
  PetscOptionsBegin(comm, NULL, title, place);
  PetscCall(OptionsRead(PetscOptionsObject, rows, place, data));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OptionsNote(const char prefix[], const char why[], const OptionRow rows[])
{
  char before[OPTION_NAME_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(before, Notes.choice, sizeof(before)));
  if (why != Notes.choice) PetscCall(PetscStrncpy(Notes.choice, why, sizeof(Notes.choice)));
  for (const OptionRow *row = rows; row && row->name; row++)
    PetscCall(Note(row, prefix, NULL, NULL, PETSC_FALSE, NULL, ""));
  PetscCall(PetscStrncpy(Notes.choice, before, sizeof(Notes.choice)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OptionsReadIf(OptionItems items, PetscBool applies, const char why[], const OptionRow rows[],
                             const char place[], void *data)
{
  char before[OPTION_NAME_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(before, Notes.choice, sizeof(before)));
  if (!applies) PetscCall(PetscStrncpy(Notes.choice, why, sizeof(Notes.choice)));
  if (applies || OptionsAll())
    PetscCall(OptionsRead(items, rows, place, data));
  else
    PetscCall(OptionsNote(items->prefix, Notes.choice, rows));
  PetscCall(PetscStrncpy(Notes.choice, before, sizeof(Notes.choice)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- choices --- */

PetscErrorCode ChoiceFind(MPI_Comm comm, const Choice *const choices[], const char option[], const char name[],
                          const Choice **choice)
{
  const OptionRow row = {.choices = choices};
  char            list[NAMES_LENGTH];

  PetscFunctionBegin;
  PetscCall(Words(&row, list));
  for (*choice = *choices; *choice && strcmp((*choice)->name, name); choices++) *choice = choices[1];
  PetscCheckUser(*choice, comm, "%s %s does not exist; choose from %s", option, name, list);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ChoicesRead(const Choice *const choices[], const char option[], const char prefix[],
                           const Choice *chosen, PetscBool all, ChoiceReader reader, void *object)
{
  PetscFunctionBegin;
  for (PetscInt k = 0, last = 0; !last; k++) {
    const Choice *choice = choices[k] ? choices[k] : chosen;

    last = !choices[k];
    PetscCall(PetscSNPrintf(Notes.choice, sizeof(Notes.choice), "%s %s", option, choice->name));
    if (last || all)
      PetscCall((*reader)(object, choice));
    else if (choice != chosen)
      PetscCall(OptionsNote(prefix, Notes.choice, choice->options));
  }
  Notes.choice[0] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- as data --- */

static const char *const KindNames[] = {"real",    "int",   "bool",  "word",      "choice", "text",  "file",
                                        "numbers", "names", "point", "direction", "axis",   "normal"};

static void WriteWords(Json *json, const OptionRow *row)
{
  JsonArray(json, "values");
  for (PetscInt k = 0; row->words && row->words[k]; k++) JsonText(json, NULL, row->words[k]);
  for (PetscInt k = 0; row->choices && row->choices[k]; k++) JsonText(json, NULL, row->choices[k]->name);
  JsonEnd(json);
}

/* The choices that have the option of note k, one behind the other; false: an earlier note has told it. */
static PetscBool AllChoices(PetscInt k, char text[OPTION_TEXT_LENGTH])
{
  const OptionNote *one = &Notes.note[k];

  text[0] = 0;
  for (PetscInt j = 0; j < Notes.n; j++) {
    const OptionNote *other = &Notes.note[j];

    if (strcmp(one->name, other->name) || strcmp(one->row.text, other->row.text) ||
        (!one->row.fallback && strcmp(one->standard, other->standard)))
      continue;
    if (j < k) return PETSC_FALSE;
    TextAppend(text, OPTION_TEXT_LENGTH, text[0] ? ", " : "");
    TextAppend(text, OPTION_TEXT_LENGTH, other->choice);
  }
  return PETSC_TRUE;
}

PetscErrorCode OptionsJson(Json *json, PetscBool scene)
{
  char choices[OPTION_TEXT_LENGTH];

  PetscFunctionBegin;
  JsonArray(json, "options");
  for (PetscInt k = 0; k < Notes.n; k++) {
    const OptionNote *note = &Notes.note[k];

    if (scene ? !note->read : !AllChoices(k, choices) || (note->owner[0] && !strchr(note->name, '<'))) continue;
    JsonObject(json, NULL);
    JsonText(json, "name", note->name);
    JsonText(json, "owner", note->owner);
    JsonText(json, "kind", KindNames[note->row.kind]);
    JsonText(json, "unit", note->row.unit);
    if (scene) {
      JsonText(json, "value", note->value);
      JsonBool(json, "given", note->given);
    } else {
      JsonText(json, "meaning", note->row.text);
      JsonText(json, "range", note->row.interval);
      if (note->row.words || note->row.choices) WriteWords(json, &note->row);
      JsonText(json, "default", note->row.fallback ? note->row.fallback : note->standard);
      JsonText(json, "choice", choices);
      JsonText(json, "group", note->title);
      JsonText(json, "place", note->place);
    }
    JsonEnd(json);
  }
  JsonEnd(json);
  PetscFunctionReturn(PETSC_SUCCESS);
}
