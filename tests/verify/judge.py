#!/usr/bin/python3
"""How tests/verify/runner.py judges: every kind of tolerance, a run that dies, a check that cannot judge, the rows of
the reference scheme, and the markers of the READMEs."""
import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import cases  # noqa: E402
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
printed = runner.Outcome(entry._replace(printed=True), [physics.at_most("a", 2, 1)]).rows()
reported = printed[0]["pass"] == "reported: no" and runner.counts(printed) == (0, 0)
runs.check(reported, "printed_scheme_is_reported", printed)

path = runs.scratch("README.md")
with open(path, "w", encoding="utf-8") as file:
    file.write("a\n<!-- verify -->\nold\n<!-- /verify -->\nb\n")
runs.replace(path, "verify", "new \\1")
with open(path, encoding="utf-8") as file:
    text = file.read()
runs.check(text == "a\n<!-- verify -->\nnew \\1\n<!-- /verify -->\nb\n", "markers", text)
for name, place in (("verify", "cases"), ("tradeoff", "tests/tradeoff"), ("extremes", "tests/extremes"),
                    ("bench", "tests/bench")):
    with open(os.path.join(runs.ROOT, place, "README.md"), encoding="utf-8") as file:
        text = file.read()
    placed = text.count(f"<!-- {name} -->\n") == text.count(f"<!-- /{name} -->\n") == 1
    runs.check(placed, f"markers_{name}", f"not once in {place}/README.md")
order = runner.order_of([0.04, None, 0.01], [0.2, 0.1, 0.1])
runs.check(order == "2.0", "observed_order", order)

identifiers = [e.id for e in cases.ENTRIES]
runs.check(len(set(identifiers)) == len(identifiers), "entries_differ", sorted(identifiers))
for case in sorted({e.case for e in cases.ENTRIES}):
    both = {e.printed for e in cases.ENTRIES if e.case == case}
    # the printed scheme knows no contact angle
    alone = case == "contact_angle" or case in cases.GALLERY
    runs.check(both == {True, False} or alone, f"both_schemes_{case}", both)
    runs.check(callable(runner.load(case)), f"check_{case}", "no check(folder)")
listed = {e.case for e in cases.ENTRIES}
folders = {name for name in os.listdir(os.path.join(runs.ROOT, "cases"))
           if os.path.exists(os.path.join(runs.ROOT, "cases", name, "check.py"))}
runs.check(folders == listed, "every_case_is_listed", folders ^ listed)
runs.done()
