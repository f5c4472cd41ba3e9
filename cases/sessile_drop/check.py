#!/usr/bin/python3
"""Sessile drop in two dimensions: height and width against the Young-Laplace equation.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

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


def young_laplace(area, angle):
    """Height and half width of the drop of half the area (m2), by bisection of the apex' curvature."""
    low, high = 1e-6, 1e5  # 1/m
    for _ in range(60):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if outline(middle, angle)[2] > area else (low, middle)
    return outline(middle, angle)[:2]


def check(folder):
    states = list(physics.snapshots(folder))
    head, f = states[-1][1:]
    d0, x = float(head["spacing"]), f["position"]
    angle = np.radians(float(physics.options(head)["-wall_contact_angle"]))
    height, width = young_laplace(len(states[0][2]["id"]) * d0**2, angle)
    middle = x[:, 0] < 4 * d0
    low = x[:, 1] < 2 * d0
    top = np.sort(x[middle, 1])[-4:].mean() + d0 / 2
    return [physics.relative("height", 1e3 * top, 1e3 * height, 0.05, "mm"),
            physics.relative("half width", 1e3 * (np.sort(x[low, 0])[-2:].mean() + d0 / 2), 1e3 * width, 0.05, "mm"),
            physics.at_most("particles lost", len(states[0][2]["id"]) - len(f["id"]), 0)]


if __name__ == "__main__":
    physics.main(check)
