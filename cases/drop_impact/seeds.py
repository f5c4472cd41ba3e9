#!/usr/bin/python3
"""The main case from several random packings: what is a trend and what is chance.

    seeds.py [--rings] [--graded] [--speed 3.13 2.42] [--spacing 0.5 0.35] [--seeds 5] [--jobs 2] [--readme]

A quarter of the box; with --graded at 0.25 mm, with one spacing and with graded.opts (fine within 6 mm of the impact,
growing to four times as much). With --rings the impact as rings in pools of 22.5 and 40 mm radius, at 0.25 and 0.125
mm; with --rings --graded these rings within 9 mm of the impact only. Runs that output/drop_impact_seeds/ holds to their
end are not run again. Writes seeds.csv (mean and standard deviation of the curves) and curves_seeds.png beside this
file, their names with _rings, _graded or both, and prints a table; --readme puts it into results.md.
"""
import argparse
import csv
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

import compare
import rundata
from check import curve, half

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "..", "..")
sys.path.insert(0, os.path.join(ROOT, "tests"))
import runs  # noqa: E402

OUTPUT = os.path.join(ROOT, "output", "drop_impact_seeds")
FILES = {"3.13": "", "2.42": "-options_file cases/drop_impact/speed_242.opts"}
GRADED = "-options_file cases/drop_impact/graded.opts"
RINGS_GRADED = GRADED + " -core_radius 9e-3"
RATIO = 4  # of coarse and fine spacing
RING_FILES = {"3.13": "", "2.42": "-options_file cases/drop_impact/axisymmetric_242.opts"}
POOLS = {"22.5": "_box", "40": ""}  # mm: radius, and the kind of reference
END = 60e-3  # s
TIMES = np.arange(0, END + 1e-9, 0.5e-3)  # s: of seeds.csv
COLUMNS = ("crown_height", "crater_depth", "crater_diameter", "jet_height", "kinetic_energy")
LABELS = {"crown_height": "crown height H (mm)", "crater_depth": "crater depth D (mm)",
          "crater_diameter": "crater diameter $\\phi$ (mm)"}


class Group(NamedTuple):
    """Runs that are held against the same reference. pool: radius in mm, of rings; else empty."""
    speed: str
    pool: str = ""

    def title(self):
        return f"{self.speed} m/s" + (f", pool of {self.pool} mm" if self.pool else "")

    def reference(self):
        return rundata.read_reference(float(self.speed), POOLS.get(self.pool, ""))

    def finer_reference(self):
        """With finer cells, until about 36 ms; none in the narrow pool."""
        return rundata.read_reference(float(self.speed), "_fine") if self.pool == "40" else None

    def options(self, grid):
        """Of runs with this grid."""
        if not self.pool:
            return (f"-options_file cases/drop_impact/case.opts -options_file options/quarter.opts {FILES[self.speed]} "
                    f"{grid.options(GRADED)} -snapshot_interval 0")
        return (f"-options_file cases/drop_impact/axisymmetric.opts {RING_FILES[self.speed]} "
                f"{grid.options(RINGS_GRADED)} -box_upper {self.pool}e-3,30e-3 -film_upper {self.pool}e-3,0 "
                "-snapshot_interval 5e-3")

    def folder(self, grid, seed):
        parts = self.speed, self.pool, "graded" * grid.graded, grid.spacing, str(seed)
        return os.path.join(OUTPUT, "_".join(filter(None, parts)))


class Grid(NamedTuple):
    """The particles of a set of runs. spacing: mm, as it was typed."""
    spacing: str
    graded: bool = False

    def options(self, files):
        """files: those of a graded run."""
        if not self.graded:
            return f"-spacing {self.spacing}e-3"
        return f"{files} -spacing {self.spacing}e-3 -spacing_coarse {self.coarse():g}e-3"

    def coarse(self):
        return RATIO * float(self.spacing)

    def title(self):
        return f"{self.spacing} to {self.coarse():g} mm" if self.graded else f"{self.spacing} mm"


def finished(folder):
    try:
        return max(rundata.read_series(folder)["time"]) >= END - 1e-9
    except rundata.Error:
        return False


