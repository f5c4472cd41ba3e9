#!/usr/bin/python3
"""What pictures show, by their data: a made-up run whose places, units, planes and signs are known. Figures are looked
at as matplotlib holds them, views as the camera that they ask for; windows are opened to try the display only."""
import argparse
import json
import os
import subprocess
import sys
import types

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import h5py  # noqa: E402
import matplotlib.collections  # noqa: E402
import numpy as np  # noqa: E402
import runs  # noqa: E402
import columns  # noqa: E402
import gas  # noqa: E402
import pictures  # noqa: E402
import report  # noqa: E402
import run as data  # noqa: E402
import solids as exact  # noqa: E402
import surface  # noqa: E402
from isph import tables  # noqa: E402
import viewer  # noqa: E402
import views  # noqa: E402

D0 = 0.01  # m, the spacing
LOWER, UPPER = (0.1, 0, 0), (0.4, 0.2, 0.3)
# liquid: (place, velocity, pressure, volume over D0^3); the last two are not in the section y = 0.1
LIQUID = [((0.15, 0.1, 0.05), (1, 2, 2), 900, 1), ((0.3, 0.105, 0.07), (0, 0, 0), -50, 8), ((0.2, 0.17, 0.2), (0, 3, 4),
          20, 1), ((0.2, 0.02, 0.2), (0, 0, 0.5), 30, 1)]
HEADS = [{"file": "series.csv", "name": name, "unit": unit, "head": f"{name}_{unit}" if unit else name,
         "counts": counts, "needs": needs} for name, unit, counts, needs in (
             ("time", "s", "value", []), ("step", "", "run", []), ("jet_height", "m", "value", []),
             ("kinetic_energy", "J", "sum", []), ("iterations", "", "run", ["step"]), ("highest", "m", "value", []),
             ("volume", "m3", "sum", []), ("force_xmin_x", "N/m", "sum", ["step"]), ("height_1", "m", "value", []))]
HEADS += [{"file": "snapshot", "name": name, "unit": unit, "head": name} for name, unit in (
    ("velocity", "m/s"), ("pressure", "Pa"), ("temperature", "K"))]
SERIES = {row["name"]: row for row in HEADS if row["file"] == "series.csv"}
SHAPE = views.PANEL[1] / views.PANEL[0]
FIGURES = {}


def close(got, wanted, name, tolerance=1e-6):
    got, wanted = np.asarray(got, float), np.asarray(wanted, float)
    good = got.shape == wanted.shape and np.allclose(got, wanted, rtol=tolerance, atol=1e-9)
    runs.check(good, name, f"{got.tolist()}, not {wanted.tolist()}")


def write(folder, times, lower, upper, options, liquid, solid=(), moved=(), **more):
    """A folder as a run leaves it. solid: (place, number of the solid) at the start, moved: the same in snapshots."""
    os.makedirs(folder)
    given = dict(line[1:].split() for line in options.splitlines())
    faces = [{"name": axis + end, "type": given.get(f"box_{axis}{end}", given.get(f"box_{axis}", "open"))}
             for axis in "xyz" for end in ("min", "max")]
    with open(os.path.join(folder, "scene.json"), "w", encoding="utf-8") as file:
        json.dump({"domain": {"faces": faces}, "columns": HEADS,
                   "bodies": [{"name": name} for name in given["bodies"].split(",")]}, file)
    with h5py.File(os.path.join(folder, "solids.h5"), "w") as file:
        file["position"] = np.array([place for place, _ in solid], float).reshape(-1, 3)
        file["solid"] = np.array([number for _, number in solid], int)
    for k, time in enumerate(times):
        with h5py.File(os.path.join(folder, f"snapshot_{k:06d}.h5"), "w") as file:
            rest = [place for place, _ in moved]
            file["id"] = np.arange(len(liquid) + len(rest))
            file["body"] = [0] * len(liquid) + [data.SOLID - number for _, number in moved]
            file["position"] = np.array([row[0] for row in liquid] + rest, float)
            file["velocity"] = np.array([row[1] for row in liquid] + [(0, 0, 0)] * len(rest), float)
            file["pressure"] = np.array([row[2] for row in liquid] + [0] * len(rest), float)
            file["temperature"] = np.array([300 + 10 * k for k in range(len(liquid))] + [0] * len(rest), float)
            file["stretch"] = np.tile(np.arange(1, 7.0), (len(liquid) + len(rest), 1))
            file["volume"] = np.array([row[3] for row in liquid] + [0] * len(rest), float) * more.get("each", D0**3)
            for name, value in (("time", time), ("dimension", more.get("dimension", 3)),
                                ("spacing", more.get("spacing", D0)), ("box_lower", lower), ("box_upper", upper),
                                ("axisymmetric", more.get("rings", 0))):
                file.attrs[name] = value
    return data.Run(folder)


def same(points, wanted):
    """Whether these are the same places in any order."""
    points, wanted = np.asarray(points, float), np.asarray(wanted, float)
    return len(points) == len(wanted) and all(np.isclose(wanted, p, atol=1e-9).all(axis=1).any() for p in points)


