#!/usr/bin/python3
"""Velocity of Poiseuille flow from rest, between plates or, of rings, through a pipe.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402


L, NU, U = 1e-3, 1e-6, 1.25e-5  # m, m2/s, m/s


def exact(y, t):
    u = 4 * U * y * (L - y) / L**2
    for n in range(1, 200, 2):
        u = u - 32 * U / (n * np.pi)**3 * np.sin(n * np.pi * y / L) * np.exp(-(n * np.pi / L)**2 * NU * t)
    return u


def zeros(count):
    """The first zeros of J0, by Newton's method."""
    found = []
    for n in range(1, count + 1):
        x = (n - 0.25) * np.pi
        for _ in range(6):
            x += physics.bessel(x)[0] / physics.bessel(x)[1]
        found.append(x)
    return found


def pipe(r, t):
    """U (1 - r2/R2) - sum 8 U J0(z r/R)/(z^3 J1(z)) exp(-z^2 nu t/R^2) over the zeros z of J0; R = L."""
    u = U * (1 - (r / L)**2)
    for z in zeros(6):
        shape = physics.bessel(z * r / L)[0]
        u = u - 8 * U * shape / (z**3 * physics.bessel(z)[1]) * np.exp(-z * z * NU * t / L**2)
    return u


def misfit(t, mean, rate):
    """What the best A + B exp(-rate t) leaves of the mean velocity, when all but the first mode are gone."""
    late = t > 0.1 * L**2 / NU
    basis = np.stack([np.ones(late.sum()), np.exp(-rate * t[late])], axis=1)
    return ((basis @ np.linalg.lstsq(basis, mean[late], rcond=None)[0] - mean[late])**2).sum()


def check_pipe(folder):
    rms, final, mean = [], None, []
    for t, head, f in physics.snapshots(folder):
        if t == 0:
            continue
        r, u, volume = f["position"][:, 0], f["velocity"][:, 1], physics.volumes(head, f)
        e = (u - pipe(r, t)) / U
        rms.append(np.sqrt((e**2).mean()))
        final = e
        mean.append((t, np.average(u, weights=volume)))
    times, mean = np.array(mean).T
    rates = np.linspace(4, 8, 401) * NU / L**2
    rate = rates[np.argmin([misfit(times, mean, s) for s in rates])]
    return [physics.relative("flow rate over that of the steady flow, last time", mean[-1] / (0.5 * U),
                             1 - 32 * np.exp(-zeros(1)[0]**2 * NU * times[-1] / L**2) / zeros(1)[0]**4, 0.01),
            physics.relative("rate of the start, R2/nu", rate * L**2 / NU, zeros(1)[0]**2, 0.02),
            physics.at_most("rms velocity error over U, largest of all times", max(rms), 0.01),
            physics.at_most("largest velocity error over U, last time", np.abs(final).max(), 0.015),
            physics.at_most("velocity error in the first two rings over that elsewhere",
                            physics.at_axis(head, [(f, final)]), 2)]


def check(folder):
    head = next(physics.snapshots(folder))[1]
    return check_pipe(folder) if physics.rings(head) else physics.shear(folder, exact, U, 0.5e-3)


if __name__ == "__main__":
    physics.main(check)
