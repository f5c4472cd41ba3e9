#!/usr/bin/python3
"""The job of a cluster under Slurm and PBS, with stand-ins for their commands: a run is continued from its newest
checkpoint, starts afresh without one, enters the queue again unless it is done or failed, and ends with its own code.
And the recipe of the container copies what is needed."""
import os
import re
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

JOB = os.path.join(runs.ROOT, "options", "cluster", "isph.job")
LAUNCHER = """#!/bin/bash
if [ "$1" = --mpi=list ]; then echo "MPI plugin types are... none pmi2 $OFFERED"; exit; fi
while [[ $1 == --* ]]; do shift; done
exec "$@"
"""
QUEUE = """#!/bin/bash
printf '%s\\n' "${0##*/}" "$@" >"$QUEUED"
"""
# In place of the program: notes its arguments, and does what BEHAVE says.
ISPH = """#!/bin/bash
printf '%s\\n' "$@" >"$NOTES"
eval "$BEHAVE"
"""
SCENE = """-dimension 2
-spacing 0.025
-box_lower 0,0
-box_upper 1,1
-box_ymin wall
-gravity 0,-9.81
-bodies film
-film_upper 1,0.3
-time_end 2
-time_step 1.5e-4
"""
ENDED = "printf 'ended by -wall_clock_limit at 0.1 s\\nResults are in it\\n' >>\"$folder/log.txt\""
DONE = "printf 'Results are in it\\n' >>\"$folder/log.txt\""
SECONDS = 5000  # of a job under Slurm
here = runs.scratch("a user's folder")
notes, queued = os.path.join(here, "notes"), os.path.join(here, "queued")
scene = os.path.join(here, "my scene.opts")


