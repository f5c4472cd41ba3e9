#!/usr/bin/python3
"""STL files as programs, editors and accidents make them: read as the surface they mean, or refused with one sentence.
On 1 to 4 ranks; no signal, no trace, no hang.

    tests/faults/stl.py [--number 60] [--triangles 1000000]

Without arguments a short part, as in make test. The last line tells how many were tried, read and refused."""
import argparse
import os
import random
import re
import shlex
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

os.environ.setdefault("ASAN_OPTIONS", "detect_leaks=0")  # leaks of Open MPI and HDF5 are not ours

SCENE = """-spacing 0.1 -box_lower 0,0,0 -box_upper 1,1,1 -bodies a -a_shape stl -gravity 0,0,-1 -steps_max 1 -dry_run
 -progress_interval 0 """
SECONDS = 300  # a run of these takes less than one; the machine may be busy
FAST = 30  # s of processor time for a million triangles: takes 4, took 70 once


def sphere(rings, radius=0.303, centre=(0.51, 0.52, 0.53)):
    """Triangles [n][3][3] of a sphere."""
    polar, around = np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings + 1)
    p = np.stack([np.outer(np.sin(polar), np.cos(around)), np.outer(np.sin(polar), np.sin(around)),
                  np.outer(np.cos(polar), np.ones_like(around))], -1) * radius + centre
    p[:, -1], p[0], p[-1] = p[:, 0], p[0, 0], p[-1, 0]
    a, b, c, d = p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]
    t = np.concatenate([np.stack([a, b, c], -2).reshape(-1, 3, 3), np.stack([a, c, d], -2).reshape(-1, 3, 3)])
    flat = (t[:, 0] == t[:, 1]).all(1) | (t[:, 1] == t[:, 2]).all(1) | (t[:, 2] == t[:, 0]).all(1)
    return t[~flat].astype("<f4")


def binary(t, header=b"made by a program", count=None):
    record = np.zeros(len(t), [("normal", "<f4", 3), ("corner", "<f4", (3, 3)), ("more", "<u2")])
    record["corner"] = t
    return header.ljust(80, b"\0")[:80] + np.array(len(t) if count is None else count, "<u4").tobytes() + \
        record.tobytes()


def text(t, name=b"part", form="%.9g", end=b"\n"):
    lines = [b"solid " + name]
    for corners in t:
        lines += [b"  facet normal 0 0 0", b"    outer loop"]
        lines += [("      vertex " + " ".join(form % x for x in corner)).encode() for corner in corners]
        lines += [b"    endloop", b"  endfacet"]
    return end.join(lines + [b"endsolid " + name, b""])


# --- what means the same surface ---


def noisy(t, rng):
    """As if written by a program that rounds each corner anew."""
    return t * (1 + 1e-7 * np.random.default_rng(rng.randrange(99)).uniform(-1, 1, t.shape)).astype("<f4")


def some_flipped(t, rng):
    """Some look inwards."""
    return np.where((np.arange(len(t)) % rng.randint(2, 5) == 0)[:, None, None], t[:, ::-1], t)


