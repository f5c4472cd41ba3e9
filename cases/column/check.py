#!/usr/bin/python3
"""A column that stands by its yield stress, and one that spreads without: its height and width, its creep.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

HEIGHT, WEIGHT = 0.1, 490.5  # m; Pa: largest shear stress in a column that stands, half of the pressure of its height


def check(folder):
    states = list(physics.snapshots(folder))
    (_, head, first), (time, _, last) = states[0], states[-1]
    options = physics.options(head)
    height = [np.sort(f["position"][:, 1])[-10:].mean() for f in (first, last)]
    width = [np.ptp(f["position"][:, 0]) for f in (first, last)]
    lower, wider = (height[0] - height[1]) / HEIGHT, (width[1] - width[0]) / HEIGHT
    if "-column_yield_stress" not in options:
        return [physics.at_least("height lost, over the height", lower, 0.5),
                physics.at_least("width gained, over the height", wider, 1)]
    creep = WEIGHT / float(options["-column_viscosity_max"]) * time
    return [physics.at_most("height lost, over the height", lower, 0.01),
            physics.at_most("width gained, over the height", wider, 0.02),
            physics.at_most("that over the strain of liquid at its largest viscosity", wider / creep, 1)]


if __name__ == "__main__":
    physics.main(check)
