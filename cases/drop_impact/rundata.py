"""What figures.py and compare.py share: the reference curves and whether they apply to a run. All in SI units."""
import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "src", "pictures"))
from tables import (RunError, number, polite, read_options, read_series, read_table,  # noqa: E402,F401
                    vector)

REFERENCE_SPEED = 3.13  # m/s, of reference.csv and reference_box.csv
GRAVITY = 9.81  # m/s2


def read_reference(box=False):
    """The reference curves; box: those of a pool as small as the paper's."""
    return read_table(os.path.join(HERE, "reference_box.csv" if box else "reference.csv"))


def impact_speed(options):
    """Speed (m/s) at which the drop of a run reaches the level z = 0; NaN if the options do not tell."""
    velocity, center = vector(options, "drop_velocity"), vector(options, "drop_center")
    radius = number(options.get("drop_radius"))
    if len(velocity) < 3 or len(center) < 3 or math.isnan(radius):
        return math.nan
    return math.sqrt(velocity[2] ** 2 + 2 * GRAVITY * max(0.0, center[2] - radius))


def reference_applies(folder):
    """Whether the reference is of the run's case, as far as its options tell."""
    speed = impact_speed(read_options(folder))
    return math.isnan(speed) or abs(speed - REFERENCE_SPEED) < 0.01 * REFERENCE_SPEED
