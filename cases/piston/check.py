#!/usr/bin/python3
"""Height of the waves that a piston makes, against linear theory.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

DEPTH, LENGTH, G, F, AMPLITUDE = 0.2, 2.8, 9.81, 1.4, 8e-3  # m, m, m/s2, Hz, m
GAUGES = {"height_1_m": 0.6, "height_2_m": 0.8, "height_3_m": 1.0}  # m from the piston
PERIODS = 2  # of the waves that are looked at, up to the end of the run


def surface(x, t, modes=400):
    """Height (m) over rest at x (m) and the times t (s), linear theory of the whole tank from rest: the modes
    cos(n pi x/L) of the tank are swings that the acceleration of the piston drives."""
    w, k = 2 * np.pi * F, np.pi * np.arange(1, modes + 1) / LENGTH
    own = np.sqrt(G * k * np.tanh(k * DEPTH))
    force = 2 * AMPLITUDE * w**2 * np.tanh(k * DEPTH) / (LENGTH * k)
    swing = force * (np.cos(w * t[:, None]) - np.cos(own * t[:, None])) / (own**2 - w**2)
    return (swing * np.cos(k * x)).sum(axis=1) + DEPTH * AMPLITUDE * (1 - np.cos(w * t)) / LENGTH


def amplitude(t, y):
    """Of the part of y(t) that swings with the piston, from the best fit of it, its first harmonic and a mean."""
    w = 2 * np.pi * F
    basis = np.stack([np.ones_like(t)] + [g(n * w * t) for n in (1, 2) for g in (np.cos, np.sin)], axis=1)
    fit = np.linalg.lstsq(basis, y, rcond=None)[0]
    return np.hypot(fit[1], fit[2])


def check(folder):
    s = runs.series(folder)
    t = s["time"]
    late = t > t[-1] - PERIODS / F
    due = [2 * amplitude(t[late], surface(x, t)[late]) for x in GAUGES.values()]
    got = [2 * amplitude(t[late], s[name][late]) for name in GAUGES]
    return [physics.relative("wave height, mean of three gauges", np.mean(got), np.mean(due), 0.03, "m"),
            physics.at_most("its largest error at a gauge", np.abs(np.divide(got, due) - 1).max(), 0.05)]


if __name__ == "__main__":
    physics.main(check)
