#!/usr/bin/python3
"""make tradeoff of a scene of one's own: the yardstick, the advice and its options file, gauges that there are not;
both sweeps, given rows whose answers are known."""
import contextlib
import io
import math
import os
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "tradeoff")]
import numpy as np  # noqa: E402
import runs  # noqa: E402
import scene  # noqa: E402
import physics  # noqa: E402
import summary  # noqa: E402
import sweeps  # noqa: E402
import tradeoff  # noqa: E402

SCENE = """-dimension 2
-spacing 0.04
-box_lower 0,0
-box_upper 2,1
-box_x wall
-box_ymin wall
-gravity 0,-9.81
-bodies water
-water_lower 0,0
-water_upper 0.5,0.6
-time_end 0.1
-series_interval 5e-3
"""


def sweep(path, gauges, *more):
    return subprocess.run([sys.executable, os.path.join(HERE, "..", "tradeoff", "scene.py"), path, "--gauges", gauges,
                           "--budget", "6", *more], cwd=runs.ROOT, env=runs.environment(), text=True, timeout=300,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)


t = np.linspace(0, 1, 50)
right, order, added = scene.yardstick([np.cos(t) + h**2 for h in (2, 2**0.5, 1)], (2, 2**0.5, 1))
runs.check(np.allclose(right, np.cos(t)) and abs(order - 2) < 1e-9 and abs(added - 1) < 1e-9,
           "Richardson's estimate of curves of second order", f"order {order}, {added} added")
right, order, added = scene.yardstick([np.cos(t) + c for c in (1, -1, 1.5)], (2, 2**0.5, 1))
runs.check(np.array_equal(right, np.cos(t) + 1.5) and np.isnan(order) and added == 2.5,
           "without convergence the finest run is the yardstick", f"order {order}, {added}")
runs.check(abs(scene.deviation(np.cos(t) + 0.02, np.cos(t)) - 2) < 1e-9, "deviation in per cent of the largest value")

right, order, _ = scene.yardstick([np.cos(t) + h**4 for h in (2, 2**0.5, 1)], (2, 2**0.5, 1))
runs.check(order == 2 and np.allclose(right, np.cos(t) - 2), "orders beyond two are not believed", f"order {order}")


def choice(axis, options, seconds, *errors):
    """A row of a sweep."""
    return dict(axis=axis, label=options, options=options, scene="a.opts", seconds=float(seconds), errors=list(errors),
                curves=[t] * len(errors), reason="", steps=9)


# gauges a and b, errors in per cent
ROWS = [choice("scene", "", 10, 4, 8), choice("spacing", "-spacing 2", 1, 9, 30),
        choice("tolerance", "-cheap 1", 6, 4.5, 6), choice("preset", "-good 1 -file x", 20, 1, 4),
        choice("preset", "-dear 1", 90, 0.5, 3),
        choice("seed", "-packing_seed 2", 0.1, 0.1, 0.1), dict(choice("kernel", "-died 1", 0.2), curves=None)]
NOTES = [{"floor": 0.3, "words": "One."}, {"floor": 7.0, "words": "Two."}]


def advised(target):
    return scene.advise(ROWS, ["a", "b"], target, NOTES)


lines, best = advised(8)
runs.check(lines[0] == "- a: for 10 % take `-spacing 2`, 1 s; for 5 % take `-cheap 1`, 6 s; for 2 % take "
           "`-good 1 -file x`, 20 s. One. Differences below 0.3 % mean nothing.", "advice of the cheapest", lines[0])
runs.check(lines[1] == "- b: for 10 % take `-cheap 1`, 6 s; for 5 % take `-good 1 -file x`, 20 s; better than 3 % none "
           "of these is (`-dear 1`, 90 s). Two. Differences below 7 % mean nothing.", "advice where none will do",
           lines[1])
for target, wanted in ((30, "-spacing 2"), (8, "-cheap 1"), (5, "-good 1 -file x"), (3, "-dear 1"), (1, "-dear 1")):
    found = advised(target)[1]["options"]
    runs.check(found == wanted, f"advice for {target} % in both gauges", found)
path = runs.scratch("advice.opts")
for row, target, head in ((ROWS[3], 5, "within 5 %"), (ROWS[4], 1, "3 %, the best of all (asked: 1 %)")):
    scene.write_options(path, row, ["a", "b"], target)
    with open(path, encoding="utf-8") as file:
        text = file.read()
    runs.check(f": {head}; {row['seconds']:.3g} s" in text and "\n-options_file a.opts\n" in text and
               text.endswith(row["options"].replace(" -f", "\n-f") + "\n"), f"options file for {target} %", text)

