#!/usr/bin/python3
"""Every option of options/*.opts and cases/*/*.opts is one of options/options.json, which tests/docs/options.py
compares with what the program writes, or PETSc's; one of a body, solid or region has the name of one that the scene or
its case names. The constants that removed options became are where the program says.
LINT_ROOT: another tree, for a test of the test."""
import glob
import json
import os
import re
import sys

import verdict

ROOT = os.environ.get("LINT_ROOT", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
PETSC = r"([a-z0-9]+_)*(ksp|pc|mg|mat|log|options|malloc|info|tao)_"


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def lines(path):
    """(name, value) of an options file."""
    text = re.sub(r"#.*", "", read(path))
    return re.findall(r"^[ \t]*-([A-Za-z_]\w*)[ \t]*(.*?)[ \t]*$", text, re.M)


with open(os.path.join(ROOT, "options", "options.json"), encoding="utf-8") as rows:
    options = json.load(rows)["options"]
faces = [axis + end for axis in "xyz" for end in ("min", "max")]
known = {option["name"][1:].replace("<face>", face).replace("<axis>", face[0]) for option in options for face in faces}
tails = {option["name"][len("-<body>"):] for option in options if option["owner"] == "<body>"}
files = sorted(glob.glob(os.path.join(ROOT, "cases/*/*.opts")) + glob.glob(os.path.join(ROOT, "options/*.opts")))
bad = [] if known and files else ["options/options.json lists no options, or there are no files of them"]
for path in files:
    named, case = set(), os.path.join(os.path.dirname(path), "case.opts")
    if not os.path.exists(case):  # a preset is for every scene, some are for the main case
        case = os.path.join(ROOT, "cases", "drop_impact", "case.opts")
    for source in (case, path):
        for name, value in lines(source):
            named |= set(value.split(",")) if name in ("bodies", "solids", "fine") or name.endswith("_holes") else set()
    for name, _ in lines(path):
        body = next((body for body in named if name.startswith(body + "_") and name[len(body):] in tails), None)
        if not (name in known or body or re.match(PETSC, name)):
            bad.append(f"{os.path.relpath(path, ROOT)}: the program knows no option -{name}")
verdict.end("options", bad, f"{len(files)} files")
