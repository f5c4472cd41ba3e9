#!/usr/bin/python3
"""What may happen to a run from outside: killed at any moment, asked to end, a full disk, damaged files, folders that
cannot be written, names with tricks. Nothing is lost, nothing hangs, every refusal is one sentence.

    tests/faults/faults.py [--kills 50] [--damages 200] [--disks 40]

Without arguments a short part, as in make test; make faults tries as many as above. The last lines tell how many were
tried of each, how many the run survived and how many it refused."""
import argparse
import os
import random
import resource
import shutil
import signal
import stat
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

SCENE = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,1 -box_x periodic -box_ymin wall -gravity 0,-9.81
 -bodies film,drop -film_upper 1,0.3 -film_tension 20 -drop_shape sphere -drop_radius 0.1 -drop_center 0.5,0.45
 -drop_velocity 1,-2 -drop_tension 20 -series_interval 0.002 -snapshot_interval 0.02 -snapshot_double
 -progress_interval 0 """
END = 0.05  # s
OFTEN = SCENE + f"-checkpoint_interval 0.001 -time_end {END} "
SECONDS = 600  # a run of these takes two; the machine may be busy
tally = {}


def count(what, outcome):
    """Counts one trial of a kind: survived, refused or failed."""
    tally.setdefault(what, {}).setdefault(outcome, 0)
    tally[what][outcome] += 1


def launch(options, ranks=1, **kwargs):
    """Starts the program in a session of its own."""
    command = (["mpiexec", "-n", str(ranks)] if ranks > 1 else []) + [runs.PROGRAM] + options.split()
    return subprocess.Popen(command, cwd=runs.ROOT, env=runs.environment(ranks), stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True,
                            start_new_session=True, **kwargs)


def kill(process):
    """kill -9 of a process and of all others of its session: mpiexec puts ranks into groups of their own."""
    def session():
        found = []
        for name in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open(f"/proc/{name}/stat") as file:
                    fields = file.read().rsplit(")", 1)[1].split()
                if int(fields[3]) == process.pid and fields[0] != "Z":
                    found.append(int(name))
            except (FileNotFoundError, ProcessLookupError):
                pass
        return found
    alive = session()
    while alive:
        for number in alive:
            try:
                os.kill(number, signal.SIGKILL)
            except ProcessLookupError:
                pass
        alive = session()


def end(process, timeout=SECONDS):
    """Waits; (exit code, or None when it hung and was killed, standard output, standard error)."""
    try:
        out, err = process.communicate(timeout=timeout)
        return process.returncode, out, err
    except subprocess.TimeoutExpired:
        kill(process)
        out, err = process.communicate()
        return None, out, err


def said(err):
    """What a run said, without mpiexec's farewell."""
    lines = [line for line in err.splitlines() if "isph: error" in line or "PETSC ERROR" in line]
    return " | ".join(lines)[:400] or err.strip()[-300:]


def refusal(code, err):
    """Whether a run ended by one sentence of its own."""
    lines = [line for line in err.splitlines() if line.startswith("isph: error: ")]
    return code is not None and 0 < code < 126 and len(lines) == 1 and "PETSC ERROR" not in err


def newest(folder):
    """The newest checkpoint of a folder, or None."""
    files = runs.numbered(folder, "checkpoint") if os.path.isdir(folder) else []
    return files[-1] if files else None


# --- killed at random moments ---


def differing(whole, pieces):
    """What differs between the last checkpoints, snapshots and series of two runs."""
    found = []
    for kind in ("checkpoint", "snapshot"):
        names = [[os.path.basename(f) for f in runs.numbered(folder, kind)] for folder in (whole, pieces)]
        if names[0] != names[1]:
            return [f"{kind}s {names[0][-3:]}, {names[1][-3:]}"]
        for name in names[0]:
            a, b = (runs.fields(os.path.join(folder, name)) for folder in (whole, pieces))
            found += [f"{name}:{k}" for k in a if not np.array_equal(a[k], b[k], equal_nan=a[k].dtype.kind == "f")]
    a, b = runs.series(whole), runs.series(pieces)
    found += [c for c in a.dtype.names if c != "wall_time" and not np.array_equal(a[c], b[c], equal_nan=True)]
    for name in ("snapshots.xdmf", "options.opts"):
        with open(os.path.join(whole, name)) as x, open(os.path.join(pieces, name)) as y:
            a, b = sorted(x), sorted(y)
            found += [] if a == b else [f"{name}: {sorted(set(a) ^ set(b))}"]
    return found


