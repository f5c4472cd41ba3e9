#!/usr/bin/python3
"""A run's folder is whole: it keeps the files that its options name, opens and goes on anywhere, -restart takes the
newest checkpoint of a folder, and -measure gives the columns of gauges that the run did not have, as it would have
written them."""
import os
import shutil
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402
import isph  # noqa: E402
from isph import tables  # noqa: E402

CORNERS = ((0.1, 0.1, 0.1), (0.1, 0.3, 0.1), (0.3, 0.1, 0.1), (0.1, 0.1, 0.3))
FACES = ((0, 1, 2), (0, 2, 3), (0, 3, 1), (2, 1, 3))
TANK = """-dimension 3 -spacing 0.05 -box_lower 0,0,0 -box_upper 0.6,0.4,0.6 -box_x wall -box_y wall -box_zmin wall
 -bodies film -film_upper 0.6,0.4,0.3 -film_velocity 0.3,0,0 -solids part,plate -part_shape stl -part_file part.stl
 -plate_lower 0.4,0.1,0.2 -plate_upper 0.5,0.3,0.5 -plate_motion_file 'my move.csv' -gravity 0,0,-9.81 -time_end 0.05
 -snapshot_interval 0.02 -series_interval 0"""
FLAT = """-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 1,1 -box_x wall -box_ymin wall -bodies film,drop
 -film_upper 1,0.4 -drop_shape sphere -drop_center 0.5,0.6 -drop_radius 0.12 -drop_velocity 0,-1 -gravity 0,-9.81
 -time_end 0.2 -snapshot_interval 0.05 -series_interval 0 """
GAUGES = "-gauge_points 0.5,0.2,0.05,0.02 -gauge_heights 0.3,0.5 -gauge_forces -gauge_spread"
SINGLE = 2e-6  # of the largest value: snapshots are in single precision
MIDDLE = ("force_", "wetted_", "contact_", "surface_energy")  # of which the run writes those of the middle of its step
STEP = 0.02  # of the largest value: what half a step changes


def kept():
    home = runs.scratch("home")
    os.makedirs(home)
    with open(os.path.join(home, "part.stl"), "w", encoding="utf-8") as file:
        file.write("solid part\n" + "".join("facet normal 0 0 0\nouter loop\n" + "".join(
            "vertex {} {} {}\n".format(*CORNERS[k]) for k in face) + "endloop\nendfacet\n" for face in FACES))
        file.write("endsolid part\n")
    with open(os.path.join(home, "my move.csv"), "w", encoding="utf-8") as file:
        file.write("0,0,0,0\n1,0,0,-0.1\n")
    there = runs.run(TANK, os.path.join("home", "run"), cwd=home)
    moved = runs.scratch("moved")
    shutil.move(there, moved)
    shutil.rmtree(home)
    inputs = sorted(os.listdir(os.path.join(moved, "inputs")))
    runs.check(inputs == ["part_file.stl", "plate_motion_file.csv"], "inputs", str(inputs))
    before = runs.numbered(moved, "checkpoint")
    again = runs.start(["-options_file", os.path.join(moved, "options.opts"), "-output_dir", moved, "-restart", moved,
                        "-time_end", "0.07"], cwd=runs.scratch(""))
    two = runs.numbered(moved, "checkpoint")
    runs.check(again.returncode == 0 and two[0] == before[-1] and len(two) == 2, "restart_of_a_folder", again.stderr)
    on = runs.start(["-options_file", os.path.join(moved, "options.opts"), "-output_dir", moved, "-restart", moved,
                     "-time_end", "0.09"], cwd=runs.scratch(""))
    runs.check(f"Restart: {moved}/{os.path.basename(two[1])}" in on.stdout, "restart_takes_the_newest",
               on.stderr + on.stdout[:300])
    import run as data
    import solids
    opened = data.Run(moved)
    corners, _ = solids.triangles(opened, opened.scene["solids"][0])
    due = np.sort([CORNERS[k] for face in FACES for k in face], 0)
    runs.check_below(abs(np.sort(corners.reshape(-1, 3), 0) - due).max(), 1e-6, "stl_of_a_moved_folder")
    fresh = runs.start(["-options_file", os.path.join(moved, "options.opts"), "-output_dir", moved,
                        "-output_overwrite"], cwd=runs.scratch(""))
    runs.check(fresh.returncode == 0 and len(os.listdir(os.path.join(moved, "inputs"))) == 2, "overwritten_by_itself",
               fresh.stderr)
    empty = runs.scratch("empty")
    os.makedirs(empty)
    none = runs.start(f"{FLAT} -restart {empty} -output_dir {runs.scratch('none')}")
    runs.check(none.returncode == 1 and "no checkpoint_<step>.h5 to restart from" in none.stderr, "restart_of_no_run",
               none.stderr)


