#!/usr/bin/python3
"""Each number of a scene changed in turn, as scene.json lists them. Where the bodies of the start differ then, a
restart from the scene's checkpoint is refused, or says that the option acts at the start only; it says each change; and
a packing that the cache has of a scene is not taken for another one."""
import json
import os
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

POOL = """-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 1.2,1.5 -box_x wall -box_ymin wall -gravity 0,-9.81
 -bodies pool,drop -pool_upper 1.2,0.5 -pool_viscosity 0.1 -drop_shape sphere -drop_radius 0.18 -drop_center 0.6,0.95
 -drop_velocity 0,-1 -drop_viscosity 0.1 -time_step_max 0.01 -snapshot_double -steps_max 1 -progress_interval 0
 -drop_tension 7 -pool_tension 7 -wall_contact_angle 70 """
PEG = POOL + """-solids peg -peg_shape sphere -peg_radius 0.13 -peg_center 0.3,0.2 -peg_contact_angle 60
 -packing_cache ''"""
KEPT = POOL + "-packing_type poisson -packing_tolerance 0.1 "
MOVED = 0.01  # spacings 0.1, and m/s: what has settled under another gravity lies nearer than this
FACTOR = 1.0625  # on each number, or in place of 0
SKIP = ("-steps_max", "-dimension", "-snapshot_")  # the test's own; the other dimensions need another scene
KINDS = ("real", "int", "point", "direction")
AT_START = "acts at the start of a run only"


def changed(option):
    """Its words with another value; None: none is known."""
    words = option["value"].split(",")
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        return None
    if option["kind"] == "int":
        return str(int(numbers[0]) + 1)
    return ",".join(f"{n * FACTOR if n else 0.0625:.9g}" for n in numbers)


def start(folder):
    """The first particles of a run, and how many each body has, where they are and how fast, in the mean."""
    fields = runs.fields(runs.numbered(folder, "snapshot")[0])
    bodies = {b: fields["body"] == b for b in np.unique(fields["body"])}
    return fields, {b: (own.sum(), np.hstack([fields[n][own].mean(axis=0) for n in ("position", "velocity")]))
                    for b, own in bodies.items()}


def another(a, b):
    """Whether two starts have other bodies."""
    return set(a) != set(b) or any(a[k][0] != b[k][0] or np.abs(a[k][1] - b[k][1]).max() > MOVED for k in a)


def run(scene, more, folder):
    return runs.start(f"{scene} {more} -output_dir {folder}")


def restarted(option, base):
    """What is wrong with a restart after a change of an option; None: it cannot be changed so."""
    name, folder = option["name"], runs.scratch("start_" + option["name"][1:])
    value = changed(option)
    if value is None or run(PEG, f"{name} {value}", folder).returncode:
        return None
    again = run(PEG, f"{name} {value} -restart {runs.numbered(base, 'checkpoint')[-1]}",
                runs.scratch("again_" + name[1:]))
    line = next((line for line in again.stdout.splitlines() if line.strip().startswith(name + " ")), "")
    if again.returncode:
        return []
    said = [] if line else ["a restart does not say that it has changed"]
    return said + [f"the start differs, and a restart takes it: {line.strip()}"] * (
        another(start(folder)[1], start(base)[1]) and AT_START not in line)


def kept(option, cache):
    """What is wrong with the packing after a change of an option, with one of the scene in the cache."""
    name, value = option["name"], changed(option)
    folders = [runs.scratch(f"{where}_{name[1:]}") for where in ("alone", "beside")]
    if value is None or any(run(KEPT, f"{name} {value} -packing_cache '{where}'", folder).returncode
                            for where, folder in zip(("", cache), folders)):
        return None
    a, b = (start(folder)[0] for folder in folders)
    return [] if np.array_equal(a["position"], b["position"]) else ["the packing of another scene is taken"]


def tried(name, scene, judge, known, least):
    path = runs.scratch(f"{name}.json")
    runs.start(f"{scene} -scene_json {path}")
    with open(path, encoding="utf-8") as file:
        options = [o for o in json.load(file)["options"] if o["kind"] in KINDS and not o["name"].startswith(SKIP)]
    with ThreadPoolExecutor(2) as pool:
        faults = list(pool.map(lambda o: judge(o, known), options))
    for option, fault in zip(options, faults):
        if fault is not None:
            runs.check(not fault, f"{name}{option['name']}", "; ".join(fault))
    count = sum(fault is not None for fault in faults)
    runs.check(count >= least, f"{name}_options", f"only {count} of {len(options)} could be changed")


def main():
    for part in runs.parts("restart", "cache"):
        if part == "restart":
            base = runs.scratch("base")
            done = run(PEG, "", base)
            runs.check(not done.returncode, "scene", done.stderr)
            tried("restart", PEG, restarted, base, 60)
        else:
            cache = runs.scratch("cache")
            os.mkdir(cache)
            done = run(KEPT, f"-packing_cache {cache}", runs.scratch("packed"))
            runs.check(not done.returncode and os.listdir(cache), "a_packing_is_kept", done.stderr)
            tried("cache", KEPT, kept, cache, 60)
    runs.done()


main()
