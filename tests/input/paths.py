#!/usr/bin/python3
"""A scene in a folder runs from anywhere: files that it names are looked for in the working directory, then in the
folders of the options files. 'none' is what holds without an option."""
import json
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

SCENE = """-dimension 2\n-spacing 0.1\n-box_lower 0,0\n-box_upper 1,1\n-box_x wall\n-box_ymin wall\n-bodies a
-a_upper 1,0.6\n-gravity 0,-9.81\n-solids p\n-p_shape sphere\n-p_radius 0.15\n-p_center 0.5,0.5\n-steps_max 2
-time_step_max 0.01\n-series_interval 0\n"""


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def used(folder, name):
    """What an option was in a run."""
    with open(os.path.join(folder, "scene.json"), encoding="utf-8") as file:
        return next((one["value"] for one in json.load(file)["options"] if one["name"] == name), None)


def paths():
    here = runs.scratch("scenes")
    scene = write(os.path.join(here, "deep", "scene.opts"), SCENE + "-p_motion_file way.txt\n")
    far, near = (write(os.path.join(here, *words), f"0 0 0\n1 {end} 0\n")
                 for words, end in ((("deep", "way.txt"), 0.2), (("way.txt",), -0.2)))
    right = runs.series(runs.run("-options_file scene.opts", "beside", cwd=os.path.dirname(scene)))["kinetic_energy"]
    for ranks in (1, 2):
        folder = runs.run(f"-options_file {scene}", f"away_{ranks}", ranks=ranks)
        runs.check(used(folder, "-p_motion_file") == far, f"the_file_is_found_on_{ranks}",
                   str(used(folder, "-p_motion_file")))
        energy = runs.series(folder)["kinetic_energy"]
        runs.check_below(abs(energy[1:] / right[1:] - 1).max(), 0 if ranks == 1 else 1e-3, f"the_same_run_on_{ranks}")
    corners = ((0.2, 0.2, 0.2), (0.8, 0.2, 0.2), (0.2, 0.8, 0.2), (0.2, 0.2, 0.8))  # each rank reads a mesh itself
    faces = "".join("facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x} {y} {z}\n" for x, y, z in (
        corners[k] for k in face)) + "endloop\nendfacet\n" for face in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)))
    write(os.path.join(here, "deep", "part.stl"), f"solid part\n{faces}endsolid part\n")
    block = write(os.path.join(here, "deep", "block.opts"), "-spacing 0.1\n-box_lower 0,0,0\n-box_upper 1,1,1\n"
                  "-bodies a\n-solids part\n-part_shape stl\n-part_file part.stl\n-steps_max 1\n-time_step 1e-3\n")
    folder = runs.run(f"-options_file {block}", "mesh", ranks=2)
    runs.check(used(folder, "-part_file").endswith("deep/part.stl"), "a_mesh_is_found_on_2", used(folder, "-part_file"))
    above = write(os.path.join(here, "above.opts"), f"-options_file {scene}\n")
    again = runs.run(f"-options_file {above}", "above")
    runs.check(used(again, "-p_motion_file") == far, "the_file_of_the_inner_folder", str(used(again, "-p_motion_file")))
    here_first = runs.run(f"-options_file {scene}", "first", cwd=here)
    runs.check(used(here_first, "-p_motion_file") == "way.txt", "the_working_directory_comes_first",
               str(used(here_first, "-p_motion_file")))
    os.remove(near)
    os.remove(far)
    gone = runs.start(f"-options_file {scene} -output_dir gone", cwd=here)
    runs.check(gone.returncode and "-p_motion_file way.txt cannot be read" in gone.stderr, "no_file", gone.stderr)


def none():
    scene = write(runs.scratch("angle.opts"), SCENE + "-a_tension 0.07\n")
    plain, angle, word = (runs.run(f"-options_file {scene} {more}", name) for name, more in (
        ("plain", ""), ("angle", "-p_contact_angle 30"), ("word", "-p_contact_angle 30 -p_contact_angle none")))
    energies = [runs.series(folder)["kinetic_energy"][-1] for folder in (plain, angle, word)]
    runs.check(energies[0] == energies[2] and energies[0] != energies[1], "no_contact_angle", str(energies))


paths()
none()
runs.done()
