#!/usr/bin/python3
"""Jet: a drop a period, of the liquid of one wave.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

R, U, F, Z0 = 0.5e-3, 1.0, 222.0, 24.5e-3  # m, m/s, Hz, end of the nozzle


def check(folder):
    d = np.atleast_1d(np.genfromtxt(os.path.join(folder, "droplets.csv"), delimiter=",", names=True))
    states = list(physics.snapshots(folder))
    last, d0 = states[-1][2]["position"], float(states[-1][1]["spacing"])
    wave = np.pi * R**2 * U / F
    settled = d[(d["time_s"] > 0.02) & (d["volume_m3"] > 0.5 * wave) & (d["volume_m3"] < 1.5 * wave)]
    size = np.bincount(physics.components(last, 1.25 * d0))
    attached = last[physics.components(last, 1.25 * d0) == np.argmax(size)]
    volume = np.median(settled["volume_m3"])
    return [physics.relative("volume of a drop, median", 1e9 * volume, 1e9 * wave, 0.1, "ul"),
            physics.relative("speed of a drop, mean", -settled["velocity_z_ms"].mean(), U, 0.05, "m/s"),
            physics.shown("length of what hangs together at the end", 1e3 * (Z0 - attached[:, 2].min()), unit="mm"),
            physics.shown("liquid in smaller pieces at the end", (size < 8).sum() / len(last))]


if __name__ == "__main__":
    physics.main(check)
