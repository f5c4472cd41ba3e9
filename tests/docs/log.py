#!/usr/bin/python3
"""What a run says, and its log.txt: all of it, without lines of progress too; and no line that is nonsense."""
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

SCENE = """-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 1,1 -box_x wall -box_ymin wall -gravity 0,-9.81
 -bodies film -film_upper 1,0.3 -film_tension 1 -solids post -post_lower 0.4,0 -post_upper 0.6,0.5 -time_end 1
 -wall_contact_angle 60 -box_xmax_contact_angle 100 -wall_contact_hysteresis 30 -post_contact_angle 75 """

CALM = "-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 1,1 -box_ymin wall -gravity 0,-9 -bodies a -steps_max 3 "


def log(folder):
    with open(os.path.join(folder, "log.txt"), encoding="utf-8") as file:
        return file.read()


def has(text, words, name):
    missing = [word for word in words if word not in text]
    runs.check(not missing, name, f"{missing} are not in {text[-1500:]}")


folder = runs.run(SCENE + "-steps_max 3", "quiet")  # with -progress_interval 0
has(log(folder), ["3 steps of", "Error budget", "residual", "continue with"], "summary_without_progress")
has(log(folder), ["Contact angles in degrees: xmin 45 to 75, xmax 85 to 115, ymin 45 to 75, post 75\n"],
    "contact_angles")
first = runs.numbered(folder, "checkpoint")[0]
runs.run(SCENE + f"-steps_max 1 -film_viscosity 0.5 -time_start 0.5 -restart {first}", "again")
has(log(runs.scratch("again")), ["Options changed since", "-film_viscosity 0.5 (was not given)", "-steps_max 1 (was 3)",
                                 "-time_start 0.5 (was not given): acts at the start of a run only"],
    "what_a_restart_changes")
text = log(runs.scratch("again"))
runs.check(text.startswith("=== isph") and text.count("Options changed") == 1, "the_head_of_the_log_is_first",
           text[:300])
dry = runs.start(SCENE + f"-spacing 0.006 -dry_run -progress_interval 1e-3 -output_dir {runs.scratch('dry')}")
lines = [line for line in dry.stdout.splitlines() if line.startswith("the dry run: ") and "%" in line]
runs.check(dry.returncode == 0 and lines and lines[0].endswith("0 %") and not any(" h " in line for line in lines),
           "dry_run_without_nonsense", str(lines[:3]) + dry.stderr[-300:])

# PETSc's habits: the products of the operator count their flops, the entries of an assembled matrix can be written.
seen = runs.start(CALM + f"-log_view -mat_type aij -ksp_view_mat binary:{runs.scratch('A')} "
                  f"-output_dir {runs.scratch('seen')}")
size = os.path.getsize(runs.scratch("A")) if os.path.exists(runs.scratch("A")) else 0
runs.check(seen.returncode == 0 and size > 1000, "entries_of_the_matrix", f"{size} bytes, {seen.stderr[-300:]}")
seen = runs.start(CALM + f"-log_view -options_left -output_dir {runs.scratch('logged')}").stdout
products = re.findall(r"^MatMult +(\d+) \S+ \S+ \S+ (\S+)", seen, re.M)
runs.check(len(products) == 2 and all(float(flops) > 1000 * int(count) for count, flops in products),
           "products_count_their_flops", str(products))
for event in "SphNeighbors", "SphDivergence", "SphGradient":
    flops = [float(number) for number in re.findall(event + r" +\d+ \S+ \S+ \S+ (\S+)", seen)]
    runs.check(flops and max(flops) > 1000, f"{event}_counts_its_flops", str(flops))
runs.check("There are no unused options" in seen and "twolevel_coarse" not in seen, "only_options_that_were_given",
           seen[-500:])
# times in the unit in which the end is one or more; what several processes mean; a part in mm
for end, unit, factor in (("2", "s", 1), ("2e-3", "ms", 1e3), ("3e-5", "us", 1e6)):
    seen = runs.start(CALM + f"-time_step 1e-5 -time_end {end} -output_dir {runs.scratch('unit' + unit)}").stdout
    last = re.findall(r"^t = +(\S+) (\S+)  step +3 ", seen, re.M)
    runs.check(last == [(f"{3e-5 * factor:.3f}", unit)], f"time_in_{unit}", str(last) + seen[-300:])
crowd = os.cpu_count() + 1
seen = runs.start(CALM + f"-output_dir {runs.scratch('crowd')}", ranks=crowd).stdout
runs.check(re.search(rf"Processes: {crowd}, of \d+ particles each", seen) and
           re.search(rf"Processes: {crowd}, besides \S+ programs", seen), "processes_that_do_not_pay", seen[-1500:])
