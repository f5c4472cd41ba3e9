#!/usr/bin/python3
"""What other programs read: the XDMF file names data sets that exist with the shapes it says; VTK reads the meshes
back; the mesh of a sphere has its volume, and stray particles are not in it."""
import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import h5py  # noqa: E402
import numpy as np  # noqa: E402
import runs  # noqa: E402
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402
from vtkmodules.vtkFiltersCore import vtkMassProperties  # noqa: E402
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


folder = runs.run(SCENE, "ball")
root = ElementTree.parse(os.path.join(folder, "snapshots.xdmf")).getroot()
grids = root.findall(".//Grid[@GridType='Uniform']")
runs.check(len(grids) == len(runs.numbered(folder, "snapshot")), "xdmf_has_all_snapshots", f"{len(grids)} grids")
bad = []
for item in root.iter("DataItem"):
    name, place = item.text.strip().split(":")
    with h5py.File(os.path.join(folder, name), "r") as file:
        shape = tuple(int(n) for n in item.get("Dimensions").split())
        data = file[place]
        if data.shape != shape or data.dtype.itemsize != int(item.get("Precision")):
            bad.append((name, place, data.shape, shape))
runs.check(not bad, "xdmf_data_sets", bad)

mesh = os.path.join(runs.ROOT, "src/pictures/mesh.py")
for extra in ([], ["--format", "ply"]):
    done = subprocess.run([sys.executable, mesh, folder, "--particles"] + extra, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, universal_newlines=True, check=False)
    runs.check(done.returncode == 0, f"mesh{''.join(extra)}", done.stdout[-300:])
for reader, name in ((vtkXMLPolyDataReader(), "surface_000000.vtp"), (vtkPLYReader(), "surface_000000.ply")):
    surface = read(reader, os.path.join(folder, "mesh", name))
    mass = vtkMassProperties()
    mass.SetInputData(surface)
    mass.Update()
    volume = mass.GetVolume() / (4 / 3 * np.pi * RADIUS**3)
    runs.check_within(volume, 0.95, 1.05, f"volume_of_{name}")
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
runs.done()
