#!/usr/bin/python3
"""A drop that hangs from a ceiling stays as it is, and one that swings there is not damped."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

ALL = """-dimension 2 -box_lower 0,-4e-3 -box_upper 5e-3,0 -box_xmin symmetry -box_ymax wall -gravity 0,-9.81
 -bodies drop -drop_viscosity 1e-3 -drop_tension 0.072 -gauge_spread -snapshot_interval 0 -checkpoint_interval 0 """
# A cap that meets the ceiling at 60 degrees, 13 spacings in half its width, which Young and Laplace make 1.2802 mm.
REST = ALL + """-spacing 1e-4 -wall_contact_angle 60 -drop_shape sphere -drop_center 0,0.75e-3 -drop_radius 1.5e-3
 -series_interval 0.01 -time_end 0.4 """
RADIUS = 1.2802e-3
SWING = ALL + """-spacing 1e-4 -drop_shape ellipsoid -drop_center 0,0 -drop_radii 1.3e-3,1.1e-3
 -series_interval 0.4e-3 -time_end 0.024 """

for seed in (1, 2):
    s = runs.series(runs.run(REST + f"-packing_seed {seed}", f"rest_{seed}"))
    late = s["time"] > 0.3
    radius = s["wetted_ymax_m"][late].mean()
    runs.check_below(abs(radius / RADIUS - 1), 0.01, f"contact radius of a hanging drop, {seed}")
    runs.check_below(s["kinetic_energy"][late].mean(), 3e-10, "and what moves in it, J/m")
    area = s["surface_energy"][late].mean() / s["surface_energy"][1]
    runs.check_below(abs(area - 1), 0.03, "and its surface is no row of drops")
s = runs.series(runs.run(SWING, "swing"))
k = s["kinetic_energy"]
peaks = [n for n in range(1, len(k) - 1) if k[n] > max(k[n - 1], k[n + 1], 0.3 * k.max())]
runs.check(len(peaks) >= 3, "a drop swings under a ceiling", peaks)
runs.check_within(k[peaks[2]] / k[peaks[0]], 0.6, 0.9, "and keeps its energy over two half swings")
runs.done()
