"""The liquid's surface from particles, and its picture: numpy computes field and light, VTK the mesh and the image.

Lengths in m. The volume fraction is the particles' volume, spread by a Gaussian of FILTER spacings onto a grid; the
surface is its contour at LEVEL. Isolated particles that do not reach LEVEL are drawn as spheres of their own volume.
Rings have a grid over the section through the axis, x and z; half of its contour is swept around the axis.
"""
import functools

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPlane, vtkPolyData
from vtkmodules.vtkFiltersCore import (vtkCleanPolyData, vtkCutter, vtkFlyingEdges2D, vtkFlyingEdges3D,
                                       vtkPolyDataNormals, vtkSmoothPolyDataFilter, vtkStripper, vtkTriangleFilter,
                                       vtkWindowedSincPolyDataFilter)
from vtkmodules.vtkFiltersModeling import vtkRotationalExtrusionFilter
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkImagingGeneral import vtkImageGaussianSmooth
from vtkmodules.vtkImagingMorphological import vtkImageConnectivityFilter
from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow,
                                         vtkWindowToImageFilter)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  registers the renderer

FILTER = 0.6  # standard deviation of the Gaussian, spacings
LEVEL = 0.45  # of the volume fraction: a layer one particle thick still shows
SIZE_STEP = 1.4  # ratio of sizes that are spread by different Gaussians
SPREAD = 2.5  # own spacings over which the drop's share is averaged where it is thinner than a particle
WIDTH = 2  # nodes, a Gaussian of a field that is sampled so often
LAYER_SHARE = 0.2  # average with the drop's full colour: two thirds of a layer of particles
CELL = 0.5  # largest cell of the grid, spacings
MOST_NODES = 8e6  # of the grid: a larger box or a finer spacing gets larger cells
BEHIND = 12  # most nodes behind a face at which the liquid ends flat: its edges, which filters round, are cut there
SMOOTHING = 60  # iterations of the mesh filter (Taubin, Zhang and Golub 1996)
PASS_BAND = 0.02  # of the mesh filter: bumps of some three spacings go, sheets and the tips of jets stay
TOO_FAR = 0.075  # spacings, by which the contour at LEVEL of a flat surface is outside the liquid
TURNS = (0, 8, 32)  # iterations, over the square of the cells in a spacing, for sizes 1, 2, 4: over 0.7 own spacings
FARTHEST = 0.5  # spacings, largest displacement of a corner that gives a piece of liquid its volume
FIRST_MOVE, SECANTS = 0.01, 3  # spacings, steps: of the secant method that finds it
RELAXED = 0.5  # share of the way to the mean of its neighbours that a corner goes in an iteration
SOFT = 6  # passes that average the normals of a picture
CALM = 24  # the same for the curvature: bumps of a few spacings are not to grow
SHARP = 4  # power of the cosine between two normals with which they are averaged: an edge stays
WIDE = 1.5e-3  # m, reach of the shade in hollows
AROUND = 240  # corners of a surface of revolution around its axis

FILM_COLOR = np.array([0.07, 0.35, 0.63])
DROP_COLOR = np.array([0.93, 0.36, 0.09])
THIN_COLOR = np.array([0.45, 0.74, 0.90])  # where light comes through
DEEP = 0.8  # share of liquid around a point WIDE below a flat surface
PALE_COLOR = np.array([0.55, 0.60, 0.66])  # the film, in pictures that show the drop's liquid
ZENITH, HORIZON, GROUND = np.array([0.52, 0.70, 0.90]), np.array([0.95, 0.97, 1.0]), np.array([0.30, 0.36, 0.42])


def blur(field, width):
    """Gaussian filter of an array with standard deviation width (nodes)."""
    image, smooth = vtkImageData(), vtkImageGaussianSmooth()
    image.SetDimensions(*(field.shape + (1,) * (3 - field.ndim))[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(field).ravel()))
    smooth.SetInputData(image)
    smooth.SetDimensionality(3)
    smooth.SetStandardDeviations(*((width,) * field.ndim + (0,) * (3 - field.ndim))[::-1])
    smooth.SetRadiusFactors(3, 3, 3)
    smooth.Update()
    return vtk_to_numpy(smooth.GetOutput().GetPointData().GetScalars()).reshape(field.shape)


def deposit(places, shape, weights):
    """A field for each of the weights, spread linearly onto the 2^d nodes around each point. places: [n][d] in nodes,
    none outside the grid; weights: arrays [n]."""
    dim = len(shape)
    base = np.floor(places).astype(np.int64)
    inside = np.all((base >= 0) & (base < np.array(shape) - 1), axis=1)
    base, rest = base[inside], (places - np.floor(places))[inside]
    weights = [weight[inside] for weight in weights]
    totals = [np.zeros(int(np.prod(shape))) for _ in weights]
    for corner in np.ndindex(*(2,) * dim):
        share = np.prod(np.where(np.array(corner) == 1, rest, 1 - rest), axis=1)
        index = np.ravel_multi_index(tuple((base + corner).T), shape)
        for total, weight in zip(totals, weights):
            total += np.bincount(index, share * weight, minlength=total.size)
    return [total.reshape(shape).astype(np.float32) for total in totals]


