#!/usr/bin/python3
"""The cheapest model that holds for a scene in three dimensions: rings if it is a body of revolution, else a quarter or
a half if it has mirror planes.

    reduce.py SCENE.opts [> rings.opts]
    isph-reduce SCENE.opts

Writes the reduced scene, complete and readable, to the output, and the reason to standard error; or says what keeps the
scene from being reduced, with exit code 3. The figures of a half and a quarter are those of the whole: their forces,
energies and volumes are multiplied (-gauge_multiplicity). A pool in a square box becomes a round one of the same area.
"""
import argparse
import math
import os
import shlex
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "pictures")]
import tables  # noqa: E402

NEAR = 1e-9  # of the box's width, for places that should be equal
SHAPES = ("sphere", "box", "cylinder", "ellipsoid")
# options of a body that are numbers or words, the same in any dimension
PLAIN = {"shape", "type", "density", "viscosity", "tension", "viscosity_model", "viscosity_exponent", "viscosity_time",
         "viscosity_infinite", "yield_stress", "radius", "height", "axis", "contact_angle", "contact_hysteresis",
         "nozzle", "modulation", "modulation_frequency", "start", "count", "interval"}
VECTORS = {"center", "velocity", "lower", "upper", "radii"}
SCENE_VECTORS = {"box_lower", "box_upper", "gravity"}
# options of the whole scene that depend on places or directions and are not known here
PLACED = ("frame_", "shaking_", "central_force", "gauge_points", "gauge_heights", "snapshot_lower", "snapshot_upper",
          "packing_cache", "restart", "interface_bodies")


def read(path, depth=0):
    """The options of a file and of those that it names, {name: value} in their order; the last of equal ones counts."""
    options = {}
    if depth > 9:
        raise tables.RunError(f"{path}: its -options_file go round in a circle.")
    try:
        with open(path, encoding="utf-8") as file:
            lines = file.readlines()
    except OSError as error:
        raise tables.RunError(f"{path}: {error.strerror}.") from error
    for line in lines:
        words = shlex.split(line, comments=True)
        k = 0
        while k < len(words):
            name = words[k].lstrip("-")
            value = words[k + 1] if k + 1 < len(words) and not is_name(words[k + 1]) else ""
            k += 2 if value else 1
            if name == "options_file":
                options.update(read(value, depth + 1))
            else:
                options.pop(name, None)
                options[name] = value
    return options


def is_name(word):
    return word.startswith("-") and word[1:2].isalpha()


