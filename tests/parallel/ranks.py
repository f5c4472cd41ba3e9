#!/usr/bin/python3
"""The same scene on 1, 2, 3 and 4 ranks, particle by particle, with -ksp_rtol 1e-12.

Sums over neighbours and the solver's dot products run in another order on another number of ranks. After 20 steps
positions differ by at most 2e-14 spacings (measured), with the scheme of the paper by 3e-13: TOLERANCE leaves room for
other machines and none for a lost neighbour, which makes 1e-6. The liquid is thin enough here that the surface
tension's band covers it: the band ends at cells that another rank lays otherwise."""
import os
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

# A drop into a film in a corner of two mirrors, a wall on the floor and one side, open elsewhere; contact at step 4.
SPLASH = """-spacing 0.8e-3 -box_lower 0,0,-6.4e-3 -box_upper 12e-3,12e-3,12e-3 -box_xmin symmetry -box_ymin symmetry
 -box_ymax wall -box_zmin wall -gravity 0,0,-9.81 -bodies film,drop -film_lower 0,0,-6.4e-3 -film_upper 12e-3,12e-3,0
 -film_density 1100 -film_viscosity 3.5e-3 -film_tension 0.067 -drop_shape sphere -drop_radius 3e-3
 -drop_center 0,0,5.2e-3 -drop_velocity 0,0,-3 -drop_density 1100 -drop_viscosity 3.5e-3 -drop_tension 0.067
 -time_step 4e-5 """
# The scheme of the paper between mirrors, where a lattice would be thrown apart at the start.
PAPER = SPLASH + """-box_xmax symmetry -box_ymax symmetry -scheme density_invariant -packing_type poisson
 -packing_cache '' """
# In the plane, periodic: sideways through the periodic faces, several spacings.
PERIODIC_2D = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,1 -box_x periodic -box_ymin wall
 -gravity 0,-9.81 -bodies film,drop -film_upper 1,0.12 -film_velocity 3,0 -drop_shape sphere -drop_radius 0.15
 -drop_center 0.5,0.33 -drop_velocity 4,-2 -film_tension 20 -drop_tension 20 -time_step 1e-3 """
# Two bodies that float, in thick liquid, over the borders of ranks.
FLOATING = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,1 -box_x wall -box_ymin wall -gravity 0,-9.81
 -bodies film -film_upper 1,0.5 -film_viscosity 0.1 -solids float,other -float_lower 0.3,0.4 -float_upper 0.5,0.6
 -float_mass 15 -float_rotation_rate 2 -other_shape sphere -other_radius 0.08 -other_center 0.7,0.45 -other_mass 10
 -viscosity_solver implicit -viscous_ksp_rtol 1e-13 -time_step 1e-3 """
# One drop in a large box: three of four ranks have nothing to do at first.
LONELY = """-spacing 1e-3 -box_lower -40e-3,-40e-3,-40e-3 -box_upper 40e-3,40e-3,40e-3 -bodies drop -drop_shape sphere
 -drop_radius 1.2e-3 -drop_center 20e-3,20e-3,20e-3 -drop_velocity 0,0,-1 -gravity 0,0,-9.81 -drop_tension 0.067
 -time_step 1e-4 """
# Rings: the same splash around an axis, a ball in the film and a jet with the form of a tube. Rounding, 2e-15 after 8
# steps, grows threefold in each step from the twelfth on.
RINGS = """-dimension axisymmetric -spacing 0.8e-3 -box_lower 0,-6.4e-3 -box_upper 16e-3,12e-3 -box_xmax wall
 -box_ymin wall -gravity 0,-9.81 -bodies film,drop,jet -film_lower 0,-6.4e-3 -film_upper 16e-3,0 -film_density 1100
 -film_viscosity 3.5e-3 -film_tension 0.067 -drop_shape sphere -drop_radius 3e-3 -drop_center 0,5.2e-3
 -drop_velocity 0,-3 -drop_density 1100 -drop_viscosity 3.5e-3 -drop_tension 0.067 -time_step 4e-5
 -solids ball -ball_shape sphere -ball_radius 2e-3 -ball_center 0,-3.2e-3 -ball_velocity 0,1
 -jet_type emitter -jet_lower 8e-3,3.2e-3 -jet_upper 11.2e-3,4e-3 -jet_velocity 0,-2 -jet_tension 0.067
 -viscosity_solver implicit -viscous_ksp_rtol 1e-14 -film_viscosity_model carreau
 -film_viscosity_exponent 0.5 -film_viscosity_time 0.1 -drop_viscosity_model herschel_bulkley -drop_yield_stress 5
 -steps_max 16 """
