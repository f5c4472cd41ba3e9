#!/usr/bin/python3
"""Jet: a drop a period, of the liquid of one wave. A pulse of it: pieces at the end, one if the liquid is elastic.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

R, U, F, Z0 = 0.5e-3, 1.0, 222.0, 24.5e-3  # m, m/s, Hz, end of the nozzle
WAVE, TENSION, DENSITY = 0.1, 0.072, 1000.0  # amplitude over U; N/m, kg/m3
# What flows out of the nozzle keeps its momentum but for the tension of the jet, which pulls it back with pi R sigma.
DROP = U * (1 + WAVE**2 / 2) - TENSION / (DENSITY * R * U)  # m/s


def check(folder):
    states = list(physics.snapshots(folder))
    head, f = states[-1][1:]
    last, d0, share = physics.places(head, f), float(head["spacing"]), physics.volumes(head, f)
    d = np.atleast_1d(np.genfromtxt(os.path.join(folder, "droplets.csv"), delimiter=",", names=True))
    up = "velocity_y_ms" if physics.rings(head) else "velocity_z_ms"
    wave = np.pi * R**2 * U / F
    settled = d[(d["time_s"] > 0.02) & (d["volume_m3"] > 0.5 * wave) & (d["volume_m3"] < 1.5 * wave)]
    piece = physics.components(last, 1.25 * d0)
    size, share = np.bincount(piece), np.bincount(piece, weights=share) / share.sum()
    if "-jet_count" in physics.options(head):
        name = "pieces with more than a hundredth of the liquid at the end", (share > 0.01).sum()
        return [physics.at_most(*name, 1) if "-jet_polymer_modulus" in physics.options(head) else physics.shown(*name)]
    attached = last[piece == np.argmax(size)]
    volume = np.median(settled["volume_m3"])
    return [physics.relative("volume of a drop, median", 1e9 * volume, 1e9 * wave, 0.1, "ul"),
            physics.relative("speed of a drop, mean", -settled[up].mean(), DROP, 0.05, "m/s"),
            physics.shown("length of what hangs together at the end", 1e3 * (Z0 - attached[:, 2].min()), unit="mm"),
            physics.shown("liquid in smaller pieces at the end", share[size < 8].sum())]


if __name__ == "__main__":
    physics.main(check)
