/* The parts of a body, for what makes them: shapes, velocity fields, viscosities, types, motions. Each is a table of
   functions with data in the body. */
#ifndef ISPH_BODY_H
#define ISPH_BODY_H

#include "scene.h"

#define SCENE_NAME_LENGTH OPTION_WORD_LENGTH
#define BODY_HOLES_MOST   64

/* A shape. */
typedef struct {
  Choice choice;
  /* Signed distance of x (m), negative inside. The sign is exact; the absolute value may be less than the distance. */
  PetscReal (*distance)(Body body, const PetscReal x[DIM]);
  void (*bounds)(Body body, PetscReal lower[DIM], PetscReal upper[DIM]); /* bounds of the shape, m */
  void (*displace)(Body body, PetscReal x[DIM]);                         /* see BodyDisplace; NULL: not at all */
  PetscReal (*wave)(Body body); /* wavelength of the surface, m; 0 or NULL: no waves */
  PetscBool boxed;              /* its surface is that of its bounds */
} ShapeOps;

/* An initial velocity field, added to the uniform part -<b>_velocity. */
typedef struct {
  Choice choice;
  void (*add)(Body body, const PetscReal x[DIM], PetscReal v[DIM]); /* adds to v (m/s) at x (m); NULL: zero */
} VelocityOps;

/* A viscosity model. */
typedef struct {
  Choice choice;
  PetscReal (*at)(Body body, PetscReal rate); /* mu (Pa s) at a shear rate (1/s); NULL: constant */
} ViscosityOps;

/* Moments of SceneMoments. MomentAdd - adds a time (s) if it lies in the run and there is room. MomentPeriod - adds the
   eighths of the first period of an oscillation with this frequency (Hz; 0: none) from a time (s): where it and its
   rate are extreme, and between. MomentTable - the frequency of column c of a table, [rows][columns] with the time (s)
   in column 0, if it turns often enough to have one. Not collective. */
typedef struct {
  PetscReal  start, end; /* s, of the run */
  PetscInt   most, n;
  PetscReal *time;      /* [n] s */
  PetscReal  frequency; /* Hz, the largest of what swings; 0: nothing does */
} Moments;
void MomentTable(Moments *moments, const PetscReal table[], PetscInt rows, PetscInt columns, PetscInt c);

static inline void MomentAdd(Moments *moments, PetscReal time)
{
  for (PetscInt k = 0; k < moments->n; k++)
    if (moments->time[k] == time) return;
  if (time >= moments->start && time <= moments->end && moments->n < moments->most) moments->time[moments->n++] = time;
}

static inline void MomentPeriod(Moments *moments, PetscReal frequency, PetscReal start)
{
  moments->frequency = PetscMax(moments->frequency, frequency);
  for (PetscInt k = 0; k < 8 && frequency > 0; k++)
    MomentAdd(moments, PetscMax(start, moments->start) + k / (8 * frequency));
}

/* A type of body. Liquid that is there from the start has none of these. */
typedef struct {
  Choice    choice;
  PetscBool later;                                                         /* see BodyComesLater */
  PetscBool (*holds)(Body body, const PetscReal x[DIM], PetscReal behind); /* see BodyHolds */
  void (*moments)(Body body, Moments *moments);                            /* adds those of the body */
  PetscInt (*fillings)(Body body, PetscReal time);                         /* see BodyFillings, BodyFillingVelocity */
  void (*velocity)(Body body, PetscReal time, const PetscReal x[DIM], PetscReal v[DIM]);
} BodyTypeOps;

/* How solids move (bodies/). All are called for solids alone, those behind 'json' for one that moves. */
typedef struct {
  const OptionRow *rows[2]; /* tables of its options, and where in the body their data are, bytes */
  size_t           data[2];
  PetscErrorCode (*read)(Body solid, OptionItems items);
  PetscErrorCode (*setup)(Body solid); /* refuses contradictions; frees the data of a solid at rest */
  PetscErrorCode (*destroy)(Body solid);
  void (*json)(Body solid, Json *json);                   /* members of the open object of scene.json */
  PetscErrorCode (*check)(Body solid, PetscReal density); /* density: the largest one of the liquids, kg/m3 */
  PetscErrorCode (*view)(Body solid, PetscBool tension, PetscViewer viewer);
  void (*move)(Body solid, PetscReal time); /* to its position at a time (s) */
  void (*back)(Body solid, const PetscReal x[DIM],
               PetscReal y[DIM]);              /* y (m): where the point at x was at the time 0 */
  void (*forth)(Body solid, PetscReal x[DIM]); /* moves the point that was at x (m) at the time 0 to where it is */
  void (*velocity)(Body solid, PetscReal time, const PetscReal x[DIM], PetscReal v[DIM]); /* see BodyMotion */
  PetscReal (*speed)(Body solid, const PetscReal lower[DIM],
                     const PetscReal upper[DIM]); /* bound of it in a box, m/s */
  void (*moments)(Body solid, Moments *moments);
} MotionOps;

