#!/usr/bin/python3
"""Period and amplitude of a bubble that breathes against the equation of Rayleigh and Plesset in a shell of liquid, or
frequency and damping of one that swings.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

STEPS = 20000  # of the exact solution
GAMMA = 1.4  # default of -gas_exponent


def breathing(dim, options):
    """Rate of (R, dR/dt) of a bubble in a shell of liquid without gravity, with the stress of viscosity and tension on
    both surfaces."""
    inner, outer, rho, viscosity, tension = (float(options.get("-" + name, 0)) for name in
                                             ("hole_radius", "shell_radius", "shell_density", "shell_viscosity",
                                              "shell_tension"))
    air, start = float(options["-gas_pressure"]), float(options["-gas_pressure_start"])

    def rate(y):
        r, u = y
        far = (outer**dim - inner**dim + r**dim)**(1 / dim)
        flow = r**(dim - 1) * u
        stress = (dim - 1) * (tension * (1 / r + 1 / far) + 2 * viscosity * flow * (r**-dim - far**-dim))
        push = (start * (inner / r)**(dim * GAMMA) - air - stress) / rho
        if dim == 2:
            return np.array([u, ((push - 0.5 * flow**2 * (far**-2 - r**-2)) / np.log(far / r) - u * u) / r])
        return np.array([u, ((push - 0.5 * flow**2 * (far**-4 - r**-4)) / (1 / r - 1 / far) - 2 * r * u * u) / r**2])
    return rate, inner


def peaks(t, x):
    """Times and values of the maxima, by parabolas."""
    at = [k for k in range(1, len(x) - 1) if x[k - 1] < x[k] >= x[k + 1]]
    fit = [np.polyfit(t[k - 1:k + 2] - t[k], x[k - 1:k + 2], 2) for k in at]
    return np.array([(t[k] - b / (2 * a), c - b * b / (4 * a)) for k, (a, b, c) in zip(at, fit)])


def small(options, period, *decay):
    """A bubble so small that tension and viscosity matter: its frequency beside that of Minnaert (1933) with both,
    w^2 = (3 gamma p - 2 sigma/R)/(rho R^2) - d^2, d = 2 mu/(rho R^2), p and R at rest. Liquid that ends at a radius B
    has 1 - R/B of the inertia and 1 - (R/B)^3 of the dissipation."""
    tension, viscosity, outer, air, start = (float(options["-" + name]) for name in (
        "shell_tension", "shell_viscosity", "shell_radius", "gas_pressure", "gas_pressure_start"))
    r = 1
    for _ in range(50):
        r = (start / (air + 2 * tension * (1 / r + 1 / outer)))**(1 / (3 * GAMMA))
    inertia = r**2 * (1 - r / outer)
    damping = 2 * viscosity * (1 - (r / outer)**3) / inertia
    square = (3 * GAMMA * start * r**(-3 * GAMMA) - 2 * tension / r) / inertia - damping**2
    return [physics.relative("period", *period, 0.01, "s"),
            physics.relative("frequency over that of Minnaert", 2 * np.pi / period[0] / np.sqrt(square), 1, 0.01),
            physics.relative("amplitude, last over first", *decay, 0.03)]


def swinging(folder, options, volume):
    """The second mode by tension: Lamb, art. 275 and 355, in a shell with the pressure of the air outside. The moment
    of P_2/r^3 follows the bubble alone, and its radius is that of the gas."""
    rho, viscosity, tension, outer = (float(options.get("-shell_" + name, 1000)) for name in
                                      ("density", "viscosity", "tension", "radius"))
    times, q = [], []
    for t, head, f in physics.snapshots(folder):
        x, z = f["position"][:, :2].T
        r = np.hypot(x, z)
        times.append(t)
        q.append((physics.volumes(head, f) * (1.5 * (z / r)**2 - 0.5) / r**3)[r < 0.95 * outer].sum())
    radius = np.cbrt(0.75 * volume.mean() / np.pi)
    far = (radius / outer)**5
    damping = 20 * viscosity / (rho * radius**2)
    frequency = np.sqrt(12 * tension / (rho * radius**3) * (1 + 2 / 3 * far) / (1 - far) - damping**2)
    w, b, error = physics.damped_cosine(np.array(times), np.array(q), frequency, damping)
    return [physics.relative("frequency", w, frequency, 0.03, "1/s"),
            physics.relative("damping rate", b, damping, 0.5, "1/s"),
            physics.at_most("deviation from a damped cosine, rms over the amplitude", error, 0.1)]


def check(folder):
    _, head, _ = next(iter(physics.snapshots(folder)))
    options = physics.options(head)
    dim = 2 if options["-dimension"] == "2" else 3
    rows = physics.table(os.path.join(folder, "pockets.csv"))
    t, volume = rows["time_s"], rows["volume_m2" if options["-dimension"] == "2" else "volume_m3"]
    if "-hole_wave_mode" in options:
        return swinging(folder, options, volume)
    rate, inner = breathing(dim, options)
    times = np.linspace(0, t[-1], STEPS)
    exact = peaks(times, (physics.integrate(rate, (inner, 0), 0, times, 1)[:, 0] / inner)**dim)
    found = peaks(t, volume / volume[0])
    period = [np.diff(p[:, 0]).mean() for p in (found, exact)]
    first, last = (found[k, 1] - 1 for k in (0, -1))
    if "-shell_tension" in options:
        return small(options, period, last / first, (exact[-1, 1] - 1) / (exact[0, 1] - 1))
    within = 0.015 if options["-dimension"] == "3" else 0.01 if "-spacing_coarse" in options else 0.005
    return [physics.relative("period", *period, within, "s"),
            physics.relative("amplitude of the volume, first", first, exact[0, 1] - 1, 0.02),
            physics.relative("the same, last", last, exact[-1, 1] - 1, 0.03)]


if __name__ == "__main__":
    physics.main(check)
