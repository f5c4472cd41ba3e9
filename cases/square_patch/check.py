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
    expected, momentum = centre_pressure(), []
    for t, head, f in physics.snapshots(folder):
        x, v = f["position"][:, :2], f["velocity"][:, :2]
        momentum.append((x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]).sum())
        n = len(x)
        energy = (v**2).sum()
        if t == 0:
            n0, energy0 = n, energy
    inner = f["lambda"] > 0.75
    density = f["density"][inner] / 1000
    path = physics.runs.numbered(folder, "snapshot")
    one = physics.runs.fields(path[1])
    near = np.hypot(one["position"][:, 0], one["position"][:, 1]) < 2.5 * head["spacing"]
    results = []
    if float(physics.runs.head(path[1])["time"]) < 0.05:
        results.append(("first pressure at the centre, relative error",
                        one["pressure"][near].mean() / (1000 * expected) - 1, 0.02))
    else:
        results += [("angular momentum, relative change", momentum[-1] / momentum[0] - 1, 1e-10),
                    ("kinetic energy, relative change", energy / energy0 - 1, 0.02),
                    ("voids: smallest density inside", 1 - density.min(), 0.15),
                    ("clumps: largest density", f["density"].max() / 1000 - 1, 0.15),
                    ("particles lost", n0 - n, 0)]
    return results


if __name__ == "__main__":
    physics.main(check)