/* How liquid wets solids (tension/contact.c). */
typedef struct {
  size_t           size; /* of the data, bytes */
  const OptionRow *rows;
  PetscErrorCode (*check)(Body solid); /* refuses contradictions */
} WettingOps;

struct _p_Body {
  Domain              domain; /* borrowed */
  char                name[SCENE_NAME_LENGTH];
  char                prefix[SCENE_NAME_LENGTH + 1]; /* of the options: the name and an underscore */
  char                shape_type[SCENE_NAME_LENGTH];
  char                velocity_type[SCENE_NAME_LENGTH];
  const ShapeOps     *shape;
  const VelocityOps  *velocity;
  void               *shape_data; /* the shape's own struct, freed with PetscFree */
  PetscInt            holes;
  struct _p_Body     *hole[BODY_HOLES_MOST]; /* shapes that are cut out; they have a shape only */
  void               *velocity_data;         /* as shape_data */
  char                viscosity_type[SCENE_NAME_LENGTH];
  const ViscosityOps *viscosity;      /* NULL of a solid */
  void               *viscosity_data; /* as shape_data */
  PetscReal           uniform[DIM];   /* uniform part of the velocity, m/s */
  Material            material;
  Properties          own; /* what features give it */
  char                type[SCENE_NAME_LENGTH];
  const BodyTypeOps  *kind;                /* NULL of a solid */
  void               *type_data;           /* as shape_data */
  void               *wetting;             /* of a solid, as shape_data */
  PetscReal           middle[DIM], extent; /* of a solid: a ball (m) that holds it where it is now */
  struct _p_Motion   *motion;              /* of a solid that can move; else NULL */
  struct _p_Free     *free;                /* of a free body; else NULL */
};

/* ShapeDistance - signed distance (m) of x (m) to the shape less its holes, at the time 0. BodyForth - moves the point
   of the body that was at x (m) at the time 0 to where it is. Not collective. */
PetscReal ShapeDistance(Body body, const PetscReal x[DIM]);
void      BodyForth(Body body, PetscReal x[DIM]);
/* BodyFindBall - finds the extent of a solid about its middle. BodyBeyond - whether x (m) is farther than reach (m)
   from the ball of a solid and of its periodic images. Not collective. */
void      BodyFindBall(Body solid);
PetscBool BodyBeyond(Body solid, PetscReal reach, const PetscReal x[DIM]);
/* TableRead - the table of a file: *rows lines of *columns numbers, least <= *columns <= most, which rank 0 reads and
   sends to the others; *table ([rows][columns], PetscFree) is NULL if the path is empty. Sets the file's checksum.
   Skips a byte-order mark, blank lines, comments (#), and a first other line that has the names of the columns. Refuses
   (UserError), by the option's name, 'what' a line must have and 'first' ("later time") its first number must be, a
   file that cannot be read, a line with other than finite numbers, of another length or with no later time than the
   line before, and fewer than two lines. Collective.
 */
PetscErrorCode TableRead(MPI_Comm comm, const char option[], const char what[], const char first[], PetscInt least,
                         PetscInt most, OptionFile *file, PetscInt *rows, PetscInt *columns, PetscReal **table);
/* RateCheck - completes the numbers of -<prefix>rotation_rate to a vector (rad/s), zero without numbers, and refuses
   (UserError) numbers that are no angular velocity. Collective. */
PetscErrorCode RateCheck(Domain domain, const char prefix[], const OptionNumbers *given, PetscReal rate[DIM]);
#define SPEED_MAX 1e5 /* m/s, of a solid: some seventy times the speed of sound in water */

#endif
