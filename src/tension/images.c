/* Images continue the liquid and its normals behind walls, so that the surface meets the wall at the contact angle.

   A face of the box is a mirror; for solids see images_solid.c.

   A mirror reverses the slope of the surface. So for each particle near a wall the images are moved along the wall, by
   2 s cot(angle) out of the liquid: a surface that meets the wall at the contact angle then continues straight behind
   the wall (ImagesTilt). For small angles this would need particles that are too far away. So images are moved by 2 s
   TILT_MOST at most (contact.c), and the residual of the cotangent becomes a part of grad phi normal to the wall
   (SumMirrored in curvature.c). The mean of the normals of a particle and its image has the contact angle.

   Only the free surface meets the wall under the contact angle; the parallel surface at the depth s below it, to which
   the normal of a particle belongs, meets it under another one if it is curved. So where normals count, the image is
   that of the particle's foot on the free surface, moved back by s along the image's normal (MoveImages). Otherwise
   menisci between two walls ten spacings apart pull 11 % too much at 60 degrees and 8 % too little at 120.

   In a corner of two walls images in one are moved along both, so far that the surface moves as much: across the other
   they would leave a gap between themselves and their own images in it (AlongOthers). A cup of square section pulled a
   third less at 60 degrees, and its liquid came apart.

   An image may be nearer than its particle. Which particles beyond the support are known depends on cells and ranks, so
   their images are left out. */
#include "curvature.h"

/* A surface ends at a wall if the part of its normal along the wall is at least this times the sine of the contact
   angle. */
#define PARALLEL 0.5
/* The surface lies along a wall if less than this of the gradient of the particles beside another one is along both:
   with 0.25 the meniscus in the corner of a cup at 60 degrees comes apart. */
#define LIES     0.1
#define FAR_AWAY 1e30 /* m */

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
  const PetscBool moves  = (PetscBool)(CurvatureOf(tension)->contact.bend != NULL);
  PetscReal      *from = liquid->near + k, *copy = liquid->near + to, image[DIM];

  for (PetscInt w = 0; w < width; w++) copy[w * stride] = from[w * stride];
  if (tension->weighted) copy[WEIGHT_COLUMN * stride] = from[WEIGHT_COLUMN * stride];
  if (width > DIM) {
    const PetscReal    normal[DIM] = {from[3 * stride], from[4 * stride], from[5 * stride]};
    const ContactAngle moving      = ContactMoving(tension, contact, moves ? from[LINE_COLUMN * stride] : 0);

    if (moves) copy[LINE_COLUMN * stride] = from[LINE_COLUMN * stride];
    if (!MirrorNormal(&moving, inward, normal, image)) return PETSC_FALSE;
    for (PetscInt e = 0; e < DIM; e++) copy[(DIM + e) * stride] = image[e];
  }
  return PETSC_TRUE;
}

