#!/usr/bin/python3
"""Contact angle and width of a drop on a wall; of a film (edge.opts), the pull on its edge.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

MU, SIGMA = 0.1, 0.067  # Pa s, N/m
REACH = 1.5  # spacings: the width of the smoothing that draws the outline
LOW = 2  # spacings: the outline is fitted above this height


def phase(points, d, x, y):
    """The liquid's share around the points (x, y), from particles, d apart, and their mirror images in the wall."""
    both, d = np.vstack([points, points * (1, -1)]), np.concatenate([d, d])
    w = np.empty_like(x)
    for k in range(len(x)):
        r2 = ((both - (x[k], y[k]))**2).sum(axis=1) / (REACH * d)**2
        w[k] = np.exp(-r2).sum() / (np.pi * REACH**2)
    return w


def outline(points, d, rays=90):
    """Where the share passes a half on rays from the middle of the drop's foot."""
    d0 = d.min()
    middle = (points[:, 0] * d**2).sum() / (d**2).sum()
    angles = np.pi * (np.arange(rays) + 0.5) / rays
    c, s = np.cos(angles), np.sin(angles)
    low, high = np.full(rays, 2 * d0), np.full(rays, 2 * np.ptp(points[:, 0]))
    for _ in range(40):
        r = 0.5 * (low + high)
        inside = phase(points, d, middle + r * c, r * s) > 0.5
        low, high = np.where(inside, r, low), np.where(inside, high, r)
    return np.column_stack([middle + low * c, low * s])


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


def check(folder):
    states = list(physics.snapshots(folder))
    if "-film_tension" in physics.options(states[-1][1]):
        return pull(states, physics.options(states[-1][1]))
    start, end = (s[2]["position"][:, :2] for s in (states[0], states[-1]))
    head, f = states[-1][1:]
    wanted = float(physics.options(head).get("-wall_contact_angle", 90))
    d0 = float(np.ravel(head["spacing"])[0])
    area, t = physics.volumes(head, f).sum(), np.radians(wanted)
    edge = outline(end, d0 * physics.sizes(head, f))
    centre, radius = circle(edge[edge[:, 1] > LOW * d0])
    angle = np.arccos(np.clip(-centre[1] / radius, -1, 1))
    exact = np.sqrt(area / (t - np.sin(t) * np.cos(t)))
    before = np.linalg.norm(states[-2][2]["velocity"], axis=1).max()
    return [
        physics.absolute("contact angle", np.degrees(angle), wanted, 4, "degrees"),
        physics.shown("half the width of the foot", 1e3 * radius * np.sin(angle), 1e3 * exact * np.sin(t), "mm"),
        physics.shown("pressure", np.median(f["pressure"]), SIGMA / exact, "Pa"),
        physics.shown("capillary number of the flow that is left", before * MU / SIGMA),
        physics.at_most("particles lost", len(start) - len(end), 0)]


if __name__ == "__main__":
    physics.main(check)
