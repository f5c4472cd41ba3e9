#!/usr/bin/python3
"""The convergence test in density units, and the error budget at the end of a run."""
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

DROP = "-options_file cases/central_force/case.opts -spacing 0.1 -time_end 1 -series_interval 0"
CASES = {"default": "", "1e-3": "-pressure_density_tolerance 1e-3", "1e-5": "-pressure_density_tolerance 1e-5",
         "1e-7": "-pressure_density_tolerance 1e-7", "1e-5, gmres":
         "-pressure_density_tolerance 1e-5 -ksp_type gmres -ksp_norm_type preconditioned"}


def run(options, name):
    """(series, what the program prints) of a run."""
    folder = runs.scratch(name)
    process = runs.start(options.split() + ["-output_dir", folder])
    if not runs.check(process.returncode == 0, f"{name}, runs", process.stderr.strip()[-400:]):
        runs.done()
    return runs.series(folder), process.stdout


series = {name: run(f"{DROP} {options}", name)[0] for name, options in CASES.items()}
iterations = {name: float(np.mean(table["iterations"][1:])) for name, table in series.items()}
for name in ("1e-3", "1e-5", "1e-7", "1e-5, gmres"):
    runs.check_below(float(np.max(series[name]["solver_error"][1:])), float(name.split(",")[0]),
                     f"rms density error the solver leaves at {name}")
runs.check(iterations["1e-3"] < iterations["1e-5"] < iterations["1e-7"], "a smaller tolerance takes more iterations",
           iterations)
runs.check(float(np.max(series["1e-3"]["solver_error"][1:])) > 1e-5, "a large tolerance is used",
           float(np.max(series["1e-3"]["solver_error"][1:])))
last = {name: table["kinetic_energy"][-1] for name, table in series.items()}
runs.check_below(abs(last["1e-7"] / last["default"] - 1), 1e-3, "the same flow as with -ksp_rtol")
failed = runs.start(DROP.split() + ["-pressure_density_tolerance", "-1", "-output_dir", runs.scratch("bad")])
runs.check(failed.returncode != 0 and "it must lie in [0, inf)" in failed.stderr, "a negative tolerance is refused",
           failed.stderr)

# the budget: its residual is that of the series, and the knob is the one that was turned
VORTEX = ("-options_file cases/taylor_green/case.opts -spacing 0.04 -packing_jitter 0.25 -series_interval 0 "
          "-time_end 0.5")
KNOB = {"": "particle spacing", "-pressure_density_tolerance 2e-2": "solver's tolerance"}
for options, knob in KNOB.items():
    table, text = run(f"{VORTEX} {options}", f"budget{options[-4:]}")
    energy = table["kinetic_energy"] + table["potential_energy"]
    residual = energy[-1] - energy[0] - table["viscous_work"][-1] - table["tension_work"][-1]
    printed = float(re.search(r"residual ([-+.\de]+) J/m", text)[1])
    runs.check_below(abs(printed / residual - 1), 5e-3, f"energy residual of the budget {options}")
    runs.check(re.search(rf"dominant .*{knob}", text) is not None, f"the budget names the {knob}",
               re.findall("dominant.*", text))
table, _ = run(VORTEX.replace("0.04", "0.02"), "exact")
taken, lost = -table["viscous_work"][-1], table["kinetic_energy"][0] - table["kinetic_energy"][-1]
runs.check_below(abs(taken / lost - 1), 0.02, "viscosity took what the vortices lost")
drop, _ = run("-options_file cases/oscillating_drop/circle.opts -spacing 0.125e-3 -time_end 7e-3 -series_interval 0",
              "swing")
gained = drop["kinetic_energy"][-1] - drop["viscous_work"][-1]
runs.check_within(drop["tension_work"][-1] / gained, 0.7, 1.3, "work of surface tension over a swinging drop's gain")
runs.check_within(drop["surface_energy"][0] / (0.067 * 2 * np.pi * 2e-3), 0.95, 1.02, "surface energy of a circle")

# what comes from outside is counted: solids that move, shaking, emitters, what leaves through open faces
POUR = ("-dimension 2 -spacing 0.04 -box_lower 0,0 -box_upper 1,1 -bodies jet -jet_type emitter -jet_lower 0.4,0.8 "
        "-jet_upper 0.6,0.96 -jet_velocity 0,-2 -gravity 0,-9.81 -time_end 0.6")
TANK = "-snapshot_interval 100 -options_file cases"
GIVEN = {"the pressure of solids that move": (f"{TANK}/piston/case.opts -box_upper 1.4,0.3 -water_upper 1.4,0.2 "
                                              "-gauge_heights 1 -time_end 1", 0.25),
         "shaking": (f"{TANK}/sloshing/case.opts -pressure_gradient symmetric -time_end 2", 0.5),
         "emitters": (POUR, 0)}
for name, (options, still) in GIVEN.items():  # until then a tank comes to rest, or is set going at a stroke
    table, text = run(f"{options} -series_interval 0.01", f"given {name.split()[-1]}")
    gain, given = (column[table["time"] >= still] for column in (
        table["kinetic_energy"] + table["potential_energy"] - table["viscous_work"], table["outside_work"]))
    runs.check_below(np.ptp(gain - given) / np.ptp(given), 0.1, f"energy from outside: {name}")
    runs.check(re.search(f"{name} [-.0-9]+", text) is not None, f"the budget names {name}",
               re.findall("viscosity gave.*", text))
table, _ = run(f"{TANK}/floating_box/case.opts -spacing 0.02 -float_mass 20 -float_velocity 0,-0.5 -time_end 0.05 "
               "-series_interval 0", "float")
column = {name: table[next(n for n in table.dtype.names if n.startswith(name))] for name in (
    "float_y", "float_velocity_x", "float_velocity_y")}
of_body = 20 * (0.5 * (column["float_velocity_x"]**2 + column["float_velocity_y"]**2) + 9.81 * column["float_y"])
runs.check_below(abs((of_body - of_body[0])[1:] / table["outside_work"][1:] + 1).max(), 0.01,
                 "a free body loses what the liquid gets")
table, _ = run(f"{TANK}/couette/case.opts -spacing 0.05e-3 -time_end 5e-3 -series_interval 0", "couette")
runs.check_below(abs(table["viscous_work"][-1] / table["kinetic_energy"][-1] - 1), 1e-5, "what a wall gave from rest")
runs.check(re.search("left through open faces -[.0-9]+", text) is not None, "the budget names what left",
           re.findall("viscosity gave.*", text))
runs.done()
