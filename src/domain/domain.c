/* The box: its options, the cells of the partition, and the positions of points relative to the box. */
#include "domain.h"
#include <string.h>

#define NAME_LENGTH 64
/* Of the partition: METIS takes 0.04 s for 60 k cells, and every rank stores the owners of all cells. */
#define CELLS_MAX        200000
#define CELL_GROWTH      1.05  /* factor by which the cell size grows until there are at most CELLS_MAX cells */
#define LENGTH_ROUNDING  1e-12 /* relative; a box exactly as wide as the reach of the kernel is allowed */
#define DUMMY_LAYERS_MAX 20    /* layers of dummy particles, on both sides of the box together */
#define COARSE_RATIO_MAX 8     /* of the coarse to the fine spacing: larger ratios are untested */
#define DEFAULT_GROWTH   0.1

const char *const        FaceTypes[]    = {"open", "periodic", "wall", "symmetry", NULL};
static const char *const AxisNames[DIM] = {"x", "y", "z"};

PetscErrorCode DomainCreate(MPI_Comm comm, Domain *domain)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(domain)); /* all faces are open */
  (*domain)->comm = comm;
  (*domain)->dim  = DIM;
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define PLACE "DomainSetFromOptions"

#define OF_AXIS "Type of both faces of a direction"
#define OF_FACE "Type of one face"

/* Reads the option -box_<name>: the type of the faces first to last of direction d. */
static PetscErrorCode ReadFaceType(Domain domain, OptionItems PetscOptionsObject, const char name[], const char what[],
                                   PetscInt d, PetscInt first, PetscInt last)
{
  char            option[NAME_LENGTH];
  const OptionRow rows[] = {{option, what, NULL, NULL, ROW_WORD, 0, .words = FaceTypes}, {.name = NULL}};

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(option, sizeof(option), "-%s", name));
  PetscCall(OptionsRead(PetscOptionsObject, rows, PLACE, &domain->face[d][first]));
  for (PetscInt side = first; side <= last; side++) domain->face[d][side] = domain->face[d][first];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For -help and its like, which tell the types of faces once. */
static const OptionRow types[] = {
  {"-<axis>", OF_AXIS, NULL, NULL, ROW_WORD, 0, .words = FaceTypes},
  {"-<face>", OF_FACE ", xmin, xmax, ymin, ...", NULL, NULL, ROW_WORD, 0, .words = FaceTypes},
  {.name = NULL},
};

static const OptionRow moving[] = {
  {"-velocity", "Velocity of a wall face, tangential", "m/s", NULL, ROW_DIRECTION, 0},
  {.name = NULL},
};