with open(runs.scratch("part.stl"), "w", encoding="utf-8") as file:
    file.write("solid part\n")
    corners = ((0, 0, 0), (0, 100, 0), (100, 0, 0), (0, 0, 100))
    for face in ((0, 1, 2), (0, 2, 3), (0, 3, 1), (2, 1, 3)):
        file.write("facet normal 0 0 0 outer loop" + "".join(
            f" vertex {corners[k][0]} {corners[k][1]} {corners[k][2]}" for k in face) + " endloop endfacet\n")
    file.write("endsolid part\n")
SOLID = "-spacing 0.05 -box_lower 0,0,0 -box_upper 1,1,1 -box_zmin wall -bodies a -a_lower 0.2,0.2,0.2 " \
    f"-steps_max 1 -solids part -part_shape stl -part_file {file.name} -dry_run -output_dir {runs.scratch('mm')} "
for more, there in (("", True), ("-part_scale 1e-3", False)):
    seen = runs.start(SOLID + more)
    runs.check(("give -part_scale 1e-3" in seen.stdout) == there, f"part_in_mm_{there}",
               seen.stdout[:300] + seen.stderr)

# -help WORD: the options that have it in name, meaning, group or choice, and no others
text = runs.start("-help Hysteresis").stdout
names = re.findall(r"^  (-\S+)", text, re.M)
runs.check("-wall_contact_hysteresis" in names and "-<body>_contact_hysteresis" in names and
           len(text.splitlines()) < 20 and "Petsc" not in text, "help_on_a_word", text[:600])
SYNONYMS = {"torque": "-gauge_moments", "drag": "-gauge_forces", "buoyancy": "-gauge_forces", "probe": "-gauge_points",
            "wetting": "-wall_contact_angle", "resolution": "-spacing", "adaptive": "-spacing_follow",
            "inflow": "_type", "vtk": "-snapshot_i", "parallel": "-ranks", "resume": "-restart", "bubble": "-gas",
            "paddle": "_motion_file", "gamg": "-pc_gamg_threshold", "ksp_rtol": "  -ksp_rtol", "sor": "-pc_sor_omega"}
for word, option in SYNONYMS.items():
    text = runs.start(f"-help {word}").stdout
    runs.check(option in text and text.count("\n  -pc_type ") < 2, f"help_on_{word}", text[:600])
text = runs.start("-help -pc_type sor").stdout
runs.check("-ksp_rtol" in text and "-pc_sor_omega" in text and "-pc_gamg" not in text, "help_on_the_solver",
           text[-600:])
text = runs.start("-help rewrites -dry_run")
runs.check(text.returncode and "no option has that" in text.stderr, "help_on_nothing", text.stderr)
meaning = runs.start(["-help", "body force"]).stdout
runs.check("-packing_relaxation_time" in meaning, "help_on_a_meaning", meaning[:600])
version = runs.start("-version").stdout
runs.check(version.startswith("isph ") and "PETSc" in version, "version", version[:300])

# A scheme that repairs the density at once warns of a packing that it would set in motion, and of no other.
WARNING = "warning: this scheme corrects that density in the first step"
for name, options, due in ("uneven", "", True), ("even", "-packing_type poisson ", False):
    has_it = WARNING in log(runs.run(CALM + "-scheme density_invariant " + options, name))
    runs.check(has_it == due, f"warning_of_the_packing_{name}", log(runs.scratch(name))[-800:])
runs.check(WARNING not in log(runs.run(CALM, "repaired_gradually")), "warning_of_the_packing_of_the_default_scheme")

# The lattice fills an emitter's shape with whole particles: a slit of 10.6 spacings has 11 in a row, one of 10 has 10.
# A jet without gaps has its flux all the same, since its rows are farther apart; single fillings have too much.
SLIT = """-dimension 2 -spacing 0.01 -box_lower -0.2,0 -box_upper 0.2,0.4 -bodies jet -jet_type emitter -steps_max 2
 -jet_velocity 0,-1 -packing_jitter 0 -jet_lower -{0},0.3 -jet_upper {0},0.35 """
