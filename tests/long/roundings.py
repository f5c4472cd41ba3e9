#!/usr/bin/python3
"""Whether a verdict hangs on rounding: the tests that judge figures, with other flags and other random numbers.

    tests/long/roundings.py [--only NAMES] [--jobs N] [VARIANT ...]

VARIANT: v2, v3, v4, O1, seeds; default: v3, O1 and seeds. Each is a copy of the tree in output/roundings, built and
tested as `make test` does: what judges figures and takes at most DEAR seconds by tests/table.txt, or what --only names.
Other instructions and other optimisation round otherwise; `seeds` adds ten to the seed of every packing. A test that
fails here and passes in `make test` needs a quantity that does not scatter, or packings of a cheaper scene."""
import argparse
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "..", "mutants"), os.path.join(HERE, "..")]
import mutants  # noqa: E402
import run  # noqa: E402
import runs  # noqa: E402

FIGURES = ("unit/", "verify/")  # other tests compare two runs of one program
DEAR = 4  # s
SEED = "PetscCall(OptionsReadBlock(comm, \"Packing\", options, __func__, packing));\n"  # in SEEDS, once
SEEDS = os.path.join("src", "packing", "packing.c")
OF_ONE_PACKING = ("verify/first_steps.py",)  # by design: its figures are those of the version before
VARIANTS = {"v2": "-O3 -march=x86-64-v2", "v3": "-O3 -march=x86-64-v3", "v4": "-O3 -march=x86-64-v4",
            "O1": "-O1 -march=native", "seeds": "-O3 -march=native"}
DEFAULT = ("v3", "O1", "seeds")  # twelve minutes of one core


def possible(variant):
    """Whether the processor has the instructions of a variant; the loader knows (glibc 2.33)."""
    if variant not in ("v2", "v3", "v4"):
        return True
    said = subprocess.run(["/lib64/ld-linux-x86-64.so.2", "--help"], stdout=subprocess.PIPE, text=True, check=False)
    return f"x86-64-{variant} (supported" in said.stdout


def reseed(tree):
    """Adds ten to the seed of every packing, given or not."""
    path = os.path.join(tree.path, SEEDS)
    with open(path, encoding="utf-8") as file:
        text = file.read()
    if text.count(SEED) != 1:
        sys.exit(f"roundings.py: {SEEDS} has no line {SEED.strip()}")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text.replace(SEED, SEED + "  packing->seed += 10;\n"))


def figures():
    """The names of the tests that judge figures, but for dear ones and ranks besides the first."""
    return " ".join(job.name for job in run.find(run.read_table(), ["verify"]) if job.name.startswith(FIGURES) and
                    job.row.seconds <= DEAR and not job.name.endswith(("@2", "@3")))


def judge(variant, only, jobs):
    """Builds and tests a variant; prints what failed."""
    tree = mutants.Tree(os.path.join(runs.ROOT, "output", "roundings", variant), runs.ROOT)
    if variant == "seeds":
        reseed(tree)
    built = subprocess.run(["make", "-s", f"-j{jobs}", "programs", f"CFLAGS={VARIANTS[variant]} -g"], cwd=tree.path,
                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if not runs.check(built.returncode == 0, f"{variant} builds", built.stdout[-600:]):
        return
    done = subprocess.run([sys.executable, "tests/run.py", "--only", only, "--jobs", str(jobs)], cwd=tree.path,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    lines = done.stdout.splitlines()
    failed = [line[7:] for line in lines if line.startswith("  FAIL ")]
    names = [line.partition("ONLY=")[2].split()[0] for line in lines if line.startswith("    again: ")]
    if variant == "seeds" and set(names) <= set(OF_ONE_PACKING):
        failed = []
    runs.check(not failed, f"{variant}: {lines[-1]}", "; ".join(failed) + f" in {', '.join(names)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--only", default="")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("variants", nargs="*", metavar="VARIANT", help=", ".join(VARIANTS))
    a = parser.parse_args()
    unknown = set(a.variants) - set(VARIANTS)
    if unknown:
        sys.exit(f"roundings.py: no variant is called {', '.join(unknown)}; there are {', '.join(VARIANTS)}")
    for variant in a.variants or DEFAULT:
        if possible(variant):
            judge(variant, a.only or figures(), a.jobs)
        else:
            print(f"skipped: this processor has no x86-64-{variant}", flush=True)
    return runs.done()


if __name__ == "__main__":
    main()
