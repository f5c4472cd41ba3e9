#!/usr/bin/python3
"""make report: the page holds scene, numbers, energy and pictures, loads nothing from elsewhere, and its surfaces are
those of the liquid. What a browser shows: browser.py."""
import base64
import json
import os
import re
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

SCENE = """-spacing 0.125 -box_lower -2,-2,-2 -box_upper 2,2,2 -bodies ball -ball_shape sphere -ball_radius 1
 -ball_velocity 0.5,0,0 -ball_tension 0.07 -gravity 0,0,-1 -steps_max 4 -time_step 1e-3 -snapshot_interval 2e-3
 -series_interval 1e-3 -checkpoint_interval 0"""
RINGS = """-dimension axisymmetric -spacing 0.125 -box_lower 0,-2 -box_upper 2,2 -bodies ball -ball_shape sphere
 -ball_radius 1 -steps_max 1 -time_step 1e-3 -checkpoint_interval 0"""
PLANE = """-dimension 2 -spacing 0.25 -box_lower 0,0 -box_upper 2,2 -bodies a -gravity 0,-1 -steps_max 1
 -solids part -part_lower 0.5,0.5 -part_upper 1.5,1.5 -part_mass 700 -checkpoint_interval 0"""
JET = """-dimension 2 -spacing 0.25 -box_lower 0,0 -box_upper 2,4 -bodies jet -jet_type emitter -jet_lower 0.5,2
 -jet_upper 1.5,3 -jet_velocity 0,-1 -steps_max 1 -checkpoint_interval 0"""


