"""The data of viewer.js: the liquid, its colours, walls and solids at several times, as numbers of one or two bytes."""
import base64
import functools
from types import SimpleNamespace

import matplotlib.ticker
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkBinnedDecimation, vtkQuadricDecimation

import columns
import gas
import run as data
import solids
import surface
import views
from display import together

STEPS, SHADES = 65535, 255  # of a 16-bit coordinate, of an 8-bit value
COARSEST, COARSEST_RINGS = 1.4, 2  # largest cells of the surface over those of a picture: sheets need finer ones
BINNED = 2.5  # times the triangles wanted: so many are left by bins, whose corners join; others go by their error
SIDES = 127  # steps of a component of a normal, to either side
MARGIN = 0.05  # of the box around it, where walls and solids may be drawn
STRIP = 0.015  # thickness of walls in two dimensions over the box
AZIMUTH, ELEVATION = 25, 25  # degrees, of the first view
SEVERAL = 1.01  # ratio of spacings that are worth a colour
TICKS = 5  # steps of a colour scale, at most


def packed(array, kind):
    return base64.b64encode(np.ascontiguousarray(array, kind).tobytes()).decode()


def thin(points, cells, most):
    """The mesh with at most so many triangles."""
    if len(cells) <= most or not len(cells):
        return points, cells
    mesh = vtkPolyData()
    corners = vtkPoints()
    corners.SetData(numpy_to_vtk(points, deep=True))
    mesh.SetPoints(corners)
    polygons = vtkCellArray()
    polygons.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(cells.ravel(), np.int64), deep=True))
    mesh.SetPolys(polygons)
    if len(cells) > BINNED * most:
        mesh = surface.passed(bins(points, cells, BINNED * most), mesh)
    fewer = vtkQuadricDecimation()
    fewer.SetTargetReduction(max(0, 1 - most / mesh.GetNumberOfCells()))
    out = surface.passed(fewer, mesh)
    return (vtk_to_numpy(out.GetPoints().GetData()).astype(float),
            vtk_to_numpy(out.GetPolys().GetConnectivityArray()).reshape(-1, 3))


