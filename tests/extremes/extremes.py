#!/usr/bin/python3
"""Runs at the extremes of what a scene may ask for. Each one works, is handled by a mechanism that the table names, is
refused with a sentence before the first step, or is stopped by a watch with a sentence and a checkpoint.

    tests/extremes/extremes.py [--all] [--only NAME] [--folder output/extremes] [--readme]

With --all (make extremes) every run, a table, and the stability map as extremes.csv and extremes.png in the folder;
without, the short part in make test; with --readme (make extremes-readme) the table of the README beside this file
and the map, from the folder. A run works when it ends with code 0 and, judged by its series,
  - all values are numbers and no particle was lost (unless the scene throws some out),
  - kinetic, potential and (as far as it is measured) surface energy together never rise above their lowest sum so far
    by more than ENERGY of what the scene has at hand, SURFACE where it has tension,
  - the density error is at most DENSITY.
It is 'handled' when, besides, steps were rolled back or the viscosity was implicit where an explicit one would have
needed shorter steps."""
import argparse
import math
import os
import sys
from re import search
from typing import NamedTuple

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import report  # noqa: E402
import runs  # noqa: E402

ENERGY = 0.05  # of the energy at hand
SURFACE = 0.1  # where the area of the surface counts, which is measured to about that while two parts meet
DENSITY = 0.1  # rms of (rho - rho0)/rho0 inside
RHO = 1000.0  # kg/m3


class Trial(NamedTuple):
    """One run: a point 'value' on an axis; short: part of make test; energy: at hand (J/m), none: what the run
    begins with and falls through; refused: words of the sentence that must refuse it."""
    axis: str
    value: str
    options: str
    energy: float = None
    short: bool = False
    refused: tuple = ()
    ranks: int = 1
    throws: bool = False
    explicit: float = 0  # the explicit limit of the viscosity, s; 0: none


TRIALS = []


def impact(axis, value, speed=1.0, mu=1e-3, sigma=0.0, g=0.0, diameter=1e-3, across=10, extra="", end=1.0, **more):
    """A drop (diameter m, 'across' spacings) falls into a film of half its depth, in the plane; time in diameters over
    speed, or 'extra' says."""
    d0 = diameter / across
    depth, width = 0.5 * diameter, 3 * diameter
    drop, film = math.pi / 4 * diameter**2, depth * width  # m2, of one metre
    at_hand = RHO * drop * (speed**2 / 2 + g * 1.5 * diameter) + sigma * (math.pi * diameter + width)
    options = (f"-dimension 2 -spacing {d0} -box_lower {-width / 2},{-depth} -box_upper {width / 2},{4 * diameter} "
               f"-box_x periodic -box_ymin wall -gravity 0,{-g} -bodies film,drop -film_upper {width / 2},0 "
               f"-film_viscosity {mu} -drop_viscosity {mu} -film_tension {sigma} -drop_tension {sigma} "
               f"-drop_shape sphere -drop_radius {diameter / 2} -drop_center 0,{0.5 * diameter + d0} "
               f"-drop_velocity 0,{-speed} -steps_max 400 ")
    scale = diameter / speed if speed else 0
    if scale:
        options += f"-time_end {end * scale} "
    h = 1.3 * d0  # smoothing length of the default
    TRIALS.append(Trial(axis, value, options + extra, at_hand, explicit=0.08 * h * h * RHO / mu if mu else 0, **more))
    return film


def relaxing(axis, value, oh, across=10, extra="", **more):
    """An ellipse relaxes to a circle; Oh = mu/sqrt(rho sigma D)."""
    diameter, sigma = 1e-3, 0.07
    d0, mu = diameter / across, oh * math.sqrt(RHO * sigma * diameter)
    radii = f"{0.65 * diameter},{diameter / 2.6}"
    options = (f"-dimension 2 -spacing {d0} -box_lower {-diameter},{-diameter} -box_upper {diameter},{diameter} "
               f"-bodies drop -drop_shape ellipsoid -drop_radii {radii} -drop_viscosity {mu} "
               f"-drop_tension {sigma} -steps_max 150 -time_end {0.5 * math.sqrt(RHO * diameter**3 / sigma)} ")
    h = 1.3 * d0
    TRIALS.append(Trial(axis, value, options + extra, sigma * 3.5 * diameter, explicit=0.08 * h * h * RHO / mu, **more))


