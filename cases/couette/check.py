#!/usr/bin/python3
"""Velocity of Couette flow from rest, between plates or, of rings, between cylinders.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402


L, NU, U = 1e-3, 1e-6, 1.25e-5  # m, m2/s, m/s
INNER, OUTER = 0.5e-3, 1.5e-3  # m: radii of the cylinders


def exact(y, t):
    u = U * y / L
    for n in range(1, 100):
        u = u + 2 * U / (n * np.pi) * (-1)**n * np.sin(n * np.pi * y / L) * np.exp(-(n * np.pi / L)**2 * NU * t)
    return u


def check_annulus(folder):
    """The steady flow U ln(r/R_i)/ln(R_o/R_i) along the axis, at the last time."""
    _, head, f = list(physics.snapshots(folder))[-1]
    r, u = f["position"][:, 0], f["velocity"][:, 1]
    e = (u - U * np.log(r / INNER) / np.log(OUTER / INNER)) / U
    middle = np.abs(r - L) < 1.1 * float(head["spacing"])
    wanted = U * np.log(L / INNER) / np.log(OUTER / INNER)
    return [physics.relative(f"velocity at r = {L:g} m, last time", wanted + U * e[middle].mean(), wanted, 0.01, "m/s"),
            physics.at_most("largest velocity error over U, last time", np.abs(e).max(), 0.01)]


def check(folder):
    if physics.rings(next(physics.snapshots(folder))[1]):
        return check_annulus(folder)
    return physics.shear(folder, exact, U, 0.75e-3)


if __name__ == "__main__":
    physics.main(check)
