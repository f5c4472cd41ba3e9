"""What the checkers in cases/*/check.py share: snapshots of a run, the report, the exact solutions of drops
that stay ellipses."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402


def snapshots(folder):
    """(time, attributes, fields sorted by particle) of each snapshot of a run."""
    for path in runs.numbered(folder, "snapshot"):
        attributes = runs.head(path)
        yield float(attributes["time"]), attributes, runs.fields(path)


def report(results):
    """Prints 'ok name: value (tolerance)' or 'FAIL name: value (tolerance)' for each (name, value, tolerance);
    passes if |value| <= tolerance. Returns the number that failed."""
    failed = 0
    for name, value, tolerance in results:
        passed = abs(value) <= tolerance
        failed += not passed
        print(f"{'ok' if passed else 'FAIL'} {name}: {value:.3g} ({tolerance:g})", flush=True)
    return failed


def main(check):
    """For check.py as a program: check.py RUN_FOLDER."""
    if len(sys.argv) != 2:
        sys.exit(f"usage: {sys.argv[0]} RUN_FOLDER")
    sys.exit(1 if report(check(sys.argv[1])) else 0)


def short(case, options, names, label="", file="case.opts"):
    """For the tests: runs cases/<case>/<file> with options and reports the results whose name is in names, all
    if that is None. A run that fails counts as one failure. Returns the
    number of failures."""
    folder = os.path.join(runs.ROOT, "cases", case)
    sys.path.insert(0, folder)
    sys.modules.pop("check", None)
    import check
    sys.path.remove(folder)
    path = runs.scratch(case + label)
    process = runs.start(f"-options_file {folder}/{file} {options} -progress_interval 0 -output_dir {path}",
                         timeout=1800)
    if process.returncode:
        print(f"FAIL {case}{label}: the run failed: {process.stderr.strip()[-300:]}", flush=True)
        return 1
    return report((f"{case}{label} {n}", v, t) for n, v, t in check.check(path) if names is None or n in names)


def shear(folder, exact, scale):
    """Results of a plane shear flow: the errors of the x velocity against exact(y, t), over scale (m/s)."""
    rms, largest = [], []
    for t, _, f in snapshots(folder):
        if t == 0:
            continue
        e = (f["velocity"][:, 0] - exact(f["position"][:, 1], t)) / scale
        rms.append(np.sqrt((e**2).mean()))
        largest.append(np.abs(e).max())
    return [("rms velocity error over U, largest of all times", max(rms), 0.01),
            ("largest velocity error over U, last time", largest[-1], 0.01)]


def ellipse(strain, rate, times, steps=4000):
    """Semi-axes a (x), b (y) at the times, of a circle of radius 1 with v = strain (x, -y) in the force -rate^2
    x: a' = s a, b' = -s b, s' = (s^2 + rate^2)(b^2 - a^2)/(a^2 + b^2)."""
    def slope(y):
        s, a, b = y
        return np.array([(s * s + rate * rate) * (b * b - a * a) / (a * a + b * b), s * a, -s * b])

    y, t, out = np.array([strain, 1.0, 1.0]), 0.0, []
    for time in times:
        h = (time - t) / steps
        for _ in range(steps if h > 0 else 0):
            k1 = slope(y)
            k2 = slope(y + h / 2 * k1)
            k3 = slope(y + h / 2 * k2)
            k4 = slope(y + h * k3)
            y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        t = time
        out.append(y[1:].copy())
    return np.array(out)


def semi_axes(position):
    """Of the ellipse with the second moments of the particles."""
    centred = position[:, :2] - position[:, :2].mean(axis=0)
    return 2 * np.sqrt((centred**2).mean(axis=0))
