"""A display for VTK: Debian's draws in a window only."""
import concurrent.futures
import multiprocessing
import os
import shutil
import sys

from tables import PACKAGES, RunError


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


def together(function, items):
    """[function(item), ...], by as many processes as there are cores. They are forked, so it is called before anything
    is rendered: a connexion to the display is one process's."""
    cores = len(os.sched_getaffinity(0))
    if min(cores, len(items)) < 2:
        return [function(item) for item in items]
    with concurrent.futures.ProcessPoolExecutor(cores, multiprocessing.get_context("fork")) as pool:
        return list(pool.map(function, items))
