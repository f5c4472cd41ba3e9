#!/usr/bin/python3
"""Relations that hold for any scene, tried on every option file of cases/ and options/, coarse and for a few steps, and
on scenes drawn at random (random_scenes.py). A relation changes a scene in a way that must not matter, or that changes
the result in a known way, and compares both runs. Where it does not apply it says why: by the program's own refusal, or
by a property of the scene.

    tests/relations/relations.py [--part PART] [--first NUMBER] [--only WORD ...] [--list]

A part is a tenth of the scenes, a number, or a quarter of the tenth that the date of the commit draws: a, b, c, d.
--first: of the random scenes; --only: relations or scenes with one of the words in their names; --list: what holds
where, of the last runs."""
import argparse
import collections
import functools
import itertools
import json
import os
import re
import shutil
import sys
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), HERE]
import dates  # noqa: E402
import kept  # noqa: E402
import numpy as np  # noqa: E402
import random_scenes  # noqa: E402
import record  # noqa: E402
import runs  # noqa: E402
import said  # noqa: E402
from scene import CORNERS, Scene, Unfit, coarse, files, mapped, read, reduce, scaled  # noqa: E402

TENTHS, QUARTERS = 10, "abcd"
FACTORS = [8, 5.5, 4, 2.75, 2, 1.375, 1]  # spacings over the file's, of which the first is taken that the scene bears
LEAST = {2: 60, 3: 200}        # particles of liquid that it must have
STEPS = {2: 10, 3: 6}
TIGHT = {"ksp_rtol": "1e-12"}  # and of implicit viscosity, where the scene has it:
TIGHT_VISCOUS = {"viscous_ksp_rtol": "1e-13"}
CLOSE = 5e-5                   # spacings, of places and of velocities times the time of the run: the weights of pairs
#                                have 16 bits, and rounding may turn one by 8e-6, a few in the settling of a packing by
#                                2.3e-5 (random/152); what was wrong was 2e-4 and more
HALF = 1e-6                    # of the kinetic energy, by which a half may differ
MANY = 10                      # what differs by more may differ by so many times what the scene itself does where it is
JOLTS, ELSEWHERE = (1e-9, -2e-8, 3e-8), (3.77, 100.3, -330.7)  # shifted by so many spacings: rounding turns weights of
#                                pairs, which the settling of a packing, or liquid that yields, carries on
MOST_STEPS = 2000              # of a run at half the spacing
AMONG_WALLS = 0.08             # of the spacing that all moves along walls, whose particles stand in other places then:
#                                up to 0.05, a wrong velocity or a contact line that sticks makes 0.1 and more
SCALARS = ("temperature", "concentration", "stretch")  # what is carried: of a tensor the trace
ENERGIES = 1e-5                # of the largest energy, by which one may differ where it is added up in another way
SAME_PLACE = 1e-6              # spacings: a start that differs by more has another packing
REFUSED = re.compile(r"isph: error: (.*(?:cannot be used with| needs |must lie in a region of -fine|"
                     r"too small for the kernel|covered by a solid).*)", re.S)
NUMBERS = itertools.count()  # of folders
# of a step, which a run has left for its last one; of the change in two whole steps, and of the largest speed
SHORT, MORE, KICK = 0.01, 3, 3e-4


