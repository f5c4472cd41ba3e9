"""The columns of series.csv that pictures show: which, their titles and handy units."""
import numpy as np

from isph import tables

SKIP = ("step", "wall_time", "rejected", "time")
BESIDE = ("volume", "viscous_work", "tension_work", "outside_work")  # of the flow, yet not drawn unless asked for
WORDS = {"lost": "left through open faces", "highest": "highest liquid", "outside_work": "work from outside",
         "wetted": "wetted area", "contact_diameter": "diameter of the contact", "contact_angle": "contact angle shown",
         "spread": "width of the contact", "contact_long": "long axis of the contact",
         "contact_short": "short axis of the contact"}
PREFIXES = {"k": 1e-3, "": 1, "m": 1e3, "µ": 1e6, "n": 1e9, "p": 1e12}
TAKE_PREFIX = ("m", "m/s", "s", "J", "J/m", "N", "N/m", "Pa")
POWERS = {"m2": 2, "m3": 3}
ROUNDING = 1e-9  # of the largest value: a column that changes by less is constant


def prefixed(value, unit):
    """Factor and unit with which a value in an SI unit is a handy number: 0.05 and m give 1000 and mm, 2e-6 and m2 give
    1e6 and mm2."""
    power = POWERS.get(unit, 1)
    if not value or unit not in TAKE_PREFIX and unit not in POWERS:
        return 1, unit
    wanted = [letter for letter in PREFIXES if letter != "k" or unit[0] not in "ms"]
    letter = next((letter for letter in wanted if abs(value) * PREFIXES[letter]**power >= 1), wanted[-1])
    return PREFIXES[letter]**power, letter + unit


def chosen(table, rows, wanted=None):
    """The columns of the series to draw, of those that change: those of the flow, or those with the wanted names. rows:
    tables.rows_of the run."""
    found = {}
    for name, values in table.items():
        values, row = np.array(values, dtype=float), rows.get(name, {})
        good = values[np.isfinite(values)]
        asked = row.get("counts") != "run" and name not in BESIDE if not wanted else \
            "all" in wanted or any(name.startswith(w) for w in wanted)
        if asked and name not in SKIP and len(good) > 1 and np.ptp(good) > ROUNDING * np.abs(good).max():
            found[name] = values
    if wanted and not found:
        raise tables.Error(f"--curves {' '.join(wanted)}: no column of this name changes in the series; it has "
                              + ", ".join(name for name in table if name not in SKIP))
    return found


def title(row):
    """Words and unit of a column, from its row."""
    name, whose = row["name"], row.get("whose") or ""
    kind, mark, rest = name.partition(f"_{whose}") if whose else (name, "", "")
    words = WORDS.get(kind, kind.replace("_", " "))
    return words + (f" at {whose}{rest.replace('_', ', ')}" if mark else ""), row["unit"]


def progress(table, rows, times):
    """How far the scene has changed at these times, from 0 to 1: the mean over the time and the columns of the flow of
    the way that each has gone up and down, over its whole way."""
    every = np.array(table.get("time", times), float)
    share = np.zeros(len(times))
    for values in (every, *chosen(table, rows).values()):
        good = np.isfinite(values)
        way = np.abs(np.diff(np.interp(times, every[good], values[good]))).cumsum()
        if len(way) and way[-1] > 0:
            share[1:] += way / way[-1]
    return share / max(share[-1], 1)