/* Whether images are moved by the depth of their particles: then one may be nearer than its particle's mirror image. */
static PetscBool Shifts(Tension tension, PetscInt width)
{
  return (PetscBool)(CurvatureOf(tension)->contact.tilted && width > DIM);
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
  Curvature         *data   = tension->data;
  const SolidImages *solid  = &data->solid;
  Images            *images = &data->images;
  SortedCells       *liquid = at->liquid;
  const PetscInt     stride = liquid->stride;
  const PetscReal    reach  = SortedRadius(liquid, cell) + PetscSqrtReal((PetscReal)tension->dim) * liquid->grid.size;
  PetscInt           copies = n;

  for (PetscInt k = 0; k < n; k++) {
    const PetscInt      a      = (PetscInt)liquid->near[SOLID_COLUMN * stride + k];
    const PetscReal    *mirror = solid->mirror + DIM * a, *normal = solid->normal + DIM * a;
    const ContactAngle *contact;
    PetscReal           away[DIM];

    if (mirror[2] < 0 || mirror[1] == 0) continue;
    contact = &data->contact.solid[(PetscInt)mirror[2]];
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
  const SolidImages *solid  = &data->solid;
  const PetscInt     stride = liquid->stride;
  PetscReal         *x = liquid->near, *y = x + stride, *z = y + stride, *index = x + SOLID_COLUMN * stride;

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

PetscBool ImagesAngle(Tension tension, const At *at, const WallImages *image, PetscReal inward[DIM],
                      ContactAngle *contact)
{
  const Curvature   *data  = tension->data;
  const SolidImages *solid = &data->solid;
  const PetscReal   *n     = image->contact ? image->inward : solid->meeting + DIM * at->a;
  const PetscInt     index = image->contact ? 0 : (PetscInt)solid->mirror[DIM * at->a + 2];

  for (PetscInt d = 0; d < DIM; d++) inward[d] = n[d];
  if (index < 0) return PETSC_FALSE;
  *contact = ContactMoving(tension, image->contact ? image->contact : &data->contact.solid[index],
                           data->contact.bend ? data->contact.bend[at->a] : 0);
  return PETSC_TRUE;
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

/* Makes of 'flat', along the wall of group g, the direction in which its images are moved where the particle sees other
   walls: the part along all walls, lengthened; flat remains beside a wall along which the surface lies. 'partial': flat
   is that of the gradient of the particles alone, which other walls cut off: only its direction along all walls is
   known, and that the normal has the contact angle with each. */
static void AlongOthers(Tension tension, const At *at, const Around *around, PetscInt g, PetscReal sine,
                        PetscBool partial, PetscReal flat[DIM])
{
  PetscReal along[DIM] = {flat[0], flat[1], flat[2]}, left = PetscSqr(sine), square = Dot(flat, flat), share, scale,
            weight;
  PetscInt others = 0;

  for (PetscInt h = 0; h < around->images; h++) {
    PetscReal    inward[DIM], into;
    ContactAngle contact;

    if (h == g || !SeesWall(tension->data, at, &around->image[h]) ||
        !ImagesAngle(tension, at, &around->image[h], inward, &contact))
      continue;
    into = Dot(along, inward);
    for (PetscInt d = 0; d < DIM; d++) along[d] -= into * inward[d];
    left -= PetscSqr(contact.cosine);
    others++;
  }
  share = square > 0 ? Dot(along, along) / square : 0;
  if (!others || share == 0) return;
  scale  = partial ? sine / PetscSqrtReal(share * PetscMax(left, PetscSqr(PARALLEL * sine))) : 1 / share;
  weight = PetscMin(1, share / PetscSqr(partial ? LIES : PARALLEL));
  for (PetscInt d = 0; d < DIM; d++) flat[d] = (1 - weight) * flat[d] + weight * scale * along[d];
}

void ImagesTilt(Tension tension, const At *at, const Around *around, const PetscReal outward[DIM], PetscReal full)
{
  const Curvature *data    = tension->data;
  const PetscBool  normals = Shifts(tension, around->width);

  for (PetscInt g = 0; g < around->images && data->contact.tilted; g++) {
    PetscReal    inward[DIM], tilt[DIM] = {0, 0, 0}, flat[DIM], into, length;
    ContactAngle contact;

    if (ImagesAngle(tension, at, &around->image[g], inward, &contact)) {
      into = Dot(outward, inward);
      for (PetscInt d = 0; d < DIM; d++) flat[d] = outward[d] - into * inward[d];
      length = PetscMax(Norm(flat), PARALLEL * contact.sine * full);
      AlongOthers(tension, at, around, g, contact.sine, (PetscBool)!normals, flat);
      for (PetscInt d = 0; d < DIM; d++) tilt[d] = 2 * contact.image_tilt * flat[d] / length;
    }
    if (normals && !SeesWall(data, at, &around->image[g]))
      RemoveImages(at->liquid, &around->image[g]);
    else
      MoveImages(data, at->liquid, &around->image[g], normals, tilt);
  }
}

float ImagesVolume(Tension tension, const At *at, PetscInt k)
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

  if (data->contact.solids) {
    const PetscInt n = AddSolidImages(tension, at, around->cell, width, around->n);

    around->image[around->images++] = (WallImages){.begin = around->n, .end = n};
    around->n                       = n;
  }
  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal wall = side ? domain->upper[d] : domain->lower[d], apart = PetscAbsReal(at->x[d] - wall);
      WallImages      image = {.begin = around->n, .axis = d, .wall = wall, .contact = &data->contact.face[d][side]};

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

PetscErrorCode ImagesCollect(Tension tension, Domain domain, const At *at, PetscInt columns, PetscInt width,
                             Around *around)
{
  Curvature      *data   = tension->data;
  const PetscBool solids = (PetscBool)(data->contact.solids > 0);
  const PetscInt  cell   = SortedCell(at->liquid, at->p);
  PetscBool       faces;

  PetscFunctionBegin;
  if (cell == around->cell) PetscFunctionReturn(PETSC_SUCCESS);
  faces          = (PetscBool)(data->contact.walls && NearWall(domain, at, cell));
  around->cell   = cell;
  around->width  = width;
  around->images = 0;
  if (faces || solids) columns = COLUMNS(0, width);
  if (tension->weighted) columns |= COLUMNS(WEIGHT_COLUMN, 1);
  if (solids) columns |= COLUMNS(SOLID_COLUMN, 1);
  if (data->contact.bend && width > DIM) columns |= COLUMNS(LINE_COLUMN, 1);
  PetscCall(SortedCellsCollect(at->liquid, cell, columns, (faces ? 1 << (2 * domain->dim) : 1) * (solids ? 2 : 1),
                               &around->real));
  PetscCall(GrowImages(&data->images, at->liquid->stride));
  around->n = around->real;
  if (faces || solids) Mirror(tension, domain, at, width, around);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ImagesDestroy(Tension tension)
{
  Curvature *data = tension->data;

  PetscFunctionBegin;
  PetscCall(PetscFree(data->images.parent));
  PetscCall(PetscFree(data->images.origin));
  PetscCall(PetscFree(data->images.volume));
  PetscCall(SortedCellsReset(&data->solid.dummies));
  PetscFunctionReturn(PETSC_SUCCESS);
}