for exponent in range(-3, 7):  # no tension, no gravity
    re = 10.0**exponent
    impact("Reynolds", f"1e{exponent}", mu=RHO * 1e-3 / re, short=exponent in (-3, 6))
TRIALS.append(Trial("Weber", "0", TRIALS[0].options.replace("-drop_velocity 0,-1.0", "-drop_velocity 0,0").replace(
    "_tension 0.0", "_tension 0.07").replace("_viscosity 1000.0", "_viscosity 0.01"), 0.07 * 7e-3))
for exponent in range(-1, 6):  # Re 100
    we = 10.0**exponent
    impact("Weber", f"1e{exponent}", mu=1e-2, sigma=RHO * 1e-3 / we, short=exponent in (-1, 5))
for exponent in range(-4, 3):
    relaxing("Ohnesorge", f"1e{exponent}", 10.0**exponent, short=exponent == 2)
for bond in (0, 1e-2, 0.1, 1, 10, 100, 1000):  # the drop at rest above the film falls in
    fall = bond * 0.07 / (RHO * 1e-6)
    impact("Bond", f"{bond:g}", speed=0, sigma=0.07, g=fall,
           extra=f"-time_end {0.5 * math.sqrt(RHO * 1e-9 / (0.07 * (1 + bond)))}", short=bond == 1000)
impact("exactly zero", "viscosity", mu=0, sigma=0.07, g=9.81)
impact("exactly zero", "tension", mu=1e-3, g=9.81)
impact("exactly zero", "gravity", mu=1e-3, sigma=0.07)
impact("exactly zero", "all three", mu=0, short=True)
impact("exactly zero", "all and speed", speed=0, mu=0, extra="-time_end 1", refused=("-time_step",), short=True)
for speed in (0.1, 1, 10, 30, 100):  # water, 2 mm
    impact("impact (m/s)", f"{speed:g}", speed=speed, sigma=0.072, g=9.81, diameter=2e-3, throws=True,
           short=speed == 100)
impact("two liquids", "thin drop, thick film", mu=10, sigma=0.07, extra="-drop_viscosity 1e-3", short=True)
impact("two liquids", "thick drop, thin film", mu=10, sigma=0.07, extra="-film_viscosity 1e-3")
for light in (1000 / 1.5, 500):
    impact("two liquids", f"density 1:{1000 / light:g}", mu=1e-3, extra=f"-drop_density {light}")
impact("two liquids", "density 1:10", mu=1e-3, extra="-film_density 100", refused=("-film_density", "at most 2"),
       short=True)
for cfl in (0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1):
    impact("CFL", f"{cfl:g}", mu=1e-2, sigma=0.02, extra=f"-time_cfl {cfl}", short=cfl == 1)
for step in (1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2):
    impact("fixed step (s)", f"{step:g}", mu=1e-2, sigma=0.02,
           extra=f"-time_step {step} -time_end {min(1e-3, 200 * step)}", short=step == 1e-3)
for ratio in (1.05, 1.1, 1.2, 1.3, 1.5, 1.8, 2.2):
    impact("h/d0", f"{ratio:g}", mu=1e-2, sigma=0.02, extra=f"-kernel_ratio {ratio}")
for exponent in range(-1, -13, -1):
    if exponent in (-1, -2, -3, -4, -6, -8, -10, -12):
        impact("solver tolerance", f"1e{exponent}", mu=1e-2, sigma=0.02, extra=f"-ksp_rtol 1e{exponent}")
