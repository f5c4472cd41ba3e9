#!/usr/bin/python3
"""A static site of all cases: each one's page, tables, options, and a report of its run with the liquid to turn.

    gallery.py [--cases NAME ...] [--output output/gallery] [--limit SECONDS] [--jobs N]          make gallery

The pages are the tree's own (README.md, cases/*/README.md, ...), as HTML by python3-markdown; no page needs a server or
another site. A case is run as in its case.opts (drop_impact as rings) for at most SECONDS on one core; a run that is
there already, in output/python, is not repeated (options/python.md). Prints the size and the time of the site."""
import argparse
import glob
import html
import os
import re
import resource
import shutil
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python"))
import display  # noqa: E402
import report  # noqa: E402
from isph import tables  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "..", "..")
SCENES = {"drop_impact": "axisymmetric.opts"}  # in place of case.opts: seconds, not minutes
SHARED = "scripts"  # folder of the site with what all reports share
STATES, TRIANGLES, DOTS = 8, 2500, 80  # of a report, and dots an inch of its pictures, so that 40 of them are small
PAGES = ("README.md", "CONTRIBUTING.md", "cases/*.md", "cases/*/*.md", "options/*.md", "tests/README.md",
         "tests/*/README.md")
FILES = (".png", ".opts", ".csv", ".svg", ".ipynb", ".html")  # that pages show or link
STYLE = """body { font: 16px/1.5 system-ui, sans-serif; max-width: 70rem; margin: 2rem auto; padding: 0 1rem; }
h2 { margin-top: 2.2rem; border-bottom: 1px solid #ddd; } img { max-width: 100%; } .wide { overflow-x: auto; }
table { border-collapse: collapse; } td, th { padding: 0.2rem 0.8rem 0.2rem 0; text-align: left; vertical-align: top; }
th { border-bottom: 1px solid #ccc; } pre { background: #f6f6f6; padding: 0.8rem; overflow-x: auto; }
code { background: #f6f6f6; } .run { background: #eef5fb; padding: 0.6rem 1rem; } a { color: #0072B2; }"""
LINK = re.compile(r'(href|src)="([^":#]+)(#[^"]*)?"')


def ran(names, limit, jobs, output):
    """{case: Run, or the sentence with which the program refused it}; their reports are in the site then."""
    def one(name):
        path = os.path.join("cases", name, SCENES.get(name, "case.opts"))
        try:
            run = isph.run(path, progress=False, wall_clock_limit=limit, checkpoint_interval=0)
            reported(run, os.path.join(output, "cases", name), name, reference_of(name))
        except isph.Error as error:
            run = str(error)
        print(f"{name}: {run}", flush=True)
        return run
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        return dict(zip(names, pool.map(one, names)))


def reference_of(name):
    """What the curves of a case are drawn beside (report.py --reference); None: nothing."""
    program, table = (os.path.join("cases", name, file) for file in ("check.py", "reference.csv"))
    if os.path.exists(program):
        with open(program, encoding="utf-8") as file:
            if "\ndef curves(" in file.read():
                return program
    return table if os.path.exists(table) else None


