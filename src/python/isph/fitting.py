"""What is my liquid: values of options with error bars from a measured curve."""
import base64
import html
import io
import itertools
import math
import os
import typing

import numpy as np

from . import launch
from .running import Job, name_of, words_of
from .tables import Error, clock

COARSER = (2.0, 2**0.5, 1.0)  # times the scene's spacing, the cheapest first
SCAN = {1: 7, 2: 4, 3: 3}  # values of each option that are tried first, of so many options
CHANGE = 0.04  # of an option for a derivative: packings change a curve by less
ENOUGH = 0.004  # the last step of an option, relative: below what packings change
TURNS = 12  # most steps of a descent
SEEDS = 5  # packings at each of the two finest spacings
BLIND, FACTOR = 0.5, 1.0  # of the range's logarithm, and logarithm: a wider bar tells nothing
ALIKE = 0.95  # correlation of two options that act alike
SHIFTS = 201  # starts of the clock that are tried
OUTLINE = "outline"  # the column of a curve that is a shape: heights of the surface over x when the run ends


class Fitted(typing.NamedTuple):
    """A value with its bar (95 %), what the bar comes from, and what the curve cannot tell ("": it tells the value)."""
    option: str
    value: float
    bar: float
    unit: str
    by_noise: float
    by_packing: float
    by_spacing: float
    doubt: str

    def __str__(self):
        if self.doubt:
            return f"{self.option}: {self.doubt}"
        return f"{self.option} = {self.value:.4g} +- {self.bar:.2g} {self.unit}".rstrip()


class Curve:
    """A measured curve: times (s), values, the name of its column; of an outline, places (m) in place of times. Numbers
    that are missing are left out."""

    def __init__(self, curve, column, rows):
        head, (self.times, self.values) = self.read(curve, column) if isinstance(curve, (str, os.PathLike)) else (
            column, np.array(curve, float).reshape(2, -1))
        row = {"name": OUTLINE, "unit": "m"} if head in (OUTLINE, OUTLINE + "_m") else next(
            (row for row in rows if head in (row["name"], row["head"])), None)
        if not row or row["name"] in ("time", "step"):
            raise Error(f"the series of this scene has no column {head}; it has "
                        f"{', '.join(row['name'] for row in rows[2:])}")
        self.row, self.column, self.unit = row, row["name"], row["unit"]
        there = np.isfinite(self.times) & np.isfinite(self.values)
        order = np.argsort(self.times[there], kind="stable")
        self.times, self.values = self.times[there][order], self.values[there][order]

    def needs(self, start):
        """The options of a run that has this curve; start: how late its clock may be (s)."""
        if self.column == OUTLINE:
            return {"gauge_heights": tuple(self.times)}
        return {"time_end": float(f"{self.times[-1] + start[1]:.9g}")}

    def of(self, series):
        """The same curve of a run: (times or places, values)."""
        if self.column == OUTLINE:
            return self.times, np.array([series[f"height_{k + 1}"][-1] for k in range(len(self.times))])
        return np.array(clock(series, self.row)), series[self.column]

    @staticmethod
    def read(path, column):
        try:
            if not os.path.getsize(path):
                raise ValueError("it is empty")
            table = np.genfromtxt(path, delimiter=",", names=True, deletechars="", encoding="utf-8")
        except (OSError, ValueError) as error:
            raise Error(f"{path} is no table: {str(error).splitlines()[0]}") from error
        names = list(table.dtype.names or ())
        clock = next((name for name in names if name in ("time", "time_s", "t", "x", "x_m")), None)
        others = [name for name in names if name != clock]
        wanted = column or (others[0] if others else "")
        found = next((name for name in others if wanted in (name, name.rpartition("_")[0])), None)
        if not clock or not found or (clock[0] == "x") != (found.startswith(OUTLINE)):
            raise Error(f"{path} must have a head line with time_s (s) and {wanted or 'a column of the series'}, or "
                        f"with x_m and {OUTLINE}_m; it has {', '.join(names) or 'none'}")
        return found, (np.atleast_1d(table[clock]), np.atleast_1d(table[found]))


