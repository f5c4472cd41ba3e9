#!/usr/bin/python3
"""Two liquids that do not mix: the angles where both meet gas, the pressure of a drop of one in the other, its period.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

REACH = 1.5  # spacings: the width of the smoothing that draws the outlines
NEAR, FAR = 4, 16  # spacings from a point where three meet: where circles are fitted to the outlines
START = 30e-3  # s: what the packing's disorder sets off in a drop has largely gone


def number(options, name):
    return float(options.get(name, 0))


def names(options):
    return options["-bodies"].split(",")


def shares(points, area, body, d):
    """The shares of both liquids, smoothed, on a grid: its coordinates and both shares."""
    s = REACH * d
    grid = [np.arange(points[:, k].min() - 4 * d, points[:, k].max() + 4 * d, d / 2) for k in (0, 1)]
    share = np.zeros((2, len(grid[1]), len(grid[0])))
    for x, a, b in zip(points, area, body):
        (i, k), (j, m) = (np.searchsorted(g, (c - 4 * s, c + 4 * s)) for g, c in zip(grid, x))
        share[b, j:m, i:k] += a / (np.pi * s * s) * np.outer(np.exp(-((grid[1][j:m] - x[1]) / s)**2),
                                                             np.exp(-((grid[0][i:k] - x[0]) / s)**2))
    return grid, share


def outline(grid, level, other):
    """Points where 'level' passes zero along the lines of the grid, and the values of 'other' there."""
    x, y = np.meshgrid(*grid)
    found = []
    for low, high in (((slice(None), slice(None, -1)), (slice(None), slice(1, None))),
                      ((slice(None, -1), slice(None)), (slice(1, None), slice(None)))):
        hit = level[low] * level[high] < 0
        t = level[low][hit] / (level[low][hit] - level[high][hit])
        found.append(np.column_stack([f[low][hit] + t * (f[high][hit] - f[low][hit]) for f in (x, y, other)]))
    found = np.vstack(found)
    return found[:, :2], found[:, 2]


def circle(points):
    """The circle or line nearest to the points (Pratt 1987): a function of x that is zero on it, and its gradient."""
    middle = points.mean(axis=0)
    size = np.sqrt(((points - middle)**2).sum(axis=1).mean())
    q = (points - middle) / size
    z = np.column_stack([(q**2).sum(axis=1), q, np.ones(len(q))])
    constraint = np.array([[0, 0, 0, -2], [0, 1, 0, 0], [0, 0, 1, 0], [-2, 0, 0, 0]], dtype=float)
    values, vectors = np.linalg.eig(np.linalg.solve(constraint, z.T @ z / len(q)))
    a, b, c, e = vectors.real[:, np.argmin(np.where(values.real > -1e-12, values.real, np.inf))]

    def at(x):
        u = (x - middle) / size
        slope = np.array([2 * a * u[0] + b, 2 * a * u[1] + c]) / size
        length = np.linalg.norm(slope)
        return (a * (u @ u) + b * u[0] + c * u[1] + e) / length, slope / length
    return at


def section(head, f):
    """Positions, areas and bodies of the liquid's particles in a plane, of bodies of revolution on both sides of the
    axis: rings, or in three dimensions a quarter of all around the x axis."""
    liquid = f["body"] >= 0
    x, area, body = f["position"][liquid], physics.volumes(head, f)[liquid], f["body"][liquid]
    if int(head["dimension"]) == 2 and not physics.rings(head):
        return x[:, :2], area, body
    other = (-1, 1) if physics.rings(head) else (1, -1)
    r = x[:, 0] if physics.rings(head) else np.linalg.norm(x[:, 1:], axis=1)
    x = x[:, :2] if physics.rings(head) else np.column_stack([x[:, 0], r])
    area = area * (1 if physics.rings(head) else 4) / (2 * np.pi * np.maximum(r, 0.25 * float(head["spacing"])))
    return np.vstack([x, x * other]), np.tile(area, 2), np.tile(body, 2)


def angles(head, f):
    """The angles (degrees) in the first liquid, the second one and gas at each point where the three meet."""
    d = float(np.ravel(head["spacing"])[0])
    grid, (first, second) = shares(*section(head, f), d)
    surface, which = outline(grid, first + second - 0.5, first - second)
    between, filled = outline(grid, first - second, first + second)
    curves = surface[which > 0], surface[which < 0], between[filled > 0.5]
    meetings = []
    for p in surface[np.abs(which) < 0.25]:
        near = [m for m in meetings if min(np.linalg.norm(q - p) for q in m) < 2 * NEAR * d]
        near[0].append(p) if near else meetings.append([p])
    meetings = [np.mean(m, axis=0) for m in meetings]
    found = []
    for place in meetings:
        point, others = place, [m for m in meetings if m is not place]
        for _ in range(4):
            fits, ways = [], []
            for curve in curves:
                r = np.linalg.norm(curve - point, axis=1)
                other = np.min([np.linalg.norm(curve - m, axis=1) for m in others], axis=0) if others else np.inf
                taken = (r > NEAR * d) & (r < FAR * d) & (other > NEAR * d) & (r < other + 2 * d)
                fits.append(circle(curve[taken]))
                normal = fits[-1](point)[1]
                way = np.array([-normal[1], normal[0]])
                ways.append(way * np.sign(way @ (curve[taken][np.argsort(r[taken])[:5]].mean(axis=0) - point)))
            misses, normals = zip(*(one(point) for one in fits))
            point = point - np.clip(np.linalg.lstsq(np.array(normals), np.array(misses), rcond=0.2)[0], -d, d)
        inside = [np.degrees(np.arccos(np.clip(way @ ways[2], -1, 1))) for way in ways[:2]]
        found.append(inside + [360 - sum(inside)])
    return np.array(found)


def balanced(first, second, between):
    """The angles (degrees) at which three tensions balance (Neumann)."""
    def angle(opposite, a, b):
        return 180 - np.degrees(np.arccos((a * a + b * b - opposite * opposite) / (2 * a * b)))
    return angle(second, first, between), angle(first, second, between), angle(between, first, second)


def lens(states, options):
    one, other = names(options)
    tensions = [number(options, f"-{one}_tension"), number(options, f"-{other}_tension"),
                number(options, "-interface_tension")]
    last = [angles(head, f).mean(axis=0) for _, head, f in states[-3:]]
    measured, wanted = np.mean(last, axis=0), balanced(*tensions)
    flow = []
    for _, head, f in states[-3:]:
        liquid = f["body"] >= 0
        v, volume = f["velocity"][liquid], physics.volumes(head, f)[liquid]
        flow.append((np.average(v, weights=volume, axis=0), np.linalg.norm(v, axis=1).max()))
    mu = number(options, f"-{one}_viscosity")
    return [physics.absolute(f"angle in {name}", a, b, 5, "degrees")
            for name, a, b in zip((one, other, "gas"), measured, wanted)] + [
                physics.shown("capillary number of the flow that is left", flow[-1][1] * mu / max(tensions)),
                physics.shown("capillary number of the mean of its velocity",
                              np.linalg.norm(flow[-1][0]) * mu / max(tensions)),
                physics.lost(states[-1][1], states[0][2], states[-1][2])]


def drop(states, options):
    """Of a circle or sphere: its pressure over that outside, and the flow that is left."""
    sigma, mu = number(options, "-interface_tension"), number(options, "-drop_viscosity")
    jumps, largest, mean = [], [], []
    for t, head, f in states:
        if t < START:
            continue
        volume, d, inside = physics.volumes(head, f), float(np.ravel(head["spacing"])[0]), f["body"] == 0
        flat = int(head["dimension"]) == 2 and not physics.rings(head)
        radius = np.sqrt(volume[inside].sum() / np.pi) if flat else np.cbrt(0.75 * volume[inside].sum() / np.pi)
        middle = np.average(f["position"][inside], weights=volume[inside], axis=0)
        middle[0] *= not physics.rings(head)
        r = np.linalg.norm(f["position"] - middle, axis=1)
        p, outside = f["pressure"], (f["body"] == 1) & (r > radius + 3 * d)
        jumps.append(p[inside & (r < radius - 3 * d)].mean() - p[outside].mean())
        largest.append(np.linalg.norm(f["velocity"][f["body"] >= 0], axis=1).max())
        mean.append(np.linalg.norm(np.average(f["velocity"], weights=volume, axis=0)))
    since = f"from {START * 1e3:g} ms on"
    return [
        physics.relative(f"jump of the pressure, mean {since}", np.mean(jumps), (1 if flat else 2) * sigma / radius,
                         0.03, "Pa"),
        physics.at_most(f"capillary number, largest of all particles and times {since}", max(largest) * mu / sigma,
                        1e-3),
        physics.shown("capillary number of the mean velocity at the end", mean[-1] * mu / sigma)]


def swing(states, options):
    """Period of the second mode of a drop in another liquid of the same density and viscosity: Lamb, art. 275, slowed
    by the layers on both sides of the interface as much as they damp it (Miller and Scriven 1968)."""
    sigma, rho, mu = (number(options, name) for name in ("-interface_tension", "-drop_density", "-drop_viscosity"))
    times, q = [], []
    for t, head, f in states:
        inside = f["body"] == 0
        x, volume = f["position"][inside], physics.volumes(head, f)[inside]
        rings = physics.rings(head)
        radius = np.cbrt(0.75 * volume.sum() / np.pi) if rings else np.sqrt(volume.sum() / np.pi)
        x = x - np.average(x, weights=volume, axis=0) * ([0, 1, 0] if rings else 1)
        times.append(t)
        q.append(np.average(x[:, 1]**2 - (0.5 if rings else 1) * x[:, 0]**2, weights=volume) / radius**2)
    frequency = np.sqrt((4.8 if rings else 3) * sigma / (rho * radius**3))
    layers = (1.25 if rings else 1) / radius * np.sqrt(frequency * mu / (2 * rho))
    w, b, error = physics.damped_cosine(np.array(times), np.array(q), frequency, layers)
    return [physics.relative("period", 2e3 * np.pi / w, 2e3 * np.pi / (frequency - layers), 0.03, "ms"),
            physics.shown("damping rate, that of the layers alone expected", b, layers, "1/s"),
            physics.at_most("deviation from a damped cosine, rms over the amplitude", error, 0.05)]


def check(folder):
    states = list(physics.snapshots(folder))
    options = physics.options(states[0][1])
    if names(options)[0] != "drop":
        return lens(states, options)
    return (swing if options["-drop_shape"] == "ellipsoid" else drop)(states, options)


if __name__ == "__main__":
    physics.main(check)