class Run:
    """A finished run of a scene: its first and last state."""

    def __init__(self, folder):
        self.folder = folder
        self.first, self.last = (self.state(runs.numbered(folder, "snapshot")[k]) for k in (0, -1))
        self.span = self.last["time"] - self.first["time"]
        still = os.path.join(folder, "solids.h5")
        if os.path.exists(still):
            self.first["solids"] = runs.h5py.File(still, "r")["position"][:]

    @staticmethod
    def state(path):
        fields, head = runs.fields(path), runs.head(path)
        liquid = fields["body"] >= 0
        return {"time": float(head["time"]), "solids": fields["position"][~liquid],  # that move; all at first
                **{name: fields[name][liquid] for name in ("id", "position", "velocity", *SCALARS) if name in fields}}

    def end(self):
        """Every field of the last checkpoint."""
        return runs.fields(runs.numbered(self.folder, "checkpoint")[-1])

    def energies(self):
        """{name: J} of the works and energies that the run has added up, and the largest of all."""
        head = runs.head(runs.numbered(self.folder, "checkpoint")[-1])
        found = {name: value for name, value in head.items() if re.search("_(work|energy|swept)$", name)}
        return found, max(head["kinetic_most"], *(abs(v) for v in found.values()), 1e-300)

    def text(self, name):
        with open(os.path.join(self.folder, name), encoding="utf-8") as file:
            return file.read()

    def doubts(self):
        """What the run has said of itself at some time, without numbers, in order of the alphabet."""
        return sorted(re.sub(r"[-+\d.e]*\d", "#", line) for line in
                      re.findall(r"^t = +\S+ \S+: (.*)", self.text("log.txt"), re.M))

    def table(self, name, kind=None):
        """The columns of a table by their names without units, or none; kind: of the file that has the same columns."""
        if not os.path.exists(os.path.join(self.folder, name)):
            return {}
        rows = np.genfromtxt(os.path.join(self.folder, name), delimiter=",", names=True, deletechars="")
        heads = {c["head"]: c["name"] for c in json.loads(self.text("scene.json"))["columns"]
                 if c["file"] == (kind or name)}
        return {heads[head]: np.atleast_1d(rows[head]) for head in rows.dtype.names}


class Trial:
    """A scene under test: runs it once for all relations that compare with it as it is."""

    def __init__(self, scene, steps, long=0):
        """long: steps of the run that shows what is kept."""
        self.scene, self.steps, self.long = scene, steps, long or 2 * steps
        self.folder = runs.scratch(f"trial_{next(NUMBERS)}")
        os.mkdir(self.folder)

    def start(self, scene, more="", ranks=1, steps=None):
        """The folder of a run; Unfit where the program refuses the scene in a sentence of the table of refusals."""
        folder = os.path.join(self.folder, str(next(NUMBERS)))
        words = [*scene.words(), "-steps_max", str(steps or self.steps), "-output_dir", folder, "-progress_interval",
                 "0", "-series_interval", "0", "-checkpoint_interval", "0", "-snapshot_double", "-packing_cache", "",
                 *more.split()]
        done = runs.start(words, ranks)
        if done.returncode:
            refused = REFUSED.search(done.stderr)
            if refused:
                raise Unfit(" ".join(refused[1].split()))
            raise RuntimeError(f"code {done.returncode}: {done.stderr.strip()[-300:]}")
        return folder

    def file(self, name):
        return os.path.join(self.folder, name)

    def run(self, scene, more="", ranks=1, steps=None):
        return Run(self.start(scene, more, ranks, steps))

    @functools.cached_property
    def plain(self):
        """The scene as it is."""
        return self.run(self.scene)

    def gauged(self, more="", steps=None):
        """The same with much that is measured and written."""
        more += " -gauge_forces -gauge_droplets -gauge_droplet_main -gauge_pinch_off -gauge_spread -snapshot_walls "
        more += f"-snapshot_interval 1e-30 -gauge_roughness -gauge_points {middle_of(self.scene)} "
        more += f"-gauge_neck {'y' if self.scene.dim == 2 else 'z'} " + "-gauge_pockets" * ("gas" in self.scene.options)
        return self.run(self.scene, more, steps=steps)

    @functools.cached_property
    def measured(self):
        return self.gauged()

    @functools.cached_property
    def longer(self):
        """The scene as it is, for more steps."""
        return self.run(self.scene, steps=self.long)

    @functools.cached_property
    def tight(self):
        """(The scene with a tight solver, to compare to rounding; its run.)"""
        scene = self.scene.copy(**TIGHT)
        try:
            return self.tried(scene.copy(**TIGHT_VISCOUS))
        except RuntimeError as error:
            if "viscous_ksp_rtol here" not in str(error):
                raise
            return self.tried(scene)

    @functools.cached_property
    def even(self):
        """The same with a packing without random displacements, which another place would have otherwise."""
        if self.scene.options.get("packing_type", "lattice") != "lattice":
            raise Unfit("-packing_type poisson: its random numbers are of places")
        return self.tried(self.tight[0].copy(packing_jitter="0"))

    def tried(self, scene):
        return scene, self.run(scene)


def same(one, other):
    """What differs between two runs to the bit, of the last checkpoint and of the series; nothing: []."""
    a, b = one.end(), other.end()
    found = runs.unlike(a, b)
    s, t = runs.series(one.folder), runs.series(other.folder)
    if len(s) != len(t):
        return found + [f"{len(s)} and {len(t)} lines"]
    return found + [n for n in s.dtype.names if n in t.dtype.names and n != "wall_time" and not np.array_equal(
        s[n], t[n], equal_nan=True)]


