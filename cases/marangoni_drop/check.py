#!/usr/bin/python3
"""The circulation in a drop in a gradient of temperature and the velocity in a layer, beside the exact ones. check.py
RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

MU, PULL, RADIUS, STEADY = 0.05, 0.45, 1e-3, 7e-3  # Pa s, |dsigma/dT| dT/dz (N/m2), m, s
SPEED = PULL * RADIUS / (3 * MU)  # m/s, at the centre


def exact(x, z):
    """Stokes flow in a sphere whose surface the stress PULL sin(theta) draws: the vortex of Hill. Its shear stress at
    the surface is 3 mu SPEED/R sin(theta), and its normal stress is that of the tension sigma(T) kappa: the drop stays
    round and at its place."""
    r = np.hypot(x, z)
    c, s, q = z / r, x / r, (r / RADIUS)**2
    across, along = SPEED * (1 - q) * c, -SPEED * (1 - 2 * q) * s
    return np.stack([across * s + along * c, across * c - along * s], axis=1)


# of the layer: stress (N/m2), depth, length (m), from when on it is steady (s)
STRESS, DEPTH, LENGTH, LEVEL = 0.045, 1e-3, 4e-3, 0.17


def check_layer(folder):
    """Where the walls are far: the surface is drawn to the cold wall, and below it as much comes back."""
    errors, surface = [], STRESS * DEPTH / (4 * MU)
    for time, _, f in physics.snapshots(folder):
        x, y = f["position"][:, 0], f["position"][:, 1]
        middle = np.abs(x - 0.5 * LENGTH) < 0.5 * DEPTH
        if time > LEVEL:
            u = STRESS / MU * (0.5 * y - 0.75 * y * y / DEPTH)
            errors.append(np.sqrt(np.mean((f["velocity"][:, 0] - u)[middle]**2)) / surface)
    return [physics.at_most("velocity, rms error over that of the surface", np.mean(errors), 0.03)]


def check(folder):
    head = next(physics.snapshots(folder))[1]
    if "-oil_tension" in physics.options(head):
        return check_layer(folder)
    shares = []
    for time, _, f in physics.snapshots(folder):
        if time < STEADY:
            continue
        x, v, weight = f["position"][:, :2], f["velocity"][:, :2], f["volume"].reshape(-1, 1)
        mean = (weight * v).sum(axis=0) / weight.sum()
        middle = (weight * x).sum(axis=0)[1] / weight.sum()
        u = exact(x[:, 0], x[:, 1] - middle)
        shares.append((weight * (v - [0, mean[1]]) * u).sum() / (weight * u**2).sum())
    return [physics.relative("circulation over the exact one", np.mean(shares), 1, 0.05)]


if __name__ == "__main__":
    physics.main(check)
