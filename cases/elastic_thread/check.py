#!/usr/bin/python3
"""A thread of Oldroyd-B liquid: a small wave beside the linear theory, the neck of a large one beside the equations of
a slender jet (slender.py). check.py RUN_FOLDER"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "..", "tests", "verify")]
import numpy as np  # noqa: E402
import physics  # noqa: E402
from slender import G, LAMBDA, LENGTH, MU, RADIUS, RHO, SIGMA  # noqa: E402

SMALL = 0.05  # of the radius: a wave that is linear
SLICE, FIRST, LAST = LENGTH / 48, 0.035, 0.0685  # m; s, while the neck is five spacings thick or more


def bessel(x):
    """I0 and I1 by their series."""
    m = np.arange(1, 40)
    terms = np.concatenate([[1.0], np.cumprod(0.25 * x * x / m**2)])
    return terms.sum(), 0.5 * x * (terms / np.arange(1, 41)).sum()


def growth(t):
    """Amplitude over that at the start, from rest: a'' = w2 a - C (mu a' + s), s' = G a' - s/lambda; w2 of Rayleigh, C
    so that slow growth is Rayleigh's, too (Chandrasekhar 1961, section 111)."""
    x = 2 * np.pi * RADIUS / LENGTH
    i0, i1 = bessel(x)
    w2 = SIGMA / (RHO * RADIUS**3) * x * i1 / i0 * (1 - x * x)
    C = w2 / (SIGMA / (2 * RADIUS) * (1 - x * x) / (x * x * (i0 / i1)**2 - 1 - x * x))
    w, P = np.linalg.eig(np.array([[0, 1, 0], [w2, -C * MU, -C], [0, G, -1 / LAMBDA]]))
    return (P @ (np.exp(w * t) * np.linalg.solve(P, [1, 0, 0])))[0].real


def wave(f, volume):
    return abs((volume * np.exp(2j * np.pi * f["position"][:, 1] / LENGTH)).sum())


def neck(f, volume):
    """Radius (m) of the thinnest slice of LENGTH/48, of slices every quarter of one."""
    z = f["position"][:, 1] % LENGTH
    return min(np.sqrt(volume[(z - at) % LENGTH < SLICE].sum() / (np.pi * SLICE))
               for at in np.arange(0, LENGTH, SLICE / 4))


def check(folder):
    states = [(t, f, physics.volumes(head, f), head) for t, head, f in physics.snapshots(folder)]
    start = wave(*states[0][1:3])
    if float(physics.options(states[0][3])["-thread_wave_amplitude"]) < SMALL * RADIUS:
        t, f, volume, _ = states[-1]
        return [physics.relative(f"amplitude of the wave after {1e3 * t:.3g} ms, over that at the start",
                                 wave(f, volume) / start, growth(t), 0.05)]
    reference = np.loadtxt(os.path.join(HERE, "reference.csv"), delimiter=",",
                           skiprows=1)
    errors = [neck(f, volume) / np.interp(t, *reference.T) - 1 for t, f, volume, _ in states if FIRST < t < LAST]
    rms = np.sqrt(np.square(errors).mean())
    return [physics.at_most("radius of the neck, rms relative error from 36 to 68 ms", rms, 0.05),
            physics.shown("radius of the neck, relative error at 68 ms", errors[-1])]


if __name__ == "__main__":
    physics.main(check)
