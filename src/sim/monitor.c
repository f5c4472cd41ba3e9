/* -monitor: every step, the PETSc way. ascii: a line on the screen; ascii:file: a line in a file; ascii:file:ascii_csv:
   comma-separated values with a head line; draw: the particles, coloured by body, in the plane of the first and the
   last direction (in three dimensions a slab through the middle). */
#include "sim_impl.h"
#include <petscdraw.h>

#define DOT  0.005 /* of the window */
#define SLAB 0.75  /* spacings to both sides of the middle */

static const OptionRow options[] = {
  {"-monitor", "Output of every step: ascii, ascii:file, ascii:file:ascii_csv or draw", NULL, NULL, ROW_TEXT, 0},
  {.name = NULL},
};

PetscErrorCode MonitorSetFromOptions(Sim sim)
{
  PetscViewerFormat format = PETSC_VIEWER_DEFAULT;
  PetscBool         set;
  char              wanted[PETSC_MAX_PATH_LEN] = "";

  PetscFunctionBegin;
  PetscCall(OptionsReadBlock(sim->comm, "Monitor", options, __func__, wanted));
  PetscCall(PetscOptionsGetViewer(sim->comm, NULL, NULL, "-monitor", &sim->monitor, &format, &set));
  if (!set || !sim->monitor) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscObjectTypeCompare((PetscObject)sim->monitor, PETSCVIEWERDRAW, &sim->monitor_draw));
  sim->monitor_csv = (PetscBool)(format == PETSC_VIEWER_ASCII_CSV);
  if (sim->monitor_draw) { /* opens the window now: its own options, -draw_pause and so on, are read with the others */
    PetscDraw draw;

    PetscCall(PetscViewerDrawGetDraw(sim->monitor, 0, &draw));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DrawParticles(Sim sim)
{
  const Domain    domain = sim->domain;
  const PetscInt  up     = domain->dim - 1;
  const PetscReal middle = 0.5 * (domain->lower[1] + domain->upper[1]);
  const PetscReal side   = PetscMax(domain->upper[0] - domain->lower[0], domain->upper[up] - domain->lower[up]);
  PetscDraw       draw;
  ParticleArrays  arrays;

  PetscFunctionBegin;
  PetscCall(PetscViewerDrawGetDraw(sim->monitor, 0, &draw));
  PetscDrawCollectiveBegin(draw);
  PetscCall(PetscDrawSetCoordinates(draw, domain->lower[0], domain->lower[up], domain->lower[0] + side,
                                    domain->lower[up] + side)); /* the same scale on both axes of the square window */
  PetscCall(PetscDrawPointSetSize(draw, DOT));
  PetscCall(PetscDrawClear(draw));
  PetscCall(ParticlesOpen(sim->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscReal *x    = arrays.real[FIELD_POSITION] + DIM * a;
    const PetscInt   body = arrays.integer[INT_BODY][a];

    if (domain->dim == 3 && PetscAbsReal(x[1] - middle) > SLAB * domain->spacing) continue;
    PetscCall(PetscDrawPoint(draw, x[0], x[up], body < 0 ? PETSC_DRAW_GRAY : PETSC_DRAW_BLUE + body % 8));
  }
  PetscCall(ParticlesClose(sim->particles, &arrays));
  PetscDrawCollectiveEnd(draw);
  PetscCall(PetscDrawFlush(draw));
  PetscCall(PetscDrawSave(draw));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MonitorStep(Sim sim)
{
  const StepState *s = &sim->state;
  PetscViewer      v = sim->monitor;

  PetscFunctionBegin;
  if (!v) PetscFunctionReturn(PETSC_SUCCESS);
  if (sim->monitor_draw)
    PetscCall(DrawParticles(sim));
  else if (sim->monitor_csv) {
    if (!sim->monitor_lines++)
      PetscCall(PetscViewerASCIIPrintf(v, "time_s,step,time_step_s,iterations,density_error,rejected,lost\n"));
    PetscCall(PetscViewerASCIIPrintf(
      v, "%.12g,%" PetscInt_FMT ",%.6g,%" PetscInt_FMT ",%.4g,%" PetscInt_FMT ",%" PetscInt_FMT "\n", (double)s->time,
      s->step, (double)s->time_step, s->iterations, (double)s->density_error, s->rejected, s->lost));
  } else
    PetscCall(PetscViewerASCIIPrintf(
      v, "step %6" PetscInt_FMT "  t = %.6g s  dt = %.4g s  its %3" PetscInt_FMT "  density error %.2e\n", s->step,
      (double)s->time, (double)s->time_step, s->iterations, (double)s->density_error));
  if (!sim->monitor_draw) PetscCall(PetscViewerFlush(v));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MonitorDestroy(Sim sim)
{
  PetscFunctionBegin;
  PetscCall(PetscViewerDestroy(&sim->monitor));
  PetscFunctionReturn(PETSC_SUCCESS);
}
