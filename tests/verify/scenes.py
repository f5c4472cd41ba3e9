#!/usr/bin/python3
"""Solids, STL shapes, emitters and their gauges: a tank on a solid floor against one on a wall of the box, the buoyancy
of a ball, a box from an STL file against the shape box, liquid from an emitter and its restart."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

TANK = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,0.8 -box_x wall -box_ymin wall -gravity 0,-9.81
 -bodies water -packing_jitter 0 -time_end 0.3 -checkpoint_interval 0 -gauge_forces """
HEAD = 9810  # Pa/m
CUBE = ((0, 1, 3), (0, 3, 2), (4, 7, 5), (4, 6, 7), (0, 5, 1), (0, 4, 5), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4),
        (1, 5, 7), (1, 7, 3))


def late(folder, name):
    """Mean of a column over the second half of the run."""
    column = runs.series(folder)[name]
    return column[len(column) // 2:].mean()


LINE = " -gauge_lines 0.5,0.05,0.5,0.35 -gauge_line_points 7"
wall = runs.run(TANK + "-water_upper 1,0.4 -gauge_points 0.5,0.01 -gauge_heights 0.3" + LINE, "wall")
floor = runs.run(TANK + "-water_upper 1,0.6 -solids floor -floor_upper 1,0.2 -gauge_points 0.5,0.21 -gauge_heights 0.3",
                 "floor")
pressures = [late(folder, "point_1_pressure_Pa") for folder in (wall, floor)]
runs.check_within(pressures[1] / pressures[0], 0.99, 1.01, "solid_floor_as_wall")
runs.check_within(late(wall, "height_1_m"), 0.397, 0.403, "height_over_wall")
runs.check_within(late(floor, "height_1_m"), 0.597, 0.603, "height_over_solid")
runs.check_within(-late(floor, "force_floor_y_Nm") / (HEAD * 0.4), 0.975, 1.025, "force_on_floor")
SPHERE = "-solids ball -ball_shape sphere -ball_center 0.5,0.2 -ball_radius 0.1"
ball = runs.run(TANK + "-water_upper 1,0.4 " + SPHERE, "ball")
runs.check_within(late(ball, "force_ball_y_Nm") / (HEAD * np.pi * 0.01), 0.93, 1.07, "buoyancy")
runs.check(os.path.exists(os.path.join(ball, "solids.h5")), "solids_file", "missing")

# lines, droplets and budgets: pressure along a vertical, two drops that fly off a pool, their energy and volume
rows = np.genfromtxt(os.path.join(wall, "lines.csv"), delimiter=",", names=True)
rows = rows[rows["step"] == rows["step"].max()]
runs.check(len(rows) == 7 and np.allclose(rows["y_m"], np.linspace(0.05, 0.35, 7)), "line_points", rows["y_m"])
runs.check_below(np.abs(rows["pressure_Pa"] / (HEAD * (0.4 - rows["y_m"])) - 1).max(), 0.05, "pressure_along_line")
runs.check_within(runs.series(wall)["volume"][-1] / 0.4, 0.9999, 1.0001, "volume")
runs.check_within(runs.series(wall)["potential_energy"][-1] / (HEAD * 0.4**2 / 2), 0.99, 1.01, "potential_energy")
FLY = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,1 -box_ymin wall -packing_jitter 0
 -bodies water,left,right -water_upper 1,0.2 -left_lower 0.1,0.5 -left_upper 0.3,0.6 -left_velocity 0.3,0.1
 -right_lower 0.6,0.6 -right_upper 0.7,0.7 -right_velocity 0,0.2 -time_end 0.05 -time_step 0.005
 -gauge_droplets -right_density 1100 -checkpoint_interval 0"""
fly = runs.run(FLY, "fly", ranks=2)
table, s = np.genfromtxt(os.path.join(fly, "droplets.csv"), delimiter=",", names=True), runs.series(fly)
table = table[table["step"] == table["step"].max()]
runs.check(s["droplets"][-1] == 2 and s["spray"][-1] == 0 and len(table) == 2, "droplets_counted", s["droplets"][-1])
runs.check(np.allclose(table["volume_m2"], (0.02, 0.01), rtol=1e-3), "droplet_volumes", table["volume_m2"])
runs.check(np.allclose(s["droplet_volume_m2"][-1], 0.03, rtol=1e-3) and np.allclose(s["largest_droplet_m2"][-1], 0.02,
                                                                                     rtol=1e-3), "droplet_columns", "")
velocity = np.column_stack([table["velocity_x_ms"], table["velocity_y_ms"]])
runs.check_below(np.abs(velocity - ((0.3, 0.1), (0, 0.2))).max(), 2e-3, "droplet_velocities")
places = np.column_stack([table["x_m"], table["y_m"]])
runs.check_below(np.abs(places - ((0.215, 0.555), (0.65, 0.66))).max(), 2e-3, "droplet_places")
runs.check_within(s["kinetic_energy"][-1] / (1000 * 0.02 * 0.05 + 1100 * 0.01 * 0.02), 0.98, 1.02, "kinetic_energy")

corners = [(x, y, z) for z in (-50, 50) for y in (0, 200) for x in (400, 600)]
path = runs.scratch("cube.stl")
with open(path, "w", encoding="utf-8") as file:
    file.write("solid cube\n")
    for triangle in CUBE:
        file.write("facet normal 0 0 0\nouter loop\n")
        for corner in triangle:
            file.write("vertex {} {} {}\n".format(*corners[corner]))
        file.write("endloop\nendfacet\n")
    file.write("endsolid\n")
both = []
for name, shape in (("box", "-step_lower 0.4,0 -step_upper 0.6,0.2"),
                    ("stl", f"-step_shape stl -step_file {path} -step_scale 1e-3")):
    both.append(runs.run(TANK + f"-water_upper 1,0.4 -solids step {shape} -time_end 0.02", "step_" + name))
fields = [runs.fields(runs.numbered(folder, "snapshot")[-1]) for folder in both]
same = len(fields[0]["id"]) == len(fields[1]["id"])
runs.check(same, "stl_as_box_particles", [len(f["id"]) for f in fields])
if same:
    runs.check_below(np.abs(fields[0]["position"] - fields[1]["position"]).max(), 1e-3, "stl_as_box_positions")

JET = """-dimension 2 -spacing 0.1e-3 -box_lower -2e-3,0 -box_upper 2e-3,10e-3 -bodies jet -jet_type emitter
 -jet_lower -0.5e-3,9e-3 -jet_upper 0.5e-3,9.5e-3 -jet_velocity 0,-1 -time_step 2e-5 """
whole = runs.run(JET + "-time_end 2.1e-3 -checkpoint_interval 1e-3", "jet")
count = len(runs.fields(runs.numbered(whole, "snapshot")[-1])["id"])
runs.check(count == 26 * 10, "jet_of_26_rows", f"{count} particles, not 260")  # five at the start, then one each 0.1 ms
last = runs.fields(runs.numbered(whole, "snapshot")[-1])
runs.check(len(set(last["id"])) == count, "emitted_ids_differ", "they do not")
y = np.sort(last["position"][:, 1])
runs.check_below(np.diff(y).max(), 0.2e-3, "jet_without_gaps")
first = runs.numbered(whole, "checkpoint")[0]
resumed = runs.run(JET + f"-time_end 2.1e-3 -restart {first}", "jet_resumed")
again = runs.fields(runs.numbered(resumed, "snapshot")[-1])
good = len(again["id"]) == count and np.array_equal(again["id"], last["id"])
runs.check(good and np.array_equal(again["position"], last["position"]), "emitter_restarts_exactly", "states differ")
printed = runs.run(JET + "-scheme density_invariant -steps_max 1", "jet_printed")  # this scheme does not settle
first, unmoved = (runs.fields(runs.numbered(folder, "snapshot")[0]) for folder in (whole, printed))
runs.check(len(first["id"]) == 5 * 10 and np.array_equal(first["position"], unmoved["position"]),
           "liquid inside an emitter is not moved before the start", "it is")
# a periodic box falls through itself: what has left it is brought back before its neighbours are out of reach
GRAVITY = 1
FALL = f"""-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 2,2 -box_x periodic -box_y periodic -bodies a
 -a_velocity 0,1 -packing_jitter 0.1 -gravity 0,{GRAVITY} -time_step 0.02 -steps_max 95 -series_interval 1e-9
 -checkpoint_interval 0"""
series = runs.series(runs.run(FALL, "periodic_fall"))
speed = np.sqrt(2 * series["kinetic_energy"][-1] / (1000 * 2 * 2))
runs.check_within(speed / (1 + GRAVITY * series["time"][-1]), 1 - 1e-4, 1 + 1e-4, "speed_of_a_periodic_fall")
runs.check_below(series["highest"].max(), 2.25, "highest_particle_of_a_periodic_fall")
# a sheet without viscosity leaves the edge of a plate: it goes straight on and pulls at nothing
SPEED = 0.5
SHEET = f"""-dimension 2 -spacing 1e-3 -box_lower -30e-3,-20e-3 -box_upper 40e-3,20e-3 -bodies a,b -a_lower -25e-3,0
 -a_upper 0,8e-3 -a_velocity {SPEED},0 -b_type emitter -b_lower -30e-3,0 -b_upper -25e-3,8e-3 -b_velocity {SPEED},0
 -solids plate -plate_lower -30e-3,-6e-3 -plate_upper 0,0 -gauge_forces -time_end 0.1 -checkpoint_interval 0"""
folder = runs.run(SHEET, "sheet")
last = runs.fields(runs.numbered(folder, "snapshot")[-1])
gone = (last["body"] >= 0) & (last["position"][:, 0] > 5e-3)
away = np.abs(last["velocity"][gone].mean(axis=0) / SPEED - (1, 0, 0)).max()
runs.check_below(away, 0.01, "a_sheet_goes_straight_on")
pull = runs.series(folder)["force_plate_y_Nm"][-20:].mean()
runs.check_below(abs(pull) / (1000 * SPEED**2 * 8e-3), 0.01, "a_sheet_pulls_at_no_edge")
# Syrup falls into a tank whose walls have a contact angle; spacings grow away from the middle of the floor. Each
# particle's images in the walls are those within its own support: with the support of another one a coarse particle had
# a slope of the pressure of 1e28 Pa/m.
SYRUP = """-dimension 3 -spacing 0.04 -spacing_coarse 0.08 -fine near -near_shape sphere -near_radius 0.15
 -near_center 0,0,0 -box_lower -0.4,-0.2,0 -box_upper 0.4,0.2,0.8 -box_x wall -box_y wall -box_zmin wall -gravity 0,0,-1
 -wall_contact_angle 60 -bodies a,b -a_upper 0.4,0.2,0.3 -a_viscosity 1 -a_tension 10 -b_lower -0.15,-0.1,0.348
 -b_upper 0.15,0.1,0.548 -b_velocity 0,0,-2 -b_viscosity 300 -b_tension 40 -kernel_type quintic_spline
 -packing_jitter 0.1 -steps_max 20 -checkpoint_interval 0 """
for seed in (897, 2, 4):
    series = runs.series(runs.run(SYRUP + f"-packing_seed {seed}", f"syrup_{seed}"))
    runs.check_below(series["kinetic_energy"].max(), 1.05 * series["kinetic_energy"][0], f"energy of syrup, {seed}")
runs.done()
