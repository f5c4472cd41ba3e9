/* The class Tension: the registered models, their common options and tables. */
#include "curvature.h"

static const TensionModel None = {.choice     = {.name = TENSION_NONE},
                                  .step_limit = STEP_LIMIT_PLAIN,
                                  .step_most  = STEP_LIMIT_PLAIN};

static const Choice *const Models[] = {&TensionCahnHilliard.choice, &TensionCurvature.choice, &None.choice, NULL};

PetscErrorCode TensionCreate(Domain domain, Scene scene, Kernel kernel, Tension *tension)
{
  Tension t;

  PetscFunctionBegin;
  PetscCall(PetscNew(&t));
  t->comm      = domain->comm;
  t->scene     = scene;
  t->dim       = domain->dim;
  t->rings     = domain->rings;
  t->weighted  = DomainVolumesDiffer(domain);
  t->size_most = DomainSizeMax(domain);
  t->spacing   = domain->spacing;
  t->active    = SceneHasTension(scene);
  t->ratio     = 1.75;
  for (PetscInt f = 0; f < 2 * DIM; f++) t->face[f / 2][f % 2] = domain->face[f / 2][f % 2];
  do {
    t->largest[t->levels] = PetscMin(t->size_most, CloudLevelSize(t->levels));
  } while (t->largest[t->levels++] < t->size_most && t->levels < SIZE_LEVELS);
  PetscCall(PetscStrncpy(t->type, TENSION_CURVATURE, sizeof(t->type)));
  PetscCall(KernelCreate(domain->comm, domain->dim, &t->kernel));
  t->smoothing = KernelSmoothingLength(kernel);
  *tension     = t;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Frees the data of the model. */
static PetscErrorCode ForgetModel(Tension tension)
{
  PetscFunctionBegin;
  if (tension->model && tension->model->destroy) PetscCall(tension->model->destroy(tension));
  PetscCall(PetscFree(tension->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A ChoiceReader: sets the model and reads its options. */
static PetscErrorCode ReadModel(void *object, const Choice *choice)
{
  Tension tension = (Tension)object;
  char    title[128];

  PetscFunctionBegin;
  PetscCall(ForgetModel(tension));
  tension->model = (const TensionModel *)choice;
  PetscCall(PetscCalloc(choice->size, &tension->data));
  if (choice->defaults) choice->defaults(tension);
  if (!choice->options && !tension->model->more) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(title, sizeof(title), "Surface tension with -tension_type %s", choice->name));
  PetscOptionsBegin(tension->comm, NULL, title, "Tension");
  if (choice->options)
    PetscCall(OptionsRead(PetscOptionsObject, choice->options, "TensionSetFromOptions", tension->data));
  if (tension->model->more) PetscCall(tension->model->more(tension, PetscOptionsObject));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow options[] = {
  {"-tension_type", "Surface tension model", NULL, NULL, ROW_CHOICE, offsetof(struct _p_Tension, type),
   .choices = Models},
  {"-tension_ratio", "Smoothing length H of the tension over h; the paper has 2.5", "1", "[1, 4]", ROW_REAL,
   offsetof(struct _p_Tension, ratio)},
  {.name = NULL},
};

PetscErrorCode TensionSetFromOptions(Tension tension)
{
  const Choice *choice;

  PetscFunctionBegin;
  PetscCall(OptionsReadBlock(tension->comm, "Surface tension", options, __func__, tension));
  PetscCall(ChoiceFind(tension->comm, Models, "-tension_type", tension->type, &choice));
  PetscCall(ChoicesRead(Models, "-tension_type", NULL, choice, OptionsAll(), ReadModel, tension));
  if (!tension->model->apply) tension->active = PETSC_FALSE;
  PetscCall(KernelSetSmoothingLength(tension->kernel, tension->ratio * tension->smoothing));
  if (tension->active && choice->setup) PetscCall(choice->setup(tension));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void TensionStepLimits(Tension tension, PetscReal *limit, PetscReal *most)
{
  *limit = tension->model->step_limit;
  *most  = tension->model->step_most;
}

PetscBool TensionOnSurface(Tension tension)
{
  return (PetscBool)(tension->active && !tension->surfaces && tension->model->on_surface);
}

PetscReal TensionReach(Tension tension)
{
  return tension->active ? KernelSupport(tension->kernel) : 0;
}

void TensionClear(Cloud cloud)
{
  (void)PetscArrayzero(cloud->field[FIELD_CAPILLARY], cloud->n_owned);
  (void)PetscArrayzero(cloud->field[FIELD_CAPILLARY_SLOPE], DIM * cloud->n_owned);
  CloudWrote(cloud, FIELD_CAPILLARY); /* and FIELD_CAPILLARY_SLOPE, FIELD_BENDING */
  if (cloud->field[FIELD_BENDING]) (void)PetscArrayzero(cloud->field[FIELD_BENDING], cloud->n_owned);
}

PetscErrorCode TensionApply(Tension tension, Cloud cloud)
{
  PetscFunctionBegin;
  tension->kept.layout = -1;
  TensionClear(cloud);
  if (!tension->active) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_TENSION), 0, 0, 0, 0));
  PetscCall(tension->model->apply(tension, cloud));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_TENSION), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TensionView(Tension tension, PetscViewer viewer)
{
  PetscFunctionBegin;
  if (tension->active)
    PetscCall(PetscViewerASCIIPrintf(viewer, "Tension: %s, H = %g m\n", tension->type,
                                     (double)KernelSmoothingLength(tension->kernel)));
  else
    PetscCall(PetscViewerASCIIPrintf(viewer, "Tension: none\n"));
  if (tension->active) PetscCall(ContactView(tension, viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void TensionJson(Tension tension, Json *json)
{
  JsonObject(json, "tension");
  JsonText(json, "model", tension->active ? tension->type : TENSION_NONE);
  JsonText(json, "contact_law", MovingLines.law(TensionLines(tension)));
  ContactJson(tension, json);
  JsonEnd(json);
}

void TensionSetSurfaces(Tension tension, TensionSurfaces surfaces)
{
  tension->surfaces = surfaces;
}

PetscErrorCode TensionDestroy(Tension *tension)
{
  PetscFunctionBegin;
  if (!*tension) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(KernelDestroy(&(*tension)->kernel));
  PetscCall(PetscFree2((*tension)->kept.of, (*tension)->kept.value));
  PetscCall(ForgetModel(*tension));
  for (PetscInt l = 0; l < SIZE_LEVELS; l++) PetscCall(SortedCellsReset(&(*tension)->liquid[l]));
  PetscCall(PetscFree(*tension));
  PetscFunctionReturn(PETSC_SUCCESS);
}
