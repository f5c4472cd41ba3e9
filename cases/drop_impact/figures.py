#!/usr/bin/python3
"""Pictures of a drop impact: figure 1 (six moments, three views) and figure 2 (H, D, phi against time) of Kuri et al.

    figures.py RUN_FOLDER [MORE_RUN_FOLDERS] [--labels TEXT ...] [--times MS ...] [--quarter] [--only 1|2]

Reads series.csv, scene.json and snapshot_*.h5 of the run; writes RUN_FOLDER/figures/figure_1.png and figure_2.png.
The other runs appear in figure 2 only, which has a column for each impact speed. Needs Debian's python3-h5py,
python3-matplotlib, python3-vtk9 and, without a display, xvfb.
"""
import argparse
import functools
import glob
import os
import sys

import rundata
from display import together, with_display

TIMES = (2e-3, 6e-3, 12e-3, 25e-3, 45e-3, 60e-3)  # s: crown, crater, its end, jet
PANEL = (1000, 700)  # pixels of a rendered view
LETTERS = 17  # points, of figure 1: 9 pixels on a telephone that is 390 wide
SECTION = (-21.5e-3, 21.5e-3, -10e-3, 20.1e-3)  # m: x and z limits of the section's picture, as high as the jet
EYE = dict(position=(34e-3, -92e-3, 84e-3), focus=(1e-3, 0, -4.7e-3), up=(0, 0, 1), angle=20.2)
CURVES = {"crown_height": "crown height H (mm)", "crater_depth": "crater depth D (mm)",
          "crater_diameter": "crater diameter $\\phi$ (mm)"}
ABOVE = dict(position=(0, 0, 0.1), focus=(0, 0, 0), up=(0, 1, 0), height=26e-3)


def first(values):
    """The first number of an attribute, whether it is a scalar or an array."""
    return float(np.ravel(values)[0])


def snapshots(folder):
    """[(time, path)] of the snapshots that can be read, in order of time (s)."""
    found = []
    for path in sorted(glob.glob(os.path.join(folder, "snapshot_*.h5"))):
        try:
            with h5py.File(path, "r") as file:
                found.append((first(file.attrs["time"]), path))
        except (OSError, KeyError):
            print(f"figures.py: {path} is not a whole snapshot; left out.", file=sys.stderr)
    return sorted(found)


def choose(found, times):
    """The snapshots nearest to the times (s), each once; spread over a run that is shorter than the default times."""
    last = found[-1][0]
    if times is None:
        times = TIMES if last > TIMES[-2] else [last * (i + 1) / len(TIMES) for i in range(len(TIMES))]
    nearest = [min(found, key=lambda item, t=t: abs(item[0] - t)) for t in times]
    return sorted(set(nearest))


def read_snapshot(path, mirrors, quarter):
    """The liquid of a snapshot over the whole box: surface.Liquid."""
    with h5py.File(path, "r") as file:
        points = np.array(file["position"], float)
        body = np.array(file["body" if "body" in file else "color"]).ravel()
        spacing = first(file.attrs["spacing"])
        level = np.nan_to_num(first(file.attrs["level"])) if "level" in file.attrs else 0.0
        corners = [np.ravel(file.attrs[name]) for name in ("box_lower", "box_upper")]
        if "axisymmetric" in file.attrs and first(file.attrs["axisymmetric"]):
            if "volume" not in file:
                raise rundata.Error(f"{path} holds no volume of its rings (-snapshot_fields).")
            share, size = shares(file, body >= 0, points[body >= 0, 0], True, spacing)
            return rings(points[body >= 0], share, size, 1 - first_part(file, body, body >= 0), spacing, corners, level)
        liquid = (body >= 0) & np.all(np.isfinite(points), axis=1)
        share, size = shares(file, liquid, points[liquid, 0], False, spacing)
        drop = 1 - first_part(file, body, liquid)
    if points.ndim != 2 or points.shape[1] != 3:
        raise rundata.Error(f"{path} is not of a run in three dimensions.")
    points = points[liquid]
    lower, upper = (np.array(corner, float) for corner in corners)
    for axis, side in enumerate(("xmin", "ymin")):
        if quarter or side in mirrors:
            mirror = np.ones(3)
            mirror[axis] = -1
            shift = np.zeros(3)
            shift[axis] = 2 * lower[axis]
            points = np.concatenate([points, points * mirror + shift])
            drop, share, size = (np.concatenate([array, array]) for array in (drop, share, size))
            lower[axis] = 2 * lower[axis] - upper[axis]
    down = np.array([0, 0, level])
    return surface.Liquid(points - down, drop, spacing, lower - down, upper - down, share, size)


