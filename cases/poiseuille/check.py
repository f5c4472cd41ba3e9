#!/usr/bin/python3
"""Velocity of Poiseuille flow from rest, between plates or, of rings, through a pipe; of liquids whose viscosity
depends on the shear rate the steady flow.
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


def stress(head):
    """The shear stress (Pa) as a function of the shear rate (1/s), as -liquid_viscosity_model and its numbers say."""
    options = physics.options(head)

    def number(name, default=0.0):
        return float(options.get("-liquid_" + name, default))
    K, n, model = number("viscosity"), number("viscosity_exponent", 1), options["-liquid_viscosity_model"]
    if model == "carreau":
        least, t = number("viscosity_infinite"), number("viscosity_time")
        return lambda rate: rate * (least + (K - least) * (1 + (t * rate)**2)**((n - 1) / 2))
    return lambda rate: number("yield_stress") + K * rate**n


def steady(law, wall, width, places=4001):
    """Distance from the wall (m) and velocity (m/s) of the steady flow whose stress falls from wall (Pa) to zero over
    the width (m): the shear rate from the stress by bisection, and its integral."""
    y = np.linspace(0, width, places)
    low, high = np.zeros(places), np.full(places, 1e3)
    for _ in range(100):
        middle = 0.5 * (low + high)
        above = law(middle) > wall * (1 - y / width)
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return y, np.concatenate([[0], np.cumsum(0.5 * (low[1:] + low[:-1]) * np.diff(y))])


def check_model(folder):
    *_, (_, head, f) = physics.snapshots(folder)
    options, rings = physics.options(head), physics.rings(head)
    along, across = (1, 0) if rings else (0, 1)
    x, u = f["position"][:, across], f["velocity"][:, along]
    size = float(options["-box_upper"].split(",")[across])
    force = 1000 * float(options["-gravity"].split(",")[along])  # N/m3
    y, profile = steady(stress(head), 0.5 * force * size, size if rings else 0.5 * size)
    exact = np.interp(size - x if rings else np.minimum(x, size - x), y, profile)
    volume, error = physics.volumes(head, f), (u - exact) / profile[-1]
    return [physics.relative("flow rate, last time", np.average(u, weights=volume), np.average(exact, weights=volume),
                             0.02, "m/s"),
            physics.relative("largest velocity", u.max(), profile[-1], 0.02, "m/s"),
            physics.at_most("rms velocity error over U", np.sqrt((error**2).mean()), 0.02),
            physics.at_most("largest velocity error over U", np.abs(error).max(), 0.02)]


def check(folder):
    head = next(physics.snapshots(folder))[1]
    if "-liquid_viscosity_model" in physics.options(head):
        return check_model(folder)
    return check_pipe(folder) if physics.rings(head) else physics.shear(folder, exact, U, 0.5e-3)


if __name__ == "__main__":
    physics.main(check)
