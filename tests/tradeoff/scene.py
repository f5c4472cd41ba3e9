#!/usr/bin/python3
"""What each choice costs and what error it makes in a scene of one's own, and which one to take.

    scene.py SCENE.opts --gauges COLUMN[,COLUMN ...] [--budget 600] [--target 5] [--ways OTHER.opts ...]
    make tradeoff SCENE=SCENE.opts GAUGES=COLUMN,... [BUDGET=600] [TARGET=5] [WAYS="OTHER.opts ..."]

The gauges are columns of series.csv. There is no exact solution: the yardstick of a gauge is what its curves tend to as
the spacing goes to zero (Richardson), from the three finest runs that the budget (CPU seconds) allows. Runs at the
scene's spacing from other packings tell what is chance. WAYS are options files that compute the same scene in another
way, as rings or as a quarter. Writes output/tradeoff/<folder>_<file>/: table.md, chart.png and
advice.opts, the cheapest choice whose gauges are all within the target (per cent).
"""
import argparse
import math
import os
import re
import shlex
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "verify"), os.path.join(HERE, "..")]
import numpy as np  # noqa: E402
import chart  # noqa: E402
import runner  # noqa: E402
import runs  # noqa: E402
import tradeoff  # noqa: E402

LADDER = (2 * 2**0.5, 2, 2**0.5, 1, 0.5**0.5, 0.5)  # factors on the scene's spacing, coarse to fine
SHARE = 0.6  # of the budget, for them
GROWTH = 4.5  # a finer run costs the factor on the spacing to this power, until two runs tell
ORDERS = (0.5, 2)  # of convergence that are believed
LEVELS = (10, 5, 2)  # per cent, of the advice
SAMPLES = 200  # times at which curves are compared
CHOICES = (("preset", "fast", "-options_file options/fast.opts"),
           ("preset", "accurate", "-options_file options/accurate.opts"),
           ("time step", "CFL 0.3", "-time_cfl 0.3"), ("time step", "CFL 0.1", "-time_cfl 0.1"),
           ("tolerance", "rtol 0.3", "-ksp_rtol 0.3"), ("kernel", "h/d0 1.2", "-kernel_ratio 1.2"))
SEEDS = (2, 3)


class Sweep:
    """The runs of a scene. rows: dict(axis, label, options, factor, cpu, seconds, steps, curves, reason)."""

    def __init__(self, scene, gauges, budget):
        self.scene, self.gauges, self.budget = scene, gauges, budget
        self.rows, self.spent, self.times = [], 0.0, None
        words = os.path.splitext(os.path.abspath(scene))[0].split(os.sep)
        self.folder = os.path.join(tradeoff.OUTPUT, "_".join(words[-2:]))
        os.makedirs(self.folder, exist_ok=True)

    def spacing(self):
        """The scene's own spacing (m), from what -dump_options writes; the program's sentence ends us if it refuses."""
        path = os.path.join(self.folder, "dump.opts")
        process = runs.start(["-options_file", self.scene, "-dump_options", path])
        if process.returncode:
            sys.exit(f"scene.py: {runner.last_words(process)}")
        with open(path, encoding="utf-8") as file:
            return next(float(line.split()[1]) for line in file if line.startswith("-spacing "))

    def measure(self, axis, label, options, factor=1.0, scene=None):
        """Runs it and appends its row."""
        folder = os.path.join(self.folder, "run")
        row = dict(axis=axis, label=label, options=options, scene=scene or self.scene, factor=factor, steps=0,
                   curves=None, reason="")
        first = tradeoff.yard()
        line = f"-options_file {shlex.quote(row['scene'])} {options} -snapshot_interval 0 -checkpoint_interval 0 " \
            "-output_overwrite"
        try:
            row["cpu"], code, row["reason"] = tradeoff.cpu(line, folder)
        except subprocess.TimeoutExpired:
            code, row["cpu"], row["reason"] = 1, tradeoff.TIMEOUT, f"not done after {tradeoff.TIMEOUT} s"
        row["yard"] = (first + tradeoff.yard()) / 2
        self.spent += row["cpu"]
        if not code:
            self.read(row, runs.series(folder))
        self.rows.append(row)
        print(f"{axis}, {label}: {row['cpu']:.3g} s {row['reason']}", flush=True)
        return row

    def read(self, row, series):
        """The gauges' curves of a run, at the same times for all runs."""
        missing = [name for name in self.gauges if name not in series.dtype.names]
        if missing:
            sys.exit(f"scene.py: the series of {row['scene']} has no column {missing[0]}; there are: "
                     f"{', '.join(series.dtype.names)}")
        if self.times is None:
            self.times = np.linspace(series["time"][0], series["time"][-1], SAMPLES)
        row["steps"] = int(series["step"][-1])
        row["curves"] = [np.interp(self.times, series["time"], series[name]) for name in self.gauges]

    def ladder(self, spacing):
        """Coarse to fine, as far as the budget goes; returns the rows that ran."""
        good, growth = [], GROWTH
        for factor in LADDER:
            if good:
                guess = good[-1]["cpu"] * (good[-1]["factor"] / factor)**growth
                if self.spent + guess > SHARE * self.budget:
                    print(f"spacing, {factor:.3g} d0: some {guess:.0f} s, more than the budget leaves")
                    break
            options = "" if factor == 1 else f"-spacing {factor * spacing:.6g}"
            row = self.measure("scene" if factor == 1 else "spacing", f"{factor:.3g} d0", options, factor)
            if row["curves"]:
                good.append(row)
            if len(good) > 1:
                finer = good[-2]["factor"] / good[-1]["factor"]
                growth = min(max(math.log(good[-1]["cpu"] / good[-2]["cpu"]) / math.log(finer), 2), 6)
        if len(good) < 2:
            sys.exit(f"scene.py: fewer than two spacings ran within {self.budget:g} s of CPU time; give a larger "
                     f"budget, a shorter scene, or mend it: {self.rows[-1]['reason'] or 'it is too large'}")
        return good


