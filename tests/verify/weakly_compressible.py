#!/usr/bin/python3
"""The weakly compressible scheme: a drop in a central force and vortices against their exact solutions, the error falls
with the speed of sound, its time step, the restart of its pressure, one and two processes, and what it refuses."""
import os
import re
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import numpy as np  # noqa: E402
import physics  # noqa: E402
import runner  # noqa: E402
import runs  # noqa: E402

SCHEME = " -scheme weakly_compressible"
DROP = "-options_file cases/central_force/case.opts -spacing 0.0667 -time_end 9.2" + SCHEME
VORTEX = "-options_file cases/taylor_green/case.opts -packing_jitter 0.25 -spacing 0.04" + SCHEME

folder = runs.run(DROP, "drop")
LIMITS = {"period": 0.01, "amplitude of b in the last period": 0.02, "area of the ellipse": 0.01}
for result in runner.load("central_force")(folder):
    if result.name in LIMITS:
        runs.check_below(result.error(), LIMITS[result.name], f"drop, relative error of {result.name}")
    else:
        runs.check(result.passed(), f"drop, {result.name}", result.words())

h, speed = 1.3 * 0.0667, 0.5  # the drop's; the sound is ten times the scene's velocity
series = runs.series(folder)
process = runs.start(DROP + " -steps_max 1 -output_dir " + runs.scratch("view"))
sound = float(re.search(r"Sound: ([\d.e+-]+) m/s", process.stdout)[1])
runs.check_below(series["time_step"][1:].max() * sound / h, 0.4, "Courant number of sound")
runs.check_below(-series["time_step"][1:-1].min() * (sound + 2 * speed) / h, -0.35, "Courant number of sound, least")
runs.check_below(float(series["density_error"].max()), 0.05, "rms density error of the drop")

errors = []
for sound in (5, 10, 20):  # U = 1 m/s
    folder = runs.run(f"{VORTEX} -sound_speed {sound}", f"vortices {sound}")
    errors.append(next(r.measured for r in runner.load("taylor_green")(folder) if r.name.startswith("velocity error")))
runs.check(errors[0] > errors[1] and errors[0] > errors[2], "the error falls with the speed of sound", errors)
runs.check_below(errors[1], 0.03, "velocity error of the vortices, c = 10 U")

folder = runs.run(VORTEX + " -pressure_source density -time_end 0.1", "summed")
pressure = np.concatenate([f["pressure"] for _, _, f in physics.snapshots(folder)])
runs.check(pressure.min() >= 0 and pressure.max() > 0, "summed density knows no suction",
           (pressure.min(), pressure.max()))

SHORT = VORTEX.replace("-packing", "-ksp_rtol 1e-12 -time_end 0.1 -checkpoint_interval 0.05 -packing")
whole = runs.run(SHORT, "whole")
first = runs.numbered(whole, "checkpoint")[0]
again = runs.run(f"{SHORT} -restart {first}", "again")
two = runs.run(SHORT, "two", ranks=2)
for name, other, limit in (("restart", again, 0.0), ("two processes", two, 1e-6)):
    a, b = (runs.fields(runs.numbered(f, "checkpoint")[-1]) for f in (whole, other))
    worst = max(np.abs(a[k] - b[k]).max() / max(np.abs(a[k]).max(), 1e-300)
                for k in ("position", "velocity", "pressure"))
    runs.check_below(worst, limit, f"{name}, largest difference")

process = runs.start(f"{VORTEX} -sound_speed -1 -output_dir " + runs.scratch("bad"))
runs.check(process.returncode != 0 and "it must lie in [0, inf)" in process.stderr, "refuses a negative speed of sound",
           process.stderr[-200:])
runs.done()
