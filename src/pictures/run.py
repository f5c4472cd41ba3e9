"""A run for the pictures: its scene, and its states with their mirror images. SI units."""
import glob
import os

import h5py
import numpy as np

import columns
from isph import tables
from isph.tables import Error

AXES = "xyz"


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


FIELD_OF = {"speed": "velocity", "pressure": "pressure", "size": "volume"}  # of the snapshots, for these colours
OF_THE_SCHEME = {"position", "velocity", "pressure", "density", "carried", "lambda", "volume", "size"}
SWING = 1e-3  # of the range of the potential energy, above its start, that a crest has at least
SOLID = -2  # INT_BODY of particles of the first of -solids; -3 is the second, and so on


class State:
    """A snapshot with its mirror images: time; path; points, velocity [n][3]; pressure, speed, body [n]; share [n]:
    volume (of rings area) over spacing^dim; size [n]: the particle's spacing over the finest; solid [n][3]: dummy
    particles of solids at this time, solid_of [n]: the index of each one's solid; first [n]: the part of the
    particle's volume that was of the first body, None: not stored; scalars: what else particles carry, by the names of
    the fields, each an attribute. Rings are in the plane y = 0 on both sides of the axis z."""

    def __init__(self, time, points, velocity, pressure, body, share, size, solid, first=None, solid_of=None,
                 path=None, scalars=None):
        self.time, self.points, self.velocity, self.pressure, self.body = time, points, velocity, pressure, body
        self.share, self.size, self.solid, self.first = share, size, solid, first
        self.solid_of, self.path = solid_of, path
        vars(self).update(scalars or {})

    @property
    def speed(self):
        return np.linalg.norm(self.velocity, axis=1)


def upright(vectors):
    """Vectors (r, z, 0) of rings as (x, y, z) in the plane y = 0."""
    return vectors[:, [0, 2, 1]]


def ring_share(r, volume, size, spacing):
    """Areas of rings over spacing^2 from their distances to the axis (m), volumes (m3) and sizes, as in the
    program."""
    half = 0.5 * size * spacing
    length = 2 * np.pi * np.where(r > half, r, 0.5 * (r + half))
    return volume / (length * spacing**2)


def shares(file, liquid, r, rings, spacing):
    """Share and size of the liquid of a snapshot; r: distances of rings from the axis (m)."""
    one = np.ones(len(r))
    if "volume" not in file:
        return one, one
    volume = np.ravel(file["volume"])[liquid].astype(float)
    if rings:
        size = np.ravel(file["size"])[liquid].astype(float) if "size" in file else one
        return ring_share(r, volume, size, spacing), size
    dim = int(np.ravel(file.attrs["dimension"])[0])
    return volume / spacing**dim, volume**(1 / dim) / spacing


def first_part(file, body, liquid):
    """The part [n] of the liquid of a snapshot that was of the first body; particles that joined have mixed."""
    if "colour" in file:
        return np.ravel(file["colour"])[liquid].astype(float)
    return (body[liquid] == 0).astype(float)


def carried(file, liquid):
    """What the liquid of a snapshot carries, by the names of the fields: numbers, and the traces of tensors."""
    found = {name: np.array(values, float)[liquid].reshape(np.count_nonzero(liquid), -1)
             for name, values in file.items()
             if name not in OF_THE_SCHEME and isinstance(values, h5py.Dataset) and values.dtype.kind == "f"}
    return {name: values[:, :3 if values.shape[1] > 1 else 1].sum(axis=1) for name, values in found.items()}


