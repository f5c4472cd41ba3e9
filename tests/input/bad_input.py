#!/usr/bin/python3
"""Bad input ends the program before the first step, in seconds, with a non-zero code and one line on standard error:
'isph: error: <sentence>', no trace; and with nothing lost of what was there."""
import hashlib
import os
import shutil
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

SECONDS = 20  # a refusal takes less than one; the machine may be busy
BOX = """-spacing 1 -box_lower 0,0,0 -box_upper 10,10,20 -box_zmin wall -gravity 0,0,-1 -steps_max 2
 -progress_interval 0 """
POOL = "-bodies film -film_upper 10,10,5 "
GOOD = BOX + POOL
DROP = "-bodies film,drop -film_upper 10,10,5 -drop_shape sphere -drop_radius 2 -drop_center 5,5,12 "
EMITTER = "-bodies film,jet -jet_type emitter -jet_lower 0,0,10 -jet_upper 2,2,12 -jet_velocity 0,0,-1 "
pipe = runs.scratch("pipe.opts")
os.mkfifo(pipe)


def refused(name, options, words, ranks=1, folder=None):
    """The options must be refused with a sentence that holds all the words."""
    path = folder or runs.scratch(name.replace(" ", "_"))
    began = time.time()
    process = runs.start(options + f" -output_dir {path}", ranks)
    took = time.time() - began
    lines = [line for line in process.stderr.splitlines() if line.strip()]
    if ranks > 1:  # mpiexec adds its own farewell
        lines = [line for line in lines if "isph: error:" in line or "PETSC" in line]
    series = os.path.join(path, "series.csv")
    steps = 0
    if folder is None and os.path.exists(series):
        with open(series, encoding="utf-8") as file:
            steps = max(0, len(file.readlines()) - 1)
    why = f"code {process.returncode}, {took:.1f} s, {steps} series lines: {process.stderr.strip()[:400]!r}"
    good = process.returncode > 0 and len(lines) == 1 and lines[0].startswith("isph: error: ") and steps == 0
    runs.check(good and took < SECONDS and all(word in lines[0] for word in words), name, why)


def checksums(folder):
    """A checksum of each file of a folder."""
    sums = {}
    for name in sorted(os.listdir(folder)):
        with open(os.path.join(folder, name), "rb") as file:
            sums[name] = hashlib.sha256(file.read()).hexdigest()
    return sums


