#!/usr/bin/python3
"""Capillary rise between plates: the mean height between them over that outside, from the balance of weight and pull.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

HALF, PLATE = 0.5e-3, 0.3e-3  # m: half of the gap, thickness of a plate


def heights(head, f, options):
    """Mean heights (m) between the plates and outside, above the plate's lower end, from the volume there."""
    x, volume = f["position"][f["body"] >= 0], physics.volumes(head, f)[f["body"] >= 0]
    right = float(options["-box_upper"].split(",")[0])
    base = float(options["-plate_lower"].split(",")[1]) + 2 * float(options["-spacing"])
    above = x[:, 1] > base
    inner, outer = above & (x[:, 0] < HALF), above & (x[:, 0] > HALF + PLATE)
    gap = right - HALF - PLATE
    return base + volume[inner].sum() / HALF, base + volume[outer].sum() / gap, gap


def check(folder):
    states = list(physics.snapshots(folder))
    options = physics.options(states[0][1])
    sigma, density = float(options["-bath_tension"]), float(options["-bath_density"])
    angle, g = np.radians(float(options["-plate_contact_angle"])), -float(options["-gravity"].split(",")[1])
    rise = []
    for _, head, f in states:
        inner, outer, gap = heights(head, f, options)
        rise.append(1e3 * (inner - outer))
    exact = 1e3 * sigma * np.cos(angle) / (density * g) * (1 / HALF - 1 / gap)
    late = rise[3 * len(rise) // 4:]
    return [physics.relative("rise between the plates over the level outside", np.mean(late), exact, 0.04, "mm"),
            physics.at_most("its change in the last quarter, over it", (max(late) - min(late)) / exact, 0.02),
            physics.lost(states[0][1], states[0][2], states[-1][2])]


if __name__ == "__main__":
    physics.main(check)
