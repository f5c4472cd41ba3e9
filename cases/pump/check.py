#!/usr/bin/python3
"""A tank that a pump fills: its level is the integral of the pump's table, and the pressure is the water's weight.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

RHO, G, START, WIDE, MOUTH, POINT = 1000, 9.81, 0.2, 1.0, 0.1, 0.05  # kg/m3, m/s2, m
TABLE = np.loadtxt(os.path.join(os.path.dirname(os.path.abspath(__file__)), "speed.csv"), delimiter=",")


def check(folder):
    s = runs.series(folder)
    t = np.linspace(0, s["time"][-1], 6001)
    speed = np.interp(t, *TABLE.T)
    came = MOUTH * np.concatenate(([0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(t))))
    level = START + np.interp(s["time"], t, came) / WIDE
    found = np.mean([s[f"height_{k}_m"] for k in (1, 2, 3)], axis=0)
    flows = s["time"] > 0.5
    weight = s["point_1_pressure_Pa"] / (RHO * G * (level - POINT))
    return [physics.relative("level at the end", found[s["time"] > TABLE[-1, 0]].mean(), level[-1], 0.01, "m"),
            physics.at_most("level while it fills, largest error over the rise",
                            np.abs(found - level)[flows].max() / (level[-1] - START), 0.05),
            physics.relative("pressure near the floor over the weight, mean", weight[flows].mean(), 1, 0.03)]


if __name__ == "__main__":
    physics.main(check)
