#!/usr/bin/python3
"""Snapshots read back: each field of each particle is that of the checkpoint of the same step, in double and in single
precision; the particles are those of the liquid and of solids that move, with -snapshot_walls all; head and units are
the scene's."""
import json
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import h5py  # noqa: E402
import numpy as np  # noqa: E402
import runs  # noqa: E402

SOLID = -2  # of the first of -solids
MEGABYTE = 1e6
STRUCTURE = 80e3  # bytes of a file besides its fields, at most; what is reserved while it is written are 260e3
SCENES = {
    "moving": "-dimension 2 -spacing 0.05 -box_lower -1,0 -box_upper 1,1.5 -box_x wall -box_ymin wall -bodies "
              "pool,drop -pool_upper 1,0.5 -drop_shape sphere -drop_center 0.5,0.9 -drop_radius 0.2 -drop_viscosity 1 "
              "-drop_viscosity_model carreau -drop_viscosity_time 1 -drop_viscosity_exponent 0.5 -gravity 0,-9.81 "
              "-solids paddle,stone,boat -paddle_lower -0.6,0.2 -paddle_upper -0.5,0.7 -paddle_velocity 0.3,0 "
              "-stone_lower 0.7,0 -stone_upper 0.9,0.2 -boat_lower 0,0.4 -boat_upper 0.3,0.6 -boat_mass 30",
    "following": "-dimension axisymmetric -spacing 0.05 -spacing_coarse 0.15 -spacing_growth 0.1 "
                 "-spacing_follow surface -box_lower 0,0 -box_upper 2,3 -box_xmax wall -box_ymin wall -bodies "
                 "pool,drop -pool_upper 2,1 -drop_shape sphere -drop_center 0,1.6 -drop_radius 0.5 -drop_velocity "
                 "0,-1 -gravity 0,-9.81",
    "plane": "-dimension 2 -spacing 0.05 -spacing_coarse 0.15 -spacing_growth 0.1 -spacing_follow surface -box_lower "
             "0,0 -box_upper 2,2 -box_x wall -box_ymin wall -bodies pool -pool_upper 2,1.2 -gravity 0,-9.81",
    "space": "-spacing 0.1 -box_lower 0,0,0 -box_upper 1,1,1 -box_x periodic -box_y symmetry -box_zmin wall -bodies a "
             "-a_upper 1,1,0.5 -gravity 1,0,-9.81 -solids post -post_lower 0.4,0,0 -post_upper 0.6,1,0.3"}
RUN = " -steps_max 4 -series_interval 0 -checkpoint_interval 0 -snapshot_interval 1e-9"


def same(name, folder, precise, walls):
    """Compares the last snapshot of a run with its checkpoint."""
    snapshot, state = runs.numbered(folder, "snapshot")[-1], runs.numbered(folder, "checkpoint")[-1]
    found, due = runs.fields(snapshot), runs.fields(state)
    with open(os.path.join(folder, "scene.json"), encoding="utf-8") as file:
        scene = json.load(file)
    moves = [SOLID - k for k, solid in enumerate(scene["solids"]) if solid["free"] or solid["driven"]]
    wanted = np.isin(due["body"], moves) | (due["body"] >= 0) | walls
    runs.check(set(found) == set(due) - {"parent"} - ({"layer"} if not walls else set()), f"{name}_fields",
               f"{sorted(found)}, the checkpoint has {sorted(due)}")
    runs.check(np.array_equal(found["id"], due["id"][wanted]), f"{name}_particles",
               f"{len(found['id'])}, {wanted.sum()} expected")
    for field in sorted(set(found) & set(due)):
        right = due[field][wanted]
        right = right.astype(np.float32) if right.dtype == float and not precise else right
        runs.check(found[field].dtype == right.dtype and np.array_equal(found[field], right), f"{name}_{field}",
                   f"{found[field].dtype}, {len(found[field])} of {len(right)} particles")
    head, last = runs.head(snapshot), runs.head(state)
    for key in ("time", "time_step", "step", "spacing", "level"):
        runs.check(head[key] == last[key], f"{name}_head_{key}", f"{head[key]}, not {last[key]}")
    dim = scene["domain"]["dimension"]
    runs.check(all(np.array_equal(head[f"box_{end}"][:dim], scene["domain"][end][:dim]) for end in ("lower", "upper")),
               f"{name}_head_box", str(head["box_upper"]))
    units = {row["name"]: row["unit"] or "1" for row in scene["columns"] if row["file"] == "snapshot"}
    with h5py.File(snapshot, "r") as file:
        stored = sum(file[field].id.get_storage_size() for field in found)
        runs.check_below(os.path.getsize(snapshot), stored + STRUCTURE, f"{name}_size_of_the_file")
        said = {field: file[field].attrs["unit"].decode() for field in found}
    runs.check(said == {field: units[field] for field in found}, f"{name}_units", f"{said}, scene.json has {units}")
    volume = "m2" if dim == 2 and not scene["domain"]["rings"] else "m3"
    runs.check(said.get("volume", volume) == volume, f"{name}_unit_of_the_volume", said.get("volume"))
    return len(moves)


moving = {}
for name, scene in SCENES.items():
    same(name, runs.run(scene + RUN + " -snapshot_double -snapshot_walls", name), True, True)
    moving[name] = same(f"{name}_single", runs.run(scene + RUN, f"{name}_single", ranks=2), False, False)
LARGE = SCENES["space"].replace("-spacing 0.1", "-spacing 0.05") + RUN  # what -dry_run says of its files
folder = runs.run(LARGE, "large")
said = re.search(r"snapshots of (\S+) MB, two checkpoints of (\S+) MB", runs.start(LARGE + " -dry_run").stdout)
for k, kind in enumerate(("snapshot", "checkpoint")):
    size = os.path.getsize(runs.numbered(folder, kind)[-1])
    runs.check_within(float(said[k + 1]) * MEGABYTE / size, 0.75, 1.3, f"estimated_{kind}")
runs.check(moving == {"moving": 2, "following": 0, "plane": 0, "space": 0}, "solids_that_move", str(moving))
runs.done()
