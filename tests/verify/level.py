#!/usr/bin/python3
"""A symmetric box that floats in the middle of a symmetric tank stays level, whatever its width in spacings: its dummy
particles are symmetric about its middle. On the lattice of the tank, some of these boats capsized."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

TANK = """-dimension 3 -spacing 0.02 -box_lower -0.15,-0.15,0 -box_upper 0.15,0.15,0.4 -box_x wall -box_y wall
 -box_zmin wall -gravity 0,0,-9.81 -bodies water -water_upper 0.15,0.15,0.2 -solids boat -time_end 0.06
 -series_interval 5e-3 -checkpoint_interval 0 -snapshot_interval 0 """
for half in (0.055, 0.058, 0.06, 0.0635, 0.065, 0.07):
    s = runs.series(runs.run(TANK + f"-boat_lower -0.1,-{half},0.14 -boat_upper 0.1,{half},0.26 "
                             f"-boat_mass {1000 * 0.2 * 2 * half * 0.06}", f"boat_{half}"))
    rates = [abs(s[n]).max() for n in s.dtype.names if n.startswith("boat_rate")]
    runs.check_below(max(rates), 0.02, f"a boat of {2 * half / 0.02:g} spacings stays level")
runs.done()
