#!/usr/bin/python3
"""Files made by somebody else: checkpoints and cached packings whose contents were changed and whose seal was made
anew, and checkpoints of another scene. On 1 to 4 ranks each run is right, or ends with one sentence before it writes a
thing: no signal, no trace, no hang, nothing read outside of the file.

    tests/faults/crafted.py [--checkpoints 200] [--packings 40] [--scenes 30]

Without arguments a short part, as in make test; make faults tries as many as above. ISPH=output/sanitized/isph tries
the program of 'make sanitized'. The last lines tell how many were tried of each, how many ran, how many were
refused."""
import argparse
import os
import random
import resource
import shlex
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import h5py  # noqa: E402
import numpy as np  # noqa: E402
import runs  # noqa: E402

os.environ.setdefault("ASAN_OPTIONS", "detect_leaks=0")  # leaks of Open MPI and HDF5 are not ours

SCENE = """-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 1,1 -box_x periodic -box_ymin wall -gravity 0,-9.81
 -bodies film,drop -film_upper 1,0.3 -film_tension 1 -film_viscosity 0.1 -drop_shape sphere -drop_radius 0.15
 -drop_center 0.5,0.55 -drop_velocity 1,-2 -drop_tension 1 -solids post -post_lower 0.2,0 -post_upper 0.3,0.4
 -progress_interval 0 """
SECONDS = 300  # a run of these takes less than one; the machine may be busy
MEMORY = 1 << 30  # bytes
SANITIZED = "sanitized" in runs.PROGRAM  # its shadow memory is huge
tally = {}


# --- the seal, as in src/storage/checksum.c ---

MAGIC, PLACE = 0x31304C4145534853, np.uint64(0x9E3779B97F4A7C15)
SEAL = 24  # bytes


def split_mix(z):
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def seal(path):
    with open(path, "rb") as file:
        data = file.read()
    words = np.frombuffer(data + bytes(-len(data) % 8), "<u8")
    with np.errstate(over="ignore"):
        total = split_mix(words ^ split_mix(np.arange(1, len(words) + 1, dtype=np.uint64) * PLACE)).sum(dtype=np.uint64)
    with open(path, "ab") as file:
        file.write(np.array([MAGIC, len(data), total], "<u8").tobytes())


def unsealed(source, target):
    shutil.copy(source, target)
    os.truncate(target, os.path.getsize(target) - SEAL)


# --- runs ---


def limits():
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if not SANITIZED:
        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))


def attempt(options, ranks):
    """(exit code or None when it hung, standard output, standard error)."""
    command = (["mpiexec", "-n", str(ranks)] if ranks > 1 else []) + [runs.PROGRAM] + shlex.split(options)
    environment = runs.environment(ranks)
    try:
        done = subprocess.run(command, cwd=runs.ROOT, env=environment, timeout=SECONDS, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=limits, check=False)
        return done.returncode, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace")
    except subprocess.TimeoutExpired:
        return None, "", ""


def sentence(code, err):
    """The one sentence of a refusal, or None if the run ended in another way."""
    lines = [line for line in err.splitlines() if line.startswith("isph: error: ")]
    bad = "PETSC ERROR" in err or "Sanitizer" in err or "runtime error" in err
    return lines[0] if code is not None and 0 < code < 126 and len(lines) == 1 and not bad else None


def judge(what, name, code, err, must, folder, words=()):
    """Counts a run. must: 'refused', or 'run', or None for either."""
    said = sentence(code, err)
    early = said and not os.path.exists(os.path.join(folder, "series.csv"))
    stopped = said and must is None and "stopped at" in said
    ran = code == 0 and must != "refused" and "runtime error" not in err
    fine = ran or (must != "run" and (early or stopped) and all(word in said for word in words))
    outcome = ("ran" if code == 0 else "refused") if fine else "failed"
    tally.setdefault(what, {"ran": 0, "refused": 0, "failed": 0})[outcome] += 1
    if not fine:
        runs.check(False, f"{what} {name}", f"code {code}, wanted {must or 'either'}: {said or err.strip()[-400:]!r}")
    return fine


# --- checkpoints ---

REALS = ("time", "time_step", "pressure_time", "previous_time_step", "density_error", "density_mean", "solver_error",
         "surface_energy", "viscous_work", "tension_work", "start_energy", "start_density", "divergence", "spacing",
         "level", "wall_time", "resampling_loss", "solid_work", "drive_work", "inflow_energy", "outflow_energy",
         "friction_work", "kinetic_energy", "given", "taken", "tension_swing")