def attempt(job):
    """A run, or the program's sentence: with some values a drop falls off."""
    try:
        return job.go()
    except Error as error:
        return error


def together(jobs, count):
    return launch.beside(attempt, jobs, count)


class Model:
    """The curve that a run with these values of the options has at one spacing."""

    def __init__(self, scene, curve, free, start, more, spacing, jobs, output):
        self.scene, self.curve, self.start, self.more, self.jobs = scene, curve, start, more, jobs
        self.names, self.lower, self.upper = list(free), *np.log(np.array(list(free.values()), float).T)
        self.spacing, self.output, self.runs = spacing, output, {}

    def curves(self, points, seeds=(None,), trial=False):
        """The residuals of each point (logarithms of values), with each seed, over the values of the curve. trial: a
        run that fails is far from the curve."""
        wanted = [(tuple(f"{math.exp(number):.6g}" for number in point), seed) for point in points for seed in seeds]
        new = [key for key in dict.fromkeys(wanted) if key not in self.runs]
        made = []
        for values, seed in new:
            options = {**self.more, "spacing": float(f"{self.spacing:.6g}"), **dict(zip(self.names, values))}
            if seed:
                options["packing_seed"] = seed
            name = "_".join([f"{self.spacing:.4g}", *values, *([f"seed{seed}"] if seed else [])])
            made.append(Job(self.scene, os.path.join(self.output, name), False, 1, options))
        for key, run in zip(new, together(made, self.jobs)):
            self.runs[key] = run if isinstance(run, Error) else self.curve.of(run.series)
        far = np.full(len(self.curve.values), 10 * np.ptp(self.curve.values)), self.start[0]
        failed = next((self.runs[key] for key in wanted if isinstance(self.runs[key], Error)), None)
        if failed and not trial:
            raise failed
        return [far if isinstance(self.runs[key], Error) else self.residual(*self.runs[key]) for key in wanted]

    def residual(self, times, values):
        """The run's curve less the measured one, with the start of the clock that fits best: (residual, start)."""
        there = np.isfinite(values)
        if there.sum() < 2:
            raise Error(f"a run's {self.curve.column} has no values; see the runs in {self.output}")
        low, high = self.start
        found = [(np.interp(self.curve.times + by, times[there], values[there]) - self.curve.values, by)
                 for by in (np.linspace(low, high, SHIFTS) if high > low else [low])]
        return min(found, key=lambda one: np.sum(one[0]**2))

    def scan(self):
        """The best of values spread over the ranges."""
        count = SCAN.get(len(self.names), 2)
        axes = [low + (high - low) * (np.arange(count) + 0.5) / count for low, high in zip(self.lower, self.upper)]
        points = list(itertools.product(*axes))
        return np.array(min(zip(self.curves(points, trial=True), points), key=lambda one: np.sum(one[0][0]**2))[1])

    def slopes(self, point, residual):
        """d residual / d logarithm [points][options]; the steps go away from the nearer end of the range."""
        ahead = np.where(point + CHANGE < self.upper, CHANGE, -CHANGE)
        moved = self.curves([point + step * one for step, one in zip(ahead, np.eye(len(point)))])
        return np.array([(one - residual) / step for (one, _), step in zip(moved, ahead)]).T

    def descend(self, point):
        """The least squares from a point on (Levenberg 1944, Marquardt 1963), within the ranges: (point, residual,
        start, slopes)."""
        damping, (residual, start) = 1e-2, self.curves([point])[0]
        slopes = self.slopes(point, residual)
        for _ in range(TURNS):
            square = slopes.T @ slopes
            step = np.linalg.lstsq(square + damping * np.diag(np.diag(square) + 1e-300), -slopes.T @ residual,
                                   rcond=None)[0]
            there = np.clip(point + step, self.lower, self.upper)
            if np.abs(there - point).max() < ENOUGH:
                break
            further, begins = self.curves([there], trial=True)[0]
            if np.sum(further**2) < np.sum(residual**2):
                point, residual, start, damping = there, further, begins, damping / 5
                slopes = self.slopes(point, residual)
            else:
                damping *= 10
        return point, residual, start, slopes

    def packings(self, point, residual, inverse):
        """How other packings move the result: its mean move, and the error of one packing beside that mean (95 %): a
        curve that is itself a run has one."""
        others = self.curves([point], range(2, SEEDS + 1))
        moves = np.array([np.zeros(len(point))] + [-inverse @ (one - residual) for one, _ in others])
        return moves.mean(0), 2 * moves.std(0, ddof=1) * math.sqrt(1 + 1 / SEEDS)


