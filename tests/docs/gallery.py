#!/usr/bin/python3
"""make gallery: each page's links lead to files of the site, none needs a server; a case that was run has its report,
its picture and its cost, one that the program refuses has its sentence. Skipped without python3-markdown."""
import glob
import importlib.util
import json
import os
import re
import subprocess
import sys
import types

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

if not importlib.util.find_spec("markdown"):
    print("skipped: python3-markdown is not installed")
    runs.done()
site = runs.scratch("site")
done = subprocess.run([sys.executable, os.path.join(runs.ROOT, "src", "pictures", "gallery.py"), "--cases", "free_fall",
                       "nowhere", "--output", site], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                      env=runs.environment(), check=False)
runs.check(done.returncode == 0 and re.search(r"\d+ pages, \d+ MB, \d+ s, \d+ s of processor time$", done.stdout),
           "gallery", done.stdout[-400:])
pages = glob.glob(os.path.join(site, "**", "*.html"), recursive=True)
broken, servers = [], []
for path in pages:
    with open(path, encoding="utf-8") as file:
        text = file.read()
    if path.endswith("report.html"):
        continue
    for target in re.findall(r'(?:href|src)="([^"#]+)', text):
        if target.startswith(("http", "mailto")):
            continue
        servers += [target] if target.startswith("/") else []
        there = os.path.normpath(os.path.join(os.path.dirname(path), target))
        if not os.path.exists(there) and target.endswith((".html", ".png", ".md")):
            broken.append((os.path.relpath(path, site), target))
runs.check(len(pages) > 80 and not broken and not servers, "links", str((broken + servers)[:5]))
case = os.path.join(site, "cases", "free_fall")
with open(os.path.join(case, "README.html"), encoding="utf-8") as file:
    text = file.read()
runs.check(re.search(r"\d+ particles, \d+ steps, \S+ s on one core", text) and "<table>" in text, "page_of_a_case",
           text[:600])
with open(os.path.join(case, "report.html"), encoding="utf-8") as file:
    text = file.read()
shared = re.findall('<script src="([^"]+)"', text)
runs.check("<h1>free_fall</h1>" in text, "title_of_a_report", text[:2000])
runs.check(len(shared) == 5 and all(os.path.exists(os.path.join(case, path)) for path in shared), "shared_scripts",
           str(shared))
runs.check(all(os.path.getsize(os.path.join(case, name)) > 5000 for name in ("report.html", "figures/section.png")),
           "report_of_a_case", str(os.listdir(case)))
sys.path.insert(0, os.path.join(runs.ROOT, "src", "pictures"))
import gallery  # noqa: E402
home, drawn = runs.scratch("drawn"), []
os.makedirs(os.path.join(home, "figures"))
for name in ("series.csv", "report.html", os.path.join("figures", "section.png")):
    with open(os.path.join(home, name), "w", encoding="utf-8"):
        pass
gallery.subprocess = types.SimpleNamespace(DEVNULL=None, PIPE=None, run=lambda words, **_: drawn.append(
    words[1]) or types.SimpleNamespace(returncode=0))
for newer, due in (("report.html", 0), ("series.csv", 2)):
    for name in ("series.csv", "report.html"):
        os.utime(os.path.join(home, name), (0, 1000 + (name == newer)))
    gallery.reported(types.SimpleNamespace(folder=home), home + "/figures", "one")
    runs.check(len(drawn) == due, f"report_where_{newer}_is_newer", str(drawn))
bare = sorted(name for name in os.listdir(os.path.join(runs.ROOT, "cases")) if glob.glob(
    os.path.join(runs.ROOT, "cases", name, "reference*.csv")) and not gallery.reference_of(name))
runs.check(not bare, "cases_beside_their_references", str(bare))
# front and height of a dam break at twice its spacing, which are no columns of the series, beside the reference
dam = os.path.join(runs.ROOT, "cases", "dam_break")
folder = runs.run("-options_file " + os.path.join(dam, "case.opts") + " -spacing 5.715e-3 -time_end 0.15", "dam")
command = [sys.executable, os.path.join(runs.ROOT, "src", "pictures", "report.py"), folder, "--reference",
           gallery.reference_of("dam_break")]
subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
with open(os.path.join(folder, "report.html"), encoding="utf-8") as file:
    text = file.read()
groups = json.loads(re.search(r'id="series"[^>]*>(.*?)</script>', text, re.S)[1])["groups"]
for one in groups[0]["curves"]:
    here, there = np.array([one["values"], one["reference"]], float)
    runs.check(np.abs(here / there - 1)[5:].max() < 0.1 and len(here) > 30, f"{one['title']} beside the reference",
               str(one)[:300])
runs.check(len(groups[0]["curves"]) == 2 and "Dashed: Two-phase volume of fluid by Gerris" in text, "curves_of_a_case",
           str([group["title"] for group in groups]))
runs.check("nowhere: the options file cases/nowhere/case.opts cannot be opened" in done.stdout, "refused_case",
           done.stdout[-400:])
runs.done()
