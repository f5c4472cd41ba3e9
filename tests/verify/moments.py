#!/usr/bin/python3
"""Moments on walls and solids (-gauge_moments): those of water at rest, depth H: rho g H^3/6 about the foot of a wall,
none on the floor about its middle; the moment on a solid is that of its buoyancy."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

RHO, G, H, WIDE, ASIDE = 1000.0, 9.81, 0.4, 0.6, 0.1
TANK = f"""-spacing 0.02 -bodies water -solids post -time_end 0.1 -series_interval 2e-3 -checkpoint_interval 0
 -snapshot_interval 0 -water_viscosity 0 """
PLANE = TANK + f"""-dimension 2 -box_lower 0,0 -box_upper {WIDE},0.6 -box_x wall -box_ymin wall -gravity 0,-{G}
 -water_upper {WIDE},{H} -post_lower {WIDE / 2 + ASIDE - 0.05},0.14 -post_upper {WIDE / 2 + ASIDE + 0.05},0.24 """


def mean(s, name):
    column, = (n for n in s.dtype.names if n.startswith(name))
    return s[column][5:].mean()


s = runs.series(runs.run(PLANE + f"-gauge_moments {WIDE},0", "foot"))
runs.check_within(mean(s, "moment_xmax_z") / (-RHO * G * H**3 / 6), 0.96, 1.04, "moment on a wall about its foot")
s = runs.series(runs.run(PLANE + f"-gauge_forces -gauge_moments {WIDE / 2},0.19", "middle"))
weight = RHO * G * H * WIDE
runs.check_below(abs(mean(s, "moment_ymin_z")) / (weight * WIDE), 5e-3, "on the floor about its middle")
runs.check_within(mean(s, "moment_post_z") / (ASIDE * RHO * G * 0.01), 0.9, 1.1, "on a solid: that of its buoyancy")
runs.check_within(mean(s, "moment_post_z") / (ASIDE * mean(s, "force_post_y")), 0.98, 1.02, "its force times its arm")
# the same tank in space, 0.2 m wide along y: x is across, z is up
SPACE = TANK + f"""-dimension 3 -box_lower 0,0,0 -box_upper 0.4,0.2,0.5 -box_x wall -box_y wall -box_zmin wall
 -gravity 0,0,-{G} -water_upper 0.4,0.2,0.3 -post_lower 0.1,0,0 -post_upper 0.2,0.2,0.1 -gauge_moments 0.4,0.1,0 """
s = runs.series(runs.run(SPACE, "space"))
runs.check_within(mean(s, "moment_xmax_y") / (0.2 * RHO * G * 0.3**3 / 6), 0.95, 1.05, "in space, about y")
runs.check_below(np.abs([mean(s, f"moment_xmax_{c}") for c in "xz"]).max() / mean(s, "moment_xmax_y"), 0.03, "alone")
# a drop of water hits a wall: the force of the pressure and the pull of tension at contact lines change its momentum
folder = runs.run("""-dimension 2 -spacing 0.05e-3 -box_lower -4e-3,0 -box_upper 4e-3,4e-3 -box_ymin wall -bodies drop
 -drop_shape sphere -drop_radius 1e-3 -drop_center 0,1.05e-3 -drop_tension 0.072 -drop_velocity 0,-0.5 -gauge_forces
 -time_end 3e-3 -series_interval 0 -snapshot_interval 3e-3 -checkpoint_interval 0""", "impact")
s = runs.series(folder)
first, last = (runs.fields(path)["velocity"][:, 1].sum() * RHO * 0.05e-3**2 for path in
               (runs.numbered(folder, "snapshot")[k] for k in (0, -1)))


def impulse(column):
    force = np.nan_to_num(s[column])
    return -(0.5 * (force[1:] + force[:-1]) * np.diff(s["time"])).sum() / (last - first)


force, pull = impulse("force_ymin_y_Nm"), impulse("force_tension_y_Nm")
runs.check_within(force + pull, 0.98, 1.02, "impulse of an impact: pressure and tension together")
runs.check(force > 1.2, "without tension it is larger", f"{force:.3g}")
runs.done()
