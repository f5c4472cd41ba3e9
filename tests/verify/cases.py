"""The list of verification runs: `make verify`, `make verify-long`, `make convergence` and the physics of `make test`
all read it, with tests/verify/runner.py. A new case is a folder in cases/ (options, README, check.py with check(folder)
returning a list of physics.Result) and an entry here."""
import re
from typing import NamedTuple

TEST, SHORT, LONG = "test", "short", "long"
SCHEMES = ("default", "reference scheme, as printed")
PRINTED = "-options_file options/printed.opts "


class Entry(NamedTuple):
    """One run and its check.

    case      folder in cases/
    label     tells the entries of a case apart
    options   after the case's file, relative to the top folder
    size      test: seconds, part of `make test`; short: up to a few minutes, `make verify`; long: `make verify-long`
    printed   of the reference scheme, as printed
    file      options file of the case
    spacings  of `make convergence`, from coarse to fine; none: not part of it
    named     of the program's own parts beside its defaults: "Cahn-Hilliard", say
    ranks     processes; entries with more than one run alone
    packings  the mean of so many is judged: of what scatters from one to the next
    """
    case: str
    label: str = ""
    options: str = ""
    size: str = SHORT
    printed: bool = False
    file: str = "case.opts"
    spacings: tuple = ()
    named: str = ""
    ranks: int = 1
    packings: int = 1

    @property
    def id(self):
        words = [self.case, re.sub(r"[^A-Za-z0-9.]+", "_", self.label),
                 self.named.replace(" ", "_") or ("printed" if self.printed else "")]
        return "-".join(w for w in words if w)

    @property
    def scheme(self):
        return self.named or SCHEMES[self.printed]


def both(case, label="", options="", size=SHORT, as_printed="", **more):
    """The entry and its twin with the reference scheme. options go to the entry alone, as_printed to the twin alone
    (after printed.opts), shared to both; twin_size: size of the twin, that of the entry if it is not given."""
    shared = more.pop("shared", "")
    twin_size = more.pop("twin_size", size)
    return [Entry(case, label, f"{shared} {options}".strip(), size, **more),
            Entry(case, label, f"{shared} {PRINTED}{as_printed}".strip(), twin_size, True, **more)]


RINGS = "rings.opts"  # the case's file for particles that are rings
LATTICE = "-packing_type lattice"
REGULAR = "-packing_jitter 0"
QUINTIC = "-kernel_type quintic_spline -kernel_ratio 1"
CORRECTED = "-pressure_gradient corrected"
CONSERVED = "-pressure_gradient conserved -shifting_conserved"
QUARTER = "-options_file options/quarter.opts -spacing "
# The printed scheme throws a block of particles apart in one step; its centre falls all the same.
LOOSE = LATTICE + " -displacement_max 1e6 -energy_max 0"
BLOCKS = {1: "0.01,0.01,0.01", 2: "0.02,0.01,0.01", 8: "0.02,0.02,0.02", 27: "0.03,0.03,0.03"}

ENTRIES = []
# free fall: to round-off
for n, upper in BLOCKS.items():
    ENTRIES += both("free_fall", f"{n} particles", "", TEST, LOOSE, shared="-a_upper " + upper, file="block.opts")
ENTRIES += both("free_fall", "2000 particles", CONSERVED, TEST)
ENTRIES += [Entry("free_fall", "rings", file=RINGS)]

# viscosity and walls
SHEAR = (1e-4, 5e-5, 3.125e-5, 2.5e-5)
ENTRIES += both("couette", "", "", TEST, LATTICE, spacings=SHEAR)
ENTRIES += both("poiseuille", "", "", TEST, LATTICE, spacings=SHEAR)
ENTRIES += [Entry("couette", "rings", file=RINGS), Entry("poiseuille", "rings", file=RINGS)]
IMPLICIT = "-viscosity_solver implicit -time_step_max 3e-3"
ENTRIES += [Entry("couette", "steps of 9 explicit limits", IMPLICIT, TEST),
            Entry("poiseuille", "steps of 9 explicit limits", IMPLICIT, TEST)]
