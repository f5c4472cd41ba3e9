#!/usr/bin/python3
"""Free bodies, light and heavy: steps hold whatever the mass, and liquid and body keep their momentum in a periodic box
without weight, where the liquid takes up most of it at once. What the body is owed of the balance is paid within the
time in which the density is repaired, so that the sum is looked at after some of those times."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

RHO, RADIUS, SPEED = 1000.0, 0.15, 0.3  # kg/m3, m, m/s
SCENE = f"""-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,1 -box_x periodic -box_y periodic -bodies water
 -solids ball -ball_shape sphere -ball_radius {RADIUS} -ball_center 0.25,0.5 -ball_velocity {SPEED},0
 -pressure_relaxation_time 0.1 -time_end 0.5 -snapshot_interval 0.5 -snapshot_double -checkpoint_interval 0
 -series_interval 0.02 """
for name, ratio, more in (("light", 0.3, ""), ("heavy", 10, ""), ("light in honey", 0.3, "-water_viscosity 50")):
    mass = ratio * RHO * np.pi * RADIUS**2
    folder = runs.run(SCENE + f"-ball_mass {mass} " + more, name)
    f, s = runs.fields(runs.numbered(folder, "snapshot")[-1]), runs.series(folder)
    liquid = f["body"] >= 0
    names = [n for n in s.dtype.names if n.startswith("ball_velocity_")]
    own = mass * np.array([s[n][-1] for n in names])
    of_liquid = RHO * s["volume"][-1] / liquid.sum() * f["velocity"][liquid, :2].sum(axis=0)
    runs.check_below(abs(own + of_liquid - (mass * SPEED, 0)).max() / (mass * SPEED), 0.02, f"momentum, {name}")
    runs.check(of_liquid[0] > 0.05 * mass * SPEED, f"the liquid is pushed, {name}", of_liquid[0])
    runs.check_below(abs(s[names[0]]).max(), SPEED * 1.01, f"never faster than at the start, {name}")
runs.done()
