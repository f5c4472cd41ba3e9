/* Contact lines that move: the angle depends on the line's speed (-wall_contact_law).

   A line that advances bends the free surface within a layer far thinner than a spacing, so that the angle that a
   simulation sees is larger than the one at rest; behind a line that recedes it is smaller. Both laws have the form
   X(angle) = X(angle at rest) + Ca L, with the capillary number Ca = mu U/sigma of the line, positive if it advances:

   cox_voinov   X = int_0^angle (x - sin x cos x)/(2 sin x) dx and L = ln(spacing/slip length): Voinov (1976), Cox
   (1986) for a liquid beside a gas. It stands for the bending below the spacing; the flow computes the bending above.
   kistler      X is the inverse of Hoffman's function f(x) = acos(1 - 2 tanh(5.16 (x/(1 + 1.31 x^0.99))^0.706)) and
                L = 1: Kistler (1993), the experiments of Hoffman (1975) in tubes of 2 mm. It stands for the bending
   below a millimetre; a fine spacing computes a part of it once more.

   With hysteresis the angle at rest is the advancing or the receding one, and the dry friction of lines/hysteresis.c
   has its part of the force.

   The speed of a line is that of the free surface along the wall, v.n/|n - (n.i) i| with n the normal of the surface
   and i of the wall, in the mean over surface particles near the wall and around. It follows with the period
   of a capillary wave one spacing long, sqrt(rho d0^3/sigma): otherwise angle and speed of viscous liquid would
   oscillate from step to step. A particle that arrives at the wall takes the capillary number of its neighbours. */
#include "lines.h"

#define REACH 0.75 /* supports of W^H, distance from a wall to which particles tell the line's speed */
#define ENDS  0.5  /* least part along the wall of the normal of a surface that ends there */
#define ANGLE_LEAST                                                                                                    \
  (20 * PETSC_PI / 180) /* where contact angles were tried, rad; a line that recedes faster leaves a ... */
#define ANGLE_MOST (165 * PETSC_PI / 180) /* ... film, one that advances faster takes air with it */
#define SLIP       1e-9                   /* m, default: molecular; ln(0.1 mm/1 nm) = 11.5, experiments have 9 to 13 */
#define BISECTIONS 60

#define TABLE 1024

typedef enum { LAW_STATIC, LAW_COX_VOINOV, LAW_KISTLER } Law;
static const char *const Laws[] = {"static", "cox_voinov", "kistler", NULL};

typedef struct {
  int        law;            /* of the angle */
  PetscReal  slip;           /* m */
  PetscReal  x[TABLE + 1];   /* X over the angle */
  PetscReal *bend;           /* [n_total] LineBend of FIELD_LINE */
  PetscReal  fastest;        /* see LinesFastest */
  PetscReal *start, *wanted; /* [n_fluid] FIELD_LINE before the step, and what it tends to */
} Lines;

/* The inverse of Hoffman's function. */
static PetscReal Hoffman(PetscReal angle)
{
  const PetscReal wanted = PetscPowReal(PetscAtanhReal(0.5 * (1 - PetscCosReal(angle))) / 5.16, 1 / 0.706);
  PetscReal       low = 0, high = 1;

  while (high / (1 + 1.31 * PetscPowReal(high, 0.99)) < wanted) high *= 2;
  for (PetscInt k = 0; k < BISECTIONS; k++) {
    const PetscReal x = 0.5 * (low + high);

    if (x / (1 + 1.31 * PetscPowReal(x, 0.99)) < wanted)
      low = x;
    else
      high = x;
  }
  return 0.5 * (low + high);
}

static PetscReal CoxSlope(PetscReal x)
{
  return x > 0 ? (x - PetscSinReal(x) * PetscCosReal(x)) / (2 * PetscSinReal(x)) : 0;
}

static const OptionRow law[] = {
  {"-wall_contact_law", "Angle of a contact line that moves, on walls and solids: as at rest, or by its speed", NULL,
   NULL, ROW_WORD, offsetof(Lines, law), .words = Laws},
  {.name = NULL},
};
static const OptionRow slip[] = {
  {"-wall_contact_slip", "Slip length of -wall_contact_law cox_voinov: 1e-9 is molecular; a rough wall has more", "m",
   "(0, inf)", ROW_REAL, offsetof(Lines, slip)},
  {.name = NULL},
};

