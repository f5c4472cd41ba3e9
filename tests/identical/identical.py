#!/usr/bin/env python3
"""Are the results of this tree those of another commit, to the last bit?

  identical.py COMMIT            builds that commit in output/identical/ (once), runs the scenes with both programs
  identical.py --program PATH    compares with a program that stands already
  identical.py --scene NAME ...  of these scenes only
  identical.py --ignore COLUMN   but for a column of the series that the change means to alter

Compared are the columns of series.csv that both have (but the wall-clock time) and every field of the last checkpoint.
For each difference: the first row or the number of particles, and by how much. The exit code is 1 if anything differs.
Not part of make test: a change that reorders a sum is allowed, with the difference stated in its commit."""
import argparse
import os
import shlex
import subprocess
import sys
import tempfile

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import runs  # noqa: E402

IMPACT = "-options_file cases/drop_impact/case.opts -options_file options/quarter.opts -options_file options/quick.opts"
SMALL = "-options_file cases/drop_impact/case.opts -options_file options/quarter.opts -spacing 1.0e-3"
# name: options, ranks, steps
SCENES = {
    "impact": (IMPACT, (1, 2), 100),
    "dam_break": ("-options_file cases/dam_break/case.opts", (1, 2), 100),
    "couette": ("-options_file cases/couette/case.opts", (1,), 100),
    "printed scheme": ("-options_file cases/drop_impact/case.opts -options_file options/quarter.opts -options_file "
                       "options/paper.opts -spacing 1.0e-3 -packing_relaxation_time 2e-4 -time_step_max 8e-5",
                       (1, 2), 40),
    "weakly compressible": (SMALL + " -scheme weakly_compressible", (1, 2), 40),
    "conserved": (SMALL + " -shifting_conserved -pressure_gradient conserved", (1, 2), 40),
    "implicit viscosity": (SMALL + " -drop_viscosity 1 -film_viscosity 1 -viscosity_solver implicit", (2,), 20),
    "morris, density source": (SMALL + " -viscosity_form morris -pressure_source density", (1,), 20),
    "assembled": (SMALL + " -pc_type icc -mat_type aij", (1,), 20),
    "jet": ("-options_file cases/jet/case.opts", (2,), 60),
    "obstacle": ("-options_file cases/obstacle/case.opts", (2,), 20),
    "thin film": ("-options_file cases/thin_film/case.opts", (1,), 10),
    "retracting sheet": ("-options_file cases/retracting_sheet/case.opts", (1,), 40),
    "contact angle": ("-options_file cases/contact_angle/case.opts", (1,), 40),
    "contact angle of a solid": ("-options_file cases/contact_angle/ball.opts", (2,), 40),
    "moving line": ("-options_file cases/ink_drop/case.opts -spacing 1.25e-6", (1,), 100),
    "two liquids": ("-options_file cases/two_liquids/case.opts -spacing 0.25e-3", (2,), 40),
    "two liquids and air": ("-options_file cases/two_liquids/lens_rings.opts -spacing 0.25e-3", (2,), 40),
    "sloshing": ("-options_file cases/sloshing/case.opts", (2,), 40),
    "free body": ("-options_file cases/floating_box/case.opts -spacing 0.02 -water_viscosity 0.001", (1, 2), 60),
    "free body, implicit": ("-options_file cases/floating_box/case.opts -spacing 0.02 -water_viscosity 100", (2,), 30),
    "moving solids": ("-options_file cases/stirred_tank/case.opts", (2,), 40),
    "sticking line": ("-options_file cases/contact_angle/incline.opts -spacing 0.2e-3", (1,), 40),
    "emitter, implicit": ("-options_file cases/honey/case.opts", (2,), 40),
    "rings": ("-options_file cases/drop_impact/axisymmetric.opts -spacing 0.4e-3", (2,), 60),
    "graded": ("-options_file cases/drop_impact/axisymmetric.opts -options_file cases/drop_impact/graded.opts "
               "-spacing 0.5e-3 -spacing_coarse 1e-3", (1,), 60),
    "following": (IMPACT + " -options_file cases/drop_impact/following.opts -spacing 0.5e-3 -spacing_coarse 2e-3", (2,),
                  40),
    "following rings": ("-options_file cases/drop_impact/axisymmetric.opts -spacing 0.4e-3 -spacing_coarse 1.6e-3 "
                        "-spacing_follow surface", (1,), 60),
    "gas": ("-options_file cases/rising_bubble/case.opts -spacing 0.05", (1, 2), 20),
    "poisson packing": (SMALL + " -packing_type poisson -spacing 1.5e-3", (1,), 5),
    "relaxation": (SMALL + " -scheme density_invariant -packing_relaxation_time 2e-4", (2,), 5),
}
APART = "wall_time"


