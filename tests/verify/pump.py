#!/usr/bin/python3
"""Emitters push: one at the bottom of a column lifts the water above it, at its flow and against its weight; a channel
filled by one through a slot has the flow of a piston; a vessel that is full ends the run with a sentence."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

G, START, SPEED, POINT, WIDE, MOUTH = 9.81, 0.3, 0.2, 0.15, 0.1, 0.04  # m, m/s
COLUMN = f"""-dimension 2 -spacing 0.01 -box_lower 0,0 -box_x wall -box_ymin wall -gravity 0,-{G} -bodies water,pump
 -water_lower 0,{MOUTH} -water_upper {WIDE},{START} -pump_type emitter -pump_upper {WIDE},{MOUTH}
 -pump_velocity 0,{SPEED} -gauge_heights 0.05 -gauge_points 0.05,{POINT} -series_interval 0.01 -checkpoint_interval 0
 -snapshot_interval 0 """
s = runs.series(runs.run(COLUMN + f"-box_upper {WIDE},0.8 -time_end 1", "column"))
late = s["time"] > 0.1
level = START + SPEED * s["time"]
runs.check_below(np.abs(s["height_1_m"] - level)[late].max(), 0.02 * START, "level of a lifted column, off by m")
pressure = s["point_1_pressure_Pa"] / (1000 * G * (level - POINT))
runs.check_within(pressure[late].mean(), 0.98, 1.02, "pressure in it, over its weight")
runs.check_below(pressure[late].std(), 0.04, "its scatter")
rate = np.polyfit(s["time"], s["volume"], 1)[0]
runs.check_within(rate / (SPEED * WIDE), 0.98, 1.02, "volume that comes")
gained = (s["kinetic_energy"] + s["potential_energy"])[-1] - (s["kinetic_energy"] + s["potential_energy"])[0]
runs.check_within((s["outside_work"][-1] - s["outside_work"][0]) / gained, 0.99, 1.01, "work of the emitter")

process = runs.start((COLUMN + f"-box_upper {WIDE},0.4 -box_ymax wall -time_end 1 -output_dir " + runs.scratch("full"))
                     .replace("\n", ""))
said = process.stdout + process.stderr
runs.check(process.returncode != 0 and "has filled the vessel" in said and said.count("isph: error") == 1,
           "a full vessel ends the run with a sentence", said[-300:])

CHANNEL = """-dimension 2 -spacing 1e-3 -box_lower 0,0 -box_upper 0.12,0.025 -box_ymin symmetry -box_ymax wall
 -box_xmin wall -solids plate -plate_lower 0.05,0.005 -plate_upper 0.053,0.025 -bodies water,feed -water_lower 0.006,0
 -water_upper 0.05,0.025 -feed_type emitter -feed_upper 0.006,0.025 -feed_velocity 0.2,0 -gauge_points 0.02,0.012
 -time_end 0.06 -series_interval 0.5e-3 -checkpoint_interval 0 -snapshot_interval 0"""
s = runs.series(runs.run(CHANNEL, "channel"))
speed = s["point_1_velocity_x_ms"][s["time"] > 1e-3] / 0.2
runs.check_within(speed.min(), 0.98, 1.02, "least speed before a slot, over that of the emitter")
runs.check_within(speed.max(), 0.98, 1.02, "largest one")
runs.done()
