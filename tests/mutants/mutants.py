#!/usr/bin/python3
"""Puts small bugs into a copy of the program, one at a time, and tells which of them the tests see.

    mutants.py [--jobs N] [NAME ...]   those whose name, folder or file contains a NAME; default: all of tests/mutants
    mutants.py --readme                the table of tests/mutants/README.md, from the last run of each mutant, which
                                       fates.csv beside it keeps

The edits are listed in tests/mutants/*.ini (see edits.py). The tree, without them, must pass the tests they name. Each
edit is then applied to a copy of the tree in output/mutants, which is compiled and tested until a test fails: the
mutant is killed. An edit that does not apply exactly once or does not compile is an error; so is a mutant that survives
without an explanation, or is killed though it has one, and a score of less than WANTED. The last line is the score."""
import argparse
import concurrent.futures
import csv
import os
import queue
import shutil
import signal
import subprocess
import sys
import threading
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(os.path.dirname(sys.path[0]), "verify"))
import edits  # noqa: E402
import mpi  # noqa: E402
import runner  # noqa: E402
import runs  # noqa: E402

ROOT = edits.ROOT
OUTPUT = os.path.join(ROOT, "output", "mutants")
TABLE = os.path.join(edits.HERE, "fates.csv")
COLUMNS = ("name", "fate", "version")  # of the tree that it was tried in
WANTED = 0.9      # the least share of all mutants that are killed
GRACE = 10        # s that a test has to end once a part of it has failed
PATIENCE = 30, 5  # a test may take so many seconds, and so many times as long as without the edit
KILLED, SURVIVED, ERROR = "killed", "survived", "error"


class Tree:
    """A copy of the tree with what has been compiled."""

    def __init__(self, path, source):
        self.path = path
        shutil.rmtree(path, ignore_errors=True)
        ignored = shutil.ignore_patterns("__pycache__")
        for name in sorted(set(os.listdir(source)) - {".git", "output"}):
            top = os.path.join(source, name)
            if os.path.isdir(top):
                shutil.copytree(top, os.path.join(path, name), ignore=ignored)
            else:
                os.makedirs(path, exist_ok=True)
                shutil.copy2(top, path)
        shutil.copytree(os.path.join(source, "output", "build"), os.path.join(path, "output", "build"))

    def build(self, target):
        """What make says if it fails, else nothing; warnings do not stop it: a bug may leave a function without use."""
        process = subprocess.run(["make", "-s", target, "STRICT="], cwd=self.path, text=True, check=False,
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        return process.stdout[-2000:] if process.returncode else ""

    def prepare(self, test):
        """Compiles what a test needs; what make says if it fails."""
        return self.build("output/build/tests/" + test.split(" on ")[0] if test.startswith("unit/") else "isph")

    def run(self, test, limit):
        """Why a test fails, within 'limit' seconds; nothing if it passes."""
        name, _, ranks = test.partition(" on ")
        if name.startswith("unit/"):
            command = (["mpiexec", "-n", ranks] if ranks else []) + ["output/build/tests/" + name]
        else:
            script, _, part = edits.job_of(test).partition(":")
            command = ([sys.executable] if script.endswith(".py") else []) + ["tests/" + script] + (
                ["--part", part] if part else [])
        own = runs.environment(int(ranks or 1)) if name.startswith("unit/") else dict(os.environ, **mpi.ANY)
        environment = {k: v for k, v in own.items() if k not in ("ISPH", "LINT_ROOT")}
        environment["PYTHONDONTWRITEBYTECODE"] = "1"  # what is compiled of a program could outlive an edit of it
        process = subprocess.Popen(command, cwd=self.path, env=environment, stdin=subprocess.DEVNULL, text=True,
                                   errors="replace", stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   start_new_session=True)
        late = threading.Timer(limit, os.killpg, (process.pid, signal.SIGKILL))
        late.start()
        passed, failed = False, ""
        for line in process.stdout:
            passed |= line.startswith("ok ")
            if line.startswith("FAIL "):  # what the others say does not matter
                failed = line[5:].rstrip("\n")
                os.killpg(process.pid, signal.SIGINT)
                break
        try:
            process.communicate(timeout=GRACE if failed else None)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
        over = not late.is_alive()
        late.cancel()
        if over and not failed:
            return f"not done after {limit:.0f} s"
        if failed:
            return failed
        if process.returncode:
            return f"exit code {process.returncode}"
        return "" if passed else "it printed no result"

    def restore(self, original):
        """Makes everything compiled, and the sources, those of another tree again."""
        for top in ("src", "tests", os.path.join("output", "build"), "isph"):
            for path in files(os.path.join(self.path, top)):
                pristine = os.path.join(original.path, os.path.relpath(path, self.path))
                if not os.path.exists(pristine):
                    os.remove(path)
                elif os.stat(pristine).st_mtime_ns != os.stat(path).st_mtime_ns:
                    shutil.copy2(pristine, path)


def files(top):
    if os.path.isfile(top):
        return [top]
    return [os.path.join(folder, name) for folder, _, names in os.walk(top) for name in names]


def baseline(tree, mutants, jobs):
    """Seconds that each test takes without any edit; ends the program if one fails."""
    tests = list(dict.fromkeys(test for m in mutants for test in m.tests))
    for test in tests:
        trouble = tree.prepare(test)
        if trouble:
            sys.exit(f"mutants.py: {test} does not compile without any edit:\n{trouble}")

    def one(test):
        started = time.monotonic()
        return tree.run(test, 600), time.monotonic() - started

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        results = dict(zip(tests, pool.map(one, tests)))
    failed = [f"{test}: {why}" for test, (why, _) in results.items() if why]
    if failed:
        sys.exit("mutants.py: tests fail without any edit:\n" + "\n".join(failed))
    print(f"{len(tests)} tests pass without any edit", flush=True)
    return {test: seconds for test, (_, seconds) in results.items()}


def examine(m, tree, original, seconds):
    """The fate of a mutant: a row of the table."""
    started = time.monotonic()
    path = os.path.join(tree.path, m.file)
    fate, by = SURVIVED, ""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    with open(path, "w", encoding="utf-8") as file:
        file.write(m.apply(text)[0])
    for test in m.tests:
        trouble = tree.prepare(test)
        if trouble:
            fate, by = ERROR, "it does not compile: " + trouble.strip().replace("\n", " / ")
            break
        why = tree.run(test, PATIENCE[0] + PATIENCE[1] * seconds[test])
        if why:
            fate, by = KILLED, f"{test}: {why[:100]}"
            break
    tree.restore(original)
    return dict(name=m.name, folder=m.folder, bug=m.bug, fate=fate, by=by, survives=m.survives,
                version=runner.version(), seconds=f"{time.monotonic() - started:.1f}")


def run_all(mutants, jobs):
    """The rows of all mutants, in their order; each is printed when it is known."""
    original = Tree(os.path.join(OUTPUT, "tree"), ROOT)
    seconds = baseline(original, mutants, jobs)
    trees = queue.Queue()
    for k in range(jobs):
        trees.put(Tree(os.path.join(OUTPUT, f"tree_{k + 1}"), original.path))

    def one(m):
        tree = trees.get()
        try:
            row = examine(m, tree, original, seconds)
        finally:
            trees.put(tree)
        print(f"{row['fate']:9}{row['folder']}: {row['bug']} ({row['name']}, {row['seconds']} s) {row['by']}",
              flush=True)
        return row

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(one, mutants))


