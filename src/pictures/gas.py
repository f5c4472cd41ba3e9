"""Enclosed gas (-gas) in pictures: what neither liquid nor solids fill, and no open face reaches, with the pressures of
pockets.csv. Lengths in m."""
import os

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkImagingMorphological import vtkImageConnectivityFilter

import columns
import surface
from isph import tables

COLOR, FAINT = "#E8C547", 0.35  # of pockets, and how much of it shows through liquid
LEAST = 4  # cells of spacing^dim: smaller voids are none that a picture shows
NEAR = 0.02  # of the run: the row of pockets.csv is of the same time


def wanted(run):
    """Whether the run has gas."""
    return any(option["name"] == "-gas" and option["value"] in ("true", "1", "")
               for option in run.scene.get("options", ()))


def regions(free):
    """The connected regions of a field of flags, by numbers from 1; 0: not free."""
    image, joined = vtkImageData(), vtkImageConnectivityFilter()
    image.SetDimensions(*(free.shape + (1,) * (3 - free.ndim)))
    image.GetPointData().SetScalars(numpy_to_vtk(free.astype(np.uint8).ravel(order="F"), deep=True))
    joined.SetScalarRange(1, 1)
    joined.SetExtractionModeToAllRegions()
    joined.SetLabelModeToSizeRank()
    joined.SetLabelScalarTypeToInt()
    out = surface.passed(joined, image).GetPointData().GetScalars()
    return vtk_to_numpy(out).reshape(free.shape, order="F")


class Pockets:
    """The pockets of a state on a grid over the box (of rings: over the section through the axis). field: above
    surface.LEVEL in pockets, below it elsewhere; every: (centre [axes], pressure or None) of each."""

    def __init__(self, run, state):
        self.axes = [0, 1] if run.dim == 2 else [0, 2] if run.rings else [0, 1, 2]
        low, high = run.lower[self.axes], run.upper[self.axes]
        least = (np.prod(high - low) / surface.MOST_NODES) ** (1 / len(self.axes))
        self.cell, self.origin = max(surface.CELL * run.spacing, least), low
        shape = tuple(np.ceil((high - low) / self.cell).astype(int) + 1)
        points = np.concatenate([state.points, state.solid])
        share, size = (np.concatenate([array, np.ones(len(state.solid))]) for array in (state.share, state.size))
        own = np.arange(len(points)) < len(state.points)
        margin = 4 * surface.FILTER * run.spacing * size.max(initial=1)
        near, (share, size, own) = surface.images(run, points, [share, size, own], margin)
        weight = share * (run.spacing / self.cell) ** len(self.axes)
        full, liquid = surface.spread((near[:, self.axes] - low) / self.cell, size, [weight, weight * own], shape,
                                      surface.FILTER * run.spacing / self.cell)
        for d, axis in enumerate(self.axes):
            if run.faces[axis][1] != "open":  # a node beyond a face is no gas
                full[(np.s_[:],) * d + (low[d] + self.cell * np.arange(shape[d]) > high[d],)] = 1
        wet = surface.blur((liquid > surface.LEVEL).astype(np.float32), 1.0) > 1e-3  # solids are hollow here
        number = regions(full < surface.LEVEL)
        kept = np.bincount(number.ravel()) * self.cell ** len(self.axes) >= LEAST * run.spacing ** len(self.axes)
        kept &= np.bincount(number[wet], minlength=len(kept)) > 0
        kept[0] = False
        for d, axis in enumerate(self.axes):
            for side, place in ((0, 0), (1, -1)):
                if run.faces[axis][side] == "open":
                    kept[np.unique(np.take(number, place, axis=d))] = False
        inside = kept[number]
        around = surface.blur(inside.astype(np.float32), 1.0) > 1e-3  # and its neighbours, between which its edge is
        near = around & (inside | (full >= surface.LEVEL))
        self.field = np.where(near, 2 * surface.LEVEL - full, 0).astype(np.float32)
        self.every = [(centre, pressure_at(run, state.time, centre, self.axes)) for centre in (
            low + self.cell * np.argwhere(number == k).mean(axis=0) for k in np.flatnonzero(kept))]

    def mesh(self):
        """Points and triangles: the surface of the pockets, in a plane the cells that they fill."""
        if len(self.axes) == 3 or self.axes[1] == 2:
            points, _, cells = self.surface()
            return points, cells
        ends = np.diff(np.pad(self.field > surface.LEVEL, ((0, 0), (1, 1))).astype(int), axis=1)
        (line, begin), (_, end) = np.argwhere(ends > 0).T, np.argwhere(ends < 0).T  # the filled parts of each line
        sides = ((-0.5, begin), (0.5, begin), (0.5, end), (-0.5, end))
        corners = [np.stack([line + x, side], axis=1) for x, side in sides]
        points = self.origin + self.cell * (np.stack(corners, axis=1).reshape(-1, 2) - [0, 0.5])
        first = 4 * np.arange(len(line))[:, None]
        cells = np.concatenate([first + [0, 1, 2], first + [0, 2, 3]])
        return np.column_stack([points, np.zeros(len(points))]), cells

    def surface(self):
        """Points, normals and triangles of the surface of the pockets, in space and of rings."""
        return surface.triangles(self.field, surface.LEVEL, self.origin, self.cell)

    def section(self, axes, run, unit):
        """Draws the tint and the pressures into a section. unit: factor on m."""
        if not self.every:
            return
        field = self.field[:, self.field.shape[1] // 2] if len(self.axes) == 3 else self.field
        x, z = (unit * (self.origin[d] + self.cell * np.arange(n)) for d, n in zip((0, -1), field.shape))
        axes.contourf(x, z, field.T, levels=[surface.LEVEL, 10], colors=[COLOR], alpha=FAINT, zorder=0.5)
        for centre, pressure in self.every:
            if pressure is None or run.rings and centre[0] < -0.5 * run.spacing:
                continue
            factor, name = columns.prefixed(pressure, "Pa")
            axes.text(unit * centre[0], unit * centre[-1], f"{factor * pressure:.3g} {name}", fontsize=7, ha="center",
                      va="center", zorder=4)


def surface_of(run, state):
    """Points, normals and triangles of the pockets of a state in space or with rings; none without -gas."""
    if not wanted(run):
        return np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3), int)
    return Pockets(run, state).surface()


def draw(axes, run, state, unit):
    """Draws the pockets of a run with gas into a section."""
    if wanted(run):
        Pockets(run, state).section(axes, run, unit)


def pressure_at(run, time, centre, axes):
    """The pressure (Pa) of the row of pockets.csv whose centre is nearest at a time; None: there is no such row."""
    path = os.path.join(run.folder, "pockets.csv")
    if not os.path.exists(path):
        return None
    try:
        table = tables.read_table(path)
    except tables.Error:
        return None
    times = np.array(table["time"])
    now = np.abs(times - time)
    rows = np.flatnonzero(now <= now.min() + 1e-12) if len(now) else []
    if not len(rows) or now.min() > NEAR * max(np.ptp(times), 1e-300):
        return None
    names = ["xy"[k] for k in range(2)] if run.rings else ["xyz"[axis] for axis in axes]
    there = np.array([[table[name][row] for name in names] for row in rows])
    near = np.linalg.norm(there - (np.abs(centre) if run.rings else centre), axis=1)
    pressure = table["pressure"][rows[near.argmin()]]
    return pressure if np.isfinite(pressure) else None
