"""The environment of the program's processes under Open MPI, for tests/runs.py and tests/run.py."""
import os

ANY = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
       "OMP_NUM_THREADS": "1", "HWLOC_COMPONENTS": "-gl"}  # an X server that ends would end mpiexec
ALONE = {"OMPI_MCA_pml": "ob1", "OMPI_MCA_btl": "self", "OMPI_MCA_ess_singleton_isolated": "1"}


def environment(ranks, folder):
    """That of a run of so many ranks. One alone must not yield: on a busy machine each call of MPI then costs it a
    slice of time, and a small run four times as long. Nor need it look for networks and servers, which takes Open MPI
    0.3 s of waiting a start; all such runs have one job number, so each needs a folder of its own."""
    more = dict(ALONE, OMPI_MCA_orte_tmpdir_base=folder) if ranks == 1 else {}
    return dict(os.environ, **ANY, OMPI_MCA_mpi_yield_when_idle="1" if ranks > 1 else "0", **more)
