#!/usr/bin/python3
"""Answers, studies and reductions: the ladder's rule on made-up values, quantities of made-up curves, reduced scenes
beside those written by hand, models that trap, figures carried back, and the programs themselves on a short scene."""
import argparse
import math
import os
import random
import re
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "..", *place) for place in ((), ("..", "src", "answers"), ("..", "src", "python"))]
import answer  # noqa: E402
import ladder  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import quantity  # noqa: E402
import reduce  # noqa: E402
import runs  # noqa: E402
import study  # noqa: E402
from isph import launch, tables  # noqa: E402

TOOLS = os.path.join(runs.ROOT, "src", "answers")
CUBE = "-box_lower -4e-3,-4e-3,-4e-3 -box_upper 4e-3,4e-3,4e-3 -spacing 0.4e-3 -time_end 1e-3 "
PAIR = CUBE + ("-spacing 0.25e-3 -bodies a,b -a_shape sphere -a_radius 1e-3 -a_center -1.2e-3,{0},0 -a_velocity 1,0,0 "
               "-b_shape sphere -b_radius 1e-3 -b_center 1.2e-3,{0},0 -b_velocity -1,0,0 ")
POOL = CUBE + ("-box_lower -4e-3,-4e-3,-2e-3 -box_zmin wall -gravity 0,0,-9.81 -bodies a,b -a_upper 4e-3,4e-3,0 "
               "-b_shape sphere -b_radius 1e-3 -b_center 0,0,1.3e-3 -b_velocity 0,0,-1 ")
JET = CUBE + ("-bodies a -a_type emitter -a_shape cylinder -a_radius 1e-3 -a_height 1.6e-3 -a_center 0,0,3e-3 "
              "-a_velocity 0,0,-2 ")
SHEET = CUBE + "-box_y periodic -bodies a -a_lower -3e-3,-4e-3,-1e-3 -a_upper 3e-3,4e-3,1e-3 -a_tension 0.07 "
FLAT = "-dimension 2 -spacing 0.2e-3 -time_end 2e-3 "
# scenes, and what is said of each; the third is how much the figures of the reduced scene may differ, none: not run
REDUCED = (
    ("pair", PAIR.format("0"), "rings", 0.07),  # five packings of the rings scatter by -3 to +2 %, before, too
    ("pair_aside", PAIR.format("0.2e-3"), "across x and z: a quarter; a mirrored", 0.05),
    ("pair_of_two_liquids", PAIR.format("0.2e-3") + "-a_tension 0.07", "across z: a half", 0.05),
    ("pair_that_strains", PAIR.format("0") + "-a_velocity_type strain -a_strain_rate 0,1,-1", "across y and z", None),
    ("swirl", PAIR.format("0") + "-a_velocity_type rotation -a_rotation_rate 9,0,0 -a_rotation_center 0,0,0",
     "there is swirl", None),
    ("pool", POOL, "rings; the pool", 0.1),
    ("pool_with_a_pillar", POOL + "-solids p -p_shape cylinder -p_radius 0.8e-3 -p_center 3.9e-3,3.9e-3,0",
     "what is there differs", None),
    ("wall_that_slides", POOL + "-box_zmin_velocity 0.1,0,0", "across y: a half", 0.05),
    ("two_wettabilities", POOL + "-a_tension 0.07 -b_tension 0.07 -box_x wall -box_xmin_contact_angle 60",
     "across y: a half", None),
    ("shaken", POOL + "-gravity_amplitude 0,5,0 -gravity_frequency 100 -box_x wall -box_y wall", "across x: a half",
     0.05),
    ("piston_from_below", POOL + "-solids p -p_shape cylinder -p_radius 1.2e-3 -p_height 2e-3 -p_center 0,0,-2e-3 "
     "-p_oscillation_amplitude 0,0,0.4e-3 -p_oscillation_frequency 100", "rings", None),
    ("comes_back", POOL + "-solids p -p_shape sphere -p_radius 1e-3 -p_center 0,0,-1e-3 -p_oscillation_amplitude "
     "0.3e-3,0,0 -p_oscillation_frequency 1000 -p_oscillation_phase -90", "across y: a half", None),
    ("piston_from_aside", POOL + "-solids p -p_shape sphere -p_radius 1e-3 -p_center 0,0,-1e-3 -p_velocity 0.1,0,0",
     "across y: a half", None),
    ("channel", POOL + "-box_y periodic -b_shape cylinder -b_axis y", "uniform along y: a plane", 0.05),
    ("sliding_channel", POOL + "-box_y periodic -b_shape cylinder -b_axis y -box_zmin_velocity 1,0,0 -b_viscosity 0.1 "
     "-a_viscosity 0.1", "uniform along y: a plane", 0.05),
    ("sheet", SHEET, "uniform along y: a plane", 0.05),
    ("jet", JET, "rings", 0.1),
    ("circle", FLAT + "-box_lower -4e-3,-2e-3 -box_upper 4e-3,4e-3 -box_x wall -box_ymin wall -bodies a,b -a_upper "
     "4e-3,0 -b_shape sphere -b_radius 1.5e-3 -b_center 0,1.7e-3 -b_velocity 0,-1 -a_tension 0.07 -b_tension 0.07",
     "across x: a half", 0.05),
    ("weak_tension", POOL + "-b_tension 1e-6 -a_tension 1e-6 -wall_contact_angle 60", "no tension", 0.1),
    ("two_emitters", JET + "-bodies a,b -a_center -2e-3,0,3e-3 -b_center 2e-3,0,3e-3 -b_type emitter -b_shape cylinder "
     "-b_radius 1e-3 -b_height 1.6e-3 -b_velocity 0,0,-2 -b_start 0.4e-3", "across y: a half", None),
    ("too_narrow_for_a_quarter", POOL + "-box_lower -4e-3,-1e-3,-2e-3 -box_upper 4e-3,1e-3,4e-3 -a_upper 4e-3,1e-3,0 "
     "-box_y wall", "across x: a half", None),
    ("thin_liquid", POOL + "-b_viscosity 1e-6 -a_viscosity 1e-6", "no viscosity", 0.1),
    ("short_fall", PAIR.format("0") + "-gravity -1e-3,0,0", "no gravity", None))


