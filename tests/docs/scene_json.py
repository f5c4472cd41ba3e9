#!/usr/bin/python3
"""scene.json: its keys and options/scene_json.md say the same; the file of a run and that of -scene_json do; its
numbers are those of the scene; signs that need escapes."""
import json
import math
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

TABLE = os.path.join(runs.ROOT, "options", "scene_json.md")
FLAT = "-dimension 2 -spacing 0.1 -box_lower -1,-1 -box_upper 1,1 -time_end 1e-3 -gravity 0,-9.81 -bodies a " \
    "-a_lower -0.5,-0.5 -a_upper 0.5,0.5 "
SCENES = (
    FLAT + "-ksp_rtol 1e-6 -box_xmax_level 0.5 -box_xmin_pressure 10",
    FLAT + "-solids s -s_shape sphere -s_radius 0.2 -s_center 0.7,0.7 -s_holes h -h_shape sphere -h_radius 0.1 "
    "-h_center 0.7,0.7 -s_oscillation_amplitude 0.1,0 -s_oscillation_frequency 1000 -a_holes k -k_shape sphere "
    "-k_radius 0.2",
    FLAT + "-spacing_coarse 0.2 -fine r -r_shape sphere -r_radius 0.3",
    FLAT + "-a_tension 0.07 -box_ymin wall -wall_contact_angle 60 -wall_contact_hysteresis 20 -a_velocity 0,-2",
    FLAT + "-bodies a,b -b_type emitter -b_velocity 0,-1 -b_lower -0.3,0.6 -b_upper 0.3,0.9 -a_viscosity_model carreau "
    "-a_viscosity_time 1 -a_viscosity_exponent 0.5 -a_velocity_type rotation -a_rotation_rate 1 -gravity 0,0 "
    "-frame_rotation_rate 1",
    "-spacing 0.2 -box_lower -1,-1,-1 -box_upper 1,1,1 -box_x periodic -time_end 1e-3 -bodies a -a_shape sphere "
    "-a_radius 0.5 -a_center 0,0,0.1 -a_velocity 0,0,-1",
)


def paths(value, path=""):
    """The paths of all values; a hole is one, and the last word of what options name is NAME."""
    if isinstance(value, dict):
        for key, part in value.items():
            named = re.search(r"\.(numbers|emitter|motion)$", path)
            yield from paths(part, f"{path}.{'NAME' if named else key}".lstrip("."))
    elif isinstance(value, list) and value and isinstance(value[0], dict) and not path.endswith("holes"):
        for part in value:
            yield from paths(part, path + "[]")
    else:
        yield path


def written(options, name):
    """The scene file of -scene_json."""
    path = runs.scratch(name)
    done = runs.start(options + f" -scene_json {path}")
    if not runs.check(done.returncode == 0 and not done.stdout, f"{name}_is_written", done.stdout + done.stderr):
        runs.done()
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def empty_lists(value, path=""):
    """The paths of lists without a value: their objects are not there to compare."""
    for key, part in value.items():
        here = f"{path}.{key}".lstrip(".")
        if part == []:
            yield here
        elif isinstance(part, dict):
            yield from empty_lists(part, here)
        elif isinstance(part, list) and isinstance(part[0], dict) and key != "holes":
            for one in part:
                yield from empty_lists(one, here + "[]")


with open(TABLE, encoding="utf-8") as text:
    documented = re.findall(r"^\| `([^`]+)` \|", text.read(), re.M)
