#!/usr/bin/python3
"""A film of a run, with a frame for each snapshot.

    film.py RUN_FOLDER [--rate N] [--color NAME] [--section] [--azimuth DEG] [--elevation DEG]

Writes RUN_FOLDER/figures/film.mp4: the surface in perspective, or with --section and in two dimensions the section.
Needs ffmpeg and the packages of pictures.py.
"""
import argparse
import os
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python"))
from display import counted, with_display  # noqa: E402
from isph import tables  # noqa: E402

SIZE = (8.0, 6.0)  # inches at DPI dots: even numbers of pixels, as the encoder wants
DPI = 120


def frame(run, state, arguments, ends, view, path):
    figure, axes = plt.subplots(figsize=SIZE, layout="constrained")
    if view is None:
        lower, upper = arguments.window
        unit, name = data.scale(upper[0] - lower[0])
        views.section(axes, run, state, arguments.color, ends, unit)
        gas.draw(axes, run, state, unit)
        axes.set(xlim=(lower[0] * unit, upper[0] * unit), ylim=(lower[1] * unit, upper[1] * unit), aspect="equal")
        axes.set(xlabel=f"{run.across} ({name})", ylabel=f"{'xyz'[run.up]} ({name})")
    else:
        colormap = views.colormap(arguments.color)
        axes.imshow(views.picture(run, views.Shape(run, state, arguments.color, ends, colormap), *view))
        axes.set(xticks=[], yticks=[])
        pictures.scale_bar(axes, view[0])
    axes.set_title(f"t = {data.duration(state.time)}")
    pictures.key(figure, [axes], run, arguments.color, ends)
    figure.savefig(path, dpi=DPI)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folder", metavar="RUN_FOLDER")
    parser.add_argument("--rate", type=float, default=15, help="frames a second (15)")
    parser.add_argument("--color", metavar="NAME", default="body", help=pictures.COLORS)
    parser.add_argument("--section", action="store_true", help="the section, not the surface")
    parser.add_argument("--azimuth", type=float, default=25)
    parser.add_argument("--elevation", type=float, default=25)
    arguments = parser.parse_args()
    if not shutil.which("ffmpeg"):
        raise tables.Error("a film needs ffmpeg; on Debian: apt-get install ffmpeg")
    run = data.Run(arguments.folder)
    run.need(arguments.color)
    some = [run.read(path) for _, path in run.moments()]
    ends = views.limits(some, arguments.color)
    arguments.window = pictures.window(run, some)
    view = None
    if run.dim == 3 and not arguments.section:
        view = views.camera(run, some, arguments.azimuth, arguments.elevation)
    folder = os.path.join(arguments.folder, "figures")
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, "film.mp4")
    with tempfile.TemporaryDirectory() as scratch:
        for number, (_, snapshot) in enumerate(counted(run.files, len(run.files), "frames")):
            frame(run, run.read(snapshot), arguments, ends, view, os.path.join(scratch, f"{number:06d}.png"))
        command = ["ffmpeg", "-y", "-loglevel", "error", "-framerate", f"{arguments.rate:g}", "-i",
                   os.path.join(scratch, "%06d.png"), "-c:v", "libx264", "-pix_fmt", "yuv420p", path]
        if subprocess.run(command, check=False).returncode:
            raise tables.Error(f"ffmpeg could not make {path}.")
    print(path)


if __name__ == "__main__":
    with tables.polite("film.py"):
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
        with_display()
        import gas
        import pictures
        import run as data
        import views
        main()