static PetscErrorCode Read(void *data, OptionItems PetscOptionsObject, PetscBool *move)
{
  Lines          *line = (Lines *)data;
  const PetscReal d    = ANGLE_MOST / TABLE;

  PetscFunctionBegin;
  line->slip = SLIP;
  PetscCall(OptionsRead(PetscOptionsObject, law, "TensionSetFromOptions", line));
  PetscCall(OptionsReadIf(PetscOptionsObject, (PetscBool)(line->law == LAW_COX_VOINOV), "-wall_contact_law cox_voinov",
                          slip, "TensionSetFromOptions", line));
  for (PetscInt k = 1; k <= TABLE; k++)
    line->x[k] = line->law == LAW_KISTLER
                   ? Hoffman(k * d)
                   : line->x[k - 1] + d / 6 * (CoxSlope((k - 1) * d) + 4 * CoxSlope((k - 0.5) * d) + CoxSlope(k * d));
  *move = (PetscBool)(line->law != LAW_STATIC);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const char *LawOf(const void *data)
{
  return Laws[data ? ((const Lines *)data)->law : LAW_STATIC];
}

PetscReal LineBend(const void *data, PetscReal spacing, PetscReal size, PetscReal capillary)
{
  const Lines *line = (const Lines *)data;

  if (capillary == 0 || line->law == LAW_KISTLER) return capillary;
  return capillary * PetscMax(0, PetscLogReal(size * spacing / line->slip));
}

/* The angle (rad) of a line with this angle at rest (rad) and LineBend. */
static PetscReal Angle(const void *data, PetscReal at_rest, PetscReal bend)
{
  const Lines    *line  = (const Lines *)data;
  const PetscReal place = PetscMin(at_rest / ANGLE_MOST, 1) * TABLE;
  const PetscInt  k     = PetscMin((PetscInt)place, TABLE - 1);
  const PetscReal x     = line->x[k] + (place - k) * (line->x[k + 1] - line->x[k]) + bend;
  PetscInt        low = 0, high = TABLE;

  while (high - low > 1) {
    const PetscInt middle = (low + high) / 2;

    if (line->x[middle] <= x)
      low = middle;
    else
      high = middle;
  }
  return PetscMax(PetscMin(ANGLE_LEAST, at_rest),
                  PetscMin(PetscMax(ANGLE_MOST, at_rest),
                           (low + (x - line->x[low]) / (line->x[high] - line->x[low])) * (ANGLE_MOST / TABLE)));
}

static PetscErrorCode Start(void *data, Cloud cloud, const PetscReal **bend)
{
  Lines *line = (Lines *)data;

  PetscFunctionBegin;
  PetscCall(CloudUpdate(cloud, FIELD_LINE));
  PetscCall(PetscRealloc(PetscMax(1, cloud->n_total) * sizeof(PetscReal), &line->bend));
  for (PetscInt a = 0; a < cloud->n_total; a++)
    line->bend[a] = LineBend(line, cloud->domain->spacing, cloud->size[a], cloud->field[FIELD_LINE][a]);
  *bend = line->bend;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the nearest wall or solid within 'reach' (m) of particle a; false: none. */
static PetscBool FindWall(Tension tension, Cloud cloud, PetscInt a, PetscReal reach, LineWall *wall)
{
  LineWall       walls[WALLS_NEAR];
  const PetscInt n = WallsNear(tension, cloud, a, reach, walls);

  if (n == 0) return PETSC_FALSE;
  *wall = walls[0];
  for (PetscInt k = 1; k < n; k++)
    if (walls[k].distance < wall->distance) *wall = walls[k];
  wall->distance = PetscMax(0, wall->distance);
  return PETSC_TRUE;
}

static PetscReal ViscosityOf(Cloud cloud, PetscInt a)
{
  return cloud->field[FIELD_VISCOSITY]
           ? cloud->field[FIELD_VISCOSITY][a]
           : BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->viscosity;
}

/* The capillary number of the line that particle a with the normal n out of the liquid tells, and its weight; weight 0:
   it is not at a line. */
static void Tell(Tension tension, Cloud cloud, PetscInt a, const PetscReal n[DIM], PetscReal *capillary,
                 PetscReal *weight)
{
  const PetscReal *v = cloud->field[FIELD_VELOCITY] + DIM * a, reach = REACH * TensionReach(tension) * cloud->size[a];
  PetscReal        flat[DIM], into, length, sigma, speed = 0;
  LineWall         wall;

  *weight = *capillary = 0;
  if (cloud->integer[INT_LAYER][a] || cloud->integer[INT_SURFACE][a] != 1 || Norm(n) == 0) return;
  sigma = BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension;
  if (sigma == 0) return;
  if (!FindWall(tension, cloud, a, reach, &wall)) return;
  into = Dot(n, wall.inward);
  for (PetscInt d = 0; d < DIM; d++) {
    flat[d] = n[d] - into * wall.inward[d];
    speed += n[d] * (v[d] - wall.velocity[d]);
  }
  length = Norm(flat);
  if (length < ENDS) return;
  *capillary = ViscosityOf(cloud, a) * speed / (length * sigma);
  *weight    = cloud->weight[a] * (1 - wall.distance / reach);
}

/* Means over particle a and its neighbours: of what they tell, and of their stored numbers unless they are zero. */
static void MeanAround(Tension tension, Cloud cloud, PetscInt a, const PetscReal told[], const PetscReal weight[],
                       PetscReal *mean, PetscReal *stored)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *line = cloud->field[FIELD_LINE];
  PetscReal        sum = weight[a] * told[a], w = weight[a], old = 0, w_old = 0;

  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt  b       = cloud->list[k];
    const PetscReal r[DIM]  = {x[DIM * a] - x[DIM * b], x[DIM * a + 1] - x[DIM * b + 1],
                               x[DIM * a + 2] - x[DIM * b + 2]},
                    support = KernelSupport(cloud->kernel) * CloudPairSize(cloud, a, b),
                    part    = weight[b] * PetscMax(0, 1 - Dot(r, r) / PetscSqr(support));

    sum += part * told[b];
    w += part;
    if (line && line[b] != 0) {
      old += part * line[b];
      w_old += part;
    }
  }
  *mean   = w > 0 ? sum / w : 0;
  *stored = w_old > 0 ? old / w_old : 0;
}

