#!/usr/bin/python3
"""src/python/isph.py: runs and their arrays, what is not repeated, sentences of the program, tables with and without
pandas, answers and studies, a stop; the recipe for the pressure's matrix of options/python.md; and the notebooks of the
cases, whose cells are executed.

    tests/docs/python.py [--part NAME]
    tests/docs/python.py --write    executes the notebooks in place, with their figures"""
import ast
import base64
import contextlib
import glob
import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import types

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

os.environ.update(runs.mpi.ANY, MPLBACKEND="Agg")
import isph  # noqa: E402
import numpy as np  # noqa: E402

PLACE = os.path.join(runs.ROOT, "src", "python")
SCENE = """-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 1,1 -box_xmin wall -box_xmax wall -box_ymin wall
 -bodies film -film_upper 0.5,0.5 -gravity 0,-9.81 -time_end 0.1 -series_interval 0.01 -snapshot_interval 0.05
 -solids part -part_lower 0.75,0.1 -part_upper 0.9,0.3 -part_velocity 0.1,0"""


def scene(folder, more=""):
    """A folder to work in, with an options file."""
    os.makedirs(folder)
    path = os.path.join(folder, "tank.opts")
    with open(path, "w", encoding="utf-8") as file:
        file.write(re.sub(r"\s+-", "\n-", f"{SCENE} {more}\n"))
    return path


def refused(function, words, name):
    try:
        function()
        runs.check(False, name, "it was not refused")
    except isph.Error as error:
        runs.check(words in str(error) and "\n" not in str(error), name, str(error))


def module():
    home = runs.scratch("module")
    tank = scene(home)
    os.chdir(home)
    many = isph.runs("tank.opts", gravity=[(0, -9.81), (0, -5)], film_viscosity=[1e-3, 1e-2], jobs=2)
    pairs = [(one.options["gravity"], one.options["film_viscosity"]) for one in many]
    runs.check(pairs == [((0, -9.81), 1e-3), ((0, -9.81), 1e-2), ((0, -5), 1e-3), ((0, -5), 1e-2)], "all_pairs",
               str(pairs))
    made = [next(o["value"] for o in one.scene["options"] if o["name"] == "-gravity") for one in many]
    runs.check(made == ["0,-9.81", "0,-9.81", "0,-5", "0,-5"], "options_reach_the_program", str(made))
    one, beside = many[0], runs.series(many[0].folder)
    runs.check(np.array_equal(one.series["highest"], beside["highest"]) and one.units["highest"] == "m" and
               one.units["kinetic_energy"] == "J/m", "series", str(one.units))
    last, there = one.snapshots[-1], runs.numbered(one.folder, "snapshot")
    runs.check(len(one.snapshots) == len(there) and last.time == runs.head(there[-1])["time"] and
               last.position.shape == last.velocity.shape == (100, 3), "snapshots", f"{last.position.shape}")
    whole = isph.Snapshot(there[-1], all=True)
    runs.check(len(whole.position) > 100 and "Results are in" in one.log, "log_and_all", one.log[-200:])
    table = many.table(top=lambda run: run.series["highest"][-1])
    runs.check(list(table) == ["gravity", "film_viscosity", "top"] and list(table["top"]) == [
        one.series["highest"][-1] for one in many], "table", str(table))
    sys.modules["pandas"] = types.SimpleNamespace(DataFrame=lambda columns: ("pandas", columns))
    kind, columns = one.table
    runs.check(kind == "pandas" and "highest" in columns, "table_of_pandas", kind)
    del sys.modules["pandas"]

    stamp = os.path.getmtime(os.path.join(one.folder, "series.csv"))
    again = isph.runs("tank.opts", gravity=(0, -9.81), film_viscosity=1e-3)
    runs.check(os.path.getmtime(os.path.join(again[0].folder, "series.csv")) == stamp, "not_repeated", again[0].folder)
    with open(tank, "a", encoding="utf-8") as file:
        file.write("-steps_max 2\n")
    again = isph.run("tank.opts", gravity=(0, -9.81), film_viscosity=1e-3)
    runs.check(again.folder == one.folder and again.series["step"][-1] == 2, "another_scene_is", str(again))
    stamp = os.path.getmtime(os.path.join(one.folder, "series.csv"))
    again = isph.run("tank.opts", again=True, gravity=(0, -9.81), film_viscosity=1e-3)
    runs.check(os.path.getmtime(os.path.join(one.folder, "series.csv")) > stamp, "again", again.folder)
    half = isph.running.Job("tank.opts", one.folder, True, 1, {"gravity": (0, -9.81), "film_viscosity": 1e-3})
    call = isph.launch.call
    isph.launch.call = lambda words: (_ for _ in ()).throw(isph.Error("stopped half way"))
    refused(half.go, "half way", "a_run_that_stops_half_way")
    isph.launch.call = call
    runs.check(isph.launch.made(one.folder)["mark"] == "", "half_a_run_is_none", str(isph.launch.made(one.folder)))
    two = isph.run("tank.opts", ranks=2, gravity=(0, -1))
    runs.check(two.scene["ranks"] == 2, "two_ranks", two.folder)

    swirl = {"film_velocity_type": "formula", "film_velocity_formula": "0.1*sin(pi*x/0.5), 0"}
    first = isph.run("tank.opts", time_end=1e-9, **swirl).snapshots[0]
    due = 0.1 * np.sin(np.pi * first.position[:, 0] / 0.5)
    runs.check_below(abs(first.velocity[:, 0] - due).max(), 1e-6, "formula")
    kept = isph.running.Job("tank.opts", None, False, 1, {"time_end": 1e-9, **swirl})
    runs.check(kept.done, "formula_is_cached", kept.folder)
    refused(lambda: isph.run("tank.opts", film_velocity_type="formula", film_velocity_formula="log(0-x),0"),
            "is no number at some", "formula_without_a_value")
    refused(lambda: isph.runs("tank.opts", film_viscosity=[1e-3, -1]), "-film_viscosity is -1", "refused")
    refused(lambda: isph.run("tank.opts", film_viscosty=1), "-film_viscosity", "misspelt")
    refused(lambda: isph.run("nowhere.opts"), "nowhere.opts cannot be opened", "no_scene")
    refused(lambda: isph.open_run("nowhere"), "nowhere has no run", "no_run")
    runs.run(SCENE + " -steps_max 1", os.path.join("module", "own"))
    refused(lambda: isph.run("tank.opts", output="own"), "own", "own_run_is_kept")
    runs.check(not glob.glob("output/python/*/*viscosity=-1*"), "nothing_computed_of_a_refused_list", "it was")