def total(values):
    """Scalars, or the traces of tensors."""
    return values.reshape(len(values), -1)[:, :3].sum(axis=1)


def nearest(scene, a, b):
    """For each point of a the nearest of b, and its distance in spacings; through periodic faces too."""
    best, index = np.full(len(a), np.inf), np.zeros(len(a), dtype=int)
    size = np.array([scene.vector("box_upper")[d] - scene.vector("box_lower")[d] for d in range(scene.dim)])
    wraps = np.array([scene.face("xyz"[d], "min") == "periodic" for d in range(scene.dim)])
    for first in range(0, len(a), 500):
        r = a[first:first + 500, None, :scene.dim] - b[None, :, :scene.dim]
        r -= np.where(wraps, size * np.round(r / size), 0)
        distance = np.sqrt((r**2).sum(axis=2))
        index[first:first + 500] = distance.argmin(axis=1)
        best[first:first + 500] = distance.min(axis=1)
    return index, best / scene.spacing


def close(scene, one, other, seen=None, scale=(1, 1), packing=False, limit=CLOSE):
    """Holds that 'other', a run of 'scene', is 'one' seen from elsewhere: seen(x, v, time) are its places and
    velocities. scale: of lengths and times. packing: whether another packing at the start is an excuse."""
    apart, wrong = differences(scene, one, other, seen, scale, packing)
    if wrong:
        return [wrong]
    worst, (start, end) = max(map(max, apart)), (", ".join(f"{value:.2g}" for value in values) for values in apart)
    return [] if worst <= limit else [f"places, ways in spacings and what is carried, of its largest, are {end} apart, "
                                      f"at the start {start}; {limit:.2g} allowed"]


def differences(scene, one, other, seen=None, scale=(1, 1), packing=False):
    """Of the first and the last state the largest distance and way apart (spacings) and difference of what is carried,
    [(distance, way, ...), ...], and what is wrong otherwise."""
    apart = []
    for k, state in enumerate(("first", "last")):
        a, b = getattr(one, state), getattr(other, state)
        x, v = a["position"][:, :scene.dim] * scale[0], a["velocity"][:, :scene.dim] * scale[0] / scale[1]
        x, v = seen(x, v, a["time"] - one.first["time"]) if seen else (x, v)
        if len(x) != len(b["position"]):
            if k == 0 and packing:
                raise Unfit("the lattice has another number of points in the bodies there")
            return apart, f"{len(x)} and {len(b['position'])} particles at the {state} state"
        index, distance = nearest(scene, x, b["position"])
        if k == 0 and packing and distance.max() > SAME_PLACE:
            raise Unfit("the lattice lies otherwise there")
        if k == 0 and packing and len(a["solids"]):
            x = a["solids"][:, :scene.dim] * scale[0]
            x = seen(x, x, 0)[0] if seen else x
            if len(x) != len(b["solids"]) or nearest(scene, x, b["solids"])[1].max() > SAME_PLACE:
                raise Unfit("the lattice in a solid lies otherwise there")
        if len(set(index)) < len(index):
            return apart, f"at the {state} state {len(index) - len(set(index))} particles have no own counterpart"
        speed = np.abs(v - b["velocity"][index, :scene.dim]).max() * other.span / scene.spacing
        # what is carried may differ by so much of its largest as places by spacings
        carried = [(total(a[name]), total(b[name])[index]) for name in SCALARS if name in a]
        apart.append((distance.max(), speed, *(np.abs(p - q).max() / max(np.abs(p).max(), 1e-300) for p, q in carried)))
    return apart, ""


def shifted(t, scene, ways):
    """[(way (m), run)] of the scene shifted by so many spacings; none where it cannot be shifted."""
    found = []
    for part in ways:
        way = part * scene.spacing * np.array([0 if scene.rings and not d else 1 for d in range(scene.dim)])
        try:
            found.append((way, t.run(mapped(scene, np.eye(3), way))))
        except Unfit:
            return []
    return found


def chance(t, scene, one):
    """By how much (spacings) rounding makes a scene differ from itself."""
    apart = [differences(scene, one, other, lambda x, v, _, way=way: (x + way, v))[0]
             for way, other in shifted(t, scene, JOLTS)]
    return max((max(max(pair) for pair in pairs) for pairs in apart if pairs), default=0.0)


