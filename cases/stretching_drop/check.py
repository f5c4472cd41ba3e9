#!/usr/bin/python3
"""Semi-axes and area of the drop that is stretched.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402


def check(folder):
    states = list(physics.snapshots(folder))
    exact = physics.ellipse(-100.0, 0.0, [t for t, _, _ in states])
    axes = np.array([physics.semi_axes(f["position"]) for _, _, f in states])
    start = axes[0]  # a lattice cut to a circle
    energy = [(f["velocity"]**2).sum() for _, _, f in states]
    return [("semi-axis a, largest relative error", np.abs(axes[:, 0] / start[0] / exact[:, 0] - 1).max(),
             0.01), ("semi-axis b, largest relative error", np.abs(axes[:, 1] / start[1] / exact[:,
                                                                                                 1] - 1).max(),
                                                                                                 0.01),
            ("area of the ellipse, relative change", axes[-1].prod() / start.prod() - 1,
             0.005), ("kinetic energy, relative change", energy[-1] / energy[0] - 1, 0.02),
             ("particles lost", len(states[0][2]["id"]) - len(states[-1][2]["id"]), 0)]


if __name__ == "__main__":
    physics.main(check)
