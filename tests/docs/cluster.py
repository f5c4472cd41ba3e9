#!/usr/bin/python3
"""The scripts for Slurm and the recipe of the container, with stand-ins for srun: a run is continued from its newest
checkpoint, starts afresh without one, says that it is done, ends with its own code; the recipe copies what is
needed."""
import os
import re
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

SCRIPTS = {"isph": os.path.join(runs.ROOT, "options", "cluster", "isph.sbatch"),
           "impact": os.path.join(runs.ROOT, "cases", "drop_impact", "cluster.sbatch")}
SRUN = """#!/bin/bash
while [[ $1 == --* ]]; do shift; done
exec "$@"
"""
# In place of the program: notes its arguments, and does what BEHAVE says.
ISPH = """#!/bin/bash
[[ $* == *-dump_options* ]] && exit 0
printf '%s\\n' "$@" >"$NOTES"
$BEHAVE
"""
SCENE = """-dimension 2
-spacing 0.1
-box_lower 0,0
-box_upper 1,1
-box_ymin wall
-gravity 0,-9.81
-bodies film
-film_upper 1,0.3
-time_end 0.05
-time_step 1e-3
"""
here = runs.scratch("a user's folder")
notes = os.path.join(here, "notes")
scene = os.path.join(here, "my scene.opts")


