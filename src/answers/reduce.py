#!/usr/bin/python3
"""The cheapest model that holds for a scene: rings if it is a body of revolution, a plane if it is uniform along an
axis, else a quarter or a half if it has mirrors; without tension, viscosity or gravity where they cannot matter.

    reduce.py SCENE.opts [> rings.opts]
    isph-reduce SCENE.opts

isph finds what holds (scene.json); this writes the reduced scene, complete and readable, to the output, and the reason
to standard error, or says what keeps the scene from being reduced, with exit code 3. A pool in a square box becomes a
round one of the same area. The figures of a half and a quarter are those of the whole, those of a plane are per metre.
For an answer each wanted column of the whole scene is carried back from the reduced one by its row of scene.json
(Way.carry), and a way that lacks one is not taken.
"""
import argparse
import math
import os
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "pictures"), os.path.join(HERE, "..", "python")]
from isph import launch, tables  # noqa: E402

LETTERS = "xyz"
NEVER = ("restart", "packing_cache")
BODY_LISTS = ("bodies", "solids", "fine", "interface_bodies")
SLACK = 1e-9  # relative, of numbers that went through an options file


def numbers(text):
    return [tables.number(word) for word in text.split(",")]


def joined(values):
    return ",".join(f"{value + 0:.9g}" for value in values)


class Scene:
    """A scene as the program knows it; options: those given, {name: option}."""

    def __init__(self, path, more=()):
        self.known = launch.known(path, *more)
        self.model, self.domain = self.known["model"], self.known["domain"]
        self.options = {option["name"].lstrip("-"): option for option in self.known["options"] if option["given"]}
        self.options.update({one["name"]: {"owner": "", "kind": "text", "value": one["value"]}
                             for one in self.known["petsc_options"]})
        for name in NEVER:
            if name in self.options:
                raise tables.Error(f"-{name} belongs to the scene as it is.")
        self.bodies = {body["name"]: body for key in ("bodies", "solids") for body in self.known[key]}
        gravity = self.known["forces"]["gravity"]
        self.up = next((d for d in reversed(range(len(gravity))) if gravity[d]), len(gravity) - 1)
        self.copies = int(float(self.options["gauge_multiplicity"]["value"])) if "gauge_multiplicity" in self.options \
            else 1
        self.folds = sum(mirror["used"] for mirror in self.model["mirrors"])
        self.columns = {row["name"]: row for row in self.known["columns"]}


class Way:
    """A way to reduce a scene: its lines, what it is, and how columns come back. to: {direction of the whole: of the
    reduced scene}; faces: those that the reduced scene has with the same meaning; gone: bodies that it lacks; factor:
    of sums; cheaper: about what the whole costs more."""

    def __init__(self, lines, why, to, faces, factor=1.0, gone=(), same=True, cheaper=1.0):
        self.lines, self.why, self.to, self.faces, self.factor, self.gone = lines, why, to, faces, factor, set(gone)
        self.same = same  # dimensions and directions are those of the whole
        self.cheaper = cheaper

    def carry(self, row):
        """(name of a column in the reduced scene, factor); None: the reduced scene has no such column."""
        whose, way = row["whose"], row["direction"]
        if row["of"] == "face" and whose not in self.faces or whose in self.gone or way and way not in self.to:
            return None
        if self.same:
            return row["name"], 1.0
        if row["counts"] == "run" or row["of"] in ("piece", "place", "particle"):
            return None
        other = {whose: self.faces.get(whose, whose), way: self.to.get(way, way)}
        return "_".join(other.get(word, word) for word in row["name"].split("_")), \
            self.factor if row["counts"] == "sum" else 1.0


def flat(scene, kept, along=None):
    """(option, value) of a scene with the components 'kept' of all vectors; cylinders along 'along' are circles."""
    for name, option in scene.options.items():
        owner, kind, value = option["owner"], option["kind"], option["value"]
        key = name[len(owner) + 1:] if owner else name
        round_one = owner in scene.bodies and scene.bodies[owner]["shape"]["type"] in ("cylinder", "thread")
        if kind == "file" and owner or kind == "numbers" and name != "gauge_axis" and (
                owner or name.startswith(("gauge_", "frame_"))):
            raise tables.Error(f"-{name}: what this means in a reduced scene is not known.")
        if name in ("dimension", "gauge_multiplicity") or name.startswith("box_") and kind != "point":
            continue
        if along is not None and round_one and key == "shape":
            value = "sphere"
        elif along is not None and round_one and key in ("axis", "height"):
            continue
        elif kind == "axis":
            value = "y"
        elif name == "gauge_neck":
            value = next((to for d, to in zip(kept, LETTERS) if LETTERS[d] == value), "none")
        elif kind in ("point", "direction", "normal") and value[:1] not in LETTERS:
            v = numbers(value)
            value = joined(v[d] if len(v) == 3 else 0 for d in kept)
        yield name, key, kind, value