def discs(axes):
    """Centres and widths of the discs of each colour."""
    return [(np.asarray(c.get_offsets()), 2 * c._widths) for c in axes.collections]


pictures.save = lambda figure, folder, name, formats: FIGURES.update({name: figure})

# units and numbers
for seconds, words in ((0.0123, "12.3 ms"), (1.5, "1.5 s"), (1.5e-5, "15 µs"), (0, "0 s")):
    runs.check(data.duration(seconds) == words, f"time_{words}", data.duration(seconds))
for length, wanted in ((2, (1, "m")), (0.05, (1e3, "mm")), (5e-4, (1e6, "µm"))):
    runs.check(data.scale(length) == wanted, f"unit_of_{length}_m", data.scale(length))
close(data.bar(0.3), 0.05, "scale_bar_is_round")
for name, wanted in (("kinetic_energy", ("kinetic energy", "J")), ("highest", ("highest liquid", "m")),
                     ("force_xmin_x", ("force xmin x", "N/m")), ("height_1", ("height 1", "m"))):
    runs.check(columns.title(SERIES[name]) == wanted, f"title_of_{name}", columns.title(SERIES[name]))
table = tables.Table({"time_s": [0], "time_step_s": [1], "a_m": [2], "a_b_m": [3]})
runs.check(table["time"] == [0] and table["a"] == [2] and "b" not in table and table.get("a_b_m") == [3],
           "columns_without_their_unit")

# a run in space behind a mirror at x = 0.1, with a solid that has moved and one that stays
STILL, START, THERE = (0.35, 0.1, 0.02), (0.3, 0.1, 0.25), (0.3, 0.1, 0.15)
BOX = "-box_xmin symmetry\n-box_xmax wall\n-box_y periodic\n-box_zmin wall\n-bodies water\n"
run = write(runs.scratch("space"), (0, 0.0123, 0.05), LOWER, UPPER, BOX, LIQUID, [(START, 0), (STILL, 1)], [(THERE, 0)])
close(run.lower, (-0.2, 0, 0), "box_with_its_image")
runs.check(run.faces[0] == ["wall", "wall"] and run.faces[2] == ["wall", "open"], "faces", run.faces)
moments = [t for t, _ in run.moments([0.011, 0.049])]
close(moments, (0.0123, 0.05), "nearest_moments")
state = run.read(run.files[1][1])
places = np.array([row[0] for row in LIQUID])
mirror = places * [-1, 1, 1] + [0.2, 0, 0]
close(state.points, np.concatenate([places, mirror]), "places_with_their_images")
v = np.array([row[1] for row in LIQUID], float)
close(state.velocity, np.concatenate([v, v * [-1, 1, 1]]), "velocities_with_their_images")
close(state.speed[:4], (3, 0, 5, 0.5), "speed")
close(state.size[:4], (1, 2, 1, 1), "sizes")
image = [(0.2 - x, y, z) for x, y, z in (STILL, THERE)]
runs.check(same(state.solid, [STILL, THERE, *image]), "solid_that_moves_and_one_that_stays", state.solid.tolist())
ends = views.limits([state], "pressure")
runs.check(-50 <= ends[0] < 0 and 30 < ends[1] <= 900, "pressure_scale_has_both_signs", ends)
ends = views.limits([state], "speed")
runs.check(ends[0] == 0 and 3 < ends[1] <= 5, "speed_scale_starts_at_0", ends)
close(state.temperature, [300, 310, 320, 330] * 2, "temperatures_with_their_images")
close(state.stretch, [6] * 8, "trace_of_a_tensor")
ends = views.limits([state], "temperature")
runs.check(300 <= ends[0] < 301 and 329 < ends[1] <= 330, "temperature_scale_is_that_of_the_liquid", ends)
try:
    run.need("temperatur")
    refused = ""
except tables.Error as error:
    refused = str(error)
runs.check("no temperatur (" in refused and "stretch, temperature" in refused, "colour_that_is_none", refused)
ends = views.limits([state], "size")
runs.check(abs(ends[0] - 1) < 1e-9 and 1.9 < ends[1] < 2.001, "size_scale_starts_at_the_finest", ends)

# its section
arguments = argparse.Namespace(color="speed", format=["png"], azimuth=25, elevation=25, curves=None)
pictures.sections(run, [state], arguments, ends, "")
axes = FIGURES["section"].axes[0]
runs.check((axes.get_xlabel(), axes.get_ylabel(), axes.get_title()) == ("x (mm)", "z (mm)", "t = 12.3 ms"),
           "labels_of_a_section", (axes.get_xlabel(), axes.get_ylabel(), axes.get_title()))
(solids, _), (liquid, width) = discs(axes)
shown = [(150, 50), (300, 70)]
runs.check(same(liquid, shown + [(200 - x, z) for x, z in shown]), "liquid_of_a_section", liquid.tolist())
runs.check(same(solids, [(1e3 * x, 1e3 * z) for x, _, z in [STILL, THERE, *image]]), "solids_of_a_section",
           solids.tolist())
