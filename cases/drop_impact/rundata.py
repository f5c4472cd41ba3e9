"""What figures.py and compare.py share: a run's series, its options and the reference curves. Needs nothing but Python.

All values in SI units. A missing or unreadable number is NaN.
"""
import csv
import math
import os

HERE = os.path.dirname(os.path.abspath(__file__))
REFERENCE_SPEED = 3.13  # m/s, of reference.csv and reference_box.csv
GRAVITY = 9.81  # m/s2


class RunError(Exception):
    """Something the user can put right; its text is the whole message."""


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return math.nan


def read_table(path):
    """The columns of a file of comma-separated values: {name: [numbers]}. Lines that start with # are comments."""
    try:
        with open(path, newline="") as stream:
            rows = list(csv.reader(line for line in stream if line.strip() and not line.startswith("#")))
    except OSError as error:
        raise RunError(f"{path}: {error.strerror}.") from error
    if len(rows) < 2:
        raise RunError(f"{path} holds no data yet.")
    names = [name.strip() for name in rows[0]]
    if "time" not in names:
        raise RunError(f"{path} has no column 'time'.")
    rows = [row for row in rows[1:] if len(row) == len(names)]  # a run that still writes may leave half a line
    return {name: [number(row[i]) for row in rows] for i, name in enumerate(names)}


def read_series(folder):
    """The time series of a run."""
    if not os.path.isdir(folder):
        raise RunError(f"{folder} is not a folder.")
    return read_table(os.path.join(folder, "series.csv"))


def read_reference(box=False):
    """The reference curves; box: those of a pool as small as the paper's."""
    return read_table(os.path.join(HERE, "reference_box.csv" if box else "reference.csv"))


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


def impact_speed(options):
    """Speed (m/s) at which the drop of a run reaches the level z = 0; NaN if the options do not tell."""
    velocity, center = vector(options, "drop_velocity"), vector(options, "drop_center")
    radius = number(options.get("drop_radius"))
    if len(velocity) < 3 or len(center) < 3 or math.isnan(radius):
        return math.nan
    return math.sqrt(velocity[2] ** 2 + 2 * GRAVITY * max(0.0, center[2] - radius))


def reference_applies(folder):
    """Whether the reference is of the run's case, as far as its options tell."""
    speed = impact_speed(read_options(folder))
    return math.isnan(speed) or abs(speed - REFERENCE_SPEED) < 0.01 * REFERENCE_SPEED
