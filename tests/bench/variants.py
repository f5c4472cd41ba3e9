#!/usr/bin/env python3
"""Speed of the step in other scenes and with other builds: on the same state the native program and the others take
the same steps in turn, on one core.

  variants.py [--only TEXT] [--out FOLDER]   FOLDER/variants.csv; TEXT: part of the name of a scene
  variants.py --readme                       the table of tests/bench/README.md from the last variants.csv

The builds, made once into FOLDER/builds, take some six minutes of one core, the states of the scenes, made once too,
two, and the steps five."""
import argparse
import os
import platform
import statistics
import subprocess
import sys

import bench
import report
import states

CASES = os.path.join(states.ROOT, "cases")
IMPACT = ["-options_file", states.CASE, *states.QUARTER]
RINGS = ["-options_file", os.path.join(CASES, "drop_impact/axisymmetric.opts")]
GRADED = ["-options_file", os.path.join(CASES, "drop_impact/graded.opts")]
# Options, moment (s) from which on steps are taken, and how many: some seconds of one core.
SCENES = {
    "impact, quarter, 0.5 mm": ([*IMPACT, "-spacing", "0.5e-3"], "5e-3", 40),
    "impact, graded quarter, 0.25 to 1 mm": ([*IMPACT, *GRADED], "5e-3", 60),
    "impact, rings, 0.125 mm": ([*RINGS, "-spacing", "0.125e-3"], "15e-3", 100),
    "impact, graded rings, 0.125 to 0.5 mm": ([*RINGS, *GRADED, "-core_radius", "9e-3", "-spacing", "0.125e-3",
                                               "-spacing_coarse", "0.5e-3"], "15e-3", 300),
    "dam break, 2-d, 0.7 mm": (["-options_file", os.path.join(CASES, "dam_break/case.opts"), "-spacing", "0.7e-3"],
                               "0.1", 150),
}
TURNS = 5
LOADER = "/lib64/ld-linux-x86-64.so.2"  # of x86-64: can be told to pass over what the portable program has for better


def made(folder, name, *flags):
    """The program that make makes with these flags in a folder of its own, if it is not up to date."""
    place = os.path.join(folder, "builds", name)
    program = os.path.join(place, "isph")
    print(f"build {name}", flush=True)
    subprocess.run(["make", "-s", *flags, f"BUILD={os.path.relpath(place, states.ROOT)}", f"PROGRAM={program}",
                    program], cwd=states.ROOT, check=True, stdout=subprocess.DEVNULL)
    return program


def builds(folder):
    """{name: command}, the native one first; behind 'env'. Each name has the code that the program says it takes."""
    commands = {"native": [os.path.join(states.ROOT, "isph")]}
    if platform.machine() == "x86_64":
        commands["built for AVX2"] = [made(folder, "avx2", "ARCH=-march=x86-64-v3")]
        library = "LD_LIBRARY_PATH=" + os.path.join(folder, "builds/portable/lib")
        portable = made(folder, "portable", "PORTABLE=1")
        commands["`PORTABLE=1`"] = [library, portable]
        commands["the same, held to the oldest"] = [library, LOADER, "--glibc-hwcaps-mask", "x86-64-v1", portable]
    names = {}
    for name, command in commands.items():
        version = subprocess.run(["env", *command, "--version"], check=True, stdout=subprocess.PIPE, text=True).stdout
        names[f"{name} ({version.split('code for ')[1].strip()})"] = command
    return names


def start(folder, scene, program):
    """The checkpoint from which a scene's steps are taken; made once."""
    options, moment, _ = SCENES[scene]
    path = os.path.join(folder, "states", "_".join(scene.replace(",", "").split()) + ".h5")
    if not os.path.exists(path):
        states.reach(program, [*options, "-time_end", moment, "-checkpoint_interval", "1"], path, bench.environment())
    return path


def measure(folder, scene, programs):
    """A row of the table: us a particle and step of the native program, and how many times that the others take, the
    median of some turns."""
    options, _, number = SCENES[scene]
    native, *others = programs
    begin = start(folder, scene, programs[native][0])
    turns = [{name: bench.take(folder, [*options, "-restart", begin], number, program=command)
              for name, command in programs.items()} for _ in range(TURNS)]
    if any(None in turn.values() for turn in turns):
        sys.exit(1)  # 'take' has said why
    run = turns[0][native]
    row = {"scene": scene, "particles": run.particles, "iterations": run.iterations,
           native: 1e6 * statistics.median(turn[native].seconds for turn in turns) / run.number / run.particles,
           **{name: statistics.median(turn[name].seconds / turn[native].seconds for turn in turns) for name in others}}
    print(", ".join(f"{key}: {value:.3g}" if key != "scene" else value for key, value in row.items()), flush=True)
    return row


def text(path):
    rows = report.load(path)
    native, *others = list(rows[0])[3:]
    titles = ["scene, 1 rank", "particles", "iterations", f"{native}: us a particle and step",
              *(f"{name}: times that" for name in others)]
    lines = [[row["scene"], f"{row['particles']:.0f}", f"{row['iterations']:.1f}",
              *(f"{row[name]:.2f}" for name in (native, *others))] for row in rows]
    return "\n".join(report.grid(titles, lines)) + "\n"


def asked(about):
    """The words of this program, and of those that run its scenes."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default=os.path.join(states.ROOT, "output/bench"))
    parser.add_argument("--only", default="")
    parser.add_argument("--readme", action="store_true")
    return parser.parse_args()


def main():
    arguments = asked(__doc__)
    table = os.path.join(arguments.out, "variants.csv")
    if not arguments.readme:
        os.makedirs(os.path.join(arguments.out, "states"), exist_ok=True)
        programs = builds(arguments.out)
        report.save(table, [measure(arguments.out, scene, programs) for scene in SCENES if arguments.only in scene])
        print(text(table))
    else:
        report.insert("variants", text(table))


if __name__ == "__main__":
    main()