close(width, np.where(np.isclose(liquid[:, 1], 70), 20, 10), "discs_are_as_wide_as_their_spacing")
close(axes.collections[1].get_array(), np.where(np.isclose(liquid[:, 1], 70), 0, 3), "colours_of_a_section")
close(axes.get_xlim() + axes.get_ylim(), (-150 - 30, 350 + 30, 0, 200 + 30), "window_of_a_section")
thick = [line for line in axes.lines if line.get_linewidth() > 1]
lines = {(tuple(np.rint(line.get_xdata())), tuple(np.rint(line.get_ydata()))) for line in thick}
walls = {((-200, -200), (0, 300)), ((400, 400), (0, 300)), ((-200, 400), (0, 0))}
runs.check(lines == walls, "walls_of_a_section", lines)

# periodic and mirror images for the surface: a point at y = 0.02 again at 0.22, one at 0.17 at -0.03, walls mirror
points, (number,) = surface.images(run, places, [np.arange(4)], 0.04)
extra = [(0.2, 0.22, 0.2), (0.2, -0.03, 0.2)]
runs.check(same(points[4:], extra) and sorted(number[4:]) == [2, 3], "images_for_the_surface", points[4:].tolist())
points, _ = surface.images(run, np.array([(0.39, 0.1, 0.01)]), [np.arange(1)], 0.02)
extra = [(0.41, 0.1, 0.01), (0.39, 0.1, -0.01), (0.41, 0.1, -0.01)]
runs.check(same(points[1:], extra), "images_in_walls", points.tolist())

# a value that is the same everywhere is so on the surface, at the floor and at a mirror too
places = np.stack(np.meshgrid(*[D0 * (np.arange(8) + 0.5)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) + [0.1, 0, 0]
one = np.ones(len(places))
fluid = views.Fluid(run, places, 7 * one[:, None], one, one)
corners = fluid.cut(fluid.mesh()[0])
runs.check(corners[:, 2].min() == 0 and np.isclose(corners[:, 2], 0).sum() > 20, "liquid_ends_at_a_wall",
           corners.min(axis=0))
values = fluid.values(corners)
runs.check_within(values.min(), 6.9, 7, "least_value_on_the_surface")
runs.check_within(values.max(), 7, 7.1, "greatest_value_on_the_surface")

# large particles that lie unevenly make a flat surface at the liquid's level, the edges of the box too, and its section
LARGE = 4
basin = types.SimpleNamespace(lower=np.array([-0.4, -0.4, 0]), upper=np.array([0.4, 0.4, 0.5]), spacing=D0, rings=False,
                              faces=[["wall", "wall"], ["wall", "wall"], ["wall", "open"]])
film = np.stack(np.meshgrid(*[0.4 * (2 * (np.arange(n) + 0.5) / n - 1) for n in (20, 20)],
                            LARGE * D0 * (np.arange(4) + 0.5), indexing="ij"), axis=-1).reshape(-1, 3)
film[:, 2] += 0.1 * LARGE * D0 * np.random.default_rng(1).standard_normal(len(film))
one = np.ones(len(film))
filled = surface.Liquid(film, 0 * one, D0, basin.lower, basin.upper, LARGE**3 * one, LARGE * one)
points, _, cells = filled.mesh()
corner = points[cells]
facing = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
area = np.linalg.norm(facing, axis=1)
top = (corner[..., 2].mean(axis=1) > 0.1) & (np.abs(corner[..., :2]).max(axis=(1, 2)) < 0.399)
tilt = np.degrees(np.arccos(np.clip(np.abs(facing[top, 2]) / area[top], 0, 1)))
runs.check_below(np.average(tilt, weights=area[top]), 2.4, "a_surface_of_uneven_large_particles_is_flat")
held = np.einsum("ij,ij->", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])) / 6
runs.check_within(held / (LARGE * D0)**3 / len(film), 0.998, 1.002, "it_holds_their_volume")

# drops of particles of two sizes, side by side, have their volumes, and a jet of radius 1.5 on a film its height,
# though the field that they are drawn from is blurred
grid = np.stack(np.meshgrid(*[np.arange(-9, 9) + 0.5] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
drops = [each * grid[np.linalg.norm(grid, axis=1) < radius] + [at, 0, 0]
         for each, radius, at in ((1, 5, -12), (2, 3, 6))]
across, height = np.linalg.norm(grid[:, :2], axis=1), grid[:, 2]
jet = grid[(height < -3) | (across < 1.5) & (np.hypot(across, np.maximum(height - 3.5, 0)) < 1.5)]
size, far = np.repeat([1.0, 2.0], [len(drop) for drop in drops]), 24 * np.ones(3)
places, _, sides = surface.Liquid(np.concatenate(drops) * D0, 0 * size, D0, -far * D0, far * D0, size**3, size).mesh()
for drop, each, side in zip(drops, (1, 2), (places[sides[:, 0], 0] < -4 * D0, places[sides[:, 0], 0] > -4 * D0)):
    corner = places[sides[side]]
    held = np.einsum("ij,ij->", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])) / 6
    runs.check_within(held / (each * D0)**3 / len(drop), 0.998, 1.002, f"a_drop_of_size_{each}_has_its_volume")
