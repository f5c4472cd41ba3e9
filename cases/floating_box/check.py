#!/usr/bin/python3
"""How deep a box floats, after Archimedes, and how it heaves, against linear theory of the tank.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

TANK, WIDTH, HEIGHT, MASS, RHO, G = 1.6, 0.3, 0.2, 45.0, 1000.0, 9.81  # m, m, m, kg/m, kg/m3, m/s2
DRAUGHT = MASS / (RHO * WIDTH)
CELL, STEP = 0.0125, 1e-3  # m, s: of the theory; half the cell changes the times of rest by 0.5 %


def potentials(depth):
    """One half of the tank in cells, the potential in each of them by a Laplace equation: the surface's potential is
    given, and the flux through the box's bottom. Returns what the upward speed of the surface and the mean potential
    on the bottom are for either: of the surface's potential (matrix, row), of the box's speed (column, number)."""
    nx, ny, b, t = (round(x / CELL) for x in (TANK / 2, depth, WIDTH / 2, DRAUGHT))
    number = -np.ones((nx, ny), int)
    wet = [(i, j) for i in range(nx) for j in range(ny) if not (i < b and j >= ny - t)]
    for k, place in enumerate(wet):
        number[place] = k
    a, given = np.zeros((len(wet), len(wet))), np.zeros((len(wet), nx - b + 1))
    for k, (i, j) in enumerate(wet):
        for x, y in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if y == ny:  # the surface, half a cell away
                a[k, k] += 2
                given[k, i - b] = 2
            elif 0 <= x < nx and y >= 0 and number[x, y] >= 0:
                a[k, k] += 1
                a[k, number[x, y]] -= 1
            elif y == j + 1:  # the bottom of the box
                given[k, -1] = CELL
    phi = np.linalg.solve(a, given)
    top, under = number[b:, ny - 1], number[:b, ny - t - 1]
    rise = -2 / CELL * phi[top]
    rise[:, :-1] += 2 / CELL * np.eye(nx - b)
    push = phi[under].mean(axis=0)
    push[-1] += CELL / 2
    return rise[:, :-1], rise[:, -1], push[:-1], push[-1]


def heave(depth, z, surface, end):
    """Times and heights (m) of the box over where it floats, let go at z (m), the surface at 'surface' (m)."""
    rise, lift, push, own = potentials(depth)
    eta, phi, v, height = np.full(len(lift), surface), np.zeros(len(lift)), 0.0, []
    for _ in range(int(end / STEP)):
        height.append(z)
        v += STEP * (RHO * WIDTH * G * (push @ eta - z)) / (MASS + RHO * WIDTH * own)
        phi -= STEP * G * eta
        eta = eta + STEP * (rise @ phi + lift * v)
        z += STEP * v
    return STEP * np.arange(len(height)), np.array(height)


def rests(t, y):
    """When y crosses zero."""
    k = np.nonzero(y[1:] * y[:-1] < 0)[0]
    return t[k] + (t[k + 1] - t[k]) * y[k] / (y[k] - y[k + 1])


def box(s):
    t, bottom = s["time"], s["float_y_m"] - HEIGHT / 2
    level = np.mean([s[f"height_{k}_m"] for k in range(1, 5)], axis=0)
    volume = s["volume"][0]
    mean = (volume + MASS / RHO) / TANK
    over = bottom - (mean - DRAUGHT)
    theory = rests(*heave(mean, over[0], (volume + WIDTH * (level[0] - bottom[0])) / TANK - mean, t[-1]))
    got = rests(t, over)
    two = (t >= got[0]) & (t <= got[4])  # periods
    return [physics.relative("draught, mean of two periods", (level - bottom)[two].mean(), DRAUGHT, 0.01, "m"),
            physics.relative("period of the heave, mean of two", (got[4] - got[0]) / 2, (theory[4] - theory[0]) / 2,
                             0.05, "s"),
            physics.at_most("first rest, difference over the period",
                            abs(got[0] - theory[0]) / (theory[4] - theory[0]) * 2, 0.05)]


def sphere(s):
    """A sphere that begins to sink takes half of the water that it displaces along."""
    m, displaced = 1.0472, RHO * 4 / 3 * np.pi * 0.05**3  # kg
    fall = -np.polyfit(s["time"], s["ball_velocity_y_ms"], 1)[0]
    return [physics.relative("acceleration of a sphere that sinks", fall, (m - displaced) * G / (m + displaced / 2),
                             0.05, "m/s2")]


def check(folder):
    s = runs.series(folder)
    return sphere(s) if "ball_y_m" in s.dtype.names else box(s)


if __name__ == "__main__":
    physics.main(check)