TANK = "-spacing 0.1 -box_lower -0.5,-{0},0 -box_upper 0.5,{0},1.2 -box_x wall -box_y wall -box_zmin wall -bodies a " \
    "-a_upper 0.5,{0},1 -gravity 0,0,-9.81 -gauge_forces -time_end 0.2 "
SHAKEN = TANK.format("0.5") + "-gravity_amplitude 5,0,0 -gravity_frequency 1 -time_end 2 "
LID = "-spacing 0.1 -box_lower -1,-1,0 -box_upper 1,1,1 -box_x periodic -box_y periodic -box_z wall -bodies a " \
    "-a_viscosity 10 -gravity 0,0,-1 -time_end 1 "
DAM = "-spacing 0.05 -box_lower 0,0,0 -box_upper 1.2,0.25,0.8 -box_x wall -box_y periodic -box_zmin wall -bodies a " \
    "-a_upper 0.6,0.25,0.6 -gravity 0,0,-9.81 -time_end 0.2 -gauge_forces "
WAVE = "-dimension 2 -spacing 0.05 -box_lower -1,0 -box_upper 1,1 -box_x periodic -box_ymin wall -bodies a " \
    "-a_shape wave -a_upper 1,0.4 -a_wave_amplitude 0.05 -gravity 0,-9.81 -time_end 0.5 "
DROP = "-spacing 5e-3 -box_lower -3e-2,-3e-2,-3e-2 -box_upper 3e-2,3e-2,3e-2 -bodies a -a_shape sphere " \
    "-a_radius 2e-2 -a_tension 0.072 -a_wave_amplitude 2e-3 -gravity 0,0,-9.81 -time_end 0.05 "
DEEP = "-spacing 0.1 -box_lower -1,-1,0 -box_upper 1,1,2 -box_x wall -box_y wall -box_zmin wall -bodies a,b " \
    "-a_upper 1,1,1 -b_shape sphere -b_radius 0.2 -b_center 0,0,1.25 -b_velocity 0,0,-2 -gravity 0,0,-9.81 "
LAW = "-dimension axisymmetric -spacing 0.2e-3 -box_lower 0,0 -box_upper 4e-3,4e-3 -box_ymin wall -bodies a " \
    "-a_shape sphere -a_radius 1e-3 -a_center 0,1e-3 -a_velocity 0,-0.5 -a_tension 0.072 -a_viscosity 1e-6 " \
    "-wall_contact_angle 60 -time_end 5e-3 "
ANGLE = CUBE + "-box_x wall -box_y wall -wall_contact_angle 60 -bodies a -a_shape sphere -a_radius 1e-3 " \
    "-a_tension 0.07 "
ROW = CUBE + "-gravity 0,0,-9.81 -box_y periodic -bodies " + ",".join("abcde") + "".join(
    f" -{name}_shape sphere -{name}_radius 0.6e-3 -{name}_center 0,{-3.2 + 1.6 * k:.1f}e-3,0"
    for k, name in enumerate("abcde"))
# what holds (rings, across x ...: a symmetry; tension, ...: that it cannot matter), and what does not
HOLDS = (
    ("shaken_whole_periods", SHAKEN, "across y", "rings, across x"),
    ("shaken_without_an_end", SHAKEN.replace("-time_end 2", "-steps_max 9"), "across y", "rings, across x"),
    ("rod_that_swings", TANK.format("0.5") + "-time_end 2 -solids r -r_shape cylinder -r_radius 0.2 -r_center 0,0,0.5 "
     "-r_oscillation_amplitude 0.1,0,0 -r_oscillation_frequency 1 -r_oscillation_phase -90", "across y",
     "rings, across x"),
    ("lid_along_both", LID + "-box_zmax_velocity 1,1,0", "", "along x, along y"),
    ("lid_along_y", LID + "-box_zmax_velocity 0,1,0", "along x", "along y"),
    ("row_of_drops", ROW, "across y", "along y"),
    ("drop_that_oscillates", DROP, "rings", "tension"),
    ("deep_water", DEEP + "-time_end 4e-3", "rings", "gravity"),
    ("law_of_the_line", LAW + "-wall_contact_law cox_voinov", "", "viscosity"),
    ("static_line", LAW, "viscosity", ""),
    ("same_angle_said_twice", ANGLE + "-box_xmin_contact_angle 60", "rings", ""),
    ("ball_cut_by_a_periodic_face", "-spacing 0.1 -box_lower -1,-1,-1 -box_upper 1,1,1 -box_x periodic -bodies a "
     "-a_shape sphere -a_radius 0.5 -a_center 1,0,0 -a_tension 1 -time_end 1", "across y", "across x"),
    ("hot_on_one_side", TANK.format("0.5") + "-a_temperature 300 -a_temperature_gradient 10,0,0", "across y",
     "rings, across x"),
    ("another_angle", ANGLE + "-box_xmin_contact_angle 70", "across y", "rings, across x"))
# Liquid like that around it, which an interface tension keeps apart.
DROP_IN_LIKE = "-dimension 2 -spacing 0.05 -box_lower -1,0 -box_upper 1,1 -box_x wall -box_ymin wall -bodies a,b " \
    "-bodies_overlap -a_shape sphere -a_radius 0.2 -a_center 0.4,0.4 -b_upper 1,0.8 -a_tension 1 -b_tension 1 " \
    "-interface_tension 1 -interface_bodies a -time_end 1 "
HOLDS += (("drop_in_liquid_like_it", DROP_IN_LIKE, "", "across x"),)
# (scene, quantity, its value in the whole scene, the model that carries it back)
FIGURES = (
    ("weight_on_a_half", TANK.format("0.3"), "force_zmin_z:mean=0.1,0.2", -1000 * 9.81 * 0.6, "half"),
    ("volume_of_a_plane", DAM, "volume:end", 0.6 * 0.25 * 0.6, "plane"),
    ("weight_on_a_plane", DAM.replace("1.2,", "0.6,"), "force_zmin_z:mean=0.1,0.2", -1000 * 9.81 * 0.09, "plane"))
