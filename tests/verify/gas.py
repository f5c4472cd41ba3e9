#!/usr/bin/python3
"""Enclosed gas: a bubble that breathes in a ring of liquid and in a shell (Rayleigh and Plesset), a column of liquid
that bounces on gas, gas of constant volume, air that liquid encloses as it falls on a cup; on two to four ranks,
after a restart, and as a half."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

RHO, INNER, OUTER, AIR = 1000, 0.01, 0.02, 1e4  # kg/m3, m, m, Pa
GAMMA, EXCESS = 1.4, 1.05  # 1; volume of the gas in open air over that at the start
BUBBLE = f"""-spacing 1e-3 -bodies shell -shell_shape sphere -shell_center 0,0 -shell_radius {OUTER} -shell_holes hole
 -hole_shape sphere -hole_center 0,0 -hole_radius {INNER} -shell_viscosity 0 -gas -gauge_pockets -gas_pressure {AIR}
 -gas_pressure_start {AIR * EXCESS ** GAMMA} -series_interval 0 -snapshot_interval 1 -checkpoint_interval 0 """
PLANE = BUBBLE + "-dimension 2 -box_lower -0.03,-0.03 -box_upper 0.03,0.03 -time_step 1e-4 -time_end 0.023 "
RINGS = BUBBLE + "-dimension axisymmetric -box_lower 0,-0.03 -box_upper 0.03,0.03 -time_step 1e-4 -time_end 0.018 "
DEEP = BUBBLE + """-dimension axisymmetric -spacing_coarse 8e-3 -fine near -near_shape sphere -near_center 0,0
 -near_radius 0.016 -shell_radius 0.1 -box_lower 0,-0.11 -box_upper 0.11,0.11 -time_step 1e-4 -time_end 1e-3 """
HALF = PLANE + "-box_lower 0,-0.03 -box_xmin symmetry "


def pockets(folder):
    """Columns of pockets.csv by their names without units."""
    rows = np.atleast_1d(np.genfromtxt(os.path.join(folder, "pockets.csv"), delimiter=",", names=True, deletechars=""))
    return {name.split("_m")[0].split("_Pa")[0].split("_s")[0]: rows[name] for name in rows.dtype.names}


def steps(rate, start, dt, count):
    """Runge and Kutta: the states of y' = rate(y)."""
    states = [np.array(start, float)]
    for _ in range(count):
        y = states[-1]
        a = rate(y)
        b = rate(y + dt / 2 * a)
        c = rate(y + dt / 2 * b)
        states.append(y + dt / 6 * (a + 2 * b + 2 * c + rate(y + dt * c)))
    return np.array(states)


def breathing(dim, viscosity=0):
    """The rate of (R, dR/dt) of a bubble in a shell of liquid; viscosity in a ring: its stress on both surfaces."""
    def rate(y):
        r, u = y
        outer = (OUTER ** dim - INNER ** dim + r ** dim) ** (1 / dim)
        push = AIR * ((EXCESS * (INNER / r) ** dim) ** GAMMA - 1) / RHO
        flow = r ** (dim - 1) * u
        if dim == 2:
            push -= 2 * viscosity * flow * (r ** -2 - outer ** -2) / RHO
            return np.array([u, ((push - 0.5 * flow ** 2 * (outer ** -2 - r ** -2)) / np.log(outer / r) - u * u) / r])
        return np.array([u, ((push - 0.5 * flow ** 2 * (outer ** -4 - r ** -4)) / (1 / r - 1 / outer) - 2 * r * u * u)
                         / r ** 2])
    return rate


def peaks(t, x):
    """Times and values of the maxima, by parabolas."""
    at = [k for k in range(1, len(x) - 1) if x[k - 1] < x[k] >= x[k + 1]]
    fit = [np.polyfit(t[k - 1:k + 2] - t[k], x[k - 1:k + 2], 2) for k in at]
    return np.array([(t[k] - b / (2 * a), c - b * b / (4 * a)) for k, (a, b, c) in zip(at, fit)])


