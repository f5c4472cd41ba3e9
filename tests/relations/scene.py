"""Scenes as options: read from files, made coarse, and seen from elsewhere: shifted, turned, mirrored, in other units.
An option that these do not know stops them with a sentence, so that a new one is not forgotten."""
import json
import os
import re
import shlex
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path[:0] = [os.path.join(ROOT, *place) for place in (("tests",), ("src", "answers"), ("src", "python"))]
import numpy as np  # noqa: E402
import reduce  # noqa: E402

# What is written and measured, which must not change anything, and what bounds a run.
OUTPUT = re.compile(r"(gauge|snapshot|series|checkpoint|output|progress|monitor|wall_clock)_|(time_end|steps_max|"
                    r"packing_cache|dry_run|dump_options|stop_at_rest)$")
# Options of a place, of a direction, of a direction of rotation; corners come in pairs.
POINTS = {"center", "point", "rotation_center", "strain_center", "frame_rotation_center", "offset"}
DIRECTIONS = {"velocity", "gravity", "gravity_amplitude", "oscillation_amplitude", "normal", "axis",
              "temperature_gradient"}
ROTATIONS = {"rotation_rate", "frame_rotation_rate", "rotation_axis"}
CORNERS = ("lower", "upper")
FACE = re.compile(r"box_([xyz])(min|max)?(_\w+)?$")
# Places that are the origin if they are not given, by the word that asks for them.
ORIGINS = {"sphere": "center", "cylinder": "center", "ellipsoid": "center", "thread": "center", "half_space": "point",
           "rotation": "rotation_center", "strain": "strain_center"}
# Powers of length, time and mass of what units are made of; of a plane everything is per metre.
LETTERS = {"m": (1, 0, 0), "s": (0, 1, 0), "kg": (0, 0, 1), "Hz": (0, -1, 0), "N": (1, -2, 1), "Pa": (-1, -2, 1),
           "J": (2, -2, 1), "W": (2, -3, 1), "rad": (0, 0, 0), "degrees": (0, 0, 0), "K": (0, 0, 0),
           "spacings": (0, 0, 0)}
PLANE = {"mass", "inertia"}  # whose units in a plane are per metre


class Unfit(Exception):
    """A relation does not apply to a scene; the text says why."""


def own(name, bodies):
    """An option's name without the name of its body."""
    for body in sorted(bodies, key=len, reverse=True):
        if name.startswith(body + "_"):
            return name[len(body) + 1:]
    return name


def plain(value):
    """The words of a value: text, a number or numbers."""
    return value if isinstance(value, str) else ",".join(repr(float(v)) for v in np.atleast_1d(value))


class Scene:
    """options: {name without the dash: words}; name: by which it is known."""

    def __init__(self, name, options):
        self.name, self.options = name, dict(options)
        self.rings = self.options.get("dimension") == "axisymmetric"
        self.dim = 3 if self.options.get("dimension", "3") == "3" else 2

    def copy(self, **changes):
        """Another scene with changed options; None takes one out."""
        scene = Scene(self.name, self.options)
        for name, value in changes.items():
            scene.options.pop(name, None)
            if value is not None:
                scene.options[name] = plain(value)
        return scene

    def words(self):
        found = []
        for name, value in self.options.items():
            found += [f"-{name}"] + ([value] if value else [])
        return found

    def names(self, *keys):
        """Names of bodies, solids, regions, holes."""
        return [n for key in keys for n in self.options.get(key, "").split(",") if n]

    def owners(self):
        found = self.names("bodies", "solids", "fine")
        for name, value in self.options.items():
            if name.endswith("_holes"):
                found += [n for n in value.split(",") if n]
        return list(dict.fromkeys(found))

    def number(self, name, default=0.0):
        return float(self.options.get(name, default))

    def vector(self, name, default=0.0):
        """An option's numbers, filled up with zeros."""
        numbers = [float(v) for v in self.options.get(name, str(default)).split(",")]
        return np.array((numbers + [0.0] * self.dim)[:max(self.dim, len(numbers))])

    @property
    def spacing(self):
        return self.number("spacing")

    def face(self, letter, end):
        return self.options.get(f"box_{letter}{end}", self.options.get(f"box_{letter}", "open"))

    def faces(self):
        return {(letter, end): self.face(letter, end) for letter in "xyz"[:self.dim] for end in ("min", "max")}

    def moves(self):
        """Whether a solid moves or gravity swings as a function of the time."""
        moving = {"oscillation_amplitude", "velocity", "rotation_rate", "motion_file"}
        return [name for name in self.options for solid in self.names("solids")
                if name in {f"{solid}_{m}" for m in moving} and not self.number(f"{solid}_mass")]

    def explicit(self):
        """The same scene with the places, densities and viscosities that have a default."""
        more = {}
        zero = plain([0.0] * self.dim)
        for body in self.owners():
            for word in (self.options.get(f"{body}_shape", "box"), self.options.get(f"{body}_velocity_type")):
                if word in ORIGINS:
                    more[f"{body}_{ORIGINS[word]}"] = zero
            if self.options.get(f"{body}_rotation_rate") and body in self.names("solids") and (
                    not self.number(f"{body}_mass")):
                more[f"{body}_rotation_center"] = zero
            for k, corner in enumerate(CORNERS):
                if self.options.get(f"{body}_shape", "box") in ("box", "wave"):
                    more[f"{body}_{corner}"] = self.options[f"box_{corner}"]
        for body in self.names("bodies"):
            more[f"{body}_density"], more[f"{body}_viscosity"] = "1000", "1e-3"
            if f"{body}_temperature" in self.options:
                more[f"{body}_heat_capacity"] = "4184"
        first = self.names("bodies")[0]
        if f"{first}_temperature" in self.options:
            more["reference_temperature"] = self.options[f"{first}_temperature"]
        if "frame_rotation_rate" in self.options:
            more["frame_rotation_center"] = zero
        if "gas" in self.options:
            more["gas_pressure"] = "101325"
        if "wall_contact_law" in self.options:
            more["wall_contact_slip"] = "1e-9"
        return Scene(self.name, {**{n: v for n, v in more.items() if n not in self.options}, **self.options})


