"""Runs of ./isph for the tests: start, read back, judge. Tests are scripts that import this and end with done()."""
import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile

import h5py
import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path[:0] = [os.path.join(ROOT, *place) for place in (("src", "python"), ("src", "pictures"), ("tests",))]
import mpi  # noqa: E402

PROGRAM = os.environ.get("ISPH", os.path.join(ROOT, "isph"))
for _signal in (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT):  # a test in the background is born with some ignored;
    if signal.getsignal(_signal) == signal.SIG_IGN:            # its runs are not
        signal.signal(_signal, signal.SIG_DFL)
# the generated file of a case: its head, and the titles of its parts by their markers
RESULTS = "# Results of {}\n\nGenerated tables, not to be edited; [README.md](README.md) says what they mean.\n"
PARTS = {"verify": "Verification", "measured": "Against the spacing", "tradeoff": "What choices cost",
         "seeds": "Several packings", "seeds_graded": "Several packings, graded",
         "seeds_rings": "Several packings, rings", "seeds_rings_graded": "Several packings, graded rings"}
# columns that the tests call without their unit
PLAIN = {"time", "time_step", "crown_height", "crater_depth", "crater_diameter", "kinetic_energy", "potential_energy",
         "surface_energy", "viscous_work", "tension_work", "outside_work", "jet_height", "highest", "volume",
         "wall_time"}
_scratch = tempfile.TemporaryDirectory(prefix="isph-test-")
_failures = 0


def scratch(name):
    """A path in a folder that vanishes with the test."""
    return os.path.join(_scratch.name, name)


def check(passed, name, why=""):
    """Prints 'ok name' or 'FAIL name: why'."""
    global _failures
    if isinstance(passed, str):  # the name in its place would always pass
        raise TypeError(f"check: {passed!r} is no truth value")
    _failures += not passed
    print(f"ok {name}" if passed else f"FAIL {name}: {why}", flush=True)
    return bool(passed)


def check_below(value, limit, name):
    """value <= limit; a nan fails."""
    return check(value <= limit, name, f"{value:.6g} is not at most {limit:.6g}")


def check_within(value, low, high, name):
    return check(low <= value <= high, name, f"{value:.6g} is not in [{low:.6g}, {high:.6g}]")


def done():
    """The exit code of the test."""
    sys.exit(1 if _failures else 0)


def environment(ranks=1):
    """That of the program's processes: see tests/mpi.py."""
    return mpi.environment(ranks, tempfile.mkdtemp(dir=_scratch.name))


def parts(*names):
    """Those of the script's parts that are to run: all, or with --part NAME one. --parts prints the names; tests/run.py
    makes a job of each."""
    if "--parts" in sys.argv:
        print("\n".join(names))
        sys.exit(0)
    if "--part" not in sys.argv:
        return names
    name = sys.argv[sys.argv.index("--part") + 1]
    if name not in names:
        sys.exit(f"{sys.argv[0]}: no part is called {name}; there are {', '.join(names)}")
    return (name,)


def start(options, ranks=1, timeout=300, cwd=ROOT):
    """Runs the program with a string or list of options in a folder; the finished process with its texts."""
    if isinstance(options, str):
        options = shlex.split(options)
    command = (["mpiexec", "-n", str(ranks)] if ranks > 1 else []) + [PROGRAM] + options
    return subprocess.run(command, cwd=cwd, env=environment(ranks), timeout=timeout, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True,
                          errors="replace")


def run(options, folder, ranks=1, timeout=300, cwd=ROOT):
    """Runs to the end into scratch folder 'folder'; ends the test if that fails. Returns the path of the folder."""
    path = scratch(folder)
    arguments = (shlex.split(options) if isinstance(options, str) else options) + ["-output_dir", path]
    process = start(arguments + ["-progress_interval", "0"], ranks, timeout, cwd)
    if process.returncode:
        check(False, folder, f"the run failed with code {process.returncode}: {process.stderr.strip()[-600:]}")
        done()
    return path


def install(prefix):
    """`make install` of what is built, whatever its flags; the finished process with its text."""
    built = [word for name in ("isph", "output/build/lib/libisph.so") for word in ("-o", name)]
    return subprocess.run(["make", "-s", *built, "install", f"PREFIX={prefix}"], cwd=ROOT, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=60, check=False)


def numbered(folder, kind):
    """Files <kind>_<number>.h5 of a run, in order."""
    names = sorted(n for n in os.listdir(folder) if n.startswith(kind + "_") and n.endswith(".h5"))
    return [os.path.join(folder, n) for n in names]


def fields(path):
    """The fields of a snapshot or checkpoint, sorted by particle id."""
    with h5py.File(path, "r") as file:
        order = np.argsort(file["id"][:], kind="stable")
        return {name: file[name][:][order] for name in file
                if isinstance(file[name], h5py.Dataset) and len(file[name]) == len(order) and name != "counts"}


def unlike(a, b):
    """The names of the fields in which two files differ in a bit."""
    return [k for k in a if k not in b or not np.array_equal(a[k], b[k], equal_nan=a[k].dtype.kind == "f")]


def unlike_lines(whole, rest):
    """(step, column) of lines of a series that are not in the whole one too, but for the clock."""
    lines = {int(line["step"]): line for line in whole}
    return [(int(line["step"]), c) for line in rest for c in whole.dtype.names if c != "wall_time" and (
        int(line["step"]) not in lines or not np.array_equal(line[c], lines[int(line["step"])][c], equal_nan=True))]


def head(path):
    """The attributes of a snapshot or checkpoint."""
    with h5py.File(path, "r") as file:
        return {name: value for name, value in file.attrs.items()}


def series(folder):
    """series.csv as a structured array; the columns that every run has by their names without the unit."""
    table = np.atleast_1d(np.genfromtxt(os.path.join(folder, "series.csv"), delimiter=",", names=True))
    table.dtype.names = [short if (short := name.rpartition("_")[0]) in PLAIN and name not in PLAIN else name
                         for name in table.dtype.names]
    return table


def replace(path, name, text):
    """Puts a generated text between the lines <!-- name --> and <!-- /name --> of a document."""
    with open(path, encoding="utf-8") as file:
        old = file.read()
    new, n = re.subn(f"(<!-- {name} -->\n).*?(<!-- /{name} -->)", lambda m: m[1] + text + "\n" + m[2], old, flags=re.S)
    if n != 1:
        sys.exit(f"{path} must have the lines <!-- {name} --> and <!-- /{name} --> once, not {n} times")
    with open(path, "w", encoding="utf-8") as file:
        file.write(new)


def results(case, name, text=None):
    """The path of the results.md of a case, which has a part of this name; a text is put into that part."""
    path = os.path.join(ROOT, "cases", case, "results.md")
    try:
        with open(path, encoding="utf-8") as file:
            old = file.read()
    except FileNotFoundError:
        old = RESULTS.format(case)
    if f"<!-- {name} -->" not in old:
        with open(path, "w", encoding="utf-8") as file:
            file.write(old + f"\n## {PARTS[name]}\n\n<!-- {name} -->\n<!-- /{name} -->\n")
    if text is not None:
        replace(path, name, "\n" + text.strip("\n") + "\n")
    return path
