#!/usr/bin/python3
"""How tests/verify/runner.py judges: every kind of tolerance, a run that dies, a check that cannot judge, known misses
and their bands, and the markers of the READMEs."""
import contextlib
import io
import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import numpy as np  # noqa: E402
import cases  # noqa: E402
import misses  # noqa: E402
import physics  # noqa: E402
import runner  # noqa: E402
import runs  # noqa: E402

for result, wanted in ((physics.relative("a", 4.5690, 4.5674, 0.005), True),
                       (physics.relative("a", 4.6, 4.5674, 0.005), False),
                       (physics.relative("a", -0.99, -1, 0.02), True), (physics.absolute("a", 1.5, 1, 0.5), True),
                       (physics.absolute("a", 1.6, 1, 0.5), False), (physics.at_most("a", -0.1, 0.01), False),
                       (physics.at_most("a", 0, 0), True), (physics.at_least("a", 81, 80), True),
                       (physics.at_least("a", 79, 80), False), (physics.shown("a", 1), None)):
    runs.check(result.passed() is wanted, f"{result.kind}_{result.measured:g}", f"{result.passed()}, not {wanted}")
for make in (physics.relative, physics.absolute):
    runs.check(make("a", math.nan, 1, 0.5).passed() is False, f"nan_is_not_{make.__name__}", "it passed")
runs.check(physics.at_most("a", math.nan, 1).passed() is False, "nan_is_not_at_most", "it passed")
runs.check(physics.at_least("a", math.nan, 1).passed() is False, "nan_is_not_at_least", "it passed")

# what the checks of the cases share: series, quadrature, second moments, pieces
j0, j1 = physics.bessel([0, 1, 5, 10])
known = np.array([[1, 0.7651976866, -0.1775967713, -0.2459357645], [0, 0.4400505857, -0.3275791376, 0.0434727462]])
runs.check(np.abs(np.array([j0, j1]) - known).max() < 1e-9, "bessel", f"{j0}, {j1}")
turn = physics.integrate(lambda y: np.array([y[1], -y[0]]), [1, 0], 0, [0.5, 2], 50)
runs.check(np.abs(turn - [[np.cos(t), -np.sin(t)] for t in (0.5, 2)]).max() < 1e-7, "quadrature", turn)
axes = physics.ellipse(0.5, 0, [1.0])[0]  # without a force a b is kept, and s = a'/a
runs.check(abs(axes.prod() - 1) < 1e-9 and axes[0] > 1.2, "ellipse", axes)
square = np.stack(np.meshgrid(*[(np.arange(400) + 0.5) / 200 - 1] * 2), axis=-1).reshape(-1, 2)
disc = square[(square**2).sum(axis=1) < 1] * [3, 0.5] + [7, -2]
runs.check(np.abs(physics.semi_axes(disc) - [3, 0.5]).max() < 0.01, "semi_axes", physics.semi_axes(disc))
time = np.linspace(0, 4, 400)
found = physics.damped_cosine(time, 3 + np.exp(-0.3 * time) * np.cos(5 * time + 1), 5.3, 0.1)
runs.check(abs(found[0] - 5) < 1e-3 and abs(found[1] - 0.3) < 1e-3, "damped_cosine", found)
runs.check(len(physics.damped_cosine(time, time**2, 1, 0.1)) == 3, "damped_cosine of what has none ends")
row = np.array([[x, 0, 0] for x in (9, 0, 1, 2, 3.2, 4.2)])
runs.check(list(physics.components(row, 1.1)) == [2, 0, 0, 0, 1, 1], "pieces", physics.components(row, 1.1))
grown = physics.components(row, 1.1, np.array([1, 1, 1, 1.2, 1.2, 1]))
runs.check(list(grown) == [1, 0, 0, 0, 0, 0], "pieces_of_two_sizes", grown)
plane, halves = {"axisymmetric": 0}, np.array([0.5, 0.5])
for name, last, wanted in (("joined", [1.0], True), ("went", [0.5], False)):
    result = physics.lost(plane, {"id": np.arange(2), "volume": halves}, {"id": np.arange(1), "volume": np.array(last)})
    runs.check(result.passed() is wanted, f"half_of_two_sizes_that_{name}", result.words())
runs.check(physics.lost(plane, {"id": np.arange(2)}, {"id": np.arange(1)}).passed() is False, "half_that_went",
           "it passed")
line = [physics.relative("a", 5 + 2 * s, 5, 1) for s in (0.4, 0.2, 0.1)]
runs.check(runner.extrapolated(line, (0.4, 0.2, 0.1)) == "5", "extrapolated",
           runner.extrapolated(line, (0.4, 0.2, 0.1)))

words = physics.relative("period", 4.56902, 4.5674, 0.005, "s").words()
runs.check(words == ("4.5690 s", "4.5674 s", "0.5 %"), "words_of_a_result", words)

