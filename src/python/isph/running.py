"""Runs: made with options or found in their folders, their series and snapshots as arrays."""
import collections.abc
import glob
import itertools
import os
import sys
import threading

import numpy as np

from . import launch, tables
from .tables import Error

LONGEST = 120  # letters of a folder's name
LOOK = 0.25  # s between two looks at the progress


def word(value):
    """A value as the word of an option: (1, 2) is 1,2."""
    if isinstance(value, (bool, np.bool_)):
        return str(bool(value)).lower()
    if isinstance(value, (tuple, list, np.ndarray)):
        return ",".join(map(word, value))
    return repr(float(value)) if isinstance(value, (float, np.floating)) else str(value)


def name_of(scene):
    """What a folder is called after a scene: its folder and file."""
    return "_".join(os.path.splitext(os.path.abspath(scene))[0].split(os.sep)[-2:])


def words_of(options):
    return [part for name, value in options.items() for part in ("-" + name, word(value))]


def said(text):
    """An attribute of a file as a word."""
    return text.decode() if isinstance(text, bytes) else str(text)


def table_of(columns):
    """{name: values} as a pandas table; without pandas as it is, with arrays."""
    try:
        import pandas
        return pandas.DataFrame(columns)
    except ImportError:
        return {name: np.array(values) for name, values in columns.items()}


class Snapshot:
    """A snapshot: path, time (s), and the fields of the liquid's particles as attributes: position, velocity [n][3],
    pressure [n], ... in SI units; fields has them, units and meanings say what they are. all: with dummy particles of
    solids."""

    def __init__(self, path, all=False):
        import h5py
        with h5py.File(path, "r") as file:
            self.path, self.time = path, float(np.ravel(file.attrs["time"])[0])
            wanted = slice(None) if all else np.ravel(file["body"]) >= 0
            size = len(file["body"])
            read = {name: file[name] for name in file
                    if isinstance(file[name], h5py.Dataset) and len(file[name]) == size}
            self.fields = {name: field[:][wanted] for name, field in read.items()}
            self.units, self.meanings = ({name: said(field.attrs.get(key, "")) for name, field in read.items()}
                                         for key in ("unit", "meaning"))

    def __getattr__(self, name):
        if name in self.__dict__.get("fields", {}):
            return self.fields[name]
        raise AttributeError(f"this snapshot has no {name}; it has {', '.join(self.__dict__.get('fields', {}))}")


    def xarray(self):
        """The snapshot as a Dataset of xarray, with units; its dimensions are particle and axis."""
        import xarray
        return xarray.Dataset({name: (("particle", "axis")[:field.ndim], field, {
            "units": self.units[name], "long_name": self.meanings[name]}) for name, field in self.fields.items()},
            {"axis": list("xyz")}, {"time": self.time})

    def pyvista(self):
        """The particles as points of pyvista, with all fields."""
        import pyvista
        points = pyvista.PolyData(np.array(self.position, float))
        for name, field in self.fields.items():
            points.point_data[name] = field
        return points


class Snapshots(collections.abc.Sequence):
    """The snapshots of a run in the order of time; each is read when it is asked for."""

    def __init__(self, folder):
        self.paths = sorted(glob.glob(os.path.join(glob.escape(folder), "snapshot_*.h5")))

    def __len__(self):
        return len(self.paths)

    def __getitem__(self, k):
        return [Snapshot(path) for path in self.paths[k]] if isinstance(k, slice) else Snapshot(self.paths[k])


class Run:
    """A run that is done. folder; options, those of the call; scene, its scene.json; series, {name: array} of
    series.csv; units, {name: SI unit}; snapshots; log, the program's messages."""

    def __init__(self, folder, options=None):
        self.folder, self.options = os.fspath(folder), dict(options or {})
        try:
            self.scene, series = tables.read_scene(self.folder), tables.read_series(self.folder)
        except Error as error:
            raise Error(f"{self.folder} has no run: {error}") from error
        self.series = {name: np.array(values) for name, values in series.items()}
        self.units = {row["name"]: row["unit"] for row in self.scene["columns"] if row["name"] in self.series}

    @property
    def snapshots(self):
        return Snapshots(self.folder)

    @property
    def log(self):
        with open(os.path.join(self.folder, "log.txt"), encoding="utf-8") as file:
            return file.read()

    @property
    def table(self):
        """The series as a pandas table."""
        return table_of(self.series)

    def pictures(self, *words):
        """Draws the run (make pictures); words: its flags, as "--color", "speed". The paths of the pictures."""
        launch.call([sys.executable, launch.tool("pictures/pictures.py"), self.folder, *words])
        return sorted(glob.glob(os.path.join(glob.escape(self.folder), "figures", "*.png")))

    def __repr__(self):
        said = " ".join(words_of(self.options))
        return f"<isph run {self.folder}{' ' if said else ''}{said}, to {self.series['time'][-1]:.4g} s>"


