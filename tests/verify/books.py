#!/usr/bin/python3
"""The books of a run, part by part: the work of what drives the liquid beside a figure known in another way."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

QUIET = " -snapshot_interval 0 -checkpoint_interval 0 "


def books(options, name, ranks=1):
    """Series of a run, and the energy that no work explains, in each row, over the most that was exchanged."""
    s = runs.series(runs.run(options + QUIET, name, ranks))
    gain = s["kinetic_energy"] + s["potential_energy"]
    given = s["viscous_work"] + s["tension_work"] + s["outside_work"]
    return s, (gain - gain[0] - given) / max(np.ptp(s["viscous_work"]), np.ptp(s["outside_work"]))


def periodic():
    # A film flows down a slope, again and again through a periodic box: gravity drives it, friction takes it all.
    s, rest = books("-options_file cases/film_on_slope/case.opts", "slope")
    runs.check_below(abs(rest).max(), 2e-3, "gravity along a periodic direction: books of a film on a slope")
    runs.check(s["outside_work"][-1] > 20 * s["kinetic_energy"][-1], "it goes round many times", s["outside_work"][-1])


CHANNEL = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 0.8,0.4 -box_y wall -bodies jet -jet_type emitter
 -jet_upper 0.2,0.4 -jet_velocity 0.5,0 -jet_viscosity 0.02 -packing_jitter 0 -ksp_rtol 1e-10 -time_end 0.5
 -series_interval 0.1 """


def emitters():
    # The work of an emitter that three ranks or a mirror divide is that of the whole; and viscosity takes the same
    # where the liquid is held in an implicit step.
    whole, rest = books(CHANNEL, "channel")
    runs.check_below(abs(rest).max(), 2e-3, "books of a channel behind an emitter")
    half = "-box_upper 0.8,0.2 -jet_upper 0.2,0.2 -box_ymax symmetry -gauge_multiplicity 2"
    for name, more, ranks in (("three ranks", "", 3), ("half", half, 1)):
        part = books(CHANNEL + more, name.replace(" ", "_"), ranks)[0]
        runs.check_below(abs(part["outside_work"][1:] / whole["outside_work"][1:] - 1).max(), 1e-6,
                         f"work of an emitter, {name}")
    implicit = books(CHANNEL + "-viscosity_solver implicit", "implicit")[0]
    for column in ("viscous_work", "outside_work"):
        runs.check_below(abs(implicit[column][-1] / whole[column][-1] - 1), 0.01, f"{column}, implicit viscosity")
    # Beside walls it has the whole force on its face: as rings, and against the pressure of an outlet.
    rest = books("""-dimension axisymmetric -spacing 0.01 -box_lower 0,0 -box_upper 0.05,0.8 -box_xmax wall
     -box_ymin wall -gravity 0,-9.81 -bodies water,pump -water_lower 0,0.04 -water_upper 0.05,0.3 -pump_type emitter
     -pump_upper 0.05,0.04 -pump_velocity 0,0.2 -time_end 1 -series_interval 0.1""", "rings")[1]
    runs.check_below(abs(rest[-1]), 0.015, "books of a column of rings that an emitter lifts")
    s, rest = books(CHANNEL + """-box_xmax_pressure 2000 -bodies jet,water -water_lower 0.2,0 -water_upper 0.8,0.4
     -water_velocity 0.5,0""", "against")
    unexplained = rest[-1] * max(np.ptp(s["viscous_work"]), np.ptp(s["outside_work"]))
    runs.check_below(abs(unexplained), 0.01 * 2000 * 0.4 * 0.5 * 0.5, "books of an emitter against an outlet")


