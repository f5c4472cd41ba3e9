"""Quantities: a column of series.csv and what is taken of its curve."""
import math

import numpy as np
from isph import tables

TIMES = {"max": 0, "min": 0, "end": 0, "rest": 0, "time_of_max": 0, "at": 1, "mean": 2, "settles": 1}  # of a take
TAKES = "max, min, end, rest, time_of_max, at=TIME, mean=TIME,TIME, settles=PER CENT"
LAST = 0.1  # of a run: its end, which is not at rest if the curve changes in it by more than this share:
MOVED, RESTS = 0.01, 0.02  # the second is that of -stop_at_rest
ENERGIES = ["kinetic_energy", "potential_energy", "surface_energy"]  # which rest where all does
LONGEST = 20  # times the scene's time, in which a run must come to rest
PASSED = 0.3  # of the range of a curve, by which it stays below its extreme when that has passed
LATER = 1.1  # times that time, until which a run at a finer spacing goes
START = 0.05  # of the run: an extreme pressure or force in it may be the packing's


class Quantity:
    """COLUMN:TAKE, for instance crater_depth:max, highest:at=10e-3 or force_zmin_z:mean=5e-3,10e-3. settles=5 is the
    time after which the curve stays within 5 % of its end; rest is the end of a run that goes on until it rests. row:
    the column's of scene.json; back: the name of the column of the runs and the factor that make it that of the
    scene."""

    def __init__(self, text):
        self.text = text
        self.column, _, take = text.partition(":")
        self.take, _, rest = (take or "end").partition("=")
        self.times = [tables.number(word) for word in rest.split(",")] if rest else []
        self.row, self.back = None, (self.column, 1.0)
        wanted = TIMES.get(self.take)
        if wanted is None or wanted != len(self.times) or not all(map(math.isfinite, self.times)):
            raise tables.Error(f"QUANTITY={text}: behind the column and a colon stands one of {TAKES}.")
        if wanted == 2 and not self.times[0] < self.times[1]:
            raise tables.Error(f"QUANTITY={text}: the mean needs an earlier and a later time.")

    def find(self, rows):
        """Looks its column up among the rows of the series; a name with the unit is one, too."""
        rows = [row for row in rows if row["file"] == "series.csv"]
        self.row = next((row for row in rows if self.column in (row["name"], row["head"])), None)
        if not self.row:
            raise tables.Error(f"QUANTITY={self.text}: the series has no column {self.column}; there are: "
                                  f"{', '.join(row['name'] for row in rows if row['name'] != 'time')}.")
        self.back = (self.row["name"], 1.0)

    def warm(self):
        return self.unit() == "K"

    def size(self, series):
        """What its accuracy is per cent of: of a temperature, whose zero is far away, its range in a run; 0: its
        value."""
        if not self.warm():
            return 0.0
        return float(np.nanmax(series["temperature_max"]) - np.nanmin(series["temperature_min"]))

    def whole(self):
        """The same in words."""
        return " of the range of temperature" if self.warm() else ""

    def unit(self):
        return "s" if self.take in ("time_of_max", "settles") else self.row["unit"] if self.row else ""

    def curve(self, series, end=math.inf):
        """(times, values) of a run until 'end'; nan where there is no value."""
        name, factor = self.back
        if name not in series:
            raise tables.Error(f"QUANTITY={self.text}: the series has no column {name}; there are: "
                                  f"{', '.join(column for column in series if column != 'time')}.")
        t, y = np.array(tables.clock(series, self.row or {})), factor * np.array(series[name])
        return t[t <= end], y[t <= end]

    def of(self, series, end=math.inf):
        """The value of a run, until 'end'; nan where the curve has none."""
        t, y = self.curve(series, end)
        known = np.isfinite(y)
        if not known.any():
            return math.nan
        if self.take in ("at", "mean"):
            if end < self.times[-1]:
                return float(y[-1])
            first, last = series["time"][0], series["time"][-1]
            if self.times[-1] > last * (1 + 1e-9) or self.times[0] < first:
                raise tables.Error(f"QUANTITY={self.text}: the run has times from {first:g} to {last:g} s.")
            wanted = self.times if self.take == "at" else np.linspace(*self.times, 1000)
            return float(np.interp(wanted, t, y).mean())
        if self.take == "settles":
            away = np.abs(y - y[-1]) > 0.01 * self.times[0] * abs(y[-1])
            return float(t[np.flatnonzero(away)[-1] + 1]) if away.any() and known[-1] else float(t[0])
        return float({"max": np.nanmax(y), "min": np.nanmin(y), "end": y[-1], "rest": y[-1],
                      "time_of_max": t[np.nanargmax(y)]}[self.take])

    def needs(self, series):
        """The time after which this run has told nothing more: of an extreme that from which on the curve stays below
        it by PASSED of its range; inf: its end is asked for. series: None before any run."""
        if self.take in ("at", "mean"):
            return self.times[-1]
        if self.take not in ("max", "min", "time_of_max") or series is None:
            return math.inf
        t, y = self.curve(series)
        y = -y if self.take == "min" else y
        if not np.isfinite(y).any() or np.nanmax(y) == np.nanmin(y):
            return math.inf
        near = np.flatnonzero(y > np.nanmax(y) - PASSED * (np.nanmax(y) - np.nanmin(y)))
        return t[0] + LATER * (t[near[-1] + 1] - t[0]) if near[-1] + 1 < len(t) else math.inf

    def remarks(self, series):
        """Sentences about the value of a run: where the curve has a gap, an end that still changes, an extreme of the
        start."""
        t, y = self.curve(series)
        known = np.isfinite(y)
        if not known.any():
            return [f"{self.text}: the curve has no value"]
        said, first, last = [], *np.flatnonzero(known)[[0, -1]]
        if first > 1 or last < len(y) - 1 or not known[first:last].all():
            gaps = np.flatnonzero(np.diff(known.astype(int)))
            said.append(f"{self.column} has values from {t[first]:.4g} to {t[last]:.4g} s only"
                        + (f", with gaps between: {', '.join(f'{t[k]:.4g}' for k in gaps[:8])} s"
                           if not known[first:last].all() else ""))
        late = known & (t >= t[-1] - LAST * (t[-1] - t[0]))
        if self.take in ("end", "rest") and late.sum() > 1 and np.ptp(y[known]) > 0:
            change = y[last] - y[np.flatnonzero(late)[0]]
            if abs(change) > (MOVED if self.take == "end" else RESTS) * max(abs(y[last]), np.ptp(y[known])):
                said.append(f"{self.text} still changes when a run ends, by {abs(change / y[last]):.1%} in its last "
                            "tenth" + (f": {self.column}:rest is its value at rest" if self.take == "end" else ""))
        if self.take in ("max", "min") and self.row and "pressure" in self.row["needs"]:
            when = t[np.nanargmax(y) if self.take == "max" else np.nanargmin(y)]
            said.append(f"{self.text} came at {when:.4g} s" + (
                ", in the first twentieth of the run: the start may have made it (-packing_relaxation_time)"
                if when - t[0] < START * (t[-1] - t[0]) else ""))
        return said


def ends(quantities, known):
    """The options that end a run of a known scene at rest, if only ends are asked; for a value at rest the run may be
    LONGEST times as long."""
    words, takes = [], {q.take for q in quantities}
    if takes - {"end", "rest", "settles"} or known["time_end"] is None:
        if "rest" in takes:
            raise tables.Error("QUANTITY: rest needs a -time_end, and end or settles are all that stands beside it.")
        return words
    if "rest" in takes:
        words += ["-time_end", f"{known['time_start'] + LONGEST * (known['time_end'] - known['time_start']):.9g}"]
    return words + ["-stop_at_rest", ",".join(dict.fromkeys([q.back[0] for q in quantities] + ENERGIES))]


def read(text):
    """The quantities of a list; commas separate them, but for those between two times."""
    words, parts = text.split(","), []
    for word in words:
        if parts and ":mean=" in parts[-1] and "," not in parts[-1].rpartition("=")[2]:
            parts[-1] += "," + word
        else:
            parts.append(word)
    return [Quantity(part) for part in parts if part]
