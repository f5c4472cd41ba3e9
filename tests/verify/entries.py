#!/usr/bin/python3
"""The entries of size test of tests/verify/cases.py: the physics of `make test`, each entry a part."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import cases  # noqa: E402
import runner  # noqa: E402
import runs  # noqa: E402

ENTRIES = {entry.id: entry for entry in cases.ENTRIES if entry.size == cases.TEST}
sys.exit(runner.test([ENTRIES[part] for part in runs.parts(*ENTRIES)]))
