/* Contact angles of the walls of the box and of solids, from the options. images.c continues the liquid behind walls so
   that its surface has them. */
#include "../scene/body.h"
#include "curvature.h"

#define TILT_MOST   0.58 /* cot 60 degrees: see images.c */
#define ANGLE_LEAST 20.  /* degrees: contact angles nearer to 0 or 180 were not tried */

/* hysteresis: advancing angle less receding angle, around 'degrees'. */
static ContactAngle FromDegrees(PetscReal degrees, PetscReal hysteresis)
{
  const PetscReal angle   = degrees * (PETSC_PI / 180);
  ContactAngle    contact = {angle, PetscCosReal(angle), PetscSinReal(angle), 0, PetscTanReal(angle), 0};

  if (hysteresis > 0) {
    const PetscReal half = 0.5 * hysteresis * (PETSC_PI / 180);

    contact = FromDegrees(degrees == 90 ? 90 : acos(contact.cosine * PetscCosReal(half)) * (180 / PETSC_PI), 0);
    contact.hysteresis_force = PetscSinReal(angle) * PetscSinReal(half);
    return contact;
  }
  if (degrees == 90 || degrees == 0) return contact;
  contact.image_tilt = PetscMin(TILT_MOST, 1 / contact.residual_tan);
  contact.residual_tan =
    1 / contact.residual_tan > TILT_MOST ? 1 / (1 / contact.residual_tan - TILT_MOST) : PETSC_MAX_REAL;
  return contact;
}

/* Of a solid, or of all walls; degrees. */
typedef struct {
  PetscReal angle, hysteresis;
} Wetting;

static const OptionRow of_solids[] = {
  {"-contact_angle",
   "Contact angle of the free surface on the solid, in the liquid; without one the liquid does not wet it", "degrees",
   "(0, 180)", ROW_REAL, offsetof(Wetting, angle), .fallback = "none", .changes = PETSC_TRUE},
  {"-contact_hysteresis",
   "Advancing minus receding contact angle, half of it on either side of -contact_angle; between them contact lines do "
   "not move",
   "degrees", "[0, 180)", ROW_REAL, offsetof(Wetting, hysteresis), .changes = PETSC_TRUE},
  {.name = NULL},
};

