#!/usr/bin/python3
"""Dry wall: spread and height against a volume-of-fluid computation, the largest spread also against fits of
experiments by Laan et al. 2014 and Lee et al. 2016, the height at the end against a cap of the contact angle.
check.py RUN_FOLDER"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402

REFERENCE = os.path.join(HERE, "reference.csv")
TOGETHER = 1.5  # spacings: the largest step within a piece
SINKING = np.linspace(0.25e-3, 1.5e-3, 26)  # s


def numbers(options):
    """Diameter (m), Weber and Reynolds number."""
    D, U, rho, mu, sigma = (factor * abs(float(options["-drop_" + name].split(",")[-1])) for factor, name in (
        (2, "radius"), (1, "velocity"), (1, "density"), (1, "viscosity"), (1, "tension")))
    return D, rho * U * U * D / sigma, rho * U * D / mu


def laan(WE, RE):
    """Largest diameter over D: Re^(1/5) sqrt(P)/(1.24 + sqrt(P)), P = We Re^(-2/5)."""
    root = np.sqrt(WE * RE**-0.4)
    return RE**0.2 * root / (1.24 + root)


def lee(WE, RE, at_rest):
    """The same by Lee et al. 2016, with the spread of a cap at rest."""
    return np.hypot(RE**0.2 * np.sqrt(WE) / (7.6 + np.sqrt(WE)), at_rest)


def cap(D, angle):
    """Height and diameter of a spherical cap of the drop's volume: V = pi R^3 (2 + cos)(1 - cos)^2/3."""
    c = np.cos(np.radians(angle))
    radius = (D**3 / 2 / ((2 + c) * (1 - c)**2))**(1 / 3)
    return radius * (1 - c), 2 * radius * np.sqrt(1 - c * c)


def fits(WE, RE, spread, at_rest, judged):
    """The largest spread beside fits of experiments."""
    result = physics.relative if judged else lambda name, measured, expected, _: physics.shown(name, measured, expected)
    return [result("largest diameter over D, fit of experiments by Laan et al.", spread, laan(WE, RE), 0.08),
            result("the same, fit by Lee et al.", spread, lee(WE, RE, at_rest), 0.08)]


def bounce(states, options):
    """The time between touch and take-off over sqrt(rho R^3/sigma): 2.6 by experiment (Richard et al. 2002)."""
    radius, rho, sigma = (float(options["-drop_" + name]) for name in ("radius", "density", "tension"))
    touching = []
    for time, head, f in states:
        x, d0 = physics.places(head, f), float(head["spacing"])
        whole = physics.components(x, TOGETHER * d0) == 0
        if x[whole, 2].min() < d0:
            touching.append(time)
    taken = (touching[-1] - touching[0]) / np.sqrt(rho * radius**3 / sigma)
    gone = touching[-1] < states[-1][0]
    return [physics.at_least("whether the drop leaves the wall", float(gone), 1),
            physics.relative("time on the wall over sqrt(rho R^3/sigma)", taken, 2.6, 0.1)]


def motion(states):
    """Times (s), diameter and height of the largest piece (m), its share of the liquid."""
    times, spread, height, share = [], [], [], []
    for time, head, f in states:
        x, d0 = physics.places(head, f), float(head["spacing"])
        whole = physics.components(x, TOGETHER * d0) == 0
        times.append(time)
        spread.append(2 * np.hypot(x[whole, 0], x[whole, 1]).max() + d0)
        height.append(x[whole, 2].max() + d0 / 2)
        volume = physics.volumes(head, f)
        share.append(volume[whole].sum() / volume.sum())
    return times, spread, height, share


def curves(folder):
    """For a report of the run (report.py --reference): the file of the reference; title, unit, times and values of a
    curve of the run, and those of the reference."""
    times, spread, height, _ = motion(physics.snapshots(folder))
    right = physics.table(REFERENCE)
    return REFERENCE, [("diameter", "m", times, spread, right["time"], right["diameter"]),
                       ("height", "m", times, height, right["time"], right["height"])]


def check(folder):
    states = list(physics.snapshots(folder))
    options = physics.options(states[-1][1])
    if float(options["-wall_contact_angle"]) > 150:
        return bounce(states, options)
    times, spread, height, share = motion(states)
    D, WE, RE = numbers(options)
    angle = float(options["-wall_contact_angle"])
    water = "-wall_contact_hysteresis" in options
    results = fits(WE, RE, max(spread) / D, cap(D, angle)[1] / D, water)
    if not water:
        reference = physics.table(REFERENCE)
        there = np.interp(SINKING, reference["time"], reference["height"])
        results = [physics.at_most("height from 0.25 to 1.5 ms beside the reference, largest deviation",
                                   np.abs(np.interp(SINKING, times, height) / there - 1).max(), 0.05),
                   physics.relative("largest diameter over D", max(spread) / D, reference["diameter"].max() / D, 0.1),
                   physics.relative("height at the end", 1e3 * height[-1], 1e3 * cap(D, angle)[0], 0.1, "mm")] + results
    return results + [physics.at_most("liquid that came off", 1 - share[-1], 0.01)]


if __name__ == "__main__":
    physics.main(check)