def sample(field, places):
    """Linear interpolation of a field at places [n][d] (nodes), clamped to the grid."""
    top = np.array(field.shape) - 1.001
    places = np.clip(places, 0, top)
    base = places.astype(np.int64)
    rest = places - base
    value = np.zeros(len(places))
    for corner in np.ndindex(*(2,) * field.ndim):
        share = np.prod(np.where(np.array(corner) == 1, rest, 1 - rest), axis=1)
        value += share * field[tuple((base + corner).T)]
    return value


def cut(points, lower, upper, rings=False):
    """Points of a surface [n][3]; those outside a box (rings: outside the cylinder of radius upper[0]) are put onto its
    faces. A face at infinity is none."""
    points = points.copy()
    if rings:
        reach = np.maximum(np.hypot(*points[:, :2].T), 1e-300)
        points[:, :2] *= np.minimum(1, upper[0] / reach)[:, None]
    axes = slice(2 if rings else 0, 3)
    points[:, axes] = np.clip(points[:, axes], lower[axes], upper[axes])
    return points


def faced(normals, points, flat):
    """Normals where the points that cut() has moved have those of the faces that they are on."""
    away = points - flat
    length = np.linalg.norm(away, axis=1, keepdims=True)
    return np.where(length > 0, away / np.maximum(length, 1e-300), normals)


def with_images(points, others, lower, upper, margin):
    """Adds the periodic images of the points within a margin (m) beyond the four sides of the box; for the section of
    rings, mirrored at the axis, the mirror images in the cylinder around them. others: arrays [n], copied too."""
    for axis in (0, 1):
        length = upper[axis] - lower[axis]
        low = points[:, axis] < lower[axis] + margin
        high = points[:, axis] > upper[axis] - margin
        shift = np.zeros(3)
        shift[axis] = length
        points = np.concatenate([points, points[low] + shift, points[high] - shift])
        others = [np.concatenate([array, array[low], array[high]]) for array in others]
    return points, others


def images(run, points, others, margin):
    """Adds points within a margin beyond the faces: copies through periodic faces, images in walls and mirrors. others:
    arrays with a row for each point, which are copied."""
    for d in range(3):
        length = run.upper[d] - run.lower[d]
        new, more = [points], [others]
        for side, face in ((0, run.lower[d]), (1, run.upper[d])):
            kind = run.faces[d][side]
            if kind == "open":
                continue
            opposite = run.upper[d] if side == 0 else run.lower[d]
            near = np.abs(points[:, d] - (opposite if kind == "periodic" else face)) < margin
            copy = points[near].copy()
            if kind == "periodic":
                copy[:, d] += length if side else -length
            else:
                copy[:, d] = 2 * face - copy[:, d]
            new.append(copy)
            more.append([other[near] for other in others])
        points, others = np.concatenate(new), [np.concatenate(parts) for parts in zip(*more)]
    return points, others


def in_plane(points, axes):
    """Points [n][3] in the coordinates of a grid over these axes; without y the first is the distance from the axis."""
    return points if len(axes) == 3 else np.stack([np.hypot(points[:, 0], points[:, 1]), points[:, 2]], axis=1)


