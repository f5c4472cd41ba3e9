/* Contact angles: the liquid and its normals go on behind walls so that the surface meets the wall under the contact
   angle.

   A face of the box is a mirror; for solids see contact_solid.c.

   A mirror reverses the slope of the surface. For each particle near a wall the images are therefore moved along the
   wall, by 2 s cot(angle) out of the liquid: then a surface that meets the wall under the contact angle goes on
   straight behind it (ContactSlant). Of acute angles this would need particles that are too far away; there the images
   are moved by 2 s SLANT_MOST at most, and grad phi has the rest of the cotangent as a part normal to the wall
   (SumMirrored in curvature.c). Normals of images are such that their mean with that of the particle has the contact
   angle.

   An image may be nearer than its particle, and what is known of particles beyond the support depends on cells and
   ranks: images of those are left out. */
#include "tension_impl.h"

/* A surface ends at a wall if the part of its normal along the wall is at least this, times sin of the contact angle.
 */
#define PARALLEL    0.5
#define SLANT_MOST  0.58 /* cot 60 degrees */
#define ANGLE_LEAST 20.  /* degrees: contact angles nearer to 0 or 180 were not tried */

/* 'hysteresis': by how much the advancing angle is above the receding one, around 'degrees'. */
static ContactAngle FromDegrees(PetscReal degrees, PetscReal hysteresis)
{
  const PetscReal angle   = degrees * (PETSC_PI / 180);
  ContactAngle    contact = {angle, PetscCosReal(angle), PetscSinReal(angle), 0, PetscTanReal(angle), 0};

  if (hysteresis > 0) {
    const PetscReal half = 0.5 * hysteresis * (PETSC_PI / 180);

    contact       = FromDegrees(degrees == 90 ? 90 : acos(contact.cosine * PetscCosReal(half)) * (180 / PETSC_PI), 0);
    contact.stick = PetscSinReal(angle) * PetscSinReal(half);
    return contact;
  }
  if (degrees == 90 || degrees == 0) return contact;
  contact.slant = PetscMin(SLANT_MOST, 1 / contact.rest);
  contact.rest  = 1 / contact.rest > SLANT_MOST ? 1 / (1 / contact.rest - SLANT_MOST) : PETSC_MAX_REAL;
  return contact;
}

