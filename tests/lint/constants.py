#!/usr/bin/python3
"""Named numbers of src/ say where they come from. A `#define NAME 0.5`, with a decimal point or an exponent, has a
comment, behind it or above its group, that gives a source, a measurement or a reason. One whose comment only says
what it is, or says "no reference", has its name and file in a row of CONTRIBUTING.md, "Where physics is wanted".
Those rows name nothing that is not there. LINT_ROOT: another tree, for a test of the test."""
import glob
import os
import re

import verdict

ROOT = os.environ.get("LINT_ROOT", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
NUMBER = re.compile(r"#define (\w+)\s+\(?(-?[\d.]+(?:e-?\d+)?)\)?\s*(/\*.*)?$")
# words of a reason: a year, a measured share, a comparison, a place to read, a clause behind a colon or semicolon
REASON = re.compile(r"\b(1[89]|20)\d\d\b|%|[:;=]|cases/|tests/|\b(so that|else|because|as in|see|tried|stable|round\w*|"
                    r"than|with|without|takes|is|are|has|have|must)\b", re.I)


def constants(lines):
    """[(name, its comments)] of the numbers with a decimal point or an exponent."""
    for k, line in enumerate(lines):
        found = NUMBER.match(line)
        if not found or not re.search(r"[.e]", found[2]):
            continue
        behind, last = found[3] or "", k
        while behind and "*/" not in behind:
            last += 1
            behind += " " + lines[last].strip()
        above, first = "", k - 1
        while first >= 0 and lines[first].startswith("#define"):
            first -= 1
        if first > 0 and lines[first].rstrip().endswith("*/"):
            end = first
            while not lines[first].lstrip().startswith("/*"):
                first -= 1
            above = " ".join(lines[first:end + 1]) if first > 0 else ""  # the head of the file is about the file
        yield found[1], behind + above


bad, known = [], 0
with open(os.path.join(ROOT, "CONTRIBUTING.md"), encoding="utf-8") as document:
    text = document.read().split("\n## Where physics is wanted\n")[1].split("\n## ")[0]
rows = [row.split(" | ") for row in re.findall(r"^\| (.*) \|$", text, re.M)]
rows = [(set(re.findall(r"`([A-Z]\w*)(?:\.\.\.)?`", row[0])), re.findall(r"`([\w/]+\.[ch])`", row[-1])) for row in rows]
texts = {}
for path in sorted(glob.glob(os.path.join(ROOT, "src", "*", "*.[ch]"))):
    file = os.path.relpath(path, os.path.join(ROOT, "src"))
    with open(path, encoding="utf-8") as source:
        texts[file] = source.read()
    named = set().union(*(names for names, files in rows if file in files))
    for name, comment in constants(texts[file].splitlines()):
        known += 1
        chosen = "no reference" in comment.lower() or not REASON.search(comment)
        if chosen and not any(name.startswith(one) for one in named):
            bad.append(f"src/{file}: {name} has no comment that says why it is so, and no row in CONTRIBUTING.md")
for names, files in rows:
    bad += [f"CONTRIBUTING.md names {file}, which is not there" for file in files if file not in texts]
    bad += [f"CONTRIBUTING.md names {name}, which is not in {' or '.join(files)}" for name in sorted(names)
            if not any(name in texts.get(file, "") for file in files)]
verdict.end("constants", bad, f"{known} numbers")
