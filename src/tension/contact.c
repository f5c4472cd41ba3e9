/* Contact angles: images continue the liquid and its normals behind walls, so that the surface meets the wall at the
   contact angle.

   A face of the box is a mirror; for solids see contact_solid.c.

   A mirror reverses the slope of the surface. So for each particle near a wall the images are moved along the wall, by
   2 s cot(angle) out of the liquid: a surface that meets the wall at the contact angle then continues straight behind
   the wall (ContactTilt). For small angles this would need particles that are too far away. So images are moved by 2 s
   TILT_MOST at most, and the residual of the cotangent becomes a part of grad phi normal to the wall (SumMirrored in
   curvature.c). The mean of the normals of a particle and its image has the contact angle.

   Only the free surface meets the wall under the contact angle; the parallel surface at the depth s below it, to which
   the normal of a particle belongs, meets it under another one if it is curved. So where normals count, the image is
   that of the particle's foot on the free surface, moved back by s along the image's normal (MoveImages). Otherwise
   menisci between two walls ten spacings apart pull 11 % too much at 60 degrees and 8 % too little at 120.

   An image may be nearer than its particle. Which particles beyond the support are known depends on cells and ranks, so
   their images are left out. */
#include "../scene/body.h"
#include "curvature.h"

/* A surface ends at a wall if the part of its normal along the wall is at least this times the sine of the contact
   angle. */
