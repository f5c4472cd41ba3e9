#!/usr/bin/python3
"""Runs on two hosts, which are two network namespaces of this machine with a cable between them and two ranks each:
they compute what one host does, go on with three ranks, and end by themselves when a host or the cable is lost and
when the hosts do not share the output folder. Needs root, iproute2 and Open MPI, and is left out elsewhere."""
import contextlib
import glob
import os
import re
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

SPACING = 0.04  # m
SCENE = f"""-dimension 2 -spacing {SPACING} -box_lower 0,0 -box_upper 1,1 -box_x periodic -box_ymin wall
 -gravity 0,-9.81 -bodies film,drop -film_upper 1,0.3 -film_tension 20 -drop_shape sphere -drop_radius 0.1
 -drop_center 0.5,0.45 -drop_velocity 1,-2 -drop_tension 20 -time_step 1e-3 -ksp_rtol 1e-12 """
ENDLESS = SCENE + "-checkpoint_interval 0.02 -time_end 1000 "
STEPS = (20, 30)    # of a run and of the run that continues it
TOLERANCE = 1e-6    # spacings, of positions
SECONDS = 60        # a run of these ends in two; the machine may be busy
SILENCE = 5         # s
NET = "10.213.7."   # addresses of the hosts: .1 and .2
# Open MPI over the cable alone. mpiexec notices the loss of a host that is silent after 1 + 5 x 2 s (by default eight
# minutes), later than SILENCE: else it would end the run first.
NETWORK = {"pml": "ob1", "btl": "tcp,self", "btl_tcp_if_include": NET + "0/24", "oob_tcp_if_include": NET + "0/24",
           "oob_tcp_keepalive_time": "1", "oob_tcp_keepalive_intvl": "2", "oob_tcp_keepalive_probes": "5"}
# Runs a command on host a or b, which has its own name; APART: a folder that this host alone sees.
ENTER = """#!/bin/sh
host=$1
shift
exec ip netns exec {name}-$host unshare -u sh -c 'hostname host-$0
[ $0 = a ] || [ -z "${{APART-}}" ] || mount -t tmpfs none "$APART" || exit
exec "$@"' $host "$@"
"""
AGENT = '#!/bin/sh\nshift\nexec {enter} b sh -c "$*"\n'  # in place of ssh ADDRESS COMMAND
PREFIX = "isph-test-"
name = f"{PREFIX}{os.getpid()}"
enter, agent = runs.scratch("enter"), runs.scratch("agent")


def ip(words):
    return subprocess.run(["ip"] + words.split(), check=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, errors="replace").stdout


def processes(host):
    return [int(pid) for pid in ip(f"netns pids {name}-{host}").split()]


def ranks(host):
    """The ranks of the program on a host."""
    is_program = lambda pid: os.path.realpath(f"/proc/{pid}/exe") == os.path.realpath(runs.PROGRAM)
    return [pid for pid in processes(host) if is_program(pid)]


def kill(pids):
    for pid in pids:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)


def clean(prefix=name):
    """Removes the hosts with what runs on them; with PREFIX also those of tests that were killed."""
    for line in ip("netns list").splitlines():
        net = line.split()[0]
        owner = re.match(re.escape(PREFIX) + r"(\d+)-[ab]$", net)
        if owner and net.startswith(prefix) and (prefix == name or not os.path.exists(f"/proc/{owner[1]}")):
            kill(int(pid) for pid in ip(f"netns pids {net}").split())
            ip(f"netns delete {net}")


def prepare():
    """Makes the two hosts; why this machine cannot, or None."""
    if os.geteuid() or not shutil.which("ip"):
        return "two hosts on one machine need root and iproute2"
    version = subprocess.run(["mpiexec", "--version"], stdout=subprocess.PIPE, text=True, check=False).stdout
    if "OpenRTE" not in version and "Open MPI" not in version:
        return "mpiexec is not Open MPI's, whose network settings the test uses"
    for path, text in ((enter, ENTER), (agent, AGENT)):
        with open(path, "w", encoding="utf-8") as file:
            file.write(text.format(name=name, enter=enter))
        os.chmod(path, 0o755)
    try:
        clean(PREFIX)
        for host in "ab":
            ip(f"netns add {name}-{host}")
        ip(f"link add cable netns {name}-a type veth peer name cable netns {name}-b")
        for k, host in enumerate("ab", 1):
            ip(f"-n {name}-{host} address add {NET}{k}/24 dev cable")
            for device in ("lo", "cable"):
                ip(f"-n {name}-{host} link set {device} up")
            subprocess.run([enter, host, "sh", "-c", "echo 3 >/proc/sys/net/ipv4/tcp_retries2"], check=True,
                           stderr=subprocess.PIPE, text=True)
    except subprocess.CalledProcessError as error:
        return f"this machine makes no network namespaces: {error.stderr.strip()}"
    return None


