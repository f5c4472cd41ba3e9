"""Views of one state: a section with matplotlib; the liquid's surface in perspective or from above with VTK."""
import matplotlib
import numpy as np
from matplotlib.collections import EllipseCollection, PolyCollection

import gas
import solids
import surface

# Okabe and Ito, distinct for colour-blind eyes too
BODY_COLORS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#555555")
SOLID_COLOR = "#9a9a9a"
FLOOR = np.array([0.90, 0.90, 0.88])
MAPS = {"pressure": "cividis", "size": "turbo", "temperature": "inferno"}  # others: viridis
PERCENTILE = 99  # of the values at the end of a colour scale, so that no single particle of spray sets it
ANGLE = 22.0  # degrees, of the perspective
ROOM = 1.05  # size of a picture over that of its contents
PANEL = (1000, 760)  # pixels


def rgb_of(name):
    return np.array([int(name[k:k + 2], 16) / 255 for k in (1, 3, 5)])


def colormap(color):
    return matplotlib.colormaps[MAPS.get(color, "viridis")]


def limits(states, color):
    """Ends of the colour scale over all states; None for bodies."""
    if color == "body":
        return None
    values = np.concatenate([getattr(state, color) for state in states])
    low = np.percentile(values, 100 - PERCENTILE)
    low = {"speed": 0.0, "pressure": min(0.0, low)}.get(color, low)
    high = np.percentile(values, PERCENTILE)
    return low, high if high > low else low + 1


def section(axes, run, state, color, ends, unit):
    """Draws the particles of a slab through the middle (in two dimensions all) as discs of their spacing. unit:
    factor on m."""
    pair = (0, run.up)
    chosen = np.ones(len(state.points), bool)
    shapes, exact = solids.outlines(run, state.path) if len(state.solid) else ([], [])
    solid = state.solid[~np.isin(state.solid_of, exact)]
    if run.dim == 3:
        middle = 0.5 * (run.lower[1] + run.upper[1])
        chosen = np.abs(state.points[:, 1] - middle) <= 0.75 * run.spacing * state.size
        solid = solid[np.abs(solid[:, 1] - middle) <= 0.75 * run.spacing]

    def discs(points, size, **style):
        n = size * run.spacing * unit
        axes.add_collection(EllipseCollection(n, n, np.zeros(len(n)), units="xy", offsets=points[:, pair] * unit,
                                              transOffset=axes.transData, linewidths=0, **style))

    if len(solid):
        discs(solid, np.ones(len(solid)), facecolors=SOLID_COLOR)
    if shapes:
        axes.add_collection(PolyCollection([unit * shape for shape in shapes], facecolors=SOLID_COLOR, linewidths=0))
    points, size = state.points[chosen], state.size[chosen]
    if color == "body":
        discs(points, size, facecolors=[BODY_COLORS[b % len(BODY_COLORS)] for b in state.body[chosen]])
    else:
        discs(points, size, array=getattr(state, color)[chosen], cmap=colormap(color), clim=ends)
    frame(axes, run, unit)


def frame(axes, run, unit):
    """Draws walls as thick lines, mirrors as dashed lines."""
    x0, x1 = run.lower[0] * unit, run.upper[0] * unit
    z0, z1 = run.lower[run.up] * unit, run.upper[run.up] * unit
    lines = (((x0, x0), (z0, z1), run.faces[0][0]), ((x1, x1), (z0, z1), run.faces[0][1]),
             ((x0, x1), (z0, z0), run.faces[run.up][0]), ((x0, x1), (z1, z1), run.faces[run.up][1]))
    for x, z, kind in lines:
        if kind == "wall":
            axes.plot(x, z, color="black", lw=4, zorder=3)  # its outer half is cut off
        elif kind in ("symmetry", "periodic"):
            axes.plot(x, z, color="0.6", lw=0.8, ls=(0, (4, 4)), zorder=3)