INTS = ("dimension", "bodies", "particles", "ranks", "step", "iterations", "rejected", "lost", "joined", "split",
        "said", "opening_lasting", "format_version")
FIELDS = ("position", "velocity", "pressure", "density", "lambda")
NUMBERS = ("id", "body", "layer", "parent", "surface")
LARGE = (-2**63, -2**31, -1, 2**31 - 1, 2**31, 2**32, 2**63 - 1)
# any number of them is possible
COUNTED = ("step", "iterations", "rejected", "lost", "joined", "split", "said", "opening_lasting")
UNSEEN = {("divergence", "nan"), ("level", "nan")}  # a run may leave these


def number_of_head(file, rng):
    if rng.random() < 0.5:
        name, value = rng.choice(REALS), rng.choice((np.nan, np.inf, -np.inf))
        must = None if (name, str(value)) in UNSEEN else "refused"
        if rng.random() < 0.3:
            value, must = rng.choice((-1.0, 0.0, 1e300, -1e300, 1e-300)), None
        if name == "spacing":
            must = "refused"
        file.attrs.modify(name, np.float64(value))
        return f"{name} {value}", must
    name, value = rng.choice(INTS), rng.choice(LARGE)
    file.attrs.modify(name, np.int64(value))
    return f"{name} {value}", None if value == 2**31 - 1 and name in COUNTED else "refused"


def kind_of_head(file, rng):
    name = rng.choice(REALS + INTS + ("format",))
    how = rng.choice(("gone", "text", "array", "vlen", "empty", "compound"))
    del file.attrs[name]
    if how == "text":
        file.attrs[name] = np.bytes_(b"x" * rng.choice((1, 100, 60000)))
    elif how == "array":
        file.attrs[name] = np.zeros(rng.choice((2, 1000)))
    elif how == "vlen":
        file.attrs.create(name, "1", dtype=h5py.string_dtype())
    elif how == "empty":
        file.attrs[name] = h5py.Empty("f8")
    elif how == "compound":
        file.attrs[name] = np.zeros((), [("a", "f8"), ("b", "i4")])
    return f"{name} {how}", "refused"


def scene_text(file, rng):
    old = bytes(file.attrs["scene_identity"])
    how, text = rng.choice((("empty", b"\0"), ("none", None), ("no lines", b"x" * 50000), ("one line", b"= = = \n="),
                            ("line ends", b"\n" * 40000), ("cut", old[:rng.randrange(len(old) - 5)]),
                            ("long", old + b"-a_long = " + b"y" * 50000), ("formats", b"%s%n%d = %s%n\n" * 99),
                            ("bytes", bytes(rng.randrange(1, 256) for _ in range(999)))))
    del file.attrs["scene_identity"]
    if text:
        file.attrs["scene_identity"] = np.bytes_(text)
    return f"scene {how}", None if how in ("empty", "none") else "refused"


def number_of_field(file, rng):
    name, value = rng.choice(FIELDS), rng.choice((np.nan, np.inf, -np.inf))
    must = "refused"
    if rng.random() < 0.4:
        value, must = rng.choice((1e300, -1e300, 1e9, 0.0)), None
        if name == "position" and value:
            must = "refused"
    place = rng.randrange(len(file[name])) if rng.random() < 0.8 else slice(None)
    file[name][place] = value
    return f"{name} {value} at {place}", must


def whole_number(file, rng):
    name = rng.choice(("id", "body", "layer", "surface"))
    value = rng.choice((-2**31, -100, -4, 3, 100, 2**31 - 1))
    kind = file["layer"][:]
    place = rng.choice(np.flatnonzero(kind == 0) if name == "layer" else range(len(kind)))
    file[name][place] = value
    return f"{name} {value} at {place}", None if name == "id" and value > 0 else "refused"


def crowd(file, rng):
    """All particles at one place: finite, in the box, and no state of a liquid."""
    liquid = np.flatnonzero(file["layer"][:] == 0)
    file["position"][liquid] = np.tile((0.5, 0.5, 0), (len(liquid), 1))
    return "one place", None


def counts(file, rng):
    how = rng.choice(("negative", "sum", "huge", "many", "none"))
    n = len(file["id"])
    values = {"negative": [-1, n + 1], "sum": [n - 1], "huge": [2**31 - 1], "many": [0] * 5000 + [n], "none": []}[how]
    del file["counts"]
    file["counts"] = np.array(values, "i4")
    file.attrs.modify("ranks", np.int64(len(values)))
    return f"counts {how}", None if how == "many" else "refused"


