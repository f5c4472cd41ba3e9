#!/usr/bin/python3
"""A scene with one or two of its options varied: a table of quantities, a CSV file and a picture.

    study.py SCENE.opts --vary "OPTION=VALUE;VALUE;... [OPTION=VALUE..VALUE/COUNT]" --quantity COLUMN:TAKE[,...]
             [--accuracy PER CENT --budget SECONDS] [--jobs N] [--output FOLDER]
    make study SCENE=my.opts VARY="drop_velocity=0,-1;0,-2;0,-3" QUANTITY=highest:max

Values are separated by semicolons; LOW..HIGH/COUNT are so many numbers at equal distances. Two options make all pairs.
With --accuracy each value is an answer with its error bar (answer.py), with the budget for each. What is there from an
earlier call is not run again, so a study that was stopped goes on.
"""
import argparse
import csv
import itertools
import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "pictures")]
import answer  # noqa: E402
import launch  # noqa: E402
import quantity  # noqa: E402
import tables  # noqa: E402


def values_of(text):
    """The values of 'a;b;c' or 'low..high/count', as words."""
    if ".." not in text:
        return [word for word in text.split(";") if word]
    low, _, rest = text.partition("..")
    high, _, count = rest.partition("/")
    low, high = tables.number(low), tables.number(high)
    if not count.isdigit() or int(count) < 2 or not math.isfinite(low + high):
        raise tables.RunError(f"VARY: {text}: a range is LOW..HIGH/COUNT, for instance 1e-3..4e-3/4.")
    return [f"{low + (high - low) * k / (int(count) - 1):.6g}" for k in range(int(count))]


def vary(text):
    """[(option, [values]), ...], one or two."""
    found = []
    for word in text.split():
        name, mark, rest = word.partition("=")
        values = values_of(rest)
        if not mark or not name or not values:
            raise tables.RunError(f"VARY: {word}: OPTION=VALUE;VALUE is wanted, for instance drop_velocity=0,-1;0,-2.")
        found.append(("-" + name.lstrip("-"), values))
    if not 1 <= len(found) <= 2:
        raise tables.RunError(f"VARY has {len(found)} options; one or two are wanted.")
    return found


def answered(arguments, quantities, options, folder):
    """([(value, bar), ...], seconds) of a combination, as answers."""
    one = argparse.Namespace(**{**vars(arguments), "output": folder})
    asked = answer.Answer(arguments.scene, quantities, one, options)
    verdicts, _ = asked.climb()
    return [(v.value, v.bar) for v in verdicts], asked.spent


def study(arguments, quantities, varied):
    """[(values, [(value, bar), ...], seconds or reason), ...] of all combinations."""
    names = [name for name, _ in varied]
    every = list(itertools.product(*(values for _, values in varied)))
    options = [[word for pair in zip(names, values) for word in pair] for values in every]
    folders = [os.path.join(arguments.output, "_".join(values).replace("/", "_")) for values in every]
    known = launch.known(arguments.scene, *options[0])
    for q in quantities:
        q.find(known["columns"])
    if arguments.accuracy:
        return [(values, *answered(arguments, quantities, o, f)) for values, o, f in zip(every, options, folders)]
    ends = quantity.ends(quantities, known)
    done = launch.together([launch.Run(arguments.scene, o + ends, f) for o, f in zip(options, folders)], arguments.jobs)
    return [(values, [(q.of(run.series) if run.series else math.nan, math.nan) for q in quantities],
             run.cpu if run.series else run.reason) for values, run in zip(every, done)]


def axis_value(text, k):
    """A number for an axis: the length of a vector, the number itself, else the place in the list."""
    numbers = [tables.number(word) for word in text.split(",")]
    if len(numbers) == 1 and math.isfinite(numbers[0]):
        return numbers[0]
    return math.sqrt(sum(n * n for n in numbers)) if all(map(math.isfinite, numbers)) else k


def picture(rows, quantities, varied, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, len(quantities), figsize=(5.5 * len(quantities), 4), squeeze=False,
                                constrained_layout=True)
    name, values = varied[0]
    others = varied[1][1] if len(varied) > 1 else [None]
    for axis, (g, q) in zip(axes[0], enumerate(quantities)):
        factor, unit = answer.scaled([row[1][g][0] for row in rows], q.unit())
        for other in others:
            here = [(axis_value(row[0][0], values.index(row[0][0])), *row[1][g]) for row in rows
                    if other is None or row[0][1] == other]
            x, y, bars = zip(*here)
            bars = [factor * bar if math.isfinite(bar) else 0 for bar in bars]
            axis.errorbar(x, [factor * v for v in y], yerr=bars, fmt="o-", capsize=4, label=None if other is None else
                          f"{varied[1][0][1:]} {other}")
        axis.set(xlabel=name[1:], ylabel=f"{q.text} ({unit})" if unit else q.text)
        if len(varied) > 1:
            axis.legend(fontsize=8)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("scene", metavar="SCENE.opts")
    parser.add_argument("--vary", required=True)
    parser.add_argument("--quantity", required=True, help="COLUMN:TAKE, several separated by commas")
    parser.add_argument("--accuracy", type=float, default=0, help="per cent; 0: single runs without error bars")
    parser.add_argument("--budget", type=float, default=600, help="with --accuracy: seconds for each value")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs side by side")
    parser.add_argument("--output", default="", help="folder, with one for these options in it; default: "
                        "output/study/<folder>_<file>")
    arguments = parser.parse_args()
    words = os.path.splitext(os.path.abspath(arguments.scene))[0].split(os.sep)
    arguments.output = arguments.output or os.path.join("output", "study", "_".join(words[-2:]))
    quantities, varied = quantity.read(arguments.quantity), vary(arguments.vary)
    arguments.output = os.path.join(arguments.output, "_".join(name[1:] for name, _ in varied))
    os.makedirs(arguments.output, exist_ok=True)
    rows = study(arguments, quantities, varied)
    head = [name[1:] for name, _ in varied]
    for q in quantities:
        head += [f"{q.text} ({q.unit()})" if q.unit() else q.text] + (["+-"] if arguments.accuracy else [])
    lines = [[*values, *(f"{v:.6g}" for pair in found for v in (pair if arguments.accuracy else pair[:1])),
              f"{cost:.3g}" if isinstance(cost, float) else cost] for values, found, cost in rows]
    with open(os.path.join(arguments.output, "study.csv"), "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([[*head, "seconds"], *lines])
    print("| " + " | ".join([*head, "seconds"]) + " |\n|" + "---|" * (len(head) + 1))
    for line in lines:
        print("| " + " | ".join(line) + " |")
    picture(rows, quantities, varied, os.path.join(arguments.output, "study.png"))
    print(f"{arguments.output}/study.csv and study.png have it, too.")


if __name__ == "__main__":
    with tables.polite("study.py"):
        main()