class Run:
    """A run folder. lower, upper: corners of the box with its mirror images; faces[d]: kinds of its two faces. A run
    with rings counts as three-dimensional; its box is the box around their cylinder."""

    def __init__(self, folder):
        if not os.path.isdir(folder):
            raise Error(f"{folder} is not a folder.")
        self.folder, self.files = folder, []
        for path in sorted(glob.glob(os.path.join(folder, "snapshot_*.h5"))):
            try:
                with h5py.File(path, "r") as file:
                    self.files.append((float(np.ravel(file.attrs["time"])[0]), path))
            except (OSError, KeyError):
                print(f"{path} is not a complete snapshot; it is left out.")
        if not self.files:
            raise Error(f"{folder} has no readable snapshot_*.h5.")
        self.files.sort()
        self.scene, self.rows = tables.read_scene(folder), tables.rows_of(folder)
        with h5py.File(self.files[0][1], "r") as file:
            head, self.fields = dict(file.attrs), set(file)
            self.colors = [*FIELD_OF, *carried(file, np.ravel(file["body"]) >= 0)]
        self.rings = bool(np.ravel(head.get("axisymmetric", 0))[0])
        self.dim = 3 if self.rings else int(np.ravel(head["dimension"])[0])
        self.up, self.across = self.dim - 1, "r" if self.rings else "x"
        self.spacing = float(np.ravel(head["spacing"])[0])
        self.lower, self.upper = np.array(head["box_lower"], float), np.array(head["box_upper"], float)
        kinds = {face["name"]: face["type"] for face in self.scene["domain"]["faces"]}
        self.faces = [[kinds.get(axis + end, "open") for end in ("min", "max")] for axis in AXES]
        self.mirrors = self.unfold()
        self.bodies = [body["name"] for body in self.scene["bodies"]]
        self.solid, self.solid_of = self.read_solid()

    def unfold(self):
        """[(direction, position)] of the mirrors that pictures unfold: at most one for each horizontal direction."""
        if self.rings:
            (_, bottom, _), (reach, top, _) = self.lower, self.upper
            self.lower, self.upper = np.array([-reach, -reach, bottom]), np.array([reach, reach, top])
            self.faces = [[self.faces[0][1]] * 2] * 2 + [self.faces[1]]
            return [(0, 0.0)]
        mirrors = []
        for d in range(self.dim - 1):
            for side in range(2):
                if self.faces[d][side] != "symmetry":
                    continue
                length, other = self.upper[d] - self.lower[d], self.faces[d][1 - side]
                mirrors.append((d, self.upper[d] if side else self.lower[d]))
                if side:
                    self.upper[d] += length
                else:
                    self.lower[d] -= length
                self.faces[d] = [other, other]
                break
        return mirrors

    def reflect(self, points, vectors=(), others=()):
        """Points with their mirror images; vectors change sign, others are copied."""
        for d, place in self.mirrors:
            image = points.copy()
            image[:, d] = 2 * place - image[:, d]
            points = np.concatenate([points, image])
            flipped = []
            for vector in vectors:
                image = vector.copy()
                image[:, d] = -image[:, d]
                flipped.append(np.concatenate([vector, image]))
            vectors = flipped
            others = [np.concatenate([other, other]) for other in others]
        return points, vectors, others

    def read(self, path):
        """The liquid of a snapshot."""
        with h5py.File(path, "r") as file:
            time = float(np.ravel(file.attrs["time"])[0])
            body = np.ravel(file["body"])
            liquid = body >= 0
            moved = body <= SOLID
            solid, solid_of = np.array(file["position"], float)[moved], SOLID - body[moved]
            points = np.array(file["position"], float)[liquid]
            zero = np.zeros(len(points))
            velocity = np.array(file["velocity"], float)[liquid] if "velocity" in file else np.zeros_like(points)
            pressure = np.ravel(file["pressure"])[liquid].astype(float) if "pressure" in file else zero
            share, size = shares(file, liquid, points[:, 0], self.rings, self.spacing)
            first, scalars = first_part(file, body, liquid), carried(file, liquid)
        if self.rings:
            points, velocity, solid = upright(points), upright(velocity), upright(solid)
        # solids that move are in the snapshots, others in solids.h5
        still = ~np.isin(self.solid_of, SOLID - np.unique(body[moved]))
        solid, _, (solid_of,) = self.reflect(solid, others=[solid_of])
        solid = np.concatenate([self.solid[still], solid])
        solid_of = np.concatenate([self.solid_of[still], solid_of])
        others = [pressure, body[liquid], share, size, first, *scalars.values()]
        points, (velocity,), (pressure, body, share, size, first, *others) = self.reflect(points, [velocity], others)
        return State(time, points, velocity, pressure, body, share, size, solid, first, solid_of, path,
                     dict(zip(scalars, others)))

    def around(self, points):
        """The points that a picture must contain; for rings with their points a quarter of a turn on."""
        return np.concatenate([points, points[:, [1, 0, 2]]]) if self.rings else points

    def read_solid(self):
        """Dummy particles of solids at the start, [n][3], and the index of each one's solid; empty without the
        file."""
        path = os.path.join(self.folder, "solids.h5")
        if not os.path.exists(path):
            return np.zeros((0, 3)), np.zeros(0, int)
        with h5py.File(path, "r") as file:
            points, solid = np.array(file["position"], float).reshape(-1, 3), np.ravel(file["solid"])
        points = upright(points) if self.rings else points
        points, _, (solid,) = self.reflect(points, others=[solid])
        return points, solid

    def moments(self, times=None, count=6):
        """The snapshots nearest to the times (s), or 'count' of them with the same change of the scene between them."""
        if times is not None:
            return sorted({min(self.files, key=lambda item, t=t: abs(item[0] - t)) for t in times})
        try:
            table, rows = tables.read_series(self.folder), self.rows
        except Error:
            table, rows = {}, {}
        done = columns.progress(table, rows, [time for time, _ in self.files])
        count, last = min(count, len(done)), -1
        found = []
        for k, wanted in enumerate(np.linspace(0, 1, count) if count > 1 else [1]):
            last = int(np.clip(np.abs(done - wanted).argmin(), last + 1, len(done) - count + k))
            found.append(last)
        return [self.files[k] for k in self.at_crests(table, found)]

    def at_crests(self, table, found):
        """The snapshots 'found', but for the first and last, moved to the nearest crest of the potential energy if it
        swings more often than there are pictures: waves are shown where they are high."""
        energy = np.array(table.get("potential_energy", []), float)
        if len(energy) < 3 or not np.isfinite(energy).all():
            return found
        energy = np.interp([time for time, _ in self.files], table["time"], energy)
        inner, least = energy[1:-1], energy[0] + SWING * np.ptp(energy)
        crest = 1 + np.flatnonzero((inner > energy[:-2]) & (inner >= energy[2:]) & (inner > least))
        if len(crest) < len(found):
            return found
        moved = [found[0], *(int(crest[np.abs(crest - k).argmin()]) for k in found[1:-1]), found[-1]]
        return moved if len(set(moved)) == len(moved) else found

    def unit(self, color):
        """The unit of a colour: that of its field in the snapshots; a size is a spacing."""
        if color == "size":
            return "m"
        return next(row["unit"] for row in self.scene["columns"]
                    if row["file"] == "snapshot" and row["name"] == FIELD_OF.get(color, color))

    def has(self, color):
        """Whether the snapshots have the field for this colour."""
        return color == "body" or color in self.colors and FIELD_OF.get(color, color) in self.fields

    def need(self, color):
        """Refuses to colour by a field that the snapshots lack."""
        if not self.has(color):
            colors = ", ".join(filter(self.has, ["body", *self.colors]))
            raise Error(f"the snapshots of {self.folder} have no {FIELD_OF.get(color, color)} (-snapshot_fields): "
                        f"colours are {colors}.")

def duration(seconds):
    """A time as text, with its unit."""
    factor, unit = columns.prefixed(seconds, "s")
    return f"{seconds * factor:.3g} {unit}"


def scale(length):
    """Factor and unit with which a length (m) is a handy number."""
    return columns.prefixed(length, "m")


def bar(width):
    """A round length (m) for a scale bar in a picture 'width' wide."""
    wanted = 0.25 * width
    power = 10.0 ** np.floor(np.log10(wanted))
    return max(step * power for step in (1, 2, 5) if step * power <= wanted)
