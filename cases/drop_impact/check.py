#!/usr/bin/python3
"""The drop impact against the reference: crater, crown, collapse, jet and kinetic energy. The tolerances are those
that must be reached at 0.25 mm, and 10 % for the depth up to 0.5 mm; at other spacings, and at speeds without a
reference, the figures are only shown.
check.py RUN_FOLDER"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "..", "..", "tests", "verify"), HERE]
import numpy as np  # noqa: E402
import compare  # noqa: E402
import physics  # noqa: E402
import rundata  # noqa: E402

SPAN = np.arange(2e-3, 35.05e-3, 0.1e-3)  # s: depth and diameter


def half(table):
    """Time (s) at which the crater, after it was deepest, is half as deep; nan if it is not yet."""
    depth, start = compare.maximum(table, "crater_depth", compare.CONTACT, np.inf)
    before = None
    for t, v in compare.pairs(table, "crater_depth"):
        if before and t > start and v < depth / 2:
            return before[0] + (depth / 2 - before[1]) * (t - before[0]) / (v - before[1])
        before = t, v
    return np.nan


def curve(table, name):
    """A column on SPAN; nan where the series does not reach."""
    samples = np.array(compare.pairs(table, name)).reshape(-1, 2)
    if not len(samples):
        return np.full(len(SPAN), np.nan)
    return np.interp(SPAN, samples[:, 0], samples[:, 1], left=np.nan, right=np.nan)


def drop_liquid(folder):
    """Where the paper saw the drop's liquid: on the crater's floor (about 15 ms), in the jet and below it (60 ms).
    Shares of what the drop had: with graded spacing some of it becomes part of larger particles of the film."""
    shares, whole = {}, None
    for t, head, f in physics.snapshots(folder):
        drop = f["body"] == 1
        x, V = physics.upright(head, f)[drop], physics.volumes(head, f)[drop]
        whole = whole or V.sum()
        shares[t] = [V[where].sum() / whole for where in (x[:, 2] < 0, np.hypot(x[:, 0], x[:, 1]) < 5e-3)]
    results = []
    for time, k, name in ((15e-3, 0, "drop's liquid below the level at 15 ms"),
                          (60e-3, 1, "drop's liquid within 5 mm of the axis at 60 ms")):
        near = min(shares, key=lambda t, time=time: abs(t - time))
        if abs(near - time) < 0.6e-3:
            results.append(physics.shown(name, 100 * shares[near][k], unit="%"))
    return results


def secondary(folder):
    """What has come off the pool by 15 ms, in the computed part of the box: particles above 1 mm below the level that
    are not connected with the rest by steps of two spacings; their share of the kinetic energy."""
    results = []
    for t, head, f in physics.snapshots(folder):
        if abs(t - 15e-3) > 0.6e-3:
            continue
        x, V = physics.upright(head, f), physics.volumes(head, f)
        energy = V * (f["velocity"]**2).sum(axis=1)
        above = x[:, 2] > -1e-3
        label = physics.components(x[above], 2 * float(head["spacing"]), physics.sizes(head, f)[above])
        off = label > 0
        share = energy[above][off].sum() / energy.sum()
        volume = V[above][off].sum() / V[f["body"] == 1].sum()
        results = [physics.shown("secondary droplets of two particles and more at 15 ms",
                                 (np.bincount(label)[1:] > 1).sum()),
                   physics.shown("single particles come off at 15 ms", (np.bincount(label)[1:] == 1).sum()),
                   physics.shown("volume come off at 15 ms, of the drop's", 100 * volume, unit="%"),
                   physics.shown("kinetic energy come off at 15 ms, of all", 100 * share, unit="%")]
    return results


def check(folder):
    series = rundata.read_series(folder)
    speed = rundata.reference_speed(folder)
    reference = rundata.read_reference(speed)
    spacing = 1e3 * rundata.read_scene(folder)["domain"]["spacing"]  # mm
    fine, middle = bool(reference["time"]) and spacing < 0.2501, bool(reference["time"]) and spacing < 0.5001

    def judge(name, run, wanted, tolerance, unit, factor=1.0, judged=fine, make=physics.relative):
        if judged:
            return make(name, run / factor, wanted / factor, tolerance, unit)
        return physics.shown(name, run / factor, wanted / factor, unit)

    results = []
    if reference["time"]:
        depth, right = (curve(table, "crater_depth") for table in (series, reference))
        width, right_width = (curve(table, "crater_diameter") for table in (series, reference))
        others = {"in a pool with the area of the box": rundata.read_reference(speed, "_box")}
        if speed == 3.13:
            others["by another program"] = rundata.read_reference(speed, "_second")
        for name, worst, limit, judged in (
                ("D(t) 2 to 35 ms, largest error over the largest D", np.abs(depth - right).max() / right.max(),
                 5 if fine else 10, middle),
                ("phi(t) 2 to 35 ms, largest error", np.abs(width / right_width - 1).max(), 7, fine)):
            results.append(physics.at_most(name, 100 * worst, limit, "%") if judged else
                           physics.shown(name, 100 * worst, 0, "%"))
        for words, other in others.items():
            results.append(physics.shown(f"phi(t) beside the reference {words}",
                                         100 * np.abs(width / curve(other, "crater_diameter") - 1).max(), 0, "%"))
    for t in (5e-3, 10e-3, 15e-3, 20e-3):
        for name, column in (("D", "crater_depth"), ("phi", "crater_diameter")):
            results.append(physics.shown(f"{name} at {1e3 * t:g} ms", 1e3 * compare.at(series, column, t),
                                         1e3 * compare.at(reference, column, t), "mm"))
    crown, crown_time = compare.maximum(series, "crown_height", *compare.CROWN_SPAN)
    finest = rundata.read_reference(speed, "_fine")
    wanted = compare.maximum(finest, "crown_height", *compare.CROWN_SPAN)
    mean = compare.maximum(series, "crown_mean", *compare.CROWN_SPAN)
    results += [judge("H, largest", crown, wanted[0], 0.15, "mm", 1e-3),
                physics.shown("time of the largest H", 1e3 * crown_time, 1e3 * wanted[1], "ms"),
                physics.shown("H, mean over the azimuth, largest", 1e3 * mean[0], 1e3 * wanted[0], "mm"),
                physics.shown("its time", 1e3 * mean[1], 1e3 * wanted[1], "ms"),
                judge("D passes half its largest value", half(series), half(reference), 1.5, "ms", 1e-3,
                      make=physics.absolute),
                judge("jet passes the level", compare.jet_rise(series), compare.jet_rise(reference), 2.0, "ms", 1e-3,
                      make=physics.absolute)]
    if reference["time"]:
        for words, other in others.items():
            results += [physics.shown(f"half D, reference {words}", 1e3 * half(series), 1e3 * half(other), "ms"),
                        physics.shown(f"jet, reference {words}", 1e3 * compare.jet_rise(series),
                                      1e3 * compare.jet_rise(other), "ms")]
    for t in (5e-3, 10e-3, 15e-3):
        results.append(judge(f"kinetic energy at {1e3 * t:g} ms", compare.at(series, "kinetic_energy", t),
                             compare.at(reference, "kinetic_energy", t), 0.15, "uJ", 1e-6))
    results.append(physics.shown("jet height at 60 ms", 1e3 * compare.at(series, "jet_height", 60e-3),
                                 1e3 * compare.at(reference, "jet_height", 60e-3), "mm"))
    return results + drop_liquid(folder) + secondary(folder)


if __name__ == "__main__":
    physics.main(check)
