#!/usr/bin/python3
"""The entries of tests/verify/cases.py that `make verify` runs, every result judged."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "verify"))
import runner  # noqa: E402

sys.argv[1:] = ["--test", "--size", "short"]
sys.exit(runner.main())
