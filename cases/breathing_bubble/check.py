#!/usr/bin/python3
"""Period and amplitude of a bubble that breathes against the equation of Rayleigh and Plesset in a shell of liquid.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

STEP = 2e-6  # s, of the exact solution
GAMMA = 1.4  # default of -gas_exponent


def breathing(dim, options):
    """Rate of (R, dR/dt) of a bubble in a shell of liquid without gravity, viscosity and tension."""
    inner, outer, rho = (float(options["-" + name]) for name in ("hole_radius", "shell_radius", "shell_density"))
    air, start = float(options["-gas_pressure"]), float(options["-gas_pressure_start"])

    def rate(y):
        r, u = y
        far = (outer**dim - inner**dim + r**dim)**(1 / dim)
        push = (start * (inner / r)**(dim * GAMMA) - air) / rho
        flow = r**(dim - 1) * u
        if dim == 2:
            return np.array([u, ((push - 0.5 * flow**2 * (far**-2 - r**-2)) / np.log(far / r) - u * u) / r])
        return np.array([u, ((push - 0.5 * flow**2 * (far**-4 - r**-4)) / (1 / r - 1 / far) - 2 * r * u * u) / r**2])
    return rate, inner


def peaks(t, x):
    """Times and values of the maxima, by parabolas."""
    at = [k for k in range(1, len(x) - 1) if x[k - 1] < x[k] >= x[k + 1]]
    fit = [np.polyfit(t[k - 1:k + 2] - t[k], x[k - 1:k + 2], 2) for k in at]
    return np.array([(t[k] - b / (2 * a), c - b * b / (4 * a)) for k, (a, b, c) in zip(at, fit)])


def check(folder):
    _, head, _ = next(iter(physics.snapshots(folder)))
    options = physics.options(head)
    dim = 2 if options["-dimension"] == "2" else 3
    rows = physics.table(os.path.join(folder, "pockets.csv"))
    t, volume = rows["time_s"], rows["volume_m2" if options["-dimension"] == "2" else "volume_m3"]
    rate, inner = breathing(dim, options)
    times = np.arange(0, t[-1], STEP)
    exact = peaks(times, (physics.integrate(rate, (inner, 0), 0, times, 1)[:, 0] / inner)**dim)
    found = peaks(t, volume / volume[0])
    period = [np.diff(p[:, 0]).mean() for p in (found, exact)]
    first, last = (found[k, 1] - 1 for k in (0, -1))
    within = 0.015 if options["-dimension"] == "3" else 0.01 if "-spacing_coarse" in options else 0.005
    return [physics.relative("period", *period, within, "s"),
            physics.relative("amplitude of the volume, first", first, exact[0, 1] - 1, 0.02),
            physics.relative("the same, last", last, exact[-1, 1] - 1, 0.03)]


if __name__ == "__main__":
    physics.main(check)
