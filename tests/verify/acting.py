#!/usr/bin/python3
"""Runs of a few particles for a few steps that show what only a whole run does: a block falls freely after its packing
has been relaxed; the energy of a fall stays; a run has the steps and the time that were asked for; a jet falls as
Euler's equation has it."""
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

FALL = """-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 2,4 -bodies a -a_lower 0.5,2 -a_upper 1.5,3 -a_viscosity 0
 -gravity 0,-10 -time_step 1e-3 -checkpoint_interval 0 """


def last(folder):
    return runs.fields(runs.numbered(folder, "checkpoint")[-1])


printed = FALL + "-packing_jitter 0.4 -scheme density_invariant -pressure_closure full_diagonal -steps_max 5 "
start, relaxed = (last(runs.run(printed + options, name))
                  for name, options in (("unrelaxed", ""), ("relaxed", "-packing_relaxation_time 5e-3")))
spread = [fields["velocity"].std(0).max() for fields in (start, relaxed)]
runs.check(spread[1] < 0.5 * spread[0], "relaxation_brings_to_rest", f"speeds scatter by {spread} m/s")
runs.check_below(abs(relaxed["velocity"][:, 1].mean() + 10 * 5e-3), 2e-3, "free_fall_after_the_relaxation")

folder = runs.scratch("fall")
process = runs.start(FALL + f"-time_end 0.0155 -output_dir {folder}")
series = runs.series(folder)
runs.check(process.returncode == 0 and abs(series["time"][-1] - 0.0155) < 1e-12, "time_end", series["time"][-1])
text = process.stdout
residual, exchanged = (float(re.search(word + r" ([-+.\de]+)", text)[1]) for word in ("residual", "kinetic"))
runs.check_below(abs(residual), 0.1 * exchanged, "budget_of_a_free_fall")  # the density does some work
series = runs.series(runs.run(FALL + "-steps_max 3", "steps"))
runs.check(list(series["step"]) == [0, 1, 2, 3], "steps_max", series["step"])

# Liquid that leaves a slit at one velocity cannot narrow at once: the pressure that bends it inwards holds it back. p
# is harmonic, 0 at the sides, with the slope rho g at the edge; far below it falls as if let go sum 2/k^3 half widths
# lower, k = (n - 1/2) pi.
HALF, SPEED, G = 2e-3, 1.0, 9.81
JET = f"""-dimension 2 -spacing 0.25e-3 -box_lower -5e-3,-16e-3 -box_upper 5e-3,3e-3 -bodies a -a_type emitter
 -a_lower {-HALF},0 -a_upper {HALF},2e-3 -a_velocity 0,{-SPEED} -gravity 0,{-G} -time_end 0.04 -snapshot_interval 2e-3
 -checkpoint_interval 0 """
late = []
for path in runs.numbered(runs.run(JET, "jet"), "snapshot")[12:]:
    fields = runs.fields(path)
    y, v = fields["position"][:, 1], fields["velocity"][:, 1]
    deep = (y < -6e-3) & (y > -12e-3)
    late.append((-y[deep] - (v[deep]**2 - SPEED**2) / (2 * G)).mean())
due = HALF * (2 / ((np.arange(1, 50) - 0.5) * np.pi)**3).sum()
runs.check_within(np.mean(late) / due, 0.9, 1.1, "a_jet_falls_late")
runs.done()
