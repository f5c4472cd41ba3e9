#!/usr/bin/python3
"""Pressure, motion, level and volume of a liquid at rest, of the film or the tank; how rough the stirred film stays.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402


def weight(folder, due, relaxed):
    """The force on the floor, if the run measured it, in the mean of what is at rest."""
    s = runs.series(folder)
    name = next((n for n in s.dtype.names if n in ("force_zmin_z_N", "force_ymin_y_N", "force_ymin_y_Nm")), None)
    if not name:
        return []
    return [physics.relative("force on the floor", -s[name][s["time"] >= relaxed].mean(), due, 0.01, "N")]


def stirred(s, spacing):
    """Of the waves and the disorder of a surface only as much stays as of the energy: heights go with v^2/2g."""
    def mean(name, begin, end):
        return s[name][(s["time"] >= begin) & (s["time"] <= end)].mean()
    (first, last), (energy, left) = ([mean(name, 0.03, 0.05), mean(name, 0.18, 0.2)] for name in (
        "surface_roughness_m", "kinetic_energy"))
    return [physics.at_most("roughness after 0.19 s over the spacing", last / spacing, 0.05),
            physics.at_most("its part of that after 0.04 s, over the same of the kinetic energy",
                            last / first * energy / left, 1.5)]


def check(folder):
    if "surface_roughness_m" in runs.series(folder).dtype.names:
        return stirred(runs.series(folder), float(next(physics.snapshots(folder))[1]["spacing"]))
    errors, instant, speed, floor, motion = [], [], [], [], []
    n = len(list(physics.snapshots(folder))[-1][2]["id"])  # particles may split at first
    for time, head, f in physics.snapshots(folder):
        rings = physics.rings(head)
        up = int(head["dimension"]) - 1
        z, volume = f["position"][:, up], physics.volumes(head, f)
        if time == 0:
            start = f
            rho, g, low, high = (1100.0, 9.81, -0.01, 0.0) if up == 2 or rings else (1000.0, 1.0, 0.0, 0.9)
            depth, relaxed = high - low, 3 * np.sqrt((high - low) / g)
            first, start_volume = np.average(z, weights=volume), volume.sum()
        if time < relaxed or len(z) != n:
            continue
        e = f["pressure"] / (rho * g * depth) - (high - z) / depth
        errors.append(e)
        judged = f
        instant.append(np.sqrt((e**2).mean()))
        motion.append((f["velocity"]**2).sum(axis=1) / (g * depth))
        speed.append(np.sqrt(np.average(motion[-1], weights=volume)))
        near = z < low + 0.2 * depth  # the pressure at the floor: a straight line through the lowest fifth
        floor.append(np.polyval(np.polyfit(z[near], f["pressure"][near], 1), low))
    lost = physics.lost(head, start, f)
    if not errors:
        raise ValueError(f"no snapshot after {relaxed:.3g} s, when the liquid should be at rest")
    level, mean = high + 2 * (np.average(z, weights=volume) - first), np.mean(errors, axis=0)
    axis = [physics.at_most("pressure error in the first two rings over that elsewhere",
                            physics.at_axis(head, [(judged, mean)]), 2),
            physics.at_most("speed in the first two rings over that elsewhere",
                            physics.at_axis(head, [(judged, np.sqrt(np.mean(motion, axis=0)))]), 2)] if rings else []
    return [physics.relative("mean pressure at the floor", np.mean(floor), rho * g * depth, 0.02, "Pa"),
            physics.at_most("mean pressure, rms error over rho g H", np.sqrt((mean**2).mean()), 0.02),
            physics.at_most("largest instantaneous rms pressure error over rho g H", max(instant), 0.05),
            physics.at_most("rms speed over sqrt(g H), second half", np.mean(speed[len(speed) // 2:]), 2e-3),
            physics.relative("depth, from the centre of mass", level - low, depth, 0.005, "m"),
            *([] if "colour" in f else [lost])] + axis + weight(folder, rho * g * start_volume, relaxed)


if __name__ == "__main__":
    physics.main(check)