def core():
    """Options, files of them, and what is said of them."""
    refused("unknown_option", GOOD + "-gravitty 0,0,-1", ["-gravitty", "did you mean", "-gravity"])
    for handler in ("-on_error_abort", "-on_error_mpiabort"):
        refused("no_error_for" + handler, f"{GOOD} {handler} -gravitty 0,0,-1", ["-gravitty"])
    refused("unknown_option_parallel", GOOD + "-time_stepp 1", ["-time_stepp", "-time_step"], 2)
    for name, words in (("-spacing 0.1cP", ["is 0.1cP", "a number", "in m,", "mm, cm behind it"]),
                        ("-spacing 0.1,0.2", ["-spacing is 0.1,0.2; a number is wanted"]),
                        ("-spacing 100 mm", ["100 mm stands in two words", "100mm"]),
                        ("-kernel_ratio 1mm", ["is 1mm", "with nothing"]),
                        ("-steps_max 1s", ["is 1s", "with nothing"]),
                        ("-gravity 0,0,", ["is 0,0,;", "single commas", "in m/s2,"]),
                        ("-gravity 0,,1", ["single commas"]), ("-gravity ,0,1", ["single commas"]),
                        ("-gravity 0,0,x", ["single commas"]),
                        ("-film_upper 1mm,1,1", ["in m,", "behind the last or each"]),
                        ("-steps_max 1e3", ["is 1e3", "a whole number is wanted, with"]),
                        ("-gauge_heights 1,1ms", ["in m,"]), ("-gravity 0,0, -1", ["is 0,0,"]),
                        ("-gravity 0,0 ,1", ["0,0,1 stands in two words"]),
                        ("-film_contact_angle none", ["nothing reads"])):
        refused("number" + name.replace("/", ""), GOOD + name, words)
    refused("unknown_option_far", GOOD + "-quite_something_else 1", ["-quite_something_else"])
    refused("no_scene", "", ["no scene", "-options_file", "-help"])
    refused("file_that_is_missing", "my.opts", ["my.opts", "cannot be opened"])
    refused("file_behind_options", GOOD + "-gravity 0,0,-1 my.opts", ["my.opts", "-options_file my.opts"])
    for name, meant in (("-drop_radus", "-drop_radius?"), ("-drp_velocity", "-drop_velocity?"),
                        ("-box_xmim", "-box_xmin?"), ("-ksp_rtoll", "-ksp_rtol?"), ("-pc_typ", "-pc_type?"),
                        ("-viscous_ksp_rtoll", "-viscous_ksp_rtol?"), ("-log_vieww", "-log_view?"),
                        ("-mg_levels_ksp_max_itt", "-mg_levels_ksp_max_it?"), ("-time_stpe", "-time_step?"),
                        ("-spectrumm", "-spectrum?"), ("-rotation_rate", "-drop_rotation_rate?"),
                        ("-drop_rotation_rate", "it belongs to -drop_velocity_type rotation"),
                        ("-packing_tolerance", "it belongs to -packing_type poisson"),
                        ("-pc_gamg_threshold", "it belongs to -pc_type gamg"),
                        ("-pc_ml_Threshold", "it belongs to -pc_type ml")):
        refused(f"meant_by{name}", BOX + DROP + f"{name} 7", [name, meant])
    for name in ("-dt", "-q", "-quite_something_else"):
        process = runs.start(BOX + DROP + f"{name} 7")
        runs.check(process.returncode == 1 and name in process.stderr and "did you mean" not in process.stderr,
                   f"nothing_is_like{name}", process.stderr)
    refused("misspelt_before_the_packing", BOX + DROP + "-spacing 0.03 -gravitty 0,0,-1", ["-gravitty", "-gravity?"])
    refused("misspelt_and_needed", BOX + "-bodies a -a_shape sphere -a_radus 2", ["-a_radius is missing", "-a_radus"])
    refused("body_without_shape", BOX + "-bodies film,drop -film_upper 10,10,5 -drop_shap sphere",
            ["drop", "no shape", "-drop_shape", "-drop_shap "])
    scene = runs.scratch("scene.opts")
    with open(scene, "w", encoding="utf-8") as file:
        file.write((GOOD + f"-output_dir {runs.scratch('of_file')} -output_overwrite").replace(" -", "\n-"))
    for name, words in (("bare_file", [scene]), ("bare_files", [scene, "options/fast.opts"]),
                        ("bare_file_and_options", [scene, "-steps_max", "1"]), ("version", ["--version"]),
                        ("help", ["--help"]), ("h", ["-h"]), ("file_and_help", [scene, "-h"])):
        process = runs.start(words)
        runs.check(process.returncode == 0 and not process.stderr, name, process.stderr)
    refused("missing_option_file", GOOD + "-options_file /nowhere/case.opts", ["/nowhere/case.opts"])
    refused("missing_option_file_two_ranks", GOOD + "-options_file /nowhere/case.opts", ["/nowhere/case.opts"], ranks=2)
    own = runs.scratch("own.opts")
    with open(own, "w", encoding="utf-8") as file:
        file.write(f"-spacing 1\n-options_file {own}\n")
    refused("options_file_of_itself", GOOD + f"-options_file {own}", [own])
    refused("options_file_of_itself_any_case", GOOD + f"-Options_File {own}", [own])
    refused("options_file_of_itself_parallel", GOOD + f"-options_file {own}", [own], 2)
    refused("options_file_without_end", GOOD + "-options_file /dev/zero", ["/dev/zero", "regular"])
    os.environ["PETSC_OPTIONS"] = f"-options_file {own}"
    refused("environment_names_file_of_itself", GOOD, ["PETSC_OPTIONS", "includes itself"])
    del os.environ["PETSC_OPTIONS"]
    home = os.environ.get("HOME", "")
    os.environ["HOME"] = runs.scratch("home")
    os.mkdir(os.environ["HOME"])
    with open(os.path.join(os.environ["HOME"], ".petscrc"), "w", encoding="utf-8") as file:
        file.write(f"-OPTIONS_FILE {own}\n")
    refused("petscrc_names_file_of_itself", GOOD, [".petscrc", "includes itself"])
    os.environ["HOME"] = home
    refused("options_file_is_a_pipe", GOOD + f"-options_file {pipe}", [pipe, "pipe"])
    refused("stl_is_a_pipe", GOOD + f"-solids s -s_shape stl -s_file {pipe}", [pipe, "cannot be read"])
    refused("clock_backwards", GOOD + "-checkpoint_wall_clock -1", ["-checkpoint_wall_clock"])
    refused("endless_start", GOOD + "-time_start inf", ["-time_start"])
    refused("endless_relaxation", GOOD + "-packing_relaxation_time inf", ["-packing_relaxation_time"])
    for start in ("-1e6", "nan"):
        refused(f"emitter_start_{start}", GOOD + EMITTER + f"-jet_start {start}", ["-jet_start"])
    refused("dimension_of_33_bits", GOOD + "-dimension 4294967298", ["-dimension", "4294967298"])
    refused("steps_of_33_bits", GOOD + "-steps_max 4294967297", ["-steps_max", "4294967297"])
    refused("densities_too_far_apart",
            BOX + "-bodies a,b -a_upper 10,10,2 -b_lower 0,0,2 -b_upper 10,10,4 -b_density 3000",
            ["-b_density", "at most 2"])
    for late in ("-log_vieww", "-infoo x", "-options_lefft"):
        refused(f"unknown_option_of_petsc_{late}", GOOD + late, [late.split()[0]])