# viscosity that depends on the shear rate
MODELS = {"power law, n = 0.5": "power_law -liquid_viscosity_exponent 0.5",
          "power law, n = 1.5": "power_law -liquid_viscosity_exponent 1.5",
          "Carreau": "carreau -liquid_viscosity_exponent 0.5 -liquid_viscosity_time 10 -liquid_viscosity_infinite 10",
          "Bingham": "herschel_bulkley -liquid_yield_stress 30"}
for model, numbers in MODELS.items():
    numbers = "-liquid_viscosity_model " + numbers
    ENTRIES += [Entry("poiseuille", model, numbers, TEST if "0.5" in model else SHORT, file="models.opts"),
                Entry("poiseuille", model + ", pipe", numbers, file="models_rings.opts")]
# polymers
MODELS = {"oldroyd_b": "", "giesekus": " -liquid_polymer_mobility 0.2", "fene_p": " -liquid_polymer_extensibility 100"}
ENTRIES += [Entry("elastic_channel", size=TEST), Entry("elastic_channel", "40 spacings", "-spacing 2.5e-5")]
ENTRIES += [Entry("elastic_channel", f"{model}, Wi 3", f"-liquid_polymer_model {model}{numbers} "
                  "-box_ymax_velocity 0.3,0 -liquid_strain_rate 0,300,0,0", TEST if model == "fene_p" else SHORT,
                  file="shear.opts")
            for model, numbers in MODELS.items()]
ENTRIES += [Entry("elastic_channel", "oldroyd_b, Wi 3, two spacings", "-box_ymax_velocity 0.3,0 -box_upper 1e-3,1e-3 "
                  "-liquid_strain_rate 0,300,0,0 -spacing_coarse 1e-4 -fine low -low_shape box -low_upper 1e-3,0.4e-3",
                  TEST, file="shear.opts"),
            Entry("elastic_channel", "oldroyd_b, Wi 100", "-spacing 1e-4 -box_upper 1e-3,1e-3 -box_ymax_velocity 1,0 "
                  "-liquid_strain_rate 0,1e3,0,0 -liquid_polymer_modulus 1 -liquid_relaxation_time 0.1 -time_end 0.6 "
                  "-snapshot_interval 0.1", file="shear.opts"),
            Entry("elastic_drop", size=TEST), Entry("elastic_drop", "half the spacing", "-spacing 0.125e-3"),
            Entry("jet", "pulse", file="pulse.opts"), Entry("jet", "elastic pulse", file="elastic.opts")]
ENTRIES += [Entry("elastic_thread", "small wave", "-thread_wave_amplitude 0.02e-3 -time_end 0.04", TEST),
            Entry("elastic_thread", size=TEST)]
ENTRIES += [Entry("film_on_slope", size=TEST), Entry("sinking_ball"), Entry("merging_threads"),
            Entry("squeeze_film"), Entry("shear_under_gravity", size=TEST),
            Entry("shear_under_gravity", "on a mirror", "-box_ymin symmetry", TEST), Entry("stokes_second", size=TEST),
            Entry("heated_cavity"), Entry("heated_cavity", "20 spacings", "-spacing 0.5e-3", TEST),
            Entry("heated_cavity", "onset, from above", file="onset.opts", size=TEST),
            Entry("heated_cavity", "onset, from below", "-liquid_thermal_expansion 2.297e-2", file="onset.opts"),
            Entry("marangoni_drop", size=TEST), Entry("marangoni_drop", "layer", file="layer.opts")]
ENTRIES += [Entry("column"), Entry("column", "newtonian", file="newtonian.opts")]