def close_by_chance(t, scene, one, other):
    """The same as close, but for what rounding does to the scene."""
    return close(scene, one, other) and close(scene, one, other, limit=max(CLOSE, MANY * chance(t, scene, one)))


# --- the relations: each returns what is wrong ---

def dump(t):
    """The options that -dump_options writes are the scene."""
    path = t.file("dump.opts")
    done = runs.start([*t.scene.words(), "-steps_max", str(t.steps), "-dump_options", path])
    if done.returncode:
        return [f"code {done.returncode}: {done.stderr.strip()[-300:]}"]
    words = Scene(t.scene.name, read(path))
    words = words.copy(**{name: None for name in ("steps_max", "packing_cache", "output_dir")})
    return same(t.plain, t.run(words))


def restart(t):
    """A run continued from a checkpoint in its middle is the run, to the bit."""
    counts = "emitter" in t.scene.options.values()  # fillings, which take their time
    steps, series = (t.long, runs.series(t.longer.folder)) if counts else (t.steps, runs.series(t.plain.folder))
    middle = 0.5 * (series["time"][0] + series["time"][-1]) - series["time"][0]
    whole = t.run(t.scene, f"-checkpoint_interval {middle!r}", steps=steps)
    first = runs.numbered(whole.folder, "checkpoint")[0]
    step = int(runs.head(first)["step"])
    if step >= steps:
        return [f"no checkpoint before step {step}"]
    more = f"-checkpoint_interval {middle!r} -restart {first}"
    rest = Run(t.start(t.scene, more, steps=steps - step))
    heads = [runs.head(runs.numbered(r.folder, "checkpoint")[-1]) for r in (whole, rest)]
    found = runs.unlike(whole.end(), rest.end()) + [
        f"attribute {k}" for k in heads[0] if k not in ("wall_time", "options") and not np.array_equal(
            heads[0][k], heads[1].get(k), equal_nan=isinstance(heads[0][k], float))]
    return found + runs.unlike_lines(runs.series(whole.folder), runs.series(rest.folder))


def added_up(one, other, copies=1):
    """Works and energies of a run that are not those of another, whose part of the scene is one of so many."""
    (a, most), (b, _) = one.energies(), other.energies()
    return [f"{name} {copies * b[name]:.6g} for {a[name]:.6g} J" for name in a
            if abs(a[name] - copies * b[name]) > ENERGIES * most]


def ranks(t):
    """Two, three or four ranks compute what one does, add up the same energies and say the same."""
    start, (scene, one) = "", t.tight
    if t.scene.options.get("packing_type") == "poisson":  # it ends elsewhere on other ranks: one makes it
        start = "-restart " + runs.numbered(t.run(scene, steps=1).folder, "checkpoint")[-1]
        one = t.run(scene, start)
    n = 2 + zlib.crc32(t.scene.name.encode()) % 3
    other = t.run(scene, start, ranks=n)
    wrong = close(scene, one, other) if start else close_by_chance(t, scene, one, other)
    said_otherwise = [f"it says {other.doubts()}, not {one.doubts()}"] * (one.doubts() != other.doubts())
    return [f"on {n}: {why}" for why in wrong or added_up(one, other) + said_otherwise]


def bodies(t):
    """The order of bodies and of solids does not matter."""
    if "bodies_overlap" in t.scene.options:
        raise Unfit("-bodies_overlap: the first body has the common part")
    changes = {key: ",".join(reversed(t.scene.names(key))) for key in ("bodies", "solids")
               if len(t.scene.names(key)) > 1}
    if not changes:
        raise Unfit("there is one body and at most one solid")
    if "interface_tension" in t.scene.options and "interface_bodies" not in t.scene.options:
        changes["interface_bodies"] = t.scene.names("bodies")[1]
    scene, one = t.even
    return close_by_chance(t, scene, one, t.run(scene.explicit().copy(**changes)))


def options(t):
    """The order of options does not matter, to the bit."""
    return same(t.plain, t.run(Scene(t.scene.name, dict(reversed(t.scene.options.items())))))


