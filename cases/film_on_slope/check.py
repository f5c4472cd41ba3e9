#!/usr/bin/python3
"""Speed of a film on a slope, against Nusselt's film and how it starts from rest. check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

DEPTH, VISCOSITY, ALONG = 2e-3, 1e-4, 4.905  # m, m2/s, m/s2
TIMES = (0.05, 0.1, 0.2)  # s


def speed(z, t, terms=40):
    """Of liquid from rest (m/s) at the height z (m) after the time t (s): Nusselt's parabola less the modes that decay,
    which stick at the slope and slip at the surface."""
    u = ALONG / VISCOSITY * (DEPTH * z - z * z / 2)
    for n in range(terms):
        k = (n + 0.5) * np.pi / DEPTH
        u = u - 2 * ALONG / (VISCOSITY * DEPTH * k**3) * np.sin(k * z) * np.exp(-VISCOSITY * k * k * t)
    return u


def check(folder):
    times, ratios = [], []
    for time, _, fields in list(physics.snapshots(folder))[1:]:
        liquid = fields["body"] >= 0
        z, u = fields["position"][liquid][:, 1], fields["velocity"][liquid][:, 0]
        times.append(time)
        ratios.append(u.sum() / speed(z, time).sum())
    return [physics.relative(f"mean speed over the exact one at {1e3 * t:g} ms", np.interp(t, times, ratios), 1, 0.02)
            for t in TIMES]


if __name__ == "__main__":
    physics.main(check)
