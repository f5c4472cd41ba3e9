#!/usr/bin/python3
"""Contact angle and width of a drop on a wall; of a film (edge.opts), the pull on its edge; of a drop on an incline
(incline.opts), whether it sticks or slides; of a plug between two walls (plug.opts), the pull of its menisci, or their
angles while it moves.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

MU, SIGMA = 0.1, 0.067  # Pa s, N/m
REACH = 1.5  # spacings: the width of the smoothing that draws the outline
LOW = 2  # spacings: the outline is fitted above this height; ...
HIGH = 3  # ... with a sphere, which has no images, above this


def phase(points, area, d, x, y):
    """The liquid's share around the points (x, y), from particles of these areas, d apart."""
    w = np.empty_like(x)
    for k in range(len(x)):
        r2 = ((points - (x[k], y[k]))**2).sum(axis=1) / (REACH * d)**2
        w[k] = (area * np.exp(-r2) / (np.pi * REACH**2 * d**2)).sum()
    return w


def outline(points, area, d, whole, rays=90):
    """Where the share passes a half on rays from the middle of the drop's foot, whose images in the wall are added; of
    a drop on a sphere on rays all around from the middle of the drop."""
    d0 = d.min()
    middle = np.array([(points[:, 0] * area).sum(), (points[:, 1] * area).sum() if whole else 0]) / area.sum()
    if not whole:
        points, area, d = np.vstack([points, points * (1, -1)]), np.concatenate([area, area]), np.concatenate([d, d])
    angles = (2 if whole else 1) * np.pi * (np.arange(rays) + 0.5) / rays
    c, s = np.cos(angles), np.sin(angles)
    low, high = np.full(rays, 0.0 if whole else 2 * d0), np.full(rays, 2 * np.ptp(points[:, 0]))
    for _ in range(40):
        r = 0.5 * (low + high)
        inside = phase(points, area, d, middle[0] + r * c, middle[1] + r * s) > 0.5
        low, high = np.where(inside, r, low), np.where(inside, high, r)
    return middle + np.column_stack([low * c, low * s])


def section(head, f):
    """Positions, areas and spacings of the particles in a plane, y the height above the wall or, with a sphere, above
    its centre; of a drop of revolution in one through its axis."""
    options, volume = physics.options(head), physics.volumes(head, f)
    d = physics.sizes(head, f) * float(head["spacing"])
    x = f["position"][:, :2]
    if "-slope_normal" in options:
        n = np.array([float(c) for c in options["-slope_normal"].split(",")])
        n /= np.linalg.norm(n)
        x = f["position"][:, :len(n)] - [float(c) for c in options["-slope_point"].split(",")]
        x = np.column_stack([x @ (n[1], -n[0]), x @ n]) if len(n) == 2 else round_about(x, n)
    elif int(head["dimension"]) == 3:
        x = round_about(f["position"], np.array([0, 0, 1]))
    if int(head["dimension"]) == 2 and not physics.rings(head):
        return x, volume, d
    area = volume / (2 * np.pi * np.maximum(x[:, 0], 0.25 * d))
    return np.vstack([x, x * (-1, 1)]), np.concatenate([area, area]), np.concatenate([d, d])


def round_about(x, n):
    """Distance from the axis n through the origin, and place along it."""
    return np.column_stack([np.linalg.norm(np.cross(x, n), axis=1), x @ n])


def circle(points):
    """Centre and radius of the circle nearest to the points, by linear least squares (Kasa 1976)."""
    a, b, c = np.linalg.lstsq(np.column_stack([points, np.ones(len(points))]), (points**2).sum(axis=1), rcond=None)[0]
    return np.array([a / 2, b / 2]), np.sqrt(c + (a * a + b * b) / 4)


def pull(states, options):
    """Gain of momentum of a film with one edge, per time, over sigma: 1 - cos of the contact angle."""
    scale = float(options["-film_density"]) / float(options["-film_tension"])
    momentum = [scale * float(np.ravel(head["spacing"])[0])**2 * f["velocity"][:, 0].sum() for _, head, f in states]
    rate = np.polyfit([t for t, _, _ in states][2:], momentum[2:], 1)[0]
    return [physics.relative("pull on the edge over sigma", -rate,
                             1 - np.cos(np.radians(float(options["-wall_contact_angle"]))), 0.1)]


