/* SceneView: the bodies, their sizes, speeds and accelerations, the dimensionless numbers that follow from them, and
   what they say about the spacing and the units of a scene. */
#include "scene_impl.h"

#define SAMPLES      5   /* points a direction at which velocity and body force of a body are read */
#define FEW_ACROSS   6   /* spacings: a body thinner than this is hardly resolved */
#define SHORT_WAVE   12  /* spacings: a shorter wave is hardly resolved: six to each half */
#define BOND_WITHOUT 1e4 /* beyond this Bond number tension cannot matter: a drop of water of a quarter of a metre */
#define WEBER_SPRAY  1e7 /* beyond this Weber number nothing is whole: lengths in mm look like that */

void SceneBodyScales(Scene scene, PetscInt b, BodyScales *scales)
{
  const Domain domain = scene->domain;
  Body         body   = SceneBody(scene, b);
  PetscReal    lower[DIM], upper[DIM], g[DIM], v[DIM], x[DIM];

  *scales = (BodyScales){.length = PETSC_MAX_REAL};
  BodyBounds(body, lower, upper);
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscBool mirrored = (PetscBool)((domain->face[d][0] == FACE_SYMMETRY && lower[d] <= domain->lower[d]) ||
                                           (domain->face[d][1] == FACE_SYMMETRY && upper[d] >= domain->upper[d]));

    scales->extent[d] = upper[d] - lower[d];
    if (d < domain->dim) scales->length = PetscMin(scales->length, (mirrored ? 2 : 1) * scales->extent[d]);
  }
  for (PetscInt k = 0; k < SAMPLES * SAMPLES * SAMPLES; k++) {
    const PetscInt at[DIM] = {k % SAMPLES, (k / SAMPLES) % SAMPLES, k / (SAMPLES * SAMPLES)};

    for (PetscInt d = 0; d < DIM; d++) x[d] = lower[d] + (upper[d] - lower[d]) * at[d] / (SAMPLES - 1);
    BodyVelocity(body, x, v);
    SceneAcceleration(scene, x, g);
    scales->speed = PetscMax(scales->speed, Norm(v));
    for (PetscInt d = 0; d < DIM; d++) scales->acceleration[d] = PetscMax(scales->acceleration[d], PetscAbsReal(g[d]));
  }
}

/* Prints what looks like a mistake, and what to check. */
static PetscErrorCode Warn(Body body, PetscReal across, PetscReal bond, PetscReal weber, PetscViewer viewer)
{
  const PetscReal wave = body->shape->wave ? body->shape->wave(body) / body->domain->spacing : 0;

  PetscFunctionBegin;
  if (across < FEW_ACROSS)
    PetscCall(PetscViewerASCIIPrintf(viewer, "warning: %s is only %.2g spacings across; %d and more show its flow\n",
                                     body->name, (double)across, FEW_ACROSS));
  if (wave > 0 && wave < SHORT_WAVE)
    PetscCall(PetscViewerASCIIPrintf(viewer,
                                     "warning: the waves of %s are only %.2g spacings long; %d and more hold them\n",
                                     body->name, (double)wave, SHORT_WAVE));
  if (bond > BOND_WITHOUT || weber > WEBER_SPRAY)
    PetscCall(PetscViewerASCIIPrintf(
      viewer,
      "warning: surface tension hardly matters to %s at this size and speed: do without, or are lengths not in m?\n",
      body->name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of body b: its least extent, in spacings too, and the dimensionless numbers made of it, of the initial speed and of
   the body force; warns of what looks like wrong units or too coarse a spacing. */
static PetscErrorCode ViewNumbers(Scene scene, PetscInt b, PetscViewer viewer)
{
  Body            body = SceneBody(scene, b);
  const Material *m    = &body->material;
  BodyScales      scales;
  PetscReal       L, g, across, inertia, weight, viscosity;
  char            text[256] = "", number[64];

  PetscFunctionBegin;
  SceneBodyScales(scene, b, &scales);
  L         = scales.length;
  g         = Norm(scales.acceleration);
  across    = L / scene->domain->spacing;
  inertia   = m->density * PetscSqr(scales.speed) * L; /* N/m */
  weight    = m->density * g * L * L;                  /* N/m */
  viscosity = BodyViscosity(body, scales.speed / L);
  const struct {
    const char *name;
    PetscReal   above, below;
  } numbers[] = {{"Re", m->density * scales.speed * L, viscosity},
                 {"We", inertia, m->tension},
                 {"Fr", PetscSqr(scales.speed), g * L},
                 {"Bo", weight, m->tension},
                 {"Oh", viscosity, PetscSqrtReal(m->density * m->tension * L)}};
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(numbers); k++) {
    if (numbers[k].above <= 0 || numbers[k].below <= 0) continue;
    PetscCall(PetscSNPrintf(number, sizeof(number), ", %s %.3g", numbers[k].name,
                            (double)(numbers[k].above / numbers[k].below)));
    PetscCall(PetscStrlcat(text, number, sizeof(text)));
  }
  PetscCall(PetscViewerASCIIPrintf(viewer, "least extent %.3g m, %.3g spacings%s\n", (double)L, (double)across, text));
  PetscCall(
    Warn(body, across, m->tension > 0 ? weight / m->tension : 0, m->tension > 0 ? inertia / m->tension : 0, viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SceneView(Scene scene, PetscViewer viewer)
{
  const PetscReal *g = scene->gravity;
  PetscBool        ascii;

  PetscFunctionBegin;
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(scene->domain->comm, &viewer));
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (!ascii) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(
    PetscViewerASCIIPrintf(viewer,
                           "Scene: %" PetscInt_FMT " bodies, gravity %g, %g, %g m/s2, central force rate %g 1/s\n",
                           scene->count, (double)g[0], (double)g[1], (double)g[2], (double)scene->central_rate));
  PetscCall(PetscViewerASCIIPushTab(viewer));
  PetscCall(FrameView(scene, viewer));
  for (PetscInt b = 0; b < scene->count; b++) {
    PetscCall(BodyView(scene->body[b], viewer));
    PetscCall(PetscViewerASCIIPushTab(viewer));
    PetscCall(ViewNumbers(scene, b, viewer));
    PetscCall(PetscViewerASCIIPopTab(viewer));
  }
  PetscCall(LiquidsView(scene, viewer));
  for (PetscInt b = 0; b < scene->solids; b++) {
    PetscCall(PetscViewerASCIIPrintf(viewer, "solid "));
    PetscCall(BodyView(scene->solid[b], viewer));
    if (BodyMass(scene->solid[b]) > 0 && SceneHasTension(scene))
      PetscCall(PetscViewerASCIIPrintf(viewer,
                                       "  warning: surface tension does not pull at %s where a surface meets it: what "
                                       "that would carry, 2 sigma in a plane, must be little against its weight\n",
                                       scene->solid[b]->name));
  }
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}
