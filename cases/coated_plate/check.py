#!/usr/bin/python3
"""A nozzle coats a plate: thickness of the film, and that it moves with the plate. check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

WIDTH, SPEED, PLATE = 2e-3, 0.15, 0.3  # m, m/s
AT = 20e-3  # m: of the last gauge
SHARE = 0.8  # of the run, from which on the film is steady


def check(folder):
    table = physics.table(os.path.join(folder, "series.csv"))
    late = table["time_s"] >= SHARE * table["time_s"][-1]
    *_, (_, head, f) = physics.snapshots(folder)
    near = (f["body"] >= 0) & (np.abs(f["position"][:, 0] - AT) < 1e-3)
    return [physics.relative("thickness of the film at 20 mm", table["height_4_m"][late].mean(), WIDTH * SPEED / PLATE,
                             0.06, "m"),
            physics.relative("speed of the film at 20 mm", f["velocity"][near, 0].mean(), PLATE, 0.06, "m/s"),
            physics.shown("thickness at 5 mm", table["height_1_m"][late].mean(), unit="m")]


if __name__ == "__main__":
    physics.main(check)