for across in (4, 6, 8, 16, 32, 64):
    impact("drop (spacings)", f"{across}", mu=1e-2, sigma=0.02, across=across, end=1 if across < 32 else 0.1)
for layers in (1, 2, 3):
    impact("film (layers)", f"{layers}", mu=1e-2, sigma=0.02, across=10,
           extra=f"-box_lower -1.5e-3,{-layers * 1e-4}", short=layers == 1)

PLACE = "-dimension 2 -spacing 0.01 -box_lower -0.1,-0.1 -box_upper 0.1,0.1 "
CELLS = {"one particle": "0.01,0.01", "a pair": "0.02,0.01", "cluster of 8": "0.04,0.02"}
for name, upper in CELLS.items():
    TRIALS.append(Trial("few particles", name, PLACE + "-bodies a -a_lower 0,0 -a_upper " + upper + " -a_tension 0.07 "
                        "-a_velocity 0.1,0 -gravity 0,-1 -time_end 0.2", short=True))
TRIALS += [
    Trial("few particles", "none", PLACE + "-bodies a -a_lower 0,0 -a_upper 0.001,0.001 -gravity 0,-1 -time_end 1",
          refused=("a",), short=True),
    Trial("few particles", "head on, meeting exactly", PLACE + "-bodies a,b -a_lower -0.05,0 -a_upper -0.04,0.01 "
          "-b_lower 0.04,0 -b_upper 0.05,0.01 -a_velocity 1,0 -b_velocity -1,0 -time_step 1e-3 -time_end 0.1", 2 * 0.05,
          short=True),
    Trial("few particles", "onto its mirror image", PLACE + "-box_lower 0,-0.1 -box_xmin symmetry -bodies a "
          "-a_lower 0.04,0 -a_upper 0.05,0.01 -a_velocity -1,0 -time_step 1e-3 -time_end 0.06", 0.05),
    Trial("scenes", "drop pinned between walls", PLACE + "-box_y wall -box_lower -0.1,-0.05 -box_upper 0.1,0.05 "
          "-bodies a -a_shape sphere -a_radius 0.055 -a_center 0,0 -a_tension 1 -time_end 0.1 -steps_max 200"),
    Trial("scenes", "in a corner of walls", PLACE + "-box_x wall -box_ymin wall -bodies a -a_upper -0.02,-0.02 "
          "-gravity 0,-9.81 -time_end 0.1", RHO * 0.08**3 * 9.81 / 2, short=True),
    Trial("scenes", "full box, no free surface", PLACE + "-box_x periodic -box_y periodic -bodies a "
          "-a_velocity_type formula "
          "-a_velocity_formula 0-cos(10*pi*x)*sin(10*pi*y),sin(10*pi*x)*cos(10*pi*y) -time_end 0.05", RHO * 0.04 / 4,
          short=True),
    Trial("scenes", "closed full box of walls", PLACE + "-box_x wall -box_y wall -bodies a -gravity 0,-9.81 "
          "-time_end 0.1", RHO * 0.2**3 * 9.81 / 2),
    Trial("scenes", "four floating drops", PLACE + "".join(
        f"-{n}_shape sphere -{n}_radius 0.02 -{n}_center {x},{y} -{n}_velocity {-x},{-y} -{n}_tension 1 "
        for n, x, y in (("a", -0.05, -0.05), ("b", 0.05, -0.05), ("c", -0.05, 0.05), ("d", 0.05, 0.05)))
          + "-bodies a,b,c,d -time_end 0.3", short=True),
    Trial("scenes", "box just wide enough", PLACE + "-box_x periodic -box_lower -0.04,-0.1 -box_upper 0.04,0.1 "
          "-box_ymin wall -bodies a -a_upper 0.04,0 -gravity 0,-9.81 -steps_max 50 -time_end 1",
          RHO * 0.08 * 0.1**2 * 9.81 / 2, short=True),
    Trial("scenes", "box too narrow", PLACE + "-box_x periodic -box_lower -0.01,-0.1 -box_upper 0.01,0.1 "
          "-bodies a -gravity 0,-9.81 -steps_max 50", refused=("x",), short=True),
    Trial("scenes", "ranks without particles", PLACE + "-bodies a -a_shape sphere -a_radius 0.02 -a_center 0.05,0.05 "
          "-a_tension 1 -gravity 0,-1 -steps_max 20", ranks=4),
    Trial("scenes", "one particle on three ranks", PLACE + "-bodies a -a_lower 0,0 -a_upper 0.01,0.01 -gravity 0,-1 "
          "-steps_max 20", ranks=3),
]