entry = cases.Entry("couette", options="-no_such_option 1")
outcome = runner.execute(entry, runs.scratch("dies"))
rows = outcome.rows()
died = len(rows) == 1 and rows[0]["pass"] == "NO" and "no_such_option" in rows[0]["measured"]
runs.check(died, "a_run_that_dies", rows)
outcome = runner.execute(entry._replace(options="-time_end 1e-3"), runs.scratch("judged"))
runs.check(not outcome.reason and outcome.seconds > 0, "a_run_that_is_judged", outcome.reason)
outcome = runner.execute(cases.Entry("film_at_rest"), "", existing=runs.scratch("judged"))
runs.check(outcome.reason.startswith("check: "), "a_check_that_cannot_judge", outcome.reason)

entry = cases.Entry("couette", "known")
BAND = misses.Record(entry.id, "a", 2.0, 1.8, 2.2)
CHANCE = BAND._replace(low=0.0, why="it comes and goes")
STOPS = BAND._replace(quantity="run", measured=0.3, low=0.1, high=0.9)


def judged(measured, *records, of=entry, result=None, reason=""):
    """[(word, remark)] of an outcome of the row 'a', at most 1, beside these records; the last one is of the total."""
    results = [] if reason else [result or physics.at_most("a", measured, 1)]
    rows = runner.Outcome(of, results, reason).rows({record[:2]: record for record in records})
    return [(row["pass"], row["remark"]) for row in rows]


STOPPED = "stopped at {} s, step 3: the pressure is too large"
for name, found, words in (
        ("miss_without_record", judged(2.0), ["beyond its tolerance"]),
        ("miss_in_its_band", judged(2.1, BAND), []),
        ("worse_than_the_band", judged(2.3, BAND), ["left its band"]),
        ("better_than_the_band", judged(1.7, BAND), ["left its band"]),
        ("not_a_number", judged(math.nan, BAND), ["left its band"]),
        ("cured", judged(0.9, BAND), ["cured"]),
        ("cured_in_a_band_that_reaches_far", judged(0.9, BAND._replace(low=0.0)), ["cured"]),
        ("chance_within_tolerance", judged(0.9, CHANCE), []),
        ("chance_left_its_band", judged(2.3, CHANCE), ["left its band"]),
        ("record_of_a_row_that_is_not_judged", judged(0, BAND, result=physics.shown("a", 2.0)), ["no tolerance"]),
        ("record_without_a_row", judged(0.9, BAND._replace(quantity="b")), ["no such row"]),
        ("record_of_another_entry", judged(2.0, BAND._replace(id="poiseuille")), ["beyond its tolerance"]),
        ("printed_scheme_is_judged", judged(2.3, BAND._replace(id="couette-known-printed"),
                                            of=entry._replace(printed=True)), ["left its band"]),
        ("stop_without_record", judged(0, reason=STOPPED.format(0.3)), ["beyond its tolerance"]),
        ("stop_in_its_band", judged(0, STOPS, reason=STOPPED.format(0.3)), []),
        ("stop_too_early", judged(0, STOPS, reason=STOPPED.format(0.01)), ["left its band"]),
        ("stop_for_another_reason", judged(0, STOPS, reason="not done after 300 s"), ["left its band"]),
        ("stop_is_cured", judged(0.9, STOPS), ["cured"]),
        ("stop_by_chance_did_not_happen", judged(0.9, STOPS._replace(why="it comes and goes")), [])):
    remarks = [remark for word, remark in found if word == misses.FAILED]
    fits = len(remarks) == len(words) and all(part in remark for part, remark in zip(words, remarks))
    runs.check(fits, name, found)
known = runner.Outcome(entry, [physics.at_most("a", 2.1, 1), physics.at_most("c", 0, 1)]).rows({BAND[:2]: BAND})
runs.check(runner.failures(known) == 0 and runner.counts(known) == "1 within tolerance, 1 known misses, 0 failed",
           "known_misses_are_counted", runner.counts(known))


def codes(measured):
    """Exit codes of `make verify` and of the physics of `make test`, of a run of couette that gave this."""
    listed = next(e for e in cases.ENTRIES if e.id == "couette")
    outcome = runner.Outcome(listed, [physics.at_most("a", measured, 1)])
    kept = runner.OUTPUT, runner.everything, runner.execute, misses.read
    runner.OUTPUT, runner.everything = runs.scratch("verify"), lambda *_: [outcome]
    runner.execute, misses.read = lambda *_: outcome, lambda: {("couette", "a"): BAND._replace(id="couette")}
    with contextlib.redirect_stdout(io.StringIO()):
        found = runner.verify([listed], 1, {}), runner.test([listed])
    runner.OUTPUT, runner.everything, runner.execute, misses.read = kept
    return found


runs.check(codes(2.1) == (0, 0), "known_misses_end_with_0", codes(2.1))
for measured in (0.9, 1.7, 2.3):
    runs.check(codes(measured) == (1, 1), f"others_end_with_1_{measured}", codes(measured))
other = runner.Outcome(entry._replace(named="other"), [physics.at_most("a", 2, 1)]).rows({})
runs.check(other[0]["pass"] == misses.FAILED, "named_parts_are_judged", other)