# solids that move
ENTRIES += [Entry("turning_box", size=TEST), Entry("dragged_cylinder"), Entry("piston"), Entry("stirred_tank"),
            Entry("floating_box"), Entry("floating_box", "sphere", file="sphere.opts"),
            Entry("coated_plate"), Entry("slot_jet"),
            Entry("slot_jet", "half the step", "-time_cfl 0.1"),
            Entry("slot_jet", "5 spacings in half the slot", "-spacing 1e-3", TEST),
            Entry("slot_jet", "20 spacings in half the slot", "-spacing 0.25e-3"),
            Entry("honey"), Entry("honey", "0.25 mm", "-spacing 0.25e-3", size=LONG),
            Entry("rotating_cup"),
            Entry("rotating_cup", "in a frame that turns", file="frame.opts")]

# no free surface; the start is a lattice with random displacements of up to a quarter spacing
VORTICES = (0.04, 0.02, 0.01)
VORTEX = "-time_centered -packing_jitter 0.25"
ENTRIES += both("taylor_green", "Re 100", VORTEX, TEST, twin_size=SHORT, spacings=VORTICES)
ENTRIES += [Entry("taylor_green", "Re 100, 100 x 100", VORTEX + " -spacing 0.01")]
ENTRIES += both("taylor_green", "Re 1000", VORTEX, shared="-water_viscosity 0.001", spacings=VORTICES)
ENTRIES += [Entry("taylor_green", "Re 1000, 100 x 100", VORTEX + " -water_viscosity 0.001 -spacing 0.01")]

# at rest
# A film of ten layers keeps its depth and the pressure at the floor with the symmetric gradient, stable up to some 20.
SHALLOW = QUINTIC + " -pressure_gradient symmetric -spacing 1e-3 -time_end 0.6"
ENTRIES += [Entry("film_at_rest", "film, 1 mm, 0.6 s", SHALLOW + " -gauge_forces", TEST)]
ENTRIES += both("film_at_rest", "film", spacings=(1e-3, 2e-3 / 3, 0.5e-3))
ENTRIES += [Entry("film_at_rest", "film, quintic spline", QUINTIC),
            Entry("film_at_rest", "film, dt 4e-5 s", SHALLOW + " -time_step 4e-5"),
            Entry("film_at_rest", "film, dt 1e-6 s", SHALLOW + " -time_end 1 -time_step 1e-6", LONG)]
ENTRIES += [Entry("film_at_rest", "tank, 0.05", REGULAR + " -spacing 0.05", TEST, file="tank.opts"),
            Entry("film_at_rest", "tank, 0.05, 60 s", REGULAR + " -spacing 0.05 -time_end 60", file="tank.opts")]
ENTRIES += both("film_at_rest", "tank", REGULAR, shared="-spacing 0.025", file="tank.opts", twin_size=TEST,
                spacings=(0.1, 0.05, 0.025))
ENTRIES += [Entry("film_at_rest", "rings", size=TEST, file=RINGS),
            Entry("film_at_rest", "graded, 0.5 to 1 mm", file="graded.opts"),
            Entry("film_at_rest", "stirred", size=TEST, file="stirred.opts"),
            Entry("film_at_rest", "following, 0.25 to 1 mm", "-time_end 0.4", file="following.opts"),
            Entry("film_at_rest", "rings, 0.25 to 0.5 mm", "-spacing 0.25e-3 -spacing_coarse 0.5e-3 -fine top "
                  "-top_lower 0,-3e-3 -top_upper 10e-3,5e-3", file=RINGS)]

# free surface without gravity: negative pressure, large deformation, long runs
FIRST = "-steps_max 6 -snapshot_interval 1e-5 -ksp_rtol 1e-8"
ENTRIES += both("square_patch", "first pressures", CORRECTED + " -packing_jitter 0 -pressure_relaxation_time 1e30",
                TEST, shared=FIRST)
ENTRIES += [Entry("square_patch", "first pressures, density term on", f"{FIRST} {CORRECTED} -packing_jitter 0", TEST)]
ENTRIES += both("square_patch", "half a turn", CONSERVED + " -pressure_regularization 0", TEST,
                spacings=(0.04, 0.02, 0.01))
