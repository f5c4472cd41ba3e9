#!/usr/bin/python3
"""Period, damping and energy of a standing gravity wave.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

G, LENGTH, DEPTH = 9.81, 1.0, 0.5  # m/s2, m, m
K = 2 * np.pi / LENGTH
RATE = np.sqrt(G * K * np.tanh(K * DEPTH))


def fit(t, a):
    """Rate w (1/s), damping c (1/s) and the residual over the amplitude of a(t) ~ exp(-c t) (p cos w t + q sin w t):
    Gauss-Newton from the exact rate."""
    w, c = RATE, 0.0
    for _ in range(30):
        envelope = np.exp(-c * t)
        basis = np.stack([envelope * np.cos(w * t), envelope * np.sin(w * t)], axis=1)
        p, q = np.linalg.lstsq(basis, a, rcond=None)[0]
        model = basis @ (p, q)
        slope = np.stack([t * (q * basis[:, 0] - p * basis[:, 1]), -t * model], axis=1)
        step = np.linalg.lstsq(np.hstack([basis, slope]), a - model, rcond=None)[0][2:]
        w, c = w + step[0], c + step[1]
    return w, c, np.sqrt(((a - model)**2).mean()) / np.hypot(p, q)


def mode(folder):
    """Times (s), first Fourier mode of the surface (m): the mass of the columns, 2/L sum V_0 cos k x; energies (J/m) of
    the motion along the linear wave and of the rest of it; particles lost."""
    t, a, wave, rest = [], [], [], []
    for time, head, f in physics.snapshots(folder):
        x, v, area = f["position"], f["velocity"], float(head["spacing"])**2
        if time == 0:
            n = len(x)
        t.append(time)
        a.append(2 / LENGTH * area * np.cos(K * x[:, 0]).sum())
        u = np.stack([-np.sin(K * x[:, 0]) * np.cosh(K * x[:, 1]),
                      np.cos(K * x[:, 0]) * np.sinh(K * x[:, 1])], axis=1)
        share = (v[:, :2] * u).sum() / (u**2).sum()
        wave.append(500 * area * share**2 * (u**2).sum())
        rest.append(500 * area * (v**2).sum() - wave[-1])
    return np.array(t), np.array(a), np.array(wave), np.array(rest), n - len(x)


def check(folder):
    t, a, wave, rest, lost = mode(folder)
    rate, damping, residual = fit(t, a)
    return [physics.relative("period", 2 * np.pi / rate, 2 * np.pi / RATE, 0.01, "s"),
            physics.shown("effective viscosity", damping / (2 * K**2), 1e-6, "m2/s"),
            physics.shown("amplitude lost in a period, share", 1 - np.exp(-damping * 2 * np.pi / rate)),
            physics.at_most("deviation from the fitted wave, rms over the amplitude", residual, 0.05),
            physics.shown("energy of other motion over that of the wave", rest.mean() / wave.max()),
            physics.at_most("particles lost", lost, 0)]


if __name__ == "__main__":
    physics.main(check)
