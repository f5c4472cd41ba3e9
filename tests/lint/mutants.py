#!/usr/bin/python3
"""The edits of tests/mutants apply to the present sources, each exactly once, and the tests they name are there."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "mutants"))
import edits  # noqa: E402
import verdict  # noqa: E402

mutants = edits.read()
wrong = edits.mistakes(mutants)
verdict.end("mutants", wrong, f"{len(mutants)} edits apply")
