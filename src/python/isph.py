"""isph from Python: runs with options, their series and snapshots as arrays, answers with error bars, studies.

    import isph
    one = isph.run("ink.opts", wall_contact_angle=40, ink_velocity=(0, -6))   # waits; one.folder, one.log, one.scene
    one.series["highest"].max(), one.units["highest"]                         # arrays of series.csv, their SI units
    last = one.snapshots[-1]; last.time, last.position, last.velocity         # arrays of the liquid's particles
    many = isph.runs("ink.opts", wall_contact_angle=[20, 40, 60], jobs=2)     # every combination of the lists
    many.table(height=lambda run: run.series["highest"][-1])                  # a pandas table, where pandas is
    isph.answer("ink.opts", "highest:max", accuracy=5)                        # a value with its error bar
    isph.study("ink.opts", "highest:max", drop_velocity=[(0, -1), (0, -2)])   # a table
    isph.open_run("output/my")                                                # a run that is there already
    with isph.Simulation("ink.opts") as now:                                  # a run that Python steps (libisph)
        now.step(); now.time, now.position, now.column("highest")

An option of the program is a keyword: -name 1,2 is name=(1, 2), and a list is what to vary. A run that was made before,
of the same scene and files with the same options by the same program, is not repeated (again=True repeats it). What
the program refuses is raised as isph.Error with its sentence, before anything is computed. Needs numpy, and h5py for
snapshots; pandas is used where it is installed. The program is that of this tree, of PATH, or $ISPH."""
import collections.abc
import concurrent.futures
import csv
import ctypes
import functools
import glob
import hashlib
import itertools
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import typing

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
MARK = "python.json"  # in the folder of a run: what was run
LONGEST = 120  # letters of a folder's name
LOOK = 0.25  # s between two looks at the progress


class Error(RuntimeError):
    """What the program said when it refused a scene or stopped."""


def program():
    """The path of the program."""
    tree = os.path.join(HERE, "..", "..", "isph")
    found = os.environ.get("ISPH") or (tree if os.path.isfile(tree) else shutil.which("isph"))
    if not found:
        raise Error("there is no isph in this tree or in PATH; build it with make, or name it in ISPH.")
    return os.path.abspath(found)


def tool(name):
    """The path of a tool beside the program, as answers/answer.py: in the tree, or where make install puts it."""
    home = os.path.dirname(os.path.realpath(program()))
    places = [os.path.join(HERE, "..", name), os.path.join(home, "src", name),
              os.path.join(home, "..", "share", "isph", name)]
    found = next((place for place in places if os.path.isfile(place)), None)
    if not found:
        raise Error(f"{name} is neither beside isph.py nor beside {program()}.")
    return found


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


def call(words):
    """Runs the program or a tool to its end; its sentence is raised if it fails. Ctrl-C ends a run with a checkpoint,
    and is raised then."""
    process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               text=True, errors="replace", start_new_session=True,
                               env=dict(os.environ, OMP_NUM_THREADS="1"))
    try:
        _, said = process.communicate()
    except KeyboardInterrupt:
        process.terminate()
        process.communicate()
        raise
    if process.returncode:
        lines = [line for line in said.splitlines() if line.strip()] or [f"exit code {process.returncode}"]
        line = next((line for line in lines if "error: " in line), lines[-1])
        raise Error(re.sub(r"^(isph: error|\w+\.py): ", "", line))


