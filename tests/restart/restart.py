#!/usr/bin/python3
"""A run continued from a checkpoint equals the one that was not interrupted: to the last bit on as many ranks as wrote
it, to round-off on another number, or from a checkpoint by the clock, which does not change the run that writes it."""
import os
import shlex
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

IMPACT = """-spacing 1e-3 -box_lower 0,0,-6e-3 -box_upper 12e-3,12e-3,12e-3 -box_x periodic -box_ymin symmetry
 -box_zmin wall -gravity 0,0,-9.81 -bodies film,drop -film_lower 0,0,-6e-3 -film_upper 12e-3,12e-3,0
 -film_viscosity 3.5e-3 -film_tension 0.067 -drop_shape sphere -drop_radius 3e-3 -drop_center 6e-3,0,5.8e-3
 -drop_velocity 1,0.5,-3 -drop_tension 0.067 -snapshot_double -checkpoint_interval 7e-4 -series_interval 1e-4
 -snapshot_interval 3e-4 -gauge_crater -gauge_axis 6e-3,6e-3 -gauge_droplets -gauge_forces
 -gauge_spread -gauge_neck z -gauge_roughness -gauge_film 0,6e-3,9e-3,6e-3 """
PLANE = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,1 -box_x periodic -box_ymin wall -gravity 0,-9.81
 -bodies film,drop -film_upper 1,0.4 -film_velocity 3,0 -drop_shape sphere -drop_radius 0.15 -drop_center 0.5,0.62
 -drop_velocity 4,-2 -film_tension 20 -drop_tension 20 -snapshot_double -checkpoint_interval 1e-2
 -sort_interval 7 -solids paddle,float
 -float_shape sphere -float_radius 0.08 -float_center 0.12,0.28 -float_mass 15 -float_rotation_rate 3
 -paddle_lower 0.3,0.1 -paddle_upper 0.7,0.2 -paddle_rotation_rate 9 -paddle_rotation_center 0.5,0.2
 -paddle_velocity 0.5,0.2 -paddle_oscillation_amplitude 0,0.01 -paddle_oscillation_frequency 9
 -gauge_forces -gauge_heights 0.2,0.8 -gauge_points 0.2,0.2,0.8,0.3 -gauge_droplets """
RINGS = """-dimension axisymmetric -spacing 1e-3 -box_lower 0,-6e-3 -box_upper 14e-3,12e-3 -box_xmax wall -box_ymin wall
 -gravity 0,-9.81 -bodies film,drop,jet -film_lower 0,-6e-3 -film_upper 14e-3,0 -film_viscosity 3.5e-3
 -film_tension 0.067 -drop_viscosity 0.35 -viscosity_solver implicit -film_viscosity_model carreau
 -film_viscosity_exponent 0.5 -film_viscosity_time 0.1 -drop_viscosity_model herschel_bulkley -drop_yield_stress 5
 -drop_shape sphere -drop_radius 3e-3 -drop_center 0,5.8e-3 -drop_velocity 0,-3 -drop_tension 0.067 -snapshot_double
 -checkpoint_interval 7e-4 -series_interval 0 -snapshot_interval 3e-4
 -solids ball -ball_shape sphere -ball_radius 2e-3 -ball_center 0,-3e-3 -ball_velocity 0,1 -gauge_forces
 -ball_contact_angle 70 -wall_contact_angle 110 -wall_contact_hysteresis 30 -ball_contact_hysteresis 20
 -wall_contact_law kistler
 -jet_type emitter -jet_lower 8e-3,3e-3 -jet_upper 11e-3,4e-3 -jet_velocity 0,-2 -jet_tension 0.067 """
# Two rings of liquid, one that grows thin and one that grows fat: particles join and split.
TORI = """-dimension axisymmetric -spacing 1e-3 -box_lower 0,-10e-3 -box_upper 30e-3,12e-3 -box_ymin wall
 -gravity 0,-9.81 -bodies a,b -a_shape sphere -a_radius 2.6e-3 -a_center 4e-3,0 -a_velocity 3,0 -a_viscosity 3.5e-3
 -a_tension 0.067
 -b_shape sphere -b_radius 2.6e-3 -b_center 16e-3,7e-3 -b_velocity -3,-2 -b_viscosity 3.5e-3 -b_tension 0.067
 -time_step 8e-5 -snapshot_double -checkpoint_interval 1.1e-3
 -series_interval 1e-4 """
# Rings of different sizes, of which the first joins and splits some across the border of what is fine.
GRADED_TORI = TORI + """-spacing_coarse 2e-3 -spacing_growth 0.2 -fine core -core_lower 0,-4e-3 -core_upper 5e-3,12e-3
 -viscosity_solver implicit """
# Particles of different sizes, finer where a drop meets a film, some of which join.
GRADED = """-spacing 1e-3 -spacing_coarse 1.8e-3 -box_lower 0,0,-6e-3 -box_upper 12e-3,12e-3,12e-3 -box_x periodic
 -box_ymin symmetry -box_zmin wall -gravity 0,0,-9.81 -bodies film,drop -film_lower 0,0,-6e-3 -film_upper 12e-3,12e-3,0
 -film_tension 0.067 -drop_tension 0.067
 -drop_shape sphere -drop_radius 3e-3 -drop_center 6e-3,0,4e-3 -drop_velocity 1,0.5,-3 -snapshot_double
 -fine core -core_shape sphere -core_radius 4e-3 -core_center 6e-3,0,2e-3 -spacing_growth 0.2
 -checkpoint_interval 7e-4 -series_interval 1e-5 -snapshot_interval 3e-4 """
# The spacing follows surfaces.
FOLLOWING = GRADED.replace("-fine core -core_shape sphere -core_radius 4e-3 -core_center 6e-3,0,2e-3",
                           "-spacing_follow curvature")
FOLLOWING_TORI = TORI + "-spacing_coarse 2e-3 -spacing_growth 0.2 -spacing_follow surface "
# A lens of one liquid on another.
LENS = """-dimension 2 -spacing 1e-3 -box_lower 0,0 -box_upper 16e-3,12e-3 -box_x wall -box_ymin wall -gravity 0,-9.81
 -bodies drop,bath -bodies_overlap -drop_shape sphere -drop_radius 3e-3 -drop_center 5e-3,5e-3 -drop_density 700
 -drop_tension 0.03 -drop_velocity 0,-0.2 -bath_upper 16e-3,6e-3 -bath_viscosity 3.5e-3 -bath_tension 0.067
 -interface_tension 0.045 -snapshot_double -checkpoint_interval 3e-3 -sort_interval 7 -time_step_max 3e-4 """
# A tank whose shaking bounds the step.
SHAKEN = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,0.5 -box_x wall -box_ymin wall -gravity 0,-9.81
 -gravity_amplitude 8,0 -gravity_frequency 4 -bodies water -water_upper 1,0.3 -snapshot_double
 -checkpoint_interval 2e-2 -sort_interval 7 """
