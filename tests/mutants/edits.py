"""The list of mutants: tests/mutants/*.ini, a file for each folder of src or tests that they change. A file that is
changed, and its edits:

    [src/pressure/source.c]
    tests: unit/test_pressure, unit/test_neighbors on 2     those of edits that name none
    [name of the mutant]
    was: an expression that stands in the file once, however its blanks and lines are laid out
    is: what replaces it
    bug: what is wrong then, in a line
    tests: unit/test_pressure, verify/couette-printed, input/bad_input.py
    survives: if no test sees it: why (an equivalent mutant, or a gap)

A file is a source of the program, a Python program of src/answers, src/pictures, src/python, tests/tradeoff or
tests/verify, or a script of the report's page.
Tests are parts of `make test`: unit programs, on some ranks if it says so; scripts, or a part of one as
answers/answers.py:holds; entries of tests/verify/cases.py of size test by their id. They run in this order until one
fails."""
import configparser
import functools
import glob
import os
import re
import sys
from typing import NamedTuple

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path.insert(0, os.path.join(ROOT, "tests"))
import run  # noqa: E402

KEYS = {"was", "is", "bug"}
VERIFY = "verify/"
DEAR = 60  # s of a test that need not run after each change of a file whose bugs it sees
PLACES = re.compile(r"src/(?:\w+/)?\w+\.[ch]$|src/pictures/\w+\.js$|"
                    r"(src/answers|src/pictures|src/python/isph|tests/tradeoff|tests/verify)/\w+\.py$")


class Mutant(NamedTuple):
    name: str
    file: str
    was: str
    becomes: str
    bug: str
    tests: tuple
    survives: str

    def apply(self, text):
        """The text with the bug, and how often the expression stood there."""
        where = r"\s+".join(re.escape(word) for word in self.was.split())
        return re.subn(where, lambda _: self.becomes, text)

    @property
    def folder(self):
        return self.file.split("/")[1]


def read():
    """All mutants, in the order of the files."""
    mutants = []
    for path in sorted(glob.glob(os.path.join(HERE, "*.ini"))):
        parser, changed, tests = configparser.ConfigParser(delimiters=(":",), comment_prefixes=("#",),
                                                           interpolation=None), "", ""
        with open(path, encoding="utf-8") as file:
            parser.read_file(file)
        for name in parser.sections():
            entry = parser[name]
            if "/" in name:
                changed, tests = name, entry.get("tests", "")
                continue
            if not KEYS <= set(entry) <= KEYS | {"tests", "survives"} or not entry.get("tests", tests):
                raise ValueError(f"mutant {name} must have {', '.join(sorted(KEYS))} and may have tests and survives")
            mutants.append(Mutant(name, changed, entry["was"], entry["is"], entry["bug"],
                                  tuple(word.strip() for word in entry.get("tests", tests).split(",")),
                                  entry.get("survives", "")))
    return mutants


@functools.lru_cache(maxsize=None)
def jobs():
    """The jobs of tests/run.py that are part of `make test`."""
    return [job for job in run.find(run.read_table(), run.FOLDERS) if job.row and job.row.set != "long"]


def job_of(test):
    """The name of a test's job in tests/run.py: unit/NAME@3 for 'unit/NAME on 3', the part of verify/entries.py for an
    entry of tests/verify/cases.py."""
    name, _, ranks = test.partition(" on ")
    if name.startswith("unit/"):
        return f"{name}@{ranks or 1}"
    return f"{VERIFY}entries.py:{name[len(VERIFY):]}" if name.startswith(VERIFY) and ".py" not in name else test


def is_of(test, job):
    """Whether a test of the list is, or has as a part, a job."""
    return job_of(test) in (job.name, job.name.partition(":")[0])


def unwatched(mutants):
    """Those for whose file `make check CHANGED=1` runs none of their tests, though one takes less than DEAR: the table
    of tests/run.py watches too little."""
    chosen = {file: run.watching(jobs(), [file]) for file in {m.file for m in mutants}}
    return [m for m in mutants if not any(is_of(test, job) for test in m.tests for job in chosen[m.file])
            and any(is_of(test, job) and job.row.seconds < DEAR for test in m.tests for job in jobs())]


def mistakes(mutants):
    """What is wrong with the list beside the present tree: a line each."""
    lines = []
    for m in mutants:
        try:
            with open(os.path.join(ROOT, m.file), encoding="utf-8") as file:
                count = m.apply(file.read())[1]
        except OSError:
            lines.append(f"{m.name}: there is no {m.file}")
            continue
        if count != 1:
            lines.append(f"{m.name}: its text stands in {m.file} {count} times, not once: mend the edit")
        if m.was == m.becomes or not PLACES.match(m.file):
            lines.append(f"{m.name}: it must change a source of the program, a Python program or a script of the page")
        lines += [f"{m.name}: {test} is no part of make test" for test in m.tests
                  if not any(is_of(test, job) for job in jobs())]
    return lines
