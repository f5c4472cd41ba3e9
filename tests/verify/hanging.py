#!/usr/bin/python3
"""A drop that hangs from a ceiling stays as it is, and one that swings there is not damped."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

DROP = """-box_xmin symmetry -bodies drop -drop_viscosity 1e-3 -drop_tension 0.072 -gauge_spread
 -snapshot_interval 0 -checkpoint_interval 0 """
PLANE = DROP + "-dimension 2 -box_lower 0,-4e-3 -box_upper 5e-3,0 -box_ymax wall -gravity 0,-9.81 "
RINGS = PLANE.replace("-box_xmin symmetry", "").replace("-dimension 2", "-dimension axisymmetric")
SPACE = DROP + """-dimension 3 -box_lower 0,0,-4e-3 -box_upper 3e-3,3e-3,0 -box_ymin symmetry -box_zmax wall
 -gravity 0,0,-9.81 """
# Caps that meet the ceiling at 60 degrees, 13 and 10 spacings in half their width, of which Young and Laplace make
# 1.2802 and 1.2901 mm.
REST = " -gauge_roughness -wall_contact_angle 60 -drop_shape sphere -drop_radius 1.5e-3 -series_interval 0.01 "
FLAT = REST + "-drop_center 0,0.75e-3 -spacing 1e-4 -time_end 0.4"
ROUGH = 0.06  # spacings
SWING = PLANE + """-spacing 1e-4 -drop_shape ellipsoid -drop_center 0,0 -drop_radii 1.3e-3,1.1e-3
 -series_interval 0.4e-3 -time_end 0.024 """

for name, scene, wetted, exact, most, spacing in (
        ("plane_1", PLANE + FLAT, lambda s: s["wetted_ymax_m"], 1.2802e-3, 0.01, 1e-4),
        ("plane_2", PLANE + FLAT + " -packing_seed 2", lambda s: s["wetted_ymax_m"], 1.2802e-3, 0.01, 1e-4),
        ("rings", RINGS + FLAT, lambda s: np.sqrt(s["wetted_ymax_m2"] / np.pi), 1.2901e-3, 0.01, 1e-4),
        ("space", SPACE + REST + "-drop_center 0,0,0.75e-3 -spacing 1.3e-4 -time_end 0.15",
         lambda s: np.sqrt(4 * s["wetted_zmax_m2"] / np.pi), 1.2901e-3, 0.015, 1.3e-4)):
    s = runs.series(runs.run(scene, name))
    late = s["time"] > 0.7 * s["time"][-1]
    runs.check_below(abs(wetted(s)[late].mean() / exact - 1), most, f"contact radius of a hanging drop, {name}")
    runs.check_below(s["surface_roughness_m"][late].mean(), ROUGH * spacing, "and its surface is no row of drops, m")
    if name.startswith("plane"):
        runs.check_below(s["kinetic_energy"][late].mean(), 3e-10, "and what moves in it, J/m")
s = runs.series(runs.run(SWING, "swing"))
k = s["kinetic_energy"]
peaks = [n for n in range(1, len(k) - 1) if k[n] > max(k[n - 1], k[n + 1], 0.3 * k.max())]
runs.check(len(peaks) >= 3, "a drop swings under a ceiling", peaks)
runs.check_within(k[peaks[2]] / k[peaks[0]], 0.6, 0.9, "and keeps its energy over two half swings")
runs.done()
