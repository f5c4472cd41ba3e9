#!/usr/bin/python3
"""Speed and height of a rising bubble against the three groups of Hysing et al. (2009), case 2.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

WINDOW = 0.06  # s, to either side, of the parabola whose slope is the speed


def check(folder):
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