for width, gaps, share in (("0.053", "-jet_interval 0.1 ", "+3.8 %"), ("0.053", "", ""), ("0.05", "", "")):
    text = log(runs.run(SLIT.format(width) + gaps, f"slit_{width}{gaps[4:8]}"))
    warned = re.search(r"a filling of the emitter jet has (\S+ %) of the volume of its shape", text)
    runs.check((warned[1] if warned else "") == share, f"flux_of_a_slit_of_{width}{gaps}", text[-1500:])
    said = runs.start(SLIT.format(width) + gaps + f"-dry_run -output_dir {runs.scratch('dry_slit')}").stdout
    runs.check(f"a filling of {0.0055 if share else 0.1 * float(width):g} m2, {share or '-0.0 %'}" in
               said.replace("+0.0", "-0.0"), f"dry_run_of_a_slit_of_{width}{gaps}", said[-1500:])

# A folder where nothing has run yet.
fresh = os.path.join(runs.scratch("fresh"), "output", "run")
done = runs.start(SLIT.format("0.05") + f"-dry_run -output_dir {fresh}")
runs.check(done.returncode == 0 and os.path.exists(fresh + ".svg") and not os.path.exists(fresh),
           "dry_run_in_a_fresh_folder", done.stderr)

text = log(runs.run("-options_file cases/jet/rings.opts -steps_max 1", "jet_of_rings"))
runs.check("of the volume of its shape" not in text, "flux_of_a_jet_of_rings", text[-1500:])

# What walls that move put in and viscosity takes out: a little of it is missing, not a tenth of what remains.
CAVITY = """-dimension 2 -spacing 0.0625 -box_lower 0,0 -box_upper 1,1 -box_x wall -box_y wall -box_ymax_velocity 1,0
 -bodies a -a_viscosity 10 -time_end 2"""
text = log(runs.run(CAVITY, "cavity"))
found = [re.search(pattern, text) for pattern in (r"viscosity gave (\S+),", r"friction of walls that move (\S+)\n",
                                                  r"residual \S+ J/m, (\S+) %")]
if runs.check(all(found), "budget_of_a_cavity", text[-800:]):
    dissipated, driven, share = (float(m[1]) for m in found)
    runs.check_within(-dissipated / driven, 0.85, 1, "a_cavity_dissipates_what_its_lid_puts_in")
    runs.check_within(share, -4, 1, "the_residual_is_a_share_of_that_in_per_cent")
# Two drops collide without gravity: the loss is a share of the energy at impact, not of what was exchanged.
text = log(runs.run("-options_file cases/drop_collision/case.opts -spacing 0.1e-3 -left_tension 0 -right_tension 0 "
                    "-time_end 3e-3", "collision"))
kinetic = runs.series(runs.scratch("collision"))["kinetic_energy"]
found = re.search(r"residual -(\S+) J/m, -(\S+) % of the largest kinetic energy: no more than one impact", text)
if runs.check(found is not None, "loss_of_a_collision", text[-900:]):
    runs.check_within(float(found[2]) / (100 * float(found[1]) / kinetic.max()), 0.97, 1.03, "share_of_a_loss")

# By which faces liquid left.
text = log(runs.run("-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 1,1 -box_xmin wall -bodies a,b "
                    "-a_upper 0.1,0.5 -b_lower 0.9,0.5 -b_upper 1,1 -a_velocity 0,-5 -b_velocity 5,0 -time_end 0.01",
                    "leaving"))
found = re.search(r"(\d+) particles left through open faces \(xmax (\d+), ymin (\d+)\)", text)
runs.check(found and int(found[1]) == int(found[2]) + int(found[3]) and int(found[2]) >= 10 and 1 < int(found[3]) < 5,
           "faces_by_which_liquid_left", text[-900:])
# Syrup: tension gives what viscosity takes, both measured to tens of per cent; no energy has grown, and the line says
# how far the measurement goes.
SYRUP = """-dimension 2 -spacing 0.2e-3 -box_lower -4e-3,-3e-3 -box_upper 4e-3,3e-3 -bodies a,b -a_shape sphere
 -a_radius 1e-3 -a_center -1e-3,0 -a_viscosity 10 -a_tension 0.072 -b_shape sphere -b_radius 1e-3 -b_center 1e-3,0
 -b_viscosity 10 -b_tension 0.072 -time_end 0.03 """
text = log(runs.run(SYRUP, "syrup"))
runs.check("energy has grown" not in text and "-time_cfl" not in text and re.search(
    r"within the error of its measurement, \S+ J/m", text), "syrup_gains_no_energy", text[-900:])
CUT = CALM + "-box_x periodic -a_upper 0.3,0.3 "
for lower, due in (("-0.2,0", ["warning: a is cut at the periodic face xmin", "m away"]), ("0,0", [])):
    text = log(runs.run(CUT + f"-a_lower {lower}", f"from_{lower[0:4]}"))
    runs.check(all(word in text for word in due) and ("is cut" in text) == bool(due), f"cut_at_{lower}", text[-800:])
runs.done()
