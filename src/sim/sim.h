/* Floor 9: the whole program: options, set-up, the loop over steps, progress. */
#ifndef ISPH_SIM_H
#define ISPH_SIM_H

#include "../output/output.h"
#include "../packing/packing.h"
#include "../spectrum/spectrum.h"
#include "../stepper/stepper.h"

typedef struct _p_Sim *Sim;

/* SimCreate - an empty program. Collective. */
PetscErrorCode SimCreate(MPI_Comm comm, Sim *sim);
/* SimSetFromOptions - makes all parts of the program from their options, and reads -time_start, -time_end (s), -restart
   (file), -progress_interval (s of wall clock). Refuses (UserError) bad input. -help prints all options, -dump_options
   writes them into a file; both set *stop. Collective. */
PetscErrorCode SimSetFromOptions(Sim sim, PetscBool *stop);
/* SimSetUp - sets up particles from the packing or a checkpoint, run folder and solver. Refuses (UserError) options
   that nothing has read. Collective. */
PetscErrorCode SimSetUp(Sim sim);
PetscErrorCode SimView(Sim sim, PetscViewer viewer);
/* SimRun - steps to -time_end. A step that fails in spite of smaller steps ends the run with a checkpoint of the last
   good state and a UserError. Collective. */
PetscErrorCode SimRun(Sim sim);
/* SimIsDry - whether -dry_run was given: then call SimDryRun in place of SimRun. Not collective. */
PetscBool SimIsDry(Sim sim);
/* SimDryRun - prints what the run would need: particles, memory, the bounds of the time step, time (from a few trial
   steps and a rehearsal with a coarser spacing) and output; draws the initial state into <-output_dir>.svg. Writes
   nothing else. Collective. */
PetscErrorCode SimDryRun(Sim sim);
PetscErrorCode SimDestroy(Sim *sim);

#endif
