#!/usr/bin/python3
"""The choice of an answer between one spacing and one that follows the liquid (src/answers/grading.py)."""
import argparse
import json
import os
import re
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "..", *place) for place in ((), ("..", "src", "answers"), ("..", "src", "python"))]
import answer  # noqa: E402
import grading  # noqa: E402
import quantity  # noqa: E402
import runs  # noqa: E402
from isph import launch  # noqa: E402

# (scene, seconds, the way that is taken, why): a drop above a film of six spacings, thin everywhere, and above a pool
FALL = "-dimension axisymmetric -spacing 0.1e-3 -box_xmax wall -box_ymin wall -gravity 0,-9.81 -bodies pool,drop " \
    "-drop_shape sphere -drop_radius 0.8e-3 -drop_center 0,1.2e-3 -drop_velocity 0,-1 -time_end 1e-3 "
POOLS = FALL + "-box_lower 0,-4e-3 -box_upper 4e-3,3e-3 -pool_upper 4e-3,0 "
WAYS = (
    ("film", FALL + "-box_lower 0,-0.6e-3 -box_upper 6e-3,3e-3 -pool_upper 6e-3,0", 13, "uniform", "gains too little"),
    ("deep_pool", POOLS, 60, "following", "comes to a finer spacing"))
REFUSED = (("two_liquids", POOLS + "-drop_tension 0.07 -interface_tension 0.03 -interface_bodies drop", "interface"),
           ("uniform_by_wish", POOLS + "-spacing_follow none", "the scene has -spacing_follow"),
           ("its_own", POOLS + "-spacing_coarse 0.2e-3 -spacing_follow surface", "the scene has -spacing_coarse"),
           ("pool_alone", POOLS, ""))
GO = launch.Run.go


def scene(name, options):
    """A scene's file."""
    path = runs.scratch(f"{name}.opts")
    with open(path, "w", encoding="utf-8") as file:
        file.write(re.sub(" (?=-[a-z])", "\n", options) + "\n")
    return path


def asked(name, options, budget):
    """(scene, quantities, arguments) of a question."""
    folder = runs.scratch(name)
    os.makedirs(folder, exist_ok=True)
    return scene(name, options), quantity.read("highest:max"), argparse.Namespace(
        output=folder, budget=budget, accuracy=0.01, jobs=2)


def short(run, apart=0):
    """In place of a run, what the program makes of two steps: its price is that of its particles and steps, its value
    that of order one; what follows the liquid is so much higher."""
    spacing, made = float(run.options[-3]), launch.Run(run.scene, run.options + ["-steps_max", "2"], run.folder)
    run.cpu = run.wall = GO(made).series["particles"][0] / 1000 * 1e-4 / spacing
    run.series = {"time": [0, 1e-3], "highest": [0, 1 + spacing / 1e-3 + apart * ("-spacing_follow" in run.options)]}
    return run


def refusals():
    """Scenes in which the spacing cannot follow the liquid, or has been chosen."""
    for name, options, words in REFUSED:
        said = grading.refused(scene(name, options), [], 0.1e-3)
        runs.check(words in said and bool(words) == bool(said), f"refused_{name}", said)


def ways():
    """The way that is taken where the choice is clear, what it runs, and its record."""
    launch.Run.go = short
    for name, options, budget, way, why in WAYS:
        found = answer.ask(*asked(f"way_{name}", options, budget))[0]
        choice, path = found.choice, runs.scratch(f"{name}.json")
        runs.check((choice.way, found.way) == (way, way) and why in choice.why, f"way_of_{name}", choice.words())
        followed = {"-spacing_follow" in run.options for _, rung in found.rungs for run in rung}
        runs.check(followed == {way == "following"}, f"runs_of_{name}", str(followed))
        runs.check(found.spent <= budget * 1.01 and len(found.rungs) > 2, f"budget_of_{name}", str(found.spent))
        answer.record(found, path)
        with open(path, encoding="utf-8") as file:
            rows = json.load(file)["spacing"]["compared"]
        runs.check([one["way"] for one in rows] == ["uniform", "following"] and
                   (rows[1]["reach"] < grading.GAIN * rows[0]["reach"]) == (way == "following"),
                   f"record_of_{name}", str(rows))
    launch.Run.go = lambda run: short(run, 0.5)
    found = answer.ask(*asked("way_deep_pool", POOLS, 60))[0]
    runs.check(found.way == "uniform" and "differs" in found.choice.why, "way_of_another_value", found.choice.words())
    launch.Run.go = short
    for budget, accuracy, words in ((60, 30, "may be enough"), (30, 0.01, "would cost")):
        path, quantities, arguments = asked("way_deep_pool", POOLS, budget)
        arguments.accuracy = accuracy
        found = answer.ask(path, quantities, arguments)[0]
        runs.check(words in found.choice.why, f"not_tried_for_{accuracy:g}_in_{budget}", found.choice.words())
    launch.Run.go = GO


def bars():
    """Values that are apart agree by the narrower of their bars, whichever way has it."""
    rows = [{"way": way, "spacing": 1, "seconds": 1, "reach": reach, "quantities": [{"quantity": "a", "value": value}]}
            for way, reach, value in (("uniform", 1, 1.0), ("following", 0.5, 1.3))]
    for narrow, wide, due in ((0.25, 9, "following"), (0.2, 9, "uniform")):
        for bars_ in ((narrow, wide), (wide, narrow)):
            for row, bar in zip(rows, bars_):
                row["quantities"][0]["bar"] = bar
            found = grading.judge(rows)
            runs.check(found.way == due, f"bars_{bars_[0]}_{bars_[1]}", found.words())


def reaches():
    """The finest spacing for what is left, and the doubt about a value away from the first bars."""
    rungs = [(s, [argparse.Namespace(cpu=s**-3.)]) for s in (2**-0.5, 0.5)]  # 8 s, then 22.6, 64, 181
    made = argparse.Namespace(rungs=rungs, growth=lambda: 3)
    for levels in (1, 2, 3):
        found = grading.reach(made, 8 * sum(2**(1.5 * k) for k in range(1, levels + 1)))
        runs.check_within(found / (0.5 * 2**(-0.5 * levels)), 1, 1.3, f"reach_of_{levels}")
    before = [argparse.Namespace(value=1, bar=0.1)]
    for value, due in ((1.13, False), (1.15, True)):
        said = grading.doubt(quantity.read("highest:max"), before, [argparse.Namespace(value=value, bar=0.1)])
        runs.check(bool(said) == due, f"doubt_{value}", said)


PARTS = {"refusals": refusals, "ways": ways, "bars": bars, "reaches": reaches}
for part in runs.parts(*PARTS):
    PARTS[part]()
runs.done()