def bins(points, cells, most):
    """The filter that leaves about so many triangles: two for each bin that the surface crosses."""
    one, two, three = (points[cells[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(two - one, three - one), axis=1).sum()
    joined = vtkBinnedDecimation()
    count = np.ceil(np.ptp(points, axis=0) / np.sqrt(2 * area / most)).astype(int).clip(1)
    joined.SetNumberOfDivisions(*count.tolist())
    joined.AutoAdjustNumberOfDivisionsOff()
    joined.SetPointGenerationModeToUseInputPoints()
    return joined


def walls(run):
    """The faces that are walls, as quadrilaterals [n][4][3]: in two dimensions strips outside the box, around rings
    discs and a cylinder."""
    found = []
    turn = np.linspace(0, 2 * np.pi, surface.AROUND // 4 + 1)
    rim = run.upper[0] * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    for d in range(run.dim):
        for side, face in enumerate((run.lower, run.upper)):
            if run.faces[d][side] != "wall":
                continue
            along = np.eye(3)[d]
            if not run.rings:
                low, high = run.lower.copy(), run.upper.copy()
                low[d] = high[d] = face[d]
                if run.dim == 2:
                    low[2] = high[2] = 0
                    high[d] += (2 * side - 1) * STRIP * (run.upper - run.lower)[:2].max()
                u, v = (0, 1) if run.dim == 2 else [e for e in range(3) if e != d]
                quad = np.array([low, low, high, high])
                quad[1, u], quad[3, u] = high[u], low[u]
                quad[[0, 1], v], quad[[2, 3], v] = low[v], high[v]
                found.append(quad[None])
            elif d == 2:
                ring = rim + face[2] * along
                middle = np.broadcast_to(face[2] * along, ring[1:].shape)
                found.append(np.stack([middle, ring[:-1], ring[1:], middle], axis=1))
            elif d == side == 0:
                low, high = rim + [0, 0, run.lower[2]], rim + [0, 0, run.upper[2]]
                found.append(np.stack([low[:-1], low[1:], high[1:], high[:-1]], axis=1))
    return np.concatenate(found) if found else np.zeros((0, 4, 3))


class Shapes:
    """Packs shapes: meshes in three dimensions, discs in two."""

    def __init__(self, run):
        span = run.upper - run.lower
        room = MARGIN * span.max()
        self.lower, self.span = run.lower - room, span + 2 * room
        self.spacing = run.spacing

    def pack(self, points, **more):
        places = np.clip((points - self.lower) / self.span, 0, 1) * STEPS
        return {"points": packed(np.rint(places), "<u2"), **more}

    def mesh(self, points, cells, normals=None):
        """normals: at the points; None: those of the triangles around."""
        wide = len(points) > STEPS
        more = {} if normals is None else {"normals": packed(np.rint(SIDES * normals), "i1")}
        return self.pack(points, cells=packed(cells, "<u4" if wide else "<u2"), wide=wide, **more)

    def discs(self, points, size):
        """size: diameters over the spacing."""
        most = max(size.max(initial=0), 1e-9)
        return self.pack(points, radii=packed(np.rint(size / most * SHADES), "u1"),
                         largest=0.5 * most * self.spacing)


def liquid(run, state, most, coarser):
    """Points, triangles (in two dimensions None), sizes, normals, and the values at the points: shares of the bodies,
    then run.colors. The normals are those of the volume fraction: few triangles have folds of their own."""
    bodies = len(run.bodies)
    table = np.hstack([views.value_table(state, color, bodies) for color in ("body", *run.colors)])
    if run.dim == 2:  # each so many-th particle, as large as those that it stands for
        every = -(-len(table) // most)
        return state.points[::every], None, np.sqrt(every) * state.size[::every], None, table[::every]
    fluid = views.Fluid(run, state.points, table, state.share, state.size, coarser)
    points, _, cells, lonely = fluid.mesh()
    balls = surface.strays(fluid.points[lonely], run.spacing, fluid.share[lonely], run.rings)
    cells = np.concatenate([cells, balls[2] + len(points)])
    points, cells = thin(np.concatenate([points, balls[0]]).astype(float), cells, most)
    flat = fluid.cut(points)
    normals = surface.faced(fluid.normals(points), points, flat)  # on a face the fraction has no slope
    return flat, cells, None, normals, fluid.values(flat)


def coarseness(run, state, most):
    """Size of the surface's cells over those of a picture, so that few triangles must be removed."""
    if run.dim == 2:
        return 1
    nothing, coarsest = np.zeros((len(state.points), 0)), COARSEST_RINGS if run.rings else COARSEST
    cells = views.Fluid(run, state.points, nothing, state.share, state.size, coarsest).mesh()[2]
    ratio = len(cells) * coarsest ** (1 if run.rings else 2) / most
    return min(max(ratio if run.rings else np.sqrt(ratio), 1), coarsest)


def fans(shapes):
    """Points and triangles of convex outlines [n][2] in the plane z = 0."""
    start = np.cumsum([0] + [len(shape) for shape in shapes])
    points = np.concatenate([np.zeros((0, 2)), *shapes])
    cells = [[(first, first + k, first + k + 1) for k in range(1, len(shape) - 1)]
             for first, shape in zip(start, shapes)]
    return np.column_stack([points, np.zeros(len(points))]), np.array(sum(cells, [])).reshape(-1, 3)


def solid(run, state, most):
    """Points and triangles of the solids; in two dimensions, unless all outlines are known, particles and None."""
    if run.dim == 2:
        shapes, exact = solids.outlines(run, state.path) if len(state.solid) else ([], [])
        return fans(shapes) if np.isin(state.solid_of, exact).all() else (state.solid, None)
    points, _, cells = views.solid_mesh(run, state)
    points, cells = np.asarray(points, float), np.asarray(cells)
    if len(cells) > most:  # flat faces share no corners
        points, at = np.unique(points, axis=0, return_inverse=True)
        cells = at.ravel()[cells]
        cells = cells[(cells != np.roll(cells, 1, axis=1)).all(axis=1)]  # not the empty ones, as at poles
    return thin(points, cells, most)


def colorings(run, seen, several):
    """The colours besides those of the bodies: name, title, ends of the scale and colours; seen: the values that the
    page shows, for each of run.colors those at all times; several: particles have several sizes."""
    found = []
    for name in run.colors:
        values = np.concatenate(seen[name])
        if not run.has(name) or np.ptp(values) == 0 or name == "size" and not several:
            continue
        low, high = views.limits([SimpleNamespace(**{name: values})], name)
        si = run.spacing if name == "size" else 1
        factor, unit = columns.prefixed(si * max(abs(low), abs(high)), run.unit(name))
        ticks = matplotlib.ticker.MaxNLocator(TICKS).tick_values(low * si * factor, high * si * factor)
        shades = views.colormap(name)(np.arange(SHADES + 1))[:, :3]
        found.append({"name": name, "title": "spacing" if name == "size" else name, "unit": unit,
                      "ends": (ticks[0] / si / factor, ticks[-1] / si / factor),
                      "ticks": [f"{tick:.6g}" for tick in ticks], "map": packed(SHADES * shades, "u1")})
    return found


def moment(run, most, coarser, path):
    """A state, points and triangles of its gas (None: the run has none), and its liquid()."""
    state = run.read(path)
    pockets = gas.Pockets(run, state).mesh() if gas.wanted(run) else None
    if pockets is not None and run.dim == 3:
        pockets = thin(*pockets, most // 2)
    return state, pockets, *liquid(run, state, most, coarser)


def scene(run, count, most):
    """All that viewer.js draws; None if there is no liquid."""
    shapes, parts, seen, rigid = Shapes(run), [], {name: [] for name in run.colors}, []
    bodies, last, several = len(run.bodies), None, False
    paths = [path for _, path in run.moments(count=count)]
    coarser = coarseness(run, run.read(paths[0]), most)
    states = together(functools.partial(moment, run, most, coarser), paths, "moments of the view")
    for state, pockets, points, cells, size, normals, table in states:
        several = several or state.size.max(initial=0) > SEVERAL * state.size.min(initial=np.inf)
        if not len(points):
            continue
        if last is None or not np.array_equal(last.solid, state.solid):
            last = SimpleNamespace(points=points, solid=state.solid)
            places, corners = solid(run, state, most // 2)
            rigid.append(shapes.discs(places, np.ones(len(places))) if corners is None else
                          shapes.mesh(places, corners))
        for k, name in enumerate(run.colors):
            seen[name].append(table[:, bodies + k])
        shape = shapes.discs(points, size) if cells is None else shapes.mesh(points, cells, normals)
        if pockets is not None and len(pockets[0]):
            shape["gas"] = shapes.mesh(*pockets)
        shape.update(time=state.time, text=data.duration(state.time), solid=len(rigid) - 1)
        if bodies > 1:
            shape["colors"] = packed(SHADES * views.base_colors(table[:, :bodies], "body", None, None), "u1")
        parts.append((shape, SimpleNamespace(points=points, solid=state.solid)))
    if not parts:
        return None
    colors = colorings(run, seen, several)
    for color in colors:
        low, high = color.pop("ends")
        for (shape, _), values in zip(parts, seen[color["name"]]):
            shade = np.clip((values - low) / (high - low), 0, 1) * SHADES
            shape.setdefault("values", {})[color["name"]] = packed(np.rint(shade), "u1")
    quads = walls(run)
    corners = np.arange(4 * len(quads)).reshape(-1, 4)
    return {"lower": list(shapes.lower), "step": list(shapes.span / STEPS), "flat": run.dim == 2,
            "box": None if run.rings else [list(run.lower), list(run.upper)], "angle": views.ANGLE,
            "solidColor": views.SOLID_COLOR, "gasColor": gas.COLOR,
            "bodies": [{"name": name, "color": views.BODY_COLORS[k % len(views.BODY_COLORS)]}
                       for k, name in enumerate(run.bodies)],
            "walls": shapes.mesh(quads.reshape(-1, 3), np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])),
            "solids": rigid, "colorings": colors, "states": [shape for shape, _ in parts],
            **camera(run, [points for _, points in parts])}


def camera(run, shown):
    """The first view: focus, eye, and height over width of the window."""
    ratio = views.PANEL[1] / views.PANEL[0]
    if run.dim == 3:
        view, half = views.camera(run, shown, AZIMUTH, ELEVATION)
        return {"focus": list(view["focus"]), "eye": list(view["position"]), "size": float(half), "ratio": 0.8 * ratio}
    points = np.concatenate([part for state in shown for part in (state.points, state.solid)])
    room = 2 * STRIP * (run.upper - run.lower)[:2].max()
    lower, upper = np.maximum(run.lower, points.min(axis=0)) - room, np.minimum(run.upper, points.max(axis=0)) + room
    focus, (wide, high, _) = 0.5 * (lower + upper), upper - lower
    ratio = min(max(high / wide, 0.25), ratio)
    distance = 0.5 * views.ROOM * max(high, wide * ratio) / np.tan(np.radians(views.ANGLE / 2))
    return {"focus": list(focus), "eye": list(focus + [0, 0, distance]), "size": float(0.5 * np.hypot(wide, high)),
            "ratio": ratio}
