#!/usr/bin/python3
"""Period and damping of the second mode of a drop, or of the third, of rings.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

RHO, MU, SIGMA = 1100.0, 3.5e-3, 0.067  # kg/m3, Pa s, N/m


def check(folder):
    times, q = [], []
    mode = 2
    for t, head, f in physics.snapshots(folder):
        d0 = float(np.ravel(head["spacing"])[0])
        x = f["position"]
        volume, rings = physics.volumes(head, f), physics.rings(head)
        dim = 3 if rings else int(head["dimension"])
        whole = x[:, 0].min() < 0  # not an octant
        if whole or rings:
            x = x - np.average(x, weights=volume, axis=0) * ([0, 1, 0] if rings else 1)
        volume = volume * (1 if whole or rings else 8)
        radius = np.sqrt(volume.sum() / np.pi) if dim == 2 else np.cbrt(0.75 * volume.sum() / np.pi)
        m = np.average(x**2, weights=volume, axis=0) / radius**2
        times.append(t)
        q.append(m[1] - m[0] if dim == 2 else m[2] - 0.5 * (m[0] + m[1]))
        if rings:
            mode, r, z = int(physics.options(head)["-drop_wave_mode"]), x[:, 0] / radius, x[:, 1] / radius
            q[-1] = np.average({2: z**2 - 0.5 * r**2, 3: z**3 - 1.5 * z * r**2}[mode], weights=volume)
    scale = SIGMA / (RHO * radius**3)  # Lamb, art. 275 and 355
    damping = (4 if dim == 2 else (mode - 1) * (2 * mode + 1)) * MU / (RHO * radius**2)
    frequency = np.sqrt((6 if dim == 2 else mode * (mode - 1) * (mode + 2)) * scale - damping**2)
    w, b, error = physics.damped_cosine(np.array(times), np.array(q), frequency, damping)
    return [
        physics.relative("period", 2e3 * np.pi / w, 2e3 * np.pi / frequency, 0.01 if rings else 0.02, "ms"),
        physics.relative("damping rate", b, damping, 0.3 if rings else 0.5, "1/s"),
        physics.at_most("deviation from a damped cosine, rms over the amplitude", error, 0.05),
        physics.shown("R/d0", radius / d0)]


if __name__ == "__main__":
    physics.main(check)