def kill_in_writing(process, folder, later):
    """Kills when a checkpoint is half written (its .tmp is there), after 'later' others. Whether it came to that."""
    seen, caught = set(), False
    while process.poll() is None and not caught:
        try:
            present = [name for name in os.listdir(folder) if name.startswith("checkpoint_")]
        except FileNotFoundError:
            present = []
        seen.update(name for name in present if not name.endswith(".tmp"))
        caught = len(seen) > later + 1 and any(name.endswith(".tmp") for name in present)
        time.sleep(0 if caught else 5e-4)
    kill(process)
    return caught


def kills(number, ranks, rng):
    """One run, killed 'number' times and continued each time from its newest checkpoint, against one that was not."""
    what = f"kill -9 on {ranks}"
    began = time.time()
    whole = runs.run(OFTEN, f"whole_{ranks}", ranks)
    seconds = time.time() - began
    pieces, resumed, writing, done = runs.scratch(f"pieces_{ranks}"), 0, 0, 0
    while done < number:
        start = newest(pieces)
        process = launch(OFTEN + f"-output_dir {pieces} " + (f"-restart {start}" if start else "-output_overwrite"),
                         ranks)
        if done % 2:
            writing += kill_in_writing(process, pieces, rng.randint(1, 5))
        else:
            time.sleep(rng.uniform(0, seconds))
            kill(process)
        _, err = process.communicate()
        resumed += start is not None
        if "isph: error" in err and "-time_end" not in err:
            runs.check(False, f"{what}_{done}", said(err))
            count(what, "failed")
        else:
            count(what, "survived")
        done += 1
        start = newest(pieces)
        if start and runs.head(start)["time"] >= END and done < number:  # it came to its end: begin again
            bad = differing(whole, pieces)
            runs.check(not bad, f"{what}_continued_to_the_end_{done}", f"differing: {bad[:5]}")
            shutil.rmtree(pieces)
    start = newest(pieces)
    code, err = 0, ""
    if not start or runs.head(start)["time"] < END:
        code, _, err = end(launch(OFTEN + f"-output_dir {pieces} " + (f"-restart {start}" if start else
                                                                      "-output_overwrite"), ranks))
    bad = differing(whole, pieces) if code == 0 else [f"code {code}, {said(err)}"]
    print(f"{what}: {done} kills, {writing} of them while a checkpoint was written, {resumed} continued")
    runs.check(not bad, f"{what}_equals_the_uninterrupted_run", f"differing: {bad[:5]}")


# --- asked to end ---


def signals():
    """SIGTERM, SIGUSR1, SIGINT and -wall_clock_limit: a checkpoint, code 0, and the run can be continued."""
    endless = SCENE + "-time_end 1000 "
    for name, number in (("SIGTERM", signal.SIGTERM), ("SIGUSR1", signal.SIGUSR1), ("SIGINT", signal.SIGINT),
                         ("wall_clock_limit", None)):
        folder = runs.scratch(name)
        process = launch(endless + f"-output_dir {folder} " + ("" if number else "-wall_clock_limit 1"))
        if number:
            while not os.path.exists(os.path.join(folder, "snapshot_000000.h5")) and process.poll() is None:
                time.sleep(0.05)
            time.sleep(0.3)
            os.kill(process.pid, number)
        code, out, err = end(process)
        good = code == 0 and newest(folder) and "continue with -restart" in out and not err.strip()
        runs.check(good, f"{name}_ends_the_run_with_a_checkpoint", f"code {code}: {said(err)}")
        if good:
            code, _, err = end(launch(SCENE + f"-steps_max 2 -output_dir {folder} -restart {newest(folder)}"))
            runs.check(code == 0, f"{name}_can_be_continued", said(err))
        count("asked to end", "survived" if good else "failed")


# --- no room ---


