#!/usr/bin/python3
"""A film with a floating drop for very many steps: volume, level and energy do not drift, memory stays flat.

    tests/long/long_run.py [STEPS]        (default 100 000; make long-run: a million)

A film 0.2 m wide, 0.08 m deep, of 0.02 m spacing with a drop of its own liquid floating on it; judged between the tenth
part of the run, when it has come to rest, and the end."""
import os
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

STEPS = int(sys.argv[1]) if len(sys.argv) > 1 else 100000
SCENE = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 0.2,0.3 -box_x periodic -box_ymin wall -gravity 0,-9.81
 -bodies film,drop -film_upper 0.2,0.08 -film_viscosity 1 -drop_shape sphere -drop_radius 0.04 -drop_center 0.1,0.13
 -drop_viscosity 1 -progress_interval 0 -time_step 2e-4 """
DEPTH = 0.08  # m
folder = runs.scratch("long")
command = SCENE + f"-steps_max {STEPS} -series_interval {2e-4 * STEPS / 200} -output_dir {folder}"
process = runs.subprocess.Popen([runs.PROGRAM] + command.split(), cwd=runs.ROOT, env=runs.environment(),
                                stdout=runs.subprocess.DEVNULL, stderr=runs.subprocess.PIPE, universal_newlines=True)
memory = []  # resident, kB
while process.poll() is None:
    try:
        with open(f"/proc/{process.pid}/status", encoding="utf-8") as file:
            memory += [int(line.split()[1]) for line in file if line.startswith("VmRSS")]
    except (FileNotFoundError, ProcessLookupError):
        pass
    time.sleep(0.2)
runs.check(process.returncode == 0, "runs_to_the_end", process.stderr.read()[-300:])
s = runs.series(folder)
rest = s[s["step"] >= STEPS / 10]
scale = abs(rest["potential_energy"][0]) + rest["kinetic_energy"][0]
quarter = len(memory) // 4
early, late = np.median(memory[quarter:2 * quarter]), np.median(memory[3 * quarter:])  # not the last file's
print(f"{int(s['step'][-1])} steps in {s['wall_time'][-1]:.0f} s; after a tenth of them: kinetic energy "
      f"{rest['kinetic_energy'][0] / scale:.1e} to {rest['kinetic_energy'][-1] / scale:.1e}, potential energy "
      f"{rest['potential_energy'].max() / scale - rest['potential_energy'].min() / scale:.1e} apart, of their sum; "
      f"memory {early:.0f} kB in the second quarter, {late:.0f} kB in the last, {max(memory)} kB at most")
runs.check_below(s["lost"][-1], 0, "no_particle_lost")
runs.check_below(abs(rest["volume"][-1] / s["volume"][0] - 1), 1e-12, "volume")
runs.check_below(np.abs(rest["highest"] - rest["highest"][0]).max() / DEPTH, 0.05, "level")
runs.check_below((rest["potential_energy"].max() - rest["potential_energy"].min()) / scale, 0.01, "energy_of_place")
runs.check_below(rest["kinetic_energy"].max() / scale, 1e-3, "stays_at_rest")
runs.check_below(late / early, 1.005, "memory_flat")
runs.done()