one, half = np.ones(len(jet)), 9 * D0 * np.ones(3)
places = surface.Liquid(jet * D0, 0 * one, D0, -half, 3 * half, one, one).mesh()[0]
runs.check_within(places[:, 2].max() / D0, 4.8, 5.2, "the_tip_of_a_jet")
loops = surface.outline(points, cells)
cut = sum(0.5 * abs(np.sum(x * np.roll(z, 1) - z * np.roll(x, 1))) for x, z in (loop.T for loop in loops))
runs.check_within(cut / (0.8 * 4 * LARGE * D0), 0.98, 1.02, "its_section_has_its_area")

# liquid in a tank has the edges and corners of the tank, where its surface was rounded, and a cylinder its wall
tank = types.SimpleNamespace(lower=np.zeros(3), upper=np.array([0.1, 0.08, 0.2]), spacing=D0, rings=False,
                             faces=[["wall", "wall"], ["wall", "symmetry"], ["wall", "open"]])
every = np.stack(np.meshgrid(*[D0 * (np.arange(n) + 0.5) for n in (10, 8, 6)], indexing="ij"), axis=-1).reshape(-1, 3)
one = np.ones(len(every))
basin = views.Fluid(tank, every, one[:, None], one, one)
filled = surface.Liquid(every, 0 * one, D0, tank.lower, tank.upper, one, one)
for name, corners in (("a view", basin.cut(basin.mesh()[0])), ("figure 1", filled.mesh()[0])):
    off = [np.hypot(*(corners[np.abs(corners[:, along] - t) < 0.5 * D0][:, across] - edge).T).min()
           for along, across, edge, length in ((2, [0, 1], (0, 0), 0.04), (2, [0, 1], (0.1, 0.08), 0.04),
                                               (0, [1, 2], (0, 0), 0.1), (1, [0, 2], (0.1, 0), 0.08))
           for t in np.linspace(0, length, 9)]
    runs.check(max(off) < 1e-3 * D0, f"edges_of_liquid_in_{name}", np.array(off) / D0)
    close([corners.min(axis=0), corners[:, :2].max(axis=0).tolist() + [0]], [(0, 0, 0), (0.1, 0.08, 0)],
          f"liquid_within_its_tank_in_{name}")
lifted = views.Fluid(tank, every + [0, 0, 3 * D0], one[:, None], one, one)
runs.check_within(lifted.cut(lifted.mesh()[0])[:, 2].min() / D0, 2.8, 3.1, "liquid_near_a_wall_leaves_it_dry")
outside = np.array([(3, 4, 1), (0.3, 0.4, -1.0)])
reach = np.hypot(*surface.cut(outside, np.array([-1, -1, 0]), np.ones(3), True)[:, :2].T)
close(reach, (1, 0.5), "wall_of_a_cylinder")

# colour scales of the page: round numbers, lengths for sizes; none of what does not vary
seen = {"speed": [np.array([0, 0.31])], "pressure": [np.zeros(2)], "size": [np.array([1, 2.0])],
        "stretch": [np.zeros(2)], "temperature": [np.array([300, 350.0])]}
scales = viewer.colorings(run, seen, True)
told = [(c["title"], c["unit"], c["ticks"][0], c["ticks"][-1]) for c in scales]
runs.check(told == [("speed", "mm/s", "0", "320"), ("spacing", "mm", "10", "20"), ("temperature", "K", "300", "350")],
           "colour_scales", told)
close([c["ends"] for c in scales], [(0, 0.32), (1, 2), (300, 350)], "ends_of_colour_scales")
told = [c["title"] for c in viewer.colorings(run, seen, False)]
runs.check(told == ["speed", "temperature"], "one_size_has_no_scale", told)

# normals: a rough plane becomes even, an edge of a cube stays
step = np.arange(20)
x, y = np.meshgrid(step, step, indexing="ij")
corner = (20 * x + y)[:-1, :-1].ravel()
cells = np.concatenate([np.stack([corner, corner + 20, corner + 21], 1),
                        np.stack([corner, corner + 21, corner + 1], 1)])
rough = np.stack([0.3 * np.cos(3 * x), 0.3 * np.sin(2 * y), 1 + 0 * x], -1).reshape(-1, 3)
rough /= np.linalg.norm(rough, axis=1, keepdims=True)
even = surface.softened(rough, cells)
runs.check_below(np.std(even[:, 0]), 0.35 * np.std(rough[:, 0]), "soft_normals")
edge = np.where((x < 10).reshape(-1, 1), [1.0, 0, 0], [0, 0, 1.0])
close(surface.softened(edge, cells), edge, "edges_stay")

# solids as they are: a box that turned by 30 degrees about z and moved, from its dummy particles
run.scene["solids"] = [{"name": "part", "shape": {"type": "box"}, "holes": [], "lower": [0.1, 0.02, 0.05],
                        "upper": [0.3, 0.1, 0.2], "free": True, "driven": False}]