def shape(file, rng):
    name = rng.choice(FIELDS + NUMBERS + ("counts",))
    how = rng.choice(("gone", "short", "long", "turned", "text", "other kind", "group", "scalar", "type", "endless"))
    old = file[name][:]
    del file[name]
    if how == "short":
        file[name] = old[:-1]
    elif how == "long":
        file[name] = np.concatenate((old, old))
    elif how == "turned":
        file[name] = np.atleast_2d(old).T if old.ndim == 2 else old[:, None]
    elif how == "text":
        file[name] = np.full(old.shape, b"1")
    elif how == "other kind":
        file[name] = old.astype("f8" if old.dtype.kind == "i" else "i4")
    elif how == "group":
        file.create_group(name)
    elif how == "scalar":
        file[name] = old.flat[0]
    elif how == "type":
        file[name] = np.dtype("f8")
    elif how == "endless":  # as many rows as the file claims particles, none of them stored
        many = 10**9
        file.create_dataset(name, (many,) + old.shape[1:], old.dtype)
        file.attrs.modify("particles", np.int64(many))
    return f"{name} {how}", "refused"


def elsewhere(file, rng):
    """Data behind links and in other files; that they are right does not matter."""
    name = rng.choice(FIELDS + NUMBERS + ("counts",))
    how = rng.choice(("external link", "soft link", "soft link in a circle", "external storage", "virtual",
                      "big chunk"))
    old, other = file[name][:], runs.scratch("other.h5")
    with h5py.File(other, "w") as second:
        second[name] = old
    del file[name]
    if how == "external link":
        file[name] = h5py.ExternalLink(other, name)
    elif how == "soft link":
        file["moved"] = old
        file[name] = h5py.SoftLink("/moved")
    elif how == "soft link in a circle":
        file[name] = h5py.SoftLink("/" + name)
    elif how == "external storage":
        with open(runs.scratch("raw"), "wb") as raw:
            raw.write(old.tobytes())
        file.create_dataset(name, old.shape, old.dtype, external=[(runs.scratch("raw"), 0, old.nbytes)])
    elif how == "virtual":
        layout = h5py.VirtualLayout(old.shape, old.dtype)
        layout[...] = h5py.VirtualSource(other, name, old.shape)
        file.create_virtual_dataset(name, layout)
    elif how == "big chunk":
        file.create_dataset(name, old.shape, old.dtype, maxshape=(None,) + old.shape[1:],
                            chunks=(1 << 22,) + old.shape[1:], compression="gzip")
    return f"{name} {how}", "refused"


def same_data(file, rng):
    """Other ways to store the same numbers: to be read."""
    name = rng.choice(FIELDS + NUMBERS)
    how = rng.choice(("again", "wider", "big-endian", "moved", "compressed"))
    old = file[name][:]
    del file[name]
    if how == "compressed":
        file.create_dataset(name, data=old, chunks=(min(64, len(old)),) + old.shape[1:], compression="gzip")
    elif how == "moved":
        file["another"] = old
        file[name] = file["another"]
        del file["another"]
    else:
        file[name] = old.astype({"again": old.dtype, "big-endian": old.dtype.newbyteorder(">"),
                                 "wider": "i8" if old.dtype.kind == "i" else "f8"}[how])
    return f"{name} {how}", "run"


def crafted(source, target, rng):
    """A changed copy of a file with a seal that fits; what was changed, and what must come of it."""
    unsealed(source, target)
    if rng.random() < 0.2:
        size = os.path.getsize(target)
        if rng.random() < 0.3:
            length = rng.randrange(size)
            os.truncate(target, length)
            how, must = f"cut to {length} of {size}", None
        else:
            with open(target, "r+b") as file:
                places = [rng.randrange(size) for _ in range(rng.randint(1, 4))]
                for place in places:
                    file.seek(place)
                    byte = rng.randrange(256)
                    file.write(bytes([byte]))
            how, must = f"bytes {places} of {size}", None
    else:
        with h5py.File(target, "r+") as file:
            how, must = rng.choice(CHANGES)(file, rng)
    seal(target)
    return how, must


CHANGES = (number_of_head, number_of_head, kind_of_head, scene_text, number_of_field, number_of_field, whole_number,
           whole_number, crowd, counts, shape, shape, elsewhere, elsewhere, same_data)


