#!/usr/bin/python3
"""Drag of a cylinder that moves along a channel, against Faxen (1946).
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

VISCOSITY, SPEED, RATIO = 10.0, 1.0, 0.25  # Pa s, m/s, diameter over width


def faxen(k):
    """Drag over viscosity and speed: 4 pi over a series in the ratio of diameter and width."""
    return 4 * np.pi / (np.log(1 / k) - 0.9157 + 1.7244 * k**2 - 1.7302 * k**4 + 2.4056 * k**6 - 4.5913 * k**8)


def check(folder):
    s = runs.series(folder)
    along, across = (next(s[n] for n in s.dtype.names if n.startswith(f"force_cylinder_{d}")) for d in "xy")
    due = VISCOSITY * SPEED * faxen(RATIO)
    return [physics.relative("drag", -along[-1], due, 0.1, "N/m"),
            physics.at_most("force across over the drag", across[-1] / due, 0.02)]


if __name__ == "__main__":
    physics.main(check)
