#!/usr/bin/python3
"""A frame that turns: a particle at rest outside of it goes round, one that flies straight does so, liquid at rest in
it stays at rest with the pressure of a rigid rotation, and one that turns backwards keeps its energy."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

RATE, CENTER = 2.0, np.array([0.1, -0.2])
FRAME = f"-dimension 2 -frame_rotation_rate {RATE} -frame_rotation_center {CENTER[0]},{CENTER[1]} -snapshot_double "
START, FLIGHT = np.array([0.505, 0.005]), np.array([0.3, 0.1])  # m; m/s, as seen from outside


def turned(vectors, angle):
    c, s = np.cos(angle), np.sin(angle)
    return vectors @ np.array([[c, s], [-s, c]])


def state(folder):
    head, f = (read(runs.numbered(folder, "snapshot")[-1]) for read in (runs.head, runs.fields))
    liquid = f["body"] >= 0
    return float(head["time"]), f["position"][liquid, :2], f["velocity"][liquid, :2], f["pressure"][liquid]


# what flies straight outside: x = c + R(-W t) (X - c)
arm = START - CENTER
for name, speed in (("rest", np.zeros(2)), ("flight", FLIGHT)):
    v = speed - RATE * np.array([-arm[1], arm[0]])
    folder = runs.run(FRAME + "-spacing 0.01 -box_lower -2,-2 -box_upper 2,2 -bodies a -a_lower 0.5,0 -a_upper "
                      f"0.51,0.01 -a_viscosity 0 -packing_jitter 0 -a_velocity {v[0]},{v[1]} -time_end 2 "
                      "-snapshot_interval 1", name)
    time, place, _, _ = state(folder)
    wanted = CENTER + turned(arm + time * speed, -RATE * time)
    runs.check_below(np.linalg.norm(place[0] - wanted), 5e-4, f"path of a particle outside the frame: {name}")

# a full box at rest in the frame: p = rho W^2 r^2/2 but for a constant
BOX = FRAME + ("-spacing 0.05 -box_lower -0.5,-0.5 -box_upper 0.5,0.5 -box_x wall -box_y wall -bodies water "
               "-water_viscosity 1 -packing_jitter 0.1 -time_end 1 -snapshot_interval 1 ")
time, x, v, p = state(runs.run(BOX, "box"))
r2 = ((x - CENTER)**2).sum(axis=1)
near = np.abs(x).max(axis=1) < 0.45
slope = np.polyfit(r2[near], p[near], 1)[0]
runs.check_within(slope / (500 * RATE**2), 0.98, 1.02, "pressure of liquid at rest in the frame")
runs.check_below(np.abs(v).max() / RATE, 0.02, "it stays at rest")
spin = (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]).sum() / (x**2).sum()
runs.check_below(abs(spin) / RATE, 3e-3, "and does not begin to turn")
runs.done()
