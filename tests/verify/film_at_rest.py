#!/usr/bin/python3
"""A film 10 mm deep and a tank at rest, cases/film_at_rest, coarse; the tank's motion and finer spacings:
tests/long/verify_cases.py."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import physics  # noqa: E402

PRESSURE = ("mean pressure, rms error over rho g H", "largest instantaneous rms pressure error over rho g H",
            "change of the level, over H", "particles lost")
FAILED = physics.short("film_at_rest",
                       "-spacing 1e-3 -kernel_type quintic_spline -kernel_ratio 1 -time_end 0.6",
                       PRESSURE + ("rms speed over sqrt(g H), second half",))
FAILED += physics.short("film_at_rest", "-packing_jitter 0 -spacing 0.05", PRESSURE, "_tank", file="tank.opts")
sys.exit(1 if FAILED else 0)
