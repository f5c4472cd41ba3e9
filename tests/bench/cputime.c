/* Preloaded, makes PETSc's clock that of the process: -log_view then shows processor time, whatever else the machine
   does. */
#include <time.h>

double MPI_Wtime(void);

double MPI_Wtime(void)
{
  struct timespec t;

  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
