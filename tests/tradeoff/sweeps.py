"""What `make tradeoff` sweeps: a short scene a case, what counts as its error, and the axes."""
from typing import NamedTuple

QUINTIC = "-kernel_type quintic_spline -kernel_ratio 1"


class Scene(NamedTuple):
    """options  of the run, after those of the case
    lattice  options of the lattice packing, which choices that bring another packing leave out
    error    of which results of the case's check.py the error is made: the root mean square of their relative
             deviations (of 'at most' results: their values); none: of all that are judged, over their tolerances
    words    what the error is, for table and chart
    spacings factors on the spacing of the scene
    file     options file of the case
    dear     leave out what would take minutes
    ways     (label, options) of other ways to compute the same scene, with all the options of such a run
    graded   (label, options) of graded spacings"""
    options: str = ""
    lattice: str = ""
    error: tuple = ()
    words: str = "error over tolerance, rms of all judged results"
    spacings: tuple = (2, 1.41, 0.71)
    file: str = "case.opts"
    dear: bool = False
    ways: tuple = ()
    graded: tuple = ()


CORE = "-fine core -core_shape sphere -core_radius 6e-3 -core_center 0,0,0"
WHOLE = "-options_file cases/drop_impact/case.opts -time_end 20.05e-3 -checkpoint_interval 0"
RINGS = "-options_file cases/drop_impact/axisymmetric.opts -time_end 20.05e-3 -checkpoint_interval 0"
IMPACT = tuple(f"{name} at {t} ms" for t in (5, 10, 15, 20) for name in ("D", "phi"))
SCENES = {
    "central_force": Scene("-spacing 0.0667 -time_end 9.2", "",
                           ("period", "amplitude of b in the last period", "area of the ellipse"),
                           "period, amplitude and area, rms relative error"),
    "taylor_green": Scene("", "-packing_jitter 0.25", ("velocity error L1 at the end",), "velocity error L1 at t = 1",
                          (2, 1.25, 0.625)),
    "film_at_rest": Scene(f"-spacing 1e-3 -time_end 0.2 {QUINTIC}", "", ("mean pressure, rms error over rho g H",),
                          "mean pressure, rms error over rho g H", (2, 2 / 3, 0.5), dear=True),
    "oscillating_drop": Scene("-spacing 0.25e-3", "", ("period",), "period in two dimensions, relative error",
                              (1.5, 0.75, 0.5), "circle.opts"),
    "drop_impact": Scene("-options_file options/quarter.opts -spacing 0.7e-3 -time_end 20.05e-3 -checkpoint_interval 0",
                         "", IMPACT + tuple(f"kinetic energy at {t} ms" for t in (5, 10, 15)),
                         "crater depth, diameter, kinetic energy to 20 ms, rms relative error", (1.4, 0.85, 0.7),
                         dear=True,
                         ways=(("whole box", f"{WHOLE} -spacing 0.7e-3"), ("rings", f"{RINGS} -spacing 0.7e-3"),
                               ("rings, 0.5 d0", f"{RINGS} -spacing 0.35e-3"),
                               ("rings, 0.36 d0", f"{RINGS} -spacing 0.25e-3"),
                               ("rings, 0.25 d0", f"{RINGS} -spacing 0.175e-3")),
                         graded=tuple((f"{fine:.2g} to {coarse:.2g} d0", f"-spacing {0.7e-3 * fine:.4g} "
                                       f"-spacing_coarse {0.7e-3 * coarse:.4g} {CORE}")
                                      for fine, coarse in ((1, 2), (0.7, 2), (0.5, 1), (0.5, 2))))}

DIMENSION = "dimension"  # the axis of Scene.ways
WCSPH = "-scheme weakly_compressible"


KERNELS = (("cubic_spline", 1.2), ("cubic_spline", 1.3), ("cubic_spline", 1.5), ("wendland_c2", 1.3),
           ("wendland_c2", 1.6), ("quintic_spline", 1.0), ("quintic_spline", 1.2))
SCHEME = (("density_invariant", "-scheme density_invariant"), ("as printed", "-options_file options/printed.opts"),
          ("closure doubled", "-pressure_closure doubled"), ("gradient symmetric", "-pressure_gradient symmetric"),
          ("gradient corrected", "-pressure_gradient corrected"),
          ("gradient conserved", "-pressure_gradient conserved"),
          ("regularization 0", "-pressure_gradient corrected -pressure_regularization 0"),
          ("no shifting", "-shifting 0"), ("shifting conserved", "-shifting_conserved"),
          ("not centered", "-time_centered 0"))
SOUND = (("c = 10 U", ""), ("summed density", " -pressure_source density"))
TENSION = (("H/h 1.25", "-tension_ratio 1.25"), ("H/h 1.5", "-tension_ratio 1.5"), ("H/h 2.5", "-tension_ratio 2.5"),
           ("none", "-tension_type none"), ("Cahn-Hilliard", "-tension_type cahn_hilliard"))


def axes(scene, spacing, step, tension, viscosity):
    """(axis, label, options) of every run beside the scene itself. spacing: of the scene; step: its median time step;
    tension, viscosity: whether it has any."""
    few = slice(None, None, 2 if scene.dear else 1)
    runs = [("spacing", f"{factor:.3g} d0", f"-spacing {factor * spacing:.8g}") for factor in scene.spacings]
    runs += [("grading", *choice) for choice in scene.graded]
    runs += [("tolerance", f"rtol {r}", f"-ksp_rtol {r}") for r in ("0.3", "1e-1", "1e-2", "1e-5", "1e-8")[few]]
    runs += [("density tolerance", d, f"-pressure_density_tolerance {d}") for d in ("1e-3", "1e-4", "1e-5", "1e-6")]
    runs += [("time step", f"CFL {c}", f"-time_cfl {c}") for c in ("0.1", "0.05", "0.3")[few]]
    if not scene.dear:
        runs += [("time step", f"{f:g} dt", f"-time_step_max {f * step:.3g}") for f in (0.25, 0.5)]
        runs += [("time step", f"{f:g} dt, fixed", f"-time_step {f * step:.3g}") for f in (1.5, 2)]
    runs += [("kernel", f"{k}, h/d0 {h}", f"-kernel_type {k} -kernel_ratio {h}") for k, h in KERNELS[few]]
    runs += [("scheme", *choice) for choice in SCHEME]
    runs += [("WCSPH", label, WCSPH + options) for label, options in SOUND[:1] if scene.dear] or \
            [("WCSPH", label, WCSPH + options) for label, options in SOUND]
    if tension:
        runs += [("tension", *choice) for choice in TENSION[few]]
    if viscosity:
        runs += [("viscosity", form, f"-viscosity_form {form}") for form in ("cleary", "morris")]
    runs += [("preconditioner", pc, f"-pc_type {pc}") for pc in ("none", "jacobi", "gamg", "hypre", "bjacobi")]
    runs += [(DIMENSION, *way) for way in scene.ways]
    return runs + [("preset", name, f"-options_file options/{name}.opts")
                   for name in ("fast", "balanced", "accurate")]
