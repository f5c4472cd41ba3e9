"""The program isph, for all that runs it: where it is, what it knows about a scene, what tells one run from another."""
import concurrent.futures
import functools
import hashlib
import json
import math
import os
import re
import resource
import shutil
import subprocess
import tempfile
import time

from . import tables

HERE = os.path.dirname(os.path.realpath(__file__))
MARK = "made.json"  # in the folder of a run: what was run
KEPT = ("series.csv", "scene.json", "options.opts", "log.txt", "droplets.csv")  # of a run; the rest is not needed
STARTED = 1  # s, which mpiexec does not use where it cannot start ranks
CROWDED = 1.25  # times the processor time of a run that had its cores for itself
RUNNING = set()  # processes that run now
NEAR = 0.8  # of its limit, where the kernel, which counts ticks, may stop a run on a busy machine


def program():
    """The path of isph: of $ISPH, of this tree, of the prefix where this package is, or of PATH."""
    places = [os.path.join(HERE, *place) for place in (("..", "..", "..", "isph"), ("..", "bin", "isph"),
                                                       ("..", "..", "..", "..", "bin", "isph"))]
    found = os.environ.get("ISPH") or next(filter(os.path.isfile, places), None) or shutil.which("isph")
    if not found:
        raise tables.Error("there is no isph in this tree or in PATH; build it with make, or name it in ISPH.")
    return os.path.abspath(found)


def tool(name):
    """The path of a file beside the program, as answers/answer.py: in the tree, or where make install puts it."""
    home = os.path.dirname(os.path.realpath(program()))
    places = [os.path.join(HERE, "..", "..", name), os.path.join(home, "src", name),
              os.path.join(home, "..", "share", "isph", name)]
    found = next((place for place in places if os.path.isfile(place)), None)
    if not found:
        raise tables.Error(f"{name} is neither beside {HERE} nor beside {program()}.")
    return found


def command(scene, options):
    return [program(), "-options_file", os.fspath(scene), *options]


def text_of(scene, options):
    """The command as it would be typed."""
    return " ".join(["isph", "-options_file", scene, *options])


def start(words, limit=math.inf):
    """Runs the program or a tool to its end, or until it has used 'limit' processor seconds: (exit code, its sentence,
    processor seconds). The clock is no measure: the machine may be busy. Ctrl-C ends it, a run with a checkpoint, and
    is raised then."""
    with tempfile.TemporaryFile("w+", errors="replace") as out:
        process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT,
                                   start_new_session=True, env=dict(os.environ, OMP_NUM_THREADS="1"))
        if math.isfinite(limit):
            resource.prlimit(process.pid, resource.RLIMIT_CPU, (math.ceil(limit), math.ceil(limit) + 1))
        RUNNING.add(process)
        try:
            _, status, usage = os.wait4(process.pid, 0)
        except KeyboardInterrupt:
            process.terminate()
            process.wait()
            raise
        finally:
            RUNNING.discard(process)
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        lines = [line.strip() for line in out if line.strip()]
    spent = usage.ru_utime + usage.ru_stime
    last = next((line for line in lines if "error: " in line), lines[-1] if lines else f"code {process.returncode}")
    if process.returncode and math.isfinite(limit) and spent >= NEAR * math.ceil(limit):
        last = f"not done after {limit:.3g} s of the processor"
    return process.returncode, re.sub(r"^(isph: error|\w+\.py): ", "", last), spent


def call(words):
    """Runs the program or a tool to its end; its sentence is raised if it fails. Its processor seconds."""
    code, said, spent = start(words)
    if code:
        raise tables.Error(said)
    return spent


@functools.lru_cache(maxsize=None)
def known(scene, *more):
    """What the program knows about a scene (scene.json) with further options; its sentence is raised if it refuses."""
    with tempfile.TemporaryDirectory() as folder:
        call(command(scene, [*more, "-scene_json", os.path.join(folder, "scene.json")]))
        found = tables.read_scene(folder)
    found["options"] = [option for option in found["options"] if option["name"] != "-scene_json"]
    return found


def mark_of(found):
    """What tells two runs apart: all that the program knows about the scene, the contents of files that it reads, and
    the program itself."""
    mark = hashlib.sha256(json.dumps(found, sort_keys=True).encode())
    for path in [program()] + [option["value"] for option in found["options"] if option["kind"] == "file"]:
        if os.path.isfile(path):
            with open(path, "rb") as file:
                mark.update(hashlib.sha256(file.read()).digest())
    return mark.hexdigest()


@functools.lru_cache(maxsize=None)
def mark_of_scene(scene):
    return mark_of(known(scene))


def made(folder):
    """What was run into a folder: {mark, command, cpu (s)}; empty: nothing that this module runs."""
    try:
        with open(os.path.join(folder, MARK), encoding="utf-8") as file:
            return json.load(file)
    except (OSError, ValueError):
        return {}


def make_mark(folder, mark, words, cpu=0.0):
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, MARK), "w", encoding="utf-8") as file:
        json.dump({"mark": mark, "command": words, "cpu": cpu}, file)


class Run:
    """A run of an answer or a study in a folder of its own. What is there from an earlier call, of the same scene and
    program with the same options, is not run again. Snapshots are made and kept if the options have their interval."""

    def __init__(self, scene, options, folder, limit=math.inf):
        self.scene, self.options, self.folder, self.limit = scene, options, folder, limit
        self.cpu, self.wall, self.reason, self.series = 0.0, 0.0, "", None
        self.ranks = 1

    def alone(self):
        """Whether it had a core for each of its processes; what was not run now does not tell."""
        return self.wall <= CROWDED * self.cpu / self.ranks

    def go(self):
        mark, before = mark_of_scene(self.scene), made(self.folder)
        if before.get("mark") == mark and before["command"] == self.options:
            try:
                self.cpu, self.series = before["cpu"], tables.read_series(self.folder)
                return self
            except tables.Error:
                pass
        words = command(self.scene, ["-snapshot_interval", "0", *self.options, "-output_dir", self.folder,
                                     "-output_overwrite", "-checkpoint_interval", "0"])
        begin = time.monotonic()
        code, last, self.cpu = start(words + (["-ranks", str(self.ranks)] if self.ranks > 1 else []), self.limit)
        if code and self.ranks > 1 and self.cpu < STARTED:
            code, last, self.cpu = start(words, self.limit)
        self.wall = time.monotonic() - begin
        if code:
            self.reason = last
            return self
        self.series = tables.read_series(self.folder)
        for name in os.listdir(self.folder):
            shown = "-snapshot_interval" in self.options and name.startswith(("snapshot", "solids"))
            if name not in KEPT and not shown and os.path.isfile(os.path.join(self.folder, name)):
                os.remove(os.path.join(self.folder, name))
        make_mark(self.folder, mark, self.options, self.cpu)
        return self


def beside(function, items, jobs):
    """[function(item), ...], 'jobs' at a time. Ctrl-C ends the programs that run."""
    if jobs <= 1:
        return [function(item) for item in items]
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        try:
            return list(pool.map(function, items))
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in list(RUNNING):
                process.terminate()
            raise


def together(all_runs, jobs, ranks=1):
    """Runs them, 'jobs' at a time, each on so many ranks."""
    for run in all_runs:
        run.ranks = ranks
    return beside(Run.go, all_runs, jobs)
