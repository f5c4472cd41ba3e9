#!/usr/bin/python3
"""A box shaken along its floor: Stokes' second problem in the frame of the floor, du/dt = A sin(w t) + nu u'', u = 0 at
the floor: u = A/w (exp(-y/d) cos(w t - y/d) - cos(w t)), d = sqrt(2 nu/w); on two ranks, too.
A tank shaken upright weighs m (g - a sin(w t)) at the times of its pressures, in two schemes."""
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

LIFT, GRAVITY, LATE = 4.0, 9.81, 0.2  # m/s2, m/s2, s: the first swing has gone
TANK = f"""-dimension 2 -spacing 0.01 -box_lower 0,0 -box_upper 0.1,0.15 -box_x wall -box_ymin wall -bodies water
 -water_upper 0.1,0.1 -packing_jitter 0 -gravity 0,-{GRAVITY} -gravity_amplitude 0,{LIFT} -gravity_frequency 5
 -time_end 0.6 -gauge_forces -checkpoint_interval 0 -time_step """
for scheme, step in ("consistent", 4e-3), ("consistent", 2e-3), ("density_invariant", 4e-3):
    series = runs.series(runs.run(f"{TANK} {step} -scheme {scheme}", f"tank {scheme} {step}"))
    late = series["time"] > LATE
    angle = 10 * np.pi * series["pressure_time_s"][late]
    waves = np.column_stack((np.ones_like(angle), np.sin(angle), np.cos(angle)))
    (mean, along, across), *_ = np.linalg.lstsq(waves, series["force_ymin_y_Nm"][late], rcond=None)
    runs.check_within(along / mean / (-LIFT / GRAVITY), 0.98, 1.02, f"swing of the weight, {scheme}, {step}")
    runs.check_below(abs(across / along) / (10 * np.pi * step), 0.02, f"how late it is, in steps, {scheme}, {step}")
runs.done()
