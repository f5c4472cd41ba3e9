#!/usr/bin/python3
"""What other programs read: the XDMF file names data sets that exist with the shapes it says; VTK reads the series of
snapshots and the meshes back; what -snapshot_fields, -snapshot_lower and so on leave out is out, and the rest as
without them; the mesh of a sphere has its volume, and stray particles are not in it; columns of tables have units;
rings are mirrored at their axis and swept round it."""
import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import h5py  # noqa: E402
import numpy as np  # noqa: E402
import runs  # noqa: E402
import run as data  # noqa: E402
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402
from vtkmodules.vtkFiltersCore import vtkMassProperties  # noqa: E402
from vtkmodules.vtkIOHDF import vtkHDFReader  # noqa: E402
from vtkmodules.vtkIOImage import vtkPNGReader  # noqa: E402
from vtkmodules.vtkIOPLY import vtkPLYReader  # noqa: E402
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader  # noqa: E402

RADIUS = 1.0
SCENE = f"""-spacing 0.125 -box_lower -2,-2,-2 -box_upper 2,2,2 -bodies ball,stray -ball_shape sphere
 -ball_radius {RADIUS} -stray_lower 1.5,1.5,1.5 -stray_upper 1.625,1.625,1.625 -ball_velocity 0.1,0,0 -gravity 0,0,-1
 -steps_max 2 -time_step 1e-3
 -checkpoint_interval 0"""


