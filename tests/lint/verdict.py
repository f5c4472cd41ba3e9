"""How a lint ends: a FAIL line for each thing it found, or ok with what it looked at."""
import sys


def end(name, bad, looked_at):
    for line in bad:
        print(f"FAIL {name}:", line)
    if not bad:
        print(f"ok {name} ({looked_at})")
    sys.exit(1 if bad else 0)
