#!/usr/bin/python3
"""Runs the tests side by side, the long ones first.

    tests/run.py [--check | --long] [--sanitizers] [--changed [COMMIT]] [--only NAMES] [--jobs N] [--list] [--seconds]

A test is a job: a program of tests/unit on a number of ranks, a script of tests/, or one part of a script.
tests/table.txt has a row for each: its ranks, its seconds, the set it belongs to, the folders whose change it watches.

    --check       what belongs to the set `check` (make check); without: `check`, `test` and of `turn` what has its turn
                  on the date of the commit or watches what this changed; --long: all sets
    --sanitizers  the jobs of tests/sanitizers too (make test-ci)
    --changed     of these only what watches the paths in `git diff COMMIT` (HEAD), the quickest that fit into a minute
                  of two cores and what names one of these files, and lint
    --only        of all sets only jobs whose name contains one of these words, separated by commas or blanks
    --seconds     runs nothing: writes the seconds of the table from times.csv, what the last runs took
    --jobs        so many at a time (one more than there are processors: some jobs wait for processes to end)

Each test prints 'ok name' or 'FAIL name: why' a line, and whatever else it likes. One that exits non-zero without a
FAIL line, is killed, runs out of time or prints neither counts as one failure, unless it prints 'skipped: why'. What
failed and what was skipped stands at the end, a failure with the command that repeats it. output/tests/ keeps the
output of each job (JOB.log) and times.csv. The last line is 'N passed, N failed'; the exit code tells whether any
failed."""
import argparse
import csv
import fnmatch
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from typing import NamedTuple

import dates
import mpi

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
TABLE = os.path.join(ROOT, "tests", "table.txt")
OUTPUT = os.path.join(ROOT, "output", "tests")
UNITS = os.path.join("output", "build", "tests", "unit")
FOLDERS = ("docs", "answers", "input", "parallel", "restart", "faults", "extremes", "solvers", "relations", "verify",
           "lint")
SETS = ("check", "test", "turn", "long")
TURNS = 5  # days, on one of which a test of the set `turn` runs
TIMEOUT = float(os.environ.get("TEST_TIMEOUT", 600))  # s a job may take; of the set `long` 7200
QUICK = 10.0  # s: --changed takes no longer jobs but those of files that changed ...
MINUTE = 120.0  # s of processor: ... and no more of them than this


class Row(NamedTuple):
    """A line of the table. pattern: of names of jobs; ranks: of a program; seconds: about what it takes; set: check,
    test or long; watches: paths whose change asks for it."""
    pattern: str
    ranks: tuple
    seconds: float
    set: str
    watches: tuple

    def fits(self, name):
        """Whether the row is of a job: its ranks, behind the @ of a program's name, are in the row."""
        stem, _, ranks = name.partition("@")
        return fnmatch.fnmatchcase(stem, self.pattern) and (not ranks or int(ranks) in self.ranks)


class Job(NamedTuple):
    name: str
    command: list
    row: Row
    source: str  # the file it is written in


class Result(NamedTuple):
    job: Job
    passed: int
    failures: list  # its FAIL lines and, where there are none, the end of its output
    skipped: list  # its lines 'skipped: why'
    wall: float
    cpu: float


