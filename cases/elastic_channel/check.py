#!/usr/bin/python3
"""Polymers between plates: the velocity of Poiseuille flow from rest beside its series of modes, each a linear equation
of velocity and stress; the conformation in a shear from rest beside the model's equation. check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

MODES, STEPS = 60, 20000
HIGH = 1e3  # of c_xx: a Weissenberg number at which c mixes much


def numbers(head):
    options = physics.options(head)

    def number(name, default=0.0):
        return float(options.get("-liquid_" + name, default))
    return options, number


def exact(head, y, t):
    """u (m/s) at y (m from the middle): the sum of modes cos k y of u' = -nu_s k2 u + k s/rho + F and s' = -G k u -
    s/lambda, by the eigenvalues of both equations."""
    _, number = numbers(head)
    rho, H, g = number("density"), 0.5e-3, 8.0
    u = np.zeros_like(y)
    for n in range(MODES):
        k = (n + 0.5) * np.pi / H
        A = np.array([[-number("viscosity") / rho * k * k, k / rho],
                      [-number("polymer_modulus") * k, -1 / number("relaxation_time")]])
        F = np.array([g * 2 * (-1)**n / ((n + 0.5) * np.pi), 0])
        w, P = np.linalg.eig(A)
        now = P @ ((np.exp(w * t) - 1) / w * np.linalg.solve(P, F))
        u += now[0].real * np.cos(k * y)
    return u


def steady_force():
    return 1000 * 8 * 0.5e-3 * 0.5e-3  # N/m: of half of the liquid


def wall_force(head, t, step=1e-6):
    """The force (N/m) on a wall: that on half of the liquid less what gives it momentum."""
    y = np.linspace(0, 0.5e-3, 1001)
    before, after = (1000 * 0.5e-3 * np.sum(0.5 * (u[1:] + u[:-1])) * y[1]
                     for u in (exact(head, y, t - step), exact(head, y, t + step)))
    return steady_force() - (after - before) / (2 * step)


def steady(head):
    _, number = numbers(head)
    return 8 * 0.25e-6 / 2 * number("density") / (number("viscosity") +
                                                  number("polymer_modulus") * number("relaxation_time"))


def sheared(head, t):
    """The conformation (3 x 3) after t/lambda in a shear, by the classical Runge-Kutta method."""
    options, number = numbers(head)
    model, lam = options.get("-liquid_polymer_model", "oldroyd_b"), number("relaxation_time")
    rate = float(options["-liquid_strain_rate"].split(",")[1]) * lam
    L, one = np.array([[0, rate, 0], [0, 0, 0], [0, 0, 0]]), np.eye(3)

    def slope(c):
        b = number("polymer_extensibility")
        f = (b - 3) / (b - np.trace(c)) if model == "fene_p" else 1
        r = L @ c + c @ L.T - (f * c - one)
        return r - number("polymer_mobility") * (c - one) @ (c - one) if model == "giesekus" else r
    c, dt = one, t / lam / STEPS
    for _ in range(STEPS):
        k1 = slope(c)
        k2 = slope(c + 0.5 * dt * k1)
        k3 = slope(c + 0.5 * dt * k2)
        c = c + dt / 6 * (k1 + 2 * k2 + 2 * k3 + slope(c + dt * k3))
    return c


def check_shear(head, t, f):
    y, s = f["position"][:, 1], f["stretch"]
    middle = np.abs(y - 0.5e-3) < 0.25e-3
    c = sheared(head, t)
    xx = "c_xx - 1, last time", s[middle, 0].mean(), c[0, 0] - 1
    xy = "c_xy, last time", s[middle, 3].mean(), c[0, 1]
    if c[0, 0] > HIGH:
        return [physics.relative(*xx, 0.05), physics.shown(*xy)]
    return [physics.relative(*xx, 0.01), physics.relative(*xy, 0.01)]


def check(folder):
    rms = []
    for t, head, f in physics.snapshots(folder):
        if "-liquid_strain_rate" in physics.options(head):
            last = check_shear, head, t, f
            continue
        last = None
        error = f["velocity"][:, 0] - exact(head, f["position"][:, 1] - 0.5e-3, t)
        rms.append(np.sqrt((error**2).mean()) / steady(head))
    if last:
        return last[0](*last[1:])
    series = runs.series(folder)
    wrong = [series["force_ymin_x_Nm"][k] - wall_force(head, t) for k, t in enumerate(series["time"]) if t > 0]
    return [physics.at_most("velocity, largest rms error over the steady largest velocity", max(rms), 0.01),
            physics.at_most("force on a wall, largest error over the steady one", np.abs(wrong).max() / steady_force(),
                            0.01)]


if __name__ == "__main__":
    physics.main(check)
