#!/usr/bin/python3
"""make report in a browser: scenes of 10 um, 1 mm and 10 m are seen; slider, play and colours act; pointing at a curve
reads the values of all curves, and a click shows the liquid of this time. Skipped without Chromium."""
import html
import json
import os
import re
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402
import columns  # noqa: E402
import report  # noqa: E402
from isph import tables  # noqa: E402

# a ball flies to the right and falls; numbers in braces are times the size of the scene
SPACE = """-dimension 3 -box_lower {-.5},{-.5},{-.5} -box_upper {.5},{.5},{.5} -box_zmin wall -bodies ball
 -ball_shape sphere -ball_radius {.25} -ball_velocity {1},0,0 -gravity 0,0,{-2} -spacing {.0625}"""
PLANE = """-dimension 2 -box_lower {-.5},{-.5} -box_upper {.5},{.5} -box_ymin wall -bodies ball -ball_shape sphere
 -ball_radius {.25} -ball_velocity {1},0 -gravity 0,{-2} -spacing {.03125} -solids peg -peg_lower {-.5},{-.5}
 -peg_upper {-.3},{-.4}"""
SCENES = (("10 um", 1e-5, SPACE), ("1 mm", 1e-3, PLANE), ("10 m", 10, SPACE))
RUN = """ -ball_viscosity 0 -ball_tension 0 -steps_max 20 -time_step 0.01 -snapshot_interval 0.02
 -series_interval 0.01 -checkpoint_interval 0"""
BROWSER = ["chromium", "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
           "--window-size=1000,800", "--virtual-time-budget=10000", "--dump-dom"]
ACTS = """<script>
(async function () {
  const found = {}, by = id => document.getElementById(id), wait = ms => new Promise(done => setTimeout(done, ms));
  function liquid() { // the part of the picture that has colour, its middle
    const canvas = document.querySelector('#view canvas'), copy = document.createElement('canvas');
    const wide = copy.width = canvas.width, high = copy.height = canvas.height, context = copy.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const bytes = context.getImageData(0, 0, wide, high).data;
    let count = 0, x = 0, y = 0;
    for (let k = 0; k < wide * high; k++) {
      const rgb = bytes.subarray(4 * k, 4 * k + 3);
      if (Math.max(...rgb) - Math.min(...rgb) < 60) continue;
      count++;
      x += k % wide / wide;
      y += Math.floor(k / wide) / high;
    }
    return [count / wide / high, x / count, y / count];
  }
  function set(id, value, event) {
    by(id).value = value;
    by(id).dispatchEvent(new Event(event));
  }
  try {
    found.count = +by('moment').max + 1;
    set('moment', 0, 'input');
    found.first = liquid();
    set('moment', by('moment').max, 'input');
    found.last = liquid();
    found.label = by('time').textContent;
    found.colors = [...by('color').options].map(option => option.value);
    set('color', 'speed', 'change');
    found.colored = liquid();
    found.scale = [...by('scale').querySelectorAll('span')].map(tick => tick.textContent);
    set('moment', 0, 'input');
    by('play').click();
    await wait(400);
    by('play').click();
    found.played = +by('moment').value;
    await wait(400);
    found.paused = +by('moment').value;
    for (const fold of document.querySelectorAll('#curves details')) fold.open = true;
    await wait(100);
    const over = document.querySelector('.u-over'), place = over.getBoundingClientRect();
    const at = {clientX: place.left + 0.7 * place.width, clientY: place.top + 0.5 * place.height, bubbles: true};
    for (const kind of ['mouseenter', 'mousemove', 'mousedown', 'mouseup', 'click']) {
      over.dispatchEvent(new MouseEvent(kind, at));
      await wait(100);
    }
    found.values = [...document.querySelectorAll('#curves div:has(> output)')].map(
      head => [head.querySelector('b').textContent, head.querySelector('output').textContent]);
    found.clicked = by('time').textContent;
  } catch (error) {
    found.error = error.message;
  }
  document.body.dataset.found = JSON.stringify(found);
})();
</script>
"""


def scene(name, size, text):
    """The folder of a run of this size, m."""
    options = re.sub(r"\{(\S+?)\}", lambda number: f"{size * float(number[1]):g}", text)
    return runs.run(options + RUN, name.replace(" ", "_"))


