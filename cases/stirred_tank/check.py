#!/usr/bin/python3
"""A stirred tank: no liquid is lost or goes into the paddle, nothing is faster than its tips by much, and the liquid
turns. check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

RATE, HALF = 2 * np.pi, np.array([0.07, 0.01])  # rad/s, m: of the paddle


def check(folder):
    states = list(physics.snapshots(folder))
    time, head, f = states[-1]
    liquid = f["body"] >= 0
    x, v = f["position"][liquid], f["velocity"][liquid]
    c, s = np.cos(RATE * time), np.sin(RATE * time)
    inside = np.abs(x[:, :2] @ np.array([[c, -s], [s, c]])) - HALF
    r2 = x[:, 0]**2 + x[:, 1]**2
    spin = (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]).sum() / r2.sum()
    first = (states[0][2]["body"] >= 0).sum()
    return [physics.at_most("particles lost", first - liquid.sum(), 0),
            physics.at_least("least distance to the paddle over the spacing", inside.max(axis=1).min() /
                             float(head["spacing"]), 0),
            physics.at_least("angular velocity of the liquid over that of the paddle", spin / RATE, 0.1),
            physics.at_most("largest speed over that of the tips", np.linalg.norm(v, axis=1).max() /
                            (RATE * np.hypot(*HALF)), 2)]


if __name__ == "__main__":
    physics.main(check)
