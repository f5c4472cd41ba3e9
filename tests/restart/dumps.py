#!/usr/bin/python3
"""What -dump_options writes of long lists and of numbers with units; tests/relations tries it on all scenes."""
import os
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

SHORT = ["-steps_max", "1", "-series_interval", "0", "-progress_interval", "0"]


def differences(one, other):
    """What differs between the folders of two runs."""
    a, b = runs.series(one), runs.series(other)
    found = ["columns of the series"] if a.dtype != b.dtype else []
    found += [name for name in a.dtype.names if not found and name != "wall_time"
              and a[name].tobytes() != b[name].tobytes()]
    pairs = [(runs.numbered(one, kind)[-1], runs.numbered(other, kind)[-1]) for kind in ("checkpoint", "snapshot")]
    for a, b in pairs:
        found += [f"{os.path.basename(a)}:{name}" for name, value in runs.fields(a).items()
                  if not np.array_equal(value, runs.fields(b).get(name), equal_nan=value.dtype.kind == "f")]
    return found


def long_list():
    """A list of numbers of any length is whole in the dump."""
    points = ",".join(f"{1e-5 * k + 1.2345678e-4:.12f},1.234567e-4,-1.2345678e-3" for k in range(60))
    dump, folder = runs.scratch("long.opts"), runs.scratch("long")
    runs.start(["-options_file", "cases/film_at_rest/case.opts", "-spacing", "1e-3", "-gauge_points", points,
                "-dump_options", dump])
    done = runs.start(["-options_file", dump, "-steps_max", "1", "-output_dir", folder])
    runs.check(not done.returncode, "long_list_runs", done.stderr)
    names = runs.series(folder).dtype.names if not done.returncode else ()
    runs.check("point_60_pressure_Pa" in names or "point_60_pressure" in names, "long_list_is_whole", str(names[-3:]))


def units():
    """A dump has the numbers in SI, as they are in the scene without units, to the last bit of the run."""
    plain = ["-dimension", "2", "-box_lower", "-5e-3,-2e-3", "-box_upper", "5e-3,10e-3", "-box_ymin", "wall", "-bodies",
             "film", "-spacing", "0.5e-3", "-film_upper", "5e-3,0", "-film_viscosity", "3e-3", "-film_tension", "72e-3",
             "-gravity", "0,-9.81", "-wall_contact_angle", "40", "-time_end", "10e-3"]
    written = dict(zip(plain[::2], plain[1::2])) | {
        "-box_lower": "-5,-2mm", "-box_upper": "5 mm,1 cm", "-spacing": "500um", "-film_upper": "5mm,0",
        "-film_viscosity": "3cP", "-film_tension": "72 mN/m", "-gravity": "0,-9.81m/s2", "-wall_contact_angle": "40deg",
        "-time_end": "10 ms"}
    dump, one, other = (runs.scratch(name) for name in ("units.opts", "plain", "units"))
    written = [word for pair in written.items() for word in pair]
    for words, folder in ((plain, one), (written, other)):
        done = runs.start([*words, *SHORT, "-dump_options", dump])
        done = done if done.returncode else runs.start([*words, *SHORT, "-output_dir", folder])
        runs.check(not done.returncode, f"units_{os.path.basename(folder)}_runs", done.stderr)
    runs.check(not differences(one, other), "units_are_converted", ", ".join(differences(one, other)))
    with open(dump, encoding="utf-8") as file:
        lines = file.read().splitlines()
    for name, value in (("-spacing", "500e-6"), ("-film_upper", "5e-3,0"), ("-wall_contact_angle", "40")):
        runs.check(f"{name} {value}" in lines, f"units_dumped{name}", "\n".join(x for x in lines if name in x))


os.chdir(runs.ROOT)
long_list()
units()
runs.done()
