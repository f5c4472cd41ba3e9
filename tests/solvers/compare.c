/* Compares solvers of the pressure equation on one state: the first of a scene's options, or that of -state FILE, a
   snapshot or checkpoint of a run with these options. Every solver solves the same system from zero, once to the
   tolerance of the run (-ksp_rtol) for its cost and once to AGREE_RTOL for its answer, which must be that of the others
   to AGREEMENT. Prints iterations, times, memory, 'ok' or 'FAIL' a solver, and what to take.

     compare -options_file run.opts [-state FILE]
*/
#include "../../src/sim/sim_impl.h"
#include <hdf5.h>
#include <malloc.h>

#define AGREE_RTOL   1e-9
#define AGREEMENT    1e-6  /* relative 2-norm; 1e-9 times a condition number of some thousands, and a margin */
#define DIRECT_MOST  20000 /* rows that a direct solver is tried on */
#define KEEP_CHEAP   10    /* steps a preconditioner is kept: as the program does by default */
#define KEEP_DEAR    50
#define DEFAULT_RTOL 1e-3
#define REPEATS      3

typedef struct {
  const char *name, *options;
  PetscInt    keep;
  PetscBool   direct;
} Candidate;

static const Candidate candidates[] = {
  {"cg, own two-level (default)", "-ksp_type cg -pc_type twolevel", KEEP_CHEAP, PETSC_FALSE},
  {"cg, none", "-ksp_type cg -pc_type none", KEEP_CHEAP, PETSC_FALSE},
  {"cg, jacobi", "-ksp_type cg -pc_type jacobi", KEEP_CHEAP, PETSC_FALSE},
  {"cg, sor", "-ksp_type cg -pc_type sor", KEEP_CHEAP, PETSC_FALSE},
  {"cg, bjacobi/icc", "-ksp_type cg -pc_type bjacobi -sub_pc_type icc", KEEP_DEAR, PETSC_FALSE},
  {"cg, asm/icc", "-ksp_type cg -pc_type asm -pc_asm_type basic -sub_pc_type icc", KEEP_DEAR, PETSC_FALSE},
  {"cg, gamg", "-ksp_type cg -pc_type gamg", KEEP_DEAR, PETSC_FALSE},
  {"cg, hypre",
   "-ksp_type cg -pc_type hypre -pc_hypre_boomeramg_strong_threshold 0.5 -pc_hypre_boomeramg_coarsen_type PMIS "
   "-pc_hypre_boomeramg_interp_type ext+i -pc_hypre_boomeramg_agg_nl 1",
   KEEP_DEAR, PETSC_FALSE},
  {"cg, ml", "-ksp_type cg -pc_type ml -pc_ml_Threshold 0.02", KEEP_DEAR, PETSC_FALSE},
  {"minres, jacobi", "-ksp_type minres -ksp_norm_type preconditioned -pc_type jacobi", KEEP_CHEAP, PETSC_FALSE},
  {"gmres, own two-level", "-ksp_type gmres -ksp_pc_side right -pc_type twolevel", KEEP_CHEAP, PETSC_FALSE},
  {"bcgs, own two-level", "-ksp_type bcgs -ksp_pc_side right -pc_type twolevel", KEEP_CHEAP, PETSC_FALSE},
  {"mumps cholesky", "-ksp_type cg -pc_type cholesky -pc_factor_mat_solver_type mumps -mat_mumps_icntl_24 1", 1,
   PETSC_TRUE}};

#define CANDIDATES ((PetscInt)PETSC_STATIC_ARRAY_LENGTH(candidates))

typedef struct {
  PetscInt  iterations, tight; /* to the run's tolerance, to AGREE_RTOL */
  PetscReal setup, solve;      /* s, the best of REPEATS */
  PetscReal slowest;           /* solve, the worst of them */
  PetscReal memory;            /* byte, largest of all ranks */
  PetscReal difference;        /* of the tight solution from the first candidate's, relative 2-norm */
  PetscBool ran, converged;
} Outcome;

/* --- the state --- */