turn = np.array([[np.cos(np.pi / 6), -0.5, 0], [0.5, np.cos(np.pi / 6), 0], [0, 0, 1]])
first = dict(enumerate(np.random.default_rng(1).uniform([0.1, 0.02, 0.05], [0.3, 0.1, 0.2], (30, 3))))
later = {k: turn @ place + [0.01, 0.05, 0] for k, place in first.items()}
exact.places = lambda path, index: first if path == run.files[0][1] else later
run.scene["time_start"] = run.files[0][0]
mirrors, run.mirrors = run.mirrors, []
(points, normals, cells), which = exact.drawn(run, run.files[1][1])
run.mirrors = mirrors
box = exact.CUBE * [0.2, 0.08, 0.15] + [0.1, 0.02, 0.05]
moved = np.round(box @ turn.T + [0.01, 0.05, 0], 9)
close(sorted(map(tuple, np.unique(np.round(points, 9), axis=0))), sorted(map(tuple, moved)),
      "corners_of_a_box_that_turned")
sides = {tuple(side) for side in np.round(np.abs(normals @ turn), 6)}
runs.check(which == [0] and len(cells) == 12 and sides == {(1, 0, 0), (0, 1, 0), (0, 0, 1)}, "faces_are_flat", sides)
outward = np.einsum("ij,ij->i", normals, points - points.mean(axis=0))
runs.check(np.all(outward > 0), "faces_look_out", outward.min())


def held(corners, normals):
    """The volume within triangles, and how well their normals fit their sides at worst."""
    side = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(side, axis=1)
    fit = np.einsum("nij,nj->ni", normals, side) / np.maximum(size, 1e-300)[:, None]
    return np.einsum("ni,ni->n", corners[:, 0], side).sum() / 6, fit[size > 1e-9].min()


# round solids, and what an outline sweeps about the axis: their volumes, and normals that look out
tilt = (np.array([1, 2, 2]) / 3).tolist()
bounds = {"lower": [-1, -1, -1], "upper": [1, 1, 2], "holes": []}
numbers = {"sphere": {"center": [0.1, 0, 0.2], "radius": 0.5},
           "ellipsoid": {"center": [0, 0, 0], "radii": [0.5, 0.2, 0.4]},
           "cylinder": {"center": [0, 0.3, 0], "radius": 0.3, "height": 0.8, "axis": tilt}}
volumes = {"sphere": np.pi / 6, "ellipsoid": 4 / 3 * np.pi * 0.04, "cylinder": np.pi * 0.09 * 0.8}
for kind, given in numbers.items():
    volume, fit = held(*exact.round_one({"shape": {"type": kind, "numbers": given}, **bounds}))
    runs.check_within(volume / volumes[kind], 0.99, 1, f"volume_of_a_{kind}")
    runs.check(fit > 0.9, f"normals_of_a_{kind}", fit)
long = {"center": [0, 0, 0], "radius": 0.3, "height": 0, "axis": [0, 0, 1]}
corners, _ = exact.round_one({"shape": {"type": "cylinder", "numbers": long}, **bounds})
close((corners[..., 2].min(), corners[..., 2].max()), (-1, 2), "a_cylinder_without_height_ends_at_the_box")
flat = types.SimpleNamespace(dim=2, rings=False)
ring = exact.outline(flat, {"shape": {"type": "sphere", "numbers": {"center": [0, 0.2], "radius": 0.5}}, "holes": []})
volume, fit = held(*exact.swept(ring))
runs.check_within(volume / volumes["sphere"], 0.99, 1, "volume_of_a_sphere_of_rings")
runs.check(fit > 0.9, "normals_of_a_sphere_of_rings", fit)
# a plane: the outline of a disc that moved, in its section and in the page
flat = write(runs.scratch("plane"), (0, 0.01), (0, 0, 0), (1, 1, 0), "-bodies water\n",
             [((0.1, 0.1, 0), (0, 0, 0), 1, 1)], [((0.5, 0.5, 0), 0)], [((0.5, 0.5, 0), 0)], dimension=2)
flat.scene["solids"] = [{"name": "disc", "shape": {"type": "sphere", "numbers": {"center": [0.5, 0.5], "radius": 0.1}},
                         "holes": [], "free": False, "driven": True}]
flat.scene["time_start"] = flat.files[0][0]
later = {k: place + [0.2, 0.1, 0] for k, place in first.items()}
exact.places = lambda path, index: first if path == flat.files[0][1] else later
then = flat.read(flat.files[1][1])
figure, axes = pictures.grid(1)
views.section(axes[0], flat, then, "body", None, 1)
drawn = [one for one in axes[0].collections if isinstance(one, matplotlib.collections.PolyCollection)]
path = drawn[0].get_paths()[0].vertices if drawn else np.zeros((1, 2))
close(np.hypot(*(path[:-1] - [0.7, 0.6]).T), np.full(exact.CORNERS, 0.1), "outline_of_a_disc_that_moved")
points, cells = viewer.solid(flat, then, 1000)
runs.check(len(cells) == exact.CORNERS - 2 and cells.max() == exact.CORNERS - 1, "disc_of_the_page", len(cells))
run.scene["solids"] = []

