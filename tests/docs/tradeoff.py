#!/usr/bin/python3
"""make tradeoff of a scene of one's own: the yardstick, the advice and its options file, gauges that there are not."""
import os
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "tradeoff")]
import numpy as np  # noqa: E402
import runs  # noqa: E402
import scene  # noqa: E402

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
