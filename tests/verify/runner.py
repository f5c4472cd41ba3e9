"""Runs the entries of tests/verify/cases.py and judges them.

    runner.py [--size test|short|long] [--case CASE[:LABEL]] [--jobs N] [--from ID=FOLDER ...]
                                           make verify, make verify-long
    runner.py --convergence --case CASE    make convergence CASE=...
    runner.py --readme                     make verify-readme: the tables of cases/*/results.md and what READMEs choose
                                           of them; rows of entries that did not run stay
    runner.py --list                       the entries

--size short runs the entries of sizes test and short, --size long all. Prints one table and writes
output/verify/verify.csv and verify.md: rows of entries that did not run now are kept. Runs stay in
output/verify/<id>. --from judges a run that exists instead of running the entry (--convergence: ID-SPACING).
The last line is
'N within tolerance, M known misses, K failed'; the exit code tells whether any failed. Rows beyond their tolerance are
held in the bands of misses.csv (misses.py), those of the reference scheme as well.
"""
import argparse
import concurrent.futures
import csv
import datetime
import importlib.util
import math
import os
import re
import shlex
import subprocess
import sys
import time
import traceback

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import cases  # noqa: E402
import misses  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

OUTPUT = os.path.join(runs.ROOT, "output", "verify")
TIMEOUT = {"test": 300, "short": 1200, "long": 7 * 86400}  # s
SIZES = {"test": ("test",), "short": ("test", "short"), "long": ("test", "short", "long")}
COLUMNS = ("case", "label", "scheme", "options", "quantity", "measured", "expected", "tolerance", "pass", "seconds",
           "version", "date", "id", "value", "remark")


