#!/usr/bin/python3
"""A step that goes wrong is rolled back and repeated with half its size; when that does not help, the run ends with one
sentence, a non-zero exit and a checkpoint of the last good state from which it can be continued."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

SCENE = """-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,1 -box_x periodic -box_ymin wall -gravity 0,-9.81
 -bodies film,drop -film_upper 1,0.2 -drop_shape sphere -drop_radius 0.1 -drop_center 0.5,0.4 -drop_velocity 0,-2
 -progress_interval 0 """

# Steps of 4 spacings: each is halved until a particle moves less than half a spacing.
folder = runs.run(SCENE + "-time_step 0.04 -time_end 0.04", "halved")
s = runs.series(folder)
runs.check(s["rejected"][-1] >= 3, "steps_are_rolled_back", f"{s['rejected'][-1]} of them")
runs.check(s["time"][-1] == 0.04, "and_the_end_is_reached", f"{s['time'][-1]} s")
runs.check_below(s["time_step"][1:].max() * 2 / 0.02, 0.55, "no_accepted_step_moves_too_far")
runs.check_below(s["kinetic_energy"][-1] / s["kinetic_energy"][0], 1.5, "the_state_is_sane")

# What is left is less than a thousandth of a step: the last one takes it, or its pressure would be noise over dt.
folder = runs.run(SCENE + "-time_step 1e-4 -time_end 5.0004e-4", "last_step")
s = runs.series(folder)
runs.check(s["step"][-1] == 5, "no_tiny_last_step", f"{s['step'][-1]} steps, the last of {s['time_step'][-1]} s")

# No step helps against a bound that the packing itself violates.
path = runs.scratch("stuck")
process = runs.start(SCENE + f"-steps_max 5 -energy_max 1e-9 -output_dir {path}")
runs.check(process.returncode != 0, "a_run_that_cannot_go_on_fails", f"exit code {process.returncode}")
errors = [line for line in process.stderr.splitlines() if line.strip()]
runs.check(len(errors) == 1 and "stopped at" in errors[0] and "try" in errors[0], "with_one_sentence", process.stderr)
runs.check("PETSC ERROR" not in process.stderr + process.stdout, "without_a_trace", process.stderr)
checkpoints = runs.numbered(path, "checkpoint")
if runs.check(len(checkpoints) > 0, "and_a_checkpoint", os.listdir(path)):
    process = runs.start(SCENE + f"-steps_max 5 -restart {checkpoints[-1]} -output_dir {path}")
    runs.check(process.returncode == 0, "that_can_be_continued", process.stderr)
runs.done()
