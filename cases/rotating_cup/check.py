#!/usr/bin/python3
"""Liquid in a cup that turns: the parabola of its surface. check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

RATE, G, WIDTH, DEPTH = 7.0, 9.81, 0.2, 0.08  # rad/s, m/s2, m
RINGS = (0.0,) + 4 * (0.03,) + 4 * (0.06,) + 4 * (0.08,)  # m, distances of the gauges from the axis
START = 1.25  # s: at rest in the cup from here on


def check(folder):
    table = physics.table(os.path.join(folder, "series.csv"))
    late = table["time_s"] >= START
    height = np.array([table[f"height_{k + 1}_m"][late].mean() for k in range(len(RINGS))])
    bend, middle = np.polyfit(np.square(RINGS), height, 1)
    exact = RATE**2 / (2 * G)
    left = height - middle - bend * np.square(RINGS)
    return [physics.relative("height of the surface over the square of the radius", bend, exact, 0.02, "1/m"),
            physics.absolute("height in the middle", middle, DEPTH - exact * WIDTH**2 / 6, 1.5e-3, "m"),
            physics.at_most("rms distance from the parabola over the spacing", left.std() / 0.01, 0.02)]


if __name__ == "__main__":
    physics.main(check)
