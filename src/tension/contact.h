/* Private to tension/: the contact angles of walls and solids. */
#ifndef ISPH_CONTACT_H
#define ISPH_CONTACT_H

#include "lines.h"

typedef struct {
  PetscReal angle, cosine, sine; /* in the liquid, rad; angle 0: no contact angle */
  PetscReal image_tilt;          /* half of the displacement of images along the wall, over their distance from it */
  PetscReal residual_tan;        /* 1/(cot(angle) - image_tilt) */
  PetscReal hysteresis_force;    /* (cos r - cos a)/2, over sigma: see lines/hysteresis.c */
} ContactAngle;

typedef struct {
  ContactAngle     face[DIM][2], *solid; /* of the walls of the box; [solids] */
  PetscInt         solids;               /* number of solids; 0: none has a contact angle */
  PetscBool        walls;                /* the box has walls */
  PetscBool        tilted;               /* a contact angle is not 90 degrees: see ImagesTilt */
  PetscBool        hysteresis;           /* some contact angle has hysteresis */
  void            *lines;                /* of MovingLines */
  PetscBool        lines_move;           /* angles depend on the speed of the line ... */
  const PetscReal *bend;                 /* [n_total] ... by MovingLines.angle; NULL: they are those at rest */
} Contacts;

/* ContactSetFromOptions - takes -<s>_contact_angle from the scene's solids; reads -wall_contact_angle and
   -box_<face>_contact_angle, inside an options block; refuses (UserError) a contact angle of a face that is no wall.
   ContactView - prints the angles of walls and solids, and warns of angles that look like radians. Collective.
   ContactJson - writes the angles into the open object. ContactMoving - the angle for images beside a particle with
   this bend. Not collective. */
PetscErrorCode ContactSetFromOptions(Tension tension, OptionItems PetscOptionsObject);
PetscErrorCode ContactView(Tension tension, PetscViewer viewer);
void           ContactJson(Tension tension, Json *json);
ContactAngle   ContactMoving(Tension tension, const ContactAngle *contact, PetscReal bend);
PetscErrorCode ContactDestroy(Tension tension);

#endif
