/* Floor 8: the whole program: options, set-up, the loop over steps, progress. */
#ifndef ISPH_SIM_H
#define ISPH_SIM_H

#include "../output/output.h"
#include "../packing/packing.h"
#include "../stepper/stepper.h"

typedef struct _p_Sim *Sim;

/* SimCreate - nothing yet. Collective. */
PetscErrorCode SimCreate(MPI_Comm comm, Sim *sim);
/* SimSetFromOptions - every class reads its options, in the order they need each other; -time_start, -time_end (s),
   -restart (file), -progress_interval (s of wall clock). Refuses bad input (UserError). With -help it prints all
   options and sets *stop. Collective. */
PetscErrorCode SimSetFromOptions(Sim sim, PetscBool *stop);
/* SimSetUp - particles from the packing or a checkpoint, run folder, solver; refuses options nobody read. Collective.
 */
PetscErrorCode SimSetUp(Sim sim);
PetscErrorCode SimView(Sim sim, PetscViewer viewer);
/* SimRun - steps to -time_end. A step that cannot be saved ends the run with a checkpoint of the last good state and a
 * UserError. Collective. */
PetscErrorCode SimRun(Sim sim);
PetscErrorCode SimDestroy(Sim *sim);

#endif