def judge(trial, folder):
    """Runs a trial: a line of the table, and whether it is as it should be."""
    process = runs.start(f"{trial.options} -output_dir {folder} -progress_interval 0", trial.ranks, 1200)
    errors = [line for line in process.stderr.splitlines() if "isph: error: " in line]
    line = {"axis": trial.axis, "value": trial.value, "outcome": "FAILED", "steps": 0, "mean step (s)": 0,
            "rolled back": 0, "energy gained": 0, "density error": 0, "lost": 0, "remark": ""}
    if process.returncode:
        sentence = errors[0].split("error: ")[1] if errors else process.stderr.strip()[-200:]
        series = os.path.join(folder, "series.csv")
        begun = os.path.exists(series) and len(open(series).readlines()) > 2
        good = process.returncode < 126 and len(errors) == 1 and "PETSC ERROR" not in process.stderr and not begun
        if process.returncode < 126 and len(errors) == 1 and sentence.startswith("stopped at ") and not trial.refused:
            line["outcome"] = "stopped"
        if good and trial.refused and all(word in sentence for word in trial.refused):
            line["outcome"] = "refused"
        line["remark"] = sentence.replace("\n", " ")[:160]
        return line
    s = runs.series(folder)
    if trial.refused:
        line["remark"] = "should have been refused"
        return line
    potential, surface = s["potential_energy"], s["surface_energy"]
    total = s["kinetic_energy"] + potential + surface
    at_hand = trial.energy or s["kinetic_energy"][0] + surface[0] + (potential[0] - potential).max()
    gained = (total - np.minimum.accumulate(total)).max() / at_hand
    line.update({"steps": int(s["step"][-1]), "mean step (s)": s["time"][-1] / max(1, s["step"][-1]),
                 "rolled back": int(s["rejected"][-1]), "lost": int(s["lost"][-1]),
                 "energy gained": float(gained),
                 "density error": float(np.nanmax(s["density_error"]))})
    wrong = []
    numbers = [c for c in s.dtype.names if c != "divergence"]
    if not all(np.isfinite(s[c][1:]).all() for c in numbers):  # some need a step
        wrong.append("values that are no numbers")
    if line["lost"] and not trial.throws:
        wrong.append(f"{line['lost']} particles lost")
    if not line["energy gained"] <= (SURFACE if surface[0] > 0 else ENERGY):
        wrong.append("energy out of nothing")
    if not line["density error"] <= DENSITY:
        wrong.append("not incompressible")
    line["outcome"] = "FAILED" if wrong else "handled" if line["rolled back"] else "works"
    remarks = wrong + ([f"{line['rolled back']} steps halved"] if line["rolled back"] else [])
    if trial.explicit and np.nanmax(s["time_step"]) > 1.001 * trial.explicit:
        line["outcome"] = "FAILED" if wrong else "handled"
        remarks.append(f"implicit viscosity, {np.nanmax(s['time_step']) / trial.explicit:.3g} explicit limits")
    line["remark"] = "; ".join(remarks)
    return line


# --- the same scene in other units ---

STEPS = 20
SCALES = 2.0**-20, 2.0**-10, 16.0, 2.0**13, 1e-6, 1e-3, 10.0, 1e4