def read(path):
    """The options of a file and of those that it names, {name: words} in their order; the last of equal ones counts."""
    options = {}
    with open(path, encoding="utf-8") as file:
        words = shlex.split(file.read(), comments=True)
    for k, word in enumerate(words):
        if word[:1] != "-" or not word[1:2].isalpha():
            continue
        after = words[k + 1] if k + 1 < len(words) else "-end"
        value = "" if after[:1] == "-" and after[1:2].isalpha() else after
        if word == "-options_file":
            options.update(read(os.path.join(ROOT, value)))
        else:
            options.pop(word[1:], None)
            options[word[1:]] = value
    return options


def files():
    """[(name, scene)] of every option file of cases/ and options/: with what it is put behind, if it is none alone. A
    folder runs/ has what an earlier version ran."""
    found = []
    impact = os.path.join(ROOT, "cases", "drop_impact", "case.opts")
    for top in ("cases", "options"):
        for folder, _, names in sorted(os.walk(os.path.join(ROOT, top))):
            if os.path.basename(os.path.dirname(folder)) == "runs":
                continue
            for file in sorted(n for n in names if n.endswith(".opts")):
                path = os.path.join(folder, file)
                options = read(path)
                if "bodies" not in options:
                    base = impact if top == "options" else os.path.join(
                        folder, "axisymmetric.opts" if "axisymmetric" in file else "case.opts")
                    options = {**read(base), **options}
                name = os.path.relpath(path, ROOT).replace("cases/", "").replace(".opts", "")
                found.append(Scene(name, {k: v for k, v in options.items() if not OUTPUT.match(k)}))
    return found


def coarse(scene, factor):
    """The scene with so many times its spacing, and its steps of time."""
    return scene.copy(**{name: factor * scene.number(name) for name in (
        "spacing", "spacing_coarse", "time_step", "time_step_min", "time_step_max") if name in scene.options})


