#!/usr/bin/python3
"""compare.py [--ranks N] FILE.h5: every solver on the state of a snapshot or checkpoint of a run of your own, and which
to take; make compare-solvers STATE=FILE.h5. The options of the run are in the file."""
import argparse
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

PROGRAM = os.path.join(runs.ROOT, "output", "build", "tests", "solvers", "compare")
# what does not concern the system, or would ask for files
LEFT_OUT = ("-options_file", "-output_", "-restart", "-log_", "-ksp_view", "-ksp_monitor", "-ksp_type", "-pc_type",
            "-packing_relaxation", "-spectrum")


def options_of(path):
    """The options of the run that wrote a file, one a line: from its attributes, or from the folder it is in."""
    head = runs.head(path)
    if "options" in head:
        text = head["options"].decode()
    else:
        with open(os.path.join(os.path.dirname(os.path.abspath(path)), "options.opts"), encoding="utf-8") as file:
            text = file.read()
    lines = [line for line in text.splitlines() if line.startswith("-") and not line.startswith(LEFT_OUT)]
    if not any(line.startswith(("-time_end", "-steps_max")) for line in lines):
        lines.append("-steps_max 1")
    return "\n".join(lines) + "\n"


def compare(options, state="", ranks=1):
    """Runs the program with a text of options; the finished process."""
    with tempfile.TemporaryDirectory(prefix="isph-solvers-") as folder:
        path = os.path.join(folder, "run.opts")
        with open(path, "w", encoding="utf-8") as file:
            file.write(options)
        command = ["mpiexec", "-n", str(ranks)] if ranks > 1 else []
        command += [PROGRAM, "-options_file", path] + (["-state", os.path.abspath(state)] if state else [])
        return subprocess.run(command, cwd=runs.ROOT, env=dict(os.environ, **runs.mpi.ANY), stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, check=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split(":", maxsplit=1)[0])
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("state", help="a snapshot or checkpoint")
    arguments = parser.parse_args()
    if not os.path.isfile(arguments.state):
        sys.exit(f"compare.py: STATE={arguments.state} is no file; give a snapshot or checkpoint of a run")
    process = compare(options_of(arguments.state), arguments.state, arguments.ranks)
    print(process.stdout, end="")
    print(process.stderr, end="", file=sys.stderr)
    sys.exit(process.returncode)


if __name__ == "__main__":
    main()