class Fluid:
    """Volume fraction of the particles on a grid over the box (rings: over the section through the axis), and the
    mean of values there. share, size: see State. coarser: factor on the cells of a picture."""

    def __init__(self, run, points, values, share, size, coarser=1):
        inside = np.all((points >= run.lower - run.spacing) & (points <= run.upper + run.spacing), axis=1)
        self.points, self.spacing, self.run = points[inside], run.spacing, run
        self.share = share = share[inside]
        values, size = values[inside], size[inside]
        self.axes = axes = [0, 2] if run.rings else [0, 1, 2]
        margin = max(4 * surface.FILTER * size.max(initial=1), (surface.BEHIND + 2) * surface.CELL) * run.spacing
        lower = np.maximum(run.lower, self.points.min(axis=0) - margin)[axes]
        upper = np.minimum(run.upper, self.points.max(axis=0) + margin)[axes]
        least = (np.prod(upper - lower) / surface.MOST_NODES) ** (1 / len(axes))
        self.cell = max(surface.CELL * run.spacing * coarser, least)
        self.origin = lower - np.ceil(margin / self.cell) * self.cell
        if run.rings:  # a node is on the axis
            self.origin[0] = self.cell * np.floor(self.origin[0] / self.cell)
        shape = np.ceil((upper - lower) / self.cell).astype(int) + 2 * int(np.ceil(margin / self.cell)) + 1 + run.rings
        near, (value, share, size) = surface.images(run, self.points, [values, share, size], margin)
        places, weight = (near[:, axes] - self.origin) / self.cell, share * (run.spacing / self.cell) ** len(axes)
        self.fraction, sized, *self.moment = surface.spread(
            places, size, [weight, weight * size, *(weight * value.T)], shape, surface.FILTER * run.spacing / self.cell)
        self.sized = sized / np.maximum(self.fraction, 1e-6)
        for d, axis in enumerate(axes):  # liquid ends flat at faces that are not open
            ends = [(run.lower, run.upper)[side][axis] if kind != "open" else (2 * side - 1) * np.inf
                    for side, kind in enumerate(run.faces[axis])]
            lower, upper = (np.array(ends) - self.origin[d]) / self.cell
            behind = min(surface.BEHIND, margin / self.cell - 2)
            self.fraction, *self.moment = (surface.ended(field, d, lower, upper, behind)
                                           for field in (self.fraction, *self.moment))

    def places(self, points):
        return (surface.in_plane(points, self.axes) - self.origin) / self.cell

    def values(self, points):
        """[n][columns]: the mean of the values at points of the surface."""
        places = self.places(points)
        amount = np.maximum(surface.sample(self.fraction, places), 1e-6)
        return np.stack([surface.sample(moment, places) / amount for moment in self.moment], axis=1)

    def normals(self, points):
        """[n][3]: outward normals at points of the surface, by differences of the volume fraction over two spacings."""
        way = np.eye(3)[self.axes] * self.spacing
        if len(self.axes) == 2:  # of rings: away from the axis, and along it
            out = points * [1, 1, 0]
            out /= np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-30)
            way = [self.spacing * out, way[1]]
        sides = [np.broadcast_to(one, points.shape) for one in way]
        slope = sum((surface.sample(self.fraction, self.places(points - one))
                     - surface.sample(self.fraction, self.places(points + one)))[:, None] * one for one in sides)
        return slope / np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-30)

    def cut(self, points):
        """Points of the surface [n][3]; those beyond faces that are not open are put onto these."""
        closed = np.array(self.run.faces) != "open"
        lower, upper = np.where(closed[:, 0], self.run.lower, -np.inf), np.where(closed[:, 1], self.run.upper, np.inf)
        return surface.cut(points, lower, upper, self.run.rings)

    def mesh(self):
        """Points, normals, triangles of the surface, and which particles are outside it."""
        points, normals, cells = surface.triangles(self.fraction, surface.LEVEL, self.origin, self.cell, self.sized,
                                                   self.spacing)
        points = surface.fitted(self, self.fraction, points, normals, cells)
        lonely = surface.sample(self.fraction, self.places(self.points)) < surface.LEVEL
        return points, normals, cells, lonely


def value_table(state, color, bodies):
    """The values for the surface's colour: a column for each body, or the scalar."""
    if color == "body":
        table = np.stack([state.body == b for b in range(bodies)], axis=1).astype(float)
        if bodies > 1 and state.first is not None:
            table *= (1 - state.first)[:, None]
            table[state.body == 0, 1] = 1 - state.first[state.body == 0]
            table[:, 0] = state.first
        return table
    return getattr(state, color)[:, None]


def base_colors(table, color, ends, colormap):
    """Colours [n][3] of values [n][columns]."""
    if color != "body":
        return colormap(np.clip((table[:, 0] - ends[0]) / (ends[1] - ends[0]), 0, 1))[:, :3]
    share = np.clip(table, 0, 1) ** 3
    share /= np.maximum(share.sum(axis=1, keepdims=True), 1e-9)
    return share @ np.array([rgb_of(BODY_COLORS[b % len(BODY_COLORS)]) for b in range(table.shape[1])])


def solid_mesh(run, state):
    """Points, normals and triangles of the solids: as they are where their triangles are known, else the contour of
    their dummy particles."""
    nothing = np.zeros((0, 3))
    (points, normals, cells), exact = solids.drawn(run, state.path) if len(state.solid) else (
        (nothing, nothing, nothing.astype(int)), [])
    rest = state.solid[~np.isin(state.solid_of, exact)]
    if len(rest):
        more = Fluid(run, rest, np.zeros((len(rest), 1)), *np.ones((2, len(rest)))).mesh()
        cells = np.concatenate([cells, more[2] + len(points)])
        points, normals = np.concatenate([points, more[0]]), np.concatenate([normals, surface.softened(*more[1:3])])
    return points, normals, cells


