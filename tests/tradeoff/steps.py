#!/usr/bin/python3
"""What longer and shorter time steps cost and what error they make, over several packings.

    steps.py [--case NAME ...] [--cfl 0.12,0.2,...] [--packings 5]          make tradeoff-steps [CASE=...]

Each scene of SCENES runs with each -time_cfl, once a packing, and at a finer spacing with the default, which tells what
accuracy costs there: an error E times as large would have been had for E^-q of the work. So 'work at equal error' is
the processor time over the default's, times (error over the default's)^q. Runs of a packing follow each other, so that
a busy machine slows all choices alike. The share of the steps that the speed bounds is taken from the series: steps
other than what gravity, tension or viscosity, the smallest of them, allows (scene.json). Writes
output/tradeoff/steps.csv and .md.
"""
import argparse
import csv
import json
import math
import os
import statistics
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "verify"), os.path.join(HERE, "..")]
import numpy as np  # noqa: E402
import runner  # noqa: E402
import runs  # noqa: E402
import sweeps  # noqa: E402
import tradeoff  # noqa: E402

DEFAULT = "0.2"
CFLS = "0.12,0.2,0.25,0.3"  # 0.6, 1, 1.25 and 1.5 times the default; -displacement_max bounds steps at 0.31
FINER = 0.71  # of the spacing
DEAREST = 3  # q, where a finer spacing hardly helps: that of order one in a plane or as rings
NEAR = 0.02  # relative, of a step to the bound that sets it
IMPACT = sweeps.SCENES["drop_impact"].error
BESIDE = ("depth from 4 to 20 ms beside the reference, largest deviation over its largest",)
# (case, file, options, spacing, results that make the error); the last is the main case
SCENES = {
    "Taylor-Green, 50 x 50": ("taylor_green", "case.opts", "-packing_jitter 0.25", 0.02,
                              ("velocity error L1 at the end",)),
    "dam break, plane": ("dam_break", "case.opts", "", 2.8575e-3,
                         ("front beside the reference, largest relative deviation from T = 1.19 on",
                          "height beside the reference, largest deviation over 2 a")),
    "deep pool, rings 0.35 mm": ("deep_pool", "rings.opts", "", 0.35e-3, BESIDE),
    "drop on a wall, rings": ("dry_wall", "rings.opts", "-time_end 1.6e-3", 0.1e-3,
                              ("height from 0.25 to 1.5 ms beside the reference, largest deviation",)),
    "stretching drop, rings": ("stretching_drop", "rings.opts", "-packing_jitter 0.25", 0.05,
                               ("largest relative error of a and b at all times",)),
    "oscillating drop, plane": ("oscillating_drop", "circle.opts", "", 0.25e-3, ("period",)),
    "main case, rings 0.35 mm": ("drop_impact", "axisymmetric.opts", "-time_end 20.05e-3 -checkpoint_interval 0",
                                 0.35e-3, IMPACT)}


def bounded_by_speed(folder):
    """The share of the steps that no other bound sets, and the smallest of these bounds by name."""
    with open(os.path.join(folder, "scene.json"), encoding="utf-8") as file:
        bounds = json.load(file)["step"]
    others = {name: bounds[name] for name in ("force", "surface_tension", "viscosity") if bounds[name]}
    dt = np.asarray(runs.series(folder)["time_step"])[1:]
    least = min(others, key=others.get, default="")
    free = np.abs(dt / others[least] - 1) > NEAR if least else np.full(len(dt), True)
    return float(np.average(free, weights=1 / dt)), least


def measure(scene, cfl, factor, seed):
    """A row: error, steps and processor seconds of a run."""
    case, file, options, spacing, names = SCENES[scene]
    folder = os.path.join(tradeoff.OUTPUT, "steps")
    row = dict(scene=scene, cfl=cfl, factor=factor, packing=seed, error=math.nan, steps=0, speed=math.nan, least="")
    row["cpu"], code, row["reason"] = tradeoff.cpu(
        f"-options_file cases/{case}/{file} {options} -spacing {factor * spacing:.6g} -time_cfl {cfl} -packing_seed "
        f"{seed}", folder)
    if not code:
        row["steps"] = int(runs.series(folder)["step"][-1])
        row["speed"], row["least"] = bounded_by_speed(folder)
        row["error"] = tradeoff.error_of(sweeps.Scene(error=names), runner.load(case)(folder))
    print(" ".join(f"{v:.4g}" if isinstance(v, float) else str(v) for v in row.values()), flush=True)
    return row


def line(of, base, power):
    """The words of a choice: error, its spread, steps, processor time, work at equal error."""
    def mean(key, some):
        return statistics.mean(r[key] for r in some)
    if any(r["reason"] for r in of):
        return f"{sum(bool(r['reason']) for r in of)} of {len(of)} stop"
    error, work = mean("error", of) / mean("error", base), mean("cpu", of) / mean("cpu", base)
    spread = statistics.stdev(r["error"] for r in of) / mean("error", base)
    return f"{error:.2f} +- {spread:.2f}, {mean('steps', of) / mean('steps', base):.2f}, {work:.2f}, " \
        f"{work * error**power:.2f}"


def table(rows):
    """Markdown: a line a scene, a column a -time_cfl."""
    lines = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        of = [row for row in rows if row["scene"] == scene]
        base = [row for row in of if row["cfl"] == DEFAULT and row["factor"] == 1]
        fine = [row for row in of if row["factor"] != 1]
        error, cost = ([statistics.mean(r[key] for r in some) for some in (base, fine)] for key in ("error", "cpu"))
        power = math.log(cost[1] / cost[0]) / math.log(error[0] / error[1]) if error[1] < error[0] else math.inf
        power = min(power, DEAREST)
        words = {"scene": scene, "bound": f"speed in {100 * statistics.mean(r['speed'] for r in base):.0f} %, else "
                 f"{base[0]['least'].replace('_', ' ') or 'none'}",
                 "the default": f"{error[0]:.2g} +- {statistics.stdev(r['error'] for r in base):.1g}, {cost[0]:.2g} s",
                 "q": f"{power:.2g}"}
        for cfl in dict.fromkeys(row["cfl"] for row in of if row["cfl"] != DEFAULT):
            words[f"`-time_cfl {cfl}`"] = line([r for r in of if r["cfl"] == cfl], base, power)
        lines.append(words)
    return runner.table(lines, list(lines[0]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--case", default="", help="scenes whose name begins so")
    parser.add_argument("--cfl", default=CFLS)
    parser.add_argument("--packings", type=int, default=5)
    arguments = parser.parse_args()
    os.makedirs(tradeoff.OUTPUT, exist_ok=True)
    path, rows = os.path.join(tradeoff.OUTPUT, "steps.csv"), []
    for scene in (name for name in SCENES if name.startswith(arguments.case)):
        for seed in range(1, arguments.packings + 1):
            rows += [measure(scene, cfl, 1, seed) for cfl in arguments.cfl.split(",")]
            rows += [measure(scene, DEFAULT, FINER, seed)]
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, rows[0])
            writer.writeheader()
            writer.writerows(rows)
    words = table(rows)
    with open(os.path.join(tradeoff.OUTPUT, "steps.md"), "w", encoding="utf-8") as file:
        file.write(words + "\n")
    print(words)


if __name__ == "__main__":
    main()
