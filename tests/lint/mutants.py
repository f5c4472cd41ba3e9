#!/usr/bin/python3
"""The edits of tests/mutants apply to the present sources, each exactly once, the tests they name are there, and one of
them runs after a change of the file."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "mutants"))
import edits  # noqa: E402
import verdict  # noqa: E402

mutants = edits.read()
wrong = edits.mistakes(mutants)
wrong += [f"{m.name}: a change of {m.file} asks for none of {', '.join(m.tests)}: see tests/table.txt"
          for m in edits.unwatched(mutants)]
verdict.end("mutants", wrong, f"{len(mutants)} edits apply")
