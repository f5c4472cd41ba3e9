/* Reads STL files, binary or text. */
#include "stl.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#define HEADER_BYTES   80
#define TRIANGLE_BYTES 50             /* of a binary file: normal, three corners, two bytes */
#define BYTE_ORDER     "\xEF\xBB\xBF" /* byte-order mark, which some editors write at the start of a text */
#define WORD_LENGTH    32             /* of a word in a text file */

/* The content of a file with a byte 0 after it; NULL if the file cannot be read. */
static char *ReadAll(const char path[], long *size)
{
  struct stat info;
  FILE       *file;
  char       *text = NULL;

  *size = -1;
  if (stat(path, &info) || !S_ISREG(info.st_mode)) return NULL; /* opening a pipe could wait for ever */
  file = fopen(path, "rb");
  if (!file) return NULL;
  if (!fseek(file, 0, SEEK_END) && (*size = ftell(file)) >= 0 && !fseek(file, 0, SEEK_SET)) {
    text = (char *)malloc((size_t)*size + 1);
    if (text && fread(text, 1, (size_t)*size, file) != (size_t)*size) {
      free(text);
      text = NULL;
    }
    if (text) text[*size] = 0;
  }
  (void)fclose(file);
  return text;
}

/* --- binary: 80 bytes, the number of triangles, the triangles; little-endian like the machine --- */

/* The number of triangles that a binary file states; -1 if the file is too short. */
static long CountBinary(const char *bytes, long size)
{
  unsigned count;

  if (size < HEADER_BYTES + (long)sizeof(count)) return -1;
  memcpy(&count, bytes + HEADER_BYTES, sizeof(count));
  return (long)count;
}

static long BinaryLength(long n)
{
  return HEADER_BYTES + (long)sizeof(unsigned) + TRIANGLE_BYTES * n;
}

static void ParseBinary(const char *bytes, long n, PetscReal corner[])
{
  for (long t = 0; t < n; t++) {
    float number[12];

    memcpy(number, bytes + HEADER_BYTES + sizeof(unsigned) + TRIANGLE_BYTES * t, sizeof(number));
    for (int k = 0; k < 9; k++) corner[9 * t + k] = (PetscReal)number[3 + k];
  }
}

/* --- text: words between blanks, in any case; a name of any words follows "solid" and "endsolid" --- */

typedef struct {
  const char *at, *end;
  long        line;
} Text;

/* Copies the next word in lower case; empty at the end of the text. A long word is truncated: no word of the format is
   as long. */
static void NextWord(Text *text, char word[WORD_LENGTH])
{
  int length = 0;

  for (; text->at < text->end && isspace((unsigned char)*text->at); text->at++) text->line += *text->at == '\n';
  for (; text->at < text->end && !isspace((unsigned char)*text->at); text->at++)
    if (length < WORD_LENGTH - 1) word[length++] = *text->at ? (char)tolower((unsigned char)*text->at) : '?';
  word[length] = 0;
}

static PetscBool Expect(Text *text, const char expected[])
{
  char word[WORD_LENGTH];

  NextWord(text, word);
  return (PetscBool)!strcmp(word, expected);
}

static void SkipLine(Text *text)
{
  while (text->at < text->end && *text->at != '\n' && *text->at != '\r') text->at++;
}

/* Reads three numbers; number may be NULL. */
static PetscBool Numbers(Text *text, PetscReal number[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    char           *end;
    const PetscReal value = (PetscReal)strtod(text->at, &end);

    if (end == text->at || end > text->end) return PETSC_FALSE;
    for (; text->at < end; text->at++) text->line += *text->at == '\n';
    if (number) number[d] = value;
  }
  return PETSC_TRUE;
}

/* Reads a facet after the word "facet". */
static PetscBool Facet(Text *text, PetscReal corner[9])
{
  if (!Expect(text, "normal") || !Numbers(text, NULL) || !Expect(text, "outer") || !Expect(text, "loop"))
    return PETSC_FALSE;
  for (PetscInt c = 0; c < 3; c++)
    if (!Expect(text, "vertex") || !Numbers(text, corner + DIM * c)) return PETSC_FALSE;
  return (PetscBool)(Expect(text, "endloop") && Expect(text, "endfacet"));
}

