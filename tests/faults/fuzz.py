#!/usr/bin/python3
"""Mutated option files and command lines. Each one runs its one step, or ends before it with one sentence and a
non-zero code; none crashes, hangs, takes much memory, or runs with an option that nothing reads.

    tests/faults/fuzz.py [--number 2000] [--seed 1]

Without arguments a short part, as in make test. The last lines tell how many ran and how many were refused."""
import argparse
import json
import os
import random
import re
import resource
import shlex
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

CPU = 60  # s; a run of these takes less than one
MEMORY = 2 << 30  # bytes
LINE = 160  # characters of a command line that is reported

COMMON = "-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 1,1 -gravity 0,-9.81 "
SCENES = [
    COMMON + "-box_x periodic -box_ymin wall -bodies film,drop -film_upper 1,0.3 -film_tension 1 -film_viscosity 0.1 "
    "-drop_shape sphere -drop_radius 0.15 -drop_center 0.5,0.55 -drop_velocity 1,-2 -drop_density 900 "
    "-time_cfl 0.3 -time_end 0.1 -snapshot_interval 0.05 -gauge_points 0.5,0.1 -snapshot_double",
    COMMON + "-box_x symmetry -box_ymin wall -bodies a -a_shape ellipsoid -a_radii 0.3,0.2 -a_center 0.5,0.5 "
    "-a_velocity_type rotation -a_rotation_rate 2 -kernel_type wendland_c2 -kernel_ratio 1.4 -time_step 1e-3 "
    "-time_end 1 -scheme density_invariant -ksp_type cg -pc_type jacobi -ksp_rtol 1e-4",
    COMMON + "-box_x wall -box_y wall -box_ymax_velocity 1,0 -bodies a -a_viscosity 100 -viscosity_form morris "
    "-viscosity_solver implicit -viscous_ksp_rtol 1e-6 -time_end 0.1 -packing_jitter 0.2 -checkpoint_interval 0.05",
    COMMON + "-box_x periodic -bodies a -a_shape wave -a_upper 1,0.5 -a_wave_amplitude 0.05 -a_tension 0.1 "
    "-tension_type cahn_hilliard -box_ymin wall -time_step_max 1e-3 -shifting 1 "
    "-pressure_gradient symmetric -time_end 0.1",
    "-spacing 0.1 -box_lower 0,0,0 -box_upper 1,1,1 -box_x periodic -box_y symmetry -box_zmin wall "
    "-gravity 0,0,-9.81 -bodies film,drop -film_upper 1,1,0.4 -drop_shape sphere -drop_radius 0.2 "
    "-drop_center 0.5,0.5,0.75 -drop_velocity 0,0,-1 -time_end 0.1 -packing_type poisson "
    "-packing_seed 3 -sort_interval 4",
]
VALUES = ["", "0", "-0", "-1", "1", "2", "3", "7", "1e-300", "1e300", "-1e300", "1e400", "nan", "inf", "-inf", "1e-9",
          "1e9", "2147483647", "2147483648", "-2147483649", "99999999999999999999",
          "0x10", "1e", "1,2", "1,2,3,4", ",", ",,",
          "1,,2", "a", "true", "no", "perhaps", "%s%n", "$(id)", "../..", "/", "\u00e9", "x" * 300,
          "1;2", "0,0,0", "0,0",
          "1e-12,1e-12", "5cm,0", "0.1 m", "3cP", "2ms", "1,2mm",
          "40deg", "1e400mm", "mm", "wall", "sphere", "all", "default", "-", "--", "1 2", "\t", "none", "lu", "fgmres"]
TAIL = " -steps_max 1 -progress_interval 0 -output_overwrite"


def pairs(scene):
    """Options as [name, value or None]."""
    found = []
    for word in shlex.split(scene):
        if re.match(r"-[A-Za-z]", word):
            found.append([word, None])
        else:
            found[-1][1] = word
    return found


def mutate_name(name, rng):
    k = rng.randrange(1, len(name))
    other = rng.choice("abcdefghijklmnopqrstuvwxyz_0")
    return rng.choice([name[:k] + name[k + 1:], name[:k] + other + name[k:], name[:k] + other + name[k + 1:]])


def mutate_value(value, rng):
    """Another value; numbers are also scaled, negated, cut."""
    numbers = (value or "").split(",")
    if rng.random() < 0.5 and re.fullmatch(r"[-+.e0-9]+", numbers[0]):
        k = rng.randrange(len(numbers))
        how = rng.randrange(5)
        if how == 0:
            numbers[k] = repr(float(numbers[k]) * 10.0**rng.randint(-12, 12))
        elif how == 1:
            numbers[k] = repr(-float(numbers[k]))
        elif how == 2:
            numbers[k] = rng.choice(VALUES)
        elif how == 3:
            del numbers[k]
        else:
            numbers.insert(k, rng.choice(numbers))
        return ",".join(numbers)
    return rng.choice(VALUES)


