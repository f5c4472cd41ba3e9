#!/usr/bin/python3
"""Parts of the program with rings (-dimension axisymmetric) against what is known of the whole body of revolution: the
buoyancy of a ball in a cylinder, in whole newtons; the flow around a rod that does not slip along it."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

# a ball on the axis of a cylinder of water
RADIUS, GRAVITY = 5e-3, 9.81
TANK = f"""-dimension axisymmetric -spacing 1e-3 -box_lower 0,0 -box_upper 20e-3,30e-3 -box_xmax wall -box_ymin wall
 -gravity 0,{-GRAVITY} -bodies water -water_upper 20e-3,25e-3 -solids ball -ball_shape sphere -ball_radius {RADIUS}
 -ball_center 0,12e-3 -gauge_forces -series_interval 5e-3 -time_end 0.1 -checkpoint_interval 0 """
series = runs.series(runs.run(TANK, "ball"))
late = series["time"] > 0.05
ball = 4 / 3 * np.pi * RADIUS**3
water = np.pi * 20e-3**2 * 25e-3 - ball
runs.check_within(series["volume"][0] / water, 0.9999, 1.0001, "volume_around_a_ball")
runs.check_within(np.mean(series["force_ball_y_N"][late]) / (1000 * GRAVITY * ball), 0.96, 1.04, "buoyancy")
total = sum(np.mean(series[f"force_{name}_y_N"][late]) for name in ("ball", "xmax", "ymin"))
runs.check_within(-total / (1000 * GRAVITY * water), 0.95, 1.05, "weight_on_all_walls")  # 25 spacings deep; plane 1.034

# liquid between a rod and a cylinder that moves along the axis: V ln(r/a)/ln(b/a)
INNER, OUTER, SPEED = 4e-3, 8e-3, 0.01
ANNULUS = f"""-dimension axisymmetric -spacing 0.5e-3 -box_lower 0,0 -box_upper {OUTER},4e-3 -box_xmax wall
 -box_xmax_velocity 0,{SPEED} -box_y periodic -bodies water -water_viscosity 0.1 -solids rod -rod_shape cylinder
 -rod_radius {INNER} -time_end 0.4 -checkpoint_interval 0 """


def annulus(name, extra=""):
    """The root mean square error of the speed over that of the exact flow."""
    state = runs.fields(runs.numbered(runs.run(ANNULUS + extra, name), "checkpoint")[-1])
    liquid = state["body"] >= 0
    exact = SPEED * np.log(state["position"][liquid, 0] / INNER) / np.log(OUTER / INNER)
    error = np.sqrt(np.mean((state["velocity"][liquid, 1] - exact) ** 2) / np.mean(exact**2))
    runs.check_below(error, 0.01, name)


annulus("annulus")

# in the plane: a closed box whose solid is so thick that its middle has no part in the equation for the pressure
PLANE = """-dimension 2 -spacing 0.5e-3 -box_lower 0,0 -box_upper 8e-3,4e-3 -box_x wall -box_xmax_velocity 0,0.01
 -box_y periodic -bodies water -water_viscosity 0.01 -solids slab -slab_upper 4e-3,4e-3 -steps_max 5 """
runs.run(PLANE, "thick_solid_in_a_closed_box")
runs.check(True, "thick_solid_in_a_closed_box")
runs.done()