def spread(places, size, weights, shape, width):
    """Fields of weights, each [n], spread by a Gaussian of the standard deviation width (nodes) times the size [n] of
    the particle; sizes count to within a fifth. Only the block around the particles of a size is computed, that of
    twice as wide ones on every second node."""
    kind = np.maximum(0, np.rint(np.log(size) / np.log(SIZE_STEP))).astype(int)
    fields = [np.zeros(shape, np.float32) for _ in weights]
    for k in np.unique(kind):
        deviation, chosen = width * SIZE_STEP**k, kind == k
        stride = 2 if SIZE_STEP**k > 1.9 else 1
        low = np.maximum(0, np.floor(places[chosen].min(axis=0) - 4 * deviation)).astype(int)
        high = np.minimum(shape, np.ceil(places[chosen].max(axis=0) + 4 * deviation)).astype(int) + 1
        block = tuple(slice(*ends) for ends in zip(low, high))
        room = tuple((n - 1) // stride + stride for n in fields[0][block].shape)
        parts = deposit((places[chosen] - low) / stride, room, [w[chosen] / stride ** len(shape) for w in weights])
        for field, part in zip(fields, parts):
            into = field[block]
            part = blur(part, np.sqrt(deviation**2 - (stride**2 - 1) / 3) / stride)  # the rest is linear, to both sides
            into += part if stride == 1 else between(part, into.shape)
    return fields


def between(field, shape):
    """A field given at every second node, at all nodes of the shape."""
    for axis, n in enumerate(shape):
        field = np.moveaxis(field, axis, 0)
        every = np.empty((2 * len(field) - 1,) + field.shape[1:], field.dtype)
        every[::2] = field
        every[1::2] = 0.5 * (field[1:] + field[:-1])
        field = np.moveaxis(every[:n], 0, axis)
    return field


def ended(field, axis, lower, upper, behind=BEHIND):
    """A field that ends behind faces at lower and upper (nodes along an axis; none: at infinity): it goes on with the
    value at the face, not at once to 0, since the filter of the mesh swells at sharp edges."""
    nodes = np.arange(field.shape[axis])
    inner = np.clip(nodes, np.ceil(lower - 1e-6), np.floor(upper + 1e-6)).astype(int)
    share = np.clip(2 - 2 * np.maximum(lower - nodes, nodes - upper) / behind, 0, 1).astype(field.dtype)
    return np.take(field, inner, axis) * share.reshape([-1 if d == axis else 1 for d in range(field.ndim)])


class Liquid:
    """The volume fractions of all liquid and of the drop on a grid over the box.

    points [n][3] (m); of_drop [n]: the drop's part of the particle; spacing, lower, upper (m): of the particles, and
    the corners of the whole box. share, size [n]: volume over spacing^3, own spacing over 'spacing'; of rings, whose
    points lie at y = 0 on both sides of the axis, share is the area over spacing^2.
    """

    def __init__(self, points, of_drop, spacing, lower, upper, share, size, rings=False):
        self.rings, self.axes, self.spacing = rings, (0, 2) if rings else (0, 1, 2), spacing
        axes, dim = list(self.axes), len(self.axes)
        inside = np.all((points >= lower) & (points <= upper), axis=1)
        self.points, self.of_drop, self.share, self.size = (array[inside] for array in (points, of_drop, share, size))
        top = min(upper[2], self.points[:, 2].max() + 3 * spacing)
        extent = np.array([upper[0] - lower[0], upper[1] - lower[1], top - lower[2]])[axes]
        cell = max(CELL * spacing, (np.prod(extent) / MOST_NODES) ** (1 / dim))
        half = 2 if self.rings else 1  # a node is on the axis
        self.cell = extent[0] / (half * np.ceil(extent[0] / (half * cell)))
        margin = max(BEHIND + 2, int(np.ceil(4 * FILTER * spacing * self.size.max(initial=1) / self.cell)))
        self.origin = np.asarray(lower, float)[axes] - margin * self.cell
        shape = tuple(np.ceil(extent / self.cell).astype(int) + 2 * margin + 1)
        near, (of_drop, share, size) = with_images(self.points, (self.of_drop, self.share, self.size), lower, upper,
                                                   margin * self.cell)
        places, weight = (near[:, axes] - self.origin) / self.cell, share * (spacing / self.cell) ** dim
        self.near = places, size, (weight * of_drop, weight)
        self.drop, self.all, sized = spread(places, size, (weight * of_drop, weight, weight * size), shape,
                                            FILTER * spacing / self.cell)
        self.sized = sized / np.maximum(self.all, 1e-6)
        self.hollow = blur(np.minimum(self.all[(slice(None, None, 4),) * dim], 1), WIDE / (4 * self.cell))
        # The block of liquid ends at the sides and the bottom of the box with flat faces; mesh() cuts it there.
        self.lower, self.upper = np.array(lower, float), np.array([*upper[:2], np.inf])
        layer, self.block = int(np.ceil(spacing / self.cell)), np.minimum(self.all, 1)
        self.block[..., :margin + layer] = self.block[..., margin + layer, None]
        for axis in range(dim):
            top = np.inf if axis == dim - 1 else round(extent[axis] / self.cell) + margin
            self.block = ended(self.block, axis, margin, top)

    @functools.lru_cache(maxsize=1)
    def mesh(self):
        """The surface in the form of triangles(), for all pictures of this liquid."""
        points, normals, cells = triangles(self.block, LEVEL, self.origin, self.cell, self.sized, self.spacing)
        points = fitted(self, self.block, points, normals, cells)
        flat = self.cut(points)
        return flat, softened(faced(normals, points, flat), cells), cells

    def cut(self, points):
        return cut(points, self.lower, self.upper, self.rings)

    def places(self, points):
        """Points (m) in units of the grid's nodes."""
        return (in_plane(points, self.axes) - self.origin) / self.cell

    def lonely(self, field, level, flags):
        """Flags of the flagged particles outside the surface of a field at a level."""
        flags = flags.copy()
        flags[flags] = sample(field, self.places(self.points[flags])) < level
        return flags

    def drop_share(self, points, layer=False):
        """The drop's part of the liquid at points (m): 0 film, 1 drop. It is sharpened for the eye; with layer it
        is the mean of the surroundings, which shows the amount of a layer one particle thick in spite of its gaps."""
        places = self.places(points)
        if layer:
            width = SPREAD * self.spacing / self.cell
            stride = max(1, int(width / WIDTH))  # a wide Gaussian needs no more nodes
            near, size, weights = self.near
            drop, every = (sample(field, places / stride) for field in spread(
                near / stride, size, weights, tuple(n // stride + 2 for n in self.all.shape), width / stride))
            return np.clip(drop / np.maximum(every, 1e-6) / LAYER_SHARE, 0, 1)
        share = sample(self.drop, places) / np.maximum(sample(self.all, places), 1e-6)
        share = np.clip((share - 0.3) / 0.4, 0, 1)
        return share * share * (3 - 2 * share)

    def shade(self, points, normals):
        """Dimming of the light at points (m) in hollows: 1 open, towards 0 enclosed."""
        places = self.places(points + normals * WIDE) / 4
        return np.clip(1.15 - 0.8 * sample(self.hollow, places), 0.4, 1)

    def thinness(self, points, normals):
        """How much light comes through the liquid behind a surface: 0 deep, 1 a sheet or a jet."""
        behind = sample(self.hollow, self.places(points - normals * WIDE) / 4)
        return np.clip((DEEP - behind) / DEEP, 0, 1)


def contour(field, level, origin, cell, edges):
    """The contour (vtkPolyData) of a field at a level as VTK's filter 'edges' finds it."""
    image = vtkImageData()
    image.SetDimensions(*(field.shape + (1,) * (3 - field.ndim)))
    image.SetSpacing(cell, cell, cell)
    image.SetOrigin(*(tuple(origin) + (0,) * (3 - field.ndim)))
    image.GetPointData().SetScalars(numpy_to_vtk(field.ravel(order="F"), deep=True))
    edges.SetValue(0, level)
    edges.ComputeScalarsOff()
    return passed(edges, image)


def passed(algorithm, mesh):
    """The output of a filter on a mesh."""
    algorithm.SetInputData(mesh)
    algorithm.Update()
    return algorithm.GetOutput()


def smoothed(mesh):
    """A mesh of triangles or lines (vtkPolyData), smoothed. What the filter takes from a jet or its tip it takes from
    all corners around: triangles get the mean of that back."""
    if mesh.GetNumberOfPoints() == 0:
        return mesh
    smooth = vtkWindowedSincPolyDataFilter()
    smooth.SetNumberOfIterations(SMOOTHING)
    smooth.SetPassBand(PASS_BAND)
    smooth.FeatureEdgeSmoothingOff()
    smooth.NormalizeCoordinatesOn()
    out = passed(smooth, mesh)
    if mesh.GetNumberOfPolys():
        cells = vtk_to_numpy(out.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        before, points = (vtk_to_numpy(one.GetPoints().GetData()).astype(float) for one in (mesh, out))
        across = np.cross(points[cells[:, 1]] - points[cells[:, 0]], points[cells[:, 2]] - points[cells[:, 0]])
        normals = summed(cells, np.repeat(across[:, None], 3, axis=1), len(points))
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        taken = np.einsum("ij,ij->i", before - points, normals)[:, None]
        points = points + averaged(taken, normals, cells) * normals
        out.GetPoints().SetData(numpy_to_vtk(points.astype(np.float32), deep=True))
    return out


def summed(cells, values, count):
    """The sums at 'count' corners of a mesh [count][3] of values at the corners of its triangles [m][3][3]."""
    return np.stack([np.bincount(cells.ravel(), values[..., d].ravel(), count) for d in range(3)], axis=1)


def flattened(mesh, sized, origin, cell, spacing):
    """A mesh without the bumps that the particles of a place cannot resolve: by the Laplacian, weighted by their size,
    which leaves thin sheets and jets alone, since their particles are small. sized: see triangles()."""
    if mesh.GetNumberOfPoints() == 0 or sized.max() < SIZE_STEP:
        return mesh
    points = vtk_to_numpy(mesh.GetPoints().GetData())
    kind = np.log2(np.clip(sample(sized, (points[:, :sized.ndim] - origin) / cell), 1, 2 ** (len(TURNS) - 1)))
    total, done, smoother = 0, 0, mesh
    for k, own in enumerate(TURNS):
        turns = int(own * (spacing / cell) ** 2)
        if turns > done:
            smoother, done = relaxed(smoother, turns - done), turns
        total = total + np.clip(1 - np.abs(kind - k), 0, 1)[:, None] * vtk_to_numpy(smoother.GetPoints().GetData())
    mesh.GetPoints().SetData(numpy_to_vtk(total.astype(np.float32), deep=True))
    return mesh


def relaxed(mesh, turns):
    smooth = vtkSmoothPolyDataFilter()
    smooth.SetNumberOfIterations(turns)
    smooth.SetRelaxationFactor(RELAXED)
    smooth.SetConvergence(0)
    smooth.FeatureEdgeSmoothingOff()
    return passed(smooth, mesh)


def with_normals(mesh, closed):
    """Points [n][3], normals [n][3] (outward) and triangles [m][3] of a mesh (vtkPolyData); closed: only
    that the mesh is closed shows which side is out."""
    normals = vtkPolyDataNormals()
    normals.SplittingOff()
    normals.SetConsistency(closed)
    normals.SetAutoOrientNormals(closed)
    mesh = passed(normals, mesh)
    if mesh.GetNumberOfPoints() == 0:
        return np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3), int)
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    vectors = vtk_to_numpy(mesh.GetPointData().GetNormals()).astype(float)
    cells = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return points, vectors, cells


def softened(normals, cells):
    """Normals averaged over the mesh: a surface of particles is rough by a tenth of a spacing, which highlights would
    show."""
    total = averaged(normals, normals, cells)
    return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-30)


def averaged(values, normals, cells, passes=SOFT):
    """Values [n][k] at the corners of a mesh, averaged with their neighbours', but not across edges."""
    if not len(cells):
        return values
    pairs = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]])
    one, other = np.concatenate([pairs, pairs[:, ::-1]]).T
    weight = np.clip(np.einsum("ij,ij->i", normals[one], normals[other]), 0, 1) ** SHARP
    every = 1 + np.bincount(one, weight, len(values))
    for _ in range(passes):
        values = np.stack([(v + np.bincount(one, weight * v[other], len(v))) / every for v in values.T], axis=1)
    return values