def module_of(case):
    """The module cases/<case>/check.py."""
    path = os.path.join(runs.ROOT, "cases", case, "check.py")
    spec = importlib.util.spec_from_file_location("check_" + case, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def load(case):
    """check(folder) of a case."""
    return module_of(case).check


def version():
    """The commit, with + if the sources differ from it."""
    git = ["git", "-C", runs.ROOT]
    sources = ["src", "options", "cases/*.opts", "cases/*.py"]
    try:
        commit = subprocess.run(git + ["rev-parse", "--short", "HEAD"], check=True, stdout=subprocess.PIPE, text=True)
        changed = subprocess.run(git + ["diff", "--quiet", "HEAD", "--"] + sources, check=False)
    except (OSError, subprocess.CalledProcessError):
        return "-"
    return commit.stdout.strip() + ("+" if changed.returncode else "")


class Outcome:
    """What an entry gave: results, or the reason why there are none."""

    def __init__(self, entry, results=(), reason="", seconds=math.nan):
        self.entry, self.results, self.reason, self.seconds = entry, list(results), reason, seconds

    def rows(self, records=None):
        """The lines of the tables, judged beside the records of known misses (default: those of misses.csv)."""
        records = misses.read() if records is None else records
        fixed = dict(case=self.entry.case, label=self.entry.label, scheme=self.entry.scheme,
                     options=self.entry.options, seconds=f"{self.seconds:.3g}", version=version(),
                     date=datetime.date.today().isoformat(), id=self.entry.id)
        lines = [(r.name, r.words(), r.measured, r.passed()) for r in self.results]
        if self.reason:
            lines = [("run", (self.reason, "runs to the end", "-"), misses.stop_time(self.reason), False)]
        rows = []
        for name, words, value, passed in lines:
            word, remark = misses.judge(passed, value, records.get((self.entry.id, name)))
            rows.append((name, words, value, word, remark))
        if not self.reason:
            rows += [(name, ("-", "-", "-"), math.nan, misses.FAILED, remark)
                     for name, remark in misses.stale(records, self.entry.id, [line[0] for line in lines])]
        return [dict(fixed, quantity=name, measured=words[0], expected=words[1], tolerance=words[2], value=value,
                     remark=remark, **{"pass": word}) for name, words, value, word, remark in rows]


def last_words(process):
    """Why a run failed, from what it printed."""
    lines = [line.strip() for line in process.stderr.splitlines() if line.strip() and not line.startswith("---")]
    text = next((line for line in lines if "isph: error:" in line), lines[-1] if lines else "")
    text = text.replace("isph: error: ", "").split(": try ")[0]  # the program's advice does not fit a table
    return text[:200].replace("|", "/") or f"exit code {process.returncode}"


def execute(entry, folder, extra="", existing=None):
    """The Outcome of an entry: the mean of its packings, the first of which runs in the folder."""
    outcome = execute_one(entry, folder, extra, existing)
    for seed in range(2, entry.packings + 1 if not existing else 0):
        other = execute_one(entry, f"{folder}-{seed}", f"{extra} -packing_seed {seed}")
        if outcome.reason or other.reason:
            return outcome if outcome.reason else other
        outcome.results = [a._replace(measured=a.measured + (b.measured - a.measured) / seed)
                           for a, b in zip(outcome.results, other.results)]
    return outcome


def execute_one(entry, folder, extra, existing=None):
    """Runs an entry in the folder and checks it: an Outcome, whatever happens."""
    options = f"-options_file cases/{entry.case}/{entry.file} {entry.options} {extra}"
    started = time.monotonic()
    try:
        if not existing:
            options = shlex.split(options) + ["-progress_interval", "0", "-output_overwrite", "-output_dir", folder]
            process = runs.start(options, entry.ranks, TIMEOUT[entry.size])
            if process.returncode:
                return Outcome(entry, reason=last_words(process), seconds=time.monotonic() - started)
        seconds = float(runs.series(existing or folder)["wall_time"][-1])
        return Outcome(entry, load(entry.case)(existing or folder), seconds=seconds)
    except subprocess.TimeoutExpired:
        return Outcome(entry, reason=f"not done after {TIMEOUT[entry.size]} s")
    except Exception as error:  # a check that cannot judge a run is a failed row
        where = traceback.extract_tb(error.__traceback__)[-1]
        return Outcome(entry, reason=f"check: {error} ({os.path.basename(where.filename)}:{where.lineno})")


def everything(entries, jobs, existing):
    """The outcomes, in the order of the list; single-process entries run jobs at a time, the others alone."""
    def one(entry):
        outcome = execute(entry, os.path.join(OUTPUT, entry.id), existing=existing.get(entry.id))
        good = sum(r.passed() is True for r in outcome.results)
        bad = sum(r.passed() is False for r in outcome.results) + bool(outcome.reason)
        print(f"{entry.id}: {good} within, {bad} not, {outcome.seconds:.3g} s {outcome.reason}", file=sys.stderr,
              flush=True)
        return outcome

    outcomes = {}
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        single = [e for e in entries if e.ranks == 1]
        outcomes.update(zip((e.id for e in single), pool.map(one, single)))
    outcomes.update((e.id, one(e)) for e in entries if e.ranks > 1)
    return [outcomes[e.id] for e in entries]


def table(rows, columns):
    """A table in markdown, its columns aligned."""
    lines = [columns] + [["-" * 3] * len(columns)] + [[str(row[c]) for c in columns] for row in rows]
    width = [min(40, max(len(line[k]) for line in lines)) for k in range(len(columns))]
    return "\n".join("| " + " | ".join(word.ljust(n) for word, n in zip(line, width)) + " |" for line in lines)


def compact(rows):
    """Rows for reading: the case's name with its label, the options beside the scheme."""
    short = []
    for row in rows:
        options = " ".join(row["options"].replace("-options_file options/printed.opts", "").split())
        short.append(dict(row, case=", ".join(w for w in (row["case"], row["label"]) if w),
                          **{"scheme/options": " ".join(w for w in (row["scheme"], options) if w)}))
    return short


def read_rows():
    """The rows of the last verify.csv, of entries that are still in the list."""
    try:
        with open(os.path.join(OUTPUT, "verify.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except OSError:
        return []
    order = {entry.id: k for k, entry in enumerate(cases.ENTRIES)}
    return sorted((row for row in rows if row["id"] in order), key=lambda row: order[row["id"]])


def counts(rows):
    """'N within tolerance, M known misses, K failed'."""
    words = [row["pass"] for row in rows]
    return (f"{words.count(misses.WITHIN)} within tolerance, {words.count(misses.KNOWN)} known misses, "
            f"{words.count(misses.FAILED)} failed")


def failures(rows):
    """Prints a line for each row that failed; their number."""
    failed = [row for row in rows if row["pass"] == misses.FAILED]
    for row in failed:
        print(f"FAIL {row['id']} {row['quantity']}: {row['measured']}, expected {row['expected']}, tolerance "
              f"{row['tolerance']}: {row['remark']}", flush=True)
    return len(failed)


def write_tables(new):
    """verify.csv and verify.md with the new rows and those of entries that did not run now."""
    ran = {row["id"] for row in new}
    order = {entry.id: k for k, entry in enumerate(cases.ENTRIES)}
    rows = sorted(new + [row for row in read_rows() if row["id"] not in ran], key=lambda row: order[row["id"]])
    with open(os.path.join(OUTPUT, "verify.csv"), "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)
    with open(os.path.join(OUTPUT, "verify.md"), "w", encoding="utf-8") as file:
        file.write("# Verification\n\n")
        file.write(table(compact(rows), ["case", "scheme/options", "quantity", "measured", "expected", "tolerance",
                                         "pass", "seconds", "version", "date"]))
        file.write(f"\n\n{counts(rows)}\n")


def verify(entries, jobs, existing):
    os.makedirs(OUTPUT, exist_ok=True)
    rows = [row for outcome in everything(entries, jobs, existing) for row in outcome.rows()]
    write_tables(rows)
    print(table(compact(rows), ["case", "scheme/options", "quantity", "measured", "expected", "tolerance", "pass"]))
    failed = failures(rows)
    for scheme in dict.fromkeys(row["scheme"] for row in rows):
        print(f"{scheme}: {counts([row for row in rows if row['scheme'] == scheme])}")
    print(counts(rows))
    return 1 if failed else 0


def test(entries):
    """For `make test` and `make test-long`: 'ok' and 'FAIL' lines, judged as by `make verify`."""
    failed = 0
    for entry in entries:
        rows = execute(entry, runs.scratch(entry.id)).rows()
        failed += failures(rows)
        for row in rows:
            if row["pass"] != misses.FAILED:
                state = "ok" if row["pass"] in (misses.WITHIN, misses.KNOWN) else "shown"
                known = ", a known miss in its band" if row["pass"] == misses.KNOWN else ""
                print(f"{state} {row['id']} {row['quantity']}: {row['measured']}, expected {row['expected']}, "
                      f"tolerance {row['tolerance']}{known}", flush=True)
    return 1 if failed else 0


def order_of(errors, spacings):
    """Observed order between the coarsest and the finest run that have an error."""
    have = [(e, s) for e, s in zip(errors, spacings) if e is not None and math.isfinite(e) and e > 0]
    if len(have) < 2:
        return "-"
    (coarse, wide), (fine, narrow) = have[0], have[-1]
    return f"{math.log(coarse / fine) / math.log(wide / narrow):.1f}"


def extrapolated(results, spacings):
    """To spacing zero, linearly from the two finest runs: of what has a value expected and goes one way from the third
    finest on."""
    have = [(r.measured, s) for r, s in zip(results, spacings) if r and math.isfinite(r.measured)][-3:]
    last = next(r for r in reversed(results) if r)
    if len(have) < 3 or not math.isfinite(last.expected):
        return "-"
    (a, _), (b, wide), (c, narrow) = have
    if (b - a) * (c - b) <= 0:
        return "-"
    return last._replace(measured=c + (c - b) * narrow / (wide - narrow), kind="shown").words()[0]


def convergence_table(entry, outcomes):
    """One entry at its spacings: the measured figures, the order, what must be reached."""
    heads = [f"{s:.3g}" for s in entry.spacings]
    names = list(dict.fromkeys(r.name for o in outcomes for r in o.results))
    rows = []
    for name in names:
        found = [next((r for r in o.results if r.name == name), None) for o in outcomes]
        last = next(r for r in reversed(found) if r)
        limits = list(dict.fromkeys(r.words()[2] for r in found if r))
        row = {"quantity": name, "order": order_of([r.error() if r else None for r in found], entry.spacings),
               "extrapolated": extrapolated(found, entry.spacings), "expected": last.words()[1],
               "tolerance": ", ".join(limits)}
        for head, r in zip(heads, found):
            row[head] = "-" if r is None else r.words()[0] + ("" if r.passed() is not False else " (!)")
        rows.append(row)
    seconds = {h: "-" if math.isnan(o.seconds) else f"{o.seconds:.3g}" for h, o in zip(heads, outcomes)}
    rows.append(dict(seconds, quantity="run time, s (one process)", order="", extrapolated="", expected="",
                     tolerance=""))
    title = ", ".join(w for w in (entry.label, entry.scheme) if w)
    lines = [f"**{title}** (`{entry.options or 'options of the case'}`), against spacing:", "",
             table(rows, ["quantity"] + heads + ["order", "extrapolated", "expected", "tolerance"])]
    stops = [f"- at {h}: {o.reason}" for h, o in zip(heads, outcomes) if o.reason]
    if len(stops) == len(heads):
        lines = [lines[0].replace(", against spacing:", " stopped:")]
    return "\n".join(lines + ([""] + stops if stops else []))


def convergence(entries, case, jobs, existing):
    chosen = [e for e in entries if e.spacings]
    if not chosen:
        sys.exit(f"runner.py: no entry of {case or 'the list'} has spacings")
    todo = [(e, s, os.path.join(OUTPUT, "convergence", f"{e.id}-{s:.3g}")) for e in chosen for s in e.spacings]
    os.makedirs(os.path.join(OUTPUT, "convergence"), exist_ok=True)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        outcomes = list(pool.map(lambda job: execute(job[0], job[2], f"-spacing {job[1]:.17g}",
                                                     existing.get(os.path.basename(job[2]))), todo))
    for name in dict.fromkeys(e.case for e in chosen):
        tables = []
        for e in chosen:
            if e.case == name:
                tables.append(convergence_table(e, [o for o in outcomes if o.entry is e]))
        text = "\n\n".join(tables + [f"Written by `make convergence CASE={name}` at version {version()}, "
                                     f"{datetime.date.today().isoformat()}. (!): beyond the tolerance. Order: of the "
                                     "error, between the coarsest and the finest run. Extrapolated: to spacing zero, "
                                     "linearly from the two finest, where the last three go one way."])
        print(text)
        runs.results(name, "measured", text)
    return 0


def name_of(row):
    return ", ".join(word for word in (row["case"], row["label"]) if word)


def lines_of(rows):
    """Lines of the table, a quantity each, default and printed scheme beside each other: {entry's name: [cells]}. The
    first line of an entry names it and the options of its run with the default scheme."""
    lines = {}
    for row in rows:
        name, options = name_of(row), " ".join(row["options"].split())
        entry = lines.setdefault(name, {})
        title = "" if entry else f"{name} `{options}`" if row["scheme"] == "default" and options else name
        line = entry.setdefault(row["quantity"],
                                [title, row["quantity"], "-", row["expected"], row["tolerance"], "-", "-"])
        if row["scheme"] == "default":
            line[2], line[5] = row["measured"], row["pass"]
        elif row["scheme"] in cases.SCHEMES:
            line[6] = row["measured"] + (" (!)" if row["pass"] in (misses.KNOWN, misses.FAILED) else "")
    return {name: list(entry.values()) for name, entry in lines.items()}


def lines_in(path):
    """The same, and the words about versions, of the table that is in a file."""
    with open(path, encoding="utf-8") as file:
        text = file.read().partition("<!-- verify -->")[2].partition("<!-- /verify -->")[0]
    lines = {}
    for line in re.findall(r"^\|(.*)\|$", text, re.M)[2:]:
        cells = [cell.strip() for cell in line.split(" | ")]
        if cells[0]:
            lines[cells[0].partition(" `")[0]] = entry = []
        entry.append(cells)
    return lines, re.findall(r"\w+\+? \([\d-]+\)", text.partition("from runs among")[2])


def keep_scheme(lines, old, ran):
    """Into the lines of an entry, what its old ones say of a scheme that is not among those that ran."""
    default, printed = (scheme in ran for scheme in cases.SCHEMES)
    for before in old:
        line = next((line for line in lines if line[1] == before[1]), None)
        measured, word, beside = *(("-", "-") if default else (before[2], before[5])), "-" if printed else before[6]
        if line is None and (measured, beside) != ("-", "-"):
            lines.append(["", before[1], measured, *before[3:5], word, beside])
        elif line and not default:
            line[0], line[2], line[5] = before[0], measured, word
        elif line and not printed:
            line[6] = beside


def side_by_side(rows, path):
    """The table of the rows, with the lines that the file at path has of entries that did not run, and its counts."""
    rows = [row for row in rows if row["scheme"] in cases.SCHEMES]
    lines, versions = lines_in(path)
    names = list(dict.fromkeys(name_of({"case": e.case, "label": e.label}) for e in cases.ENTRIES))
    new = lines_of(rows)
    for name in new:
        keep_scheme(new[name], lines.get(name, []), {row["scheme"] for row in rows if name_of(row) == name})
    lines = [line for name in names for line in new.get(name) or lines.get(name, [])]
    due = {e.id for e in cases.ENTRIES if e.case == rows[0]["case"] and e.scheme in cases.SCHEMES}
    if due <= {row["id"] for row in rows}:
        versions = []  # no figure of a former run is left
    versions = sorted({f"{row['version']} ({row['date']})" for row in rows} | set(versions))
    printed = [line[6].endswith("(!)") for line in lines if "-" not in (line[4], line[6])]
    beside = f" As printed: {printed.count(False)} within tolerance, {printed.count(True)} beyond." if printed else ""
    heads = ["case", "quantity", "default scheme", "expected", "tolerance", "within", "as printed"]
    return (table([dict(zip(heads, line)) for line in lines], heads) +
            f"\n\nDefault scheme: {counts([{'pass': line[5]} for line in lines])}.{beside} Rows with 'known' or (!) "
            "are beyond their tolerance; tests/verify/misses.csv has the bands that hold them. Written by `make "
            f"verify-readme` from runs among {', '.join(versions)}.")


def chosen(case):
    """The table between <!-- chosen --> and <!-- /chosen --> of a case's README, and the same with the figures of
    results.md. Its rows name an entry (case.opts: the one without a label; empty: that above) and a quantity."""
    path = os.path.join(runs.ROOT, "cases", case, "README.md")
    with open(path, encoding="utf-8") as file:
        text = file.read().partition("<!-- chosen -->\n")[2].partition("<!-- /chosen -->")[0].strip()
    if not text:
        return "", ""
    lines, _ = lines_in(runs.results(case, "verify"))
    head, rule, *rows = [[cell.strip() for cell in line[1:-1].split("|")] for line in text.splitlines()]
    columns, label = {"isph": 2, "expected": 3, "tolerance": 4, "within": 5, "as printed": 6}, ""
    for row in rows:
        label = row[0] or label
        name = name_of({"case": case, "label": label.replace("case.opts", "")})
        found = [line for line in lines.get(name, []) if line[1] == row[1]]
        if len(found) != 1:
            sys.exit(f"runner.py: {path} asks for '{row[1]}' of '{label}', which results.md has {len(found)} times")
        row[2:] = [found[0][columns[title]] for title in head[2:]]
    return text, "\n".join("| " + " | ".join(row) + " |" for row in [head, rule] + rows)


def readme():
    """The tables of cases/*/results.md, and what READMEs choose of them. What did not run stays as it is."""
    rows = read_rows()
    if not rows:
        print("runner.py: there is no output/verify/verify.csv of make verify: only the READMEs are written anew")
    for case in dict.fromkeys(entry.case for entry in cases.ENTRIES):
        own = [row for row in rows if row["case"] == case]
        if own:
            runs.results(case, "verify", side_by_side(own, runs.results(case, "verify")))
        new = chosen(case)[1]
        if new:
            runs.replace(os.path.join(runs.ROOT, "cases", case, "README.md"), "chosen", f"\n{new}\n")
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--size", choices=list(SIZES), default="short")
    parser.add_argument("--case", default="")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--from", dest="existing", action="append", default=[], metavar="ID=FOLDER")
    for mode in ("convergence", "readme", "list"):
        parser.add_argument("--" + mode, action="store_true")
    a = parser.parse_args()
    case, _, label = a.case.partition(":")
    entries = [e for e in cases.ENTRIES if (not case or e.case == case) and label in (e.label, "")]
    if not entries:
        sys.exit(f"runner.py: no entry is of {a.case}; there are {', '.join(sorted({e.case for e in cases.ENTRIES}))}")
    existing = dict(pair.split("=", 1) for pair in a.existing)
    if a.list:
        print("\n".join(f"{e.size:6}{e.id:45}{e.options}" for e in entries))
        return 0
    if a.readme:
        return readme()
    if a.convergence:
        return convergence(entries, a.case, max(1, a.jobs), existing)
    sized = [e for e in entries if e.size in SIZES[a.size]]
    if not sized:
        sys.exit(f"runner.py: {a.case} has no entry of size {a.size}; make verify-long runs all")
    return verify(sized, max(1, a.jobs), existing)


if __name__ == "__main__":
    sys.exit(main())
