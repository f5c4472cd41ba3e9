/* Floor 11: the whole program: options, set-up, the loop over steps, progress. */
#ifndef ISPH_SIM_H
#define ISPH_SIM_H

#include "../output/output.h"
#include "../packing/packing.h"
#include "../spectrum/spectrum.h"
#include "../stepper/stepper.h"

typedef struct _p_Sim *Sim;

/* SimCreate - an empty program. SimEmbed - it is a part of another program: it has no timer and prints no lines of
   progress unless options ask for them, it needs no end, and without -output_dir it writes no files. Collective. */
PetscErrorCode SimCreate(MPI_Comm comm, Sim *sim);
PetscErrorCode SimEmbed(Sim sim);
/* SimSetFromOptions - makes all parts of the program from their options, and reads -time_start, -time_end (s), -restart
   (file), -progress_interval (s of wall clock). Refuses (UserError) bad input. -help prints all options, -dump_options
   writes them into a file; both set *stop. Collective. */
PetscErrorCode SimSetFromOptions(Sim sim, PetscBool *stop);
/* SimSetUp - sets up particles from the packing or a checkpoint, run folder and solver. Refuses (UserError) options
   that nothing has read. Collective. */
PetscErrorCode SimSetUp(Sim sim);
PetscErrorCode SimView(Sim sim, PetscViewer viewer);
/* SimStep - a step, at most to the time 'end' (s), and what the run writes after it. A step that fails in spite of
   smaller steps ends the run with a checkpoint of the last good state and a UserError. SimEnded - whether the run is at
   its end, whose step writes the last state. SimFinish - says where the results are, and computes the spectrum.
   SimSetEnd - the run ends at this time (s), too. SimStep and SimFinish are collective. */
PetscErrorCode SimStep(Sim sim, PetscReal end);
PetscBool      SimEnded(Sim sim);
PetscErrorCode SimFinish(Sim sim);
void           SimSetEnd(Sim sim, PetscReal end);
/* SimCheckpoint - writes a checkpoint of the state. Collective. */
PetscErrorCode SimCheckpoint(Sim sim);
/* SimSetField - positions (m) or velocities (m/s) of this rank's particles, [n][DIM]; rows of particles of walls are
   not read. The energy that the liquid gets so counts as brought. *fine: all are numbers, and no place is outside of
   the box; else nothing changes. Collective. */
PetscErrorCode SimSetField(Sim sim, FieldId field, const double values[], PetscBool *fine);
/* SimScene - scene.json as a text on rank 0, NULL elsewhere; to be freed with free. particles: SimSetUp has been
   called. Collective. */
PetscErrorCode SimScene(Sim sim, PetscBool particles, char **text);
/* SimState, SimParticles, SimOutput - borrowed. SimWrites - whether the run writes into a folder. SimUnit - a unit in
   the scene's dimensions: DomainUnit. Not collective. */
PetscBool        SimWrites(Sim sim);
const char      *SimUnit(Sim sim, const char unit[]);
MPI_Comm         SimComm(Sim sim);
const StepState *SimState(Sim sim);
Particles        SimParticles(Sim sim);
Output           SimOutput(Sim sim);
/* SimIsDry - whether -dry_run was given: then call SimDryRun in place of SimRun. Not collective. */
PetscBool SimIsDry(Sim sim);
/* SimMeasures - whether -measure was given: then call SimMeasure in place of SimRun. It writes the columns at the times
   of the snapshots of a run into measured.csv of its folder. Collective, on one process. */
PetscBool      SimMeasures(Sim sim);
PetscErrorCode SimMeasure(Sim sim);
/* SimDryRun - prints what the run would need: particles, memory, the bounds of the time step, time (from a few trial
   steps and a rehearsal with a coarser spacing) and output; draws the initial state into <-output_dir>.svg. Writes
   nothing else. Collective. */
PetscErrorCode SimDryRun(Sim sim);
PetscErrorCode SimDestroy(Sim *sim);

#endif