# Two rings of liquid, one that grows thin and one that grows fat: particles join and split.
TORI = """-dimension axisymmetric -spacing 1e-3 -box_lower 0,-10e-3 -box_upper 30e-3,12e-3 -box_ymin wall
 -gravity 0,-9.81 -bodies a,b -a_shape sphere -a_radius 2.6e-3 -a_center 4e-3,0 -a_velocity 3,0 -a_viscosity 3.5e-3
 -a_tension 0.067
 -b_shape sphere -b_radius 2.6e-3 -b_center 16e-3,7e-3 -b_velocity -3,-2 -b_viscosity 3.5e-3 -b_tension 0.067
 -time_step 8e-5 """
# The same of different sizes.
GRADED_TORI = TORI + """-spacing_coarse 2e-3 -spacing_growth 0.2 -fine core -core_lower 0,-4e-3 -core_upper 5e-3,12e-3
 -viscosity_solver implicit -viscous_ksp_rtol 1e-13 """
# Particles of different sizes, some of which join: a drop into a film, both finer where they meet, near periodic and
# mirror faces.
GRADED = """-spacing 1e-3 -spacing_coarse 1.8e-3 -box_lower 0,0,-6e-3 -box_upper 36e-3,12e-3,12e-3 -box_x periodic
 -box_ymin symmetry -box_zmin wall -gravity 0,0,-9.81 -bodies film,drop -film_lower 0,0,-6e-3 -film_upper 36e-3,12e-3,0
 -film_viscosity 3.5e-3 -film_tension 0.067 -drop_tension 0.067
 -drop_shape sphere -drop_radius 3e-3 -drop_center 6e-3,0,4e-3 -drop_velocity 1,0.5,-3
 -fine core -core_shape sphere -core_radius 4e-3 -core_center 6e-3,0,2e-3 -spacing_growth 0.2 -time_step 4e-5
 """
# The spacing follows surfaces: particles of both bodies split and join.
FOLLOWING = (GRADED.split("-fine")[0] + "-spacing_growth 0.2 -spacing_follow curvature "
             "-time_step 4e-5 ")
FOLLOWING_TORI = TORI + "-spacing_coarse 2e-3 -spacing_growth 0.2 -spacing_follow surface "
# A drop that wets the floor, is repelled by a wall that has an angle of its own, and by a ball that moves.
WETTED = """-spacing 0.8e-3 -box_lower 0,0,0 -box_upper 12e-3,9.6e-3,8e-3 -box_x wall -box_y periodic -box_zmin wall
 -wall_contact_angle 60 -box_xmin_contact_angle 110 -gravity 0,0,-9.81 -bodies drop -drop_shape sphere
 -drop_radius 4e-3 -drop_center 3.2e-3,8e-3,1e-3 -drop_tension 0.067 -drop_viscosity 3.5e-3 -solids ball
 -ball_shape sphere -ball_radius 2.4e-3 -ball_center 7e-3,8e-3,2e-3 -ball_velocity 0,0,0.1 -ball_contact_angle 120
 -wall_contact_hysteresis 30 -ball_contact_hysteresis 20
 -time_step 4e-5 """
MOVING_LINE = WETTED + "-wall_contact_law cox_voinov "
# A drop of one liquid sinks into the surface of another, between walls.
LENS = """-dimension 2 -spacing 0.8e-3 -box_lower 0,0 -box_upper 16e-3,12e-3 -box_x wall -box_ymin wall -gravity 0,-9.81
 -bodies drop,bath -bodies_overlap -drop_shape sphere -drop_radius 3e-3 -drop_center 4e-3,4.8e-3 -drop_density 700
 -drop_tension 0.03 -drop_velocity 0,-0.2 -bath_upper 16e-3,5.6e-3 -bath_viscosity 3.5e-3 -bath_tension 0.067
 -interface_tension 0.045 -time_step 1e-4 """
TOLERANCE = 1e-10  # spacings
SETTLED = 1e-6     # the same of packings: 20 iterations of sums in single precision differ by 3e-7
COMMON = "-ksp_rtol 1e-12 "


