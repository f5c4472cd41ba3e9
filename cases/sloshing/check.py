#!/usr/bin/python3
"""Sloshing: the surface at both walls against linear theory, a sum of modes from rest; of a run with a pocket of gas in
the corner of the roof, its oscillation against potential theory.
check.py RUN_FOLDER"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

L, H, G = 1.0, 0.3, 9.81  # m, m, m/s2
MODES = range(1, 40, 2)  # even ones are not excited
AIR, GAMMA, RHO = 101325.0, 1.4, 1000  # Pa, 1, kg/m3


def elevation(x, t, amplitude, omega):
    """Height above rest (m) at x: eta_n'' + w_n^2 eta_n = k tanh(kH) c_n a sin(wt), c_n = -4/(L k^2) the modes of
    x - L/2, from rest (from the linear free-surface conditions with gravity a sin(wt) along x)."""
    eta = 0
    for n in MODES:
        k = n * np.pi / L
        own = np.sqrt(G * k * np.tanh(k * H))
        force = -4 * amplitude * np.tanh(k * H) / (L * k)
        eta = eta + force / (own**2 - omega**2) * (np.sin(omega * t) - omega / own * np.sin(own * t)) * np.cos(k * x)
    return eta


def corner(radius, height, length):
    """Flux (m2/s) into a quarter of a circle in the corner of the roof for a unit of the potential between it and the
    open end of the water: its images in wall, roof and floor are a row of sources. Topliss, Cooker and Peregrine (1992)
    have the same of half a circle at a wall, with another logarithm. A solution on a grid agrees within 0.02 %."""
    return np.pi / 2 / (np.log(height / (np.pi * radius)) + np.pi * length / (2 * height))


def bounce(flux, start, volume, end):
    """Half the swing of the pressure (Pa) of the gas until a time, V'' = flux p/rho, V' = -start at first, p = p0
    ((V0/V)^gamma - 1)."""
    dt, rate, V, p = 1e-5, -start, volume, []
    for _ in range(round(end / dt)):
        p.append(AIR * ((volume / V)**GAMMA - 1))
        rate += dt * flux / RHO * p[-1]
        V += dt * rate
    return np.ptp(p) / 2


def trapped(folder, options):
    """The pocket of pocket.opts. The water that moves with the speed U has the flux U (length - x) flux into the pocket
    once the wall has stopped it, x the mean distance of the pocket's surface from the wall."""
    length, height = (float(x) for x in options["-water_upper"].split(","))
    size = float(options["-pocket_radius"]), height, length
    speed, flux, volume = -float(options["-water_velocity"].split(",")[0]), corner(*size), np.pi * size[0]**2 / 4
    rows = physics.table(os.path.join(folder, "pockets.csv"))
    t, p = rows["time_s"], rows["pressure_Pa"]
    above = p - p.mean()
    up = np.flatnonzero((above[:-1] < 0) & (above[1:] >= 0))
    periods = np.diff(t[up] - above[up] * (t[up + 1] - t[up]) / (above[up + 1] - above[up]))
    period = 2 * np.pi * np.sqrt(RHO * volume / (GAMMA * AIR * flux))
    swing = bounce(flux, speed * (size[2] - 2 * size[0] / np.pi) * flux, volume, period)
    return [physics.relative("first period of the pocket", 1e3 * periods[0], 1e3 * period, 0.01, "ms"),
            physics.relative("second period", 1e3 * periods[1], 1e3 * period, 0.03, "ms"),
            physics.relative("half the swing of its pressure in the first", np.ptp(p[t < period]) / 2, swing, 0.03,
                             "Pa"),
            physics.relative("its gas at the end, over that at the start", rows["amount_m2"][-1] / rows["amount_m2"][0],
                             1, 1e-6)]


def check(folder):
    s = runs.series(folder)
    options = physics.options(runs.head(runs.numbered(folder, "snapshot")[0]))
    if "-water_holes" in options:
        return trapped(folder, options)
    amplitude = float(options["-gravity_amplitude"].split(",")[0])
    omega = 2 * np.pi * float(options["-gravity_frequency"])
    places = [float(x) for x in options["-gauge_heights"].split(",")]
    measured = np.concatenate([s[f"height_{k + 1}_m"] - H for k in range(2)])
    exact = np.concatenate([elevation(x, s["time"], amplitude, omega) for x in places])
    return [physics.relative("rms elevation at the walls", 1e3 * np.sqrt((measured**2).mean()),
                             1e3 * np.sqrt((exact**2).mean()), 0.1, "mm"),
            physics.at_least("correlation with linear theory", np.corrcoef(measured, exact)[0, 1], 0.95),
            physics.shown("highest at a wall", 1e3 * measured.max(), 1e3 * exact.max(), "mm"),
            physics.at_most("particles lost", s["lost"][-1], 0)]


if __name__ == "__main__":
    physics.main(check)
