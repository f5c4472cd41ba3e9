#!/usr/bin/python3
"""All solvers on the states that matter: a film at rest, crater and splash of the drop impact, a closed box without
free surface, two fragments; the closed box also on two processes. All must give the same pressure, and the own
preconditioner must need few iterations on every one, and as many for a tank of 6400 particles as for one of 400."""
import os
import re
import sys

sys.path[:0] = [os.path.dirname(os.path.abspath(__file__)),
                os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")]
import compare  # noqa: E402
import runs  # noqa: E402

TANK = """-dimension 2 -box_lower 0,0 -box_upper 2,1 -box_x wall -box_ymin wall -gravity 0,-9.81 -bodies water
 -water_upper 1,1 -steps_max 3 -ksp_rtol 1e-8 -checkpoint_interval 0 -snapshot_interval 0 """
GROWTH = 1.2  # of the iterations from one size to another; those of Jacobi double and double again
MOST = 14  # iterations to 1e-3 of the own preconditioner; 4 to 9 are seen
FRAGMENTS = """-dimension 3
-spacing 0.1
-box_lower -2,-1,-1
-box_upper 2,1,1
-bodies left,right
-left_shape sphere
-left_center -1,0,0
-left_radius 0.7
-left_tension 1
-right_shape sphere
-right_center 1,0.2,0
-right_radius 0.45
-right_tension 1
-right_velocity -0.1,0,0
-left_velocity_type strain
-left_strain_rate 0.1,-0.05,-0.05
-left_strain_center -1,0,0
-steps_max 1
"""


def text_of(case, extra=""):
    with open(os.path.join(runs.ROOT, "cases", case), encoding="utf-8") as file:
        return file.read() + extra


def judge(name, process, candidates=13):
    """Hands on what the program says of every solver; the own preconditioner must be good."""
    print(f"--- {name}\n{process.stdout}")
    lines = re.findall(r"^(ok|FAIL) (.*)$", process.stdout, flags=re.M)
    runs.check(len(lines) == candidates, f"{name}, all solvers ran", f"{len(lines)}: {process.stderr.strip()[-300:]}")
    runs.check(process.returncode == 0 and all(word == "ok" for word, _ in lines), f"{name}, all agree",
               [text for word, text in lines if word != "ok"])
    own = re.search(r"^cg, own two-level \(default\) +(\d+)", process.stdout, flags=re.M)
    runs.check_below(int(own[1]) if own else 1e9, MOST, f"{name}, iterations of the own preconditioner")
    runs.check("recommended: -ksp_type" in process.stdout, f"{name}, recommends", process.stdout[-200:])


needed = {pc: [runs.series(runs.run(f"{TANK} -spacing {1 / n} -pc_type {pc}", f"{pc}_{n}"))["iterations"][1:].mean()
               for n in sizes] for pc, sizes in (("twolevel", (20, 40, 80)), ("jacobi", (20, 40)))}
runs.check_below(max(needed["twolevel"]) / min(needed["twolevel"]), GROWTH, "iterations at three sizes of a tank")
runs.check(needed["jacobi"][1] / needed["jacobi"][0] > 1.7, "which without a coarse grid grow with the size", needed)
judge("film at rest", compare.compare(text_of("film_at_rest/case.opts", "-spacing 0.6667e-3\n")))
judge("closed box", compare.compare(text_of("taylor_green/case.opts", "-packing_jitter 0.25\n")))
judge("closed box, 2 processes", compare.compare(text_of("taylor_green/case.opts", "-packing_jitter 0.25\n"), ranks=2))
judge("two fragments", compare.compare(FRAGMENTS))
impact = runs.run("-options_file cases/drop_impact/case.opts -options_file options/quarter.opts -spacing 1e-3 "
                  "-snapshot_interval 3e-3 -checkpoint_interval 0 -time_end 12e-3", "impact")
snapshots = runs.numbered(impact, "snapshot")
for title, at in (("splash", 3e-3), ("crater", 12e-3)):
    path = min(snapshots, key=lambda p, t=at: abs(float(runs.head(p)["time"]) - t))
    judge(title, compare.compare(compare.options_of(path), path))
runs.done()
