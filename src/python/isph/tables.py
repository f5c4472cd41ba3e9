"""Tables and scene of a run, without other libraries. SI units; a missing or unreadable number is NaN."""
import contextlib
import csv
import json
import math
import os
import sys

LAST = 4096  # bytes that hold the last line of a series
PACKAGES = "python3-h5py python3-matplotlib python3-vtk9 libjs-three xvfb"


class Error(RuntimeError):
    """What the user can correct, or what the program said when it refused a scene or stopped; the text is the whole
    message."""


@contextlib.contextmanager
def polite(program):
    """Around imports and main: a Error, a path that cannot be used or a missing library ends the program with one
    sentence."""
    try:
        yield
    except ImportError as error:
        sys.exit(f"{program}: {sys.executable} has no {error.name}; on Debian: apt-get install {PACKAGES}, then use "
                 "/usr/bin/python3.")
    except Error as error:
        sys.exit(f"{program}: {error}")
    except OSError as error:
        if not error.filename:
            raise
        sys.exit(f"{program}: {error.filename}: {error.strerror}.")


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return math.nan


class Table(dict):
    """The columns of a file, {name: [numbers]}. A name may leave out the last word of a head, its unit: time is
    time_s."""

    def find(self, name):
        """The key that is meant; None: there is none, or several."""
        if dict.__contains__(self, name):
            return name
        longer = [key for key in self if key.rpartition("_")[0] == name]
        return longer[0] if len(longer) == 1 else None

    def __contains__(self, name):
        return self.find(name) is not None

    def __missing__(self, name):
        key = self.find(name)
        if key is None:
            raise KeyError(name)
        return self[key]

    def get(self, name, default=None):
        return self[name] if name in self else default


def read_table(path, names=()):
    """The columns of a file of comma-separated values. Lines that start with # are comments. names: {head: name}, by
    which columns are called."""
    try:
        with open(path, newline="") as stream:
            rows = list(csv.reader(line for line in stream if line.strip() and not line.startswith("#")))
    except OSError as error:
        raise Error(f"{path}: {error.strerror}.") from error
    if len(rows) < 2:
        raise Error(f"{path} has no data yet.")
    heads = [dict(names).get(name.strip(), name.strip()) for name in rows[0]]
    rows = [row for row in rows[1:] if len(row) == len(heads)]  # a run that still writes may leave half a line
    table = Table({name: [number(row[i]) for row in rows] for i, name in enumerate(heads)})
    if "time" not in table:
        raise Error(f"{path} has no column 'time'.")
    return table


def read_series(folder):
    """The time series of a run, by the names of its columns without their units."""
    if not os.path.isdir(folder):
        raise Error(f"{folder} is not a folder.")
    names = {row["head"]: row["name"] for row in rows_of(folder).values()}
    return read_table(os.path.join(folder, "series.csv"), names)


def clock(series, row):
    """The times (s) at which the values of a column hold: of pressures and forces those of pressure_time."""
    held = series["pressure_time"] if "pressure" in row.get("needs", ()) and "pressure_time" in series else ()
    return [then if math.isfinite(then) else time for time, then in zip(series["time"], held)] or series["time"]


def last_time(folder):
    """The time (s) of the last whole line of a run's series, which may still be written."""
    with open(os.path.join(folder, "series.csv"), "rb") as file:
        heads = file.readline().decode().split(",")
        file.seek(max(file.tell(), os.fstat(file.fileno()).st_size - LAST))
        last = file.read().decode(errors="replace").rpartition("\n")[0].rpartition("\n")[2].split(",")
    return float(last[[head.rpartition("_")[0] for head in heads].index("time")])


def rows_of(folder):
    """The rows of the columns of a run's series (options/scene_json.md), {name: row}."""
    return {row["name"]: row for row in read_scene(folder)["columns"] if row["file"] == "series.csv"}


def read_scene(folder):
    """What the program knows about the scene of a run: scene.json (options/scene_json.md)."""
    path = os.path.join(folder, "scene.json")
    try:
        with open(path, encoding="utf-8") as stream:
            return json.load(stream)
    except OSError as error:
        raise Error(f"{path}: {error.strerror}; this version of isph writes it.") from error
    except ValueError as error:
        raise Error(f"{path} is no scene.json: {error}.") from error