def moved(t, matrix, shift):
    n = t.scene.dim
    matrix, shift = np.array(matrix, dtype=float)[:n, :n], np.array(shift, dtype=float)[:n]
    scene, one = t.even
    scene = mapped(scene, matrix, shift)
    return close(scene, one, t.run(scene), lambda x, v, _: (x @ matrix.T + shift, v @ matrix.T), packing=True)


def shift(t):
    """A scene at another place is the same there."""
    way = 16 * t.scene.spacing * np.array([-3, 2, 1])
    if t.scene.rings:
        way[0] = 0
    return moved(t, np.eye(3), way)


def mirror(t):
    """A scene seen in a mirror."""
    return moved(t, np.diag([1, -1, 1] if t.scene.rings else [-1, 1, 1]), np.zeros(3))


def turn(t):
    """A scene turned by a right angle; in space each axis becomes the next one."""
    if t.scene.rings:
        raise Unfit("rings have one axis")
    walls = {letter for (letter, _), kind in t.scene.faces().items() if kind == "wall"}
    if len(walls) > 1 and any("contact_angle" in name for name in t.scene.options):
        raise Unfit("not cured: where two walls meet, images with a contact angle follow the order of the axes")
    return moved(t, [[0, -1], [1, 0]] if t.scene.dim == 2 else [[0, 0, 1], [1, 0, 0], [0, 1, 0]], np.zeros(3))


def units(t):
    """A scene in other units of length, time and mass, powers of two."""
    length, time, mass = 2.0**4, 2.0**-3, 2.0**6
    scene, one = t.tight
    scene = scaled(scene, length, time, mass)
    ties = "spacing_coarse" in scene.options  # which rounding breaks when a graded packing is spread
    return close(scene, one, t.run(scene), scale=(length, time), packing=ties)


def outputs(t):
    """What is measured and written does not change the run, to the bit."""
    return same(t.plain, t.measured)


def middle_of(scene):
    return ",".join(repr(float(v)) for v in 0.5 * (scene.vector("box_lower") + scene.vector("box_upper"))[:scene.dim])


def clock(t):
    """Checkpoints by the clock do not change the run, to the bit."""
    return same(t.plain, t.run(t.scene, "-checkpoint_wall_clock 1e-9"))


def half(t):
    """Half or a quarter of a symmetric scene is the whole."""
    path, (scene, whole) = t.file("whole.opts"), t.even
    with open(path, "w", encoding="utf-8") as file:
        file.write(reduce.as_text(list(scene.options.items())))
    try:
        known = reduce.Scene(path, ["-steps_max", str(t.steps)])
        mirrors = [m for m in known.model["mirrors"] if m["holds"] and m["across"] != "xyz"[t.scene.dim - 1]][:2]
        if not mirrors:
            raise Unfit("; ".join(m["why"] for m in known.model["mirrors"] if m["why"]) or "there is no mirror")
        lines = reduce.mirrored(known, mirrors).lines
    except reduce.tables.Error as error:
        raise Unfit(str(error)) from error
    part = Scene(t.scene.name, {k: v for k, v in lines if k != "gauge_multiplicity"})
    planes = [m["across"] for m in mirrors]
    places, images = whole.first["position"], 2**len(planes)
    for letter in planes:
        d = "xyz".index(letter)
        seen = places.copy()
        seen[:, d] = 2 * part.vector("box_lower")[d] - seen[:, d]
        if nearest(scene, seen, places)[1].max() > SAME_PLACE:
            raise Unfit("the packing of the whole is not symmetric")
    other = t.run(part)
    if images * len(other.first["id"]) != len(places):
        raise Unfit("the lattice of the whole has particles on the mirror")
    if nearest(scene, other.first["position"], places)[1].max() > SAME_PLACE:
        raise Unfit("of points that are as near to the surface of a body, the half's packing has others")
    runs_of, (whole, less) = (whole, other), (runs.series(r.folder)["kinetic_energy"] for r in (whole, other))
    most = max(np.abs(whole).max(), 1e-300)
    apart = np.abs(whole - images * less).max() / most
    if apart <= HALF:
        return added_up(*runs_of, images)
    rounding = max((np.abs(whole - runs.series(other.folder)["kinetic_energy"]).max() / most
                    for _, other in shifted(t, scene, ELSEWHERE)), default=0.0)
    return [] if apart <= MANY * rounding else [f"kinetic energies differ by {apart:.2g} of it, those of the whole by "
                                                f"{rounding:.2g} at other places"]