def triangles(field, level, origin, cell, sized=None, spacing=0.0):
    """The smoothed surface of a field at a level: points [n][3], normals [n][3] (outward), triangles [m][3]. A field in
    two dimensions is of rings; its first direction crosses the axis. sized: of the particles there, over their
    spacing (m), a field, too; with it a flat surface is where the liquid ends, though the level is not a half."""
    if field.ndim == 2:
        first = int(round(-origin[0] / cell))
        joined = vtkStripper()
        joined.JoinContiguousSegmentsOn()
        joined.SetMaximumLength(max(field.size, 4))
        edges = contour(np.ascontiguousarray(field[first:]), level, (0, origin[1]), cell, vtkFlyingEdges2D())
        lines = passed(joined, edges)
        ends = vtk_to_numpy(lines.GetPoints().GetData())[:, 0] < 1e-6 * cell if lines.GetNumberOfPoints() else []
        origin, sized = np.array([0, origin[1]]), None if sized is None else sized[first:]
        lines = smoothed(lines)
        lines = lines if sized is None else flattened(lines, sized, origin, cell, spacing)
        points, normals, cells = revolve(lines, ends)
    else:
        edges = vtkFlyingEdges3D()
        edges.ComputeNormalsOff()
        mesh = smoothed(contour(field, level, origin, cell, edges))
        mesh = mesh if sized is None else flattened(mesh, sized, origin, cell, spacing)
        points, normals, cells = with_normals(mesh, False)
    if sized is not None and len(points):
        places = (in_plane(points, (0, 1, 2)[:field.ndim]) - origin) / cell
        own = sample(sized, places)
        away = (FILTER * own)**2 * spacing * curvature(points, normals, cells, spacing) / 2 - TOO_FAR * own
        points = points + away[:, None] * spacing * normals
    return points, normals, cells


