#!/usr/bin/python3
"""Runs of a few particles for a few steps that show what only a whole run does: a block falls freely after its packing
has been relaxed, at the damping that the options ask for; the cache of relaxed packings knows other options; the energy
of a fall stays; a run has the steps and the time that were asked for."""
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

FALL = """-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 2,4 -bodies a -a_lower 0.5,2 -a_upper 1.5,3 -a_viscosity 0
 -gravity 0,-10 -packing_jitter 0.2 -time_step 1e-3 -checkpoint_interval 0 """


def last(folder):
    return runs.fields(runs.numbered(folder, "checkpoint")[-1])


relax = FALL + "-packing_relaxation_time 5e-3 -steps_max 5 -packing_cache " + runs.scratch("cache") + " "
weak = last(runs.run(relax + "-packing_relaxation_damping 0.9", "weak"))
strong = last(runs.run(relax + "-packing_relaxation_damping 0.1", "strong"))
moved = np.abs(weak["position"] - strong["position"]).max()
runs.check(moved > 1e-6, "relaxation_damping_acts", f"positions differ by {moved:.2e} m")
runs.check_below(abs(weak["velocity"][:, 1].mean() + 10 * 5e-3), 2e-3, "free_fall_after_the_relaxation")
last(runs.run(relax + "-packing_relaxation_damping 0.9 -time_cfl 0.1", "other_cfl"))
last(runs.run(relax + "-packing_relaxation_damping 0.9 -series_interval 1e-3", "other_series"))
count = len(os.listdir(runs.scratch("cache")))
runs.check(count == 3, "cache_knows_options_that_act", f"{count} files for three relaxations")

folder = runs.scratch("fall")
process = runs.start(FALL + f"-time_end 0.0155 -output_dir {folder}")
series = runs.series(folder)
runs.check(process.returncode == 0 and abs(series["time"][-1] - 0.0155) < 1e-12, "time_end", series["time"][-1])
text = process.stdout
residual, exchanged = (float(re.search(word + r" ([-+.\de]+)", text)[1]) for word in ("residual", "kinetic"))
runs.check_below(abs(residual), 0.1 * exchanged, "budget_of_a_free_fall")  # the density does some work
series = runs.series(runs.run(FALL + "-steps_max 3", "steps"))
runs.check(list(series["step"]) == [0, 1, 2, 3], "steps_max", series["step"])
runs.done()
