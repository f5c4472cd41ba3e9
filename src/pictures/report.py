#!/usr/bin/python3
"""One page that shows a run: report.html in its folder, which needs no other file.

    report.py RUN_FOLDER [--states 25] [--triangles 40000]          make report RUN=...

It has scene and liquids, dimensionless numbers, the surface in three dimensions to turn and play, pictures, curves, the
energy budget, the cost of the run, its options, and how to cite. The pictures are those of figures/; missing pictures
are drawn first. --triangles: most triangles of the surface at a time.
"""
import argparse
import base64
import html
import json
import math
import os
import re
import subprocess
import sys

import tables

HERE = os.path.dirname(os.path.abspath(__file__))
THREE = "/usr/share/javascript/three"
LIBRARY = ("three.min.js", "examples/js/controls/OrbitControls.js")
PICTURES = (("figure_1.png", "Six moments"), ("figure_2.png", "Crown, crater and jet beside the reference"),
            ("surface.png", "Moments"), ("section.png", "Sections"), ("top.png", "From above"),
            ("curves.png", "Curves"))
NUMBERS = {"Re": "Reynolds", "We": "Weber", "Fr": "Froude", "Bo": "Bond", "Oh": "Ohnesorge"}
STEPS = 65535  # of a 16-bit coordinate
COARSEST = 2  # largest cells of the surface over those of a picture


def table(head, rows):
    """An HTML table; numbers to the right."""
    def cells(kind, row):
        return "".join(f'<{kind}{" class=n" if k else ""}>{html.escape(str(cell))}</{kind}>'
                       for k, cell in enumerate(row))
    return f"<table><tr>{cells('th', head)}</tr>" + "".join(f"<tr>{cells('td', row)}</tr>" for row in rows) + "</table>"


def read_log(folder):
    """The lines that the last start of the run wrote to log.txt: all lines, and the lines before its steps."""
    try:
        with open(os.path.join(folder, "log.txt"), encoding="utf-8") as file:
            lines = file.read().split("\n")
    except OSError as error:
        raise tables.RunError(f"{error.filename}: {error.strerror}.") from error
    start = max((k for k, line in enumerate(lines) if line.startswith("=== isph ")), default=None)
    if start is None:
        raise tables.RunError(f"{folder}/log.txt is not that of a run.")
    end = next((k for k in range(start, len(lines)) if lines[k].startswith("Output: ")), len(lines))
    return lines[start:], lines[start:end]


def liquids(log):
    """Tables of the bodies and of their dimensionless numbers, from the lines of the log."""
    bodies, numbers, names = [], [], list(NUMBERS)
    for line in log:
        body = re.match(r"  (\w+): (emitter, )?(\w+) within ", line)
        if body:
            bodies.append([body[1], (body[2] or "") + body[3], "", "", ""])
        values = re.match(r"    density (\S+) kg/m3, viscosity (\S+) Pa s, tension (\S+) N/m", line)
        if values and bodies:
            bodies[-1][2:] = [values[k].rstrip(".,") for k in (1, 2, 3)]
        if line.startswith("    least extent ") and bodies:
            found = dict(re.findall(r"\b(Re|We|Fr|Bo|Oh) (\S+?)(?:,|$)", line))
            extent = re.search(r"least extent (\S+) m, (\S+) spacings", line)
            numbers.append([bodies[-1][0], extent[1] if extent else "", extent[2] if extent else "",
                            *(found.get(name, "") for name in names)])
    text = table(["body", "shape", "density, kg/m3", "viscosity, Pa s", "tension, N/m"], bodies)
    if numbers:
        heads = [f"{NUMBERS[name]} {name}" for name in names]
        text += "<p></p>" + table(["body", "least extent, m", "in spacings", *heads], numbers)
    return text


def scaled(value, unit):
    """A value with an SI prefix."""
    for factor, prefix in ((1, ""), (1e3, "m"), (1e6, "µ"), (1e9, "n")):
        if abs(value) * factor >= 1:
            return f"{value * factor:.3g} {prefix}{unit}"
    return f"{value:.3g} {unit}"


