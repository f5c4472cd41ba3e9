#!/usr/bin/python3
"""A bottle upside down: the suction of its gas holds the water until the first bubble.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

WEIGHT = 1000 * 9.81 * 0.14  # Pa, of the water over the neck


def check(folder):
    rows = physics.table(os.path.join(folder, "pockets.csv"))
    t = np.unique(rows["time_s"])
    parts = [rows[rows["time_s"] == time] for time in t]
    count = np.array([len(part) for part in parts])
    first = t[count > 1][0] if (count > 1).any() else t[-1]
    top = np.array([part["pressure_Pa"][part["y_m"].argmax()] for part in parts])
    before = (t < first) & (t > 0)
    states = list(physics.snapshots(folder))
    water = [(f["position"][:, 1] > 0).sum() for _, _, f in states]
    held = water[[k for k, (time, _, _) in enumerate(states) if time <= 0.1][-1]] / water[0]
    mean = top[before].mean()
    return [physics.relative("mean pressure of the gas before the first bubble", mean, -WEIGHT, 0.15, "Pa"),
            physics.at_least("water in the bottle after 0.1 s, over that at the start", held, 0.97),
            physics.shown("time of the first bubble", first, unit="s"),
            physics.shown("water in the bottle at the end, over that at the start", water[-1] / water[0])]


if __name__ == "__main__":
    physics.main(check)
