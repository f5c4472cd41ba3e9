#!/usr/bin/python3
"""Full vessels in which solids move: liquid without a free surface, in which a void may open behind an edge or beside a
gap. With -gas a void is a pocket of the volume 0, so that no energy comes from its closing.

    confined.py                            the test: the quick scenes, two packings each, one of them on two ranks too
    confined.py --study [--seeds 5]        all scenes, so many packings on one rank and the first on --ranks, as a table
    confined.py --study --scenes NAME,...  some of them
    confined.py --study --readme           puts the table into cases/stirred_tank/README.md

Each run must come to its end, and its largest kinetic energy must be within a factor of 1.5 of the median of the
packings."""
import argparse
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

MOST = 1.5  # of the median: a void that closes without -gas takes the energy up by 2 to 10^17
QUICK = {"lid": 0.3, "piston": 0.15, "honey": 0.1}  # s
README = os.path.join(runs.ROOT, "cases", "stirred_tank", "README.md")
ALL = "-gas -bodies liquid -liquid_viscosity 0.01 -snapshot_interval 10 -checkpoint_interval 0 -series_interval 0 "
PLANE = ALL + "-dimension 2 -spacing 5e-3 -box_x wall -box_y wall "
SQUARE = PLANE + "-box_lower -0.1,-0.1 -box_upper 0.1,0.1 "
CUBE = ALL + """-dimension 3 -spacing 0.0125 -box_x wall -box_y wall -box_z wall -box_lower -0.1,-0.1,-0.1
 -box_upper 0.1,0.1,0.1 """
BALL = "-solids ball -ball_shape sphere "


def box(depth, half, thick, motion):
    """Six solids, or four in the plane, around a full box whose half width is given; all have the motion."""
    text, names = "", []
    for axis in range(depth):
        for side in (-1, 1):
            high = [half + thick] * axis + [half] * (depth - axis)
            low = [-x for x in high]
            low[axis], high[axis] = sorted((side * half, side * (half + thick)))
            name = "xyz"[axis] + ("low" if side < 0 else "high")
            names.append(name)
            text += f"-{name}_lower {','.join(map(str, low))} -{name}_upper {','.join(map(str, high))} "
            text += " ".join(f"-{name}_{option}" for option in motion) + " "
    inner = ",".join([str(half)] * depth)
    return f"-solids {','.join(names)} -liquid_lower -{inner.replace(',', ',-')} -liquid_upper {inner} " + text


def course(name, rows):
    """A file of a motion in the scratch folder."""
    path = runs.scratch(name)
    np.savetxt(path, rows, delimiter=",", fmt="%.6g")
    return path


def scenes():
    """Options by the name of the scene."""
    turn = [(t, 0, 0, 180 * min(t / 0.4, 1) - 180 / (2 * np.pi) * np.sin(2 * np.pi * min(t / 0.4, 1)))
            for t in np.linspace(0, 0.8, 81)]
    press = [(t, 0, -0.04 * (1 - np.cos(np.pi * min(t / 0.4, 1)))) for t in np.linspace(0, 0.8, 81)]
    stopped = [f"motion_file {course('turn.csv', turn)}", "rotation_center 0,0"]
    return {
        "lid": SQUARE + """-liquid_viscosity 0.5 -box_ymax_velocity 1,0 -solids block -block_lower -0.03,-0.03
 -block_upper 0.03,0.03 -time_end 0.6""",
        "gears": PLANE + """-box_lower -0.15,-0.1 -box_upper 0.15,0.1 -solids left,right -left_lower -0.12,-0.01
 -left_upper 0.02,0.01 -right_lower 0.04,-0.07 -right_upper 0.06,0.07 -left_rotation_rate 6.2831853
 -right_rotation_rate -6.2831853 -left_rotation_center -0.05,0 -right_rotation_center 0.05,0 -time_end 0.6""",
        "piston": PLANE + """-box_lower -0.2,-0.05 -box_upper 0.2,0.05 -solids piston -piston_lower -0.03,-0.04
 -piston_upper 0.03,0.04 -piston_oscillation_amplitude 0.08,0 -piston_oscillation_frequency 1
 -piston_oscillation_phase -90 -time_end 0.5""",
        "honey": SQUARE + """-liquid_viscosity 10 -solids paddle -paddle_lower -0.07,-0.01 -paddle_upper 0.07,0.01
 -paddle_rotation_rate 6.2831853 -time_end 0.3""",
        "turn and stop": ALL + "-dimension 2 -spacing 5e-3 -box_lower -0.2,-0.2 -box_upper 0.2,0.2 " +
                         box(2, 0.1, 0.03, stopped) + "-time_end 0.6",
        "shaken": SQUARE + BALL + """-ball_center 0,0 -ball_radius 0.03 -ball_oscillation_amplitude 0.04,0
 -ball_oscillation_frequency 2 -time_end 0.5""",
        "falling": PLANE + BALL + """-box_lower -0.1,-0.15 -box_upper 0.1,0.15 -gravity 0,-9.81 -ball_center 0,0.08
 -ball_radius 0.03 -ball_mass 8.5 -time_end 0.5""",
        "squeeze film": SQUARE + f"""-solids plate -plate_lower -0.06,-0.005 -plate_upper 0.06,0.015
 -plate_motion_file {course('press.csv', press)} -time_end 0.6""",
        "falling as rings": ALL + BALL + """-dimension axisymmetric -spacing 5e-3 -box_lower 0,-0.15 -box_upper 0.1,0.15
 -box_xmax wall -box_y wall -gravity 0,-9.81 -ball_center 0,0.08 -ball_radius 0.03 -ball_mass 0.339 -time_end 0.5""",
        "shaken in 3-d": CUBE + BALL + """-ball_center 0,0,0 -ball_radius 0.04 -ball_oscillation_amplitude 0.03,0,0
 -ball_oscillation_frequency 2 -time_end 0.3""",
        "stirred in 3-d": CUBE + """-solids paddle -paddle_lower -0.07,-0.015,-0.05 -paddle_upper 0.07,0.015,0.05
 -paddle_rotation_rate 0,0,6.2831853 -time_end 0.3""",
        "cup with a lid": ALL + "-dimension 3 -spacing 0.0125 -box_lower -0.19,-0.19,-0.19 -box_upper 0.19,0.19,0.19 " +
                          box(3, 0.1, 0.04, ["rotation_rate 0,0,7", "rotation_center 0,0,0"]) + "-time_end 0.3"}