def breathes(name, options, dim, period):
    """The bubble's period (relative error at most 'period') and amplitude (3 %); the gas gives what the liquid has."""
    folder = runs.run(options, name)
    got, dt = pockets(folder), 2e-6
    exact = steps(breathing(dim), (INNER, 0), dt, int(got["time"][-1] / dt))[:, 0] ** dim / INNER ** dim
    exact, found = peaks(dt * np.arange(len(exact)), exact), peaks(got["time"], got["volume"] / got["volume"][0])
    if not runs.check(len(found) == len(exact) > 1, f"{name}_peaks", f"{len(found)} peaks, not {len(exact)}"):
        return folder
    ratio = np.diff(found[:, 0]).mean() / np.diff(exact[:, 0]).mean()
    runs.check_within(ratio, 1 - period, 1 + period, f"{name}_period")
    runs.check_within((found[-1, 1] - 1) / (exact[-1, 1] - 1), 0.97, 1.03, f"{name}_amplitude")
    return folder


whole = breathes("plane", PLANE, 2, 0.005)
breathes("rings", RINGS, 3, 0.01)
breathes("half", HALF, 2, 0.005)
volume = pockets(runs.run(DEEP, "deep"))["volume"][0]  # the settling of coarse liquid must not press the bubble
runs.check_within(volume / (4 / 3 * np.pi * INNER ** 3), 0.95, 1.05, "graded_start_keeps_the_volume")
series = runs.series(whole)
most = series["kinetic_energy"].argmax()
runs.check_within(series["outside_work"][most] / series["kinetic_energy"][most], 0.97, 1.03, "work_of_the_gas")

change = np.abs(np.diff(series["outside_work"])).sum()
runs.check_below(abs(series["outside_work"][-1] - series["kinetic_energy"][-1]) / change, 0.01, "energy_of_the_gas")

# implicit viscosity: seven times the explicit step
syrup = pockets(runs.run(PLANE + "-shell_viscosity 10", "syrup"))
exact = steps(breathing(2, 10), (INNER, 0), 2e-6, int(syrup["time"][-1] / 2e-6))[:, 0] ** 2 / INNER ** 2
exact, found = peaks(2e-6 * np.arange(len(exact)), exact), peaks(syrup["time"], syrup["volume"] / syrup["volume"][0])
runs.check_within((found[1, 1] - 1) / (found[0, 1] - 1) * (exact[0, 1] - 1) / (exact[1, 1] - 1), 0.95, 1.05,
                  "syrup_damps")
runs.check_within((found[1, 0] - found[0, 0]) / (exact[1, 0] - exact[0, 0]), 0.98, 1.02, "syrup_period")

# a tenth of a period a step: stable, 5 % too slow
long = pockets(runs.run(PLANE + "-time_step 1e-3 -time_end 0.05", "long"))
found = peaks(long["time"], long["volume"] / long["volume"][0])
runs.check_within(np.diff(found[:, 0]).mean() / 0.009996, 1, 1.06, "long_steps_period")
runs.check_within((found[-1, 1] - 1) / (found[0, 1] - 1), 0.75, 1.05, "long_steps_are_stable")

one = pockets(whole)
for ranks in 2, 3, 4:
    more = pockets(runs.run(PLANE + "-time_end 5e-3", f"ranks_{ranks}", ranks=ranks))
    for column in ("pressure", "volume", "amount"):
        off = abs(more[column][-1] / one[column][len(more[column]) - 1] - 1)
        runs.check_below(off, 1e-6, f"{column}_on_{ranks}_ranks")
halves = runs.run(PLANE + "-time_end 8e-3 -checkpoint_interval 4e-3", "halves")
again = runs.run(PLANE + f"-time_end 8e-3 -checkpoint_interval 4e-3 -restart {halves}/checkpoint_000040.h5", "again")
for column in ("volume", "pressure", "amount", "x"):
    values = [pockets(folder)[column][-1] for folder in (halves, again)]
    runs.check(values[0] == values[1], f"restart_keeps_{column}", f"{values}")