# gas: a void of radius 0.15 in a tank is a pocket, a notch that is open above is none, nor what is within a solid
x, y = np.meshgrid(0.01 * (np.arange(100) + 0.5), 0.01 * (np.arange(80) + 0.5), indexing="ij")
places = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)
void = np.hypot(*(places[:, :2] - [0.3, 0.4]).T) < 0.15
notch = (np.abs(places[:, 0] - 0.7) < 0.05) & (places[:, 1] > 0.5)
block = np.abs(places[:, :2] - [0.75, 0.25]).max(axis=1) < 0.15
shell = block & (np.abs(places[:, :2] - [0.75, 0.25]).max(axis=1) > 0.11)
liquid = [(tuple(place), (0, 0, 0), 0, 1) for place in places[~void & ~notch & ~block]]
tank = write(runs.scratch("tank"), (0, 0.5), (0, 0, 0), (1, 1, 0), "-box_x wall\n-box_ymin wall\n-bodies water\n",
             liquid, [(tuple(place), 0) for place in places[shell]], dimension=2, each=1e-4, spacing=0.01)
tank.scene["solids"], tank.scene["options"] = [], [{"name": "-gas", "value": ""}]
with open(os.path.join(tank.folder, "pockets.csv"), "w", encoding="utf-8") as file:
    file.write("time_s,step,pocket,volume_m2,pressure_Pa,amount_m2,x_m,y_m,z_m\n0,1,1,1,7,1,0.3,0.4,0\n"
               "0.5,2,1,1,1500,1,0.31,0.4,0\n0.5,2,2,1,99,1,0.9,0.1,0\n")
found = gas.Pockets(tank, tank.read(tank.files[1][1]))
runs.check(gas.wanted(tank) and len(found.every) == 1, "pockets_of_gas", found.every)
close(found.every[0][0], (0.3, 0.4), "centre_of_a_pocket", 0.02)
runs.check(found.every[0][1] == 1500, "pressure_of_a_pocket", found.every)
points, cells = found.mesh()
one, two, three = (points[cells[:, k]] for k in range(3))
area = 0.5 * np.abs(np.cross(two - one, three - one)[:, 2]).sum()
runs.check_within(area / (np.pi * 0.15**2), 0.9, 1.1, "area_of_a_pocket")
runs.check(np.hypot(*(points[:, :2] - [0.3, 0.4]).T).max() < 0.17, "a_pocket_is_where_it_is", points.max(axis=0))
figure, axes = pictures.grid(1)
gas.draw(axes[0], tank, tank.read(tank.files[1][1]), 1e3)
runs.check([text.get_text() for text in axes[0].texts] == ["1.5 kPa"] and len(axes[0].collections) > 0,
           "gas_of_a_section", [text.get_text() for text in axes[0].texts])
# in a view a pocket shows through the liquid where nothing else hides it: here all pixels show the number of triangles
def drawn(*counts):
    """The first pixel of a picture of so many triangles of liquid, solids and gas."""
    parts = [(np.zeros((3, 3)), np.eye(3), np.zeros((n, 3), int), np.zeros((3, 3))) for n in counts]
    return views.picture(open_below, types.SimpleNamespace(**dict(zip(("liquid", "solid", "gas"), parts))),
                         {"position": (0, 0, 1), "focus": (0, 0, 0)}, 1)[0, 0, 0]


open_below, render = types.SimpleNamespace(faces=[["open"] * 2] * 3), surface.render
surface.render = lambda points, cells, *_: np.full((1, 1, 3), len(cells), np.uint8)
close([drawn(100, 20, 60), drawn(100, 20, 0)], [0.65 * 120 + 0.35 * 80, 120], "pocket_through_liquid")
surface.render = render
ring = gas.surface_of(types.SimpleNamespace(scene={}), None)
runs.check(len(ring[2]) == 0, "no_pockets_without_gas", ring)

# windows one after the other, on the display that a program starts
WINDOWS = """import sys; sys.path[:0] = sys.argv[1:]
import display; display.with_display()
import numpy as np, surface
for _ in range(40):
    image = surface.render(np.eye(3), np.array([[0, 1, 2]]), np.full((3, 3), 9, np.uint8),
                           {"position": (2, 2, 2), "focus": (0, 0, 0), "up": (0, 0, 1), "angle": 60}, (60, 40))
print((image == 9).sum() // 3)"""
done = subprocess.run([sys.executable, "-c", WINDOWS, os.path.dirname(views.__file__), os.path.join(
    runs.ROOT, "src", "python")], text=True, check=False,
                      stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                      env={name: value for name, value in os.environ.items() if name != "DISPLAY"})
runs.check(done.returncode == 0 and 100 < int(done.stdout) < 60 * 40, "many_windows", done.stdout + done.stderr[-300:])
tank.scene["options"] = [{"name": "-gas", "value": "false"}]
runs.check(not gas.wanted(tank), "no_gas", "it was")

# moments: a wave that swings more often than there are pictures is shown at its crests
swing = data.Run.__new__(data.Run)
swing.files = [(0.01 * k, f"snapshot_{k}") for k in range(100)]
table = {"time": [t for t, _ in swing.files],
         "potential_energy": [np.sin(2 * np.pi * 8 * t)**2 for t, _ in swing.files]}
found = swing.at_crests(table, [0, 20, 40, 60, 80, 99])
runs.check(found[0] == 0 and found[-1] == 99 and all(
    table["potential_energy"][k] > 0.9 for k in found[1:-1]), "moments_at_crests", found)
