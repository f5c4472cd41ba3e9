"""A display for VTK: Debian's draws in a window only."""
import atexit
import concurrent.futures
import multiprocessing
import os
import shutil
import subprocess
import sys
import time

from isph.tables import PACKAGES, Error

PATIENCE = 5  # s between lines of progress


def with_display():
    """Starts an X server without a screen, until this program ends, if there is no display. The server chooses its
    number itself: xvfb-run looks for a free one, which another program may take meanwhile. It does not start anew when
    its last window closes: one opened then finds no server."""
    if os.environ.get("DISPLAY"):
        return
    if not shutil.which("Xvfb"):
        raise Error(f"without a display the pictures need xvfb: apt-get install {PACKAGES}")
    reading, writing = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(writing), "-noreset", "-screen", "0", "1280x1024x24"],
                              pass_fds=[writing], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(writing)
    atexit.register(server.terminate)
    with os.fdopen(reading, encoding="ascii") as answer:
        number = answer.readline().strip()
    if not number:
        raise Error("Xvfb, which the pictures need without a display, does not start.")
    os.environ["DISPLAY"], os.environ["LIBGL_ALWAYS_SOFTWARE"] = f":{number}", "1"


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
