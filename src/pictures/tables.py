"""Tables and options of a run, without other libraries. SI units; a missing or unreadable number is NaN."""
import contextlib
import csv
import math
import os
import sys

PACKAGES = "python3-h5py python3-matplotlib python3-vtk9 libjs-three xvfb xauth"

# Units, in three dimensions, of the columns of series.csv without a unit in their name; other names end with it.
UNITS = {"time": "s", "time_step": "s", "crown_height": "m", "crater_depth": "m", "crater_diameter": "m",
         "kinetic_energy": "J", "potential_energy": "J", "surface_energy": "J", "viscous_work": "J",
         "tension_work": "J", "outside_work": "J", "jet_height": "m", "highest": "m", "volume": "m3", "wall_time": "s"}


class RunError(Exception):
    """An error that the user can correct; its text is the whole message."""


@contextlib.contextmanager
def polite(program):
    """Around imports and main: a RunError or a missing library ends the program with one sentence."""
    try:
        yield
    except ImportError as error:
        sys.exit(f"{program}: {sys.executable} has no {error.name}; on Debian: apt-get install {PACKAGES}, then use "
                 "/usr/bin/python3.")
    except RunError as error:
        sys.exit(f"{program}: {error}")


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return math.nan


def plain(name):
    """The name of a column, without the unit if UNITS has it: time_s is time."""
    base = name.rpartition("_")[0]
    return base if name not in UNITS and base in UNITS else name


def read_table(path):
    """The columns of a file of comma-separated values: {plain name: [numbers]}. Lines that start with # are
    comments."""
    try:
        with open(path, newline="") as stream:
            rows = list(csv.reader(line for line in stream if line.strip() and not line.startswith("#")))
    except OSError as error:
        raise RunError(f"{path}: {error.strerror}.") from error
    if len(rows) < 2:
        raise RunError(f"{path} has no data yet.")
    names = [plain(name.strip()) for name in rows[0]]
    if "time" not in names:
        raise RunError(f"{path} has no column 'time'.")
    rows = [row for row in rows[1:] if len(row) == len(names)]  # a run that still writes may leave half a line
    return {name: [number(row[i]) for row in rows] for i, name in enumerate(names)}


def read_series(folder):
    """The time series of a run."""
    if not os.path.isdir(folder):
        raise RunError(f"{folder} is not a folder.")
    return read_table(os.path.join(folder, "series.csv"))


def read_options(folder):
    """The options of a run, {name without the dash: value}, from its options.opts; empty if there is none."""
    options = {}
    try:
        with open(os.path.join(folder, "options.opts")) as stream:
            for line in stream:
                words = line.split("#")[0].split(None, 1)
                if words and words[0].startswith("-"):
                    options[words[0].lstrip("-")] = words[1].strip() if len(words) > 1 else ""
    except OSError:
        pass
    return options


def vector(options, name):
    """An option of comma-separated numbers as a list; empty if it is not set."""
    return [number(word) for word in options[name].split(",")] if name in options else []
