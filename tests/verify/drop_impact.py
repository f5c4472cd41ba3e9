#!/usr/bin/python3
"""The main case at a spacing of 1 mm (a drop of 4 spacings) to 6 ms: a regression, not a verification. The crater is
too shallow at this spacing: measured depth at 5 ms 3.78 mm, the reference has 5.04; kinetic energy 99 uJ against 118.
The bands around the measured values let other packings through and a lost correction not: without shifting the energy
is 55 uJ and the crater 2.6 mm deep. It does not see gravity; the case free_fall does."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

# at 5 ms: low, high; seeds 1 to 4 give 3.37 to 4.03 mm, 87.3 to 99.1 uJ, 9.7 to 13.2 mm
BANDS = {"crater_depth": (3.2e-3, 4.6e-3), "kinetic_energy": (85e-6, 104e-6), "crater_diameter": (9e-3, 13.7e-3)}
REFERENCE = {"crater_depth": 0.40, "kinetic_energy": 0.30, "crater_diameter": 0.20}  # largest errors
DROP_ENERGY = 0.5 * 1100 * 4 / 3 * np.pi * 2e-3**3 * 3.124667342**2  # J
VOLUME = 40e-3 * 40e-3 * 10e-3 + 4 / 3 * np.pi * 2e-3**3  # m3

folder = runs.run("""-options_file cases/drop_impact/case.opts -options_file options/quarter.opts
 -spacing 1e-3 -time_end 6e-3 """ + " ".join(sys.argv[1:]), "impact")
s = runs.series(folder)
with open(os.path.join(runs.ROOT, "cases", "drop_impact", "reference.csv"), encoding="utf-8") as file:
    reference = np.genfromtxt([line for line in file if not line.startswith("#")], delimiter=",", names=True)
for name, (low, high) in BANDS.items():
    value = np.interp(5e-3, s["time"], np.nan_to_num(s[name]))
    right = np.interp(5e-3, reference["time"], np.nan_to_num(reference[name]))
    print(f"{name} at 5 ms: {value:.4g}, reference {right:.4g}, error {value / right - 1:+.1%}")
    runs.check_within(value, low, high, name)
    runs.check_below(abs(value / right - 1), REFERENCE[name], name + "_against_reference")
runs.check(s["time"][-1] == 6e-3, "reaches_the_end", f"{s['time'][-1]} s")
runs.check_below(abs(s["kinetic_energy"][0] / DROP_ENERGY - 1), 0.06, "energy_of_the_drop")
runs.check_below(abs(s["volume"][0] / VOLUME - 1), 2e-3, "volume")
runs.check(np.all(s["volume"] == s["volume"][0]) and s["lost"][-1] == 0, "volume_is_kept", f"{s['lost'][-1]} left")
energy = s["kinetic_energy"] + s["potential_energy"] - s["potential_energy"][0]
runs.check_below((energy.max() - energy[0]) / energy[0], 0.05, "energy_does_not_grow")
runs.check_below(np.diff(energy[s["time"] > 1e-3]).max() / energy[0], 0.02, "energy_falls_after_contact")
runs.check_below(s["rejected"][-1], 0, "no_step_rolled_back")
runs.check_below(np.nanmax(s["density_error"][1:]), 0.05, "density")
last = runs.fields(runs.numbered(folder, "snapshot")[-1])
runs.check(last["position"][:, :2].min() >= 0 and last["position"][:, :2].max() <= 20e-3, "stays_between_mirrors")
runs.check_below(-10e-3 - last["position"][:, 2].min(), -0.2e-3, "stays_above_the_floor")
runs.done()
