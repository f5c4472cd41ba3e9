#!/usr/bin/python3
"""Velocity and decay of the Taylor-Green vortices; the Reynolds number is read from the options of the run.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402


def check(folder):
    k = 2 * np.pi
    for t, head, f in physics.snapshots(folder):
        reynolds = 1 / float(physics.options(head)["-water_viscosity"])
        x, y = f["position"][:, 0], f["position"][:, 1]
        decay = np.exp(-8 * np.pi**2 / reynolds * t)
        exact = decay * np.hypot(np.cos(k * x) * np.sin(k * y), np.sin(k * x) * np.cos(k * y))
        speed = np.hypot(f["velocity"][:, 0], f["velocity"][:, 1])
    p = -0.25 * decay**2 * (np.cos(2 * k * x) + np.cos(2 * k * y))
    pressure = np.sqrt(((f["pressure"] - f["pressure"].mean() - p)**2).mean() / (p**2).mean())
    # the issue gives tolerances for Re 100 at 50 x 50 and 100 x 100
    limit = 0.015 if float(np.ravel(head["spacing"])[0]) > 0.0101 else 0.01
    return [physics.at_most("velocity error L1 at the end", np.abs(speed - exact).mean() / exact.mean(), limit),
            physics.relative("mean kinetic energy at the end", (speed**2).mean() / 2, 0.25 * decay**2, 0.03, "J/kg"),
            physics.shown("rms pressure error over rms pressure, at the end", pressure, 0),
            physics.at_most("momentum over U", np.abs(f["velocity"].mean(axis=0)).max(), 1e-3)]


if __name__ == "__main__":
    physics.main(check)
