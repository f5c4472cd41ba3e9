#!/usr/bin/python3
"""The pull at the edge of a sheet and the speed at which it retracts.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

LENGTH = 7e-3  # m, of the sheet


def check(folder):
    times, pull, edge = [], [], []
    for t, head, f in physics.snapshots(folder):
        given = physics.options(head)
        rho, sigma = (float(given.get("-sheet_" + name, 1000)) for name in ("density", "tension"))
        width, thickness = (float(given["-sheet_upper"].split(",")[k]) for k in (1, 2))
        if t == 0:
            continue
        mass = rho * float(np.ravel(head["spacing"])[0])**3
        times.append(t)
        pull.append(-mass * f["velocity"][:, 0].sum() / width / (2 * sigma * t))
        edge.append(np.percentile(f["position"][:, 0], 99))
    speed = np.sqrt(2 * sigma / (rho * 2 * thickness))
    times, pull, edge = np.array(times), np.array(pull), np.array(edge)
    half = speed * times < 0.5 * LENGTH
    late = half & (times > 0.5 * times[half][-1])
    return [physics.relative("momentum of the half over 2 sigma t, mean until the edge is half way",
                             pull[half].mean(), 1, 0.2),
            physics.shown("speed of the edge over that of Taylor and Culick, second half of that time",
                          -np.polyfit(times[late], edge[late], 1)[0] / speed, 1)]


if __name__ == "__main__":
    physics.main(check)
