/* Options are rows of tables: what a struct is read from, what -help, -dump_options, scene.json and the refusal of
   unknown names tell. base.h includes this file. */
#ifndef ISPH_OPTION_ROWS_H
#define ISPH_OPTION_ROWS_H

/* The value of a row, at its offset in the struct. */
typedef enum {
  ROW_REAL,      /* PetscReal */
  ROW_INT,       /* PetscInt */
  ROW_BOOL,      /* PetscBool */
  ROW_WORD,      /* an enum or int: the index of one of 'words' */
  ROW_CHOICE,    /* char [OPTION_WORD_LENGTH]: the name of one of 'choices' */
  ROW_TEXT,      /* char [PETSC_MAX_PATH_LEN] */
  ROW_FILE,      /* OptionFile */
  ROW_NUMBERS,   /* a struct like OptionNumbers with room for 'most' numbers */
  ROW_NAMES,     /* a struct like OptionList with room for 'most' texts, which the reader frees */
  ROW_POINT,     /* PetscReal [3], like the next three read by what knows the dimension */
  ROW_DIRECTION, /* PetscReal [3], no third component in two dimensions */
  ROW_AXIS,      /* PetscReal [3], a unit vector from x, y, z or any vector; in two dimensions in the plane */
  ROW_NORMAL     /* the same; in two dimensions also along z */
} OptionKind;

#define OPTION_WORD_LENGTH  64   /* of a chosen name */
#define OPTION_NUMBERS_MOST 10   /* of OptionNumbers */
#define OPTION_NAME_LENGTH  128  /* of an option */
#define OPTION_TEXT_LENGTH  1024 /* of a default value */

typedef struct Choice Choice;

typedef struct {
  const char          *name, *text;     /* "-spacing"; what it means, a phrase with a capital letter */
  const char          *unit, *interval; /* NULL: none; "[0, 1)": any number outside is refused */
  OptionKind           kind;
  size_t               offset;     /* bytes */
  const char          *fallback;   /* what holds without the option, in words; NULL: the value in the struct */
  const char *const   *words;      /* ROW_WORD; ends with NULL */
  const Choice *const *choices;    /* ROW_CHOICE; ends with NULL */
  PetscInt             most;       /* ROW_NUMBERS, ROW_NAMES; 0: OPTION_NUMBERS_MOST */
  PetscBool            changes;    /* from one start of a run to the next it may: see OptionsIdentity */
} OptionRow;                       /* the last row of a table has no name */
#define OPTION_REQUIRED "required" /* a fallback */

/* OptionNumbers - as many numbers as were given, 0 without the option, or the default. OptionList - the same of texts.
   OptionFile - a file and a checksum of what was read from it. */
typedef struct {
  PetscInt  count;
  PetscReal value[OPTION_NUMBERS_MOST];
} OptionNumbers;
typedef struct {
  PetscInt count;
  char    *text[OPTION_NUMBERS_MOST];
} OptionList;
typedef struct {
  char               path[PETSC_MAX_PATH_LEN];
  unsigned long long checksum;
} OptionFile;

/* An entry of a registry, which is an array of pointers that ends with NULL: a kernel, a shape, a scheme, ... It is the
   head of the class's own table of functions. Members may be NULL or 0. */
struct Choice {
  const char      *name;
  size_t           size;         /* bytes of the choice's own data, which start as zeros */
  const OptionRow *options;      /* read into these data, or into the owner if size is 0 */
  void (*defaults)(void *owner); /* writes the defaults, before the options are read */
  /* Refuses (UserError) options that are missing or contradict each other, and completes the data. */
  PetscErrorCode (*setup)(void *owner);
};

/* OptionsRead - reads the rows of a table into a struct, whose values are the defaults, inside a PetscOptionsBegin
   block; refuses (UserError) a value outside its interval or its words. place: the function that -help names. Each row
   is noted. OptionsReadBlock - the same in a block of its own. OptionsReadVectors - OptionsRead where 'vector' reads
   the rows of vectors. Collective. */
typedef PetscErrorCode (*OptionVector)(void *context, OptionItems items, const OptionRow *row, const char help[],
                                       const char place[], PetscReal value[DIM]);
