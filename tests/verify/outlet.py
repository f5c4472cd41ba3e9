#!/usr/bin/python3
"""Outlets, open faces whose outside holds a level or a pressure: a tank at rest at the level of its outlet stays at
rest, as rings, too; a channel between an emitter and an outlet has the outlet's level and the emitter's flow, also
mirrored, in three dimensions, on two ranks and after a restart; a column falls as the pressure below it lets it; in a
viscous channel the pressure outside leaves the slope."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

RHO, G, SPACING = 1000, 9.81, 0.025
PLAIN = "-series_interval 0.05 -checkpoint_interval 0 -snapshot_interval 0 "


def near(values, expected, share, name):
    """All values are within a share of what is expected."""
    runs.check_below(np.abs(np.asarray(values) / expected - 1).max(), share, name)


def tank():
    level = 0.5
    scene = f"-spacing {SPACING} -box_xmax_level {level} -bodies water -time_end 2 {PLAIN}"
    plane = scene + f"""-dimension 2 -box_lower 0,0 -box_upper 1,0.7 -box_xmin wall -box_ymin wall -gravity 0,{-G}
     -water_upper 1,{level} -gauge_heights 0.1,0.5,0.9 -gauge_points 0.9,0.2 """
    rings = scene + f"""-dimension axisymmetric -box_lower 0,0 -box_upper 0.7,0.7 -box_ymin wall -gravity 0,{-G}
     -water_upper 0.7,{level} -gauge_heights 0.1,0.3,0.6 -gauge_points 0.6,0.2 -time_end 1 """
    for name, options in ("plane", plane), ("rings", rings):
        s = runs.series(runs.run(options, f"tank_{name}"))
        runs.check_below(1 - s["volume"].min() / s["volume"][0], 0.01, f"{name}: share of a tank at rest that leaves")
        runs.check_below(np.sqrt(2 * s["kinetic_energy"].max() / (RHO * s["volume"][0])) / np.sqrt(G * level), 0.01,
                         f"{name}: its largest mean speed, over sqrt(g H)")
        for n in 1, 2, 3:
            near(s[f"height_{n}_m"], level, 0.02, f"{name}: its level {n}")
        near(s["point_1_pressure_Pa"][1:], RHO * G * (level - 0.2), 0.04, f"{name}: pressure beside the outlet")


LEVEL, SPEED, LONG = 0.4, 0.3, 4.0  # m, m/s, s
FLOW = LEVEL * SPEED  # m2/s


def channel(dim, mirrored=False):
    """Options of a channel of one metre."""
    deep, zero, up = (",0.15", ",0", 2) if dim == 3 else ("", "", 1)
    ends = (("-0.1", "0"), ("-1", "-0.1")) if mirrored else (("0", "0.1"), ("0.1", "1"))
    corners = [(f"{low}{zero},0", f"{high}{deep},{LEVEL}") for low, high in ends]
    u = -SPEED if mirrored else SPEED
    x = -1 if mirrored else 1
    wall = "zmin" if dim == 3 else "ymin"
    return f"""-dimension {dim} -spacing {SPACING} -box_lower {min(0, x)}{zero},0 -box_upper {max(0, x)}{deep},0.6
     -box_{'xmax' if mirrored else 'xmin'} wall -box_{'xmin' if mirrored else 'xmax'}_level {LEVEL} -box_{wall} wall
     {'-box_y symmetry' if dim == 3 else ''} -bodies water,feed -feed_type emitter
     -feed_lower {corners[0][0]} -feed_upper {corners[0][1]} -feed_velocity {u}{zero},0
     -water_lower {corners[1][0]} -water_upper {corners[1][1]} -water_velocity {u}{zero},0
     -gravity 0{',0' * (up - 1)},{-G} -time_end {LONG}
     -gauge_heights {','.join(f'{x * place}' + (',0.07' if dim == 3 else '') for place in (0.3, 0.6, 0.9))} {PLAIN}"""


def flows(s, face, name, wide=1.0):
    """What a channel must have."""
    unit = "m2" if wide == 1 else "m3"
    for n in 1, 2, 3:
        near(s[f"height_{n}_m"], LEVEL, 0.02, f"{name}: level {n}")
    runs.check_below(abs(s[f"outflow_{face}_{unit}"][-1] - wide * FLOW * s["time"][-1]), wide * LEVEL * SPACING,
                     f"{name}: what left is what came, to a row of particles")
    near(s[f"outflow_rate_{face}_{unit}s"][s["time"] > 0.5].mean(), wide * FLOW, 0.03, f"{name}: its rate in front of "
         "the face")


def plane():
    whole = runs.run(channel(2), "channel", ranks=1)
    s = runs.series(whole)
    flows(s, "xmax", "channel")
    # the outside takes what its pressure takes from the flow
    with open(os.path.join(whole, "log.txt"), encoding="utf-8") as log:
        given = float(log.read().split("the pressure outside outlets")[1].split()[0].strip(","))
    near([-given], RHO * G * LEVEL**2 / 2 * SPEED * LONG, 0.02, "work against the pressure outside")
    flows(runs.series(runs.run(channel(2, True), "mirrored")), "xmin", "mirrored")
    flows(runs.series(runs.run(channel(2), "ranks", ranks=2)), "xmax", "two ranks")
    low = runs.series(runs.run(channel(2).replace(f"level {LEVEL}", "level 0.3"), "low"))
    late = low["time"] > 0.7 * LONG
    runs.check_within(low["height_3_m"][late].mean(), 0.27, 0.35, "a lower level outside draws the level down")


def space():
    flows(runs.series(runs.run(channel(3) + " -time_end 0.8", "space")), "xmax", "in space", 0.15)


def restart():
    """To the last bit, with the volume that left before."""
    options = channel(2) + " -time_end 0.6 -checkpoint_interval 0.3 "
    whole = runs.run(options, "whole")
    first = runs.numbered(whole, "checkpoint")[0]
    rest = runs.run(options + f"-restart {first}", "rest")
    ends = [runs.numbered(folder, "checkpoint")[-1] for folder in (whole, rest)]
    unlike = runs.unlike(runs.fields(ends[0]), runs.fields(ends[1]))
    runs.check(not unlike, "restart: fields", str(unlike))
    left = [runs.series(folder)["outflow_xmax_m2"][-1] for folder in (whole, rest)]
    runs.check(left[0] == left[1] > 0, "restart: what left", f"{left}")


def pressure():
    """A column of water H on an outlet with the pressure P falls with g - P/(rho h), h what of it is left."""
    deep, wide, load = 0.5, 0.2, 0.6  # m, m, share of the weight at the start
    s = runs.series(runs.run(f"""-dimension 2 -spacing 0.0125 -box_lower 0,0 -box_upper {wide},0.6 -box_x symmetry
     -box_ymin_pressure {load * RHO * G * deep} -bodies water -water_upper {wide},{deep} -gravity 0,{-G} -time_end 0.2
     -gauge_heights 0.1 {PLAIN} -series_interval 0.01""", "column"))
    h, v, dt, heights, t = deep, 0.0, 1e-5, [], 0.0
    for time in s["time"]:
        while t < time - dt / 2:
            v += dt * (G - load * G * deep / h)
            h -= dt * v
            t += dt
        heights.append(h)
    runs.check_below(np.abs(s["height_1_m"] - heights).max(), 0.01, "a column falls on the pressure, off by m")
    near(deep - s["volume"][-1] / wide, s["outflow_ymin_m2"][-1] / wide, 1e-9, "what it lost has left")


def viscous():
    """A pressure outside raises that of a viscous channel behind an emitter, not its slope in implicit steps, and does
    not scatter it in explicit ones."""
    mu, wide, speed, places = 1, 0.04, 0.05, np.array([0.15, 0.2, 0.25, 0.3])
    channel = f"""-dimension 2 -spacing 0.004 -box_lower 0,0 -box_upper 0.4,{wide} -box_y wall
     -box_xmax_pressure 1500 -bodies oil,feed -oil_lower 0.06,0 -oil_upper 0.4,{wide} -oil_velocity {speed},0
     -oil_viscosity {mu} -feed_type emitter -feed_upper 0.06,{wide} -feed_velocity {speed},0 -feed_viscosity {mu}
     -packing_jitter 0 -gauge_points {','.join(f'{x},0.02' for x in places)} {PLAIN} """
    s = runs.series(runs.run(channel + "-viscosity_solver implicit -time_end 4", "viscous"))
    late = s["time"] > 2
    falls = -np.polyfit(places, [s[f"point_{n}_pressure_Pa"][late].mean() for n in (1, 2, 3, 4)], 1)[0]
    near([falls], 12 * mu * speed / wide**2, 0.05, "a viscous channel: slope of its pressure")
    s = runs.series(runs.run(channel + "-viscosity_solver explicit -time_end 1 -series_interval 0.01", "explicit"))
    runs.check_below(s["point_1_pressure_Pa"][5:].std(), 40, "a viscous channel: scatter of its pressure, Pa")


def long_steps():
    """A vessel at rest beside an outlet keeps its density in long steps, whatever presses outside."""
    s = runs.series(runs.run(f"""-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 0.5,0.2 -box_y wall -box_xmin wall
     -box_xmax_pressure 1500 -bodies oil -oil_upper 0.5,0.2 -oil_viscosity 1 -time_end 4 {PLAIN}""", "long_steps"))
    runs.check_below(s["density_error"][1:].max(), 2 * s["density_error"][0], "at rest in long steps: density error")


def model():
    """A scene whose two open faces differ is no half."""
    scene = f"""-spacing 0.1 -box_lower -1,-1,0 -box_upper 1,1,1 -box_zmin wall -gravity 0,0,-{G} -bodies a
     -a_lower -1,-1,0 -a_upper 1,1,0.5 -time_end 0.1 -box_xmin_level 0.5 -dry_run """
    for level, holds in (0.5, True), (0.4, False):
        process = runs.start(scene + f"-box_xmax_level {level} -output_dir " + runs.scratch("model"))
        runs.check(("mirror across x: yes" in process.stdout) == holds, f"mirror: {holds}", process.stdout[-900:])


def refused():
    scene = "-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 1,1 -bodies a -a_upper 1,0.5 -time_end 0.1 "
    gravity = f"-gravity 0,{-G} "
    for options, word in ((gravity + "-box_xmax wall -box_xmax_level 0.5", "only an open one has an outside"),
                          ("-box_xmax_level 0.5", "needs -gravity"),
                          (gravity + "-box_xmax_level 0.5 -gas", "-gas"),
                          (gravity + "-box_xmax_pressure 5 -scheme weakly_compressible", "consistent"),
                          (gravity + "-box_zmax_level 0.5", "-box_zmax_level")):
        process = runs.start(scene + options + " -output_dir " + runs.scratch("refused"))
        said = process.stdout + process.stderr
        runs.check(process.returncode != 0 and word in said and said.count("isph: error") == 1, f"refused: {word}",
                   said[-300:])


PARTS = {"tank": tank, "plane": plane, "space": space, "restart": restart, "pressure": pressure, "viscous": viscous,
         "long_steps": long_steps, "model": model, "refused": refused}
for part in runs.parts(*PARTS):
    PARTS[part]()
runs.done()