ENTRIES += both("stretching_drop", "", CORRECTED, TEST, spacings=(0.08, 0.04, 0.02))
ENTRIES += [Entry("stretching_drop", "rings", size=TEST, file=RINGS)]
ENTRIES += both("central_force", "", CORRECTED, spacings=(0.08, 0.04, 0.02))
ENTRIES += [Entry("central_force", "R/d0 = 20", CORRECTED + " -spacing 0.05", TEST)]

# gravity and a free surface
WAVE = ""
ENTRIES += [Entry("standing_wave", "40 spacings", WAVE + " -spacing 0.025 -time_end 2", TEST)]
ENTRIES += [Entry("standing_wave", "50 spacings", WAVE + " -spacing 0.02", spacings=(0.04, 0.02, 0.0125)),
            Entry("standing_wave", "50 spacings", PRINTED + "-spacing 0.02", printed=True),
            Entry("standing_wave", "rings", WAVE, file=RINGS),
            Entry("standing_wave", "parametric resonance", "-gravity_amplitude 0,-2.943 -gravity_frequency 2.4944 "
                  "-water_wave_amplitude 2e-3 -spacing 0.02", TEST)]
PATCH = "-fine patch -patch_shape box -patch_lower 0.25,0.2 -patch_upper 0.75,0.6"
ENTRIES += [Entry("standing_wave", "graded, 50 spacings, 100 in a patch", f"-spacing_coarse 0.02 {PATCH}")]
ENTRIES += [Entry("dam_break", "collapse", REGULAR, TEST, spacings=(5.715e-3, 2.8575e-3, 1.42875e-3)),
            Entry("dam_break", "collapse", PRINTED, TEST, printed=True),
            Entry("dam_break", "collapse, 3-d", REGULAR, file="case_3d.opts"),
            Entry("dam_break", "impact", REGULAR, file="impact.opts", spacings=(0.03, 0.015, 0.0075)),
            Entry("dam_break", "impact, 3-d", REGULAR, LONG, file="impact_3d.opts"),
            Entry("dam_break", "trapped air", REGULAR, file="trapped.opts")]

# surface tension: with the default model, the paper's (calibrated for the program; as printed), and the whole scheme
# as printed
def tensions(case, label="", size=SHORT, spacings=(), coarse=(), as_printed="", **more):
    """The entry of the default, and those of other models beside it, at the coarse spacings; as_printed goes to the
    last alone."""
    paper = dict(more, size=SHORT, printed=True, spacings=coarse or spacings)
    ch = "-tension_type cahn_hilliard"
    return [Entry(case, label, size=size, spacings=spacings, **more),
            Entry(case, label, ch, named="Cahn-Hilliard", **paper),
            Entry(case, label, ch + " -tension_ratio 2.5 -tension_calibration 5.30", named="Cahn-Hilliard 2.5",
                  **paper),
            Entry(case, label, (PRINTED + as_printed).strip(), **paper)]


ENTRIES += tensions("laplace_jump", "2-d", TEST, (0.5e-3, 0.25e-3, 0.125e-3), file="circle.opts")
ENTRIES += [Entry("laplace_jump", f"2-d, seed {seed}", f"-packing_seed {seed}", file="circle.opts")
            for seed in range(2, 6)]
ENTRIES += tensions("laplace_jump", "3-d", spacings=(0.5e-3, 1e-3 / 3, 0.25e-3))
ENTRIES += [Entry("laplace_jump", "rings", file=RINGS), Entry("laplace_jump", "rings, R/d0 = 8", "-spacing 0.25e-3",
                                                               file=RINGS)]
ENTRIES += tensions("oscillating_drop", "2-d", spacings=(0.5e-3, 0.25e-3, 0.125e-3), file="circle.opts")
ENTRIES += tensions("oscillating_drop", "3-d", spacings=(0.5e-3, 0.25e-3, 0.125e-3),
                    coarse=(0.5e-3, 1e-3 / 3, 0.25e-3))
