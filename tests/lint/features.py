#!/usr/bin/python3
"""Where the features of the program are named: lines, files and folders of src/ (.c and .h, without comments and texts)
with a name of the feature, inside and outside of its home. A feature that is one folder and one record is named outside
in the list of edges and at most one header; how far the others are from that is the table that --print shows (make
lint). The number of folders outside may not become larger. The core names no edge at all: an edge of a step is a record
that src/stepper/hooks.c lists; others look at the core from above. LINT_ROOT: another tree, for figures before a
change."""
import glob
import os
import re
import sys

import verdict

ROOT = os.environ.get("LINT_ROOT", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
# name: where it is at home (a folder, or files until it has one), its names, folders outside at most
FEATURES = {
    "free bodies": (("bodies/", "scene/free.c", "gauges/bodies.c"),
                    r"Free(?!Surface)[A-Z]\w*|SceneHasFree|BodyMass|Coupling[A-Z]\w*|GaugeBodies", 4),
    "solids that move": (("bodies/", "scene/motion.c", "scene/rotation.c"),
                         r"SceneSolidsMove|SceneMoveSolids|SolidsMove|BodyMov\w+|BodyMotion|MovingEdge|SceneDriven", 7),
    "emitters": (("stepper/emitters.c", "packing/emit.c", "scene/emitter.c"),
                 r"SceneEmits|BodyEmi\w+|BodyHolds|PackingEmit\w*|SimEmit|Emitter\w*|emitter|inflow_energy", 7),
    "resampling": (("resampling/",), r"Resampl\w+|TargetF\w+|TargetIs\w+", 2),
    "following": (("resampling/target.c", "resampling/walls.c", "resampling/smooth.c", "scene/spacing.c"),
                  r"domain->follow|Follow[A-Z]\w*|SceneTarget\w*|ResampleWalls", 8),
    "graded spacing": (("scene/spacing.c", "packing/graded.c", "neighbors/levels.c"),
                       r"graded|Graded\w*|spacing_coarse|size_most|growth", 13),
    "rings": (("domain/",), r"rings|Ring[A-Z]\w*|\w+Ring[A-Z]\w*|RING_\w+", 14),
    "contact lines": (("tension/contact.c", "tension/contact_solid.c", "tension/hysteresis.c", "tension/moving_line.c",
                       "stepper/contact_line.c", "gauges/spread.c"),
                      r"\w*Contact[A-Z]\w*|contact_\w+|\w*Hysteresis\w*|\w*FastestLine|fastest_line|LARGEST_LINE"
                      r"|TensionMoveLines|TensionHasLaw|\w*MovingLine\w*", 5),
    "interface": (("tension/interface.c", "pressure/interface.c", "scene/liquids.c"),
                  r"Interface[A-Z]\w*|\w+Interface|interface_\w+|SUM_LIQUIDS\w*|LIQUID_SUMS", 5),
}
CORE = ("base", "domain", "kernel", "particles", "neighbors", "operators", "pressure", "twolevel", "solver", "storage",
        "stepper")
EDGES = (r"SceneHasFree|Free[A-Z]\w*|Coupling[A-Z]\w*|SceneEmits|BodyEmi\w+|BodyHolds|Resampl\w+|Gauges?[A-Z]\w*"
         r"|Spectrum\w*|TensionApplyHysteresis|TensionMoveLines|TensionHasLaw|[A-Z]\w+Edge")
LIST = "stepper/hooks.c"
KNOWN = ("pressure/source.c", "stepper/trial.c", "stepper/time_step.c")  # that do: of liquid that emitters hold
RECORD = re.compile(r"^const Edge \w+ = ", re.M)  # the file of an edge has it
SKIP = re.compile(r'/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.S)


def blank(found):
    return "\n" * found.group().count("\n")


def count(names, sources):
    """[(file, lines)] with a name."""
    word = re.compile(rf"\b(?:{names})\b")
    found = [(path, sum(bool(word.search(line)) for line in lines)) for path, lines in sources]
    return [(path, lines) for path, lines in found if lines]


def size(found):
    """lines, files, folders."""
    return sum(lines for _, lines in found), len(found), len({os.path.dirname(path) for path, _ in found})


sources = []
for path in sorted(glob.glob(os.path.join(ROOT, "src", "*", "*.[ch]"))):
    with open(path, encoding="utf-8") as file:
        sources.append((os.path.relpath(path, os.path.join(ROOT, "src")), SKIP.sub(blank, file.read()).splitlines()))
bad, table = [], [f"{'feature':18}{'lines':>6}{'files':>6}{'folders':>8}   outside its home: lines, files, folders"]
for feature, (home, names, most) in FEATURES.items():
    all_of_it = count(names, sources)
    outside = [(path, lines) for path, lines in all_of_it if not path.startswith(home)]
    table.append(f"{feature:18}{'%6d%6d%8d' % size(all_of_it)}   {'%6d%6d%6d' % size(outside)}")
    bad += [f"{feature}: src/{part} is no home" for part in home if not any(p.startswith(part) for p, _ in sources)]
    if size(outside)[2] > most:
        bad.append(f"{feature} is named in {size(outside)[2]} folders outside its home, at most {most}: "
                   + ", ".join(path for path, _ in outside))
records = [path for path, lines in sources if RECORD.search("\n".join(lines))]
named = {path for path, _ in count(EDGES, sources) if path.split("/")[0] in CORE}
bad += [f"src/{path} names an edge, which the core must not" for path in sorted(named - {LIST, *KNOWN, *records})]
bad += [f"src/{path} names no edge any more: take it from KNOWN in tests/lint/features.py" for path in KNOWN
        if path not in named]
if "--print" in sys.argv:
    print("\n".join(table))
verdict.end("features", bad, f"{len(FEATURES)} features, {len(records)} edges")
