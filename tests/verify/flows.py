#!/usr/bin/python3
"""Couette, Poiseuille and Taylor-Green flow at the resolutions and tolerances of their cases."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import physics  # noqa: E402

FAILED = physics.short("couette", "", None)
FAILED += physics.short("poiseuille", "", None)
FAILED += physics.short("taylor_green", "", None, "_50")
FAILED += physics.short("taylor_green", "-spacing 0.01", None, "_100")
sys.exit(1 if FAILED else 0)