runs.check(swing.at_crests({**table, "potential_energy": list(range(100))}, [0, 20, 99]) == [0, 20, 99],
           "moments_without_crests", "moved")

# units of areas, and names of columns of a wall
close(columns.prefixed(3e-6, "m2")[0], 1e6, "square_millimetres")
runs.check(columns.prefixed(3e-6, "m2")[1] == "mm2" and columns.prefixed(5e-15, "m3") == (1e18, "µm3"),
           "unit_of_an_area", columns.prefixed(5e-15, "m3"))
told = [columns.title({"name": name, "unit": "m2", "whose": whose})[0] for name, whose in (
    ("wetted_ymin", "ymin"), ("force_part_x", "part"), ("highest", None))]
runs.check(told == ["wetted area at ymin", "force at part, x", "highest liquid"], "names_of_columns", told)

# views: from the front, a little to the right and from above; all liquid is in the picture
block = np.stack(np.meshgrid([-0.1, 0.3], [0.02, 0.18], [0.01, 0.2], indexing="ij"), axis=-1).reshape(-1, 3)
cloud = data.State(0, np.repeat(block, 50, axis=0), None, None, None, None, None, np.zeros((0, 3)))
for azimuth, elevation, place in ((0, 0, (0, -1, 0)), (90, 0, (1, 0, 0)), (0, 90, (0, 0, 1)), (25, 25, None)):
    view, half = views.camera(run, [cloud], azimuth, elevation)
    eye, focus = np.array(view["position"]), np.array(view["focus"])
    back = (eye - focus) / np.linalg.norm(eye - focus)
    if place:
        close(back, place, f"eye_at_{azimuth}_{elevation}")
    up = np.array(view["up"], float) if elevation < 90 else np.array([0., 1, 0])
    right = np.cross(up, back) / np.linalg.norm(np.cross(up, back))
    away = (eye - block) @ back
    high = np.abs((block - focus) @ np.cross(back, right)) / away / np.tan(np.radians(views.ANGLE / 2))
    wide = np.abs((block - focus) @ right) / away / np.tan(np.radians(views.ANGLE / 2)) * SHAPE
    runs.check_within(max(high.max(), wide.max()), 0.8, 1, f"picture_is_filled_at_{azimuth}_{elevation}")
view, half = views.above(run, [cloud])
back = np.subtract(view["position"], view["focus"])
close((*back / np.linalg.norm(back), *view["up"]), (0, 0, 1, 0, 1, 0), "from_above")
runs.check(view["height"] >= 0.16 and view["height"] / SHAPE >= 0.4, "all_from_above", view)
shown = []
views.picture = lambda *a: (shown.append(a), np.zeros((views.PANEL[1], views.PANEL[0], 3), np.uint8))[1]
pictures.surfaces(run, [state], arguments, ends, "")
runs.check("angle" in shown[0][2] and "height" in shown[1][2] and shown[0][1] is shown[1][1],
           "perspective_and_from_above_of_one_shape", [a[2] for a in shown])
panel = FIGURES["top"].axes[0]
bar, = panel.lines
says, unit = panel.texts[0].get_text().split()
close(np.ptp(bar.get_xdata()) * shown[1][2]["height"] / SHAPE * 1e3, float(says), "scale_bar_from_above")
runs.check(max(bar.get_ydata()) < 0 and bar.get_transform() == panel.transAxes, "scale_bar_below_the_picture",
           str(bar.get_ydata()))
runs.check(unit == "mm", "unit_of_the_scale_bar", unit)

# a plane: sizes are square roots of areas; the walls are strips outside the box
flat = write(runs.scratch("flat"), (0,), (0, 0, 0), (0.1, 0.2, 0), "-box_x wall\n-box_ymin wall\n-bodies ball\n",
             [((0.05, 0.02, 0), (1, 2, 0), 5, 4), ((0.02, 0.03, 0), (0, 1, 0), 6, 1)], dimension=2, each=D0**2)
state = flat.read(flat.files[0][1])
close(state.size, (2, 1), "sizes_of_a_plane")
strips = [(quad.min(axis=0)[:2], quad.max(axis=0)[:2]) for quad in viewer.walls(flat)]
outside = [high[0] <= 1e-12 or low[0] >= 0.1 - 1e-12 or high[1] <= 1e-12 for low, high in strips]
runs.check(outside == [True] * 3, "strips_outside_the_box", str(strips))

# rings: the axis points up, and each ring has the area of its volume over its length
ROWS = [((0.05, 0.02, 0), (1, 2, 0), 5, 2 * np.pi * 0.05), ((0.005, 0.03, 0), (0, 1, 0), 6, 4 * np.pi * 0.005)]
rings = write(runs.scratch("rings"), (0,), (0, 0, 0), (0.1, 0.2, 0), "-box_ymin wall\n-bodies ball\n", ROWS,
              dimension=2, rings=1, each=D0**2)