def stopped():
    """Ctrl-C in Python: the run ends with a checkpoint."""
    home = runs.scratch("stopped")
    scene(home, "-time_end 1000 -part_velocity 0,0")  # else it leaves the box
    program = f"import sys; sys.path.insert(0, {PLACE!r}); import isph; " \
        "isph.run('tank.opts', output='run', progress=True)"
    process = subprocess.Popen([sys.executable, "-c", program], cwd=home, stderr=subprocess.PIPE, text=True)
    folder = os.path.join(home, "run")
    while process.poll() is None and not (os.path.isdir(folder) and runs.numbered(folder, "snapshot")):
        time.sleep(0.05)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    with open(os.path.join(folder, "log.txt"), encoding="utf-8") as file:
        runs.check("KeyboardInterrupt" in said and "ended by SIGTERM" in file.read() and
                   runs.numbered(folder, "checkpoint") and "of 1 runs" in said, "stop_in_python", said[-300:])


STEPPED = """
import sys
sys.path.insert(0, %r)
import h5py
import numpy as np
import isph
from mpi4py import MPI
comm = MPI.COMM_WORLD
for name, options in (("whole", {}), ("stopped", {"film_viscosity": 0.1})):
    with isph.Simulation("tank.opts", comm=comm, output_dir=name, **options) as now:
        first, places = now.time, []
        now.step()
        liquid = now.layer == 0
        if name == "stopped":  # what is written changes the run
            given = 0 * now.velocity + np.where(liquid[:, None], [0.5, 0, 0], 0)
            now.velocity = given
            liquid = now.layer == 0
            drift = comm.allreduce(now.velocity[liquid, 0].sum()) / comm.allreduce(int(liquid.sum()))
            work = now.column("outside_work") / now.column("kinetic_energy")
            assert abs(drift - 0.5) < 1e-9 and 0.97 < work <= 1, (drift, work)
            now.step()
            liquid = now.layer == 0
            moved = comm.allreduce(now.velocity[liquid, 0].sum()) / comm.allreduce(int(liquid.sum()))
            assert 0.15 < moved < 0.45, moved  # the wall holds a part
            try:
                now.velocity = given[:1]
                raise AssertionError("not refused")
            except isph.Error as error:
                assert "shape" in str(error) or len(now.velocity) == 1, error
            now.velocity = 0 * now.velocity
            now.step()
            liquid = now.layer == 0
        total = comm.allreduce(int(liquid.sum()))
        assert total == 100 and (name == "stopped" or now.steps == 1 and now.time == now.time_step), (total, now.time)
        assert now.position.shape == (len(liquid), 3) and now.position.base is not None
        assert not now.position.flags.writeable and now.unit("velocity") == "m/s" and "lambda" in now.fields
        own, mass = now.velocity[liquid], 1000 * 0.05**2
        kinetic = comm.allreduce(0.5 * mass * (own**2).sum())
        assert abs(kinetic / now.column("kinetic_energy") - 1) < 0.02, (kinetic, now.column("kinetic_energy"))
        times = []

        def after(run):
            times.append((run.time, run.column("highest")))
            if name == "stopped" and len(times) == 3:
                raise ValueError("enough")
        try:
            now.run(after=after)
        except ValueError as error:
            assert name == "stopped" and str(error) == "enough" and len(times) == 3
            try:
                now.column("nothing")
                raise AssertionError("a column that is none")
            except isph.Error as later:  # not what the callback raised
                assert "nothing" in str(later), later
        else:
            assert name == "whole" and now.ended and now.time == 0.1 and len(times) == now.steps - 1
            assert now.scene is None or now.scene["time_end"] == 0.1
try:
    isph.Simulation("tank.opts", comm=comm, film_viscosity=-1)
    raise AssertionError("not refused")
except isph.Error as error:
    assert comm.rank or "-film_viscosity is -1" in str(error), error
if not comm.rank:
    with h5py.File(isph.open_run("whole").snapshots[-1].path) as file:
        assert file["position"].shape[1] == 3
    print("all", len(times), times[-1][1])
"""