def scaled(scale):
    """An impact of lengths times 'scale' at the same Re, We and Bo: speed U, density and D0 as they are, gravity over
    scale, viscosity and tension times scale."""
    lengths = {"spacing": "1e-4", "box_lower": "-1.2e-3,-5e-4", "box_upper": "1.2e-3,2e-3", "film_upper": "1.2e-3,0",
               "drop_radius": "4e-4", "drop_center": "0,5e-4"}
    options = "-dimension 2 -box_x periodic -box_ymin wall -bodies film,drop -drop_shape sphere -drop_velocity 0,-1 "
    options += " ".join(f"-{k} " + ",".join(repr(float(x) * scale) for x in v.split(",")) for k, v in lengths.items())
    for body in ("film", "drop"):
        options += f" -{body}_viscosity {1e-3 * scale!r} -{body}_tension {0.02 * scale!r}"
    return options + f" -gravity 0,{-9.81 / scale!r} -steps_max {STEPS} -ksp_rtol 1e-10 -snapshot_double"


def units(folder, scales):
    """The difference of positions over the spacing, of velocities over U, from the scene of scale 1. Powers of two
    scale every number exactly and must give it to the last bit, so the largest is taken. Other scales round otherwise,
    and the factors of pairs, in single precision, by up to 2^-24: over STEPS steps of at most 0.2 h = 0.26 spacings
    each (-time_cfl) that may move a particle by 2^-24 of the way, and in each of the 20 iterations in which the packing
    settles by 2^-24 of the pairs' displacements, of about a spacing, which nearly cancel. So it must be in the mean
    (rms); a few particles in the neck between drop and film, where the impact multiplies what comes in, move by four
    times as much: 3.6e-6 at a scale of 3, 5.8e-6 at 1e-6, with rounding, which changes from version to version."""
    reference, lines = None, []
    for scale in (1.0, *scales):
        path = os.path.join(folder, f"units_{scale:g}")
        process = runs.start(scaled(scale) + f" -output_dir {path} -progress_interval 0", 1, 600)
        line = {"axis": "units", "value": f"drop of {scale * 0.8e-3:.2g} m", "outcome": "FAILED", "steps": STEPS}
        if process.returncode:
            lines.append(dict(line, remark=process.stderr.strip()[-160:]))
            continue
        f = runs.fields(runs.numbered(path, "checkpoint")[-1])
        x, v = f["position"] / scale, f["velocity"]
        if reference is None:
            reference = x, v
            continue
        exact = math.log2(scale).is_integer()
        moved, speed = (np.abs(d).max() if exact else np.sqrt((d**2).sum(axis=1).mean())
                        for d in ((x - reference[0]) / 1e-4, v - reference[1]))
        bound = 0 if exact else 2**-24 * (STEPS * 0.26 + 20)
        lines.append(dict(line, outcome="works" if max(moved, speed) <= bound else "FAILED",
                          remark=f"positions differ by {moved:.1e} spacings, velocities by {speed:.1e} U; "
                                 f"at most {bound:.1e}"))
    return lines


# --- where a growing step breaks a scene, beside what -spectrum predicts ---

FULL = ("-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 1,1 -box_x periodic -box_y periodic -bodies a "
        "-a_viscosity 1e5 -a_velocity_type formula -a_velocity_formula "
        "0-cos(2*pi*x)*sin(2*pi*y),sin(2*pi*x)*cos(2*pi*y) -packing_jitter 0.05 -shifting 0 "
        "-viscosity_solver explicit ")
ROUND = ("-dimension 2 -spacing 1e-4 -box_lower -1.2e-3,-1.2e-3 -box_upper 1.2e-3,1.2e-3 -bodies a -a_shape sphere "
         "-a_center 0,0 -a_radius 8e-4 -a_viscosity 0 -a_tension 0.07 ")
