"""A display for VTK: Debian's draws in a window only."""
import concurrent.futures
import multiprocessing
import os
import shutil
import sys
import time

from tables import PACKAGES, RunError

PATIENCE = 5  # s between lines of progress


def with_display():
    """Starts this program again under xvfb-run if there is no display."""
    if os.environ.get("DISPLAY"):
        return
    if not shutil.which("xvfb-run") or not shutil.which("xauth"):
        raise RunError(f"without a display the pictures need xvfb: apt-get install {PACKAGES}")
    os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"
    command = ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", sys.executable, os.path.abspath(sys.argv[0])]
    sys.stdout.flush()
    os.execvp(command[0], command + sys.argv[1:])


def counted(results, count, what):
    """Passes results on; lines on standard error say how many there are."""
    last = time.monotonic()
    for number, result in enumerate(results, 1):
        if number == count or time.monotonic() - last > PATIENCE:
            last = time.monotonic()
            print(f"{what}: {number} of {count}", file=sys.stderr, flush=True)
        yield result


def together(function, items, what):
    """[function(item), ...], by as many processes as there are cores. They are forked, so it is called before anything
    is rendered: a connexion to the display is one process's. what: the items, in lines of progress."""
    cores = len(os.sched_getaffinity(0))
    if min(cores, len(items)) < 2:
        return list(counted(map(function, items), len(items), what))
    with concurrent.futures.ProcessPoolExecutor(cores, multiprocessing.get_context("fork")) as pool:
        return list(counted(pool.map(function, items), len(items), what))
