#!/usr/bin/python3
"""A bubble that has burst: the floor of its cavity, then the tip of the jet, beside a volume-of-fluid computation that
starts as the run does.
check.py RUN_FOLDER"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

RADIUS = 0.5e-3  # m, of the bubble
AXIS, GAP = 0.1, 2  # within so many radii of the axis liquid hangs together if no gap is longer (spacings)


def tips(folder):
    """Times (s) and the height (m) of the liquid at the axis that hangs together from below."""
    found = []
    for time, head, f in physics.snapshots(folder):
        x, spacing = f["position"], float(head["spacing"])
        y = np.sort(x[x[:, 0] < AXIS * RADIUS, 1])
        gaps = np.flatnonzero(np.diff(y) > GAP * spacing)
        found.append((time, (y[gaps[0]] if len(gaps) else y[-1]) + spacing / 2))
    return np.array(found).T


def curves(folder):
    """For a report of the run, as in dam_break/check.py."""
    right = physics.table(os.path.join(HERE, "reference.csv"))
    return os.path.join(HERE, "reference.csv"), [("floor, then tip", "m", *tips(folder), right["time"], right["tip"])]


def passes(t, y, height):
    """When the tip first passes a height (s)."""
    k = np.argmax(y > height)
    if not y[k] > height:
        raise ValueError(f"the tip does not reach {height:g} m")
    return np.interp(height, y[k - 1:k + 1], t[k - 1:k + 1])


def speed(t, y):
    """The mean speed over 0.4 of the radius below the level of the surface (m/s); above, the reference sheds a drop."""
    return 0.4 * RADIUS / (passes(t, y, 0) - passes(t, y, -0.4 * RADIUS))


def check(folder):
    run, reference = tips(folder), physics.table(os.path.join(HERE, "reference.csv"))
    right = reference["time"], reference["tip"]
    early = np.array([3e-4, 4e-4, 5e-4])
    off = np.abs(np.interp(early, *run) - np.interp(early, *right)).max()
    return [physics.at_most("floor of the cavity at 0.3, 0.4, 0.5 ms beside the reference, over the radius",
                            off / RADIUS, 0.05),
            physics.relative("time at which the jet is 0.5 mm below the surface", 1e3 * passes(*run, -RADIUS),
                             1e3 * passes(*right, -RADIUS), 0.05, "ms"),
            physics.relative("time at which it passes the surface", 1e3 * passes(*run, 0), 1e3 * passes(*right, 0),
                             0.05, "ms"),
            physics.relative("its speed there", speed(*run), speed(*right), 0.1, "m/s")]


if __name__ == "__main__":
    physics.main(check)