static PetscErrorCode CheckFaceVelocity(Domain domain, PetscInt d, PetscInt side)
{
  char             option[NAME_LENGTH];
  const PetscReal *velocity = domain->wall_velocity[d][side];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(option, sizeof(option), "-box_%s_velocity", FaceNames[d][side]));
  PetscCheckUser(!OptionFind(option)->given || domain->face[d][side] == FACE_WALL, domain->comm,
                 "%s: the face is %s; only a wall has a velocity", option, FaceTypes[domain->face[d][side]]);
  PetscCheckUser(velocity[d] == 0, domain->comm,
                 "%s must be tangential: its %s component must be 0, not %g m/s; a wall that moves along its normal is "
                 "a solid",
                 option, AxisNames[d], (double)velocity[d]);
  PetscCheckUser(!domain->rings || velocity[0] == 0, domain->comm,
                 "%s must have 0 as its first number, not %g m/s: with -dimension axisymmetric a wall moves along the "
                 "axis only",
                 option, (double)velocity[0]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadFaces(Domain domain)
{
  const PetscBool all = OptionsAll();

  PetscFunctionBegin;
  if (all) {
    FaceType any = FACE_OPEN;

    PetscOptionsBegin(domain->comm, "box_", "Faces of the box", "Domain");
    PetscCall(OptionsRead(PetscOptionsObject, types, PLACE, &any));
    PetscOptionsEnd();
  }
  if (domain->rings) domain->face[0][0] = FACE_SYMMETRY; /* the axis */
  PetscOptionsBegin(domain->comm, "box_", "Faces of the box", "Domain");
  if (all) PetscOptionsObject->alreadyprinted = PETSC_TRUE;
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscInt first = DomainIsRadial(domain, d);

    if (!first) PetscCall(ReadFaceType(domain, PetscOptionsObject, AxisNames[d], OF_AXIS, d, 0, 1));
    for (PetscInt side = first; side < 2; side++)
      PetscCall(ReadFaceType(domain, PetscOptionsObject, FaceNames[d][side], OF_FACE, d, side, side));
    PetscCheckUser((domain->face[d][0] == FACE_PERIODIC) == (domain->face[d][1] == FACE_PERIODIC), domain->comm,
                   "-box_%s is %s but -box_%s is %s: a periodic face needs a periodic face opposite", FaceNames[d][0],
                   FaceTypes[domain->face[d][0]], FaceNames[d][1], FaceTypes[domain->face[d][1]]);
  }
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks the corners, and sets what follows from dimension, spacing and corners. */
static PetscErrorCode CheckBox(Domain domain)
{
  PetscReal particles = 1; /* the box and its walls have room for so many */

  PetscFunctionBegin;
  PetscCheckUser(!domain->rings || domain->lower[0] == 0, domain->comm,
                 "-box_lower must have 0 as its first number, not %g m: with -dimension axisymmetric the box begins at "
                 "the axis",
                 (double)domain->lower[0]);
  domain->volume = PetscPowRealInt(domain->spacing, (int)domain->dim);
  if (domain->dim == 2) {
    domain->lower[2] = -0.5 * domain->spacing;
    domain->upper[2] = 0.5 * domain->spacing;
  }
  for (PetscInt d = 0; d < DIM; d++) {
    /* A box thinner than one spacing holds no particle. The tolerance allows for the rounding of decimal input. */
    PetscCheckUser(domain->upper[d] - domain->lower[d] >= (1 - POINT_TOLERANCE) * domain->spacing, domain->comm,
                   "the box must be at least one -spacing (%g m) wide in %s: -box_upper %g m is less than that above "
                   "-box_lower %g m",
                   (double)domain->spacing, AxisNames[d], (double)domain->upper[d], (double)domain->lower[d]);
    if (d < domain->dim) particles *= (domain->upper[d] - domain->lower[d]) / domain->spacing + DUMMY_LAYERS_MAX;
  }
  PetscCheckUser(
    particles < PETSC_MAX_INT, domain->comm,
    "-spacing %g m is too small for the box: box and walls have room for %.2g particles, but this build of PETSc can "
    "number %.2g only",
    (double)domain->spacing, (double)particles, (double)PETSC_MAX_INT);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the domain is made of. */
typedef struct {
  int       dimension;
  PetscReal coarse; /* m */
} Given;

static const char *const Dimensions[] = {"2", "3", "axisymmetric", NULL};

static const OptionRow kind[] = {
  {"-dimension",
   "Number of dimensions; axisymmetric: particles are rings, x is the distance from the axis, y the position along the "
   "axis",
   NULL, NULL, ROW_WORD, offsetof(Given, dimension), .words = Dimensions},
  {.name = NULL},
};

static const OptionRow grading[] = {
  {"-spacing_coarse",
   "Largest particle spacing, far from the regions of -fine and from what -spacing_follow follows; 0: -spacing "
   "everywhere",
   "m", "[0, inf)", ROW_REAL, offsetof(Given, coarse)},
  {.name = NULL},
};

static const OptionRow spacing[] = {
  {"-spacing", "Particle spacing d0 (resolution)", "m", "(0, inf)", ROW_REAL, offsetof(struct _p_Domain, spacing),
   .fallback = OPTION_REQUIRED},
  {"-spacing_growth",
   "Increase of the spacing per distance from what is fine; 0.05 makes less noise if the spacing grows along a free "
   "surface",
   "1", "(0, 0.2]", ROW_REAL, offsetof(struct _p_Domain, growth), .changes = PETSC_TRUE},
  {"-box_lower", "Lower corner of the box", "m", NULL, ROW_POINT, offsetof(struct _p_Domain, lower),
   .fallback = OPTION_REQUIRED},
  {"-box_upper", "Upper corner of the box", "m", NULL, ROW_POINT, offsetof(struct _p_Domain, upper),
   .fallback = OPTION_REQUIRED},
  {.name = NULL},
};

PetscErrorCode DomainSetFromOptions(Domain domain)
{
  MPI_Comm  comm  = domain->comm;
  Given     given = {1, 0};
  PetscBool has_lower, has_upper;

  PetscFunctionBegin;
  domain->growth = DEFAULT_GROWTH;
  PetscOptionsBegin(comm, NULL, "Box", "Domain");
  PetscCall(OptionsRead(PetscOptionsObject, kind, PLACE, &given));
  domain->dim   = given.dimension == 1 ? 3 : 2;
  domain->rings = (PetscBool)(given.dimension == 2);
  PetscCall(DomainReadOptions(domain, PetscOptionsObject, spacing, PLACE, domain));
  PetscCall(OptionsRead(PetscOptionsObject, grading, PLACE, &given));
  PetscCheckUser(domain->spacing > 0, comm,
                 "-spacing is missing%s: the particle spacing (m) must be given and positive", OptionMeant("-spacing"));
  domain->graded         = (PetscBool)(given.coarse > 0);
  domain->spacing_coarse = domain->graded ? given.coarse : domain->spacing;
  PetscCheckUser(domain->spacing_coarse >= domain->spacing &&
                   domain->spacing_coarse <= (1 + LENGTH_ROUNDING) * COARSE_RATIO_MAX * domain->spacing,
                 comm, "-spacing_coarse %g m must be one to %d times -spacing, %g m", (double)given.coarse,
                 COARSE_RATIO_MAX, (double)domain->spacing);
  PetscCall(PetscOptionsHasName(NULL, NULL, "-box_lower", &has_lower));
  PetscCall(PetscOptionsHasName(NULL, NULL, "-box_upper", &has_upper));
  PetscCheckUser(has_lower && has_upper, comm,
                 "%s is missing%s: the corners of the box, -box_lower and -box_upper (m), must be given",
                 has_lower ? "-box_upper" : "-box_lower", OptionMeant(has_lower ? "-box_upper" : "-box_lower"));
  PetscCall(CheckBox(domain));
  PetscOptionsEnd();
  PetscCall(ReadFaces(domain));
  PetscCall(DomainReadFaces(domain, moving, PLACE, DIM * sizeof(PetscReal), domain->wall_velocity));
  for (PetscInt f = DomainFirstStraight(domain); f < 2 * domain->dim; f++)
    PetscCall(CheckFaceVelocity(domain, f / 2, f % 2));
  for (PetscInt f = 0; f < 2 * DIM; f++) PetscCall(PropertiesMake(domain, OWNER_FACE, &domain->own[f / 2][f % 2]));
  PetscCall(DomainReadFaces(domain, NULL, PLACE, sizeof(Properties), domain->own));
  PetscCall(AdaptiveSetFromOptions(domain));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckReach(Domain domain, PetscReal reach)
{
  PetscFunctionBegin;
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal width = domain->upper[d] - domain->lower[d];

    for (PetscInt side = 0; side < 2; side++) {
      const FaceType type = domain->face[d][side];

      PetscCheckUser(
        (type != FACE_PERIODIC && type != FACE_SYMMETRY) || width >= (1 - LENGTH_ROUNDING) * reach, domain->comm,
        "the box is too small for the kernel: it is %g m wide in %s, where -box_%s is %s, but the kernel reaches %g m",
        (double)width, AxisNames[d], FaceNames[d][side], FaceTypes[type], (double)reach);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers of cells whose size (m) is at least 'size'. Returns their product, which may exceed an integer. */
static PetscReal CountCells(Domain domain, PetscReal size, PetscReal cells[DIM])
{
  PetscReal product = 1;

  for (PetscInt d = 0; d < DIM; d++) {
    cells[d] = d < domain->dim
                 ? PetscMax(1, PetscFloorReal((1 + LENGTH_ROUNDING) * (domain->upper[d] - domain->lower[d]) / size))
                 : 1;
    product *= cells[d];
  }
  return product;
}

PetscErrorCode DomainSetUp(Domain domain, PetscReal reach)
{
  PetscReal   cells[DIM], size = domain->graded ? reach * domain->spacing / domain->spacing_coarse : reach;
  PetscInt    count = 1;
  PetscMPIInt ranks;

  PetscFunctionBegin;
  PetscCheck(domain->spacing > 0, domain->comm, PETSC_ERR_ORDER,
             "DomainSetFromOptions must be called before DomainSetUp");
  PetscCheck(reach > 0 && !PetscIsInfOrNanReal(reach), domain->comm, PETSC_ERR_ARG_OUTOFRANGE,
             "reach must be positive, not %g m", (double)reach);
  PetscCall(CheckReach(domain, reach));
  while (CountCells(domain, size, cells) > CELLS_MAX) size *= CELL_GROWTH;
  for (PetscInt d = 0; d < DIM; d++) {
    domain->cells[d]     = (PetscInt)cells[d];
    domain->cell_size[d] = (domain->upper[d] - domain->lower[d]) / cells[d];
    count *= domain->cells[d];
  }
  PetscCall(PetscFree(domain->cell_rank));
  PetscCall(PetscMalloc1(count, &domain->cell_rank));
  PetscCallMPI(MPI_Comm_size(domain->comm, &ranks));
  for (PetscInt c = 0; c < count; c++) domain->cell_rank[c] = (PetscMPIInt)((PetscInt64)c * ranks / count);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DomainView(Domain domain, PetscViewer viewer)
{
  PetscBool ascii;

  PetscFunctionBegin;
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(domain->comm, &viewer));
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (!ascii) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscViewerASCIIPrintf(viewer, "Domain: %" PetscInt_FMT " dimensions%s, spacing %g m", domain->dim,
                                   domain->rings ? " of rings about x = 0" : "", (double)domain->spacing));
  if (domain->graded)
    PetscCall(PetscViewerASCIIPrintf(viewer, " to %g m, increasing by %g per distance", (double)domain->spacing_coarse,
                                     (double)domain->growth));
  PetscCall(PetscViewerASCIIPrintf(viewer, "\n"));
  PetscCall(PetscViewerASCIIPushTab(viewer));
  for (PetscInt d = 0; d < domain->dim; d++) {
    PetscCall(PetscViewerASCIIPrintf(viewer, "%s: %g to %g m, %s to %s, %" PetscInt_FMT " cells of %g m\n",
                                     AxisNames[d], (double)domain->lower[d], (double)domain->upper[d],
                                     FaceTypes[domain->face[d][0]], FaceTypes[domain->face[d][1]], domain->cells[d],
                                     (double)domain->cell_size[d]));
    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal *v = domain->wall_velocity[d][side];
      char             text[VECTOR_TEXT];

      if (Dot(v, v) > 0)
        PetscCall(PetscViewerASCIIPrintf(viewer, "wall %s moves at %s m/s\n", FaceNames[d][side],
                                         VectorText(domain->dim, v, text)));
    }
  }
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void DomainIdentity(Domain domain, FILE *text)
{
  fprintf(text, "-dimension = %s\n", domain->rings ? "axisymmetric" : domain->dim == 2 ? "2" : "3");
  OptionsIdentity(text, "", spacing, domain, domain->dim);
  if (domain->graded) fprintf(text, "-spacing_coarse = %.12g\n", (double)domain->spacing_coarse);
  if (domain->adaptive) fprintf(text, "-spacing_follow = on\n"); /* what it follows may change */
  for (PetscInt f = 0; f < 2 * domain->dim; f++) {
    char prefix[NAME_LENGTH];

    (void)snprintf(prefix, sizeof(prefix), "box_%s_", FaceNames[f / 2][f % 2]);
    fprintf(text, "-box_%s = %s\n", FaceNames[f / 2][f % 2], FaceTypes[domain->face[f / 2][f % 2]]);
    PropertiesIdentity(domain, &domain->own[f / 2][f % 2], prefix, text);
  }
}

void DomainJson(Domain domain, Json *json)
{
  JsonObject(json, "domain");
  JsonInt(json, "dimension", domain->dim);
  JsonBool(json, "rings", domain->rings);
  JsonReal(json, "spacing", domain->spacing);
  JsonReal(json, "spacing_coarse", domain->spacing_coarse);
  JsonReal(json, "growth", domain->growth);
  JsonText(json, "follow", domain->adaptive ? domain->adaptive->name(domain) : "none");
  JsonReals(json, "lower", domain->dim, domain->lower);
  JsonReals(json, "upper", domain->dim, domain->upper);
  JsonArray(json, "faces");
  for (PetscInt f = 0; f < 2 * domain->dim; f++) {
    JsonObject(json, NULL);
    JsonText(json, "name", FaceNames[f / 2][f % 2]);
    JsonText(json, "type", FaceTypes[domain->face[f / 2][f % 2]]);
    JsonReals(json, "velocity", domain->dim, domain->wall_velocity[f / 2][f % 2]);
    PropertiesJson(domain, &domain->own[f / 2][f % 2], json);
    JsonEnd(json);
  }
  JsonEnd(json);
  JsonEnd(json);
}

PetscErrorCode DomainDestroy(Domain *domain)
{
  PetscFunctionBegin;
  if (!*domain) PetscFunctionReturn(PETSC_SUCCESS);
  if ((*domain)->adaptive) PetscCall((*domain)->adaptive->destroy(*domain));
  PetscCall(PetscFree((*domain)->adaptive_data));
  PetscCall(PetscFree((*domain)->cell_rank));
  for (PetscInt f = 0; f < 2 * DIM; f++) PetscCall(PropertiesFree(&(*domain)->own[f / 2][f % 2]));
  PetscCall(PetscFree((*domain)->property));
  PetscCall(PetscFree(*domain));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt DomainCell(Domain domain, const PetscReal x[DIM])
{
  PetscInt at[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    PetscReal t = (x[d] - domain->lower[d]) / domain->cell_size[d];

    if (!(t > 0)) t = 0; /* also NaN */
    if (t > (PetscReal)(domain->cells[d] - 1)) t = (PetscReal)(domain->cells[d] - 1);
    at[d] = (PetscInt)t;
  }
  return CellIndex(domain->cells, at[0], at[1], at[2]);
}

void DomainWrap(Domain domain, PetscReal x[DIM])
{
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal lower = domain->lower[d], upper = domain->upper[d];

    if (domain->face[d][0] != FACE_PERIODIC || (x[d] >= lower && x[d] < upper)) continue;
    x[d] -= (upper - lower) * PetscFloorReal((x[d] - lower) / (upper - lower));
    if (x[d] < lower || x[d] >= upper) x[d] = lower; /* after rounding at a face */
  }
}

void DomainNearest(Domain domain, PetscReal difference[DIM])
{
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal width = domain->upper[d] - domain->lower[d];

    if (domain->face[d][0] == FACE_PERIODIC) difference[d] -= width * PetscFloorReal(difference[d] / width + 0.5);
  }
}

void DomainConfine(Domain domain, PetscReal x[DIM])
{
  const PetscReal margin = POINT_TOLERANCE * domain->spacing;

  DomainWrap(domain, x);
  for (PetscInt d = 0; d < domain->dim; d++) {
    if (domain->face[d][0] == FACE_PERIODIC) continue;
    if (domain->face[d][0] == FACE_SYMMETRY && x[d] < domain->lower[d]) x[d] = 2 * domain->lower[d] - x[d];
    if (domain->face[d][1] == FACE_SYMMETRY && x[d] > domain->upper[d]) x[d] = 2 * domain->upper[d] - x[d];
    x[d] = PetscMax(domain->lower[d] + margin, PetscMin(domain->upper[d] - margin, x[d]));
  }
}

PetscReal DomainWallSpeed(Domain domain)
{
  PetscReal speed = 0;

  for (PetscInt f = 0; f < 2 * DIM; f++) speed = PetscMax(speed, Norm(domain->wall_velocity[f / 2][f % 2]));
  return speed;
}

void DomainWallVelocity(Domain domain, const PetscReal x[DIM], PetscReal v[DIM])
{
  PetscInt faces = 0;

  for (PetscInt d = 0; d < DIM; d++) v[d] = 0;
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal *face = domain->wall_velocity[d][x[d] < domain->lower[d] ? 0 : 1];

    if (x[d] >= domain->lower[d] && x[d] <= domain->upper[d]) continue;
    for (PetscInt c = 0; c < DIM; c++) v[c] = faces == 0 || v[c] == face[c] ? face[c] : 0;
    faces++;
  }
}

PetscInt DomainExit(Domain domain, const PetscReal x[DIM])
{
  for (PetscInt d = 0; d < domain->dim; d++) {
    if (domain->face[d][0] == FACE_OPEN && x[d] < domain->lower[d]) return 2 * d;
    if (domain->face[d][1] == FACE_OPEN && x[d] > domain->upper[d]) return 2 * d + 1;
  }
  return -1;
}

const char *DomainUnit(Domain domain, const char unit[])
{
  static const char *const flat[][2] = {{"J", "J/m"}, {"N", "N/m"},     {"Nm", "Nm/m"}, {"m3", "m2"},
                                        {"m2", "m"},  {"m3/s", "m2/s"}, {"W", "W/m"}};

  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(flat) && DomainIsFlat(domain); k++)
    if (!strcmp(unit, flat[k][0])) return flat[k][1];
  return unit;
}