static PetscErrorCode CheckSolid(Body body)
{
  const Wetting  *given = (const Wetting *)body->wetting;
  const PetscReal half  = 0.5 * given->hysteresis;

  PetscFunctionBegin;
  PetscCheckUser(half == 0 || given->angle > 0, body->domain->comm, "-%scontact_hysteresis needs -%scontact_angle",
                 body->prefix, body->prefix);
  PetscCheckUser(half == 0 || half < PetscMin(given->angle, 180 - given->angle), body->domain->comm,
                 "-%scontact_hysteresis %g: the contact angle, %g, plus and minus half of it must lie in (0, 180)",
                 body->prefix, (double)given->hysteresis, (double)given->angle);
  PetscCheckUser(given->angle == 0 || !body->free, body->domain->comm,
                 "-%scontact_angle cannot be used with -%smass: the surface tension's force on a free body is not "
                 "computed",
                 body->prefix, body->prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

const WettingOps SolidWetting = {sizeof(Wetting), of_solids, CheckSolid};

static const Wetting *WettingOf(Scene scene, PetscInt solid)
{
  return (const Wetting *)SceneSolid(scene, solid)->wetting;
}

PetscBool TensionSolidsWet(Scene scene)
{
  for (PetscInt s = 0; s < SceneSolidCount(scene); s++)
    if (WettingOf(scene, s)->angle > 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Takes the angles of the scene's solids. */
static PetscErrorCode SolidAngles(Tension tension)
{
  Contacts *contact = &CurvatureOf(tension)->contact;

  PetscFunctionBegin;
  contact->solids = TensionSolidsWet(tension->scene) ? SceneSolidCount(tension->scene) : 0;
  PetscCall(PetscCalloc1(contact->solids, &contact->solid));
  for (PetscInt s = 0; s < contact->solids; s++) {
    const Wetting *given = WettingOf(tension->scene, s);

    contact->solid[s] = FromDegrees(given->angle, given->hysteresis);
    if (contact->solid[s].hysteresis_force > 0) contact->hysteresis = PETSC_TRUE;
    if (contact->solid[s].image_tilt != 0) contact->tilted = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroy(Tension tension)
{
  Contacts *contact = &CurvatureOf(tension)->contact;

  PetscFunctionBegin;
  PetscCall(PetscFree(contact->solid));
  if (contact->lines) PetscCall(MovingLines.destroy(contact->lines));
  PetscCall(PetscFree(contact->lines));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow angles[] = {
  {"-wall_contact_angle", "Angle in the liquid at which the free surface meets the walls of the box (wetting)",
   "degrees", "(0, 180)", ROW_REAL, offsetof(Wetting, angle)},
  {"-wall_contact_hysteresis",
   "Advancing angle less receding angle, around the contact angle; between them contact lines do not move", "degrees",
   "[0, 180)", ROW_REAL, offsetof(Wetting, hysteresis)},
  {.name = NULL},
};

static const OptionRow of_faces[] = {
  {"-contact_angle", "Contact angle of this wall, if it differs", "degrees", "(0, 180)", ROW_REAL, 0,
   .fallback = "-wall_contact_angle"},
  {.name = NULL},
};

PetscErrorCode ContactSetFromOptions(Tension tension, OptionItems PetscOptionsObject)
{
  Curvature *data = tension->data;
  Wetting    all  = {90, 0};
  PetscReal  own[2 * DIM]; /* of the faces, degrees */

  PetscFunctionBegin;
  PetscCall(PetscCalloc(MovingLines.size, &data->contact.lines));
  PetscCall(MovingLines.read(data->contact.lines, PetscOptionsObject, &data->contact.lines_move));
  PetscCall(OptionsRead(PetscOptionsObject, angles, "TensionSetFromOptions", &all));
  for (PetscInt f = 0; f < 2 * DIM; f++) own[f] = all.angle;
  PetscCall(DomainReadFaces(SceneDomain(tension->scene), of_faces, "TensionSetFromOptions", sizeof(*own), own));
  for (PetscInt f = tension->rings ? 1 : 0; f < 2 * tension->dim; f++) {
    const PetscInt  d = f / 2, side = f % 2;
    const PetscReal angle = own[f];

    PetscCheckUser(angle == all.angle || tension->face[d][side] == FACE_WALL, tension->comm,
                   "-box_%s_contact_angle: the face is %s; only a wall has a contact angle", FaceNames[d][side],
                   FaceTypes[tension->face[d][side]]);
    PetscCheckUser(
      0.5 * all.hysteresis < PetscMin(angle, 180 - angle), tension->comm,
      "-wall_contact_hysteresis %g: half of it below and half above the contact angle, %g, must be in (0, 180)",
      (double)all.hysteresis, (double)angle);
    data->contact.face[d][side] = FromDegrees(angle, all.hysteresis);
    if (tension->face[d][side] != FACE_WALL) continue;
    data->contact.walls = PETSC_TRUE;
    if (all.hysteresis > 0) data->contact.hysteresis = PETSC_TRUE;
    if (data->contact.face[d][side].image_tilt != 0) data->contact.tilted = PETSC_TRUE;
  }
  PetscCall(SolidAngles(tension));
  if (data->contact.lines_move && (data->contact.walls || data->contact.solids)) data->contact.tilted = PETSC_TRUE;
  data->images.used = (PetscBool)(data->contact.tilted || data->contact.solids > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Warn(const ContactAngle *contact, const char what[], PetscViewer viewer)
{
  const PetscReal angle = contact->angle * 180 / PETSC_PI;

  PetscFunctionBegin;
  if (angle == 0 || PetscMin(angle, 180 - angle) >= ANGLE_LEAST) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscViewerASCIIPrintf(viewer,
                                   "warning: the contact angle of %g degrees of %s is outside %g to %g, where angles "
                                   "were tried; %g radians are %.4g degrees\n",
                                   (double)angle, what, ANGLE_LEAST, 180 - ANGLE_LEAST, (double)angle,
                                   (double)(angle * 180 / PETSC_PI)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool Angles(const ContactAngle *contact, PetscReal angle[2])
{
  if (contact->angle == 0) return PETSC_FALSE;
  angle[0] = 180 / PETSC_PI * acos(contact->cosine + contact->hysteresis_force);
  angle[1] = 180 / PETSC_PI * acos(contact->cosine - contact->hysteresis_force);
  return PETSC_TRUE;
}

PetscBool TensionFaceAngles(Tension tension, PetscInt d, PetscInt side, PetscReal angle[2])
{
  const Curvature *data = CurvatureOf(tension);

  return (PetscBool)(tension->active && data && tension->face[d][side] == FACE_WALL && d < tension->dim &&
                     Angles(&data->contact.face[d][side], angle));
}

PetscBool TensionSolidAngles(Tension tension, PetscInt s, PetscReal angle[2])
{
  const Curvature *data = CurvatureOf(tension);

  return (PetscBool)(tension->active && data && s < data->contact.solids && Angles(&data->contact.solid[s], angle));
}

PetscBool TensionHasHysteresis(Tension tension)
{
  const Curvature *data = CurvatureOf(tension);

  return (PetscBool)(tension->active && data && data->contact.hysteresis);
}

PetscBool TensionHasLaw(Tension tension)
{
  const Curvature *data = CurvatureOf(tension);

  return (PetscBool)(data && data->contact.lines_move);
}

PetscBool TensionHasAngles(Tension tension)
{
  const Curvature *data = CurvatureOf(tension);

  return (PetscBool)(data && (data->contact.tilted || data->contact.hysteresis));
}

/* The wall or solid with a contact angle of number k: its name, and its angles; false: there is none. *name NULL: no
   wall, no solid of this number. */
static PetscBool AnglesOf(Tension tension, PetscInt k, const char **name, PetscReal angle[2])
{
  const PetscInt faces = 2 * tension->dim;

  *name = k < faces                                     ? FaceNames[k / 2][k % 2]
          : k - faces < SceneSolidCount(tension->scene) ? BodyName(SceneSolid(tension->scene, k - faces))
                                                        : NULL;
  if (!*name) return PETSC_FALSE;
  return k < faces ? TensionFaceAngles(tension, k / 2, k % 2, angle) : TensionSolidAngles(tension, k - faces, angle);
}

void ContactJson(Tension tension, Json *json)
{
  PetscReal   angle[2];
  const char *name;

  JsonArray(json, "contact_angles");
  for (PetscInt k = 0; AnglesOf(tension, k, &name, angle) || name; k++) {
    if (!AnglesOf(tension, k, &name, angle)) continue;
    JsonObject(json, NULL);
    JsonText(json, "name", name);
    JsonReal(json, "receding", angle[0]);
    JsonReal(json, "advancing", angle[1]);
    JsonEnd(json);
  }
  JsonEnd(json);
}

/* Prints one angle, or the receding and the advancing angle, of each. */
static PetscErrorCode ViewAngles(Tension tension, PetscViewer viewer)
{
  PetscReal   angle[2];
  const char *name;
  PetscBool   first = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt k = 0; AnglesOf(tension, k, &name, angle) || name; k++) {
    if (!AnglesOf(tension, k, &name, angle)) continue;
    PetscCall(
      PetscViewerASCIIPrintf(viewer, "%s %s %.4g", first ? "Contact angles in degrees:" : ",", name, (double)angle[0]));
    if (angle[1] > angle[0]) PetscCall(PetscViewerASCIIPrintf(viewer, " to %.4g", (double)angle[1]));
    first = PETSC_FALSE;
  }
  if (!first) PetscCall(PetscViewerASCIIPrintf(viewer, "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactView(Tension tension, PetscViewer viewer)
{
  const Curvature    *data  = CurvatureOf(tension);
  const ContactAngle *worst = NULL;

  PetscFunctionBegin;
  if (!data) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ViewAngles(tension, viewer));
  for (PetscInt f = 0; f < 2 * tension->dim; f++) {
    const ContactAngle *contact = &data->contact.face[f / 2][f % 2];

    if (contact->angle > 0 && (!worst || contact->sine < worst->sine)) worst = contact;
  }
  if (worst) PetscCall(Warn(worst, "a wall", viewer));
  for (PetscInt s = 0; s < data->contact.solids; s++) PetscCall(Warn(&data->contact.solid[s], "a solid", viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The friction of hysteresis adds its part. */
ContactAngle ContactMoving(Tension tension, const ContactAngle *contact, PetscReal bend)
{
  const PetscReal friction = bend > 0 ? contact->hysteresis_force : -contact->hysteresis_force;
  PetscReal       angle;
  ContactAngle    moving;

  if (bend == 0) return *contact;
  angle  = MovingLines.angle(CurvatureOf(tension)->contact.lines, acos(contact->cosine - friction), bend);
  moving = FromDegrees(acos(PetscMin(1, PetscMax(-1, PetscCosReal(angle) + friction))) * (180 / PETSC_PI), 0);
  moving.hysteresis_force = contact->hysteresis_force;
  return moving;
}