#define PARALLEL    0.5
#define TILT_MOST   0.58 /* cot 60 degrees */
#define FAR_AWAY    1e30 /* m */
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
   "(0, 180)", ROW_REAL, offsetof(Wetting, angle), .fallback = "none"},
  {"-contact_hysteresis",
   "Advancing minus receding contact angle, half of it on either side of -contact_angle; between them contact lines do "
   "not move",
   "degrees", "[0, 180)", ROW_REAL, offsetof(Wetting, hysteresis)},
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
  Curvature    *data  = tension->data;
  SolidContact *solid = &data->solid;

  PetscFunctionBegin;
  solid->count = TensionSolidsWet(tension->scene) ? SceneSolidCount(tension->scene) : 0;
  PetscCall(PetscCalloc1(solid->count, &solid->angle));
  for (PetscInt s = 0; s < solid->count; s++) {
    const Wetting *given = WettingOf(tension->scene, s);

    solid->angle[s] = FromDegrees(given->angle, given->hysteresis);
    if (solid->angle[s].hysteresis_force > 0) data->hysteresis = PETSC_TRUE;
    if (solid->angle[s].image_tilt != 0) data->tilted = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroy(Tension tension)
{
  Curvature *data = tension->data;

  PetscFunctionBegin;
  PetscCall(PetscFree(data->solid.angle));
  PetscCall(PetscFree(data->images.parent));
  PetscCall(PetscFree(data->images.origin));
  PetscCall(PetscFree(data->images.volume));
  if (data->lines) PetscCall(MovingLines.destroy(data->lines));
  PetscCall(PetscFree(data->lines));
  PetscCall(SortedCellsReset(&data->solid.dummies));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow angles[] = {
  {"-wall_contact_angle", "Angle in the liquid at which the free surface meets the walls of the box", "degrees",
   "(0, 180)", ROW_REAL, offsetof(Wetting, angle)},
  {"-wall_contact_hysteresis",
   "Advancing angle less receding angle, around the contact angle; between them contact lines do not move", "degrees",
   "[0, 180)", ROW_REAL, offsetof(Wetting, hysteresis)},
  {.name = NULL},
};

PetscErrorCode ContactSetFromOptions(Tension tension, OptionItems PetscOptionsObject)
{
  Curvature *data = tension->data;
  Wetting    all  = {90, 0};

  PetscFunctionBegin;
  PetscCall(PetscCalloc(MovingLines.size, &data->lines));
  PetscCall(MovingLines.read(data->lines, PetscOptionsObject, &data->lines_move));
  PetscCall(OptionsRead(PetscOptionsObject, angles, "TensionSetFromOptions", &all));
  for (PetscInt f = tension->rings ? 1 : 0; f < 2 * tension->dim; f++) {
    const PetscInt  d = f / 2, side = f % 2;
    char            option[OPTION_NAME_LENGTH];
    const OptionRow one[] = {{option, "Contact angle of this wall, if it differs", "degrees", "(0, 180)", ROW_REAL, 0},
                             {.name = NULL}};
    PetscReal       angle = all.angle;

    PetscCall(PetscSNPrintf(option, sizeof(option), "-box_%c%s_contact_angle", "xyz"[d], side ? "max" : "min"));
    PetscCall(OptionsRead(PetscOptionsObject, one, "TensionSetFromOptions", &angle));
    PetscCheckUser(angle == all.angle || tension->face[d][side] == FACE_WALL, tension->comm,
                   "%s: the face is %s; only a wall has a contact angle", option, FaceTypes[tension->face[d][side]]);
    PetscCheckUser(
      0.5 * all.hysteresis < PetscMin(angle, 180 - angle), tension->comm,
      "-wall_contact_hysteresis %g: half of it below and half above the contact angle, %g, must be in (0, 180)",
      (double)all.hysteresis, (double)angle);
    data->contact[d][side] = FromDegrees(angle, all.hysteresis);
    if (tension->face[d][side] != FACE_WALL) continue;
    data->walls = PETSC_TRUE;
    if (all.hysteresis > 0) data->hysteresis = PETSC_TRUE;
    if (data->contact[d][side].image_tilt != 0) data->tilted = PETSC_TRUE;
  }
  PetscCall(SolidAngles(tension));
  if (data->lines_move && (data->walls || data->solid.count)) data->tilted = PETSC_TRUE;
  data->images.used = (PetscBool)(data->tilted || data->solid.count > 0);
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
                     Angles(&data->contact[d][side], angle));
}

PetscBool TensionSolidAngles(Tension tension, PetscInt s, PetscReal angle[2])
{
  const Curvature *data = CurvatureOf(tension);

  return (PetscBool)(tension->active && data && s < data->solid.count && Angles(&data->solid.angle[s], angle));
}

PetscBool TensionHasHysteresis(Tension tension)
{
  const Curvature *data = CurvatureOf(tension);

  return (PetscBool)(tension->active && data && data->hysteresis);
}

PetscBool TensionHasLaw(Tension tension)
{
  const Curvature *data = CurvatureOf(tension);

  return (PetscBool)(data && data->lines_move);
}

PetscBool TensionHasAngles(Tension tension)
{
  const Curvature *data = CurvatureOf(tension);

  return (PetscBool)(data && (data->tilted || data->hysteresis));
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
    const ContactAngle *contact = &data->contact[f / 2][f % 2];

    if (contact->angle > 0 && (!worst || contact->sine < worst->sine)) worst = contact;
  }
  if (worst) PetscCall(Warn(worst, "a wall", viewer));
  for (PetscInt s = 0; s < data->solid.count; s++) PetscCall(Warn(&data->solid.angle[s], "a solid", viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The contact angle of a line with this LineBend, for images: the friction of hysteresis adds its part. */
static ContactAngle Moving(Tension tension, const ContactAngle *contact, PetscReal bend)
{
  const PetscReal friction = bend > 0 ? contact->hysteresis_force : -contact->hysteresis_force;
  PetscReal       angle;
  ContactAngle    moving;

  if (bend == 0) return *contact;
  angle  = MovingLines.angle(CurvatureOf(tension)->lines, acos(contact->cosine - friction), bend);
  moving = FromDegrees(acos(PetscMin(1, PetscMax(-1, PetscCosReal(angle) + friction))) * (180 / PETSC_PI), 0);
  moving.hysteresis_force = contact->hysteresis_force;
  return moving;
}

PetscBool ContactOf(Tension tension, const At *at, const WallImages *image, PetscReal inward[DIM],
                    ContactAngle *contact)
{
  const Curvature    *data  = tension->data;
  const SolidContact *solid = &data->solid;
  const PetscReal    *n     = image->contact ? image->inward : solid->meeting + DIM * at->a;
  const PetscInt      index = image->contact ? 0 : (PetscInt)solid->mirror[DIM * at->a + 2];

  for (PetscInt d = 0; d < DIM; d++) inward[d] = n[d];
  if (index < 0) return PETSC_FALSE;
  *contact =
    Moving(tension, image->contact ? image->contact : &solid->angle[index], data->bend ? data->bend[at->a] : 0);
  return PETSC_TRUE;
}

/* Largest sum of the distances (m) from a wall of a particle of a cell and a neighbour whose image is within the
   particle's support. */
static PetscReal ImageReach(const SortedCells *liquid, PetscInt cell)
{
  return SortedRadius(liquid, cell) + liquid->grid.size;
}

static PetscBool NearWall(Domain domain, const At *at, PetscInt cell)
{
  const PetscReal *x = at->x, reach = ImageReach(at->liquid, cell);
  PetscBool        near = PETSC_FALSE;

  for (PetscInt d = 0; d < domain->dim; d++) {
    if (domain->face[d][0] == FACE_WALL && PetscAbsReal(x[d] - domain->lower[d]) <= reach) near = PETSC_TRUE;
    if (domain->face[d][1] == FACE_WALL && PetscAbsReal(x[d] - domain->upper[d]) <= reach) near = PETSC_TRUE;
  }
  return near;
}

/* The normal of the image behind a wall: its mean with the original has the contact angle. False if the surface is too
   nearly parallel to the wall to end there. */
static PetscBool MirrorNormal(const ContactAngle *contact, const PetscReal inward[DIM], const PetscReal normal[DIM],
                              PetscReal image[DIM])
{
  const PetscReal into = Dot(normal, inward);
  PetscReal       flat[DIM], scale, length;

  for (PetscInt e = 0; e < DIM; e++) flat[e] = normal[e] - into * inward[e];
  length = PetscSqr(flat[2]) + (PetscSqr(flat[1]) + PetscSqr(flat[0]));
  if (length < PetscSqr(PARALLEL * contact->sine)) return PETSC_FALSE;
  scale = 2 * contact->sine / PetscSqrtReal(length);
  for (PetscInt e = 0; e < DIM; e++) image[e] = scale * flat[e] - normal[e] + 2 * contact->cosine * inward[e];
  length = PetscSqr(image[2]) + (PetscSqr(image[1]) + PetscSqr(image[0]));
  length = length > 0 ? 1 / PetscSqrtReal(length) : 0;
  for (PetscInt e = 0; e < DIM; e++) image[e] *= length;
  return PETSC_TRUE;
}

/* Copies the columns of candidate k to the place 'to', with the normal of an image (columns as in AddImages) and the
   same position. False: no image. */
static PetscBool CopyImage(Tension tension, SortedCells *liquid, const ContactAngle *contact,
                           const PetscReal inward[DIM], PetscInt width, PetscInt k, PetscInt to)
{
  const PetscInt  stride = liquid->stride;
  const PetscBool moves  = (PetscBool)(CurvatureOf(tension)->bend != NULL);
  PetscReal      *from = liquid->near + k, *copy = liquid->near + to, image[DIM];

  for (PetscInt w = 0; w < width; w++) copy[w * stride] = from[w * stride];
  if (tension->weighted) copy[WEIGHT_COLUMN * stride] = from[WEIGHT_COLUMN * stride];
  if (width > DIM) {
    const PetscReal    normal[DIM] = {from[3 * stride], from[4 * stride], from[5 * stride]};
    const ContactAngle moving      = Moving(tension, contact, moves ? from[LINE_COLUMN * stride] : 0);

    if (moves) copy[LINE_COLUMN * stride] = from[LINE_COLUMN * stride];
    if (!MirrorNormal(&moving, inward, normal, image)) return PETSC_FALSE;
    for (PetscInt e = 0; e < DIM; e++) copy[(DIM + e) * stride] = image[e];
  }
  return PETSC_TRUE;
}

/* Whether images are moved by the depth of their particles: then one may be nearer than its particle's mirror image. */
static PetscBool Shifts(Tension tension, PetscInt width)
{
  return (PetscBool)(CurvatureOf(tension)->tilted && width > DIM);
}

/* Appends the images in one wall of the n collected candidates within 'reach' (m) of the wall, with the weight and the
   first 'width' columns; columns 3 to 5 are normals if width > 3. Returns the new number. The first 'real' of the n
   candidates are particles, the others images. */
static PetscInt AddImages(Tension tension, SortedCells *liquid, PetscReal reach, const WallImages *image,
                          PetscInt width, PetscInt real, PetscInt n)
{
  Images    *images = &CurvatureOf(tension)->images;
  PetscReal *x      = liquid->near + image->axis * liquid->stride;
  PetscInt   copies = n;

  for (PetscInt k = 0; k < n; k++) {
    if (!Shifts(tension, width) && PetscAbsReal(x[k] - image->wall) > reach) continue;
    if (!CopyImage(tension, liquid, image->contact, image->inward, width, k, copies)) continue;
    x[copies] = 2 * image->wall - x[k];
    if (images->used) {
      images->parent[copies] = k;
      images->origin[copies] = k < real ? k : images->origin[k];
      images->volume[copies] = k < real ? 1 : images->volume[k];
    }
    copies++;
  }
  return copies;
}

/* The same for images in solids. Leaves out images that are beyond the support of all points of the cell of x, wherever
   they are moved along the solid. */
static PetscInt AddSolidImages(Tension tension, const At *at, PetscInt cell, PetscInt width, PetscInt n)
{
  Curvature          *data   = tension->data;
  const SolidContact *solid  = &data->solid;
  Images             *images = &data->images;
  SortedCells        *liquid = at->liquid;
  const PetscInt      stride = liquid->stride;
  const PetscReal     reach  = SortedRadius(liquid, cell) + PetscSqrtReal((PetscReal)tension->dim) * liquid->grid.size;
  PetscInt            copies = n;

  for (PetscInt k = 0; k < n; k++) {
    const PetscInt      a      = (PetscInt)liquid->near[SOLID_COLUMN * stride + k];
    const PetscReal    *mirror = solid->mirror + DIM * a, *normal = solid->normal + DIM * a;
    const ContactAngle *contact;
    PetscReal           away[DIM];

    if (mirror[2] < 0 || mirror[1] == 0) continue;
    contact = &solid->angle[(PetscInt)mirror[2]];
    for (PetscInt d = 0; d < DIM; d++) away[d] = liquid->near[d * stride + k] - 2 * mirror[0] * normal[d] - at->x[d];
    if (!Shifts(tension, width) && Norm(away) > reach + 2 * PetscAbsReal(contact->image_tilt * mirror[0])) continue;
    if (!CopyImage(tension, liquid, contact, solid->meeting + DIM * a, width, k, copies)) continue;
    for (PetscInt d = 0; d < DIM; d++) liquid->near[d * stride + copies] = at->x[d] + away[d];
    images->parent[copies]   = k;
    images->origin[copies]   = k;
    images->volume[copies++] = (float)mirror[1];
  }
  return copies;
}

/* Moves the images of a group to their positions for a particle: 'tilt' times their distance from the wall. normals:
   the columns of normals and depths are collected. */
static void MoveImages(const Curvature *data, SortedCells *liquid, const WallImages *image, PetscBool normals,
                       const PetscReal tilt[DIM])
{
  const SolidContact *solid  = &data->solid;
  const PetscInt      stride = liquid->stride;
  PetscReal          *x = liquid->near, *y = x + stride, *z = y + stride, *index = x + SOLID_COLUMN * stride;

  for (PetscInt k = image->begin; k < image->end; k++) {
    const PetscInt   from   = data->images.parent[k];
    const PetscReal *normal = image->inward;
    PetscReal        s, shift[DIM];

    if (image->contact)
      s = (x[image->axis * stride + from] - image->wall) * normal[image->axis];
    else {
      s      = solid->mirror[DIM * (PetscInt)index[from]];
      normal = solid->normal + DIM * (PetscInt)index[from];
    }
    for (PetscInt d = 0; d < DIM; d++) shift[d] = 0;
    if (normals) {
      const PetscReal *n = x + DIM * stride, depth = x[DEPTH_COLUMN * stride + from];
      PetscReal        into = 0;

      for (PetscInt d = 0; d < DIM; d++) {
        shift[d] = depth * (n[d * stride + from] - n[d * stride + k]);
        into += n[d * stride + from] * normal[d];
      }
      s += depth * into;
    }
    x[k] = x[from] + shift[0] + s * (tilt[0] - 2 * normal[0]);
    y[k] = y[from] + shift[1] + s * (tilt[1] - 2 * normal[1]);
    z[k] = z[from] + shift[2] + s * (tilt[2] - 2 * normal[2]);
  }
}

/* Whether a particle is within its support of the wall of a group of images; others do not see them. */
static PetscBool SeesWall(const Curvature *data, const At *at, const WallImages *image)
{
  const PetscReal  support = at->size * at->liquid->support;
  const PetscReal *mirror  = data->solid.mirror + (image->contact ? 0 : DIM * at->a);

  if (image->contact) return (PetscBool)(PetscAbsReal(at->x[image->axis] - image->wall) <= support);
  return (PetscBool)(mirror[2] >= 0 && mirror[0] <= support);
}

/* Moves the images of a group out of all supports. */
static void RemoveImages(SortedCells *liquid, const WallImages *image)
{
  for (PetscInt k = image->begin; k < image->end; k++) liquid->near[k] = FAR_AWAY;
}

void ContactTilt(Tension tension, const At *at, const Around *around, const PetscReal outward[DIM], PetscReal full)
{
  const Curvature *data    = tension->data;
  const PetscBool  normals = Shifts(tension, around->width);

  for (PetscInt g = 0; g < around->images && data->tilted; g++) {
    PetscReal    inward[DIM], tilt[DIM] = {0, 0, 0}, flat[DIM], into, length;
    ContactAngle contact;

    if (ContactOf(tension, at, &around->image[g], inward, &contact)) {
      into = Dot(outward, inward);
      for (PetscInt d = 0; d < DIM; d++) flat[d] = outward[d] - into * inward[d];
      length = PetscMax(Norm(flat), PARALLEL * contact.sine * full);
      for (PetscInt d = 0; d < DIM; d++) tilt[d] = 2 * contact.image_tilt * flat[d] / length;
    }
    if (normals && !SeesWall(data, at, &around->image[g]))
      RemoveImages(at->liquid, &around->image[g]);
    else
      MoveImages(data, at->liquid, &around->image[g], normals, tilt);
  }
}

float ContactVolume(Tension tension, const At *at, PetscInt k)
{
  const Images    *images = &CurvatureOf(tension)->images;
  const PetscInt   stride = at->liquid->stride;
  const PetscReal *from   = at->liquid->near + images->origin[k],
                  r[DIM]  = {from[0] - at->x[0], from[stride] - at->x[1], from[2 * stride] - at->x[2]};

  return Dot(r, r) < PetscSqr(at->size * at->liquid->support) ? images->volume[k] : 0;
}

/* Appends the images of the collected candidates in solids and in all walls within the support of the cell. An
   image may have an image in the next wall. */
static void Mirror(Tension tension, Domain domain, const At *at, PetscInt width, Around *around)
{
  const Curvature *data  = tension->data;
  const PetscReal  reach = ImageReach(at->liquid, around->cell);

  if (data->solid.count) {
    const PetscInt n = AddSolidImages(tension, at, around->cell, width, around->n);

    around->image[around->images++] = (WallImages){.begin = around->n, .end = n};
    around->n                       = n;
  }
  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal wall = side ? domain->upper[d] : domain->lower[d], apart = PetscAbsReal(at->x[d] - wall);
      WallImages      image = {.begin = around->n, .axis = d, .wall = wall, .contact = &data->contact[d][side]};

      if (domain->face[d][side] != FACE_WALL || apart > reach) continue;
      image.inward[d] = side ? -1 : 1;
      around->n = image.end = AddImages(tension, at->liquid, reach - apart, &image, width, around->real, around->n);
      around->image[around->images++] = image;
    }
}

/* Makes room for the data of each collected image. */
static PetscErrorCode GrowImages(Images *images, PetscInt capacity)
{
  PetscFunctionBegin;
  if (!images->used || images->capacity >= capacity) PetscFunctionReturn(PETSC_SUCCESS);
  images->capacity = capacity;
  PetscCall(PetscFree(images->parent));
  PetscCall(PetscFree(images->origin));
  PetscCall(PetscFree(images->volume));
  PetscCall(PetscMalloc1(capacity, &images->parent));
  PetscCall(PetscMalloc1(capacity, &images->origin));
  PetscCall(PetscMalloc1(capacity, &images->volume));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactCollect(Tension tension, Domain domain, const At *at, PetscInt columns, PetscInt width,
                              Around *around)
{
  Curvature      *data   = tension->data;
  const PetscBool solids = (PetscBool)(data->solid.count > 0);
  const PetscInt  cell   = SortedCell(at->liquid, at->p);
  PetscBool       faces;

  PetscFunctionBegin;
  if (cell == around->cell) PetscFunctionReturn(PETSC_SUCCESS);
  faces          = (PetscBool)(data->walls && NearWall(domain, at, cell));
  around->cell   = cell;
  around->width  = width;
  around->images = 0;
  if (faces || solids) columns = COLUMNS(0, width);
  if (tension->weighted) columns |= COLUMNS(WEIGHT_COLUMN, 1);
  if (solids) columns |= COLUMNS(SOLID_COLUMN, 1);
  if (data->bend && width > DIM) columns |= COLUMNS(LINE_COLUMN, 1);
  PetscCall(SortedCellsCollect(at->liquid, cell, columns, (faces ? 1 << (2 * domain->dim) : 1) * (solids ? 2 : 1),
                               &around->real));
  PetscCall(GrowImages(&data->images, at->liquid->stride));
  around->n = around->real;
  if (faces || solids) Mirror(tension, domain, at, width, around);
  PetscFunctionReturn(PETSC_SUCCESS);
}
