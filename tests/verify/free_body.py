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
# In a box that is periodic across, a body that floats has no place of its own: a third of the box further it does the
# same, also close to a face.
TANK = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1.2,0.6 -box_x periodic -box_ymin wall -gravity 0,-9.81
 -bodies water -water_upper 1.2,0.4 -packing_jitter 0 -solids float -float_mass 30 -float_turns 0 -time_end 0.1
 -series_interval 0.02 -snapshot_interval 1 -checkpoint_interval 0 """
away, close = [runs.series(runs.run(TANK + f"-float_lower {x},0.25 -float_upper {x + 0.2},0.45", f"tank_{x}"))
               for x in (0.42, 0.02)]
across, up = [n for n in away.dtype.names if n.startswith("float_velocity_")]
runs.check(len(close) > 4 and abs(away[up][-1]) > 0.01, "the box heaves", away[up])
runs.check_below(max(abs(away[across]).max(), abs(close[across]).max()), 1e-4, "the box is not pushed sideways")
runs.check_below(abs(away[up] - close[up]).max(), 1e-4, "it heaves alike at two places")
runs.done()
