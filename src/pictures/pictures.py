#!/usr/bin/python3
"""Pictures of any run, for a paper or a first look.

    pictures.py RUN_FOLDER [--times S ...] [--count N] [--color NAME] [--azimuth DEG] [--elevation DEG]
                [--curves NAME ...] [--format png|pdf|svg ...] [--width CM] [--dpi N]

Writes into RUN_FOLDER/figures:
    section.png   the section through the middle (in two dimensions all) at several times, with axes and units
    surface.png   three dimensions: the liquid's surface in perspective
    top.png       three dimensions: the view from above, with a scale bar
    curves.png    gauges and energies of the scene; with --curves the columns of that name
or .pdf, .svg.
Needs Debian's python3-h5py, python3-matplotlib, python3-vtk9 and, without a display, xvfb.
"""
import argparse
import functools
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python"))
from display import together, with_display  # noqa: E402
from isph import tables  # noqa: E402

with tables.polite("pictures.py"):
    import matplotlib
    import numpy as np
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    if __name__ == "__main__":
        with_display()
    import columns
    import gas
    import run as data
    import views

COLUMNS = 3  # of panels; fewer if they are flat, more if they are tall
INCH = 2.54  # cm
WIDE = 12.0  # inches, for which figures are drawn
LETTERS = 0.9  # inches, for title and numbers of a panel
COLORS = "body, speed, pressure, size, or a field of the snapshots as temperature; of a tensor its trace (body)"


