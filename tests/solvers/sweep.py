#!/usr/bin/python3
"""sweep.py [--all] [--readme]: every Krylov method, preconditioner and matrix type of this PETSc on one and two
ranks, and the sides of the preconditioner: each run must be right or be refused in one sentence. 'Right' is a kinetic
energy and a pressure as those of the default solver at REFERENCE. Without --all a sample, the part of make test;
--readme writes the table of tests/solvers/README.md."""
import argparse
import concurrent.futures
import os
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

TYPES = os.path.join(runs.ROOT, "output", "build", "tests", "solvers", "types")
README = os.path.join(os.path.dirname(os.path.abspath(__file__)), "README.md")
COMMON = ("-box_x periodic -drop_shape sphere -packing_jitter 0.1 -steps_max 10 -progress_interval 0 "
          "-snapshot_interval 1e9 -ksp_max_it 1000 ")
SCENES = {
    # a drop falls into a film: a free surface, walls, isolated particles in the splash
    "": "-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 1,1 -gravity 0,-9.81 -box_ymin wall -bodies film,drop "
        "-film_upper 1,0.3 -film_tension 1 -film_viscosity 0.1 -drop_radius 0.15 -drop_center 0.5,0.55 "
        "-drop_velocity 1,-2 -drop_tension 1 -time_step 2e-3 " + COMMON,
    # a full box without a free surface, whose pressure is known up to a constant
    "closed": "-dimension 3 -spacing 0.2 -box_lower 0,0,0 -box_upper 1,1,1 -box_y symmetry -box_z wall -bodies water "
              "-water_density 1000 -water_velocity_type formula -water_velocity_formula "
              "0-cos(2*pi*x)*sin(2*pi*y),sin(2*pi*x)*cos(2*pi*y),0 -time_step 5e-3 " +
              COMMON.replace("-drop_shape sphere ", ""),
}
REFERENCE = "-ksp_rtol 1e-10"
TOLERANCE = "-ksp_rtol 1e-6"
PRESSURE = 1e-4  # relative error (2-norm) of the pressure: the tolerance times a condition number of a hundred
ENERGY = 1e-5    # the same of the kinetic energy, which the pressure only changes
HALVED = 0.1     # of the energy after steps were rolled back and halved: it is that of an earlier time
SECONDS = 90     # no run of these takes more than three on an idle machine
METHODS = ("gmres", "fgmres", "bcgs", "cgs", "tfqmr", "bcgsl", "minres", "cg")
DIRECT = ("lu", "cholesky", "redundant", "qr", "svd", "jacobi", "twolevel")
ROOTS = ("aij", "aijperm", "aijsell", "aijcrl", "baij", "sbaij", "sell", "dense")
CLOSED = ("-pc_type twolevel", "-pc_type jacobi", "-pc_type gamg", "-ksp_type minres -pc_type jacobi",
          "-ksp_type gmres -pc_type jacobi", "-ksp_type cgs -pc_type jacobi", "-pc_type icc", "-pc_type lu",
          "-ksp_type preonly -pc_type lu", "-ksp_type preonly -pc_type cholesky", "-pc_type none")
# what was wrong, with exit code 0 or a trace, before the solver's word was checked, and what must stay right
ALWAYS = ("-ksp_type cgs -pc_type jacobi", "-ksp_type tfqmr -pc_type jacobi", "-pc_type deflation", "-pc_type lmvm",
          "-ksp_type preonly -pc_type lu", "-ksp_type preonly -pc_type jacobi", "-ksp_type minres -pc_type jacobi",
          "-ksp_type bcgsl -pc_type jacobi", "-mat_type blockmat -pc_type jacobi", "-ksp_type gmres -pc_type jacobi",
          "-pc_type ilu", "-pc_type composite", "-pc_type gamg", "-pc_type twolevel", "-ksp_type tsirm -pc_type jacobi")
EVERY = 17  # of the others the sample takes one in so many


def combinations():
    """(scene, options, ranks) of all runs."""
    text = subprocess.run([TYPES], check=True, text=True, stdout=subprocess.PIPE, env=runs.environment()).stdout
    lists = {line.split(":")[0]: line.split(":")[1].replace(",", " ").split() for line in text.splitlines()}
    options = [f"-ksp_type {name} -pc_type jacobi" for name in lists["ksp"]]
    options += [f"-pc_type {name}" for name in lists["pc"]]
    options += [f"-mat_type {name} -pc_type jacobi" for name in (*ROOTS, *lists["mat"])]
    options += [f"-ksp_type preonly -pc_type {name}" for name in DIRECT]
    options += [f"-ksp_type {name} -pc_type jacobi -ksp_pc_side {side}" for name in METHODS
                for side in ("left", "right", "symmetric")]
    return [(scene, choice, ranks) for scene, choices in (("", options), ("closed", CLOSED)) for choice in choices
            for ranks in (1, 2)]


def state(folder):
    """(last line of the series, pressure by id) of a run."""
    return runs.series(folder)[-1], runs.fields(runs.numbered(folder, "checkpoint")[-1])["pressure"]