ENTRIES += [Entry("oscillating_drop", f"rings, n = {mode}{coarse}", f"-drop_wave_mode {mode}{spacing}", file=RINGS)
            for mode in (2, 3) for coarse, spacing in (("", ""), (", R/d0 = 16", " -spacing 0.125e-3"))]
ENTRIES += [Entry("capillary_wave", "32 a wave length", "-spacing 0.03125", TEST)]
# As printed the wave flies apart; at the case's own spacing only in some builds, and there at any time.
ENTRIES += tensions("capillary_wave", spacings=(0.0625, 0.03125, 0.015625), as_printed=LATTICE + " -spacing 0.03125")
ENTRIES += tensions("rayleigh_plateau", spacings=(0.25e-3, 1e-3 / 6, 0.125e-3),
                    coarse=(0.25e-3, 0.2e-3, 1e-3 / 6))
ENTRIES += [Entry("rayleigh_plateau", "rings", file=RINGS),
            Entry("rayleigh_plateau", "rings, pinching, R/d0 = 32", "-spacing 0.03125e-3 -thread_viscosity 0 "
                  "-snapshot_interval 0.1e-3 -time_end 48e-3", file=RINGS)]
ENTRIES += [Entry("contact_angle", f"{angle} degrees", f"-wall_contact_angle {angle}",
                  spacings=(0.25e-3, 1e-3 / 6, 0.125e-3)) for angle in (60, 90, 120)]
ENTRIES += [Entry("contact_angle", f"{angle} degrees, {where}", f"-{name}_contact_angle {angle}", file=f"{name}.opts")
            for name, where in (("slope", "solid plane"), ("ball", "solid sphere")) for angle in (60, 90, 120)]
FOOT = "-fine foot -foot_shape box -foot_lower -4e-3,0 -foot_upper 4e-3,0.6e-3"
ENTRIES += [Entry("contact_angle", "60 degrees, graded", f"-spacing 0.2e-3 -spacing_coarse 0.4e-3 {FOOT} -time_end 0.1",
                  TEST)]
ENTRIES += [Entry("contact_angle", "60 degrees, following", "-spacing_coarse 0.5e-3 -spacing_follow surface "
                  "-time_end 0.1", TEST)]
ENTRIES += [Entry("contact_angle", f"incline, {share:g} of the critical force{where}", f"-gravity {gravity}",
                  file=name)
            for share, gravity, where, name in (
                (0.85, "6.200,-7.602", "", "incline.opts"), (1.15, "8.388,-5.087", "", "incline.opts"),
                (0.85, "9.760,-0.991", ", solid", "incline_solid.opts"),
                (1.15, "9.528,2.335", ", solid", "incline_solid.opts"))]
ENTRIES += [Entry("contact_angle", "edge of a film, 12 spacings thick", file="edge.opts"),
            Entry("contact_angle", "edge of a film, 3 spacings thick", "-film_upper 5e-3,0.3e-3", TEST,
                  file="edge.opts")]

ENTRIES += [Entry("contact_angle", f"plug, {angle} degrees, 10 spacings", f"-wall_contact_angle {angle}", TEST,
                  file="plug.opts") for angle in (45, 60, 120, 135)]
ENTRIES += [Entry("contact_angle", "plug, 60 degrees, 20 spacings", "-spacing 0.05e-3", file="plug.opts")]
ENTRIES += [Entry("contact_angle", f"plug in a tube, {angle} degrees, 20 spacings", f"-wall_contact_angle {angle}",
                  file="tube.opts") for angle in (60, 120)]
ENTRIES += [Entry("contact_angle", "plug in a square channel, 60 degrees, 20 spacings", file="corner.opts")]
ENTRIES += [Entry("contact_angle", f"plug that moves, {count} spacings",
                  f"-gravity 0,-15 -wall_contact_law cox_voinov -spacing {1e-3 / count}", size, file="plug.opts")
            for count, size in ((10, TEST), (20, "short"))]

