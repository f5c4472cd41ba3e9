#!/usr/bin/python3
"""isph.fit and make fit: a curve tells the options that made it, within the bars.

swings    a damped oscillation in place of runs, with errors by spacing and packing of a known size: in nine of ten
          curves with noise and gaps the values lie inside the bars; another start; what a curve cannot tell
outlines  the outline of a hanging drop, by the Young-Laplace equation, tells the tension
vortices  the exact decay of Taylor and Green's vortices tells the viscosity
refused   curves and ranges that cannot be used"""
import math
import os
import subprocess
import sys
import types

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402
import isph  # noqa: E402
from isph import fitting  # noqa: E402

VORTEX = os.path.join(runs.ROOT, "cases", "taylor_green", "case.opts")
HANGING = os.path.join(runs.ROOT, "cases", "my_liquid", "case.opts")
TIMES = np.linspace(0, 1, 81)
FREE = {"water_tension": (0.02, 0.1), "water_viscosity": (1e-3, 1e-1)}
SWINGS = 3  # in TIMES, with the tension 0.05


def swing(tension, viscosity, by=0.0, seed=0):
    """A drop that swings; by: a relative error of the frequency."""
    packing = 1 + 0.002 * np.random.default_rng(seed).standard_normal()
    rate = 2 * math.pi * SWINGS * math.sqrt(tension / 0.05) * (1 + by) * packing
    return np.cos(rate * TIMES) * np.exp(-100 * viscosity * packing**3 * TIMES)


class Job:
    """In place of running.Job."""

    def __init__(self, _scene, folder, _again, _ranks, options):
        self.options, self.folder = options, folder

    def go(self):
        one = self.options
        tension, viscosity = float(one["water_tension"]), float(one["water_viscosity"])
        curve = swing(tension, viscosity, one["spacing"], one.get("packing_seed", 1))
        return types.SimpleNamespace(series={"time": TIMES, "kinetic_energy": curve})


def swings():
    real = fitting.Job, fitting.together
    fitting.Job, fitting.together = Job, lambda jobs, *_: [job.go() for job in jobs]
    inside, known = 0, {"water_tension": 0.067, "water_viscosity": 0.0095}
    for k in range(10):
        chance = np.random.default_rng(100 + k)
        data = swing(*known.values(), 0, 50 + k) + 0.05 * chance.standard_normal(len(TIMES))
        data[chance.random(len(TIMES)) < 0.3] = np.nan
        found = isph.fit(VORTEX, (TIMES, data), FREE, column="kinetic_energy", output=runs.scratch(f"swing_{k}"),
                         spacing=0.01)
        inside += all(abs(found[name].value - right) <= found[name].bar for name, right in known.items())
        told = found["water_tension"]
        runs.check(not told.doubt and told.bar < 0.2 * told.value, f"told_{k}", str(tuple(told)))
    runs.check(inside >= 9, "inside", f"{inside} of 10")
    late = isph.fit(VORTEX, (TIMES[20:60] - 0.1, swing(0.067, 0.0095)[20:60]), FREE, column="kinetic_energy",
                    start=(0, 0.2), output=runs.scratch("late"))
    runs.check_within(late["water_tension"].value, 0.064, 0.07, "another_start")
    runs.check_within(late.start, 0.09, 0.11, "start_of_the_clock")
    noisy = (TIMES, swing(0.067, 0.0095) + 0.02 * np.random.default_rng(1).standard_normal(len(TIMES)))
    blind = isph.fit(VORTEX, noisy, {**FREE, "water_density": (0.5, 2)}, column="kinetic_energy",
                     output=runs.scratch("blind"), spacing=0.01)
    runs.check("water_density has no influence on this curve" in str(blind) and not blind["water_tension"].doubt and
               os.path.getsize(blind.page) > 1000, "no_influence", str(blind))
    ends = isph.fit(VORTEX, noisy, {"water_tension": (0.069, 0.1)}, column="kinetic_energy", spacing=0.01,
                    output=runs.scratch("ends"), water_viscosity=0.0095)
    runs.check("water_tension is at the end of its range" in str(ends), "end_of_the_range", str(ends))
    fitting.Job, fitting.together = real


