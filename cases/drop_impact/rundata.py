"""What figures.py and compare.py share: the reference curves and whether they apply to a run. All in SI units."""
import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "..", "..", "src", name) for name in ("python", "pictures")]
from isph.tables import Error, polite, read_scene, read_series, read_table  # noqa: E402,F401

REFERENCES = {3.13: "reference", 2.42: "reference_242"}  # m/s: the first part of the file's name
GRAVITY = 9.81  # m/s2


def read_reference(speed, kind=""):
    """The reference curves of a speed in REFERENCES; kind "_box": of a pool as small as the paper's; "_fine": with
    finer cells, until about 36 ms; "_second" (3.13 m/s only): by another program; none of a speed of None."""
    return {"time": []} if speed is None else read_table(os.path.join(HERE, REFERENCES[speed] + kind + ".csv"))


def pool(folder):
    """The kind of reference whose pool is nearest to that of a run in area: "_box", of 22.5 mm radius, or "", of 40."""
    domain = read_scene(folder)["domain"]
    half = [max(abs(low), abs(high)) for low, high in zip(domain["lower"], domain["upper"])]  # m, from the axis
    radius = half[0] if len(half) < 3 else 2 * math.sqrt(half[0] * half[1] / math.pi)
    return "_box" if radius < 31e-3 else ""


def impact_speed(scene):
    """Speed (m/s) at which the drop of a run reaches the level z = 0; NaN if the scene has no drop."""
    drop = next((body for body in scene["bodies"]
                 if body["name"] == "drop" and body["shape"]["type"] == "sphere"), None)
    if not drop:
        return math.nan
    fall = drop["shape"]["numbers"]["center"][-1] - drop["shape"]["numbers"]["radius"]
    return math.sqrt(drop["velocity"][-1] ** 2 + 2 * GRAVITY * max(0.0, fall))  # of rings there are two numbers


def reference_speed(folder):
    """The speed in REFERENCES that is the run's, as far as its scene tells (3.13 if it does not); None if there is
    none."""
    speed = impact_speed(read_scene(folder))
    if math.isnan(speed):
        return 3.13
    return next((known for known in REFERENCES if abs(speed - known) < 0.01 * known), None)