# two liquids that do not mix: tensions of the lens, the bath and between them, mN/m
ENTRIES += [Entry("two_liquids", f"lens, {one:g}, {other:g} and {between:g} mN/m",
                  f"-lens_tension {one}e-3 -bath_tension {other}e-3 -interface_tension {between}e-3")
            for one, other, between in ((60, 70, 30), (40, 60, 40))]
ENTRIES += [Entry("two_liquids", "lens, rings", file="lens_rings.opts")]
ENTRIES += [Entry("two_liquids", f"pair, {between:g} mN/m between", f"-interface_tension {between}e-3",
                  file="pair.opts") for between in (33.5, 67, 100)]
ENTRIES += [Entry("two_liquids", "pair, 3-d", file="pair_3d.opts")]
ENTRIES += [Entry("two_liquids", "drop, 2-d", size=TEST, file="drop.opts"),
            Entry("two_liquids", "drop, 3-d", file="sphere.opts"), Entry("two_liquids", "drop, rings", file=RINGS),
            Entry("two_liquids", "period, 2-d", file="swing.opts"),
            Entry("two_liquids", "period, rings", file="swing_rings.opts")]

ENTRIES += tensions("retracting_sheet", spacings=(0.5e-3, 0.25e-3, 0.125e-3), coarse=(0.5e-3, 0.25e-3))
ENTRIES += [Entry("retracting_sheet", "one particle thick", "-spacing 0.5e-3", TEST)]

# enclosed gas
ENTRIES += [Entry("breathing_bubble"), Entry("breathing_bubble", "rings", file=RINGS),
            Entry("breathing_bubble", "3-d, an eighth", file="octant.opts"),
            Entry("breathing_bubble", "graded rings", file="deep.opts"), Entry("rising_bubble"),
            Entry("breathing_bubble", "swinging, rings", size=TEST, file="swinging.opts", packings=3),
            Entry("breathing_bubble", "10 um of air in water", file="minnaert.opts"),
            Entry("breathing_bubble", "100 um of air in water", "-shell_tension 0.00711 -shell_viscosity 0.000993 "
                  "-gas_pressure_start 1.06866", file="minnaert.opts"),
            Entry("breathing_bubble", "1 um of air in water", "-shell_tension 0.711 -shell_viscosity 0.0993 "
                  "-gas_pressure_start 2.91638 -time_step 0.02 -time_end 5", file="minnaert.opts"),
            Entry("rising_bubble", "1/80", "-spacing 0.0125"), Entry("bottle"),
            Entry("bottle", "3-d", size=LONG, file="case_3d.opts"), Entry("bursting_bubble"),
            Entry("gas_piston"), Entry("gas_piston", "3-d", file="case_3d.opts")]
ENTRIES += [Entry("rising_bubble", f"rings, M {morton}", f"-liquid_viscosity {viscosity}", file=RINGS)
            for morton, viscosity in ((848, 0.1527), (266, 0.1143), (41.1, 0.0716), (5.51, 0.0433))]

# the gallery: scenes for a look and to start from, each with one number that is judged; not run as printed
COLLIDE = "-options_file cases/drop_collision/"
ENTRIES += [Entry("drop_collision", "head-on", size=TEST),
            Entry("drop_collision", "off centre", COLLIDE + "off_center.opts", TEST, packings=3),
            Entry("drop_collision", "two sizes, two liquids", COLLIDE + "unequal.opts"),
            Entry("sessile_drop"), Entry("sessile_drop", "rings", file=RINGS), Entry("my_liquid", size=TEST),
            Entry("sessile_drop", "rings, 0.1 mm", "-spacing 0.1e-3 -time_end 0.4", file=RINGS), Entry("thin_film"),
            Entry("deep_pool", packings=3), Entry("dry_wall"), Entry("printed_line"), Entry("obstacle"),
            Entry("sloshing"), Entry("sloshing", "air in the corner of the roof", file="pocket.opts"), Entry("jet"),
            Entry("weir"), Entry("pump"), Entry("boat_at_wall")]