def scenes():
    """Scenes that cannot be."""
    PLANE = """-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 2,1 -box_ymin wall -gravity 0,-9.81 -bodies film
     -film_upper 2,0.2 -steps_max 200 -progress_interval 0 -solids part,post -part_lower 0.5,0.4 -part_upper 0.7,0.6
     -post_lower 1.2,0 -post_upper 1.4,0.8 """
    for name, options, words in (("leaves_the_box", "-part_velocity 0,10",
                                 ["the solid part moves out of the box at ymax"]),
                                 ("runs_into_another", "-part_velocity 10,0",
                                 ["the solid part moves into the solid post"])):
        process = runs.start(PLANE + options + f" -output_dir {runs.scratch('solid_' + name)}")
        runs.check(process.returncode > 0 and all(word in process.stderr for word in words + ["last good state"]),
                   f"solid_{name}", process.stderr)
    for name, options, words in (("leaves", "-part_velocity 0,1", ["the solid part moves out of the box at ymax"]),
                                 ("swings_out", "-part_oscillation_amplitude 0,0.5 -part_oscillation_frequency 3",
                                  ["the solid part moves out of the box at ymax"]),
                                 ("meets", "-part_velocity 1,0", ["the solid part moves into the solid post"])):
        refused(f"solid_{name}_later", PLANE + options + " -time_end 1", words + ["-time_end"])
    refused("solid_moves_with_printed_scheme", PLANE + "-part_velocity 1,0 -scheme density_invariant",
            ["-scheme consistent"])
    refused("relaxation_with_another_scheme", PLANE + "-packing_relaxation_time 1",
            ["-packing_relaxation_time", "-scheme density_invariant"])
    table = runs.scratch("way.csv")
    for name, text, words in (("no_table", "\xef\xbb\xbf0;0;0\n0,0,0\n1,0,0.2\n", ["line 1", "t,x,y"]),
                              ("jump", "0,0,0\n1e-9,0,0.2\n", ["0.2 m", "2e+08 m/s", "at most"])):
        with open(table, "w", encoding="latin-1") as file:
            file.write(text)
        refused("motion_" + name, PLANE + f"-part_motion_file {table}", ["-part_motion_file"] + words)
    FLOAT = PLANE.replace("part,post", "part").split(" -post")[0] + " -part_mass 50 "
    for name, options, words in (("printed_scheme", "-scheme density_invariant", ["-scheme consistent"]),
                                 ("density_source", "-pressure_source density", ["-pressure_source divergence"]),
                                 ("two_densities",
                                  "-bodies film,oil -oil_density 900 -oil_lower 0,0.5 -oil_upper 0.3,0.8",
                                  ["-<body>_density"]),
                                 ("direct_solver", "-ksp_type preonly -pc_type lu", ["-ksp_type preonly", "mass"]),
                                 ("frame", "-frame_rotation_rate 1 -gravity 0,0", ["-frame_rotation_rate"]),
                                 ("moved_too", "-part_motion_file way.csv", ["-part_m"]),
                                 ("no_mass", "-part_mass 1e-300", ["-part_mass", "must lie in"]),
                                 ("all_mass", "-part_mass 1e300", ["-part_mass", "must lie in"]),
                                 ("no_inertia", "-part_inertia 1e-300", ["-part_inertia", "must lie in"]),
                                 ("speed", "-part_velocity 0,1e300", ["solid part", "m/s are allowed"])):
        refused("free_body_and_" + name, FLOAT + options, words)
    LIQUIDS = """-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 2,1 -bodies drop,bath,top -drop_upper 0.5,0.5
     -bath_lower 0.5,0 -bath_upper 1.5,0.5 -top_lower 1.5,0 -top_upper 2,0.5 -interface_tension 1 -steps_max 2 """
    for name, options, words in (("three_bodies", "", ["-interface_bodies", "3"]),
                                 ("all_bodies", "-interface_bodies drop,bath,top", ["all of -bodies"]),
                                 ("no_such_body", "-interface_bodies oil", ["oil"]),
                                 ("two_tensions", "-interface_bodies drop -bath_tension 1",
                                  ["-bath_tension", "-top_tension"]),
                                 ("no_interface", "-interface_tension 0 -interface_bodies drop",
                                  ["-interface_tension"]),
                                 ("cahn_hilliard", "-interface_bodies drop -tension_type cahn_hilliard", ["curvature"]),
                                 ("printed_scheme", "-interface_bodies drop -scheme density_invariant", ["consistent"]),
                                 ("contact_angle", "-interface_bodies drop -box_ymin wall -wall_contact_angle 60",
                                  ["90"]),
                                 ("grading", "-interface_bodies drop -spacing_coarse 0.1 -fine f -f_upper 0.5,1",
                                  ["-interface_tension", "-spacing_coarse"])):
        refused("interface_and_" + name, LIQUIDS + options, words)
    refused("overlap_and_poisson", LIQUIDS + "-interface_bodies drop -bodies_overlap -packing_type poisson",
            ["lattice"])
    refused("hysteresis_beyond_0", GOOD + "-wall_contact_angle 30 -wall_contact_hysteresis 60", ["hysteresis",
                                                                                                 "(0, 180)"])
    refused("hysteresis_of_solid_without_angle", PLANE + "-part_contact_hysteresis 20", ["-part_contact_angle"])
    refused("hysteresis_with_printed_scheme",
            GOOD + "-film_tension 1 -wall_contact_hysteresis 9 -scheme density_invariant",
            ["-scheme consistent"])
    refused("contact_angle_of_free_body", FLOAT + "-part_contact_angle 60", ["-part_contact_angle", "-part_mass"])
    refused("contact_angle_of_open_face", GOOD + "-box_xmin_contact_angle 60", ["-box_xmin_contact_angle", "open"])
    refused("contact_angle_of_solid_with_cahn_hilliard", PLANE + "-part_contact_angle 60 -tension_type cahn_hilliard",
            ["-<solid>_contact_angle", "curvature"])
    refused("floating_point_traps", GOOD + "-fp_trap", ["-fp_trap"])
    refused("view_of_the_swarm", GOOD + "-dm_view", ["-dm_view", "DMSwarm", "-snapshot_interval"])
    refused("entries_of_no_matrix", GOOD + f"-ksp_view_mat binary:{runs.scratch('entries')}",
            ["-ksp_view_mat", "-mat_type aij"])
    runs.check(not os.path.exists(runs.scratch("entries")), "entries_of_no_matrix_leave_no_file")
    refused("spacing_too_small", GOOD + "-spacing 1e-9", ["-spacing", "room for"])
    refused("more_than_the_memory", GOOD + "-spacing 0.01", ["-spacing", "memory"])
    refused("negative_spacing", GOOD + "-spacing -1", ["-spacing"])
    refused("zero_spacing", GOOD + "-spacing 0", ["-spacing"])
    refused("text_for_number", GOOD + "-spacing abc", ["abc", "-spacing"])
    refused("text_for_number_parallel", GOOD + "-spacing abc", ["abc", "-spacing"], 2)
    refused("text_in_vector", GOOD + "-box_lower 0,x,0", ["x", "-box_lower"])
    refused("fraction_for_whole", GOOD + "-steps_max 1.5", ["1.5", "-steps_max"])
    refused("snapshot_field", GOOD + "-snapshot_fields pressure,speed", ["-snapshot_fields", "speed", "velocity"])
    refused("snapshot_corner_short", GOOD + "-snapshot_lower 0", ["-snapshot_lower", "three numbers"])
    refused("snapshot_region_outside", GOOD + "-snapshot_lower 1e3,1e3,1e3 -snapshot_upper 2e3,2e3,2e3",
            ["-snapshot_upper"])
    refused("snapshot_compression", GOOD + "-snapshot_compression 10", ["-snapshot_compression", "10", "9"])
    refused("text_for_switch", GOOD + "-snapshot_double perhaps", ["perhaps", "-snapshot_double"])
    refused("unknown_choice", GOOD + "-viscosity_wall both", ["both", "-viscosity_wall", "rest", "linear"])
    refused("pressure_regularization", GOOD + "-pressure_regularization -1", ["-pressure_regularization", "[0, inf)"])
    refused("unknown_scheme", GOOD + "-scheme magic", ["magic", "consistent", "density_invariant"])
    refused("solid_named_as_body", GOOD + "-solids film", ["-solids", "film", "twice"])
    refused("emitter_at_rest", GOOD + "-bodies film,jet -jet_type emitter -jet_lower 0,0,10 -jet_upper 2,2,12",
            ["-jet_velocity"])
    refused("unknown_body_type", GOOD + "-film_type gas", ["gas", "liquid", "emitter"])
    refused("shaken_without_frequency", GOOD + "-gravity_amplitude 1,0,0", ["-gravity_frequency"])
    refused("stl_missing", GOOD + "-solids s -s_shape stl -s_file /nowhere.stl", ["/nowhere.stl"])
    refused("stl_is_text", GOOD + "-solids s -s_shape stl -s_file README.md", ["README.md", "no whole STL file"])
    open_stl = runs.scratch("open.stl")
    with open(open_stl, "w", encoding="utf-8") as file:
        file.write("solid one\nfacet normal 0 0 1\nouter loop\nvertex 1 1 1\nvertex 5 1 1\nvertex 1 5 1\nendloop\n"
                   "endfacet\nendsolid\n")
    refused("stl_not_closed", GOOD + f"-solids s -s_shape stl -s_file {open_stl}", ["not closed", "3 edges"])
    refused("height_outside", GOOD + "-gauge_heights 50,0", ["-gauge_heights", "50"])
    refused("film_outside", GOOD + "-gauge_film 1,1,5,50", ["-gauge_film", "y = 50", "line 1"])
    refused("film_incomplete", GOOD + "-gauge_film 1,1,5", ["-gauge_film", "3 numbers", "4 a line"])
    FLAT = "-spacing 1 -box_lower 0,0 -box_upper 9,9 -bodies a -a_upper 5,5 -steps_max 1 -gravity 0,-1 "
    refused("neck_across", FLAT + "-dimension 2 -gauge_neck z", ["-gauge_neck is z", "x or y"])
    refused("neck_of_rings", FLAT + "-dimension axisymmetric -gauge_neck x", ["-gauge_neck is x", "axis of the rings"])
    refused("unknown_solver", GOOD + "-ksp_type magic", ["magic", "-ksp_type"])
    refused("preconditioner_of_one_rank", GOOD + "-pc_type ilu", ["-pc_type ilu", "mpiaij", "jacobi"], 2)
    refused("side_that_cannot_be", GOOD + "-ksp_pc_side right", ["-ksp_pc_side right", "RIGHT"], 2)
    refused("matrix_that_cannot_be", GOOD + "-mat_type blockmat", ["-mat_type blockmat", "aij"])
    refused("scaled_equation", GOOD + "-ksp_diagonal_scale", ["-ksp_diagonal_scale", "-pc_type jacobi"])
    refused("unknown_preconditioner", GOOD + "-pc_type magic", ["magic", "-pc_type"])
    refused("missing_bodies", BOX, ["-bodies"])
    refused("overlapping_bodies", BOX + "-bodies a,b -a_upper 10,10,5 -b_lower 0,0,4 -b_upper 10,10,8", ["overlap"])
    refused("holes_that_touch", GOOD + "-solids s -s_lower 0,0,8 -s_upper 10,10,16 -s_holes a,b -a_lower 3,3,8"
            " -a_upper 7,7,12 -b_lower 3,3,12 -b_upper 7,7,16", ["a and b of s touch at", "overlap by a spacing, 1 m"])
    HOLE = FLAT + "-dimension 2 -a_holes h -h_shape sphere -h_radius 1 -h_center 2,2 "
    refused("hole_named_twice", HOLE + "-a_holes h,h", ["-a_holes", "h appears twice"])
    refused("pressure_of_a_hole_without_gas", HOLE + "-h_pressure 2e5", ["-<hole>_pressure needs -gas"])
    refused("pressure_of_the_air_without_gas", FLAT + "-dimension 2 -gas_pressure 2e5", ["-gas_pressure", "to -gas"])
    refused("level_that_is_no_number", FLAT + "-dimension 2 -box_xmax_level nan", ["-box_xmax_level is nan", "inf"])
    refused("thin_periodic_box", GOOD + "-box_upper 2,10,20 -box_x periodic -film_upper 2,10,5", ["x"])
    refused("thin_symmetry_box", GOOD + "-box_upper 2,10,20 -box_x symmetry -film_upper 2,10,5", ["x"])
    refused("periodic_against_wall", GOOD + "-box_xmin periodic -box_xmax wall", ["periodic"])
    refused("empty_box", GOOD + "-box_upper 0,0,0", ["-box_upper"])
    refused("no_end", "-spacing 1 -box_lower 0,0,0 -box_upper 10,10,20 -gravity 0,0,-1 " + POOL, ["-time_end"])
    refused("end_before_start", GOOD + "-time_start 1 -time_end 0.5", ["-time_end", "-time_start"])
    refused("no_particles", BOX + "-bodies a -a_shape sphere -a_radius 1 -a_center 50,50,50", ["a"])
    SMALL = "-bodies film,drop -drop_shape sphere -drop_radius 0.1 -drop_center 5,5,10 "
    for n in (1, 2):
        refused(f"body_too_small_{n}", GOOD + SMALL, ["body drop", "too small"], n)
    refused("solid_too_small", GOOD + "-solids rod -rod_lower 2.1,2,7 -rod_upper 2.2,5,9", ["solid rod", "too small"])
    refused("nothing_moves", GOOD + "-gravity 0,0,0", ["-time_step"])
    refused("negative_density", GOOD + "-film_density -1", ["-film_density"])


