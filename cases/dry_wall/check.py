#!/usr/bin/python3
"""Dry wall: spread and height against a volume-of-fluid computation, the largest spread also against Laan et al. 2014,
the height at the end against a cap of the contact angle.
check.py RUN_FOLDER"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

D, U, RHO, MU, SIGMA = 2e-3, 1.0, 1190.0, 36e-3, 0.065
SINKING = np.linspace(0.25e-3, 1.5e-3, 26)  # s
WE, RE = RHO * U * U * D / SIGMA, RHO * U * D / MU


def laan():
    """Largest diameter over D: Re^(1/5) sqrt(P)/(1.24 + sqrt(P)), P = We Re^(-2/5)."""
    root = np.sqrt(WE * RE**-0.4)
    return RE**0.2 * root / (1.24 + root)


def cap(angle):
    """Height of a spherical cap of the drop's volume: V = pi R^3 (2 + cos)(1 - cos)^2/3."""
    c = np.cos(np.radians(angle))
    radius = (D**3 / 2 / ((2 + c) * (1 - c)**2))**(1 / 3)
    return radius * (1 - c)


def check(folder):
    times, spread, height, share = [], [], [], []
    for time, head, f in physics.snapshots(folder):
        x, d0 = physics.places(head, f), float(head["spacing"])
        whole = physics.components(x, 1.5 * d0) == 0
        times.append(time)
        spread.append(2 * np.hypot(x[whole, 0], x[whole, 1]).max() + d0)
        height.append(x[whole, 2].max() + d0 / 2)
        volume = physics.volumes(head, f)
        share.append(volume[whole].sum() / volume.sum())
    angle = float(physics.options(head)["-wall_contact_angle"])
    reference = physics.table(os.path.join(HERE, "reference.csv"))
    there = np.interp(SINKING, reference["time"], reference["height"])
    return [physics.at_most("height from 0.25 to 1.5 ms beside the reference, largest deviation",
                            np.abs(np.interp(SINKING, times, height) / there - 1).max(), 0.05),
            physics.relative("largest diameter over D", max(spread) / D, reference["diameter"].max() / D, 0.1),
            physics.shown("the same, fit of experiments by Laan et al.", max(spread) / D, laan()),
            physics.relative("height at the end", 1e3 * height[-1], 1e3 * cap(angle), 0.1, "mm"),
            physics.at_most("liquid that came off", 1 - share[-1], 0.01)]


if __name__ == "__main__":
    physics.main(check)
