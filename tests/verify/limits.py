#!/usr/bin/python3
"""Limits in which two ways to compute the same scene must agree, each with its tolerance."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

# A drop falls into a film, in the plane.
SPLASH = """-dimension 2 -spacing 0.05 -box_lower -1,0 -box_upper 1,2 -box_x wall -box_ymin wall -gravity 0,-1
 -drop_shape sphere -drop_radius 0.25 -drop_center 0,0.8 -drop_velocity 0,-1 -drop_tension 2 -drop_viscosity 1
 -time_end 0.6 -series_interval 0.02 -checkpoint_interval 0 -packing_jitter 0 -ksp_rtol 1e-10 """
FILM = "-bodies film,drop -film_lower -1,0 -film_upper 1,0.5 -film_tension 2 -film_viscosity 1 "


def energies(options, name):
    s = runs.series(runs.run(options, name))
    return s["kinetic_energy"], s["potential_energy"]


def apart(one, other):
    """Largest difference of the kinetic energies of two runs over the largest of them, at the times of both."""
    n = min(len(one[0]), len(other[0]))
    return np.abs(one[0][:n] - other[0][:n]).max() / one[0].max()


def hysteresis():
    """A contact angle without hysteresis is one with a hysteresis of 0; one of 90 degrees is none."""
    wet = SPLASH + FILM + "-wall_contact_angle 70 "
    runs.check_below(apart(energies(wet, "without"), energies(wet + "-wall_contact_hysteresis 0", "with")), 0,
                     "a hysteresis of 0 is none")


def interface():
    """A tension of 0 between two liquids is none."""
    runs.check_below(apart(energies(SPLASH + FILM, "mixing"), energies(SPLASH + FILM + "-interface_tension 0", "0")), 0,
                     "an interface tension of 0 is none")


def solid():
    """A solid box under the film is the floor of the box."""
    floor = energies(SPLASH + FILM, "floor")
    slab = SPLASH.replace("-box_lower -1,0", "-box_lower -1,-0.3").replace("-box_ymin wall", "") + FILM
    slab += "-solids slab -slab_lower -1,-0.3 -slab_upper 1,0 "
    runs.check_below(apart(floor, energies(slab, "slab")), 0.01, "a solid box is a wall of the box")


def halves():
    """Half of a scene with a mirror is the whole, of a packing that is symmetric: a sphere's need not be. To 0.25 s:
    from contact at 0.05 s on rounding grows thirtyfold every six steps."""
    block = SPLASH.replace("-drop_shape sphere -drop_radius 0.25 -drop_center 0,0.8",
                           "-drop_lower {},0.6 -drop_upper 0.2,1").replace("-time_end 0.6", "-time_end 0.25")
    for name, more, most in (("without tension", "-film_tension 0 -drop_tension 0", 1e-6), ("with tension", "", 1e-5)):
        whole = energies(block.format(-0.2) + FILM + more, f"whole {name}")
        half = energies(block.format(0).replace("-box_lower -1,0", "-box_lower 0,0") +
                        FILM.replace("-film_lower -1,0", "-film_lower 0,0") +
                        f"-box_xmin symmetry -box_xmax wall -gauge_multiplicity 2 {more}", f"half {name}")
        runs.check_below(apart(whole, half), most, f"half of a symmetric scene is the whole, {name}")


def rings():
    """Rings far from the axis are the plane: a strip at a thousand spacings, per length of its middle, to 0.4 s: see
    halves."""
    far = SPLASH.replace("-drop_center 0,", "-drop_center 50,").replace("-box_lower -1,0 -box_upper 1,2 -box_x wall",
                                                                        "-box_lower 0,0 -box_upper 52,2 -box_xmax wall")
    far += FILM.replace("-film_lower -1,0 -film_upper 1,0.5", "-film_lower 49,0 -film_upper 51,0.5")
    far += "-solids a,b -a_lower 48.6,0 -a_upper 49,1 -b_lower 51,0 -b_upper 51.4,1 -time_end 0.4 "
    plane = energies(far, "plane")
    ring = energies(far.replace("-dimension 2", "-dimension axisymmetric"), "rings")
    runs.check_below(apart(plane, [e / (2 * np.pi * 50) for e in ring]), 0.01, "rings far from the axis are the plane")


def viscosity():
    """Explicit and implicit viscosity agree."""
    thick = (SPLASH + FILM).replace("viscosity 1", "viscosity 20") + "-time_step 1e-3 "
    runs.check_below(apart(energies(thick + "-viscosity_solver explicit", "explicit"),
                           energies(thick + "-viscosity_solver implicit -viscous_ksp_rtol 1e-10", "implicit")), 0.01,
                     "explicit viscosity is implicit viscosity")


def graded():
    """Graded spacing with one size is the uniform scheme."""
    grown = "-spacing_coarse 0.05 -fine core -core_lower -0.5,0 -core_upper 0.5,2 "
    runs.check_below(apart(energies(SPLASH + FILM, "uniform"), energies(SPLASH + FILM + grown, "graded")), 1e-5,
                     "graded spacing with one size is uniform spacing")


def sound():
    """The weakly compressible scheme at a small Mach number is the default one, at whose times it is read."""
    for name, sound, scene in (
            ("drop", 10, "-options_file cases/central_force/case.opts -spacing 0.0667 -time_end 4 "),
            ("vortices", 20, "-options_file cases/taylor_green/case.opts -spacing 0.04 -time_end 0.6 ")):
        scene += "-checkpoint_interval 0 -packing_jitter 0.1 -series_interval "
        default = runs.series(runs.run(scene + "0.05", f"incompressible {name}"))
        slow = runs.series(runs.run(scene + f"0.005 -scheme weakly_compressible -sound_speed {sound}",
                                    f"compressible {name}"))
        slow = np.interp(default["time"], slow["time"], slow["kinetic_energy"])
        runs.check_below(apart([default["kinetic_energy"]], [slow]), 0.03,
                         f"the weakly compressible scheme is the default one, {name}")


PARTS = {part.__name__: part for part in (hysteresis, interface, solid, halves, rings, viscosity, graded, sound)}
for chosen in runs.parts(*PARTS):
    PARTS[chosen]()
runs.done()