SAME = {
    "binary": lambda t, rng: binary(t), "text": lambda t, rng: text(t),
    "binary with solid": lambda t, rng: binary(t, b"solid vertex facet"),
    "vertex in the name": lambda t, rng: text(t, b"vertex"),
    "a sentence as name": lambda t, rng: text(t, b"the facet normal of outer loop vertex 1 2 3 solid endsolid"),
    "no name": lambda t, rng: text(t, b""), "capitals": lambda t, rng: text(t).upper(),
    "first capitals": lambda t, rng: text(t).title(), "byte-order mark": lambda t, rng: b"\xef\xbb\xbf" + text(t),
    "leading blanks": lambda t, rng: b"\n \t\n  " + text(t), "DOS": lambda t, rng: text(t, end=b"\r\n"),
    "mark, blanks, DOS": lambda t, rng: b"\xef\xbb\xbf\r\n " + text(t, end=b"\r\n"),
    "old Macintosh": lambda t, rng: text(t, end=b"\r"), "tabs": lambda t, rng: text(t).replace(b" ", b"\t"),
    "trailing blanks": lambda t, rng: text(t, end=b"  \n") + b"\n\n", "exponents": lambda t, rng: text(t, form="%+.8E"),
    "two solids": lambda t, rng: text(t[::2], b"one") + text(t[1::2], b"two"),
    "shuffled": lambda t, rng: binary(rng.sample(list(t), len(t))),
    "each twice": lambda t, rng: binary(np.concatenate([t, t])),
    "each twice, turned": lambda t, rng: text(np.repeat(np.roll(t, 1, 1), 2, 0)),
    "each three times": lambda t, rng: binary(np.repeat(t, 3, 0)),
    "one twice": lambda t, rng: binary(np.concatenate([t, t[5:6]])),
    "points and lines": lambda t, rng: binary(np.concatenate([t, t[:9, [0, 0, 0]], t[:9, [0, 1, 1]]])),
    "an inner wall": lambda t, rng: binary(np.concatenate([t, t[:7] - 0.01, t[:7, ::-1] - np.float32(0.01)])),
    "rounded anew": lambda t, rng: binary(noisy(t, rng)), "inside out": lambda t, rng: binary(t[:, ::-1]),
    "some inside out": lambda t, rng: binary(some_flipped(t, rng)),
}

# --- what is none ---


def broken(data, rng):
    """A word or number of a text that is none."""
    old, new = rng.choice(((b"vertex", b"vertx"), (b"endloop", b""), (b"facet", b"face"), (b"endfacet", b"endfacet 7"),
                           (b"outer loop", b"outer"), (b"0.", b"O."), (b"0.", b"0,"), (b"endsolid", b""),
                           (b"vertex", b"vertex vertex"), (b"facet normal", b"facet normal x"), (b"0.", b"0 0 ."),
                           (b"vertex 0", b"vertex 0 0"), (b"facet", b"facet\0"), (b"endsolid", b"endsolid\n1")))
    parts = data.split(old)
    k = rng.randrange(1, len(parts))
    return old.join(parts[:k]) + new + old.join(parts[k:])


def number(t, rng, value):
    t = t.astype("f8")
    t[rng.randrange(len(t)), rng.randrange(3), rng.randrange(3)] = value
    return t


def missing(t, rng, count):
    return np.delete(t, rng.sample(range(len(t)), count), 0)


def far_body(t, rng):
    """Two triangles missing; a second body far away must not hide that."""
    return np.concatenate([missing(t, rng, 2), t * np.float32(1000) + np.float32(3e4)])


NONE = {
    "cut": lambda t, rng: binary(t)[:rng.randrange(84, 84 + 50 * len(t))],
    "cut in the header": lambda t, rng: binary(t)[:rng.randrange(84)],
    "text cut": lambda t, rng: text(t)[:-rng.randrange(20, 5000)], "broken text": lambda t, rng: broken(text(t), rng),
    "too many": lambda t, rng: binary(t, count=len(t) + rng.choice((1, 1000, 2**31, 2**32 - 1 - len(t)))),
    "too few": lambda t, rng: binary(t, count=rng.randrange(len(t))), "longer": lambda t, rng: binary(t) + b"\0" * 7,
    "none": lambda t, rng: binary(t[:0]), "empty": lambda t, rng: b"", "solid": lambda t, rng: b"solid",
    "no triangles": lambda t, rng: b"solid a\nendsolid a\n", "zeros": lambda t, rng: bytes(rng.randrange(1, 9999)),
    "noise": lambda t, rng: bytes(rng.randrange(256) for _ in range(3000)),
    "text noise": lambda t, rng: b"solid " + bytes(rng.randrange(256) for _ in range(3000)),
    "nan": lambda t, rng: binary(number(t, rng, np.nan)), "infinite": lambda t, rng: binary(number(t, rng, -np.inf)),
    "huge": lambda t, rng: binary(number(t, rng, 1e30)), "text nan": lambda t, rng: text(number(t, rng, np.nan)),
    "text huge": lambda t, rng: text(number(t, rng, rng.choice((1e300, -1e300, np.inf)))),
    "all huge": lambda t, rng: binary(t * np.float32(1e12)), "one point": lambda t, rng: binary(t * 0),
    "a plane": lambda t, rng: binary(t * [1, 1, 0] + [0, 0, 0.5]),
    "one missing": lambda t, rng: binary(missing(t, rng, 1)), "some missing": lambda t, rng: text(missing(t, rng, 9)),
    "two missing, a far body": lambda t, rng: binary(far_body(t, rng)),
    "each both ways": lambda t, rng: binary(np.concatenate([t, t[:, ::-1]])),
    "one triangle": lambda t, rng: text(t[:1]), "a corner moved": lambda t, rng: binary(number(t, rng, 0.45)),
}