# cells that are kept for some steps against cells that are filled anew, as they are after each checkpoint: of a bubble
# that breathes (the short relaxation time makes it follow its cells), and of one that moves by 0.3 spacings a step
for name, options, most in (("breathing", "-pressure_relaxation_time 1e-3 -time_end 8e-3 ", 0.025),
                            ("moving", "-shell_velocity 3,1 -time_end 2e-3 ", 0.025)):
    kept, anew = (pockets(runs.run(PLANE + options + f"-checkpoint_interval {interval}", f"{name}_{way}"))
                  for way, interval in (("kept", 0), ("anew", 1e-4)))
    for column in ("volume", "pressure"):
        runs.check_below(abs(kept[column] - anew[column]).max() / np.ptp(anew[column]), most,
                         f"kept_cells_of_a_{name}_bubble_have_its_{column}")

# eight metres of liquid fall on two metres of gas
COLUMN = """-dimension 2 -spacing 0.25 -box_lower 0,0 -box_upper 2.5,20 -box_x symmetry -box_ymin wall -bodies water
 -water_lower 0,2 -water_upper 2.5,10 -water_viscosity 0 -gravity 0,-9.81 -gas -gauge_pockets -series_interval 0
 -snapshot_interval 1 -checkpoint_interval 0 -time_step 4e-3 -time_end 1 """
fall = steps(lambda y: np.array([y[1], 101325 * ((2 / y[0]) ** GAMMA - 1) / (RHO * 8) - 9.81]), (2, 0), 1e-4,
             10000)[:, 0]
got = pockets(runs.run(COLUMN, "column"))
runs.check_within(got["pressure"].max() / (101325 * ((2 / fall.min()) ** GAMMA - 1)), 0.99, 1.01, "column_on_gas")
got = pockets(runs.run(COLUMN + "-gas_exponent 0 -time_end 0.1", "constant"))
runs.check_within(got["volume"].min() / got["volume"].max(), 0.998, 1, "constant_volume")
runs.check_within(got["pressure"][-10:].mean() / (RHO * 8 * 9.81), 0.95, 1.05, "pressure_of_constant_volume")

# gas so wide that blocks of its cells are empty, some of them beyond the box
got = pockets(runs.run(COLUMN + "-water_lower 0,8 -water_upper 2.5,12 -time_end 4e-3", "wide"))
runs.check_within(got["volume"][0] / (8 * 2.5), 0.99, 1.01, "volume_of_wide_gas")

# layers of liquid that rows look through, at rest on a lattice: one of three spacings bears 0.72 of its weight
for layers, least, most in ((3, 0.68, 0.9), (6, 0.95, 1.05)):
    layer = f"-gas_exponent 0 -water_upper 2.5,{2 + layers / 4} -packing_jitter 0 -time_end 0.1"
    thin = pockets(runs.run(COLUMN + layer, f"layer_{layers}"))
    runs.check_within(thin["pressure"][-10:].mean() / (RHO * layers / 4 * 9.81), least, most,
                      f"pressure_below_{layers}_spacings")

# a plate of liquid falls on a cup of solids and encloses air; without gas that air does not resist
CUP = """-dimension 2 -spacing 0.01 -box_lower -0.4,0 -box_upper 0.4,0.6 -bodies plate -plate_lower -0.25,0.34
 -plate_upper 0.25,0.44 -plate_velocity 0,-1 -plate_viscosity 1e-3 -gravity 0,-9.81 -solids left,right,bottom
 -left_lower -0.16,0.1 -left_upper -0.1,0.3 -right_lower 0.1,0.1 -right_upper 0.16,0.3 -bottom_lower -0.16,0.04
 -bottom_upper 0.16,0.1 -time_end 0.12 -snapshot_interval 1 -series_interval 5e-3 -checkpoint_interval 0 """
