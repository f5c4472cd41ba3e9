#!/usr/bin/python3
"""One page that shows a run: report.html in its folder, which needs no other file.

    report.py RUN_FOLDER [--states 25] [--triangles 20000] [--reference FILE]          make report RUN=...

It has scene, liquids, walls, dimensionless numbers, the liquid through time to turn and play, pictures, curves to point
at, the energies, the cost of the run, its messages and options, and how to cite. The pictures are those of figures/;
missing pictures are drawn first. --triangles: most triangles of the surface at a time, in two dimensions most
particles. --reference: a table with columns of the series' names, which the curves show beside the run's, or the
check.py of a case, whose curves() finds others in the snapshots. --scripts: an address from which the page takes its
scripts (SCRIPTS), so that many pages share them; pictures are linked then.
"""
import argparse
import base64
import html
import importlib.util
import json
import math
import os
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "python"))
from isph import tables  # noqa: E402

THREE = "/usr/share/javascript/three"
VIEWER = [os.path.join(THREE, name) for name in ("three.min.js", "examples/js/controls/OrbitControls.js")]
PICTURES = (("figure_1.png", "Six moments"), ("figure_2.png", "Crown, crater and jet beside the reference"),
            ("surface.png", "Moments"), ("section.png", "Sections"), ("top.png", "From above"))
SCRIPTS = [*VIEWER, *(os.path.join(HERE, name) for name in ("viewer.js", "uplot/uPlot.iife.min.js", "curves.js"))]
NUMBERS = {"Re": "Reynolds", "We": "Weber", "Fr": "Froude", "Bo": "Bond", "Oh": "Ohnesorge", "Ca": "capillary"}
BESIDE = "Beside the reference"
GROUPS = (BESIDE, "Measured", "Forces", "Energies")  # of curves, in this order
FOLDED, FEW = ("Forces", "Energies"), 6  # groups that are folded unless the curves are few
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


def number(value):
    """A number for a table; none is empty."""
    return "" if value is None else f"{value:.4g}"


def liquids(scene):
    """Tables of the bodies, of their dimensionless numbers, and of the walls and solids."""
    bodies = [[body["name"], ("emitter, " if body["emitter"] else "") + body["shape"]["type"],
               *(number(body[key]) for key in ("density", "viscosity", "tension"))] for body in scene["bodies"]]
    text = table(["body", "shape", "density, kg/m3", "viscosity, Pa s", "tension, N/m"], bodies)
    numbers = []
    for body in scene["bodies"]:
        found = {one["name"]: one for one in body["dimensionless"]}
        length = min(high - low for low, high in zip(body["lower"], body["upper"]))
        numbers.append([body["name"], number(next((one["length"] for one in found.values()), length)),
                        number(body["spacings"]), *(number(found[n]["value"]) if n in found else "" for n in NUMBERS)])
    heads = [f"{words} {name}" for name, words in NUMBERS.items()]
    text += "<p></p>" + table(["body", "least extent, m", "in spacings", *heads], numbers)
    sides = walls(scene)
    return text + ("<p></p>" + table(["wall or solid", "kind", "contact angle, degrees"], sides) if sides else "")


def walls(scene):
    """Rows of the walls of the box and of the solids: name, shape and motion, contact angle if it has one."""
    angles = {one["name"]: number(one["receding"]) + (
        f" to {number(one['advancing'])}" if one["advancing"] > one["receding"] else "")
        for one in scene["tension"]["contact_angles"]}
    found = [[face["name"], "wall" + (", moves" if any(face["velocity"]) else "")]
             for face in scene["domain"]["faces"] if face["type"] == "wall"]
    found += [[solid["name"], solid["shape"]["type"] + (
        f", free: mass {number(solid['motion']['mass'])} kg" + ("/m" if scene["domain"]["dimension"] == 2 else "")
        if solid["free"] else ", moves" if solid["driven"] else "")] for solid in scene["solids"]]
    return [[*row, angles.get(row[0], "")] for row in found]


def setting(scene):
    """What the scene is otherwise, and the models that hold for it."""
    domain, step, model = scene["domain"], scene["step"], scene["model"]
    box = " by ".join(f"{high - low:.4g}" for low, high in zip(domain["lower"], domain["upper"]))
    parts = [f"Box of {box} m" + (", rings" if domain["rings"] else "") +
             f", spacing {domain['spacing']:.4g} m" + (f" to {domain['spacing_coarse']:.4g} m"
                                                       if domain["spacing_coarse"] > domain["spacing"] else ""),
             f"gravity {', '.join(number(g) for g in scene['forces']['gravity'])} m/s2",
             f"scheme {scene['scheme']}, tension {scene['tension']['model']}"]
    if step.get("binds"):
        parts.append(f"at the start {step['binds'].replace('_', ' ')} bounds the step, {step[step['binds']]:.3g} s")
    holds = [f"a body of revolution about {one['about']}" for one in model["revolution"] if one["holds"]]
    holds += [f"mirrored across {one['across']}" for one in model["mirrors"] if one["holds"]]
    holds += [f"uniform along {one['along']}" for one in model["uniform"] if one["holds"]]
    holds += [f"without effect of {one['name']}" for one in model["forces"] if one["vain"]]
    if holds:
        parts.append("the scene is " + ", ".join(holds))
    return f"<p>{html.escape('; '.join(parts))}.</p>"


