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
    momentum, energy, number, pressure = [], [], [], []
    for t, head, f in physics.snapshots(folder):
        x, v = f["position"][:, :2], f["velocity"][:, :2]
        momentum.append((x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]).sum())
        energy.append((v**2).sum())
        number.append(len(x))
        near = np.hypot(x[:, 0], x[:, 1]) < 2.5 * float(np.ravel(head["spacing"])[0])
        pressure.append(f["pressure"][near].mean())
    if t < 0.1:  # the first steps only
        wanted = 1000 * centre_pressure()
        worst = max(pressure[2:], key=lambda p: abs(p - wanted))
        return [physics.relative("first pressures at the centre, worst after step 1", worst, wanted, 0.02, "Pa")]
    inner = f["lambda"] > 0.75
    return [physics.at_most("angular momentum, relative change", momentum[-1] / momentum[0] - 1, 1e-10),
            physics.relative("kinetic energy over that at the start", energy[-1] / energy[0], 1, 0.02),
            physics.relative("voids: smallest density inside", f["density"][inner].min(), 1000, 0.15, "kg/m3"),
            physics.relative("clumps: largest density", f["density"].max(), 1000, 0.15, "kg/m3"),
            physics.at_most("particles lost", number[0] - number[-1], 0)]


if __name__ == "__main__":
    physics.main(check)
