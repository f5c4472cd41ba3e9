#!/usr/bin/python3
"""Deep pool: the crater's depth against the model of Bisighini et al. (2010) and a volume-of-fluid computation.
check.py RUN_FOLDER"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

D, U, RHO, MU, SIGMA, G = 4e-3, 2.0, 1000.0, 1e-3, 0.072, 9.81
START = 2.0  # D/U: end of the penetration phase
WE, RE, FR = RHO * U * U * D / SIGMA, RHO * U * D / MU, U * U / (G * D)


def crater(times, steps=4000):
    """Depth over D at times over D/U of a sphere that grows (radius alpha) and sinks (centre zeta), from tau = 2 on:
    Bisighini et al. 2010 with their penetration phase, alpha = 0.77 + 0.17 tau, zeta = -0.77 + 0.27 tau, before."""
    def slope(y):
        a, z, u, w = y
        growth = -1.5 * u * u / a - 2 / (WE * a * a) - z / (FR * a) + 1.75 * w * w / a - 4 * u / (RE * a * a)
        return np.array([u, w, growth, -3 * u * w / a - 4.5 * w * w / a - 2 / FR - 12 * w / (RE * a * a)])

    return physics.integrate(slope, [0.77 + 0.17 * START, -0.77 + 0.27 * START, 0.17, 0.27], START, times,
                             steps)[:, :2].sum(axis=1)


def beside(s, reference, column):
    """Deviations from the reference from 4 to 20 ms, m."""
    t = np.linspace(4e-3, 20e-3, 65)
    return np.abs(np.interp(t, s["time"], s[column]) - np.interp(t, reference["time"], reference[column]))


def check(folder):
    s = runs.series(folder)
    places = np.array([4.0, 6.0, 8.0])
    depth = np.interp(places, s["time"] * U / D, s["crater_depth"]) / D
    exact = crater(places)
    reference = physics.table(os.path.join(HERE, "reference.csv"))
    return [physics.relative(f"crater depth over D at t U/D = {t:g}", d, e, 0.15)
            for t, d, e in zip(places, depth, exact)] + [
                physics.at_most("depth from 4 to 20 ms beside the reference, largest deviation over its largest",
                                beside(s, reference, "crater_depth").max() / reference["crater_depth"].max(), 0.1),
                physics.shown("diameter of the crater likewise", beside(s, reference, "crater_diameter").max() /
                              reference["crater_diameter"].max()),
                physics.at_most("particles lost", s["lost"][-1], 0)]


if __name__ == "__main__":
    physics.main(check)
