#!/usr/bin/python3
"""The cache of relaxed packings: read again by the run that wrote it and by one that only writes elsewhere; not by one
whose particles may come to rest at other places, whatever its bodies and options are called."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

BOX = """-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 1,1 -box_x wall -box_y wall -gravity 0,-9.81
 -packing_jitter 0.2 -packing_relaxation_time 0.02 -steps_max 1 -output_overwrite """
NAMES = ("a", "log_a", "my_options", "snapshot")
CHANGES = ("-{0}_viscosity 50", "-{0}_velocity 3,0", "-box_ymax_velocity 2,0", "-{0}_upper 1,0.5", "-packing_seed 2",
           "-gravity 0,-1 -gravity_amplitude 1,0 -gravity_frequency 9", "-kernel_ratio 1.5",
           "-scheme density_invariant")
HARMLESS = "-output_dir {1}/elsewhere -series_interval 1 -snapshot_interval 1 -gauge_points 0.5,0.1 -time_end 9"


def cached(name, cache, options):
    """Whether a run with these options takes its packing from the cache; the test ends if the run fails."""
    process = runs.start(BOX + f"-bodies {name} -{name}_shape box -{name}_upper 1,0.6 -packing_cache {cache} "
                         f"-output_dir {cache}/run " + options.format(name, cache))
    if process.returncode:
        runs.check(False, f"{name} {options}", f"code {process.returncode}: {process.stderr[-300:]}")
        runs.done()
    return "from the cache" in process.stdout


for name in NAMES:
    cache = runs.scratch(f"relaxed_{name}")
    runs.check(not cached(name, cache, ""), f"{name}_first")
    runs.check(cached(name, cache, "") and cached(name, cache, HARMLESS) == (name != "snapshot"),
               f"{name}_again")
    read = [change for change in (CHANGES if name == "a" else CHANGES[:2]) if cached(name, cache, change)]
    runs.check(not read, f"{name}_changed", f"the packing of another scene is read with {read}")
# a free body is let go alike after a relaxation and from the cache
cache = runs.scratch("relaxed_ball")
first, again = [runs.series(runs.run("-options_file cases/floating_box/sphere.opts -spacing 0.01 -time_end 0.004 "
                                     f"-packing_cache {cache}", f"ball_{k}")) for k in (1, 2)]
differing = [n for n in first.dtype.names if n != "wall_time" and not np.array_equal(first[n], again[n])]
runs.check(len(first) > 2 and not differing, "free_body_again", f"differing: {differing}")
runs.done()
