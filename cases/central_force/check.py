#!/usr/bin/python3
"""Period, amplitude and energy of the drop in a central force; as many periods as the run has.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

PERIOD = 4.5674  # s, of the exact solution


def crossings(times, values):
    """Times at which the values pass from negative to positive, by linear interpolation."""
    k = np.flatnonzero((values[:-1] < 0) & (values[1:] >= 0))
    return times[k] - values[k] * (times[k + 1] - times[k]) / (values[k + 1] - values[k])


def check(folder):
    states = list(physics.snapshots(folder))
    times = np.array([t for t, _, _ in states])
    axes = np.array([physics.semi_axes(f["position"]) for _, _, f in states])
    axes /= np.sqrt(axes[0].prod())
    exact = physics.ellipse(-0.5, 1.0, times, steps=40)
    measured = crossings(times, np.log(axes[:, 0] / axes[:, 1]))
    wanted = crossings(times, np.log(exact[:, 0] / exact[:, 1]))
    energy = np.array([(f["velocity"]**2).sum() + (f["position"]**2).sum() for _, _, f in states])
    last = times > times[-1] - PERIOD
    period = PERIOD * measured[-1] / wanted[len(measured) - 1] if len(measured) else np.nan
    growth = (energy[-1] / energy[0] - 1) / (times[-1] / PERIOD)
    return [physics.relative("period", period, PERIOD, 0.005, "s"),
            physics.relative("amplitude of b in the last period", axes[last, 1].max(), exact[last, 1].max(), 0.01, "m"),
            physics.at_most("energy, relative change a period", growth, 0.02),
            physics.relative("area of the ellipse", np.pi * axes[-1].prod(), np.pi, 0.005, "m2"),
            physics.at_most("particles lost", len(states[0][2]["id"]) - len(states[-1][2]["id"]), 0)]


if __name__ == "__main__":
    physics.main(check)