def grid(count, width=4.0, height=3.0, columns=COLUMNS):
    """A figure with panels for 'count' times."""
    columns = min(columns, count)
    rows = -(-count // columns)
    scale = plt.rcParams["figure.figsize"][0] / WIDE
    height = scale * (height - LETTERS) + LETTERS
    figure, axes = plt.subplots(rows, columns, figsize=(scale * width * columns, height * rows), squeeze=False,
                                layout="constrained")
    for panel in axes.flat[count:]:
        panel.set_axis_off()
    return figure, list(axes.flat[:count])


def key(figure, axes, run, color, ends):
    """The legend: names of bodies, or the colour scale."""
    if color == "body":
        names = [(views.BODY_COLORS[b % len(views.BODY_COLORS)], name) for b, name in enumerate(run.bodies)]
        if len(run.solid):
            names.append((views.SOLID_COLOR, "solid"))
        marks = [plt.Line2D([], [], marker="o", ls="", color=c, label=name) for c, name in names]
        if len(marks) > 1:
            axes[0].legend(handles=marks, loc="upper right", fontsize=8, framealpha=0.8, handletextpad=0.2)
    else:
        scale = matplotlib.cm.ScalarMappable(matplotlib.colors.Normalize(*ends), views.colormap(color))
        words = "spacing over the finest" if color == "size" else f"{color} ({run.unit(color) or 1})"
        figure.colorbar(scale, ax=axes, label=words, shrink=0.8)


def save(figure, folder, name, formats):
    for ending in formats:
        path = os.path.join(folder, f"{name}.{ending}")
        figure.savefig(path)
        print(path)
    plt.close(figure)


def sections(run, states, arguments, ends, folder):
    lower, upper = window(run, states)
    unit, name = data.scale(upper[0] - lower[0])
    ratio = (upper[1] - lower[1]) / (upper[0] - lower[0])
    columns = 2 * COLUMNS if ratio > 2 else COLUMNS if ratio > 0.3 else 2 if ratio > 0.12 else 1
    width = 12.0 / columns
    figure, axes = grid(len(states), width, min(6.0, 0.93 * width * ratio + LETTERS), columns)
    for panel, state in zip(axes, states):
        views.section(panel, run, state, arguments.color, ends, unit)
        gas.draw(panel, run, state, unit)
        panel.set(xlim=(lower[0] * unit, upper[0] * unit), ylim=(lower[1] * unit, upper[1] * unit), aspect="equal")
        panel.set_title(f"t = {data.duration(state.time)}", fontsize=10)
        panel.set(xlabel=f"{run.across} ({name})", ylabel=f"{'xyz'[run.up]} ({name})")
        panel.label_outer()
    key(figure, axes, run, arguments.color, ends)
    save(figure, folder, "section", arguments.format)


def window(run, states):
    """Corners (x, up) of what sections show: the liquid of all states and the solids, cut by the box."""
    pair = [0, run.up]
    points = np.concatenate([part for state in states for part in (state.points, state.solid)])[:, pair]
    room = 0.04 * (points.max(axis=0) - points.min(axis=0)).max() + run.spacing
    return (np.maximum(run.lower[pair], points.min(axis=0) - room),
            np.minimum(run.upper[pair], points.max(axis=0) + room))


def surfaces(run, states, arguments, ends, folder):
    """Perspective, and the view from above."""
    colormap = views.colormap(arguments.color)
    shapes = together(functools.partial(views.Shape, run, color=arguments.color, ends=ends, colormap=colormap), states,
                      "surfaces")
    for name in ("surface", "top"):
        if name == "surface":
            view, half = views.camera(run, states, arguments.azimuth, arguments.elevation)
        else:
            view, half = views.above(run, states)
        figure, axes = grid(len(states), height=4.0 * views.PANEL[1] / views.PANEL[0] + 0.5)
        for panel, state, shape in zip(axes, states, shapes):
            panel.imshow(views.picture(run, shape, view, half))
            panel.set(xticks=[], yticks=[])
            panel.spines[:].set_color("0.8")
            panel.set_title(f"t = {data.duration(state.time)}", fontsize=10)
        scale_bar(axes[-1], view)
        key(figure, axes, run, arguments.color, ends)
        save(figure, folder, name, arguments.format)


def scale_bar(panel, view):
    """A scale bar below the picture: exact in a parallel view; in perspective at the distance of the focus, with a
    note."""
    if "height" in view:
        height, note = view["height"], ""
    else:
        distance = np.linalg.norm(np.subtract(view["position"], view["focus"]))
        height, note = 2 * distance * np.tan(np.radians(view["angle"] / 2)), " (at the centre)"
    length = data.bar(height)
    unit, name = data.scale(length)
    share = length / height * views.PANEL[1] / views.PANEL[0]
    panel.plot([0, share], [-0.03, -0.03], color="black", lw=2, transform=panel.transAxes, clip_on=False)
    panel.text(share + 0.02, -0.03, f"{length * unit:g} {name}{note}", fontsize=9, va="center",
               transform=panel.transAxes)


def curves(run, folder, arguments):
    """A panel for each column."""
    table = tables.read_series(run.folder)
    time = np.array(table["time"])
    chosen = columns.chosen(table, run.rows, arguments.curves)
    if not chosen:
        return
    figure, axes = grid(len(chosen), height=2.2)
    factor, unit = columns.prefixed(np.abs(time).max(), "s")
    for panel, (name, values) in zip(axes, chosen.items()):
        words, unit_of = columns.title(run.rows[name])
        scale, unit_of = columns.prefixed(np.nanmax(np.abs(values)), unit_of)
        panel.plot(factor * time, scale * values, color=views.BODY_COLORS[0], lw=1.3)
        panel.set_title(words + (f" ({unit_of})" if unit_of else ""), fontsize=9)
        panel.set_xlabel(f"time ({unit})", fontsize=9)
        panel.tick_params(labelsize=8)
        panel.grid(color="0.9")
        panel.spines[["top", "right"]].set_visible(False)
        if not panel.get_subplotspec().is_last_row() and panel not in axes[-COLUMNS:]:
            panel.set_xlabel("")
            panel.tick_params(labelbottom=False)
    save(figure, folder, "curves", arguments.format)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folder", metavar="RUN_FOLDER")
    parser.add_argument("--times", type=float, nargs="+", metavar="S", help="times to draw, s: the nearest snapshots")
    parser.add_argument("--count", type=int, default=6, help="number of times without --times (6)")
    parser.add_argument("--color", metavar="NAME", default="body", help=COLORS)
    parser.add_argument("--azimuth", type=float, default=25, help="of the eye, degrees from -y towards x (25)")
    parser.add_argument("--elevation", type=float, default=25, help="of the eye above the horizon, degrees (25)")
    parser.add_argument("--curves", nargs="+", metavar="NAME", help="columns of series.csv beginning so, or all; "
                        "default: the gauges' and the energies")
    parser.add_argument("--format", nargs="+", choices=("png", "pdf", "svg"), default=["png"],
                        help="of the files (png)")
    parser.add_argument("--width", type=float, default=WIDE * INCH, metavar="CM", help="of a figure of three columns; "
                        f"letters keep their size: 17 for a page ({WIDE * INCH:.1f})")
    parser.add_argument("--dpi", type=int, default=150, help="dots an inch (150)")
    arguments = parser.parse_args()
    plt.rcParams["savefig.dpi"] = arguments.dpi
    plt.rcParams["figure.figsize"] = (arguments.width / INCH, arguments.width / INCH)
    run = data.Run(arguments.folder)
    run.need(arguments.color)
    states = [run.read(path) for _, path in run.moments(arguments.times, max(1, arguments.count))]
    folder = os.path.join(arguments.folder, "figures")
    os.makedirs(folder, exist_ok=True)
    ends = views.limits(states, arguments.color)
    curves(run, folder, arguments)
    sections(run, states, arguments, ends, folder)
    if run.dim == 3:
        surfaces(run, states, arguments, ends, folder)


if __name__ == "__main__":
    with tables.polite("pictures.py"):
        main()