def fitted(fluid, field, points, normals, cells):
    """The corners of a mesh, moved along their normals so that each piece of liquid has the volume of its particles:
    all corners of a piece by one part of the spacing there, at most FARTHEST. fluid has the particles, the grid, and
    what cuts the surface at faces at which the liquid ends flat; field: what the mesh is the contour of."""
    if not len(cells):
        return points
    piece = regions(field, LEVEL)
    own = fluid.spacing * sample(fluid.sized, fluid.places(points))
    of_point = nearest(piece, fluid.places(points - fluid.cell * normals))
    of_cell = of_point[cells].max(axis=1)
    round_axis = np.pi * np.abs(fluid.points[:, 0]) if len(fluid.axes) == 2 else 1  # rings are on both sides of it
    each = round_axis * fluid.share * fluid.spacing**len(fluid.axes)
    wanted = np.bincount(nearest(piece, fluid.places(fluid.points)), each, piece.max() + 1)

    def held(move):
        a, b, c = fluid.cut(points + (move[of_point] * own)[:, None] * normals)[cells].transpose(1, 0, 2)
        return np.bincount(of_cell, np.einsum("ij,ij->i", a, np.cross(b, c)) / 6, len(wanted))

    move, next_move = np.zeros(len(wanted)), np.full(len(wanted), FIRST_MOVE)
    former = held(move)
    for _ in range(SECANTS):
        volume = held(next_move)
        slope = (volume - former) / np.where(next_move == move, 1, next_move - move)
        former, move = volume, next_move
        next_move = np.clip(move + (wanted - volume) / np.where(slope > 0, slope, np.inf), -FARTHEST, FARTHEST)
    return points + (np.where(of_point > 0, next_move[of_point], 0) * own)[:, None] * normals


