#!/usr/bin/env python3
"""What the events of a step cost beside stored figures, so that no change spends time unseen.

  events.py [--only TEXT] [--out FOLDER]   runs scenes of variants.py; fails if an event became more than 15 % dearer
  events.py --readme                       the last run's figures become the stored ones, events.csv beside this file,
                                           and the README's table

A figure is the processor time of an event that -log_view has, over that of a product of the solver in the same run, so
that another processor and what else it does matter little; for SphSolve it is the time of a product over that of a
fused multiply-add at the peak, for each particle. It is the least of some turns."""
import os
import sys

import bench
import report
import states
import variants

STORED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "events.csv")
SCENES = ("impact, quarter, 0.5 mm", "impact, graded quarter, 0.25 to 1 mm", "impact, rings, 0.125 mm")
TURNS = 3
DEARER = 1.15
LEAST = 0.02  # of the step: events below are not judged


def figures(folder, scene):
    """{event: figure} of the events of one run that take a part of its step."""
    options, _, number = variants.SCENES[scene]
    run = bench.take(folder, [*options, "-restart", variants.start(folder, scene, os.path.join(states.ROOT, "isph"))],
                     number)
    if not run:
        sys.exit(1)  # 'take' has said why
    multiply_add = 2 / bench.roofline.peak(bench.built(folder, "peak"))[1]  # s
    product = run.event("SphSolve")[0] / (run.iterations + 1)
    return {name: (product / run.number / run.particles / multiply_add if name == "SphSolve" else seconds / product)
            for name, seconds in run.events().items() if seconds > LEAST * run.seconds}


def measure(folder, scene):
    """Rows of the table of a scene: the least of each event."""
    turns = [figures(folder, scene) for _ in range(TURNS)]
    return [{"scene": scene, "event": name, "figure": min(turn[name] for turn in turns)}
            for name in turns[0] if all(name in turn for turn in turns)]


def stored():
    """{(scene, event): figure}"""
    rows = report.load(STORED) if os.path.exists(STORED) else []
    return {(row["scene"], row["event"]): row["figure"] for row in rows}


def text(rows, known):
    lines = [[row["scene"], row["event"], f"{row['figure']:.2f}",
              f"{row['figure'] / known[key]:.2f}" if (key := (row["scene"], row["event"])) in known else ""]
             for row in rows]
    return "\n".join(report.grid(["scene", "event", "figure", "over the stored one"], lines)) + "\n"


def dearer(rows, known):
    """Sentences about the events that cost more than their stored figures allow."""
    return [f"{row['event']} takes {row['figure'] / known[key]:.2f} times its stored figure in: {row['scene']}"
            for row in rows if row["figure"] > DEARER * known.get(key := (row["scene"], row["event"]), float("inf"))]


def main():
    arguments = variants.asked(__doc__)
    table = os.path.join(arguments.out, "events.csv")
    if arguments.readme:
        rows = report.load(table)
        report.insert("events", text(rows, stored()))
        report.save(STORED, rows)
        return
    os.makedirs(os.path.join(arguments.out, "states"), exist_ok=True)
    rows = [row for scene in SCENES if arguments.only in scene for row in measure(arguments.out, scene)]
    report.save(table, rows)
    print(text(rows, stored()))
    found = dearer(rows, stored())
    print("\n".join(found) or "no event became more than 15 % dearer")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
