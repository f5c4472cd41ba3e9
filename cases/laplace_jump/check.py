#!/usr/bin/python3
"""Pressure and spurious flow of a drop at rest.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

RHO, MU, SIGMA = 1100.0, 3.5e-3, 0.067  # kg/m3, Pa s, N/m
# s, of a circle, a sphere and a sphere as rings: what the packing's disorder sets off has largely gone
START = {"circle": 50e-3, "sphere": 20e-3, "rings": 50e-3}


def check(folder):
    jump, rms, largest, motion, first = [], [], [], [], 0.0
    for t, head, f in physics.snapshots(folder):
        volume = physics.volumes(head, f)
        kind = "rings" if physics.rings(head) else {2: "circle", 3: "sphere"}[int(head["dimension"])]
        middle = np.average(f["position"], weights=volume, axis=0)
        middle[0] *= kind != "rings"
        x = f["position"] - middle
        radius = np.sqrt(volume.sum() / np.pi) if kind == "circle" else np.cbrt(0.75 * volume.sum() / np.pi)
        speed = np.linalg.norm(f["velocity"], axis=1)
        if t < START[kind]:
            first = max(first, speed.max())
            continue
        jump.append(f["pressure"][np.linalg.norm(x, axis=1) < 0.5 * radius].mean())
        motion.append((f, speed))
        rms.append(np.sqrt((speed**2).mean()))
        largest.append(speed.max())
    since = f"from {START[kind] * 1e3:g} ms on"
    return [
        physics.relative(f"pressure in the inner half, mean {since}", np.mean(jump),
                         (1 if kind == "circle" else 2) * SIGMA / radius, 0.01 if kind == "rings" else 0.03, "Pa"),
        physics.at_most("its standard deviation over time, over the mean", np.std(jump) / np.mean(jump), 0.03),
        physics.at_most(f"capillary number, largest of all particles and times {since}", max(largest) * MU / SIGMA,
                        1e-3),
        physics.shown(f"capillary number, rms over particles and times {since}",
                      np.sqrt(np.mean(np.square(rms))) * MU / SIGMA),
        physics.shown("capillary number, largest before", first * MU / SIGMA)] + (
            [physics.at_most("speed in the first two rings over that elsewhere", physics.at_axis(head, motion), 2)]
            if kind == "rings" else [])


if __name__ == "__main__":
    physics.main(check)
