#!/usr/bin/python3
"""Parabola and momentum of a falling cluster.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402


G, V = np.array([1.0, -2.0, -9.81]), np.array([0.5, 0.0, 2.0])


def check_rings(states):
    (_, head, a), (t, _, b) = states[0], states[-1]
    start, end = (np.average(np.stack([f["position"][:, 1], f["velocity"][:, 1]]), axis=1,
                             weights=physics.volumes(head, f)) for f in (a, b))
    fall, gained = V[2] * t + 0.5 * G[2] * t * t, G[2] * t
    return [physics.relative("distance fallen by the centre of mass", start[0] - end[0], -fall, 1e-3, "m"),
            physics.at_most("momentum, error over m v", abs(end[1] - start[1] - gained) / V[2], 1e-3),
            physics.lost(head, a, b)]


def check(folder):
    states = list(physics.snapshots(folder))
    (_, head, a), (t, _, b) = states[0], states[-1]
    if physics.rings(head):
        return check_rings(states)
    if len(a["id"]) != len(b["id"]):
        raise ValueError(f"{len(a['id'])} particles at the start, {len(b['id'])} at the end")
    fall = V * t + 0.5 * G * t * t
    spin = [np.cross(f["position"] - f["position"].mean(axis=0),
                     f["velocity"] - f["velocity"].mean(axis=0)).sum(axis=0) for f in (a, b)]
    radius = np.linalg.norm(a["position"] - a["position"].mean(axis=0), axis=1).max()
    scale = len(a["id"]) * max(radius, float(np.ravel(head["spacing"])[0])) * np.linalg.norm(V)
    moved = b["position"].mean(axis=0) - a["position"].mean(axis=0)
    gained = b["velocity"].mean(axis=0) - V
    results = [physics.relative("distance fallen by the centre of mass", -moved[2], -fall[2], 1e-12, "m"),
               physics.at_most("parabola, error over the distance", np.abs(moved - fall).max() / np.linalg.norm(fall),
                               1e-12),
               physics.at_most("momentum, error over m v", np.abs(gained - G * t).max() / np.linalg.norm(V), 1e-12),
               physics.at_most("angular momentum, change over m v R", np.abs(spin[1] - spin[0]).max() / scale, 1e-10)]
    if len(a["id"]) == 1:
        results.append(physics.at_most("pressure of a single particle", np.abs(b["pressure"]).max(), 0, "Pa"))
    return results


if __name__ == "__main__":
    physics.main(check)
