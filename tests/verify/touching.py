#!/usr/bin/python3
"""Free bodies touch walls and each other: exact laws of dry bodies, and boxes in a tank of water."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

SPACING, G = 0.02, 9.81
# Dry: a layer of water lies at rest behind a step, out of the bodies' reach.
DRY = f"""-dimension 2 -spacing {SPACING} -box_lower 0,0 -box_upper 2,1 -box_x wall -box_ymin wall -bodies water
 -water_lower 1.76,0 -water_upper 2,0.06 -solids step,a,b -step_lower 1.6,0 -step_upper 1.76,0.3
 -checkpoint_interval 0 -series_interval 5e-3 -time_step_max 2e-3 """

SLOPE = 1.7  # m/s2, along the floor
ROLL = DRY.replace("step,a,b", "step,a") + f"""-gravity {SLOPE},-9.6 -a_shape sphere -a_radius 0.1 -a_center 0.3,0.1
 -a_mass 31.4 -a_friction 1 -time_end 0.8 """
BALL = f"""-dimension 3 -spacing {SPACING} -box_lower 0,0,0 -box_upper 1,0.4,0.3 -box_x wall -box_y wall -box_zmin wall
 -bodies water -water_lower 0.9,0,0 -water_upper 1,0.4,0.04 -solids step,a -step_lower 0.82,0,0
 -step_upper 0.9,0.4,0.1 -a_shape sphere -a_radius 0.08 -a_center 0.2,0.2,0.08 -a_mass 2.1 -a_friction 1
 -gravity {SLOPE},{0.1 * SLOPE},-9.6
 -time_end 0.4 -time_step_max 4e-3 -series_interval 0.02 -checkpoint_interval 0 """
ACROSS = f"""-dimension 2 -spacing {SPACING} -box_lower 0,0 -box_upper 2,1 -box_x periodic -box_ymin wall -bodies water
 -water_lower 0,0 -water_upper 2,0.06 -solids a,b -checkpoint_interval 0 -series_interval 5e-3 -time_step_max 2e-3
 -a_mass 10 -a_velocity 1,0.2 -a_friction 0.5 -a_restitution 0.9 -a_inertia 0.1 -b_mass 25 -b_velocity 0,0.1
 -b_friction 0.2 -b_restitution 0.9 -b_inertia 0.3 -time_end 0.3 """


def columns(s, body):
    """x, y, velocities, angle and rate of a body."""
    def of(kind):
        return next(s[n] for n in s.dtype.names if n.startswith(body + kind))
    return [of(k) for k in ("_x", "_y", "_velocity_x", "_velocity_y", "_turn", "_rate")]


def dry():
    # A box slides along the floor and is slowed by friction alone: x = v^2/(2 mu g). A ball falls and rebounds.
    speed, mu, fall, rebound = 1.0, 0.3, 0.3, 0.6
    s = runs.series(runs.run(DRY + f"""-gravity 0,{-G} -a_lower 0.1,0 -a_upper 0.31,0.13 -a_mass 20
 -a_velocity {speed},0 -a_friction {mu} -b_shape sphere -b_radius 0.08 -b_center 1.2,{0.08 + fall} -b_mass 7
 -b_restitution {rebound}
 -time_end 0.55""", "slide"))
    x, y, u, _, turn, _ = columns(s, "a")
    runs.check_within((x[-1] - x[0]) / (speed**2 / (2 * mu * G)), 0.99, 1.01, "way of a sliding box")
    runs.check_below(abs(u[-1]), 1e-6, "it stops")
    runs.check_below(max(abs(y - y[0]).max() / SPACING, abs(turn).max()), 0.01, "it stays on the floor")
    _, y, _, v, _, _ = columns(s, "b")
    y, v = y[s["time"] < 0.4], v[s["time"] < 0.4]  # the first of them
    low = int(np.argmin(y))
    runs.check_below(abs(y[low] - 0.08) / SPACING, 0.25, "a ball comes to the floor")
    runs.check_within(v[low:].max() / np.sqrt(2 * G * fall), 0.97 * rebound, 1.01 * rebound, "and rebounds")
    # A box slides along a rail, without friction: the dummy particles of the rail that its edges pass do not stop it.
    # In space there are two rails.
    for name, scene in (("plane", DRY + """-b_lower 0.2,0.1 -b_upper 0.3,0.9 -a_lower 0.3,0.15 -a_upper 0.5,0.35
 -a_mass 40 -a_velocity 0,0.5"""), ("space", """-dimension 3 -spacing 0.05 -box_lower 0,0,0 -box_upper 1,0.4,1
 -box_x wall -box_y wall -box_zmin wall -bodies water -water_lower 0.9,0,0 -water_upper 1,0.4,0.1 -solids b,c,a
 -b_lower 0,0,0 -b_upper 0.1,0.4,1 -c_lower 0.1,0,0 -c_upper 0.5,0.1,1 -a_lower 0.1,0.1,0.1 -a_upper 0.3,0.3,0.3
 -a_mass 8 -a_velocity 0,0,0.5 -checkpoint_interval 0 -series_interval 5e-3 -time_step_max 2e-3""")):
        s = runs.series(runs.run(scene + " -time_end 0.4", f"rail_{name}"))
        speeds = np.array([s[n] for n in s.dtype.names if n.startswith("a_velocity")])
        runs.check_below(abs(speeds[-1] / 0.5 - 1).max(), 1e-3, f"a box slides along a rail, {name}")
        runs.check_below(abs(speeds[:-1]).max() / 0.5, 5e-3, f"and is not pushed off, {name}")
    # A cylinder rolls down a slope with 2/3 g sin(slope), with and without a restitution, on a wall and on a solid; a
    # sphere with 5/7 of it: they touch with their circle, not with the corners between its particles.
    for name, more, floor in (("wall", "", 0), ("rebound", "-a_restitution 0.5", 0),
                              ("solid", "-solids step,a,f -f_lower 0,-0.1 -f_upper 1.6,0", -0.1)):
        s = runs.series(runs.run(ROLL + f"{more} -box_lower 0,{floor}", f"roll_{name}"))
        x, _, u, _, _, rate = columns(s, "a")
        runs.check_within((x[-1] - x[0]) / (SLOPE * s["time"][-1]**2 / 3), 0.98, 1.02, f"way of a cylinder, {name}")
        runs.check_within(-rate[-1] * 0.1 / u[-1], 0.98, 1.02, f"it rolls, {name}")
    s = runs.series(runs.run(BALL, "roll_ball"))
    for across, g in (("x", SLOPE), ("y", 0.1 * SLOPE)):
        u = s[next(n for n in s.dtype.names if n.startswith(f"a_velocity_{across}"))]
        runs.check_within(u[-1] / (5 / 7 * g * s["time"][-1]), 0.98, 1.02, f"speed of a sphere that rolls, {across}")
    # A ball slides to and fro in a round trough, without friction: nothing ahead of it stops it.
    s = runs.series(runs.run(DRY + f"""-gravity 0,{-G} -b_lower 0.1,0 -b_upper 1.5,0.6 -b_holes round
 -round_shape sphere -round_radius 0.7 -round_center 0.8,0.84 -a_shape sphere -a_radius 0.1
 -a_center 0.594788,0.276184 -a_mass 20
 -time_end 1.6""", "trough"))
    x, late = columns(s, "a")[0] - 0.8, s["time"] > 1.2
    runs.check_within(x[late].min() / x[0], 0.99, 1.001, "a ball swings in a trough")
    due = 2 * np.pi * np.sqrt(0.6 / G) * (1 + np.radians(20)**2 / 16)
    runs.check_within(s["time"][late][np.argmin(x[late])] / due, 0.99, 1.01, "its period")
    # What rebounds whole comes back to its height, again and again.
    s = runs.series(runs.run(DRY.replace("-time_step_max 2e-3", "") + f"""-gravity 0,{-G} -a_lower 0.2,0.2
 -a_upper 0.4,0.3 -a_mass 20 -a_restitution 1 -b_shape sphere -b_radius 0.1 -b_center 0.8,0.3 -b_mass 20
 -b_restitution 1
 -time_end 1.4""", "bounce"))
    for body in "ab":
        y = columns(s, body)[1]
        high = (y[s["time"] > 1].max() - y[0]) / 0.2
        runs.check_below(abs(high), 0.01, f"height after three rebounds, {body}")
    # Without friction a ball that spins goes on to spin when it has hit the floor.
    s = runs.series(runs.run(DRY + f"""-gravity 0,{-G} -a_shape sphere -a_radius 0.1 -a_center 0.8,0.2 -a_mass 31.4
 -a_rotation_rate 20 -a_restitution 0.6 -b_lower 0.1,0 -b_upper 0.3,0.1 -b_mass 20 -time_end 0.25""", "spin"))
    _, y, _, v, _, rate = columns(s, "a")
    runs.check(v.max() > 0.7, "a ball that spins rebounds", v.max())
    runs.check_below(abs(rate - 20).max(), 0.02, "and goes on to spin")
    # A box that is 0.006 rad off hits a wall with its whole face: its small rate rebounds, too, whatever the step.
    s = runs.series(runs.run(DRY.replace("2e-3", "2e-4") + """-a_lower 0.06,0.5 -a_upper 0.26,0.7 -a_mass 20
 -time_end 0.15 -a_velocity -1,0 -a_rotation_rate 0.1 -a_restitution 0.5 -b_lower 0.6,0 -b_upper 0.8,0.1
 -b_mass 20""", "off"))
    _, _, u, _, _, rate = columns(s, "a")
    runs.check_within(u[-1], 0.48, 0.52, "a box a little off rebounds")
    runs.check_below(abs(rate[-1]), 0.11, "and does not turn")
    # Two bodies without gravity: momentum and angular momentum about the origin are kept, also with friction.
    mass = {"a": 10.0, "b": 25.0}
    s = runs.series(runs.run(DRY + f"""-a_lower 0.3,0.5 -a_upper 0.5,0.7 -a_mass {mass['a']} -a_velocity 1,0
 -a_friction 0.5 -a_rotation_rate 2 -b_lower 0.7,0.6 -b_upper 0.86,0.9 -b_mass {mass['b']} -b_velocity -0.5,0.1
 -b_friction 0.2
 -a_inertia 0.1 -b_inertia 0.3 -time_end 0.35""", "collide"))
    inertia = {"a": 0.1, "b": 0.3}
    sums = np.zeros((3, len(s)))
    for name, m in mass.items():
        x, y, u, v, _, rate = columns(s, name)
        sums += np.array([m * u, m * v, m * (x * v - y * u) + inertia[name] * rate])
    runs.check_below(abs(sums - sums[:, :1]).max(), 1e-9, "momentum of two bodies that collide")
    runs.check(abs(columns(s, "a")[2] - 1).max() > 0.3, "they collide", "no change of velocity")
    # Two balls that meet head on rebound by the geometric mean of their coefficients.
    s = runs.series(runs.run(DRY + """-a_shape sphere -a_radius 0.1 -a_center 0.4,0.6 -a_mass 10 -a_velocity 1,0
 -a_restitution 0.9 -b_shape sphere -b_radius 0.1 -b_center 0.7,0.6 -b_mass 25 -b_velocity -0.5,0
 -b_restitution 0.4 -time_end 0.2""", "rebound"))
    apart = columns(s, "b")[2] - columns(s, "a")[2]
    runs.check_within(apart[-1] / 1.5, 0.97 * np.sqrt(0.9 * 0.4), 1.01 * np.sqrt(0.9 * 0.4), "rebound of two balls")
    # A collision across a periodic face is the one in the middle of the box.
    last = []
    for shift in (0, 1):
        low = [f"{(x + shift) % 2:.2f}" for x in (0.6, 1.0)]
        high = [f"{float(x) + w:.2f}" for x, w in zip(low, (0.2, 0.16))]
        s = runs.series(runs.run(ACROSS + f"""-a_lower {low[0]},0.5 -a_upper {high[0]},0.7 -b_lower {low[1]},0.6
 -b_upper {high[1]},0.9""", f"across_{shift}"))
        last.append([columns(s, body)[k][-1] for body in "ab" for k in (2, 3, 5)])
    runs.check(abs(np.array(last[0]) - (1, 0.2, 0, 0, 0.1, 0)).max() > 0.3, "they collide in the middle", str(last[0]))
    runs.check_below(np.abs(np.subtract(*last)).max(), 1e-9, "a collision across a periodic face")


TANK = f"""-dimension 2 -spacing {SPACING} -box_lower 0,0 -box_upper 1.2,0.8 -box_x wall -box_ymin wall -gravity 0,{-G}
 -bodies water -water_upper 1.2,0.4 -series_interval 0.02 -snapshot_interval 0 """
PUSHED = TANK.replace("1.2,", "1.6,").replace("1.6,0.4", "1.6,0.5") + """-solids float -float_lower 1.2,0.37
 -float_upper 1.5,0.57 -float_mass 45 -float_velocity 0.6,0 -checkpoint_interval 0 """
STACK = TANK + """-solids low,high -low_lower 0.4,0.03 -low_upper 0.8,0.17 -low_mass 112 -low_friction 0.5
 -high_lower 0.45,0.2 -high_upper 0.75,0.34 -high_mass 84 -high_friction 0.5 """

DEEP = TANK.replace("0.4 -series", "0.6 -series") + """-solids low,high -low_lower 0.4,0 -low_upper 0.8,0.1
 -low_mass 80 -high_lower 0.45,0.1 -high_upper 0.75,0.2 -high_mass 60 -water_viscosity 1 -time_end 0.5
 -checkpoint_interval 0 """


def tank():
    s = runs.series(runs.run(PUSHED + "-time_end 1.4", "pushed"))
    x, _, u, _, turn, _ = columns(s, "float")
    runs.check_below(abs(x[-10:] - (1.6 - 0.15)).max() / SPACING, 0.25, "a box pushed against the end lies at it")
    # in the mean: a last step that is cut short moves it by 0.03 m/s
    runs.check_below(max(abs(u[-10:].mean()), abs(turn[-10:]).max()), 0.02, "and rests")
    s = runs.series(runs.run(STACK + "-time_end 1 -checkpoint_interval 0", "stack"))
    for name, level in (("low", 0.07), ("high", 0.21)):
        _, y, u, v, turn, _ = columns(s, name)
        runs.check_below(abs(y[-10:] - level).max() / SPACING, 0.25, f"a stack of two boxes: height, {name}")
        moved = max(abs(of[-10:]).max() for of in (u, v, turn))
        runs.check_below(moved, 0.03, f"and at rest, {name}")
    # Deep water presses boxes on the floor and on each other, for steps as long as the weight allows.
    s = runs.series(runs.run(DEEP, "deep"))
    for name, level in (("low", 0.05), ("high", 0.15)):
        runs.check_below(abs(columns(s, name)[1] - level).max() / SPACING, 0.02, f"deep water on a stack, {name}")


def ranks():
    one, two = (runs.series(runs.run(PUSHED + "-time_end 0.8 -ksp_rtol 1e-8", f"ranks_{n}", n)) for n in (1, 2))
    a, b = columns(one, "float"), columns(two, "float")
    runs.check_below(max(abs(a[k][-1] - b[k][-1]) for k in (0, 1)) / SPACING, 0.02, "one and two ranks")


TURNTABLE = """-dimension 3 -spacing 0.04 -box_lower 0,0,0 -box_upper 1.2,1.2,0.5 -box_x wall -box_y wall -box_zmin wall
 -bodies water -water_upper 0.12,1.2,0.08 -solids step,table,a -step_lower 0.12,0,0 -step_upper 0.2,1.2,0.16
 -table_shape cylinder -table_axis z -table_center 0.7,0.6,0.06 -table_radius 0.4 -table_height 0.12
 -table_rotation_rate 0,0,2 -table_rotation_center 0.7,0.6,0.06 -a_lower 0.6,0.5,0.12 -a_upper 0.8,0.7,0.24
 -a_mass 5 -a_rotation_rate 0,0,2 -a_friction 0.5 -gravity 0,0,-9.81 -time_end 0.3 -time_step_max 4e-3
 -series_interval 0.02 -checkpoint_interval 0 """
BALLS = DRY.replace("step,a,b", "step,a,b,c") + "-a_velocity 1,0 -time_end 0.2 " + " ".join(
    f"-{n}_shape sphere -{n}_radius 0.1 -{n}_mass 10 -{n}_restitution 1" for n in "abc")


def moving():
    # What carries a body has its velocity where they touch: a conveyor, a lift, a turntable.
    one, mu = DRY.replace("step,a,b", "step,a"), 0.3
    s = runs.series(runs.run(one + f"""-gravity 0,{-G} -box_ymin_velocity 1,0 -a_lower 0.1,0 -a_upper 0.31,0.13
 -a_mass 20 -a_friction {mu} -time_end 0.45""", "conveyor"))
    u = columns(s, "a")[2]
    early = s["time"] < 0.9 / (mu * G)
    runs.check_below(abs(u - mu * G * s["time"])[early].max(), 1e-3, "a conveyor speeds a box up by friction")
    runs.check_within(u[-1], 0.999, 1.001, "until it has the conveyor's velocity")
    s = runs.series(runs.run(DRY.replace("step,a,b", "step,a,lift") + f"""-gravity 0,{-G} -lift_lower 0.1,0.2
 -lift_upper 0.6,0.3 -lift_oscillation_amplitude 0,0.05 -lift_oscillation_frequency 1.5 -a_lower 0.25,0.3
 -a_upper 0.46,0.43 -a_mass 20 -time_end 0.7""", "lift"))
    y = columns(s, "a")[1]
    runs.check_below(abs(y - y[0] - 0.05 * np.sin(3 * np.pi * s["time"])).max() / SPACING, 0.05, "a lift carries a box")
    s = runs.series(runs.run(TURNTABLE, "turntable"))
    rates = [s[n] for n in s.dtype.names if n.startswith("a_rate")]
    runs.check_below(max(abs(rate[-1] - due) for rate, due in zip(rates, (0, 0, 2))), 0.002,
                     "a box turns with its table")
    # A row of balls that touch shares the momentum of a hit, and the run says so; with gaps it is handed on.
    for name, gap, due in (("touching", 0, (-1 / 3, 2 / 3, 2 / 3)), ("apart", SPACING, (0, 0, 1))):
        folder = runs.run(BALLS + f" -a_center 0.3,0.6 -b_center 0.6,0.6 -c_center {0.8 + gap},0.6", f"row_{name}")
        s = runs.series(folder)
        u = [columns(s, body)[2][-1] for body in "abc"]
        runs.check_below(np.abs(np.subtract(u, due)).max(), 1e-6, f"a row of balls, {name}")
        said = "b is between a and c in a hit" in open(os.path.join(folder, "log.txt"), encoding="utf-8").read()
        runs.check(said == (gap == 0), f"the run says that hits are at once, {name}", said)


PARTS = {"dry": dry, "tank": tank, "ranks": ranks, "moving": moving}
for part in runs.parts(*PARTS):
    PARTS[part]()
runs.done()