SQUARES = (
    ("side_of_a_square", TANK.format("0.5"), "force_ymin_y:mean=0.1,0.2", -0.5 * 1000 * 9.81, "half"),
    ("weight_as_rings", TANK.format("0.5"), "force_zmin_z:mean=0.1,0.2", -1000 * 9.81, "rings"))
PLENTY = 2000  # s: the proof is made on a slow machine, too


def refused(call, words, name):
    """The call raises Error with these words."""
    try:
        call()
        said = "nothing"
    except tables.Error as error:
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
    late = ladder.Verdict(rungs(lambda h: 3 + 0.4 * h + (5 if h > 0.6 else 0), count=7))  # the last five are a line
    runs.check_within(late.bar / (late.value - 3), ladder.MARGIN - 1e-6, ladder.MARGIN + 1e-6, "bar_of_the_last_five")
    wild = ladder.Verdict(list(zip((4, 2, 1), ([1.0] * 3, [3.0] * 3, [1.5] * 3))))
    runs.check(math.isnan(wild.order) and "up and down" in wild.words and wild.bar > 1, "up_and_down", str(wild.bar))
    noisy = ladder.Verdict(rungs(lambda h: 3.0, noise=0.1))
    runs.check(noisy.bar > 0.05, "only_chance", noisy.words)
    runs.check(math.isinf(ladder.Verdict([(1, [2.0, 2.1])]).bar), "one_spacing_has_no_bar")
    runs.check(math.isinf(ladder.Verdict([(2, [2.0]), (1, [2.1])]).bar), "one_packing_has_no_bar")
    one = ladder.Verdict([(2, [1.0, 3.0]), (1, [1.0, 2.0, 3.0])])  # variances 2 and 1
    runs.check_within(one.chance, 4 / 3 - 1e-9, 4 / 3 + 1e-9, "chance_of_the_mean_of_three")
    inside = 0
    for seed in range(200):
        draw = random.Random(seed)
        made = [(h, [3 + 0.2 * h + 0.01 * draw.gauss(0, 1) for _ in range(3)]) for h in (1, 0.7071, 0.5)]
        found = ladder.Verdict(made)
        inside += abs(found.value - 3) <= found.bar
    runs.check_within(inside / 200, 0.85, 1, "coverage_of_made_up_values")


def diverging():
    """Values that grow with the logarithm of the spacing have no bar; what chance does has one."""
    for name, way, limit in (("logarithm", lambda h: 1 - 0.1 * math.log(h), False),
                             ("order_0.4", lambda h: h**0.4, True), ("order_1", lambda h: h, True),
                             ("up_and_down", lambda h: (-1)**round(2 * math.log2(h)), True)):
        for count in (3, 4, 5):
            found = ladder.Verdict(rungs(way, count=count))
            runs.check(math.isfinite(found.bar) == (limit or count < 4), f"{name}_of_{count}",
                       f"{found.bar}: {found.words}")
    noisy = [(s, [v + e for e in (-1, 0, 1)]) for s, (v, *_) in rungs(lambda h: 1 - 0.1 * math.log(h), count=5)]
    runs.check(math.isfinite(ladder.Verdict(noisy).bar), "what_chance_does_has_a_bar", ladder.Verdict(noisy).words)
    runs.check("do not shrink" in answer.confidence(ladder.Verdict(rungs(lambda h: -math.log(h))), 5), "and_says_why")


def quantities():
    series = {"time": [0, 1, 2, 2.9], "a": [0, 3, 1, 2], "b": [math.nan, 1, 2, 3], "wide_ymin": [1, 2, 3, 4],
              "p": [math.nan, 7, 5, 5], "gap": [1, math.nan, math.nan, 2],
              "late": [math.nan, math.nan, 1, 1]}
    creep = {"time": list(range(21)), "a": list(range(21))}
    rows = [{"file": "series.csv", "name": name, "head": f"{name}_m", "unit": "m",
             "needs": ["pressure"] * (name == "p")} for name in series]
    for text, value in (("a:max", 3), ("a:min", 0), ("a:end", 2), ("a", 2), ("a:time_of_max", 1), ("a:at=1.5", 2),
                        ("a:mean=2,2.9", 1.5), ("b:min", 1), ("wide_ymin:end", 4), ("wide_ymin_m:end", 4),
                        ("p:min", 5), ("a:settles=60", 1), ("gap:at=0", 1)):
        one = quantity.Quantity(text)
        one.find(rows)
        runs.check_within(one.of(series), value - 1e-9, value + 1e-9, f"quantity_{text}")
        runs.check(one.unit() == ("s" if "time_of" in text or "settles" in text else "m"), f"unit_{text}", one.unit())
    held = quantity.Quantity("p:at=1")
    held.find(rows)
    runs.check_within(held.of({**series, "pressure_time": [0, 0.5, 1.5, 2.5]}), 6 - 1e-9, 6 + 1e-9,
                      "a_pressure_at_its_own_time")
    for text in ("b:at=0.5", "gap:at=1.5", "gap:mean=0,2.9"):
        runs.check(math.isnan(quantity.Quantity(text).of(series)), f"no_bridge_{text}")
    for text, words in (("a:end", "still changes"), ("gap:end", "gaps between"), ("late:max", "from 2 to 2.9 s only"),
                        ("p:max", "came at 1 s")):
        one = quantity.Quantity(text)
        one.find(rows)
        said = one.remarks(creep if text == "a:end" else series)
        runs.check(words in " ".join(said), f"remark_{text}", str(said))
    hot = {"time": [0, 1], "temperature_min": [300, 301], "temperature_max": [math.nan, 310]}
    warm = quantity.Quantity("temperature_max:end")
    warm.find([{"file": "series.csv", "name": "temperature_max", "head": "temperature_max_K", "unit": "K"}])
    two = ladder.Verdict([(2, [309.0, 309.1]), (1, [310.0, 310.1])], warm.size(hot))
    runs.check_within(two.share, 10 * two.bar - 1e-9, 10 * two.bar + 1e-9, "a_temperature_is_judged_by_its_range")
    runs.check(answer.confidence(two, 5).startswith("low"), "so_a_kelvin_of_ten_is_much", answer.confidence(two, 5))
    late = {"time": [1, 2, 3], "a": [1, 2, 3]}
    refused(lambda: quantity.Quantity("a:mean=0,2").of(late), "times from 1 to 3 s", "refuses_a_mean_before_the_start")
    peaks = {"time": [0, 1, 2, 3, 4, 5, 6], "a": [0, 9, 5, 3, 7, 1, 1], "up": list(range(7)), "flat": [1] * 7}
    for text, due in (("a:max", 5.5), ("a:time_of_max", 5.5), ("a:min", math.inf), ("up:max", math.inf),
                      ("up:min", 2.2), ("flat:max", math.inf), ("a:at=2", 2), ("a:mean=1,3", 3), ("a:end", math.inf),
                      ("a:settles=5", math.inf)):
        found = quantity.Quantity(text).needs(peaks)
        runs.check(found == due or abs(found - due) < 1e-9, f"needs_{text}", str(found))
    words = quantity.ends(quantity.read("a:rest"), {"time_start": 1, "time_end": 2})
    runs.check(words[:2] == ["-time_end", "21"], "a_value_at_rest_has_twenty_times_the_time", str(words))
    runs.check(study.values_of("1..3/3") == ["1", "2", "3"], "range_of_a_study", str(study.values_of("1..3/3")))
    one = quantity.Quantity("p:end")
    one.find(rows)
    runs.check(not one.remarks(series), "no_remark", str(one.remarks(series)))
    runs.check([q.text for q in quantity.read("a:max,b:mean=1,2,a:end")] == ["a:max", "b:mean=1,2", "a:end"], "list")
    for text in ("a:most", "a:at", "a:at=x", "a:mean=3,1"):
        refused(lambda t=text: quantity.Quantity(t), "QUANTITY", f"refuses_{text}")
    refused(lambda: quantity.Quantity("c:max").find(rows), "there are", "refuses_unknown_column")
    refused(lambda: quantity.Quantity("a:at=4").of(series), "from 0 to 2.9", "refuses_late_time")
    half = runs.scratch("half.csv")  # a run that still writes
    with open(half, "w", encoding="utf-8") as file:
        file.write("time,highest\n0,1\n0.1,2\n0.2")
    read = tables.read_table(half)
    runs.check(dict(read) == {"time": [0, 0.1], "highest": [1, 2]}, "half_a_line_is_left_out", dict(read))


