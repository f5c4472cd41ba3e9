#!/usr/bin/python3
"""The velocity of a layer over a wall that swings along itself, from rest, against its series of modes. check.py
RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

NU, AMPLITUDE, RATE, DEPTH = 1e-4, 0.19739, 2 * np.pi, 25e-3  # m2/s, m/s2, 1/s, m
MODES = 200


def exact(y, t):
    """u (m/s) of u_t = nu u_yy + A sin w t, u(0) = 0, u_y(H) = 0, from rest: each mode sin k y by itself."""
    k = (np.arange(MODES) + 0.5) * np.pi / DEPTH
    decay = NU * k**2
    a = (2 / (k * DEPTH) * AMPLITUDE / (decay**2 + RATE**2) *
         (decay * np.sin(RATE * t) - RATE * np.cos(RATE * t) + RATE * np.exp(-decay * t)))
    return np.sin(np.outer(y, k)) @ a


def check(folder):
    errors = [np.sqrt(((f["velocity"][:, 0] - exact(f["position"][:, 1], time))**2).mean()) * RATE / AMPLITUDE
              for time, _, f in physics.snapshots(folder)]
    return [physics.at_most("velocity, largest rms error over its amplitude far from the wall", max(errors), 0.01)]


if __name__ == "__main__":
    physics.main(check)