def tried(options, seed, ranks):
    """The largest kinetic energy of a run; if it does not come to its end, inf and the sentence."""
    folder = runs.scratch(f"run{tried.count}")
    tried.count += 1
    process = runs.start(f"{options} -packing_seed {seed} -progress_interval 0 -output_dir {folder}", ranks, 600)
    if process.returncode:
        return np.inf, process.stderr.strip()[-300:]
    return runs.series(folder)["kinetic_energy"].max(), ""


tried.count = 0


def judged(options, seeds, ranks):
    """(energies over their median of the seeds on one rank, that of seed 1 on more, median, sentences)"""
    found = [tried(options, seed, 1) for seed in range(1, seeds + 1)]
    two = tried(options, 1, ranks) if ranks > 1 else found[0]
    energy = np.array([e for e, _ in found])
    middle = np.median(energy[np.isfinite(energy)]) if np.isfinite(energy).any() else np.nan
    return energy / middle, two[0] / middle, middle, [why for e, why in found + [two] if not np.isfinite(e)]


def quick():
    """The test: scenes of a second or two."""
    for name, end in QUICK.items():
        share, two, _, why = judged(f"{scenes()[name]} -time_end {end}", 2, 2)
        tag = name.replace(" ", "_")
        runs.check(not why, f"{tag}_runs_to_the_end", " ".join(why))
        for kind, ratio in (("two_packings", share.max()), ("two_ranks", max(two, 1 / two))):
            runs.check(ratio < MOST, f"{tag}_energy_in_{kind}", f"{ratio:.3g} times the median, at most {MOST}")
    runs.done()


def study(names, seeds, ranks, readme):
    rows = ["| vessel | largest kinetic energy, J, median | least and largest over it | on " +
            f"{ranks} ranks over 1, seed 1 |", "| --- | --- | --- | --- |"]
    for name, options in scenes().items():
        if names and name not in names:
            continue
        share, two, middle, why = judged(options, seeds, ranks)
        unit = "/m" if "-dimension 2" in options else ""
        rows.append(f"| {name} | {middle:.3g}{unit} | {share.min():.2f}, {share.max():.2f} | "
                    f"{two / share[0]:.2f} |")
        print(rows[-1], np.round(share, 3), *why, flush=True)
    if readme:
        runs.replace(README, "confined", "\n" + "\n".join(rows) + "\n")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--study", action="store_true")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--scenes", default="")
    parser.add_argument("--readme", action="store_true")
    arguments = parser.parse_args()
    if not arguments.study:
        quick()
    study([n for n in arguments.scenes.split(",") if n], arguments.seeds, arguments.ranks,
          arguments.readme)
