#!/usr/bin/python3
"""What each choice costs and what error it makes: runs a case over the axes of sweeps.py, one choice at a time.

    tradeoff.py --case CASE [--axis NAME ...] [--fresh] [--readme]     make tradeoff CASE=...

Any case of cases/ with a check.py. Writes output/tradeoff/<case>/: table.md, tradeoff.csv and chart.png (error
against CPU time, Pareto front, presets named). Runs that stand in tradeoff.csv with the same options are not repeated
unless --fresh says so. --readme puts the table of tradeoff.csv into the case's results.md and runs
nothing.

CPU time is that of the process. On a machine that others use it varies by factors, so before and after each run a
fixed small run is timed, and the table gives seconds of the machine at the quickest of these.
"""
import argparse
import csv
import math
import os
import resource
import shlex
import shutil
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "verify"), os.path.join(HERE, "..")]
import numpy as np  # noqa: E402
import cases  # noqa: E402
import chart  # noqa: E402
import runner  # noqa: E402
import runs  # noqa: E402
import sweeps  # noqa: E402

OUTPUT = os.path.join(runs.ROOT, "output", "tradeoff")
COLUMNS = ("axis", "label", "options", "error", "cpu", "yard", "steps", "iterations", "reason", "version")
YARD = "-options_file cases/taylor_green/case.opts -spacing 0.04 -packing_jitter 0.25 -time_end 0.6"
YARDS = []  # CPU seconds of it, in this sweep, and when
YARD_AGE = 20  # s after which it is timed again
TIMEOUT = 1800  # s
SCENE = ("scene", "as it is", "")