def regions(field, level):
    """The connected parts of a field above a level, numbered from 1, at its nodes; 0 elsewhere."""
    image, connect = vtkImageData(), vtkImageConnectivityFilter()
    image.SetDimensions(*(field.shape + (1,) * (3 - field.ndim))[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(field).ravel()))
    connect.SetScalarRange(level, float(field.max()))
    connect.SetExtractionModeToAllRegions()
    connect.SetLabelModeToSizeRank()
    connect.SetLabelScalarTypeToInt()
    return vtk_to_numpy(passed(connect, image).GetPointData().GetScalars()).reshape(field.shape)


def nearest(piece, places):
    """The pieces (of regions) at the nodes around places [n][d] in nodes; 0 where there is none."""
    base = np.clip(np.floor(places).astype(int), 0, np.array(piece.shape) - 2)
    return np.max([piece[tuple((base + corner).T)] for corner in np.ndindex(*(2,) * piece.ndim)], axis=0)


def curvature(points, normals, cells, spacing):
    """The sum of the principal curvatures (1/m) at the corners of a mesh, positive where it is convex, at most one over
    a spacing (m), averaged like the normals: a Gaussian of the width w moves a surface inwards by w^2/2 times as
    much. It is the gradient of the triangles' area."""
    corner = points[cells]
    side = np.roll(corner, -1, axis=1) - np.roll(corner, 1, axis=1)  # opposite to each corner
    across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    length = np.maximum(np.linalg.norm(across, axis=1), 1e-300)
    grows = np.cross(side, (across / length[:, None])[:, None]) / 2
    outward = np.sign(np.einsum("ij,ij->i", across, normals[cells[:, 0]]))
    grows = grows * outward[:, None, None]
    total = summed(cells, grows, len(points))
    area = np.bincount(cells.ravel(), np.repeat(length / 6, 3), len(points))
    bent = np.einsum("ij,ij->i", total, normals) / np.maximum(area, 1e-300)
    return averaged(np.clip(bent, -1 / spacing, 1 / spacing)[:, None], normals, cells, CALM)[:, 0]


def revolve(lines, on_axis=()):
    """The surface that lines (vtkPolyData; x is the distance from the axis, y the position along it) sweep around
    the axis z, in the form of triangles(). on_axis: flags of the points to be put on the axis, or none."""
    if lines.GetNumberOfPoints() == 0:
        return np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3), int)
    flat = vtk_to_numpy(lines.GetPoints().GetData()).astype(float)
    places = np.stack([np.maximum(flat[:, 0], 0), 0 * flat[:, 0], flat[:, 1]], axis=1)
    if len(on_axis):
        places[on_axis, 0] = 0
    profile, corners = vtkPolyData(), vtkPoints()
    corners.SetData(numpy_to_vtk(places, deep=True))
    profile.SetPoints(corners)
    profile.SetLines(lines.GetLines())
    sweep, clean = vtkRotationalExtrusionFilter(), vtkCleanPolyData()
    sweep.SetResolution(AROUND)
    sweep.CappingOff()
    clean.SetTolerance(1e-7)  # joins the corners of the seam, and the corners on the axis
    return with_normals(passed(clean, passed(vtkTriangleFilter(), passed(sweep, profile))), True)


def strays(centers, spacing, share, rings):
    """Isolated particles at centers [n][3] (m) as spheres of their volumes, share [n] over spacing^3; rings as tori,
    with share their areas over spacing^2."""
    if not rings:
        return spheres(centers, spacing * (3 * share / (4 * np.pi)) ** (1 / 3))
    once = centers[:, 0] > 0  # not the mirror images
    return tori(centers[once], spacing * np.sqrt(share[once] / np.pi))


