#!/usr/bin/python3
"""An emitter whose speed is a table (-<b>_velocity_file): the liquid that has come is the integral of the table, to one
filling, also where the flow stops, and the liquid inside has the table's speed."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

WIDE, ROW = 0.1, 0.02  # m
TABLE = np.array([(0.0, 1.0), (0.2, 2.0), (0.3, 0.0), (0.4, 0.0), (0.6, 0.5)])
path = runs.scratch("table.csv")
np.savetxt(path, TABLE, delimiter=",", header="t,speed", comments="")
s = runs.series(runs.run(f"""-dimension 2 -spacing 0.01 -box_lower 0,-2 -box_upper 0.5,0.1 -bodies jet -jet_type emitter
 -jet_lower 0.2,0 -jet_upper {0.2 + WIDE},{ROW} -jet_velocity 0,-2 -jet_velocity_file {path} -time_end 0.6
 -series_interval 0.02 -checkpoint_interval 0 -snapshot_interval 0""", "feed"))
fine = np.linspace(0, 0.6, 6001)
speed = np.interp(fine, *TABLE.T)
came = WIDE * np.concatenate(([0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(fine))))
late = (s["volume"] - np.interp(s["time"], fine, came)) / (WIDE * ROW)  # the filling that leaves counts
runs.check_within(late.min(), -0.05, 1, "at least what the table says")
runs.check_within(late.max(), 0, 1.2, "and one filling more at most")
still = s["volume"][(s["time"] > 0.31) & (s["time"] < 0.39)]
runs.check_below(np.ptp(still), 1e-12, "nothing comes while the table is 0")
bad = runs.scratch("bad.csv")
for text, word in (("0,1\n0.1,-1\n", "takes no liquid back"), ("0,1\n", "two lines"), ("0,1,2\n1,1,2\n", "line 1")):
    with open(bad, "w", encoding="utf-8") as file:
        file.write(text)
    process = runs.start("-dimension 2 -spacing 0.01 -box_lower 0,-2 -box_upper 0.5,0.1 -bodies jet -jet_type emitter "
                         f"-jet_velocity 0,-2 -jet_upper 0.3,0.02 -jet_velocity_file {bad} -output_dir "
                         + runs.scratch("bad"))
    said = process.stdout + process.stderr
    refused = process.returncode != 0 and word in said and said.count("isph: error") == 1
    runs.check(refused, f"refused: {word}", said[-300:])
runs.done()
