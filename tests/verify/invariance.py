#!/usr/bin/python3
"""The same scene shifted, turned by 90 degrees, mirrored, in units of other powers of two, with its bodies in another
order: before the liquids meet the kinetic energy is the same to round-off, afterwards to what an impact makes of that.
The lattice has no random displacements and no spheres: those begin otherwise at another place.
In units of other powers of two every bit of every field is the same: with a solid that stands, one that floats, as
rings; a wall that the liquid comes to finds rows of the preconditioner that had nothing.
And one without walls in a frame that moves: there velocities differ by the frame's, to the same accuracy."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np  # noqa: E402
import runs  # noqa: E402

SPACING, TIME = 0.03125, 0.5  # m, s; the spacing and all corners are powers of two or sums of some, exact when shifted
COMMON = "-dimension 2 -packing_jitter 0 -ksp_rtol 1e-11 -checkpoint_interval 0 -bodies_overlap "


def scene(scale=1.0, shift=(0, 0), turned=False, mirrored=False, order="film,drop,block"):
    """Two blocks fall into a film between walls, off the middle. scale: of lengths and times."""
    def place(x, y):
        x = -x if mirrored else x
        x, y = (-y, x) if turned else (x, y)
        return scale * (x + shift[0]), scale * (y + shift[1])

    def box(name, x, y, z, w):
        corners = np.array([place(x, y), place(z, w)])
        low, high = corners.min(axis=0), corners.max(axis=0)
        return f"-{name}_lower {low[0]!r},{low[1]!r} -{name}_upper {high[0]!r},{high[1]!r} "

    def along(x, y):
        x = -x if mirrored else x
        x, y = (-y, x) if turned else (x, y)
        return f"{float(x)!r},{float(y)!r}"

    walls = "-box_y wall -box_xmax wall " if turned else "-box_x wall -box_ymin wall "
    down = along(0, -1.0 / scale)  # velocities stay as they are, accelerations do not
    film = "-film_tension {0!r} -film_viscosity {0!r} ".format(float(scale))
    drop = film.replace("film", "drop")
    falling = f"-drop_velocity {along(0, -1)} -block_velocity {along(0, -1)} "
    return (COMMON + f"-spacing {scale * SPACING!r} " + box("box", -1, 0, 1, 2) + walls +
            f"-gravity {down} -bodies {order} " + box("film", -1, 0, 1, 0.5) + box("block", 0.25, 0.6875, 0.5, 0.9375) +
            box("drop", -0.5, 0.6875, -0.1875, 1) +
            film + drop + drop.replace("drop", "block") + falling +
            f"-time_end {scale * TIME!r} -series_interval {scale * 0.02!r} ")


def energy(name, **kwargs):
    scale = kwargs.get("scale", 1.0)
    return runs.series(runs.run(scene(**kwargs), name))["kinetic_energy"] / scale**2


def apart(a, b):
    n = min(len(a), len(b))
    return np.abs(a[:n] - b[:n]).max() / a.max()


def collapse(solid, scale):
    """A column collapses, a drop falls, a solid is in the way, all lengths and times in units of 1/scale."""
    def at(*x):
        return ",".join(repr(scale * c) for c in x)

    rings = solid == "rings"
    bodies = "".join(f"-{b}_viscosity {scale * 0.1!r} -{b}_tension {scale * 1.0!r} " for b in ("column", "drop"))
    solids = {"fixed": f"-solids rod -rod_shape box -rod_lower {at(0.375, 0)} -rod_upper {at(0.5, 0.125)} ",
              "free": f"-solids rod -rod_shape sphere -rod_radius {at(0.08)} -rod_center {at(0.45, 0.125)} "
                      f"-rod_mass {10 * scale**2!r} ", "rings": ""}
    return (f"-dimension {'axisymmetric' if rings else '2'} -spacing {at(0.025)} -box_lower {at(0, 0)} "
            f"-box_upper {at(1, 1)} -box_ymin wall {'-box_xmax' if rings else '-box_x'} wall "
            f"-gravity 0,{-9.81 / scale!r} -bodies column,drop -column_upper {at(0.3, 0.5)} -drop_shape sphere "
            f"-drop_radius {at(0.1)} -drop_center {at(0 if rings else 0.6, 0.7)} -drop_velocity 0,-1 "
            f"-checkpoint_interval 0 -steps_max 30 " + bodies + solids[solid])


def differ(solid, scale):
    """The fields of the last checkpoint that are not the same in both units, to the last bit."""
    one, other = (runs.fields(runs.numbered(runs.run(collapse(solid, s), f"{solid} {s} {scale}"), "checkpoint")[-1])
                  for s in (1.0, scale))
    power = {"position": 1, "volume": 3 if solid == "rings" else 2}
    return [name for name in one if not np.array_equal(other[name], one[name] * scale ** power.get(name, 0),
                                                       equal_nan=one[name].dtype.kind == "f")]


def moving():
    """Three blocks meet in free flight, and in a box whose faces they cross, seen from a frame that moves. Steps are
    fixed and the time of the density's repair is given, for by default both follow from the speeds."""
    drift = np.array([-0.75, 0.5])
    free = (COMMON.replace("-bodies_overlap ", "") + f"-spacing {SPACING} -time_step {2.0**-8} "
            "-pressure_relaxation_time 0.125 -bodies film,drop,block -film_lower -1,0 -film_upper 1,0.5 "
            "-drop_lower -0.5,0.6875 -drop_upper -0.1875,1 -block_lower 0.25,0.6875 -block_upper 0.5,0.9375 "
            "-time_end 0.5 -snapshot_interval 0.0625 -snapshot_double " +
            " ".join(f"-{name}_tension 1 -{name}_viscosity 1" for name in ("film", "drop", "block")))
    for name, box, least in (("free", "-box_lower -4,-4 -box_upper 4,4 ", 1e-9),
                             ("periodic", "-box_lower -1.125,-0.5 -box_upper 1.125,1.5 -box_x periodic "
                              "-box_y periodic ", 1e-7)):  # pairs across faces are of single precision
        rest, gone = ([runs.fields(path)["velocity"][:, :2] - v for path in runs.numbered(
            runs.run(f"{free} {box} -film_velocity {v[0]},{v[1]} -drop_velocity {v[0]},{v[1] - 1} "
                     f"-block_velocity {v[0]},{v[1] - 1}", f"{name} {v[0]}"), "snapshot")] for v in (0 * drift, drift))
        runs.check(len(rest) == len(gone) == 9, f"{name}: as many snapshots in a frame that moves", len(gone))
        runs.check_below(max(np.abs(a - b).max() for a, b in zip(rest[:2], gone)), least,
                         f"{name}: the velocities in a frame that moves before the blocks meet")
        runs.check_below(max(abs((a**2).sum() / (b**2).sum() - 1) for a, b in zip(rest, gone)), 1e-3,
                         f"{name}: the energy in a frame that moves")


FREE = 7  # lines of the series before the liquids meet
CHANGES = {"shifted": {"shift": (3, -5)}, "turned": {"turned": True}, "mirrored": {"mirrored": True},
           "larger": {"scale": 16.0}, "smaller": {"scale": 2.0**-10}, "reordered": {"order": "block,film,drop"}}
SOLIDS = ("fixed", "free", "rings")
for part in runs.parts(*CHANGES, *SOLIDS, "moving"):
    if part in SOLIDS:
        for factor in (16.0, 2.0**-10):
            unlike = differ(part, factor)
            runs.check(not unlike, f"{part}, in units of {factor:g}: the same to the last bit", f"{unlike} differ")
        continue
    if part == "moving":
        moving()
        continue
    one, other = energy(f"before {part}"), energy(part, **CHANGES[part])
    runs.check_below(apart(one[:FREE], other[:FREE]), 1e-9, f"the scene {part} has the same energy before it meets")
    runs.check_below(apart(one, other), 1e-3, f"the scene {part} has the same energy")
runs.done()