static PetscErrorCode Find(void *data, Tension tension, Cloud cloud, const PetscReal normal[])
{
  Lines           *line   = (Lines *)data;
  const PetscBool  moves  = (PetscBool)(line->law != LAW_STATIC);
  const PetscReal *stored = cloud->field[FIELD_LINE];
  PetscReal       *told, *weight;

  PetscFunctionBegin;
  if (!moves && line->fastest >= FAST_LINE) PetscFunctionReturn(PETSC_SUCCESS);
  line->fastest = 0;
  PetscCall(CloudGetWork(cloud, 1, &told));
  PetscCall(CloudGetWork(cloud, 1, &weight));
  for (PetscInt a = 0; a < cloud->n_total; a++) Tell(tension, cloud, a, normal + DIM * a, &told[a], &weight[a]);
  if (moves) {
    PetscCall(PetscRealloc(PetscMax(1, cloud->n_fluid) * sizeof(PetscReal), &line->wanted));
    PetscCall(PetscRealloc(PetscMax(1, cloud->n_fluid) * sizeof(PetscReal), &line->start));
  }
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal mean = 0, around = 0;
    LineWall  wall;

    if (Norm(normal + DIM * a) > 0 && FindWall(tension, cloud, a, TensionReach(tension) * cloud->size[a], &wall))
      MeanAround(tension, cloud, a, told, weight, &mean, &around);
    line->fastest = PetscMax(line->fastest, PetscAbsReal(mean));
    if (!moves) continue;
    line->wanted[a] = mean;
    line->start[a]  = mean == 0 ? 0 : stored[a] != 0 ? stored[a] : around;
  }
  PetscCall(CloudRestoreWork(cloud, &weight));
  PetscCall(CloudRestoreWork(cloud, &told));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(void *data)
{
  Lines *line = (Lines *)data;

  PetscFunctionBegin;
  PetscCall(PetscFree(line->bend));
  PetscCall(PetscFree(line->wanted));
  PetscCall(PetscFree(line->start));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal LinesFastest(Tension tension)
{
  const Lines *line = (const Lines *)TensionLines(tension);

  return line ? line->fastest : 0;
}

void LinesMove(Tension tension, Cloud cloud, PetscReal dt)
{
  const Lines *line = (const Lines *)TensionLines(tension);

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const Material *m     = BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]));
    const PetscReal s     = cloud->size[a] * cloud->domain->spacing,
                    share = PetscMin(1, dt * PetscSqrtReal(m->tension / (m->density * s * s * s)));

    cloud->field[FIELD_LINE][a] = line->start[a] + share * (line->wanted[a] - line->start[a]);
  }
}

const LineOps MovingLines = {sizeof(Lines), Read, LawOf, Start, Angle, Find, Destroy};
