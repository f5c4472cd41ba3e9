#!/usr/bin/python3
"""Thin film: the radius of the crown against Yarin and Weiss (1995).
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

D, U, DEPTH = 4e-3, 3.13, 1.16e-3  # m, m/s, m
FOOT = (1.0, 4.0)  # spacings above the level: the crown's wall, below the rim and its spray
TIMES = (1.0, 4.5)  # D/U: from the crown's birth to before the mirrors feel it


def crown(folder):
    """Times over D/U and radii of the crown's wall over D: the median distance from the axis of a layer's liquid."""
    tau, radius = [], []
    for time, head, f in physics.snapshots(folder):
        x, d0 = f["position"], float(head["spacing"])
        wall = (x[:, 2] > FOOT[0] * d0) & (x[:, 2] < FOOT[1] * d0)
        if TIMES[0] <= time * U / D <= TIMES[1] and wall.sum() > 20:
            tau.append(time * U / D)
            radius.append(np.median(np.hypot(x[wall, 0], x[wall, 1])) / D)
    return np.array(tau), np.array(radius)


def check(folder):
    tau, radius = crown(folder)
    slope, start = np.polyfit(tau, radius**2, 1)  # r^2/D^2 = C^2 (tau - tau0)
    exponent = np.polyfit(np.log(tau + start / slope), np.log(radius), 1)[0]
    first, last = (f["id"] for _, _, f in (list(physics.snapshots(folder))[k] for k in (0, -1)))
    return [physics.relative("crown, C in r/D = C sqrt(tau - tau0)", np.sqrt(slope), (2 * D / (3 * DEPTH))**0.25, 0.15),
            physics.shown("tau0", -start / slope), physics.shown("exponent about tau0", exponent, 0.5),
            physics.at_most("particles lost over all", 1 - len(last) / len(first), 0.01)]


if __name__ == "__main__":
    physics.main(check)
