"""Solids as they are: the triangles of an STL file, the faces of a box, in the pose of a state. Others are drawn as the
contour of their dummy particles (views.solid_mesh)."""
import os

import h5py
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOGeometry import vtkSTLReader

SOLID = -2  # INT_BODY of the first of -solids
CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6],
                  [0, 6, 4], [1, 5, 7], [1, 7, 3]])  # outward
ENOUGH = 4  # points that show a pose


def triangles(run, solid):
    """Corners [n][3][3] (m) of a solid of scene.json in its first pose; None: its shape has no triangles, or holes."""
    shape, name = solid["shape"], solid["name"]
    if solid["holes"] or run.dim == 2 or run.rings:
        return None
    if shape["type"] == "box":
        low, high = np.array(solid["lower"]), np.array(solid["upper"])
        return (low + CUBE * (high - low))[FACES]
    path = next((option["value"] for option in run.scene["options"] if option["name"] == f"-{name}_file"), "")
    if shape["type"] != "stl" or not os.path.isfile(path):
        return None
    reader = vtkSTLReader()
    reader.SetFileName(path)
    reader.Update()
    mesh = reader.GetOutput()
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    given = {option["name"]: option["value"] for option in run.scene["options"]}
    offset = np.array([float(number) for number in given[f"-{name}_offset"].split(",")])
    points = float(given[f"-{name}_scale"]) * points + offset
    return points[vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)]


def places(path, index):
    """{id: position} of the dummy particles of a solid in a snapshot."""
    with h5py.File(path, "r") as file:
        own = np.ravel(file["body"]) == SOLID - index
        return dict(zip(np.ravel(file["id"])[own].tolist(), np.array(file["position"], float)[own]))


def pose(first, now):
    """The motion (rotation [3][3], centre before, centre after) that carries places onto others, {id: position}
    (Kabsch 1976, Acta Cryst. A32, 922); None: too few are in both."""
    both = sorted(set(first) & set(now))
    if len(both) < ENOUGH:
        return None
    before, after = (np.array([points[number] for number in both]) for points in (first, now))
    centres = before.mean(axis=0), after.mean(axis=0)
    u, _, v = np.linalg.svd((before - centres[0]).T @ (after - centres[1]))
    sign = np.diag([1, 1, np.sign(np.linalg.det(u @ v))])
    return (u @ sign @ v).T, *centres


def flat(corners):
    """Triangles [n][3][3] as points, normals and cells whose faces are flat: no corner is shared."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    return corners.reshape(-1, 3), np.repeat(normal, 3, axis=0), np.arange(3 * len(corners)).reshape(-1, 3)


def drawn(run, path):
    """(points, normals, cells) of the solids that have triangles, in the pose of a snapshot and with the images of
    mirrors, and the indices of these solids."""
    found, which = [np.zeros((0, 3, 3))], []
    for index, solid in enumerate(run.scene["solids"]):
        corners = triangles(run, solid)
        if corners is None:
            continue
        if solid["free"] or solid["driven"]:
            motion = pose(places(run.files[0][1], index), places(path, index))
            if run.files[0][0] > run.scene["time_start"] or motion is None:
                continue  # nobody knows its first pose
            turn, before, after = motion
            corners = (corners - before) @ turn.T + after
        which.append(index)
        images = run.reflect(corners.reshape(-1, 3))[0].reshape(-1, 3, 3)
        found.append(images)
    return flat(np.concatenate(found)), which