state = rings.read(rings.files[0][1])
close(state.points, [(0.05, 0, 0.02), (0.005, 0, 0.03), (-0.05, 0, 0.02), (-0.005, 0, 0.03)], "rings_stand_upright")
close(state.velocity, [(1, 0, 2), (0, 0, 1), (-1, 0, 2), (0, 0, 1)], "velocities_of_rings")
close(state.share, (1, 2, 1, 2), "areas_of_rings")
on_axis = data.ring_share(np.zeros(1), np.array([2 * np.pi * 0.25 * D0**3]), np.ones(1), D0)
close(on_axis, [1], "area_of_a_ring_on_the_axis")
close((*rings.lower, *rings.upper), (-0.1, -0.1, 0, 0.1, 0.1, 0.2), "box_around_rings")
runs.check(rings.faces == [["open"] * 2, ["open"] * 2, ["wall", "open"]], "faces_of_rings", rings.faces)
pictures.sections(rings, [state], argparse.Namespace(color="body", format=["png"]), None, "")
axes = FIGURES["section"].axes[0]
runs.check((axes.get_xlabel(), axes.get_ylabel()) == ("r (mm)", "z (mm)"), "labels_of_rings", axes.get_xlabel())

# curves: times in ms, lengths in mm
with open(os.path.join(run.folder, "series.csv"), "w", encoding="utf-8") as file:
    file.write("step,time_s,jet_height_m,kinetic_energy_J,iterations\n0,0,0.01,2,0\n1,0.01,0.02,3,7\n2,0.04,0.05,1,9\n")
pictures.curves(run, "", arguments)
panels = {axes.get_title(): axes.lines[0] for axes in FIGURES["curves"].axes if axes.lines}
runs.check(set(panels) == {"jet height (mm)", "kinetic energy (J)"}, "curves_drawn", set(panels))
if "jet height (mm)" in panels:
    close(panels["jet height (mm)"].get_ydata(), (10, 20, 50), "curve_in_mm")
    close(panels["jet height (mm)"].get_xdata(), (0, 10, 40), "curve_over_ms")
label = FIGURES["curves"].axes[-1].get_xlabel()
runs.check(label == "time (ms)", "time_of_curves", label)

# moments between which the scene changes alike: nothing but the time passes until 6, then a height rises
changes = {"time": [0, 6, 10], "step": [0, 1, 2], "highest": [1, 1, 3], "volume": [1, 2, 3], "height_1": [5] * 3}
close(columns.progress(changes, SERIES, [0, 6, 8, 10]), (0, 0.3, 0.65, 1), "half_of_the_change_is_the_height's")
back = {"time": [0, 1, 2], "highest": [0, 3, 2]}  # up and down again is change, too
close(columns.progress(back, SERIES, [0, 1, 2]), (0, 0.625, 1), "what_goes_back_changes")
drawn = list(columns.chosen(changes, SERIES))
runs.check(drawn == ["highest"], "no_curve_of_a_constant", drawn)
run.files = [(time, "") for time in range(11)]
with open(os.path.join(run.folder, "series.csv"), "w", encoding="utf-8") as file:
    file.write("time_s,step,highest_m\n0,0,1\n6,1,1\n10,2,3\n")
close([time for time, _ in run.moments(count=4)], (0, 6, 8, 10), "moments_of_equal_change")
close([time for time, _ in run.moments(count=99)], range(11), "no_moment_twice")

# the report: the walls and solids with their contact angles
SCENE = {"domain": {"dimension": 3, "faces": [{"name": "xmin", "type": "wall", "velocity": [0, 0, 0]},
                                              {"name": "xmax", "type": "open", "velocity": [0, 0, 0]},
                                              {"name": "ymax", "type": "wall", "velocity": [1, 0, 0]}]},
         "solids": [{"name": "ball", "shape": {"type": "sphere"}, "free": True, "driven": False, "motion": {"mass": 7}},
                    {"name": "peg", "shape": {"type": "box"}, "free": False, "driven": True, "motion": {}}],
         "tension": {"contact_angles": [{"name": "xmin", "receding": 50, "advancing": 70},
                                        {"name": "ymax", "receding": 90, "advancing": 90},
                                        {"name": "ball", "receding": 60, "advancing": 60}]}, "ranks": 2}
SIDES = [["xmin", "wall", "50 to 70"], ["ymax", "wall, moves", "90"], ["ball", "sphere, free: mass 7 kg", "60"],
         ["peg", "box, moves", ""]]
runs.check(report.walls(SCENE) == SIDES, "contact_angles", report.walls(SCENE))

# the report: energies at the start and the end, and the cost, 8 s of 2 processes for 20 steps of 100 particles
report.columns = columns  # which its main imports
text = report.energy({"kinetic_energy": [1, 5, 3], "highest": [0, 1, 2]}, {k: SERIES[k] for k in ("kinetic_energy",
                                                                                                  "highest")})
runs.check("<td>kinetic energy, J</td><td class=n>1</td><td class=n>3</td><td class=n>2</td>" in text and
           "highest" not in text, "the report has the energies", text)
series = {"step": [0, 1, 20], "wall_time": [0, 1, 8], "particles": [100, 100, 100]}
text = report.cost(series, SCENE)
runs.check("20 steps, 100 particles at the end, 2 processes, 8 s: 8e+03 µs" in text, "the report tells the cost", text)
runs.done()
