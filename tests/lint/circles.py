#!/usr/bin/python3
"""No circle between the files of a folder of src/: none of includes between headers, and none of calls between objects,
where a.c uses what b.c defines and b.c, perhaps by way of others, what a.c defines (nm; calls are looked at where
output/build has the objects). A circle is reported as a -> b -> a with the names that make it. LINT_ROOT: another tree,
for a test of the test."""
import glob
import os
import re
import subprocess
import sys

ROOT = os.environ.get("LINT_ROOT", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
SHOWN = 3  # names shown of each arrow


def includes(folder):
    """{header: {header of the same folder it includes: [its name]}}"""
    arrows = {}
    for path in glob.glob(os.path.join(folder, "*.h")):
        with open(path, encoding="utf-8") as file:
            named = re.findall(r'^\s*#\s*include\s*"([^"/]+)"', file.read(), re.M)
        arrows[os.path.basename(path)] = {name: [f'#include "{name}"'] for name in named}
    return arrows


def symbols(path):
    """(defined, used) names of an object."""
    lines = subprocess.run(["nm", "-P", "-g", path], check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()
    kinds = [line.split()[:2] for line in lines]
    return {name for name, kind in kinds if kind not in "Uw"}, {name for name, kind in kinds if kind in "Uw"}


def calls(folder):
    """{file: {file of the same folder it uses: [names]}}, of sources that have been compiled."""
    built = os.path.join(ROOT, "output", "build", os.path.basename(folder))
    found = {}
    for source in glob.glob(os.path.join(folder, "*.c")):
        path = os.path.join(built, os.path.basename(source)[:-1] + "o")
        if os.path.exists(path):
            found[os.path.basename(source)] = symbols(path)
    return {a: {b: sorted(found[a][1] & found[b][0]) for b in found if b != a and found[a][1] & found[b][0]}
            for a in found}


def circle(arrows, start):
    """The shortest way from a file back to itself, or None."""
    ways = [[start]]
    seen = set()
    for way in ways:
        for following in sorted(arrows.get(way[-1], {})):
            if following == start:
                return way + [start]
            if following not in seen:
                seen.add(following)
                ways.append(way + [following])
    return None


def circles(arrows):
    """One circle for each file that is on some, each reported once."""
    found = {}
    for start in sorted(arrows):
        way = circle(arrows, start)
        if way:
            found.setdefault(frozenset(way), way)
    return found.values()


bad, objects = 0, 0
for folder in sorted(glob.glob(os.path.join(ROOT, "src", "*", ""))):
    folder = folder.rstrip("/")
    used = calls(folder)
    objects += len(used)
    for arrows in (includes(folder), used):
        for way in circles(arrows):
            bad += 1
            names = [", ".join(arrows[a][b][:SHOWN]) + (", ..." if len(arrows[a][b]) > SHOWN else "")
                     for a, b in zip(way, way[1:])]
            print(f"FAIL circles: src/{os.path.basename(folder)}: {' -> '.join(way)}: {'; '.join(names)}")
if not bad:
    print(f"ok circles ({objects} objects)" if objects else "ok circles (of includes; nothing is built)")
sys.exit(1 if bad else 0)