air = runs.run(CUP + "-gas -gauge_pockets", "air")
series, without = runs.series(air), runs.series(runs.run(CUP, "no_air"))
inside = 0.2 * 0.2  # m2
runs.check_within(pockets(air)["amount"][0] / inside, 0.98, 1.02, "air_when_the_cup_closes")
runs.check_within(series["gas_volume_m2"][-1], 0.85 * inside, 1.1 * inside, "air_in_the_cup")
runs.check(series["gas_pockets"][1] == 0, "cup_is_open_at_first", series["gas_pockets"][1])
runs.check(np.nanmax(series["gas_pressure_max_Pa"]) > 300, "air_resists", series["gas_pressure_max_Pa"])
same = series["time"] < 0.03  # nothing is enclosed
runs.check((series["kinetic_energy"][same] == without["kinetic_energy"][same]).all(), "no_pocket_no_difference",
           f"{series['kinetic_energy'][same]} {without['kinetic_energy'][same]}")

for options, word in (("-gauge_pockets", "needs -gas"), ("-gas -gas_exponent -1", "-gas_exponent")):
    process = runs.start(PLANE.replace("-gas -gauge_pockets", "") + options + f" -output_dir {runs.scratch('bad')}")
    runs.check(process.returncode != 0 and word in process.stdout + process.stderr, f"refuses: {options}",
               (process.stdout + process.stderr)[-300:])
process = runs.start("""-dimension 2 -spacing 0.04 -box_lower 0,0 -box_upper 1,0.8 -box_x wall -box_y wall -gas
 -gas_exponent 0 -bodies jet,pool -jet_type emitter -jet_lower 0.4,0.6 -jet_upper 0.6,0.8 -jet_velocity 0,-1
 -pool_upper 1,0.3 -gravity 0,-9.81 -time_end 0.5 -output_dir """ + runs.scratch("filled"))
runs.check(process.returncode > 0 and "should keep" in process.stderr, "constant_volume_that_cannot_be_kept",
           process.stderr[-300:])
MIRRORED = """-dimension 2 -spacing 0.02 -box_lower -0.5,-0.5 -box_upper 0.5,0.5 -box_x wall -box_y wall -bodies water
 -water_lower -0.5,-0.5 -water_upper 0.5,0.5 -water_holes h -h_shape sphere -h_radius 0.2 -h_center 0,0 -gas
 -gas_pressure_start 2e5 -gauge_pockets -gauge_points 0.05,0.05 -packing_jitter 0 -time_end 2e-3 -series_interval 0 """
whole, quarter = (runs.run(MIRRORED + more, name) for name, more in (
    ("whole", ""), ("quarter", "-box_lower 0,0 -water_lower 0,0 -box_xmin symmetry -box_ymin symmetry "
                               "-gauge_multiplicity 4")))
of_whole, of_quarter = pockets(whole), pockets(quarter)
for column in ("volume", "amount", "pressure", "number"):
    runs.check_within(of_quarter[column][-1] / of_whole[column][-1], 0.98, 1.02, f"pocket_of_a_quarter_{column}")
runs.check_below(max(abs(of_quarter[column][-1]) for column in "xy"), 1e-12, "pocket_of_a_quarter_centre")
series = runs.series(whole)
runs.check_below(abs(series["point_1_pressure_Pa"][-1] / of_whole["pressure"][-1] - 1), 1e-9,
                 "pressure_at_a_point_in_gas")
process = runs.start(COLUMN + f"-energy_max 1e-3 -output_dir {runs.scratch('bound')}")
runs.check("-energy_max" in process.stdout + process.stderr, "gas_at_rest_brings_no_energy",
           (process.stdout + process.stderr)[-300:])
process = runs.start(PLANE + f"-time_end 2e-3 -energy_max 1e-3 -output_dir {runs.scratch('free')}")
runs.check(process.returncode == 0, "gas_under_pressure_does", (process.stdout + process.stderr)[-300:])
runs.done()