def clock():
    """The checkpoint by the clock is newer than those of steps, which remove it."""
    folder = runs.run(FLAT + "-checkpoint_interval 0.1", "clock")
    shutil.copy(runs.numbered(folder, "checkpoint")[-1], os.path.join(folder, "checkpoint_clock.h5"))
    done = runs.start(f"{FLAT} -time_end 0.21 -restart {folder} -output_dir {runs.scratch('clocked')}")
    runs.check("checkpoint_clock.h5 at 0.2 s" in done.stdout, "checkpoint_by_the_clock", done.stdout[:300])


def unlike(folder, name, had, gauges):
    """Compares what is measured with what the run with all its gauges has written."""
    found = isph.measure(folder, **gauges)
    whole = tables.read_series(had)
    lines = [whole["step"].index(step) for step in found["step"]]
    runs.check(len(lines) == len(runs.numbered(folder, "snapshot")), f"{name}_times", str(lines))
    for column, values in found.items():
        due = np.array(whole[column])[lines]
        late = column.startswith(MIDDLE)
        alike = [other for other in found if other == column or column[:6] == other[:6] == "force_"]
        scale = np.nanmax([np.abs(np.array(whole[other])[lines]) for other in alike] + [np.full(len(lines), 1e-30)])
        if "force_" in column and "-snapshot_walls" not in WALLS[name]:
            runs.check(np.isnan(values).all(), f"{name}_{column}", str(values))
            continue
        runs.check(np.array_equal(np.isnan(values), np.isnan(due)), f"{name}_{column}_gaps", f"{values} {due}")
        runs.check_below(np.nanmax(np.abs(values - due), initial=0) / scale, STEP if late else SINGLE,
                         f"{name}_{column}")
    return found


WALLS = {"plain": "", "walls": " -snapshot_walls", "rings": "", "emitter": ""}


def measured():
    gauges = {"gauge_points": (0.5, 0.2, 0.05, 0.02), "gauge_heights": (0.3, 0.5), "gauge_forces": True,
              "gauge_spread": True}
    for name in ("plain", "walls"):
        had = runs.run(FLAT + GAUGES + WALLS[name], name + "_had")
        folder = runs.run(FLAT + WALLS[name], name)
        found = unlike(folder, name, had, gauges)
        runs.check(not {"viscous_work", "outside_work", "time_step"} & set(found), f"{name}_past", str(list(found)))
    rings = FLAT.replace("-dimension 2", "-dimension axisymmetric").replace("-box_x wall", "-box_xmax wall").replace(
        "0.5,0.6", "0,0.6") + "-film_tension 7 -drop_tension 7 "
    had = runs.run(rings + "-gauge_heights 0.3", "rings_had")
    unlike(runs.run(rings, "rings"), "rings", had, {"gauge_heights": 0.3})
    jet = FLAT + "-drop_type emitter -drop_center 0.5,0.8 "
    had = runs.run(jet + "-gauge_heights 0.5", "emitter_had")
    unlike(runs.run(jet, "emitter"), "emitter", had, {"gauge_heights": 0.5})


def refused():
    for name, more, words in (("gas", "-gas", "with -gas"),
                              ("region", "-snapshot_lower 0.1,0.1", "a part of the liquid"),
                              ("bare", "-snapshot_fields velocity", "no pressure, which -measure needs"),
                              ("free", "-solids block -block_lower 0.1,0.5 -block_upper 0.3,0.7 -block_mass 10",
                               "free solids")):
        folder = runs.run(f"{FLAT} -steps_max 2 {more}", "refused_" + name)
        done = runs.start(["-measure", folder])
        runs.check(done.returncode == 1 and words in done.stderr and done.stderr.count("\n") == 1, f"refuse_{name}",
                   done.stderr)
    nowhere = runs.scratch("nowhere")
    for there, ranks, why in ((nowhere, 1, "options.opts cannot be opened"), (folder, 2, "one process")):
        done = runs.start(["-measure", there], ranks)
        runs.check(done.returncode and why in done.stderr, f"refuse_{why}", done.stderr)


PARTS = {f.__name__: f for f in (kept, clock, measured, refused)}
for part in runs.parts(*PARTS):
    PARTS[part]()
runs.done()
