#!/usr/bin/python3
"""A sheet of honey falls from a slot: it stays in one piece, as thick as the balance of its forces says.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

SLOT, WIDTH, SPEED = 55e-3, 5e-3, 0.1  # m, m/s
DENSITY, VISCOSITY, TENSION, GRAVITY = 1400.0, 10.0, 0.06, 9.81
STEADY = 0.5  # s, from which on the sheet that hangs has its thickness
HALF = 2.5e-3  # m, of the stretch that a thickness is measured over


def thickness(depths, steps=40):
    """Of the steady sheet (m) at these depths below the slot. Its speed u: d/dz (4 mu e u') = rho e (u u' - g), e u =
    the flow; where it is cut off, 4 mu e u' = -2 sigma. The slope at the slot is found by bisection."""
    def slope(y):
        u, s = y
        return np.array([s, s * s / u + DENSITY / (4 * VISCOSITY) * (u * s - GRAVITY)])

    low, high = 0.0, 10.0
    while high - low > 1e-9:
        middle = (low + high) / 2
        u, s = physics.integrate(slope, [SPEED, middle], 0.0, [SLOT], 10 * steps)[0]
        pull = 4 * VISCOSITY * WIDTH * SPEED / u * s + 2 * TENSION
        low, high = (middle, high) if u < 0 or pull < 0 else (low, middle)
    return WIDTH * SPEED / physics.integrate(slope, [SPEED, low], 0.0, depths, steps)[:, 0]


def check(folder):
    depths = np.array([15e-3, 25e-3, 35e-3, 45e-3])
    pieces, late = 0, []
    for time, head, f in physics.snapshots(folder):
        liquid = f["body"] >= 0
        x, d0 = f["position"][liquid], float(head["spacing"])
        pieces = max(pieces, 1 + physics.components(x, 1.6 * d0).max())
        if time > STEADY:
            late.append([(np.abs(SLOT - x[:, 1] - z) < HALF).sum() * d0 * d0 / (2 * HALF) for z in depths])
    table = physics.table(os.path.join(folder, "series.csv"))
    return [physics.absolute("pieces, most of all times", pieces, 1, 0)] + [
        physics.relative(f"thickness {1e3 * z:.0f} mm below the slot", 1e3 * e, 1e3 * exact, 0.08, "mm")
        for z, e, exact in zip(depths, np.mean(late, axis=0), thickness(depths))] + [
        physics.at_most("density error, largest", table["density_error"].max(), 0.035)]


if __name__ == "__main__":
    physics.main(check)