def program(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    os.chmod(path, 0o755)


def lines(path):
    """Those of a file of a stand-in; none without the file, which is removed."""
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as file:
        words = file.read().splitlines()
    os.unlink(path)
    return words


def submit(queue, folder, behave="true", more=(), seconds=SECONDS, offered=""):
    """Runs the job as the queue would: (code, output, errors, arguments of the program, how it was queued again)."""
    environment = dict(runs.environment(), PATH=here + os.pathsep + os.environ["PATH"], NOTES=notes, QUEUED=queued,
                       BEHAVE=f"folder='{folder}'; {behave}", OFFERED=offered)
    words = ["bash", JOB]
    if queue == "slurm":
        environment.update(SLURM_JOB_ID="7", SLURM_JOB_END_TIME=str(int(time.time()) + seconds))
        words += [scene, folder, *more]
    else:
        environment.update(PBS_O_WORKDIR=here, scene=scene, folder=folder, options=" ".join(more))
    process = subprocess.run(words, cwd=here if queue == "slurm" else "/", env=environment, stdin=subprocess.DEVNULL,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120, check=False)
    return process.returncode, process.stdout, process.stderr, lines(notes), lines(queued)


def after(words, option):
    return words[words.index(option) + 1] if option in words else None


os.mkdir(here)
for name in ("srun", "mpiexec"):
    program(os.path.join(here, name), LAUNCHER)
for name in ("scontrol", "qsub", "sbatch"):
    program(os.path.join(here, name), QUEUE)
program(os.path.join(here, "isph"), ISPH)
with open(scene, "w", encoding="utf-8") as scene_file:
    scene_file.write(SCENE)
with open(JOB, encoding="utf-8") as job_file:
    job = job_file.read()
clock = {f"{int(h) * 3600 + int(m) * 60 + int(s)}" for h, m, s in re.findall(r"time=(\d+):(\d+):(\d+)$", job, re.M)}
allotted = re.search(r"^seconds=(\d+)", job, re.M)[1]
runs.check(clock == {allotted}, "one_time", f"the headers have {clock} s, the script {allotted} s")

lead = re.search("^lead=([0-9]+)", job, re.M)[1]
runs.check(f"--signal=USR1@{lead}\n" in job, "one_lead", lead)
for offered in ("", "pmix", "pmix_v4"):
    heard = submit("slurm", "output/mpi", 'echo "[$SLURM_MPI_TYPE]"; ' + DONE, offered=offered)[1]
    runs.check(f"[{'pmix' if offered == 'pmix' else ''}]" in heard, f"starts_by_{offered or 'what_slurm_has'}", heard)
code, out, err, words, put = submit("slurm", "output/short", DONE, seconds=int(lead) - 1)
runs.check(code == 1 and not words and not put and "give it a longer --time" in err, "short_job_is_refused",
           f"code {code}, {words}, {put}, {err}")

AGAIN = {"slurm": ["scontrol", "requeue", "7"], "pbs": ["qsub", "-v", "scene,folder,options", JOB]}
LIMIT = {"slurm": 0.9 * SECONDS, "pbs": 0.9 * int(allotted)}
for name, again in AGAIN.items():
    place = "output/" + name + " run"
    path = os.path.join(here, place)
    code, out, err, words, put = submit(name, place, DONE, ("-drop_radius", "1"))
    runs.check(code == 0 and "-restart" not in words and "-output_overwrite" in words, f"{name}_starts",
               f"code {code}, {words}, {err}")
    runs.check(not put and "is done" in out, f"{name}_that_is_done_stays_out", f"{put}, {out}")
    runs.check(after(words, "-drop_radius") == "1", f"{name}_options", str(words))
    runs.check_within(float(after(words, "-wall_clock_limit") or 0), LIMIT[name] - 10, LIMIT[name], f"{name}_limit")
    code, out, err, words, put = submit(name, place, ENDED)
    runs.check(code == 0 and put == again and "goes on" in out, f"{name}_goes_on", f"code {code}, {put}, {out}, {err}")
    code, out, err, words, put = submit(name, place, "echo 'isph: error: other' >&2; exit 3")
    runs.check(code == 3 and not put and "isph: error: other" in err and "failed with code 3" in err,
               f"{name}_that_failed_stays_out", f"code {code}, {put}, {out}, {err}")
    for step in ("000500", "999999", "1000000", "1000000.h5.tmp"):
        program(os.path.join(path, f"checkpoint_{step}" + ("" if "." in step else ".h5")), "")
    os.utime(os.path.join(path, "checkpoint_000500.h5"), (time.time() + 60,) * 2)
    code, out, err, words, put = submit(name, place, DONE)
    runs.check(code == 0 and not put and after(words, "-restart") == f"{place}/checkpoint_1000000.h5" and
               "-output_overwrite" not in words, f"{name}_continues_from_the_largest_number", f"code {code}, {words}")
    program(os.path.join(path, "checkpoint_clock.h5"), "")
    code, out, err, words, put = submit(name, place, DONE)
    runs.check(after(words, "-restart") == f"{place}/checkpoint_clock.h5", f"{name}_continues_from_the_clock",
               str(words))
    code, out, err, words, put = submit(
        name, place, "echo 'isph: error: the checkpoint c is at 1 s, not before -time_end 1 s' >&2; exit 1")
    runs.check(code == 0 and not put and "is done" in out, f"{name}_done", f"code {code}, {put}, {out}, {err}")

# the program itself, in as many jobs as it takes
os.unlink(os.path.join(here, "isph"))
os.symlink(runs.PROGRAM, os.path.join(here, "isph"))
folder, jobs, put = os.path.join(here, "output", "real"), 0, AGAIN["slurm"]
while put == AGAIN["slurm"] and jobs < 50:
    code, out, err, words, put = submit("slurm", folder, more=("-wall_clock_limit", "2"))
    jobs += 1
runs.check(code == 0 and not put and jobs > 1 and "is done" in out and runs.series(folder)["time"][-1] == 2,
           "the_program_in_several_jobs", f"code {code} after {jobs} jobs, {put}, {out[-300:]}, {err}")
print(f"{jobs} jobs")
code, out, err, words, put = submit("slurm", folder)
runs.check(code == 0 and not put and "is done" in out, "done_again", f"code {code}, {put}, {out}, {err}")
for path in runs.numbered(folder, "checkpoint"):
    os.unlink(path)
code, out, err, words, put = submit("slurm", folder, more=("-time_end", "0.05"))
runs.check(code == 0 and len(runs.numbered(folder, "checkpoint")) == 1, "starts_afresh_without_checkpoint",
           f"code {code}, {out[-300:]}, {err}")


def signalled(number, more):
    """A job whose program gets a signal in the middle of its steps, as Slurm sends it: (code, how it was queued again,
    newest checkpoint)."""
    before = runs.numbered(folder, "snapshot") if os.path.isdir(folder) else []
    environment = dict(runs.environment(), PATH=here + os.pathsep + os.environ["PATH"], QUEUED=queued,
                       SLURM_JOB_ID="7", SLURM_JOB_END_TIME=str(int(time.time()) + SECONDS))
    process = subprocess.Popen(["bash", JOB, scene, folder, *more], cwd=here, env=environment, text=True,
                               stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and len(runs.numbered(folder, "snapshot") if os.path.isdir(folder) else []) < \
            len(before) + 2:
        time.sleep(0.05)
    found = subprocess.run(["pgrep", "-P", str(process.pid), "isph"], stdout=subprocess.PIPE, text=True, check=False)
    for pid in found.stdout.split():
        os.kill(int(pid), number)
    return process.wait(120), lines(queued), runs.numbered(folder, "checkpoint")[-1:]


# the signals of the queue: each ends a job with a checkpoint, from which the next one goes on
folder, last = os.path.join(here, "output", "signalled"), 0
for number in (signal.SIGUSR1, signal.SIGTERM):
    code, put, newest = signalled(number, ("-time_end", "1000", "-snapshot_interval", "0.01"))
    at = runs.head(newest[0])["time"] if newest else 0
    runs.check(code == 0 and put == AGAIN["slurm"] and at > last, f"{number.name}_of_the_queue",
               f"code {code}, {put}, {newest}, {at} after {last}")
    last = at

# the container: what is copied, and that the program can be made and installed from it
with open(os.path.join(runs.ROOT, "options", "cluster", "Containerfile"), encoding="utf-8") as recipe_file:
    recipe = recipe_file.read()
copies = [line.split()[1:] for line in re.findall(r"^COPY .*$", recipe, re.M)]
sources = {word.rstrip("/") for words in copies for word in words[:-1]}
runs.check(bool(sources) and not sources & {".", "output", ".git", "*"}, "container_without_runs", str(sources))
runs.check(re.search("^ENV OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1", recipe, re.M),
           "root_of_container", "Open MPI refuses -ranks to root")
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