ENTRIES += [Entry(case, "rings", file=RINGS) for case in ("thin_film", "deep_pool", "dry_wall", "jet")]
ENTRIES += [Entry("dry_wall", "rings, D/32", "-spacing 0.0625e-3", file=RINGS),
            Entry("dry_wall", "water", file="water.opts", packings=3),
            Entry("dry_wall", "water that bounces", "-wall_contact_angle 160 -wall_contact_hysteresis 0 "
                  "-drop_velocity 0,-0.5 -time_end 16e-3", TEST, file="water.opts"), Entry("ink_drop", size=TEST),
            Entry("capillary_rise"), Entry("dripping")]
GALLERY = {"drop_collision", "sessile_drop", "thin_film", "deep_pool", "dry_wall", "printed_line", "obstacle",
           "sloshing", "jet", "stirred_tank", "ink_drop", "capillary_rise", "dripping"}
# solids do not move with the printed scheme
DEFAULT_ONLY = {"my_liquid", "film_on_slope", "elastic_channel", "elastic_drop", "elastic_thread", "merging_threads",
                "sinking_ball", "squeeze_film", "shear_under_gravity",
                "stokes_second", "column", "turning_box", "heated_cavity", "marangoni_drop",
                "dragged_cylinder", "piston", "rotating_cup", "breathing_bubble", "rising_bubble", "bottle",
                "gas_piston", "coated_plate", "honey", "floating_box", "two_liquids", "weir", "pump",
                "boat_at_wall", "bursting_bubble", "slot_jet"}

# the main case
IMPACTS = (1e-3, 0.7e-3, 0.5e-3, 0.35e-3, 0.25e-3)
ENTRIES += [Entry("drop_impact", "0.5 mm", QUARTER + "0.5e-3", LONG, ranks=2, spacings=IMPACTS),
            Entry("drop_impact", "0.5 mm", "-options_file options/paper.opts -time_step_min 1e-5 -time_step_max 4e-5 "
                  "-packing_relaxation_step 2e-5 " + QUARTER + "0.5e-3", LONG, True, ranks=2, spacings=IMPACTS[:2])]
ENTRIES += [Entry("drop_impact", "0.25 mm", QUARTER + "0.25e-3", LONG, ranks=2),
            Entry("drop_impact", "0.5 mm, 2.42 m/s",
                  "-options_file cases/drop_impact/speed_242.opts " + QUARTER + "0.5e-3", LONG, ranks=2),
            Entry("drop_impact", "0.25 mm, 2.42 m/s",
                  "-options_file cases/drop_impact/speed_242.opts " + QUARTER + "0.25e-3", LONG, ranks=2)]
ENTRIES += [Entry("drop_impact", "0.25 to 1 mm", "-options_file options/quarter.opts "
                  "-options_file cases/drop_impact/graded.opts", LONG, ranks=2)]
ENTRIES += [Entry("drop_impact", "following, 0.25 to 1 mm", "-options_file options/quarter.opts "
                  "-options_file cases/drop_impact/following.opts", LONG, ranks=2),
            Entry("drop_impact", "following rings, 0.125 to 0.5 mm", "-spacing 0.125e-3 -spacing_coarse 0.5e-3 "
                  "-spacing_follow surface", file="axisymmetric.opts")]
ENTRIES += [Entry("drop_impact", "rings, 0.125 to 0.5 mm", "-options_file cases/drop_impact/graded.opts "
                  "-spacing 0.125e-3 -spacing_coarse 0.5e-3", file="axisymmetric.opts")]
QUICK = "-options_file options/quarter.opts -options_file options/quick.opts"
ENTRIES += [Entry("drop_impact", "quick", QUICK, LONG, ranks=2),
            Entry("drop_impact", "quick, 2.42 m/s", "-options_file cases/drop_impact/speed_242.opts " + QUICK, LONG,
                  ranks=2),
            Entry("drop_impact", "0.25 mm, pool of 60 x 60 mm", QUARTER + "0.25e-3 -box_upper 30e-3,30e-3,30e-3 "
                  "-film_upper 30e-3,30e-3,0 -time_end 50e-3", LONG, ranks=2)]
