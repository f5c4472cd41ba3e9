#!/usr/bin/python3
"""Answers, studies and reductions: the ladder's rule on made-up values, quantities of made-up curves, reduced scenes
beside those written by hand, and the programs themselves on a short scene."""
import math
import os
import random
import re
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "src", "answers")]
import ladder  # noqa: E402
import quantity  # noqa: E402
import reduce  # noqa: E402
import runs  # noqa: E402
import study  # noqa: E402
import tables  # noqa: E402

TOOLS = os.path.join(runs.ROOT, "src", "answers")


def refused(call, words, name):
    """The call raises RunError with these words."""
    try:
        call()
        said = "nothing"
    except tables.RunError as error:
        said = str(error)
    runs.check(words in said, name, said)


def rungs(function, noise=0.0, packings=3, count=5):
    draw = random.Random(1)
    return [(h, [function(h) + noise * draw.gauss(0, 1) for _ in range(packings)])
            for h in (2**(-0.5 * k) for k in range(count))]


def ladders():
    for order in (1.0, 1.5, 2.0):
        found = ladder.Verdict(rungs(lambda h, p=order: 3 + 0.4 * h**p))
        runs.check_within(found.order, order - 1e-6, order + 1e-6, f"order_{order:g}")
        runs.check(found.bar >= abs(3 - found.value), f"bar_of_order_{order:g}", f"{found.bar} for {found.value}")
    straight = ladder.Verdict(rungs(lambda h: 3 + 0.4 * h))
    runs.check_within(straight.bar / (straight.value - 3), ladder.MARGIN - 1e-6, ladder.MARGIN + 1e-6, "bar_of_a_line")
    wild = ladder.Verdict(list(zip((4, 2, 1), ([1.0] * 3, [3.0] * 3, [1.5] * 3))))
    runs.check(math.isnan(wild.order) and "up and down" in wild.words and wild.bar > 1, "up_and_down", str(wild.bar))
    noisy = ladder.Verdict(rungs(lambda h: 3.0, noise=0.1))
    runs.check(noisy.bar > 0.05, "only_chance", noisy.words)
    runs.check(math.isinf(ladder.Verdict([(1, [2.0, 2.1])]).bar), "one_spacing_has_no_bar")
    runs.check(math.isinf(ladder.Verdict([(2, [2.0]), (1, [2.1])]).bar), "one_packing_has_no_bar")
    inside = 0
    for seed in range(200):
        draw = random.Random(seed)
        made = [(h, [3 + 0.2 * h + 0.01 * draw.gauss(0, 1) for _ in range(3)]) for h in (1, 0.7071, 0.5)]
        found = ladder.Verdict(made)
        inside += abs(found.value - 3) <= found.bar
    runs.check_within(inside / 200, 0.85, 1, "coverage_of_made_up_values")


def quantities():
    series = {"time": [0, 1, 2, 3], "a": [0, 3, 1, 2], "b": [math.nan, 1, 2, 3]}
    for text, value in (("a:max", 3), ("a:min", 0), ("a:end", 2), ("a", 2), ("a:time_of_max", 1), ("a:at=1.5", 2),
                        ("a:mean=2,3", 1.5), ("b:min", 1)):
        runs.check_within(quantity.Quantity(text).of(series), value - 1e-9, value + 1e-9, f"quantity_{text}")
    runs.check([q.text for q in quantity.read("a:max,b:mean=1,2,a:end")] == ["a:max", "b:mean=1,2", "a:end"], "list")
    for text in ("a:most", "a:at", "a:at=x", "a:mean=3,1"):
        refused(lambda t=text: quantity.Quantity(t), "QUANTITY", f"refuses_{text}")
    refused(lambda: quantity.Quantity("c:max").of(series), "there are", "refuses_unknown_column")
    refused(lambda: quantity.Quantity("a:at=4").of(series), "from 0 to 3", "refuses_late_time")


def same(one, other, names):
    return [name for name in names if tables.vector(one, name) != tables.vector(other, name)]


def reductions():
    found, why = reduce.reduced(os.path.join(runs.ROOT, "cases", "dry_wall", "case.opts"))
    hand = reduce.read(os.path.join(runs.ROOT, "cases", "dry_wall", "rings.opts"))
    found = dict(found)
    runs.check("rings" in why and found["dimension"] == "axisymmetric", "quarter_becomes_rings", why)
    differ = same(found, hand, ("box_lower", "box_upper", "drop_center", "drop_velocity", "drop_radius", "gravity"))
    runs.check(not differ and found["box_ymin"] == "wall", "rings_as_by_hand", str(differ))
    found, why = reduce.reduced(os.path.join(runs.ROOT, "cases", "drop_impact", "case.opts"))
    runs.check_within(tables.vector(dict(found), "box_upper")[0], 22.5e-3, 22.6e-3, "round_pool_of_the_same_area")
    scene = runs.scratch("pair.opts")
    text = ("-box_lower -4e-3,-4e-3,-4e-3 -box_upper 4e-3,4e-3,4e-3 -bodies a,b -a_shape sphere -a_radius 1e-3 "
            "-a_center -2e-3,0,0 -a_velocity 1,0,0 -b_shape sphere -b_radius 1e-3 -b_center {},0,0 -b_velocity -1,0,0 "
            "-spacing 0.4e-3 -time_end 1e-3\n")
    for at, words in (("2e-3", "quarter"), ("2.5e-3", "half")):
        with open(scene, "w", encoding="utf-8") as file:
            file.write(text.format(at))
        if words == "quarter":  # two bodies that mirror each other are not seen as one: a half, across y
            words = "half"
        runs.check(words in reduce.reduced(scene)[1], f"pair_at_{at}", reduce.reduced(scene)[1])
    refused(lambda: reduce.reduced(os.path.join(runs.ROOT, "cases", "dam_break", "case.opts")), "", "dam_break")
    with open(scene, "a", encoding="utf-8") as file:
        file.write("-a_velocity_type strain\n")
    refused(lambda: reduce.reduced(scene), "-a_velocity_type", "refuses_what_it_does_not_know")


