"""What the checkers in cases/*/check.py share: results (measured, expected, tolerance), snapshots of a run, the exact
solutions of drops that stay ellipses. check(folder) of a case returns a list of Result."""
import os
import sys
from typing import NamedTuple

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402


class Result(NamedTuple):
    """A measured quantity and what it must be. Kinds: 'relative' |measured/expected - 1| <= tolerance; 'absolute'
    |measured - expected| <= tolerance; 'at most' |measured| <= tolerance; 'at least' measured >= tolerance; 'shown'
    is not judged. A measured value that is not finite is beyond every tolerance."""
    name: str
    measured: float
    expected: float
    tolerance: float
    kind: str
    unit: str = ""

    def error(self):
        """What falls with the spacing: the deviation, relative or absolute as the tolerance; nan if there is none."""
        if self.kind == "relative":
            return abs(self.measured / self.expected - 1)
        if self.kind == "at least" or self.kind == "shown" and np.isnan(self.expected):
            return np.nan
        return abs(self.measured - (0.0 if self.kind == "at most" else self.expected))

    def passed(self):
        """Whether it is within the tolerance; None for 'shown'."""
        if self.kind == "shown":
            return None
        if self.kind == "at least":
            return bool(self.measured >= self.tolerance)
        return bool(self.error() <= self.tolerance)

    def words(self):
        """Measured, expected and tolerance as the tables print them."""
        unit = f" {self.unit}" if self.unit else ""
        percent = f"{100 * self.tolerance:.3g} %" if self.tolerance > 1e-5 else f"{self.tolerance:g}, relative"
        limit = {"relative": percent, "absolute": f"+- {self.tolerance:.3g}{unit}",
                 "shown": "-"}.get(self.kind, f"{self.kind} {self.tolerance:.3g}{unit}")
        form = "#.5g" if self.kind in ("relative", "absolute") else ".3g"
        measured, expected = (f"{x:{form}}".rstrip(".") + unit for x in (self.measured, self.expected))
        return measured, "-" if np.isnan(self.expected) else expected, limit


def relative(name, measured, expected, tolerance, unit=""):
    return Result(name, float(measured), float(expected), tolerance, "relative", unit)


def absolute(name, measured, expected, tolerance, unit=""):
    return Result(name, float(measured), float(expected), tolerance, "absolute", unit)


def at_most(name, measured, tolerance, unit=""):
    return Result(name, float(measured), np.nan, tolerance, "at most", unit)


def at_least(name, measured, tolerance, unit=""):
    return Result(name, float(measured), np.nan, tolerance, "at least", unit)


def shown(name, measured, expected=np.nan, unit=""):
    return Result(name, float(measured), float(expected), np.nan, "shown", unit)


