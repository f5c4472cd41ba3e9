#!/usr/bin/python3
"""Writes the liquid's surface as meshes for other programs, and the particles as points.

    mesh.py RUN_FOLDER [--format vtp|ply] [--times S ...] [--least N] [--particles]

For runs in three dimensions or with rings, which have a surface of revolution. Writes for each snapshot a closed mesh
RUN_FOLDER/mesh/surface_<number>.vtp (or .ply) with the liquid's volume, without pieces of less than N particles (8).
vtp files have speed, pressure and body at the corners; surface.pvd makes a series of them in ParaView. --particles:
writes particles_<number>.vtp and particles.pvd, too. Needs Debian's python3-h5py, python3-vtk9.
"""
import argparse
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python"))
from isph import tables  # noqa: E402

LEAST = 8


def pieces(points, cells, spacing):
    """Volume of each piece over that of a particle, and the piece of each triangle. A piece is connected by corners."""
    mesh = polydata(points, cells)
    connect = vtkPolyDataConnectivityFilter()
    connect.SetInputData(mesh)
    connect.SetExtractionModeToAllRegions()
    connect.ColorRegionsOn()
    connect.Update()
    region = vtk_to_numpy(connect.GetOutput().GetPointData().GetArray("RegionId"))[cells[:, 0]]
    a, b, c = (points[cells[:, k]] for k in range(3))
    volume = np.bincount(region, np.einsum("ij,ij->i", a, np.cross(b, c)) / 6)
    return np.abs(volume) / spacing**3, region


def polydata(points, cells=None):
    """vtkPolyData of triangles, or of points."""
    mesh, corners = vtkPolyData(), vtkPoints()
    corners.SetData(numpy_to_vtk(np.ascontiguousarray(points, np.float32), deep=True))
    mesh.SetPoints(corners)
    array = vtkCellArray()
    width = 1 if cells is None else 3
    index = np.arange(len(points)) if cells is None else cells.ravel()
    array.SetData(width, numpy_to_vtkIdTypeArray(np.ascontiguousarray(index, np.int64), deep=True))
    (mesh.SetVerts if cells is None else mesh.SetPolys)(array)
    return mesh


def attach(mesh, **values):
    for name, value in values.items():
        array = numpy_to_vtk(np.ascontiguousarray(value), deep=True)
        array.SetName(name)
        mesh.GetPointData().AddArray(array)


def write(mesh, path):
    writer = vtkPLYWriter() if path.endswith(".ply") else vtkXMLPolyDataWriter()
    writer.SetFileName(path)
    writer.SetInputData(mesh)
    if not writer.Write():
        raise tables.Error(f"{path} cannot be written.")


def series(folder, name, files):
    """A .pvd file: the meshes as a series of times."""
    path = os.path.join(folder, f"{name}.pvd")
    with open(path, "w", encoding="utf-8") as out:
        out.write('<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n')
        for time, file in files:
            out.write(f'<DataSet timestep="{time:.12g}" file="{os.path.basename(file)}"/>\n')
        out.write("</Collection>\n</VTKFile>\n")
    print(path)


def surface_of(run, state, least):
    """The mesh of a state, without small pieces."""
    table = np.column_stack([state.speed, state.pressure, state.body])
    fluid = views.Fluid(run, state.points, table, state.share, state.size)
    points, normals, cells, _ = fluid.mesh()
    points = fluid.cut(points)
    if len(cells):
        size, region = pieces(points, cells, run.spacing)
        cells = cells[size[region] >= least]
    used, index = np.unique(cells, return_inverse=True)
    points, normals, cells = points[used], normals[used], index.reshape(-1, 3)
    values = fluid.values(points - 0.5 * run.spacing * normals) if len(points) else np.zeros((0, 3))
    mesh = polydata(points, cells)
    found = {"speed": values[:, 0], "pressure": values[:, 1], "body": values[:, 2]}
    source = {"speed": "velocity", "pressure": "pressure", "body": "body"}
    attach(mesh, **{name: column for name, column in found.items() if source[name] in run.fields})
    return mesh


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folder", metavar="RUN_FOLDER")
    parser.add_argument("--format", choices=("vtp", "ply"), default="vtp")
    parser.add_argument("--times", type=float, nargs="+", metavar="S", help="nearest snapshots to these times, s (all)")
    parser.add_argument("--least", type=float, default=LEAST, help="least number of particles of a piece (8)")
    parser.add_argument("--particles", action="store_true", help="points too")
    arguments = parser.parse_args()
    run = data.Run(arguments.folder)
    if run.dim != 3:
        raise tables.Error(f"{arguments.folder} is of a run in two dimensions, which has no surface mesh.")
    folder = os.path.join(arguments.folder, "mesh")
    os.makedirs(folder, exist_ok=True)
    meshes, clouds = [], []
    files = run.files if arguments.times is None else run.moments(arguments.times)
    for time, path in counted(files, len(files), "meshes"):
        number = os.path.basename(path)[len("snapshot_"):-len(".h5")]
        state = run.read(path)
        meshes.append((time, os.path.join(folder, f"surface_{number}.{arguments.format}")))
        write(surface_of(run, state, arguments.least), meshes[-1][1])
        if arguments.particles:
            clouds.append((time, os.path.join(folder, f"particles_{number}.vtp")))
            points = polydata(state.points)
            fields = {"velocity": state.velocity, "pressure": state.pressure, "body": state.body}
            attach(points, **{name: field for name, field in fields.items() if name in run.fields})
            write(points, clouds[-1][1])
    if arguments.format == "vtp":
        series(folder, "surface", meshes)
    if clouds:
        series(folder, "particles", clouds)


if __name__ == "__main__":
    with tables.polite("mesh.py"):
        import numpy as np
        import run as data
        import views
        from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
        from vtkmodules.vtkFiltersCore import vtkPolyDataConnectivityFilter
        from vtkmodules.vtkIOPLY import vtkPLYWriter
        from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
        from display import counted
        main()
