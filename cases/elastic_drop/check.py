#!/usr/bin/python3
"""A drop of an Oldroyd-B liquid on a plate: its diameter over that before beside a volume-of-fluid computation with the
logarithm of the conformation, the test 'fall' of Basilisk, which lies on the curve of Figueiredo et al. 2016.
check.py RUN_FOLDER"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

DIAMETER, SPEED = 10e-3, 1.0  # m, m/s


def extremes(t, diameter):
    """The largest diameter of the first spreading, the least one after it, and the last one."""
    peak = np.argmax(np.where(t < 2.8, diameter, 0))
    least = peak + np.argmin(diameter[peak:])
    return diameter[peak], t[peak], diameter[least], t[least], diameter[-1]


def check(folder):
    series = physics.table(os.path.join(folder, "series.csv"))
    measured = extremes(series["time_s"] * SPEED / DIAMETER, series["spread_ymin_m"] / DIAMETER)
    expected = extremes(*np.loadtxt(os.path.join(HERE, "reference.csv"), delimiter=",", skiprows=1).T)
    names = ("largest diameter over D", "its time, D/U", "least diameter over D after it", "its time, D/U",
             "diameter over D at 5 D/U")
    return [physics.relative(*row) for row in zip(names, measured, expected, (0.03, 0.05, 0.05, 0.05, 0.03))]


if __name__ == "__main__":
    physics.main(check)