def energy(series, rows):
    """The energies and the work of the series at its start and its end."""
    found = [[f"{columns.title(row)[0]}, {row['unit']}",
              *(f"{v:.4g}" for v in (series[name][0], series[name][-1], series[name][-1] - series[name][0]))]
             for name, row in rows.items() if row["unit"] in ("J", "J/m")]
    return table(["", "at the start", "at the end", "change"], found)


def cost(series, scene):
    """The cost of the run."""
    steps, wall = int(series["step"][-1]), series.get("wall_time", [math.nan])[-1]
    particles, ranks = series.get("particles", [math.nan])[-1], scene["ranks"]
    text = f"{steps} steps, {particles:.0f} particles at the end, {ranks} process{'es' if ranks != 1 else ''}"
    if math.isfinite(wall) and wall > 0:
        text += f", {wall:.3g} s"
        if steps and particles > 0:
            text += f": {1e6 * wall * ranks / steps / particles:.3g} µs a step and particle on each process"
    return f"<p>{text}.</p>"


def text_file(folder, name, title):
    """A text of the run, folded."""
    try:
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            return f"<details><summary>{title}</summary><pre>{html.escape(file.read())}</pre></details>"
    except OSError as error:
        raise tables.Error(f"{error.filename}: {error.strerror}.") from error


def script(paths, address):
    """Scripts as parts of the page, or from an address."""
    text = ""
    for path in paths:
        if address:
            text += f'<script src="{address}/{os.path.basename(path)}"></script>\n'
            continue
        with open(path, encoding="utf-8") as file:
            text += f"<script>{file.read()}</script>\n"
    return text


def here(*names):
    return [os.path.join(HERE, name) for name in names]


def part(name, values, scripts, address):
    """Data of the page and the scripts that read them."""
    return f'<script id="{name}" type="application/json">{json.dumps(values)}</script>\n{script(scripts, address)}'


def through_time(run, arguments):
    """The part of the page with the liquid through time."""
    found = viewer.scene(run, arguments.states, arguments.triangles)
    if not found:
        return ""
    turn = "move" if found["flat"] else "turn"
    parts = {0: "", 1: " Half of the liquid was computed, the rest is its mirror image.",
             2: " A quarter of the liquid was computed, the rest are its mirror images."}
    mirrored = " The liquid was computed as rings about the axis." if run.rings else parts[len(run.mirrors)]
    return ('<h2>The liquid through time</h2>\n<div id="view"></div>\n'
            '<p class="bar turn"><button id="play">Play</button>'
            '<input id="moment" type="range" min="0" value="0"><span id="time"></span>'
            '<label>colour <select id="color"></select></label></p>\n'
            '<div id="scale" class="turn"></div>\n'
            f'<p class="small turn">Drag to {turn}, scroll to zoom. The scene changes by the same amount between the '
            f'{len(found["states"])} times; they follow each other as in reality, slowed down.{mirrored}</p>\n'
            f'{part("states", found, SCRIPTS[:3], arguments.scripts)}')


def group_of(row):
    """The group of a curve."""
    if row["unit"] in ("J", "J/m"):
        return "Energies"
    return "Forces" if row["unit"] in ("N", "N/m") else "Measured"


def beside(path, folder):
    """The table of a reference, curves of the run that its series has not with those of the reference (title, unit,
    times, values, times and values there), and what the table's first line says of it. Nothing without a path."""
    if not path:
        return {}, [], ""
    others = []
    if path.endswith(".py"):
        spec = importlib.util.spec_from_file_location("check", path)
        case = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(case)
        path, others = case.curves(folder)
    with open(path, encoding="utf-8") as file:
        first = file.readline()
    said = first[1:].strip() if first.startswith("#") else os.path.basename(path)
    return tables.read_table(path), others, said