def flat_faces(scene, kept):
    """The options of the faces that stay."""
    kinds = {face["name"]: face for face in scene.domain["faces"]}
    for d, letter in zip(kept, LETTERS):
        for end in ("min", "max"):
            owner, to = f"box_{LETTERS[d]}{end}", f"box_{letter}{end}"
            yield to, kinds[LETTERS[d] + end]["type"]
            for name, option in scene.options.items():
                if option["owner"] == owner:
                    vector, value = option["kind"] == "direction", option["value"]
                    yield to + name[len(owner):], joined(numbers(value)[k] for k in kept) if vector else value


def rings(scene, axis):
    """The scene as rings about an axis of the model."""
    up = LETTERS.index(axis["about"])
    across = [d for d in range(3) if d != up]
    half = scene.domain["upper"][across[0]] - axis["center"][across[0]]
    pool = any(body["shape"]["type"] == "box" for body in scene.bodies.values())
    if any(body["shape"]["type"] == "wave" for body in scene.bodies.values()):
        raise tables.Error("a wave is no body of revolution")
    radius = 2 * half / math.sqrt(math.pi) if pool else half
    lines = [("dimension", "axisymmetric")]
    for name, key, kind, value in flat(scene, (across[0], up)):
        if kind in ("point", "direction", "normal") and key != "radii":
            value = f"{radius if key in ('upper', 'box_upper') else 0:.9g},{value.split(',')[1]}"
        lines.append((name, "0" if name == "gauge_axis" else value))
    lines += [(k, "wall" if v == "periodic" and k == "box_xmax" else v) for k, v in flat_faces(scene, (across[0], up))
              if not k.startswith("box_xmin")]
    why = "a body of revolution: rings"
    if pool:
        why += f"; the pool, {2 * half:.4g} m square, is round, {radius:.4g} m in radius, with the same area"
    faces = {LETTERS[up] + end: "y" + end for end in ("min", "max")}
    return Way(lines, why, {LETTERS[up]: "y"}, faces, scene.copies / 2**scene.folds, same=False,
               cheaper=1 / max(axis["particles"], 1e-6))


def plane(scene, letter):
    """The scene in two dimensions."""
    d = LETTERS.index(letter)
    kept = tuple(k for k in range(3) if k not in (d, scene.up)) + (scene.up,)
    lines = [("dimension", "2")] + [(name, value) for name, _, _, value in flat(scene, kept, d)]
    lines += flat_faces(scene, kept)
    depth = scene.domain["upper"][d] - scene.domain["lower"][d]
    to = {LETTERS[k]: new for k, new in zip(kept, LETTERS)}
    faces = {old + end: new + end for old, new in to.items() for end in ("min", "max")}
    return Way(lines, f"uniform along {letter}: a plane; forces, energies and volumes are per metre of {letter}", to,
               faces, depth * scene.copies, same=False, cheaper=depth / scene.domain["spacing"])


def mirrored(scene, mirrors):
    """A half or a quarter."""
    lower, upper = list(scene.domain["lower"]), scene.domain["upper"]
    planes, gone = [mirror["across"] for mirror in mirrors], {b for mirror in mirrors for b in mirror["gone"]}
    for letter in planes:
        lower[LETTERS.index(letter)] = 0.5 * (lower[LETTERS.index(letter)] + upper[LETTERS.index(letter)])
    gone |= {hole["name"] for body in scene.bodies.values() for hole in body.get("holes", ())
             if any(hole["upper"][LETTERS.index(letter)] <= lower[LETTERS.index(letter)] for letter in planes)}
    lines, kinds = [], {face["name"]: face["type"] for face in scene.domain["faces"]}
    for name, option in scene.options.items():
        value, listed = option["value"], name in BODY_LISTS or name.endswith("_holes")
        if option["owner"] in gone or name in ("gauge_multiplicity", *(f"box_{letter}" for letter in planes)):
            continue
        if listed:
            value = ",".join(body for body in value.split(",") if body not in gone)
        if value or not listed:
            lines.append((name, joined(lower) if name == "box_lower" else value))
    for letter in planes:
        other = kinds[letter + "max"]
        lines += [(f"box_{letter}min", "symmetry"), (f"box_{letter}max", "symmetry" if other == "periodic" else other)]
    lines.append(("gauge_multiplicity", str(2**len(planes) * scene.copies)))
    lines += kept_numbers(scene, lines, gone)
    why = f"mirror plane{'s' if len(planes) > 1 else ''} across {' and '.join(planes)}: a " + (
        "quarter" if len(planes) > 1 else "half") + (f"; {', '.join(sorted(gone))} mirrored" if gone else "")
    faces = {name: name for name in kinds if name not in [letter + "min" for letter in planes]}
    return Way(lines, why, {letter: letter for letter in LETTERS}, faces, gone=gone, cheaper=2**len(planes))


def kept_numbers(scene, lines, gone):
    """Numbers of bodies that a smaller box would change, since their defaults are those of the box."""
    half = {body["name"]: body for key in ("bodies", "solids") for body in known_of(lines)[key]}
    for name, body in scene.bodies.items():
        for part in ("shape", "velocity_field"):
            old, new = (one[name].get(part, {}).get("numbers", {}) for one in (scene.bodies, half)) \
                if name not in gone else ({}, {})
            for key, value in old.items():
                if value != new.get(key) and isinstance(value, (float, int, list)) and f"{name}_{key}" not in dict(
                        lines):
                    yield f"{name}_{key}", joined(value if isinstance(value, list) else [value])