def cpu(options, folder):
    """(CPU seconds, exit code, last words) of a run."""
    shutil.rmtree(folder, ignore_errors=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    process = runs.start(shlex.split(options) + ["-output_dir", folder, "-progress_interval", "0"], timeout=TIMEOUT)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return seconds, process.returncode, runner.last_words(process) if process.returncode else ""


def yard():
    """CPU seconds of the small run: how quick the machine is just now."""
    if not YARDS or time.monotonic() - YARDS[-1][1] > YARD_AGE:
        YARDS.append((cpu(YARD, runs.scratch("yard"))[0], time.monotonic()))
    return YARDS[-1][0]


def deviation(result):
    """Relative deviation of a result, or the value itself of one that should vanish."""
    if result.kind in ("at most", "at least"):
        return abs(result.measured)
    return abs(result.measured / result.expected - 1)


def error_of(scene, results):
    """The error of a run, from the results of its case's check."""
    if scene.error:
        values = [deviation(r) for r in results if r.name in scene.error]
        if len(values) != len(scene.error):
            raise ValueError(f"the check has no {set(scene.error) - {r.name for r in results}}")
    else:
        values = [r.error() / r.tolerance for r in results if r.passed() is not None and r.kind != "at least"
                  and r.tolerance > 0]
    return math.sqrt(sum(v * v for v in values) / len(values)) if values else math.nan


def measure(case, scene, axis, label, options):
    """A row of the table."""
    folder = os.path.join(OUTPUT, case, "run")
    row = dict(axis=axis, label=label, options=options, error=math.nan, steps=0, iterations=math.nan, reason="",
               version=runner.version())
    first = yard()
    other = "printed.opts" in options
    line = options if axis == sweeps.DIMENSION else \
        f"-options_file cases/{case}/{scene.file} {scene.options} {'' if other else scene.lattice} {options}"
    row["cpu"], code, row["reason"] = cpu(line, folder)
    row["yard"] = (first + yard()) / 2
    if not code:
        try:
            series = runs.series(folder)
            row["steps"] = int(series["step"][-1])
            row["iterations"] = float(np.mean(series["iterations"][1:]))
            row["error"] = error_of(scene, runner.load(case)(folder))
        except Exception as error:  # a run that a check cannot judge is a row without error
            row["reason"] = f"check: {error}"[:80]
    print(f"{case}: {axis}, {label}: error {row['error']:.3g}, {row['cpu']:.3g} s, yard {row['yard']:.3g} s "
          f"{row['reason']}", flush=True)
    return row


def read(case):
    """The rows of tradeoff.csv; CPU seconds of the quickest machine seen go to 'seconds'."""
    try:
        with open(os.path.join(OUTPUT, case, "tradeoff.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except OSError:
        return []
    for row in rows:
        for name in ("error", "cpu", "yard", "iterations"):
            row[name] = float(row[name])
        row["steps"] = int(row["steps"])
    quickest = min((row["yard"] for row in rows), default=1)
    for row in rows:
        row["seconds"] = row["cpu"] * quickest / row["yard"]
    return rows


def write(case, rows):
    with open(os.path.join(OUTPUT, case, "tradeoff.csv"), "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)


def front(rows):
    """The rows no other beats in both error and time."""
    good = [r for r in rows if math.isfinite(r["error"])]
    return [r for r in good if not any(o["error"] <= r["error"] and o["seconds"] < r["seconds"] or
                                       o["error"] < r["error"] and o["seconds"] <= r["seconds"] for o in good)]


def text(case, scene, rows):
    """The table in markdown: error and CPU time of each choice, and both over those of the scene."""
    base = rows[0]
    best = front(rows)
    lines = []
    for row in rows:
        good = math.isfinite(row["error"])
        lines.append({"axis": row["axis"], "choice": row["label"], "options": f"`{row['options']}`" if row["options"]
                      else "", "error": f"{row['error']:.3g}" if good else row["reason"][:60],
                      "over the scene's": f"{row['error'] / base['error']:.2f}" if good else "-",
                      "CPU s": f"{row['seconds']:.3g}", "speed-up": f"{base['seconds'] / row['seconds']:.2f}",
                      "steps": row["steps"], "iterations": f"{row['iterations']:.3g}",
                      "Pareto": "*" if row in best else ""})
    columns = ["axis", "choice", "options", "error", "over the scene's", "CPU s", "speed-up", "steps", "iterations",
               "Pareto"]
    versions = ", ".join(sorted({row["version"] for row in rows}))
    line = " ".join(f"-options_file cases/{case}/{scene.file} {scene.options} {scene.lattice}".split())
    return (f"`{line}`, one choice changed at a time. Error: "
            f"{scene.words}.\n\n{runner.table(lines, columns)}\n\nWritten by `make tradeoff CASE={case}` at version "
            f"{versions}. *: no other run is both quicker and more accurate.")


def sweep(case, scene, only, fresh):
    folder = os.path.join(OUTPUT, case)
    os.makedirs(folder, exist_ok=True)
    known = {} if fresh else {(row["axis"], row["label"], row["options"]): row for row in read(case)}
    done = []

    def take(axis, label, options):
        row = known.pop((axis, label, options), None) or measure(case, scene, axis, label, options)
        done.append(row)
        write(case, done + list(known.values()))
        return row

    base = take(*SCENE)
    if base["reason"] or not math.isfinite(float(base["error"])):
        sys.exit(f"tradeoff.py: the scene itself has no error: {base['reason']}")
    folder_of_options = os.path.join(folder, "scene")
    if not os.path.isdir(folder_of_options):
        cpu(f"-options_file cases/{case}/{scene.file} {scene.options} {scene.lattice}", folder_of_options)
    with open(os.path.join(folder_of_options, "options.opts"), encoding="utf-8") as file:
        used = dict((line.split(None, 1) + [""])[:2] for line in file if line.startswith("-"))
    step = float(np.median(runs.series(folder_of_options)["time_step"][1:]))
    has = {word: any(name.endswith("_" + word) and float(value) > 0 for name, value in used.items())
           for word in ("tension", "viscosity")}
    viscous = has["viscosity"] or not any(name.endswith("_viscosity") for name in used)  # water is the default
    for axis, label, options in sweeps.axes(scene, float(used["-spacing"]), step, has["tension"], viscous):
        path = options.split("-options_file ")[-1].split()[0] if "-options_file" in options else ""
        if (not only or axis in only) and (not path or os.path.exists(os.path.join(runs.ROOT, path))):
            take(axis, label, options)
    if not only:
        write(case, done)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--case", required=True)
    parser.add_argument("--axis", action="append", default=[])
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("--readme", action="store_true")
    arguments = parser.parse_args()
    case = arguments.case
    entry = next((e for e in cases.ENTRIES if e.case == case), None)
    if not entry:
        sys.exit(f"tradeoff.py: CASE={case} is no case; there are {', '.join(sorted({e.case for e in cases.ENTRIES}))}")
    scene = sweeps.SCENES.get(case, sweeps.Scene(entry.options, file=entry.file, spacings=(2, 1.5)))
    if not arguments.readme:
        sweep(case, scene, arguments.axis, arguments.fresh)
    rows = read(case)
    if not rows:
        sys.exit(f"tradeoff.py: output/tradeoff/{case}/tradeoff.csv is missing; run make tradeoff CASE={case} first")
    table = text(case, scene, rows)
    if arguments.readme:
        runs.results(case, "tradeoff", table)
        return
    with open(os.path.join(OUTPUT, case, "table.md"), "w", encoding="utf-8") as file:
        file.write(table + "\n")
    chart.draw(rows, front(rows), f"{case}: {scene.words}", os.path.join(OUTPUT, case, "chart.png"))
    print(table)


if __name__ == "__main__":
    main()
