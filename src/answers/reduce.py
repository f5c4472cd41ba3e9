#!/usr/bin/python3
"""The cheapest model that holds for a scene: rings if it is a body of revolution, a plane if it is uniform along an
axis, else a quarter or a half if it has mirrors; without tension, viscosity or gravity where they cannot matter.

    reduce.py SCENE.opts [> rings.opts]
    isph-reduce SCENE.opts

isph finds what holds (-scene_model); this writes the reduced scene, complete and readable, to the output, and the
reason to standard error, or says what keeps the scene from being reduced, with exit code 3. The figures of a half and a
quarter are those of the whole: their forces, energies and volumes are multiplied (-gauge_multiplicity). A pool in a
square box becomes a round one of the same area. Figures of a plane are per metre.
"""
import argparse
import math
import os
import re
import shlex
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "pictures")]
import launch  # noqa: E402
import tables  # noqa: E402

SHAPES = {"sphere", "box", "cylinder", "ellipsoid", "half_space", "thread"}  # that rings or a plane can have
# options of a body that are numbers or words, the same in any dimension, and those that are vectors
PLAIN = {"shape", "type", "density", "viscosity", "tension", "viscosity_model", "viscosity_exponent", "viscosity_time",
         "viscosity_infinite", "yield_stress", "radius", "height", "axis", "contact_angle", "contact_hysteresis",
         "nozzle", "modulation", "modulation_frequency", "start", "count", "interval", "wave_amplitude", "wave_mode",
         "wave_length", "oscillation_frequency", "oscillation_phase"}
VECTORS = {"center", "velocity", "lower", "upper", "radii", "point", "normal", "oscillation_amplitude"}
SCENE_VECTORS = {"box_lower", "box_upper", "gravity", "gravity_amplitude"}
# options of the whole scene that depend on places or directions and are not known here
PLACED = ("frame_", "shaking_", "gauge_points", "gauge_heights", "gauge_lines", "gauge_film", "snapshot_lower",
          "snapshot_upper")
NEVER = ("restart", "packing_cache")


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


class Model:
    """What holds for a scene, as isph says."""

    def __init__(self, path, more=()):
        done = subprocess.run(launch.command(path, [*more, "-scene_model"]), capture_output=True, text=True)
        if done.returncode:
            raise tables.RunError(done.stderr.strip().replace("isph: error: ", ""))
        self.axis, self.center, self.why = None, {}, ""
        self.mirrors, self.folded, self.uniform, self.vain, self.against = {}, set(), [], [], []
        for line in done.stdout.splitlines():
            what, _, says = line.strip().partition(": ")
            letter = what[-1:]
            yes = says.startswith("yes")
            if what.startswith("revolution"):
                self.why = says[4:]
                self.axis = letter if yes else None
                self.center = {d: float(v) for d, v in re.findall(r"([xyz]) = ([^, ]+)", says)}
            elif what.startswith("mirror"):
                if yes:
                    self.mirrors[letter] = says.partition("without ")[2].split(",") if "without" in says else []
                elif "already" in says:
                    self.folded.add(letter)
                else:
                    self.against.append(f"no mirror across {letter}: {says[4:]}")
            elif what.startswith("uniform"):
                self.uniform.append(letter)
            elif "cannot matter" in says:
                self.vain.append((what, says.partition(": ")[2]))
            elif what == "symmetry":
                self.why = says