def mapped(scene, matrix, shift):
    """The scene seen from elsewhere: x -> matrix x + shift. matrix: a permutation of the axes with signs."""
    scene = scene.explicit()
    n, owners, changed = scene.dim, scene.owners(), {}
    matrix, shift = np.array(matrix, dtype=float)[:n, :n], np.array(shift, dtype=float)[:n]
    proper = round(np.linalg.det(matrix))
    for name, value in scene.options.items():
        what = own(name, owners)
        if what in CORNERS:
            low, high = (matrix @ scene.vector(name[:-5] + corner)[:n] + shift for corner in CORNERS)
            changed[name] = (np.minimum if what == "lower" else np.maximum)(low, high)
        elif name in ("box_lower", "box_upper"):
            low, high = (matrix @ scene.vector(f"box_{corner}")[:n] + shift for corner in CORNERS)
            changed[name] = (np.minimum if name == "box_lower" else np.maximum)(low, high)
        elif what in POINTS:
            changed[name] = matrix @ scene.vector(name)[:n] + shift
        elif what in DIRECTIONS and not FACE.match(name):
            if value in ("x", "y", "z"):
                value = plain(np.eye(3)["xyz".index(value)][:n])
            changed[name] = matrix @ np.array([float(v) for v in value.split(",")] + [0.0] * n)[:n]
            if what == "temperature_gradient":  # which body_temperature is at the origin
                start = name[:-len("_gradient")]
                changed[start] = scene.number(start) - changed[name] @ shift
        elif what in ROTATIONS and n == 2:
            changed[name] = [proper * scene.vector(name)[-1 if value.count(",") == 2 else 0]]
        elif what in ROTATIONS:
            if value in ("x", "y", "z"):
                value = plain(np.eye(3)["xyz".index(value)])
            changed[name] = proper * matrix @ [float(v) for v in value.split(",")]
        elif what == "strain_rate":
            rate = scene.vector(name)
            rate = np.diag(rate[:n]) if len(rate) == n else rate.reshape(n, n)
            changed[name] = (matrix @ rate @ matrix.T).ravel()
        elif what == "radii":
            changed[name] = abs(matrix @ scene.vector(name)[:n])
        elif what in ("motion_file", "velocity_file", "velocity_formula", "file"):
            raise Unfit(f"-{name}: the places of a file are not seen from elsewhere")
        elif what == "inertia" and value.count(","):
            changed[name] = abs(matrix @ scene.vector(name)[:n])
        elif what in ("wave_amplitude",) and not np.array_equal(matrix, np.eye(n)):
            raise Unfit(f"-{name}: a wave has its crest where x is least, its poles up")
        elif name == "central_force_rate" and shift.any():
            raise Unfit("-central_force_rate acts about the origin")
    faces = {}
    for d, letter in enumerate("xyz"[:n]):
        to = int(np.argmax(abs(matrix[:, d])))
        for k, end in enumerate(("min", "max")):
            other = ("min", "max")[k if matrix[to, d] > 0 else 1 - k]
            new = f"box_{'xyz'[to]}{other}"
            faces[new] = scene.face(letter, end)
            for name in [name for name in scene.options if name.startswith(f"box_{letter}{end}_")]:
                value, more = scene.options[name], name[len(f"box_{letter}{end}"):]
                if more == "_level":  # against gravity
                    down = matrix @ scene.vector("gravity")[:n]
                    value = plain(float(value) - down @ shift / np.linalg.norm(down))
                faces[new + more] = plain(matrix @ scene.vector(name)[:n]) if more == "_velocity" else value
    if scene.rings:
        faces.pop("box_xmin", None)
    kept = {name: value for name, value in scene.options.items() if not FACE.match(name)}
    return Scene(scene.name, {**kept, **faces}).copy(**changed)


def units():
    """{name of an option, without its body's: powers of length, time, mass}; words and pure numbers have none."""
    with open(os.path.join(ROOT, "options", "options.json"), encoding="utf-8") as file:
        rows = json.load(file)["options"]
    return {re.sub(r"^-(<\w+>_)?", "", row["name"]): powers_of(row["unit"] or "1") for row in rows}


def powers_of(unit):
    """Powers of length, time and mass of a unit like W/(m2 K)."""
    found = np.zeros(3, int)
    for sign, part in zip((1, -1), unit.split("/")):
        for letters, power in re.findall(r"([A-Za-z]+)(\d*)", part):
            found += sign * int(power or 1) * np.array(LETTERS[letters])
    return tuple(found)


def scaled(scene, length, time, mass):
    """The scene in units that are so many times smaller."""
    scene = scene.explicit()
    powers, owners, changed = units(), scene.owners(), {}
    for name, value in scene.options.items():
        what = name if name in powers else own(name, owners)
        if re.match(r"(viscous_)?(ksp|pc|mat)_", name):
            continue  # PETSc's: numbers without a unit
        if what not in powers:
            raise Unfit(f"-{name} is none of ours")
        if what in ("motion_file", "velocity_file", "velocity_formula", "file"):
            raise Unfit(f"-{name}: the numbers of a file stay in their units")
        if what in ("viscosity_model",) and value in ("power_law", "herschel_bulkley"):
            raise Unfit(f"-{name} {value}: its consistency has no power of two")
        a, b, c = powers[what]
        if what in PLANE and scene.dim == 2 and not scene.rings:
            a -= 1
        if (a, b, c) != (0, 0, 0):
            changed[name] = [float(v) * length**a * time**b * mass**c for v in value.split(",")]
    return scene.copy(**changed)