def energy(log):
    """The error budget, as the program printed it at the end of the run."""
    start = next((k for k, line in enumerate(log) if line.startswith("Error budget")), len(log))
    end = next((k for k in range(start, len(log)) if log[k].startswith("  dominant")), None)
    if end is None:
        return "<p>The run has not reached its end, so its log has no error budget.</p>"
    return f"<pre>{html.escape(chr(10).join(log[start:end + 1]))}</pre>"


def cost(series, log):
    """The cost of the run."""
    steps, wall = int(series["step"][-1]), series.get("wall_time", [math.nan])[-1]
    particles = series.get("particles", [math.nan])[-1]
    ranks = next((m[1] for m in (re.search(r"in a DMSwarm on (\d+) rank", line) for line in log) if m), "1")
    text = f"{steps} steps, {particles:.0f} particles at the end, {ranks} process{'es' if ranks != '1' else ''}"
    if math.isfinite(wall) and wall > 0:
        text += f", {wall:.3g} s"
        if steps and particles > 0:
            text += f": {1e6 * wall * int(ranks) / steps / particles:.3g} µs a step and particle on each process"
    return f"<p>{text}.</p>"


def packed(array, kind):
    return base64.b64encode(np.ascontiguousarray(array, kind).tobytes()).decode()


def thin(points, cells, most):
    """The mesh with at most so many triangles."""
    if len(cells) <= most or not len(cells):
        return points, cells
    mesh = vtkPolyData()
    corners = vtkPoints()
    corners.SetData(numpy_to_vtk(points, deep=True))
    mesh.SetPoints(corners)
    polygons = vtkCellArray()
    polygons.SetCells(len(cells), numpy_to_vtkIdTypeArray(
        np.column_stack([np.full(len(cells), 3), cells]).ravel().astype(np.int64), deep=True))
    mesh.SetPolys(polygons)
    fewer = vtkQuadricDecimation()
    fewer.SetInputData(mesh)
    fewer.SetTargetReduction(1 - most / len(cells))
    fewer.Update()
    out = fewer.GetOutput()
    return (vtk_to_numpy(out.GetPoints().GetData()).astype(float),
            vtk_to_numpy(out.GetPolys().GetData()).reshape(-1, 4)[:, 1:])


def surfaces(run, count, most):
    """The data of viewer.js: the surface at each time, coloured by body."""
    span = run.upper - run.lower
    data = {"lower": list(run.lower), "step": list(span / STEPS), "states": [],
            "box": [list(run.lower), list(run.upper)]}
    top, coarser = run.lower[2], None
    for _, path in run.moments(count=count):
        state = run.read(path)
        share = views.value_table(state, "body", len(run.names()))
        if coarser is None:  # so that few triangles must be removed
            ratio = len(views.Fluid(run, state.points, share, state.share, state.size).mesh()[2]) / most
            coarser = min(max(ratio if run.rings else math.sqrt(ratio), 1), COARSEST)
        fluid = views.Fluid(run, state.points, share, state.share, state.size, coarser)
        points, _, cells, _ = fluid.mesh()
        points, cells = thin(np.asarray(points, float), np.asarray(cells), most)
        if not len(cells):
            continue
        rgb = views.base_colors(fluid.values(points), "body", None, None)
        places = np.clip((points - run.lower) / span, 0, 1) * STEPS
        wide = len(points) > STEPS
        data["states"].append({"time": moment(state.time), "points": packed(np.rint(places), "<u2"), "wide": wide,
                               "colors": packed(np.rint(255 * np.clip(rgb, 0, 1)), "u1"),
                               "cells": packed(cells, "<u4" if wide else "<u2")})
        top = max(top, np.quantile(points[:, 2], 0.99))
    middle = 0.5 * (run.lower + run.upper)
    reach = max(*span[:2], top - run.lower[2])
    data["focus"] = [middle[0], middle[1], 0.5 * (run.lower[2] + top)]
    data["eye"] = [middle[0] + 0.7 * reach, middle[1] - 1.9 * reach, data["focus"][2] + 1.0 * reach]
    return data


def moment(seconds):
    return scaled(seconds, "s") if seconds else "0 s"