def floor_mesh(run, focus, half):
    """The floor, if it is a wall: two triangles, cut to the neighbourhood of the view."""
    if run.faces[2][0] != "wall":
        return np.zeros((0, 3)), np.zeros((0, 3), int)
    x0, y0 = np.maximum(run.lower[:2], focus[:2] - half)
    x1, y1 = np.minimum(run.upper[:2], focus[:2] + half)
    z = run.lower[2]
    if run.rings:
        turn = np.linspace(0, 2 * np.pi, surface.AROUND, endpoint=False)
        rim = min(half, run.upper[0]) * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
        corner = np.arange(1, len(turn) - 1)
        return rim + [0, 0, z], np.stack([0 * corner, corner, corner + 1], axis=1)
    return np.array([[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]]), np.array([[0, 1, 2], [0, 2, 3]])


def camera(run, states, azimuth, elevation):
    """A perspective that contains the box around the liquid of all states, and half of the diagonal of this box."""
    points = run.around(np.concatenate([part for state in states for part in (state.points, state.solid)]))
    lower = np.maximum(run.lower, np.percentile(points, 0.5, axis=0) - run.spacing)
    upper = np.minimum(run.upper, np.percentile(points, 99.5, axis=0) + run.spacing)
    focus = 0.5 * (lower + upper)
    a, e = np.radians(azimuth), np.radians(elevation)
    way = np.array([np.cos(e) * np.sin(a), -np.cos(e) * np.cos(a), np.sin(e)])
    right = np.array([np.cos(a), np.sin(a), 0])
    corners = np.array([[x, y, z] for x in (lower[0], upper[0]) for y in (lower[1], upper[1])
                        for z in (lower[2], upper[2])]) - focus
    slope = np.tan(np.radians(ANGLE / 2))
    wide = np.abs(corners @ right) * PANEL[1] / PANEL[0]
    high = np.abs(corners @ np.cross(way, right))
    distance = (corners @ way + ROOM * np.maximum(wide, high) / slope).max()
    return (dict(position=focus + distance * way, focus=focus, up=(0, 0, 1), angle=ANGLE),
            0.5 * np.linalg.norm(upper - lower))


def above(run, states):
    """A parallel view from above."""
    points = run.around(np.concatenate([state.points for state in states]))
    lower, upper = np.maximum(run.lower, points.min(axis=0)), np.minimum(run.upper, points.max(axis=0))
    focus = 0.5 * (lower + upper)
    wide, high = upper[:2] - lower[:2] + 4 * run.spacing
    height = max(high, wide * PANEL[1] / PANEL[0])
    return dict(position=focus + [0, 0, 1], focus=focus, up=(0, 1, 0), height=height), 0.5 * max(wide, high)


class Shape:
    """What a picture shows of a state, from wherever it is seen. liquid, solid, gas: points, normals, triangles, and
    the colours at the points."""

    def __init__(self, run, state, color, ends, colormap):
        fluid = Fluid(run, state.points, value_table(state, color, len(run.bodies)), state.share, state.size)
        points, normals, cells, lonely = fluid.mesh()
        points, normals = fluid.cut(points), surface.softened(normals, cells)
        balls = surface.strays(fluid.points[lonely], run.spacing, fluid.share[lonely], run.rings)
        cells = np.concatenate([cells, balls[2] + len(points)])
        points, normals = np.concatenate([points, balls[0]]), np.concatenate([normals, balls[1]])
        base = base_colors(fluid.values(points - 0.5 * run.spacing * normals), color, ends, colormap)
        self.liquid = points, normals, cells, base
        self.solid, self.gas = ((*mesh, np.tile(rgb_of(color), (len(mesh[0]), 1))) for mesh, color in (
            (solid_mesh(run, state), SOLID_COLOR), (gas.surface_of(run, state), gas.COLOR)))


def picture(run, shape, view, half, size=PANEL):
    """Renders a Shape and the floor: [height][width][3] bytes. Pockets of gas show through the liquid around them."""
    eye, focus = np.array(view["position"], float), np.array(view["focus"], float)

    def lit(points, normals, cells, base):
        toward = eye - points if "angle" in view else np.broadcast_to(eye - focus, points.shape)
        toward = toward / np.linalg.norm(toward, axis=1, keepdims=True)
        return points, cells, surface.colors(normals, base, np.ones(len(points)), toward)

    def drawn(*parts):
        first = np.cumsum([0] + [len(points) for points, _, _ in parts])
        points, cells, rgb = zip(*parts)
        cells = [part + start for part, start in zip(cells, first)]
        return surface.render(*map(np.concatenate, (points, cells, rgb)), view, size)

    ground, corners = floor_mesh(run, focus, 1.5 * half)
    dry = lit(*shape.solid), (ground, corners, np.tile((255 * FLOOR).astype(np.uint8), (len(ground), 1)))
    image = drawn(lit(*shape.liquid), *dry)
    if len(shape.gas[2]):
        without, within = drawn(*dry), drawn(*dry, lit(*shape.gas))
        seen = (without != within).any(axis=2)
        image[seen] = np.rint((1 - gas.FAINT) * image[seen] + gas.FAINT * within[seen])
    return image
