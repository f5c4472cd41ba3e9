#!/usr/bin/python3
"""The neck of a thread of Oldroyd-B liquid by the equations of a slender jet: axial velocity and section of each slice,
the full curvature, the inertia of the radial motion (Garcia and Castellanos 1994). slender.py > reference.csv"""
import numpy as np

RHO, MU, SIGMA, RADIUS, LENGTH = 1100.0, 3.5e-3, 0.067, 1e-3, 18e-3  # kg/m3, Pa s, N/m, m, m
G, LAMBDA, AMPLITUDE = 20.0, 0.02, 0.1e-3  # Pa, s, m
SLICES, END, EVERY = 100, 0.0905, 2e-3


def tridiagonal(low, middle, up, right):
    """The solution of low x[i-1] + middle x[i] + up x[i+1] = right."""
    n = len(middle)
    c, d = np.empty(n), np.empty(n)
    c[0], d[0] = up[0] / middle[0], right[0] / middle[0]
    for i in range(1, n):
        pivot = middle[i] - low[i] * c[i - 1]
        c[i], d[i] = up[i] / pivot, (right[i] - low[i] * d[i - 1]) / pivot
    for i in range(n - 2, -1, -1):
        d[i] -= c[i] * d[i + 1]
    return d


def main():
    half = 0.5 * LENGTH
    fine = np.linspace(0, half, 20001)
    section = (RADIUS**2 - 0.5 * AMPLITUDE**2) ** 0.5 + AMPLITUDE * np.cos(2 * np.pi * fine / LENGTH)
    filled = np.concatenate([[0], np.cumsum(0.5 * np.pi * (section[1:]**2 + section[:-1]**2) * np.diff(fine))])
    s = np.linspace(0, 1, SLICES + 1)
    s = s + 0.2 * np.sin(np.pi * s)  # more of them in the neck
    s /= s[-1]
    z, volume = np.interp(s * filled[-1], filled, fine), np.diff(s * filled[-1])
    mass = np.zeros(SLICES + 1)
    mass[1:] += 0.5 * RHO * volume
    mass[:-1] += 0.5 * RHO * volume
    v, along, across, t, tell = np.zeros(SLICES + 1), np.ones(SLICES), np.ones(SLICES), 0.0, 0.0
    print("time_s,neck_m")
    while t < END:
        length = np.diff(z)
        h = np.sqrt(volume / length / np.pi)
        if t >= tell:
            print(f"{t:.5g},{h[-1]:.6g}")
            tell += EVERY
        middle = 0.5 * (z[1:] + z[:-1])
        slope = np.diff(np.concatenate([[h[0]], h, [h[-1]]])) / np.diff(
            np.concatenate([[-middle[0]], middle, [2 * half - middle[-1]]]))
        root = np.sqrt(1 + (0.5 * (slope[1:] + slope[:-1]))**2)
        rate = np.diff(v)
        pull = np.pi * h * h * (3 * MU * rate / length + G * (along - across) + SIGMA *
                                (1 / (h * root) + np.diff(slope) / length / root**3))
        swell = RHO * volume**2 / (8 * np.pi) / length**3  # of the radial inertia
        pull += 1.5 * swell * rate**2 / length
        push = np.diff(np.concatenate([[0], pull, [0]]))
        inner = mass[1:-1] + swell[1:] + swell[:-1]
        a = np.zeros(SLICES + 1)
        a[1:-1] = tridiagonal(-swell[:-1], inner, -swell[1:], push[1:-1])
        dt = min(0.25 * (length**2 * np.sqrt(RHO / (SIGMA * h))).min(), 0.2 * RHO * length.min()**2 / (3 * MU),
                 0.2 * length.min() * np.sqrt(RHO / (G * along.max() + SIGMA / h.min())), 2e-5)
        v = v + dt * a
        z = z + dt * v
        strain, left = dt * np.diff(v) / np.diff(z), np.exp(-dt / LAMBDA)
        along = 1 + (along * np.exp(2 * strain) - 1) * left
        across = 1 + (across * np.exp(-strain) - 1) * left
        t += dt


if __name__ == "__main__":
    main()