def viewer(run, arguments):
    """The part of the page with the surface; empty in two dimensions."""
    if run.dim != 3:
        return ""
    data = surfaces(run, arguments.states, arguments.triangles)
    if not data["states"]:
        return ""
    scripts = []
    for name in LIBRARY:
        with open(os.path.join(THREE, name), encoding="utf-8") as file:
            scripts.append(file.read())
    with open(os.path.join(HERE, "viewer.js"), encoding="utf-8") as file:
        scripts.append(file.read())
    code = "\n".join(f"<script>{script}</script>" for script in scripts)
    return ('<h2>The surface through time</h2>\n<div id="view"></div>\n<p class="bar"><button id="play">Play</button>'
            '<input id="moment" type="range" min="0" value="0"><span id="time"></span></p>\n<p class="small">Drag to '
            'turn, scroll to zoom.</p>\n<script id="surfaces" type="application/json">'
            f"{json.dumps(data)}</script>\n{code}\n")


def pictures(folder, files):
    """The pictures as parts of the page; draws them first if the last snapshot is newer."""
    figures = os.path.join(folder, "figures")
    curves = os.path.join(figures, "curves.png")
    if not os.path.exists(curves) or os.path.getmtime(curves) < os.path.getmtime(files[-1][1]):
        subprocess.run([sys.executable, os.path.join(HERE, "pictures.py"), folder], check=True)
    text = ""
    for name, title in PICTURES:
        path = os.path.join(figures, name)
        if os.path.exists(path):
            with open(path, "rb") as file:
                image = base64.b64encode(file.read()).decode()
            text += f'<h2>{title}</h2>\n<img alt="{title}" src="data:image/png;base64,{image}">\n'
    return text


def options(folder):
    with open(os.path.join(folder, "options.opts"), encoding="utf-8") as file:
        return f"<details><summary>All options of the run</summary><pre>{html.escape(file.read())}</pre></details>"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folder", metavar="RUN_FOLDER")
    parser.add_argument("--states", type=int, default=25, help="number of times of the surface (25)")
    parser.add_argument("--triangles", type=int, default=40000, help="most triangles of the surface at a time (40000)")
    arguments = parser.parse_args()
    if not os.path.exists(os.path.join(THREE, LIBRARY[0])):
        raise tables.RunError("the view in three dimensions needs three.js: apt-get install libjs-three")
    run, (whole, log) = data.Run(arguments.folder), read_log(arguments.folder)
    series = tables.read_series(arguments.folder)
    version = re.match(r"=== isph (\S+), (\S+)", log[0])
    scene = [line for line in log[1:]
             if not line.startswith((" " * 4, "Output")) or line.startswith("    moves")]
    body = ("<h2>Scene</h2>\n" + liquids(log) + f"<pre>{html.escape(chr(10).join(scene))}</pre>\n"
            + viewer(run, arguments) + pictures(arguments.folder, run.files)
            + "<h2>Where the energy went</h2>\n" + energy(whole) + "<h2>What it cost</h2>\n" + cost(series, log)
            + "<h2>Options</h2>\n" + options(arguments.folder)
            + f"<h2>How to cite</h2>\n<p>The program, isph {version[1]} (the isph authors), and Kuri, Yamaguchi, "
            "Kagawa, Nakajima, Fujimura: <i>Simulations of Droplet Impact onto a Liquid Surface Using Incompressible "
            "Smoothed Particle Hydrodynamics Method</i>, 2014. The view uses three.js (MIT licence).</p>\n")
    with open(os.path.join(HERE, "report.html"), encoding="utf-8") as file:
        page = file.read()
    name = os.path.basename(os.path.abspath(arguments.folder))
    ends = f"from {moment(series['time'][0])} to {moment(series['time'][-1])}"
    for key, value in (("title", html.escape(name)), ("subtitle", f"isph {version[1]}, {version[2]}; {ends}"),
                       ("body", body)):
        page = page.replace("{{" + key + "}}", value)
    path = os.path.join(arguments.folder, "report.html")
    with open(path, "w", encoding="utf-8") as file:
        file.write(page)
    print(path)


if __name__ == "__main__":
    with tables.polite("report.py"):
        import numpy as np
        import run as data
        import views
        from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
        from vtkmodules.vtkFiltersCore import vtkQuadricDecimation
        main()
