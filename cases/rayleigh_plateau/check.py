#!/usr/bin/python3
"""Growth rate of the waves on a thread, and the drops it breaks into.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

RHO, MU, SIGMA, RADIUS, LENGTH = 1100.0, 3.5e-3, 0.067, 1e-3, 9.0146e-3  # kg/m3, Pa s, N/m, m, m
FIRST, LAST = 1.5, 5.0  # times the amplitude at the start: where the growth is measured
SECTION = 6  # spacings
# radius of the neck over that of the thread, and when it is so thin, in sqrt(rho R^3/sigma): an axisymmetric boundary
# element computation of the potential flow of this thread, whose figures agree to 1e-4 with half the nodes
NECK = ((0.3, 11.0522), (0.1, 11.4646))
SMALL = 8  # particles of a quarter: a satellite has as many or more, spray less


def bessel(x):
    """I0, I1 and the derivative of I1 by their series."""
    m = np.arange(1, 120)
    terms = np.concatenate([[1.0], np.cumprod(0.25 * x * x / m**2)])
    i0, i1 = terms.sum(), 0.5 * x * (terms / np.arange(1, 121)).sum()
    return i0, i1, i0 - i1 / x


def growth(x):
    """Growth rate (1/s) of the wave number x/R: the root of Chandrasekhar's (1961, ch. XII) relation for a viscous
    thread."""
    def relation(s):
        y = np.sqrt(x * x + s * RHO * RADIUS**2 / MU)
        i0, i1, d1 = bessel(x)
        _, j1, e1 = bessel(y)
        return (2 * x * x * (x * x + y * y) * d1 / i0 * (1 - 2 * x * y / (x * x + y * y) * i1 / j1 * e1 / d1)
                - (x**4 - y**4) - SIGMA * RHO * RADIUS / MU**2 * x * i1 / i0 * (1 - x * x))

    low, high = 1e-6, np.sqrt(SIGMA / (RHO * RADIUS**3))
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if relation(middle) < 0 else (low, middle)
    return low


def pieces(x, share, reach, up):
    """(share of the volume, number) of the sets of particles that are connected by steps below reach (m), periodic in
    the direction up, the largest first."""
    free, sizes = np.ones(len(x), dtype=bool), []
    while free.any():
        front = [int(np.argmax(free))]
        free[front] = False
        piece = []
        while front:
            piece += front
            near = np.zeros(len(x), dtype=bool)
            for a in front:
                r = x - x[a]
                r[:, up] -= LENGTH * np.round(r[:, up] / LENGTH)
                near |= (r**2).sum(axis=1) < reach**2
            front = list(np.flatnonzero(near & free))
            free[front] = False
        sizes.append((share[piece].sum(), len(piece)))
    return sorted(sizes, reverse=True)


def pinching(states):
    """How fast the neck of a thread without viscosity becomes thin: the factor A in r = A (sigma/rho)^(1/3) (T -
    t)^(2/3) from the time between two radii, beside potential flow, and the time of the second. The radius is that of
    sections SECTION long, whose volume is smooth."""
    times, least = [], []
    for t, head, f in states:
        d0 = float(np.ravel(head["spacing"])[0])
        bins = int(2 * LENGTH / d0)
        volume = np.histogram(f["position"][:, 1] % LENGTH, bins, (0, LENGTH), weights=physics.volumes(head, f))[0]
        around = np.concatenate([volume, volume[:2 * SECTION]])
        least.append(np.convolve(around, np.ones(2 * SECTION), "valid").min())
        times.append(t)
    radius = np.sqrt(np.array(least) / (np.pi * SECTION * d0)) / RADIUS
    late = np.argmin(radius > NECK[1][0]) + 1
    one, other = (np.interp(-r, -radius[:late], times[:late]) for r, _ in NECK)
    unit = np.sqrt(RHO * RADIUS**3 / SIGMA)
    (_, first), (_, second) = NECK
    return [physics.relative("prefactor of the pinching neck over that of potential flow",
                             ((second - first) * unit / (other - one))**(2 / 3), 1, 0.08),
            physics.relative("time of a neck of a tenth of the radius", 1e3 * other, 1e3 * second * unit, 0.015, "ms"),
            physics.shown("radius of that neck over the spacing", NECK[1][0] * RADIUS / d0)]


def check(folder):
    if physics.options(next(physics.snapshots(folder))[1])["-thread_viscosity"] == "0":
        return pinching(list(physics.snapshots(folder)))
    times, height, broken, first, last = [], [], np.nan, None, []
    k = 2 * np.pi / LENGTH
    for t, head, f in physics.snapshots(folder):
        d0 = float(np.ravel(head["spacing"])[0])
        x = f["position"]
        first = first or f
        times.append(t)
        volume = physics.volumes(head, f)
        up, whole = (1, 1) if physics.rings(head) else (2, 4)  # a quarter of the thread
        height.append(whole * (volume * np.cos(k * x[:, up])).sum() / (np.pi * RADIUS**2 * LENGTH))  # of R, over it
        last = pieces(x, volume / volume.sum(), 1.25 * d0, up)
        around = np.histogram(x[:, up], bins=np.arange(0, LENGTH + 1e-9, LENGTH / np.floor(LENGTH / (1.5 * d0))))[0]
        if np.isnan(broken) and (around == 0).any():
            broken = t
    times, ratio = np.array(times), np.array(height) / height[0]
    part = (ratio > FIRST) & (times < times[np.argmax(ratio > LAST)])
    rate = np.polyfit(times[part], np.arccosh(ratio[part]), 1)[0]
    exact, unit = growth(k * RADIUS), np.sqrt(SIGMA / (RHO * RADIUS**3))
    drops = [share for share, n in last if n >= SMALL]
    return [
        physics.relative("growth rate, over sqrt(sigma/rho R^3)", rate / unit, exact / unit,
                         0.05 if physics.rings(head) else 0.07),
        physics.at_least("volume of the main drop over that of a wave length", drops[0], 0.9),
        physics.shown("drops a wave length at the end", len(drops), 2),
        physics.shown("volume of the satellite over that of a wave length", drops[1] if drops[1:] else 0),
        physics.shown("particles in smaller pieces, of all", 1 - sum(drops)),
        physics.shown("break-up", broken * 1e3, np.log(2 / height[0]) / exact * 1e3, "ms"),
        physics.shown("height at the start over the radius", height[0], 0.03),
        physics.lost(head, first, f)]


if __name__ == "__main__":
    physics.main(check)