PetscErrorCode OptionsRead(OptionItems items, const OptionRow rows[], const char place[], void *data);
PetscErrorCode OptionsReadBlock(MPI_Comm comm, const char title[], const OptionRow rows[], const char place[],
                                void *data);
PetscErrorCode OptionsReadVectors(OptionItems items, const OptionRow rows[], const char place[], void *data,
                                  OptionVector vector, void *context);
/* OptionsNote - notes the rows of a table as options that belong to a choice that is not made. Collective.
   OptionsReadIf - OptionsRead if the rows apply to the scene, as 'why' says ("-dimension axisymmetric"), or OptionsAll;
   else they are noted. Collective. */
PetscErrorCode OptionsNote(const char prefix[], const char why[], const OptionRow rows[]);
PetscErrorCode OptionsReadIf(OptionItems items, PetscBool applies, const char why[], const OptionRow rows[],
                             const char place[], void *data);
/* OptionHelp - the text of a row for -help: meaning, unit, interval, words. Not collective. */
PetscErrorCode OptionHelp(const OptionRow *row, char help[NAMES_LENGTH]);

/* OptionsSame - whether two structs have the same values by the rows of a table. OptionsIdentity - writes the values of
   a struct as lines "-<prefix>option = value", all numbers as they were read, but for those that a restart may change,
   numbers that were not given, and names; dim: numbers of a vector. OptionsTell - appends what the log says of a struct
   to a text of at most 'length' bytes: numbers, unless zero ones are left out, directions, and choices other than the
   first of the registry. Not collective. */
PetscBool OptionsSame(const OptionRow rows[], const void *one, const void *other);
void OptionsTell(char text[], size_t length, const OptionRow rows[], const void *data, PetscInt dim, PetscBool zeros);
void OptionsIdentity(FILE *text, const char prefix[], const OptionRow rows[], const void *data, PetscInt dim);

/* ChoiceFind - the entry of a registry; refuses (UserError) a name that is none, of the option. Collective. */
PetscErrorCode ChoiceFind(MPI_Comm comm, const Choice *const choices[], const char option[], const char name[],
                          const Choice **choice);
/* ChoicesRead - calls the reader with the chosen entry of a registry, for an option of this full name. The reader makes
   the choice the object's and reads its options; a block of their own has a title that names it, since PETSc prints a
   title once. The options of the others are noted. all: the reader is called with the others, too, before. Collective.
 */
typedef PetscErrorCode (*ChoiceReader)(void *object, const Choice *choice);
PetscErrorCode ChoicesRead(const Choice *const choices[], const char option[], const char prefix[],
                           const Choice *chosen, PetscBool all, ChoiceReader reader, void *object);

/* An option that was read, or that belongs to a choice that was not made. */
typedef struct {
  OptionRow   row;              /* a copy */
  const char *name;             /* the whole one, "-drop_radius" */
  const char *owner;            /* "drop", "<body>" for any body, or "" */
  const char *title, *place;    /* of the block; the function */
  const char *choice;           /* "-packing_type poisson" or "" */
  PetscBool   read, given;      /* given: by the user */
  const char *value, *standard; /* given, or in force; the default */
  char       *text;             /* holds all these */
} OptionNote;

/* OptionsNoted - the notes in the order of reading; each name once, as it was last read, and with OptionsAll once for
   each choice that has it. OptionFind - a note by name; NULL: none. Not collective. OptionsForget - removes the notes;
   call it before a scene is read. Collective. */
const OptionNote *OptionsNoted(PetscInt *count);
const OptionNote *OptionFind(const char name[]);
PetscErrorCode    OptionsForget(void);

/* OptionsAll - whether the options of all types are wanted, chosen by the scene or not: -help without -dump_options, a
   word of help, or -options_json. Not collective. */
#define DUMP_OPTION    "-dump_options"
#define LIST_OPTION    "-options_json"
#define SCENE_OPTION   "-scene_json"
#define HELP_OPTION    "-help_on" /* what -help WORD becomes, since PETSc reads -help itself */
#define MEASURE_OPTION "-measure"
PetscBool OptionsAll(void);

#endif
