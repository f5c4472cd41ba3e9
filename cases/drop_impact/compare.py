#!/usr/bin/python3
"""Compares a run of the drop impact with the reference: crater, crown, kinetic energy and jet, deviations in percent.
The crown is the mean over the azimuth, beside the reference with the finest cells; the jet is beside the reference
whose pool has the area of the run's.

    compare.py RUN_FOLDER [--json]
"""
import argparse
import json
import math
import sys

import rundata

CRATER_TIMES = (5e-3, 10e-3, 15e-3, 20e-3, 30e-3)  # s
ENERGY_TIMES = (2e-3, 5e-3, 6e-3, 10e-3, 15e-3)  # s
JET_TIMES = (55e-3, 60e-3)  # s
JET_SPAN = 3e-3  # s, before drops leave its tip: the jet's speed is the mean over this time after it passes the level
CONTACT = 1e-3  # s: before it the gauges see the drop itself
CROWN_SPAN = (2e-3, 40e-3)  # s: after the drop's top, before the jet
GROWING = 1e-3  # s: a maximum this close to the end of a series is none yet
MILLI, MICRO = (1e-3, "mm"), (1e-6, "uJ")
SECONDS, SPEED = (1e-3, "ms"), (1.0, "m/s")


def pairs(table, name):
    """The finite samples [(time, value)] of a column, in order of time."""
    if name not in table:
        return []
    return sorted((t, v) for t, v in zip(table["time"], table[name]) if math.isfinite(t) and math.isfinite(v))


def at(table, name, time):
    """The value at a time, between the samples on both sides; NaN outside the series."""
    before = None
    for t, v in pairs(table, name):
        if t >= time - 1e-9:
            if abs(t - time) <= 1e-9:
                return v
            return math.nan if before is None else before[1] + (v - before[1]) * (time - before[0]) / (t - before[0])
        before = (t, v)
    return math.nan


def maximum(table, name, first, last):
    """(value, time) of the largest sample with first <= time <= last (s); NaN if there is none or if it still grows at
    the end of the series."""
    samples = pairs(table, name)
    value, time = max(((v, t) for t, v in samples if first <= t <= last), default=(math.nan, math.nan))
    if samples and samples[-1][0] < time + GROWING:
        return math.nan, math.nan
    return value, time


def jet_rise(table):
    """Time (s) at which the surface on the axis comes up through the level after the crater was deepest; NaN if it has
    not. A sample without a value counts as below: a gauge may have nothing to measure while the crater is open."""
    _, start = maximum(table, "crater_depth", CONTACT, math.inf)
    before = None
    for t, v in zip(table["time"], table.get("jet_height", [])):
        if t < start or math.isnan(start):
            continue
        if not v > 0:
            before = (t, v if v < 0 else 0.0)
        elif before:
            return before[0] - before[1] * (t - before[0]) / (v - before[1])
    return math.nan


def quantities(table):
    """What is compared: [(name, factor and unit, value)]."""
    rows = [(f"D at {t * 1e3:g} ms", MILLI, at(table, "crater_depth", t)) for t in CRATER_TIMES]
    depth, depth_time = maximum(table, "crater_depth", CONTACT, math.inf)
    rows += [("D max", MILLI, depth), ("time of D max", SECONDS, depth_time)]
    rows += [(f"phi at {t * 1e3:g} ms", MILLI, at(table, "crater_diameter", t)) for t in CRATER_TIMES]
    crown, crown_time = maximum(table, "crown_mean" if "crown_mean" in table else "crown_height", *CROWN_SPAN)
    rows += [("H max", MILLI, crown), ("time of H max", SECONDS, crown_time)]
    rows += [(f"E kin at {t * 1e3:g} ms", MICRO, at(table, "kinetic_energy", t)) for t in ENERGY_TIMES]
    rise = jet_rise(table)
    speed = at(table, "jet_height", rise + JET_SPAN) / JET_SPAN if math.isfinite(rise) else math.nan
    rows += [("jet passes the level", SECONDS, rise)]
    rows += [(f"jet at {t * 1e3:g} ms", MILLI, at(table, "jet_height", t)) for t in JET_TIMES]
    rows += [("jet speed, mean of 3 ms", SPEED, speed)]
    return rows


def expected(folder, speed):
    """What the references say of the same."""
    kinds = {"H": "_fine", "time of H": "_fine", "jet": rundata.pool(folder)}  # the first words of a name; others: ""
    tables = {kind: quantities(rundata.read_reference(speed, kind)) for kind in {"", *kinds.values()}}
    return [tables[next((kind for word, kind in kinds.items() if name.startswith(word)), "")][k]
            for k, (name, _, _) in enumerate(tables[""])]


def deviation(run, reference):
    """In percent; NaN where it says nothing."""
    return 100 * (run - reference) / abs(reference) if reference else math.nan


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", metavar="RUN_FOLDER", help="the folder of a run, with its series.csv")
    parser.add_argument("--json", action="store_true", help="print JSON, SI units, null where there is no value")
    arguments = parser.parse_args()

    series = rundata.read_series(arguments.folder)
    speed = rundata.reference_speed(arguments.folder)
    rows = [(name, unit, run, wanted, deviation(run, wanted))
            for (name, unit, run), (_, _, wanted) in zip(quantities(series), expected(arguments.folder, speed))]
    if arguments.json:
        plain = [dict(name=name, unit="J" if unit is MICRO else {"mm": "m", "ms": "s"}.get(unit[1], unit[1]),
                      run=None if math.isnan(run) else run, reference=None if math.isnan(wanted) else wanted,
                      deviation_percent=None if math.isnan(percent) else percent)
                 for name, unit, run, wanted, percent in rows]
        print(json.dumps(dict(run=arguments.folder, end_time=max(series["time"]), quantities=plain), indent=1))
        return
    if speed is None:
        known = " and ".join(f"{v} m/s" for v in rundata.REFERENCES)
        print(f"There are references for {known}; this run has another speed and stands alone.")
    print(f"{'':24}{'run':>10}{'reference':>12}{'deviation':>12}")
    for name, (factor, unit), run, wanted, percent in rows:
        words = ["-" if math.isnan(x) else f"{x / factor:.2f}" for x in (run, wanted)]
        last = "-" if math.isnan(percent) else f"{percent:+.1f} %"
        print(f"{name:24}{words[0]:>10}{words[1]:>12}{last:>12}  {unit}")


if __name__ == "__main__":
    try:
        main()
    except rundata.Error as error:
        sys.exit(f"compare.py: {error}")
    except BrokenPipeError:
        sys.exit(1)