def build(commit):
    """The program of a commit, in output/identical/."""
    commit = subprocess.run(["git", "rev-parse", "--short", commit], cwd=runs.ROOT, check=True, text=True,
                            stdout=subprocess.PIPE).stdout.strip()
    folder = os.path.join(runs.ROOT, "output", "identical", commit)
    if not os.path.isdir(folder):
        subprocess.run(["git", "clone", "--quiet", runs.ROOT, folder], check=True)
        subprocess.run(["git", "checkout", "--quiet", commit], cwd=folder, check=True)
    subprocess.run(["make", "--quiet", "-j2", "isph"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return os.path.join(folder, "isph")


def compute(program, options, ranks, steps, folder):
    """Runs the scene; the reason if it fails."""
    command = (["mpiexec", "-n", str(ranks)] if ranks > 1 else []) + [program] + shlex.split(options)
    # the level from which the column highest counts is measured by older programs and 0 by newer ones, unless given
    command += ["-gauge_level", "0", "-steps_max", str(steps), "-output_dir", folder, "-output_overwrite",
                "-progress_interval", "0"]
    process = subprocess.run(command, cwd=os.path.dirname(program), env=runs.environment(ranks), text=True,
                             stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    return process.stdout[-400:] if process.returncode else ""


def differences(one, other, ignored):
    """Sentences: what differs between two folders of runs, but for ignored columns."""
    a, b = runs.series(one), runs.series(other)
    shared = [name for name in a.dtype.names if name in b.dtype.names and APART not in name and name not in ignored]
    if len(a) != len(b):
        yield f"series: {len(a)} and {len(b)} rows"
    else:
        for name in shared:
            apart = ~((a[name] == b[name]) | (np.isnan(a[name]) & np.isnan(b[name])))
            if apart.any():
                scale = max(np.nanmax(np.abs(b[name])), 1e-300)
                yield (f"series: {name} from row {np.argmax(apart)} on, by {np.nanmax(np.abs(a[name] - b[name])):.3g}"
                       f" ({np.nanmax(np.abs(a[name] - b[name])) / scale:.2g} of the largest)")
    a, b = (runs.fields(runs.numbered(folder, "checkpoint")[-1]) for folder in (one, other))
    for name in sorted(set(a) & set(b)):
        if a[name].shape != b[name].shape:
            yield f"checkpoint: {name} is {a[name].shape} and {b[name].shape}"
        elif a[name].tobytes() != b[name].tobytes():
            apart = (a[name] != b[name]).reshape(len(a[name]), -1).any(axis=1)
            yield (f"checkpoint: {name} of {np.count_nonzero(apart)} particles, by at most "
                   f"{np.nanmax(np.abs(a[name] - b[name])):.3g}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commit", nargs="?", default="HEAD")
    parser.add_argument("--program", help="the other program")
    parser.add_argument("--scene", nargs="+", default=list(SCENES), choices=list(SCENES))
    parser.add_argument("--ignore", nargs="+", default=[], metavar="COLUMN")
    arguments = parser.parse_args()
    other = os.path.abspath(arguments.program) if arguments.program else build(arguments.commit)
    with tempfile.TemporaryDirectory(prefix="isph-identical-") as scratch:
        for name in arguments.scene:
            options, counts, steps = SCENES[name]
            for ranks in counts:
                title = f"{name}, {ranks} rank{'s' * (ranks > 1)}"
                folders = [os.path.join(scratch, f"{name} {ranks} {side}".replace(" ", "_")) for side in "ab"]
                failed = [compute(program, options, ranks, steps, folder)
                          for program, folder in zip((runs.PROGRAM, other), folders)]
                if any(failed):
                    runs.check(False, title, " / ".join(text for text in failed if text))
                    continue
                found = list(differences(*folders, arguments.ignore))
                runs.check(not found, title, "; ".join(found))
    runs.done()


if __name__ == "__main__":
    main()