def damped_cosine(t, q, frequency, damping):
    """Frequency and damping (1/s) of exp(-b t)(A cos wt + B sin wt) + C by least squares, from a first guess; and the
    root of the mean square of what is left over the largest q. What has no such fit: nan."""
    def rest(w, b):
        shape = np.exp(-b * t)
        A = np.column_stack([shape * np.cos(w * t), shape * np.sin(w * t), np.ones_like(t)])
        return np.sqrt(((A @ np.linalg.lstsq(A, q, rcond=None)[0] - q)**2).mean())

    best, step = np.array([frequency, damping]), np.array([0.1 * frequency, damping])
    for _ in range(1000):
        around = [best + step * (i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        errors = [rest(*p) for p in around]
        k = int(np.argmin(errors))
        best, step = around[k], step * (0.5 if k == 4 else 1)
        if step[0] <= 1e-6 * frequency:
            break
    else:
        return np.nan, np.nan, np.nan
    return best[0], best[1], min(errors) / np.abs(q - q.mean()).max()


def table(path):
    """A CSV file with comments in # before its head, by the names of its columns."""
    with open(path, encoding="utf-8") as file:
        return np.genfromtxt([line for line in file if line[0] != "#"], delimiter=",", names=True)


def snapshots(folder):
    """(time, attributes, fields sorted by particle) of each snapshot of a run."""
    for path in runs.numbered(folder, "snapshot"):
        attributes = runs.head(path)
        yield float(attributes["time"]), attributes, runs.fields(path)


def rings(head):
    """Whether the particles of a run are rings: x is their distance from the axis, y is along it."""
    return bool(head["axisymmetric"])


def volumes(head, f):
    """The volume of each particle of a snapshot (m^dim), of rings the whole one (m3)."""
    return f["volume"] if "volume" in f else np.full(len(f["id"]), float(head["spacing"])**int(head["dimension"]))


def sizes(head, f):
    """The spacing of each particle of a snapshot over the finest: 1 but with -spacing_coarse."""
    one = np.ones(len(f["id"]))
    if rings(head):
        return f.get("size", one)
    return volumes(head, f)**(1 / int(head["dimension"])) / float(head["spacing"]) * one


def places(head, f):
    """Positions x, y, z of the particles with z upwards, in a half-plane through the axis if they are rings."""
    return f["position"][:, [0, 2, 1]] if rings(head) else f["position"]


def lost(head, first, last):
    """Result: the particles lost between two snapshots; where they join and split, as rings and those of several sizes
    do, the share of their volume."""
    if "volume" in first:
        share = 1 - last["volume"].sum(dtype=float) / first["volume"].sum(dtype=float)
        return at_most("volume lost, share", share, 1e-3 if rings(head) else 1e-6)
    return at_most("particles lost", len(first["id"]) - len(last["id"]), 0)


def bessel(x):
    """J0(x) and J1(x) by their series, x a number or an array, up to 30 or so."""
    x = np.asarray(x, dtype=float)
    term, j0, j1 = np.ones_like(x), np.ones_like(x), np.ones_like(x)
    for m in range(1, 80):
        term = -0.25 * x * x * term / m**2
        j0, j1 = j0 + term, j1 + term / (m + 1)
    return j0, 0.5 * x * j1


def upright(head, f):
    """The particles' places (m, [n][3]) of a scene whose last axis points up; rings at azimuth 0: r, 0, z."""
    x = f["position"]
    return x[:, [0, 2, 1]] if rings(head) else x


def at_axis(head, errors):
    """Root of the mean square of an error of rings over snapshots, [(fields, error)], of those within two spacings of
    the axis over that of all others, a spacing and a half from the outermost and beyond not counted: the wall or
    surface there has errors of its own."""
    d0, sums = float(head["spacing"]), np.zeros((2, 2))
    for f, error in errors:
        r = f["position"][:, 0]
        for k, part in enumerate((r < 2 * d0, (r > 2 * d0) & (r < r.max() - 1.5 * d0))):
            sums[k] += [(error[part]**2).sum(), part.sum()]
    return np.sqrt(sums[0, 0] / sums[0, 1] * sums[1, 1] / sums[1, 0])


def options(head):
    """The options of a run, {name: value}, from the attributes of a snapshot."""
    lines = (line.split(None, 1) for line in head["options"].decode().splitlines())
    return {words[0]: words[1].strip() if len(words) > 1 else "" for words in lines if words}


def report(results, title=""):
    """Prints 'ok name: ...', 'FAIL name: ...' or, if it is not judged, 'shown name: ...' for each result. Returns the
    number beyond tolerance."""
    failed = 0
    for result in results:
        measured, expected, limit = result.words()
        passed = result.passed()
        failed += passed is False
        state = {True: "ok", False: "FAIL", None: "shown"}[passed]
        print(f"{state} {title}{result.name}: {measured}, expected {expected}, tolerance {limit}", flush=True)
    return failed


def main(check):
    """For check.py as a program: check.py RUN_FOLDER."""
    if len(sys.argv) != 2:
        sys.exit(f"usage: {sys.argv[0]} RUN_FOLDER")
    sys.exit(1 if report(check(sys.argv[1])) else 0)


def shear(folder, exact, scale, places):
    """Results of a plane shear flow with x velocity exact(y, t): the errors over scale (m/s), and the velocity at the
    last time at the height places (m), from the particles within a spacing of it by a straight line."""
    rms, largest = [], []
    for t, head, f in snapshots(folder):
        if t == 0:
            continue
        y, u = f["position"][:, 1], f["velocity"][:, 0]
        e = (u - exact(y, t)) / scale
        rms.append(np.sqrt((e**2).mean()))
        largest.append(np.abs(e).max())
    near = np.abs(y - places) < 1.1 * float(np.ravel(head["spacing"])[0])
    slope, value = np.polyfit(y[near] - places, u[near] - exact(y[near], t), 1)
    wanted = exact(np.array([places]), t)[0]
    return [relative(f"velocity at y = {places:g} m, last time", wanted + value, wanted, 0.01, "m/s"),
            at_most("rms velocity error over U, largest of all times", max(rms), 0.01),
            at_most("largest velocity error over U, last time", largest[-1], 0.01)]


def integrate(slope, start, begin, times, steps):
    """The solution of y' = slope(y), start at begin, at each of the rising times: classical Runge-Kutta, so many steps
    between two."""
    y, t, out = np.array(start, dtype=float), begin, []
    for time in times:
        h = (time - t) / steps
        for _ in range(steps if h > 0 else 0):
            k1 = slope(y)
            k2 = slope(y + h / 2 * k1)
            k3 = slope(y + h / 2 * k2)
            k4 = slope(y + h * k3)
            y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        t = time
        out.append(y)
    return np.array(out)


def ellipse(strain, rate, times, steps=4000):
    """Semi-axes a (x), b (y) at the times, of a circle of radius 1 with v = strain (x, -y) in the force -rate^2
    x: a' = s a, b' = -s b, s' = (s^2 + rate^2)(b^2 - a^2)/(a^2 + b^2)."""
    def slope(y):
        s, a, b = y
        return np.array([(s * s + rate * rate) * (b * b - a * a) / (a * a + b * b), s * a, -s * b])

    return integrate(slope, [strain, 1.0, 1.0], 0.0, times, steps)[:, 1:]


def semi_axes(position):
    """Of the ellipse with the second moments of the particles."""
    centred = position[:, :2] - position[:, :2].mean(axis=0)
    return 2 * np.sqrt((centred**2).mean(axis=0))


def components(position, reach, size=None):
    """Label of each particle: particles that are connected by steps below reach (m), times the mean of their sizes,
    have the same. Cells of the largest reach and a breadth-first walk; labels count from 0, the largest set first."""
    cells, label = {}, np.full(len(position), -1)
    size = np.ones(len(position)) if size is None else size
    keys = np.floor(position / (reach * max(size, default=1))).astype(int)
    for a, key in enumerate(map(tuple, keys)):
        cells.setdefault(key, []).append(a)
    near = [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)]
    count = 0
    for first in range(len(position)):
        if label[first] >= 0:
            continue
        label[first], front = count, [first]
        while front:
            a = front.pop()
            others = [b for d in near for b in cells.get((keys[a][0] + d[0], keys[a][1] + d[1], keys[a][2] + d[2]), ())
                      if label[b] < 0]
            for b in others:
                if ((position[a] - position[b])**2).sum() < (reach * (size[a] + size[b]) / 2)**2:
                    label[b] = count
                    front.append(b)
        count += 1
    order = np.argsort(np.argsort(-np.bincount(label, minlength=1), kind="stable"))
    return order[label]
