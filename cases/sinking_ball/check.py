#!/usr/bin/python3
"""Speed of a ball that sinks in a tube, against Haberman and Sayre (1958). check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import physics  # noqa: E402
import runs  # noqa: E402

RADIUS, TUBE, VISCOSITY, EXCESS, G = 5e-3, 20e-3, 10.0, 1000.0, 9.81  # m, m, Pa s, kg/m3, m/s2


def haberman_sayre(k):
    """Drag of a ball in a tube over that of Stokes; k: their radii."""
    return (1 - 0.75857 * k**5) / (1 - 2.1050 * k + 2.0865 * k**3 - 1.7068 * k**5 + 0.72603 * k**6)


def check(folder):
    s = runs.series(folder)
    v = next(s[name] for name in s.dtype.names if name.startswith("ball_velocity_y"))
    due = 2 / 9 * EXCESS * G * RADIUS**2 / (VISCOSITY * haberman_sayre(RADIUS / TUBE))
    steady = s["time"] > 0.03
    return [physics.relative("speed of the ball from 30 ms on", -1e3 * v[steady].mean(), 1e3 * due, 0.05, "mm/s"),
            physics.at_most("largest speed upwards", 1e3 * max(0, v.max()), 0.02 * 1e3 * due, "mm/s")]


if __name__ == "__main__":
    physics.main(check)