def spread(residual, options):
    """The scatter of a residual (standard deviation), more where neighbours are alike: they tell less."""
    scatter = math.sqrt(np.sum(residual**2) / max(len(residual) - options, 1))
    alike = np.sum(residual[1:] * residual[:-1]) / max(np.sum(residual**2), 1e-300)
    return scatter * math.sqrt((1 + min(max(alike, 0), 0.9)) / (1 - min(max(alike, 0), 0.9)))


def doubts(model, point, bars, slopes, noise):
    """For each option what the curve cannot tell, or ""."""
    width, said = model.upper - model.lower, []
    norm = np.linalg.norm(slopes, axis=0)
    for k, name in enumerate(model.names):
        twin = next((other for m, other in enumerate(model.names) if m != k and
                     abs(slopes[:, k] @ slopes[:, m]) > ALIKE * norm[k] * norm[m]), None)
        if norm[k] / math.sqrt(len(slopes)) * width[k] < noise:
            said.append(f"{name} has no influence on this curve")
        elif bars[k] > min(BLIND * width[k], FACTOR):
            said.append(f"this curve cannot tell {name} from {twin}: they act alike" if twin else
                        f"this curve does not tell {name} within its range")
        elif min(point[k] - model.lower[k], model.upper[k] - point[k]) < ENOUGH:
            said.append(f"{name} is at the end of its range: give a wider one")
        else:
            said.append("")
    return said


class Fit(dict):
    """{option: Fitted}. curve: the measured one; start: by how much its clock is late (s); best: times and values of
    the best run; page: fit.html."""

    def __str__(self):
        return "\n".join(map(str, self.values()))


def asked(free, known, curve, start, name):
    """Refuses what cannot be fitted."""
    if not free or len(free) > max(SCAN):
        raise Error(f"free has {len(free)} options; it must have 1 to {max(SCAN)}")
    for option, ends in free.items():
        if np.shape(ends) != (2,) or not 0 < ends[0] < ends[1]:
            raise Error(f"the range of {option} is {ends}; it must have a lower end above 0 and an upper end")
        if not any(row["name"] == "-" + option for row in known["options"]):
            raise Error(f"{name} has no option -{option}")
    if len(curve.times) < len(free) + 4:
        raise Error(f"the curve has {len(curve.times)} values; {len(free)} options need at least {len(free) + 4}")
    if np.ptp(curve.values) == 0:
        raise Error("the curve is constant: it tells nothing")
    if curve.column == OUTLINE:
        if known["domain"]["dimension"] == 3 or any(start):
            raise Error("an outline is that of a scene in the plane or of rings when it ends: it has no start")
    elif curve.times[0] + start[0] < known["time_start"]:
        raise Error(f"the curve begins at {curve.times[0] + start[0]:g} s, before the scene, at "
                    f"{known['time_start']:g} s: start=(least, most) says by how much (s) the scene's clock is ahead")


