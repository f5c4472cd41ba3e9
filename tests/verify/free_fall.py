#!/usr/bin/python3
"""Free fall of 1, 2, 8 and 27 particles with both schemes: the centre of mass follows the parabola, momentum is
m g t, to round-off, whatever the pressure does among them. The trapezoidal position update is exact for a constant
force."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

G = np.array([1.0, -2.0, -9.81])
V = np.array([0.5, 0.0, 2.0])
EDGE = {1: (1, 1, 1), 2: (2, 1, 1), 8: (2, 2, 2), 27: (3, 3, 3)}  # particles a direction
TIME = 0.1
TOLERANCE = 1e-12  # of the distance fallen; measured: at most 2e-15 alone, 6e-15 with tension

for scheme in ("consistent", "density_invariant"):
    for n, edge in EDGE.items():
        name = f"{scheme}_{n}"
        upper = ",".join(str(0.01 * e) for e in edge)
        scene = f"""-spacing 0.01 -box_lower -1,-1,-1 -box_upper 1,1,1 -gravity {','.join(map(str, G))} -bodies a
 -a_lower 0,0,0 -a_upper {upper} -a_velocity {','.join(map(str, V))} -a_viscosity 0.1 -a_tension 0.05 -scheme {scheme}
 -time_end {TIME} -time_step 2e-3 -packing_jitter 0 -snapshot_double """
        # the scheme of the paper throws a small lattice block apart in one step; its centre falls all the same
        loose = "-displacement_max 1e6 -density_max 1e3 " if scheme == "density_invariant" else ""
        folder = runs.run(scene + loose, name)
        first, last = (runs.fields(runs.numbered(folder, "snapshot")[k]) for k in (0, -1))
        time = runs.head(runs.numbered(folder, "snapshot")[-1])["time"]
        whole = len(first["id"]) == n and len(last["id"]) == n and abs(time - TIME) < 1e-12
        if not runs.check(whole, name + "_particles",
                          f"{len(first['id'])} at the start, {len(last['id'])} at {time} s"):
            continue
        fall = V * TIME + 0.5 * G * TIME**2
        moved = last["position"].mean(axis=0) - first["position"].mean(axis=0)
        runs.check_below(np.abs(moved - fall).max() / np.linalg.norm(fall), TOLERANCE, name + "_parabola")
        speed = last["velocity"].mean(axis=0)
        runs.check_below(np.abs(speed - V - G * TIME).max() / np.linalg.norm(V), TOLERANCE, name + "_momentum")
        if n == 1:
            runs.check(last["pressure"][0] == 0, name + "_no_pressure", f"{last['pressure'][0]} Pa")
runs.done()
