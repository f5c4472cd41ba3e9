#!/usr/bin/python3
"""The outline of a hanging drop against the Young-Laplace equation. check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

RHO, G = 1000.0, 9.81
STEP = 2e-7  # m, along the outline


def outline(curvature, sigma):
    """Radius, height over the tip (m), volume (m3) along the outline of a drop that hangs, from its tip to where it is
    upright: d phi/ds = curvature - rho g z/sigma - sin phi/x, phi the slope, curvature the sum of both at the tip."""
    x = z = volume = phi = 0.0
    found = [(x, z, volume)]
    while phi < np.pi / 2 and len(found) < 50000:
        turn = curvature - RHO * G * z / sigma - (np.sin(phi) / x if x else curvature / 2)
        middle = phi + 0.5 * STEP * turn
        dx, dz = STEP * np.cos(middle), STEP * np.sin(middle)
        volume += np.pi * (x + 0.5 * dx)**2 * dz
        x, z, phi = x + dx, z + dz, phi + STEP * turn
        found.append((x, z, volume))
    return np.array(found).T


def hanging(volume, sigma):
    """Radii and distances from the plate of a drop of this volume that meets the plate under 90 degrees."""
    low, high = np.sqrt(2 * RHO * G / sigma), 1e4  # 1/m; a blunter tip is not upright anywhere
    for _ in range(40):
        middle = np.sqrt(low * high)
        x, z, held = outline(middle, sigma)
        low, high = (middle, high) if held[-1] > volume else (low, middle)
    return x, z[-1] - z


def check(folder):
    state = list(physics.snapshots(folder))[-1]
    given, series = physics.options(state[1]), runs.series(folder)
    radius, height = (float(word) for word in given["-drop_upper"].split(","))
    places = [float(word) for word in given["-gauge_heights"].split(",")]
    x, distance = hanging(np.pi * radius**2 * height, float(given["-drop_tension"]))
    seen = np.array([series[f"height_{k + 1}_m"][-1] for k in range(len(places))])
    exact = np.interp(places, x, distance)
    return [physics.relative("length of the drop", 1e3 * seen[0], 1e3 * exact[0], 0.02, "mm"),
            physics.at_most("outline, rms error over its length",
                            np.sqrt(((seen - exact)**2).mean()) / exact[0], 0.015)]


if __name__ == "__main__":
    physics.main(check)
