#!/usr/bin/python3
"""A value with its error: runs a scene at several spacings and packings until a quantity is known well enough.

    answer.py SCENE.opts --quantity COLUMN:TAKE[,...] [--accuracy 5] [--budget 600] [--jobs N] [--output FOLDER]
    make answer SCENE=my.opts QUANTITY=crater_depth:max ACCURACY=5 BUDGET=600

A scene in three dimensions that is a body of revolution is computed as rings, one with mirrors as a half or a quarter
(reduce.py). COLUMN is one of series.csv, TAKE one of max, min, end, time_of_max, at=TIME, mean=TIME,TIME (SI units). It
begins at coarse spacings, goes finer, and stops when the error of every quantity is at most ACCURACY per cent of it,
or when the next spacing would cost more than what is left of BUDGET (seconds of one core, all runs together). Prints
value, error by spacing, error by packing, and the command that reproduces the last run; FOLDER/answer.html has it with
pictures. A run that is there already, by the same command, is not run again.
"""
import argparse
import html
import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "pictures")]
import ladder  # noqa: E402
import launch  # noqa: E402
import quantity  # noqa: E402
import reduce  # noqa: E402
import tables  # noqa: E402

RATIO = math.sqrt(2)  # of two spacings that follow each other
COARSEST = 4  # the first spacing is RATIO**COARSEST times the scene's
FINEST = 6  # the last is the scene's over RATIO**FINEST
GROWTH = 4.0  # a finer run costs RATIO to this power, until two runs tell
PATIENCE, LEAST_PATIENCE = 5, 60  # times what a run should cost, by the clock; s
CHEAP = ((5, 0.05), (3, 0.2), (2, 0.5))  # so many packings, if together they cost at most this share of the budget


class Answer:
    """The runs of a scene. rungs: [(spacing, [Run, ...])], those that ended well."""

    def __init__(self, scene, quantities, arguments, options=()):
        """options: further ones, [word, ...], that all runs have."""
        self.scene, self.quantities, self.arguments, self.more = scene, quantities, arguments, list(options)
        self.folder = arguments.output
        os.makedirs(self.folder, exist_ok=True)
        self.options = launch.dumped(scene, self.folder, self.more)
        self.spacing = float(self.options["-spacing"])
        self.seed = int(float(self.options.get("-packing_seed", 1)))
        self.rungs, self.notes, self.spent, self.model = [], [], 0.0, ""

    def run(self, spacing, seeds):
        """The runs at a spacing that ended well."""
        together = [launch.Run(self.scene, self.more + ["-spacing", f"{spacing:.6g}", "-packing_seed", str(seed)],
                               os.path.join(self.folder, f"run_{spacing:.6g}_{seed}"), self.patience(spacing))
                    for seed in seeds]
        launch.together(together, self.arguments.jobs)
        good = [run for run in together if run.series]
        self.spent += sum(run.cpu for run in together)
        for run in together:
            if not run.series:
                self.notes.append(f"{launch.text_of(self.scene, run.options)}: {run.reason}")
        return good

    def patience(self, spacing):
        """Seconds after which a run at a spacing is given up: one that has a step of nothing never ends."""
        guess = self.guess(spacing)
        return PATIENCE * guess + LEAST_PATIENCE if math.isfinite(guess) else self.arguments.budget + LEAST_PATIENCE

    def guess(self, spacing):
        """What one run at a spacing will cost, s; nan: unknown."""
        if not self.rungs:
            return math.nan
        growth = GROWTH
        if len(self.rungs) > 1:
            (coarse, before), (fine, last) = ([(s, ladder.mean([run.cpu for run in runs]))
                                               for s, runs in self.rungs[-2:]])
            if before > 0.2:
                growth = min(max(math.log(last / before) / math.log(coarse / fine), 2.5), 6)
        spacing_now, runs = self.rungs[-1]
        return ladder.mean([run.cpu for run in runs]) * (spacing_now / spacing)**growth

    def verdicts(self):
        return [ladder.Verdict([(spacing, [q.of(run.series) for run in runs]) for spacing, runs in self.rungs])
                for q in self.quantities]

    def enough(self, verdicts):
        return all(v.bar <= self.arguments.accuracy / 100 * abs(v.value) for v in verdicts)

    def more_packings(self, verdicts):
        """Whether chance is the larger error, and packings at this spacing are cheaper than a finer spacing."""
        spacing, runs = self.rungs[-1]
        one = ladder.mean([run.cpu for run in runs])
        wide = any(v.chance > v.spacing and v.bar > self.arguments.accuracy / 100 * abs(v.value) for v in verdicts)
        return wide and len(runs) < 8 and self.spent + len(runs) * one <= self.arguments.budget \
            and len(runs) * one < self.guess(spacing / RATIO)

    def climb(self):
        """Runs the ladder; returns the verdicts and the sentence that says why it ended."""
        budget, verdicts, step = self.arguments.budget, None, -COARSEST
        while step <= FINEST:
            spacing = self.spacing * RATIO**-step
            cost = self.guess(spacing)
            if self.rungs and self.spent + cost > budget:
                return verdicts, f"the next spacing, {spacing:.3g} m, would cost some {cost:.0f} s"
            count = 3 if not self.rungs else next((n for n, share in CHEAP if n * cost <= share * budget), 1)
            good = self.run(spacing, range(self.seed, self.seed + count))
            step += 1
            if not good:
                if self.rungs:
                    return verdicts, f"at {spacing:.3g} m no run ended: {self.notes[-1]}"
                continue  # too coarse for the scene
            self.rungs.append((spacing, good))
            verdicts = self.verdicts()
            self.say(spacing, verdicts)
            while self.more_packings(verdicts):
                runs = self.rungs[-1][1]
                first = self.seed + len(runs)
                more = self.run(spacing, range(first, first + len(runs)))
                if not more:
                    break
                runs += more
                verdicts = self.verdicts()
                self.say(spacing, verdicts)
            if len(self.rungs) > 2 and self.enough(verdicts):
                return verdicts, ""
        if not self.rungs:
            raise tables.RunError(f"no run ended: {self.notes[-1]}")
        return verdicts, "the finest spacing that is tried has been reached"

    def say(self, spacing, verdicts):
        runs = self.rungs[-1][1]
        values = ", ".join(f"{q.text} {v.value:.4g} +- {v.bar:.2g}" for q, v in zip(self.quantities, verdicts))
        print(f"{spacing:.3g} m, {len(runs)} packings, {self.spent:.0f} s so far: {values}", flush=True)


