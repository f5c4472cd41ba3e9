#!/usr/bin/python3
"""An emitter whose speed is a table (-<b>_velocity_file): the liquid that has come is the integral of the table, to one
filling, also where the flow stops, and the liquid inside has the table's speed. What gets among the liquid of an
emitter, between it and a wall, goes with it."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "bench"))
import h5py  # noqa: E402
import numpy as np  # noqa: E402
import runs  # noqa: E402
import states  # noqa: E402

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

CHANNEL = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,0.5 -box_xmin wall -box_ymin wall -gravity 0,-9.81
 -bodies water,feed -water_lower 0.12,0 -water_upper 1,0.3 -water_velocity 0.3,0 -feed_type emitter -feed_upper 0.12,0.3
 -feed_velocity 0.3,0 -series_interval 0 -snapshot_interval 0 """
started = runs.numbered(runs.run(CHANNEL + "-steps_max 10", "channel"), "checkpoint")[-1]
changed = runs.scratch("among.h5")
with open(started, "rb") as file:
    whole = file.read()[:-24]  # without the seal
with open(changed, "wb") as file:
    file.write(whole)
with h5py.File(changed, "r+") as file:
    x, body = file["position"][:], file["body"][:]
    feed = int(body[(x[:, 0] > 0) & (x[:, 0] < 0.1)].max())
    inside = np.flatnonzero((body == feed) & (file["surface"][:] == 0))
    among = inside[np.hypot(x[inside, 0] - 0.05, x[inside, 1] - 0.1).argmin()]
    name = file["id"][among]
    file["body"][among] = 1 - feed
states.seal(changed)
folder = runs.run(CHANNEL + f"-steps_max 10 -restart {changed}", "among")
f = runs.fields(runs.numbered(folder, "checkpoint")[-1])
at = f["id"] == name
runs.check(np.allclose(f["velocity"][at][:, :2], (0.3, 0)), "what is among an emitter's liquid goes with it",
           f["velocity"][at])
runs.check_below(np.abs(f["pressure"]).max(), 2 * 1000 * 9.81 * 0.3, "its pressure")
runs.done()
