#!/usr/bin/python3
"""A boat that meets the end of its tank: where its bow is, and how it floats. check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import physics  # noqa: E402
import runs  # noqa: E402

SPACING, END, HALF, FLOATS = 0.025, 1.0, 0.15, 0.2  # m; the last: height of its centre where it floats


def check(folder):
    s = runs.series(folder)
    bow, late = s["boat_x_m"] + HALF, s["time"] > 0.8
    return [physics.absolute("bow, at its farthest", bow.max(), END, 0.25 * SPACING, "m"),
            physics.absolute("bow, at the end", bow[late].mean(), END, 0.25 * SPACING, "m"),
            physics.absolute("height of the centre, mean", s["boat_z_m"].mean(), FLOATS, 0.25 * SPACING, "m")]


if __name__ == "__main__":
    physics.main(check)