LIVES = """
import gc, sys, types
sys.path.insert(0, %r)
import isph
import numpy as np
gc.disable()

def says(words, function):
    try:
        print("not refused:", words, function())
    except isph.Error as error:
        assert words in str(error) and "Isph" not in str(error), error

says("-film_viscosity is -1", lambda: isph.Simulation("tank.opts", film_viscosity=-1))
now = isph.Simulation("tank.opts")
says("tank.opts at 0 s; its close()", lambda: isph.Simulation("tank.opts"))
now.step()
place, up = now.position, now.position[:, 1]
kept = [np.asarray(place), place.copy(), place + 0, place[place[:, 0] >= -1]]
assert place.base is not None and not place.flags.writeable and up.max() == kept[0][:, 1].max()
assert np.linalg.norm(place, axis=1).shape == up.shape == (len(now.body),)
assert all(type(one) is np.ndarray for one in kept)
was = kept[1].copy()
says("in place", lambda: place.__setitem__(0, 1))
says("pressure", lambda: now.set("pressure", now.pressure))
try:
    now.velocty = 0
    print("not refused: a field that is misspelt")
except AttributeError:
    pass
now.step()
for late in (lambda: place + 1, lambda: up.max(), lambda: np.array(place), lambda: place[0],
             lambda: len(up), lambda: np.sum(up), lambda: list(place), lambda: place.shape):
    says("earlier state of the run", late)
assert all(np.array_equal(one, was) for one in kept) and not np.array_equal(was, now.position)
speed = now.velocity
now.velocity = 0 * now.velocity
says("earlier state", lambda: speed.max())
seen = []
now.run(0.05, lambda now: seen.append(now.position))
says("earlier state", lambda: seen[0].max())
now.run()
for late in (now.step, lambda: now.step(0.01)):
    says("the run is at its end, 0.1 s", late)
last = now.position
now.close()
now.close()
now = isph.Simulation("tank.opts")
says("callback cannot end its run", lambda: now.run(after=lambda now: now.close()))
last = now.position
now.close()
says("earlier state", lambda: last.max())
for name in ("time", "time_step", "steps", "ended", "scene", "position", "columns_now"):
    says("closed", lambda: now.column("highest") if name == "columns_now" else getattr(now, name))
for late in (now.step, now.run, now.checkpoint, lambda: now.unit("velocity"), lambda: now.set("velocity", 0)):
    says("closed", late)
for _ in range(2):  # one after the other, each ended by del
    now = isph.Simulation("tank.opts", steps_max=1)
    now.run(after=lambda now: seen.append(now.velocity))
    assert now.steps == 1 and now.ended
    del now
now = isph.Simulation("tank.opts", ksp_max_it=1, ksp_rtol=1e-14)
try:
    now.step()
    now.run()
except isph.Error as error:
    assert "Isph" not in str(error), error
now.close()
import isph.running
sys.modules["xarray"] = types.SimpleNamespace(Dataset=lambda fields, axes, attrs: (fields, axes, attrs))
class PolyData:
    def __init__(self, points):
        self.points, self.point_data = points, {}
sys.modules["pyvista"] = types.SimpleNamespace(PolyData=PolyData)
last = isph.run("tank.opts").snapshots[-1]
fields, axes, more = last.xarray()
points = last.pyvista()
assert fields["velocity"][0] == ("particle", "axis") and fields["velocity"][2]["units"] == last.units["velocity"]
assert fields["body"][0] == ("particle",) and more["time"] == last.time and len(points.points) == 100
assert np.array_equal(points.point_data["pressure"], last.pressure)
now = isph.Simulation("tank.opts")  # open at the end of Python
print("lives")
"""


