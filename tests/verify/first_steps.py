#!/usr/bin/python3
"""The main case at a spacing of 1 mm until 1 ms on one and on two ranks, against figures of this program: a change of
any formula, packing or default of the scheme shows here, in a second. Where a result is to change, the figures change
with it: first_steps.py --write prints them."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

SCENE = """-options_file cases/drop_impact/case.opts -options_file options/quarter.opts -spacing 1e-3 -time_end 1e-3
 -ksp_rtol 1e-11 -checkpoint_interval 0"""
FIGURES = {"step": 19, "crater_depth": -2.95262443398e-05, "kinetic_energy": 0.000147253077326,
           "potential_energy": -0.000862567170333, "surface_energy": 0.000107148603152,
           "viscous_work": -1.40024980461e-06, "tension_work": 2.06120235155e-06, "density_error": 0.00439238073486,
           "divergence": 0.000405120080089, "highest": 0.00107027883621, "particles": 4008}
TOLERANCE = 3e-6  # code for any x86-64 processor, without fused operations, differs by up to 5e-7

for ranks in (1, 2):
    last = runs.series(runs.run(SCENE, f"on_{ranks}", ranks))[-1]
    if "--write" in sys.argv:
        print({name: float(last[name]) for name in FIGURES})
        continue
    for name, figure in FIGURES.items():
        runs.check_within(last[name] / figure, 1 - TOLERANCE, 1 + TOLERANCE, f"{name} on {ranks} ranks")
runs.done()
