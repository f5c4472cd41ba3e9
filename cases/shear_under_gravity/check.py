#!/usr/bin/python3
"""The slope of the velocity of an inviscid layer that shears, and its motion across. check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

DEPTH, G = 0.2, 9.81  # m, m/s2


def check(folder):
    states = list(physics.snapshots(folder))
    slopes = [np.polyfit(f["position"][:, 1], f["velocity"][:, 0], 1)[0] for _, _, f in states]
    time, head, last = states[-1]
    d0 = head["spacing"]
    viscosity = np.log(slopes[0] / slopes[-1]) / ((np.pi / DEPTH)**2 * time)
    return [physics.relative("slope of the velocity at the end over that at the start", slopes[-1] / slopes[0], 1,
                             0.03),
            physics.at_most("rms speed across", np.sqrt((last["velocity"][:, 1]**2).mean()), 0.003, "m/s"),
            physics.shown("viscosity that this is, over d0 sqrt(g d0)", viscosity / (d0 * np.sqrt(G * d0)))]


if __name__ == "__main__":
    physics.main(check)
