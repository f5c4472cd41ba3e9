#!/usr/bin/python3
"""What waves lose where the spacing grows: hump.opts with one spacing, and fine up to 1.3 m only.

    reflection.py [--spacing 2.5e-3] [--ratio 2 4]

Prints how far the flow along the tank, in slabs 0.1 m wide before 1.3 m, differs from that with one spacing, over the
largest flow there: before 1.1 s, when nothing that came back from 1.3 m can be there, and after. The default takes ten
minutes of one core.
"""
import argparse
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "..", "..")
sys.path[:0] = [os.path.join(ROOT, "tests"), os.path.join(ROOT, "tests", "verify")]
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402

PLACES = (0.7, 0.8, 0.9, 1.0)  # m
WIDTH = 0.1  # m
BACK = 1.1  # s


def flow(spacing, ratio):
    """Times (s) and the flow (m2/s) through the slabs, [times][places]."""
    graded = f"-spacing_coarse {ratio * spacing} -fine near -near_upper 1.3,0.16" if ratio > 1 else ""
    folder = runs.run(f"-options_file {HERE}/hump.opts -spacing {spacing} {graded}", f"reflection_{ratio:g}",
                      timeout=3600)
    times, flows = [], []
    for time, head, f in physics.snapshots(folder):
        volume, x = physics.volumes(head, f), f["position"][:, 0]
        inside = np.abs(x[:, None] - PLACES) < WIDTH / 2
        times.append(time)
        flows.append((volume * f["velocity"][:, 0]) @ inside / WIDTH)
    return np.array(times), np.array(flows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--spacing", type=float, default=2.5e-3)
    parser.add_argument("--ratio", type=float, nargs="*", default=[2, 4])
    arguments = parser.parse_args()
    times, one = flow(arguments.spacing, 1)
    for ratio in arguments.ratio:
        apart = np.abs(flow(arguments.spacing, ratio)[1] - one) / np.abs(one).max(axis=0)
        for when, part in ((f"to {BACK} s", times < BACK), (f"from {BACK} s on", times >= BACK)):
            figures = ", ".join(f"{100 * value:.1f} %" for value in apart[part].max(axis=0))
            print(f"ratio {ratio:g}, {when}: {figures} at {', '.join(map(str, PLACES))} m")


if __name__ == "__main__":
    main()