def rms(values):
    values = values[np.isfinite(values)]
    return math.sqrt((values**2).mean()) if len(values) else math.nan


def yardstick(curves, factors):
    """(curve, order or nan, rms of what was added to the finest): Richardson's estimate from the three finest curves,
    or the finest itself where they do not converge."""
    finest = curves[-1]
    if len(curves) < 3:
        return finest, math.nan, rms(curves[-2] - finest)
    ratio = factors[-2] / factors[-1]
    before, last = rms(curves[-3] - curves[-2]), rms(curves[-2] - finest)
    order = math.log(before / last) / math.log(ratio) if before > 0 and last > 0 else math.nan
    if not order >= ORDERS[0]:
        return finest, math.nan, last
    order = min(order, ORDERS[1])
    added = (finest - curves[-2]) / (ratio**order - 1)
    return finest + added, order, rms(added)


def deviation(curve, right):
    """Rms of the deviation in per cent of the largest value; infinite where most of the values are missing."""
    known = np.isfinite(right)
    both = known & np.isfinite(curve)
    if both.sum() < 0.5 * known.sum():
        return math.inf
    return 100 * rms((curve - right)[both]) / np.abs(right[known]).max()


def name_of(row):
    """A choice in words."""
    words = {"scene": "the scene as it is", "spacing": f"`{row['options']}`", "way": f"`{row['scene']}`"}
    return words.get(row["axis"], f"`{row['options']}`")


def advise(rows, gauges, target, notes):
    """(lines of advice, the row for the target)."""
    judged = [row for row in rows if row["curves"] and row["axis"] != "seed"]
    lines = []
    for g, gauge in enumerate(gauges):
        takes, parts, floor = [], [], notes[g]["floor"]
        for level in LEVELS:
            fit = [row for row in judged if row["errors"][g] <= level]
            best = min(fit, key=lambda row: row["seconds"], default=None)
            if takes and best is takes[-1][1]:
                takes.pop()  # one that does for less does here too
            if best:
                takes.append((level, best))
        for level, best in takes:
            parts.append(f"for {level} % take {name_of(best)}, {best['seconds']:.3g} s")
        best = min(judged, key=lambda row: row["errors"][g])
        if best["errors"][g] > LEVELS[-1]:
            parts.append(f"better than {best['errors'][g]:.2g} % none of these is ({name_of(best)}, "
                         f"{best['seconds']:.3g} s)")
        lines.append(f"- {gauge}: {'; '.join(parts)}. {notes[g]['words']} Differences below {floor:.2g} % mean "
                     "nothing.")
    fit = [row for row in judged if max(row["errors"]) <= target]
    choice = min(fit, key=lambda row: row["seconds"]) if fit else min(judged, key=lambda row: max(row["errors"]))
    return lines, choice


def quoted(path):
    """A path as a word of an options file, which has two kinds of quotes and no other way to write one."""
    mark = "'" if '"' in path else '"'
    return f"{mark}{path}{mark}" if re.search(r"[\s'\"]", path) else path


def write_options(path, choice, gauges, target):
    worst = max(choice["errors"])
    head = f"within {target:g} %" if worst <= target else f"{worst:.2g} %, the best of all (asked: {target:g} %)"
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"# {', '.join(gauges)}: {head}; {choice['seconds']:.3g} s of CPU time. Written by make tradeoff.\n"
                   f"-options_file {quoted(choice['scene'])}\n")
        option = re.sub(r" (?=-[a-z])", "\n", choice["options"])  # one a line
        file.write(f"{option}\n" if option else "")


