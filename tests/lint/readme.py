#!/usr/bin/python3
"""README.md stays short: at most 200 lines of at most 120 columns, and its tables whole. Functions that it and
CONTRIBUTING.md name as `file:function` are defined in that file of src/, and the README names one for each equation of
the paper, (1) to (11). The sub-steps of its table of the default scheme are those that the scheme documents, and its
functions are called in that order. LINT_ROOT: another tree, for a test of the test."""
import os
import re
import sys

import verdict

ROOT = os.environ.get("LINT_ROOT", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
LINES, COLUMNS, EQUATIONS = 200, 120, 11
SCHEME, STEP = "src/stepper/consistent.c", "ConsistentStep"
bad = []


def defines(path, function):
    """Whether a file of src/ defines a function: its name and parameters at the start of a line, then a brace."""
    try:
        with open(os.path.join(ROOT, "src", path), encoding="utf-8") as file:
            return re.search(rf"^[A-Za-z][\w *]*\b{function}\([^;{{]*\)\s*\{{", file.read(), re.M) is not None
    except OSError:
        return False


def numbers(cell):
    """The equations that a cell names: '(8) left' is 8, '(5)-(7)' is 5, 6, 7."""
    ends = [int(n) for n in re.findall(r"\((\d+)\)", cell)]
    return set(range(ends[0], ends[-1] + 1)) if ends else set()


def lines_of(document):
    with open(os.path.join(ROOT, document), encoding="utf-8") as file:
        return file.read().splitlines()


def scheme(rows):
    """What differs between the README's rows (sub-step, function) and the comment above the scheme, or its calls."""
    comment, _, source = "\n".join(lines_of(SCHEME)).partition("*/")
    documented = re.findall(r"^ {5}(\w+)  +\S", comment, re.M)
    shown = [name for name, _ in rows if name in documented]
    if shown != documented:
        yield f"{SCHEME} documents the sub-steps {documented}, README.md shows {shown}"
    step = source.split(f" {STEP}(")[1].split("\n}\n")[0]
    calls = [call.start() for call in (re.search(rf"\b{function}\(", step) for _, function in rows) if call]
    if len(calls) < 3 or calls != sorted(calls):
        yield f"{STEP} does not call the functions of README.md's table in that order"


lines = lines_of("README.md")
table = "\n".join(lines).split("| sub-step |")[-1].split("\n\n")[0]
bad += scheme(re.findall(r"^\| (\w+) \|.*`[\w/.]+:(\w+)` \|$", table, re.M))
if len(lines) > LINES:
    bad.append(f"README.md has {len(lines)} lines, at most {LINES}")
bad += [f"README.md:{k}: {len(line)} columns, at most {COLUMNS}" for k, line in enumerate(lines, 1)
        if len(line) > COLUMNS]
named, equations = 0, set()
for document in ("README.md", "CONTRIBUTING.md"):
    for k, line in enumerate(lines_of(document), 1):
        for path, function in re.findall(r"`([\w/]+\.[ch]):(\w+)`", line):
            named += 1
            equations |= numbers(line.split("|")[1]) if document == "README.md" else set()
            if not defines(path, function):
                bad.append(f"{document}:{k}: src/{path} defines no function {function}")
for k, (above, line) in enumerate(zip(lines, lines[1:]), 2):
    if above.startswith("|") and line.startswith("|") and above.count("|") != line.count("|"):
        bad.append(f"README.md:{k}: the table has rows of different length")
missing = sorted(set(range(1, EQUATIONS + 1)) - equations)
if missing:
    bad.append(f"README.md names no function for the equations {missing}")
verdict.end("readme", bad, f"{len(lines)} lines, {named} functions")