def later(t):
    """A scene that starts at another time is the same then."""
    if t.scene.moves():
        raise Unfit(f"-{t.scene.moves()[0]} is a function of the time")
    late, changes = 0.125, {}
    for body in t.scene.names("bodies"):
        if f"{body}_velocity_file" in t.scene.options:
            raise Unfit(f"-{body}_velocity_file is a function of the time")
        if t.scene.options.get(f"{body}_type") == "emitter":
            changes[f"{body}_start"] = [t.scene.number(f"{body}_start") + late]
    if "gravity_amplitude" in t.scene.options:
        phase = t.scene.number("gravity_phase") - 360 * late * t.scene.number("gravity_frequency")
        changes["gravity_phase"] = [phase % 360]
    changes["time_start"] = [t.scene.number("time_start") + late]
    scene, one = t.tight
    return close(scene, one, t.run(scene.copy(**changes)))


def cut(t):
    """A body that is cut in two along a plane is the body."""
    for body in t.scene.names("bodies"):
        if t.scene.options.get(f"{body}_shape", "box") != "box" or t.scene.options.get(f"{body}_type") == "emitter":
            continue
        if "interface_tension" in t.scene.options or f"{body}_holes" in t.scene.options:
            continue
        scene, one = t.even
        scene = scene.explicit()
        low, high = (scene.vector(f"{body}_{corner}")[:scene.dim] for corner in CORNERS)
        low, high = np.maximum(low, scene.vector("box_lower")), np.minimum(high, scene.vector("box_upper"))
        d = scene.dim - 1
        if high[d] - low[d] < 4 * scene.spacing:
            continue
        where = low.copy(), high.copy()
        where[1][d] = where[0][d] = low[d] + scene.spacing * round(0.5 * (high[d] - low[d]) / scene.spacing)
        changes = {name.replace(f"{body}_", "upper_half_", 1): value for name, value in scene.options.items()
                   if name.startswith(f"{body}_")}
        names = scene.names("bodies")
        changes["bodies"] = ",".join(names[:names.index(body) + 1] + ["upper_half"] + names[names.index(body) + 1:])
        changes[f"{body}_upper"], changes["upper_half_lower"] = where[1], where[0]
        return close(scene, one, t.run(scene.copy(**changes)), packing=True)
    raise Unfit("no body is a box of four layers, without holes and an interface")


def far(t):
    """A solid far from everything changes nothing."""
    scene, one = t.tight
    d, n = scene.spacing, scene.dim
    low, high = scene.vector("box_lower")[:n], scene.vector("box_upper")[:n]
    taken = one.end()["position"][:, :n]
    reach = 12 * d * max(1.0, scene.number("spacing_coarse") / d)
    for k in range(2**n):
        corner = np.array([(low, high)[k >> c & 1][c] for c in range(n)])
        inward = np.sign(0.5 * (low + high) - corner)
        center = corner + 4 * d * inward
        if (high - low > 12 * d).all() and np.sqrt(((taken - center)**2).sum(axis=1)).min() > reach:
            names = scene.names("solids") + ["remote"]
            remote = dict(remote_shape="box", remote_lower=center - 1.6 * d, remote_upper=center + 1.6 * d)
            return close(scene, one, t.run(scene.copy(solids=",".join(names), **remote)))
    raise Unfit("no corner of the box is free")


def frame(t):
    """Liquid that nothing holds falls as the frame does in which it is at rest."""
    scene = t.scene
    if scene.names("solids") or any(kind in ("wall", "symmetry", "periodic") for kind in scene.faces().values()) or (
            scene.rings or "central_force_rate" in scene.options or "gravity_amplitude" in scene.options or
            "frame_rotation_rate" in scene.options or "emitter" in scene.options.values()):
        raise Unfit("something holds or brings the liquid, or it has an axis")
    g, dt = scene.vector("gravity")[:scene.dim], float(runs.series(t.plain.folder)["time_step"][1:].min())
    pull = -g if g.any() else np.array([0.3, -0.5, 0.7])[:scene.dim] * scene.spacing / dt**2 / 400
    fixed = t.tight[0].copy(time_step=[dt / 4], pressure_relaxation_time=[50 * dt])
    if fixed.options.get("scheme", "consistent") != "consistent":
        raise Unfit("its steps or its speed of sound follow from the scene's speeds")
    one, wrong = t.run(fixed), []
    for way in (pull, 0.1 * pull):  # rounding turns a flag of a particle at times: what is wrong is so with both
        wrong = close(scene, one, t.run(fixed.copy(gravity=g + way)),
                      lambda x, v, time, way=way: (x + 0.5 * way * time**2, v + way * time))
        if not wrong:
            break
    return wrong


