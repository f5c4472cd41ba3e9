#!/usr/bin/python3
"""The verification cases without tension at the resolution and with the tolerances they must reach; every
result counts."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "verify"))
import physics  # noqa: E402

G = "-pressure_gradient corrected "
Q = "-kernel_type quintic_spline -kernel_ratio 1 "
RUNS = [  # case, file, options, label
    ("film_at_rest", "case.opts", Q + "-packing_jitter 0.1", ""),
    ("film_at_rest", "tank.opts", Q + "-spacing 0.025 -packing_jitter 0", "_tank"),
    ("couette", "case.opts", "", ""),
    ("poiseuille", "case.opts", "", ""),
    ("taylor_green", "case.opts", G, "_50"),
    ("taylor_green", "case.opts", G + "-spacing 0.01", "_100"),
    ("square_patch", "case.opts", G, ""),
    ("stretching_drop", "case.opts", G, ""),
    ("central_force", "case.opts", G, ""),
    ("free_fall", "case.opts", "", ""),
]
FAILED = 0
for case, file, options, label in RUNS:
    FAILED += physics.short(case, options, None, label, file=file)
sys.exit(1 if FAILED else 0)
