#!/usr/bin/python3
"""Velocity and decay of the Taylor-Green vortices; the Reynolds number is read from the options of the run.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402


def check(folder):
    k, error, pressure = 2 * np.pi, [], []
    for t, head, f in physics.snapshots(folder):
        options = dict(line.split(None, 1) for line in head["options"].decode().splitlines()
                       if len(line.split()) > 1)
        reynolds = 1 / float(options["-water_viscosity"])
        x, y = f["position"][:, 0], f["position"][:, 1]
        decay = np.exp(-8 * np.pi**2 / reynolds * t)
        exact = decay * np.hypot(np.cos(k * x) * np.sin(k * y), np.sin(k * x) * np.cos(k * y))
        speed = np.hypot(f["velocity"][:, 0], f["velocity"][:, 1])
        error.append(np.abs(speed - exact).mean() / exact.mean())
        p = -0.25 * decay**2 * (np.cos(2 * k * x) + np.cos(2 * k * y))
        pressure.append(np.sqrt(((f["pressure"] - f["pressure"].mean() - p)**2).mean() / (p**2).mean()))
        energy = (speed**2).mean() / (0.5 * decay**2) - 1
        drift = np.abs(f["velocity"].mean(axis=0)).max()
    # the issue gives tolerances for Re 100 at 50 x 50 and 100 x 100
    return [("velocity error L1 at the end", error[-1], 0.015 if head["spacing"] > 0.0101 else 0.01),
            ("kinetic energy error at the end", energy, 0.03), ("momentum over U", drift, 1e-3)]


if __name__ == "__main__":
    physics.main(check)