def stream(t):
    """Along a periodic axis all may move with one velocity besides: liquid, walls, solids, contact lines."""
    scene = t.tight[0]
    axes = [d for d in range(scene.dim) if scene.face("xyz"[d], "min") == "periodic" and not (scene.rings and not d)]
    if not axes:
        raise Unfit("no axis is periodic")
    if scene.names("fine") or {"emitter", "poisson"} & set(scene.options.values()) or (
            {"central_force_rate", "frame_rotation_rate"} & set(scene.options)) or any(
                name.endswith(("_motion_file", "_velocity_formula")) for name in scene.options):
        raise Unfit("something stands where it is, or has a table of its motion")
    if scene.options.get("scheme", "consistent") != "consistent":
        raise Unfit("its steps or its speed of sound follow from the scene's speeds")
    if any(kind == "wall" for kind in scene.faces().values()) and any(
            name.endswith("_polymer_modulus") for name in scene.options):
        raise Unfit("the stretch beside a wall follows where its particles stand, by a tenth in the first ten steps")
    dt = float(runs.series(t.plain.folder)["time_step"][1:].min())
    way = np.zeros(scene.dim)
    way[axes[0]] = scene.spacing / (t.steps * dt)  # a spacing in all
    walls = [f"box_{letter}{end}_velocity" for (letter, end), kind in scene.faces().items() if kind == "wall"]
    movers = [f"{name}_velocity" for name in scene.names("bodies", "solids")] + walls
    # the time in which density errors are corrected follows from the scene's speeds, too
    fixed = scene.copy(time_step=[dt], pressure_relaxation_time=[20 * dt])
    moving = fixed.copy(**{name: way + scene.vector(name)[:scene.dim] for name in movers})
    try:
        other = t.run(moving)
    except RuntimeError as error:
        raise (Unfit("a solid ends at a face of the axis") if "moves out of the box" in str(error) else error)
    return close(scene, t.run(fixed), other, lambda x, v, time: (x + way * time, v + way),
                 limit=AMONG_WALLS if walls or "gas" in scene.options else CLOSE)  # gas has cells, which stand


def ends(t):
    """A run whose end is no multiple of its step kicks nothing there: no speed changes by more than in whole steps."""
    dt = runs.series(t.plain.folder)["time_step"][-1]
    odd = t.run(t.scene.copy(time_end=[t.plain.last["time"] + SHORT * dt]), steps=t.steps + 2)
    after = t.run(t.scene, steps=t.steps + 2)
    states = [by_number(run) for run in (t.plain, odd, after)]
    both = functools.reduce(np.intersect1d, [state[0] for state in states])
    v = [speeds[np.searchsorted(number, both)] for number, speeds in states]
    most = max(np.abs(v[2]).max(), 1e-300)
    kick, usual = np.abs(v[1] - v[0]).max() / most, np.abs(v[2] - v[0]).max() / most
    if kick <= max(MORE * usual, KICK):
        return []
    return [f"speeds change by {kick:.2g} in the last step, {usual:.2g} in two whole ones"]


def by_number(run):
    """Numbers of the liquid in order, and its velocities."""
    order = np.argsort(run.last["id"])
    return run.last["id"][order], run.last["velocity"][order]


def keeps(t):
    """A scene keeps mass, momentum and energy as far as it is closed."""
    def finer(end):
        return t.start(coarse(t.scene, 0.5).copy(time_end=[end]), steps=MOST_STEPS)

    return kept.judge(t.scene, t.longer.folder, finer)


RELATIONS = {r.__name__: r for r in (dump, restart, ranks, bodies, options, shift, mirror, turn, units, outputs, clock,
                                     half, later, cut, far, frame, stream, said.first, said.books, said.told, ends,
                                     keeps)}


