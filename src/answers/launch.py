"""Runs of ./isph for an answer or a study: several at a time, each with its processor time."""
import concurrent.futures
import functools
import hashlib
import json
import math
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "pictures"))
import tables  # noqa: E402

KEPT = ("series.csv", "scene.json", "options.opts", "log.txt", "droplets.csv")  # of a run; the rest is not needed
STARTED = 1  # s, which mpiexec does not use where it cannot start ranks
CROWDED = 1.25  # times the processor time of a run that had its cores for itself
NEAR = 0.8  # of its limit, where the kernel, which counts ticks, may stop a run on a busy machine


def program():
    """The path of isph: of $ISPH, of this tree, or of the PATH."""
    here = os.path.join(HERE, "..", "..", "isph")
    found = os.environ.get("ISPH") or (here if os.path.exists(here) else shutil.which("isph"))
    if not found:
        raise tables.RunError("there is no isph, neither beside these tools nor in PATH; build it with make, or name "
                              "it in ISPH.")
    return os.path.abspath(found)


def command(scene, options):
    return [program(), "-options_file", scene, *options]


def text_of(scene, options):
    """The command as it would be typed."""
    return " ".join(["isph", "-options_file", scene, *options])


def start(scene, options, limit=math.inf, ranks=1):
    """Runs isph to its end, or until it has used 'limit' processor seconds: (exit code, its last words, processor
    seconds). The clock is no measure: the machine may be busy."""
    side = ["-ranks", str(ranks)] if ranks > 1 else []
    with tempfile.TemporaryFile("w+") as out:
        process = subprocess.Popen(command(scene, options) + side, stdout=out, stderr=subprocess.STDOUT,
                                   env=dict(os.environ, OMP_NUM_THREADS="1"))
        if math.isfinite(limit):
            resource.prlimit(process.pid, resource.RLIMIT_CPU, (math.ceil(limit), math.ceil(limit) + 1))
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        lines = [line.strip() for line in out if line.strip()]
    spent = usage.ru_utime + usage.ru_stime
    last = next((line for line in lines if "error:" in line), lines[-1] if lines else "")
    if process.returncode and math.isfinite(limit) and spent >= NEAR * math.ceil(limit):
        last = f"not done after {limit:.3g} s of the processor"
    return process.returncode, last.replace("isph: error: ", ""), spent


@functools.lru_cache(maxsize=None)
def known(scene, *more):
    """What the program knows about a scene (scene.json) with further options; its sentence ends us if it refuses."""
    with tempfile.TemporaryDirectory() as folder:
        code, last, _ = start(scene, [*more, "-scene_json", os.path.join(folder, "scene.json")])
        if code:
            raise tables.RunError(last)
        found = tables.read_scene(folder)
    found["options"] = [option for option in found["options"] if option["name"] != "-scene_json"]
    return found


@functools.lru_cache(maxsize=None)
def mark_of(scene):
    """What tells two versions of a scene, or of the program, apart: all that the program knows about it, the contents
    of files that it reads, and the program itself."""
    found = known(scene)
    mark = hashlib.sha256(json.dumps(found, sort_keys=True).encode())
    for path in [program()] + [option["value"] for option in found["options"] if option["kind"] == "file"]:
        if os.path.isfile(path):
            with open(path, "rb") as file:
                mark.update(hashlib.sha256(file.read()).digest())
    return mark.hexdigest()[:16]


class Run:
    """A run in a folder of its own. What is there from an earlier call, of the same scene and program with the same
    options, is not run again. Snapshots are made and kept if the options have their interval."""

    def __init__(self, scene, options, folder, limit=math.inf):
        self.scene, self.options, self.folder, self.limit = scene, options, folder, limit
        self.cpu, self.wall, self.reason, self.series = 0.0, 0.0, "", None
        self.ranks = 1

    def alone(self):
        """Whether it had a core for each of its processes; what was not run now does not tell."""
        return self.wall <= CROWDED * self.cpu / self.ranks

    def go(self):
        mark = os.path.join(self.folder, "command.txt")
        wanted = f"{text_of(self.scene, self.options)}\n# {mark_of(self.scene)}"
        try:
            with open(mark, encoding="utf-8") as file:
                done, cpu = file.read().rstrip("\n").rsplit("\n", 1)
            if done == wanted:
                self.cpu, self.series = float(cpu), tables.read_series(self.folder)
                return self
        except (OSError, ValueError, tables.RunError):
            pass
        words = ["-snapshot_interval", "0", *self.options, "-output_dir", self.folder, "-output_overwrite",
                 "-checkpoint_interval", "0"]
        begin = time.monotonic()
        code, last, self.cpu = start(self.scene, words, self.limit, self.ranks)
        if code and self.ranks > 1 and self.cpu < STARTED:
            code, last, self.cpu = start(self.scene, words, self.limit)
        self.wall = time.monotonic() - begin
        if code:
            self.reason = last
            return self
        self.series = tables.read_series(self.folder)
        for name in os.listdir(self.folder):
            shown = "-snapshot_interval" in self.options and name.startswith(("snapshot", "solids"))
            if name not in KEPT and not shown and os.path.isfile(os.path.join(self.folder, name)):
                os.remove(os.path.join(self.folder, name))
        with open(mark, "w", encoding="utf-8") as file:
            file.write(f"{wanted}\n{self.cpu}\n")
        return self


def together(all_runs, jobs, ranks=1):
    """Runs them, 'jobs' at a time, each on so many ranks."""
    for run in all_runs:
        run.ranks = ranks
    with concurrent.futures.ThreadPoolExecutor(max_workers=max(1, jobs)) as pool:
        return list(pool.map(Run.go, all_runs))