def folders():
    """Folders, checkpoints, and combinations that are refused."""
    # the output folder: what a former run left is not touched
    good = runs.run(GOOD, "good")
    before = checksums(good)
    refused("folder_of_a_run", GOOD, [good, "-output_overwrite"], folder=good)
    runs.check(checksums(good) == before, "folder_of_a_run_unchanged", "files differ")
    blocked = runs.scratch("blocked")
    with open(blocked, "w", encoding="utf-8") as file:
        file.write("a file\n")
    refused("folder_is_a_file", GOOD, [blocked], folder=blocked)

    # checkpoints
    checkpoint = runs.numbered(good, "checkpoint")[-1]
    size = os.path.getsize(checkpoint)
    broken = runs.scratch("broken.h5")
    for share in (0, 0.1, 0.5, 0.99):
        shutil.copy(checkpoint, broken)
        os.truncate(broken, int(size * share))
        refused(f"truncated_to_{share}", GOOD + f"-restart {broken}", [broken])
    shutil.copy(checkpoint, broken)
    with open(broken, "r+b") as file:
        file.seek(size // 2)
        byte = file.read(1)
        file.seek(size // 2)
        file.write(bytes([byte[0] ^ 1]))
    refused("one_bit_wrong", GOOD + f"-restart {broken}", [broken])
    refused("foreign_hdf5", GOOD + f"-restart {runs.numbered(good, 'snapshot')[-1]}", ["checkpoint"])
    refused("foreign_text", GOOD + f"-restart {os.path.join(good, 'series.csv')}", ["checkpoint"])
    refused("missing_checkpoint", GOOD + "-restart /nowhere/checkpoint_000001.h5", ["/nowhere/checkpoint_000001.h5"])
    refused("checkpoint_of_other_spacing", GOOD + f"-spacing 0.5 -restart {checkpoint}", ["spacing"])
    two = "-bodies a,b -a_upper 10,10,2 -b_lower 0,0,2 -b_upper 10,10,4 "
    refused("checkpoint_of_other_bodies", BOX + two + f"-restart {checkpoint}", ["bodies"])
    for changed, words in (("-box_upper 10,10,30", ["-box_upper", "10,10,20", "10,10,30"]), ("-box_z wall",
                                                                                             ["-box_zmax"]),
                           ("-film_density 900", ["-film_density", "1000", "900"]),
                           ("-film_upper 10,10,6", ["-film_upper (there 10,10,5, here 10,10,6)"]),
                           ("-film_velocity 1,0,0", ["-film_velocity (there 0,0,0, here 1,0,0)"]),
                           ("-kernel_type wendland_c2", ["-kernel_type"]),
                           ("-solids s -s_upper 2,2,2", ["solid 1 of -solids", "s"])):
        refused(f"checkpoint_with{changed}".replace(" ", "_"), GOOD + f"{changed} -restart {checkpoint}",
                [checkpoint, "another scene"] + words)
    refused("checkpoint_of_other_box_parallel", GOOD + f"-box_upper 10,10,30 -restart {checkpoint}", ["-box_upper"], 2)
    swapped = runs.numbered(runs.run(BOX + two, "swapped"), "checkpoint")[-1]
    refused("checkpoint_of_swapped_bodies", BOX + two + f"-bodies b,a -restart {swapped}", ["body 1 of -bodies", "a",
                                                                                            "b"])
    table = runs.scratch("table.csv")  # under another name it is the same, with another number it is not
    moved = GOOD + "-solids s -s_lower 4,4,8 -s_upper 6,6,12 -s_motion_file "
    for name, last in ((table, 2), (table + "2", 2), (table + "3", 3)):
        with open(name, "w", encoding="utf-8") as file:
            file.write(f"0,0,0,0\n9,0,0,{last}\n")
    driven = runs.numbered(runs.run(moved + table, "driven"), "checkpoint")[-1]
    runs.run(moved + f"{table}2 -steps_max 1 -restart {driven}", "driven_on")
    refused("checkpoint_of_other_motion", moved + f"{table}3 -restart {driven}", ["-s_motion_file (there a file of"])
    corners = ((4, 4, 8), (6, 4, 8), (4, 6, 8), (4, 4, 11))
    for name, shift in ((table + ".stl", 0), (table + "2.stl", 0), (table + "3.stl", 0.5)):
        facets = ["facet normal 0 0 0\nouter loop\n" +
                  "".join(f"vertex {corners[k][0] + shift} {corners[k][1]} {corners[k][2]}\n" for k in facet) +
                  "endloop\nendfacet\n" for facet in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))]
        with open(name, "w", encoding="utf-8") as file:
            file.write("solid s\n" + "".join(facets) + "endsolid s\n")
    shaped = GOOD + "-solids s -s_shape stl -s_file "
    stood = runs.numbered(runs.run(shaped + table + ".stl", "stood"), "checkpoint")[-1]
    runs.run(shaped + f"{table}2.stl -steps_max 1 -restart {stood}", "stands_on")
    refused("checkpoint_of_other_stl", shaped + f"{table}3.stl -restart {stood}", ["-s_file (there a file of"])
    refused("checkpoint_is_the_end", GOOD + f"-time_end 1e-9 -restart {checkpoint}", ["-time_end"])
    refused("checkpoint_is_a_pipe", GOOD + f"-restart {pipe}", [pipe, "no readable file"])
    runs.check(checksums(good) == before, "checkpoint_folder_unchanged", "files differ")
    # a restart that is refused leaves the run of its folder as it was: in its own folder, and in another to be
    # overwritten
    early = runs.numbered(runs.run(GOOD + "-checkpoint_interval 1e-9", "early"), "checkpoint")[0]
    for name, folder in (("own", os.path.dirname(early)), ("other", good)):
        before = checksums(folder)
        for word, options in (("misspelt", "-gravitty 0,0,-1"), ("too_late", "-time_end 1e-9")):
            refused(f"restart_{word}_{name}_folder", GOOD + f"{options} -output_overwrite -restart {early}",
                    [options.split()[0]], folder=folder)
        runs.check(checksums(folder) == before, f"refused_restart_keeps_{name}_folder", "files differ")
    GRADED = GOOD + "-spacing_coarse 2 -fine core -core_shape sphere -core_radius 2 -core_center 5,5,5 "
    for name, meant in (("-scheme weakly_compressible", "-scheme weakly_compressible"),
                        ("-scheme density_invariant", "-scheme density_invariant"),
                        ("-shifting_conserved", "-shifting_conserved"), ("-pressure_gradient conserved", "conserved"),
                        ("-spectrum", "-spectrum"), ("-packing_type poisson", "-packing_type poisson"),
                        ("-tension_type cahn_hilliard", "-tension_type cahn_hilliard"),
                        ("-solids b -b_upper 1,1,1 -b_velocity 1,0,0", "a solid that moves")):
        refused(f"graded {name}", GRADED + name, [meant, "cannot be used with -spacing_coarse"])
    for name, meant in (("-spacing_follow edges", "choose from none, surface, curvature, auto"),
                        ("-spacing_follow surface", "-spacing_coarse (m) is missing"),
                        ("-spacing_follow surface -spacing_coarse 2 -particles_most -1", "[0, inf)")):
        refused(f"following {name}", GOOD + name, [name.split()[-2], meant])
    refused("graded from a checkpoint of one size", GRADED + f"-restart {checkpoint}", ["-spacing_coarse"])
    refused("graded unknown option", GRADED + "-core_radus 1", ["-core_radus", "did you mean", "-core_radius"])
    for name, more, words in (("velocity of a mirror", "-box_x symmetry -box_xmin_velocity 0,1,0",
                               ["the face is symmetry"]),
                              ("velocity into the box", "-box_zmin_velocity 0,0,1", ["must be tangential", "a solid"])):
        refused(name, GOOD + more, words)
    TURN = "-frame_rotation_rate 0,0,1 "
    for name, more, words in (("gravity", TURN + "-gravity 0,-1,0", ["-gravity", "along the axis"]),
                              ("periodic", TURN + "-box_x periodic", ["-box_xmin is periodic or symmetry"]),
                              ("one number", "-frame_rotation_rate 1",
                               ["-frame_rotation_rate must have three numbers"]),
                              ("scheme", TURN + "-scheme density_invariant", ["-frame_rotation_rate needs -scheme"])):
        refused("frame that turns, " + name, GOOD + more, words)
    refused("frame that turns, rings", "-options_file cases/free_fall/rings.opts -frame_rotation_rate 1",
            ["cannot be used with -dimension axisymmetric"])


PARTS = {part.__name__: part for part in (core, scenes, folders)}
for chosen in runs.parts(*PARTS):
    PARTS[chosen]()
runs.done()
