#!/usr/bin/python3
"""A value with its error: runs a scene at several spacings and packings until a quantity is known well enough.

    answer.py SCENE.opts --quantity COLUMN:TAKE[,...] [--accuracy 5] [--budget 600] [--jobs N] [--output FOLDER]
    make answer SCENE=my.opts QUANTITY=crater_depth:max ACCURACY=5 BUDGET=600

A scene that is a body of revolution is computed as rings, one with mirrors as a half or a quarter, if its columns can
be carried back (reduce.py) and if the whole scene at a coarse spacing gives the same (Proof). COLUMN is one of
series.csv, TAKE one of max, min, end, rest, time_of_max, at=TIME, mean=TIME,TIME, settles=PER CENT (SI units). Where
only ends are asked, runs end at rest (-stop_at_rest). It begins at coarse spacings, goes finer, and stops when the
error of every quantity is at most ACCURACY per cent of it (of a temperature, of the range in the liquid), or when the
next spacing would cost more than what is left of BUDGET (seconds of one core, all runs together). Where two spacings
will not do, the same two with a spacing that follows the liquid tell which way gives more accuracy in the time that is
left (grading.py). Runs end when no quantity can change any more: of a maximum, when two coarser spacings have shown
that it has passed. A single run is divided among the cores that are free. Prints value, error by spacing, error by
packing, and the command that reproduces the last run; FOLDER/answer.html has it with pictures, answer.csv the values,
answer.json the choice of the spacing. A run that is there already, by the same command, is not run again.
"""
import argparse
import csv
import html
import json
import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "pictures"), os.path.join(HERE, "..", "python")]
import columns  # noqa: E402
import grading  # noqa: E402
import ladder  # noqa: E402
import quantity  # noqa: E402
import reduce  # noqa: E402
from isph import launch, tables  # noqa: E402

RATIO = ladder.RATIO
COARSEST, START = 4, 2  # the first spacing is the scene's times RATIO to a power from -START to COARSEST, where
ACROSS = 12  # spacings or some more are across the smallest body: coarser ones only widen the bar
FINEST = 6  # the last is the scene's over RATIO**FINEST
GROWTH = 4.0  # a finer run costs RATIO to this power, until two runs tell
PATIENCE, LEAST_PATIENCE = 5, 60  # times what a run should cost; s
FIRST, DEAR = 3, 0.1  # packings of the first spacing, for at most this share of the budget if its price is known
CHEAP = ((FIRST, 0.2), (2, 0.5))  # so many packings, if together they cost at most this share of the budget
CHANCE = 0.5  # of the accuracy, that chance may have
PROOF_ACROSS = 8  # there whole and reduced scene are compared
PROOF = 0.1  # of the budget, for the whole scene there
ALIKE = 0.1  # relative difference of two models at a coarse spacing that is not the model's
PAIR = 2  # packings of each
ROUNDING = 1e-9  # of a number of steps
SPLIT = 10  # s of a run, from which it is divided among cores that are free
LEAST_SHARE = 0.05  # of the run, that the comparison must reach


STYLE = ("<!doctype html><meta charset='utf-8'><title>{}</title><style>body{{font:15px sans-serif;max-width:64em;"
         "margin:2em auto;padding:0 1em}}td,th{{padding:.15em .8em;text-align:right}}img{{max-width:100%}}</style>\n")


def coarseness(known, across):
    """How many times RATIO the spacing may be coarser for so many across the smallest body; at most COARSEST."""
    here = min((body["spacings"] for body in known["bodies"]), default=across)
    return min(math.floor(math.log(here / across, RATIO) + ROUNDING), COARSEST)


