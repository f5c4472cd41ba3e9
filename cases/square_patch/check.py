#!/usr/bin/python3
"""First pressure, angular momentum and evenness of the rotating square patch.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402


def centre_pressure():
    """Of lap p = 2 rho omega^2, p = 0 on the edge, rho omega^2 L^2 = 1: -0.147343."""
    m = np.arange(1, 400, 2)
    sign = np.where(m % 4 == 1, 1.0, -1.0)
    mm, nn = np.meshgrid(m, m)
    return (np.outer(sign, sign) * -32 / (mm * nn * np.pi**4 * (mm**2 + nn**2))).sum()


def check(folder):
    momentum, energy, number = [], [], []
    for _, head, f in physics.snapshots(folder):
        x, v = f["position"][:, :2], f["velocity"][:, :2]
        momentum.append((x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]).sum())
        energy.append((v**2).sum())
        number.append(len(x))
    path = physics.runs.numbered(folder, "snapshot")
    if float(physics.runs.head(path[1])["time"]) < 0.05:
        one = physics.runs.fields(path[1])
        near = np.hypot(one["position"][:, 0], one["position"][:, 1]) < 2.5 * float(np.ravel(head["spacing"])[0])
        return [physics.relative("first pressure at the centre", one["pressure"][near].mean(),
                                 1000 * centre_pressure(), 0.02, "Pa")]
    inner = f["lambda"] > 0.75
    return [physics.at_most("angular momentum, relative change", momentum[-1] / momentum[0] - 1, 1e-10),
            physics.relative("kinetic energy over that at the start", energy[-1] / energy[0], 1, 0.02),
            physics.relative("voids: smallest density inside", f["density"][inner].min(), 1000, 0.15, "kg/m3"),
            physics.relative("clumps: largest density", f["density"].max(), 1000, 0.15, "kg/m3"),
            physics.at_most("particles lost", number[0] - number[-1], 0)]


if __name__ == "__main__":
    physics.main(check)