def fit(scene, curve, free, column=None, start=(0, 0), jobs=1, output=None, **options):
    """The values of options that a measured curve tells, with error bars of 95 %:

        found = isph.fit("drop.opts", "lab.csv", free={"drop_tension": (0.02, 0.1), "drop_viscosity": (1e-3, 1e-1)})
        print(found); found["drop_tension"].value, found["drop_tension"].bar, found.page

    curve: a CSV file, its head line time_s and the name of a column of the scene's series, or (times, values), for
    which 'column' is needed; gaps may be empty. A shape is a curve, too: x_m and outline_m, or (places, heights) with
    column="outline", are heights of the surface when the run ends. free: for each option, at most three, the
    range in which it is sought.
    start: the least and most by which the scene's clock is ahead of the curve's (s), which is sought, too. Coarse runs
    come first; no run is repeated. The bar has the noise of the curve, the packing and the spacing. Returns a Fit, with
    a page."""
    known = launch.known.__wrapped__(os.fspath(scene), *words_of(options))
    rows = [row for row in known["columns"] if row["file"] == "series.csv"]
    measured = Curve(curve, column, rows)
    asked(free, known, measured, start, scene)
    end = {**measured.needs(start), "snapshot_interval": 0, "checkpoint_interval": 0}
    output = os.fspath(output or os.path.join("output", "python", name_of(scene), "fit"))
    models = [Model(scene, measured, free, start, {**end, **options}, factor * known["domain"]["spacing"], jobs, output)
              for factor in COARSER]
    point, ends = models[0].scan(), []
    for model in models:
        point, residual, begins, slopes = model.descend(point)
        if model is models[0]:
            continue
        inverse = np.linalg.pinv(slopes)
        moved, packing = model.packings(point, residual, inverse)
        ends.append((point + moved, packing))
    (coarse, _), (value, packing) = ends
    noise = spread(residual, len(free) + (start[1] > start[0]))
    by_noise = 2 * noise * np.sqrt(np.diag(inverse @ inverse.T))
    by_spacing = np.abs(value - coarse) / (COARSER[1] - 1)  # of the first order
    bars = np.hypot(by_noise, packing) + by_spacing
    units = {row["name"]: row["unit"] for row in known["options"]}
    found = Fit()
    for k, (name, doubt) in enumerate(zip(free, doubts(model, value, bars, slopes, noise))):
        one = math.exp(value[k])
        found[name] = Fitted(name, one, one * bars[k], units["-" + name], one * by_noise[k], one * packing[k],
                             one * by_spacing[k], doubt)
    found.curve, found.start = measured, begins
    found.best = model.runs[tuple(f"{math.exp(number):.6g}" for number in point), None]
    found.page = write(found, output, scene)
    return found


def write(found, output, scene):
    """fit.html, curve beside curve, where matplotlib is; its path."""
    os.makedirs(output, exist_ok=True)
    page = os.path.join(output, "fit.html")
    picture = ""
    try:
        from matplotlib.figure import Figure
        figure = Figure((8, 4.5), layout="constrained")
        axes = figure.subplots()
        axes.plot(found.curve.times, found.curve.values, ".", color="#D55E00", label="measured")
        axes.plot(found.best[0] - found.start, found.best[1], color="#0072B2", label="computed")
        axes.set(xlabel="x (m)" if found.curve.column == OUTLINE else "t (s)",
                 ylabel=f"{found.curve.column} ({found.curve.unit})",
                 xlim=(found.curve.times[0], found.curve.times[-1]))
        axes.legend(frameon=False)
        kept = io.BytesIO()
        figure.savefig(kept, format="png", dpi=150)
        picture = f'<img alt="both curves" src="data:image/png;base64,{base64.b64encode(kept.getvalue()).decode()}">'
    except ImportError:
        pass
    lines = ""
    for one in found.values():
        cells = [f"{one.value:.4g} \u00b1 {one.bar:.2g} {one.unit}", *(f"{by:.2g}" for by in one[4:7])]
        cells = [one.option, *([one.doubt] if one.doubt else cells)]
        lines += "<tr><td>" + "<td>".join(map(html.escape, cells)) + "</tr>"
    with open(page, "w", encoding="utf-8") as file:
        file.write(f"""<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>Fit</title>
<meta name="viewport" content="width=device-width"><style>body{{font:16px sans-serif;max-width:50em;margin:1em auto;
padding:0 1em}}img{{width:100%}}td,th{{padding:.2em .6em;text-align:left}}</style>
<h1>{html.escape(os.fspath(scene))}</h1>{picture}<table><tr><th>option<th>value<th>noise<th>packing<th>spacing</tr>
{lines}</table><p>Bars are of 95 %: noise of the curve and packing added in squares, then the spacing.</p></html>""")
    return page