def tori(centers, radius):
    """Tori about the axis z through centers [n][3] at y = 0 (m), of the radii [n] (m): points, normals, triangles."""
    turn = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    flat = np.zeros((len(centers), len(turn), 3))
    flat[..., 0] = np.abs(centers[:, 0])[:, None] + radius[:, None] * np.cos(turn)
    flat[..., 1] = centers[:, 2][:, None] + radius[:, None] * np.sin(turn)
    lines, corners, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    corners.SetData(numpy_to_vtk(flat.reshape(-1, 3), deep=True))
    loops = np.arange(flat.shape[0] * len(turn)).reshape(-1, len(turn))
    loops = np.concatenate([loops, loops[:, :1]], axis=1)
    cells.SetData(len(turn) + 1, numpy_to_vtkIdTypeArray(np.ascontiguousarray(loops.ravel(), np.int64), deep=True))
    lines.SetPoints(corners)
    lines.SetLines(cells)
    return revolve(lines)


def spheres(centers, radius):
    """Spheres of the radii [n] about centers [n][3] (m): points, normals, triangles."""
    source = vtkSphereSource()
    source.SetThetaResolution(12)
    source.SetPhiResolution(8)
    source.SetRadius(1)
    source.Update()
    unit = vtk_to_numpy(source.GetOutput().GetPoints().GetData()).astype(float)
    cells = vtk_to_numpy(source.GetOutput().GetPolys().GetConnectivityArray()).reshape(-1, 3)
    points = (centers[:, None, :] + radius[:, None, None] * unit).reshape(-1, 3)
    offsets = np.arange(len(centers))[:, None, None] * len(unit)
    return points, np.tile(unit, (len(centers), 1)), (cells + offsets).reshape(-1, 3)


def surface(liquid, layer=False):
    """Points, normals, triangles and drop shares (layer: see drop_share) of the liquid's surface."""
    mesh = liquid.mesh()
    loose = liquid.lonely(liquid.block, LEVEL, np.ones(len(liquid.points), bool))
    balls = strays(liquid.points[loose], liquid.spacing, liquid.share[loose], liquid.rings)
    own = np.repeat(liquid.of_drop[loose], len(balls[0]) // max(1, loose.sum()))
    own = liquid.drop_share(balls[0]) if liquid.rings else own
    share = np.concatenate([liquid.drop_share(mesh[0] - 0.5 * liquid.spacing * mesh[1], layer), own])
    return (np.concatenate([mesh[0], balls[0]]), np.concatenate([mesh[1], balls[1]]),
            np.concatenate([mesh[2], balls[2] + len(mesh[0])]), share)


def sky(directions):
    """Light from directions [n][3] (unit vectors): ground, horizon, zenith and a bright window."""
    up = directions[:, 2:3]
    light = np.where(up > 0, HORIZON + (ZENITH - HORIZON) * np.sqrt(np.clip(up, 0, 1)),
                     HORIZON + (GROUND - HORIZON) * np.clip(-4 * up, 0, 1))
    lamp = np.array([-0.45, -0.25, 0.86])
    glow = np.clip((directions @ (lamp / np.linalg.norm(lamp)) - 0.9) / 0.06, 0, 1)[:, None]
    return light + 3.5 * glow


def colors(normals, base, shade, toward_eye, wet=1.0):
    """Colours [n][3] (bytes) of a surface: its own, scattered, and the mirror image of the sky (Schlick) times its
    wetness."""
    facing = np.sum(normals * toward_eye, axis=1, keepdims=True)
    normals = np.where(facing < 0, -normals, normals)
    facing = np.abs(facing)
    lamp = np.array([-0.35, -0.55, 0.76])
    direct = np.clip(normals @ (lamp / np.linalg.norm(lamp)), 0, 1)[:, None]
    ambient = (0.55 + 0.45 * normals[:, 2:3]) * shade[:, None]
    mirror = 2 * facing * normals - toward_eye
    fresnel = 0.08 + 0.92 * (1 - facing) ** 4
    image = sky(mirror) * (0.35 + 0.65 * shade[:, None])
    scattered = base * (0.63 * ambient + 0.75 * direct * (0.4 + 0.6 * shade[:, None]))
    color = scattered + wet * np.minimum(fresnel, 0.6) * image
    return (255 * np.clip(color, 0, 1) ** (1 / 1.25)).astype(np.uint8)


def line_actor(lines):
    """Lines from a to b, [(a, b), ...] in m."""
    mesh, corners, pairs = vtkPolyData(), vtkPoints(), vtkCellArray()
    corners.SetData(numpy_to_vtk(np.array(lines, np.float32).reshape(-1, 3), deep=True))
    pairs.SetData(2, numpy_to_vtkIdTypeArray(np.arange(2 * len(lines), dtype=np.int64), deep=True))
    mesh.SetPoints(corners)
    mesh.SetLines(pairs)
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(mesh)
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(0.6, 0.6, 0.6)
    actor.GetProperty().SetLineWidth(1.5)
    actor.GetProperty().LightingOff()
    return actor


def render(points, cells, rgb, camera, size, lines=()):
    """Draws triangles with a colour for each corner: an array [height][width][3] of bytes. camera as for picture();
    lines: ends (m) of thin grey lines."""
    mesh = vtkPolyData()
    corners = vtkPoints()
    corners.SetData(numpy_to_vtk(points.astype(np.float32), deep=True))
    polygons = vtkCellArray()
    polygons.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(cells.ravel(), np.int64), deep=True))
    mesh.SetPoints(corners)
    mesh.SetPolys(polygons)
    mesh.GetPointData().SetScalars(numpy_to_vtk(rgb, deep=True))
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(mesh)
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().LightingOff()
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(actor)
    if len(lines):
        renderer.AddActor(line_actor(lines))
    view = renderer.GetActiveCamera()
    view.SetPosition(*camera["position"])
    view.SetFocalPoint(*camera["focus"])
    view.SetViewUp(*camera["up"])
    if "angle" in camera:
        view.SetViewAngle(camera["angle"])
    else:
        view.ParallelProjectionOn()
        view.SetParallelScale(camera["height"] / 2)
    renderer.ResetCameraClippingRange()
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(*size)
    window.AddRenderer(renderer)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    image = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).reshape(size[1], size[0], -1)
    window.Finalize()
    return image[::-1, :, :3].copy()


