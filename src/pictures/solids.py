"""Solids as they are, in the pose of a state: the triangles of an STL file, boxes, spheres, ellipsoids, cylinders; in a
plane and of rings the outline of their section. Others are drawn as their dummy particles, or the contour of these
(views.solid_mesh)."""
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
CORNERS = 64  # of a circle
AROUND = 96  # of a circle about the axis of rings
UP = np.array([0.0, 0, 1])


def box_of(low, high):
    return (np.array(low) + CUBE * (np.array(high) - low))[FACES]


def outline(run, solid):
    """Corners [n][2] (m) of a convex solid of scene.json in a plane, or of its section if it is of rings; None: its
    shape has no such outline, or holes."""
    numbers, kind = solid["shape"].get("numbers", {}), solid["shape"]["type"]
    turn = np.linspace(0, 2 * np.pi, CORNERS, endpoint=False)
    way = np.array(numbers.get("axis") or [0, 0, 1], float)
    if solid["holes"] or numbers.get("wave_amplitude"):
        return None
    if kind == "box" or kind == "cylinder" and run.rings:
        (x, y), (far, top) = solid["lower"], solid["upper"]
        return np.array([[x, y], [far, y], [far, top], [x, top]])
    if kind in ("sphere", "ellipsoid") or kind == "cylinder" and abs(way[2]) == 1:
        radii = np.array(numbers.get("radii") or [numbers["radius"]] * 2, float)[:2]
        return np.array(numbers["center"], float)[:2] + radii * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    return None


def patches(rows, columns, place):
    """Triangles [n][3][...] of a net: place(u, v) gives what stands at its knots, u and v from 0 to 1."""
    u, v = np.meshgrid(np.linspace(0, 1, rows + 1), np.linspace(0, 1, columns + 1), indexing="ij")
    net = place(u[..., None], v[..., None])
    a, b, c, d = net[:-1, :-1], net[1:, :-1], net[1:, 1:], net[:-1, 1:]
    found = np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)])
    return found.reshape(-1, 3, 3)


def around(u, v, radius=1):
    return radius * np.concatenate([np.cos(2 * np.pi * v) * u, np.sin(2 * np.pi * v) * u, 0 * u * v], axis=-1)


def round_one(solid):
    """Corners and normals [n][3][3] of a sphere, an ellipsoid or a cylinder of finite height; None: neither."""
    numbers, kind = solid["shape"].get("numbers", {}), solid["shape"]["type"]
    center = np.array(numbers.get("center", [0, 0, 0]), float)
    if kind in ("sphere", "ellipsoid") and not numbers.get("wave_amplitude"):
        radii = np.array(numbers.get("radii") or [numbers["radius"]] * 3, float)
        unit = patches(CORNERS // 2, CORNERS, lambda u, v: around(np.sin(np.pi * u), v) + np.cos(np.pi * u) * UP)
        normals = unit / radii
        return center + radii * unit, normals / np.linalg.norm(normals, axis=2, keepdims=True)
    if kind != "cylinder":
        return None
    axis, radius = np.array(numbers["axis"], float), numbers["radius"]
    _, one, other = np.linalg.svd(axis[None])[2]
    frame = np.stack([one, other, np.cross(one, other)])  # across the axis, and along it
    along = (box_of(solid["lower"], solid["upper"]).reshape(-1, 3) - center) @ frame[2]  # one without height ends there
    half = 0.5 * numbers.get("height", 0)
    low, high = (-half, half) if half else (along.min(), along.max())
    wall = patches(1, CORNERS, lambda u, v: around(1 + 0 * u, v, radius) + (high + (low - high) * u) * UP)
    lid = patches(1, CORNERS, lambda u, v: around(u, v, radius))
    corners = np.concatenate([wall, lid + high * UP, lid * [1, -1, 1] + low * UP])
    normals = np.concatenate([wall * [1, 1, 0] / radius, 0 * lid + UP, 0 * lid - UP])
    return center + corners @ frame, normals @ frame


def swept(corners):
    """Corners and normals [n][3][3] of what an outline, counterclockwise, sweeps about the axis z."""
    ends = np.roll(corners, -1, axis=0)
    kept = (corners[:, 0] > 0) | (ends[:, 0] > 0)
    begin, end = (np.maximum(side[kept], [0, -np.inf]) for side in (corners, ends))
    found, normals = [], []
    for (r, z), (far, top) in zip(begin, end):
        way = np.array([top - z, r - far]) / max(np.hypot(top - z, r - far), 1e-300)
        found.append(patches(1, AROUND, lambda u, v, r=r, z=z, far=far, top=top: around(
            r + u * (far - r), 1 - v) + (z + u * (top - z)) * UP))
        normals.append(patches(1, AROUND, lambda u, v, way=way: around(way[0] + 0 * u, 1 - v) + way[1] * UP))
    return np.concatenate(found), np.concatenate(normals)


def triangles(run, solid):
    """Corners and outward normals [n][3][3] (m) of a solid of scene.json in its first pose; None: its shape has no
    triangles, or holes."""
    shape, name = solid["shape"], solid["name"]
    if run.dim == 2 or run.rings or solid["holes"]:
        return None
    if shape["type"] == "box":
        return faceted(box_of(solid["lower"], solid["upper"]))
    path = next((option["value"] for option in run.scene["options"] if option["name"] == f"-{name}_file"), "") \
        if shape["type"] == "stl" else ""
    kept = os.path.join(run.folder, "inputs", f"{name}_file{os.path.splitext(path)[1]}")  # as the run has read it
    path = kept if os.path.isfile(kept) else path
    if not os.path.isfile(path):
        return round_one(solid)
    reader = vtkSTLReader()
    reader.SetFileName(path)
    reader.Update()
    mesh = reader.GetOutput()
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    given = {option["name"]: option["value"] for option in run.scene["options"]}
    offset = np.array([float(number) for number in given[f"-{name}_offset"].split(",")])
    points = float(given[f"-{name}_scale"]) * points + offset
    return faceted(points[vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)])


