#!/usr/bin/python3
"""A column of liquid that falls on gas and bounces, against the equation of a piston on a spring of gas (Bagnold 1939).
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

STEP = 1e-4  # s, of the exact solution
GAMMA, AIR, G = 1.4, 101325, 9.81  # defaults of -gas_exponent, -gas_pressure (Pa); m/s2


def top(t, x):
    """Time and value of the first maximum, by a parabola."""
    k = next(k for k in range(1, len(x) - 1) if x[k - 1] < x[k] >= x[k + 1])
    a, b, c = np.polyfit(t[k - 1:k + 2] - t[k], x[k - 1:k + 2], 2)
    return t[k] - b / (2 * a), c - b * b / (4 * a)


def check(folder):
    _, head, _ = next(iter(physics.snapshots(folder)))
    options = physics.options(head)
    low, high = (float(options[f"-water_{end}"].split(",")[-1]) for end in ("lower", "upper"))
    load = float(options["-water_density"]) * (high - low)
    rows = physics.table(os.path.join(folder, "pockets.csv"))
    t, volume = rows["time_s"], rows["volume_m2" if options["-dimension"] == "2" else "volume_m3"]
    times = np.arange(0, t[-1], STEP)
    height = physics.integrate(lambda y: np.array([y[1], AIR * ((low / y[0])**GAMMA - 1) / load - G]), (low, 0), 0,
                               times, 1)[:, 0]
    exact, found = top(times, AIR * ((low / height)**GAMMA - 1)), top(t, rows["pressure_Pa"])
    after = t > found[0]
    back = top(t[after], volume[after] / volume[0])
    return [physics.relative("largest pressure", found[1], exact[1], 0.01, "Pa"),
            physics.relative("its time", found[0], exact[0], 0.01, "s"),
            physics.relative("volume of the gas when the column is up again, over that at the start", back[1], 1,
                             0.005),
            physics.relative("the time of that", back[0], 2 * exact[0], 0.01, "s")]


if __name__ == "__main__":
    physics.main(check)
