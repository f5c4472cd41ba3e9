#!/usr/bin/python3
"""Velocity of plane Couette flow from rest.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402


L, NU, U = 1e-3, 1e-6, 1.25e-5  # m, m2/s, m/s


def exact(y, t):
    u = U * y / L
    for n in range(1, 100):
        u = u + 2 * U / (n * np.pi) * (-1)**n * np.sin(n * np.pi * y / L) * np.exp(-(n * np.pi / L)**2 * NU * t)
    return u


def check(folder):
    return physics.shear(folder, exact, U, 0.75e-3)


if __name__ == "__main__":
    physics.main(check)
