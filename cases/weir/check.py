#!/usr/bin/python3
"""Head over a sharp-crested weir against Rehbock (1929), the level that the outlet holds, and its flow.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

G, CREST, LEVEL = 9.81, 0.2, 0.18  # m/s2, m, m
FLOW = 0.303 * 0.2  # m2/s
STEADY = 2.0  # s


def rehbock(flow):
    """The head (m) over the crest, by bisection: q = 2/3 (0.602 + 0.083 h/P) sqrt(2 g) h^(3/2), h = H + 1.2 mm."""
    low, high = 0.0, 1.0
    for _ in range(60):
        h = (low + high) / 2
        q = 2 / 3 * (0.602 + 0.083 * h / CREST) * np.sqrt(2 * G) * h**1.5
        low, high = (h, high) if q < flow else (low, h)
    return low - 0.0012


def check(folder):
    s = runs.series(folder)
    late = s["time"] > STEADY
    head = np.mean([s[f"height_{k}_m"][late].mean() for k in (1, 2, 3)]) - CREST
    tail = np.mean([s[f"height_{k}_m"][late].mean() for k in (4, 5, 6)])
    flow = np.polyfit(s["time"][late], s["outflow_xmax_m2"][late] + s["volume"][late], 1)[0]
    return [physics.relative("head over the crest", head, rehbock(FLOW), 0.05, "m"),
            physics.relative("level before the outlet", tail, LEVEL, 0.1, "m"),
            physics.relative("what comes: left or stored", flow, FLOW, 0.01, "m2/s")]


if __name__ == "__main__":
    physics.main(check)