class Runs(list):
    """A list of runs that differ in options."""

    def table(self, **quantities):
        """A row for each run: its options, and NAME=function(run) for each quantity."""
        names = {name: None for run in self for name in run.options}
        columns = {name: [run.options.get(name) for run in self] for name in names}
        for name, function in quantities.items():
            columns[name] = [function(run) for run in self]
        return table_of(columns)


class Job:
    """A run that is to be made, which the program has accepted."""

    def __init__(self, scene, output, again, ranks, options):
        self.options, self.words, self.scene = options, words_of(options), os.fspath(scene)
        found = launch.known.__wrapped__(self.scene, *self.words)  # afresh: the file may be another one now
        self.start, self.end = found["time_start"], found["time_end"]
        self.mark = launch.mark_of(found)
        name = "_".join(f"{key}={word(value)}" for key, value in options.items()).replace("/", "_") or "as_it_is"
        if len(name) > LONGEST:
            name = name[:LONGEST] + "_" + self.mark[:8]
        self.folder = os.fspath(output or os.path.join("output", "python", name_of(scene), name))
        self.ranks = ["-ranks", str(ranks)] if ranks > 1 else []
        before = launch.made(self.folder)
        self.ours, self.done = bool(before), before.get("mark") == self.mark and not again

    def go(self):
        """The run; what is there of an earlier call is taken."""
        if not self.done:
            words = launch.command(self.scene, self.words)
            if self.ours:
                launch.make_mark(self.folder, "", words)  # it may be stopped half way
            cpu = launch.call([*words, *self.ranks, "-output_dir", self.folder,
                               *(["-output_overwrite"] if self.ours else [])])
            launch.make_mark(self.folder, self.mark, words, cpu)
            self.done = True
        return Run(self.folder, self.options)

    def share(self):
        """How much of it is done, from the last line of its series."""
        if self.done or not self.end:
            return float(self.done)
        try:
            return min(max((tables.last_time(self.folder) - self.start) / (self.end - self.start), 0.0), 1.0)
        except (OSError, ValueError, IndexError, ZeroDivisionError):
            return 0.0


def watch(jobs, stop):
    """A bar on standard error, until all is done."""
    while not stop.wait(LOOK):
        share, done = sum(job.share() for job in jobs) / len(jobs), sum(job.done for job in jobs)
        print(f"\r{'#' * round(30 * share):30s} {100 * share:3.0f} %  {done} of {len(jobs)} runs", end="",
              file=sys.stderr, flush=True)
    print(f"\r{'':60s}\r", end="", file=sys.stderr, flush=True)


def run(scene, output=None, again=False, ranks=1, progress=None, **options):
    """Runs a scene, an options file, with further options, on so many ranks, and waits for it. output: its folder;
    default: output/python/SCENE/OPTIONS. progress: a bar; default: in a terminal or notebook. Returns a Run; raises
    Error with the program's sentence."""
    return together([Job(scene, output, again, ranks, options)], 1, progress)[0]


def runs(scene, again=False, ranks=1, jobs=1, progress=None, **options):
    """Runs of all combinations of the options that are lists, 'jobs' at a time; a vector is a tuple. All are checked
    before the first starts. Returns Runs, in the order of itertools.product."""
    lists = [value if isinstance(value, (list, range, np.ndarray)) else [value] for value in options.values()]
    return together([Job(scene, None, again, ranks, dict(zip(options, values)))
                     for values in itertools.product(*lists)], jobs, progress)


def together(all_jobs, jobs, progress):
    stop, shown = threading.Event(), sys.stderr.isatty() or "ipykernel" in sys.modules if progress is None else progress
    bar = threading.Thread(target=watch, args=(all_jobs, stop), daemon=True)
    if shown and not all(job.done for job in all_jobs):
        bar.start()
    try:
        return Runs(launch.beside(Job.go, all_jobs, jobs))
    finally:
        stop.set()
        if bar.is_alive():
            bar.join()


def open_run(folder):
    """A run that is there already."""
    return Run(folder)
