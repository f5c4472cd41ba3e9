#!/usr/bin/python3
"""Parabola and momentum of a falling cluster.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402


G, V = np.array([1.0, -2.0, -9.81]), np.array([0.5, 0.0, 2.0])


def check(folder):
    states = list(physics.snapshots(folder))
    (_, _, a), (t, _, b) = states[0], states[-1]
    fall = V * t + 0.5 * G * t * t
    spin = [np.cross(f["position"] - f["position"].mean(axis=0),
                     f["velocity"] - f["velocity"].mean(axis=0)).sum(axis=0) for f in (a, b)]
    scale = len(a["id"]) * 0.078 * np.linalg.norm(V)
    moved = b["position"].mean(axis=0) - a["position"].mean(axis=0)
    gained = b["velocity"].mean(axis=0) - V
    return [("parabola, error over the distance fallen", np.abs(moved - fall).max() / np.linalg.norm(fall), 1e-10),
            ("momentum, error over m v", np.abs(gained - G * t).max() / np.linalg.norm(V), 1e-10),
            ("angular momentum, over m v R", np.abs(spin[1] - spin[0]).max() / scale, 1e-10)]


if __name__ == "__main__":
    physics.main(check)
