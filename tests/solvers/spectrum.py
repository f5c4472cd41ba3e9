#!/usr/bin/python3
"""-spectrum against theory: the lattice's largest eigenvalue, the smallest of a film and of a periodic box, the
condition that CG's own Lanczos process sees, the bound of its iterations; the explicit limit of viscosity, which runs
below and above it confirm; the modes of a drop."""
import math
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

NUMBER = r"(-?[\d.]+(?:e[+-]?\d+)?|nan)"
BOX = """-dimension 3 -spacing 0.1 -box_lower 0,0,0 -box_upper 1,1,1 -box_x periodic -box_y periodic -box_z periodic
 -bodies water -water_shape box -water_density 1 -water_viscosity 0.01 -water_velocity_type formula
 -checkpoint_interval 0 -packing_jitter 0"""
VORTICES = " -water_velocity_formula 0-{0}*cos(2*pi*x)*sin(2*pi*y),{0}*sin(2*pi*x)*cos(2*pi*y),0"
FILM = ("-options_file cases/film_at_rest/case.opts -box_lower -2e-3,-2e-3,-10e-3 -box_upper 2e-3,2e-3,5e-3 "
        "-film_lower -2e-3,-2e-3,-10e-3 -film_upper 2e-3,2e-3,0 -steps_max 2 -packing_jitter 0")
DROP = """-dimension 3 -box_lower -2e-3,-2e-3,-2e-3 -box_upper 2e-3,2e-3,2e-3 -bodies drop -drop_shape sphere
 -drop_center 0,0,0 -drop_radius 1.5e-3 -drop_density 1100 -drop_viscosity 0 -drop_tension 0.067 -packing_jitter 0
 -checkpoint_interval 0 -steps_max 30"""


def report(options, name):
    """What -spectrum prints at the end of a run."""
    place = runs.scratch(name.replace(" ", "_"))
    process = runs.start(options.replace("\n", "") + f" -spectrum -progress_interval 0 -output_dir {place}")
    if not runs.check(process.returncode == 0, f"{name}, runs", process.stderr.strip()[-500:]):
        runs.done()
    return process.stdout[process.stdout.index("Spectrum"):]


def numbers(text, pattern):
    """The numbers that a pattern, with N for a number, finds in the report."""
    found = re.search(pattern.replace("N", NUMBER), text)
    if not runs.check(found is not None, f"the report has {pattern.split('N')[0].strip()}", text):
        runs.done()
    return [float(word) for word in found.groups()]


def solver(text, name):
    """The condition, by SLEPc and as CG saw it, and the bound of the iterations."""
    most, least, condition = numbers(text, r"twolevel\n +largest +N, smallest N, condition N")
    seen = numbers(text, r"CG saw +N, N, N")
    runs.check_within(seen[0] / most, 0.97, 1.005, f"{name}, largest, CG over SLEPc")
    runs.check_within(seen[1] / least, 0.995, 1.05, f"{name}, smallest, CG over SLEPc")
    runs.check_within(condition, 3, 5, f"{name}, condition under the own preconditioner")
    iterations, _, bound = numbers(text, r"iterations N from zero to N; at most N by")
    runs.check_within(iterations, 2, bound, f"{name}, iterations within the bound of the condition")


def below(name, step):
    """That the limit stands beside the step of the run, which is below it."""
    times = step[1] / runs.series(runs.scratch(name.replace(" ", "_")))["time_step"][-1]
    runs.check_within(step[2] / times, 0.97, 1.03, f"{name}, the limit over the step")
    runs.check(times > 1, f"{name}, the step is below the capillary limit", times)


def box():
    """The full lattice and the explicit limit of viscosity."""
    full = report(BOX + VORTICES.format(1e-6) + " -steps_max 1", "box")
    largest, seen = numbers(full, r"largest +N? ?1/m2 = N/d0\^2; a full lattice has N/d0".replace("N? ?", r"[\d.e+]+ "))
    runs.check_within(seen, 3.53, 3.54, "3.53/d0^2 of a full lattice")
    runs.check_within(largest / seen, 0.999, 1.005, "largest eigenvalue of a full box over that")
    smallest, theory = numbers(full, r"smallest +N 1/m2; theory N 1/m2")
    runs.check_within(theory, 39.4, 39.5, "(2 pi/L)^2 of a box of 1 m")
    runs.check_within(smallest / theory, 0.93, 1.01, "smallest eigenvalue of a full box over that")
    viscous, limit = numbers(full, r"viscosity +largest eigenvalue [\d.e+]+ 1/s = N nu/d0\^2: "
                             "stable up to 2/lambda = N s")
    runs.check_within(viscous, 6.41, 6.43, "largest eigenvalue of the viscosity, 6.421 nu/d0^2 of a full lattice")

    # a viscosity that makes it the only thing that counts; 60 steps below and above the limit
    stiff = BOX.replace("viscosity 0.01", "viscosity 100") + VORTICES.format(1) + " -shifting 0 -packing_jitter 0.05"
    limit = numbers(report(stiff + " -steps_max 1", "stiff"), r"2/lambda = N s")[0]
    for factor, stable in ((0.9, True), (1.1, False)):
        folder = runs.scratch(f"stiff_{factor}")
        process = runs.start((stiff + f" -time_step {factor * limit:.6g} -steps_max 60 -series_interval 0 "
                              "-viscosity_solver explicit -energy_max 0 -displacement_max 1e9 "
                              "-progress_interval 0").replace("\n", "").split() +
                             ["-output_dir", folder])
        energy = runs.series(folder)["kinetic_energy"] if process.returncode == 0 else [1.0, math.inf]
        runs.check((energy[-1] < energy[0]) == stable, f"viscosity at {factor} of its limit is " +
                   ("stable" if stable else "unstable"), f"kinetic energy from {energy[0]:.3g} to {energy[-1]:.3g} J")


