#!/usr/bin/env python3
"""Speed of the step: sizes x ranks x states x preconditioners.

  bench.py [--size quick|full] [--out FOLDER]   runs; FOLDER/bench.csv, bench.png, bench.md
  bench.py --readme                             the tables of tests/bench/README.md from the last bench.csv

quick: 16 k and 128 k particles, some eight minutes of one core; full: 1 M too, some forty, of which the states, made
once, take half. The most telling runs come first; the table is written after each.
Times are processor time, all ranks summed, from -log_view with the clock of cputime.c: other work on the machine
lengthens them by a tenth or two, not more; a rank that waits computes nothing but counts."""
import argparse
import os
import re
import subprocess
from typing import NamedTuple

import report
import roofline
import states

ROOT = states.ROOT
SIZES = {"16k": 1.0e-3, "128k": 0.5e-3, "1M": 0.25e-3}
QUICK = ("16k", "128k")
RANKS = (1, 2)
SOLVERS = ("twolevel", "jacobi", "icc", "gamg", "hypre", "ml")
# What each preconditioner needs to be at its best on rows of 80 entries; icc exists on one rank, within blocks on more.
OPTIONS = {
    "icc": (["-pc_type", "icc"], ["-pc_type", "bjacobi", "-sub_pc_type", "icc"]),
    "hypre": (["-pc_type", "hypre", "-pc_hypre_boomeramg_strong_threshold", "0.5", "-pc_hypre_boomeramg_coarsen_type",
               "PMIS", "-pc_hypre_boomeramg_interp_type", "ext+i", "-pc_hypre_boomeramg_agg_nl", "1"],) * 2,
    "ml": (["-pc_type", "ml", "-pc_ml_Threshold", "0.02"],) * 2,
}
TOLERANCE = 1e-4
TIGHT = 1e-5  # of the runs that compare iterations over sizes
STEPS = {"16k": 20, "128k": 12, "1M": 10}
KEPT = {"twolevel": 10, "jacobi": 10}  # steps a preconditioner is kept; all others:
KEPT_DEAR = 50
EVENTS = ("Neighbors", "Surface", "Viscosity", "Tension", "Divergence", "Source", "Assemble", "Solve", "Gradient",
          "Shift", "Halo", "Migrate", "Guard")
# Bytes a step must move: a neighbour is a number and a factor, read by two loops over pairs (source and gradient) and
# written with a second factor of two bytes by the search; each product reads the number and the second factor. A vector
# of the solver is eight bytes a particle, some twelve pass in each iteration.
NEIGHBOURS = 80
PAIR_LOOPS, PAIR_BYTES, PRODUCT_BYTES, SEARCH_BYTES = 2, 8, 6, 10
VECTOR_BYTES = 12 * 8


def environment():
    """Of runs under Open MPI, also as root."""
    return {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
            "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMP_NUM_THREADS": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}


def built(folder, name, *flags):
    """The path of a small program or library of this folder."""
    program = os.path.join(folder, name)
    if not os.path.exists(program):
        source = os.path.join(ROOT, f"tests/bench/{name}.c")
        subprocess.run(["gcc", "-O3", "-march=native", *flags, "-o", program, source], check=True)
    return program


def triad(folder, processes):
    """Bytes a second of so many processes at once."""
    program = built(folder, "triad")
    running = [subprocess.Popen([program], stdout=subprocess.PIPE, text=True) for _ in range(processes)]
    return sum(float(p.communicate()[0]) for p in running)


class Steps(NamedTuple):
    """Some steps of a run. seconds: processor time of all ranks; memory: bytes; log: the text of -log_view."""
    number: int
    particles: int
    iterations: float
    seconds: float
    memory: int
    log: str

    def counts(self):
        """{event: (seconds, count)} in the stage of the steps, of one rank."""
        stage = [part for part in self.log.split("--- Event Stage") if "SphSolve" in part and "SphShift" in part][-1]
        return {name: (float(seconds), int(count))
                for name, count, seconds in re.findall(r"^(\w+)\s+(\d+) [\d.]+ ([\d.e+-]+)", stage, re.M)}

    def event(self, name):
        return self.counts().get(name, (0.0, 0))

    def events(self):
        """{event of isph: seconds}"""
        return {name: seconds for name, (seconds, _) in self.counts().items() if name.startswith("Sph")}


def execute(command, log):
    """Runs; returns the code, standard output and what the process and those that it waited for have used."""
    with open(log + ".out", "w+", encoding="utf-8") as out:
        process = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT, env=environment(), cwd=ROOT)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        return process.returncode, out.read(), usage