TRUST = 0.7, 1.4  # step that breaks over the predicted one


def broken(scene, step, folder):
    """Whether 100 fixed steps put kinetic energy into what should lose it, or into a drop at rest, 0.01 of its
    surface's, or throw particles away."""
    options = f"{scene} -time_step {step!r} -steps_max 100 -energy_max 0 -displacement_max 1e9 "
    process = runs.start(options + f"-output_dir {folder} -output_overwrite -progress_interval 0", 1, 600)
    if process.returncode:
        return True
    s = runs.series(folder)
    most = 1.01 * s["kinetic_energy"][0] + 0.01 * s["surface_energy"][0]
    return s["lost"][-1] > 0 or not s["kinetic_energy"].max() <= most


def limits(folder):
    """The smallest step, in steps of a tenth of the predicted limit, that breaks each scene."""
    lines = []
    for name, scene, word in (("viscosity", FULL, "2/lambda"), ("tension", ROUND, "2/omega")):
        text = runs.start(f"{scene} -steps_max 3 -spectrum -output_dir {folder}_{name} -progress_interval 0").stdout
        predicted = float(search(name + f".*{word} = ([0-9.e+-]+) s", text).group(1))
        own = float(search(r"time step ([0-9.e+-]+) s", text).group(1))
        share = next((k / 10 for k in range(5, 20) if broken(scene, k / 10 * predicted, f"{folder}_{name}_run")), 2)
        good = TRUST[0] <= share <= TRUST[1] and own < share * predicted
        lines.append({"axis": "step over limit", "value": name, "outcome": "works" if good else "FAILED", "steps": 100,
                      "remark": f"breaks at {share * predicted:.3g} s, {share:g} of SLEPc's {word} {predicted:.3g} s; "
                                f"the run takes {own:.3g} s"})
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--only", default="", help="runs whose axis or value contains this")
    parser.add_argument("--folder", default=os.path.join(runs.ROOT, "output", "extremes"))
    parser.add_argument("--readme", action="store_true", help="write the table and the map of tests/extremes")
    arguments = parser.parse_args()
    if arguments.readme:
        report.readme(arguments.folder)
        return
    lines = []
    for number, trial in enumerate(TRIALS):
        if (trial.short or arguments.all) and arguments.only in f"{trial.axis} {trial.value}":
            lines.append(judge(trial, runs.scratch(f"run_{number}")))
            good = lines[-1]["outcome"] != "FAILED"
            runs.check(good, f"{trial.axis}_{trial.value}".replace(" ", "_"), lines[-1]["remark"])
    if arguments.only in "units":
        for line in units(runs.scratch(""), SCALES if arguments.all else (SCALES[0], 1e-6)):
            lines.append(line)
            runs.check(line["outcome"] != "FAILED", f"units_{line['value']}", line["remark"])
    if arguments.all and arguments.only in "step over limit":
        for line in limits(runs.scratch("limits")):
            lines.append(line)
            runs.check(line["outcome"] != "FAILED", f"step_over_limit_{line['value']}", line["remark"])
    print(f"\n{'axis':16s} {'value':26s} {'outcome':8s} {'steps':>5s} {'mean step':>10s} {'energy':>8s} {'density':>8s}"
          "  remark")
    for line in lines:
        print(f"{line['axis']:16s} {line['value']:26s} {line['outcome']:8s} {line['steps']:5d} "
              f"{line.get('mean step (s)', 0):10.3g} {line.get('energy gained', 0):8.4f} "
              f"{line.get('density error', 0):8.4f}  {line['remark']}")
    outcomes = [line["outcome"] for line in lines]
    kinds = ("works", "handled", "refused", "stopped", "FAILED")
    print(", ".join(f"{outcomes.count(kind)} {kind}" for kind in kinds), f"of {len(lines)}")
    if arguments.all and not arguments.only:
        report.keep(lines, arguments.folder, runs.ROOT)
    runs.done()


main()
