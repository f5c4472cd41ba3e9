#!/usr/bin/python3
"""Velocity of plane Poiseuille flow from rest.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402


L, NU, U = 1e-3, 1e-6, 1.25e-5  # m, m2/s, m/s


def exact(y, t):
    u = 4 * U * y * (L - y) / L**2
    for n in range(1, 200, 2):
        u = u - 32 * U / (n * np.pi)**3 * np.sin(n * np.pi * y / L) * np.exp(-(n * np.pi / L)**2 * NU * t)
    return u


def check(folder):
    return physics.shear(folder, exact, U, 0.5e-3)


if __name__ == "__main__":
    physics.main(check)
