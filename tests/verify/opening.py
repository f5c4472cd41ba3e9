#!/usr/bin/python3
"""Liquid that hangs under tension opens without -gas, and the run says where and at what pressure: once, and only of
what hangs."""
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

WATER, GRAVITY = 1000, 9.81
SAID = re.compile(r"liquid under tension, (\S+) Pa, opens at (\S+),(\S+),\S+ m")
ALL = """-dimension 2 -spacing 0.01 -box_lower 0,0 -box_xmin wall -box_ymin wall -box_xmax wall -gravity 0,-9.81
 -bodies_overlap -snapshot_interval 0 -series_interval 0 -checkpoint_interval 0 """
# Two tanks, and a pipe over a post between them; it is filled, and its crest is above the higher level.
SIPHON = ALL + """-box_upper 0.8,0.6 -bodies left,pipe,right -left_upper 0.34,0.25 -right_lower 0.46,0
 -right_upper 0.8,0.1 -pipe_lower 0.28,0.05 -pipe_upper 0.52,0.51 -solids post,outl,outr,roof -post_lower 0.34,0
 -post_upper 0.46,0.45 -outl_lower 0.24,0.05 -outl_upper 0.28,0.51 -outr_lower 0.52,0.05 -outr_upper 0.56,0.51
 -roof_lower 0.24,0.51 -roof_upper 0.56,0.55 """
# The same without the crest's height: it stands as deep below the higher level.
LOW = SIPHON + "-left_upper 0.24,0.56 -right_lower 0.56,0 -right_upper 0.8,0.56 "


def said(options, name, ranks=1):
    """(pressure, x, y) of each time that the run said it."""
    with open(os.path.join(runs.run(options, name, ranks), "log.txt"), encoding="utf-8") as log:
        return [tuple(map(float, m.groups())) for m in SAID.finditer(log.read())]


for processes in (1, 3):
    found = said(SIPHON + "-time_end 0.3", f"siphon_{processes}", processes)
    runs.check(len(found) == 1, f"a siphon on {processes} ranks: it says once that liquid opens", found)
    for pressure, x, y in found:
        runs.check(0.28 < x < 0.52 and y > 0.42, "and where: in the crest", (x, y))
        runs.check_within(-pressure / WATER / GRAVITY, 0.44 - 0.25, 0.51 - 0.1, "and its tension")
for until in (0.05, 0.28):  # before and after it is said
    first = said(SIPHON + f"-time_end {until}", f"until_{until}")
    again = said(SIPHON + f"-time_end 0.5 -restart {runs.numbered(runs.scratch(f'until_{until}'), 'checkpoint')[-1]}",
                 f"from_{until}")
    runs.check((len(first), len(again)) == ((0, 1) if until < 0.1 else (1, 0)), f"a restart at {until} s says no more",
               (first, again))
runs.check(not said(LOW + "-time_end 0.3", "low"), "a pipe below the level does not open")
runs.check(not said(SIPHON + "-time_end 0.3 -gas", "gas"), "nor is anything said with -gas")
DAM = ALL + "-box_upper 0.8,0.8 -bodies water -water_upper 0.2,0.4 -time_end 0.8 "
runs.check(not said(DAM, "dam"), "a dam that breaks and hits a wall, which presses it")
FULL = ALL + """-box_upper 0.4,0.2 -box_ymax wall -box_x wall -bodies water -solids plate -plate_lower 0.15,0.08
 -plate_upper 0.25,0.12 -plate_velocity 0.1,0 -time_end 0.3 """
runs.check(not said(FULL, "full"), "a full vessel, whose pressure has no level")
runs.done()
