#!/usr/bin/python3
"""The jet from a slot in the end of a channel, against von Mises (1917). check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

SLOT, CHANNEL, SPEED, RHO = 5e-3, 25e-3, 0.2, 1000.0  # m, m: half of each; m/s, kg/m3
STEADY = 40e-3  # s: from here on the liquid between these places (m) has left the slot after the first 15 ms
BETWEEN = (12e-3, 32e-3)
WIDTH, PRESSURE, AT = 0.03, 0.04, 10  # at so many spacings in half the slot; tolerances fall with the spacing.
# With 5 spacings the pressure scatters by 6 % and is not judged


def contraction(share):
    """Width of the jet over the slot, which is a share of its channel, by bisection: with q = c share, the flow's speed
    in the channel over that of the jet, c (1 + 2/pi (1/q - q) arctan q) = 1 (Milne-Thomson, Theoretical Hydrodynamics,
    on the streamlines from an orifice in the end of a canal)."""
    low, high = 0.5, 1.0
    while high - low > 1e-9:
        c = 0.5 * (low + high)
        q = c * share
        low, high = (low, c) if c * (1 + 2 / np.pi * (1 / q - q) * np.arctan(q)) > 1 else (c, high)
    return low


def check(folder):
    widths, speeds = [], []
    for t, head, f in physics.snapshots(folder):
        x = f["position"][:, 0]
        jet = (x > BETWEEN[0]) & (x < BETWEEN[1])
        if t > 0.99 * STEADY:
            widths.append(physics.volumes(head, f)[jet].sum() / (BETWEEN[1] - BETWEEN[0]))
            speeds.append(f["velocity"][jet, 0].mean())
    s = physics.table(os.path.join(folder, "series.csv"))
    late = s["time_s"] > 0.99 * STEADY
    u2 = s["point_1_velocity_x_ms"]**2 + s["point_1_velocity_y_ms"]**2
    pressure = (s["point_1_pressure_Pa"] + 0.5 * RHO * (u2 - SPEED**2))[late].mean()
    c = contraction(SLOT / CHANNEL)
    fast = SPEED * CHANNEL / (c * SLOT)
    tolerance = AT * float(np.ravel(head["spacing"])[0]) / SLOT
    bernoulli = 0.5 * RHO * (fast**2 - SPEED**2)
    held = ("pressure in the channel", pressure, bernoulli)
    return [physics.relative("width of the jet over that of the slot", np.mean(widths) / SLOT, c, WIDTH * tolerance),
            physics.relative(*held, PRESSURE * tolerance, "Pa") if tolerance < 1.5 else physics.shown(*held, "Pa"),
            physics.relative("speed of the jet", np.mean(speeds), fast, 2 * WIDTH * tolerance, "m/s"),
            physics.shown("width of the jet over that of the slot, scatter over the times", np.std(widths) / SLOT)]


if __name__ == "__main__":
    physics.main(check)