def refuse_nonsense(arguments):
    """Ends us with a sentence for what no sweep can do, before anything runs."""
    for name, value in (("BUDGET", arguments.budget), ("TARGET", arguments.target)):
        if not 0 < value < math.inf:
            sys.exit(f"scene.py: {name}={value:g}: a positive number is wanted, of "
                     f"{'CPU seconds' if name == 'BUDGET' else 'per cent'}")
    for path in arguments.ways:
        if not os.path.isfile(path):
            sys.exit(f"scene.py: WAYS: {path} is no file; options files are wanted, separated by blanks")
    if not all(arguments.gauges.split(",")):
        sys.exit(f"scene.py: GAUGES={arguments.gauges}: columns of series.csv are wanted, separated by commas")
    if "'" in arguments.scene and '"' in arguments.scene:
        sys.exit(f"scene.py: SCENE={arguments.scene}: a path with both kinds of quotes cannot stand in an options file")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("scene", metavar="SCENE.opts")
    parser.add_argument("--gauges", required=True, help="columns of series.csv, separated by commas")
    parser.add_argument("--budget", type=float, default=600, help="CPU seconds for all runs")
    parser.add_argument("--target", type=float, default=5, help="per cent, of advice.opts")
    parser.add_argument("--ways", nargs="*", default=[], metavar="OTHER.opts", help="the same scene in other ways")
    arguments = parser.parse_args()
    refuse_nonsense(arguments)
    sweep = Sweep(arguments.scene, arguments.gauges.split(","), arguments.budget)
    good = sweep.ladder(sweep.spacing())
    base = min(good, key=lambda row: abs(row["factor"] - 1))
    here = [("way", os.path.basename(path), "", path) for path in arguments.ways]
    here += [(axis, label, f"{base['options']} {options}".strip(), None) for axis, label, options in
             [("seed", str(seed), f"-packing_seed {seed}") for seed in SEEDS] + list(CHOICES)]
    for axis, label, options, scene in here:
        if axis != "way" and sweep.spent + base["cpu"] > sweep.budget:
            print(f"{axis}, {label}: the budget is spent")
            continue
        sweep.measure(axis, label, options, base["factor"], scene)
    report(sweep, good, base, arguments.target)


def report(sweep, good, base, target):
    """Errors against the yardsticks; table, chart and advice."""
    rights, notes = [], []
    seeds = [row for row in sweep.rows if row["axis"] == "seed" and row["curves"]]
    for g in range(len(sweep.gauges)):
        right, order, added = yardstick([row["curves"][g] for row in good], [row["factor"] for row in good])
        if not np.isfinite(right).any() or not np.nanmax(np.abs(right)) > 0:
            sys.exit(f"scene.py: {sweep.gauges[g]} has no values but zero in the finest run")
        sure = 100 * added / np.nanmax(np.abs(right))
        chance = max((deviation(row["curves"][g], base["curves"][g]) for row in seeds), default=math.nan)
        rights.append(right)
        words = (f"The yardstick converges with order {order:.2g} and is {sure:.2g} % from the finest run." if
                 math.isfinite(order) else f"The yardstick is the finest run, {sure:.2g} % from the one before it: the "
                 "runs do not converge further.")
        if math.isfinite(chance):
            words += f" Another packing changes it by {chance:.2g} %."
        notes.append({"floor": max(sure, chance) if math.isfinite(chance) else sure, "words": words})
    quickest = min(row["yard"] for row in sweep.rows)
    for row in sweep.rows:
        row["seconds"] = row["cpu"] * quickest / row["yard"]
        row["errors"] = [deviation(c, r) for c, r in zip(row["curves"], rights)] if row["curves"] else \
            [math.nan] * len(rights)
        row["error"] = max(row["errors"]) / 100
    lines = [{"axis": row["axis"], "choice": row["label"], "options": f"`{row['options']}`" if row["options"] else "",
              **{f"{name}, %": f"{e:.2g}" for name, e in zip(sweep.gauges, row["errors"])},
              "CPU s": f"{row['seconds']:.3g}", "steps": row["steps"], "": row["reason"][:80]} for row in sweep.rows]
    advice, choice = advise(sweep.rows, sweep.gauges, target, notes)
    text = (runner.table(lines, list(lines[0])) + "\n\nError: rms over time of the deviation from the yardstick, over "
            "its largest value.\n\n" + "\n".join(advice) + "\n")
    with open(os.path.join(sweep.folder, "table.md"), "w", encoding="utf-8") as file:
        file.write(text)
    write_options(os.path.join(sweep.folder, "advice.opts"), choice, sweep.gauges, target)
    drawn = [row for row in sweep.rows if row["axis"] != "seed"]
    title = f"{sweep.scene}: {', '.join(sweep.gauges)}, the worst of them".replace("$", r"\$")  # no formula
    chart.draw(drawn, tradeoff.front(drawn), title, os.path.join(sweep.folder, "chart.png"))
    print(f"\n{text}\nTake {os.path.relpath(sweep.folder, runs.ROOT)}/advice.opts: {name_of(choice)}, "
          f"{100 * choice['error']:.2g} %, {choice['seconds']:.3g} s.")


if __name__ == "__main__":
    main()