def faceted(corners):
    """Corners [n][3][3] and the normals of their triangles at each."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    return corners, np.repeat(normal[:, None], 3, axis=1)


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


def moved(run, path, index):
    """The motion of a solid until a snapshot, functions of points and of vectors; None: nobody knows it."""
    solid = run.scene["solids"][index]
    if not solid["free"] and not solid["driven"]:
        return lambda points: points, lambda vectors: vectors
    motion = pose(places(run.files[0][1], index), places(path, index))
    if run.files[0][0] > run.scene["time_start"] or motion is None:
        return None  # nobody knows its first pose
    turn, before, after = motion
    return lambda points: (points - before) @ turn.T + after, lambda vectors: vectors @ turn.T


def outlines(run, path):
    """The outlines of solids in the plane of sections at a snapshot, [n][2] (m) each, with their images, and the
    indices of these solids. Not of runs in space, whose solids nothing cuts here."""
    found, which = [], []
    for index, solid in enumerate(run.scene.get("solids", ()) if run.dim == 2 or run.rings else ()):
        corners, motion = outline(run, solid), moved(run, path, index)
        if corners is None or motion is None:
            continue
        which.append(index)
        points = motion[0](np.column_stack([corners, np.zeros(len(corners))]))
        points = points[:, [0, 2, 1]] if run.rings else points
        images = run.reflect(points)[0].reshape(-1, len(points), 3)
        found += [image[:, [0, run.up]] for image in images]
    return found, which


def drawn(run, path):
    """(points, normals, cells) of the solids that have triangles, in the pose of a snapshot and with the images of
    mirrors, and the indices of these solids. No corner is shared."""
    found, normals, which = [np.zeros((0, 3))], [np.zeros((0, 3))], []
    for index, solid in enumerate(run.scene.get("solids", ())):
        shape, motion = triangles(run, solid), moved(run, path, index)
        if run.rings and motion is not None:
            corners = outline(run, solid)
            if corners is not None:
                corners = motion[0](np.column_stack([corners, np.zeros(len(corners))]))[:, :2]
                shape, motion = swept(corners), (lambda points: points, lambda vectors: vectors)
        if shape is None or motion is None:
            continue
        which.append(index)
        corners, vectors = motion[0](shape[0].reshape(-1, 3)), motion[1](shape[1].reshape(-1, 3))
        if not run.rings:
            corners, (vectors,), _ = run.reflect(corners, [vectors])
        found.append(corners)
        normals.append(vectors)
    points = np.concatenate(found)
    return (points, np.concatenate(normals), np.arange(len(points)).reshape(-1, 3)), which