def lives():
    """The life of a run in Python: what comes too early, too late or twice raises a sentence; nothing else ends."""
    home = runs.scratch("lives")
    scene(home)
    done = subprocess.run([sys.executable, "-c", LIVES % PLACE], cwd=home, env=runs.environment(), text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120, check=False)
    runs.check(done.returncode == 0 and done.stdout == "lives\n", "lives", done.stdout[-800:])


def interrupted():
    """Ctrl-C in a run that Python steps ends its steps and is raised; the run goes on after it."""
    home = runs.scratch("interrupted")
    scene(home, "-time_end 1000 -part_velocity 0,0")
    program = f"import sys; sys.path.insert(0, {PLACE!r}); import isph\nnow = isph.Simulation('tank.opts')\n" \
        "print('begins', flush=True)\ntry:\n    now.run()\nexcept KeyboardInterrupt:\n" \
        "    steps = now.steps\n    now.step()\n    print(now.steps - steps, now.ended)"
    process = subprocess.Popen([sys.executable, "-c", program], cwd=home, stdout=subprocess.PIPE, text=True,
                               env=runs.environment())
    process.stdout.readline()
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=60)
    runs.check(process.returncode == 0 and said == "1 False\n", "ctrl_c_in_a_stepped_run", said)


def stepped():
    """A run in the process of Python, on one and two ranks: fields without copies, columns, a callback, errors."""
    home, said = runs.scratch("stepped"), []
    scene(home)
    for ranks in (1, 2):
        words = ["mpiexec", "-n", str(ranks)] if ranks > 1 else []
        done = subprocess.run([*words, sys.executable, "-c", STEPPED % PLACE], cwd=home,
                              env=runs.environment(ranks), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                              stdin=subprocess.DEVNULL, timeout=120, check=False)
        runs.check(done.returncode == 0 and done.stdout.startswith("all 3 "), f"stepped_on_{ranks}",
                   done.stdout + done.stderr[-600:])
        said.append(done.stdout)
        shutil.rmtree(os.path.join(home, "stopped"), ignore_errors=True)
        one = isph.run(os.path.join(home, "tank.opts"), output=os.path.join(home, f"program_{ranks}"), ranks=ranks)
        here = isph.open_run(os.path.join(home, "whole"))
        same = [name for name in one.series if name != "wall_time" and not np.array_equal(
            one.series[name], here.series[name], equal_nan=True)]
        runs.check(not same, f"as_the_program_on_{ranks}", str(same))
        shutil.rmtree(os.path.join(home, "whole"))


def page():
    """The example of options/python.md for a run that Python steps, as it is written."""
    with open(os.path.join(runs.ROOT, "options", "python.md"), encoding="utf-8") as file:
        example = file.read().split("communicators are taken.\n")[1].split("\nA process")[0]
    example = "import isph\n" + "".join(line[4:] or "\n" for line in example.splitlines(True))
    done = subprocess.run([sys.executable, "-c", example], cwd=runs.ROOT, stdout=subprocess.PIPE, text=True,
                          check=False, env=dict(runs.environment(), PYTHONPATH=PLACE),
                          timeout=120, stderr=subprocess.STDOUT)
    words = done.stdout.split()
    runs.check(done.returncode == 0 and len(words) == 4 and 0.1 < float(words[0]) < 0.4 and words[3] == "m/s",
               "example_of_the_page", done.stdout[-300:])