def program(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    os.chmod(path, 0o755)


def begin(script, folder, behave="true"):
    """Starts a script as Slurm would, in our folder; isph is found as ./isph and in the path."""
    if os.path.exists(notes):
        os.unlink(notes)
    environment = dict(runs.environment(), PATH=here + os.pathsep + os.environ["PATH"], NOTES=notes, BEHAVE=behave)
    words = [scene, folder] if script == "isph" else []
    return subprocess.Popen(["bash", SCRIPTS[script]] + words, cwd=here, env=environment, stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def submit(script, folder, behave="true"):
    """(code, output, errors, arguments of the program)."""
    process = begin(script, folder, behave)
    out, err = process.communicate(timeout=120)
    words = []
    if os.path.exists(notes):
        with open(notes, encoding="utf-8") as file:
            words = file.read().splitlines()
    return process.returncode, out, err, words


def after(words, option):
    return words[words.index(option) + 1] if option in words else None


os.mkdir(here)
program(os.path.join(here, "srun"), SRUN)
program(os.path.join(here, "isph"), ISPH)
with open(scene, "w", encoding="utf-8") as scene_file:
    scene_file.write(SCENE)

for name in SCRIPTS:
    place = "output/my run" if name == "isph" else "output/impact_100M"
    path = os.path.join(here, place)
    code, out, err, words = submit(name, place)
    runs.check(code == 0 and "-restart" not in words and "-output_overwrite" in words, f"{name}_starts",
               f"code {code}, {words}, {err}")
    os.makedirs(path, exist_ok=True)
    for step in ("000500", "999999", "1000000", "1000000.h5.tmp"):
        program(os.path.join(path, f"checkpoint_{step}" + ("" if "." in step else ".h5")), "")
    code, out, err, words = submit(name, place)
    runs.check(code == 0 and after(words, "-restart") == f"{place}/checkpoint_1000000.h5" and
               "-output_overwrite" not in words, f"{name}_continues_from_the_largest_number", f"code {code}, {words}")
    done = 'eval echo "isph: error: the checkpoint c is at 1 s, not before -time_end 1 s" >&2; exit 1'
    code, out, err, words = submit(name, place, done)
    runs.check(code == 0 and "is done" in out, f"{name}_done", f"code {code}, {out}, {err}")
    code, out, err, words = submit(name, place, 'eval echo "isph: error: other" >&2; exit 3')
    runs.check(code == 3 and "isph: error: other" in err and "is done" not in out, f"{name}_fails",
               f"code {code}, {out}, {err}")

# a run that hangs is ended by the watchdog, one that goes on is not
os.environ.update(ISPH_SILENCE="2", ISPH_WATCH="1")
silent = "eval trap '' TERM; for ((k = 0; k < 200; k++)); do sleep 0.2; done"
began = time.time()
code, out, err, words = submit("isph", "output/hangs", silent)
runs.check(code == 137 and "has had no line for 2 s" in err and time.time() - began < 30, "isph_that_hangs_is_ended",
           f"code {code} after {time.time() - began:.0f} s, {err}")
busy = "eval for ((k = 0; k < 25; k++)); do sleep 0.2; echo >>output/goes/log.txt; done"
code, out, err, words = submit("isph", "output/goes", busy)
runs.check(code == 0 and "no line" not in err, "isph_that_goes_on_is_not", f"code {code}, {err}")
del os.environ["ISPH_SILENCE"], os.environ["ISPH_WATCH"]

# the script of the impact hands the signal on and waits for the checkpoint
process = begin("impact", "",
                "eval trap 'echo checkpoint; exit 0' TERM; for ((k = 0; k < 300; k++)); do sleep 0.1; done")
while not os.path.exists(notes) and process.poll() is None:
    time.sleep(0.05)
time.sleep(0.5)
process.send_signal(signal.SIGTERM)
out, err = process.communicate(timeout=120)
runs.check(process.returncode == 0 and "checkpoint" in out, "impact_hands_the_signal_on",
           f"code {process.returncode}, {out}, {err}")

# the program itself
os.unlink(os.path.join(here, "isph"))
os.symlink(runs.PROGRAM, os.path.join(here, "isph"))
folder = os.path.join(here, "output", "real")
code, out, err, words = submit("isph", folder)
runs.check(code == 0 and len(runs.numbered(folder, "checkpoint")) == 2, "checkpoints_on_the_way",
           f"code {code}, {err}, {sorted(os.listdir(folder))}")
code, out, err, words = submit("isph", folder)
runs.check(code == 0 and "is done" in out, "done_again", f"code {code}, {out[-300:]}, {err}")
with open(scene, "a", encoding="utf-8") as scene_file:
    scene_file.write("-time_end 0.06\n")
code, out, err, words = submit("isph", folder)
runs.check(code == 0 and abs(runs.series(folder)["time"][-1] - 0.06) < 1e-12, "continues_with_a_later_end",
           f"code {code}, {out[-300:]}, {err}")
for path in runs.numbered(folder, "checkpoint"):
    os.unlink(path)
code, out, err, words = submit("isph", folder)
runs.check(code == 0 and len(runs.numbered(folder, "checkpoint")) == 2, "starts_afresh_without_checkpoint",
           f"code {code}, {out[-300:]}, {err}")

# the container: what is copied, and that the program can be made and installed from it
with open(os.path.join(runs.ROOT, "options", "cluster", "Containerfile"), encoding="utf-8") as recipe_file:
    copies = [line.split()[1:] for line in re.findall(r"^COPY .*$", recipe_file.read(), re.M)]
sources = {word.rstrip("/") for words in copies for word in words[:-1]}
runs.check(bool(sources) and not sources & {".", "output", ".git", "*"}, "container_without_runs", str(sources))
tree = runs.scratch("isph-src")
os.mkdir(tree)
for source in sorted(sources - {"."}):
    whole = os.path.join(runs.ROOT, source)
    if os.path.isdir(whole):
        shutil.copytree(whole, os.path.join(tree, source))
    else:
        shutil.copy(whole, tree)
made = subprocess.run(["make", "-n", "PORTABLE=1", "isph", "install"], cwd=tree, text=True, stdout=subprocess.PIPE,
                      stderr=subprocess.PIPE, check=False)
needed = re.findall(r"/usr/bin/python3 ([\w./-]+\.py)", made.stdout)
runs.check(made.returncode == 0 and all(os.path.exists(os.path.join(tree, path)) for path in needed),
           "container_has_what_is_needed", f"{made.stderr[-300:]} {needed}")
runs.done()
