#!/usr/bin/python3
"""A bottle upside down: the suction of its gas holds the water until the first bubble; in three dimensions, the rate at
which it empties, beside the experiments of Clanet and Searby (2004).
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

WEIGHT = 1000 * 9.81 * 0.14  # Pa, of the water over the neck


def emptying(states, options):
    """Of the round bottle: a full one of length L and diameter D with a hole d empties at a constant rate in the time
    3.0 L/(g D)^(1/2) (D/d)^(5/2), Clanet and Searby's fit to their ideal bottles. Its rate is measured from a twentieth
    of the water on, when it glugs, to a half."""
    length, width, hole = (float(options[f"-{name}"]) * factor for name, factor in
                           (("inside_height", 1), ("inside_radius", 2), ("neck_radius", 2)))
    share = float(options["-water_height"]) / length
    t = np.array([time for time, _, _ in states])
    water = np.array([(f["position"][:, 2] > 0).sum() for _, _, f in states])
    left = water / water[0] * share
    glugs = (left < 0.95 * share) & (left > 0.5 * share)
    time = -1 / np.polyfit(t[glugs], left[glugs], 1)[0]
    law = 3.0 * length / np.sqrt(9.81 * width) * (width / hole)**2.5
    return [physics.relative("time in which a full bottle empties at this rate", time, law, 0.2, "s"),
            physics.shown("water in the bottle at the end, over that at the start", left[-1] / share)]


def check(folder):
    states = list(physics.snapshots(folder))
    options = physics.options(states[0][1])
    if options["-dimension"] == "3":
        return emptying(states, options)
    rows = physics.table(os.path.join(folder, "pockets.csv"))
    t = np.unique(rows["time_s"])
    parts = [rows[rows["time_s"] == time] for time in t]
    count = np.array([len(part) for part in parts])
    first = t[count > 1][0] if (count > 1).any() else t[-1]
    top = np.array([part["pressure_Pa"][part["y_m"].argmax()] for part in parts])
    before = (t < first) & (t > 0)
    water = [(f["position"][:, 1] > 0).sum() for _, _, f in states]
    held = water[[k for k, (time, _, _) in enumerate(states) if time <= 0.1][-1]] / water[0]
    mean = top[before].mean()
    return [physics.relative("mean pressure of the gas before the first bubble", mean, -WEIGHT, 0.15, "Pa"),
            physics.at_least("water in the bottle after 0.1 s, over that at the start", held, 0.97),
            physics.shown("time of the first bubble", first, unit="s"),
            physics.shown("water in the bottle at the end, over that at the start", water[-1] / water[0])]


if __name__ == "__main__":
    physics.main(check)
