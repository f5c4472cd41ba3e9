#!/usr/bin/python3
"""Figures quoted in README.md and in the presets' headers are those of the generated tables. Each quotation is a
pattern whose groups are figures, and for each group where it comes from; a group must be the table's figure, rounded
to the digits quoted. Figures that no quotation covers fail too: in the tables of README's sections SECTIONS, and in
a preset's header any number before a unit or 'times'. Per cents in the gallery of cases/README.md are figures of the
cases. --mend also writes the tables' figures into README.md. LINT_ROOT: another tree, for a test of the test."""
import glob
import math
import os
import re
import sys

import verdict

ROOT = os.environ.get("LINT_ROOT", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
TRADEOFF, BENCH = "tests/tradeoff/README.md", "tests/bench/README.md"
SECTIONS = ("## How good it is", "## How fast it is")
PRESETS = ("fast", "balanced", "accurate", "paper", "printed", "quick", "quarter")


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return file.read()


def tables(path):
    """The rows of all tables of a document: lists of (column's title, cell). An empty first cell is that above it."""
    rows, titles, above = [], None, ""
    for line in read(path).splitlines():
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        if not cells:
            titles = None
        elif titles is None:
            titles = cells
        elif not set("".join(cells)) <= set("- :"):
            above = cells[0] = cells[0] or above
            rows.append(list(zip(titles, cells)))
    return rows


def look_up(path, keys, column, part=0):
    """The number in a column of the only row that has these cells (options behind a name aside); part: which of several
    numbers in the cell."""
    found = [dict(row) for row in tables(path) if column in dict(row) and
             all(any(cell == key or cell.startswith(key + " `") for _, cell in row) for key in keys)]
    if len(found) != 1:
        raise LookupError(f"{len(found)} rows of {path} have {keys} and a column '{column}'")
    return found[0][column].split(": ")[-1].split(", ")[part]


def verified(case, quantity, column="default scheme"):
    return lambda: look_up(f"cases/{case.partition(',')[0]}/results.md", (case, quantity), column)


def choice(name, scene, part, inverse=False):
    """Error (0) or CPU time (1) over those of the defaults; inverse: how many times as quick."""
    def figure():
        value = look_up(TRADEOFF, (name,), scene, part)
        return str(1 / float(value)) if inverse else value
    return figure


def speed(ranks, column):
    return lambda: look_up(BENCH, ("1102944", "splash", ranks), column)


def slow(column):
    return lambda: look_up(BENCH, ("floating_box",), column)


def preconditioner(name, part):
    return lambda: look_up(BENCH, (name,), "splash: us, iterations", part)


def judged(part):
    """Figures of the default scheme within (0) their tolerance, and all (1) that are judged."""
    pattern = r"^Default scheme: (\d+) within tolerance, (\d+) known misses, (\d+) failed"
    counts = [re.search(pattern, read(path), re.M) for path in glob.glob("cases/*/results.md", root_dir=ROOT)]
    good, known, failed = (sum(int(count[k]) for count in counts if count) for k in (1, 2, 3))
    return lambda: str((good, good + known + failed)[part])


DEPTH = "D(t) 2 to 35 ms, largest error over the largest D"
ENERGY, FRONT = "kinetic energy at 10 ms", "front beside the reference, largest relative deviation from T = 1.19 on"
DROP, IMPACT, VORTICES = "pressure in the inner half, mean from 20 ms on", "drop impact, 0.7 mm, to 20 ms", \
    "Taylor-Green, 50 x 50"
QUOTED = [
    ("README.md", r"crater depth, [^|]*\| ([\d.]+) %", [verified("drop_impact, 0.25 mm", DEPTH)]),
    ("README.md", r"crater diameter, [^|]*\| ([\d.]+) %",
     [verified("drop_impact, 0.25 mm", "phi(t) 2 to 35 ms, largest error")]),
    ("README.md", r"\| \| kinetic energy after 10 ms \| ([\d.]+) uJ \| ([\d.]+) uJ",
     [verified("drop_impact, 0.25 mm", ENERGY), verified("drop_impact, 0.25 mm", ENERGY, "expected")]),
    ("README.md", r"0\.5 mm \| kinetic energy after 10 ms \| ([\d.]+) uJ \| ([\d.]+) uJ \| ([\d.]+) uJ",
     [verified("drop_impact, 0.5 mm", ENERGY, column) for column in ("default scheme", "expected", "as printed")]),
    ("README.md", r"dam break \|[^|]*\| ([\d.]+) %", [verified("dam_break, collapse", FRONT)]),
    ("README.md", r"drop at rest \|[^|]*\| ([\d.]+) Pa \| ([\d.]+) Pa \| ([\d.]+) Pa",
     [verified("laplace_jump, 3-d", DROP, column) for column in ("default scheme", "expected", "as printed")]),
    ("README.md", r"oscillating drop \|[^|]*\| ([\d.]+) ms \| ([\d.]+) ms \| ([\d.]+) ms",
     [verified("oscillating_drop, 3-d", "period", column) for column in ("default scheme", "expected", "as printed")]),
    ("README.md", r"drop of water on a wall \|[^|]*\| ([\d.]+) \| ([\d.]+)",
     [verified("dry_wall, water", "the same, fit by Lee et al."),
      verified("dry_wall, water", "the same, fit by Lee et al.", "expected")]),
    ("README.md", r"Couette flow \|[^|]*\| ([\d.]+) % \| *\| ([\d.]+) %",
     [verified("couette", "rms velocity error over U, largest of all times", column)
      for column in ("default scheme", "as printed")]),
    ("README.md", r"(\d+) of (\d+) judged figures", [judged(0), judged(1)]),
    ("README.md", r"1 process, default[^|]*\| ([\d.]+) \| ([\d.]+)",
     [speed("1", "us a particle and step"), speed("1", "iterations")]),
    ("README.md", r"2 processes[^|]*\| ([\d.]+) \| ([\d.]+)",
     [speed("2", "us a particle and step"), speed("2", "iterations")]),
    ("README.md", r"jacobi`[^|]*\| ([\d.]+) \| ([\d.]+)", [preconditioner("jacobi", 0), preconditioner("jacobi", 1)]),
    ("README.md", r"gamg`[^|]*\| ([\d.]+) \| ([\d.]+)", [preconditioner("gamg", 0), preconditioner("gamg", 1)]),
    ("README.md", r"a slow scene, [^|]*: (\d+) steps, ([\d.]+) s", [slow("steps"), slow("processor time")]),
    ("options/accurate.opts", r"Taylor-Green error ([\d.]+) times at ([\d.]+) times the CPU time",
     [choice("preset `accurate`", VORTICES, 0), choice("preset `accurate`", VORTICES, 1)]),
    ("options/accurate.opts", r"drop impact at 0\.7 mm ([\d.]+) times the error at ([\d.]+) times the time",
     [choice("preset `accurate`", IMPACT, 0), choice("preset `accurate`", IMPACT, 1)]),
    ("options/accurate.opts", r"spacing 0\.7 times as wide has ([\d.]+) times the error at ([\d.]+) times the time",
     [choice("finer", IMPACT, 0), choice("finer", IMPACT, 1)]),
]


def text_of(path):
    """What is compared of a document: README's sections, or the comments of a preset as one line."""
    text = read(path)
    if path.endswith(".opts"):
        return " ".join(line.strip("# \n") for line in text.splitlines() if line.startswith("#"))
    return "\n".join(text.split(title + "\n")[1].split("\n## ")[0] for title in SECTIONS)


def left_over(path, text):
    """Numbers that look like results."""
    if path.endswith(".opts"):
        return re.findall(r"\d[\d.]*(?= (?:%|times|uJ|Pa)|-fold)", text)
    return [number for line in text.splitlines() if line.startswith("|")
            for cell in line.split("|")[3:] for number in re.findall(r"\d[\d.]*", cell)]


def found(case):
    """Per cents that the gallery may quote of a case: figures of its results.md, and how far off they are."""
    for row in map(dict, tables(f"cases/{case}/results.md")):
        numbers = [re.match(r"-?\d\S*", row.get(column, "")) for column in ("default scheme", "expected")]
        measured, expected = (float(number[0]) if number else math.nan for number in numbers)
        yield measured if "%" in row.get("default scheme", "") else 100 * measured
        yield 100 * (measured / (expected or math.nan) - 1)


def gallery():
    """What the last column of cases/README.md quotes and the cases have not."""
    shown = re.findall(r"\[(\w+)\]\(\1/README\.md\):.*\|(.*)\|$", read("cases/README.md"), re.M)
    quoted = [(case, number) for case, cell in shown for number in re.findall(r"([\d.]+) %", cell)]
    return len(quoted), [
        f"cases/README.md: {number} % is not among the figures of {case}" for case, number in quoted
        if all(not abs(abs(value) - float(number)) <= 0.501 * 10.0 ** -len(number.partition(".")[2])
               for value in found(case))]


count, bad = gallery()
for document in ["README.md"] + [f"options/{preset}.opts" for preset in PRESETS]:
    text = text_of(document)
    for _, pattern, sources in (quoted for quoted in QUOTED if quoted[0] == document):
        match = re.search(pattern, text)
        if not match:
            bad.append(f"{document} has nothing like {pattern}; change tests/lint/figures.py with it")
            continue
        mended = match[0]
        for k, source in reversed(list(enumerate(sources, 1))):
            shown, figure = match[k], source()
            value = float(figure.split()[0])
            if text[match.end(k):].startswith(" %") and not figure.endswith("%"):
                value *= 100
            count += 1
            digits = len(shown.partition(".")[2])
            if abs(float(shown) - value) > 0.501 * 10.0 ** -digits:
                bad.append(f"{document}: {shown} in '{match[0]}' is {value:g} in the generated table")
                begin, end = (place - match.start() for place in match.span(k))
                mended = mended[:begin] + f"{value:.{digits}f}" + mended[end:]
        if "--mend" in sys.argv:
            whole = read(document)
            with open(os.path.join(ROOT, document), "w", encoding="utf-8") as file:
                file.write(whole.replace(match[0], mended))
        text = text[:match.start()] + re.sub(r"\d", "_", match[0]) + text[match.end():]
    bad += [f"{document}: tests/lint/figures.py does not know where {number} comes from"
            for number in left_over(document, text)]
verdict.end("figures", bad, f"{count} compared")