def run(group, grid, seed):
    """Runs one packing, unless its run is there."""
    folder = group.folder(grid, seed)
    if not finished(folder):
        options = f"{group.options(grid)} -packing_seed {seed} -checkpoint_interval 0"
        subprocess.run([runs.PROGRAM, *options.split(), "-output_dir", folder, "-output_overwrite",
                        "-progress_interval", "0"], cwd=ROOT, env=runs.environment(), check=True,
                       stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    print(folder, flush=True)
    return rundata.read_series(folder)


def on(table, name, times):
    """A column at these times; nan where it has no value."""
    samples = np.array(compare.pairs(table, name)).reshape(-1, 2)
    return np.interp(times, samples[:, 0], samples[:, 1], left=np.nan, right=np.nan) if len(samples) else times * np.nan


def errors(tables, reference):
    """Largest errors of crater depth and diameter from 2 to 35 ms, %, of the mean of these runs."""
    depth, width = (np.mean([curve(table, name) for table in tables], axis=0)
                    for name in ("crater_depth", "crater_diameter"))
    right, right_width = curve(reference, "crater_depth"), curve(reference, "crater_diameter")
    return 100 * np.abs(depth - right).max() / right.max(), 100 * np.abs(width / right_width - 1).max()


def figures_of(table, reference):
    """The numbers of one run that the table gives: {name: value}."""
    depth, width = errors([table], reference)
    crown = compare.maximum(table, "crown_height", *compare.CROWN_SPAN)
    return {"largest error of D, %": depth, "largest error of phi, %": width,
            **{f"D at {t} ms, mm": 1e3 * compare.at(table, "crater_depth", 1e-3 * t) for t in (5, 10, 15)},
            **{f"phi at {t} ms, mm": 1e3 * compare.at(table, "crater_diameter", 1e-3 * t) for t in (5, 10, 15)},
            "H, largest, mm": 1e3 * crown[0], "its time, ms": 1e3 * crown[1],
            **{f"kinetic energy at {t} ms, uJ": 1e6 * compare.at(table, "kinetic_energy", 1e-3 * t)
               for t in (2, 5, 10, 15)},
            "half depth, ms": 1e3 * half(table), "jet passes the level, ms": 1e3 * compare.jet_rise(table),
            "jet at 60 ms, mm": 1e3 * compare.at(table, "jet_height", END - 1e-9)}


def write_table(results):
    """Mean and standard deviation of every set of runs, beside the references."""
    text = ""
    for group in dict.fromkeys(group for group, _ in results):
        references = [table for table in (group.reference(), group.finer_reference()) if table]
        wanted = [figures_of(table, table) for table in references]
        runs_of = {grid: tables for (g, grid), tables in results.items() if g == group}
        sets = {grid: [figures_of(table, references[0]) for table in tables] for grid, tables in runs_of.items()}
        heads = [grid.title() for grid in sets] + ["reference", "with finer cells"][:len(references)]
        text += f"\n| {group.title()} | " + " | ".join(heads) + " |\n" + "|---" * (len(heads) + 1) + "|\n"
        for reference, words in zip(references, ("", ", finer cells")):
            for k, name in enumerate(("D", "phi")):
                cells = [f"{errors(tables, reference)[k]:.2g}" for tables in runs_of.values()] + [""] * len(references)
                text += f"| largest error of the mean of {name}, %{words} | " + " | ".join(cells) + " |\n"
        for name in wanted[0]:
            cells = []
            for rows in sets.values():
                values = [row[name] for row in rows]
                cells.append(f"{np.mean(values):.3g} +- {np.std(values, ddof=1):.2g}")
            cells += ["" if "error" in name or not np.isfinite(w[name]) else f"{w[name]:.3g}" for w in wanted]
            text += f"| {name} | " + " | ".join(cells) + " |\n"
    return text


def write_curves(results, path):
    with open(path, "w", encoding="utf-8", newline="") as file:
        file.write("# Mean and standard deviation over packing seeds of the drop impact; SI, but pool: its radius "
                   "in mm (empty: a quarter of the box), coarse: the coarse spacing (empty: one spacing); "
                   "by seeds.py\n")
        writer = csv.writer(file, lineterminator="\n")
        names = [f"{column}_{kind}" for column in COLUMNS for kind in ("mean", "spread")]
        writer.writerow(["speed", "pool", "spacing", "coarse", "time", *names])
        for (group, grid), tables in results.items():
            values = np.array([[on(table, c, TIMES) for c in COLUMNS] for table in tables])
            mean, spread = values.mean(axis=0), values.std(axis=0, ddof=1)
            for k, time in enumerate(TIMES):
                row = [f"{x:.5g}" for pair in zip(mean[:, k], spread[:, k]) for x in pair]
                coarse = f"{grid.coarse():g}e-3" if grid.graded else ""
                writer.writerow([group.speed, group.pool, f"{grid.spacing}e-3", coarse, f"{time:.5g}", *row])


def draw(results, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    groups = list(dict.fromkeys(group for group, _ in results))
    figure, axes = plt.subplots(3, len(groups), figsize=(6.2 * len(groups), 8.6), sharex=True, squeeze=False,
                                gridspec_kw=dict(hspace=0.08, wspace=0.16))
    for column, group in enumerate(groups):
        reference = group.reference()
        for row, (name, label) in enumerate(LABELS.items()):
            panel = axes[row][column]
            panel.plot(1e3 * TIMES, 1e3 * on(reference, name, TIMES), color="black", lw=1.6,
                       label="reference (axisymmetric VOF)")
            for k, ((_, grid), tables) in enumerate((key, t) for key, t in results.items() if key[0] == group):
                values = 1e3 * np.array([on(table, name, TIMES) for table in tables])
                mean, spread = values.mean(axis=0), values.std(axis=0, ddof=1)
                panel.plot(1e3 * TIMES, mean, color=f"C{k}", lw=1.6, label=f"{grid.title()}, {len(tables)} packings")
                panel.fill_between(1e3 * TIMES, mean - spread, mean + spread, color=f"C{k}", alpha=0.25, lw=0)
            panel.set(ylabel=label, ylim=(0, None), xlim=(0, 60))
            panel.grid(color="0.9", lw=0.8)
            panel.spines[["top", "right"]].set_visible(False)
        axes[0][column].set_title(group.title())
        axes[0][column].legend(frameon=False, fontsize=9)
        axes[-1][column].set_xlabel("time after contact (ms)")
    figure.savefig(path, dpi=110, bbox_inches="tight", pad_inches=0.06)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--speed", nargs="+", choices=FILES, default=list(FILES), help="m/s")
    parser.add_argument("--rings", action="store_true", help="as rings, in two pools")
    parser.add_argument("--graded", action="store_true", help="fine near the impact only")
    parser.add_argument("--spacing", nargs="+", metavar="MM", help="0.5 0.35; with --graded 0.25; of rings 0.25 0.125")
    parser.add_argument("--seeds", type=int, default=5, help="number of packings")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time")
    parser.add_argument("--readme", action="store_true", help="put the table into results.md")
    arguments = parser.parse_args()
    rings, graded = arguments.rings, arguments.graded
    spacings = arguments.spacing or (["0.25", "0.125"] if rings else ["0.25"] if graded else ["0.5", "0.35"])
    grids = [Grid(spacing, kind) for kind in ([graded] if rings else range(graded + 1)) for spacing in spacings]
    keys = [(Group(speed, pool), grid) for speed in arguments.speed for pool in (POOLS if rings else [""])
            for grid in grids]
    jobs = [(*key, seed) for key in keys for seed in range(1, arguments.seeds + 1)]
    with ThreadPoolExecutor(arguments.jobs) as pool:
        tables = list(pool.map(lambda job: run(*job), jobs))
    results = {key: [table for job, table in zip(jobs, tables) if job[:2] == key] for key in keys}
    kind = "_rings" * rings + "_graded" * graded
    write_curves(results, os.path.join(HERE, f"seeds{kind}.csv"))
    draw(results, os.path.join(HERE, f"curves_seeds{kind}.png"))
    text = write_table(results)
    print(text)
    if arguments.readme:
        runs.results("drop_impact", f"seeds{kind}", text)


if __name__ == "__main__":
    with rundata.polite("seeds.py"):
        main()