runs.check(len(documented) == len(set(documented)), "each_key_has_one_row", str(documented))
seen, empty = set(), set()
files = [written(scene, f"scene_{k}.json") for k, scene in enumerate(SCENES)]
for k, (scene, file) in enumerate(zip(SCENES, files)):
    folder = runs.run(scene, f"run_{k}")
    with open(os.path.join(folder, "scene.json"), encoding="utf-8") as text:
        of_run = json.load(text)
    seen |= set(paths(file)) - set(empty_lists(file))
    seen |= set(paths(of_run)) - set(empty_lists(of_run))
    empty |= set(empty_lists(of_run))
    step = of_run.pop("step")
    bounds = [bound for name, bound in step.items() if name != "binds" and bound is not None]
    others = [{o["name"]: o["value"] for o in one.pop("petsc_options")} for one in (file, of_run)]
    runs.check(others == [{"ksp_rtol": "1e-6"} if "-ksp_rtol" in scene else {}, {}], f"options_of_petsc_{k}",
               str(others))
    told = [{o["name"]: o for o in one.pop("options")} for one in (file, of_run)]
    runs.check(told[0]["-spacing"] == told[1]["-spacing"] and told[0]["-spacing"]["given"], f"options_of_{k}")
    runs.check(file.pop("step") == {} and file == of_run, f"run_{k}_and_option_write_the_same")
    runs.check(step[step["binds"]] == min(bounds) if bounds else step["binds"] is None, f"least_bound_{k}", str(step))
unknown, missing = sorted(seen - set(documented)), sorted(set(documented) - seen - empty)
runs.check(not unknown, "every_key_is_in_the_table", str(unknown))
runs.check(not missing, "every_row_of_the_table_is_written", str(missing))

solid, drop, ball = files[1]["solids"][0], files[3], files[5]
runs.check(sorted(solid["holes"][0]) == ["lower", "name", "pressure", "shape", "upper"], "a_hole", str(solid["holes"]))
runs.check(solid["driven"] and not solid["free"] and solid["motion"]["oscillation_amplitude"] == [0.1, 0] and
           any(math.isclose(t, 0.25e-3) for t in solid["moments"]), "a_solid_that_moves", str(solid))
runs.check(math.isclose(solid["lower"][0], 0.5) and solid["shape"]["numbers"]["radius"] == 0.2, "bounds",
           str(solid["lower"]))
numbers = {n["name"]: n for n in drop["bodies"][0]["dimensionless"]}
for name, value in (("Re", 2e6), ("We", 4000 / 0.07), ("Fr", 4 / 9.81), ("Bo", 9810 / 0.07), ("Ca", 2e-3 / 0.07),
                    ("Oh", 1e-3 / math.sqrt(1000 * 0.07))):
    runs.check_within(numbers[name]["value"], value * (1 - 1e-12), value * (1 + 1e-12), f"number_{name}")
runs.check(numbers["Re"]["length"] == 1 and numbers["Re"]["speed"] == 2, "length_and_speed", str(numbers["Re"]))
angles = {a["name"]: a for a in drop["tension"]["contact_angles"]}
runs.check(list(angles) == ["ymin"], "angles", str(angles))
runs.check_within(angles["ymin"]["receding"], 50 - 1e-9, 50 + 1e-9, "receding")
runs.check_within(angles["ymin"]["advancing"], 70 - 1e-9, 70 + 1e-9, "advancing")
runs.check(all(a["holds"] == (a["across"] != "z") for a in ball["model"]["mirrors"]), "mirrors",
           str(ball["model"]["mirrors"]))
liquid, jet = files[4]["bodies"]
runs.check(math.isclose(jet["emitter"]["interval"], 0.3) and liquid["emitter"] == {}, "emitter", str(jet))
runs.check(files[4]["model"]["not_looked_for"] == "a frame that rotates", "not_looked_for")
table = runs.scratch('a "quoted" \\ name.csv')
with open(table, "w", encoding="utf-8") as text:
    text.write("0,0,0\n1e-3,0,0.1\n")
path = runs.scratch("quoted.json")
done = runs.start(SCENES[1].split() + ["-s_motion_file", table, "-scene_json", path])
with open(path, encoding="utf-8") as text:
    runs.check(json.load(text)["solids"][0]["motion"]["motion_file"] == table, "escapes", done.stderr)
refused = runs.start(FLAT + f" -scene_json {runs.scratch('none')}/scene.json")
runs.check(refused.returncode == 1 and "cannot write the scene file" in refused.stderr, "refuses_a_file",
           refused.stderr)
runs.done()