class Answer:
    """The runs of a scene. rungs: [(spacing, [Run, ...])], those that ended well."""

    def __init__(self, scene, quantities, arguments, options=(), way=grading.UNIFORM):
        """options: further ones, [word, ...], that all runs have; way: of the spacing (grading.py)."""
        self.scene, self.quantities, self.arguments, self.more = scene, quantities, arguments, list(options)
        self.way, self.choice = way, None
        self.step, self.tried = None, 0  # the next of the ladder; packings of the last, those that failed among them
        self.folder = arguments.output
        os.makedirs(self.folder, exist_ok=True)
        known = launch.known(scene, *self.more)
        self.spacing, self.seed = known["domain"]["spacing"], seed_of(known)
        self.coarser, self.price = coarseness(known, ACROSS), None
        if not all(q.row for q in quantities):
            for q in quantities:
                q.find(known["columns"])
        self.more, self.end = self.more + quantity.ends(quantities, known), known["time_end"]
        self.until = self.needed_time(None)
        self.rungs, self.notes, self.spent, self.model, self.doubt = [], [], 0.0, "", ""

    def run(self, spacing, seeds):
        """The runs at a spacing that ended well."""
        more = self.more + (["-time_end", f"{self.until:.6g}"] if self.shorter() else [])
        more += grading.options(self.way, spacing)
        name = "run" if self.way == grading.UNIFORM else self.way
        together = [launch.Run(self.scene, more + ["-spacing", f"{spacing:.6g}", "-packing_seed", str(seed)],
                               os.path.join(self.folder, f"{name}_{spacing:.6g}_{seed}"), self.patience(spacing))
                    for seed in seeds]
        launch.together(together, self.arguments.jobs, self.ranks(spacing, len(together)))
        good = [run for run in together if run.series]
        self.spent += sum(run.cpu for run in together)
        if good and self.shorter() and self.needed_time(good) == math.inf:  # at this spacing it comes later
            self.until = math.inf
            return self.run(spacing, seeds)
        for run in together:
            if not run.series:
                self.notes.append(f"{launch.text_of(self.scene, run.options)}: {run.reason}")
        return good

    def needed_time(self, runs):
        """The time until which runs tell the quantities, by those at a spacing; None: before any."""
        return max(q.needs(run.series if run else None) for q in self.quantities for run in runs or [None])

    def shorter(self):
        return self.end is not None and self.until < self.end * (1 - 1e-9)

    def ranks(self, spacing, count):
        """On how many ranks each of so many runs goes: more than one where cores are free."""
        free = all(run.alone() for _, runs in self.rungs[-1:] for run in runs)
        return max(1, self.arguments.jobs // count) if free and self.guess(spacing) > SPLIT else 1

    def patience(self, spacing):
        """Seconds after which a run at a spacing is given up: one that has a step of nothing never ends."""
        guess = self.guess(spacing)
        return PATIENCE * guess + LEAST_PATIENCE if math.isfinite(guess) else self.arguments.budget + LEAST_PATIENCE

    def guess(self, spacing):
        """What one run at a spacing will cost, s; nan: unknown."""
        if not self.rungs:
            return self.price[1] * (self.price[0] / spacing)**GROWTH if self.price else math.nan
        spacing_now, runs = self.rungs[-1]
        return ladder.mean([run.cpu for run in runs]) * (spacing_now / spacing)**self.growth()

    def growth(self):
        """A finer run costs the ratio of the spacings to this power."""
        if len(self.rungs) > 1:
            (coarse, before), (fine, last) = ([(s, ladder.mean([run.cpu for run in runs]))
                                               for s, runs in self.rungs[-2:]])
            if before > 0.2:
                return min(max(math.log(last / before) / math.log(coarse / fine), 2.5), 6)
        return GROWTH

    def left(self):
        """Seconds of the budget."""
        return self.arguments.budget - self.spent

    def verdicts(self):
        return [ladder.Verdict([(spacing, [q.of(run.series) for run in runs]) for spacing, runs in self.rungs],
                               q.size(self.rungs[-1][1][0].series)) for q in self.quantities]

    def enough(self, verdicts):
        return all(v.share <= self.arguments.accuracy for v in verdicts)

    def needed(self, verdicts, cost):
        """How many packings a spacing begins with: the first two have several, to tell how large chance is, the second
        as many as chance needs to be CHANCE of the accuracy, if the budget bears them; the others have one, and more
        where chance is the larger error (more_packings)."""
        if not self.rungs:
            return FIRST
        if len(self.rungs) > 1:
            return 1
        one = [v.chance * math.sqrt(len(self.rungs[-1][1])) for v in verdicts]
        wanted = [CHANCE * self.arguments.accuracy / 100 * v.size for v in verdicts]
        many = max((c / w)**2 if w > 0 else math.inf for c, w in zip(one, wanted))
        return min(max(2, math.ceil(min(many, FIRST) - ROUNDING)), next(
            (n for n, share in CHEAP if n * cost <= share * self.arguments.budget), 1))

    def more_packings(self, verdicts):
        """Whether chance is the larger error, and packings at this spacing are cheaper than a finer spacing."""
        spacing, runs = self.rungs[-1]
        one = ladder.mean([run.cpu for run in runs])
        wide = any(v.chance > v.spacing and v.share > self.arguments.accuracy for v in verdicts)
        return wide and len(runs) < 8 and self.spent + len(runs) * one <= self.arguments.budget \
            and len(runs) * one < self.guess(spacing / RATIO)

    def first(self):
        """The step at which the ladder begins: finer than the scene only where a price is known and low."""
        step = min(-self.coarser, START if self.price else 0)
        while step > -COARSEST and FIRST * self.guess(self.spacing * RATIO**-step) > DEAR * self.arguments.budget:
            step -= 1
        return step

    def settle(self):
        """More packings at the finest spacing while chance is the larger error; returns the verdicts."""
        verdicts = self.verdicts()
        while self.more_packings(verdicts):
            runs, first = self.rungs[-1][1], self.seed + self.tried
            self.tried += len(runs)
            more = self.run(self.rungs[-1][0], range(first, self.seed + self.tried))
            if not more:
                break
            runs += more
            verdicts = self.verdicts()
            self.say(verdicts)
        return verdicts

    def climb(self, most=math.inf):
        """Runs the ladder on, up to so many spacings; returns the verdicts and the sentence that says why it ended;
        None: it has not."""
        self.step = self.first() if self.step is None else self.step
        while True:
            verdicts = self.settle() if self.rungs else None
            if len(self.rungs) > 2 and self.enough(verdicts):
                return verdicts, ""
            if len(self.rungs) > 1:
                self.until = max(self.needed_time(runs) for _, runs in self.rungs[-2:])
            if self.step > FINEST:
                break
            spacing = self.spacing * RATIO**-self.step
            cost = self.guess(spacing)
            if self.rungs and cost > self.left():
                return verdicts, f"the next spacing, {spacing:.3g} m, would cost some {cost:.0f} s"
            self.tried = self.needed(verdicts, cost)
            good = self.run(spacing, range(self.seed, self.seed + self.tried))
            self.step += 1
            if good:
                self.rungs.append((spacing, good))
                self.say(self.verdicts())
                if len(self.rungs) == most:
                    return self.verdicts(), None
            elif self.rungs:
                return verdicts, f"at {spacing:.3g} m no run ended: {self.notes[-1]}"  # else too coarse for the scene
        if not self.rungs:
            raise tables.Error(f"no run ended: {self.notes[-1]}")
        return verdicts, "the finest spacing that is tried has been reached"

    def say(self, verdicts):
        spacing, runs = self.rungs[-1]
        values = ", ".join(f"{q.text} {v.value:.4g} +- {v.bar:.2g}" for q, v in zip(self.quantities, verdicts))
        print(f"{spacing:.3g} m, {len(runs)} packings, {self.spent:.0f} s so far: {values}", flush=True)


def ask(scene, quantities, arguments, options=(), proof=None):
    """(the Answer that went on, its verdicts, why it ended): with one spacing, or with one that follows the liquid."""
    uniform, following = (Answer(scene, quantities, arguments, options, way)
                          for way in (grading.UNIFORM, grading.FOLLOWING))
    if proof:
        uniform.spent, uniform.price = proof.spent, proof.price
    verdicts, why = uniform.climb(grading.LEVELS)
    if why is not None:
        uniform.choice = grading.Choice(grading.UNIFORM, f"the first {len(uniform.rungs)} spacings end it")
        return uniform, verdicts, why
    before, choice = uniform.verdicts(), grading.choose(uniform, following)
    print(f"Spacing: {choice.words()}", flush=True)
    found = following if choice.way == grading.FOLLOWING else uniform
    found.step, found.choice = uniform.step, choice
    verdicts, why = found.climb()
    if found is following:
        found.doubt = grading.doubt(quantities, before, verdicts)
    return found, verdicts, why


def seed_of(known):
    return next((int(float(option["value"])) for option in known["options"]
                 if option["name"].lstrip("-") == "packing_seed"), 1)


def write(path, way, scene):
    with open(path, "w", encoding="utf-8") as file:
        file.write(reduce.text(scene, way))
    return path


class Proof:
    """The whole scene beside its reduced ones, at a coarse spacing and for a time that is cheap. spent: processor s."""

    def __init__(self, scene, quantities, arguments, known):
        self.scene, self.quantities, self.arguments, self.known = scene, quantities, arguments, known
        self.spacing = known["domain"]["spacing"] * RATIO**max(0, coarseness(known, PROOF_ACROSS))
        self.start, self.end, self.spent, self.whole = known["time_start"], known["time_end"], 0.0, None
        self.price = None  # (spacing, s of a run there) of the reduced scene

    def pair(self, scene, name, more, share=1.0):
        """Runs of a scene with PAIR packings, of at most this share of the budget each."""
        return [launch.Run(scene, more + ["-spacing", f"{self.spacing:.6g}", "-packing_seed",
                                          str(seed_of(self.known) + k)],
                           os.path.join(self.arguments.output, "proof", f"{name}_{k}"), share * self.arguments.budget)
                for k in range(PAIR)]

    def go(self, made):
        """The runs that ended well; else the reason."""
        launch.together(made, self.arguments.jobs)
        self.spent += sum(run.cpu for run in made)
        return [run for run in made if run.series], next((run.reason for run in made if run.reason), "")

    def reduced(self, path):
        """The runs of the reduced scene, or the reason. Where cores are free the whole scene runs beside them, to its
        end, unless that takes more than its share of the budget."""
        made, beside = self.pair(path, "reduced", quantity.ends(self.quantities, self.known)), []
        if self.whole is None and self.arguments.jobs >= 2 * PAIR:
            beside = self.pair(self.scene, "whole", [], PROOF / PAIR)
        good, why = self.go(made + beside)
        if beside and all(run.series for run in beside):
            self.whole = beside, self.end
        return [run for run in good if run in made], why

    def short(self, way, made):
        """The time until which the whole scene is run: that of the scene, unless it costs more than PROOF of the
        budget; or why it is not run."""
        if self.end is None:
            return self.end, ""
        cost = PAIR * ladder.mean([run.cpu for run in made]) * max(1, way.cheaper)
        share = min(1, PROOF * self.arguments.budget / max(cost, 1e-9))
        if share < LEAST_SHARE:
            return None, f"not proved: the whole scene would cost some {cost:.0f} s at {self.spacing:.3g} m"
        return self.start + share * (self.end - self.start), ""

    def judge(self, way, path):
        """(whether the reduced scene gives what the whole does, in words)."""
        part, why = self.reduced(path)
        if not part:
            return False, f"the reduced scene does not run at {self.spacing:.3g} m: {why}"
        self.price = self.spacing, ladder.mean([run.cpu for run in part])
        end, why = self.short(way, part) if self.whole is None or self.whole[1] != self.end else (self.end, "")
        if why:
            return None, why
        if self.whole is None or self.whole[1] != end:
            until = ["-time_end", f"{end:.9g}"] if end is not None else []
            self.whole = self.go(self.pair(self.scene, "whole", until))[0], end
        whole = self.whole[0]
        if not whole:
            return None, f"not proved: the whole scene does not run at {self.spacing:.3g} m"
        until, said, good = math.inf if end is None else end, [], True
        for q in self.quantities:
            back, q.back = q.back, (q.row["name"], 1.0)
            right = [q.of(run.series, until) for run in whole]
            q.back = back
            found = [q.of(run.series, until) for run in part]
            off = abs(ladder.mean(right) - ladder.mean(found))
            chance = math.hypot(*(2 * ladder.deviation(v) / math.sqrt(PAIR) for v in (right, found)))
            alike = off <= math.hypot(chance, ALIKE * max(map(abs, right))) or not math.isfinite(off) and all(
                math.isnan(v) for v in right + found)
            good = good and alike
            said.append(f"{q.text} {ladder.mean(right):.4g} and {ladder.mean(found):.4g} {q.unit()}")
        words = f"whole and reduced {'agree' if good else 'differ'} at {self.spacing:.3g} m" + (
            f" until {end:.3g} s" if end != self.end else "") + f": {', '.join(said)}"
        return good, words


def model(scene, quantities, arguments):
    """(path of the cheapest model of a scene that gives what the whole does, what it is, the Proof, doubt)."""
    known = launch.known(scene)
    for q in quantities:
        q.find(known["columns"])
    finest = ["-spacing", f"{known['domain']['spacing'] * RATIO**-FINEST:.6g}"]
    notes, proof = [], Proof(scene, quantities, arguments, known)
    try:
        for k, (way, note) in enumerate(reduce.ways(scene, finest, [q.row["name"] for q in quantities])):
            if not way:
                notes.append(note)
                continue
            path = os.path.join(arguments.output, f"reduced_{k}.opts")  # each way its own: runs are known by it
            for q in quantities:
                q.back = way.carry(q.row)
            good, words = proof.judge(way, write(path, way, scene))
            if good is not False:
                words += "".join(f"; {q.text} is {q.back[1]:.4g} times {q.back[0]}" for q in quantities
                                 if q.back[1] != 1)
                more = f" ({'; '.join(notes)})" if notes else ""
                return path, f"{way.why}; {words}{more}", proof, "" if good else words
            notes.append(f"{way.why.partition(';')[0].partition(':')[0]}: {words}")
    except tables.Error as error:
        notes.append(str(error))
    for q in quantities:
        q.back = (q.row["name"], 1.0)
    proof.price = None
    return scene, "the scene as it is" + (f": {'; '.join(notes)}" if notes else ""), proof, ""


def confidence(verdict, accuracy, doubt=""):
    """In words. An order far above two is chance."""
    if doubt:
        return "fair: " + doubt
    if not math.isfinite(verdict.bar):
        return "none: " + verdict.words
    if verdict.share > accuracy:
        return "low: " + verdict.words
    if 0.5 < verdict.order < 4 or "no more than packings" in verdict.words:
        return "good: " + verdict.words
    return "fair: " + verdict.words


def report(answer, verdicts, why):
    """The lines of the answer."""
    lines = []
    for q, v in zip(answer.quantities, verdicts):
        met = "" if v.share <= answer.arguments.accuracy else f"not converged to {answer.arguments.accuracy:g} %: "
        lines.append(f"{q.text} = {met}{v.value:.5g} +- {v.bar:.2g} {q.unit()} ({v.share:.2g} %{q.whole()}): "
                     f"{v.spacing:.2g} by the spacing, {v.chance:.2g} by the packing. Confidence "
                     f"{confidence(v, answer.arguments.accuracy, answer.doubt)}.")
    spacing, runs = answer.rungs[-1]
    lines += [f"Note: {said}." for q in answer.quantities for said in q.remarks(runs[0].series)]
    last = runs[0].series["time"][-1]
    if answer.shorter() and last < answer.end * (1 - 1e-9):
        lines.append(f"Note: the last runs ended at {last:.3g} s: later the curves had stayed away from what is asked.")
    elif answer.end and last < answer.end * (1 - 1e-9):
        lines.append(f"Note: the runs ended at rest, the last at {last:.3g} s.")
    lines.append(f"Price: {answer.spent:.0f} s for {sum(len(r) for _, r in answer.rungs)} runs; the last took "
                 f"{runs[-1].cpu:.3g} s. {('It ended because ' + why + '.') if why else ''}".rstrip())
    lines.append(f"Model: {answer.model}")
    lines.append(f"Spacing: {answer.choice.words()}")
    lines.append(f"The last run: {launch.text_of(answer.scene, runs[0].options)}")
    lines += [f"A run failed: {note}" for note in answer.notes]
    return lines


def scaled(values, unit):
    """Factor and unit with which values are handy numbers."""
    return columns.prefixed(max((abs(v) for v in values if math.isfinite(v)), default=0), unit)


def picture(answer, verdicts, path):
    """Curves of each quantity's column at all spacings, and its value over the spacing."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(len(answer.quantities), 2, figsize=(11, 3.6 * len(answer.quantities)), squeeze=False,
                                constrained_layout=True)
    shades = plt.get_cmap("viridis")
    every = [spacing for spacing, _ in answer.rungs]
    wide, length = scaled(every, "m")
    for (left, right), q, v in zip(axes, answer.quantities, verdicts):
        curves = [[q.curve(run.series) for run in runs] for _, runs in answer.rungs]
        late, second = scaled([t[-1] for rung in curves for t, _ in rung], "s")
        high, unit = scaled([y for rung in curves for _, line in rung for y in line], q.row["unit"])
        big, of = scaled([v.value], q.unit())
        for k, (spacing, rung) in enumerate(zip(every, curves)):
            color = shades(0.9 - 0.9 * k / max(1, len(every) - 1))
            for j, (t, y) in enumerate(rung):
                left.plot(late * t, high * y, color=color, linewidth=0.9,
                          label=f"{wide * spacing:.3g} {length}" if not j else None)
            right.plot([wide * spacing] * len(rung), [big * q.of(run.series) for run in answer.rungs[k][1]], "o",
                       color=color, markersize=4)
        right.errorbar([0.93 * wide * every[-1]], [big * v.value], yerr=[big * v.bar if math.isfinite(v.bar) else 0],
                       fmt="ks", capsize=5)
        right.set(xscale="log", xlabel=f"spacing ({length})", ylabel=f"{q.text} ({of})" if of else q.text,
                  title=f"{q.text}: {big * v.value:.4g} +- {big * v.bar:.2g} {of}")
        words = columns.title(q.row)[0]
        left.set(xlabel=f"time ({second})", ylabel=f"{words} ({unit})" if unit else words)
        left.legend(fontsize=7)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def page(answer, verdicts, lines, path):
    """answer.html: the answer, its picture and the table of all runs."""
    picture(answer, verdicts, os.path.join(os.path.dirname(path), "answer.png"))
    head = "".join(f"<th>{html.escape(q.text)}</th>" for q in answer.quantities)
    rows = "".join(f"<tr><td>{spacing:.4g}</td><td>{run.options[-1]}</td><td>{run.cpu:.3g}</td>" +
                   "".join(f"<td>{q.of(run.series):.5g}</td>" for q in answer.quantities) + "</tr>\n"
                   for spacing, runs in answer.rungs for run in runs)
    with open(path, "w", encoding="utf-8") as file:
        file.write(STYLE.format("Answer") + f"<h1>{html.escape(answer.scene)}</h1>\n" +
                   "".join(f"<p>{html.escape(line)}</p>\n" for line in lines) +
                   "<img src='answer.png' alt='curves at all spacings, and the values over the spacing'>\n"
                   f"<table><tr><th>spacing, m</th><th>packing</th><th>seconds</th>{head}</tr>\n{rows}</table>\n")


def table(answer, verdicts, path):
    """answer.csv, for programs: a row for each quantity."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(("quantity", "value", "bar", "unit", "by_spacing", "by_packing"))
        for q, v in zip(answer.quantities, verdicts):
            rows.writerow((q.text, repr(v.value), repr(v.bar), q.unit(), repr(v.spacing), repr(v.chance)))


def record(answer, path):
    """answer.json: the choice of the spacing, with what was compared."""
    choice = answer.choice
    with open(path, "w", encoding="utf-8") as file:
        json.dump({"spacing": {"way": choice.way, "why": choice.why, "compared": choice.ways}}, file, indent=1)
        file.write("\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("scene", metavar="SCENE.opts")
    parser.add_argument("--quantity", required=True, help="COLUMN:TAKE, several separated by commas")
    parser.add_argument("--accuracy", type=float, default=5,
                        help="per cent of each quantity, of a temperature of the range in the liquid")
    parser.add_argument("--budget", type=float, default=600, help="seconds of one core, all runs together")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)), help="runs side by side")
    parser.add_argument("--whole", action="store_true", help="the scene as it is, even where rings or a part would do")
    parser.add_argument("--output", default="", help="folder; default: output/answer/<folder>_<file>")
    arguments = parser.parse_args()
    for name, value in (("ACCURACY", arguments.accuracy), ("BUDGET", arguments.budget)):
        if not 0 < value < math.inf:
            raise tables.Error(f"{name}={value:g}: a positive number is wanted.")
    words = os.path.splitext(os.path.abspath(arguments.scene))[0].split(os.sep)
    arguments.output = arguments.output or os.path.join("output", "answer", "_".join(words[-2:]))
    quantities = quantity.read(arguments.quantity)
    if not quantities:
        raise tables.Error("QUANTITY names nothing: a column of series.csv is wanted, for instance highest:max.")
    os.makedirs(arguments.output, exist_ok=True)
    scene, words, proof, doubt = (arguments.scene, "the scene as it is", None, "") if arguments.whole else model(
        arguments.scene, quantities, arguments)
    print(f"Model: {words}", flush=True)
    answer, verdicts, why = ask(scene, quantities, arguments, proof=proof)
    answer.model, answer.doubt = words, "; ".join(filter(None, (doubt, answer.doubt)))
    lines = report(answer, verdicts, why)
    print("\n" + "\n".join(lines))
    table(answer, verdicts, os.path.join(answer.folder, "answer.csv"))
    record(answer, os.path.join(answer.folder, "answer.json"))
    page(answer, verdicts, lines, os.path.join(answer.folder, "answer.html"))
    print(f"{os.path.join(answer.folder, 'answer.html')} shows ladder and curves.")


if __name__ == "__main__":
    with tables.polite("answer.py"):
        main()
