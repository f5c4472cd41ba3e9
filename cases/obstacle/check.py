#!/usr/bin/python3
"""Dam break against an obstacle: water heights and pressure against Kleefsman et al. (2005).
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

# Read off the published curves: time (s), height in the reservoir H4 and before the obstacle H2 (m)
RESERVOIR = ((0.4, 0.460), (0.6, 0.395), (0.8, 0.332), (1.0, 0.279), (1.4, 0.197), (1.8, 0.147))
BEFORE = ((0.6, 0.119), (0.8, 0.147), (1.0, 0.179), (1.4, 0.202), (1.8, 0.333))
PEAK, ARRIVAL = 11239.0, 0.415  # Pa, s: of the sensor 21 mm above the floor


def deviations(s, name, table):
    t, h = np.array(table).T
    return (np.interp(t, s["time"], s[name]) - h) / 0.55


def check(folder):
    s = runs.series(folder)
    reservoir, before = (deviations(s, name, table)
                         for name, table in (("height_1_m", RESERVOIR), ("height_2_m", BEFORE)))
    early = s["time"] < 0.8
    p, t = np.nan_to_num(s["point_1_pressure_Pa"]), s["time"]
    width = max(1, int(round(10e-3 / np.median(np.diff(t)))))
    p = np.convolve(p, np.full(width, 1 / width), "same")
    arrived = t[np.argmax(p > 0.2 * PEAK)]
    force = s["force_obstacle_x_N"]
    return [physics.at_most("height in the reservoir H4, largest deviation over 0.55 m", np.abs(reservoir).max(), 0.05),
            physics.shown("height before the obstacle H2, largest deviation over 0.55 m", np.abs(before).max()),
            physics.absolute("arrival of the water at the obstacle", arrived, ARRIVAL, 0.04, "s"),
            physics.shown("first pressure peak, mean over 10 ms", p[early].max(), PEAK, "Pa"),
            physics.shown("largest force on the obstacle, whole tank", -2 * np.nanmin(force), unit="N"),
            physics.at_most("particles lost over all", s["lost"][-1] / s["particles"][0], 0.01)]


if __name__ == "__main__":
    physics.main(check)
