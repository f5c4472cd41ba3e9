"""The known misses: results that are beyond their tolerance and must not change unseen, and how a row is judged beside
its record in misses.csv.

A row beyond its tolerance must have a record and lie in the record's band; outside it fails, worse or better. A row
that is within its tolerance again is cured and fails until its record is removed. Where chance decides on which side of
the tolerance a row lies, the record says so in 'why', and its band is judged alone. A run that stops is the row 'run',
its value the time (s) at which it stopped; where chance decides whether it stops, 'why' says so, and a run to the end
is right too. A record whose entry or row does not exist fails."""
import csv
import math
import os
from typing import NamedTuple

PATH = os.path.join(os.path.dirname(os.path.abspath(__file__)), "misses.csv")
WITHIN, KNOWN, FAILED, SHOWN = "yes", "known", "NO", "-"  # the words of the tables


class Record(NamedTuple):
    """One line of misses.csv: a row of an entry, the value when it was recorded, the ends of its band, and why chance
    decides it (empty: it does not)."""
    id: str
    quantity: str
    measured: float
    low: float
    high: float
    why: str = ""


def read(path=PATH):
    """{(id, quantity): Record} of a file like misses.csv; a ValueError tells what is wrong with it."""
    records = {}
    with open(path, newline="", encoding="utf-8") as file:
        for line in csv.DictReader(line for line in file if line[0] != "#"):
            record = Record(line["id"], line["quantity"], float(line["measured"]), float(line["low"]),
                            float(line["high"]), line["why"])
            if not record.low <= record.measured <= record.high:
                raise ValueError(f"{record.id}, {record.quantity}: its measured value is not in its band")
            if record[:2] in records:
                raise ValueError(f"{record.id}, {record.quantity}: it has two records")
            records[record[:2]] = record
    return records


def judge(passed, value, record):
    """(word for the tables, what is wrong) of a row: passed tells whether it is within its tolerance (None: it has
    none), record is its Record or None."""
    if record is None:
        return {True: WITHIN, False: FAILED, None: SHOWN}[passed], "" if passed is not False else "beyond its tolerance"
    if passed is None:
        return FAILED, "recorded as a known miss, but it has no tolerance: remove its record"
    if record.low <= value <= record.high and (not passed or record.why):
        return WITHIN if passed else KNOWN, ""
    if passed:
        return FAILED, "cured: within its tolerance, remove its record"
    return FAILED, f"a known miss that left its band, {record.low:.6g} to {record.high:.6g}"


def stale(records, entry, quantities):
    """(quantity, what is wrong) of the records of an entry that ran to its end with these quantities, but not that."""
    return [(name, "cured: it runs to the end, remove its record" if name == "run" else
             "recorded as a known miss, but there is no such row: remove its record")
            for (owner, name), record in records.items()
            if owner == entry and name not in quantities and not (name == "run" and record.why)]


def stop_time(reason):
    """The time (s) at which a run stopped, from its last words; nan if they do not tell."""
    words = reason.split()
    try:
        return float(words[words.index("at") + 1])
    except (ValueError, IndexError):
        return math.nan
