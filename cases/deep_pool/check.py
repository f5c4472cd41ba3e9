#!/usr/bin/python3
"""Deep pool: the crater's depth against the equation of a growing hemisphere (Berberovic et al. 2009).
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

D, U, RHO, MU, SIGMA, G = 4e-3, 2.0, 1000.0, 1e-3, 0.072, 9.81
WE, RE, FR = RHO * U * U * D / SIGMA, RHO * U * D / MU, U * U / (G * D)


def hemisphere(times, steps=2000):
    """Depth over D at times over D/U: tau/2 up to 2, then the hemisphere driven by inertia against gravity, surface
    tension and viscosity."""
    def slope(y):
        depth, speed = y
        return np.array([speed, -1.5 * speed**2 / depth - 2 / (WE * depth**2) - 1 / FR - 4 * speed / (RE * depth**2)])

    y, tau, out = np.array([1.0, 0.5]), 2.0, []
    for time in times:
        if time <= 2:
            out.append(0.5 * time)
            continue
        h = (time - tau) / steps
        for _ in range(steps):
            k1 = slope(y)
            k2 = slope(y + h / 2 * k1)
            k3 = slope(y + h / 2 * k2)
            k4 = slope(y + h * k3)
            y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        tau = time
        out.append(y[0])
    return np.array(out)


def check(folder):
    s = runs.series(folder)
    places = np.array([1.0, 2.0, 4.0, 6.0, 8.0])
    depth = np.interp(places, s["time"] * U / D, s["crater_depth"]) / D
    exact = hemisphere(places)
    return [physics.relative("crater depth over D at t U/D = 4", depth[2], exact[2], 0.15),
            physics.relative("crater depth over D at t U/D = 6", depth[3], exact[3], 0.15)] + [
                physics.shown(f"crater depth over D at t U/D = {places[k]:g}", depth[k], exact[k]) for k in (0, 1, 4)]


if __name__ == "__main__":
    physics.main(check)