def vortices():
    """On the command line, in the folder of the scene's copy."""
    curve, home = runs.scratch("lab.csv"), runs.scratch("fit")
    with open(curve, "w", encoding="utf-8") as file:
        file.write("time_s,kinetic_energy_J/m\n" + "".join(
            f"{t:g},{0.25 * math.exp(-16 * math.pi**2 * 0.01 * t):g}\n" for t in np.arange(0, 1.01, 0.1)))
    words = [sys.executable, os.path.join(runs.ROOT, "src", "answers", "fit.py"), VORTEX, curve,
             "water_viscosity=0.002,0.05", "--output", home]
    done = subprocess.run(words, env=runs.environment(), text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    parts = done.stdout.split()
    good = done.returncode == 0 and parts[0] == "water_viscosity"
    if runs.check(good, "fit_of_the_command_line", done.stdout[-400:]):
        runs.check_below(abs(float(parts[2]) - 0.01), float(parts[4]), "viscosity_of_vortices")
        runs.check_below(float(parts[4]), 0.003, "bar_of_vortices")
    count = len(os.listdir(home))
    subprocess.run(words, env=runs.environment(), stdout=subprocess.DEVNULL, check=False)
    runs.check(count > 15 and len(os.listdir(home)) == count, "not_repeated", str(count))


def outlines():
    found = isph.fit(HANGING, os.path.join(os.path.dirname(HANGING), "outline.csv"), {"drop_tension": (0.02, 0.1)},
                     output=runs.scratch("outlines"), jobs=2)["drop_tension"]
    runs.check(not found.doubt, "outline_tells_the_tension", found.doubt)
    runs.check_below(abs(found.value - 0.05), found.bar, "tension_of_an_outline")
    runs.check_below(found.bar, 0.012, "bar_of_an_outline")


def refused():
    def says(words, *arguments, **more):
        try:
            isph.fit(*arguments, **more)
            runs.check(False, words, "it was not refused")
        except isph.Error as error:
            runs.check(words in str(error) and "\n" not in str(error), words, str(error))
    one, flat = {"water_viscosity": (1e-3, 1e-1)}, np.ones(len(TIMES))
    curve = {"column": "kinetic_energy"}
    text = runs.scratch("text.csv")
    with open(text, "w", encoding="utf-8") as file:
        file.write("hours,angle\n1,2\n2,3\n")
    sides = runs.scratch("sides.csv")
    with open(sides, "w", encoding="utf-8") as file:
        file.write("x_m,highest_m\n0,1\n1,2\n")
    octant = os.path.join(runs.ROOT, "cases", "oscillating_drop", "case.opts")
    says("an outline is that of a scene in the plane", octant, (TIMES, TIMES), {"drop_tension": (0.01, 0.1)},
         column="outline")
    says("must have a head line with time_s", HANGING, sides, {"drop_tension": (0.01, 0.1)})
    says("no column brightness", VORTEX, (TIMES, TIMES), one, column="brightness")
    says("tells nothing", VORTEX, (TIMES, flat), one, **curve)
    says("3 values", VORTEX, (TIMES[:3], TIMES[:3]), one, **curve)
    says("begins at -0.5 s, before the scene", VORTEX, (TIMES - 0.5, TIMES), one, **curve)
    says("must have a lower end above 0", VORTEX, (TIMES, TIMES), {"water_viscosity": (0.1, 0.01)}, **curve)
    says("must have a lower end above 0", VORTEX, (TIMES, TIMES), {"water_viscosity": 0.1}, **curve)
    with open(runs.scratch("empty.csv"), "w", encoding="utf-8"):
        pass
    says("is empty", VORTEX, runs.scratch("empty.csv"), one)
    says("no option -water_colour", VORTEX, (TIMES, TIMES), {"water_colour": (1, 2)}, **curve)
    says("must have a head line with time_s", VORTEX, text, one)
    says("is no table", VORTEX, "nowhere.csv", one)


PARTS = {f.__name__: f for f in (swings, outlines, vortices, refused)}
for part in runs.parts(*PARTS):
    PARTS[part]()
runs.done()
