/* -dry_run: what a run would need, and a picture of its start. */
#include "../storage/storage.h"
#include "sim_impl.h"
#include <errno.h>
#include <petsctime.h>
#include <stdio.h>
#include <string.h>

#define DRAWN        4     /* numbers for each particle of the picture */
#define SIZE_STEPS   4     /* size classes of graded particles for each fine spacing */
#define SIZE_CLASSES 20    /* size classes at most */
#define WRITE_TIME   7e-3  /* s, for a snapshot of any size with its lines of the series */
#define WRITE_RATE   50e6  /* bytes/s, compressed and written */
#define PICTURE      800.0 /* pixels, the larger side */
#define SLAB         0.75  /* spacings to both sides of the middle of a scene in three dimensions */
#define CHANGED      0.02  /* of the liquid's particles, of which a change is said */
#define MEGABYTE     1e6   /* has so many bytes */

/* Okabe and Ito's colours, told apart by colour-blind eyes too */
static const char *const colors[] = {"#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00"};

PetscBool SimIsDry(Sim sim)
{
  return sim->dry_run;
}

/* A line about one body or solid: its particles, of an emitter one filling's, against the volume of its shape; of a
   solid against that part of it which liquid feels. */
static PetscErrorCode PrintBody(Sim sim, Body body, PetscInt solid, PetscInt count, PetscReal volume)
{
  const PetscReal shape = ShapeVolume(sim, body, solid);
  const PetscBool later = BodyComesLater(body);

  PetscFunctionBegin;
  PetscCall(PetscPrintf(sim->comm, "    %s: %" PetscInt_FMT " particles, %s%.4g %s", BodyName(body), count,
                        later ? "a filling of " : "", (double)volume, DomainUnit(sim->domain, "m3")));
  if (shape > 0)
    PetscCall(PetscPrintf(sim->comm, ", %+.1f %% of its %s", (double)(100 * (volume / shape - 1)),
                          solid < 0 ? "shape" : "shape near its surface"));
  PetscCall(PetscPrintf(sim->comm, "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Prints the volume of the particles of each body and solid against that of its shape: if they differ, choose another
   spacing. */
static PetscErrorCode PrintBodies(Sim sim)
{
  PetscInt      *count;
  PetscReal     *volumes;
  const PetscInt bodies = SceneCount(sim->scene), all = bodies + SceneSolidCount(sim->scene);
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(all, &count, all, &volumes));
  PetscCall(ParticlesOpen(sim->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt body = arrays.integer[INT_BODY][a], b = body >= 0 ? body : bodies + BODY_SOLID - body;

    if (body == BODY_WALL) continue;
    count[b]++;
    volumes[b] += ParticleVolume(sim->domain, &arrays, a);
  }
  PetscCall(ParticlesClose(sim->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, (PetscMPIInt)all, MPIU_INT, MPI_SUM, sim->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, volumes, (PetscMPIInt)all, MPIU_REAL, MPI_SUM, sim->comm));
  for (PetscInt b = 0; b < bodies; b++) {
    const Body body = SceneBody(sim->scene, b);

    PetscCall(
      PrintBody(sim, body, -1, count[b], BodyComesLater(body) ? StepperFilling(sim->stepper, b, NULL) : volumes[b]));
  }
  for (PetscInt b = bodies; b < all; b++)
    PetscCall(PrintBody(sim, SceneSolid(sim->scene, b - bodies), b - bodies, count[b], volumes[b]));
  PetscCall(PetscFree2(count, volumes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Prints the number of liquid particles of each size, in steps of a quarter of the fine spacing. */
static PetscErrorCode PrintSizes(Sim sim)
{
  const Domain   domain              = sim->domain;
  const PetscInt last                = (PetscInt)PetscCeilReal(SIZE_STEPS * (DomainSizeMax(domain) - 1));
  PetscInt       count[SIZE_CLASSES] = {0};
  ParticleArrays arrays;

  PetscFunctionBegin;
  if (!domain->graded) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ParticlesOpen(sim->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscReal size = ParticleSize(domain, &arrays, a);

    if (arrays.integer[INT_BODY][a] >= 0) count[PetscMax(0, (PetscInt)PetscFloorReal(SIZE_STEPS * (size - 1) + 0.5))]++;
  }
  PetscCall(ParticlesClose(sim->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, SIZE_CLASSES, MPIU_INT, MPI_SUM, sim->comm));
  for (PetscInt k = 0; k <= last; k++)
    if (count[k])
      PetscCall(PetscPrintf(sim->comm, "    spacing about %.3g m: %" PetscInt_FMT "\n",
                            (double)(domain->spacing * (1 + (PetscReal)k / SIZE_STEPS)), count[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintParticles(Sim sim)
{
  PetscInt       count[3] = {0, 0, 0}; /* liquid, walls, solids */
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(sim->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt body = arrays.integer[INT_BODY][a];

    count[body >= 0 ? 0 : body == BODY_WALL ? 1 : 2]++;
  }
  PetscCall(ParticlesClose(sim->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, 3, MPIU_INT, MPI_SUM, sim->comm));
  PetscCall(PetscPrintf(sim->comm,
                        "Dry run\n  particles: %" PetscInt_FMT " of liquid, %" PetscInt_FMT
                        " of the box's walls, %" PetscInt_FMT " of solids\n",
                        count[0], count[1], count[2]));
  PetscCall(PrintBodies(sim));
  PetscCall(PrintSizes(sim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintMemory(Sim sim)
{
  double         memory[2]; /* bytes, all ranks, and the largest */
  PetscLogDouble resident;

  PetscFunctionBegin;
  PetscCall(PetscMemoryGetCurrentUsage(&resident));
  memory[0] = memory[1] = (double)resident;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &memory[0], 1, MPI_DOUBLE, MPI_SUM, sim->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &memory[1], 1, MPI_DOUBLE, MPI_MAX, sim->comm));
  PetscCall(PetscPrintf(sim->comm, "  memory: %.0f MB in all, %.0f MB on the largest rank, after the trial steps\n",
                        memory[0] / MEGABYTE, memory[1] / MEGABYTE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintBounds(Sim sim)
{
  StepBound      bound[STEP_BOUNDS];
  const PetscInt n = StepperBounds(sim->stepper, bound);

  PetscFunctionBegin;
  PetscCall(PetscPrintf(sim->comm, "  bounds of the time step at the start, and what lifts them:\n"));
  for (PetscInt k = 0; k < n; k++)
    PetscCall(PetscPrintf(sim->comm, "    %-18s %-8.3g s  %s\n", bound[k].cause, (double)bound[k].step, bound[k].lift));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* beside: s in all for other work than steps. */
static PetscErrorCode PrintTime(Sim sim, const RunEstimate *run, PetscReal beside)
{
  char text[64];

  PetscFunctionBegin;
  if (PetscAbsReal(run->end - run->start) > CHANGED * run->start)
    PetscCall(PetscPrintf(sim->comm, "  at the end: about %.0f particles of liquid\n", (double)run->end));
  PetscCall(FormatDuration((double)(run->steps * run->step_time + beside), text, sizeof(text)));
  PetscCall(PetscPrintf(sim->comm, "  time: about %s: %.0f steps of %.3g s on this machine", text, (double)run->steps,
                        (double)run->step_time));
  if (run->coarser > 0)
    PetscCall(PetscPrintf(sim->comm, " (trial steps, and a rehearsal of %.0f %% of the run with a spacing of %.3g m)\n",
                          (double)(100 * run->rehearsed), (double)(run->coarser * sim->domain->spacing)));
  else if (run->rehearsed > 0)
    PetscCall(PetscPrintf(sim->comm, " (the whole run was tried)\n"));
  else
    PetscCall(PetscPrintf(sim->comm, " (trial steps alone); a flow that accelerates needs more\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rank 0 writes the picture. particle: [n][DRAWN] x, up, colour and size of the particles of the slab, from all ranks.
   Returns an errno. */
static int Draw(Sim sim, const char path[], PetscInt n, const double particle[])
{
  const Domain domain = sim->domain;
  const int    up     = (int)domain->dim - 1;
  const double wide   = (double)(domain->upper[0] - domain->lower[0]),
               high = (double)(domain->upper[up] - domain->lower[up]), scale = PICTURE / PetscMax(wide, high);
  FILE *file = fopen(path, "w");

  if (!file) return errno;
  fprintf(file,
          "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\">\n<rect width=\"100%%\" "
          "height=\"100%%\" fill=\"white\" stroke=\"black\"/>\n",
          wide * scale, high * scale + 20);
  for (PetscInt k = 0; k < n; k++) {
    const int body = (int)particle[DRAWN * k + 2];

    fprintf(file, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\" fill=\"%s\"/>\n",
            (particle[DRAWN * k] - (double)domain->lower[0]) * scale,
            ((double)domain->upper[up] - particle[DRAWN * k + 1]) * scale,
            0.5 * particle[DRAWN * k + 3] * (double)domain->spacing * scale,
            body < 0 ? "#999999" : colors[(size_t)body % PETSC_STATIC_ARRAY_LENGTH(colors)]);
  }
  for (PetscInt b = 0; b < SceneCount(sim->scene); b++)
    fprintf(file, "<text x=\"%.0f\" y=\"%d\" font-size=\"14\" text-anchor=\"end\" fill=\"%s\">%s</text>\n",
            wide * scale - 4, 16 * ((int)b + 1), colors[(size_t)b % PETSC_STATIC_ARRAY_LENGTH(colors)],
            BodyName(SceneBody(sim->scene, b)));
  fprintf(file, "<text x=\"4\" y=\"%.0f\" font-size=\"14\">%s; %g m wide, %g m high</text>\n</svg>\n",
          high * scale + 15, domain->dim == 3 ? "section through the middle of y" : "x to the right, y up", wide, high);
  return fclose(file) ? errno : 0;
}

/* Makes the folder that a file is to be in, with its parents; an errno, or 0. */
static int MakePlace(const char path[])
{
  char folder[PETSC_MAX_PATH_LEN], *slash;

  PetscCallAbort(PETSC_COMM_SELF, PetscStrncpy(folder, path, sizeof(folder)));
  slash = strrchr(folder, '/');
  if (!slash || slash == folder) return 0;
  *slash = 0;
  return FolderCreate(folder);
}

static PetscErrorCode Picture(Sim sim)
{
  const Domain    domain = sim->domain;
  const PetscReal middle = 0.5 * (domain->lower[1] + domain->upper[1]);
  const PetscInt  up     = domain->dim - 1;
  PetscMPIInt     rank;
  PetscInt        n = 0, total;
  double         *own, *all;
  ParticleArrays  arrays;
  char            path[PETSC_MAX_PATH_LEN];
  int             error = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(sim->comm, &rank));
  PetscCall(ParticlesOpen(sim->particles, &arrays));
  PetscCall(PetscMalloc1(DRAWN * arrays.n, &own));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscReal *x = arrays.real[FIELD_POSITION] + DIM * a, wide = ParticleSize(domain, &arrays, a);

    if (arrays.integer[INT_BODY][a] == BODY_WALL) continue;
    if (domain->dim == 3 && PetscAbsReal(x[1] - middle) > SLAB * wide * domain->spacing) continue;
    own[n++] = (double)x[0];
    own[n++] = (double)x[up];
    own[n++] = (double)arrays.integer[INT_BODY][a];
    own[n++] = (double)wide;
  }
  PetscCall(ParticlesClose(sim->particles, &arrays));
  PetscCall(GatherTo(sim->comm, PETSC_FALSE, n, own, MPI_DOUBLE, &total, &all));
  PetscCall(PetscSNPrintf(path, sizeof(path), "%s.svg", OutputFolder(sim->output)));
  if (!rank) error = MakePlace(path);
  if (!rank && !error) error = Draw(sim, path, total / DRAWN, all);
  PetscCall(PetscFree(all));
  PetscCall(PetscFree(own));
  PetscCallMPI(MPI_Bcast(&error, 1, MPI_INT, 0, sim->comm));
  PetscCheckUser(!error, sim->comm, "cannot write the picture %s: %s", path, strerror(error));
  PetscCall(PetscPrintf(sim->comm, "  picture of the start: %s\n", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SimDryRun(Sim sim)
{
  PetscInt64  snapshots, bytes, checkpoint;
  RunEstimate run;
  StepTimes   times;
  SceneModel  model;
  PetscReal   beside, each[2]; /* s, for the start and for output; bytes */
  PetscInt    liquid;
  double      now;

  PetscFunctionBegin;
  ProgressBegin("the dry run", "nothing is lost");
  PetscCall(PetscTime(&now));
  PetscCall(OutputEstimate(sim->output, sim->state.time, sim->time_end, &snapshots, &bytes, &checkpoint, each));
  PetscCall(CountLiquid(sim, &liquid));
  ModelFind(sim, &model);
  PetscCall(ModelPrint(sim, &model));
  PetscCall(Picture(sim));
  PetscCall(PrintParticles(sim));
  PetscCall(PrintBounds(sim));
  PetscCall(TrySteps(sim, &times));
  PetscCall(PrintMemory(sim));
  PetscCall(EstimateRun(sim, liquid, &times, &run));
  bytes += (PetscInt64)(each[0] * (run.mean - run.start));
  checkpoint += (PetscInt64)(each[1] * (run.end - run.start));
  beside = (PetscReal)(now - petsc_BaseTime) + (PetscReal)snapshots * (WRITE_TIME + (PetscReal)bytes / WRITE_RATE);
  PetscCall(PrintTime(sim, &run, beside));
  PetscCall(PetscPrintf(sim->comm,
                        "  output: about %" PetscInt64_FMT
                        " snapshots of %.3g MB, two checkpoints of %.3g MB: %.3g MB\n",
                        snapshots, (double)bytes / MEGABYTE, (double)checkpoint / MEGABYTE,
                        (double)(snapshots * bytes + 2 * checkpoint) / MEGABYTE));
  PetscFunctionReturn(PETSC_SUCCESS);
}