def acted(folder):
    """What the browser found on the page of a run."""
    command = [sys.executable, os.path.join(runs.ROOT, "src", "pictures", "report.py"), folder, "--triangles", "2000"]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if not runs.check(done.returncode == 0, "report", done.stderr[-500:]):
        return {}
    path = os.path.join(folder, "report.html")
    with open(path, encoding="utf-8") as file:
        page = file.read()
    with open(path, "w", encoding="utf-8") as file:
        file.write(page.replace("</body>", ACTS + "</body>"))
    done = subprocess.run([*BROWSER, "file://" + path], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                          check=False, timeout=60)
    body = re.search("<body[^>]*>", done.stdout)
    found = re.search('data-found="([^"]*)"', body[0] if body else "")
    good = found and "data-error" not in body[0] and "error" not in json.loads(html.unescape(found[1]))
    return json.loads(html.unescape(found[1])) if runs.check(good, "acts", body and body[0]) else {}


def without_webgl(folder):
    """The page says so, and hides what would turn the liquid; the curves are there."""
    done = subprocess.run([*(word for word in BROWSER if "swiftshader" not in word), "--disable-3d-apis",
                           "file://" + os.path.join(folder, "report.html")], stdout=subprocess.PIPE, text=True,
                          stderr=subprocess.DEVNULL, check=False, timeout=60)
    runs.check("has no WebGL" in done.stdout and '<p class="bar turn" hidden' in done.stdout and
               "u-over" in done.stdout, "without_webgl", done.stdout[-300:])


def on_a_phone(folder):
    """Nothing is wider than the screen of a phone, 390 pixels: the page in a frame."""
    frame = os.path.join(folder, "phone.html")
    with open(frame, "w", encoding="utf-8") as file:
        file.write('<body><iframe src="report.html" width="390" height="800" style="border:0"></iframe><script>'
                   'onload = () => setTimeout(() => { const page = frames[0].document.documentElement; '
                   'document.body.dataset.wide = page.scrollWidth; }, 3000);</script></body>')
    done = subprocess.run([*BROWSER, "--allow-file-access-from-files", "file://" + frame], stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True, check=False, timeout=60)
    wide = re.search('data-wide="([0-9]+)"', done.stdout)
    runs.check(wide and 300 < int(wide[1]) <= 390, "on_a_phone", wide and wide[1])


def seconds(text):
    number, unit = text.split()
    return float(number) / {"s": 1, "ms": 1e3, "µs": 1e6}[unit]


def look(name, size, text):
    folder = scene(name, size, text)
    found = acted(folder)
    if name == "1 mm":
        without_webgl(folder)
        on_a_phone(folder)
    if not found:
        return
    (share, x, y), (_, far, low), last = found["first"], found["last"], found["count"] - 1
    runs.check_within(share, 0.05, 0.7, f"{name}: part of the picture with liquid")
    runs.check(far > x + 0.02 and low > y + 0.01, f"{name}: the slider moves it", f"{found['first']} {found['last']}")
    runs.check(abs(seconds(found["label"]) - 0.2) < 0.011, f"{name}: the last time", found["label"])
    runs.check(0 < found["played"] <= last and found["paused"] == found["played"], f"{name}: play and pause",
               f"{found['played']} {found['paused']}")
    runs.check(found["colors"] == ["body", "speed", "pressure"], f"{name}: colours", found["colors"])
    runs.check_within(found["colored"][0] / found["last"][0], 0.7, 1.1, f"{name}: liquid coloured by speed")
    ends = [float(tick.split()[0]) for tick in (found["scale"][0], found["scale"][-1])]
    unit = {"10 um": 1e-6, "1 mm": 1e-3, "10 m": 1}[name]
    runs.check(ends[0] == 0 and 1 <= ends[1] * unit / size <= 1.5 and found["scale"][-1].endswith("m/s"),
               f"{name}: scale", found["scale"])
    series = tables.read_series(folder)
    rows = tables.rows_of(folder)
    chosen = columns.chosen(series, rows)
    wanted = {column: chosen[column] for column in sorted(chosen, key=lambda one: report.GROUPS.index(
        report.group_of(rows[one])))}
    runs.check([head for head, _ in found["values"]] == [columns.title(rows[column])[0] for column in wanted],
               f"{name}: a curve for each column", found["values"])
    for (head, value), numbers in zip(found["values"], wanted.values()):
        told, _, when = value.partition(" at ")
        got = float(told.split()[0] if told else "nan")
        k = int(np.argmin(np.abs(np.array(series["time"]) - seconds(when)))) if when else 0
        factor, _ = columns.prefixed(np.nanmax(np.abs(numbers)), "J")
        runs.check(abs(series["time"][k] - 0.14) < 0.011 and np.isclose(got, factor * numbers[k], rtol=1e-3),
                   f"{name}: {head} at the pointer", f"{value}, not {numbers[k]}")
    runs.check(abs(seconds(found["clicked"]) - 0.14) < 0.011, f"{name}: a click shows the time", found["clicked"])


if shutil.which(BROWSER[0]):
    for row in SCENES:
        look(*row)
else:
    print("skipped: chromium is not installed")
runs.done()
