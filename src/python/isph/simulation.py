"""A run in the process of Python, by libisph (isph.h)."""
import atexit
import contextlib
import ctypes
import functools
import itertools
import json
import math
import os
import re
import signal
import threading
import weakref

import numpy as np

from . import launch
from .running import words_of
from .tables import Error


class Array(ctypes.Structure):
    """IsphArray of isph.h."""
    _fields_ = [("data", ctypes.c_void_p), ("count", ctypes.c_long), ("components", ctypes.c_int),
                ("bytes", ctypes.c_int), ("integer", ctypes.c_int), ("unit", ctypes.c_char_p)]


CALLBACK = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)
RESULTS = {"IsphTime": ctypes.c_double, "IsphTimeStep": ctypes.c_double, "IsphSteps": ctypes.c_long,
           "IsphError": ctypes.c_char_p, "IsphFieldName": ctypes.c_char_p, "IsphColumnName": ctypes.c_char_p}


OPEN = [lambda: None]  # the last run of this process, a weak reference


@atexit.register
def close_last():
    """Before mpi4py ends MPI."""
    last = OPEN[0]()
    if last is not None:
        last.__del__()


@functools.lru_cache(maxsize=None)
def library():
    """libisph of this tree, of the installed program, or $ISPH_LIBRARY."""
    tree = os.path.join(launch.HERE, "..", "..", "..", "output", "build", "lib", "libisph.so")
    places = [os.environ.get("ISPH_LIBRARY", ""), tree, os.path.join(launch.HERE, "libisph.so"),
              os.path.join(os.path.dirname(os.path.realpath(launch.program())), "..", "lib", "isph", "libisph.so")]
    found = next((place for place in places if os.path.isfile(place)), None)
    if not found:
        raise Error("there is no libisph.so; make builds it, ISPH_LIBRARY names another one.")
    loaded = ctypes.CDLL(os.path.abspath(found))
    for name, kind in RESULTS.items():
        getattr(loaded, name).restype = kind
    return loaded


@contextlib.contextmanager
def held(stops):
    """Ctrl-C waits for the end of a step: it is listed in 'stops', and raised at the end."""
    if threading.current_thread() is not threading.main_thread():  # signals are the main thread's
        yield
        return
    before = signal.signal(signal.SIGINT, lambda *_: stops.append(signal.SIGINT))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before or signal.SIG_DFL)
    if stops:
        raise KeyboardInterrupt


class Field(np.lib.mixins.NDArrayOperatorsMixin):
    """A field of a run: as an array, of the program's own memory and read only, until the run has another state; then
    it raises. What is computed from it is an array; np.array(field) and field.copy() keep it."""

    def __init__(self, run, name, values):
        self._run, self._name, self._state, self._values = weakref.ref(run), name, run.state, values

    def _now(self):
        if getattr(self._run(), "state", None) != self._state:
            raise Error(f"this {self._name} is of an earlier state of the run: take it anew after each step, or keep a "
                        f"copy, {self._name}.copy()")
        return self._values

    def _kept(self, found):
        """A result; what shares the program's memory is a Field, too."""
        if isinstance(found, tuple):
            return tuple(map(self._kept, found))
        shared = isinstance(found, np.ndarray) and np.may_share_memory(found, self._values)
        return Field(self._run(), self._name, found) if shared else found

    def __array__(self, dtype=None):
        return np.array(self._now(), dtype)

    def __array_ufunc__(self, ufunc, method, *inputs, **more):
        return getattr(ufunc, method)(*map(plain, inputs), **{name: plain(value) for name, value in more.items()})

    def __array_function__(self, function, _types, args, more):
        return self._kept(function(*plain(args), **{name: plain(value) for name, value in more.items()}))

    def __getitem__(self, key):
        return self._kept(self._now()[plain(key)])

    def __setitem__(self, key, value):
        raise Error(f"{self._name} cannot be changed in place; velocity and position can be set as a whole, "
                    "now.velocity = values")

    def __len__(self):
        return len(self._now())

    def __iter__(self):
        return map(self._kept, self._now())

    def __float__(self):
        return float(self._now())

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        found = getattr(self._now(), name)
        return (lambda *args, **more: self._kept(found(*plain(args), **more))) if callable(found) else self._kept(found)

    def __repr__(self):
        return f"<{self._name}, {self._now()!r}>"


def plain(value):
    """A value without Fields, which have their arrays instead; for a function that keeps none."""
    if isinstance(value, (tuple, list)):
        return type(value)(map(plain, value))
    return value._now() if isinstance(value, Field) else value  # pylint: disable=protected-access