def pull_of_plug(states, options):
    """The pressure between the menisci of a plug over -2 sigma cos(contact angle)/gap, in a tube, of rings, over its
    radius: mean of the particles within a third of that from its middle, in the second half of the run."""
    gap = float(options["-plug_upper"].split(",")[0]) - float(options["-plug_lower"].split(",")[0])
    exact = -2 * SIGMA * np.cos(np.radians(float(options["-wall_contact_angle"]))) / gap
    late = [f["pressure"][np.abs(f["position"][:, 1]) < gap / 3].mean() for _, _, f in states[len(states) // 2:]]
    return [physics.relative("pull of the menisci over its exact value", np.mean(late) / exact, 1, 0.04)]


def cox(rest, number):
    """The angle (degrees) of a line of the capillary number 'number' times the logarithm of both lengths, after Cox
    (1986); rest: at rest, degrees."""
    x = np.linspace(1e-6, np.radians(165), 20001)
    slope = (x - np.sin(x) * np.cos(x)) / (2 * np.sin(x))
    total = np.concatenate([[0], np.cumsum(np.diff(x) * (slope[1:] + slope[:-1]) / 2)])
    return np.degrees(np.interp(np.interp(np.radians(rest), x, total) + number, total, x))


def moving_plug(states, options):
    """The angles of both menisci of a plug that gravity moves along y, from the pressure, which is linear between them:
    at its middle line it is -2 sigma cos(angle)/gap behind each; beside those of its speed."""
    gap = float(options["-plug_upper"].split(",")[0]) - float(options["-plug_lower"].split(",")[0])
    d = float(options["-spacing"])
    late = states[len(states) // 2:]
    height = [f["position"][f["body"] >= 0][:, 1].mean() for _, _, f in late]
    number = -MU / SIGMA * np.polyfit([t for t, _, _ in late], height, 1)[0]
    ends = []
    for k in range(len(late)):
        f = late[k][2]
        y = f["position"][f["body"] >= 0]
        inside, middle = np.abs(y[:, 1] - height[k]) < gap / 2, np.abs(y[:, 0]) < d
        line = np.polyfit(y[inside, 1], f["pressure"][f["body"] >= 0][inside], 1)
        ends.append([np.polyval(line, y[middle, 1].min() - d / 2), np.polyval(line, y[middle, 1].max() + d / 2)])
    front, back = np.degrees(np.arccos(np.clip(np.mean(ends, axis=0) * gap / (-2 * SIGMA), -1, 1)))
    rest = float(options["-wall_contact_angle"])
    slip = number * np.log(d / float(options.get("-wall_contact_slip", 1e-9)))
    return [physics.at_least("capillary number of the plug", number, 1e-3),
            physics.absolute("advancing angle beside that of Cox and Voinov", front, cox(rest, slip), 3, "degrees"),
            physics.absolute("receding angle beside that of Cox and Voinov", back, cox(rest, -slip), 3, "degrees")]


def incline(states, options):
    """Speed along the wall in the second half of the run as a capillary number, from the mean position: a drop with
    hysteresis stays where it is below rho g A sin(slope) = sigma (cos r - cos a), and slides above."""
    wall = next(name for name in options if name.endswith("_contact_hysteresis"))
    angle, half = (np.radians(float(options[name])) for name in (wall.replace("hysteresis", "angle"), wall))
    normal = np.array([float(c) for c in options.get("-slope_normal", "0,1").split(",")])
    along = np.array([normal[1], -normal[0]]) / np.linalg.norm(normal)
    force = float(options["-drop_density"]) * physics.volumes(*states[0][1:]).sum() * (
        np.array([float(c) for c in options["-gravity"].split(",")]) @ along)
    over = force / (2 * SIGMA * np.sin(angle) * np.sin(half / 2))
    late = states[len(states) // 2:]
    places = [f["position"][f["body"] >= 0][:, :2].mean(axis=0) @ along for _, _, f in late]
    number = np.polyfit([t for t, _, _ in late], places, 1)[0] * float(options["-drop_viscosity"]) / SIGMA
    name = f"capillary number of its speed at {over:.2f} of the force that moves it"
    return [physics.at_most(name, number, 1e-3) if over < 1 else physics.at_least(name, number, 2e-3),
            physics.lost(states[0][1], states[0][2], states[-1][2])]


def met(head, f):
    """The angle (rad) at which the circle nearest to the outline meets wall or sphere, and its radius (m)."""
    options = physics.options(head)
    ball = float(options.get("-ball_radius", 0))
    points, area, d = section(head, f)
    edge = outline(points, area, d, ball > 0)
    high = np.linalg.norm(edge, axis=1) - ball if ball else edge[:, 1]
    centre, radius = circle(edge[high > (HIGH if ball else LOW) * d.min()])
    place = np.linalg.norm(centre)
    cosine = (ball**2 - place**2 + radius**2) / (2 * ball * radius) if ball else -centre[1] / radius
    return np.arccos(np.clip(cosine, -1, 1)), radius


def check(folder):
    states = list(physics.snapshots(folder))
    head, f = states[-1][1:]
    options = physics.options(head)
    if any(name.endswith("_contact_hysteresis") for name in options):
        return incline(states, options)
    if "-film_tension" in options:
        return pull(states, options)
    if "-plug_tension" in options:
        return moving_plug(states, options) if "-gravity" in options else pull_of_plug(states, options)
    wanted = float(next((v for name, v in options.items() if name.endswith("_contact_angle")), 90))
    angle, radius = met(head, f)
    before = np.linalg.norm(states[-2][2]["velocity"], axis=1).max()
    tolerance = 5 if "-solids" in options else 4
    results = [physics.absolute("contact angle", np.degrees(angle), wanted, tolerance, "degrees")]
    if int(head["dimension"]) == 2 and "-ball_radius" not in options:
        t = np.radians(wanted)
        exact = np.sqrt(physics.volumes(head, f).sum() / (t - np.sin(t) * np.cos(t)))
        results += [physics.shown("half the width of the foot", 1e3 * radius * np.sin(angle), 1e3 * exact * np.sin(t),
                                  "mm"),
                    physics.shown("pressure", np.median(f["pressure"]), SIGMA / exact, "Pa")]
    return results + [physics.shown("capillary number of the flow that is left", before * MU / SIGMA),
                      physics.lost(head, states[0][2], f)]


if __name__ == "__main__":
    physics.main(check)