def resolves(run, spacing):
    """Whether no solid is thinner than a spacing, and no hole than two. The stirred tank, full, with a paddle of 0.8
    spacings, gains a third of its energy in ten steps, and rounding grows 40 000 times in one; from 1.2 spacings on it
    keeps all relations. Around a bubble with a radius of 1.25 spacings rounding grows 300 times in ten steps."""
    with open(os.path.join(run.folder, "scene.json"), encoding="utf-8") as file:
        found = json.load(file)
    holes = [hole for owner in found["solids"] + found["bodies"] for hole in owner.get("holes", [])]
    return all(high - low >= least * spacing for least, shapes in ((1, found["solids"]), (2, holes)) for shape in shapes
               for low, high in zip(shape["lower"], shape["upper"]))


def prepared(scene):
    """A Trial of a file's scene at the coarsest spacing that it bears."""
    for factor in FACTORS:
        trial = Trial(coarse(scene, factor), STEPS[scene.dim])
        try:
            run = trial.run(trial.scene, steps=1)
            if factor == FACTORS[-1] or len(run.first["id"]) >= LEAST[scene.dim] and resolves(run, trial.scene.spacing):
                return trial
        except (Unfit, RuntimeError):
            if factor == FACTORS[-1]:
                raise
    raise AssertionError


def drawn(make, number, name):
    """A Trial of a random scene."""
    scene = make(number)
    options = {name[1:]: value for name, value in scene.options.items()}
    options.update(spacing=str(random_scenes.D0), time_step_max="0.02")
    return Trial(Scene(name, options), STEPS[scene.dim], scene.steps)


def scenes(first):
    """{name: function that makes its Trial}. first: number of the first random scenes."""
    found = {scene.name: functools.partial(prepared, scene) for scene in files()}
    for family, (make, count) in random_scenes.FAMILIES.items():
        for k in range(first, first + count):
            found[f"{family}/{k}"] = functools.partial(drawn, make, k, f"{family}/{k}")
    return found


def today():
    """The tenth that the date of the commit draws."""
    return dates.day() % TENTHS


def of_part(name, part):
    """Whether a scene belongs to a part."""
    draw = zlib.crc32(name.encode())
    if part in QUARTERS:
        return draw % TENTHS == today() and draw // TENTHS % len(QUARTERS) == QUARTERS.index(part)
    return draw % TENTHS == int(part)


def judge(name, make, relations):
    """Tries the relations on a scene; {relation: '' if it holds, else why it does not apply, or what is wrong}."""
    fates = {}
    try:
        trial = make()
    except (Unfit, RuntimeError) as error:
        runs.check(False, f"{name} runs", str(error))
        return fates
    for relation, holds in relations.items():
        try:
            wrong = "; ".join(holds(trial)[:6])
        except Unfit as error:
            fates[relation] = str(error)
            continue
        except RuntimeError as error:
            wrong = str(error)
        if (name, relation) in record.KNOWN:
            runs.check(bool(wrong), f"{name} {relation} is known to be wrong", "it holds now: its row goes")
        else:
            runs.check(not wrong, f"{name} {relation}", wrong)
        fates[relation] = f"{record.WRONG}{wrong}" if wrong else ""
    shutil.rmtree(trial.folder, ignore_errors=True)
    return fates


def show():
    """For each relation: in how many scenes it holds and is wrong, and why it does not apply to the others."""
    table = record.last()
    for relation in RELATIONS:
        fates = [(name, own[relation]) for name, own in table.items() if relation in own]
        wrong = [name for name, fate in fates if fate.startswith(record.WRONG)]
        print(f"{relation}: holds in {sum(not fate for _, fate in fates)} scenes, is wrong in {len(wrong)} {wrong}")
        why = collections.Counter(fate for _, fate in fates if fate and not fate.startswith(record.WRONG))
        for reason, count in why.most_common():
            print(f"    {count:4}  {reason[:150]}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--part")
    parser.add_argument("--parts", action="store_true")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--list", action="store_true")
    arguments = parser.parse_args()
    if arguments.list:
        return show()
    chosen = {r: holds for r, holds in RELATIONS.items() if r in arguments.only} or RELATIONS
    words = [word for word in arguments.only if word not in RELATIONS]
    parts = runs.parts(*QUARTERS, *map(str, range(TENTHS)))
    for name, make in scenes(arguments.first).items():
        if arguments.part and not of_part(name, parts[0]) or words and not any(word in name for word in words):
            continue
        record.keep(name, judge(name, make, chosen))
    return runs.done()


if __name__ == "__main__":
    main()
