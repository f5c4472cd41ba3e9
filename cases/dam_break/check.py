#!/usr/bin/python3
"""Dam break: front and height of the column against Martin and Moyce; of a run with points, the pressure of the impact
against Lobovsky et al.; of a run with pockets, the air that the wave traps; all against volume-of-fluid computations,
which start as the runs do.
check.py RUN_FOLDER"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

G, A, H = 9.81, 57.15e-3, 0.3  # m/s2; widths of Martin and Moyce, height of Lobovsky et al., m
TANK, STIFFNESS = (1.61, 1.2), 1.4 * 101325  # m, of Lobovsky et al.; Pa, of air
SPECK = 0.1  # of the air that the reference traps


def experiment(name):
    return physics.table(os.path.join(HERE, f"experiment_{name}.csv"))


def reference(name):
    return physics.table(os.path.join(HERE, f"reference_{name}.csv"))


def reach(s, spacing):
    """The end of the liquid that hangs together from the wall or floor: no gap of 1.5 spacings in the coordinate."""
    s = np.sort(s)
    gaps = np.flatnonzero(np.diff(s) > 1.5 * spacing)
    return (s[gaps[0]] if len(gaps) else s[-1]) + spacing / 2


def motion(folder):
    """Times (s), front over A, height over 2 A of the three layers next to the wall, energy over its start."""
    t, z, h, energy = [], [], [], []
    for time, head, f in physics.snapshots(folder):
        x, spacing, up = f["position"], float(head["spacing"]), int(head["dimension"]) - 1
        t.append(time)
        z.append(reach(x[:, 0], spacing) / A)
        h.append(reach(x[x[:, 0] < 3 * spacing, up], spacing) / (2 * A))
        energy.append((0.5 * (f["velocity"]**2).sum(axis=1) + G * x[:, up]).sum())
    return np.array(t), np.array(z), np.array(h), np.array(energy) / energy[0]


def curves(folder):
    """For a report of the run (report.py --reference): the file of the reference; title, unit, times and values of a
    curve of the run, and those of the reference."""
    t, z, h, _ = motion(folder)
    right = reference("collapse")
    return os.path.join(HERE, "reference_collapse.csv"), [
        ("front over the width", "", t, z, right["time"], right["front"]),
        ("height at the wall over the width", "", t, 2 * h, right["time"], right["height"])]


def collapse(folder):
    """Against Martin and Moyce. How long their barrier held the water is not known: the front is compared at their
    times and, with a lag fitted, for its course."""
    t, z, h, energy = motion(folder)
    e, c = experiment("front"), experiment("height")
    scaled = t * np.sqrt(2 * G / A)
    lags = np.arange(0, 0.6, 0.005)
    off = [np.abs(np.interp(e["T"][2:] - lag, scaled, z) / e["front"][2:] - 1).max() for lag in lags]
    places = np.linspace(1.67, 4.11, 26)
    speed = np.polyfit(np.interp(places, z, scaled), places, 1)[0]
    measured = np.polyfit(e["T"][3:], e["front"][3:], 1)[0]
    height = np.interp(c["t"], t * np.sqrt(G / A), h)
    passed = np.argmin(np.abs(z - 4))
    right = reference("collapse")
    there = np.interp(e["T"][2:] * np.sqrt(A / (2 * G)), right["time"], right["front"])
    here = np.interp(e["T"][2:], scaled, z)
    beside = np.interp(right["time"], t, h) - right["height"] / 2
    return [physics.at_most("front, largest relative deviation from T = 1.19 on", off[0], 0.05),
            physics.at_most("front, largest relative deviation, times less the lag", min(off), 0.05),
            physics.shown("lag of the experiment, T", lags[np.argmin(off)]),
            physics.relative("speed of the front, d(x/a)/dT", speed, measured, 0.05),
            physics.at_most("height of the column, largest deviation over 2 a", np.abs(height - c["height"]).max(),
                            0.05),
            physics.shown("height of the column, largest relative deviation",
                          np.abs(height / c["height"] - 1).max()),
            physics.at_most("front beside the reference, largest relative deviation from T = 1.19 on",
                            np.abs(here / there - 1).max(), 0.05),
            physics.at_most("height beside the reference, largest deviation over 2 a", np.abs(beside).max(), 0.05),
            physics.shown("front of the reference beside the experiment", np.abs(there / e["front"][2:] - 1).max()),
            physics.at_most("energy, relative change until x/a = 4", energy[passed] - 1, 0.02)]


def impact(folder):
    """Against Lobovsky et al.: pressures after a running mean of 1 ms."""
    s, e, right = runs.series(folder), experiment("pressure"), reference("impact")
    t = np.arange(0, s["time"][-1], 1e-4)
    p = np.interp(t, s["time"], np.nan_to_num(s["point_1_pressure_Pa"])) / (1000 * G * H)
    p, scaled = np.convolve(p, np.full(10, 0.1), "same"), t * np.sqrt(G / H)
    there = np.interp(t, right["time"], right["pressure"]) / (1000 * G * H)
    if scaled[-1] < e["t"][-1]:
        raise ValueError(f"the run ends at t sqrt(g/H) = {scaled[-1]:.3g}")
    chosen = (scaled >= e["t"][0]) & (scaled <= e["t"][-1])
    low, high, median = (np.interp(scaled, e["t"], e[name]) for name in ("low", "high", "median"))
    later = (scaled > 3.5) & (scaled < 5)
    peak = np.argmax(np.where(scaled < 3.1, p, 0))
    return [physics.at_least("share of the samples in the band", ((p >= low) & (p <= high))[chosen].mean(), 0.8),
            physics.relative("first peak over rho g H", p[peak], 1.871, 0.2),
            physics.absolute("time of the peak, t sqrt(g/H)", scaled[peak], 2.599, 0.12),
            physics.relative("mean from 3.5 to 5 over rho g H", p[later].mean(), median[later].mean(), 0.2),
            physics.relative("the same beside the reference", p[later].mean(), there[later].mean(), 0.1),
            physics.shown("first peak beside the reference", p[peak], there[scaled < 3.1].max()),
            physics.shown("share of the reference's samples in the band",
                          ((there >= low) & (there <= high))[chosen].mean())]


def wider(part):
    """The cells of a part and those beside them."""
    more = part.copy()
    for a, b in ((np.s_[1:], np.s_[:-1]), (np.s_[:, 1:], np.s_[:, :-1])):
        more[a] |= part[b]
        more[b] |= part[a]
    return more


def grown(part, region):
    """The cells of the region that hang together with a part of it."""
    while True:
        more = wider(part) & region
        if (more == part).all():
            return part
        part = more


def cells(x, spacing):
    """The share of each cell of the tank that liquid fills: a particle is a square, and the sums are smoothed."""
    n, m = (round(length / spacing) for length in TANK)
    filled, parts = np.zeros((n, m)), (np.arange(4) - 1.5) / 4
    for shift in np.stack(np.meshgrid(parts, parts), -1).reshape(-1, 2):
        np.add.at(filled, tuple(np.clip((x / spacing + shift).astype(int), 0, (n - 1, m - 1)).T), 1 / 16)
    for _ in range(2):
        wide = np.pad(filled, ((1, 1), (0, 0)), "edge")
        filled = (0.25 * (wide[:-2] + wide[2:]) + 0.5 * filled).T
    return filled


def own_period(x, spacing, centre):
    """Period (s) of small oscillations of the pocket at the centre, among particles at x. Its pressure p moves liquid
    by a potential that is harmonic, 0 at the open surface, constant around the pocket: with the flux Q for a unit,
    V'' = Q p/rho, and p = -gamma p0 V/V0, so that the square of the frequency is gamma p0 Q/(rho V0)."""
    filled = cells(x, spacing)
    liquid, top = filled > 0.5, np.zeros(filled.shape, bool)
    top[:, -1] = True
    enclosed = ~liquid & ~grown(top & ~liquid, ~liquid)
    there = np.argwhere(enclosed)
    seed = there[(((there + 0.5) * spacing - centre)**2).sum(axis=1).argmin()]
    pocket = np.zeros(filled.shape, bool)
    pocket[tuple(seed)] = True
    pocket = grown(pocket, enclosed)
    weights = []
    for low, high in ((np.s_[:-1], np.s_[1:]), (np.s_[:, :-1], np.s_[:, 1:])):
        inner, outer = np.maximum(filled[low], filled[high]), np.minimum(filled[low], filled[high])
        edge = 1 / np.clip((inner - 0.5) / np.maximum(inner - outer, 1e-9), 0.1, 1)  # over the way to the surface
        weights.append(np.where(liquid[low] & liquid[high], 1.0, np.where(liquid[low] | liquid[high], edge, 0.0)))

    def flux(phi):
        across, along = weights[0] * np.diff(phi, axis=0), weights[1] * np.diff(phi, axis=1)
        return (np.pad(across, ((1, 0), (0, 0))) - np.pad(across, ((0, 1), (0, 0))) +
                np.pad(along, ((0, 0), (1, 0))) - np.pad(along, ((0, 0), (0, 1))))
    phi = pocket.astype(float)
    r = -flux(phi) * liquid
    d, square = r, (r * r).sum()
    while square > 1e-16 * pocket.sum():  # conjugate gradients
        q = flux(d) * liquid
        alpha = square / (d * q).sum()
        phi, r = phi + alpha * d, r - alpha * q
        before, square = square, (r * r).sum()
        d = r + square / before * d
    area = (1 - filled)[wider(wider(pocket))].sum() * spacing**2
    return 2 * np.pi * np.sqrt(1000 * area / (STIFFNESS * (flux(phi) * pocket).sum()))


def trapped(folder):
    """The air that the wave from the wall traps, until 1.3 s, when the reference traps more elsewhere; what the crest
    encloses before, the air of a particle or two, is not meant. The computed gas is a spring and swings; the
    reference's is incompressible: pressures are means over time."""
    rows, right, s = physics.table(os.path.join(folder, "pockets.csv")), reference("trapped"), runs.series(folder)
    there = right[right["area"] > 0]
    rows = rows[rows["amount_m2"] > SPECK * there["area"][0]]
    times = np.unique(rows["time_s"])
    parts = [rows[rows["time_s"] == time] for time in times]
    largest = np.array([part[part["volume_m2"].argmax()] for part in parts])
    kept = np.interp([1.3, 1.4], times, largest["amount_m2"]) / largest["amount_m2"][0]
    start = times[0]
    t, z, _, _ = motion(folder)
    fronts = np.abs(np.interp([0.2, 0.3], t, z * A) / np.interp([0.2, 0.3], right["time"], right["front"]) - 1)
    energy = np.abs(np.interp(right["time"], s["time"], s["kinetic_energy"]) - right["kinetic_energy"])
    window = np.linspace(1.1, 1.3, 201)

    def mean(time, values):
        return np.interp(window, time, values).mean()
    swing = largest["pressure_Pa"] - mean(times, largest["pressure_Pa"])
    up = times[1:][(swing[:-1] < 0) & (swing[1:] >= 0)]
    up = up[(up > 1.07) & (up < 1.31)]
    own = [own_period(f["position"][:, :2], float(head["spacing"]),
                      [np.interp(time, times, largest[f"{c}_m"]) for c in "xy"])
           for time, head, f in physics.snapshots(folder) if 1.08 < time < 1.31]
    distance = np.hypot(*(mean(times, largest[f"{c}_m"]) - mean(there["time"], there[c]) for c in "xy"))
    return [physics.at_most("front at 0.2 and 0.3 s beside the reference, largest relative deviation", fronts.max(),
                            0.05),
            physics.absolute("time of closing", start, there["time"][0] - 0.01, 0.02, "s"),
            physics.relative("enclosed area at closing", largest["volume_m2"][0], there["area"][0], 0.1, "m2"),
            physics.at_most("centre of the pocket from 1.1 to 1.3 s beside the reference's, over its width",
                            distance / np.sqrt(there["area"][0]), 0.2),
            physics.absolute("mean pressure of the pocket from 1.1 to 1.3 s over rho g H",
                             mean(times, largest["pressure_Pa"]) / (1000 * G * H),
                             mean(there["time"], there["pressure"]) / (1000 * G * H), 0.1),
            physics.relative("period of the gas from 1.08 to 1.3 s, beside linear theory", np.diff(up).mean(),
                             np.mean(own), 0.05, "s"),
            physics.at_most("kinetic energy until closing beside the reference, largest deviation over its largest",
                            energy[right["time"] < start].max() / right["kinetic_energy"].max(), 0.05),
            physics.shown("the same until 1.3 s", energy[right["time"] < 1.31].max() / right["kinetic_energy"].max()),
            physics.relative("gas of the pocket at 1.3 s, over that at closing", kept[0], 1, 0.01),
            physics.shown("the same at 1.4 s", kept[1])]


def check(folder):
    if os.path.exists(os.path.join(folder, "pockets.csv")):
        return trapped(folder)
    points = "point_1_pressure_Pa" in (runs.series(folder).dtype.names or ())
    return impact(folder) if points else collapse(folder)


if __name__ == "__main__":
    physics.main(check)
