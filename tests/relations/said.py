"""Relations of what a run says: first rows, the budget, and numbers that are told twice."""
import json
import os
import re
import sys

TESTS = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path[:0] = [TESTS, os.path.join(TESTS, "verify")]
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runs  # noqa: E402
from scene import CORNERS, Unfit  # noqa: E402

BRIEF, SLACK = 1e-6, 0.05  # a step so many times shorter changes nothing by more than so much
STIFF = 100  # Pa s of random scenes, from which -viscosity_solver auto may be implicit; as it is with polymers
ALL = 100  # % of the energy exchanged: an impact may lose much of it, but no more
FULL = 1.2  # of the fillings of an emitter, whose inlet has whole particles
UNSEEN = 0.01  # % of the energy exchanged, which rounding and the solver may leave
NUMERIC = ("real", "int", "numbers", "point", "direction")  # kinds of options
AFTER = 0.01  # of the largest value of a column, which is read from a snapshot
SAID = 0.2  # of the steps, by which a dry run may be wrong, or two


def first(t):
    """What a step has to fill is nan before the first one: a step of no length changes nothing else but velocities, of
    which the pressure takes the divergence at once."""
    dt = float(np.nanmin(runs.series(t.measured.folder)["time_step"]))
    brief = t.gauged(f"-time_step {BRIEF * dt!r}", 1)
    wrong = []
    for file in ("series.csv", "droplets.csv", "pockets.csv"):
        rows, usual = brief.table(file), t.measured.table(file)
        still = {c["name"] for c in json.loads(brief.text("scene.json"))["columns"]
                 if c["file"] == file and c["counts"] != "run" and not re.match("J|.*/s$", c["unit"])}
        here = [rows["step"] == k for k in (0, 1)] if rows else []
        if rows and file != "series.csv" and here[0].sum() != here[1].sum():
            continue  # rows of what a step finds
        for name in still & set(rows):
            before, after = (np.atleast_1d(rows[name])[k] for k in here)
            scale = np.nanmax(np.abs(usual[name]), initial=1e-300)
            if not (np.isnan(before) | np.isnan(after) | np.isclose(before, after, SLACK, SLACK * scale)).all():
                wrong.append(f"{file} {name}: {before[0]:.6g}, after a step of no length {after[0]:.6g}")
    return wrong


def books(t):
    """The energy of a scene closes within what its own budget says."""
    liquids = t.scene.names("bodies")
    if t.scene.options.get("viscosity_solver") == "implicit" or any(
            t.scene.number(f"{name}_viscosity") >= STIFF or t.scene.number(f"{name}_polymer_modulus")
            for name in liquids):
        raise Unfit("not cured: the work of implicit viscosity is that of one velocity, and long steps have two")
    found = re.search(r"residual .*?, (\S+) % of .*?: (.*)", t.longer.text("log.txt"))
    if not found:  # nothing was exchanged
        return []
    share = float(found[1])
    return [found[0]] if share > UNSEEN and found[2].startswith("energy has grown") or share < -ALL else []