def disk(options, ranks, what, limit=None):
    """A run that meets the end of its room must end with a sentence, all files under their final names whole. limit:
    of the size of a file, from the first snapshot on (MPI's own files need more before)."""
    folder = options.split("-output_dir ")[1].split()[0]
    process = launch(options, ranks)
    while limit and process.poll() is None and not os.path.exists(os.path.join(folder, "snapshot_000000.h5")):
        time.sleep(0.01)
    if limit and process.poll() is None:
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (limit, limit))
    code, _, err = end(process)
    if code == 0:
        count(what, "survived")
        return
    whole = True
    for kind in ("checkpoint", "snapshot"):
        for name in runs.numbered(folder, kind) if os.path.isdir(folder) else []:
            try:
                runs.fields(name)
            except (OSError, KeyError) as error:
                whole = False
                print(name, error)
    good = refusal(code, err) and whole
    count(what, "refused" if good else "failed")
    if not good:
        runs.check(False, f"{what}, {options.split('-output_dir')[1]}", f"code {code}: {said(err)}")
    elif newest(folder):  # what is there can be continued where there is room
        copy = runs.scratch("copy.h5")
        shutil.copy(newest(folder), copy)
        code, _, err = end(launch(SCENE + f"-steps_max 1 -restart {copy} -output_dir {runs.scratch('room')}"
                                  " -output_overwrite"))
        runs.check(code == 0, f"{what}_continued", said(err))


def disks(number, rng):
    """Small file systems of random sizes, and a limit on the size of files; on one and two ranks."""
    place = runs.scratch("disk")
    os.mkdir(place)
    dense = SCENE + "-checkpoint_interval 0.002 -snapshot_interval 0.002 -time_end 0.02 "
    mounted = 0
    for k in range(number):
        size = int(rng.uniform(4, 900)) * 1024
        if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "none", place],
                          stderr=subprocess.DEVNULL, check=False).returncode:
            break
        mounted += 1
        try:
            disk(dense + f"-output_dir {place}/run", 1 + k % 2, "full disk")
        finally:
            subprocess.run(["umount", place], check=True)
    if not mounted:
        print("full disk: mounting is not allowed here; only limits on file sizes are tried")
    for k in range(number):
        size = int(rng.uniform(100, 100000))
        disk(dense + f"-output_dir {runs.scratch(f'limit_{k}')}", 1, "file too large", size)
    runs.check(not tally.get("full disk", {}).get("failed") and not tally["file too large"].get("failed"),
               "no_room_is_a_sentence")


# --- damaged files ---


def damaged(source, target, rng):
    """A copy cut short, or with one to four bits flipped; a description."""
    shutil.copy(source, target)
    size = os.path.getsize(target)
    if rng.random() < 0.3:
        length = rng.randrange(size)
        os.truncate(target, length)
        return f"truncated to {length} of {size}"
    with open(target, "r+b") as file:
        places = [rng.randrange(size) for _ in range(rng.randint(1, 4))]
        for place in places:
            file.seek(place)
            byte = file.read(1)[0]
            file.seek(place)
            file.write(bytes([byte ^ (1 << rng.randrange(8))]))
    return f"bits flipped at {places} of {size}"