def answers():
    home = runs.scratch("answers")
    scene(home, "-series_interval 0.002")
    os.chdir(home)
    found = isph.answer("tank.opts", "highest:end,kinetic_energy:max", accuracy=50, budget=8)
    with open("output/python/answers_tank/answer/answer.html", encoding="utf-8") as file:
        page = file.read()
    runs.check([one.quantity for one in found] == ["highest:end", "kinetic_energy:max"] and all(
        0 < one.bar < one.value for one in found) and found[0].unit == "m", "answer", str(found))
    runs.check(all(f"{one.value:.5g} +- {one.bar:.2g}" in page for one in found), "answer_of_the_page", page[-600:])
    table = isph.study("tank.opts", "highest:end", film_viscosity=[1e-3, 1e-1])
    ends = list(table["highest:end (m)"])
    runs.check(list(table["film_viscosity"]) == [1e-3, 1e-1] and ends[0] != ends[1] and 0 < min(ends) and
               max(ends) < 0.5, "study", str(table))
    refused(lambda: isph.answer("tank.opts", "hihgest:end"), "hihgest", "answer_refused")


def matrix():
    with open(os.path.join(runs.ROOT, "options", "python.md"), encoding="utf-8") as file:
        page = file.read().split("## The matrix of the pressure")[1]
    command = re.search(r"^    \./isph (.*)$", page, re.M)[1].split()
    os.chdir(runs.scratch(""))
    done = runs.start([word.replace("output/matrix", runs.scratch("matrix")).replace(
        "binary:", "binary:" + runs.scratch("")) for word in command])
    recipe = "".join(line[4:] or "\n" for line in page.split("is numpy:\n")[1].split("\n`scipy")[0].splitlines(True))
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        exec(recipe, space := {})  # pylint: disable=exec-used
    n, entries, residual = (float(word) for word in text.getvalue().split())
    turned = sorted(zip(space["columns"], space["rows"], space["values"]))
    odd = max(abs(a[2] - b[2]) for a, b in zip(sorted(zip(space["rows"], space["columns"], space["values"])), turned))
    runs.check(done.returncode == 0 and n > 1000 and entries > 10 * n and residual < 2e-3, "matrix", text.getvalue())
    runs.check(odd < 1e-12 * max(space["values"]), "matrix_is_symmetric", f"{odd}")


def shown(space, source):
    """Executes a cell: (its text, the value of its last line if that is an expression)."""
    tree, last = ast.parse(source), None
    value = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    with contextlib.redirect_stdout(io.StringIO()) as text:
        exec(compile(tree, "cell", "exec"), space)  # pylint: disable=exec-used
        if value:
            last = eval(compile(ast.Expression(value.value), "cell", "eval"), space)  # pylint: disable=eval-used
    return text.getvalue(), last


def outputs(text, last):
    """As a notebook keeps them."""
    import matplotlib.figure
    kept = [{"output_type": "stream", "name": "stdout", "text": text.splitlines(True)}] if text else []
    if isinstance(last, matplotlib.figure.Figure):
        picture = io.BytesIO()
        last.savefig(picture, dpi=80)
        data = {"image/png": base64.b64encode(picture.getvalue()).decode()}
    else:
        data = {"text/plain": repr(last).splitlines(True)}
    return kept + ([{"output_type": "display_data", "metadata": {}, "data": data}] if last is not None else [])


def notebooks():
    for path in sorted(glob.glob(os.path.join(runs.ROOT, "cases", "*", "*.ipynb"))):
        name, home = os.path.relpath(path, runs.ROOT), runs.scratch("notebook")
        shutil.copytree(os.path.dirname(path), os.path.join(home, "cases", "one"))
        os.chdir(os.path.join(home, "cases", "one"))
        with open(path, encoding="utf-8") as file:
            book = json.load(file)
        space, count = {}, 0
        for cell in book["cells"]:
            if cell["cell_type"] != "code":
                continue
            count += 1
            text, last = shown(space, "".join(cell["source"]))
            cell["outputs"], cell["execution_count"] = outputs(text, last), count
        table = space["table"]
        ratio = np.array(table["width"]) / np.array(table["cap"])
        runs.check(book["nbformat"] == 4 and count == 4, f"{name}_cells", str(count))
        runs.check(np.all(np.abs(ratio[2:] - 1) < 0.12) and np.all(np.diff(table["width"]) < 0), f"{name}_widths",
                   f"{table}")
        if "--write" in sys.argv:
            with open(path, "w", encoding="utf-8") as file:
                json.dump(book, file, indent=1)
                file.write("\n")
        shutil.rmtree(home)


PARTS = {f.__name__: f for f in (module, stopped, lives, interrupted, stepped, page, answers, matrix, notebooks)}
for part in ["notebooks"] if "--write" in sys.argv else runs.parts(*PARTS):
    PARTS[part]()
runs.done()