def scene(name, options):
    """A scene's file."""
    path = runs.scratch(f"{name}.opts")
    with open(path, "w", encoding="utf-8") as file:
        file.write(re.sub(" (?=-[a-z])", "\n", options) + "\n")
    return path


def reductions():
    way = reduce.reduced(os.path.join(runs.ROOT, "cases", "dry_wall", "case.opts"))
    found, hand = reduce.known_of(way.lines), launch.known(os.path.join(runs.ROOT, "cases", "dry_wall", "rings.opts"))
    runs.check("rings" in way.why and found["domain"]["rings"], "quarter_becomes_rings", way.why)
    differ = [key for key in ("domain", "bodies", "forces") if found[key] != hand[key]]
    runs.check(not differ, "rings_as_by_hand", str([(found[key], hand[key]) for key in differ]))
    way = reduce.reduced(os.path.join(runs.ROOT, "cases", "drop_impact", "case.opts"))
    runs.check_within(reduce.known_of(way.lines)["domain"]["upper"][0], 22.5e-3, 22.6e-3,
                      "round_pool_of_the_same_area")
    for name, options, words, _ in REDUCED:
        try:
            why = reduce.reduced(scene(name, options)).why
        except tables.Error as error:
            why = str(error)
        runs.check(words in why, name, why)
    block = runs.scratch("block.stl")  # a wedge, symmetric across y
    vertices = ((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (1, -1, 1), (1, 1, 1))
    with open(block, "w", encoding="utf-8") as file:
        file.write("solid wedge\n")
        for corners in ((0, 2, 1), (0, 3, 2), (1, 2, 5), (1, 5, 4), (0, 1, 4), (3, 5, 2), (0, 4, 5), (0, 5, 3)):
            file.write("facet normal 0 0 0\nouter loop\n")
            for c in corners:
                file.write("vertex {} {} {}\n".format(*vertices[c]))
            file.write("endloop\nendfacet\n")
        file.write("endsolid wedge\n")
    wedge = reduce.reduced(scene("wedge", POOL + f"-solids p -p_shape stl -p_file {block} -p_scale 1e-3 "
                                 "-p_offset 0,0,-1e-3")).why
    runs.check("mirror plane across y: a half" in wedge, "wedge_of_an_stl_file", wedge)
    lines = dict(reduce.reduced(scene("solver", WAVE + "-ksp_rtol 1e-6")).lines)
    runs.check(lines.get("ksp_rtol") == "1e-6", "options_of_petsc_stay", str(lines))
    wave = launch.known(scene("wave", WAVE))["bodies"][0]["shape"]["numbers"]
    half = reduce.known_of(reduce.reduced(scene("wave", WAVE)).lines)["bodies"][0]["shape"]["numbers"]
    runs.check(half == wave, "half_of_a_wave", f"{half}, not {wave}")
    for box, due in (("periodic", "symmetry"), ("wall", "wall")):
        way = reduce.reduced(scene(f"half_of_{box}", POOL + f"-b_center 0,1e-4,1.3e-3 -box_x {box}"))
        kinds = {face["name"]: face["type"] for face in reduce.known_of(way.lines)["domain"]["faces"]}
        runs.check((kinds["xmin"], kinds["xmax"]) == ("symmetry", due), f"half_of_a_{box}_box", str(kinds))
    floats = reduce.reduced(scene("floats", POOL + " -solids p -p_shape sphere -p_radius 1e-3 -p_mass 2e-6")).why
    runs.check("the scene as it is" in floats and "a free body" in floats, "floats", floats)


def holding(known):
    """What holds for a scene, as the words of HOLDS."""
    model = known["model"]
    return ["rings"] * any(one["holds"] for one in model["revolution"]) + [
        f"across {one['across']}" for one in model["mirrors"] if one["holds"]] + [
        f"along {one['along']}" for one in model["uniform"] if one["holds"]] + [
        one["name"] for one in model["forces"] if one["vain"]]


def holds():
    """The models that isph finds where there is a trap."""
    for name, options, yes, no in HOLDS:
        found = holding(launch.known(scene(name, options)))
        for words, due in ((yes, True), (no, False)):
            for word in filter(None, words.split(", ")):
                runs.check((word in found) == due, f"{name}_{word}", str(found))
    for name, lag, due in (("both_rise_alike", "", True), ("one_sinks_earlier", "0.75 0 0 0.12\n", False)):
        motions = [runs.scratch(f"{name}_{side}") for side in "lr"]  # they differ between what all rows show
        for path, more in zip(motions, ("", lag)):
            with open(path, "w", encoding="utf-8") as file:
                file.write(f"0 0 0 0\n0.1 0 0 0.1\n0.5 0 0 0.2\n{more}1 0 0 0.1\n1.2 0 0 0.1\n")
        found = holding(launch.known(scene(name, TANK.format("0.5") + "-time_end 1.2 -solids l,r " + " ".join(
            f"-{side}_shape sphere -{side}_radius 0.15 -{side}_center {x},0,0.5 -{side}_motion_file {path}"
            for side, x, path in zip("lr", (-0.3, 0.3), motions)))))
        runs.check(("across x" in found) == due and "across y" in found, name, str(found))


def asked(name, options, text, budget=20):
    """(scene, quantities, arguments, what is known) of a question."""
    folder = runs.scratch(name)
    os.makedirs(folder, exist_ok=True)
    path = scene(name, options)
    return path, quantity.read(text), argparse.Namespace(output=folder, budget=budget, accuracy=10, jobs=2), \
        launch.known(path)


def squares():
    """As figures, in scenes that take longer."""
    figure(SQUARES)


def figure(rows):
    """A figure of a reduced scene is that of the whole: it is carried back by its column's row, and the program has run
    both."""
    for name, options, text, value, words in rows:
        path, (q,), arguments, _ = asked(name, options, text, PLENTY)
        reduced, why, _, doubt = answer.model(path, [q], arguments)
        runs.check(words in why and not doubt and "agree" in why, f"{name}_model", why)
        spacings = [launch.known(file)["domain"]["spacing"] for file in (path, reduced)]
        runs.check(spacings[0] == spacings[1], f"{name}_spacing", str(spacings))
        run = launch.Run(reduced, [], os.path.join(arguments.output, "run")).go()
        runs.check_within(q.of(run.series) / value, 0.93, 1.07, f"{name}_carried_back")


def beside(path, q, arguments, known, way):
    """Where cores are free whole and reduced run at once, and the verdict is the same; a whole that did not come to its
    end there runs again, for the time that is due."""
    real, words = launch.together, []
    for jobs, fails, due in ((2, False, [2, 2]), (4, False, [4]), (4, True, [4, 2])):
        calls = []

        def counting(made, most, ranks=1):
            done = real(made, most, ranks)
            for run in made[2:] if fails else ():
                run.series = None
            calls.append(len(made))
            return done

        arguments.jobs, arguments.budget, arguments.output = jobs, PLENTY, runs.scratch(f"beside_{jobs}_{fails}")
        os.makedirs(arguments.output)
        launch.together = counting
        words.append(answer.Proof(path, [q], arguments, known).judge(
            way, answer.write(os.path.join(arguments.output, "other.opts"), way, path))[1])
        launch.together = real
        runs.check(calls == due, f"runs_at_once_{jobs}_{fails}", str(calls))
    runs.check(words[0] == words[1] == words[2] and "differ" in words[0], "verdict_beside", str(words))


def figures():
    """Figures are carried back; a wrong model is found out."""
    figure(FIGURES)
    path, (q,), arguments, known = asked("wrong", TANK.format("0.3"), "force_zmin_z:mean=0.1,0.2")
    q.find(known["columns"])
    for share, due in ((1, True), (0.8, False)):
        whole = [(name, option["value"]) for name, option in reduce.Scene(path).options.items()]
        lines = [(name, f"0,0,{-9.81 * share}" if name == "gravity" else value) for name, value in whole]
        way = reduce.Way(lines, "another gravity", {d: d for d in "xyz"}, {"zmin": "zmin"})
        arguments.output = os.path.join(arguments.output, str(share))
        os.makedirs(arguments.output)
        good, words = answer.Proof(path, [q], arguments, known).judge(
            way, answer.write(os.path.join(arguments.output, "other.opts"), way, path))
        runs.check(good == due and ("agree" if due else "differ") in words, f"proof_of_{share:g}_gravity", words)
    beside(path, q, arguments, known, way)
    path, (q,), arguments, known = asked("second", TANK.format("0.3"), "force_zmin_z:mean=0.1,0.2", PLENTY)
    ways, reduce.ways = reduce.ways, lambda *_: [(reduce.Way(
        [(name, f"0,0,{-9.81 * share}" if name == "gravity" else value) for name, value in whole], f"{share} of g",
        {d: d for d in "xyz"}, {"zmin": "zmin"}), "") for share in (0.8, 1)]
    why = answer.model(path, [q], arguments)[1]
    reduce.ways = ways
    runs.check(why.startswith("1 of g") and "0.8 of g: whole and reduced differ" in why, "second_way", why)


def carries():
    """Which columns come back from which way."""
    def row(name, counts="sum", of="scene", whose="", direction=""):
        return {"name": name, "counts": counts, "of": of, "whose": whose, "direction": direction, "needs": []}
    known = reduce.Scene(scene("carries", TANK.format("0.25") + "-box_y periodic"))
    rings = reduce.rings(known, {"about": "z", "center": [0, 0, 0], "particles": 0.1})
    plane = reduce.plane(known, "y")
    half = reduce.mirrored(known, [{"across": "x", "gone": []}])
    quarter = reduce.Scene(os.path.join(runs.ROOT, "cases", "dry_wall", "case.opts"))
    back = reduce.rings(quarter, {"about": "z", "center": quarter.domain["lower"], "particles": 0.1}).carry(
        row("kinetic_energy"))
    runs.check(quarter.copies == 4 and back == ("kinetic_energy", 1), "rings_of_a_quarter", f"{back}, {quarter.copies}")
    for column, wanted in (
            (row("kinetic_energy"), (("kinetic_energy", 1), ("kinetic_energy", 0.5), ("kinetic_energy", 1))),
            (row("force_zmin_z", of="face", whose="zmin", direction="z"),
             (("force_ymin_y", 1), ("force_ymin_y", 0.5), ("force_zmin_z", 1))),
            (row("force_zmin_y", of="face", whose="zmin", direction="y"), (None, None, ("force_zmin_y", 1))),
            (row("force_xmax_x", of="face", whose="xmax", direction="x"),
             (None, ("force_xmax_x", 0.5), ("force_xmax_x", 1))),
            (row("force_xmin_x", of="face", whose="xmin", direction="x"), (None, ("force_xmin_x", 0.5), None)),
            (row("force_ymin_y", of="face", whose="ymin", direction="y"), (None, None, ("force_ymin_y", 1))),
            (row("highest", "value"), (("highest", 1), ("highest", 1), ("highest", 1))),
            (row("particles", "run"), (None, None, ("particles", 1))),
            (row("point_1_pressure", "value", "place"), (None, None, ("point_1_pressure", 1)))):
        for way, due in zip((rings, plane, half), wanted):
            got = way.carry(column)
            runs.check(got == due or got and due and got[0] == due[0] and math.isclose(got[1], due[1]),
                       f"{way.why[:12]}_{column['name']}", f"{got}, not {due}")


def drawn_lines(path):
    """How many lines of pictures a figure has: runs of its rows in which there is blue, that of the first body."""
    image = plt.imread(path)
    blue = ((image[:, :, 2] > image[:, :, 0] + 0.3).sum(axis=1) > 0).astype(int)
    return int((np.diff(blue) == 1).sum() + blue[0])


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
    file = subprocess.run(line + ["--output", short], capture_output=True, text=True)
    runs.check(file.returncode == 1 and file.stderr == f"answer.py: {short}: File exists.\n", "folder_that_is_a_file",
               file.stderr)
    again = subprocess.run(line + ["--budget", "0.01", "--accuracy", "0.01"], capture_output=True, text=True)
    runs.check("not converged" in again.stdout and "would cost" in again.stdout, "says_what_more_would_cost",
               again.stdout + again.stderr)
    with open(short, "a", encoding="utf-8") as file:
        file.write("-drop_velocity 0,-2\n")
    other = subprocess.run(line + ["--budget", "5", "--accuracy", "30"], capture_output=True, text=True)
    values = [re.search(r"highest:end = (?:not converged[^:]*: )?(\S+)", done.stdout).group(1)
              for done in (first, other)]
    runs.check(abs(float(values[0]) / float(values[1]) - 1) > 0.1, "a_changed_scene_is_run_again", str(values))
    bad = subprocess.run(line + ["--accuracy", "-1"], capture_output=True, text=True)
    runs.check(bad.returncode == 1 and "ACCURACY=-1" in bad.stderr, "refuses_accuracy", bad.stderr)
    found = subprocess.run([sys.executable, os.path.join(TOOLS, "study.py"), short, "--vary",
                            "drop_velocity=0,-0.5;0,-1 spacing=2e-4..4e-4/2", "--quantity", "highest:end", "--output",
                            runs.scratch("study")], capture_output=True, text=True)
    with open(os.path.join(runs.scratch("study"), "drop_velocity_spacing", "study.csv"), encoding="utf-8") as file:
        rows = file.read().splitlines()
    runs.check(found.returncode == 0 and len(rows) == 5, "study", found.stdout + found.stderr)
    with open(os.path.join(runs.scratch("study"), "drop_velocity_spacing", "study.html"), encoding="utf-8") as file:
        shown = file.read()
    runs.check(f"<td>{rows[1].split(',')[-2]}</td>" in shown and shown.count("<tr>") == 5,
               "page_of_a_study", shown[:300])
    runs.check_within(drawn_lines(os.path.join(runs.scratch("study"), "drop_velocity_spacing", "variants.png")), 4, 4,
                      "variants_side_by_side")
    runs.check([study.axis_value(word, 5) for word in ("-90", "3,4", "red")] == [-90, 5, 5], "axis_of_a_study")
    refused(lambda: study.vary("a"), "OPTION=VALUE", "refuses_vary")
    refused(lambda: study.values_of("1..2"), "LOW..HIGH/COUNT", "refuses_range")


def couette(time):
    """Kinetic energy (J/m) of liquid between walls 1 m apart and 0.4 m long, one of which moves at 1 m/s, from rest."""
    y = np.linspace(0, 1, 2001)
    u = y + sum(2 * (-1)**n / (n * math.pi) * np.exp(-(n * math.pi)**2 * 0.5 * time) * np.sin(n * math.pi * y)
                for n in range(1, 40))
    return 0.4 * 0.5 * 1000 * float(np.trapz(u * u, y))


def packings():
    """Chance decides how many packings a spacing needs."""
    found = answer.Answer(*asked("packings", TANK.format("0.3"), "highest:max")[:3])
    for chance, count, spacings, cost, due in ((0, 0, 0, 1, 3), (0.02, 3, 1, 1, 2), (0.0924, 3, 1, 1, 3),
                                               (9, 2, 1, 1, 3), (math.inf, 1, 1, 1, 3), (9, 3, 1, 4, 2),
                                               (9, 3, 1, 9, 1), (9, 3, 2, 1, 1)):
        found.rungs = [(1, [None] * count)] * spacings  # budget 20 s
        one = argparse.Namespace(chance=chance * 0.5, value=1, size=1)  # the accuracy is 10 %
        runs.check(found.needed([one], cost) == due, f"packings_for_{chance:g}_of_{count}_{spacings}_{cost}",
                   str(found.needed([one], cost)))
    words = launch.command(found.scene, ["-spacing", "0.02", "-output_dir", runs.scratch("bounded")])
    code, said, spent = launch.start(words, 1)
    runs.check(code and "not done after 1 s of the processor" in said and 0.8 <= spent < 3, "a_run_has_a_bound",
               f"{code}, {said}, {spent}")
    made, tried = launch.Run.go, []

    def failing(run):  # every second packing
        seed = int(run.options[-1])
        tried.append((run.options[-3], seed))
        run.cpu, run.series = 0.01, {"time": [0, 1], "highest": [seed, seed]} if seed % 2 else None
        return run
    launch.Run.go, found.rungs, found.arguments.accuracy = failing, [], 1e-3
    found.climb()
    launch.Run.go = made
    runs.check(len(tried) == len(set(tried)) and max(seed for _, seed in tried) > 3, "a_packing_that_failed_is_left",
               str(tried[:12]))


def passed():
    """From the third spacing on runs end when a maximum has passed, and go on where it comes later; a single dear run
    has all cores, if they are free."""
    path, quantities, arguments, known = asked("passed", TANK.format("0.3"), "highest:max")
    arguments.accuracy, arguments.budget = 1e-3, 1e9
    made, tried = launch.Run.go, []

    def peaking(run):
        ends = float(run.options[run.options.index("-time_end") + 1]) if "-time_end" in run.options else 0.2
        spacing = float(run.options[-3])
        peak = 0.09 if spacing < 0.03 else 0.03
        t = np.linspace(0, ends, 201)
        run.cpu, run.wall = 100, 100 / run.ranks
        run.series = {"time": t, "highest": np.where(abs(t - peak) < 0.02, 1 + spacing, 0)}
        tried.append((spacing, ends, run.ranks))
        return run
    launch.Run.go = peaking
    found = answer.Answer(path, quantities, arguments)
    verdicts, _ = found.climb()
    spacings = sorted({s for s, _, _ in tried}, reverse=True)
    ends = [[e for s, e, _ in tried if s == spacing] for spacing in spacings]
    runs.check(set(ends[0] + ends[1]) == {0.2}, "two_spacings_run_whole", str(ends))
    runs.check(all(abs(e - 0.055) < 2e-3 for e in ends[2]), "then_until_it_has_passed", str(ends))
    again = next(k for k, of in enumerate(ends) if k > 1 and max(of) > 0.1)
    runs.check(ends[again][0] < 0.06 and ends[again][-1] == 0.2, "again_where_it_comes_later", str(ends))
    runs.check_within(verdicts[0].value, 1, 1.1, "and_finds_it")
    runs.check({r for s, _, r in tried if s == spacings[0]} == {1}, "what_has_no_price_is_not_divided", str(tried))
    runs.check({r for s, _, r in tried if s in spacings[2:]} == {2}, "a_single_dear_run_is", str(tried))
    finer = 0.5 * found.rungs[-1][0]
    runs.check(found.ranks(finer, 1) == 2, "on_a_machine_that_is_free", str(found.ranks(finer, 1)))
    for run in found.rungs[-1][1]:
        run.wall = 300
    runs.check(found.ranks(finer, 1) == 1, "not_on_a_busy_machine", str(found.ranks(finer, 1)))
    launch.Run.go = made
    later = answer.Answer(path, quantity.read("highest:at=0.1,highest:mean=0.02,0.05"), arguments)
    run = later.run(0.1, [1])[0]
    runs.check_within(run.series["time"][-1], 0.1, 0.1 + 1e-9, "a_value_at_a_time_ends_there")
    divided = launch.Run(path, ["-spacing", "0.1", "-packing_seed", "1"], runs.scratch("divided"))
    os.environ.update(runs.mpi.ANY)
    launch.together([divided], 1, 2)
    runs.check(not divided.reason, "a_run_on_two_ranks_ends", divided.reason)
    with open(os.path.join(divided.folder, "log.txt"), encoding="utf-8") as file:
        runs.check("on 2 ranks" in file.read(), "a_run_on_two_ranks")
    runs.check_within(divided.series["time"][-1], 0.2 - 1e-9, 0.2 + 1e-9, "which_ends")


def resting(times, curve):
    """The time at which the curve has stayed within 2 % of its range since half of it."""
    return next((t for t in times[10:] if np.ptp(curve[(times >= t / 2) & (times <= t)]) <= 0.02 * np.ptp(
        curve[times <= t])), math.inf)


def keys():
    """Another program, or another content of a file, is another run."""
    path, other = scene("keys", TANK.format("0.3")), runs.scratch("isph")
    marks = [launch.mark_of(launch.known.__wrapped__(path))]
    shutil.copy(launch.program(), other)
    before = os.environ.get("ISPH")
    os.environ["ISPH"] = other
    marks.append(launch.mark_of(launch.known.__wrapped__(path)))
    with open(other, "ab") as file:
        file.write(b"another")
    marks.append(launch.mark_of(launch.known.__wrapped__(path)))
    os.environ.pop("ISPH")
    if before:
        os.environ["ISPH"] = before
    runs.check(marks[0] == marks[1] != marks[2], "key_of_the_program", str(marks))
    table, marks = runs.scratch("moved.csv"), []
    path = scene("moved", TANK.format("0.3") + f"-solids p -p_shape sphere -p_radius 0.2 -p_motion_file {table}")
    for way in (0.1, 0.1, 0.2):
        with open(table, "w", encoding="utf-8") as file:
            file.write(f"0,0,0,0\n1,{way},0,0\n")
        marks.append(launch.mark_of(launch.known.__wrapped__(path)))
    runs.check(marks[0] == marks[1] != marks[2], "key_of_a_table", str(marks))


def coarse():
    """The ladder begins where the smallest body has twelve spacings across, dear ones coarser."""
    for spacings, due in (([48, 17.1], 1), ([48], 4), ([12], 0), ([8], -2), ([1e6], answer.COARSEST), ([], 0)):
        found = answer.coarseness({"bodies": [{"spacings": one} for one in spacings]}, 12)
        runs.check(found == due, f"coarse_{spacings}", str(found))
    path, (q,), arguments, known = asked("first", TANK.format("0.3"), "highest:max", 100)
    proof = answer.Proof(path, [q], arguments, known)
    for cheaper, cpu, due in ((1, 1, 0.2), (50, 1, 0.02), (500, 1, None)):  # 10 s of 100 for two runs of the whole
        found = proof.short(argparse.Namespace(cheaper=cheaper), [argparse.Namespace(cpu=cpu)])[0]
        runs.check(found == due or due and abs(found / due - 1) < 1e-9, f"time_of_a_proof_{cheaper}", str(found))
    found = answer.Answer(path, [q], arguments)
    for coarser, price, due in ((3, None, -3), (-2, None, 0), (-2, (0.1, 0.1), 2), (-2, (0.1, 1), 0),
                                (0, (0.1, 1e3), -answer.COARSEST)):
        found.coarser, found.price = coarser, price
        runs.check(found.first() == due, f"first_step_{coarser}_{price}", str(found.first()))


def rests():
    """A run ends when the exact solution says so, on any number of ranks, and not before all motions have come."""
    slit = "-dimension 2 -spacing 0.04 -box_lower 0,0 -box_upper 0.4,1 -box_x periodic -box_y wall -bodies a " \
        "-a_viscosity 500 -box_ymax_velocity 1,0 -time_end 3 -snapshot_interval 0 "
    exact = np.linspace(0.01, 3, 300)
    due = resting(exact, np.array([couette(t) for t in exact]))
    for ranks in (1, 2):
        folder = runs.run(f"-options_file {scene('slit', slit)} -stop_at_rest", f"slit_{ranks}", ranks=ranks)
        series = runs.series(folder)
        runs.check_within(series["time"][-1] / due, 0.95, 1.25, f"rests_when_the_solution_does_on_{ranks}")
        ended = resting(series["time"], series["kinetic_energy"])
        runs.check_within(series["time"][-1] / ended, 1, 1.05, f"rests_when_its_curve_does_on_{ranks}")
        with open(os.path.join(folder, "log.txt"), encoding="utf-8") as file:
            runs.check("at rest at" in file.read(), f"says_that_it_rests_on_{ranks}")
        runs.check_within(series["kinetic_energy"][-1] / couette(9), 0.97, 1.03, f"value_at_rest_on_{ranks}")
    flight = CUBE.replace("1e-3", "2e-3") + "-box_x periodic -bodies a -a_shape sphere -a_radius 1e-3 -a_viscosity 1 " \
        "-a_velocity 1,0,0 -a_velocity_type strain -a_strain_rate 60,-60,0"  # which decays, a share of its energy
    runs.check_within(runs.series(runs.run(f"-options_file {scene('flight', flight)} -stop_at_rest", "flight"))["time"][
        -1], 1.999e-3, 2.001e-3, "a_drop_in_flight_does_not_rest")
    table = runs.scratch("late.txt")
    with open(table, "w", encoding="utf-8") as file:
        file.write("0 0 0\n2.5 0 0\n3 0.1 0\n")
    late = slit + f"-solids p -p_shape sphere -p_radius 0.1 -p_center 0.2,0.4 -p_motion_file {table}"
    runs.check_within(runs.series(runs.run(f"-options_file {scene('late', late)} -stop_at_rest", "late"))["time"][-1],
                      2.999, 3.001, "what_is_to_move_does_not_rest")
    gone = slit + "-gauge_neck y -stop_at_rest kinetic_energy,neck_diameter"  # there is no neck
    runs.check_within(runs.series(runs.run(f"-options_file {scene('gone', gone)}", "gone"))["time"][-1], 2.999, 3.001,
                      "a_column_without_a_value_does_not_rest")
    path, quantities, arguments, known = asked("at_rest", slit.replace("-time_end 3", "-time_end 0.2"),
                                               "kinetic_energy:rest")
    quantities[0].find(known["columns"])
    found = answer.Answer(path, quantities, arguments)
    series = found.run(0.04, [1])[0].series
    runs.check_within(quantities[0].of(series) / couette(9), 0.97, 1.03, "a_value_at_rest_runs_on")
    runs.check(not quantities[0].remarks(series), "rest_is_rest", str(quantities[0].remarks(series)))
    short = found.more.copy()
    found.more = short[2:]
    said = quantities[0].remarks(found.run(0.04, [2])[0].series)
    runs.check("still changes" in str(said), "says_that_it_does_not_rest", str(said))
    for text, words in (("highest:end", ["-stop_at_rest"]), ("highest:end,highest:max", []),
                        ("highest:at=0.1", []), ("highest:rest", ["-time_end", "-stop_at_rest"])):
        made = quantity.ends(quantity.read(text), known)
        runs.check([w for w in made if w[0] == "-"] == words, f"ends_{text}", str(made))
    refused(lambda: quantity.ends(quantity.read("highest:rest,highest:max"), known), "rest needs", "rest_beside_max")


def mean(values):
    """Of the second half."""
    return sum(values[len(values) // 2:]) / (len(values) - len(values) // 2)


def models():
    """A reduced scene gives what the whole gives within what another packing changes: the mean energy of the second
    half of the run, and the height."""
    for name, options, _, tolerance in REDUCED:
        if not tolerance:
            continue
        path = scene(name, options + " -snapshot_interval 0 -checkpoint_interval 0 -series_interval 1e-4")
        way = reduce.reduced(path)
        why, lean = way.why, answer.write(runs.scratch(f"{name}_reduced.opts"), way, path)
        whole, part = (runs.series(runs.run(f"-options_file {file} ", os.path.basename(file)[:-5]))
                       for file in (path, lean))
        for column in ("kinetic_energy",) + (("highest",) if "gravity" in options else ()):  # else there is no height
            share = 8e-3 if "a plane" in why and column == "kinetic_energy" else 1
            ratio = share * mean(part[column]) / mean(whole[column])
            runs.check_within(ratio, 1 - tolerance, 1 + tolerance, f"{name}_{column}: {why[:30]}")


PARTS = {"ladders": ladders, "diverging": diverging, "quantities": quantities, "reductions": reductions,
         "models": models, "programs": programs, "holds": holds, "figures": figures, "squares": squares,
         "carries": carries, "rests": rests, "coarse": coarse, "packings": packings, "passed": passed, "keys": keys}
for part in runs.parts(*PARTS):
    PARTS[part]()
runs.done()