class Simulation:
    """A run in this process, which Python steps; its fields are arrays of the program's own memory, not copies, until
    the next step, after which they raise. A process has one at a time, until close(), the end of 'with', or del; on
    several processes all call the same (mpiexec -n 2 python3 ...).

        with isph.Simulation("tank.opts", spacing=0.02) as now:
            now.run(0.5, lambda now: print(now.time, now.column("highest")))

    comm: a communicator of mpi4py; default: all processes. Options as in run(); without output_dir no file is written.
    time, time_step (s), steps, ended; fields: the names of the fields, which are attributes: position, velocity [n][3],
    pressure [n], body, layer (0: liquid), ...; columns: the names of the columns of the series."""

    def __init__(self, scene=None, comm=None, **options):
        words = ([os.fspath(scene)] if scene else []) + words_of(options)
        text = " ".join(f'"{part}"' if re.search(r"\s", part) or not part else part for part in words)
        self.state, self._run, self._after, self._raised = 0, ctypes.c_void_p(), None, None
        other = OPEN[0]()
        if other is not None and other._run:
            raise Error(f"this process has an open run, of {other.what} at {other.time:g} s; its close() ends it")
        self.what = os.fspath(scene) if scene else "options"
        try:
            self._call("IsphCreate", text.encode(), ctypes.c_int(comm.py2f() if comm else -1), ctypes.byref(self._run))
            OPEN[0] = weakref.ref(self)
            self._call("IsphSetUp", self._run)
            self.columns, self.fields = self._names("IsphColumnName"), self._names("IsphFieldName")
        except BaseException:
            self.__del__()  # else this process could have no other run
            raise

    def __del__(self):
        if self.__dict__.get("_run"):
            library().IsphDestroy(ctypes.byref(self._run))

    def _call(self, name, *words):
        """Calls a function of isph.h; its sentence is raised."""
        if not self._run and name != "IsphCreate":
            raise Error("this run is closed")
        if getattr(library(), name)(*words):
            raised, self._raised = self._raised, None
            raise raised or Error(library().IsphError().decode() or f"{name} failed")

    def _change(self, name, *words):
        """Calls a function that gives the run another state: fields of the one before end."""
        self.state += 1
        self._call(name, *words)

    def _names(self, name):
        every = (getattr(library(), name)(self._run, k) for k in itertools.count())
        return [text.decode() for text in itertools.takewhile(bool, every)]

    def step(self, end=math.inf):
        """One step, at most to the time 'end' (s)."""
        self._change("IsphStep", self._run, ctypes.c_double(end))

    def run(self, end=math.inf, after=None):
        """Steps to the time 'end' (s) or that of the scene; after(self) is called after each step. What it raises ends
        the call, as Ctrl-C does; the run can go on."""
        stops = []

        def called(_context, _run):
            try:
                self.state += 1
                if stops:
                    raise KeyboardInterrupt
                if after:
                    after(self)
                return 0
            except BaseException as error:  # pylint: disable=broad-except
                self._raised = error
                return 1
        with held(stops):
            try:
                self._after = CALLBACK(called)  # kept while it may be called
                self._call("IsphSetCallback", self._run, self._after, None)
                self._change("IsphRun", self._run, ctypes.c_double(end))
            finally:
                library().IsphSetCallback(self._run, None, None)
                self._after = None

    def field(self, name):
        """The numbers of a field, [n] or [n][components], a Field."""
        array = Array()
        self._call("IsphField", self._run, name.encode(), ctypes.byref(array))
        kind = np.dtype(f"{'i' if array.integer else 'f'}{array.bytes}")
        size = array.count * array.components * array.bytes
        memory = (ctypes.c_char * size).from_address(array.data) if size else b""
        values = np.frombuffer(memory, kind).reshape(array.count, array.components)
        values.flags.writeable = False
        return Field(self, name, values[:, 0] if array.components == 1 else values)

    def set(self, name, values):
        """Gives the liquid other positions (m) or velocities (m/s), [n][3] in the order of the field, before the next
        step; 'now.velocity = values' is the same. Rows of walls are not read. Arrays of fields end."""
        values = np.ascontiguousarray(values, float)
        if name in ("position", "velocity") and values.shape != self.position.shape:
            raise Error(f"{name} has the shape {self.position.shape}, not {values.shape}")
        self._change("IsphSetField", self._run, name.encode(), values.ctypes.data_as(ctypes.c_void_p))

    def __setattr__(self, name, value):
        known = self.__dict__.get("fields", ())
        if name in known:
            self.set(name, value)
        elif known and not name.startswith("_") and name not in self.__dict__:
            raise AttributeError(f"this run has no {name} to be set; it has {', '.join(known)}")
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

    def _number(self, name):
        if not self._run:
            raise Error("this run is closed")
        return getattr(library(), name)(self._run)

    time = property(lambda self: self._number("IsphTime"))
    time_step = property(lambda self: self._number("IsphTimeStep"))
    steps = property(lambda self: self._number("IsphSteps"))
    ended = property(lambda self: bool(self._number("IsphEnded")))

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
        self.state += 1
        if self._run:
            self._call("IsphDestroy", ctypes.byref(self._run))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
