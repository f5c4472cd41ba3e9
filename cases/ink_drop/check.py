#!/usr/bin/python3
"""Ink drop: spread of the impact and afterwards.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

IMPACT = 1.5  # times D/U, until when the impact spreads the drop


def check(folder):
    times, spread, height = [], [], []
    for time, head, f in physics.snapshots(folder):
        x, d0 = physics.places(head, f), float(head["spacing"])
        times.append(time)
        spread.append(2 * np.hypot(x[:, 0], x[:, 1]).max() + d0)
        height.append(x[:, 2].max() + d0 / 2)
    o = physics.options(head)
    D, U, rho, mu, sigma = (factor * abs(float(o[name].split(",")[-1])) for factor, name in (
        (2, "-ink_radius"), (1, "-ink_velocity"), (1, "-ink_density"), (1, "-ink_viscosity"), (1, "-ink_tension")))
    c = np.cos(np.radians(float(o["-wall_contact_angle"])))
    radius = (D**3 / 2 / ((2 + c) * (1 - c)**2))**(1 / 3)  # of the cap at rest
    impact = max(s for t, s in zip(times, spread) if t <= IMPACT * D / U)
    number = rho * U * D / mu * np.sqrt(rho * U**2 * D / sigma)  # Re^2 Oh
    return [physics.relative("spread of the impact over D, experiments by Scheller and Bousfield 1995", impact / D,
                             0.61 * number**0.166, 0.15),
            physics.relative("diameter at the end over that of the cap's sphere", spread[-1] / (2 * radius),
                             np.sqrt(1 - c * c), 0.08),
            physics.relative("height at the end", 1e6 * height[-1], 1e6 * radius * (1 - c), 0.1, "um")]


if __name__ == "__main__":
    physics.main(check)