def mutate(options, rng):
    """Changes one to three things; the names that were made up."""
    made_up = []
    for _ in range(rng.choice((1, 1, 2, 3))):
        k, how = rng.randrange(len(options)), rng.random()
        if how < 0.6:
            options[k][1] = mutate_value(options[k][1], rng)
        elif how < 0.75:
            options[k][0] = mutate_name(options[k][0], rng)
            made_up.append(options[k][0])
        elif how < 0.85 and len(options) > 1:
            del options[k]
        elif how < 0.92:
            other = rng.randrange(len(options))
            options[k][1], options[other][1] = options[other][1], options[k][1]
        else:
            options.insert(rng.randrange(len(options) + 1), [options[k][0], mutate_value(options[k][1], rng)])
    return [name for name in made_up if any(name == o[0] for o in options)]


def mutate_text(text, rng):
    """Damages an options file: cut short, bytes changed, quotes left open, lines joined, itself included."""
    how = rng.randrange(7)
    k = rng.randrange(len(text))
    if how == 0:
        return text[:k]
    if how == 1:
        return text[:k] + bytes([rng.randrange(256)]) + text[k + 1:]
    if how == 2:
        return text[:k] + rng.choice((b'"', b"'")) + text[k:]
    if how == 3:
        return text.replace(b"\n", rng.choice((b" ", b"\r\n", b"\r", b"\n\n#", b"\0")), rng.randint(1, 9))
    if how == 4:
        return text + b"-options_file " + rng.choice((b"self.opts", b"/nowhere.opts", b"/", b"")) + b"\n"
    if how == 5:
        return text[:k] + bytes(rng.randrange(256) for _ in range(rng.randint(1, 50))) + text[k:]
    return text[:k] + rng.choice((b"x" * 5000, b"# ", b"-", b"\\", b"=", b"{", b"-a -b -c ")) + text[k:]


def limits():
    resource.setrlimit(resource.RLIMIT_CPU, (CPU, CPU))
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def attempt(arguments, folder):
    """The exit code (None: it hung) and standard error of one run."""
    environment = dict(runs.environment(), OMPI_MCA_ess_singleton_isolated="1")
    command = [runs.PROGRAM] + arguments + shlex.split(TAIL) + ["-output_dir", os.path.join(folder, "run"),
                                                               "-packing_cache", ""]
    try:
        process = subprocess.run(command, cwd=folder, env=environment, timeout=20 * CPU, stdin=subprocess.DEVNULL,
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=limits, check=False)
        return process.returncode, process.stderr.decode(errors="replace"), process.stdout.decode(errors="replace")
    except subprocess.TimeoutExpired:
        return None, "", ""


def known(scenes, folder):
    """The names of the options of scenes."""
    names, path = set(), os.path.join(folder, "known.json")
    for scene in scenes:
        attempt(shlex.split(scene) + ["-options_json", path], folder)
        words = shlex.split(scene)
        bodies = words[words.index("-bodies") + 1].split(",")
        with open(path, encoding="utf-8") as file:
            for option in json.load(file)["options"]:
                names.update(option["name"].replace("<body>", body) for body in bodies)
    return names


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--number", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)
    folder = runs.scratch("fuzz")
    os.mkdir(folder)
    for scene in SCENES:
        code, err, _ = attempt(shlex.split(scene), folder)
        runs.check(code == 0, "unmutated", f"code {code}: {err.strip()[:300]} of {scene[:LINE]}")
    names = known(SCENES, folder)
    tally = {"ran": 0, "refused": 0, "failed": 0}
    for number in range(arguments.number):
        options, made_up = pairs(rng.choice(SCENES)), []
        as_file, damaged = rng.random() < 0.5, False
        if rng.random() < 0.8:
            made_up = mutate(options, rng)
        else:
            as_file = damaged = True
        words = [word for pair in options for word in pair if word is not None]
        if any("\0" in word for word in words):
            continue
        if as_file:
            text = "".join(f"{name} {value if value is not None else ''}\n" for name, value in options).encode()
            text = mutate_text(text, rng) if damaged else text
            with open(os.path.join(folder, "self.opts"), "wb") as file:
                file.write(text)
            words = ["-options_file", "self.opts"]
        code, err, _ = attempt(words, folder)
        lines = [line for line in err.split("\n") if line.strip()]
        refused = code is not None and 0 < code < 126 and len(lines) == 1 and lines[0].startswith("isph: error: ")
        late = refused and re.search(r"stopped at .* step [1-9]", lines[0])
        ignored = code == 0 and [name for name in made_up if name not in names]
        if (refused and not late) or (code == 0 and not ignored):
            tally["ran" if code == 0 else "refused"] += 1
            continue
        tally["failed"] += 1
        shown = shlex.join(words) if not as_file else repr(text)
        runs.check(False, f"fuzz_{number}",
                   f"code {code}, ignored {ignored or 'none'}: {err.strip()[:300]!r} of {shown}")
    runs.check(tally["failed"] == 0 and tally["ran"] + tally["refused"] > 0, "fuzz")
    print(f"{sum(tally.values())} tried: {tally['ran']} ran, {tally['refused']} refused with a sentence, "
          f"{tally['failed']} failed")
    runs.done()


main()