def read(reader, path):
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def check_surface(surface, volume, name):
    """A mesh is closed and holds a volume to 1 %."""
    mass = vtkMassProperties()
    mass.SetInputData(surface)
    mass.Update()
    runs.check_within(mass.GetVolume() / volume, 0.99, 1.01, f"volume_of_{name}")
    cells = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    edges = np.sort(np.concatenate([cells[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    runs.check(len(count) > 100 and np.all(count == 2), f"closed_{name}", f"{np.sum(count != 2)} edges of {len(count)}")


def by_vtk(path):
    """The fields of a snapshot as VTK reads them, sorted by id."""
    reader = vtkHDFReader()
    if not runs.check(reader.CanReadFile(path), f"vtk_can_read_{os.path.basename(path)}", path):
        return None
    cloud = read(reader, path)
    data = cloud.GetPointData()
    found = {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)) for k in range(data.GetNumberOfArrays())}
    if not cloud.GetNumberOfPoints():
        return {name: np.zeros(0) for name in runs.fields(path)}
    found["position"] = vtk_to_numpy(cloud.GetPoints().GetData())
    runs.check(cloud.GetNumberOfCells() == 1 and cloud.GetCell(0).GetNumberOfPoints() == cloud.GetNumberOfPoints(),
               f"vtk_cell_{os.path.basename(path)}", "not one cell of all points")
    order = np.argsort(found["id"])
    return {name: values[order] for name, values in found.items()}


def check_series(folder, name):
    """XDMF and VTK tell of the same snapshots what the files hold; their fields."""
    grids = ElementTree.parse(os.path.join(folder, "snapshots.xdmf")).getroot().findall(".//Grid[@GridType='Uniform']")
    paths = runs.numbered(folder, "snapshot")
    runs.check(len(grids) == len(paths), f"{name}_xdmf_has_all_snapshots", f"{len(grids)} grids")
    for grid, path in zip(grids, paths):
        bad, listed = [], {"position"} | {a.get("Name") for a in grid.iter("Attribute")}
        here, seen = runs.fields(path), by_vtk(path)
        with h5py.File(path, "r") as file:
            for item in grid.iter("DataItem"):
                source, place = item.text.strip().split(":")
                data, shape = file[place], tuple(int(n) for n in item.get("Dimensions").split())
                if (source != os.path.basename(path) or data.shape != shape
                        or data.dtype.itemsize != int(item.get("Precision"))):
                    bad.append((place, data.shape, shape))
            bad += [] if abs(float(grid.find("Time").get("Value")) - file.attrs["time"]) < 1e-9 else ["time"]
        bad += [] if listed == set(here) else [f"xdmf has {listed}, the file {set(here)}"]
        runs.check(not bad, f"{name}_xdmf_{os.path.basename(path)}", bad)
        same = seen is not None and set(seen) == set(here)
        same = same and all(np.array_equal(seen[f], here[f]) or not len(here["id"]) for f in here)
        runs.check(same, f"{name}_vtk_reads_{os.path.basename(path)}", "other fields or values")
    return [runs.fields(path) for path in paths]


folder = runs.run(SCENE, "ball")
whole = check_series(folder, "ball")
grids = runs.numbered(folder, "snapshot")

# fields, region and compression, on two ranks, and continued
PART = " -snapshot_fields pressure,velocity -snapshot_lower -2,-2,0 -snapshot_upper 0.5,2,2 -snapshot_compression 4"
part = runs.run(SCENE + PART, "part", ranks=2)
got = check_series(part, "part")
for k, (some, all_of_it) in enumerate(zip(got, whole)):
    runs.check(set(some) == {"position", "id", "body", "pressure", "velocity"}, f"part_fields_{k}", set(some))
    x = all_of_it["position"]
    inside = (x[:, 2] >= 0) & (x[:, 0] <= 0.5)
    runs.check(np.array_equal(some["id"], all_of_it["id"][inside]) and 0 < inside.sum() < len(x), f"part_region_{k}",
               f"{len(some['id'])} particles, {inside.sum()} expected")
    runs.check_below(np.abs(some["position"] - x[inside]).max(), 1e-6, f"part_positions_{k}")
with h5py.File(runs.numbered(part, "snapshot")[-1], "r") as file:
    runs.check(file["velocity"].compression == "gzip" and file["velocity"].compression_opts == 4, "compression",
               file["velocity"].compression)
state = runs.numbered(part, "checkpoint")[-1]
full = runs.fields(state)
runs.check(len(full["id"]) == len(whole[0]["id"]) and "lambda" in full, "checkpoint_stays_complete", sorted(full))
runs.run(SCENE + PART + f" -steps_max 3 -snapshot_fields none -restart {state}", "part")
after = check_series(part, "continued")
runs.check([len(f) for f in after] == [5, 5, 3], "continued_with_other_fields", [sorted(f) for f in after])
bare = runs.run(SCENE + " -snapshot_fields none", "bare")
empty = runs.run(SCENE + " -snapshot_lower -2,-2,-2 -snapshot_upper -1.5,-1.5,-1.5", "empty")
runs.check([len(f["id"]) for f in check_series(empty, "empty")] == [0, 0], "empty_region", "particles in it")

done = subprocess.run([sys.executable, os.path.join(runs.ROOT, "src/pictures/pictures.py"), "--color", "speed", bare],
                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, check=False)
runs.check(done.returncode == 1 and "have no velocity" in done.stdout, "no_colour_without_field", done.stdout[-300:])

# every column with a unit has it in the head of its table
BARE = {"step", "iterations", "density_error", "divergence", "solver_error", "particles", "lost", "rejected",
        "droplets", "spray", "line", "number"}
UNITS = ("s", "m", "m2", "m3", "J", "N", "Pa", "m/s", "degrees")
GAUGES = " -gauge_points 0,0,0 -gauge_heights 0,0 -gauge_lines 0,0,0,1,0,0 -gauge_forces -gauge_droplets -box_zmin wall"
GAUGES += " -gauge_spread -gauge_neck z -gauge_film 0,0,1,0 -gauge_pinch_off -gauge_roughness"
tables = runs.run(SCENE + GAUGES, "gauges")
for name in ("series.csv", "lines.csv", "droplets.csv", "film.csv", "pinch_off.csv"):
    with open(os.path.join(tables, name), encoding="utf-8") as file:
        columns = file.readline().strip().split(",")
    unitless = [c for c in columns if c not in BARE and c.rsplit("_", 1)[-1] not in UNITS]
    runs.check(not unitless and len(columns) > 5, f"units_of_{name}", f"no unit: {unitless}")

mesh = os.path.join(runs.ROOT, "src/pictures/mesh.py")
for extra in ([], ["--format", "ply"]):
    done = subprocess.run([sys.executable, mesh, folder, "--particles"] + extra, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, universal_newlines=True, check=False)
    runs.check(done.returncode == 0, f"mesh{''.join(extra)}", done.stdout[-300:])
of_ball = np.sum(runs.fields(runs.numbered(folder, "snapshot")[0])["body"] == 0) * 0.125**3
for reader, name in ((vtkXMLPolyDataReader(), "surface_000000.vtp"), (vtkPLYReader(), "surface_000000.ply")):
    surface = read(reader, os.path.join(folder, "mesh", name))
    check_surface(surface, of_ball, name)
    corners = vtk_to_numpy(surface.GetPoints().GetData())
    runs.check_below(np.linalg.norm(corners, axis=1).max(), 1.2 * RADIUS, f"no_stray_{name}")
points = read(vtkXMLPolyDataReader(), os.path.join(folder, "mesh", "particles_000000.vtp"))
fields = runs.fields(runs.numbered(folder, "snapshot")[0])
runs.check(points.GetNumberOfPoints() == len(fields["id"]), "particles_vtp", points.GetNumberOfPoints())
velocity = vtk_to_numpy(points.GetPointData().GetArray("velocity"))
runs.check_within(velocity[:, 0].max(), 0.0999, 0.1001, "particles_velocity")
series = ElementTree.parse(os.path.join(folder, "mesh", "surface.pvd")).getroot().findall(".//DataSet")
present = all(os.path.exists(os.path.join(folder, "mesh", s.get("file"))) for s in series)
runs.check(present and len(series) == len(grids), "pvd_series", [s.get("file") for s in series])

# a film between walls and mirrors: its sides are those of the box, its volume is the particles'
POOL = """-spacing 0.1 -box_lower 0,0,0 -box_upper 1,1,1 -box_x symmetry -box_ymin wall -box_ymax symmetry
 -box_zmin wall -bodies film -film_upper 1,1,0.4 -steps_max 1 -time_step 1e-4 -checkpoint_interval 0"""
pool = runs.run(POOL, "pool")
subprocess.run([sys.executable, mesh, pool], stdout=subprocess.DEVNULL, check=False)
surface = read(vtkXMLPolyDataReader(), os.path.join(pool, "mesh", "surface_000000.vtp"))
check_surface(surface, 4 * 0.4, "pool")
corners = vtk_to_numpy(surface.GetPoints().GetData())
runs.check_within(np.ptp(corners[:, 0]), 1.999, 2.001, "pool_as_wide_as_its_box")

# rings: a ball on the axis, cut to its meridian, is swept to a whole ball; a single ring beside it is no piece of it
RINGS = f"""-dimension axisymmetric -spacing 0.125 -box_lower 0,-2 -box_upper 2,2 -box_ymin wall -bodies ball,stray
 -ball_shape sphere -ball_center 0,0 -ball_radius {RADIUS} -stray_lower 1.5,1.5 -stray_upper 1.625,1.625
 -ball_velocity 0,0.1 -steps_max 1 -time_step 1e-3 -checkpoint_interval 0"""
folder = runs.run(RINGS, "rings")
drawn = subprocess.run([sys.executable, mesh, folder, "--particles", "--least", "30"], stdout=subprocess.PIPE,
                       stderr=subprocess.STDOUT, universal_newlines=True, check=False)
if runs.check(drawn.returncode == 0, "rings_mesh", drawn.stdout[-300:]):
    surface = read(vtkXMLPolyDataReader(), os.path.join(folder, "mesh", "surface_000000.vtp"))
    corners = vtk_to_numpy(surface.GetPoints().GetData())
    radius = np.linalg.norm(corners, axis=1)
    first = runs.fields(runs.numbered(folder, "snapshot")[0])
    check_surface(surface, first["volume"][first["body"] == 0].sum(), "rings")
    runs.check_within(radius.min(), 0.85 * RADIUS, RADIUS, "rings_mesh_is_a_ball")
    runs.check_below(radius.max(), 1.15 * RADIUS, "rings_mesh_without_stray")
    sides = [np.sum(sign * corners[:, axis] > 0.5 * RADIUS) for axis in (0, 1) for sign in (1, -1)]
    runs.check(min(sides) == max(sides) > 100, "rings_mesh_of_revolution", sides)
drawn = subprocess.run([sys.executable, os.path.join(runs.ROOT, "src/pictures/pictures.py"), folder, "--count", "1"],
                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, check=False)
made = [os.path.join(folder, "figures", name) for name in ("section.png", "surface.png", "top.png")]
if runs.check(drawn.returncode == 0 and all(os.path.exists(p) for p in made), "rings_pictures", drawn.stdout[-300:]):
    for path in made[1:]:  # the ball is in the middle of its panel; the legend above it is left out
        image = read(vtkPNGReader(), path)
        pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(image.GetDimensions()[1], -1, 4).astype(int)
        frame, lower = np.flatnonzero((pixels[:, :, 0] < 250).any(axis=0)), pixels[:len(pixels) // 2]
        blue = np.flatnonzero((lower[:, :, 2] - lower[:, :, 0] > 60).any(axis=0))
        runs.check(len(blue) > 100 and abs(blue.min() + blue.max() - frame.min() - frame.max()) < 10,
                   f"rings_{os.path.basename(path)}_centred", (blue[[0, -1]], frame[[0, -1]]))
state = data.Run(folder).read(runs.numbered(folder, "snapshot")[0])
right = state.points[:, 0] > 0
mirrored = np.array_equal(state.points[right] * [-1, 1, 1], state.points[~right]) and not state.points[:, 1].any()
runs.check(mirrored and 2 * right.sum() == len(right) > 100, "rings_mirrored", state.points[:3])
area = 0.125**2 * np.sum(state.share[right]) / (np.pi / 2 * RADIUS**2 + 0.125**2)
runs.check_within(area, 0.97, 1.03, "rings_share")

# particles of different sizes: the mesh holds the coarse ones as well, a picture shows them as wide as they are
CORE = """ -spacing_coarse 0.3 -fine core,nook -core_shape sphere -core_radius 0.3 -core_center {} -nook_shape sphere
 -nook_radius 0.2 -nook_center {}"""
for scene, center, stray, name in ((SCENE, "1,0,0", "1.6,1.6,1.6", "graded"),
                                   (RINGS, "0,1", "1.6,1.6", "graded_rings")):
    folder = runs.run(scene + CORE.format(center, stray), name)
    subprocess.run([sys.executable, mesh, folder, "--least", "30"], stdout=subprocess.DEVNULL, check=False)
    first = runs.fields(runs.numbered(folder, "snapshot")[0])
    check_surface(read(vtkXMLPolyDataReader(), os.path.join(folder, "mesh", "surface_000000.vtp")),
                  first["volume"][first["body"] == 0].sum(), name)
    state = data.Run(folder).read(runs.numbered(folder, "snapshot")[0])
    wide = state.size[state.body == 0]
    runs.check_within(wide.min(), 0.95, 1.05, f"{name}_finest")
    runs.check_within(wide.max(), 1.8, 2.7, f"{name}_coarsest")
runs.done()
