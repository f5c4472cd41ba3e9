#!/usr/bin/python3
"""Contact angle and width of a drop on a wall.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402


def circle(points):
    """Centre and radius of the circle nearest to the points (Kasa 1976)."""
    A = np.column_stack([points, np.ones(len(points))])
    a, b, c = np.linalg.lstsq(A, (points**2).sum(axis=1), rcond=None)[0]
    return np.array([a / 2, b / 2]), np.sqrt(c + (a * a + b * b) / 4)


def cap(angle, area):
    """Radius of the circle whose part above a chord, which it meets under the angle (rad), has the area."""
    return np.sqrt(area / (angle - np.sin(angle) * np.cos(angle)))


def angle_of(head, f):
    """Contact angle (rad): the height of the circle's centre over its radius is -cos; of the free surface's particles,
    half a spacing inside it."""
    d0 = float(np.ravel(head["spacing"])[0])
    x = f["position"][:, :2]
    surface = x[(f["surface"] == 1) & (x[:, 1] > 2 * d0)]
    centre, radius = circle(surface)
    radius += d0 / 2
    return np.arccos(np.clip(-centre[1] / radius, -1, 1)), np.sqrt(((np.hypot(*(surface - centre).T) - radius + d0 / 2)**2).mean())/d0


if __name__ == "__main__":
    for d in sys.argv[1:]:
        for t, head, f in physics.snapshots(d):
            a, e = angle_of(head, f)
            x = f["position"]; m = x[:, 1] < 0.2e-3; u=np.abs(f["velocity"]).max()
            print(d, f"{t*1e3:.0f} ms angle {np.degrees(a):.2f} rough {e:.3f} base {np.ptp(x[m,0])*1e3/2:.3f} umax {u:.2e} centre {x[:,:2].mean(0)} p {np.median(f['pressure']):.2f}")
