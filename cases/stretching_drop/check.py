#!/usr/bin/python3
"""Semi-axes and area of the drop that is stretched.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402


def moments(f):
    """Semi-axes, across and along the axis, of the spheroid with the second moments of the rings."""
    x = np.average(f["position"]**2, weights=f["volume"], axis=0)
    middle = np.average(f["position"][:, 1], weights=f["volume"])
    return np.sqrt([2.5 * x[0], 5 * (x[1] - middle**2)])


def deviation(f):
    """The velocities of rings less the strain (-r/2, z) that fits them best."""
    x, v = f["position"], f["velocity"]
    flow = np.stack([-0.5 * x[:, 0], x[:, 1]], axis=1)
    return np.linalg.norm(v[:, :2] - flow * (v[:, :2] * flow).sum() / (flow**2).sum(), axis=1)


def spheroid(strain, times):
    """Semi-axes a (across), b (along) at the times, of a sphere of radius 1 with v = strain (-r/2, z): the pressure is
    p0 (1 - r^2/a^2 - z^2/b^2), so that a' = -s a/2, b' = s b, s' = s^2 (3/4/(b^2/a^2 + 1/2) - 1)."""
    def slope(y):
        s, a, b = y
        return np.array([s * s * (0.75 / ((b / a)**2 + 0.5) - 1), -0.5 * s * a, s * b])

    return physics.integrate(slope, [strain, 1.0, 1.0], 0.0, times, 4000)[:, 1:]


def check(folder):
    states = list(physics.snapshots(folder))
    times, head = [t for t, _, _ in states], states[0][1]
    rings = physics.rings(head)
    exact = spheroid(100.0, times) if rings else physics.ellipse(-100.0, 0.0, times)
    axes = np.array([moments(f) if rings else physics.semi_axes(f["position"]) for _, _, f in states])
    axes /= axes[0]  # at the start a lattice cut to a circle of radius 1
    energy = [(physics.volumes(head, f) * (f["velocity"]**2).sum(axis=1)).sum() for _, _, f in states]
    if rings:
        size = physics.relative("volume of the spheroid", 4 / 3 * np.pi * axes[-1, 0]**2 * axes[-1, 1], 4 / 3 * np.pi,
                                0.005, "m3")
    else:
        size = physics.relative("area of the ellipse", np.pi * axes[-1].prod(), np.pi, 0.005, "m2")
    end = f"at {times[-1] * 1e3:g} ms"
    return [
        physics.relative(f"semi-axis a {end}", axes[-1, 0], exact[-1, 0], 0.01, "m"),
        physics.relative(f"semi-axis b {end}", axes[-1, 1], exact[-1, 1], 0.01, "m"),
        physics.at_most("largest relative error of a and b at all times", np.abs(axes / exact - 1).max(), 0.01),
        size,
        physics.relative("kinetic energy over that at the start", energy[-1] / energy[0], 1, 0.02),
        physics.lost(head, states[0][2], states[-1][2])] + (
            [physics.at_most("deviation from the strain, in the first two rings over that elsewhere",
                             physics.at_axis(head, [(f, deviation(f)) for _, _, f in states[1:]]), 2)] if rings else [])


if __name__ == "__main__":
    physics.main(check)
