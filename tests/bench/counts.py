#!/usr/bin/python3
"""What a step says by MPI: messages, bytes and collectives of a rank, from 1 to 32 ranks with 20 000 particles each.

    counts.py [--ranks 1 2 4 8 16 32] [--readme]
    make bench-counts

Two runs of different length, of a film at rest that grows with the number of ranks, give what a step adds. Counts do
not depend on how many cores there are. --readme puts the table into tests/bench/README.md.
"""
import argparse
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "..")]
import mpi  # noqa: E402
import runs  # noqa: E402

SIDE = 27  # particles along an edge of a rank's share
GRIDS = {1: (1, 1, 1), 2: (2, 1, 1), 4: (2, 2, 1), 8: (2, 2, 2), 16: (4, 2, 2), 32: (4, 4, 2)}
STEPS = (4, 14)
SCENE = ("-dimension 3 -spacing 1e-3 -box_lower 0,0,0 -box_upper {0},{1},{3} -box_x periodic -box_y periodic -box_zmin "
         "wall -gravity 0,0,-9.81 -bodies film -film_upper {0},{1},{2} -film_viscosity 3.5e-3 -film_tension 0.07 "
         "-time_step 1e-5 -ksp_rtol 1e-4 -snapshot_interval 0 -series_interval 0 -checkpoint_interval 0 -time_end 1")


def counted(library, ranks, steps):
    """(most of a rank, mean of the ranks) of messages, bytes, collectives, and the iterations of a step."""
    sides = [SIDE * n * 1e-3 for n in GRIDS[ranks]]
    options = SCENE.format(*sides, sides[2] + 5e-3) + f" -steps_max {steps} -output_dir {runs.scratch('counted')}"
    file = runs.scratch("counts.txt")
    if os.path.exists(file):
        os.remove(file)
    command = ["mpiexec", "-n", str(ranks), "-x", f"LD_PRELOAD={library}", "-x", f"COUNTS={file}", runs.PROGRAM,
               *options.split(), "-output_overwrite"]
    done = subprocess.run(command, env=mpi.environment(max(2, ranks), ""), stdout=subprocess.PIPE, text=True,
                          check=True)
    words = done.stdout.split(" iterations a step")[0].split()
    with open(file, encoding="utf-8") as lines:
        return [float(word) for word in lines.read().split()], float(words[-1])


def table(ranks):
    library = runs.scratch("counts.so")
    subprocess.run(["mpicc", "-shared", "-fPIC", "-O1", "-o", library, os.path.join(HERE, "counts.c")], check=True)
    lines = ["| ranks | messages: most, mean | kB: most, mean | collectives | iterations |",
             "| --- | --- | --- | --- | --- |"]
    for count in ranks:
        (first, _), (last, iterations) = (counted(library, count, steps) for steps in STEPS)
        step = [(b - a) / (STEPS[1] - STEPS[0]) for a, b in zip(first, last)]
        lines.append(f"| {count} | {step[0]:.0f}, {step[1]:.0f} | {step[2] / 1e3:.0f}, {step[3] / 1e3:.0f} | "
                     f"{step[4]:.0f} | {iterations:.1f} |")
        print(lines[-1], flush=True)
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--ranks", type=int, nargs="+", default=sorted(GRIDS), choices=sorted(GRIDS))
    parser.add_argument("--readme", action="store_true")
    arguments = parser.parse_args()
    found = table(arguments.ranks)
    if arguments.readme:
        path = os.path.join(HERE, "README.md")
        with open(path, encoding="utf-8") as file:
            before, _, rest = file.read().partition("<!-- counts -->\n")
        with open(path, "w", encoding="utf-8") as file:
            file.write(f"{before}<!-- counts -->\n\n{found}\n\n<!-- /counts -->{rest.partition('<!-- /counts -->')[2]}")


if __name__ == "__main__":
    main()
