#!/usr/bin/python3
"""Where the features of the program are named: lines, files and folders of src/ (.c and .h, without comments and texts)
with a name of the feature, inside and outside of its home. A feature that is one folder and one record is named outside
in a list of records and at most one header; how far the others are from that is the table that --print shows (make
lint). The number of folders outside may not become larger. The core, headers too, names no edge at all, but in the
lists, src/stepper/hooks.c and src/domain/adaptive.c: an edge is a record. The words are what the homes of the edges
define: their public functions, types, constants and records. LINT_ROOT: another tree, for figures before a change."""
import glob
import os
import re
import sys

import verdict

ROOT = os.environ.get("LINT_ROOT", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
# name: where it is at home (first the folder of its record, if it has one), its names, folders outside at most
FEATURES = {
    "free bodies": (("bodies/",),
                    r"Free(?!Surface)[A-Z]\w*|SceneHasFree|BodyMass|Coupling[A-Z]\w*|GaugeBodies", 2),
    "solids that move": (("bodies/",),
                         r"SceneSolidsMove|SceneMoveSolids|SolidsMove|BodyMov\w+|BodyMotion|MovingEdge|SceneDriven", 5),
    "emitters": (("emitters/",),
                 r"Emi(?:tter|ssion)\w*|BodyTypeEmitter|emitter|inflow_energy", 2),
    "resampling": (("resampling/",), r"Resampl\w+", 1),
    "following": (("following/",), r"Follow(?:ing)?[A-Z]\w*|Target[A-Z]\w*", 1),
    "adaptive spacing": (("domain/", "following/"), r"adaptive|adaptive_data|Adaptive\w*", 6),
    "graded spacing": (("packing/graded.c", "neighbors/levels.c", "following/"),
                       r"graded|Graded\w*|spacing_coarse|size_most|growth", 13),
    "rings": (("domain/",), r"rings|Ring[A-Z]\w*|\w+Ring[A-Z]\w*|RING_\w+", 16),
    "contact lines": (("lines/", "tension/contact.c", "tension/contact.h", "tension/lines.c", "tension/lines.h"),
                      r"\w*Contact[A-Z]\w*|contact_\w+|\w*Hysteresis\w*|\w*FastestLine|fastest_line|LARGEST_LINE"
                      r"|LinesMove|LineOps|TensionLines|TensionHasLaw|TensionSolidsWet|\w*MovingLine\w*", 4),
    "gas": (("gas/",), r"Gas[A-Z]\w*|GaugePockets|Pockets?|GAS_\w+", 1),
    "heat": (("heat/",), r"Heat[A-Z]\w*|HEAT\w*|GaugeScalars", 1),
    "elastic": (("elastic/",), r"Elastic[A-Z]\w*|Polymers\w*|GaugeElastic", 1),
    "outlets": (("outlets/",), r"Outlet[A-Z]\w*|OUTLET\w*", 1),
    "interface": (("interface/",), r"Interface[A-Z]\w*|\w+Interface|interface_\w+", 2),
    "pressure jumps": (("neighbors/", "pressure/"),
                       r"CloudPressureJump|CloudAcross|pressure_jump\w*|at_interface|Jumps[A-Z]\w*", 2),
}
# Lines outside of these folders that ask whether particles are rings: others take lengths, volumes and directions of
# the domain. The number may not become larger.
METRIC, ASKS = ("domain/", "neighbors/", "scene/", "packing/", "resampling/", "following/"), 25
# The folders that every run is made of.
CORE = ("base", "domain", "kernel", "particles", "neighbors", "operators", "pressure", "twolevel", "solver", "storage",
        "stepper")
LISTS = {"stepper/hooks.c", "domain/adaptive.c"}
RECORD = re.compile(r"^const (?:Edge|Adaptive) \w+ +=", re.M)  # the file of an edge has it
# What a file defines for others: functions and records of a .c file; types, constants and macros of a header.
DEFINES = {".c": re.compile(r"^(?!static\b|typedef\b|extern\b|#)[A-Za-z][\w *]*?\b(\w+)(?:\(|(?:\[\w*\])? = )", re.M),
           ".h": re.compile(r"^#define (\w+)|^\} (\w+);|^  ([A-Z][A-Z_0-9]+),?$|^typedef .*\(\*(\w+)\)\(", re.M)}
OWN = re.compile(r"^#define (\w+)", re.M)
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
asks = size(count(r"(?:->|\.)rings", [source for source in sources if not source[0].startswith(METRIC)]))[0]
table.append(f"rings asked for on {asks} lines outside of {' '.join(METRIC)}")
if asks > ASKS:
    bad.append(f"rings are asked for on {asks} lines outside of {' '.join(METRIC)}, at most {ASKS}: ask the domain")
text = {path: "\n".join(lines) for path, lines in sources}
records = [path for path in text if RECORD.search(text[path])]
homes = [home for home, _, _ in FEATURES.values() if any(path.startswith(home[0]) for path in records)]
bad += [f"src/{path} is the record of an edge, which is at home in no row of FEATURES (tests/lint/features.py)"
        for path in records if not any(path.startswith(home) for home in homes)]
edges = {path for path in text for home in homes if path.startswith(home)}
words = {word for path in edges for found in DEFINES[path[-2:]].findall(text[path])
         for word in ([found] if isinstance(found, str) else found) if word}
for path, lines in sources:
    if path.split("/")[0] in CORE and path not in edges | LISTS:
        named = sorted(words & set(re.findall(r"\w+", text[path])) - set(OWN.findall(text[path])))
        if named:
            bad.append(f"src/{path} names an edge, which the core must not: {', '.join(named)}")
if "--print" in sys.argv:
    print("\n".join(table))
verdict.end("features", bad, f"{len(FEATURES)} features, {len(records)} edges with {len(words)} names")