def flipped(t, rng):
    """Some bytes changed: a surface with a bump, or none."""
    data = bytearray(rng.choice((binary, text))(t))
    for _ in range(rng.randint(1, 3)):
        data[rng.randrange(len(data))] = rng.randrange(256)
    return bytes(data)


def attempt(data, ranks):
    """(exit code or None, particles or None, standard error, processor seconds)."""
    path = runs.scratch("part.stl")
    with open(path, "wb") as file:
        file.write(data)
    command = (["mpiexec", "-n", str(ranks)] if ranks > 1 else []) + [runs.PROGRAM] + \
        shlex.split(SCENE + f"-a_file {path} -output_dir {runs.scratch('run')}")
    environment = runs.environment(ranks)
    began = sum(os.times()[2:4])
    try:
        done = subprocess.run(command, cwd=runs.ROOT, env=environment, timeout=SECONDS, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    except subprocess.TimeoutExpired:
        return None, None, "", 0
    found = re.search(r"a: (\d+) particles", done.stdout.decode(errors="replace"))
    return done.returncode, found and int(found[1]), done.stderr.decode(errors="replace"), sum(os.times()[2:4]) - began


def sentence(code, err):
    lines = [line for line in err.splitlines() if line.startswith("isph: error: ")]
    bad = "PETSC ERROR" in err or "Sanitizer" in err or "runtime error" in err
    return code is not None and 0 < code < 126 and len(lines) == 1 and not bad


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--number", type=int, default=16)
    parser.add_argument("--triangles", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)
    surface, tally = sphere(12), {"read": 0, "refused": 0, "failed": 0}
    code, whole, err, _ = attempt(binary(surface), 1)
    runs.check(code == 0 and whole, "stl", f"code {code}: {err[-300:]}")
    tries = [(name, make, True) for name, make in SAME.items()] + [(name, make, False) for name, make in NONE.items()]
    rng.shuffle(tries)
    tries += [("bytes changed", flipped, None)] * max(0, arguments.number - len(tries))
    for k, (name, make, same) in enumerate(tries[:arguments.number]):
        ranks = 1 + k % 4
        code, particles, err, _ = attempt(make(surface, rng), ranks)
        read = code == 0 and (particles == whole if same else same is None)
        refused = same is not True and sentence(code, err)
        tally["read" if read else "refused" if refused else "failed"] += 1
        if not read and not refused:
            runs.check(False, f"stl {name} on {ranks}",
                       f"code {code}, {particles} particles of {whole}: {err[-400:]!r}")
    runs.check(not tally["failed"], "stl_files")
    if arguments.triangles:
        fine = sphere(int((arguments.triangles / 4)**0.5))
        for name, data in (("binary", binary(fine)), ("text", text(fine))):
            code, particles, err, seconds = attempt(data, 1)
            print(f"{len(fine)} triangles, {name}: {seconds:.1f} s")
            runs.check(code == 0 and particles and seconds < FAST, f"many_triangles_{name}",
                       f"code {code}, {seconds:.1f} s, {particles} particles: {err[-300:]}")
    print(f"{sum(tally.values())} STL files tried: {tally['read']} read, {tally['refused']} refused, "
          f"{tally['failed']} failed")
    runs.done()


main()
