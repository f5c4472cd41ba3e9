#!/usr/bin/python3
"""The paper's own choices (options/paper.opts) on the main case at a spacing of 1 mm, to 3 ms: a regression. Steps are
longer in proportion to the spacing. The bands hold the mean of three packings; fifteen have 122 to 132 uJ at 2 ms, 99
to 117 uJ and 2.3 to 3.3 mm at 3 ms. The reference has 149 uJ and 3.2 mm: what the scheme loses at this spacing."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

STEP_MIN, STEP_MAX, END = 2e-5, 8e-5, 3e-3  # s: four times the paper's, for four times its spacing
# column, time (s), low, high
BANDS = (("kinetic_energy", 0, 170e-6, 178e-6), ("kinetic_energy", 2e-3, 116e-6, 138e-6),
         ("kinetic_energy", 3e-3, 95e-6, 115e-6), ("crater_depth", 3e-3, 2.1e-3, 3.4e-3))

packings = [runs.series(runs.run(f"""-options_file cases/drop_impact/case.opts -options_file options/quarter.opts
 -options_file options/paper.opts -spacing 1e-3 -time_end {END} -time_step_min {STEP_MIN} -time_step_max {STEP_MAX}
 -packing_relaxation_step 4e-5 -packing_seed {seed} """ + " ".join(sys.argv[1:]), f"printed_{seed}"))
            for seed in range(1, 4)]
for name, time, low, high in BANDS:
    runs.check_within(np.mean([np.interp(time, s["time"], np.nan_to_num(s[name])) for s in packings]), low, high,
                      f"{name}_at_{1e3 * time:g}_ms")
s = packings[0]
steps = s["time_step"][1:-2]  # the last two share what is left to the end
runs.check_within(steps.min(), STEP_MIN, STEP_MAX, "smallest_step")
runs.check_within(steps.max(), STEP_MIN, STEP_MAX, "largest_step")
runs.check(s["time"][-1] == END, "reaches_the_end", f"{s['time'][-1]} s")
runs.check(s["lost"][-1] == 0 and s["rejected"][-1] == 0, "nothing_lost_or_rolled_back")
runs.check_below(np.nanmax(s["density_error"][1:]), 0.01, "density")
energy = s["kinetic_energy"] + s["potential_energy"] - s["potential_energy"][0]
runs.check_below(energy.max() / energy[0], 1.05, "energy_does_not_grow")
runs.done()
