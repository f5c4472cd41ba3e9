#!/usr/bin/python3
"""The table of tests/tradeoff/README.md: what each choice costs in five scenes, from their tradeoff.csv.

    summary.py          after make tradeoff CASE=... of all five; make tradeoff-readme runs it
"""
import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "verify"), os.path.join(HERE, "..")]
import runner  # noqa: E402
import runs  # noqa: E402
import tradeoff  # noqa: E402

SCENES = {"drop_impact": "drop impact, 0.7 mm, to 20 ms", "oscillating_drop": "oscillating drop, 2-d, R/d0 = 8",
          "central_force": "central force, R/d0 = 15", "taylor_green": "Taylor-Green, 50 x 50",
          "film_at_rest": "film at rest, 10 layers"}
# A line of the table: its name, then axis and label in the sweeps.
LINES = [("`-ksp_rtol 0.3`", "tolerance", "rtol 0.3"), ("`-ksp_rtol 1e-8`", "tolerance", "rtol 1e-8"),
         ("`-pressure_density_tolerance 1e-3`", "density tolerance", "1e-3"),
         ("`-pressure_density_tolerance 1e-5`", "density tolerance", "1e-5"),
         ("`-time_cfl 0.3`", "time step", "CFL 0.3"), ("`-time_cfl 0.1`", "time step", "CFL 0.1"),
         ("`-kernel_ratio 1.2`", "kernel", "cubic_spline, h/d0 1.2"),
         ("`-kernel_ratio 1.5`", "kernel", "cubic_spline, h/d0 1.5"),
         ("`-pressure_gradient symmetric`", "scheme", "gradient symmetric"),
         ("`-time_centered 0`", "scheme", "not centered"), ("`-shifting 0`", "scheme", "no shifting"),
         ("`-shifting_conserved`", "scheme", "shifting conserved"),
         ("`-viscosity_form cleary`", "viscosity", "cleary"), ("`-viscosity_form morris`", "viscosity", "morris"),
         ("`-pc_type jacobi`", "preconditioner", "jacobi"), ("`-pc_type gamg`", "preconditioner", "gamg"),
         ("WCSPH, c = 10 U", "WCSPH", "c = 10 U"), ("the scheme as printed", "scheme", "as printed"),
         ("preset `fast`", "preset", "fast"), ("preset `accurate`", "preset", "accurate")]


def cell(row, base, before=""):
    """Error and CPU time over the defaults', or what happened."""
    if row is None:
        return "-"
    if not math.isfinite(row["error"]):
        return "refused" if row["steps"] == 0 and "too small" in row["reason"] else "stops"
    return f"{before}{row['error'] / base['error']:.2f}, {row['seconds'] / base['seconds']:.2f}"


def spacing(rows, finer):
    """The finest or the coarsest spacing of a sweep."""
    found = sorted((float(r["label"].split()[0]), r) for r in rows if r["axis"] == "spacing" and
                   (float(r["label"].split()[0]) < 1) == finer)
    if not found:
        return "-"
    ratio, row = found[0] if finer else found[-1]
    return cell(row, rows[0], f"{ratio:g} d0: " if math.isfinite(row["error"]) else "")


def main():
    sweeps = {case: tradeoff.read(case) for case in SCENES}
    missing = [case for case, rows in sweeps.items() if not rows]
    if missing:
        print(f"summary.py: without make tradeoff CASE={missing[0]} tests/tradeoff/README.md stays as it is")
        return
    lines = [{"choice": "the default", **{SCENES[c]: f"{r[0]['error']:.2g}, {r[0]['seconds']:.2g} s"
                                          for c, r in sweeps.items()}}]
    for name, finer in (("coarser", False), ("finer", True)):
        lines.append({"choice": name, **{SCENES[c]: spacing(r, finer) for c, r in sweeps.items()}})
    for name, axis, label in LINES:
        found = {c: next((row for row in r if (row["axis"], row["label"]) == (axis, label)), None)
                 for c, r in sweeps.items()}
        if not any(found.values()):
            sys.exit(f"summary.py: no sweep has '{label}' on the axis '{axis}'")
        lines.append({"choice": name, **{SCENES[c]: cell(row, sweeps[c][0]) for c, row in found.items()}})
    versions = ", ".join(sorted({row["version"] for rows in sweeps.values() for row in rows}))
    table = runner.table(lines, ["choice", *SCENES.values()])
    text = f"{table}\n\nWritten by `make tradeoff-readme` from the sweeps of version {versions}."
    runs.replace(os.path.join(HERE, "README.md"), "tradeoff", "\n" + text + "\n")


if __name__ == "__main__":
    main()
