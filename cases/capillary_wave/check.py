#!/usr/bin/python3
"""Height of a capillary wave against Prosperetti's solution.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

LENGTH = 1.0  # m


def erfcx(z):
    """exp(z^2) erfc(z), complex, by the rational series of Weideman (1994); 1e-12 of its size."""
    n = 48
    m = 2 * n
    scale = np.sqrt(n / np.sqrt(2))
    t = scale * np.tan(np.arange(-m + 1, m) * np.pi / (2 * m))
    f = np.concatenate([[0], np.exp(-t**2) * (scale**2 + t**2)])
    a = np.real(np.fft.fft(np.fft.fftshift(f)))[1:n + 1][::-1] / (2 * m)
    z = np.asarray(z, dtype=complex)
    right = np.where(z.real < 0, -z, z)
    down = scale + right
    value = 2 * np.polyval(a, (scale - right) / down) / down**2 + 1 / (np.sqrt(np.pi) * down)
    return np.where(z.real < 0, 2 * np.exp(z**2) - value, value)


def prosperetti(t, rate, damping):
    """a/a0 of a wave that starts at rest on deep liquid beside nothing (Prosperetti 1981, Eq. (22) with density ratio
    zero): rate w0 of the inviscid wave, damping nu k^2 (1/s). With damping/rate = 0.05 at w0 t = 1, 3, 6, 12: 0.5661,
    -0.7712, 0.5516, 0.2511."""
    t = np.asarray(t, dtype=float)
    z = np.roots([1, 0, 2 * damping, 4 * damping**1.5, damping**2 + rate**2])
    a = 4 * damping**2 / (8 * damping**2 + rate**2) * np.exp(-damping * t) * erfcx(np.sqrt(damping * t))
    for i, root in enumerate(z):
        others = np.prod([other - root for j, other in enumerate(z) if j != i])
        a = a + root / others * rate**2 / (root**2 - damping) * np.exp(-damping * t) * erfcx(root * np.sqrt(t))
    return a.real


def check(folder):
    k = 2 * np.pi / LENGTH
    times, height = [], []
    for t, head, f in physics.snapshots(folder):
        given = physics.options(head)
        mode = (physics.volumes(head, f) * np.cos(k * f["position"][:, 0])).sum()
        times.append(t)
        height.append(2 / LENGTH * mode)  # first mode of the column's height
    rho, mu, sigma, a0 = (float(given["-water_" + name]) for name in ("density", "viscosity", "tension",
                                                                       "wave_amplitude"))
    rate = np.sqrt(sigma * k**3 / rho)
    times, height = np.array(times), np.array(height) / a0
    exact = prosperetti(times, rate, mu / rho * k**2)
    crossings = [[t0 + (t1 - t0) * a / (a - b) for t0, t1, a, b in zip(times, times[1:], h, h[1:]) if a * b < 0]
                 for h in (height, exact)]
    return [
        physics.at_most("height over that at the start, rms error", np.sqrt(((height - exact)**2).mean()), 0.05),
        physics.absolute("height at the start over the amplitude asked for", height[0], 1, 0.02),
        physics.shown("third passage of the level, w0 t", *(rate * c[2] if len(c) > 2 else np.nan for c in crossings)),
        physics.shown("height at the last minimum over the amplitude", height[times * rate > 8].min(),
                      exact[times * rate > 8].min())]


if __name__ == "__main__":
    physics.main(check)