def told(t):
    """What is said in two places is the same: options and scene.json, a table and the series, the last snapshot and the
    series, a dry run and the run; and what a run says of itself it says once."""
    run, wrong = t.measured, []
    scene, series = json.loads(run.text("scene.json")), run.table("series.csv")
    given = {o["name"][1:]: [float(word) for word in str(o["value"]).split(",")] for o in scene["options"]
             if o["kind"] in NUMERIC and o["given"]}

    def compare(what, a, b, limit=1e-6):
        a, b = np.ravel(np.array(a, dtype=float)), np.ravel(np.array(b, dtype=float))
        if len(a) and not np.allclose(a[:len(b)], b[:len(a)], limit, limit * np.nanmax(np.abs(b), initial=0),
                                      equal_nan=True):
            wrong.append(f"{what}: {a[:3]} and {b[:3]}")

    def walk(value, owner=""):
        for key, part in value.items():
            name = f"{owner}_{key}" if f"{owner}_{key}" in given else key if not owner else None
            if isinstance(part, dict):
                walk(part, owner)
            elif isinstance(part, list) and part and isinstance(part[0], dict):
                for one in part:
                    own = {"faces": "box_", "bodies": "", "solids": ""}.get(key)
                    walk(one, "-" if own is None else own + one["name"])
            elif name in given and key not in CORNERS and part is not None:  # corners: those of the shape
                compare(f"scene.json {name} beside the option", part, given[name])

    walk({key: part for key, part in scene.items() if key not in ("options", "columns", "model", "step", "regions")})
    pockets, drops = run.table("pockets.csv"), run.table("droplets.csv")
    for k, time in enumerate(series["time"]):
        now = (pockets["time"] == time) & (pockets["amount"] > 0) if pockets else np.zeros(0, dtype=bool)
        if k and pockets:
            compare("gas_volume beside pockets.csv", pockets["volume"][now].sum(), series["gas_volume"][k])
            compare("gas_pockets beside pockets.csv", now.sum(), series["gas_pockets"][k])
            if now.any():
                compare("gas_pressure_max beside pockets.csv", pockets["pressure"][now].max(),
                        series["gas_pressure_max"][k])
        now = drops["time"] == time if drops else np.zeros(0, dtype=bool)
        if now.any():
            compare("droplets.csv beside the series", [now.sum() - 1, drops["volume"][now][1:].sum()],
                    [series["droplets"][k], series["droplet_volume"][k]])
    path = runs.numbered(run.folder, "snapshot")[-1]
    fields = runs.fields(path)
    volume = physics.volumes(runs.head(path), fields)[fields["body"] >= 0]
    mass = volume * np.array([t.scene.number(f"{name}_density", 1000) for name in t.scene.names("bodies")])[
        fields["body"][fields["body"] >= 0]]
    compare("particles of the last snapshot", len(volume), series["particles"][-1], 0)
    compare("volume of the last snapshot", volume.sum(), series["volume"][-1])
    compare("kinetic energy of the last snapshot", 0.5 * mass @ (run.last["velocity"]**2).sum(axis=1),
            series["kinetic_energy"][-1])
    for name, weight in (("temperature", mass), ("concentration", volume)):
        if name in fields:
            compare(f"{name} of the last snapshot", weight @ fields[name][fields["body"] >= 0].ravel() / weight.sum(),
                    series[f"{name}_mean"][-1])
    doubts = t.longer.doubts()
    wrong += [f"said more than once: {doubt}" for doubt in sorted(set(doubts)) if doubts.count(doubt) > 1]
    wrong += tried_dry(t) + counted(t, scene) + afterwards(run)
    return wrong[:4]


def afterwards(run):
    """-measure finds in the snapshots what the run has measured, but for forces, which are those of a step's middle;
    gas and free solids are refused."""
    done = runs.start(["-measure", run.folder])
    if done.returncode:
        return [f"-measure: {done.stderr.strip()[-200:]}"] * ("-measure cannot be used with" not in done.stderr)
    after, series = run.table("measured.csv", "series.csv"), run.table("series.csv")
    largest = {name: np.nanmax(np.abs(series[name]), initial=0) for name in after if not name.startswith("force")}
    return [f"-measure: {name} {after[name][-1]:.6g}, the run {series[name][-1]:.6g}" for name in largest if not
            np.isclose(after[name][-1], series[name][-1], SLACK, AFTER * largest[name], equal_nan=True)]


def counted(t, scene):
    """An emitter of so many fillings brings no more than they hold; of rings it is not looked at."""
    volume = t.longer.table("series.csv")["volume"]
    jets = {body["name"]: body for body in scene["bodies"] if body["emitter"]}
    counts = {name: t.scene.number(f"{name}_count") for name in jets}
    if not jets or t.scene.rings or not all(counts.values()) or volume[-1] < volume[0]:
        return []
    room = sum(counts[name] * np.prod(np.subtract(jet["upper"], jet["lower"])[:t.scene.dim]) for name, jet in
               jets.items())
    return [f"emitters brought {volume[-1] - volume[0]:.4g} of {room:.4g}"] * (volume[-1] - volume[0] > FULL * room)


def tried_dry(t):
    """What a dry run says of particles and steps that is not so."""
    end = t.longer.last["time"]
    dry = runs.start([*t.scene.copy(time_end=[end]).words(), "-dry_run", "-output_dir", t.file("dry"), "-packing_cache",
                      ""])
    said = [re.search(words, dry.stdout) for words in (r"particles: (\d+) of liquid", r"time: about .*?: (\d+) steps")]
    if dry.returncode or not all(said):
        return [f"no dry run: {dry.stderr.strip()[-200:]}"]
    particles, steps = (int(found[1]) for found in said)
    wrong = [f"dry run: {particles} particles"] * (particles != len(t.plain.first["id"]))
    return wrong + [f"dry run: {steps} steps, taken {t.long}"] * (abs(steps - t.long) > max(2, SAID * t.long))
