#!/usr/bin/python3
"""The entries of tests/verify/cases.py that `make verify` runs besides those of `make test`, each entry a part."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "verify"))
import cases  # noqa: E402
import runner  # noqa: E402
import runs  # noqa: E402

ENTRIES = {entry.id: entry for entry in cases.ENTRIES if entry.size == cases.SHORT}
sys.exit(runner.test([ENTRIES[part] for part in runs.parts(*ENTRIES)]))