class Scene:
    """The options of a scene, and what its bodies are made of."""

    def __init__(self, path, model):
        self.options, self.model = read(path), model
        self.bodies = [name for key in ("bodies", "solids") for name in self.options.get(key, "").split(",") if name]
        for name in self.options:
            if name in NEVER:
                raise tables.RunError(f"-{name} belongs to the scene as it is.")
        gravity = tables.vector(self.options, "gravity") or [0, 0, 0]
        self.up = next((d for d in range(2, -1, -1) if d < len(gravity) and gravity[d]), 2)

    def owner(self, key):
        """The body to which an option belongs, and the option's name without it."""
        body = next((b for b in sorted(self.bodies, key=len, reverse=True) if key.startswith(b + "_")), None)
        return body, key[len(body) + 1:] if body else key

    def check_plain(self):
        """Refuses what rings and planes cannot have, or what is not known here."""
        for key in self.options:
            body, name = self.owner(key)
            if body and name not in PLAIN | VECTORS or not body and name.startswith(PLACED):
                raise tables.RunError(f"-{key}: what this means in a reduced scene is not known.")
            if name == "shape" and self.options[key] not in SHAPES:
                raise tables.RunError(f"-{key} {self.options[key]}: only {', '.join(sorted(SHAPES))} can be reduced.")

    def face(self, d, side):
        o = self.options
        letter = "xyz"[d]
        return o.get(f"box_{letter}{('min', 'max')[side]}", o.get(f"box_{letter}", o.get("box_faces", "open")))

    def flat(self, kept, along=None):
        """The lines of the scene with the components 'kept' of all vectors; cylinders along 'along' are circles."""
        for key, value in self.options.items():
            body, name = self.owner(key)
            if key == "dimension" or key.startswith("box_") and key not in SCENE_VECTORS or key == "gauge_multiplicity":
                continue
            if body and name == "shape" and value in ("cylinder", "thread") and along is not None:
                value = "sphere"
            elif body and name in ("axis", "height") and along is not None:
                continue
            elif body and name == "axis":
                value = "y"
            elif key == "gauge_neck":
                value = next((to for d, to in zip(kept, "xy") if "xyz"[d] == value), "none")
            elif body and name in VECTORS or key in SCENE_VECTORS:
                v = tables.vector({"v": value}, "v")
                value = ",".join(f"{v[d] if len(v) == 3 else 0:.9g}" for d in kept)
            yield key, name, body, value

    def faces(self, kept, lines):
        for d, letter in zip(kept, "xy"):
            for side, end in enumerate(("min", "max")):
                for kind in ("", "_contact_angle", "_velocity"):
                    value = self.options.get(f"box_{'xyz'[d]}{end}{kind}") if kind else self.face(d, side)
                    if kind == "_velocity" and value:
                        value = ",".join(f"{tables.vector({'v': value}, 'v')[k]:.9g}" for k in kept)
                    if value and value != "open":
                        lines.append((f"box_{letter}{end}{kind}", value))


def rings(scene):
    """The lines of the scene as rings."""
    scene.check_plain()
    up = "xyz".index(scene.model.axis)
    across = [d for d in range(3) if d != up]
    half = tables.vector(scene.options, "box_upper")[across[0]] - scene.model.center["xyz"[across[0]]]
    pool = any(scene.options.get(f"{b}_shape", "box") == "box" for b in scene.bodies)
    radius = 2 * half / math.sqrt(math.pi) if pool else half
    lines = [("dimension", "axisymmetric")]
    for key, name, body, value in scene.flat((across[0], up)):
        if name in VECTORS | SCENE_VECTORS and name != "radii":
            first = {"upper": radius, "box_upper": radius}.get(name, 0)
            value = f"{first:.9g},{value.split(',')[1]}"
        lines.append((key, "0" if key == "gauge_axis" else value))
    kinds = []
    scene.faces((across[0], up), kinds)
    lines += [(k, "wall" if v == "periodic" and k == "box_xmax" else v) for k, v in kinds
              if not k.startswith("box_xmin")]
    why = "a body of revolution: rings"
    if pool:
        why += f"; the pool, {2 * half:.4g} m square, is round, {radius:.4g} m in radius, with the same area"
    return lines, why


def plane(scene, along):
    """The lines of the scene in two dimensions."""
    scene.check_plain()
    d = "xyz".index(along)
    kept = tuple(k for k in range(3) if k not in (d, scene.up)) + (scene.up,)
    lines = [("dimension", "2")] + [(key, value) for key, _, _, value in scene.flat(kept, d)]
    scene.faces(kept, lines)
    return lines, f"uniform along {along}: a plane; forces, energies and volumes are per metre of {along}"


