#!/usr/bin/python3
"""options/form.html in a browser: what it writes for each kind of scene runs, without an option that nothing reads, and
has the number of particles that it says; a number that is none is marked. Skipped without Chromium."""
import html
import os
import re
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

FORM = os.path.join(runs.ROOT, "options", "form.html")
BROWSER = ["chromium", "--headless", "--no-sandbox", "--virtual-time-budget=3000", "--dump-dom"]
KINDS = 10


def page(query, more="", was="", becomes=""):
    """The page after its script, and 'more', have run; with another text in its rows."""
    path = runs.scratch("form.html")
    with open(FORM, encoding="utf-8") as file, open(path, "w", encoding="utf-8") as out:
        out.write(file.read().replace(was, becomes).replace("</body>", f"<script>{more}</script></body>"))
    return subprocess.run([*BROWSER, f"file://{path}{query}"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                          text=True, check=False, timeout=60).stdout


if not shutil.which(BROWSER[0]):
    print("skipped: chromium is not installed")
    runs.done()
for kind in range(KINDS):
    seen = page(f"?kind={kind}")
    text = html.unescape(re.search(r'<pre id="text">(.*?)</pre>', seen, re.S)[1])
    said = int(re.search(r"(\d+) particles of the liquid", seen)[1])
    with open(runs.scratch(f"{kind}.opts"), "w", encoding="utf-8") as file:
        file.write(text)
    folder = runs.scratch(f"run_{kind}")
    done = runs.start([file.name, "-steps_max", "2", "-packing_cache", "", "-output_dir", folder])
    title = text.splitlines()[0][2:].partition(";")[0] if text else f"kind {kind}"
    if runs.check(done.returncode == 0 and "warning" not in done.stdout, title, done.stderr[-300:] + done.stdout[:300]):
        particles = runs.fields(runs.numbered(folder, "snapshot")[0])["body"]
        lines = [line.split()[0] for line in text.splitlines() if line.startswith("-")]
        controls = re.findall(r'id="option_(-\w+)"', seen)
        runs.check(controls == lines, f"{title}: a control for each option", str(set(lines) ^ set(controls)))
        runs.check_within((particles >= 0).sum() / said, 0.8, 1.25, f"{title}: particles")
runs.check(len(re.findall("<option", seen.split('id="fields"')[0])) == KINDS, "all_kinds", str(seen.count("<option")))
seen = page("?kind=0", "document.getElementById('field_d').value = 'two'; show();")
runs.check('class="bad"' in seen and '<pre id="text"></pre>' in seen, "a_number_that_is_none", seen[-300:])
# the rows of the program's options: their unit and meaning, their range, another option
seen = page("?kind=1")
runs.check('>-drop_radius (m)<' in seen and 'title="Radius of a sphere, a cylinder or a thread, (0, inf)' in seen,
           "unit_and_meaning_of_a_row", seen[-300:])
runs.check('title="Uniform part of the initial velocity' in seen and 'title="Velocity of the solid' not in seen,
           "a_body_is_no_solid", re.findall('title="[^"]*elocity[^"]*"', seen))
seen = page("?kind=1", "changed.set('-drop_density', '-1'); show();")
runs.check('<pre id="text"></pre>' in seen and "must be (0, inf)" in seen, "a_value_out_of_range", seen[-300:])
seen = page("?kind=1", "changed.set('-time_end', '1e-6'); add('-gauge_forces'); add('-drop_wave_mode');")
text = html.unescape(re.search(r'<pre id="text">(.*?)</pre>', seen, re.S)[1])
runs.check("\n-time_end 1e-6\n" in text and "\n-gauge_forces true\n" in text and "\n-drop_wave_mode 2\n" in text,
           "another_option", text)
# a new number of liquids, another range, another shape: no line of the form but its rows
DENSITY = '["-<body>_density","real","kg/m3","(0, inf)"'
HEAT = '["-<body>_heat","real","J/kg","(0, inf)",null,"7","Heat; of fusion","Body, any"],\n'
seen = page("?kind=1", "", DENSITY, HEAT + DENSITY)
runs.check(">Heat (J/kg)<" in seen and "\n-drop_heat 7\n" in seen and 'id="field_heat"' in seen,
           "a_new_number_of_liquids", re.findall("<label>.*?<", seen))
seen = page("?kind=1", "", DENSITY, DENSITY.replace("inf", "900]").replace("900])", "900]"))
runs.check('id="field_density" class="bad" title="(0, 900] in SI units"' in seen and '<pre id="text"></pre>' in seen,
           "range_of_a_field", re.findall('<input id="field_density"[^>]*>', seen))
seen = page("?kind=1", "", '["box","sphere"', '["torus","box","sphere"')
runs.check('<option value="torus">' in seen, "a_new_shape", "")
fields = html.unescape(re.search(r'<form id="fields">(.*?)</form>', seen, re.S)[1])
said = {words: unit for words, unit in re.findall(r"<label>([^<(]+?)(?: \(([^)]*)\))?<input", fields)}
runs.check(said == {"diameter of the drop": "um", "speed of the drop": "m/s", "contact angle": "degrees",
                    "Density": "kg/m3", "Dynamic viscosity": "mPa s", "Surface tension": "mN/m",
                    "spacings across the drop": "", "Time at which the run ends": "us"}, "units_of_the_fields",
           str(said))
with open(runs.scratch("more.opts"), "w", encoding="utf-8") as file:
    file.write(text)
done = runs.start([file.name, "-steps_max", "2", "-packing_cache", "", "-output_dir", runs.scratch("more")])
runs.check(done.returncode == 0, "another_option_runs", done.stderr[-300:])
runs.done()
