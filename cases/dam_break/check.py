#!/usr/bin/python3
"""Dam break: front and height of the column against Martin and Moyce; of a run with points, the pressure of the impact
against Lobovsky et al.
check.py RUN_FOLDER"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "tests", "verify"))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

G, A, H = 9.81, 57.15e-3, 0.3  # m/s2; widths of Martin and Moyce, height of Lobovsky et al., m


def experiment(name):
    with open(os.path.join(HERE, f"experiment_{name}.csv")) as file:
        return np.genfromtxt([line for line in file if line[0] != "#"], delimiter=",", names=True)


def front(x, spacing):
    """The end of the liquid that hangs together from the left: no gap of 1.5 spacings in x."""
    s = np.sort(x)
    gaps = np.flatnonzero(np.diff(s) > 1.5 * spacing)
    return (s[gaps[0]] if len(gaps) else s[-1]) + spacing / 2


def motion(folder):
    """Times (s), front over A, mean depth of the quarter of A next to the wall over 2 A, energy over its start."""
    t, z, h, energy = [], [], [], []
    for time, head, f in physics.snapshots(folder):
        x, spacing, up = f["position"], float(head["spacing"]), int(head["dimension"]) - 1
        width = A / 2 if up == 2 else spacing  # half the channel of case_3d.opts; one layer of particles
        t.append(time)
        z.append(front(x[:, 0], spacing) / A)
        h.append((x[:, 0] < A / 4).sum() * spacing**3 / (width * A / 4) / (2 * A))
        energy.append((0.5 * (f["velocity"]**2).sum(axis=1) + G * x[:, up]).sum())
    return np.array(t), np.array(z), np.array(h), np.array(energy) / energy[0]


def collapse(folder):
    """Against Martin and Moyce. How long their barrier held the water is not known: the front is compared at their times
    and, with a lag fitted, for its course."""
    t, z, h, energy = motion(folder)
    e, c = experiment("front"), experiment("height")
    scaled = t * np.sqrt(2 * G / A)
    lags = np.arange(0, 0.6, 0.005)
    off = [np.abs(np.interp(e["T"][2:] - lag, scaled, z) / e["front"][2:] - 1).max() for lag in lags]
    speed = np.polyfit(np.interp(np.linspace(1.5, 4, 26), z, scaled), np.linspace(1.5, 4, 26), 1)[0]
    measured = np.polyfit(e["T"][3:], e["front"][3:], 1)[0]
    height = np.interp(c["t"], t * np.sqrt(G / A), h)
    passed = np.argmin(np.abs(z - 4))
    return [("front, largest deviation from T = 1.19", off[0], 0.05),
            ("front, largest deviation with the lag", min(off), 0.05),
            ("lag in T", lags[np.argmin(off)], 0.3),
            ("front's speed, relative error", speed / measured - 1, 0.05),
            ("height, largest deviation over 2 a", np.abs(height - c["height"]).max(), 0.05),
            ("height, largest relative deviation to 2.21", np.abs(height / c["height"] - 1)[c["t"] < 2.3].max(), 0.05),
            ("energy, change until x/a = 4", energy[passed] - 1, 0.05)]


def impact(folder):
    """Against Lobovsky et al.: pressures after a running mean of 1 ms."""
    s, e = runs.series(folder), experiment("pressure")
    t = np.arange(0, s["time"][-1], 1e-4)
    results = []
    for point, place in ((1, "15 mm"), (2, "30 mm")):
        p = np.interp(t, s["time"], s[f"point_{point}_pressure_Pa"]) / (1000 * G * H)
        p, scaled = np.convolve(p, np.full(10, 0.1), "same"), t * np.sqrt(G / H)
        chosen = (scaled >= e["t"][0]) & (scaled <= e["t"][-1])
        low, high = np.interp(scaled, e["t"], e["low"]), np.interp(scaled, e["t"], e["high"])
        peak = np.argmax(np.where(scaled < 3.1, p, 0))
        onset, plateau = scaled[np.argmax(p > 0.2)], p[(scaled > 3.5) & (scaled < 5)].mean()
        results += [(f"outside the band at {place}, share", ((p < low) | (p > high))[chosen].mean(), 0.2),
                    (f"first peak at {place}, relative error", p[peak] / 1.871 - 1, 0.2),
                    (f"arrival at {place}, t sqrt(g/H) less 2.45", onset - 2.45, 0.12),
                    (f"mean from 3.5 to 5 at {place}, relative error", plateau / 0.597 - 1, 0.2)]
    return results


def check(folder):
    points = "point_1_pressure_Pa" in (runs.series(folder).dtype.names or ())
    return impact(folder) if points else collapse(folder)


if __name__ == "__main__":
    physics.main(check)
