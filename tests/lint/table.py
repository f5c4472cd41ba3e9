#!/usr/bin/python3
"""tests/table.txt is whole: every test has a row, every row tests, every folder of src/ a quick test that watches it,
and what is watched exists."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import run  # noqa: E402
import verdict  # noqa: E402

bad = []
rows = run.read_table()
jobs = run.find(rows, run.FOLDERS + ("long", "sanitizers"))
bad += [f"tests/table.txt has no row for {job.name}" for job in jobs if job.row is None]
stems = [job.name.partition("@")[0] for job in jobs]
used = {job.row.pattern for job in jobs if job.row}
bad += [f"the row {row.pattern} is of no test, or rows below it are of all its tests" for row in rows
        if row.pattern not in used]
bad += [f"tests/table.txt: {pattern} has two rows" for pattern in {row.pattern for row in rows}
        if [row.pattern for row in rows].count(pattern) > 1]
watched = {path for row in rows for path in row.watches}
bad += [f"tests/table.txt: {path} is watched and does not exist" for path in sorted(watched)
        if not os.path.exists(os.path.join(run.ROOT, path))]
for folder in sorted(os.listdir(os.path.join(run.ROOT, "src"))):
    path = f"src/{folder}/"
    if os.path.isdir(os.path.join(run.ROOT, path)) and not any(
            path in job.row.watches and job.row.seconds <= run.QUICK for job in jobs if job.row):
        bad.append(f"tests/table.txt: no quick test watches {path}")
verdict.end("table", bad, f"{len(jobs)} jobs of {len(set(stems))} tests, {len(rows)} rows")