def painted(liquid, camera, pale=False):
    """Points, triangles and colours [n][3] (bytes) of the surface as the camera sees it, for render(). pale: a pale
    film, so that the drop's liquid shows.

    camera: position, focus, up (m), and either 'angle' (degrees, perspective) or 'height' (m, parallel projection).
    """
    points, normals, cells, share = surface(liquid, pale)
    eye, focus = np.array(camera["position"], float), np.array(camera["focus"], float)
    toward = eye - points if "angle" in camera else np.broadcast_to(eye - focus, points.shape)
    toward = toward / np.linalg.norm(toward, axis=1, keepdims=True)
    film = PALE_COLOR if pale else FILM_COLOR
    film = film + liquid.thinness(points, normals)[:, None] * (THIN_COLOR - film)
    base = film + share[:, None] * (DROP_COLOR - film)
    shade = liquid.shade(points, normals)
    return points, cells, colors(normals, base, shade, toward, 0.3 if pale else 1.0)


def section(liquid, window, pixels):
    """Colours of the section at y = 0, seen along y: image [rows][columns][3], from 0 to 1; outline() has its edge.

    window: x and z limits (x0, x1, z0, z1), m; pixels: the size of a pixel, m.
    """
    deviation = FILTER * liquid.spacing * liquid.size
    slab = np.abs(liquid.points[:, 1]) <= 3 * deviation
    y, size, deviation = liquid.points[slab, 1], liquid.size[slab], deviation[slab]
    shape = (int(round((window[1] - window[0]) / pixels)), int(round((window[3] - window[2]) / pixels)))
    places = (liquid.points[slab][:, [0, 2]] - [window[0], window[2]]) / pixels - 0.5
    weight = liquid.share[slab] * liquid.spacing ** 2 / pixels ** 2
    if not liquid.rings:
        weight *= liquid.spacing * np.exp(-(y / deviation) ** 2 / 2) / (deviation * np.sqrt(2 * np.pi))
    drop, both = spread(places, size, (weight * liquid.of_drop[slab], weight), shape, FILTER * liquid.spacing / pixels)
    share = np.clip((drop / np.maximum(both, 1e-6) - 0.1) / 0.3, 0, 1)[..., None]  # thin layers show
    return (FILM_COLOR + share * (DROP_COLOR - FILM_COLOR)).transpose(1, 0, 2)


def outline(points, cells):
    """Where a surface crosses y = 0: loops of x and z, each [n][2], in m."""
    mesh, corners, polygons = vtkPolyData(), vtkPoints(), vtkCellArray()
    corners.SetData(numpy_to_vtk(points, deep=True))
    polygons.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(cells.ravel(), np.int64), deep=True))
    mesh.SetPoints(corners)
    mesh.SetPolys(polygons)
    plane, cutter, joined = vtkPlane(), vtkCutter(), vtkStripper()
    plane.SetOrigin(0, 1e-6 * np.ptp(points[:, 1]), 0)  # not through the corners that a mirror has
    plane.SetNormal(0, 1, 0)
    cutter.SetCutFunction(plane)
    joined.SetMaximumLength(len(points) + 4)
    joined.JoinContiguousSegmentsOn()
    lines = passed(joined, passed(cutter, mesh))
    if not lines.GetNumberOfLines():
        return []
    places = vtk_to_numpy(lines.GetPoints().GetData())[:, [0, 2]].astype(float)
    ends = vtk_to_numpy(lines.GetLines().GetOffsetsArray())
    order = vtk_to_numpy(lines.GetLines().GetConnectivityArray())
    return [places[order[low:high]] for low, high in zip(ends, ends[1:])]
