#!/usr/bin/python3
"""Period, damping and energy of a standing gravity wave; with -gravity_amplitude, twice as fast as the wave, the growth
of its parametric resonance.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

G, LENGTH, DEPTH, RADIUS = 9.81, 1.0, 0.5, 0.5  # m/s2, m, m, m
PLANE, RINGS = 2 * np.pi / LENGTH, 3.8317059702 / RADIUS  # wave numbers, 1/m; the first zero of J1


def exact(k):
    """Rate (1/s) of the linear wave."""
    return np.sqrt(G * k * np.tanh(k * DEPTH))


def fit(t, a, rate, constant):
    """Rate w (1/s), damping c (1/s) and the residual over the amplitude of a(t) ~ exp(-c t) (p cos w t + q sin w t),
    plus a constant if there is one: Gauss-Newton from the exact rate."""
    w, c = rate, 0.0
    for _ in range(30):
        envelope = np.exp(-c * t)
        basis = np.stack([envelope * np.cos(w * t), envelope * np.sin(w * t)], axis=1)
        extra = np.ones((len(t), 1 if constant else 0))
        p, q, *mean = np.linalg.lstsq(np.hstack([basis, extra]), a, rcond=None)[0]
        model = basis @ (p, q)
        slope = np.stack([t * (q * basis[:, 0] - p * basis[:, 1]), -t * model], axis=1)
        step = np.linalg.lstsq(np.hstack([basis, slope, extra]), a - model, rcond=None)[0][2:4]
        w, c = w + step[0], c + step[1]
    return w, c, np.sqrt(((a - model - sum(mean))**2).mean()) / np.hypot(p, q)


def mode(head, f):
    """Of a snapshot: amplitude of the wave of the surface (m), by the mass of the columns, 2/L sum V_0 cos k x, of
    rings sum V J0(k r)/(pi R^2 J0(k R)^2); energies (J/m, J) of the motion along the linear wave and of the rest of it;
    speed of that rest by particle (m/s)."""
    x, v, volume = f["position"], f["velocity"], physics.volumes(head, f)
    if physics.rings(head):
        k = RINGS
        up, across = physics.bessel(k * x[:, 0])
        norm = np.pi * RADIUS**2 * physics.bessel(k * RADIUS)[0]**2
    else:
        k, norm = PLANE, LENGTH / 2
        up, across = np.cos(k * x[:, 0]), np.sin(k * x[:, 0])
    u = np.stack([-across * np.cosh(k * x[:, 1]), up * np.sinh(k * x[:, 1])], axis=1)
    squares = (volume * (u**2).sum(axis=1)).sum()
    share = (volume * (v[:, :2] * u).sum(axis=1)).sum() / squares
    wave = 500 * share**2 * squares
    rest = 500 * (volume * (v**2).sum(axis=1)).sum() - wave
    return (volume * up).sum() / norm, wave, rest, np.linalg.norm(v[:, :2] - share * u, axis=1)


def resonance(damping, options):
    """Growth of a'' + w^2 (1 + e sin 2wt) a = 0, Mathieu's equation: e w/4 to first order of e."""
    share = float(options["-gravity_amplitude"].split(",")[1]) / -G
    return [physics.relative("growth rate of the resonance", -damping, share * exact(PLANE) / 4, 0.1, "1/s")]


def check(folder):
    states = list(physics.snapshots(folder))
    head, first, last = states[0][1], states[0][2], states[-1][2]
    k = RINGS if physics.rings(head) else PLANE
    t = np.array([time for time, _, _ in states])
    modes = [mode(h, f) for _, h, f in states]
    a, wave, rest = np.array([m[:3] for m in modes]).T
    # J0^2, of the wave's second order, has a part along J0, as cos^2 has none along cos
    rate, damping, residual = fit(t, a, exact(k), physics.rings(head))
    if "-gravity_amplitude" in physics.options(head):
        return resonance(damping, physics.options(head))
    return [physics.relative("period", 2 * np.pi / rate, 2 * np.pi / exact(k), 0.01, "s"),
            physics.shown("effective viscosity", damping / (2 * k**2), 1e-6, "m2/s"),
            physics.shown("amplitude lost in a period, share", 1 - np.exp(-damping * 2 * np.pi / rate)),
            physics.at_most("deviation from the fitted wave, rms over the amplitude", residual, 0.05),
            physics.shown("energy of other motion over that of the wave", rest.mean() / wave.max()),
            physics.lost(head, first, last)] + (
                [physics.at_most("deviation from the wave's flow, in the first two rings over that elsewhere",
                                 physics.at_axis(head, [(f, m[3]) for (_, _, f), m in zip(states, modes)]), 2)]
                if physics.rings(head) else [])


if __name__ == "__main__":
    physics.main(check)