# a sweep of three spacings of second order, on a machine that was half as quick for two of its runs
line = np.linspace(0, 1, scene.SAMPLES)
swept = object.__new__(scene.Sweep)
swept.scene, swept.gauges, swept.folder, swept.times = "a.opts", ["a"], runs.scratch("swept"), line
os.mkdir(swept.folder)
swept.rows = [dict(axis="scene" if h == 1 else "spacing", label=f"{h:g} d0", options=f"-spacing {h:g}", scene="a.opts",
                   factor=h, cpu=cpu, yard=yard, steps=5, reason="", curves=[100 * line + e])
              for h, cpu, yard, e in ((2, 2, 1, 4), (2**0.5, 8, 2, 2), (1, 16, 1, 1))]
swept.rows.append(dict(swept.rows[2], axis="seed", label="2", cpu=16, curves=[100 * line + 1.5]))
with contextlib.redirect_stdout(io.StringIO()) as told:
    scene.report(swept, swept.rows[:3], swept.rows[2], 2.5)
got = [(round(row["seconds"], 9), round(row["errors"][0], 9)) for row in swept.rows[:3]]
runs.check(got == [(2, 4), (4, 2), (16, 1)], "seconds of the quickest machine, errors in per cent", got)
told = told.getvalue()
runs.check("converges with order 2 and is 1 % from the finest run. Another packing changes it by 0.5 %" in told and
           "-spacing 1.41421`, 2 %, 4 s." in told, "the sweep's words", told[-400:])

# the sweep of a case: errors of its check, the front, the summary
half = [physics.relative("a", 0.03, 0.02, 1), physics.at_most("b", -0.5, 0.25), physics.at_least("c", 9, 1)]
error = tradeoff.error_of(sweeps.Scene(error=("a", "b")), half)
runs.check(abs(error - 0.5) < 1e-12, "error of named results", error)
error = tradeoff.error_of(sweeps.Scene(), half)
runs.check(abs(error - math.sqrt((0.5**2 + 2**2) / 2)) < 1e-12, "errors over their tolerances", error)
rows = [dict(error=e, seconds=s, steps=1, reason="")
        for e, s in ((3, 3), (2, 4), (5, 1), (4, 3), (3, 5), (math.nan, 0.1))]
runs.check([rows.index(r) for r in tradeoff.front(rows)] == [0, 1, 2], "front of error and time", tradeoff.front(rows))
runs.check(summary.cell(rows[2], rows[1]) == "2.50, 0.25" and summary.cell(rows[5], rows[1]) == "stops" and
           summary.cell(None, rows[1]) == "-", "a cell of the summary", summary.cell(rows[2], rows[1]))

os.mkdir(runs.scratch("a user's dams"))
path = os.path.join(runs.scratch("a user's dams"), "the dam.opts")
with open(path, "w", encoding="utf-8") as file:
    file.write(SCENE)
for name, gauges, more, word in (("budget_of_nan", "highest", ["--budget=nan"], "BUDGET=nan"),
                                 ("budget_of_inf", "highest", ["--budget=inf"], "BUDGET=inf"),
                                 ("target_of_0", "highest", ["--target=0"], "TARGET=0"),
                                 ("target_below_0", "highest", ["--target=-5"], "TARGET=-5"),
                                 ("missing_way", "highest", ["--ways", "no such way"], "WAYS: no such way"),
                                 ("no_gauge", "", [], "GAUGES=")):
    done = sweep(path, gauges, *more)
    runs.check(done.returncode == 1 and done.stderr.startswith("scene.py: ") and word in done.stderr and
               done.stderr.count("\n") == 1 and not done.stdout, name, f"code {done.returncode}: {done.stderr[-300:]}")
runs.check(scene.quoted("a.opts") == "a.opts" and scene.quoted('a "b" c.opts') == "'a \"b\" c.opts'",
           "paths in an options file")
done = sweep(path, "crown")
runs.check(done.returncode == 1 and "no column crown" in done.stderr and "kinetic_energy" in done.stderr,
           "a gauge that there is not", done.stderr)
done = sweep(path, "highest,kinetic_energy")
runs.check(done.returncode == 0, "the sweep of a scene", (done.stdout + done.stderr)[-500:])
for word in ("- highest: for", "- kinetic_energy:", "advice.opts: "):
    runs.check(word in done.stdout, f"it says '{word}'", done.stdout[-500:])
advice = done.stdout.rpartition("Take ")[2].partition(": ")[0]
dry = runs.start(["-options_file", advice, "-dry_run", "-output_dir", runs.scratch("dry")])
runs.check(dry.returncode == 0, "its options file is a scene", f"{advice}: {dry.stderr}")
shutil.rmtree(os.path.join(runs.ROOT, "output", "tradeoff", os.path.basename(os.path.dirname(path)) + "_the dam"))
runs.done()