def waves():
    """The first waves of a tube and a film; a splash."""
    # rings in a closed tube of radius R: (3.8317/R)^2, the first wave across it, the zero of J1
    errors = []
    for spacing in (0.5e-3, 0.25e-3):
        tube = report(f"""-dimension axisymmetric -spacing {spacing} -box_lower 0,0 -box_upper 12e-3,4e-3 -box_xmax wall
     -box_y periodic -bodies water -water_velocity 0,0.01 -packing_jitter 0 -steps_max 1 -checkpoint_interval 0 """,
                      f"tube {spacing}")
        errors.append(1 - numbers(tube, r"smallest +N 1/m2")[0] / (3.83171 / 12e-3)**2)
    runs.check_within(errors[0], 0.0, 0.1, "first wave across a tube, relative error")
    runs.check_within(errors[0] / errors[1], 1.5, 2.6, "first wave across a tube, the error halves with the spacing")

    errors = []
    for spacing in (1e-3, 0.5e-3):
        film = report(f"{FILM} -spacing {spacing}", f"film {spacing}")
        smallest, theory = numbers(film, r"smallest +N 1/m2; theory N 1/m2")
        errors.append(1 - smallest / theory)
        solver(film, f"film {spacing}")
    runs.check_within(errors[0], 0.0, 0.25, "(pi/2H)^2 of a film 10 spacings deep, relative error")
    runs.check_within(errors[1], 0.0, 0.13, "(pi/2H)^2 of a film 20 spacings deep, relative error")
    runs.check_within(errors[0] / errors[1], 1.5, 2.6, "(pi/2H)^2, the error halves with the spacing")

    # the scene of README, finer, as its drop touches the film: the largest eigenvalue is then a displacement that grows
    splash = report("""-dimension 2 -spacing 0.25e-3 -box_lower -5e-3,-2e-3 -box_upper 5e-3,10e-3 -box_x periodic
     -box_ymin wall
     -bodies film,drop -film_shape box -film_upper 5e-3,0 -film_tension 0.072 -drop_shape sphere -drop_center 0,1.5e-3
     -drop_radius 1e-3 -drop_tension 0.072 -drop_velocity 0,-1 -gravity 0,-9.81 -checkpoint_interval 0 -steps_max 5""",
                    "splash")
    step = numbers(splash, r"tension +largest frequency N 1/s: stable up to 2/omega = N s, N times the step")
    runs.check_within(step[0] * step[1], 1.99, 2.01, "splash, 2/omega")
    below("splash", step)
    runs.check_within(numbers(splash, "a displacement grows at N 1/s")[0], 500, 5000, "splash, rate of growth, 1/s")


def drop():
    """The modes of a drop."""
    modes = {}
    for cells in (12, 16):
        text = report(f"{DROP} -spacing {1.5e-3 / cells:.9g}", f"drop {cells}")
        step = numbers(text, r"tension +largest frequency N 1/s: stable up to 2/omega = N s, N times the step")
        runs.check_within(step[0] * step[1], 1.99, 2.01, f"R/d0 = {cells}, 2/omega")
        below(f"drop {cells}", step)
        modes[cells] = {int(n): (float(mean), float(low), float(high), int(count)) for n, mean, low, high, count in
                         re.findall(rf"degree (\d)  mean +{NUMBER} \(theory +\d+\), from +{NUMBER} to +{NUMBER}, "
                                    r"(\d+) modes", text)}
    for degree, exact, tolerance in ((1, 0, None), (2, 8, 0.03), (3, 30, 0.06), (4, 72, 0.10)):
        mean, low, high, count = modes[16][degree]
        runs.check(count == 2 * degree + 1, f"multiplicity of degree {degree}", f"{count}, not {2 * degree + 1}")
        if degree == 1:
            runs.check(max(abs(low), abs(high)) < 0.01, "degree 1 is a translation", f"{low} to {high}")
            continue
        runs.check_within(mean / exact, 1 - tolerance, 1.02, f"omega^2 of degree {degree} over {exact} sigma/(rho R^3)")
        runs.check_within((high - low) / mean, 0, 0.04, f"degree {degree}, spread of its modes")
        limit = mean + (mean - modes[12][degree][0]) / ((16 / 12)**2 - 1)  # of second order
        runs.check_within(limit / exact, 0.97, 1.03, f"omega^2 of degree {degree}, extrapolated, over {exact}")


PARTS = {part.__name__: part for part in (box, waves, drop)}
for chosen in runs.parts(*PARTS):
    PARTS[chosen]()
runs.done()
