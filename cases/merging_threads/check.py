#!/usr/bin/python3
"""How fast two threads merge, against Hopper (1984). check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

RADIUS, TENSION, VISCOSITY = 1e-3, 0.072, 10.0  # m, N/m, Pa s
LENGTHS = (1.9, 1.8, 1.7)  # half lengths over the radius: 2 of threads that touch, 1.414 of the circle at the end


def elliptic(k):
    """The complete elliptic integral of the first kind of the modulus k."""
    a, b = np.ones_like(k), np.sqrt(1 - k * k)
    for _ in range(40):
        a, b = (a + b) / 2, np.sqrt(a * b)
    return np.pi / (2 * a)


def merged(length):
    """Time (s) after which threads that touch at first have this half length, (1 + m)/sqrt(1 + m^2) of the radius of
    the circle at the end: t = pi/4 mu R/sigma int_(m^2)^1 dk/(k sqrt(1 + k) K(k))."""
    end = np.sqrt(2) * RADIUS
    m = np.linspace(0, 1, 200001)[1:]
    m = m[np.argmin(np.abs((1 + m) / np.sqrt(1 + m * m) - length / np.sqrt(2)))]
    edge = np.linspace(m * m, 1, 20001)
    k = (edge[1:] + edge[:-1]) / 2
    return np.pi / 4 * VISCOSITY * end / TENSION * ((edge[1] - edge[0]) / (k * np.sqrt(1 + k) * elliptic(k))).sum()


def half_length(fields, spacing):
    """Of the pair (m), from the second moment of the liquid: that of Hopper's shape has no such formula, so from its
    farthest particles, half a spacing outside their centres."""
    x = fields["position"][fields["body"] >= 0][:, 0]
    return np.sort(x)[-3:].mean() + 0.5 * spacing


def check(folder):
    time, length = [], []
    for t, head, fields in physics.snapshots(folder):
        time.append(t)
        length.append(half_length(fields, float(head["spacing"])) / RADIUS)
    due = np.array([merged(f) for f in LENGTHS])
    got = np.interp(-np.array(LENGTHS), -np.array(length), time)
    return [physics.relative(f"time from half length {LENGTHS[0]} to {f}", 1e3 * (got[k] - got[0]),
                             1e3 * (due[k] - due[0]), 0.1, "ms") for k, f in enumerate(LENGTHS) if k]


if __name__ == "__main__":
    physics.main(check)
