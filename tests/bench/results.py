#!/usr/bin/env python3
"""What a result costs: the whole drop impact at 3.13 m/s (60 ms), computed in different ways, each on one core: its
processor time, and its largest errors of depth and diameter from 2 to 35 ms beside the reference.

  results.py [--all | --only TEXT] [--out FOLDER]   FOLDER/results.csv; TEXT: part of the name of a way
  results.py --readme                               the table of tests/bench/README.md from the last results.csv

Runs the ways that take minutes; --all the others too, of which else it says how long they take. What FOLDER holds to
its end is not run again."""
import argparse
import os
import re
import sys

import bench
import report
import states

sys.path.insert(0, os.path.join(states.ROOT, "cases/drop_impact"))
import rundata  # noqa: E402
import seeds  # noqa: E402

SPEED, POOL = "3.13", "40"  # m/s; mm
RINGS, QUARTER = seeds.Group(SPEED, POOL), seeds.Group(SPEED)
COARSE = QUARTER.options(seeds.Grid("0.5"))
LIMITS = 5, 8  # %, of the errors of depth and diameter
# Options, and minutes of one core.
WAYS = {
    "rings, 0.25 mm": (RINGS.options(seeds.Grid("0.25")), 0.3),
    "rings, 0.25 mm within 9 mm, to 1 mm": (RINGS.options(seeds.Grid("0.25", True)), 0.1),
    "rings, 0.125 mm within 9 mm, to 0.5 mm": (RINGS.options(seeds.Grid("0.125", True)), 0.5),
    "quarter, 0.25 mm near the impact, to 1 mm": (QUARTER.options(seeds.Grid("0.25", True)), 3),
    "quarter, 0.35 mm": (QUARTER.options(seeds.Grid("0.35")), 4),
    "quarter, 0.5 mm, as printed": (f"{COARSE} -options_file options/printed.opts", 5),
    "quarter, 0.5 mm, weakly compressible": (f"{COARSE} -scheme weakly_compressible", 15),
}
SHORT = 3  # minutes: a way that takes no longer is run


def cost(folder):
    """Particles and processor seconds of a finished run, from the file that 'run' leaves in it."""
    return report.load(os.path.join(folder, "cost.csv"))[0]


def run(folder, options):
    """Runs the impact, unless its run is there."""
    if seeds.finished(folder) and os.path.exists(os.path.join(folder, "cost.csv")):
        return
    os.makedirs(folder, exist_ok=True)
    code, out, usage = bench.execute([os.path.join(states.ROOT, "isph"), *options.split(), "-checkpoint_interval", "0",
                                      "-output_dir", folder, "-output_overwrite", "-progress_interval", "0"],
                                     folder)
    found = re.search(r"^Particles: (\d+)", out, re.M)
    if code or not found:
        sys.exit(f"{folder}: failed: {out.strip()[-300:]}")
    report.save(os.path.join(folder, "cost.csv"), [{"particles": int(found.group(1)),
                                                    "seconds": usage.ru_utime + usage.ru_stime}])


def row_of(way, folder):
    series = rundata.read_series(folder)
    depth, width = seeds.errors([series], rundata.read_reference(rundata.reference_speed(folder)))
    return {"way": way, **cost(folder), "depth": depth, "width": width}


def text(path):
    titles = ("way", "particles", "processor time", "error of D", "error of phi",
              f"within {LIMITS[0]} and {LIMITS[1]} %?")
    return "\n".join(report.grid(titles, [
        (row["way"], f"{row['particles']:.0f}", f"{row['seconds']:.0f} s", f"{row['depth']:.1f} %",
         f"{row['width']:.1f} %", "yes" if row["depth"] <= LIMITS[0] and row["width"] <= LIMITS[1] else "no")
        for row in report.load(path)])) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default=os.path.join(states.ROOT, "output/bench_results"))
    parser.add_argument("--only", default="")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--readme", action="store_true")
    arguments = parser.parse_args()
    table = os.path.join(arguments.out, "results.csv")
    if arguments.readme:
        report.insert("results", text(table))
        return
    rows = []
    for way, (options, minutes) in WAYS.items():
        folder = os.path.join(arguments.out, re.sub(r"\W+", "_", way))
        if arguments.only in way and (arguments.all or arguments.only or minutes <= SHORT):
            run(folder, options)
        if os.path.exists(os.path.join(folder, "cost.csv")):
            rows.append(row_of(way, folder))
            report.save(table, rows)
        else:
            print(f"{way}: not run, some {minutes:g} minutes", flush=True)
    print(text(table))


if __name__ == "__main__":
    with rundata.polite("results.py"):
        main()