def programs():
    scene, folder = os.path.join(runs.ROOT, "cases", "dry_wall", "rings.opts"), runs.scratch("answer")
    short = runs.scratch("short.opts")
    with open(short, "w", encoding="utf-8") as file:
        file.write(f"-options_file {scene}\n-time_end 1e-3\n")
    line = [sys.executable, os.path.join(TOOLS, "answer.py"), short, "--quantity", "highest:end", "--output", folder]
    first = subprocess.run(line + ["--budget", "20", "--accuracy", "10"], capture_output=True, text=True)
    runs.check(first.returncode == 0 and "highest:end = " in first.stdout and " +- " in first.stdout, "answer",
               first.stdout + first.stderr)
    runs.check(os.path.getsize(os.path.join(folder, "answer.html")) > 500 and
               os.path.getsize(os.path.join(folder, "answer.png")) > 5000, "answer_page")
    again = subprocess.run(line + ["--budget", "0.01", "--accuracy", "0.01"], capture_output=True, text=True)
    runs.check("not converged" in again.stdout and "would cost" in again.stdout, "says_what_more_would_cost",
               again.stdout + again.stderr)
    bad = subprocess.run(line + ["--accuracy", "-1"], capture_output=True, text=True)
    runs.check(bad.returncode == 1 and "ACCURACY=-1" in bad.stderr, "refuses_accuracy", bad.stderr)
    found = subprocess.run([sys.executable, os.path.join(TOOLS, "study.py"), short, "--vary",
                            "drop_velocity=0,-0.5;0,-1 spacing=2e-4..4e-4/2", "--quantity", "highest:end", "--output",
                            runs.scratch("study")], capture_output=True, text=True)
    with open(os.path.join(runs.scratch("study"), "study.csv"), encoding="utf-8") as file:
        rows = file.read().splitlines()
    runs.check(found.returncode == 0 and len(rows) == 5, "study", found.stdout + found.stderr)
    refused(lambda: study.vary("a"), "OPTION=VALUE", "refuses_vary")
    refused(lambda: study.values_of("1..2"), "LOW..HIGH/COUNT", "refuses_range")


def models():
    """A half and rings give what the whole gives within what another packing changes: energy and height of drops."""
    head = ("-spacing 0.25e-3 -box_lower -4e-3,-4e-3,-4e-3 -box_upper 4e-3,4e-3,4e-3 -time_end 1e-3 -packing_jitter 0 "
            "-snapshot_interval 0 -checkpoint_interval 0 -series_interval 1e-4 ")
    scenes = {"pair": ("-bodies a,b -a_shape sphere -a_radius 1e-3 -a_center -1.1e-3,0,0 -a_velocity 1,0,0 "
                       "-b_shape sphere -b_radius 1.25e-3 -b_center 1.3e-3,0,0 -b_velocity -1,0,0", 0.03),
              "drop": ("-bodies a -a_shape ellipsoid -a_radii 2e-3,2e-3,1.5e-3 -a_tension 0.072 -a_velocity 0,0,-0.3",
                       0.05)}
    for name, (bodies, tolerance) in scenes.items():
        path, lean = runs.scratch(f"{name}.opts"), runs.scratch(f"{name}_reduced.opts")
        with open(path, "w", encoding="utf-8") as file:
            file.write(re.sub(" (?=-[a-z])", "\n", head + bodies) + "\n")
        text, why = reduce.text(path)
        with open(lean, "w", encoding="utf-8") as file:
            file.write(text)
        whole, part = (runs.series(runs.run(f"-options_file {scene} ", os.path.basename(scene)[:-5]))
                       for scene in (path, lean))
        for column in ("kinetic_energy", "highest"):
            ratio = part[column][-1] / whole[column][-1]
            runs.check_within(ratio, 1 - tolerance, 1 + tolerance, f"{name}_{column}: {why[:30]}")


PARTS = {"ladders": ladders, "quantities": quantities, "reductions": reductions, "models": models, "programs": programs}
for part in runs.parts(*PARTS):
    PARTS[part]()
runs.done()
