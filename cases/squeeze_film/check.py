#!/usr/bin/python3
"""The force on a disk that comes down on a film, against Stefan (1874). check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

RADIUS, FILM, SPEED, VISCOSITY = 2.0, 0.2, 0.01, 1.0  # m, m, m/s, Pa s
EDGE = 4 / (3 * np.pi)  # of the film's thickness, by which the edge lengthens the film (Dagan et al. 1982)
START = 1.0  # s: the first steps are short, and the pressure comes up in them


def stefan(time, edge):
    """The force (N) at a time (s), 3 pi mu V (R + edge h)^4/(2 h^3)."""
    h = FILM - SPEED * time
    return 1.5 * np.pi * VISCOSITY * SPEED * (RADIUS + edge * h)**4 / h**3


def check(folder):
    series = runs.series(folder)
    time, force = series["time"], series["force_disk_y_N"]
    later = time > START
    time, ratio = time[later], force[later] / stefan(time[later], EDGE)
    return [physics.relative("force over that of Stefan with its edge, mean", ratio.mean(), 1, 0.06, ""),
            physics.relative("the same in the last second", ratio[time > time[-1] - 1].mean(), 1, 0.06, ""),
            physics.shown("force over that of Stefan without an edge, mean",
                          (force[later] / stefan(time, 0)).mean())]


if __name__ == "__main__":
    physics.main(check)
