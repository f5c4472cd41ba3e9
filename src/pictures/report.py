#!/usr/bin/python3
"""One page that shows a run: report.html in its folder, which needs no other file.

    report.py RUN_FOLDER [--states 25] [--triangles 20000]          make report RUN=...

It has scene, liquids, walls, dimensionless numbers, the liquid through time to turn and play, pictures, curves to point
at, the energy budget, the cost of the run, its options, and how to cite. The pictures are those of figures/; missing
pictures are drawn first. --triangles: most triangles of the surface at a time, in two dimensions most particles.
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
VIEWER = [os.path.join(THREE, name) for name in ("three.min.js", "examples/js/controls/OrbitControls.js")]
PICTURES = (("figure_1.png", "Six moments"), ("figure_2.png", "Crown, crater and jet beside the reference"),
            ("surface.png", "Moments"), ("section.png", "Sections"), ("top.png", "From above"))
NUMBERS = {"Re": "Reynolds", "We": "Weber", "Fr": "Froude", "Bo": "Bond", "Oh": "Ohnesorge"}
LINES = 2000  # most of the series that the curves have
DIGITS = 6  # of their values


def table(head, rows):
    """An HTML table; numbers to the right. Columns of zeros or without a value are left out."""
    full = [k for k in range(len(head)) if any(row[k] not in ("", "0") for row in rows)]
    head, rows = [head[k] for k in full], [[row[k] for k in full] for row in rows]

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
    sides = walls(log)
    return text + ("<p></p>" + table(["wall or solid", "kind", "contact angle, degrees"], sides) if sides else "")


def walls(log):
    """Rows of the walls of the box and of the solids: name, shape, contact angle if it has one."""
    found = {}
    for line in log:
        face = re.match(r"  ([xyz]): .* m, (\w+) to (\w+), ", line)
        solid = re.match(r"  solid +(\w+): (\w+)", line)
        if face:
            found.update({face[1] + end: "wall" for end, kind in zip(("min", "max"), face.groups()[1:])
                          if kind == "wall"})
        elif solid:
            found[solid[1]] = solid[2]
    angles = next((line.partition(":")[2] for line in log if line.startswith("Contact angles in degrees:")), "")
    angles = dict(part.split(maxsplit=1) for part in angles.split(",") if part)
    return [[name, kind, angles.get(name, "")] for name, kind in found.items()]


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


def script(paths):
    """Scripts as parts of the page."""
    text = ""
    for path in paths:
        with open(path, encoding="utf-8") as file:
            text += f"<script>{file.read()}</script>\n"
    return text


def here(*names):
    return [os.path.join(HERE, name) for name in names]


def part(name, values, scripts):
    """Data of the page and the scripts that read them."""
    return f'<script id="{name}" type="application/json">{json.dumps(values)}</script>\n{script(scripts)}'


def through_time(run, arguments):
    """The part of the page with the liquid through time."""
    found = viewer.scene(run, arguments.states, arguments.triangles)
    if not found:
        return ""
    turn = "move" if found["flat"] else "turn"
    return ('<h2>The liquid through time</h2>\n<div id="view"></div>\n<p class="bar"><button id="play">Play</button>'
            '<input id="moment" type="range" min="0" value="0"><span id="time"></span>'
            '<label>colour <select id="color"></select></label></p>\n<div id="scale"></div>\n'
            f'<p class="small">Drag to {turn}, scroll to zoom. The scene changes by the same amount between the '
            f'{len(found["states"])} times.</p>\n{part("states", found, [*VIEWER, *here("viewer.js")])}')


def curves(series, dim):
    """The part of the page with the curves; empty if nothing changes."""
    every = -(-len(series["time"]) // LINES)
    factor, unit = columns.prefixed(max(map(abs, series["time"])), "s")

    def thinned(values, scale):
        return [float(f"{scale * value:.{DIGITS}g}") if math.isfinite(value) else None for value in values[::every]]

    found = []
    for name, values in columns.chosen(series).items():
        words, unit_of = columns.title(name, dim)
        scale, unit_of = columns.prefixed(np.nanmax(np.abs(values)), unit_of)
        found.append({"title": words, "unit": unit_of or "", "values": thinned(values, scale)})
    if not found:
        return ""
    values = {"time": thinned(series["time"], factor), "unit": unit, "factor": factor, "curves": found}
    with open(here("uplot/uPlot.min.css")[0], encoding="utf-8") as style, \
            open(here("uplot/LICENSE")[0], encoding="utf-8") as licence:
        head = f"<!-- uPlot:\n{licence.read()}-->\n<style>{style.read()}</style>\n"
    return ('<h2>Curves</h2>\n<p class="small">Point at a time to read all values; click to see the liquid then.</p>\n'
            f'{head}<div id="curves"></div>\n{part("series", values, here("uplot/uPlot.iife.min.js", "curves.js"))}')


def pictures(folder, files):
    """The pictures as parts of the page; draws them first if the last snapshot is newer."""
    figures = os.path.join(folder, "figures")
    drawn = os.path.join(figures, "section.png")
    if not os.path.exists(drawn) or os.path.getmtime(drawn) < os.path.getmtime(files[-1][1]):
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
    parser.add_argument("--states", type=int, default=25, help="number of times of the liquid (25)")
    parser.add_argument("--triangles", type=int, default=20000,
                        help="most triangles of the surface, or particles, at a time (20000)")
    arguments = parser.parse_args()
    if not os.path.exists(VIEWER[0]):
        raise tables.RunError("the view of the liquid needs three.js: apt-get install libjs-three")
    run, (whole, log) = data.Run(arguments.folder), read_log(arguments.folder)
    series = tables.read_series(arguments.folder)
    version = re.match(r"=== isph (\S+), (\S+)", log[0])
    scene = [line for line in log[1:]
             if not line.startswith((" " * 4, "Output")) or line.startswith("    moves")]
    body = ("<h2>Scene</h2>\n" + liquids(log) + f"<pre>{html.escape(chr(10).join(scene))}</pre>\n"
            + through_time(run, arguments) + pictures(arguments.folder, run.files) + curves(series, run.dim)
            + "<h2>Where the energy went</h2>\n" + energy(whole) + "<h2>What it cost</h2>\n" + cost(series, log)
            + "<h2>Options</h2>\n" + options(arguments.folder)
            + f"<h2>How to cite</h2>\n<p>The program, isph {version[1]} (the isph authors), and Kuri, Yamaguchi, "
            "Kagawa, Nakajima, Fujimura: <i>Simulations of Droplet Impact onto a Liquid Surface Using Incompressible "
            "Smoothed Particle Hydrodynamics Method</i>, 2014. The page uses three.js and uPlot (MIT licences).</p>\n")
    with open(os.path.join(HERE, "report.html"), encoding="utf-8") as file:
        page = file.read()
    name = os.path.basename(os.path.abspath(arguments.folder))
    ends = f"from {data.duration(series['time'][0])} to {data.duration(series['time'][-1])}"
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
        import columns
        import run as data
        import viewer
        main()
