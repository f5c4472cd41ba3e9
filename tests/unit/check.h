/* The checks of the unit tests. A test is a program: CHECK... for each fact, then  return CHECK_DONE();  at the end of
   main. Rank 0 prints 'ok <name>' lines; a failing check prints 'FAIL <name>: got .. expected .. tol ..' from every
   rank it fails on. */
#ifndef ISPH_CHECK_H
#define ISPH_CHECK_H

#include <petsc.h>
#include <stdio.h>

static int check_count, check_failures;

static inline void CheckReport(int passed, const char name[], double got, double expected, double tol)
{
  PetscMPIInt rank = 0;
  int         running;

  if (!MPI_Initialized(&running) && running && !MPI_Finalized(&running) && !running)
    (void)MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  check_count++;
  if (!passed) check_failures++;
  if (!passed)
    printf("FAIL %s: got %.17g expected %.17g tol %g\n", name, got, expected, tol);
  else if (!rank)
    printf("ok %s\n", name);
  fflush(stdout);
}

static inline void CheckTrue(int passed, const char name[])
{
  CheckReport(passed, name, passed, 1., 0.);
}

static inline void CheckClose(double value, double expected, double tol, const char name[])
{
  double error = value - expected;

  /* NaN fails, and two equal infinities pass. */
  CheckReport(value == expected || (error <= tol && -error <= tol), name, value, expected, tol);
}

/* CHECK - that a condition holds.  CHECK_CLOSE - that |value - expected| <= tol. */
#define CHECK(cond, name)                       CheckTrue((cond) ? 1 : 0, name)
#define CHECK_CLOSE(value, expected, tol, name) CheckClose((double)(value), (double)(expected), (double)(tol), name)
/* CHECK_DONE - the value main returns: 0 when at least one check ran and none failed. */
#define CHECK_DONE() (check_count && !check_failures ? 0 : 1)

#endif
