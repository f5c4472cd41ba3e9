#!/usr/bin/python3
"""A start is at rest: a pool that waits for its drop gets neither speed nor pressure from its packing."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import physics  # noqa: E402
import runs  # noqa: E402

IMPACT = "-options_file cases/drop_impact/case.opts -options_file options/quarter.opts "
SCENES = {  # options, head of the liquid in Pa: hydrostatic at the floor and the drop's 2 sigma / R
    "rings": ("-options_file cases/deep_pool/rings.opts ", 1000 * 9.81 * 16e-3 + 72),
    "quarter": (IMPACT + "-spacing 0.7e-3 ", 1100 * 9.81 * 10e-3 + 67),
    "graded": (IMPACT + "-options_file cases/drop_impact/graded.opts -spacing 0.5e-3 -spacing_coarse 2e-3 ",
               1100 * 9.81 * 10e-3 + 67),
}

for part in runs.parts(*SCENES):
    options, head = SCENES[part]
    for seed in 1, 2, 3:
        folder = runs.run(f"{options} -packing_seed {seed} -time_end 0 -snapshot_interval 0.1e-3 -series_interval 1e-9",
                          f"{part} {seed}")
        rows = runs.series(folder)
        energy = rows["kinetic_energy"] + rows["potential_energy"]  # what falls gains by right
        gain = (energy.max() - energy[0]) / rows["kinetic_energy"][0]
        runs.check_below(gain, 0.02, f"{part}, seed {seed}, energy gained before contact")
        first = [abs(fields["pressure"]).max() for _, time, fields in physics.snapshots(folder)][1:3]
        runs.check_below(max(first), 2.5 * head, f"{part}, seed {seed}, pressure in the first 0.2 ms, Pa")
runs.done()
