#!/usr/bin/python3
"""Speed and height of a rising bubble against the three groups of Hysing et al. (2009), case 2; as rings, its Reynolds
number against those that Bhaga and Weber (1981) measured.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

WINDOW = 0.06  # s, to either side, of the parabola whose slope is the speed
MEASURED = {848: 2.47, 266: 3.57, 41.1: 7.16, 5.51: 13.3}  # Re of Bhaga and Weber by M, at E = 116
STEADY = 5  # in units of (diameter / gravity)^(1/2): from here on the speed changes by 1 % at most


def steady(folder, options):
    """The bubble of rings.opts, in units of its diameter, gravity and the density of the liquid."""
    rows = physics.table(os.path.join(folder, "pockets.csv"))
    largest = [part[part["volume_m3"].argmax()] for part in
               (rows[rows["time_s"] == time] for time in np.unique(rows["time_s"]))]
    t, y, volume = (np.array([pocket[name] for pocket in largest]) for name in ("time_s", "y_m", "volume_m3"))
    viscosity, tension = (float(options["-liquid_" + name]) for name in ("viscosity", "tension"))
    morton = viscosity**4 / tension**3
    number = np.polyfit(t[t > STEADY], y[t > STEADY], 1)[0] / viscosity
    return [physics.relative("Reynolds number", number, MEASURED[min(MEASURED, key=lambda m: abs(m - morton))], 0.06),
            physics.relative("volume at the end, over that at the start", volume[-1] / volume[0], 1, 0.02)]


def check(folder):
    _, head, _ = next(iter(physics.snapshots(folder)))
    options = physics.options(head)
    if options["-dimension"] == "axisymmetric":
        return steady(folder, options)
    rows = physics.table(os.path.join(folder, "pockets.csv"))
    t = np.unique(rows["time_s"])
    parts = [rows[rows["time_s"] == time] for time in t]
    volume = np.array([part["volume_m2"].sum() for part in parts])
    y = np.array([(part["volume_m2"] * part["y_m"]).sum() for part in parts]) / volume
    at = np.arange(0.1, 2.95, 0.01)
    near = [np.abs(t - time) < WINDOW for time in at]
    speed = np.array([np.polyfit(t[n] - time, y[n], 2)[1] for n, time in zip(near, at)])
    early, late = at < 1.2, at > 1.5
    return [physics.relative("largest speed before 1.2 s", speed[early].max(), 0.2513, 0.02, "m/s"),
            physics.absolute("its time", at[early][speed[early].argmax()], 0.731, 0.05, "s"),
            physics.relative("largest speed after 1.5 s", speed[late].max(), 0.2417, 0.1, "m/s"),
            physics.relative("height of the centre at 3 s", np.interp(3, t, y), 1.132, 0.025, "m"),
            physics.relative("volume at 3 s, over that at the start", volume[-1] / volume[0], 1, 0.02)]


if __name__ == "__main__":
    physics.main(check)