def read_table(path=TABLE):
    """The rows of the table; a ValueError tells which line is wrong. A folder of src/ stands without src/."""
    rows = []
    with open(path, encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            words = line.partition("#")[0].split()
            if not words:
                continue
            try:
                pattern, ranks, seconds, kind, *watches = words
                rows.append(Row(pattern, tuple(int(n) for n in ranks.split(",")), float(seconds), kind,
                                tuple(w.removeprefix("./") if "/" in w or "." in w else f"src/{w}/"
                                      for w in watches)))
            except ValueError:
                raise ValueError(f"{path}:{number}: a line is PATTERN RANKS SECONDS SET WATCHES ...") from None
            if kind not in SETS:
                raise ValueError(f"{path}:{number}: {kind} is no set; there are {', '.join(SETS)}")
    return rows


def row_of(name, rows):
    """The last row that is of a job: particular rows stand below general ones."""
    return next((row for row in reversed(rows) if row.fits(name)), None)


def parts(script):
    """The parts of a script that has some: it prints their names with --parts; none: [None]. One that cannot is a part,
    which will fail."""
    with open(os.path.join(ROOT, script), encoding="utf-8") as file:
        if not re.search(r"runs\.parts\(|^ *--parts\)", file.read(), re.M):
            return [None]
    done = subprocess.run(command_of(script) + ["--parts"], cwd=ROOT, env=dict(os.environ, **mpi.ANY), check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return ["?"] if done.returncode else done.stdout.split()


def command_of(script):
    return ([os.environ.get("PYTHON", sys.executable)] if script.endswith(".py") else []) + [os.path.join(".", script)]


def find(rows, folders):
    """All jobs there are, each with its row of the table (None where it has none)."""
    jobs = []

    def add(name, command, source):
        jobs.append(Job(name, command, row_of(name, rows), source))

    for file in sorted(os.listdir(os.path.join(ROOT, "tests", "unit"))):
        stem, kind = os.path.splitext(file)
        if kind != ".c":
            continue
        row = row_of(f"unit/{stem}", rows)
        for ranks in row.ranks if row else (1,):
            mpiexec = ["mpiexec", "-n", str(ranks)] if ranks > 1 else []
            add(f"unit/{stem}@{ranks}", mpiexec + [os.path.join(".", UNITS, stem)], f"tests/unit/{file}")
    for folder in folders:
        for file in sorted(os.listdir(os.path.join(ROOT, "tests", folder))):
            script = os.path.join("tests", folder, file)
            if not file.endswith((".sh", ".py")) or not os.access(os.path.join(ROOT, script), os.X_OK):
                continue
            for part in parts(script):
                add(f"{folder}/{file}" + (f":{part}" if part else ""),
                    command_of(script) + (["--part", part] if part else []), script)
    return jobs


def with_turns(jobs):
    """The jobs of the sets before `turn`, and of that what has its turn or watches what the last commit changed."""
    turning = sorted((job for job in jobs if job.row.set == "turn"), key=lambda job: -job.row.seconds)
    paths = changed_paths("HEAD~1", must=False)
    now = [job for k, job in enumerate(turning) if (k + dates.day()) % TURNS == 0 or job.source in paths or
           any(path.startswith(w) for w in job.row.watches for path in paths)]
    if len(now) < len(turning):
        print(f"run.py: {len(turning) - len(now)} tests have no turn on this date: make test-long, ONLY run them",
              flush=True)
    return [job for job in jobs if SETS.index(job.row.set) < SETS.index("turn")] + now


def changed_paths(commit, must=True):
    git = ["git", "-C", ROOT]
    paths = subprocess.run(git + ["diff", "--name-only", commit, "--"], check=False, stdout=subprocess.PIPE,
                           stderr=subprocess.PIPE, text=True)
    if paths.returncode and not must:
        return []
    if paths.returncode:
        sys.exit(f"run.py: BASE={commit} is no commit of this repository: {paths.stderr.strip().splitlines()[0]}")
    new = subprocess.run(git + ["ls-files", "--others", "--exclude-standard"], check=True, stdout=subprocess.PIPE,
                         text=True)
    return paths.stdout.split() + new.stdout.split()


def watching(jobs, paths):
    """The jobs that watch one of the paths and are quick, those that watch one by its whole name, and those that are
    written in one of them."""
    named = set(paths)
    return [job for job in jobs if job.source in named or named & set(job.row.watches) or job.row.seconds <= QUICK and
            (job.name.startswith("lint/") or any(path.startswith(w) for w in job.row.watches for path in paths))]


def in_a_minute(jobs, paths):
    """The jobs without the longest, as many as it takes; those that are written in one of the paths or name it stay."""
    named, spent, kept = set(paths), 0.0, []
    for job in sorted(jobs, key=lambda job: job.row.seconds):
        spent += job.row.seconds
        if spent <= MINUTE or job.source in named or named & set(job.row.watches):
            kept.append(job)
    if len(kept) < len(jobs):
        print(f"run.py: {len(jobs) - len(kept)} of {len(jobs)} tests that watch the changes are left to make check and "
              "make test", flush=True)
    return kept


def choose(jobs, arguments):
    """What is to run, the longest first."""
    if arguments.only:
        words = arguments.only.replace(",", " ").split()
        for word in words:
            if not any(word in job.name for job in jobs):
                sys.exit(f"run.py: ONLY={word}: no test has this in its name; names are like unit/test_rings@3 or "
                         "verify/gas.py, tests/run.py --list lists them\n0 passed, 1 failed")
        jobs = [job for job in jobs if any(word in job.name for word in words)]
    else:
        if arguments.changed:
            paths = changed_paths(arguments.changed)
            jobs = in_a_minute(watching([job for job in jobs if job.row.set != "long"], paths), paths)
        elif arguments.check:
            jobs = [job for job in jobs if job.row.set == "check"]
        elif not arguments.long:
            jobs = with_turns(jobs)
    return sorted(jobs, key=lambda job: -job.row.seconds)


def log_of(job):
    return os.path.join(OUTPUT, job.name.replace("/", "_").replace(":", "_") + ".log")


def judge(job, code, text):
    """(number of ok lines, what failed, what was skipped)."""
    lines = text.splitlines()
    skipped = [line for line in lines if line.startswith("skipped")]
    passed = sum(line.startswith("ok ") for line in lines)
    failures = [line for line in lines if line.startswith("FAIL ")]
    if not failures:
        if code is None:
            failures = [f"FAIL {job.name}: it was stopped, for it took longer than allowed"]
        elif code:
            failures = [f"FAIL {job.name}: exit code {code}"] + ["  | " + line for line in lines[-15:]]
        elif not passed and not skipped:
            failures = [f"FAIL {job.name}: it printed no result"]
    return passed, failures, skipped


def execute(job):
    """Runs a job to its end; its processor time is that of all its processes."""
    log, began = log_of(job), time.monotonic()
    limit = TIMEOUT if job.row.set != "long" else max(TIMEOUT, 7200)
    folder = tempfile.mkdtemp(prefix="isph-test-")
    environment = dict(os.environ, **mpi.ANY)
    if job.name.startswith("unit/"):
        environment = mpi.environment(int(job.name.partition("@")[2]), folder)
    with open(log, "w", encoding="utf-8") as out:
        try:
            process = subprocess.Popen(job.command, cwd=ROOT, env=environment, stdin=subprocess.DEVNULL, stdout=out,
                                       stderr=subprocess.STDOUT, start_new_session=True)
        except OSError as error:
            return Result(job, 0, [f"FAIL {job.name}: {error}; make test builds it"], [], 0.0, 0.0)
        late = threading.Event()

        def stop():
            late.set()
            os.killpg(process.pid, signal.SIGKILL)

        timer = threading.Timer(limit, stop)
        timer.start()
        _, status, usage = os.wait4(process.pid, 0)
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
    shutil.rmtree(folder, ignore_errors=True)
    with open(log, encoding="utf-8", errors="replace") as file:
        verdict = judge(job, None if late.is_set() else process.returncode, file.read())
    return Result(job, *verdict, time.monotonic() - began, usage.ru_utime + usage.ru_stime)


def run(jobs, number):
    """The results, as they come; a line for each. A unit test runs on one number of ranks at a time: its runs share a
    folder."""
    waiting, running, results, lock = list(jobs), set(), [], threading.Condition()

    def program(job):
        return job.name.partition("@")[0]

    def work():
        while True:
            with lock:
                while waiting and all(program(job) in running for job in waiting):
                    lock.wait()
                if not waiting:
                    return
                job = next(job for job in waiting if program(job) not in running)
                waiting.remove(job)
                running.add(program(job))
            result = execute(job)
            with lock:
                running.remove(program(job))
                lock.notify_all()
                results.append(result)
                failed = sum(line.startswith("FAIL ") for line in result.failures)
                print(f"{len(results):3}/{len(jobs)}  {job.name:58} {result.passed:4} ok"
                      f"{f' {failed:3} FAILED' if failed else '':11} {result.wall:6.1f} s {result.cpu:6.1f} s",
                      flush=True)

    workers = [threading.Thread(target=work) for _ in range(number)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    return results


def write_times(results):
    """output/tests/times.csv: those of this run, and of jobs that did not run now."""
    path, times = os.path.join(OUTPUT, "times.csv"), {}
    if os.path.exists(path):
        with open(path, newline="", encoding="utf-8") as file:
            times = {line["test"]: line for line in csv.DictReader(file)}
    for r in results:
        times[r.job.name] = {"test": r.job.name, "passed": r.passed, "wall_s": f"{r.wall:.2f}", "cpu_s": f"{r.cpu:.2f}"}
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, ("test", "passed", "wall_s", "cpu_s"))
        writer.writeheader()
        writer.writerows(sorted(times.values(), key=lambda line: -float(line["wall_s"])))


def write_seconds(rows):
    """The seconds of the table: the most processor time that a job of a row took, two digits."""
    took = {}
    with open(os.path.join(OUTPUT, "times.csv"), newline="", encoding="utf-8") as file:
        for line in csv.DictReader(file):
            row = row_of(line["test"], rows)
            if row and float(line["cpu_s"]) > 0:
                took[row.pattern] = max(took.get(row.pattern, 0), float(line["cpu_s"]))
    with open(TABLE, encoding="utf-8") as file:
        lines = file.read().splitlines()
    for k, line in enumerate(lines):
        found = re.match(r"([a-z]\S+)(\s+\S+\s+)(\S+)(\s+)", line)
        if found and found[1] in took:
            seconds = f"{took[found[1]]:.2g}" if took[found[1]] < 100 else f"{took[found[1]]:.0f}"
            lines[k] = found[1] + found[2] + f"{seconds:{len(found[3] + found[4]) - 1}} " + line[found.end():]
    with open(TABLE, "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("check", "long", "sanitizers", "list", "seconds"):
        parser.add_argument("--" + name, action="store_true")
    parser.add_argument("--changed", nargs="?", const="HEAD", default="")
    parser.add_argument("--only", default="")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() + 1)  # some only wait
    arguments = parser.parse_args()
    folders = list(FOLDERS) + ["long"] * (arguments.long or bool(arguments.only)) + \
        ["sanitizers"] * (arguments.sanitizers or "sanitizers" in arguments.only)
    try:
        began, rows = time.monotonic(), read_table()
    except ValueError as error:
        sys.exit(f"run.py: {error}")
    if arguments.seconds:
        return write_seconds(rows)
    jobs = find(rows, folders)
    unknown = [job.name for job in jobs if job.row is None]
    if unknown:
        sys.exit(f"run.py: no row of tests/table.txt is of {', '.join(unknown)}")
    jobs = choose(jobs, arguments)
    if arguments.list:
        print("\n".join(f"{job.row.set:6} {job.row.seconds:6.1f} s  {job.name}" for job in jobs))
        return 0
    if not jobs:
        print("run.py: no test is chosen")
        print("0 passed, 1 failed")
        return 0 if arguments.changed else 1
    os.makedirs(OUTPUT, exist_ok=True)
    results = run(jobs, max(1, arguments.jobs))
    write_times(results)
    bad = [r for r in results if r.failures]
    if bad:
        print("\nFailed:")
    for r in bad:
        print("\n".join("  " + line for line in r.failures))
        print(f"    again: make test ONLY={r.job.name}    its output: {os.path.relpath(log_of(r.job), ROOT)}")
    for r in results:
        print("".join(f"{r.job.name} {line}\n" for line in r.skipped), end="")
    print(f"{len(results)} jobs in {time.monotonic() - began:.0f} s, {sum(r.cpu for r in results):.0f} s of processor "
          "time; output/tests/times.csv has each one's")
    failed = sum(sum(line.startswith("FAIL ") for line in r.failures) for r in bad)
    print(f"{sum(r.passed for r in results)} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