def reported(run, place, title, reference=None):
    """Draws the report of a run, unless it is there, and puts it and its pictures into a folder of the site.
    reference: of reference_of()."""
    page_of = os.path.join(run.folder, "report.html")
    shown = ["--states", STATES, "--triangles", TRIANGLES, "--scripts", f"../../{SHARED}", "--title", title]
    commands = (("pictures.py", "--dpi", DOTS),
                ("report.py", *shown, *(["--reference", reference] if reference else [])))
    series = os.path.join(run.folder, "series.csv")
    if not os.path.exists(page_of) or os.path.getmtime(page_of) < os.path.getmtime(series):
        for name, *flags in commands:
            done = subprocess.run([sys.executable, os.path.join(HERE, name), run.folder, *map(str, flags)], check=False,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            if done.returncode:
                raise tables.Error(f"{title}: {name}: {done.stderr.strip()}")
    shutil.copy(page_of, os.path.join(place, "report.html"))
    os.makedirs(os.path.join(place, "figures"), exist_ok=True)
    for name, _ in report.PICTURES:
        if os.path.exists(os.path.join(run.folder, "figures", name)):
            shutil.copy(os.path.join(run.folder, "figures", name), os.path.join(place, "figures"))


def said(run, scene):
    """The lines about a run at the head of a case's page."""
    if isinstance(run, str):
        return f'<p class="run">This case was not run here: {html.escape(run)}</p>'
    end, last = run.scene["time_end"], run.series["time"][-1]
    whole = "" if end is None or last >= end * (1 - 1e-6) else f" (to {last:.3g} of {end:.3g} s)"
    drawn = next(name for name in ("surface.png", "section.png")
                 if os.path.exists(os.path.join(run.folder, "figures", name)))
    return (f'<p class="run"><a href="report.html"><img src="figures/{drawn}" alt="moments of the run"></a><br>'
            f'<a href="report.html">The liquid to turn and play, with its curves</a>; <a href="{scene}">the option '
            f'file</a>; {run.series["particles"][-1]:.0f} particles, {run.series["step"][-1]:.0f} steps, '
            f'{run.series["wall_time"][-1]:.3g} s on one core{whole}.</p>')


def page(path, output, head=""):
    """Writes a page of markdown as HTML; its links lead to the pages of the site."""
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        text = file.read()
    body = markdown.markdown(text, extensions=["tables", "fenced_code", "toc", "md_in_html"])
    title = html.escape(re.search(r"^# (.*)", text, re.M)[1])
    body = re.sub("</h1>", "</h1>\n" + head.replace("\\", r"\\"), body, count=1)
    body = body.replace("<table>", '<div class="wide"><table>').replace("</table>", "</table></div>")
    folder = os.path.dirname(path)

    def linked(match):
        kind, target, part = match[1], match[2], match[3] or ""
        there = os.path.normpath(os.path.join(folder, target))
        if os.path.isdir(os.path.join(ROOT, there)) and os.path.exists(os.path.join(ROOT, there, "README.md")):
            target = os.path.join(target, "README.md")
        if target.endswith(".md"):
            return f'{kind}="{target[:-3]}.html{part}"'
        return match[0]

    up = os.path.relpath("index.html", folder or ".")
    place = os.path.join(output, path[:-3] + ".html")
    os.makedirs(os.path.dirname(place), exist_ok=True)
    with open(place, "w", encoding="utf-8") as file:
        file.write(f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content='
                   f'"width=device-width"><title>{title}</title><style>{STYLE}</style></head><body>\n<p><a href="{up}">'
                   f'isph</a></p>\n{LINK.sub(linked, body)}\n</body></html>\n')


def found(patterns):
    """The files of the tree that fit one of the patterns."""
    return sorted({os.path.relpath(path, ROOT) for pattern in patterns
                   for path in glob.glob(os.path.join(ROOT, pattern))})


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--cases", nargs="+", help="folders of cases/; default: all")
    parser.add_argument("--output", default=os.path.join("output", "gallery"))
    parser.add_argument("--limit", type=float, default=60, help="seconds of a run at most (60)")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)), help="cases at a time")
    arguments = parser.parse_args()
    display.with_display()
    began, output = time.monotonic(), os.path.abspath(arguments.output)
    os.chdir(ROOT)
    names = arguments.cases or [os.path.basename(os.path.dirname(path)) for path in found(["cases/*/case.opts"])]
    for path in found(f"{folder}/*{ending}" for folder in (".", "cases/*", "options", "tests/*") for ending in FILES):
        os.makedirs(os.path.dirname(os.path.join(output, path)), exist_ok=True)
        shutil.copy(path, os.path.join(output, path))
    os.makedirs(os.path.join(output, SHARED), exist_ok=True)
    for path in report.SCRIPTS:
        shutil.copy(path, os.path.join(output, SHARED))
    runs = ran(names, arguments.limit, arguments.jobs, output)
    for path in found(PAGES):
        name = os.path.basename(os.path.dirname(path))
        own = path == os.path.join("cases", name, "README.md") and name in runs
        page(path, output, said(runs[name], SCENES.get(name, "case.opts")) if own else "")
    with open(os.path.join(output, "index.html"), "w", encoding="utf-8") as file:
        file.write('<!DOCTYPE html><html><head><meta charset="utf-8"><meta http-equiv="refresh" content="0; '
                   'url=cases/README.html"><title>isph</title></head><body><a href="cases/README.html">isph: the cases'
                   '</a></body></html>\n')
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    size = sum(os.path.getsize(os.path.join(folder, file)) for folder, _, files in os.walk(output) for file in files)
    print(f"{os.path.join(output, 'index.html')}: {len(found(PAGES))} pages, {size / 1e6:.0f} MB, "
          f"{time.monotonic() - began:.0f} s, {used.ru_utime + used.ru_stime:.0f} s of processor time")


if __name__ == "__main__":
    with tables.polite("gallery.py"):
        import concurrent.futures
        import markdown
        import isph
        main()
