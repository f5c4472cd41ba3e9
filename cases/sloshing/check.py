#!/usr/bin/python3
"""Sloshing: the surface at both walls against linear theory, a sum of modes from rest.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

L, H, G = 1.0, 0.3, 9.81  # m, m, m/s2
MODES = range(1, 40, 2)  # even ones are not excited


def elevation(x, t, amplitude, omega):
    """Height above rest (m) at x: eta_n'' + w_n^2 eta_n = k tanh(kH) c_n a sin(wt), c_n = -4/(L k^2) the modes of
    x - L/2, from rest (from the linear free-surface conditions with gravity a sin(wt) along x)."""
    eta = 0
    for n in MODES:
        k = n * np.pi / L
        own = np.sqrt(G * k * np.tanh(k * H))
        force = -4 * amplitude * np.tanh(k * H) / (L * k)
        eta = eta + force / (own**2 - omega**2) * (np.sin(omega * t) - omega / own * np.sin(own * t)) * np.cos(k * x)
    return eta


def check(folder):
    s = runs.series(folder)
    options = physics.options(runs.head(runs.numbered(folder, "snapshot")[0]))
    amplitude = float(options["-gravity_amplitude"].split(",")[0])
    omega = 2 * np.pi * float(options["-gravity_frequency"])
    places = [float(x) for x in options["-gauge_heights"].split(",")]
    measured = np.concatenate([s[f"height_{k + 1}_m"] - H for k in range(2)])
    exact = np.concatenate([elevation(x, s["time"], amplitude, omega) for x in places])
    return [physics.relative("rms elevation at the walls", 1e3 * np.sqrt((measured**2).mean()),
                             1e3 * np.sqrt((exact**2).mean()), 0.1, "mm"),
            physics.at_least("correlation with linear theory", np.corrcoef(measured, exact)[0, 1], 0.95),
            physics.shown("highest at a wall", 1e3 * measured.max(), 1e3 * exact.max(), "mm"),
            physics.at_most("particles lost", s["lost"][-1], 0)]


if __name__ == "__main__":
    physics.main(check)
