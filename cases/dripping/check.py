#!/usr/bin/python3
"""Dripping: the volume of the first drop that falls, over that of a drop that falls from a tube without flow.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

TOGETHER = 1.6  # spacings: the largest step within a drop
# Harkins and Brown (1919): the share F of the weight 2 pi r sigma that falls, over r/V^(1/3)
RATIO = np.array([0.25, 0.30, 0.35, 0.40, 0.45, 0.50])
SHARE = np.array([0.7550, 0.7256, 0.7011, 0.6828, 0.6669, 0.6515])


def falls(radius, sigma, weight):
    """Volume (m3) of the drop that falls from a tube of this radius (m); weight: of a volume, N/m3."""
    volume = 2 * np.pi * radius * sigma / weight
    for _ in range(50):
        volume = 2 * np.pi * radius * sigma / weight * np.interp(radius / volume**(1 / 3), RATIO, SHARE)
    return volume


def first_drop(states):
    """Volume (m3) and time (s) of the first drop that is off the tube, larger than half of all."""
    for time, head, f in states:
        liquid = f["body"] >= 0
        x, volume = f["position"][liquid], physics.volumes(head, f)[liquid]
        if not len(x):
            continue
        piece = physics.components(x, TOGETHER * float(head["spacing"]))
        sizes = [volume[piece == k].sum() for k in range(piece.max() + 1)]
        k = int(np.argmax(sizes))
        if x[piece == k, 1].max() < 0:
            return sizes[k], time
    return np.nan, np.nan


def check(folder):
    states = list(physics.snapshots(folder))
    o = physics.options(states[0][1])
    volume, time = first_drop(states)
    wanted = falls(float(o["-tube_upper"].split(",")[0]), float(o["-water_tension"]),
                   -1000.0 * float(o["-gravity"].split(",")[1]))
    flow = np.pi * float(o["-water_radius"])**2 * -float(o["-water_velocity"].split(",")[1])
    return [physics.relative("volume of the drop over that without flow, Harkins and Brown", volume / wanted, 1, 0.08),
            physics.shown("flow", 1e9 * flow, unit="mm3/s"), physics.shown("volume", 1e9 * volume, unit="mm3"),
            physics.shown("time of its fall", time, unit="s")]


if __name__ == "__main__":
    physics.main(check)