# a table that is written anew: what ran takes the place of what stood there, what did not run stays
couette = next(e for e in cases.ENTRIES if e.id == "couette")
TABLE = runs.scratch("table.md")
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("""<!-- verify -->
| case | quantity | default scheme | expected | tolerance | within | as printed |
| --- | --- | --- | --- | --- | --- | --- |
| couette | a | 5 | - | at most 1 | NO | 3 (!) |
|  | went | 0 | - | at most 0 | yes | - |
|  | printed alone | - | - | at most 1 | - | 0.5 |

from runs among abcdef0 (2026-01-01).
<!-- /verify -->""")
for of, wanted in ((couette, [["a", "0.7", "yes", "3 (!)"], ["printed alone", "-", "-", "0.5"]]),
                   (couette._replace(printed=True), [["a", "5", "NO", "0.7"], ["went", "0", "yes", "-"]])):
    lines = runner.side_by_side(runner.Outcome(of, [physics.at_most("a", 0.7, 1)]).rows({}), TABLE).splitlines()
    found = [[line.split("|")[k].strip() for k in (2, 3, 6, 7)] for line in lines[2:] if line.startswith("|")]
    runs.check(found == wanted, f"rows_that_stay_beside_{of.scheme.partition(' ')[0]}", found)
    runs.check("abcdef0" in lines[-1], f"version_of_what_stays_beside_{of.scheme.partition(' ')[0]}", lines[-1])
every = [row for e in cases.ENTRIES if e.case == "couette"
         for row in runner.Outcome(e, [physics.at_most("a", 0.7, 1)]).rows({})]
runs.check("abcdef0" not in runner.side_by_side(every, TABLE), "no_version_of_which_nothing_stays",
           runner.side_by_side(every, TABLE)[-200:])


def refused(*lines):
    """What misses.read says of a file with these lines."""
    with open(runs.scratch("misses.csv"), "w", encoding="utf-8") as file:
        file.write("\n".join(("# a comment", "id,quantity,measured,low,high,why") + lines) + "\n")
    try:
        return str(misses.read(runs.scratch("misses.csv")))
    except ValueError as error:
        return "refused: " + str(error)


LINE = 'couette,"speed, last",2,1.8,2.2,'
runs.check(refused(LINE) == str({("couette", "speed, last"): misses.Record("couette", "speed, last", 2.0, 1.8, 2.2)}),
           "records_are_read", refused(LINE))
runs.check("two records" in refused(LINE, LINE), "two_records", refused(LINE, LINE))
runs.check("not in its band" in refused(LINE.replace("2,1.8", "3,1.8")), "record_outside_its_band", "read")

path = runs.scratch("README.md")
with open(path, "w", encoding="utf-8") as file:
    file.write("a\n<!-- verify -->\nold\n<!-- /verify -->\nb\n")
runs.replace(path, "verify", "new \\1")
with open(path, encoding="utf-8") as file:
    text = file.read()
runs.check(text == "a\n<!-- verify -->\nnew \\1\n<!-- /verify -->\nb\n", "markers", text)
for name, place in (("tradeoff", "tests/tradeoff"), ("extremes", "tests/extremes"), ("bench", "tests/bench")):
    with open(os.path.join(runs.ROOT, place, "README.md"), encoding="utf-8") as file:
        text = file.read()
    placed = text.count(f"<!-- {name} -->\n") == text.count(f"<!-- /{name} -->\n") == 1
    runs.check(placed, f"markers_{name}", f"not once in {place}/README.md")
for name in dict.fromkeys(e.case for e in cases.ENTRIES):
    old, new = runner.chosen(name)
    runs.check(old and old == new, f"chosen_{name}", f"make verify-readme would change cases/{name}/README.md")
order = runner.order_of([0.04, None, 0.01], [0.2, 0.1, 0.1])
runs.check(order == "2.0", "observed_order", order)

identifiers = [e.id for e in cases.ENTRIES]
runs.check(len(set(identifiers)) == len(identifiers), "entries_differ", sorted(identifiers))
lost = {owner for owner, _ in misses.read()} - set(identifiers)
runs.check(not lost, "known_misses_have_entries", f"misses.csv has records of {lost}")
for case in sorted({e.case for e in cases.ENTRIES}):
    both = {e.printed for e in cases.ENTRIES if e.case == case}
    # the printed scheme knows no contact angle
    alone = case == "contact_angle" or case in cases.GALLERY | cases.DEFAULT_ONLY
    runs.check(both == {True, False} or alone, f"both_schemes_{case}", both)
    runs.check(callable(runner.load(case)), f"check_{case}", "no check(folder)")
listed = {e.case for e in cases.ENTRIES}
folders = {name for name in os.listdir(os.path.join(runs.ROOT, "cases"))
           if os.path.exists(os.path.join(runs.ROOT, "cases", name, "check.py"))}
runs.check(folders == listed, "every_case_is_listed", folders ^ listed)
runs.done()