def launch(options, size, folder, **more):
    """Starts so many ranks, of which host a takes the first two."""
    settings = {f"OMPI_MCA_{key}": value for key, value in NETWORK.items()}
    environment = dict(runs.environment(size), **settings, **more, OMPI_MCA_plm_rsh_agent=agent,
                       TMPDIR=runs.scratch(""))
    command = [enter, "a", "mpiexec", "-n", str(size), "--host", f"{NET}1:2,{NET}2:2", runs.PROGRAM]
    return subprocess.Popen(command + runs.shlex.split(options) + ["-output_dir", folder], cwd=runs.ROOT,
                            env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            text=True, errors="replace")


def end(process):
    """(code, standard error); code None: it hung and was killed."""
    try:
        _, err = process.communicate(timeout=SECONDS)
        return process.returncode, err
    except subprocess.TimeoutExpired:
        kill(processes("a") + processes("b"))
        return None, process.communicate()[1]


def wait(process, folder):
    """Until the run has written two checkpoints."""
    while process.poll() is None and len(glob.glob(os.path.join(folder, "checkpoint_*.h5"))) < 2:
        time.sleep(0.01)


def same(one, two, what):
    """Whether two folders end in the same state."""
    one, two = (runs.fields(runs.numbered(folder, "checkpoint")[-1]) for folder in (one, two))
    if runs.check(np.array_equal(one["id"], two["id"]), f"{what}_particles", "they are others"):
        runs.check_below(np.abs(one["position"] - two["position"]).max() / SPACING, TOLERANCE, f"{what}_positions")


def compute():
    """Two hosts and one, from the start and from a checkpoint on three ranks."""
    one, two = runs.run(SCENE + f"-steps_max {STEPS[0]}", "one"), runs.scratch("two")
    code, err = end(launch(SCENE + f"-steps_max {STEPS[0]}", 4, two))
    if not runs.check(code == 0, "two_hosts", f"code {code}: {err[-500:]}"):
        return
    same(one, two, "two_hosts")
    start = runs.numbered(one, "checkpoint")[-1]
    more = f"-steps_max {STEPS[1] - STEPS[0]} -restart "
    on_one, on_two = runs.run(SCENE + more + start, "on_one"), runs.scratch("on_two")
    code, err = end(launch(SCENE + more + runs.numbered(two, "checkpoint")[-1], 3, on_two))
    if runs.check(code == 0, "three_ranks", f"code {code}: {err[-500:]}"):
        same(on_one, on_two, "three_ranks")


def lose(what, act, sentence, seconds):
    """A run loses something: it ends by itself within so many seconds, names a checkpoint that is good, and leaves no
    process behind."""
    folder = runs.scratch(what)
    process = launch(ENDLESS + f"-wall_clock_silence {SILENCE}", 4, folder)
    wait(process, folder)
    there = [len(ranks(host)) for host in "ab"]
    runs.check(there == [2, 2], f"{what}_after_a_start_on_both_hosts", f"the hosts have {there} ranks")
    began = time.monotonic()
    act()
    code, err = end(process)
    runs.check(code not in (0, None), f"{what}_ends_the_run", f"code {code}: {err[-500:]}")
    runs.check_below(time.monotonic() - began, seconds, f"{what}_seconds")
    runs.check(not ranks("a") and not ranks("b"), f"{what}_leaves_no_process", f"{ranks('a')} and {ranks('b')}")
    named = re.search(f"^isph: .*{sentence}.*checkpoint is (\\S+)$", err, re.M)
    if runs.check(bool(named), f"{what}_names_the_checkpoint", err[-1500:]):
        again = runs.start(SCENE + f"-steps_max 1 -restart {named[1]} -output_dir {folder}")
        runs.check(again.returncode == 0, f"{what}_continued", again.stderr[-500:])


def apart():
    folder = runs.scratch("apart")
    os.mkdir(folder)
    code, err = end(launch(ENDLESS, 4, folder, APART=folder))
    lines = [line for line in err.splitlines() if line.startswith("isph: ")]
    runs.check(code and len(lines) == 1 and "Rank 2 does not see" in lines[0], "a_folder_of_one_host_is_refused",
               f"code {code}: {err[-500:]}")


def main():
    why = prepare()
    if why:
        print(f"skipped: {why}")
        return
    compute()
    apart()
    lose("host", lambda: kill(processes("b")), "received a signal", 15)
    lose("cable", lambda: ip(f"-n {name}-b link set cable down"), f"for {SILENCE} s", SILENCE + 15)


for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    signal.signal(number, lambda *_: sys.exit(1))
try:
    main()
finally:
    if shutil.which("ip"):
        clean()
runs.done()