def curves(series, rows, arguments):
    """The part of the page with the curves; empty if nothing changes."""
    reference, others, said = beside(arguments.reference, arguments.folder)
    every = -(-len(series["time"]) // LINES)
    factor, unit = columns.prefixed(max(map(abs, series["time"])), "s")

    def thinned(values, scale):
        return [float(f"{scale * value:.{DIGITS}g}") if math.isfinite(value) else None for value in values[::every]]

    def drawn(title, unit, values, there=None):
        scale, unit = columns.prefixed(np.nanmax(np.abs(values)), unit)
        more = {} if there is None else {"reference": thinned(there, scale)}
        return {"title": title, "unit": unit or "", "values": thinned(values, scale), **more}

    def then(times, values):
        return np.interp(series["time"], times, values, np.nan, np.nan)

    groups = {title: [] for title in GROUPS}
    groups[BESIDE] = [drawn(title, unit, then(times, values), then(*there))
                      for title, unit, times, values, *there in others]
    for name, values in columns.chosen(series, rows).items():
        there = then(reference["time"], reference[name]) if name in reference else None
        groups[group_of(rows[name])].append(drawn(*columns.title(rows[name]), values, there))
    few = sum(map(len, groups.values())) <= FEW
    found = [{"title": title, "curves": curves, "open": few or title not in FOLDED}
             for title, curves in groups.items() if curves]
    if not found:
        return ""
    values = {"time": thinned(series["time"], factor), "unit": unit, "factor": factor, "groups": found}
    with open(here("uplot/uPlot.min.css")[0], encoding="utf-8") as style, \
            open(here("uplot/LICENSE")[0], encoding="utf-8") as licence:
        head = f"<!-- uPlot:\n{licence.read()}-->\n<style>{style.read()}</style>\n"
    text = "Point at a time to read all values; click to see the liquid then."
    if any("reference" in curve for group in found for curve in group["curves"]):
        text += f" Dashed: {html.escape(said)}"
    return (f'<h2>Curves</h2>\n<p class="small">{text}</p>\n{head}<div id="curves"></div>\n'
            f'{part("series", values, SCRIPTS[3:], arguments.scripts)}')


def pictures(folder, files, linked):
    """The pictures as parts of the page, or linked in figures/; draws them first if the last snapshot is newer. Those
    that a case has drawn by a program of its own are enough."""
    figures = os.path.join(folder, "figures")
    drawn = [os.path.join(figures, name) for name in ("figure_1.png", "section.png")]
    if not any(os.path.exists(path) and os.path.getmtime(path) >= os.path.getmtime(files[-1][1]) for path in drawn):
        subprocess.run([sys.executable, os.path.join(HERE, "pictures.py"), folder], check=True)
    text = ""
    for name, title in PICTURES:
        path = os.path.join(figures, name)
        if os.path.exists(path):
            with open(path, "rb") as file:
                whole = base64.b64encode(file.read()).decode()
            image = f"figures/{name}" if linked else f"data:image/png;base64,{whole}"
            text += f'<h2>{title}</h2>\n<img alt="{title}" src="{image}">\n'
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folder", metavar="RUN_FOLDER")
    parser.add_argument("--states", type=int, default=25, help="number of times of the liquid (25)")
    parser.add_argument("--triangles", type=int, default=20000,
                        help="most triangles of the surface, or particles, at a time (20000)")
    parser.add_argument("--reference", metavar="FILE",
                        help="a table whose columns are drawn beside the run's, or check.py of a case")
    parser.add_argument("--title", metavar="TEXT", help="of the page (the name of the folder)")
    parser.add_argument("--scripts", metavar="ADDRESS", help="where the scripts are, if not in the page")
    arguments = parser.parse_args()
    if not os.path.exists(VIEWER[0]):
        raise tables.Error("the view of the liquid needs three.js: apt-get install libjs-three")
    run = data.Run(arguments.folder)
    scene, series = run.scene, tables.read_series(arguments.folder)
    body = ("<h2>Scene</h2>\n" + setting(scene) + liquids(scene) + "\n" + through_time(run, arguments)
            + pictures(arguments.folder, run.files, arguments.scripts) + curves(series, run.rows, arguments)
            + "<h2>Where the energy went</h2>\n" + energy(series, run.rows) + "<h2>What it cost</h2>\n"
            + cost(series, scene) + "<h2>Messages and options</h2>\n"
            + text_file(arguments.folder, "log.txt", "What the program said, with its budget of errors")
            + text_file(arguments.folder, "options.opts", "All options of the run")
            + f"<h2>How to cite</h2>\n<p>The program, isph {scene['version']} (the isph authors), and Kuri, Yamaguchi, "
            "Kagawa, Nakajima, Fujimura: <i>Simulations of Droplet Impact onto a Liquid Surface Using Incompressible "
            "Smoothed Particle Hydrodynamics Method</i>, 2014. The page uses three.js and uPlot (MIT licences).</p>\n")
    with open(os.path.join(HERE, "report.html"), encoding="utf-8") as file:
        page = file.read()
    name = arguments.title or os.path.basename(os.path.abspath(arguments.folder))
    date = time.strftime("%Y-%m-%d", time.gmtime(os.path.getmtime(os.path.join(arguments.folder, "scene.json"))))
    ends = f"from {data.duration(series['time'][0])} to {data.duration(series['time'][-1])}"
    for key, value in (("title", html.escape(name)), ("subtitle", f"isph {scene['version']}, {date}; {ends}"),
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