def report(folder, *options):
    """The page of a run."""
    done = subprocess.run([sys.executable, os.path.join(runs.ROOT, "src", "pictures", "report.py"), folder, *options],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if not runs.check(done.returncode == 0, "report", done.stderr[-500:]):
        runs.done()
    with open(os.path.join(folder, "report.html"), encoding="utf-8") as file:
        return file.read()


def part(page, name):
    """Data of the page."""
    return json.loads(re.search(rf'id="{name}"[^>]*>(.*?)</script>', page, re.S)[1])


def places(page, number):
    """Points of a moment's surface, and its part of the page."""
    found = part(page, "states")
    state = found["states"][number]
    steps = np.frombuffer(base64.b64decode(state["points"]), "<u2").reshape(-1, 3)
    return np.array(found["lower"]) + steps * np.array(found["step"]), state


def radial(page, number):
    """How far the normals of a ball's surface point away from its centre: least and mean cosine."""
    x, state = places(page, number)
    normals = np.frombuffer(base64.b64decode(state["normals"]), "i1").reshape(-1, 3) / 127
    away = x - x.mean(axis=0)
    cosine = np.einsum("ni,ni->n", normals, away / np.linalg.norm(away, axis=1, keepdims=True))
    return cosine.min(), cosine.mean()


def volume(page, number):
    """The volume that a moment's surface holds, and its number of triangles."""
    x, state = places(page, number)
    cells = np.frombuffer(base64.b64decode(state["cells"]), "<u4" if state["wide"] else "<u2").reshape(-1, 3)
    return abs(np.einsum("ni,ni->n", x[cells[:, 0]], np.cross(x[cells[:, 1]], x[cells[:, 2]])).sum() / 6), len(cells)


ball = runs.run(SCENE, "ball")
page = report(ball, "--triangles", "2000")
sphere = 4 / 3 * np.pi
for name, wanted in (("the scene", "Box of 4 by 4 by 4 m, spacing 0.125 m"),
                     ("a liquid", "<td>ball</td><td class=n>sphere</td>"),
                     ("dimensionless numbers", "Weber We"),
                     ("the energies", "kinetic energy, J"), ("the log", "of the largest kinetic energy"),
                     ("its cost", "4 steps, "), ("the options", "-ball_velocity 0.5,0,0"),
                     ("how to cite", "How to cite"), ("pictures", "data:image/png;base64,")):
    runs.check(wanted in page, f"the page has {name}", wanted)
runs.check("{{" not in page.split("<script")[0] and not re.search(r'(src|href)="(?!data:)', page),
           "the page loads nothing")
runs.check('"reference"' not in page and "<script src" not in page, "a page of its own", page[-300:])
series = runs.series(ball)
with open(runs.scratch("beside.csv"), "w", encoding="utf-8") as file:
    file.write("# Half of it by another program.\ntime,kinetic_energy,nothing\n")
    file.writelines(f"{t},{0.5 * e},0\n" for t, e in zip(series["time"], series["kinetic_energy"]))
shared = report(ball, "--triangles", "2000", "--reference", file.name, "--scripts", "../scripts")
found = [one for group in part(shared, "series")["groups"] for one in group["curves"] if "reference" in one]
runs.check(len(found) == 1 and found[0]["title"].startswith("kinetic energy") and np.allclose(
    found[0]["reference"], 0.5 * np.array(found[0]["values"]), rtol=1e-4), "curve of a reference", str(found)[:300])
runs.check("Dashed: Half of it by another program." in shared, "name of a reference", "")
with open(runs.scratch("check.py"), "w", encoding="utf-8") as program:
    program.write("def curves(folder):\n    return %r, [('way', 'm', [0, 2e-3], [0.25, 0.75], [1e-3, 5e-3], "
                  "[0.5, 0.9])]\n" % file.name)
others = part(report(ball, "--triangles", "2000", "--reference", program.name), "series")["groups"]
exact = [[1e3 * np.interp(t, at, values, np.nan, np.nan) for t in series["time"]]
         for at, values in (([0, 2e-3], [0.25, 0.75]), ([1e-3, 5e-3], [0.5, 0.9]))]
way = others[0]["curves"][0]
runs.check(others[0]["title"] == "Beside the reference" and others[0]["open"] and (way["title"], way["unit"]) ==
           ("way", "mm") and np.allclose(np.array([way["values"], way["reference"]], float), exact, equal_nan=True),
           "curves of a case's program", str(others[0])[:300])
runs.check(sum("reference" in one for group in others[1:] for one in group["curves"]) == 1,
           "the columns of its reference, too", str(others)[:300])
runs.check(len(re.findall('<script src="../scripts/', shared)) == 5 and len(shared) < len(page) - 8e5,
           "scripts of several pages", f"{len(page)} {len(shared)}")
inside, count = volume(page, 0)
runs.check_within(inside / sphere, 0.95, 1.03, "volume within the surface")
runs.check(500 < count <= 2000, "triangles are thinned", f"{count}")
rings = report(runs.run(RINGS, "rings"))
for name, (least, mean) in (("", radial(page, 0)), (" of rings", radial(rings, 0))):
    runs.check(least > 0.9 and 0.98 < mean < 1.01, f"normals of few triangles are those of a ball{name}", (least, mean))
inside, _ = volume(rings, 0)
runs.check_within(inside / sphere, 0.95, 1.03, "volume within the surface of rings")
plane = report(runs.run(PLANE, "plane"))
discs = part(plane, "states")
steps, radii = (np.frombuffer(base64.b64decode(discs["states"][0][key]), kind)
                for key, kind in (("points", "<u2"), ("radii", "u1")))
x = np.array(discs["lower"]) + steps.reshape(-1, 3) * np.array(discs["step"])
runs.check(discs["flat"] and len(radii) == len(x) > 30 and np.all((x[:, :2] > 0) & (x[:, :2] < 2)),
           "discs in two dimensions", x[:5])
runs.check(len({solid["points"] for solid in discs["solids"]}) == 2, "a solid that moves", len(discs["solids"]))
runs.check("free: mass 700 kg/m" in plane, "how a solid moves", plane[:900])
poured = report(runs.run(JET, "poured"))
runs.check("<td>jet</td><td class=n>emitter, box</td>" in poured and "Reynolds Re" in poured, "emitter",
           poured[:600])
runs.check("e+307" not in poured, "no distance between particles where there are none", "closest particles")
runs.done()
