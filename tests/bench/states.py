"""States for the benchmark: a checkpoint of the quarter of the drop impact, mirrored in x = 0 and y = 0, is the same
moment of the whole box, four times the particles. What is measured from it is a true mid-impact state, not a model."""
import glob
import os
import shutil
import struct
import subprocess

import h5py
import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CASE = os.path.join(ROOT, "cases/drop_impact/case.opts")
QUARTER = ["-options_file", os.path.join(ROOT, "options/quarter.opts")]
# The states: options of the quarter's run, and which state it continues.
STATES = {
    "rest": (["-time_start", "0", "-time_end", "1", "-steps_max", "10"], None),
    "splash": (["-time_end", "5e-3"], None),
    "crater": (["-time_end", "15e-3"], "splash"),
}

SEAL_MAGIC = 0x31304C4145534853  # see src/storage/checksum.c
MASK = np.uint64(0xFFFFFFFFFFFFFFFF)
POINTS = ("position", "velocity")
IDENTITIES = ("id", "parent")


def _mix(z):
    """SplitMix64's output function, as in src/storage/checksum.c."""
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def seal(path):
    """Appends magic, length and checksum to a finished file."""
    data = open(path, "rb").read()
    words = np.frombuffer(data + b"\0" * (-len(data) % 8), dtype="<u8")
    with np.errstate(over="ignore"):
        places = np.arange(1, len(words) + 1, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
        total = int(np.sum(_mix(words ^ _mix(places)), dtype=np.uint64))
    with open(path, "ab") as file:
        file.write(struct.pack("<3Q", SEAL_MAGIC, len(data), total))


def mirrored(name, values, signs, turn):
    """The values of one quarter: points and vectors change sign, identities go on counting."""
    if name in POINTS:
        return values * np.array([signs[0], signs[1], 1.0])
    return values + turn if name in IDENTITIES else values


def mirror(source, target):
    """Writes the whole box's checkpoint from that of the quarter 0 <= x, 0 <= y."""
    partial = target + ".tmp"
    shutil.copyfile(source, partial)
    with h5py.File(partial, "r+") as file:
        n = int(file["position"].shape[0])
        step = int(np.max(file["id"])) + 1
        for name in list(file):
            values = file[name][...]
            if values.shape[0] != n or name == "counts":
                continue
            parts = [mirrored(name, values, signs, q * step)
                     for q, signs in enumerate(((1, 1), (-1, 1), (1, -1), (-1, -1)))]
            attributes = dict(file[name].attrs)
            del file[name]
            file[name] = np.concatenate(parts).astype(values.dtype)
            file[name].attrs.update(attributes)
        del file["counts"]
        file["counts"] = np.array([4 * n], dtype=np.int64)
        file.attrs.modify("particles", np.int64(4 * n))
        file.attrs.modify("ranks", np.int64(1))
        del file.attrs["scene_identity"]  # the quarter's; without one a restart takes it to be that of the run
    seal(partial)
    os.replace(partial, target)


def scene(folder, state):
    """Options of the whole box in a state: the case, at rest without its drop."""
    if state != "rest":
        return ["-options_file", CASE]
    path = os.path.join(folder, "film.opts")
    with open(CASE, encoding="utf-8") as case, open(path, "w", encoding="utf-8") as film:
        film.writelines(line for line in case if not line.startswith(("-drop_", "-bodies", "-time_")))
        film.write("-bodies film\n")
    return ["-options_file", path]


def reach(program, options, target, env):
    """Runs the options; the last checkpoint becomes the file 'target'."""
    run = target.removesuffix(".h5") + "_run"
    print(f"state {os.path.basename(target)}", flush=True)
    subprocess.run([program, *options, "-snapshot_interval", "1", "-output_dir", run, "-output_overwrite"], env=env,
                   cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    shutil.copyfile(sorted(glob.glob(os.path.join(run, "checkpoint_*.h5")))[-1], target)
    shutil.rmtree(run)


def make(program, folder, spacing, state, env):
    """The path of the state's checkpoint of the whole box; computes it if it is not there."""
    label = os.path.join(folder, f"{1e3 * spacing:g}mm_{state}")
    if os.path.exists(label + ".h5"):
        return label + ".h5"
    options, before = STATES[state]
    quarter = label + "_quarter.h5"
    start = []
    if before:
        make(program, folder, spacing, before, env)
        start = ["-restart", os.path.join(folder, f"{1e3 * spacing:g}mm_{before}_quarter.h5")]
    reach(program, [*scene(folder, state), *QUARTER, "-spacing", str(spacing), *options, *start], quarter, env)
    mirror(quarter, label + ".h5")
    return label + ".h5"