class Scene:
    """A scene in three dimensions. Raises RunError with what keeps it from being reduced."""

    def __init__(self, options):
        self.options = options
        if options.get("dimension", "3") != "3":
            raise tables.RunError(f"the scene has -dimension {options['dimension']}; only three can be reduced.")
        self.lower, self.upper = self.vector("box_lower"), self.vector("box_upper")
        self.bodies = [name for key in ("bodies", "solids") for name in options.get(key, "").split(",") if name]
        gravity = self.vector("gravity", [0, 0, 0])
        along = [d for d in range(3) if gravity[d]]
        self.up = along[0] if len(along) == 1 else 2
        self.tilted = len(along) > 1
        self.folded = [self.is_folded(d) for d in range(3)]
        self.lower = [2 * low - high if fold else low for low, high, fold in zip(self.lower, self.upper, self.folded)]
        self.width = max(u - v for u, v in zip(self.upper, self.lower))
        for name in options:
            if any(name.startswith(word) for word in PLACED):
                raise tables.RunError(f"-{name} depends on a place or a direction that a reduced scene may not have.")

    def is_folded(self, d):
        """Whether the lower face across d is a mirror through the middle of all bodies: the scene is a half already."""
        if self.face(d, 0) != "symmetry":
            return False
        for body in self.bodies:
            p = self.parts(body)
            if p.get("shape", "box") == "box":
                if "lower" in p and tables.vector({"v": p["lower"]}, "v")[d] > self.lower[d]:
                    return False
            elif tables.vector({"v": p.get("center", "0,0,0")}, "v")[d] != self.lower[d]:
                return False
        return True

    def vector(self, name, default=None):
        numbers = tables.vector(self.options, name) or default
        if not numbers or not all(map(math.isfinite, numbers)):
            raise tables.RunError(f"-{name} is needed, as numbers separated by commas.")
        if len(numbers) == 1:  # along x, or as the program reads one number
            raise tables.RunError(f"-{name} has one number; three are wanted.")
        return numbers

    def of(self, body, name, default=""):
        return self.options.get(f"{body}_{name}", default)

    def parts(self, body):
        """The options of a body; refuses those that are not known here."""
        found = {}
        for key, value in self.options.items():
            if key.startswith(body + "_") and key not in (f"{b}_{n}" for b in self.bodies if len(b) > len(body)
                                                          for n in PLAIN | VECTORS):
                name = key[len(body) + 1:]
                if name not in PLAIN | VECTORS:
                    raise tables.RunError(f"-{key}: what this means in a reduced scene is not known.")
                found[name] = value
        shape = found.get("shape", "box")
        if shape not in SHAPES:
            raise tables.RunError(f"-{body}_shape {shape}: only {', '.join(SHAPES)} can be reduced.")
        return found

    def middle(self, d):
        return 0.5 * (self.lower[d] + self.upper[d])

    def same(self, a, b):
        return abs(a - b) <= NEAR * self.width

    def face(self, d, side):
        o = self.options
        letter = "xyz"[d]
        return o.get(f"box_{letter}{('min', 'max')[side]}", o.get(f"box_{letter}", o.get("box_faces", "open")))

    def extent(self, body, d):
        """Where a body begins and ends along d."""
        p = self.parts(body)
        shape = p.get("shape", "box")
        if shape == "box":
            high = tables.vector({"v": p["upper"]}, "v")[d] if "upper" in p else self.upper[d]
            if self.folded[d]:
                return 2 * self.middle(d) - high, high
            return tables.vector({"v": p["lower"]}, "v")[d] if "lower" in p else self.lower[d], high
        at = tables.vector({"v": p.get("center", "0,0,0")}, "v")[d]
        if shape == "ellipsoid":
            half = tables.vector({"v": p["radii"]}, "v")[d]
        elif shape == "cylinder" and "xyz".index(p.get("axis", "z")) == d:
            half = 0.5 * float(p.get("height", "inf"))
        else:
            half = float(p["radius"])
        return at - half, at + half

    def mirror(self, d):
        """Why the middle plane across d is no mirror; empty: it is."""
        if self.face(d, 0) != self.face(d, 1) and not self.folded[d]:
            return f"the faces {'xyz'[d]}min and {'xyz'[d]}max differ"
        if self.vector("gravity", [0, 0, 0])[d]:
            return "gravity has a component across it"
        for body in self.bodies:
            low, high = self.extent(body, d)
            if not self.same(low + high, 2 * self.middle(d)) and math.isfinite(low + high):
                return f"{body} is not in its middle"
            velocity = tables.vector({"v": self.of(body, "velocity", "0,0,0")}, "v")
            if len(velocity) == 3 and velocity[d]:
                return f"{body} moves across it"
        return ""

    def revolution(self):
        """Why the scene is no body of revolution about the vertical through the middle of the box; empty: it is."""
        across = [d for d in range(3) if d != self.up]
        for d in across:
            if self.mirror(d):
                return self.mirror(d)
        if self.tilted or self.face(across[0], 1) != self.face(across[1], 1):
            return "the vertical faces differ, or gravity is not along an axis"
        if not self.same(self.upper[across[0]] - self.lower[across[0]], self.upper[across[1]] - self.lower[across[1]]):
            return "the box is not square"
        for body in self.bodies:
            p = self.parts(body)
            shape = p.get("shape", "box")
            ends = [self.extent(body, d) for d in across]
            if shape == "box" and not all(self.same(e[0], self.lower[d]) and self.same(e[1], self.upper[d])
                                          for e, d in zip(ends, across)):
                return f"{body} is a box that does not fill the width of the scene"
            if shape == "cylinder" and "xyz".index(p.get("axis", "z")) != self.up:
                return f"{body} is a cylinder across the vertical"
            if shape == "ellipsoid" and not self.same(ends[0][1] - ends[0][0], ends[1][1] - ends[1][0]):
                return f"{body} is an ellipsoid of three axes"
        return ""