def mirrored(scene, planes):
    """The lines of a half or a quarter."""
    lower, upper = (list(tables.vector(scene.options, name)) for name in ("box_lower", "box_upper"))
    gone = {b for letter in planes for b in scene.model.mirrors[letter]}
    numbers = ["xyz".index(letter) for letter in planes]
    for d in numbers:
        lower[d] = 0.5 * (lower[d] + upper[d])
    lines = []
    for key, value in scene.options.items():
        if scene.owner(key)[0] in gone or key in ("gauge_multiplicity", *(f"box_{letter}" for letter in planes)):
            continue
        if key in ("bodies", "solids", "interface_bodies"):
            value = ",".join(b for b in value.split(",") if b not in gone)
        lines.append((key, ",".join(f"{v:.9g}" for v in lower) if key == "box_lower" else value))
    for letter, d in zip(planes, numbers):
        other = scene.face(d, 1)
        lines += [(f"box_{letter}min", "symmetry"), (f"box_{letter}max", "symmetry" if other == "periodic" else other)]
    lines = [(k, v) for k, v in lines if v or k not in ("bodies", "solids")]
    lines.append(("gauge_multiplicity", str(2**len(planes) * int(scene.options.get("gauge_multiplicity", 1)))))
    several = len(planes) > 1
    return lines, (f"mirror plane{'s' if several else ''} across {' and '.join(planes)}: a "
                   f"{'quarter' if several else 'half'}{'; ' + ', '.join(sorted(gone)) + ' mirrored' if gone else ''}")


def without(scene, lines, why):
    """Removes tension, viscosity or gravity that cannot matter, with the options that nothing reads then."""
    zero, bodies = dict(lines).get("gravity", "0"), dict(lines).get("bodies", "").split(",")
    for what, reason in scene.model.vain:
        if what == "tension" and "interface_tension" in scene.options:  # it also keeps the liquids apart
            continue
        vain = re.compile({"gravity": "gravity$", "viscosity": f"(({'|'.join(bodies)})_)?viscosity",
                           "tension": f"({'|'.join(bodies)})_tension$|tension_|wall_contact_|\\w+_contact_(angle|hyst)"}
                          [what])
        lines = [(k, v) for k, v in lines if not vain.match(k)]
        lines += [("gravity", ",".join("0" for _ in zero.split(",")))] if what == "gravity" else \
            [(f"{b}_{what}", "0") for b in bodies]
        why += f"; no {what}, since {reason}"
    return lines, why


def reduced(path, more=()):
    """([(option, value), ...], the reason in words) of the cheapest model; raises RunError if there is none. more:
    further options under which it must hold."""
    model = Model(path, more)
    scene = Scene(path, model)
    planes = [letter for letter in model.mirrors if "xyz".index(letter) != scene.up or scene.up == 2 and not model.axis]
    uniform = [letter for letter in model.uniform if "xyz".index(letter) != scene.up]
    ways = [lambda: rings(scene)] if model.axis else []
    ways += [lambda: plane(scene, uniform[0])] if uniform else []
    ways += [lambda: mirrored(scene, planes[:2])] if planes else []
    ways += [lambda one=one: mirrored(scene, [one]) for one in planes if len(planes) > 1]
    ways += [lambda: (list(scene.options.items()), "the scene as it is")] if model.vain else []
    notes = [f"no rings: {model.why}"] if model.why and not model.axis else []
    for way in ways:
        try:
            lines, why = without(scene, *way())
            with tempfile.NamedTemporaryFile("w", suffix=".opts") as file:  # isph must take it
                file.write(as_text(lines))
                file.flush()
                Model(file.name)
            return lines, why + (f" ({'; '.join(notes)})" if notes else "")
        except tables.RunError as error:
            notes.append(str(error))
    notes += model.against + [f"the mirror across {letter} is used already" for letter in sorted(model.folded)]
    raise tables.RunError(f"the scene cannot be reduced: {'; '.join(notes)}.")


def as_text(lines):
    return "".join(f"-{k} {v}".rstrip() + "\n" for k, v in lines)


def text(path, more=()):
    """The reduced scene as an options file, and the reason."""
    lines, why = reduced(path, more)
    return f"# {os.path.basename(path)}, reduced: {why}.\n{as_text(lines)}", why


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
