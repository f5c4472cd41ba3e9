#!/usr/bin/python3
"""A scene with one or two of its options varied: a table of quantities, a CSV file and a page with curves and the
variants' pictures side by side.

    study.py SCENE.opts --vary "OPTION=VALUE;VALUE;... [OPTION=VALUE..VALUE/COUNT]" --quantity COLUMN:TAKE[,...]
             [--accuracy PER CENT --budget SECONDS] [--jobs N] [--output FOLDER]
    make study SCENE=my.opts VARY="drop_velocity=0,-1;0,-2;0,-3" QUANTITY=highest:max

Values are separated by semicolons; LOW..HIGH/COUNT are so many numbers at equal distances. Two options make all pairs.
With --accuracy each value is an answer with its error bar (answer.py), with the budget for each. What is there from an
earlier call is not run again, so a study that was stopped goes on.
"""
import argparse
import csv
import html
import itertools
import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "pictures"), os.path.join(HERE, "..", "python")]
import answer  # noqa: E402
import columns  # noqa: E402
import quantity  # noqa: E402
from isph import launch, tables  # noqa: E402


PICTURES = 3  # of each variant, at the times between which the first changes alike; the last is its end
SNAPSHOTS = 12  # of a run, from which they are chosen
WIDTH = 11.0  # inches, of the page's figures
TALLEST = 1.2  # a picture's height over its width
CUT = 0.3  # inches, of titles


def values_of(text):
    """The values of 'a;b;c' or 'low..high/count', as words."""
    if ".." not in text:
        return [word for word in text.split(";") if word]
    low, _, rest = text.partition("..")
    high, _, count = rest.partition("/")
    low, high = tables.number(low), tables.number(high)
    if not count.isdigit() or int(count) < 2 or not math.isfinite(low + high):
        raise tables.Error(f"VARY: {text}: a range is LOW..HIGH/COUNT, for instance 1e-3..4e-3/4.")
    return [f"{low + (high - low) * k / (int(count) - 1):.6g}" for k in range(int(count))]


def vary(text):
    """[(option, [values]), ...], one or two."""
    found = []
    for word in text.split():
        name, mark, rest = word.partition("=")
        values = values_of(rest)
        if not mark or not name or not values:
            raise tables.Error(f"VARY: {word}: OPTION=VALUE;VALUE is wanted, for instance drop_velocity=0,-1;0,-2.")
        found.append(("-" + name.lstrip("-"), values))
    if not 1 <= len(found) <= 2:
        raise tables.Error(f"VARY has {len(found)} options; one or two are wanted.")
    return found


class Row:
    """A variant: values of its options, found [(value, bar), ...], processor seconds or the reason why there is none,
    folder of the run that is shown."""

    def __init__(self, values, found, cost, folder):
        self.values, self.found, self.cost, self.folder = values, found, cost, folder

    def words(self, accuracy):
        """Those of its line in the table."""
        return [*self.values, *(f"{v:.6g}" for pair in self.found for v in (pair if accuracy else pair[:1])),
                f"{self.cost:.3g}" if isinstance(self.cost, float) else self.cost]


def answered(arguments, quantities, values, options, folder):
    """The row of a combination, as answers."""
    one = argparse.Namespace(**{**vars(arguments), "output": folder})
    asked, verdicts, _ = answer.ask(arguments.scene, quantities, one, options)
    return Row(values, [(v.value, v.bar) for v in verdicts], asked.spent, asked.rungs[-1][1][0].folder)


def study(arguments, quantities, varied):
    """The rows of all combinations."""
    names = [name for name, _ in varied]
    every = list(itertools.product(*(values for _, values in varied)))
    options = [[word for pair in zip(names, values) for word in pair] for values in every]
    folders = [os.path.join(arguments.output, "_".join(values).replace("/", "_")) for values in every]
    known = launch.known(arguments.scene, *options[0])
    for q in quantities:
        q.find(known["columns"])
    if known["time_end"] is not None:
        apart = ["-snapshot_interval", f"{(known['time_end'] - known['time_start']) / SNAPSHOTS:.9g}"]
        options = [one + apart for one in options]
    if arguments.accuracy:
        return [answered(arguments, quantities, *one) for one in zip(every, options, folders)]
    ends = quantity.ends(quantities, known)
    done = launch.together([launch.Run(arguments.scene, o + ends, f) for o, f in zip(options, folders)], arguments.jobs)
    return [Row(values, [(q.of(run.series) if run.series else math.nan, math.nan) for q in quantities],
                run.cpu if run.series else run.reason, run.folder if run.series else None)
            for values, run in zip(every, done)]


def axis_value(text, k):
    """A number for an axis: the length of a vector, the number itself, else the place in the list."""
    numbers = [tables.number(word) for word in text.split(",")]
    if len(numbers) == 1 and math.isfinite(numbers[0]):
        return numbers[0]
    return math.sqrt(sum(n * n for n in numbers)) if all(map(math.isfinite, numbers)) else k