def rings(scene):
    """The lines of the scene as rings."""
    up, across = scene.up, [d for d in range(3) if d != scene.up]
    width = scene.upper[across[0]] - scene.lower[across[0]]
    face = scene.face(across[0], 1)
    pool = any(scene.parts(b).get("shape", "box") == "box" for b in scene.bodies)
    radius = width / math.sqrt(math.pi) if pool else 0.5 * width

    def pair(name, value):
        v = tables.vector({"v": value}, "v")
        r = {"box_upper": radius, "box_lower": 0.0}.get(name, 0.0)
        return f"{r:.9g},{v[up]:.9g}"

    lines = [("dimension", "axisymmetric")]
    for key, value in scene.options.items():
        body = next((b for b in sorted(scene.bodies, key=len, reverse=True) if key.startswith(b + "_")), None)
        name = key[len(body) + 1:] if body else key
        if key == "dimension" or key.startswith("box_") and key not in SCENE_VECTORS:
            continue
        if body and name in ("lower", "upper"):
            lines.append((key, f"{0 if name == 'lower' else radius:.9g},{tables.vector({'v': value}, 'v')[up]:.9g}"))
        elif body and name == "radii":
            v = tables.vector({"v": value}, "v")
            lines.append((key, f"{v[across[0]]:.9g},{v[up]:.9g}"))
        elif body and name == "axis":
            lines.append((key, "y"))
        elif body and name in VECTORS or key in SCENE_VECTORS:
            lines.append((key, pair(name, value)))
        elif key == "gauge_axis":
            lines.append((key, "0"))
        elif key != "gauge_multiplicity":
            lines.append((key, value))
    if face != "open":
        lines.append(("box_xmax", "wall" if face == "periodic" else face))
    lines += [(f"box_y{end}", scene.face(up, side)) for side, end in enumerate(("min", "max"))
              if scene.face(up, side) != "open"]
    why = "a body of revolution: rings"
    if pool:
        why += f"; the pool, {width:.4g} m square, is round, {radius:.4g} m in radius, with the same area"
    return lines, why


def mirrored(scene, planes):
    """The lines of a half or a quarter."""
    lower = list(scene.lower)
    lines = []
    for d in planes:
        lower[d] = scene.middle(d)
    for key, value in scene.options.items():
        if key == "box_lower":
            value = ",".join(f"{v:.9g}" for v in lower)
        elif key == "gauge_multiplicity":
            continue
        lines.append((key, value))
    for d in planes:
        other = scene.face(d, 1)
        lines += [(f"box_{'xyz'[d]}min", "symmetry"),
                  (f"box_{'xyz'[d]}max", "symmetry" if other == "periodic" else other)]
    lines.append(("gauge_multiplicity", str(2**len(planes) * int(scene.options.get("gauge_multiplicity", 1)))))
    lines = [(k, v) for k, v in lines if k not in [f"box_{'xyz'[d]}" for d in planes]]
    names = " and ".join("xyz"[d] for d in planes)
    several = len(planes) > 1
    return lines, f"mirror plane{'s' if several else ''} across {names}: a {'quarter' if several else 'half'}"


def reduced(path):
    """([(option, value), ...], the reason in words) of the cheapest model; raises RunError if there is none."""
    scene = Scene(read(path))
    why = scene.revolution()
    if not why:
        return rings(scene)
    planes = [d for d in range(3) if d != scene.up and not scene.mirror(d) and not scene.folded[d]]
    if any(scene.folded) and not planes:
        raise tables.RunError(f"the scene has its mirrors already, and is no body of revolution, since {why}.")
    if not planes:
        raise tables.RunError(f"the scene cannot be reduced: it is no body of revolution, since {why}; across x: "
                              f"{scene.mirror(0)}; across {'y' if scene.up != 1 else 'z'}: "
                              f"{scene.mirror(1 if scene.up != 1 else 2)}.")
    lines, words = mirrored(scene, planes)
    return lines, f"{words} (no rings: {why})"


def text(path):
    """The reduced scene as an options file, and the reason."""
    lines, why = reduced(path)
    options = "".join(f"-{k} {v}".rstrip() + "\n" for k, v in lines)
    return f"# {os.path.basename(path)}, reduced: {why}.\n{options}", why


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("scene", metavar="SCENE.opts")
    arguments = parser.parse_args()
    try:
        out, why = text(arguments.scene)
    except tables.RunError as error:
        print(f"reduce.py: {error}", file=sys.stderr)
        sys.exit(3)
    print(out, end="")
    print(f"reduce.py: {why}", file=sys.stderr)


if __name__ == "__main__":
    with tables.polite("reduce.py"):
        main()
