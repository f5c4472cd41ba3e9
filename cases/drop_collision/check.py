#!/usr/bin/python3
"""Colliding drops: momentum, angular momentum, pieces.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

WATER = 1000.0  # kg/m3, default of -<body>_density


def masses(head, f):
    """Of the particles, kg a metre of depth."""
    options, d0 = physics.options(head), float(head["spacing"])
    density = [float(options.get(f"-{name}_density", WATER)) for name in options["-bodies"].split(",")]
    return np.array(density)[f["body"]] * d0**2


def motion(head, f):
    """Momentum, angular momentum, and the sum of m |v|, what the momentum is compared with."""
    m, x, v = masses(head, f), f["position"], f["velocity"]
    return m @ v[:, :2], (m * (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0])).sum(), (m * np.hypot(v[:, 0], v[:, 1])).sum()


def check(folder):
    states = list(physics.snapshots(folder))
    (_, head, start), (_, _, end) = states[0], states[-1]
    p0, l0, scale = motion(head, start)
    p1, l1, _ = motion(head, end)
    piece = np.bincount(physics.components(end["position"], 1.5 * float(head["spacing"])))
    reach = 1e-3 * scale  # kg m/s times a drop's radius: of angular momentum
    widest = max(np.ptp(f["position"][physics.components(f["position"], 1.5 * float(head["spacing"])) == 0, 1])
                 for _, _, f in states[::4])
    # equal slow drops merge; what unequal ones do is only shown
    equal = masses(head, start)[0] == masses(head, start)[-1]
    count = (piece >= 0.01 * len(start["id"])).sum()
    pieces = (physics.absolute("pieces of a hundredth of the liquid or more", count, 1, 0) if equal else
              physics.shown("pieces of a hundredth of the liquid or more", count))
    results = [physics.at_most("change of momentum over the sum of m v", np.linalg.norm(p1 - p0) / scale, 0.02),
               physics.at_most("change of angular momentum over R the sum of m v", abs(l1 - l0) / reach, 0.02),
               pieces,
               physics.shown("largest height over the start's", widest / np.ptp(start["position"][:, 1])),
               physics.at_most("particles lost over all", 1 - len(end["id"]) / len(start["id"]), 0.01)]
    return results


if __name__ == "__main__":
    physics.main(check)
