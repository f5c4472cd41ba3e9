#!/usr/bin/python3
"""What a user does to a run in a terminal: Ctrl-C, Ctrl-Z and fg, a closed window, kill, a killed launcher, a stop
file; at short steps, and during one that takes longer than mpiexec's patience. Each time the run on two ranks by
-ranks, and on one, ends with a checkpoint to continue from and a sentence; mpiexec in place of -ranks is warned of at
the start.

    tests/faults/terminal.py [--all]    on one rank, too, and with more signals"""
import contextlib
import os
import pty
import select
import shlex
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

SCENE = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,1 -box_x periodic -box_ymin wall -gravity 0,-9.81
 -bodies film -film_upper 1,0.3 -snapshot_interval 0.02 -checkpoint_interval 0.02 -progress_interval 0.1
 -time_end 1000 """
STUCK = 4.0  # s of a long step: Open MPI's mpiexec kills two seconds after a signal
SECONDS = 120  # a run ends in two; the machine may be busy


class Terminal:
    """The program in a pseudo-terminal of its own, as the shell in it would start it."""

    def __init__(self, words, ranks, folder):
        self.folder, self.text, self.ranks = folder, "", ranks
        environment = runs.environment(ranks)
        self.pid, self.master = pty.fork()
        if not self.pid:
            os.chdir(runs.ROOT)
            os.execve(words[0] if "/" in words[0] else "/usr/bin/env", words if "/" in words[0] else ["env", *words],
                      environment)

    def read(self, seconds):
        """What the program writes within a time; it would wait for a reader."""
        until = time.monotonic() + seconds
        while self.master is not None and (left := until - time.monotonic()) > 0:
            if select.select([self.master], [], [], left)[0]:
                try:
                    self.text += os.read(self.master, 65536).decode(errors="replace")
                except OSError:  # nobody has the terminal any more
                    break
        if self.master is None:
            time.sleep(seconds)

    def processes(self):
        """The ranks, in order."""
        found = []
        for name in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open(f"/proc/{name}/cmdline", "rb") as file:
                    words = file.read().split(b"\0")
                if self.folder.encode() in words and b"isph" in os.path.basename(words[0]) and (
                        self.ranks == 1 or self.parent(int(name)) != os.getpid()):
                    found.append(int(name))
            except (FileNotFoundError, ProcessLookupError, PermissionError):
                pass
        return sorted(found)

    def parent(self, pid):
        with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
            return int(file.read().rsplit(")", 1)[1].split()[1])

    def until(self, there):
        """Waits for something; whether it came."""
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            self.read(0.05)
            if there():
                return True
        return False

    def ended(self):
        """The exit code, once all processes are gone; None: they did not end."""
        code = []

        def gone():
            if not code:
                pid, status = os.waitpid(self.pid, os.WNOHANG)
                if pid:
                    code.append(os.waitstatus_to_exitcode(status))
            return code and not self.processes()

        if self.until(gone):
            return code[0]
        for pid in [self.pid] + self.processes():
            os.kill(pid, signal.SIGKILL)
        return None

    def close(self):
        if self.master is not None:
            os.close(self.master)
        self.master = None


def log_of(folder):
    with open(os.path.join(folder, "log.txt"), encoding="utf-8") as file:
        return file.read()


def key(letter):
    return lambda terminal: os.write(terminal.master, bytes([ord(letter) - 64]))


def send(number):
    return lambda terminal: os.kill(terminal.pid, number)


def touch(terminal):
    with open(os.path.join(terminal.folder, "stop"), "w", encoding="utf-8"):
        pass


def suspend(terminal):
    """Ctrl-Z and, after a while, what fg sends; then Ctrl-C."""
    key("Z")(terminal)
    terminal.read(1)
    before = os.path.getsize(os.path.join(terminal.folder, "series.csv"))
    terminal.read(1)
    terminal.still = os.path.getsize(os.path.join(terminal.folder, "series.csv")) == before
    os.kill(terminal.pid, signal.SIGCONT)
    terminal.read(0.5)
    key("C")(terminal)


def trial(what, do, ranks, long):
    """One run, to which 'do' is done; long: during a step that takes STUCK seconds, as its last rank is stopped."""
    name = f"{what}, {'a long step' if long else 'short steps'}, {ranks} rank{'s' * (ranks > 1)}"
    folder = runs.scratch(name.replace(", ", "_").replace(" ", "_"))
    words = [runs.PROGRAM, *(["-ranks", str(ranks)] if ranks > 1 else []), *shlex.split(SCENE), "-output_dir", folder]
    terminal = Terminal(words, ranks, folder)
    good = terminal.until(lambda: os.path.isdir(folder) and len(runs.numbered(folder, "checkpoint")) > 0)
    there = terminal.processes()
    good = good and len(there) == ranks
    if good and long:
        os.kill(there[-1], signal.SIGSTOP)
        terminal.read(0.3)
    before = len(terminal.text)
    do(terminal)
    if good and long:
        terminal.read(STUCK)
        with contextlib.suppress(ProcessLookupError):  # it has ended, and fails below
            os.kill(there[-1], signal.SIGCONT)
    code = terminal.ended()
    files = runs.numbered(folder, "checkpoint")
    said, log = terminal.text[before:], log_of(folder)
    good = good and "ended by " in log and files and f"-restart {files[-1]}" in log
    good = good and (code in (0, -signal.SIGKILL)) and (code == 0 or "launcher" in what)
    good = good and not [n for n in os.listdir(folder) if n.endswith((".tmp", ".lock")) or n == "stop"]
    good = good and getattr(terminal, "still", True)
    if good and long and ranks > 1 and terminal.master is not None and "file" not in what:
        good = "ends with a checkpoint after this step" in said.replace("\r", "")
    if good:
        again = runs.start(SCENE + f"-steps_max 1 -restart {files[-1]} -output_dir {folder}")
        good = again.returncode == 0 and abs(runs.series(folder)["time"][-2] - runs.head(files[-1])["time"]) < 1e-9
    runs.check(good, name.replace(" ", "_").replace(",", ""), f"code {code}, {there}: {said[-500:]} | {log[-300:]}")
    terminal.close()


def twice():
    """A second Ctrl-C ends the run at once."""
    folder = runs.scratch("twice")
    terminal = Terminal([runs.PROGRAM, "-ranks", "2", *shlex.split(SCENE), "-output_dir", folder], 2, folder)
    terminal.until(lambda: os.path.isdir(folder) and len(runs.numbered(folder, "checkpoint")) > 0)
    there = terminal.processes()
    os.kill(there[-1], signal.SIGSTOP)
    for _ in range(2):
        key("C")(terminal)
        terminal.read(1)
    os.kill(there[-1], signal.SIGCONT)
    code = terminal.ended()
    runs.check(code and "ended by" not in log_of(folder), "a_second_Ctrl-C_ends_the_run_at_once", f"code {code}")
    terminal.close()


def warned():
    """mpiexec in place of -ranks: said before it is too late, with the way out."""
    folder = runs.scratch("warned")
    words = ["mpiexec", "-n", "2", runs.PROGRAM, *shlex.split(SCENE), "-steps_max", "3", "-output_dir", folder]
    terminal = Terminal(words, 2, folder)
    code = terminal.ended()
    runs.check(code == 0 and f"touch {folder}/stop" in terminal.text and "-ranks 2" in terminal.text,
               "mpiexec_is_warned_of", f"code {code}: {terminal.text[-600:]}")
    terminal.close()


def first():
    """-ranks before the options files, as -help shows it."""
    with open(runs.scratch("first.opts"), "w", encoding="utf-8") as file:
        file.write(SCENE.replace(" -", "\n-"))
    for ranks in (1, 2):
        folder = runs.scratch(f"first_{ranks}")
        done = subprocess.run([runs.PROGRAM, "-ranks", str(ranks), file.name, "-steps_max", "2", "-output_dir", folder],
                              cwd=runs.ROOT, env=runs.environment(ranks), stdin=subprocess.DEVNULL, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=SECONDS, check=False)
        runs.check(done.returncode == 0 and runs.series(folder)["step"][-1] == 2, f"before_the_files_{ranks}",
                   done.stdout[-400:])


def refused():
    """-ranks where it cannot start mpiexec."""
    with open(runs.scratch("ranks.opts"), "w", encoding="utf-8") as file:
        file.write("-ranks 2\n")
    for name, words, word in (("in_a_file", [runs.PROGRAM, file.name, *shlex.split(SCENE)], "on the command line"),
                              ("zero", [runs.PROGRAM, *shlex.split(SCENE), "-ranks", "0"], "-ranks is 0"),
                              ("under_mpiexec", ["mpiexec", "-n", "1", runs.PROGRAM, *shlex.split(SCENE), "-ranks",
                                                 "2"], "without mpiexec")):
        done = subprocess.run(words + ["-output_dir", runs.scratch("refused")], cwd=runs.ROOT, check=False,
                              env=runs.environment(2), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=SECONDS)
        lines = [line for line in done.stderr.splitlines() if line.startswith("isph: error: ")]
        runs.check(done.returncode and len(lines) == 1 and word in lines[0] and
                   not os.path.exists(runs.scratch("refused")), f"ranks_refused_{name}", done.stderr[-400:])


def main():
    every = "--all" in sys.argv
    for long in (False, True):
        trial("Ctrl-C", key("C"), 2, long)
        trial("a closed window", Terminal.close, 2, long)
    trial("Ctrl-Z and fg", suspend, 2, False)
    trial("kill", send(signal.SIGTERM), 2, True)
    trial("a killed launcher", send(signal.SIGKILL), 2, True)
    trial("a stop file", touch, 2, True)
    if every:
        for number in (signal.SIGHUP, signal.SIGQUIT, signal.SIGUSR1, signal.SIGXCPU):
            trial(number.name, send(number), 2, True)
        for what, do in (("Ctrl-C", key("C")), ("a closed window", Terminal.close), ("kill", send(signal.SIGTERM)),
                         ("a stop file", touch)):
            trial(what, do, 1, False)
            trial(what, do, 1, True)
        trial("Ctrl-C", key("C"), 4, True)
    twice()
    warned()
    first()
    refused()
    runs.done()


main()