def compute(scene, options, ranks, tolerance=TOLERANCE):
    """(finished process or None if it hangs, folder)."""
    name = f"{scene} {options} {tolerance} {ranks}".replace(" ", "_").replace("/", "_")
    folder = runs.scratch(name)
    try:
        return runs.start(f"{SCENES[scene]} {tolerance} {options} -output_dir {folder}", ranks, SECONDS), folder
    except subprocess.TimeoutExpired:
        return None, folder


def refusal(process):
    """The sentence that a run was refused with, or why it is none."""
    lines = [line for line in process.stderr.splitlines() if "isph: error:" in line or "PETSC" in line]
    if process.returncode < 0 or len(lines) != 1 or not lines[0].startswith("isph: error: "):
        return None, f"code {process.returncode}, {len(lines)} lines: {' / '.join(lines[:3])[:200]}"
    return lines[0][len("isph: error: "):], ""


def judge(reference, scene, options, ranks):
    """(verdict, iterations, what is wrong or the sentence)."""
    process, folder = compute(scene, options, ranks)
    if process is None:
        return "HANG", 0, f"no end after {SECONDS} s"
    if process.returncode:
        sentence, why = refusal(process)
        if sentence is None:
            return "TRACE", 0, why
        return ("no answer" if "stopped at" in sentence else "refused"), 0, sentence
    last, pressure = state(folder)
    right, wanted = reference
    energy = abs(last["kinetic_energy"] / right["kinetic_energy"] - 1)
    if last["rejected"] > 0:
        return ("halved" if energy < HALVED else "WRONG"), last["iterations"], f"energy off by {energy:.2g}"
    if scene == "closed":  # up to a constant
        pressure, wanted = pressure - pressure.mean(), wanted - wanted.mean()
    error = np.linalg.norm(pressure - wanted) / np.linalg.norm(wanted)
    good = energy <= ENERGY and error <= PRESSURE
    return ("right" if good else "WRONG"), last["iterations"], f"energy off by {energy:.2g}, pressure by {error:.2g}"


def table(outcome):
    """The rows of the README: one each choice, a column each number of ranks."""
    yield "| scene | options | 1 rank | 2 ranks | why not |"
    yield "| --- | --- | --- | --- | --- |"
    for scene, options in dict.fromkeys((scene, options) for scene, options, _ in outcome):
        cells, why = [], ""
        for ranks in (1, 2):
            verdict, iterations, text = outcome[scene, options, ranks]
            cells.append(f"{verdict}, {iterations:.0f}" if verdict in ("right", "halved") else verdict)
            if verdict in ("refused", "no answer"):
                why = text.split('PETSc says "')[1].split('"')[0] if 'PETSc says "' in text else text.split(": try")[0]
                why = why.split("step 0: the pressure solver")[-1].split(") ", 1)[-1].split(";")[0][:100]
        yield f"| {scene or 'drop and film'} | `{options}` | {cells[0]} | {cells[1]} | {why.replace('|', ' ')} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--readme", action="store_true")
    arguments = parser.parse_args()
    jobs = combinations()
    if not (arguments.all or arguments.readme):
        chosen = [job for job in jobs if job[1] in ALWAYS and job[0] == "" and job[2] == 1]
        jobs = chosen + [job for job in jobs if job not in chosen][::EVERY]
    reference = {}
    for scene in SCENES:
        process, folder = compute(scene, "", 1, REFERENCE)
        if not runs.check(process is not None and process.returncode == 0, f"reference {scene}".strip(),
                          process.stderr[-300:] if process else "hangs"):
            runs.done()
        reference[scene] = state(folder)
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        outcome = dict(zip(jobs, pool.map(lambda job: judge(reference[job[0]], *job), jobs)))
    for (scene, options, ranks), (verdict, _, text) in outcome.items():
        runs.check(verdict in ("right", "halved", "refused", "no answer"),
                   f"{scene} {options}, {ranks} rank{'s' * (ranks > 1)}".strip(), f"{verdict}: {text}")
    if not arguments.all and not arguments.readme:
        for options in ("-pc_type twolevel", "-pc_type gamg", "-ksp_type preonly -pc_type lu",
                        "-ksp_type minres -pc_type jacobi", "-ksp_type tfqmr -pc_type jacobi"):
            verdict, _, text = outcome["", options, 1]
            runs.check(verdict == "right", f"{options} is right", f"{verdict}: {text}")
    counts = {}
    for verdict, *_ in outcome.values():
        counts[verdict] = counts.get(verdict, 0) + 1
    print(", ".join(f"{number} {verdict}" for verdict, number in sorted(counts.items())))
    if arguments.readme:
        runs.replace(README, "sweep", f"\n{len(outcome)} runs: " +
                     ", ".join(f"{number} {verdict}" for verdict, number in sorted(counts.items())) + ".\n\n" +
                     "\n".join(table(outcome)) + "\n")
    runs.done()


if __name__ == "__main__":
    main()