def compare(name, scene, ranks, spacing, velocity, tolerance):
    """Runs from one start on 1 and on the given numbers of ranks and compares the final states by id."""
    start = runs.numbered(runs.run(COMMON + scene + "-steps_max 1", name + "_start"), "checkpoint")[-1]
    scene = "-steps_max 20 " + scene + f"-restart {start} "
    one = runs.fields(runs.numbered(runs.run(COMMON + scene, name + "_1"), "checkpoint")[-1])
    for n in ranks:
        many = runs.fields(runs.numbered(runs.run(COMMON + scene, f"{name}_{n}", n), "checkpoint")[-1])
        if not runs.check(np.array_equal(one["id"], many["id"]), f"{name}_{n}_ids", "other particles"):
            continue
        moved = np.abs(one["position"] - many["position"]).max() / spacing
        speed = np.abs(one["velocity"] - many["velocity"]).max() / velocity
        flags = int((one["surface"] != many["surface"]).sum())
        print(f"{name} on {n} ranks: positions {moved:.2e} spacings, velocities {speed:.2e} of U, {flags} flags differ")
        runs.check_below(moved, tolerance, f"{name}_{n}_positions")
        runs.check_below(speed, 10 * tolerance, f"{name}_{n}_velocities")
        runs.check_below(flags, 0, f"{name}_{n}_flags")


def settled():
    """Packings that are evened out, of all kinds, on several numbers of ranks."""
    for name in ("splash", "rings", "graded", "following", "floating", "wetted", "lens", "lonely"):
        scene, _, spacing, _ = SCENES[name]
        scene += "-steps_max 1 -snapshot_interval 1 -snapshot_double"
        first = [runs.fields(runs.numbered(runs.run(COMMON + scene, f"settled_{name}_{n}", n), "snapshot")[0])
                 for n in (1, 2, 3)]
        for n, many in zip((2, 3), first[1:]):
            if runs.check(np.array_equal(first[0]["id"], many["id"]), f"settled_{name}_{n}_ids", "other particles"):
                moved = np.abs(first[0]["position"] - many["position"]).max() / spacing
                runs.check_below(moved, SETTLED, f"settled_{name}_{n}_positions")


def crowded():
    """Many ranks on few processors leave them to each other without being told: otherwise a step takes seconds."""
    ranks = 4 * os.cpu_count()
    if ranks > 16:
        print("skipped: this machine has too many processors to crowd them")
        return
    environment = runs.environment(ranks)
    del environment["OMPI_MCA_mpi_yield_when_idle"]
    words = ["mpiexec", "-n", str(ranks), "--host", f"localhost:{ranks}", runs.PROGRAM]
    words += runs.shlex.split(PERIODIC_2D + "-steps_max 20 -wall_clock_limit 20 -output_dir " + runs.scratch("crowded"))
    done = subprocess.run(words, cwd=runs.ROOT, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=200, check=False)
    runs.check(done.returncode == 0 and "\n20 steps of" in done.stdout, "crowded_20_steps_in_20_s", done.stdout[-500:])


SCENES = {"splash": (SPLASH, (2, 3, 4), 0.8e-3, 3), "splash_paper": (PAPER, (2, 3), 0.8e-3, 3),
          "rings": (RINGS, (2, 4), 0.8e-3, 3), "tori": (TORI, (2, 4), 1e-3, 3), "graded": (GRADED, (2, 4), 1e-3, 3),
          "graded_tori": (GRADED_TORI, (2, 4), 1e-3, 3), "following": (FOLLOWING, (2, 4), 1e-3, 3),
          "following_tori": (FOLLOWING_TORI, (2, 4), 1e-3, 3), "periodic_2d": (PERIODIC_2D, (2, 3, 4), 0.02, 4),
          "floating": (FLOATING, (2, 3, 4), 0.02, 1), "wetted": (WETTED, (2, 4), 0.8e-3, 1),
          "moving_line": (MOVING_LINE, (2, 4), 0.8e-3, 1),
          "lens": (LENS, (2, 3, 4), 0.8e-3, 1), "lonely": (LONELY, (2, 4), 1e-3, 1)}
for part in runs.parts(*SCENES, "settled", "crowded"):
    if part in SCENES:
        compare(part, *SCENES[part], TOLERANCE)
    elif part == "settled":
        settled()
    else:
        crowded()
runs.done()