def rings(points, share, size, drop, spacing, corners, level):
    """The liquid of a snapshot with rings at points (r, z): their section, mirrored at the axis."""
    r, z = points[:, 0], points[:, 1] - level
    points = np.concatenate([np.stack([side * r, 0 * r, z], axis=1) for side in (1, -1)])
    reach, bottom, top = corners[1][0], corners[0][1] - level, corners[1][1] - level
    return surface.Liquid(points, np.tile(drop, 2), spacing, np.array([-reach, -reach, bottom]),
                          np.array([reach, reach, top]), np.tile(share, 2), np.tile(size, 2), True)


def draw_section(axes, image, loops):
    """The section through the axis, drop and film filled."""
    x0, x1, z0, z1 = (1e3 * x for x in SECTION)
    drawn = axes.imshow(image, origin="lower", extent=(x0, x1, z0, z1), interpolation="bilinear", aspect="equal")
    if loops:
        edge = Path.make_compound_path(*(Path(1e3 * loop, closed=False) for loop in loops))
        drawn.set_clip_path(edge, axes.transData)
    axes.axhline(0, color="0.45", lw=0.6, ls=(0, (4, 4)))
    axes.set(xlim=(x0, x1), ylim=(z0, z1))


def moment(mirrors, quarter, file):
    """What figure 1 shows of a snapshot: the surface as both cameras see it, and the section."""
    liquid = read_snapshot(file, mirrors, quarter)
    eye = surface.painted(liquid, EYE)
    return (eye, surface.painted(liquid, ABOVE, pale=True),
            (surface.section(liquid, SECTION, 0.25 * liquid.spacing), surface.outline(*eye[:2])))


def figure_1(folder, times, quarter, path):
    found = snapshots(folder)
    if not found:
        raise rundata.Error(f"{folder} holds no readable snapshot_*.h5.")
    faces, chosen = rundata.read_scene(folder)["domain"]["faces"], choose(found, times)
    mirrors = [face["name"] for face in faces if face["type"] == "symmetry"]
    rows = len(chosen)
    figure, axes = plt.subplots(rows, 3, figsize=(12.6, 0.35 + 2.9 * rows), squeeze=False,
                                gridspec_kw=dict(wspace=0.03, hspace=0.04))
    shapes = together(functools.partial(moment, mirrors, quarter), [file for _, file in chosen],
                      "moments of figure 1")
    for row, (time, _), (eye, top, middle) in zip(axes, chosen, shapes):
        row[0].imshow(surface.render(*eye, EYE, PANEL), interpolation="antialiased")
        above = ABOVE["height"] * 1e3 / 2
        wide = above * PANEL[0] / PANEL[1]
        row[1].imshow(surface.render(*top, ABOVE, PANEL), extent=(-wide, wide, -above, above),
                      interpolation="antialiased")
        draw_section(row[2], *middle)
        for panel in row:
            panel.set(xticks=[], yticks=[])
            for spine in panel.spines.values():
                spine.set(color="0.8", lw=0.8)
        row[0].text(0.025, 0.955, f"{round(1e3 * time, 1):g} ms", transform=row[0].transAxes, va="top",
                    size=1.1 * LETTERS, weight="bold")
    titles = ("drop and film", "drop's liquid from above", "section through the axis")
    for panel, title in zip(axes[0], titles):
        panel.set_title(title, size=LETTERS)
    for panel, x, z in ((axes[-1][1], 7, -11.6), (axes[-1][2], 8.5, 14.4)):
        panel.plot([x, x + 10], [z, z], color="black", lw=2)
        panel.text(x + 5, z + 0.4, "10 mm", ha="center", va="bottom", size=LETTERS)
    legend = [Patch(color=color, label=label) for color, label in (
        (surface.DROP_COLOR, "liquid of the drop"), (surface.FILM_COLOR, "of the film"),
        (surface.THIN_COLOR, "where it is thin"), (surface.PALE_COLOR, "of the film, pale"))]
    halves = sorted({face[0] for face in mirrors} | ({"x", "y"} if quarter else set()))
    words = ("", "half of the liquid was computed, mirrored in {}",
             "a quarter of the liquid was computed, mirrored in {}")[len(halves)].format(" and ".join(halves))
    figure.legend(handles=legend, loc="upper center", bbox_to_anchor=(0.51, 0.108), ncols=2, frameon=False,
                  fontsize=LETTERS, title_fontsize=LETTERS, columnspacing=1, title=words or None)
    figure.savefig(path, dpi=140, bbox_inches="tight", pad_inches=0.06)
    plt.close(figure)


