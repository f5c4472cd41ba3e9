#!/usr/bin/python3
"""Sessile drop, in two dimensions or of rings: height and width against the Young-Laplace equation.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

RHO, G, SIGMA = 1000.0, 9.81, 0.072
STEPS = 2000  # of the slope angle along the outline


def outline(curvature, angle):
    """Height, half width, half area (m, m2) of the drop with this curvature at the apex: along the outline d phi/ds =
    curvature + rho g z/sigma, z the depth below the apex, phi the slope; until phi is the contact angle."""
    x = z = area = 0.0
    h = angle / STEPS
    for k in range(STEPS):
        phi = (k + 0.5) * h
        middle = curvature + RHO * G * (z + 0.5 * h * np.sin(phi) / (curvature + RHO * G * z / SIGMA)) / SIGMA
        dx, dz = h * np.cos(phi) / middle, h * np.sin(phi) / middle
        area += (x + 0.5 * dx) * dz
        x, z = x + dx, z + dz
    return z, x, area


def round_outline(curvature, angle):
    """The same of a drop of revolution with this curvature, the sum of both, at the apex: height, radius, volume (m,
    m, m3). d phi/ds = curvature + rho g z/sigma - sin phi/x, by the classical Runge-Kutta method until phi is the
    angle; the first step is on a sphere."""
    def slope(y):
        x, z, phi, _ = y
        turn = curvature + RHO * G * z / SIGMA - np.sin(phi) / x
        return np.array([np.cos(phi), np.sin(phi), turn, np.pi * x * x * np.sin(phi)]) / turn  # by phi

    phi = angle / STEPS
    radius = 2 / curvature
    start = [radius * np.sin(phi), radius * (1 - np.cos(phi)), phi, 0.25 * np.pi * radius**3 * phi**4]
    x, z, _, volume = physics.integrate(slope, start, phi, [angle], STEPS // 10)[-1]
    return z, x, volume


def young_laplace(size, angle, shape):
    """Height and half width of the drop of half the area (m2) or of the volume (m3), by bisection of the apex'
    curvature."""
    low, high = 1e-6 if shape is outline else 1, 1e5  # 1/m
    for _ in range(60):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if shape(middle, angle)[2] > size else (low, middle)
    return shape(middle, angle)[:2]


def weight_on_the_wall(folder, due, unit):
    """The force on the wall and the pull of the drop's edge, which together are the weight, in the mean of the last
    quarter."""
    s = runs.series(folder)
    both = sum(s[name] for name in s.dtype.names if name.startswith(("force_ymin_y", "force_tension_y")))
    return physics.relative("weight on the wall, with the pull of the edge",
                            -both[s["time"] > 0.75 * s["time"][-1]].mean(), due, 0.01, unit)


def check(folder):
    states = list(physics.snapshots(folder))
    head, f = states[-1][1:]
    d0, x = float(head["spacing"]), f["position"]
    angle = np.radians(float(physics.options(head)["-wall_contact_angle"]))
    rings = physics.rings(head)
    height, width = young_laplace(physics.volumes(head, states[0][2]).sum(), angle, round_outline if rings else outline)
    middle = x[:, 0] < 4 * d0
    low = x[:, 1] < 2 * d0
    top = np.sort(x[middle, 1])[-4:].mean() + d0 / 2
    return [physics.relative("height", 1e3 * top, 1e3 * height, 0.02 if rings else 0.05, "mm"),
            physics.relative("half width", 1e3 * (np.sort(x[low, 0])[-2:].mean() + d0 / 2), 1e3 * width, 0.05, "mm"),
            weight_on_the_wall(folder, RHO * G * physics.volumes(head, f).sum(), "N" if rings else "N/m"),
            physics.lost(head, states[0][2], f)]


if __name__ == "__main__":
    physics.main(check)
