#!/usr/bin/python3
"""The impact of the test of ranks over 200 steps on 1, 2, 3 and 4 ranks, particle by particle.

Sums run in another order on another number of ranks: a difference of round-off, which turns some factors of pairs, kept
in single precision, by 2^-24 of them. What 200 steps of a splash make of that, whatever began it, is measured on one
rank: the same scene with the drop's speed changed in its last bits. Ranks may differ by MARGIN times as much, because
their round-off enters at every step and sum, not once."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

SPACING, SPEED = 1e-3, 3.0
SPLASH = """-spacing 1e-3 -box_lower 0,0,-5e-3 -box_upper 10e-3,10e-3,10e-3 -box_xmin symmetry -box_ymin symmetry
 -box_ymax wall -box_zmin wall -gravity 0,0,-9.81 -bodies film,drop -film_lower 0,0,-5e-3 -film_upper 10e-3,10e-3,0
 -film_density 1100 -film_viscosity 3.5e-3 -film_tension 0.067 -drop_shape sphere -drop_radius 2.5e-3
 -drop_center 0,0,4e-3 -drop_density 1100 -drop_viscosity 3.5e-3 -drop_tension 0.067 -time_step 2e-5 -ksp_rtol 1e-13
 -steps_max 200 """
PUSH = 2.0**-50  # of the drop's speed: four last bits
MARGIN = 10


def final(name, ranks, speed=SPEED):
    folder = runs.run(SPLASH + f"-drop_velocity 0,0,{-speed!r}", name, ranks, 7200)
    return runs.fields(runs.numbered(folder, "checkpoint")[-1])


def apart(a, b):
    """Largest distance of a particle in two runs, spacings."""
    return np.abs(a["position"] - b["position"]).max() / SPACING


one = final("one", 1)
pushed = apart(one, final("pushed", 1, SPEED * (1 + PUSH)))
travelled = np.abs(one["velocity"]).max() * 200 * 2e-5 / SPACING
print(f"last bits of the speed change the end by {pushed:.2e} spacings, of about {travelled:.1f} travelled")
for n in (2, 3, 4):
    many = final(f"on_{n}", n)
    moved = apart(one, many)
    print(f"on {n} ranks: {moved:.2e} spacings")
    runs.check(np.array_equal(one["id"], many["id"]), f"ids_on_{n}", "other particles")
    runs.check_below(moved, MARGIN * pushed, f"positions_on_{n}")
runs.done()