def finest(scene, folder):
    """The options of the finest run, at which the model must hold."""
    os.makedirs(folder, exist_ok=True)
    return ["-spacing", f"{float(launch.dumped(scene, folder)['-spacing']) * RATIO**-FINEST:.6g}"]


def model(scene, folder):
    """(path of the cheapest model of a scene, what it is): the reduced scene, or the scene itself."""
    try:
        text, why = reduce.text(scene, finest(scene, folder))
    except tables.RunError as error:
        return scene, f"the scene as it is: {error}"
    path = os.path.join(folder, "reduced.opts")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path, why


def confidence(verdict, accuracy):
    """In words."""
    if not math.isfinite(verdict.bar):
        return "none: too few runs"
    if verdict.bar > accuracy / 100 * abs(verdict.value):
        return "low: " + verdict.words
    if verdict.order > 0.5 or "no more than packings" in verdict.words:
        return "good: " + verdict.words
    return "fair: " + verdict.words


def report(answer, verdicts, why):
    """The lines of the answer."""
    lines = []
    for q, v in zip(answer.quantities, verdicts):
        share = 100 * v.bar / abs(v.value) if v.value else math.inf
        met = "" if share <= answer.arguments.accuracy else f"not converged to {answer.arguments.accuracy:g} %: "
        lines.append(f"{q.text} = {met}{v.value:.5g} +- {v.bar:.2g} {q.unit()} ({share:.2g} %): {v.spacing:.2g} by the "
                     f"spacing, {v.chance:.2g} by the packing. Confidence {confidence(v, answer.arguments.accuracy)}.")
    spacing, runs = answer.rungs[-1]
    lines.append(f"Price: {answer.spent:.0f} s for {sum(len(r) for _, r in answer.rungs)} runs; the last took "
                 f"{runs[-1].cpu:.3g} s. {('It ended because ' + why + '.') if why else ''}".rstrip())
    lines.append(f"Model: {answer.model}")
    lines.append(f"The last run: {launch.text_of(answer.scene, runs[0].options)}")
    lines += [f"A run failed: {note}" for note in answer.notes]
    return lines