def take(folder, options, number, ranks=1, program=(os.path.join(ROOT, "isph"),)):
    """The Steps of a run of so many; None, and a sentence, if it fails. program: what 'env' is given to start it."""
    log = os.path.join(folder, "log.txt")
    clock = built(folder, "cputime", "-shared", "-fPIC")
    command = (["mpiexec", "-n", str(ranks)] if ranks > 1 else []) + [
        "env", f"LD_PRELOAD={clock}", *program, *options, "-time_end", "1", "-steps_max", str(number),
        "-output_dir", os.path.join(folder, "run"), "-output_overwrite", "-series_interval", "1", "-snapshot_interval",
        "1", "-checkpoint_interval", "1", "-log_view", ":" + log]
    code, out, usage = execute(command, log)
    found = re.search(r"(\d+) steps of (\d+) particles in .* and ([\d.]+) iterations a step", out)
    if code or not found:
        print(f"failed: {' '.join(command)}\n{out.strip()[-300:]}", flush=True)
        return None
    text = open(log, encoding="utf-8").read()
    total = float(re.search(r"^ \d+:\s+Steps: ([\d.e+-]+)", text, re.M).group(1))
    return Steps(int(found.group(1)), int(found.group(2)), float(found.group(3)), ranks * total,
                 1024 * ranks * usage.ru_maxrss, text)


def measure(folder, size, ranks, state, solver, tolerance):
    """One run: a row of the table."""
    start = states.make(os.path.join(ROOT, "isph"), os.path.join(folder, "states"), SIZES[size], state, environment())
    choice = OPTIONS.get(solver, (["-pc_type", solver],) * 2)[ranks > 1]
    bandwidth = triad(folder, ranks)
    run = take(folder, [*states.scene(os.path.join(folder, "states"), state), "-spacing", str(SIZES[size]), *choice,
                        "-ksp_rtol", str(tolerance), "-restart", start], STEPS[size], ranks)
    if not run:
        return None
    scale = 1e6 * ranks / run.particles
    setup, setups = run.event("PCSetUp")
    once = setup / max(setups, 1)
    amortised = once / KEPT.get(solver, KEPT_DEAR)
    step = scale * ((run.seconds / ranks - setup) / run.number + amortised)
    limit = (NEIGHBOURS * (SEARCH_BYTES + PAIR_BYTES * PAIR_LOOPS + PRODUCT_BYTES * (run.iterations + 1)) +
             VECTOR_BYTES * run.iterations)
    single, double = roofline.peak(built(folder, "peak"))
    row = {"size": size, "particles": run.particles, "ranks": ranks, "state": state, "solver": solver,
           "tolerance": tolerance, "iterations": run.iterations, "step": step, "setup": scale * once,
           "memory": run.memory / 1e6, "triad": bandwidth / 1e9, "single": single / 1e9, "double": double / 1e9,
           **roofline.count(start, SIZES[size]), "share": 1e6 * limit / bandwidth * ranks / step}
    for event in EVENTS:
        row[event] = scale * run.event("Sph" + event)[0] / run.number
    row["Solve"] += scale * (amortised - setup / run.number)
    print(f"{size:>4} {ranks} {state:>6} {solver:>8} {tolerance:g}: {run.iterations:.1f} iterations, {step:.2f} us, "
          f"set-up {row['setup']:.2f} us, {row['memory']:.0f} MB, triad {row['triad']:.1f} GB/s", flush=True)
    return row


def plan(size):
    """What to run: the own preconditioner and jacobi everywhere, on one rank to other tolerances too; the others on one
    rank, at 1 M in the splash only."""
    names = SIZES if size == "full" else QUICK
    for ranks in RANKS:
        for name in names:
            for state in states.STATES:
                yield name, ranks, state, "twolevel", TOLERANCE
                if ranks == 1:
                    yield name, ranks, state, "twolevel", TIGHT
    for name in names:
        for state in states.STATES:
            yield name, 1, state, "jacobi", TOLERANCE
    for name in names:
        for state in states.STATES if name != "1M" else ("splash",):
            for solver in SOLVERS[2:]:
                yield name, 1, state, solver, TOLERANCE
    for name in QUICK:
        for state in states.STATES:
            yield name, 1, state, "twolevel", 1e-3


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", default="quick", choices=("quick", "full"))
    parser.add_argument("--out", default=os.path.join(ROOT, "output/bench"))
    parser.add_argument("--only", default="", help="a text that the names of runs, as '128k 1 splash gamg', contain")
    parser.add_argument("--readme", action="store_true")
    arguments = parser.parse_args()
    table = os.path.join(arguments.out, "bench.csv")
    if arguments.readme:
        report.readme(table)
        return
    os.makedirs(os.path.join(arguments.out, "states"), exist_ok=True)
    rows = []
    for run in plan(arguments.size):
        if arguments.only not in " ".join(str(part) for part in run):
            continue
        row = measure(arguments.out, *run)
        if row:
            rows.append(row)
            report.save(table, rows)
    if not report.pick(rows, solver="twolevel", tolerance=TOLERANCE, ranks=1):
        return  # a choice of runs without what the tables start from
    report.chart(table, os.path.join(arguments.out, "bench.png"), EVENTS)
    report.markdown(table, os.path.join(arguments.out, "bench.md"))


if __name__ == "__main__":
    main()
