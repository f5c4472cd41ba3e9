"""The roofline of the step: what each event must at least move and compute, counted from its loops, and the time which
that takes at the bandwidth and the peaks of the machine, measured in the same run. It is a bound, no count of
instructions: candidates that are no neighbours, the finding of cells, what is read twice, and scattered reads of
places and velocities, which mostly hit a cache, are not in it."""
import functools
import subprocess

import h5py
import numpy as np

SAMPLE = 500  # particles whose pairs are counted
SIDES = np.array((40e-3, 40e-3))  # m: the box is periodic
KERNEL = 2 * 1.3  # spacings: support of the kernel; that of the tension's; and from where on from a particle of the
TENSION = 1.75 * KERNEL  # surface none has a normal: 0.9 H deep, the first half a spacing
NORMAL = 0.9 * TENSION / 2 - 0.5
SHARPENED = 2  # means of the curvature that the tension takes
NUMBER = 8  # bytes


def peak(program):
    """Fused multiply-adds: flops a second of one core in single and in double precision."""
    return [float(word) for word in subprocess.run([program], stdout=subprocess.PIPE, check=True).stdout.split()]


@functools.cache
def count(path, spacing):
    """What a checkpoint has for each of its particles, walls and all: particles of the liquid, and with a normal;
    pairs, those of the liquid's rows, those of normals' with the liquid and with other normals within H's support."""
    with h5py.File(path) as file:
        x, liquid = file["position"][...], file["layer"][...] == 0
        surface = (file["surface"][...] == 1) & liquid
    total = dict.fromkeys(("liquid", "normals", "pairs", "liquid_pairs", "tension_pairs", "normal_pairs"), 0.0)
    chosen = np.random.default_rng(1).choice(len(x), min(SAMPLE, len(x)), replace=False)
    for a in chosen:
        d = x - x[a]
        d[:, :2] -= SIDES * np.round(d[:, :2] / SIDES)
        d /= spacing
        r = np.linalg.norm(d, axis=1)
        pairs = np.sum(r < KERNEL) - 1
        total["pairs"] += pairs
        if not liquid[a]:
            continue
        total["liquid"] += 1
        total["liquid_pairs"] += pairs
        if np.min(r[surface], initial=np.inf) > NORMAL:
            continue
        around, skin = d[liquid & (r < TENSION)], d[surface & (r < TENSION + NORMAL)]
        depth = np.linalg.norm(around[:, None] - skin, axis=2).min(axis=1)
        total["normals"] += 1
        total["tension_pairs"] += len(around)
        total["normal_pairs"] += np.sum(depth < NORMAL)
    return {name: value / len(chosen) for name, value in total.items()}


def work(row):
    """{event: (bytes, flops in single, flops in double)} a particle and step. A fused multiply-add is two flops, a
    kernel's value and slope are 16, its value alone 13."""
    liquid, normals, pairs, own = row["liquid"], row["normals"], row["pairs"], row["liquid_pairs"]
    products = row["iterations"] + 1
    return {
        # neighbors/search.c, operators/moments.c. A pair: written as number, slope (4 bytes each) and Laplacian (2);
        # its distance 8, kernel 16, factors 5; sums of W, normal, crowding, six moments and viscosity 48. A particle:
        # place, velocity; density, normal, crowding, moments, acceleration.
        "Neighbors": (10 * pairs + 22 * NUMBER, 29 * pairs, 48 * pairs),
        # operators/divergence.c. A pair: number and slope; both differences 6, products and sums 21, largest jump
        # 6. A particle: place, velocity, B; velocity gradient, divergence, jump.
        "Divergence": (8 * own + 23 * NUMBER * liquid, 0, 33 * own),
        # pressure/source.c, pressure/solve.c: ten numbers in, one out.
        "Source": (11 * NUMBER * liquid, 0, 25 * liquid),
        # pressure/operator.c: a sum in, two parts of the diagonal out.
        "Assemble": (3 * NUMBER, 0, 5),
        # pressure/operator.c: a product reads number and code of a pair, 3 flops; conjugate gradients and both levels
        # pass twelve vectors in an iteration: three products, three sums, from and to eight nodes.
        "Solve": (6 * pairs * products + 12 * NUMBER * row["iterations"], 0,
                  3 * pairs * products + 45 * row["iterations"]),
        # pressure/gradient.c. A pair: number and slope; differences 4, product with the slope 1, sum 6. A particle:
        # place, pressure, B, normal, crowding, density; acceleration.
        "Gradient": (8 * own + 20 * NUMBER * liquid, 0, 11 * own + 40 * liquid),
        # tension/curvature.c, particles with a normal alone. A pair with the liquid: distance 9, kernel 16, phi and its
        # gradient 10. One with a normal: distance 9, kernel 13, moments 56, the mean that sharpens 2, the last one with
        # its slope 11; its weight (4 bytes) is written, and read in each. A particle: place, normal, depth; the fit's
        # eleven numbers; two means and the slope.
        "Tension": ((7 + (1 + SHARPENED) * 11 + 5) * NUMBER * normals + 4 * (1 + SHARPENED) * row["normal_pairs"],
                    16 * row["tension_pairs"] + 13 * row["normal_pairs"],
                    19 * row["tension_pairs"] + (65 + 2 + 11) * row["normal_pairs"]),
        # stepper/shifting.c: lambda, crowding, B, velocity gradient; place and velocity in and out.
        "Shift": (31 * NUMBER * liquid, 0, 60 * liquid),
    }


def table(row):
    """Events of a row of bench.csv (one rank), the dearest first."""
    lines = [f"| {row['size']}, {row['state']}, 1 rank | us a particle and step | bytes | flops, single + double | "
             "at least, us | limited by | share |", "|---|---|---|---|---|---|---|"]
    needed, bounds, rest = work(row), 0.0, row["step"]
    for event in sorted(list(row)[list(row).index("share") + 1:], key=lambda event: -row[event]):
        rest -= row[event]
        if event in needed:
            moved, single, double = needed[event]
            memory, core = 1e-3 * moved / row["triad"], 1e-3 * (single / row["single"] + double / row["double"])
            bounds += max(memory, core)
            lines.append(f"| {event} | {row[event]:.3f} | {moved:.0f} | {single:.0f} + {double:.0f} | "
                         f"{max(memory, core):.3f} | {'memory' if memory > core else 'arithmetic'} | "
                         f"{100 * max(memory, core) / row[event]:.0f} % |")
        elif row[event] >= 0.001:
            lines.append(f"| {event} | {row[event]:.3f} | | | | | |")
    lines += [f"| everything else | {rest:.3f} | | | | | |",
              f"| step | {row['step']:.3f} | | | {bounds:.3f} | | {100 * bounds / row['step']:.0f} % |", "",
              f"The machine: triad {row['triad']:.1f} GB/s, fused multiply-adds {row['single']:.0f} (single) and "
              f"{row['double']:.0f} (double) Gflop/s of one core.",
              f"{row['pairs']:.0f} neighbours a particle, {row['iterations']:.1f} iterations; "
              f"{100 * row['normals']:.0f} % of the particles have a normal, with",
              f"{row['tension_pairs'] / row['normals']:.0f} neighbours each, of which "
              f"{row['normal_pairs'] / row['normals']:.0f} have one."]
    return lines