def gas():
    # What an emitter in the middle of a closed vessel brings, the gas takes: its adiabatic work to its last volume. A
    # jet breaks up otherwise from packing to packing: the mean of three.
    works, rests = [], []
    for seed in range(1, 4):
        s, rest = books(f"""-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,0.8 -box_x wall -box_y wall -gas
         -gravity 0,-9.81 -bodies jet,pool -jet_type emitter -jet_lower 0.4,0.4 -jet_upper 0.6,0.6 -jet_velocity 0,-1
         -pool_upper 1,0.3 -series_interval 0.02 -time_end 0.5 -packing_seed {seed}""", f"gas_{seed}")
        volume = s[next(n for n in s.dtype.names if n.startswith("gas_volume"))]
        amount, end = np.nanmax(volume), volume[-1]
        taken = 101325 * (amount / 0.4 * ((amount / end)**0.4 - 1) - (amount - end))
        with open(runs.scratch(f"gas_{seed}/log.txt"), encoding="utf-8") as log:
            works.append(-float(log.read().split(", enclosed gas")[1].split()[0]) / taken)
        rests.append(rest[-1] * np.ptp(s["outside_work"]) / taken)
    runs.check_within(np.mean(works), 0.95, 1.05, "gas that an emitter compresses takes its adiabatic work")
    runs.check_below(abs(np.mean(rests)), 0.04, "books of a vessel that is filled")


TANK = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,0.7 -box_xmin wall -gravity 0,-9.81 -bodies water
 -water_upper 1,0.5 -series_interval 0.05 """


def outlets():
    # Water that falls through the floor against a pressure, and water that a higher outside pushes in, which it says.
    rest = books(TANK + "-box_xmax wall -box_ymin_pressure 3000 -time_end 0.3", "floor")[1]
    runs.check_below(abs(rest[-1]), 0.02, "books of a floor that is an outlet")
    s, rest = books(TANK + "-box_ymin wall -box_xmax_level 0.6 -time_end 0.8", "higher")
    given = s["outside_work"][-1]
    runs.check(given > 20, "a higher outside gives energy", given)
    runs.check_below(rest[-1] * np.ptp(s["outside_work"]), 1, "and no less than the water gets")
    with open(runs.scratch("higher/log.txt"), encoding="utf-8") as log:
        runs.check("the outside of xmax presses more" in log.read(), "it says that liquid would enter")


PISTON = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1.2,0.7 -box_x wall -box_ymin wall -gravity 0,-9.81
 -bodies water -water_upper 1.2,0.4 -solids paddle -paddle_lower 0.56,-0.1 -paddle_upper 0.64,0.6
 -paddle_oscillation_amplitude 0.01,0 -paddle_oscillation_frequency 1 """


def solids():
    # A paddle that starts with a speed gives what the water gets, not twice.
    s, rest = books(PISTON + "-series_interval 0.01 -time_end 0.02", "paddle")
    runs.check_within(s["outside_work"][-1] / s["kinetic_energy"].max(), 0.95, 1.05, "work of a paddle that starts")
    # A piston lifts a column, between walls and in a periodic box, whose floor cuts it.
    for side in "wall", "periodic":
        s, rest = books(f"""-dimension 2 -spacing 0.01 -box_lower 0,-0.1 -box_upper 0.1,0.6 -box_x {side} -box_ymin wall
         -gravity 0,-9.81 -bodies water -water_lower 0,0.04 -water_upper 0.1,0.3 -water_velocity 0,0.2 -solids piston
         -piston_lower -1,-1 -piston_upper 1,0.04 -piston_velocity 0,0.2 -series_interval 0.1 -time_end 0.5 """, side)
        runs.check_below(abs(rest[-1]), 0.01, f"books of a piston, {side}")


def at_rest():
    # Nothing is exchanged in a tank at rest: its books are no share of it, and no option is named; nor does a plate
    # that creeps above liquid without a weight give it anything.
    for name, more in (("walls", "-box_xmax wall"), ("outlet", "-box_xmax_level 0.5"),
                       ("weightless", "-box_xmax wall -gravity 0,0 -solids p -p_lower 0.4,0.56 -p_upper 0.6,0.66 "
                                      "-p_velocity 0,-1e-3 -time_step 1e-3")):
        path = runs.run(TANK + more + " -box_ymin wall -time_end 0.4" + QUIET, f"rest_{name}")
        with open(os.path.join(path, "log.txt"), encoding="utf-8") as log:
            line, after = log.read().split("residual")[1].split("\n")[:2]
        runs.check("within the error" in line and "%" not in line, f"a tank at rest, {name}: its residual", line)
        runs.check("tolerance" not in after, f"a tank at rest, {name}: its verdict", after)


PARTS = {"solids": solids, "at_rest": at_rest, "periodic": periodic, "emitters": emitters, "gas": gas,
         "outlets": outlets}
for part in runs.parts(*PARTS):
    PARTS[part]()
runs.done()
