#!/usr/bin/python3
"""Values of options, with error bars, from a measured curve: make fit.

    fit.py SCENE.opts CURVE.csv "drop_tension=0.02,0.1;drop_viscosity=1e-3,1e-1" [--column NAME] [--start LEAST,MOST]
           [--jobs N] [--output FOLDER]
    isph-fit ...

CURVE.csv has a head line with time_s and the name of a column of the scene's series. Prints a line for each option, and
writes fit.html. options/python.md says more.
"""
import argparse
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python"))
from isph import tables  # noqa: E402


def numbers(text, what):
    found = [tables.number(word) for word in text.split(",")]
    if len(found) != 2 or found[0] != found[0] or found[1] != found[1]:
        raise tables.Error(f"{what} is {text}; it must have two numbers, as 0.02,0.1.")
    return tuple(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene", metavar="SCENE.opts")
    parser.add_argument("curve", metavar="CURVE.csv")
    parser.add_argument("free", metavar="OPTION=LEAST,MOST[;...]")
    parser.add_argument("--column")
    parser.add_argument("--start", default="0,0")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--output")
    words = parser.parse_args()
    import isph
    free = {name.strip().lstrip("-"): numbers(ends, f"the range of {name}")
            for name, _, ends in (part.partition("=") for part in words.free.split(";") if part.strip())}
    found = isph.fit(words.scene, words.curve, free, column=words.column, start=numbers(words.start, "--start"),
                     jobs=words.jobs, output=words.output)
    print(f"{found}\nCurve beside curve: {found.page}")


if __name__ == "__main__":
    with tables.polite("fit.py"):
        main()
