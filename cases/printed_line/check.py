#!/usr/bin/python3
"""Printed line: the pressure in the drop in flight, one piece at the end.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

SIGMA, R = 0.03, 15e-6  # N/m, m
FLIGHT = (-1.2e-6, -0.4e-6)  # s: after the first steps, before the kernels of drop and line meet


def check(folder):
    pressure, states = [], list(physics.snapshots(folder))
    for time, head, f in states:
        inside = (f["body"] == 1) & (f["surface"] == 0)
        if FLIGHT[0] <= time <= FLIGHT[1]:
            pressure.append(np.median(f["pressure"][inside]))
    x, d0 = f["position"], float(head["spacing"])
    pieces = physics.components(x, 1.5 * d0).max() + 1
    foot = x[:, 2] < 2 * d0
    return [physics.relative("pressure in the drop before it lands", np.mean(pressure), 2 * SIGMA / R, 0.05, "Pa"),
            physics.absolute("pieces at the end", pieces, 1, 0),
            physics.at_most("particles lost", len(states[0][2]["id"]) - len(f["id"]), 0),
            physics.shown("half width of the line where the drop landed", 1e6 * (x[foot & (x[:, 1] < 10e-6), 0].max() +
                                                                                  d0 / 2), unit="um"),
            physics.shown("half width of the line at the end of the box", 1e6 * (x[foot & (x[:, 1] > 70e-6), 0].max() +
                                                                                  d0 / 2), 30, "um")]


if __name__ == "__main__":
    physics.main(check)
