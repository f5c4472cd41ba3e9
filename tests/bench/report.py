"""Tables and chart of bench.csv."""
import csv
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, ".."))
import roofline  # noqa: E402
import runs  # noqa: E402

OWN, TOLERANCE = "twolevel", 1e-4


def value(text):
    """A cell: its number, if it is one."""
    try:
        return float(text)
    except ValueError:
        return text


def load(path):
    """Rows of a table, numbers as numbers."""
    with open(path, encoding="utf-8") as file:
        return [{key: value(text) for key, text in row.items()} for row in csv.DictReader(file)]


def save(path, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def grid(titles, rows):
    """Lines of a table in Markdown."""
    return ["| " + " | ".join(cells) + " |" for cells in (titles, ["---"] * len(titles), *rows)]


def pick(rows, **wanted):
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def speed_table(rows):
    """Own preconditioner: sizes, states, ranks."""
    titles = ("particles", "state", "ranks", "us a particle and step", "iterations", "memory", "triad",
              "share of its limit")
    lines = ["| " + " | ".join(titles) + " |", "| --- " * len(titles) + "|"]
    for row in pick(rows, solver=OWN, tolerance=TOLERANCE):
        lines.append(f"| {row['particles']:.0f} | {row['state']} | {row['ranks']:.0f} | {row['step']:.2f} | "
                     f"{row['iterations']:.1f} | {row['memory']:.0f} MB | {row['triad']:.1f} GB/s | "
                     f"{100 * row['share']:.0f} % |")
    return lines


def compared_size(rows):
    """The largest of the sizes with the most preconditioners."""
    sizes = dict.fromkeys(row["size"] for row in rows)
    return max(reversed(sizes), key=lambda size: len({row["solver"] for row in pick(rows, size=size)}))


def solver_table(rows):
    """Preconditioners on one rank: step and iterations in each state."""
    size = compared_size(rows)
    rows = pick(rows, size=size, ranks=1, tolerance=TOLERANCE)
    kinds = list(dict.fromkeys(row["state"] for row in rows))
    lines = [f"| {size}, 1 rank | " + " | ".join(f"{state}: us, iterations" for state in kinds) + " | set-up, us |",
             "| --- " * (len(kinds) + 2) + "|"]
    for solver in dict.fromkeys(row["solver"] for row in rows):
        cells = [", ".join(f"{row['step']:.2f}, {row['iterations']:.1f}" for row in
                           pick(rows, solver=solver, state=state)) for state in kinds]
        last = pick(rows, solver=solver)[-1]["setup"]
        lines.append(f"| {solver} | " + " | ".join(cells) + f" | {last:.2f} |")
    return lines


def event_table(rows):
    """Where the time of the own preconditioner goes, and its bounds: largest size, one rank, last state."""
    return roofline.table(pick(rows, solver=OWN, tolerance=TOLERANCE, ranks=1)[-1])


def tolerance_table(rows):
    """Iterations of the own preconditioner over sizes."""
    own = pick(rows, solver=OWN, ranks=1)
    tolerances = sorted({row["tolerance"] for row in own}, reverse=True)
    lines = ["| 1 rank | " + " | ".join(f"{t:g}: us, iterations" for t in tolerances) + " |",
             "| --- " * (len(tolerances) + 1) + "|"]
    for size, state in dict.fromkeys((row["size"], row["state"]) for row in own):
        cells = [", ".join(f"{row['step']:.2f}, {row['iterations']:.1f}" for row in
                           pick(own, size=size, state=state, tolerance=t)) for t in tolerances]
        lines.append(f"| {size}, {state} | " + " | ".join(cells) + " |")
    return lines


def sections(path):
    """{marker in the README: text}"""
    rows = load(path)
    return {"bench": "\n\n".join("\n".join(make(rows)) for make in (speed_table, tolerance_table, solver_table)) + "\n",
            "roofline": "\n".join(event_table(rows)) + "\n"}


def markdown(path, target):
    with open(target, "w", encoding="utf-8") as file:
        file.write("\n".join(sections(path).values()))


def insert(marker, text):
    """Puts a text into the README beside this file."""
    runs.replace(os.path.join(HERE, "README.md"), marker, "\n" + text)


def readme(path):
    for marker, text in sections(path).items():
        insert(marker, text)


def chart(path, target, events):
    """Left: where the step's time goes, by size and ranks; right: the preconditioners."""
    rows = load(path)
    own = pick(rows, solver=OWN, tolerance=TOLERANCE)
    figure, (left, right) = plt.subplots(1, 2, figsize=(13, 5))
    labels = [f"{row['size']}\n{row['state']}\n{row['ranks']:.0f}" for row in own]
    below = [0.0] * len(own)
    for event in events:
        heights = [row[event] for row in own]
        left.bar(range(len(own)), heights, bottom=below, label=event)
        below = [a + b for a, b in zip(below, heights)]
    left.set_xticks(range(len(own)), labels, fontsize=7)
    left.set_ylabel("us a particle and step")
    left.legend(fontsize=7, ncol=2)
    size = compared_size(rows)
    compared = pick(rows, size=size, ranks=1, tolerance=TOLERANCE)
    kinds = list(dict.fromkeys(row["state"] for row in compared))
    solvers = list(dict.fromkeys(row["solver"] for row in compared))
    for k, state in enumerate(kinds):
        chosen = pick(compared, state=state)
        places = [solvers.index(row["solver"]) + 0.27 * (k - 1) for row in chosen]
        right.bar(places, [row["step"] for row in chosen], width=0.25, label=state)
        for place, row in zip(places, chosen):
            right.text(place, row["step"], f"{row['iterations']:.0f}", ha="center", va="bottom", fontsize=7)
    right.set_xticks(range(len(solvers)), solvers)
    right.set_ylabel(f"us a particle and step, {size}, 1 rank; above: iterations")
    right.legend()
    figure.tight_layout()
    figure.savefig(target, dpi=110)
