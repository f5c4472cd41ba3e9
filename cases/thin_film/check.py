#!/usr/bin/python3
"""Thin film: the radius of the crown against a volume-of-fluid computation and Yarin and Weiss (1995).
check.py RUN_FOLDER"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

D, U, DEPTH = 4e-3, 3.13, 1.16e-3  # m, m/s, m
REFERENCE = os.path.join(HERE, "reference.csv")
FOOT = (1.0, 4.0)  # spacings above the level: the crown's wall, below the rim and its spray
TIMES = (1.0, 4.5)  # D/U: from the crown's birth to before the mirrors feel it


def median(r, volume):
    """The r below which half the volume is."""
    order = np.argsort(r)
    below = np.cumsum(volume[order]) - 0.5 * volume[order]
    return np.interp(0.5 * volume.sum(), below, r[order])


def crown(folder):
    """Times over D/U and radii of the crown's wall over D: the median distance from the axis of a layer's liquid."""
    tau, radius = [], []
    for time, head, f in physics.snapshots(folder):
        x, d0 = physics.places(head, f), float(head["spacing"])
        wall = (x[:, 2] > FOOT[0] * d0) & (x[:, 2] < FOOT[1] * d0)
        if TIMES[0] <= time * U / D <= TIMES[1] and wall.sum() > (3 if physics.rings(head) else 20):
            tau.append(time * U / D)
            radius.append(median(np.hypot(x[wall, 0], x[wall, 1]), physics.volumes(head, f)[wall]) / D)
    return np.array(tau), np.array(radius)


def growth(tau, radius):
    """C and tau0 of radius = C sqrt(tau - tau0)."""
    slope, start = np.polyfit(tau, radius**2, 1)
    return np.sqrt(slope), -start / slope


def curves(folder):
    """For a report of the run (report.py --reference): the file of the reference; title, unit, times and values of a
    curve of the run, and those of the reference."""
    tau, radius = crown(folder)
    right = physics.table(REFERENCE)
    return REFERENCE, [("radius of the crown", "m", tau * D / U, radius * D, right["time"], right["radius"])]


def check(folder):
    tau, radius = crown(folder)
    factor, start = growth(tau, radius)
    reference = physics.table(REFERENCE)
    then, there = reference["time"] * U / D, reference["radius"] / D
    chosen = (then >= TIMES[0]) & (then <= TIMES[1])
    right, right_start = growth(then[chosen], there[chosen])
    exponent = np.polyfit(np.log(tau - start), np.log(radius), 1)[0]
    (_, head, first), (_, _, last) = (list(physics.snapshots(folder))[k] for k in (0, -1))
    return [physics.at_most("radius of the crown beside the reference, largest deviation",
                            np.abs(radius / np.interp(tau, then, there) - 1).max(), 0.05),
            physics.relative("crown, C in r/D = C sqrt(tau - tau0)", factor, right, 0.05),
            physics.shown("C of the theory without losses", factor, (2 * D / (3 * DEPTH))**0.25),
            physics.shown("tau0", start, right_start), physics.shown("exponent about tau0", exponent, 0.5),
            physics.lost(head, first, last) if physics.rings(head) else
            physics.at_most("particles lost over all", 1 - len(last["id"]) / len(first["id"]), 0.01)]


if __name__ == "__main__":
    physics.main(check)