def picture(rows, quantities, varied, unit, path):
    """The quantities over the first option, whose unit is given, a line for each value of the second."""
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, len(quantities), figsize=(5.5 * len(quantities), 4), squeeze=False,
                                constrained_layout=True)
    name, values = varied[0]
    others = varied[1][1] if len(varied) > 1 else [None]
    places = {value: axis_value(value, k) for k, value in enumerate(values)}
    much, handy = answer.scaled(places.values(), unit)
    for axis, (g, q) in zip(axes[0], enumerate(quantities)):
        factor, of = answer.scaled([row.found[g][0] for row in rows], q.unit())
        for other in others:
            here = [(much * places[row.values[0]], *row.found[g]) for row in rows
                    if other is None or row.values[1] == other]
            x, y, bars = zip(*here)
            bars = [factor * bar if math.isfinite(bar) else 0 for bar in bars]
            axis.errorbar(x, [factor * v for v in y], yerr=bars, fmt="o-", capsize=4, label=None if other is None else
                          f"{varied[1][0][1:]} {other}")
        axis.set(xlabel=f"{name[1:]} ({handy})" if handy else name[1:], ylabel=f"{q.text} ({of})" if of else q.text)
        if len(varied) > 1:
            axis.legend(fontsize=8)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def variants(rows, varied, path):
    """The variants side by side, a line of pictures for each, in one frame and scale; False: there is nothing to
    show."""
    import matplotlib.pyplot as plt
    import numpy as np
    import pictures
    import run as data
    import views
    shown = [(row, data.Run(row.folder)) for row in rows if row.folder]
    if not shown:
        return False
    times = [time for time, _ in shown[0][1].moments(count=PICTURES + 1)[1:]]
    states = [[run.read(file) for _, file in run.moments(times)] for _, run in shown]
    corners = [pictures.window(run, here) for (_, run), here in zip(shown, states)]
    lower, upper = (pick([corner[k] for corner in corners], axis=0) for k, pick in enumerate((np.min, np.max)))
    factor, unit = data.scale(upper[0] - lower[0])
    tall = min(TALLEST, (upper[1] - lower[1]) / (upper[0] - lower[0])) * WIDTH / PICTURES + CUT
    figure, axes = plt.subplots(len(shown), PICTURES, figsize=(WIDTH, tall * len(shown) + CUT), squeeze=False,
                                sharex=True, sharey=True, constrained_layout=True)
    for line, (row, run), here in zip(axes, shown, states):
        for panel, state in zip(line, here):
            views.section(panel, run, state, "body", None, factor)
            panel.set(xlim=(lower[0] * factor, upper[0] * factor), ylim=(lower[1] * factor, upper[1] * factor),
                      aspect="equal")
            panel.set_title(f"t = {data.duration(state.time)}", fontsize=8)
        line[0].set_ylabel("\n".join(f"{name[1:]} {value}" for (name, _), value in zip(varied, row.values)) +
                           f"\n{unit}", fontsize=8)
        for panel in line[len(here):]:
            panel.set_axis_off()
    figure.savefig(path, dpi=110)
    plt.close(figure)
    return True


def page(arguments, head, lines, shown):
    """study.html: the table, the curves and the variants' pictures."""
    cells = "".join(f"<tr>{''.join(f'<td>{html.escape(word)}</td>' for word in line)}</tr>\n" for line in lines)
    images = [("study.png", "the quantities over the option")] + [("variants.png", "the variants side by side")] * shown
    with open(os.path.join(arguments.output, "study.html"), "w", encoding="utf-8") as file:
        file.write(answer.STYLE.format("Study") + f"<h1>{html.escape(arguments.scene)}</h1>\n<table><tr>" +
                   "".join(f"<th>{html.escape(word)}</th>" for word in head) + f"</tr>\n{cells}</table>\n" +
                   "".join(f"<img src='{name}' alt='{words}'>\n" for name, words in images))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("scene", metavar="SCENE.opts")
    parser.add_argument("--vary", required=True)
    parser.add_argument("--quantity", required=True, help="COLUMN:TAKE, several separated by commas")
    parser.add_argument("--accuracy", type=float, default=0, help="per cent; 0: single runs without error bars")
    parser.add_argument("--budget", type=float, default=600, help="with --accuracy: seconds for each value")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)), help="runs side by side")
    parser.add_argument("--output", default="", help="folder, with one for these options in it; default: "
                        "output/study/<folder>_<file>")
    arguments = parser.parse_args()
    words = os.path.splitext(os.path.abspath(arguments.scene))[0].split(os.sep)
    arguments.output = arguments.output or os.path.join("output", "study", "_".join(words[-2:]))
    quantities, varied = quantity.read(arguments.quantity), vary(arguments.vary)
    arguments.output = os.path.join(arguments.output, "_".join(name[1:] for name, _ in varied))
    os.makedirs(arguments.output, exist_ok=True)
    import matplotlib
    matplotlib.use("Agg")
    rows = study(arguments, quantities, varied)
    head = [name[1:] for name, _ in varied]
    for q in quantities:
        head += [f"{q.text} ({q.unit()})" if q.unit() else q.text] + (["+-"] if arguments.accuracy else [])
    head, lines = head + ["seconds"], [row.words(arguments.accuracy) for row in rows]
    with open(os.path.join(arguments.output, "study.csv"), "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([head, *lines])
    print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for line in lines:
        print("| " + " | ".join(line) + " |")
    unit = next((option["unit"] for option in launch.known(arguments.scene, varied[0][0], varied[0][1][0])["options"]
                 if option["name"] == varied[0][0]), "")
    picture(rows, quantities, varied, unit, os.path.join(arguments.output, "study.png"))
    page(arguments, head, lines, variants(rows, varied, os.path.join(arguments.output, "variants.png")))
    print(f"{arguments.output}/study.html shows the variants side by side; study.csv has the table.")


if __name__ == "__main__":
    with tables.polite("study.py"):
        main()
