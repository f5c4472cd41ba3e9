#!/usr/bin/python3
"""Where the drop's liquid is: shares of its volume, in per cent, at 6, 12, 25 and 60 ms after contact.

    liquid.py RUN_FOLDER [MORE_RUN_FOLDERS]

While the crater is open: on its floor (below half its depth), on its wall (above that), in the rim (above the level).
Later: in the jet and in the thread below it (within 2.2 mm of the axis, above and below the level), elsewhere. With
graded spacing some becomes part of larger particles of the film, which is missing in the sum.
"""
import argparse
import os

import numpy as np

import compare
import rundata
from check import physics

TIMES = (6e-3, 12e-3, 25e-3, 60e-3)  # s
NEAR = 0.6e-3  # s: a snapshot this close to a time stands for it
AXIS = 2.2e-3  # m: radius of the jet and of the thread
OPEN, CLOSED = ("floor", "wall", "rim"), ("jet", "thread", "elsewhere")


def shares(x, volume, whole, depth):
    """{place: share of the whole volume in per cent} of particles at x [n][3] (m); depth (m) of the crater, nan if it
    has closed."""
    def share(flag):
        return 100 * volume[flag].sum() / whole

    r, z = np.hypot(x[:, 0], x[:, 1]), x[:, 2]
    if np.isfinite(depth):
        flags = (z < -depth / 2, (z >= -depth / 2) & (z < 0), z >= 0)
        return {name: share(flag) for name, flag in zip(OPEN, flags)}
    flags = ((r < AXIS) & (z >= 0), (r < AXIS) & (z < 0), r >= AXIS)
    return {name: share(flag) for name, flag in zip(CLOSED, flags)}


def rows_of(folder):
    """[(time, shares)] of a run's snapshots nearest to TIMES."""
    series = rundata.read_series(folder)
    closed = compare.jet_rise(series)
    found, whole = {}, None
    for t, head, f in physics.snapshots(folder):
        drop = f["body"] == 1
        volume = physics.volumes(head, f)[drop]
        whole = whole or volume.sum()
        time = min(TIMES, key=lambda wanted, t=t: abs(t - wanted))
        if abs(t - time) > NEAR or (time in found and abs(found[time][0] - time) <= abs(t - time)):
            continue
        depth = np.nan if t > closed else compare.at(series, "crater_depth", t)
        found[time] = t, shares(physics.upright(head, f)[drop], volume, whole, depth)
    return [found[time] for time in TIMES if time in found]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folders", metavar="RUN_FOLDER", nargs="+")
    print("| run | time, ms | " + " | ".join(OPEN + CLOSED) + " |\n" + "|---" * 8 + "|")
    for folder in parser.parse_args().folders:
        for t, found in rows_of(folder):
            cells = [f"{found[name]:.0f} %" if name in found else "" for name in OPEN + CLOSED]
            print(f"| {os.path.basename(os.path.abspath(folder))} | {1e3 * t:.3g} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    with rundata.polite("liquid.py"):
        main()