def without(scene, way, rows):
    """Removes tension, viscosity or gravity that cannot matter, for the scene and for the wanted columns."""
    lines = dict(way.lines)
    bodies = lines.get("bodies", "").split(",")
    for force in scene.model["forces"]:
        what = force["name"]
        needed = next((row["name"] for row in rows if what in row["needs"]), None)
        if not force["vain"] or needed or what == "tension" and "interface_tension" in lines:  # keeps liquids apart
            continue
        ends = {"gravity": (), "viscosity": ("_viscosity",), "tension": (
            "_tension", "_contact_angle", "_contact_hysteresis")}[what]
        lines = {k: v for k, v in lines.items() if not k.endswith(ends or "gravity") and not (
            what == "tension" and k.startswith(("tension_", "wall_contact_")))}
        lines.update({"gravity": ",".join("0" for _ in scene.domain["lower"] if scene)} if what == "gravity" else
                     {f"{body}_{what}": "0" for body in bodies})
        if what == "gravity" and lines.get("dimension") in ("2", "axisymmetric"):
            lines["gravity"] = "0,0"
        way.why += f"; no {what}, since {force['why']}"
    way.lines = list(lines.items())
    return way


def known_of(lines):
    """What the program knows about a scene of these lines; it must take them."""
    with tempfile.NamedTemporaryFile("w", suffix=".opts") as file:
        file.write(as_text(lines))
        file.flush()
        return launch.known.__wrapped__(file.name)


def ways(path, more=(), columns=()):
    """The ways to reduce a scene, the cheapest first, as pairs (Way, ""), or (None, why not). more: further options
    under which the model must hold; columns: names of those that must come back."""
    scene = Scene(path)
    model = scene.model = Scene(path, more).model if more else scene.model
    rows = [scene.columns[name] for name in columns if name in scene.columns]
    holds = {key: [one for one in model[key] if one["holds"]] for key in ("revolution", "mirrors", "uniform")}
    mirrors = [m for m in holds["mirrors"]
               if LETTERS.index(m["across"]) != scene.up or scene.up == 2 and not holds["revolution"]]
    makers = [lambda axis=axis: rings(scene, axis) for axis in holds["revolution"]]
    makers += [lambda one=one: plane(scene, one["along"]) for one in holds["uniform"]
               if LETTERS.index(one["along"]) != scene.up][:1]
    makers += [lambda: mirrored(scene, mirrors[:2])] if mirrors else []
    makers += [lambda one=one: mirrored(scene, [one]) for one in mirrors if len(mirrors) > 1]
    letters = {letter: letter for letter in LETTERS}
    makers += [lambda: Way([(name, option["value"]) for name, option in scene.options.items()], "the scene as it is",
                           letters, {face["name"]: face["name"] for face in scene.domain["faces"]})
               ] if any(force["vain"] for force in model["forces"]) else []
    if model["not_looked_for"]:
        yield None, f"no symmetry: none is looked for with {model['not_looked_for']}"
    for one in [] if holds["revolution"] else model["revolution"][-1:]:
        yield None, f"no rings: {one['why']}"
    for make in makers:
        try:
            way = without(scene, make(), rows)
            if way.why == "the scene as it is":
                continue
            found = {row["name"] for row in known_of(way.lines)["columns"]}
            for row in rows:
                back = way.carry(row)
                if not back or back[0] not in found:
                    raise tables.Error(f"{way.why.partition(';')[0]}: it has no {row['name']} of the whole scene")
            yield way, ""
        except tables.Error as error:
            yield None, str(error)
    for mirror in model["mirrors"]:
        if mirror["why"] or mirror["used"]:
            yield None, f"no mirror across {mirror['across']}: {mirror['why']}" if mirror["why"] else \
                f"the mirror across {mirror['across']} is used already"


def reduced(path, more=(), columns=()):
    """The first Way that the program takes; raises Error if there is none."""
    notes = []
    for way, note in ways(path, more, columns):
        if way:
            way.why += f" ({'; '.join(notes)})" if notes else ""
            return way
        notes.append(note)
    raise tables.Error(f"the scene cannot be reduced: {'; '.join(notes)}.")


def as_text(lines):
    return "".join(f"-{k} {v}".rstrip() + "\n" for k, v in lines)


def text(path, way):
    """The reduced scene as an options file."""
    return f"# {os.path.basename(path)}, reduced: {way.why}.\n{as_text(way.lines)}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("scene", metavar="SCENE.opts")
    arguments = parser.parse_args()
    try:
        way = reduced(arguments.scene)
    except tables.Error as error:
        print(f"reduce.py: {error}", file=sys.stderr)
        sys.exit(3)
    print(text(arguments.scene, way), end="")
    print(f"reduce.py: {way.why}", file=sys.stderr)


if __name__ == "__main__":
    with tables.polite("reduce.py"):
        main()
