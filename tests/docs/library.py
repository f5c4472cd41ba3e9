#!/usr/bin/python3
"""The example of options/library.md: compiled as it stands, alone and on two ranks, it computes what the program does
with these options; the installed header and library are enough for it, and no file is left."""
import os
import re
import subprocess
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

with open(os.path.join(runs.ROOT, "options", "library.md"), encoding="utf-8") as page:
    text = page.read()
source = re.search(r"```c\n(.*?)```", text, re.S).group(1)
options = re.search(r'IsphCreate\("(.*?)"', source).group(1).split()

TO_ROUNDING = 1e-11  # of twelve digits
TO_SOLVER = 1e-4     # on another number of ranks

place = runs.scratch("opt")
done = runs.install(place)
runs.check(done.returncode == 0, "make install", done.stdout[-400:])
words = subprocess.run(["pkg-config", "--cflags", "--libs", "isph"], capture_output=True, text=True,
                       env=dict(os.environ, PKG_CONFIG_PATH=os.path.join(place, "lib", "pkgconfig")))
runs.check(words.returncode == 0, "pkg-config knows the installed library", words.stderr)
program = runs.scratch("dam")
with open(program + ".c", "w", encoding="utf-8") as file:
    file.write(source)
done = subprocess.run(["cc", "-std=c11", "-Wall", "-Wextra", "-Werror", "-pedantic", program + ".c", "-o", program,
                       *words.stdout.split(), "-lm"], capture_output=True, text=True)
runs.check(done.returncode == 0, "the example compiles without the headers of MPI and PETSc", done.stderr[-600:])
before = sorted(os.listdir(runs.ROOT))
folder = runs.run([*options, "-series_interval", "0"], "run")
highest = max(runs.series(folder)["highest"][1:])
fastest = np.sqrt((runs.fields(runs.numbered(folder, "snapshot")[-1])["velocity"] ** 2).sum(axis=1)).max()
for ranks, allowed in ((1, TO_ROUNDING), (2, TO_SOLVER)):
    command = (["mpiexec", "-n", str(ranks)] if ranks > 1 else []) + [program]
    done = subprocess.run(command, cwd=runs.ROOT, env=runs.environment(ranks), capture_output=True, text=True)
    lines = re.findall(r"^([\d.]+) s: highest (\S+) m, here at most (\S+) m/s$", done.stdout, re.M)
    runs.check(len(lines) == ranks == done.stdout.count("\n") and not done.stderr,
               f"on {ranks} ranks the example says a line a rank and nothing else", (done.stdout + done.stderr)[-400:])
    if lines:
        runs.check_below(abs(float(lines[0][1]) / highest - 1), allowed, f"largest height, {ranks} ranks")
        runs.check_below(abs(max(float(line[2]) for line in lines) / fastest - 1), allowed, f"speed, {ranks} ranks")
runs.check(sorted(os.listdir(runs.ROOT)) == before, "the example leaves no file")
with open(os.path.join(place, "bin", "isph-other"), "w", encoding="utf-8"):
    pass
done = subprocess.run(["make", "-s", "uninstall", f"PREFIX={place}"], cwd=runs.ROOT, capture_output=True, text=True)
left = [file for _, _, files in os.walk(place) for file in files]
runs.check(done.returncode == 0 and left == ["isph-other"], "make uninstall leaves what it did not install",
           done.stderr + str(left))
runs.done()
