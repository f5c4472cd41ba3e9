#!/usr/bin/python3
"""The lock of a run folder: a second run is refused and overwrites nothing, a dead run locks nothing, a run
whose folder is removed or moved ends with a sentence, and so does one whose ranks see different folders."""
import hashlib
import os
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

SCENE = """-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 1,1 -box_x wall -box_ymin wall -gravity 0,-9.81
 -bodies film -film_upper 1,0.3 -progress_interval 0 """
ENDLESS = SCENE + "-time_end 1e5 -series_interval 0.1 -wall_clock_limit 100 "
SHORT = SCENE + "-steps_max 2 "
LOCK = "run.lock"


def launch(options):
    """Starts a run; it has its lock and its first files when this returns."""
    process = subprocess.Popen([runs.PROGRAM] + runs.shlex.split(options), cwd=runs.ROOT, env=runs.environment(),
                               stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               universal_newlines=True)
    folder = runs.shlex.split(options)[-1]
    while process.poll() is None and not os.path.exists(os.path.join(folder, "snapshots.xdmf")):
        time.sleep(0.01)
    return process


def refused(process, words, name):
    """It ended with one sentence that has these words."""
    lines = [line for line in process.stderr.splitlines() if "isph: error: " in line]
    runs.check(process.returncode and len(lines) == 1 and all(word in lines[0] for word in words), name,
               f"code {process.returncode}: {process.stdout[-200:]} {process.stderr[-400:]}")


def end(process, timeout=60):
    """Waits for what was launched; as of runs.start."""
    out, err = process.communicate(timeout=timeout)
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)


def contents(folder):
    """What the files hold that a run writes once."""
    found = {}
    for name in ("options.opts", "version.txt", "snapshot_000000.h5", LOCK):
        with open(os.path.join(folder, name), "rb") as file:
            found[name] = hashlib.md5(file.read()).hexdigest()
    return found


def two_runs():
    """The second run into one folder, in every way to start it; the first goes on to its end."""
    folder = runs.scratch("two")
    first = launch(ENDLESS + f"-output_dir {folder}")
    checkpoint = os.path.join(runs.run(SHORT, "other"), "checkpoint_000002.h5")
    runs.check(os.path.exists(os.path.join(folder, LOCK)), "a_run_locks_its_folder", str(os.listdir(folder)))
    before = contents(folder)
    for name, options, ranks in (("overwrite", "-output_overwrite", 1), ("plain", "", 1),
                                 ("on_two_ranks", "-output_overwrite", 2), ("restart", f"-restart {checkpoint}", 1)):
        second = runs.start(SHORT + f"-output_dir {folder} {options}", ranks)
        refused(second, ["another run is going on", f"process {first.pid}"], f"second_run_{name}_is_refused")
    runs.check(contents(folder) == before, "nothing_is_overwritten", "files changed")
    first.send_signal(signal.SIGTERM)
    done = end(first)
    runs.check(done.returncode == 0 and not os.path.exists(os.path.join(folder, LOCK)), "the_end_removes_the_lock",
               f"code {done.returncode}: {done.stderr[-300:]}")
    steps = runs.series(folder)["step"]
    runs.check(len(steps) > 2 and (steps[1:] > steps[:-1]).all(), "the_first_run_is_whole", str(steps))
    refused(runs.start(SHORT + f"-output_dir {folder}"), ["holds a run already"], "a_finished_run_is_no_lock")
    runs.check(not os.path.exists(os.path.join(folder, LOCK)), "a_refused_run_leaves_no_lock", "it is there")


def dead():
    """The lock of a run that was killed, and a file of that name, keep nobody out."""
    folder = runs.scratch("dead")
    process = launch(ENDLESS + f"-output_dir {folder}")
    process.kill()
    end(process)
    lock = os.path.join(folder, LOCK)
    runs.check(os.path.exists(lock), "a_killed_run_leaves_its_file", "it is gone")
    for name in ("a_dead_lock", "an_empty_file"):
        again = runs.start(SHORT + f"-output_dir {folder} -output_overwrite")
        runs.check(again.returncode == 0 and not os.path.exists(lock), f"{name}_keeps_nobody_out", again.stderr[-300:])
        with open(lock, "w", encoding="utf-8"):
            pass
    kept = runs.scratch("kept")
    with open(kept, "w", encoding="utf-8") as file:
        file.write("keep me")
    os.unlink(lock)
    os.symlink(kept, lock)
    again = runs.start(SHORT + f"-output_dir {folder} -output_overwrite")
    with open(kept, encoding="utf-8") as file:
        runs.check(again.returncode and file.read() == "keep me", "a_link_is_not_followed", again.stderr[-300:])


def gone():
    """The folder is removed, moved or replaced, or only its lock is removed."""
    for name in ("removed", "moved", "replaced", "lock_removed"):
        folder, aside = runs.scratch(name), runs.scratch(name + "_aside")
        process = launch(ENDLESS + f"-output_dir {folder}")
        if name == "lock_removed":
            os.unlink(os.path.join(folder, LOCK))
        else:
            os.rename(folder, aside)
        if name == "removed":
            shutil.rmtree(aside)
        if name == "replaced":
            shutil.copytree(aside, folder)
        try:
            refused(end(process), [folder, "removed or moved"], f"folder_{name}")
        except subprocess.TimeoutExpired:
            process.kill()
            runs.check(False, f"folder_{name}", "the run goes on")
        if name == "replaced":
            runs.check(os.path.exists(os.path.join(folder, LOCK)), "the_lock_of_another_folder_stays", "it is gone")


def apart():
    """Two ranks with the same name of a folder, but in different places."""
    homes = [runs.scratch("here"), runs.scratch("there")]
    command = [runs.PROGRAM] + runs.shlex.split(SHORT + "-output_dir apart")
    for home in homes:
        os.mkdir(home)
    words = ["mpiexec", "-n", "1", "-wdir", homes[0]] + command + [":", "-n", "1", "-wdir", homes[1]] + command
    process = subprocess.run(words, env=runs.environment(2), timeout=120, stdin=subprocess.DEVNULL, check=False,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
    refused(process, ["Rank 1 does not see", "share"], "folders_that_are_not_shared")


for part in (two_runs, dead, gone, apart):
    part()
runs.done()
