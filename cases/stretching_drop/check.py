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
    times = [t for t, _, _ in states]
    exact = physics.ellipse(-100.0, 0.0, times)
    axes = np.array([physics.semi_axes(f["position"]) for _, _, f in states])
    axes /= axes[0]  # at the start a lattice cut to a circle of radius 1
    energy = [(f["velocity"]**2).sum() for _, _, f in states]
    end = f"at {times[-1] * 1e3:g} ms"
    return [
        physics.relative(f"semi-axis a {end}", axes[-1, 0], exact[-1, 0], 0.01, "m"),
        physics.relative(f"semi-axis b {end}", axes[-1, 1], exact[-1, 1], 0.01, "m"),
        physics.at_most("largest relative error of a and b at all times", np.abs(axes / exact - 1).max(), 0.01),
        physics.relative("area of the ellipse", np.pi * axes[-1].prod(), np.pi, 0.005, "m2"),
        physics.relative("kinetic energy over that at the start", energy[-1] / energy[0], 1, 0.02),
        physics.at_most("particles lost", len(states[0][2]["id"]) - len(states[-1][2]["id"]), 0)]


if __name__ == "__main__":
    physics.main(check)
