#!/usr/bin/python3
"""Signals, closed pipes and the wall clock, at any moment of a run, on one and two ranks: the run ends with its last
checkpoint and series written, and with a sentence that names what ended it; before the first step with the sentence
alone. One that is ignored from outside (nohup) stays ignored. Faults of one rank alone and silence end all.

    tests/faults/signals.py [--all]

Without --all a short part, as in make test. The last lines tell how many were tried, continued and refused."""
import contextlib
import os
import re
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

SCENE = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,1 -box_x periodic -box_ymin wall -gravity 0,-9.81
 -bodies film,drop -film_upper 1,0.3 -film_tension 20 -drop_shape sphere -drop_radius 0.1 -drop_center 0.5,0.45
 -drop_velocity 1,-2 -drop_tension 20 -series_interval 0.002 -snapshot_interval 0.02 -progress_interval 0.05
 -time_end 1000 """
SLOW = SCENE + "-packing_cache '' -spacing 0.004 "
MOMENTS = {"set-up": SCENE, "packing": SLOW + "-packing_type poisson", "step": SCENE,
           "relaxation": SCENE + "-scheme density_invariant -packing_relaxation_time 10",
           "write": SCENE + "-checkpoint_interval 1e-4"}
ENDING = ("HUP", "INT", "QUIT", "PIPE", "TERM", "USR1", "XCPU")
SECONDS = 120  # a run of these ends in two; the machine may be busy
tally = {}


def count(what, outcome, why=""):
    """Counts a trial and checks it; outcome: continued, refused or failed."""
    tally.setdefault(what.split(",")[0], []).append(outcome)
    runs.check(outcome != "failed", what, why)


def launch(options, ranks=1, **kwargs):
    """Starts the program, with all its processes in a session of its own."""
    command = (["mpiexec", "-n", str(ranks)] if ranks > 1 else []) + [runs.PROGRAM] + runs.shlex.split(options)
    kwargs = {"stdout": subprocess.PIPE, **kwargs}
    return subprocess.Popen(command, cwd=runs.ROOT, env=runs.environment(ranks),
                            stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, universal_newlines=True,
                            start_new_session=True, **kwargs)


def ranks_of(process):
    """The processes of the program in its session that note signals already."""
    found = []
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat", encoding="utf-8") as file:
                fields = file.read().rsplit(")", 1)[1].split()
            if int(fields[3]) != process.pid or os.path.realpath(f"/proc/{name}/exe") != os.path.realpath(runs.PROGRAM):
                continue
            with open(f"/proc/{name}/status", encoding="utf-8") as file:
                caught = int(next(line for line in file if line.startswith("SigCgt")).split()[1], 16)
            if caught >> (signal.SIGTERM - 1) & 1:
                found.append(int(name))
        except (FileNotFoundError, ProcessLookupError, PermissionError, StopIteration):
            pass
    return sorted(found)


def wait(process, ranks, moment, folder):
    """Until the run has come to the moment; the processes."""
    present = lambda start, end: os.path.isdir(folder) and any(n.startswith(start) and n.endswith(end)
                                                               for n in os.listdir(folder))
    while process.poll() is None and len(ranks_of(process)) < ranks:
        time.sleep(0.002)
    if moment in ("packing", "relaxation"):  # its first line of progress
        while process.poll() is None and f"the {moment}" not in process.stdout.readline():
            pass
    while moment == "step" and process.poll() is None and not present("snapshot", ".h5"):
        time.sleep(0.002)
    while moment == "write" and process.poll() is None and not present("checkpoint", ".tmp"):
        pass
    while moment == "checkpoint" and process.poll() is None and not present("checkpoint", ".h5"):
        time.sleep(0.002)
    return ranks_of(process)


def end(process):
    """The exit code (None: it hung and was killed), standard output and standard error."""
    try:
        out, err = process.communicate(timeout=SECONDS)
        return process.returncode, out or "", err
    except subprocess.TimeoutExpired:
        for pid in ranks_of(process) + [process.pid]:
            os.kill(pid, signal.SIGKILL)
        out, err = process.communicate()
        return None, out or "", err


def outcome(code, text, err, folder, name):
    """continued: it wrote a checkpoint that a run can start from, and the series to that time; refused: a sentence."""
    lines = [line for line in err.splitlines() if line.startswith("isph: error: ")]
    if "PETSC ERROR" in err or code is None:
        return "failed"
    if code and 0 < code < 126 and len(lines) == 1 and f"ended by {name}" in lines[0]:
        return "refused"
    files = runs.numbered(folder, "checkpoint") if os.path.isdir(folder) else []
    if code or lines or not files or f"ended by {name}" not in text or f"-restart {files[-1]}" not in text:
        return "failed"
    at = runs.head(files[-1])["time"]
    again = runs.start(SCENE + f"-steps_max 1 -restart {files[-1]} -output_dir {folder}")
    whole = again.returncode == 0 and abs(runs.series(folder)["time"][-2] - at) <= 0.002
    return "continued" if whole and not any(n.endswith(".tmp") for n in os.listdir(folder)) else "failed"


def send(name, moment, ranks, only=None):
    """One run that gets a signal; only: one rank alone."""
    what = f"SIG{name}, {moment}, {ranks} rank{'s' * (ranks > 1)}"
    folder = runs.scratch(what.replace(", ", "_").replace(" ", "_"))
    process = launch(MOMENTS[moment] + f" -output_dir {folder}", ranks)
    for k, pid in enumerate(wait(process, ranks, moment, folder)):
        if only in (None, k):
            os.kill(pid, getattr(signal, f"SIG{name}"))
    code, out, err = end(process)
    result = outcome(code, out + err, err, folder, f"SIG{name}")
    early = moment in ("packing", "relaxation")
    if result == ("continued" if early else "refused") and moment != "set-up":
        result = "failed"
    count(what, result, f"code {code}: {out.strip()[-200:]} | {err.strip()[-300:]}")


def pipes():
    """Readers that go away, and outputs that cannot be written."""
    for what, command in (("a reader that takes one line", "{} | head -n 1"), ("no reader", "{} | true"),
                          ("both outputs to one line", "{} 2>&1 | head -n 1")):
        folder = runs.scratch(what.replace(" ", "_"))
        text = f"{runs.PROGRAM} {SCENE} -output_dir {folder}".replace("\n", " ")
        shell = subprocess.Popen(["bash", "-c", "set -o pipefail; " + command.format(text)], cwd=runs.ROOT,
                                 env=runs.environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, universal_newlines=True, start_new_session=True)
        code, _, err = end(shell)
        if os.path.isdir(folder):
            with open(os.path.join(folder, "log.txt"), encoding="utf-8") as file:
                journal = file.read()
            said = journal if "2>&1" in command else err
            result = outcome(code, said, err, folder, "SIGPIPE")
        else:  # the first word was said in the set-up
            result = "refused" if code and 0 < code < 126 else "failed"
        count(f"closed pipe, {what}", result, f"code {code}: {err[-300:]}")
    short = SCENE.replace("-time_end 1000", "-time_end 0.05")
    for what, output in (("full", "> /dev/full"), ("closed", ">&-"), ("both closed", ">&- 2>&-")):
        folder = runs.scratch(f"output_{what.replace(' ', '_')}")
        command = f"{runs.PROGRAM} {short} -output_dir {folder} {output}".replace("\n", " ")
        process = subprocess.run(["bash", "-c", command], cwd=runs.ROOT,
                                 env=runs.environment(), stdin=subprocess.DEVNULL, check=False, stderr=subprocess.PIPE,
                                 universal_newlines=True, timeout=SECONDS)
        good = process.returncode == 0 and runs.series(folder)["time"][-1] > 0.049
        count(f"lost output, {what}", "continued" if good else "failed", f"code {process.returncode}: {process.stderr}")


def ignored(name):
    """A signal whose disposition was inherited as ignored does nothing, before PETSc starts and after."""
    number = getattr(signal, f"SIG{name}")
    for moment in ("set-up", "step"):
        folder = runs.scratch(f"ignored_{name}_{moment}")
        process = launch(SCENE.replace("-time_end 1000", "-time_end 0.3") + f" -output_dir {folder}",
                         restore_signals=False, preexec_fn=lambda: signal.signal(number, signal.SIG_IGN))
        for pid in wait(process, 1, moment, folder):
            os.kill(pid, number)
        code, _, err = end(process)
        good = code == 0 and not err and runs.series(folder)["time"][-1] > 0.29
        count(f"ignored SIG{name}, {moment}", "continued" if good else "failed", f"code {code}: {err[-300:]}")


def confirmed():
    """A step that takes long, as the other rank is stopped for a while: a signal is confirmed within a second, with the
    last checkpoint and, under mpiexec, with what leaves the run its time; the run ends as ever."""
    hint = "./isph -ranks"
    for what, more in (("mpiexec that kills", ""), ("-ranks that waits", " -ranks 2")):
        folder = runs.scratch(f"confirmed_{len(more)}")
        process = launch(MOMENTS["write"] + f"{more} -output_dir {folder}", 2)
        there = wait(process, 2, "checkpoint", folder)
        for order, pids, pause in ((signal.SIGSTOP, there[1:], 0.1), (signal.SIGTERM, there, 0.9),
                                   (signal.SIGCONT, there[1:], 0)):
            for pid in pids:
                os.kill(pid, order)
            time.sleep(pause)
        code, out, err = end(process)
        result = outcome(code, out + err, err, folder, "SIGTERM")
        said = [line for line in err.splitlines() if "received a signal" in line]
        if len(said) != 1 or (hint in said[0]) == bool(more) or "checkpoint is " + folder not in said[0]:
            result = "failed"
        count(f"confirmed, {what}", result, f"code {code}: {err[-400:]}")


def clock():
    """-wall_clock_limit counts from the start of the program."""
    folder = runs.scratch("limit")
    process = launch(MOMENTS["packing"] + f" -wall_clock_limit 0.5 -output_dir {folder}")
    code, out, err = end(process)
    count("wall clock, packing", outcome(code, out, err, folder, "-wall_clock_limit"), f"code {code}: {err[-300:]}")
    process = launch(SCENE + f" -wall_clock_limit 1 -output_dir {folder}", 2)
    code, out, err = end(process)
    count("wall clock, step", outcome(code, out, err, folder, "-wall_clock_limit"), f"code {code}: {err[-300:]}")


def silence():
    """-wall_clock_silence ends a run whose other rank is stuck, with the name of the checkpoint to continue from. It
    does not end one that was stopped and goes on, nor one whose rank 0 works alone for long."""
    folder = runs.scratch("silence")
    options = f"{MOMENTS['write']} -wall_clock_silence 6 -output_dir {folder}"
    process = launch(options, 2)
    stuck = wait(process, 2, "checkpoint", folder)[1:]
    began = time.monotonic()
    for pid in stuck:
        os.kill(pid, signal.SIGSTOP)
    code, _, err = end(process)
    took, said = time.monotonic() - began, re.findall(r"^isph: error: .* for 6 s .*checkpoint is (\S+)$", err, re.M)
    good = code and took < 40 and said and said[0] == max(runs.numbered(folder, "checkpoint"))
    again = runs.start(f"{SCENE} -steps_max 1 -output_dir {folder} -restart {said[0]}").returncode if good else None
    if good:
        with open(os.path.join(folder, "log.txt"), encoding="utf-8") as file:
            good = again == 0 and "-wall_clock_silence" in file.read()
    count("silence, a rank that is stuck", "continued" if good else "failed",
          f"code {code}, {took:.0f} s: {err[-400:]}")
    process = launch(options + "_stopped", 2)
    there = wait(process, 2, "step", folder + "_stopped")
    for order, pause in ((signal.SIGSTOP, 8), (signal.SIGCONT, 0.5), (signal.SIGTERM, 0)):
        for pid in there:
            with contextlib.suppress(ProcessLookupError):  # it has ended, and fails below
                os.kill(pid, order)
        time.sleep(pause)
    code, out, err = end(process)
    count("silence, a run that was stopped", outcome(code, out + err, err, folder + "_stopped", "SIGTERM"),
          f"code {code}: {err[-400:]}")
    folder += "_packing"
    process = launch(MOMENTS["packing"] + " -spacing 1e-3 -wall_clock_silence 3 -wall_clock_limit 7 "
                     f"-output_dir {folder}", 2)
    code, out, err = end(process)
    result = outcome(code, out, err, folder, "-wall_clock_limit")
    count("silence, rank 0 packs alone", result, f"code {code}: {err[:300]}")


def alone():
    """What goes wrong on one rank of two ends both, with its sentence: options that differ, and an error of PETSc's."""
    tries = {"an option": ([runs.PROGRAM] + runs.shlex.split(SCENE), ["-drop_radius", "-1"], "-drop_radius is -1"),
             "an error": ([os.path.join(runs.ROOT, "output/build/tests/unit/test_errors"), "alone"], [], "seven")}
    for what, (command, more, word) in tries.items():
        process = subprocess.Popen(["mpiexec", "-n", "1"] + command + [":", "-n", "1"] + command + more, cwd=runs.ROOT,
                                   env=runs.environment(2), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, universal_newlines=True, start_new_session=True)
        code, _, err = end(process)
        lines = [line for line in err.splitlines() if "isph: error: " in line]
        good = code and len(lines) == 1 and word in lines[0] and "PETSC ERROR" not in err
        count(f"one rank alone, {what}", "refused" if good else "failed", f"code {code}: {err[-300:]}")


def main():
    if "--all" in sys.argv:
        for ranks in (1, 2):
            for moment in MOMENTS:
                for k, name in enumerate(ENDING):
                    send(name, moment, ranks, only=k % 2 if ranks > 1 and k % 3 == 0 else None)
        for name in ("HUP", "INT", "QUIT", "PIPE", "TERM"):
            ignored(name)
    else:
        for name, moment, ranks, only in (("HUP", "set-up", 1, None), ("PIPE", "packing", 2, None),
                                          ("TERM", "relaxation", 1, None), ("QUIT", "step", 2, 1),
                                          ("HUP", "write", 1, None)):
            send(name, moment, ranks, only)
        ignored("HUP")
    pipes()
    confirmed()
    clock()
    silence()
    alone()
    print(f"{'signal':28s} {'tried':>6s} {'continued':>10s} {'refused':>8s} {'failed':>7s}")
    for what, results in tally.items():
        print(f"{what:28s} {len(results):6d} {results.count('continued'):10d} {results.count('refused'):8d} "
              f"{results.count('failed'):7d}")
    runs.done()


main()
