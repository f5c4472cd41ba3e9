"""What `make tradeoff` sweeps: a short scene a case, what counts as its error, and the axes."""
from typing import NamedTuple

QUINTIC = "-kernel_type quintic_spline -kernel_ratio 1"


class Scene(NamedTuple):
    """options  of the run, after those of the case
    error    of which results of the case's check.py the error is made: the root mean square of their relative
             deviations (of 'at most' results: their values); none: of all that are judged, over their tolerances
    words    what the error is, for table and chart
    spacings factors on the spacing of the scene
    file     options file of the case
    dear     leave out what would take minutes"""
    options: str = ""
    error: tuple = ()
    words: str = "error over tolerance, rms of all judged results"
    spacings: tuple = (2, 1.41, 0.71)
    file: str = "case.opts"
    dear: bool = False


IMPACT = tuple(f"{name} at {t} ms" for t in (5, 10, 15, 20) for name in ("D", "phi"))
SCENES = {
    "central_force": Scene("-spacing 0.0667 -time_end 9.2", ("period", "amplitude of b in the last period", "area of the ellipse"),
                           "period, amplitude and area, rms relative error"),
    "taylor_green": Scene("-packing_jitter 0.25", ("velocity error L1 at the end",), "velocity error L1 at t = 1"),
    "film_at_rest": Scene(f"-spacing 1e-3 -time_end 0.2 {QUINTIC}", ("mean pressure, rms error over rho g H",),
                          "mean pressure, rms error over rho g H", (1.43, 1.25, 0.71)),
    "oscillating_drop": Scene("-spacing 0.25e-3", ("period",), "period, relative error", (1.5, 0.8, 0.667)),
    "drop_impact": Scene("-options_file options/quarter.opts -spacing 1e-3 -time_end 20.05e-3 -checkpoint_interval 0",
                         IMPACT + tuple(f"kinetic energy at {t} ms" for t in (5, 10, 15)),
                         "crater depth, diameter, kinetic energy to 20 ms, rms relative error", (1.4, 0.85, 0.7),
                          dear=True)}

WCSPH = "-scheme weakly_compressible"


def axes(scene, spacing, step, tension, viscosity):
    """(axis, label, options) of every run beside the scene itself. spacing: of the scene; step: its median time step;
    tension, viscosity: whether it has any."""
    runs = [("spacing", f"{factor:g} d0", f"-spacing {factor * spacing:.6g}") for factor in scene.spacings]
    runs += [("tolerance", f"rtol {r}", f"-ksp_rtol {r}") for r in ("0.3", "1e-1", "1e-2", "1e-5", "1e-8")]
    runs += [("density tolerance", d, f"-pressure_density_tolerance {d}") for d in ("1e-3", "1e-4", "1e-5", "1e-6")]
    runs += [("time step", f"CFL {c}", f"-time_cfl {c}") for c in ("0.05", "0.1", "0.4", "0.6")]
    runs += [("time step", f"{f:g} dt", f"-time_step_max {f * step:.3g}") for f in (0.25, 0.5)]
    runs += [("time step", f"{f:g} dt, fixed", f"-time_step {f * step:.3g}") for f in (1.5, 2)]
    runs += [("kernel", f"{k}, h/d0 {h}", f"-kernel_type {k} -kernel_ratio {h}") for k, h in
             (("cubic_spline", 1.2), ("cubic_spline", 1.3), ("cubic_spline", 1.5), ("wendland_c2", 1.3),
              ("wendland_c2", 1.6), ("quintic_spline", 1.0), ("quintic_spline", 1.2))]
    runs += [("scheme", "density_invariant", "-scheme density_invariant"),
             ("scheme", "as printed", "-options_file options/printed.opts"),
             ("scheme", "closure doubled", "-pressure_closure doubled"),
             ("scheme", "gradient symmetric", "-pressure_gradient symmetric"),
             ("scheme", "gradient corrected", "-pressure_gradient corrected"),
             ("scheme", "gradient conserved", "-pressure_gradient conserved"),
             ("scheme", "regularization 0", "-pressure_gradient corrected -pressure_regularization 0"),
             ("scheme", "relaxation 1", "-pressure_relaxation_ratio 1"),
             ("scheme", "relaxation 25", "-pressure_relaxation_ratio 25"),
             ("scheme", "no shifting", "-shifting 0"), ("scheme", "shifting conserved", "-shifting_conserved"),
             ("scheme", "not centered", "-time_centered 0")]
    runs += [("WCSPH", "c = 10 U", WCSPH), ("WCSPH", "c = 5 U", WCSPH + " -sound_mach 0.2"),
             ("WCSPH", "no diffusion", WCSPH + " -density_diffusion 0"),
             ("WCSPH", "summed density", WCSPH + " -pressure_source density")]
    if not scene.dear:
        runs += [("WCSPH", "c = 20 U", WCSPH + " -sound_mach 0.05")]
    if tension:
        runs += [("tension", f"H/h {r}", f"-tension_ratio {r}") for r in (1.25, 1.5, 2.5)]
        runs += [("tension", "no sharpening", "-tension_sharpening 0"), ("tension", "none", "-tension_type none")]
        runs += [("tension", f"Cahn-Hilliard, band {b}", f"-tension_type cahn_hilliard -tension_band {b}")
                 for b in (0.5, 1)]
    if viscosity:
        runs += [("viscosity", form, f"-viscosity_form {form}") for form in ("cleary", "morris")]
    runs += [("preconditioner", pc, f"-pc_type {pc}") for pc in ("none", "jacobi", "gamg", "hypre", "bjacobi")]
    runs += [("rebuild", f"every {n}", f"-pressure_rebuild_interval {n}") for n in (1, 3, 30, 100)]
    return runs + [("preset", name, f"-options_file options/{name}.opts")
                   for name in ("fast", "balanced", "accurate", "paper")]
