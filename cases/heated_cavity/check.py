#!/usr/bin/python3
"""The heat that crosses a heated square, over that of liquid at rest, beside de Vahl Davis (1983), and the Rayleigh
number at which a roll begins to grow. check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

CONDUCTED, STEADY = 5.893 * 10, 12  # W/m at rest; s
NUSSELT = 2.238  # G. de Vahl Davis, Int. J. Numer. Meth. Fluids 3 (1983) 249, Ra = 10000
# of the onset between rigid plates: J. W. Strutt (Lord Rayleigh) 1916, H. Jeffreys 1928; near it a roll grows by
# (Ra/ONSET - 1)/SLOW a diffusion time, M. C. Cross, Phys. Fluids 23 (1980) 1727. From then on (s) the start is over.
ONSET, PRANDTL, DIFFUSION, BEGUN = 1708, 0.71, 1e-4 / (5.893 / (1000 * 4184)), 20
SLOW = (PRANDTL + 0.5117) / (19.65 * PRANDTL)
RAYLEIGH = 0.00981 * 10 * 1e-6 / (1e-6 * 5.893 / (1000 * 4184))  # for an expansion of 1/K


def check_onset(series, expansion):
    late = series["time"] > BEGUN
    growth = 0.5 * np.polyfit(series["time"][late], np.log(series["kinetic_energy"][late]), 1)[0]
    onset = RAYLEIGH * expansion / (1 + growth * DIFFUSION * SLOW)
    return [physics.relative("Rayleigh number of the onset", onset, ONSET, 0.03)]


def check(folder):
    series, options = runs.series(folder), physics.options(next(physics.snapshots(folder))[1])
    if "-box_ymin_temperature" in options:
        return check_onset(series, float(options["-liquid_thermal_expansion"]))
    late = series["time"] >= STEADY
    hot, cold = (np.mean(series[f"heat_from_{face}_Wm"][late]) / CONDUCTED for face in ("xmin", "xmax"))
    return [physics.relative("Nusselt number of the hot wall", hot, NUSSELT, 0.05),
            physics.relative("Nusselt number of the cold wall", -cold, NUSSELT, 0.05)]


if __name__ == "__main__":
    physics.main(check)
