#!/usr/bin/python3
"""Pressure and spurious flow of a drop at rest.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

RHO, MU, SIGMA = 1100.0, 3.5e-3, 0.067  # kg/m3, Pa s, N/m
START = {2: 50e-3, 3: 20e-3}  # s, of two and three dimensions: what the packing's disorder sets off has largely gone


def check(folder):
    jump, rms, largest, first = [], [], [], 0.0
    for t, head, f in physics.snapshots(folder):
        d0 = float(np.ravel(head["spacing"])[0])
        x = f["position"] - f["position"].mean(axis=0)
        dim = 2 if np.abs(x[:, 2]).max() == 0 else 3
        radius = d0 * np.sqrt(len(x) / np.pi) if dim == 2 else d0 * np.cbrt(0.75 * len(x) / np.pi)  # of their volume
        speed = np.linalg.norm(f["velocity"], axis=1)
        if t < START[dim]:
            first = max(first, speed.max())
            continue
        jump.append(f["pressure"][np.linalg.norm(x, axis=1) < 0.5 * radius].mean())
        rms.append(np.sqrt((speed**2).mean()))
        largest.append(speed.max())
    since = f"from {START[dim] * 1e3:g} ms on"
    return [
        physics.relative(f"pressure in the inner half, mean {since}", np.mean(jump), (dim - 1) * SIGMA / radius, 0.03,
                         "Pa"),
        physics.at_most("its standard deviation over time, over the mean", np.std(jump) / np.mean(jump), 0.03),
        physics.at_most(f"capillary number, largest of all particles and times {since}", max(largest) * MU / SIGMA,
                        1e-3),
        physics.shown(f"capillary number, rms over particles and times {since}",
                      np.sqrt(np.mean(np.square(rms))) * MU / SIGMA),
        physics.shown("capillary number, largest before", first * MU / SIGMA)]


if __name__ == "__main__":
    physics.main(check)