PetscErrorCode ContactCreate(Tension tension, Domain domain, Scene scene)
{
  SolidContact *solid = &tension->solid;

  PetscFunctionBegin;
  solid->scene = scene;
  for (PetscInt d = 0; d < DIM; d++)
    for (PetscInt side = 0; side < 2; side++) {
      tension->face[d][side] = domain->face[d][side];
      if (d < domain->dim && domain->face[d][side] == FACE_WALL) tension->walls = PETSC_TRUE;
    }
  for (PetscInt s = 0; s < SceneSolidCount(scene); s++)
    if (BodyContactAngle(SceneSolid(scene, s)) > 0) solid->count = SceneSolidCount(scene);
  PetscCall(PetscCalloc1(solid->count, &solid->angle));
  for (PetscInt s = 0; s < solid->count; s++) {
    const Body body = SceneSolid(scene, s);

    solid->angle[s] = FromDegrees(BodyContactAngle(body), BodyContactHysteresis(body));
    if (solid->angle[s].stick > 0) tension->sticks = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactDestroy(Tension tension)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(tension->solid.angle));
  PetscCall(PetscFree(tension->images.parent));
  PetscCall(PetscFree(tension->images.origin));
  PetscCall(PetscFree(tension->images.share));
  PetscCall(SortedCellsReset(&tension->solid.dummies));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactSetFromOptions(Tension tension, OptionItems PetscOptionsObject)
{
  PetscReal common = 90, hysteresis = 0;

  PetscFunctionBegin;
  PetscCall(OptionReal("-wall_contact_angle",
                       "angle in the liquid at which the free surface meets the walls of the box (degrees)", "(0, 180)",
                       &common));
  PetscCall(OptionReal("-wall_contact_hysteresis",
                       "the advancing angle less the receding one, around that angle, between which lines stick there "
                       "(degrees)",
                       "[0, 180)", &hysteresis));
  for (PetscInt f = tension->rings ? 1 : 0; f < 2 * tension->dim; f++) {
    const PetscInt d = f / 2, side = f % 2;
    char           option[64];
    PetscReal      angle = common;

    PetscCall(PetscSNPrintf(option, sizeof(option), "-box_%c%s_contact_angle", "xyz"[d], side ? "max" : "min"));
    PetscCall(OptionReal(option, "that of this wall, if it differs (degrees)", "(0, 180)", &angle));
    PetscCheckUser(angle == common || tension->face[d][side] == FACE_WALL, tension->comm,
                   "%s: the face is %s; only a wall has a contact angle", option, FaceTypes[tension->face[d][side]]);
    PetscCheckUser(
      0.5 * hysteresis < PetscMin(angle, 180 - angle), tension->comm,
      "-wall_contact_hysteresis %g: half of it below and above the contact angle, %g, must stay in (0, 180)",
      (double)hysteresis, (double)angle);
    tension->contact[d][side] = FromDegrees(angle, hysteresis);
    if (tension->face[d][side] == FACE_WALL && hysteresis > 0) tension->sticks = PETSC_TRUE;
    if (tension->face[d][side] == FACE_WALL && tension->contact[d][side].slant != 0) tension->slanted = PETSC_TRUE;
  }
  for (PetscInt s = 0; s < tension->solid.count; s++)
    if (tension->solid.angle[s].slant != 0) tension->slanted = PETSC_TRUE;
  tension->images.used = (PetscBool)(tension->slanted || tension->solid.count > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Warn(const ContactAngle *contact, const char what[], PetscViewer viewer)
{
  const PetscReal angle = contact->angle * 180 / PETSC_PI;

  PetscFunctionBegin;
  if (angle == 0 || PetscMin(angle, 180 - angle) >= ANGLE_LEAST) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscViewerASCIIPrintf(viewer,
                                   "warning: the contact angle %g of %s is in degrees, and was tried from %g to %g "
                                   "only; %g radians are %.4g degrees\n",
                                   (double)angle, what, ANGLE_LEAST, 180 - ANGLE_LEAST, (double)angle,
                                   (double)(angle * 180 / PETSC_PI)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One angle, or the receding and the advancing one between which the line sticks; first: nothing is said before it. */
static PetscErrorCode ViewAngle(const ContactAngle *contact, const char where[], PetscBool *first, PetscViewer viewer)
{
  const PetscReal degrees = 180 / PETSC_PI, receding = degrees * acos(contact->cosine + contact->stick),
                  advancing = degrees * acos(contact->cosine - contact->stick);

  PetscFunctionBegin;
  PetscCall(
    PetscViewerASCIIPrintf(viewer, "%s %s %.4g", *first ? "Contact angles in degrees:" : ",", where, (double)receding));
  if (contact->stick > 0) PetscCall(PetscViewerASCIIPrintf(viewer, " to %.4g", (double)advancing));
  *first = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViewAngles(Tension tension, PetscViewer viewer)
{
  const SolidContact *solid = &tension->solid;
  PetscBool           first = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < 2 * tension->dim; f++) {
    char face[8];

    if (tension->face[f / 2][f % 2] != FACE_WALL) continue;
    PetscCall(PetscSNPrintf(face, sizeof(face), "%c%s", "xyz"[f / 2], f % 2 ? "max" : "min"));
    PetscCall(ViewAngle(&tension->contact[f / 2][f % 2], face, &first, viewer));
  }
  for (PetscInt s = 0; s < solid->count; s++)
    if (solid->angle[s].angle > 0)
      PetscCall(ViewAngle(&solid->angle[s], BodyName(SceneSolid(solid->scene, s)), &first, viewer));
  if (!first) PetscCall(PetscViewerASCIIPrintf(viewer, "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactView(Tension tension, PetscViewer viewer)
{
  const ContactAngle *worst = NULL;

  PetscFunctionBegin;
  PetscCall(ViewAngles(tension, viewer));
  for (PetscInt f = 0; f < 2 * tension->dim; f++) {
    const ContactAngle *contact = &tension->contact[f / 2][f % 2];

    if (contact->angle > 0 && (!worst || contact->sine < worst->sine)) worst = contact;
  }
  if (worst) PetscCall(Warn(worst, "a wall", viewer));
  for (PetscInt s = 0; s < tension->solid.count; s++) PetscCall(Warn(&tension->solid.angle[s], "a solid", viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const ContactAngle *ContactOf(Tension tension, const WallImages *image, PetscInt a, PetscReal inward[DIM])
{
  const SolidContact *solid = &tension->solid;
  const PetscReal    *n     = image->contact ? image->inward : solid->meeting + DIM * a;
  const PetscInt      index = image->contact ? 0 : (PetscInt)solid->place[DIM * a + 2];

  for (PetscInt d = 0; d < DIM; d++) inward[d] = n[d];
  return image->contact ? image->contact : index < 0 ? NULL : &solid->angle[index];
}

/* How far (m) from a wall a particle of a cell and a neighbour may be together, if its image is to be within the
   support of the first. */
static PetscReal ImageReach(const SortedCells *liquid, PetscInt cell)
{
  return SortedRadius(liquid, cell) + liquid->grid.size;
}

static PetscBool NearWall(Tension tension, Domain domain, PetscInt cell, const PetscReal x[DIM])
{
  const PetscReal reach = ImageReach(tension->liquid, cell);
  PetscBool       near  = PETSC_FALSE;

  for (PetscInt d = 0; d < domain->dim && tension->walls; d++) {
    if (domain->face[d][0] == FACE_WALL && PetscAbsReal(x[d] - domain->lower[d]) <= reach) near = PETSC_TRUE;
    if (domain->face[d][1] == FACE_WALL && PetscAbsReal(x[d] - domain->upper[d]) <= reach) near = PETSC_TRUE;
  }
  return near;
}

/* The normal of the image behind a wall: one whose mean with the original has the contact angle. False if the surface
   is too close to parallel to the wall to end there. */
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

/* Copies what has been collected of candidate k to the place 'to', with the normal of an image (columns as in
   AddImages) and the same position. False: it has no image. */
static PetscBool CopyImage(Tension tension, const ContactAngle *contact, const PetscReal inward[DIM], PetscInt width,
                           PetscInt k, PetscInt to)
{
  SortedCells   *liquid = tension->liquid;
  const PetscInt stride = liquid->stride;
  PetscReal     *from = liquid->near + k, *copy = liquid->near + to, image[DIM];

  for (PetscInt w = 0; w < width; w++) copy[w * stride] = from[w * stride];
  if (tension->weighted) copy[WEIGHT_COLUMN * stride] = from[WEIGHT_COLUMN * stride];
  if (width > DIM) {
    const PetscReal normal[DIM] = {from[3 * stride], from[4 * stride], from[5 * stride]};

    if (!MirrorNormal(contact, inward, normal, image)) return PETSC_FALSE;
    for (PetscInt e = 0; e < DIM; e++) copy[(DIM + e) * stride] = image[e];
  }
  return PETSC_TRUE;
}

/* Adds the images in one wall (m, its place along the axis) of the n collected candidates within 'reach' (m) of it
   behind them, with their first 'width' columns and that of the weight; columns 3 to 5 hold normals if width says that
   there are any. Returns the new number; 'real' ones of the n are no images. */
static PetscInt AddImages(Tension tension, PetscReal wall, PetscReal reach, PetscInt axis, const WallImages *image,
                          PetscInt width, PetscInt real, PetscInt n)
{
  Images        *images = &tension->images;
  const PetscInt stride = tension->liquid->stride;
  PetscReal     *at     = tension->liquid->near + axis * stride;
  PetscInt       copies = n;

  for (PetscInt k = 0; k < n; k++) {
    if (PetscAbsReal(at[k] - wall) > reach) continue;
    if (!CopyImage(tension, image->contact, image->inward, width, k, copies)) continue;
    at[copies] = 2 * wall - at[k];
    if (images->used) {
      images->parent[copies] = k;
      images->origin[copies] = k < real ? k : images->origin[k];
      images->share[copies]  = k < real ? 1 : images->share[k];
    }
    copies++;
  }
  return copies;
}

/* The same of the images in solids. Those that are further than the support from all points of the cell of x, wherever
   they are moved along the solid, are left out. */
static PetscInt AddSolidImages(Tension tension, const PetscReal x[DIM], PetscInt cell, PetscInt width, PetscInt n)
{
  const SolidContact *solid  = &tension->solid;
  Images             *images = &tension->images;
  SortedCells        *liquid = tension->liquid;
  const PetscInt      stride = liquid->stride;
  const PetscReal     reach  = SortedRadius(liquid, cell) + PetscSqrtReal((PetscReal)tension->dim) * liquid->grid.size;
  PetscInt            copies = n;

  for (PetscInt k = 0; k < n; k++) {
    const PetscInt      a     = (PetscInt)liquid->near[SOLID_COLUMN * stride + k];
    const PetscReal    *place = solid->place + DIM * a, *normal = solid->normal + DIM * a;
    const ContactAngle *contact;
    PetscReal           away[DIM];

    if (place[2] < 0 || place[1] == 0) continue;
    contact = &solid->angle[(PetscInt)place[2]];
    for (PetscInt d = 0; d < DIM; d++) away[d] = liquid->near[d * stride + k] - 2 * place[0] * normal[d] - x[d];
    if (Norm(away) > reach + 2 * PetscAbsReal(contact->slant * place[0])) continue;
    if (!CopyImage(tension, contact, solid->meeting + DIM * a, width, k, copies)) continue;
    for (PetscInt d = 0; d < DIM; d++) liquid->near[d * stride + copies] = x[d] + away[d];
    images->parent[copies]  = k;
    images->origin[copies]  = k;
    images->share[copies++] = (float)place[1];
  }
  return copies;
}

/* Puts the images of a group where they are for a particle, moved by 'slant' times their distance from the wall. */
static void MoveImages(Tension tension, const WallImages *image, const PetscReal slant[DIM])
{
  const SolidContact *solid  = &tension->solid;
  const PetscInt      stride = tension->liquid->stride;
  PetscReal          *x = tension->liquid->near, *y = x + stride, *z = y + stride, *index = x + SOLID_COLUMN * stride;

  for (PetscInt k = image->begin; k < image->end; k++) {
    const PetscInt   from   = tension->images.parent[k];
    const PetscReal *normal = image->inward;
    PetscReal        s;

    if (image->contact)
      s = (x[image->axis * stride + from] - image->wall) * normal[image->axis];
    else {
      s      = solid->place[DIM * (PetscInt)index[from]];
      normal = solid->normal + DIM * (PetscInt)index[from];
    }
    x[k] = x[from] + s * (slant[0] - 2 * normal[0]);
    y[k] = y[from] + s * (slant[1] - 2 * normal[1]);
    z[k] = z[from] + s * (slant[2] - 2 * normal[2]);
  }
}

void ContactSlant(Tension tension, const Around *around, PetscInt a, const PetscReal outward[DIM], PetscReal full)
{
  for (PetscInt g = 0; g < around->images && tension->slanted; g++) {
    PetscReal           inward[DIM], slant[DIM] = {0, 0, 0}, flat[DIM], into, length;
    const ContactAngle *contact = ContactOf(tension, &around->image[g], a, inward);

    if (contact) {
      into = Dot(outward, inward);
      for (PetscInt d = 0; d < DIM; d++) flat[d] = outward[d] - into * inward[d];
      length = PetscMax(Norm(flat), PARALLEL * contact->sine * full);
      for (PetscInt d = 0; d < DIM; d++) slant[d] = 2 * contact->slant * flat[d] / length;
    }
    MoveImages(tension, &around->image[g], slant);
  }
}

float ContactShare(Tension tension, PetscInt k, const PetscReal x[DIM])
{
  const Images    *images = &tension->images;
  const PetscInt   stride = tension->liquid->stride;
  const PetscReal *from   = tension->liquid->near + images->origin[k],
                  r[DIM]  = {from[0] - x[0], from[stride] - x[1], from[2 * stride] - x[2]};

  return Dot(r, r) < PetscSqr(tension->size * tension->liquid->support) ? images->share[k] : 0;
}

/* Continues the collected candidates in solids and behind all walls within the support of the cell of x. An image may
   have an image in the next wall. */
static void Mirror(Tension tension, Domain domain, const PetscReal x[DIM], PetscInt width, Around *around)
{
  const PetscReal reach = ImageReach(tension->liquid, around->cell);

  if (tension->solid.count) {
    const PetscInt n = AddSolidImages(tension, x, around->cell, width, around->n);

    around->image[around->images++] = (WallImages){.begin = around->n, .end = n};
    around->n                       = n;
  }
  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal wall  = side ? domain->upper[d] : domain->lower[d];
      WallImages      image = {.begin = around->n, .axis = d, .wall = wall, .contact = &tension->contact[d][side]};

      if (domain->face[d][side] != FACE_WALL || PetscAbsReal(x[d] - wall) > reach) continue;
      image.inward[d] = side ? -1 : 1;
      around->n       = image.end =
        AddImages(tension, wall, reach - PetscAbsReal(x[d] - wall), d, &image, width, around->real, around->n);
      around->image[around->images++] = image;
    }
}

/* Makes room for what is known of each collected image. */
static PetscErrorCode GrowImages(Images *images, PetscInt capacity)
{
  PetscFunctionBegin;
  if (!images->used || images->capacity >= capacity) PetscFunctionReturn(PETSC_SUCCESS);
  images->capacity = capacity;
  PetscCall(PetscFree(images->parent));
  PetscCall(PetscFree(images->origin));
  PetscCall(PetscFree(images->share));
  PetscCall(PetscMalloc1(capacity, &images->parent));
  PetscCall(PetscMalloc1(capacity, &images->origin));
  PetscCall(PetscMalloc1(capacity, &images->share));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContactCollect(Tension tension, Domain domain, PetscInt p, const PetscReal x[DIM], PetscInt columns,
                              PetscInt width, Around *around)
{
  SortedCells    *liquid = tension->liquid;
  const PetscBool solids = (PetscBool)(tension->solid.count > 0);
  const PetscInt  cell   = SortedCell(liquid, p);
  PetscBool       faces;

  PetscFunctionBegin;
  if (cell == around->cell) PetscFunctionReturn(PETSC_SUCCESS);
  faces          = NearWall(tension, domain, cell, x);
  around->cell   = cell;
  around->images = 0;
  if (faces || solids) columns = COLUMNS(0, width);
  if (tension->weighted) columns |= COLUMNS(WEIGHT_COLUMN, 1);
  if (solids) columns |= COLUMNS(SOLID_COLUMN, 1);
  PetscCall(
    SortedCellsCollect(liquid, cell, columns, (faces ? 1 << (2 * domain->dim) : 1) * (solids ? 2 : 1), &around->real));
  PetscCall(GrowImages(&tension->images, liquid->stride));
  around->n = around->real;
  if (faces || solids) Mirror(tension, domain, x, width, around);
  PetscFunctionReturn(PETSC_SUCCESS);
}
