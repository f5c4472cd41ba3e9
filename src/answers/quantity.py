"""Quantities: a column of series.csv and what is taken of its curve."""
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "pictures"))
import numpy as np  # noqa: E402
import tables  # noqa: E402

UNITS_OF_NAMES = {"m", "m2", "m3", "J", "N", "N/m", "Pa", "degrees"}
TAKES = "max, min, end, time_of_max, at=TIME, mean=TIME,TIME"


class Quantity:
    """COLUMN:TAKE, for instance crater_depth:max, highest:at=10e-3 or force_zmin_z:mean=5e-3,10e-3."""

    def __init__(self, text):
        self.text = text
        self.column, _, take = text.partition(":")
        self.take, _, rest = (take or "end").partition("=")
        self.times = [tables.number(word) for word in rest.split(",")] if rest else []
        wanted = {"max": 0, "min": 0, "end": 0, "time_of_max": 0, "at": 1, "mean": 2}.get(self.take)
        if wanted is None or wanted != len(self.times) or not all(map(math.isfinite, self.times)):
            raise tables.RunError(f"QUANTITY={text}: behind the column and a colon stands one of {TAKES}.")
        if wanted == 2 and not self.times[0] < self.times[1]:
            raise tables.RunError(f"QUANTITY={text}: the mean needs an earlier and a later time.")

    def unit(self):
        """The unit (three dimensions); empty if it is not known."""
        if self.take == "time_of_max":
            return "s"
        last = self.column.rpartition("_")[2]
        return tables.UNITS.get(self.column, last if last in UNITS_OF_NAMES else "")

    def of(self, series):
        """The value of a run. A column's name may leave its unit out."""
        longer = [name for name in series if name.rpartition("_")[0] == self.column]
        if self.column not in series and len(longer) == 1:
            self.column = longer[0]
        if self.column not in series:
            raise tables.RunError(f"QUANTITY={self.text}: the series has no column {self.column}; there are: "
                                  f"{', '.join(name for name in series if name != 'time')}.")
        t, y = np.array(series["time"]), np.array(series[self.column])
        known = np.isfinite(y)
        if not known.any():
            return math.nan
        if self.take in ("at", "mean"):
            if self.times[-1] > t[-1] * (1 + 1e-9) or self.times[0] < t[0]:
                raise tables.RunError(f"QUANTITY={self.text}: the run has times from {t[0]:g} to {t[-1]:g} s.")
            if self.take == "at":
                return float(np.interp(self.times[0], t[known], y[known]))
            fine = np.linspace(*self.times, 1000)
            return float(np.interp(fine, t[known], y[known]).mean())
        return float({"max": np.nanmax(y), "min": np.nanmin(y), "end": y[known][-1],
                      "time_of_max": t[np.nanargmax(y)]}[self.take])


def read(text):
    """The quantities of a list; commas separate them, but for those between two times."""
    words, parts = text.split(","), []
    for word in words:
        if parts and ":mean=" in parts[-1] and "," not in parts[-1].rpartition("=")[2]:
            parts[-1] += "," + word
        else:
            parts.append(word)
    return [Quantity(part) for part in parts if part]