def damages(number, rng):
    """Damaged checkpoints are refused; a damaged packing is made again. Limits of memory and time: no huge
    allocation, no endless loop."""
    bound = lambda: resource.setrlimit(resource.RLIMIT_DATA, (1 << 30, 1 << 30))
    good = newest(runs.run(SCENE + "-steps_max 2", "undamaged"))
    broken, folder = runs.scratch("broken.h5"), runs.scratch("of_broken")
    for k in range(number):
        how = damaged(good, broken, rng)
        code, _, err = end(launch(SCENE + f"-steps_max 1 -restart {broken} -output_dir {folder}",
                                  1 + (k % 10 == 0), preexec_fn=bound))
        fine = refusal(code, err) and broken in err and not newest(folder)
        count("damaged checkpoint", "refused" if fine else "failed")
        if not fine:
            runs.check(False, f"checkpoint {how}", f"code {code}: {said(err)}")
    runs.check(not tally["damaged checkpoint"].get("failed"), "damaged_checkpoints_are_refused")
    packed = SCENE + f"-packing_type poisson -packing_cache {runs.scratch('cache')} -steps_max 1 -output_overwrite "
    first = runs.fields(newest(runs.run(packed, "packed")))
    cached = os.path.join(runs.scratch("cache"), os.listdir(runs.scratch("cache"))[0])
    shutil.copy(cached, broken)
    for k in range(max(3, number // 20)):
        how = damaged(broken, cached, rng)
        code, _, err = end(launch(packed + f"-output_dir {folder}", preexec_fn=bound))
        again = runs.fields(newest(folder)) if code == 0 else {}
        fine = code == 0 and all(np.array_equal(first[k], again[k], equal_nan=True) for k in ("position", "velocity"))
        count("damaged packing", "survived" if fine else "failed")
        if not fine:
            runs.check(False, f"packing {how}", f"code {code}: {said(err)}")
    runs.check(not tally["damaged packing"].get("failed"), "damaged_packings_are_made_again")


# --- folders and names ---


def names():
    """Names of files come from options: nothing is written outside the run's folder, nothing is executed, modes are
    those of the user's mask."""
    home = runs.scratch("home")
    os.mkdir(home)
    for k, name in enumerate(("$(touch owned)", "`touch owned`", ";touch owned", "a|touch owned", "%s%n%s%n",
                              "-restart_",
                              "a b", "\u00e4\u00f6", "a'b", 'a"b', "*", "~", "a//b/./c", "x" * 200)):
        folder = os.path.join(home, f"{k}", name)
        process = runs.start(runs.shlex.split(SCENE) + ["-steps_max", "1", "-output_dir", folder])
        inside = [os.path.join(p, f) for p, _, files in os.walk(os.path.join(home, f"{k}")) for f in files]
        there = process.returncode == 0 and os.path.isdir(folder) and newest(folder)
        fine = (there or refusal(process.returncode, process.stderr)) and not any("owned" == os.path.basename(f)
                                                                                  for f in inside)
        fine = fine and not os.path.exists(os.path.join(runs.ROOT, "owned"))
        fine = fine and all(os.path.realpath(f).startswith(os.path.realpath(folder)) for f in inside)
        modes = {stat.S_IMODE(os.stat(f).st_mode) for f in inside}
        fine = fine and modes <= {0o644}
        count("odd name", "survived" if there else "refused" if fine else "failed")
        runs.check(fine, f"output_dir_{k}", f"{name!r}: code {process.returncode}, modes "
                   f"{[oct(m) for m in modes]}, {said(process.stderr)}")
    for body in ("../up", "a/b", "a b", "$(ls)", "-x", "", "9", "a" * 300):
        process = runs.start(runs.shlex.split(SCENE) + ["-bodies", f"film,{body}", "-steps_max", "1", "-output_dir",
                                                        os.path.join(home, "body")])
        fine = refusal(process.returncode, process.stderr)
        count("odd name", "refused" if fine else "failed")
        runs.check(fine, f"body_{body[:20]!r}", f"code {process.returncode}: {said(process.stderr)}")


def folders():
    """Folders that cannot be made or written; a file that is a link out of the folder."""
    blocked = runs.scratch("a_file")
    with open(blocked, "w") as file:
        file.write("keep me\n")
    tries = {"under_a_file": f"{blocked}/run", "in_proc": "/proc/run", "a_device": "/dev/null"}
    for name, folder in tries.items():
        code, _, err = end(launch(SCENE + f"-steps_max 1 -output_dir {folder}"))
        fine = refusal(code, err)
        count("unwritable folder", "refused" if fine else "failed")
        runs.check(fine, name, f"code {code}: {said(err)}")
    folder = runs.run(SCENE + "-steps_max 1", "linked")
    os.unlink(os.path.join(folder, "series.csv"))
    for name in ("series.csv", "options.opts", "checkpoint_000001.h5.tmp", "snapshot_000000.h5.tmp", "version.txt"):
        path = os.path.join(folder, name)
        if os.path.lexists(path):
            os.unlink(path)
        os.symlink(blocked, path)
    code, _, err = end(launch(SCENE + f"-steps_max 1 -output_overwrite -output_dir {folder}"))
    with open(blocked) as file:
        kept = file.read() == "keep me\n"
    runs.check(kept, "links_are_not_followed", f"code {code}: {said(err)}")
    count("link out of the folder", "survived" if kept else "failed")


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--kills", type=int, default=4)
parser.add_argument("--damages", type=int, default=10)
parser.add_argument("--disks", type=int, default=3)
parser.add_argument("--seed", type=int, default=1)
arguments = parser.parse_args()
dice = random.Random(arguments.seed)
kills(arguments.kills - arguments.kills // 5, 1, dice)
kills(max(1, arguments.kills // 5), 2, dice)
signals()
disks(arguments.disks, dice)
damages(arguments.damages, dice)
names()
folders()
print(f"{'fault':28s} {'tried':>6s} {'survived':>9s} {'refused':>8s} {'failed':>7s}")
for kind, results in tally.items():
    print(f"{kind:28s} {sum(results.values()):6d} {results.get('survived', 0):9d} {results.get('refused', 0):8d} "
          f"{results.get('failed', 0):7d}")
runs.done()
