#!/usr/bin/python3
"""A box shaken along its floor: Stokes' second problem in the frame of the floor, du/dt = A sin(w t) + nu u'', u = 0 at
the floor: u = A/w (exp(-y/d) cos(w t - y/d) - cos(w t)), d = sqrt(2 nu/w); on two ranks, too."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

U, FREQUENCY, NU, TIME = 1e-3, 1.0, 1e-6, 2.3  # m/s, Hz, m2/s, s: the transient has gone
RATE = 2 * np.pi * FREQUENCY
DEPTH = np.sqrt(2 * NU / RATE)
SCENE = f"""-dimension 2 -spacing 1e-4 -box_lower 0,0 -box_upper 1e-3,3e-3 -box_ymin wall -box_x periodic
 -box_ymax symmetry -bodies water -packing_jitter 0 -water_viscosity 1e-3 -viscosity_form morris -time_end {TIME}
 -snapshot_interval {TIME} -checkpoint_interval 0 -gravity_amplitude {U * RATE},0 -gravity_frequency {FREQUENCY}
 -water_velocity {-U},0 """
for ranks in (1, 2):
    f = runs.fields(runs.numbered(runs.run(SCENE, f"wall {ranks}", ranks), "snapshot")[-1])
    liquid = f["body"] >= 0
    y, u = f["position"][liquid, 1], f["velocity"][liquid, 0]
    exact = U * (np.exp(-y / DEPTH) * np.cos(RATE * TIME - y / DEPTH) - np.cos(RATE * TIME))
    runs.check_below(np.sqrt(np.mean((u - exact)**2)) / U, 0.02, f"rms velocity error over the largest, {ranks} ranks")
    runs.check(np.ptp(exact) > 0.3 * U, "there is something to see", np.ptp(exact))
runs.done()