# two boxes and a floor in contact, which slide on each other
TOUCHING = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,0.8 -box_x wall -box_ymin wall -gravity 0,-9.81
 -bodies water -water_upper 1,0.36 -snapshot_double -checkpoint_interval 2e-2 -sort_interval 7 -solids low,high
 -low_upper 0.7,0.14 -low_lower 0.3,0 -low_mass 112 -low_friction 0.5 -high_lower 0.33,0.14 -high_upper 0.62,0.28
 -high_mass 84 -high_friction 0.2 -high_velocity 0.3,0 """
STEPS = 24  # of the whole run; the checkpoint falls between
ROUND_OFF = 1e-10  # on another number of ranks, spacings


def compare_series(name, whole, rest):
    """The lines of the continued run stand in the whole one too, but for the clock."""
    differing = runs.unlike_lines(whole, rest)
    runs.check(len(rest) > 1 and not differing, name, f"{len(rest)} lines, differing: {differing[:5]}")


def test(name, scene, spacing, ranks, others):
    """Runs through on 'ranks'; continues from the first checkpoint on the same and on other numbers of ranks."""
    a = runs.run(scene + f"-steps_max {STEPS}", name, ranks)
    middle, end = runs.numbered(a, "checkpoint")[0], runs.numbered(a, "checkpoint")[-1]
    step = int(runs.head(middle)["step"])
    runs.check(0 < step < STEPS, name + "_checkpoint_between", f"it is at step {step} of {STEPS}")
    final = runs.fields(end)
    for n in [ranks] + others:
        label = f"{name}_on_{n}"
        extra = "-ksp_rtol 1e-12 " if n != ranks else ""
        if extra:  # iterations end elsewhere on other ranks: compare with a tight solver
            tight = runs.run(scene + extra + f"-steps_max {STEPS}", label + "_whole", ranks)
            middle = runs.numbered(tight, "checkpoint")[0]
            final = runs.fields(runs.numbered(tight, "checkpoint")[-1])
            step = int(runs.head(middle)["step"])
        b = runs.run(scene + extra + f"-steps_max {STEPS - step} -restart {middle}", label, n)
        again = runs.fields(runs.numbered(b, "checkpoint")[-1])
        if n == ranks:
            unlike = runs.unlike(final, again)
            runs.check(not unlike, label + "_bitwise", f"differing fields: {unlike}")
            heads = runs.head(end), runs.head(runs.numbered(b, "checkpoint")[-1])
            other = [k for k in heads[0] if k not in ("wall_time", "options") and heads[0][k] != heads[1].get(k)]
            runs.check(not other, label + "_head", f"differing: {other}")
            compare_series(label + "_series", runs.series(a), runs.series(b))
            last = [runs.fields(runs.numbered(folder, "snapshot")[-1]) for folder in (a, b)]
            runs.check(not runs.unlike(*last), label + "_snapshot", f"differing fields: {runs.unlike(*last)}")
        else:
            moved = np.abs(final["position"] - again["position"]).max() / spacing
            print(f"{label}: positions differ by {moved:.2e} spacings")
            runs.check_below(moved, ROUND_OFF, label + "_positions")


def inside():
    """In the folder of the checkpoint itself: the series goes on behind the restart."""
    folder = runs.run(PLANE + f"-steps_max {STEPS}", "inside", 1)
    before = runs.series(folder)
    middle = runs.numbered(folder, "checkpoint")[0]
    for changed, words in (("-float_turns 0 -float_rotation_rate 0",
                            ["-float_turns (there 1, here 0)", "-float_rotation_rate"]),
                           ("-float_inertia 3", ["-float_inertia (here only: 3)"]),
                           ("-float_rotation_center 0.12,0.29", ["-float_rotation_center", "0.12,0.29"])):
        process = runs.start(PLANE + f"{changed} -steps_max 1 -restart {middle} -output_dir {runs.scratch('other')}")
        runs.check(process.returncode > 0 and all(word in process.stderr for word in words + ["another scene"]),
                   f"other_body {changed}", f"code {process.returncode}: {process.stderr[-300:]}")
    rest = STEPS - int(runs.head(middle)["step"])
    process = runs.start(PLANE + f"-steps_max {rest} -restart {middle} -output_dir {folder} -progress_interval 0")
    after = runs.series(folder)
    columns = [c for c in before.dtype.names if c != "wall_time"]
    runs.check(process.returncode == 0 and len(before) == len(after) and
               all(np.array_equal(before[c], after[c], equal_nan=True) for c in columns), "series_goes_on",
               f"code {process.returncode}, {len(before)} lines before, {len(after)} after; {process.stderr[-300:]}")


def other_gravity():
    """Options may change at a restart, and the budget counts the energy that another gravity brings."""
    tank = SHAKEN + "-gravity_amplitude 0,0 "
    folder = runs.run(tank + "-steps_max 4", "gravity", 1)
    for name, options in (("half", "-gravity 0,-5"), ("same", "-time_cfl 0.1")):
        process = runs.start(f"{tank} {options} -steps_max 4 -restart {folder} -output_dir {runs.scratch(name)}")
        runs.check("within the error of its measurement" in process.stdout and
                   ("a changed scene" in process.stdout) == (name == "half"), f"gravity_{name}",
                   process.stdout[process.stdout.find("  energy"):][:500] + process.stderr[-300:])


def killed_by(name, scene, ranks, end):
    """Kills a run when it has written a checkpoint by the clock after its fifth step; the step of it, and its path."""
    folder = runs.scratch(name)
    words = (["mpiexec", "-n", str(ranks)] if ranks > 1 else []) + [runs.PROGRAM] + shlex.split(
        scene + f"-checkpoint_interval 0 -checkpoint_wall_clock 1e-9 -time_end {end} -output_dir {folder}")
    process = subprocess.Popen(words, cwd=runs.ROOT, env=runs.environment(ranks), stdin=subprocess.DEVNULL,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    path = os.path.join(folder, "checkpoint_clock.h5")
    while process.poll() is None:
        if os.path.exists(path) and runs.head(path)["step"] > 5:
            break
        time.sleep(1e-3)
    with open(os.path.join(folder, "run.lock"), encoding="utf-8") as file:
        first = int(file.read().split("process ")[1].split()[0])
    os.kill(first, signal.SIGKILL)  # of rank 0: mpiexec ends the others
    process.wait()
    return int(runs.head(path)["step"]), path


def clock():
    """Checkpoints by the clock: the run that writes them is to the last bit that which does not; one is kept, until the
    next other one; a run continued from it agrees to round-off if the solver is tight."""
    for name, scene, spacing, ranks, late in (("plane", PLANE, 0.02, 1, 0.3), ("plane_parallel", PLANE, 0.02, 2, 0.3),
                                              ("rings", RINGS, 1e-3, 1, 0.01)):
        end = f"-checkpoint_interval 0 -steps_max {STEPS} -ksp_rtol 1e-12 "
        without = runs.run(scene + end + "-checkpoint_wall_clock 0", f"{name}_without", ranks)
        often = runs.run(scene + end + "-checkpoint_wall_clock 1e-9", f"{name}_often", ranks)
        files = [runs.numbered(folder, "checkpoint") for folder in (without, often)]
        runs.check([len(f) for f in files] == [1, 1], f"clock_{name}_one_is_left", str(files))
        differing = runs.unlike(*(runs.fields(f[-1]) for f in files))
        runs.check(not differing, f"clock_{name}_changes_nothing", f"differing fields: {differing}")
        compare_series(f"clock_{name}_series", runs.series(without), runs.series(often))
        step, file = killed_by(f"{name}_killed", scene + "-ksp_rtol 1e-12 ", ranks, late)
        runs.check(runs.numbered(os.path.dirname(file), "checkpoint") == [file], f"clock_{name}_alone",
                   str(os.listdir(os.path.dirname(file))))
        more = 10
        whole = runs.run(scene + f"-checkpoint_interval 0 -checkpoint_wall_clock 0 -steps_max {step + more} "
                         "-ksp_rtol 1e-12", f"{name}_whole", ranks)
        rest = runs.run(scene + f"-checkpoint_interval 0 -steps_max {more} -ksp_rtol 1e-12 -restart {file}",
                        f"{name}_rest", ranks)
        a, b = (runs.fields(runs.numbered(folder, "checkpoint")[-1]) for folder in (whole, rest))
        moved = np.abs(a["position"] - b["position"]).max() / spacing if len(a["id"]) == len(b["id"]) else np.nan
        print(f"clock_{name}: continued from step {step}, positions differ by {moved:.2e} spacings")
        runs.check_below(moved, 100 * ROUND_OFF, f"clock_{name}_continues")


SCENES = {"impact": (IMPACT, 1e-3, 1, []), "impact_parallel": (IMPACT, 1e-3, 2, [1, 3]), "plane": (PLANE, 0.02, 1, [2]),
          "shaken": (SHAKEN, 0.02, 1, []), "touching": (TOUCHING, 0.02, 1, [2]),
          "rings": (RINGS, 1e-3, 2, [1]), "lens": (LENS, 1e-3, 1, [2]),
          "tori": (TORI, 1e-3, 1, [3]), "graded": (GRADED, 1e-3, 2, [1]), "graded_tori": (GRADED_TORI, 1e-3, 2, [1]),
          "following": (FOLLOWING, 1e-3, 2, [1]), "following_tori": (FOLLOWING_TORI, 1e-3, 1, [2])}
ALONE = {"inside": inside, "clock": clock, "gravity": other_gravity}
for part in runs.parts(*SCENES, *ALONE):
    if part in ALONE:
        ALONE[part]()
    else:
        test(part, *SCENES[part])
runs.done()