def picture(answer, verdicts, path):
    """Curves of each quantity's column at all spacings, and its value over the spacing."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(len(answer.quantities), 2, figsize=(11, 3.6 * len(answer.quantities)), squeeze=False,
                                constrained_layout=True)
    shades = plt.get_cmap("viridis")
    for (left, right), q, v in zip(axes, answer.quantities, verdicts):
        for k, (spacing, runs) in enumerate(answer.rungs):
            color = shades(0.9 - 0.9 * k / max(1, len(answer.rungs) - 1))
            for run in runs:
                left.plot(run.series["time"], run.series[q.column], color=color, linewidth=0.9,
                          label=f"{spacing:.3g} m" if run is runs[0] else None)
            right.plot([spacing] * len(runs), [q.of(run.series) for run in runs], "o", color=color, markersize=4)
        finest = answer.rungs[-1][0]
        right.errorbar([0.93 * finest], [v.value], yerr=[v.bar if math.isfinite(v.bar) else 0], fmt="ks", capsize=5)
        right.set(xscale="log", xlabel="spacing (m)", title=f"{q.text}: {v.value:.4g} +- {v.bar:.2g}")
        left.set(xlabel="time (s)", ylabel=tables_label(q))
        left.legend(fontsize=7)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def tables_label(q):
    unit = tables.UNITS.get(q.column)
    return f"{q.column} ({unit})" if unit else q.column


def page(answer, verdicts, lines, path):
    """answer.html: the answer, its picture and the table of all runs."""
    picture(answer, verdicts, os.path.join(os.path.dirname(path), "answer.png"))
    head = "".join(f"<th>{html.escape(q.text)}</th>" for q in answer.quantities)
    rows = "".join(f"<tr><td>{spacing:.4g}</td><td>{run.options[-1]}</td><td>{run.cpu:.3g}</td>" +
                   "".join(f"<td>{q.of(run.series):.5g}</td>" for q in answer.quantities) + "</tr>\n"
                   for spacing, runs in answer.rungs for run in runs)
    with open(path, "w", encoding="utf-8") as file:
        file.write("<!doctype html><meta charset='utf-8'><title>Answer</title><style>body{font:15px sans-serif;"
                   "max-width:64em;margin:2em auto;padding:0 1em}td,th{padding:.15em .8em;text-align:right}"
                   "img{max-width:100%}</style>\n" + f"<h1>{html.escape(answer.scene)}</h1>\n" +
                   "".join(f"<p>{html.escape(line)}</p>\n" for line in lines) +
                   "<img src='answer.png' alt='curves at all spacings, and the values over the spacing'>\n"
                   f"<table><tr><th>spacing, m</th><th>packing</th><th>seconds</th>{head}</tr>\n{rows}</table>\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("scene", metavar="SCENE.opts")
    parser.add_argument("--quantity", required=True, help="COLUMN:TAKE, several separated by commas")
    parser.add_argument("--accuracy", type=float, default=5, help="per cent of each quantity")
    parser.add_argument("--budget", type=float, default=600, help="seconds of one core, all runs together")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs side by side")
    parser.add_argument("--whole", action="store_true", help="the scene as it is, even where rings or a part would do")
    parser.add_argument("--output", default="", help="folder; default: output/answer/<folder>_<file>")
    arguments = parser.parse_args()
    for name, value in (("ACCURACY", arguments.accuracy), ("BUDGET", arguments.budget)):
        if not 0 < value < math.inf:
            raise tables.RunError(f"{name}={value:g}: a positive number is wanted.")
    words = os.path.splitext(os.path.abspath(arguments.scene))[0].split(os.sep)
    arguments.output = arguments.output or os.path.join("output", "answer", "_".join(words[-2:]))
    quantities = quantity.read(arguments.quantity)
    if not quantities:
        raise tables.RunError("QUANTITY names nothing: a column of series.csv is wanted, for instance highest:max.")
    scene, words = (arguments.scene, "the scene as it is") if arguments.whole else model(arguments.scene,
                                                                                        arguments.output)
    print(f"Model: {words}")
    answer = Answer(scene, quantities, arguments)
    answer.model = words
    verdicts, why = answer.climb()
    lines = report(answer, verdicts, why)
    print("\n" + "\n".join(lines))
    page(answer, verdicts, lines, os.path.join(answer.folder, "answer.html"))
    print(f"{os.path.join(answer.folder, 'answer.html')} shows ladder and curves.")


if __name__ == "__main__":
    with tables.polite("answer.py"):
        main()