def known(scene, words=()):
    """What the program knows about a scene with options: scene.json (options/scene_json.md)."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "scene.json")
        call([program(), "-options_file", os.fspath(scene), *words, "-scene_json", path])
        with open(path, encoding="utf-8") as file:
            found = json.load(file)
    found["options"] = [option for option in found["options"] if option["name"] != "-scene_json"]
    return found


def mark_of(found):
    """What tells runs apart: all that the program knows about the scene, the files that it reads, the program."""
    mark = hashlib.sha256(json.dumps(found, sort_keys=True).encode())
    for path in [program()] + [option["value"] for option in found["options"] if option["kind"] == "file"]:
        if os.path.isfile(path):
            with open(path, "rb") as file:
                mark.update(hashlib.sha256(file.read()).digest())
    return mark.hexdigest()


def table_of(columns):
    """{name: values} as a pandas table; without pandas as it is, with arrays."""
    try:
        import pandas
        return pandas.DataFrame(columns)
    except ImportError:
        return {name: np.array(values) for name, values in columns.items()}


class Snapshot:
    """A snapshot: path, time (s), and the fields of the liquid's particles as attributes: position, velocity [n][3],
    pressure [n], ... in SI units; fields lists them. all: with dummy particles of solids."""

    def __init__(self, path, all=False):
        import h5py
        with h5py.File(path, "r") as file:
            self.path, self.time = path, float(np.ravel(file.attrs["time"])[0])
            wanted = slice(None) if all else np.ravel(file["body"]) >= 0
            size = len(file["body"])
            self.fields = {name: file[name][:][wanted] for name in file
                           if isinstance(file[name], h5py.Dataset) and len(file[name]) == size}

    def __getattr__(self, name):
        if name in self.__dict__.get("fields", {}):
            return self.fields[name]
        raise AttributeError(f"this snapshot has no {name}; it has {', '.join(self.__dict__.get('fields', {}))}")


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
            with open(os.path.join(self.folder, "scene.json"), encoding="utf-8") as file:
                self.scene = json.load(file)
            with open(os.path.join(self.folder, "series.csv"), encoding="utf-8") as file:
                heads = file.readline().strip().split(",")
                values = np.loadtxt(file, delimiter=",", ndmin=2).reshape(-1, len(heads))
        except OSError as error:
            raise Error(f"{self.folder} has no run: {error.filename}: {error.strerror}") from error
        rows = {row["head"]: row for row in self.scene["columns"] if row["file"] == "series.csv"}
        self.series = {rows[head]["name"]: values[:, k] for k, head in enumerate(heads)}
        self.units = {rows[head]["name"]: rows[head]["unit"] for head in heads}

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
        call([sys.executable, tool("pictures/pictures.py"), self.folder, *words])
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
        found = known(self.scene, self.words)
        self.start, self.end = found["time_start"], found["time_end"]
        self.mark = mark_of(found)
        name = "_".join(f"{key}={word(value)}" for key, value in options.items()).replace("/", "_") or "as_it_is"
        if len(name) > LONGEST:
            name = name[:LONGEST] + "_" + self.mark[:8]
        self.folder = os.fspath(output or os.path.join("output", "python", name_of(self.scene), name))
        self.ranks = ["-ranks", str(ranks)] if ranks > 1 else []
        before = self.written()
        self.ours, self.done = before is not None, before == self.mark and not again

    def written(self):
        """The mark in the folder; None: no run of ours."""
        try:
            with open(os.path.join(self.folder, MARK), encoding="utf-8") as file:
                return json.load(file)["mark"]
        except (OSError, ValueError, KeyError):
            return None

    def write(self, mark):
        os.makedirs(self.folder, exist_ok=True)
        with open(os.path.join(self.folder, MARK), "w", encoding="utf-8") as file:
            json.dump({"mark": mark, "command": [program(), "-options_file", self.scene, *self.words]}, file)

    def go(self):
        """The run; what is there of an earlier call is taken."""
        if not self.done:
            if self.ours:
                self.write("")  # it may be stopped half way
            call([program(), *self.ranks, "-options_file", self.scene, *self.words, "-output_dir", self.folder,
                  *(["-output_overwrite"] if self.ours else [])])
            self.write(self.mark)
            self.done = True
        return Run(self.folder, self.options)

    def share(self):
        """How much of it is done, from the last line of its series."""
        if self.done or not self.end:
            return float(self.done)
        try:
            with open(os.path.join(self.folder, "series.csv"), "rb") as file:
                head = file.readline().decode().split(",")
                file.seek(max(file.tell(), os.fstat(file.fileno()).st_size - 4096))
                last = file.read().decode(errors="replace").rpartition("\n")[0].rpartition("\n")[2].split(",")
            now = float(last[next(k for k, name in enumerate(head) if name.startswith("time_s"))])
            return min(max((now - self.start) / (self.end - self.start), 0.0), 1.0)
        except (OSError, ValueError, IndexError, StopIteration, ZeroDivisionError):
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
        if jobs == 1:  # in this thread, which Ctrl-C interrupts
            return Runs(job.go() for job in all_jobs)
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            return Runs(pool.map(Job.go, all_jobs))
    finally:
        stop.set()
        if bar.is_alive():
            bar.join()


def open_run(folder):
    """A run that is there already."""
    return Run(folder)


class Value(typing.NamedTuple):
    """A quantity with its error bar, and what the bar comes from."""
    quantity: str
    value: float
    bar: float
    unit: str
    by_spacing: float
    by_packing: float

    def __str__(self):
        return f"{self.quantity} = {self.value:.5g} +- {self.bar:.2g} {self.unit}".rstrip()


def read_table(path):
    """The columns of a CSV file; numbers where all are."""
    with open(path, newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    columns = {}
    for name, texts in zip(head, zip(*rows)):
        try:
            texts = [float(text) for text in texts]
        except ValueError:
            pass
        columns[f"{list(columns)[-1]} {name}" if name == "+-" else name] = list(texts)
    return columns


def ask(name, scene, quantity, output, words):
    """Calls answer.py or study.py; the folder."""
    output = os.fspath(output or os.path.join("output", "python", name_of(scene), name))
    call([sys.executable, tool(f"answers/{name}.py"), os.fspath(scene), "--quantity", quantity, "--output", output,
          *words])
    return output


def answer(scene, quantity, accuracy=5, budget=600, jobs=1, output=None):
    """A quantity (COLUMN:TAKE, as "highest:max"; several separated by commas) with its error by spacing and packing, to
    so many per cent, for at most so many processor seconds (make answer; tests/answers/README.md). A Value, or a list
    of them."""
    folder = ask("answer", scene, quantity, output,
                 ["--accuracy", str(accuracy), "--budget", str(budget), "--jobs", str(jobs)])
    columns = read_table(os.path.join(folder, "answer.csv"))
    found = [Value(*row) for row in zip(*(columns[name] for name in Value._fields))]
    return found if len(found) > 1 else found[0]


def study(scene, quantity, accuracy=0, budget=600, jobs=1, output=None, **options):
    """A table of quantities for all values of one or two options, which are lists (make study): a pandas table where
    pandas is installed, else {head: values}. accuracy: with error bars."""
    varied = " ".join(f"{name}=" + ";".join(map(word, values)) for name, values in options.items())
    folder = ask("study", scene, quantity, output,
                 ["--vary", varied, "--accuracy", str(accuracy), "--budget", str(budget), "--jobs", str(jobs)])
    return table_of(read_table(os.path.join(folder, "_".join(options), "study.csv")))


class Array(ctypes.Structure):
    """IsphArray of isph.h."""
    _fields_ = [("data", ctypes.c_void_p), ("count", ctypes.c_long), ("components", ctypes.c_int),
                ("bytes", ctypes.c_int), ("integer", ctypes.c_int), ("unit", ctypes.c_char_p)]


CALLBACK = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)
RESULTS = {"IsphTime": ctypes.c_double, "IsphTimeStep": ctypes.c_double, "IsphSteps": ctypes.c_long,
           "IsphError": ctypes.c_char_p, "IsphFieldName": ctypes.c_char_p, "IsphColumnName": ctypes.c_char_p}


@functools.lru_cache(maxsize=None)
def library():
    """libisph of this tree, of the installed program, or $ISPH_LIBRARY."""
    tree = os.path.join(HERE, "..", "..", "output", "build", "lib", "libisph.so")
    places = [os.environ.get("ISPH_LIBRARY", ""), tree,
              os.path.join(os.path.dirname(os.path.realpath(program())), "..", "lib", "isph", "libisph.so")]
    found = next((place for place in places if os.path.isfile(place)), None)
    if not found:
        raise Error("there is no libisph.so; make builds it, ISPH_LIBRARY names another one.")
    loaded = ctypes.CDLL(os.path.abspath(found))
    for name, kind in RESULTS.items():
        getattr(loaded, name).restype = kind
    return loaded


class Simulation:
    """A run in this process, which Python steps; its fields are arrays of the program's own memory, not copies, until
    the next step. A process has one at a time; on several processes all call the same (mpiexec -n 2 python3 ...).

        with isph.Simulation("tank.opts", spacing=0.02) as now:
            now.run(0.5, lambda now: print(now.time, now.column("highest")))

    comm: a communicator of mpi4py; default: all processes. Options as in run(); without output_dir no file is written.
    time, time_step (s), steps, ended; fields: the names of the fields, which are attributes: position, velocity [n][3],
    pressure [n], body, layer (0: liquid), ...; columns: the names of the columns of the series."""

    def __init__(self, scene=None, comm=None, **options):
        words = ([os.fspath(scene)] if scene else []) + words_of(options)
        text = " ".join(f'"{part}"' if re.search(r"\s", part) or not part else part for part in words)
        self._run, self._after, self._raised = ctypes.c_void_p(), None, None
        self._call("IsphCreate", text.encode(), ctypes.c_int(comm.py2f() if comm else -1), ctypes.byref(self._run))
        self._call("IsphSetUp", self._run)
        self.fields, self.columns = self._names("IsphFieldName"), self._names("IsphColumnName")

    def _call(self, name, *words):
        """Calls a function of isph.h; its sentence is raised."""
        if getattr(library(), name)(*words):
            raised, self._raised = self._raised, None
            raise raised or Error(library().IsphError().decode() or f"{name} failed")

    def _names(self, name):
        every = (getattr(library(), name)(self._run, k) for k in itertools.count())
        return [text.decode() for text in itertools.takewhile(bool, every)]

    def step(self, end=math.inf):
        """One step, at most to the time 'end' (s)."""
        self._call("IsphStep", self._run, ctypes.c_double(end))

    def run(self, end=math.inf, after=None):
        """Steps to the time 'end' (s) or that of the scene; after(self) is called after each step. What it raises ends
        the run."""
        def called(_context, _run):
            try:
                after(self)
                return 0
            except BaseException as error:  # pylint: disable=broad-except
                self._raised = error
                return 1
        self._after = CALLBACK(called) if after else CALLBACK()  # kept while it may be called
        self._call("IsphSetCallback", self._run, self._after, None)
        self._call("IsphRun", self._run, ctypes.c_double(end))

    def field(self, name):
        """The numbers of a field, [n] or [n][components], read only; they last until the next step: copy what is to
        be kept."""
        array = Array()
        self._call("IsphField", self._run, name.encode(), ctypes.byref(array))
        kind = np.dtype(f"{'i' if array.integer else 'f'}{array.bytes}")
        size = array.count * array.components * array.bytes
        memory = (ctypes.c_char * size).from_address(array.data) if size else b""
        values = np.frombuffer(memory, kind).reshape(array.count, array.components)
        values.flags.writeable = False
        return values[:, 0] if array.components == 1 else values

    def set(self, name, values):
        """Gives the liquid other positions (m) or velocities (m/s), [n][3] in the order of the field, before the next
        step; 'now.velocity = values' is the same. Rows of walls are not read. Arrays of fields end."""
        values = np.ascontiguousarray(values, float)
        if values.shape != self.position.shape:
            raise Error(f"{name} has the shape {self.position.shape}, not {values.shape}")
        self._call("IsphSetField", self._run, name.encode(), values.ctypes.data_as(ctypes.c_void_p))

    def __setattr__(self, name, value):
        if name in self.__dict__.get("fields", ()):
            self.set(name, value)
        else:
            super().__setattr__(name, value)

    def unit(self, name):
        """The unit of a field."""
        array = Array()
        self._call("IsphField", self._run, name.encode(), ctypes.byref(array))
        return array.unit.decode()

    def __getattr__(self, name):
        if name in self.__dict__.get("fields", ()):
            return self.field(name)
        raise AttributeError(f"this run has no {name}; it has {', '.join(self.__dict__.get('fields', ()))}")

    def column(self, name):
        """A column of the series now, by its name with or without the unit; nan: it has no value now."""
        value = ctypes.c_double()
        self._call("IsphColumn", self._run, name.encode(), ctypes.byref(value))
        return value.value

    time = property(lambda self: library().IsphTime(self._run))
    time_step = property(lambda self: library().IsphTimeStep(self._run))
    steps = property(lambda self: library().IsphSteps(self._run))
    ended = property(lambda self: bool(library().IsphEnded(self._run)))

    @property
    def scene(self):
        """scene.json, on process 0."""
        text = ctypes.c_char_p()
        self._call("IsphScene", self._run, ctypes.byref(text))
        return json.loads(text.value or "null")

    def checkpoint(self):
        """Writes a checkpoint into output_dir."""
        self._call("IsphCheckpoint", self._run)

    def close(self):
        """Ends the run; there can be another one then."""
        if self._run:
            self._call("IsphDestroy", ctypes.byref(self._run))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
