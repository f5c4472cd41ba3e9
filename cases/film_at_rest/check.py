#!/usr/bin/python3
"""Pressure, motion, level and volume of a liquid at rest; of the film or the tank.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402


def check(folder):
    errors, instant, speed, centre = [], [], [], []
    for time, head, f in physics.snapshots(folder):
        dim = int(head["dimension"])
        up = dim - 1
        if time == 0:
            n = len(f["id"])
            rho, g, low, high = (1100.0, 9.81, -0.01, 0.0) if dim == 3 else (1000.0, 1.0, 0.0, 0.9)
            depth, relaxed = high - low, 10 * np.sqrt((high - low) / g)
            end = 0.3 * relaxed
        z = f["position"][:, up]
        centre.append((z.mean() - low) / depth)
        if time < end or len(z) != n:
            continue
        e = f["pressure"] / (rho * g * depth) - (high - z) / depth
        errors.append(e)
        instant.append(np.sqrt((e**2).mean()))
        speed.append(np.sqrt((f["velocity"]**2).sum(axis=1).mean() / (g * depth)))
    if not errors:
        return [("particles lost", n - len(z), 0)]
    return [("mean pressure, rms error over rho g H", np.sqrt((np.mean(errors, axis=0)**2).mean()), 0.02),
            ("largest instantaneous rms pressure error over rho g H", max(instant), 0.05),
            ("rms speed over sqrt(g H), second half", np.mean(speed[len(speed) // 2:]), 2e-3),
            ("change of the level, over H", 2 * (centre[-1] - centre[0]), 0.005),
            ("particles lost", n - len(z), 0)]


if __name__ == "__main__":
    physics.main(check)
