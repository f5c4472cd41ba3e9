#!/usr/bin/python3
"""Liquid in a box that turns: its angular velocity, and the parabola of its pressure.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

RATE, DENSITY, INSIDE = 2.0, 1000.0, 0.45  # rad/s, kg/m3; m, radius within which the parabola is fitted


def check(folder):
    *_, (time, _, f) = physics.snapshots(folder)
    liquid = f["body"] >= 0
    x, v, p = (f[name][liquid] for name in ("position", "velocity", "pressure"))
    r2 = x[:, 0]**2 + x[:, 1]**2
    spin = (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]).sum() / r2.sum()
    error = np.hypot(v[:, 0] + RATE * x[:, 1], v[:, 1] - RATE * x[:, 0])
    near = r2 < INSIDE**2
    slope, _ = np.polyfit(r2[near], p[near], 1)
    return [physics.relative("angular velocity", spin, RATE, 0.01, "rad/s"),
            physics.relative("pressure over the square of the radius", slope, DENSITY * RATE**2 / 2, 0.02, "Pa/m2"),
            physics.at_most("rms velocity error over that of the corners", np.sqrt((error**2).mean()) /
                            (RATE * np.sqrt(r2.max())), 0.02)]


if __name__ == "__main__":
    physics.main(check)
