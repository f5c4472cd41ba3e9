#!/usr/bin/python3
"""A scene in space begins from rings: they become particles with their volume, momentum, energy and what they carry,
on any number of ranks, with a disturbance if one is named; rings that are not of the scene are refused."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

# A hot drop with polymers has just hit a film.
LIQUID = """-bodies film,drop -drop_shape sphere -drop_radius 3e-3 -film_density 1100 -film_viscosity 3.5e-3
 -drop_viscosity 3.5e-3 -film_tension 0.067 -drop_tension 0.067 -drop_density 1100 -film_thermal_conductivity 0.6
 -drop_thermal_conductivity 0.6 -film_temperature 300 -drop_temperature 320 -film_polymer_modulus 50
 -drop_polymer_modulus 50 -film_relaxation_time 1 -drop_relaxation_time 1 -snapshot_double -box_ymin wall
 -progress_interval 0 """
RINGS = LIQUID + """-dimension axisymmetric -spacing 0.25e-3 -spacing_coarse 1e-3 -spacing_follow surface
 -box_lower 0,-6e-3 -box_upper 13e-3,12e-3 -box_xmax wall -gravity 0,-9.81 -film_lower 0,-6e-3 -film_upper 13e-3,0
 -drop_center 0,3.8e-3 -drop_velocity 0,-3 -time_end 6e-4 -snapshot_interval 6e-4"""
SPACE = LIQUID.replace("-box_ymin wall", "-box_zmin wall") + """-dimension 3 -spacing 0.5e-3 -spacing_coarse 1e-3
 -spacing_follow surface -box_upper 9e-3,9e-3,12e-3 -gravity 0,0,-9.81 -film_upper 9e-3,9e-3,0
 -drop_center 0,0,3.8e-3 -drop_velocity 0,0,-3 -steps_max 12 -time_end 1 -snapshot_interval 1 """
QUARTER = SPACE + "-box_x symmetry -box_y symmetry -box_lower 0,0,-6e-3 -film_lower 0,0,-6e-3 "
HALF = SPACE + "-box_x symmetry -box_y periodic -box_lower 0,-9e-3,-6e-3 -film_lower 0,-9e-3,-6e-3 "


def sums(path, share, inside):
    """Of the liquid in a snapshot that is this share of the whole: volume, momentum along the axis and away from it,
    kinetic energy, heat of the drop, stretch of the polymers away from the axis and along; of what is 'inside' a radius
    where little moves."""
    data = runs.fields(path)
    x, v, volume = data["position"], data["velocity"], data["volume"] / share
    rings = not v[:, 2].any()
    r = x[:, 0] if rings else np.hypot(x[:, 0], x[:, 1])
    c, s = (1, 0) if rings else x[:, :2].T / r
    out, S = v[:, 0] * c + v[:, 1] * s * (not rings), data["stretch"].T
    stretch = S[0] + S[3] if rings else S[0] * c ** 2 + S[1] * s ** 2 + 2 * S[3] * c * s + S[4] * c + S[5] * s
    values = (volume * v[:, 1 if rings else 2], volume * out, volume * (v ** 2).sum(1) / 2,
              volume * (data["temperature"] - 300), volume * stretch)
    return np.array([value[r < inside].sum() for value in values]), volume[r < inside].sum()


def modes(path):
    """Even modes to 16, around the axis, of the liquid's velocity away from it over the mean, 3 to 8 mm from the axis,
    where a ring has particles for them and the box no corners."""
    data = runs.fields(path)
    x, v = data["position"], data["velocity"]
    r, angle = np.hypot(x[:, 0], x[:, 1]), np.arctan2(x[:, 1], x[:, 0])
    out = data["volume"] * (v[:, 0] * x[:, 0] + v[:, 1] * x[:, 1]) / r * (abs(r - 5.5e-3) < 2.5e-3)
    return {m: 2 * (out * np.cos(m * angle)).sum() / out.sum() for m in range(2, 17, 2)}


def main():
    rings = runs.run(RINGS, "rings")
    last = runs.numbered(rings, "snapshot")[-1]
    for name, options, share in (("quarter", QUARTER, 1 / 4), ("half", HALF, 1 / 2)):
        space = runs.run(options + "-restart " + rings, name)
        snapshots = runs.numbered(space, "snapshot")
        moved, volume = sums(last, 1, 8e-3)
        began, filled = sums(snapshots[0], share, 8e-3)
        for what, a, b in zip(("momentum", "momentum_outwards", "energy", "heat", "stretch"), moved, began):
            runs.check_below(abs(b / a - 1), 0.01 if what == "energy" else 1e-3, f"{name}_{what}")
        runs.check_below(abs(filled / volume - 1), 0.01, f"{name}_volume")
    two = runs.run(QUARTER + "-restart " + rings, "two", ranks=2)
    one = runs.fields(runs.numbered(runs.scratch("quarter"), "snapshot")[0])
    other = runs.fields(runs.numbered(two, "snapshot")[0])
    runs.check(not {"velocity", "volume", "body"} & set(runs.unlike(one, other)), "two_ranks")
    runs.check_below(abs(one["position"] - other["position"]).max(), 1e-3 * 0.5e-3, "two_ranks_places")
    fingers = runs.run(QUARTER + f"-steps_max 1 -restart_disturbance 0.2*cos(8*a) -restart {rings}", "fingers")
    for mode, amplitude in modes(runs.numbered(fingers, "snapshot")[0]).items():
        runs.check_below(abs(amplitude - 0.2 * (mode == 8)), 0.005, f"disturbance_mode_{mode}")
    for name, options, why in (
            ("disturbance", QUARTER + "-restart_disturbance 0.2*cos(8*phi) ", "from \"phi"),
            ("disturbance_no_number", QUARTER + "-restart_disturbance log(0-r) ", "no number at some"),
            ("spacing", QUARTER.replace("-spacing_follow surface", "-fine core -core_upper 9e-3,9e-3,9e-3"),
             "needs -spacing_follow"),
            ("density", QUARTER.replace("-drop_density 1100", "-drop_density 1000"),
             "other liquid, without -drop_density = 1000"),
            ("box", QUARTER.replace("9e-3,9e-3", "10e-3,10e-3"), "its box is 0.013 m wide"),
            ("floor", QUARTER.replace(",-6e-3", ",-7e-3"), "begins at a height of -0.006 m")):
        process = runs.start(options + f"-restart {rings} -output_dir " + runs.scratch(name))
        runs.check(process.returncode != 0 and why in process.stderr and process.stderr.count("\n") == 1,
                   name + "_refused", process.stderr)
    process = runs.start(QUARTER + "-restart_disturbance 0.1 -output_dir " + runs.scratch("no_restart"))
    runs.check("needs -restart" in process.stderr, "disturbance_of_nothing_refused", process.stderr)
    process = runs.start(QUARTER + f"-restart_disturbance 0.1 -restart {fingers} -output_dir " + runs.scratch("space"))
    runs.check("begins from rings" in process.stderr, "disturbance_of_particles_refused", process.stderr)
    runs.done()


main()