def score(rows):
    killed = sum(row["fate"] == KILLED for row in rows)
    return f"{killed} of {len(rows)} mutants killed, {100 * killed / max(1, len(rows)):.0f} %"


def report(rows, wanted):
    """Prints what is wrong, the survivors and the score; the exit code. wanted: the least share that is killed."""
    bad = 0
    for row in rows:
        if row["fate"] == SURVIVED:
            print(f"survivor {row['name']}: {row['bug']}: {row['survives'] or 'UNEXPLAINED'}")
        if row["fate"] == ERROR:
            print(f"FAIL {row['name']}: {row['by']}")
        if row["fate"] == KILLED and row["survives"]:
            print(f"FAIL {row['name']}: it is killed now ({row['by']}): remove 'survives'")
        bad += row["fate"] == ERROR or (row["fate"] == SURVIVED) != bool(row["survives"])
    print(score(rows))
    return 1 if bad or sum(row["fate"] == KILLED for row in rows) < wanted * len(rows) else 0


def read():
    """The rows of the table by the mutants' names."""
    try:
        with open(TABLE, newline="", encoding="utf-8") as file:
            return {row["name"]: row for row in csv.DictReader(file)}
    except OSError:
        return {}


def write(rows, mutants):
    """The table with the new rows and those of mutants that did not run now."""
    known = {**read(), **{row["name"]: row for row in rows}}
    with open(TABLE, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(known[m.name] for m in mutants if m.name in known and known[m.name]["fate"] != ERROR)


def readme():
    known, mutants = read(), edits.read()
    missing = [m.name for m in mutants if m.name not in known]
    rows = [dict(known[m.name], folder=m.folder, bug=m.bug, survives=m.survives) for m in mutants if m.name in known]
    lines = ["| folder | tried | killed |", "| --- | --- | --- |"]
    for folder in sorted({row["folder"] for row in rows}):
        own = [row["fate"] == KILLED for row in rows if row["folder"] == folder]
        lines.append(f"| {folder} | {len(own)} | {sum(own)} |")
    survivors = [f"| {row['name']} | {row['folder']} | {row['bug']} | {row['survives']} |" for row in rows
                 if row["fate"] != KILLED]
    rest = f"; of the list {len(missing)} have not run, {missing[0]} for instance" if missing else ""
    if survivors:
        lines += ["", "| survivor | folder | bug | why |", "| --- | --- | --- | --- |"] + survivors
    runs.replace(os.path.join(edits.HERE, "README.md"), "score",
                 f"\n{score(rows)}{rest}.\n\n" + "\n".join(lines) + "\n")
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--readme", action="store_true")
    parser.add_argument("names", nargs="*")
    a = parser.parse_args()
    if a.readme:
        return readme()
    mutants = edits.read()
    wrong = edits.mistakes(mutants)
    if wrong:
        sys.exit("\n".join("mutants.py: " + line for line in wrong))
    chosen = [m for m in mutants if not a.names or any(name in f"{m.name} {m.file}" for name in a.names)]
    if not chosen:
        sys.exit(f"mutants.py: no mutant is called {' or '.join(a.names)}")
    os.makedirs(OUTPUT, exist_ok=True)
    started = time.monotonic()
    rows = run_all(chosen, max(1, a.jobs))
    write(rows, mutants)
    print(f"{(time.monotonic() - started) / 60:.0f} minutes")
    return report(rows, WANTED if len(rows) == len(mutants) else 0)


if __name__ == "__main__":
    sys.exit(main())
