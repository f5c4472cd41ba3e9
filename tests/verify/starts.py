#!/usr/bin/python3
"""A start is at rest: a pool that waits for its drop gets neither speed nor pressure from its packing; the force on the
floor of a tank is the weight of its water from the first steps on, in which it was 0.41 to 1.23 of it before packings
were evened out."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

IMPACT = "-options_file cases/drop_impact/case.opts -options_file options/quarter.opts "
SCENES = {  # options, head of the liquid in Pa: hydrostatic at the floor and the drop's 2 sigma / R
    "rings": ("-options_file cases/deep_pool/rings.opts ", 1000 * 9.81 * 16e-3 + 72),
    "quarter": (IMPACT + "-spacing 0.7e-3 ", 1100 * 9.81 * 10e-3 + 67),
    "graded": (IMPACT + "-options_file cases/drop_impact/graded.opts -spacing 0.5e-3 -spacing_coarse 2e-3 ",
               1100 * 9.81 * 10e-3 + 67),
}

WEIGHT = 1000 * 9.81 * 0.3  # N/m
TANK = """-dimension 2 -spacing 0.01 -box_lower 0,0 -box_upper 1,0.6 -box_x wall -box_ymin wall -gravity 0,-9.81
 -bodies water -water_upper 1,0.3 -time_end 0.05 -series_interval 1e-9 """
TANKS = {"uniform": "", "solid": "-solids post -post_lower 0.45,0 -post_upper 0.55,0.1 ",
         "graded": "-spacing_coarse 0.02 -fine core -core_lower 0.3,0 -core_upper 0.6,0.3 ",
         "following": "-spacing_coarse 0.02 -spacing_follow surface ",
         "quintic": "-kernel_type quintic_spline -kernel_ratio 1 "}

BALL = """-dimension axisymmetric -spacing 0.625e-3 -box_lower 0,0 -box_upper 20e-3,40e-3 -box_xmax wall -box_ymin wall
 -gravity 0,-9.81 -bodies syrup -syrup_upper 20e-3,35e-3 -solids ball -ball_shape sphere -ball_radius 5e-3
 -ball_center 0,18e-3 -ball_mass 1e-3 -steps_max 1 -time_end 1 -ksp_converged_reason -checkpoint_interval 0"""


def tank(kind):
    """The force on the floor of a tank, and on a post on it, over the weight."""
    for seed in 1, 2:
        folder = runs.run(TANK + TANKS[kind] + f"-gauge_forces -packing_seed {seed}", f"tank {kind} {seed}")
        rows = runs.series(folder)[1:]
        force = -sum(rows[name] for name in rows.dtype.names if name.startswith(("force_ymin_y", "force_post_y")))
        force /= WEIGHT * (29 / 30 if kind == "solid" else 1)  # less what the post displaces
        print(f"tank {kind}, seed {seed}: force on the floor {force.min():.3f} to {force.max():.3f} of the weight")
        runs.check_within(force.min(), 0.97, 1.02, f"tank, {kind}, seed {seed}, least force over the weight")
        runs.check_within(force.max(), 0.97, 1.03, f"tank, {kind}, seed {seed}, most force over the weight")


def solves():
    """No solve of the settling is dear: the preconditioner of the lattice is not kept for what has settled."""
    for kind, most in ("twolevel", 1.6), ("jacobi", 3):
        done = runs.start(f"{BALL} -pc_type {kind} -output_dir {runs.scratch('solves_' + kind)}")
        iterations = [int(line.split()[-1]) for line in done.stdout.splitlines() if "converged due to" in line]
        runs.check(len(iterations) > 20, f"the settling solves, {kind}", done.stdout + done.stderr)
        runs.check_below(iterations[1] / iterations[0], most, f"second solve of the settling over the first, {kind}")


AWAY = f"""-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 2,1.4 -box_x periodic -box_ymin wall -gravity 0,-9.81
 -bodies film -film_upper 2,0.3 -solids part -time_start 1 -time_end 2 -steps_max 1
 -part_motion_file {runs.scratch("way.csv")} """


def away():
    """A solid that its motion has taken elsewhere before the start has the dummies of its shape there."""
    turn, shift, center = np.radians(30), np.array([0.9, 0.3]), np.array([0.4, 0.65])
    rotate = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    for name, shape in (("box", "-part_lower 0.2,0.5 -part_upper 0.6,0.8"),
                        ("disc", "-part_shape sphere -part_radius 0.15 -part_center 0.4,0.65")):
        places = []
        for x, y, angle in ((0, 0, 0), (*shift, np.degrees(turn))):
            with open(runs.scratch("way.csv"), "w", encoding="utf-8") as file:
                file.writelines(f"{time},{x},{y},{angle}\n" for time in (0, 9))
            folder = runs.run(AWAY + shape + " -part_rotation_center 0.4,0.65", f"{name}{angle:.0f}")
            f = runs.fields(runs.numbered(folder, "checkpoint")[-1])
            places.append(f["position"][f["body"] < -1][:, :2])
        if runs.check(len(places[0]) == len(places[1]), f"{name}: as many dummies", [len(p) for p in places]):
            moved = (places[0] - center) @ rotate.T + center + shift
            runs.check_below(abs(places[1] - moved).max() / 0.05, 1e-9, f"{name}: each where the motion has it")


for part in runs.parts(*SCENES, *(f"tank_{kind}" for kind in TANKS), "solves", "away"):
    if part in ("solves", "away"):
        {"solves": solves, "away": away}[part]()
        continue
    if part not in SCENES:
        tank(part[len("tank_"):])
        continue
    options, head = SCENES[part]
    for seed in 1, 2, 3:
        folder = runs.run(f"{options} -packing_seed {seed} -time_end 0 -snapshot_interval 0.1e-3 -series_interval 1e-9",
                          f"{part} {seed}")
        rows = runs.series(folder)
        energy = rows["kinetic_energy"] + rows["potential_energy"]  # what falls gains by right
        gain = (energy.max() - energy[0]) / rows["kinetic_energy"][0]
        runs.check_below(gain, 0.02, f"{part}, seed {seed}, energy gained before contact")
        first = [abs(fields["pressure"]).max() for _, time, fields in physics.snapshots(folder)][1:3]
        runs.check_below(max(first), 2.5 * head, f"{part}, seed {seed}, pressure in the first 0.2 ms, Pa")
runs.done()
