#!/usr/bin/python3
"""What users give to make, as RUN=..., reaches the programs as it was typed, and the shell evaluates none of it."""
import json
import os
import re
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

MARK = runs.scratch("evaluated")
EVIL = f"it's \"a\" $HOME `touch {MARK}` $(touch {MARK}) $(shell touch {MARK}); touch {MARK} & # * \\"
WORDS = f"--one it's * $HOME `touch {MARK}` ;touch {MARK} $(shell touch {MARK})"
SPLIT = WORDS.split()
# In place of Python, mpiexec, isph: notes its words. Prerequisites that are built are left as they are.
NOTE = """#!/usr/bin/python3
import json
import os
import sys
with open(os.environ["NOTES"], "a", encoding="utf-8") as notes:
    notes.write(json.dumps(sys.argv[1:]) + "\\n")
"""
HAVE = "#!/bin/sh\nprintf installed\n"  # in place of dpkg-query: no package is missing, so none is installed by a test
MAKES = ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")  # of the make that runs the tests
KEPT = ("isph", "packages", "programs", "output/build/tests/solvers/compare", "output/build/tests/unit/test_errors")
# target, variables, words that one of the calls must end with
TARGETS = (("pictures", {"RUN": EVIL, "FLAGS": WORDS}, [EVIL, *SPLIT]),
           ("film", {"RUN": EVIL, "FLAGS": WORDS}, [EVIL, *SPLIT]),
           ("mesh", {"RUN": EVIL, "FLAGS": WORDS}, [EVIL, *SPLIT]),
           ("report", {"RUN": EVIL, "FLAGS": WORDS}, [EVIL, *SPLIT]),
           ("tradeoff", {"SCENE": EVIL, "GAUGES": EVIL, "BUDGET": EVIL, "TARGET": EVIL, "WAYS": WORDS},
            [EVIL, f"--gauges={EVIL}", f"--budget={EVIL}", f"--target={EVIL}", "--ways", *SPLIT]),
           ("fit", {"SCENE": EVIL, "CURVE": EVIL, "FREE": EVIL, "FLAGS": WORDS}, [EVIL, EVIL, EVIL, *SPLIT]),
           ("tradeoff", {"CASE": EVIL}, [f"--case={EVIL}"]),
           ("tradeoff-readme", {"CASE": EVIL}, [f"--case={EVIL}", "--readme"]),
           ("compare-solvers", {"STATE": EVIL, "RANKS": EVIL}, ["--ranks", EVIL, EVIL]),
           ("verify", {"CASE": EVIL, "FROM": WORDS, "JOBS": "3"},
            [f"--case={EVIL}", "--jobs", "3", *(word for one in SPLIT for word in ("--from", one))]),
           ("convergence", {"CASE": EVIL, "JOBS": "3"}, [f"--case={EVIL}", "--jobs", "3"]),
           ("reference", {"CASE": WORDS}, SPLIT),
           ("identical", {"COMMIT": EVIL}, [EVIL]),
           ("bench", {"SIZE": EVIL}, ["--size", EVIL]),
           ("bench-results", {"FLAGS": WORDS}, SPLIT),
           ("seeds", {"JOBS": EVIL}, ["--jobs", EVIL]),
           ("test", {"ONLY": EVIL, "JOBS": EVIL}, ["--only", EVIL, "--jobs", EVIL]),
           ("check", {"CHANGED": "1", "BASE": EVIL}, ["--check", "--changed", EVIL]),
           ("run", {"RUN": EVIL}, ["-output_dir", EVIL, "-output_overwrite", "-ranks", "2"]),
           ("run", {"RUN": EVIL}, [EVIL]),
           ("paper", {"RUN": EVIL, "FLAGS": WORDS}, ["-output_dir", f"{EVIL}_paper", "-output_overwrite", *SPLIT,
                                                 "-ranks", "2"]),
           ("paper", {"RUN": EVIL}, [f"{EVIL}_paper"]))

tools = runs.scratch("tools")
os.mkdir(tools)
for tool, text in (("python", NOTE), ("mpiexec", NOTE), ("true", NOTE), ("dpkg-query", HAVE)):
    with open(os.path.join(tools, tool), "w", encoding="utf-8") as tool_file:
        tool_file.write(text)
    os.chmod(os.path.join(tools, tool), 0o755)
for target, given, due in TARGETS:
    notes = runs.scratch("notes")
    if os.path.exists(notes):
        os.unlink(notes)
    command = ["make", "-s", target, f"PYTHON={os.path.join(tools, 'python')}", "MAKE=true"]
    command += [word for name in KEPT for word in ("-o", name)] + [f"{name}={value}" for name, value in given.items()]
    environment = {name: value for name, value in os.environ.items() if name not in MAKES}
    environment.update(NOTES=notes, PATH=tools + os.pathsep + os.environ["PATH"])
    done = subprocess.run(command, cwd=runs.ROOT, env=environment, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, timeout=60, check=False)
    calls = []
    if os.path.exists(notes):
        with open(notes, encoding="utf-8") as file:
            calls = [json.loads(line) for line in file]
    evaluated = os.path.exists(MARK)
    if evaluated:
        os.unlink(MARK)
    runs.check(done.returncode == 0 and not evaluated and any(call[-len(due):] == due for call in calls),
               f"{target} {' '.join(given)}", f"code {done.returncode}, {evaluated=}, {calls}, {done.stdout[-300:]}")

# a prefix with an apostrophe and blanks: the programs that are installed there find each other
prefix = runs.scratch("a user's prefix")
done = runs.install(prefix)
helped = subprocess.run([os.path.join(prefix, "bin", "isph-pictures"), "--help"], text=True, stdout=subprocess.PIPE,
                        stderr=subprocess.STDOUT, timeout=60, check=False) if done.returncode == 0 else done
runs.check(helped.returncode == 0 and "--color" in helped.stdout, "install PREFIX", helped.stdout[-300:])

# no recipe puts such a variable into the text that the shell reads
names = "BASE|BUDGET|CASE|COMMIT|CURVE|DESTDIR|FLAGS|FREE|FROM|GAUGES|JOBS|MUTANT|ONLY|PREFIX|RANKS|RUN|SCENE|" \
    "SIZE|STATE|TARGET|WAYS"
bare = []
for folder, _, files in os.walk(runs.ROOT):
    if os.path.relpath(folder, runs.ROOT).split(os.sep)[0] in ("output", ".git"):
        continue
    for path in (os.path.join(folder, file) for file in files if file in ("makefile", "rules.mk")):
        with open(path, encoding="utf-8") as file:
            for line in file:
                asked = re.sub(rf"\$\((?:if|findstring \S+,|filter \S+,)\s*\$\(({names})\)", "", line)
                bare += [line.strip()] if line[0] == "\t" and re.search(rf"\$\(({names})\)", asked) else []
runs.check(not bare, "no variable in the text of a recipe", str(bare))
# what is not given has its default, whatever makes the rest opaque to the shell
text = subprocess.run(["make", "-pn", "help"], cwd=runs.ROOT, check=True, stdout=subprocess.PIPE, text=True,
                      env={k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MFLAGS")}).stdout
for name, value in (("BASE", "HEAD"), ("COMMIT", "HEAD"), ("SIZE", "quick"), ("BUDGET", "600"), ("TARGET", "5"),
                    ("RANKS", "1"), ("RUN", "output/drop_impact")):
    found = re.search(rf"^{name} :?= *(.*)$", text, re.M)
    runs.check(found and found[1] == value, f"default_of_{name}", found and found[0])
runs.done()
