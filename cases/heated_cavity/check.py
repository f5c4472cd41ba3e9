#!/usr/bin/python3
"""The heat that crosses a heated square, over that of liquid at rest, beside de Vahl Davis (1983). check.py
RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

CONDUCTED, STEADY = 5.893 * 10, 12  # W/m at rest; s
NUSSELT = 2.238  # G. de Vahl Davis, Int. J. Numer. Meth. Fluids 3 (1983) 249, Ra = 10000


def check(folder):
    series = runs.series(folder)
    late = series["time"] >= STEADY
    hot, cold = (np.mean(series[f"heat_from_{face}_Wm"][late]) / CONDUCTED for face in ("xmin", "xmax"))
    return [physics.relative("Nusselt number of the hot wall", hot, NUSSELT, 0.05),
            physics.relative("Nusselt number of the cold wall", -cold, NUSSELT, 0.05)]


if __name__ == "__main__":
    physics.main(check)
