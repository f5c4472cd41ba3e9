#!/usr/bin/python3
"""Drops without tension, cases/stretching_drop, cases/central_force, cases/square_patch and cases/free_fall,
coarse."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import physics  # noqa: E402

G = "-pressure_gradient corrected "
FAILED = physics.short("stretching_drop", G,
                       ("semi-axis a, largest relative error", "semi-axis b, largest relative error",
                        "kinetic energy, relative change", "particles lost"))
FAILED += physics.short("central_force", G + "-spacing 0.05",
                        ("period, relative error", "amplitude of b in the last period, relative error",
                         "energy, relative change a period", "particles lost"))
FAILED += physics.short("square_patch", G,
                        ("kinetic energy, relative change", "voids: smallest density inside",
                         "clumps: largest density", "particles lost"))
FAILED += physics.short("free_fall", "-shifting 0",
                        ("parabola, error over the distance fallen", "momentum, error over m v"))
sys.exit(1 if FAILED else 0)