/* All of a data set, on every rank: *values ([count][width]); count is a result. */
static PetscErrorCode ReadAll(hid_t file, const char name[], PetscInt width, PetscInt *count, PetscReal **values)
{
  hid_t    set, space;
  hssize_t total;

  PetscFunctionBegin;
  set = H5Dopen2(file, name, H5P_DEFAULT);
  PetscCheckUser(set >= 0, PETSC_COMM_WORLD, "the file of -state has no data set %s", name);
  space = H5Dget_space(set);
  total = H5Sget_simple_extent_npoints(space);
  PetscCall(PetscMalloc1(total, values));
  PetscCheck(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, *values) >= 0, PETSC_COMM_SELF,
             PETSC_ERR_FILE_READ, "cannot read %s", name);
  *count = (PetscInt)total / width;
  PetscCheck(H5Sclose(space) >= 0 && H5Dclose(set) >= 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "HDF5");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives the fluid particles of the packing the positions, velocities and pressures of the file, by id; those that the
   file does not have had left the box. */
static PetscErrorCode TakeState(Sim sim, const char path[])
{
  PetscReal     *id, *x, *v, *p;
  PetscInt       count, same, last = 0, *place;
  PetscBool     *keep;
  ParticleArrays arrays;
  hid_t          file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);

  PetscFunctionBegin;
  PetscCheckUser(file >= 0, sim->comm, "-state %s cannot be opened as an HDF5 file", path);
  PetscCall(ReadAll(file, "id", 1, &count, &id));
  PetscCall(ReadAll(file, "position", DIM, &same, &x));
  PetscCall(ReadAll(file, "velocity", DIM, &same, &v));
  PetscCall(ReadAll(file, "pressure", 1, &same, &p));
  PetscCheck(H5Fclose(file) >= 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "HDF5");
  PetscCheckUser(same == count, sim->comm, "-state %s: its data sets have different lengths", path);
  for (PetscInt k = 0; k < count; k++) last = PetscMax(last, (PetscInt)id[k]);
  PetscCall(PetscMalloc1(last + 1, &place));
  for (PetscInt k = 0; k <= last; k++) place[k] = -1;
  for (PetscInt k = 0; k < count; k++) place[(PetscInt)id[k]] = k;
  PetscCall(ParticlesOpen(sim->particles, &arrays));
  PetscCall(PetscMalloc1(arrays.n, &keep));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt number = arrays.integer[INT_ID][a], k = number <= last ? place[number] : -1;

    keep[a] = (PetscBool)(k >= 0 || arrays.integer[INT_LAYER][a] > 0);
    if (k < 0 || arrays.integer[INT_LAYER][a]) continue;
    PetscCall(PetscArraycpy(arrays.real[FIELD_POSITION] + DIM * a, x + DIM * k, DIM));
    PetscCall(PetscArraycpy(arrays.real[FIELD_VELOCITY] + DIM * a, v + DIM * k, DIM));
    arrays.real[FIELD_PRESSURE][a] = p[k];
  }
  PetscCall(ParticlesClose(sim->particles, &arrays));
  PetscCall(ParticlesRemove(sim->particles, keep));
  PetscCall(PetscFree(keep));
  PetscCall(PetscFree(place));
  PetscCall(PetscFree(id));
  PetscCall(PetscFree(x));
  PetscCall(PetscFree(v));
  PetscCall(PetscFree(p));
  PetscCall(CloudResync(sim->cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- a candidate --- */

/* Seconds that an event took so far, largest of all ranks. */
static PetscErrorCode Spent(MPI_Comm comm, const char event[], PetscReal *seconds)
{
  PetscEventPerfInfo info;
  PetscLogEvent      id;
  PetscReal          own;

  PetscFunctionBegin;
  PetscCall(PetscLogEventGetId(event, &id));
  PetscCall(PetscLogEventGetPerfInfo(PETSC_DETERMINE, id, &info));
  own = info.time;
  PetscCallMPI(MPI_Allreduce(&own, seconds, 1, MPIU_REAL, MPIU_MAX, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal HeapInUse(void)
{
  const struct mallinfo2 info = mallinfo2();

  return (PetscReal)info.uordblks + (PetscReal)info.hblkhd;
}

/* Solves from zero to a tolerance. */
static PetscErrorCode Solve(KSP ksp, Vec b, Vec x, PetscReal rtol, PetscInt *iterations, PetscBool *converged)
{
  KSPConvergedReason reason;

  PetscFunctionBegin;
  PetscCall(VecSet(x, 0));
  PetscCall(KSPSetTolerances(ksp, rtol, PETSC_DEFAULT, PETSC_DEFAULT, 100000));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(KSPGetIterationNumber(ksp, iterations));
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  *converged = (PetscBool)(reason > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts options into the database, which then has nothing of the former candidate; words are separated by blanks. */
static PetscErrorCode Choose(const char *former, const char *options)
{
  PetscToken token;
  char      *word;

  PetscFunctionBegin;
  if (former) {
    PetscCall(PetscTokenCreate(former, ' ', &token));
    PetscCall(PetscTokenFind(token, &word));
    while (word) {
      if (word[0] == '-') PetscCall(PetscOptionsClearValue(NULL, word));
      PetscCall(PetscTokenFind(token, &word));
    }
    PetscCall(PetscTokenDestroy(&token));
  }
  PetscCall(PetscOptionsInsertString(NULL, options));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Relative 2-norm of the difference of a solution to the reference, which the first becomes; constants do not count
   where the pressure has one to spare. */
static PetscErrorCode Difference(KSP ksp, Vec x, Vec reference, PetscReal *difference)
{
  Mat          A;
  MatNullSpace constant;
  PetscReal    norm;

  PetscFunctionBegin;
  PetscCall(KSPGetOperators(ksp, &A, NULL));
  PetscCall(MatGetNullSpace(A, &constant));
  if (constant) PetscCall(MatNullSpaceRemove(constant, x));
  PetscCall(VecNorm(reference, NORM_2, &norm));
  *difference = 0;
  if (norm == 0) {
    PetscCall(VecCopy(x, reference));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(VecAXPY(x, -1, reference));
  PetscCall(VecNorm(x, NORM_2, difference));
  *difference /= norm;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Set-up and solution of the candidate whose options are in the database; times are the best of REPEATS. */
static PetscErrorCode Try(Sim sim, PetscReal dt, PetscReal rtol, Vec reference, Outcome *out)
{
  Vec       b, x;
  KSP       ksp;
  Mat       A;
  PetscReal before[2], after[2], heap;

  PetscFunctionBegin;
  out->ran   = PETSC_TRUE;
  out->setup = out->solve = out->difference = PETSC_INFINITY;
  for (PetscInt repeat = 0; repeat < REPEATS; repeat++) {
    PetscCall(PressureReset(sim->pressure));
    PetscCall(PressureAssemble(sim->pressure, dt, &A, &b));
    heap = HeapInUse();
    PetscCall(Spent(sim->comm, "PCSetUp", &before[0]));
    PetscCall(PressureSetUp(sim->pressure, dt));
    PetscCall(PressureSolver(sim->pressure, &ksp, &b));
    PetscCall(VecDuplicate(b, &x));
    PetscCall(Spent(sim->comm, "KSPSolve", &before[1]));
    PetscCall(Solve(ksp, b, x, rtol, &out->iterations, &out->converged));
    PetscCall(Spent(sim->comm, "PCSetUp", &after[0])); /* blocks are set up by the first solve */
    PetscCall(Spent(sim->comm, "KSPSolve", &after[1]));
    out->setup   = PetscMin(out->setup, after[0] - before[0]);
    out->solve   = PetscMin(out->solve, after[1] - before[1]);
    out->slowest = PetscMax(out->slowest, after[1] - before[1]);
    out->memory  = PetscMax(0, HeapInUse() - heap);
    if (repeat < REPEATS - 1) PetscCall(VecDestroy(&x));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &out->memory, 1, MPIU_REAL, MPIU_MAX, sim->comm));
  if (out->converged) PetscCall(Solve(ksp, b, x, AGREE_RTOL, &out->tight, &out->converged));
  if (out->converged) PetscCall(Difference(ksp, x, reference, &out->difference));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- the table --- */

/* Seconds a step: the solution, and the preconditioner's share. */
static PetscReal Cost(PetscInt k, const Outcome *out)
{
  return out->solve + out->setup / candidates[k].keep;
}

/* The same by the slowest solution of REPEATS: what is cheaper than this may be as fast as k. */
static PetscReal Slowest(PetscInt k, const Outcome *out)
{
  return out->slowest + out->setup / candidates[k].keep;
}

static PetscErrorCode Report(MPI_Comm comm, const Outcome out[], PetscReal rtol)
{
  PetscInt best = 0;

  PetscFunctionBegin;
  PetscCall(PetscPrintf(comm, "%-30s %9s %9s %9s %9s %9s %9s %10s\n", "", "its", "its", "set-up", "solve", "a step",
                        "memory", "deviation"));
  PetscCall(PetscPrintf(comm, "%-30s %9.0e %9.0e %9s %9s %9s %9s %10s\n", "to a tolerance of", (double)rtol, AGREE_RTOL,
                        "ms", "ms", "ms", "MB", ""));
  for (PetscInt k = 0; k < CANDIDATES; k++) {
    if (!out[k].ran) continue;
    PetscCall(PetscPrintf(comm, "%-30s %9" PetscInt_FMT " %9" PetscInt_FMT " %9.3g %9.3g %9.3g %9.3g %10.1e\n",
                          candidates[k].name, out[k].iterations, out[k].tight, 1e3 * (double)out[k].setup,
                          1e3 * (double)out[k].solve, 1e3 * (double)Cost(k, out + k), 1e-6 * (double)out[k].memory,
                          (double)out[k].difference));
    if (out[k].converged && Cost(k, out + k) < Cost(best, out + best)) best = k;
  }
  PetscCall(PetscPrintf(comm, "recommended: %s   (%s)\n", candidates[best].options, candidates[best].name));
  for (PetscInt k = 0; k < CANDIDATES; k++)
    if (k != best && out[k].ran && out[k].converged && Cost(k, out + k) <= Slowest(best, out + best))
      PetscCall(PetscPrintf(comm, "not slower within the scatter of %d timings: %s\n", REPEATS, candidates[k].name));
  for (PetscInt k = 0; k < CANDIDATES; k++) {
    if (!out[k].ran) continue;
    if (out[k].difference <= AGREEMENT)
      PetscCall(PetscPrintf(comm, "ok %s\n", candidates[k].name));
    else
      PetscCall(PetscPrintf(comm, "FAIL %s: its pressure deviates by %g from the first, allowed is %g\n",
                            candidates[k].name, (double)out[k].difference, AGREEMENT));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* state: file to take the particles from; NULL: the packing. */
static PetscErrorCode Compare(Sim sim, const char state[], PetscBool *failed)
{
  Outcome     out[CANDIDATES];
  const char *former = NULL;
  PetscReal   dt, rtol = DEFAULT_RTOL;
  Vec         reference, b;
  Mat         A;
  PetscInt    rows;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(out, CANDIDATES));
  PetscCall(PackingRun(sim->packing, &sim->report));
  if (state) PetscCall(TakeState(sim, state));
  PetscCall(PetscOptionsGetReal(NULL, NULL, "-ksp_rtol", &rtol, NULL));
  PetscCall(StepperPredict(sim->stepper, &sim->state, &dt));
  PetscCall(PressureAssemble(sim->pressure, dt, &A, &b));
  PetscCall(MatGetSize(A, &rows, NULL));
  PetscCall(VecDuplicate(b, &reference));
  PetscCall(VecSet(reference, 0));
  PetscCall(PetscPrintf(sim->comm, "%" PetscInt_FMT " rows, time step %.3g s\n", rows, (double)dt));
  for (PetscInt k = 0; k < CANDIDATES; k++) {
    if (candidates[k].direct && rows > DIRECT_MOST) continue;
    PetscCall(Choose(former, candidates[k].options));
    former = candidates[k].options;
    PetscCall(Try(sim, dt, rtol, reference, out + k));
    *failed = (PetscBool)(*failed || !(out[k].difference <= AGREEMENT));
  }
  PetscCall(Report(sim->comm, out, rtol));
  PetscCall(VecDestroy(&reference));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Run(PetscBool *failed)
{
  Sim       sim;
  PetscBool stop, set;
  char      state[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(LogRegister());
  PetscCall(PetscLogDefaultBegin());
  PetscCall(PetscOptionsGetString(NULL, NULL, "-state", state, sizeof(state), &set));
  PetscCall(SimCreate(PETSC_COMM_WORLD, &sim));
  PetscCall(SimSetFromOptions(sim, &stop));
  PetscCall(Compare(sim, set ? state : NULL, failed));
  PetscCall(SimDestroy(&sim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscBool failed = PETSC_FALSE;
  int       code;

  if (MPI_Init(&argc, &argv) || UserErrorHandlerPush()) return 2;
  if (PetscInitialize(&argc, &argv, NULL, NULL)) return 2;
  code = (int)Run(&failed);
  (void)PetscFinalize();
  (void)MPI_Finalize();
  return code || failed ? 1 : 0;
}