def draw_curves(panels, speed, runs):
    """H, D and phi of runs {label: (colour, table)} of one speed (m/s; None: unknown) beside its references."""
    curves = [(rundata.read_reference(speed), dict(color="black", lw=1.6, label="reference (axisymmetric VOF)"))]
    if speed is not None:
        curves.append((rundata.read_reference(speed, "_box"),
                       dict(color="0.45", lw=1.2, ls=(0, (5, 2)), label="reference, pool of the box's area")))
    curves += [(table, dict(color=color, lw=1.8, label=label)) for label, (color, table) in runs.items()]
    end = max(max(table["time"]) for _, table in runs.values())
    for panel, (name, label) in zip(panels, CURVES.items()):
        for table, style in curves:
            time = 1e3 * np.array(table["time"])
            values = 1e3 * np.array(table.get(name, np.full(len(time), np.nan)))
            keep = (time >= 0) & (time <= max(1e3 * end, 1))
            if name == "crown_height" and "jet_height" in table:
                jet = 1e3 * np.array(table["jet_height"])
                up = keep & (time > 40) & (jet > 0)
                panel.plot(time[up], jet[up], **{**style, "ls": ":", "label": None})
                keep &= ~up  # a jet that leans passes for a crown
            panel.plot(time[keep], values[keep], **style)
        panel.set(ylabel=label, ylim=(0, None))
        panel.grid(color="0.9", lw=0.8)
        panel.set_axisbelow(True)
        panel.spines[["top", "right"]].set_visible(False)
    if end > 45e-3:
        panels[0].plot([], [], color="0.3", ls=":", lw=1.6, label="height of the jet")
    panels[0].legend(frameon=False, fontsize=9, loc="upper left")
    panels[-1].set_xlabel("time after contact (ms)")
    panels[-1].set_xlim(0, max(1e3 * end, 1))


def figure_2(folders, labels, path):
    """A column for each impact speed; runs with the same label have the same colour."""
    speeds = {}
    for folder, label in zip(folders, labels):
        runs = speeds.setdefault(rundata.reference_speed(folder), {})
        runs[label] = f"C{list(dict.fromkeys(labels)).index(label)}", rundata.read_series(folder)
    figure, axes = plt.subplots(3, len(speeds), figsize=(1 + 6.2 * len(speeds), 8.6), sharex="col", squeeze=False,
                                gridspec_kw=dict(hspace=0.08, wspace=0.16))
    for panels, (speed, runs) in zip(axes.T, sorted(speeds.items(), key=lambda item: -(item[0] or 0))):
        draw_curves(panels, speed, runs)
        if len(speeds) > 1:
            panels[0].set_title(f"{speed} m/s" if speed else "other speed")
    figure.savefig(path, dpi=110, bbox_inches="tight", pad_inches=0.06)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folders", metavar="RUN_FOLDER", nargs="+", help="runs; the first one gets the pictures")
    parser.add_argument("--labels", nargs="+", metavar="TEXT", help="names of the runs in figure 2")
    parser.add_argument("--times", type=float, nargs="+", metavar="MS", help="moments of figure 1, ms after contact")
    parser.add_argument("--quarter", action="store_true", help="the run is a quarter, cut at x = 0 and y = 0 (found "
                        "by itself if scene.json says so)")
    parser.add_argument("--only", choices=("1", "2"), help="make this figure only")
    arguments = parser.parse_args()
    for folder in arguments.folders:
        if not os.path.isdir(folder):
            raise rundata.Error(f"{folder} is not a folder.")
    labels = arguments.labels or [os.path.basename(os.path.abspath(folder)) for folder in arguments.folders]
    if len(labels) != len(arguments.folders):
        raise rundata.Error(f"{len(arguments.folders)} runs have {len(labels)} --labels.")
    output = os.path.join(arguments.folders[0], "figures")
    os.makedirs(output, exist_ok=True)
    times = [1e-3 * t for t in arguments.times] if arguments.times else None
    if arguments.only != "1":
        path = os.path.join(output, "figure_2.png")
        figure_2(arguments.folders, labels, path)
        print(path)
    if arguments.only != "2":
        path = os.path.join(output, "figure_1.png")
        figure_1(arguments.folders[0], times, arguments.quarter, path)
        print(path)


if __name__ == "__main__":
    with rundata.polite("figures.py"):
        import h5py
        import matplotlib
        import numpy as np
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
        from matplotlib.patches import Patch
        from matplotlib.path import Path
        with_display()
        import surface
        from run import first_part, shares
        main()
