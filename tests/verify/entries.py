#!/usr/bin/python3
"""The entries of size test of tests/verify/cases.py: the physics of `make test`."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import runner  # noqa: E402

sys.argv[1:] = ["--test", "--size", "test"]
sys.exit(runner.main())