/* Reads all triangles into a buffer to be freed with free(). Returns false at an error in text->line. */
static PetscBool ParseText(Text *text, long *n, PetscReal **corner)
{
  char      word[WORD_LENGTH];
  long      room  = 0;
  PetscBool solid = PETSC_FALSE; /* between "solid" and "endsolid" */

  *n      = 0;
  *corner = NULL;
  for (NextWord(text, word); word[0]; NextWord(text, word)) {
    if (!solid && !strcmp(word, "solid")) {
      solid = PETSC_TRUE;
      SkipLine(text);
    } else if (solid && !strcmp(word, "endsolid")) {
      solid = PETSC_FALSE;
      SkipLine(text);
    } else if (solid && !strcmp(word, "facet")) {
      if (*n == room) {
        PetscReal *more = (PetscReal *)realloc(*corner, 9 * sizeof(PetscReal) * (size_t)(room = 2 * room + 1024));

        if (!more) return PETSC_FALSE;
        *corner = more;
      }
      if (!Facet(text, *corner + 9 * *n)) return PETSC_FALSE;
      (*n)++;
    } else
      return PETSC_FALSE;
  }
  return (PetscBool)!solid;
}

/* --- both --- */

/* Whether a file is a text: an optional byte-order mark, blanks and "solid" at the start, and no byte 0 within the
   length of a binary header, which may begin with "solid", too. *start: after the byte-order mark and blanks. */
static PetscBool BeginsLikeText(const char *bytes, long size, const char **start)
{
  const char *at = bytes;

  if (!strncmp(at, BYTE_ORDER, strlen(BYTE_ORDER))) at += strlen(BYTE_ORDER);
  while (isspace((unsigned char)*at)) at++;
  *start = at;
  return (PetscBool)(!strncasecmp(at, "solid", strlen("solid")) &&
                     !memchr(bytes, 0, (size_t)PetscMin(size, HEADER_BYTES)));
}

static PetscErrorCode ReadTextFile(MPI_Comm comm, const char path[], const char start[], const char end[], PetscInt *n,
                                   PetscReal **corner)
{
  Text            text = {.at = start, .end = end, .line = 1};
  PetscReal      *found;
  long            count;
  const PetscBool whole = ParseText(&text, &count, &found);
  const PetscBool ended = (PetscBool)(text.at >= text.end);

  PetscFunctionBegin;
  if (!whole || count > PETSC_MAX_INT / 9) free(found);
  PetscCheckUser(whole || !ended, comm, "the STL file %s is truncated: it ends before its 'endsolid'", path);
  PetscCheckUser(whole, comm,
                 "the STL file %s has an error in line %ld: it must have 'solid', then triangles of 'facet normal', "
                 "'outer loop', three times 'vertex', 'endloop', 'endfacet', and then 'endsolid'",
                 path, text.line);
  PetscCheckUser(count <= PETSC_MAX_INT / 9, comm, "the STL file %s has %ld triangles; at most %ld are allowed", path,
                 count, (long)PETSC_MAX_INT / 9);
  *n = (PetscInt)count;
  PetscCall(PetscMalloc1(9 * count + 1, corner));
  PetscCall(PetscArraycpy(*corner, found, 9 * count));
  free(found);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StlRead(MPI_Comm comm, const char path[], PetscInt *n, PetscReal **corner)
{
  long           size, said;
  char          *bytes = ReadAll(path, &size);
  const char    *start;
  PetscErrorCode bad = PETSC_SUCCESS;

  PetscFunctionBegin;
  PetscCheckUser(bytes, comm, "the STL file %s cannot be read", path);
  *n   = -1;
  said = CountBinary(bytes, size);
  if (said >= 0 && size == BinaryLength(said) && said <= PETSC_MAX_INT / 9) {
    *n = (PetscInt)said;
    PetscCall(PetscMalloc1(9 * said + 1, corner));
    ParseBinary(bytes, said, *corner);
  } else if (BeginsLikeText(bytes, size, &start))
    bad = ReadTextFile(comm, path, start, bytes + size, n, corner);
  free(bytes);
  PetscCall(bad);
  PetscCheckUser(
    *n >= 0 || said < 0, comm,
    "%s is no whole STL file: it does not begin with 'solid', and as a binary file it states %ld triangles, "
    "which need %ld bytes, but it is %ld bytes long (at most %ld triangles are allowed)",
    path, said, BinaryLength(said), size, (long)PETSC_MAX_INT / 9);
  PetscCheckUser(*n >= 0, comm, "%s is no STL file: it does not begin with 'solid' and is too short for a binary one",
                 path);
  PetscCheckUser(*n > 0, comm, "the STL file %s has no triangle", path);
  PetscFunctionReturn(PETSC_SUCCESS);
}