def checkpoints(number, rng):
    good = [runs.numbered(runs.run(SCENE + "-steps_max 3", f"good_{ranks}", ranks), "checkpoint")[-1]
            for ranks in (1, 3)]
    again = runs.fields(runs.numbered(runs.run(SCENE + f"-steps_max 1 -restart {good[0]}", "again"), "checkpoint")[-1])
    bad, folder = runs.scratch("bad.h5"), runs.scratch("of_bad")
    for k in range(number):
        ranks = 1 + k % 4
        how, must = crafted(good[ranks == 3], bad, rng)
        shutil.rmtree(folder, ignore_errors=True)
        code, _, err = attempt(SCENE + f"-steps_max 1 -restart {bad} -output_dir {folder}", ranks)
        judge("checkpoint", f"{k}: {how} on {ranks}", code, err, must, folder, (bad,) if must else ())
        if must == "run" and ranks == 1 and code == 0:
            now = runs.fields(runs.numbered(folder, "checkpoint")[-1])
            runs.check(all(np.array_equal(again[f], now[f]) for f in ("position", "velocity", "id")), f"{how} is read")
    runs.check(not tally.get("checkpoint", {}).get("failed"), "crafted_checkpoints")


# --- cached packings ---


def packing_change(file, rng):
    name = rng.choice(("id", "body", "position", "particles"))
    if name == "particles":
        value = rng.choice((-1, 0, 1, 10**9, 2**31, 2**63 - 1))
        file.attrs.modify(name, np.int64(value))
        return f"particles {value}"
    if rng.random() < 0.5:
        place = rng.randrange(len(file[name]))
        value = rng.choice((np.nan, np.inf, 1e300, -9.0) if name == "position" else (-1, -2**31, 2, 10**6, 2**31 - 1))
        file[name][place] = value
        return f"{name} {value} at {place}"
    if rng.random() < 0.5:
        return elsewhere_of(file, name)
    old = file[name][:]
    del file[name]
    if rng.random() < 0.5:
        file[name] = old[: len(old) // 2]
    return f"{name} gone or short"


def elsewhere_of(file, name):
    other = runs.scratch("other.h5")
    with h5py.File(other, "w") as second:
        second[name] = file[name][:]
    del file[name]
    file[name] = h5py.ExternalLink(other, name)
    return f"{name} external link"


def packings(number, rng):
    """What is no packing of the scene is made again, and the run is that without the file on as many ranks: where the
    optimisation of a packing ends depends on their number."""
    plain = SCENE.replace("-solids post -post_lower 0.2,0 -post_upper 0.3,0.4", "")
    cache, folder, kept = runs.scratch("cache_poisson"), runs.scratch("of_cache"), runs.scratch("kept.h5")
    options = f"{plain} -packing_type poisson -packing_tolerance 1e-2 -packing_cache {cache} -steps_max 1 "
    options += "-output_overwrite "
    runs.run(options, "first")
    firsts = {}
    cached = os.path.join(cache, os.listdir(cache)[0])
    shutil.copy(cached, kept)
    for k in range(number // 2):
        ranks = 1 + k % 4
        unsealed(kept, cached)
        with h5py.File(cached, "r+") as file:
            how = packing_change(file, rng)
        seal(cached)
        code, out, err = attempt(options + f"-output_dir {folder}", ranks)
        fine = judge("packing", f"poisson {k}: {how} on {ranks}", code, err, "run", folder)
        if fine:
            now = runs.fields(runs.numbered(folder, "checkpoint")[-1])
            if ranks not in firsts:
                alone = runs.run(options + "-packing_cache '' ", "alone", ranks)
                firsts[ranks] = runs.fields(runs.numbered(alone, "checkpoint")[-1])
            same = np.allclose(firsts[ranks]["position"], now["position"], rtol=0, atol=1e-9) and \
                "from the cache" not in out
            runs.check(same, f"poisson {how} on {ranks} is made again")
    runs.check(not tally.get("packing", {}).get("failed"), "crafted_packings")


# --- checkpoints of another scene ---

OTHER = (  # options in place of those of the scene, words of the refusal
    ("-box_upper 1,2", "-box_upper"), ("-box_lower 0,-0.1", "-box_lower"),
    ("-box_lower 0.4,0 -box_upper 1.4,1", "-box_lower"),
    ("-box_upper 1.00001,1", "-box_upper"), ("-box_x wall", "-box_xmin"), ("-box_x open", "-box_xmax"),
    ("-box_x symmetry", "-box_xmin"), ("-box_ymin open", "-box_ymin"), ("-box_ymax wall", "-box_ymax"),
    ("-bodies drop,film", "-bodies"), ("-bodies film", "drop"),
    ("-bodies film,drop,more -more_lower 0.9,0.9", "bodies"),
    ("-film_density 900", "-film_density"), ("-drop_tension 2", "-drop_tension"), ("-film_upper 1,0.35", "film"),
    ("-drop_radius 0.14", "drop"), ("-drop_center 0.5,0.56", "drop"), ("-drop_shape box -drop_lower 0,.5", "drop"),
    ("-drop_velocity 1,-3", "-drop_velocity"), ("-film_velocity 0,0.1", "-film_velocity"),
    ("-drop_velocity_type rotation -drop_rotation_rate 1", "-drop_velocity"), ("-kernel_ratio 1.4", "-kernel_ratio"),
    ("-kernel_type wendland_c2", "what differs: -kernel_type"), ("-post_upper 0.3,0.45", "post"),
    ("-solids ''", "post"),
    ("-solids post,more -more_lower 0.8,0 -more_upper 0.9,0.2", "more"), ("-spacing 0.04", "spacing"),
    ("-dimension 3 -box_lower 0,0,0 -box_upper 1,0.5,1 -gravity 0,0,-1 -film_lower 0,0,0 -film_upper 1,0.5,0.3 "
     "-drop_center 0.5,0.2,0.55 -drop_velocity 0,0,1 -post_lower 0,0,0 -post_upper 0.2,0.2,0.2", "dimensions"),
    ("-film_type emitter -film_velocity 0,1", "film"),
    ("-drop_type emitter", "-drop_type"))
SAME = ("-gravity 0,-1", "-film_viscosity 2", "-ksp_rtol 1e-9", "-time_cfl 0.1", "-shifting 0",
        "-snapshot_double -snapshot_interval 0.01", "-kernel_ratio 1.3", "-box_upper 1,1.0", "-packing_seed 7")


def scenes(number, rng):
    good = runs.numbered(runs.run(SCENE + "-steps_max 3", "scene", 2), "checkpoint")[-1]
    folder = runs.scratch("of_scene")
    for k, (options, word) in enumerate(rng.sample(OTHER, min(number, len(OTHER)))):
        shutil.rmtree(folder, ignore_errors=True)
        code, _, err = attempt(SCENE + options + f" -steps_max 1 -restart {good} -output_dir {folder}", 1 + k % 4)
        judge("other scene", options, code, err, "refused", folder, (word,))
    for k, options in enumerate(rng.sample(SAME, min(max(2, number // 3), len(SAME)))):
        code, out, err = attempt(f"{SCENE} {options} -steps_max 1 -restart {good} -output_dir {folder} "
                                 "-output_overwrite", 1 + k % 4)
        judge("same scene", options, code, err, "run", folder)
        said = [line for line in out.splitlines() if line.startswith(f"  {options.split()[0]} ") and "(was" in line]
        runs.check(len(said) == 1 and ("start of a run only" in said[0]) == ("packing" in options),
                   f"a restart says {options}", out[:300])
    older = runs.scratch("older.h5")
    for name, change in (("without a number", lambda attributes: attributes.pop("lost")),
                         ("of a format to come", lambda attributes: attributes.modify("format_version", 99))):
        unsealed(good, older)
        with h5py.File(older, "r+") as file:
            change(file.attrs)
        seal(older)
        shutil.rmtree(folder, ignore_errors=True)
        code, _, err = attempt(SCENE + f"-steps_max 1 -restart {older} -output_dir {folder}", 1)
        judge("other scene", name, code, err, "refused", folder, ("another version",))
    folder = runs.run(SCENE + f"-box_ymin_velocity 3,0 -steps_max 1 -restart {good}", "moving")
    with h5py.File(runs.numbered(folder, "checkpoint")[-1], "r") as file:
        wall = file["body"][:] == -1
        runs.check(wall.any() and (file["velocity"][:][wall] == (3, 0, 0)).all(), "a wall moves as a restart says")
    runs.check(not tally["other scene"]["failed"] and not tally["same scene"]["failed"], "scenes_at_a_restart")


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--checkpoints", type=int, default=24)
parser.add_argument("--packings", type=int, default=6)
parser.add_argument("--scenes", type=int, default=6)
parser.add_argument("--seed", type=int, default=1)
arguments = parser.parse_args()
dice = random.Random(arguments.seed)
checkpoints(arguments.checkpoints, dice)
packings(arguments.packings, dice)
scenes(arguments.scenes, dice)
print(f"{'crafted':14s} {'tried':>6s} {'ran':>6s} {'refused':>8s} {'failed':>7s}")
for kind, results in tally.items():
    print(f"{kind:14s} {sum(results.values()):6d} {results['ran']:6d} {results['refused']:8d} {results['failed']:7d}")
runs.done()
