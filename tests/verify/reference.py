#!/usr/bin/python3
"""Independent computations of cases: two phases, liquid and air, by volume of fluid with Gerris (Popinet, J. Comput.
Phys. 190:572, 2003 and 228:5838, 2009; Debian's package gerris), axisymmetric or plane. Written to
cases/CASE/reference*.csv, which the cases' checks read.

    reference.py [CASE ...]      all without a name; the computations' files go to output/reference/

Nothing else of the program needs Gerris. A computation takes 2 to 25 minutes of a core.
"""
import glob
import os
import subprocess
import sys
from typing import NamedTuple

import numpy as np
from scipy import ndimage, spatial

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

AIR = 1.2, 1.8e-5  # kg/m3, Pa s
G = 9.81  # m/s2
INPUT = """{graph} {{
  Global {{
    #define MIX(T,a,b) (CLAMP(T,0.,1.)*(a) + (1. - CLAMP(T,0.,1.))*(b))
  }}
  PhysicalParams {{ L = {size} }}
  Time {{ end = {end} dtmax = {step} }}
  Refine ({fine} ? {level} : 5)
  VariableTracerVOFHeight T
  VariableFiltered T1 T 1
  {tension}
  PhysicalParams {{ alpha = 1./MIX(T1,{density},{air[0]}) }}
  SourceViscosity {{}} MIX(T1,{viscosity},{air[1]})
  Source {down} -{g}
  InitFraction T ({liquid})
  {start}
  RemoveDroplets {{ istep = 20 }} T 5
  AdaptGradient {{ istep = 1 }} {{ cmax = 1e-2 minlevel = 4 maxlevel = {level} }} T
  AdaptVorticity {{ istep = 1 }} {{ cmax = 2e-2 minlevel = 4 maxlevel = {level} - 1 }}
  OutputSimulation {{ step = {interval} }} cells-%g.txt {{ variables = U,V,T,P format = text }}
  OutputScalarSum {{ step = {interval} }} energy {{ v = 0.5*{density}*T*Velocity2 }}
  {more}
}}
{boxes}"""


class Scene(NamedTuple):
    """Lengths in m, otherwise SI. Axisymmetric: x is the height, y the radius; the wall is at x = low."""
    size: float  # of a box
    count: int  # boxes, one after the other along x
    low: float  # x of the first box's lower side
    level: int  # the smallest cell is size/2^level
    end: float
    interval: float
    liquid: str  # positive inside
    fine: str  # where the mesh begins fine
    density: float = 1100.0
    viscosity: float = 3.5e-3
    tension: float = 0.067
    speed: float = 0.0  # of the liquid above x = gap, downwards
    gap: float = 0.0
    axisymmetric: bool = True
    step: float = 1e30
    points: tuple = ()

    @property
    def cell(self):
        return self.size / 2**self.level

    def text(self):
        origin = self.low / self.size + 0.5
        graph = (f"{self.count} {self.count - 1} {'GfsAxi' if self.axisymmetric else 'GfsSimulation'} GfsBox GfsGEdge "
                 f"{{ x = {origin:.9g} y = 0.5 }}")
        boxes = []
        for k in range(self.count):
            first, last = k == 0, k == self.count - 1
            if self.axisymmetric:  # no slip on the wall, a free way out above, a mirror at the side
                sides = "left = Boundary { BcDirichlet V 0 } " * first + "right = BoundaryOutflow" * last
            else:  # walls that let slide, open above
                sides = ("left = Boundary " * first + "right = Boundary " * last +
                         "bottom = Boundary top = BoundaryOutflow")
            boxes.append(f"GfsBox {{ {sides} }}")
        edges = [f"{k + 1} {k + 2} right" for k in range(self.count - 1)]
        tension = f"VariableCurvature K T\n  SourceTension T {self.tension} K" if self.tension else ""
        start = f"Init {{}} {{ U = (T > 0. && x > {self.gap} ? -{self.speed} : 0.) }}" if self.speed else ""
        more = "\n  ".join(f"OutputLocation {{ istep = 1 }} point_{k} {x} {y} 0"
                           for k, (x, y) in enumerate(self.points))
        return INPUT.format(graph=graph, boxes="\n".join(boxes + edges) + "\n", size=self.size, end=self.end,
                            step=self.step, fine=self.fine, level=self.level, density=self.density,
                            viscosity=self.viscosity, air=AIR, g=G, down="U" if self.axisymmetric else "V",
                            liquid=self.liquid, interval=self.interval, tension=tension, start=start, more=more)

    def run(self, folder):
        """Computes, unless the folder holds the finished computation of this scene."""
        path, text = os.path.join(folder, "scene.gfs"), self.text()
        if os.path.exists(os.path.join(folder, "finished")) and open(path, encoding="utf-8").read() == text:
            return
        os.makedirs(folder, exist_ok=True)
        for old in glob.glob(folder + "/*"):
            os.remove(old)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        with open(os.path.join(folder, "messages"), "w", encoding="utf-8") as file:
            subprocess.run(["gerris2D", "-m", "scene.gfs"], cwd=folder, stdout=file, stderr=file, check=True)
        open(os.path.join(folder, "finished"), "w", encoding="utf-8").close()

    def states(self, folder, top, side):
        """(time, T) in order of time: the liquid's share on square cells of the finest size, [height][radius]."""
        n, m = round((top - self.low) / self.cell), round(side / self.cell)
        x, y = self.low + self.cell * (np.arange(n) + 0.5), self.cell * (np.arange(m) + 0.5)
        points = np.stack(np.meshgrid(x, y, indexing="ij"), -1).reshape(-1, 2)
        found = []
        for path in glob.glob(folder + "/cells-*.txt"):
            with open(path, encoding="utf-8") as file:
                found.append((float(file.readline().split()[-1]), path))
        for time, path in sorted(found):
            cells = np.loadtxt(path, usecols=(0, 1, 5))
            _, nearest = spatial.cKDTree(cells[:, :2]).query(points)
            yield time, x, y, cells[nearest, 2].reshape(n, m)

    def energy(self, folder):
        """Times and kinetic energy of the liquid, J."""
        rows = [line.split() for line in open(os.path.join(folder, "energy"), encoding="utf-8")]
        return np.array([(float(r[2]), 2 * np.pi * self.size * float(r[4])) for r in rows]).T


def crossing(at, T):
    """The first place along the coordinates where T falls below a half; the last if it never does."""
    k = int(np.argmax(T < 0.5))
    if not T[k] < 0.5:
        return at[-1]
    return at[0] if k == 0 else at[k - 1] + (at[k] - at[k - 1]) * (T[k - 1] - 0.5) / (T[k - 1] - T[k])


def crater(scene, folder, start, top, axis=2.2e-3):
    """Columns of drop_impact/reference.csv; start: height of the drop's lowest point at the start over its speed, s."""
    rows, (times, energy) = [], scene.energy(folder)
    for time, x, r, T in scene.states(folder, top, scene.size):
        air, _ = ndimage.label(T < 0.5)
        T = np.where((T < 0.5) & (air != air[-1, -1]), 1.0, T)  # bubbles are no crater
        liquid, _ = ndimage.label(T > 0.5)
        pool = liquid == liquid[0, -1]
        surface = np.array([crossing(x, T[:, k]) for k in range(len(r))])
        highest = np.where(pool.any(0), x[len(x) - 1 - pool[::-1].argmax(0)] + scene.cell / 2, np.nan)
        above = np.searchsorted(x, 0)
        level = T[above - 1] + (T[above] - T[above - 1]) * (0 - x[above - 1]) / scene.cell
        gaps, _ = ndimage.label(level < 0.5)
        inside = np.argmax(gaps == np.bincount(gaps[gaps > 0]).argmax()) if gaps.any() else 0  # of the widest
        outside = crossing(r[inside:], 1 - level[inside:]) if level[inside] < 0.5 else 0.0
        rows.append((time - start, highest[r > axis].max(), -surface.min(), 2 * outside,
                     np.interp(time, times, energy), surface[0]))
    return "time,crown_height,crater_depth,crater_diameter,kinetic_energy,jet_height", rows


def impact(speed, wide, end=62e-3, finer=0):
    """The drop impact: a pool of 40 mm radius, or of the area of the paper's box; cells halved 'finer' times."""
    drop = "4e-6 - (x - 2.25e-3)*(x - 2.25e-3) - y*y"
    fine = "(x < 5e-3 && y < 5e-3) || fabs(x) < 1e-3"
    return Scene(40e-3 if wide else 22.5e-3, 1 if wide else 2, -10e-3, (9 if wide else 8) + finer, end, 5e-4,
                 f"MAX({drop}, -x*1e-2)", fine, speed=speed, gap=1e-4)


def impact_columns(speed):
    return lambda scene, folder: crater(scene, folder, 0.25e-3 / speed, 25e-3)


POOL = Scene(18.05e-3, 2, -16e-3, 8, 20.5e-3, 5e-4, "MAX(4e-6 - (x - 2.25e-3)*(x - 2.25e-3) - y*y, -x*1e-2)",
             "(x < 5e-3 && y < 5e-3) || fabs(x) < 1e-3", 1000.0, 1e-3, 0.072, 2.0, 1e-4)
FILM = Scene(16e-3, 1, -1.16e-3, 9, 6.2e-3, 2.5e-4, "MAX(4e-6 - (x - 2.16e-3)*(x - 2.16e-3) - y*y, -x*1e-2)",
             "(x < 4.5e-3 && y < 2.5e-3) || fabs(x) < 0.3e-3", speed=3.13, gap=0.8e-4)
WALL = Scene(4e-3, 1, 0.0, 8, 6e-3, 5e-5, "1e-6 - (x - 1.05e-3)*(x - 1.05e-3) - y*y", "1", 1190.0, 36e-3, 0.065, 1.0)
COLUMN = Scene(0.16, 3, 0.0, 8, 0.25, 4e-3, "MIN(57.15e-3 - x, 114.3e-3 - y)", "x < 0.07 && y < 0.13", 1000.0, 1e-3,
               0.0, axisymmetric=False, step=1e-3)
TANK = Scene(0.805, 2, 0.0, 8, 1.12, 0.05, "MIN(0.6 - x, 0.3 - y)", "x < 0.65 && y < 0.35", 1000.0, 1e-3, 0.0,
             axisymmetric=False, step=2e-3, points=((1.6095, 0.015),))
BURST = Scene(1.5e-3, 2, -1.5e-3, 8, 0.8e-3, 1e-5,
              "MIN(-x, sqrt((x + 0.477e-3)*(x + 0.477e-3) + y*y) - 0.5e-3)",
              "fabs(sqrt((x + 0.477e-3)*(x + 0.477e-3) + y*y) - 0.5e-3) < 0.05e-3 || fabs(x) < 0.03e-3",
              1000.0, 1.9e-3, 0.072)
TRAPPED = TANK._replace(level=7, end=1.4, interval=0.02, points=())


def crown(scene, folder, layer=(0.29e-3, 1.16e-3)):
    """Half of the liquid of a layer above the level lies nearer to the axis than this."""
    rows = []
    for time, x, r, T in scene.states(folder, layer[1], 12e-3):
        liquid = (T[x > layer[0]] * r).sum(axis=0).cumsum()
        if liquid[-1] > 0:
            rows.append((time - 0.16e-3 / 3.13, r[np.searchsorted(liquid, liquid[-1] / 2)]))
    return "time,radius", rows


def spread(scene, folder):
    rows, (times, energy) = [], scene.energy(folder)
    for time, x, r, T in scene.states(folder, 2.2e-3, 2.5e-3):
        liquid, _ = ndimage.label(T > 0.5)
        drop = liquid == np.bincount(liquid[liquid > 0]).argmax()
        foot = drop[x < 0.05e-3].any(axis=0)
        rows.append((time - 0.05e-3, 2 * r[drop.any(axis=0)].max() + scene.cell,
                     x[drop.any(axis=1)].max() + scene.cell / 2,
                     2 * r[foot].max() + scene.cell if foot.any() else 0.0, np.interp(time, times, energy)))
    return "time,diameter,height,wetted_diameter,kinetic_energy", rows


def fall(scene, folder):
    """Front and height of the column over its width a = 57.15 mm."""
    rows, n = [], round(scene.count * scene.size / scene.cell)
    x = scene.cell * (np.arange(n) + 0.5)
    for path in glob.glob(folder + "/cells-*.txt"):
        cells = np.loadtxt(path, usecols=(0, 1, 5))
        tree = spatial.cKDTree(cells[:, :2])
        floor = cells[tree.query(np.c_[x, np.full(n, scene.cell / 2)])[1], 2]
        side = cells[tree.query(np.c_[np.full(n, 3e-3), x])[1], 2]
        with open(path, encoding="utf-8") as file:
            rows.append((float(file.readline().split()[-1]), crossing(x, floor) / 57.15e-3,
                         crossing(x, side) / 57.15e-3))
    return "time,front,height", sorted(rows)


def tip(scene, folder):
    """Height of the liquid on the axis that hangs together from below: the floor of the cavity, then the jet."""
    rows = []
    for path in glob.glob(folder + "/cells-*.txt"):
        with open(path, encoding="utf-8") as file:
            time = float(file.readline().split()[-1])
        cells = np.loadtxt(path, usecols=(0, 1, 5))
        axis = cells[cells[:, 1] < 1.4 * scene.cell]
        axis = axis[axis[:, 0].argsort()]
        rows.append((time, crossing(axis[:, 0], axis[:, 2])))
    return "time,tip", sorted(rows)


def trapped(scene, folder, height=0.8, least=8):
    """Front on the floor, kinetic energy, and the largest region of air of 'least' cells or more that no way connects
    with the top."""
    rows, n, m = [], round(scene.count * scene.size / scene.cell), round(height / scene.cell)
    x, y = scene.cell * (np.arange(n) + 0.5), scene.cell * (np.arange(m) + 0.5)
    points = np.stack(np.meshgrid(x, y, indexing="ij"), -1).reshape(-1, 2)
    kinetic = {float(line.split()[2]): float(line.split()[4])
               for line in open(os.path.join(folder, "energy"), encoding="utf-8")}
    for path in glob.glob(folder + "/cells-*.txt"):
        with open(path, encoding="utf-8") as file:
            time = float(file.readline().split()[-1])
        cells = np.loadtxt(path, usecols=(0, 1, 5, 6))
        nearest = spatial.cKDTree(cells[:, :2]).query(points)[1].reshape(n, m)
        T, p = cells[nearest, 2], cells[nearest, 3]
        regions, count = ndimage.label(T < 0.5)
        inside = [regions == k for k in range(1, count + 1) if k != regions[n // 2, -1]]
        inside = max((part for part in inside if part.sum() >= least), key=np.sum, default=np.zeros((n, m), bool))
        area = scene.cell**2 * (1 - T)[ndimage.binary_dilation(inside)].sum()
        centre = points[inside.ravel()].mean(axis=0) if area else (0, 0)
        rows.append((time, crossing(x, T[:, 0]), kinetic[time], area, p[inside].mean() if area else 0, *centre))
    return "time,front,kinetic_energy,area,pressure,x,y", sorted(rows)


def pressure(scene, folder, interval=1e-3):
    """Pressure at the point, Pa, mean of each interval."""
    rows = np.loadtxt(os.path.join(folder, "point_0"), usecols=(0, 4))
    time = np.arange(0, rows[-1, 0], interval / 10)
    p = np.interp(time, rows[:, 0], rows[:, 1])[:len(time) // 10 * 10].reshape(-1, 10).mean(axis=1)
    return "time,pressure", list(zip(interval * (np.arange(len(p)) + 0.5), p))


REFERENCES = {  # case: file, scene, columns, what it is
    "drop_impact": [
        ("reference_242.csv", impact(2.42, True), impact_columns(2.42),
         "drop impact at 2.42 m/s, pool of 40 mm radius"),
        ("reference_242_fine.csv", impact(2.42, True, 36.5e-3, 1), impact_columns(2.42),
         "drop impact at 2.42 m/s, pool of 40 mm radius, up to 36 ms"),
        ("reference_242_box.csv", impact(2.42, False), impact_columns(2.42),
         "drop impact at 2.42 m/s, pool of the box's area"),
        ("reference_second.csv", impact(3.13, True), impact_columns(3.13),
         "drop impact at 3.13 m/s, pool of 40 mm radius: by another program than reference.csv")],
    "deep_pool": [("reference.csv", POOL, lambda s, f: crater(s, f, 0.25e-3 / 2.0, 15e-3), "drop into a deep pool")],
    "bursting_bubble": [("reference.csv", BURST, tip, "floor of the cavity, then tip of the jet, on the axis")],
    "thin_film": [("reference.csv", FILM, crown, "crown on a thin film")],
    "dry_wall": [("reference.csv", WALL, spread, "drop on a dry wall, 90 degrees")],
    "dam_break": [("reference_collapse.csv", COLUMN, fall, "column of 57.15 mm, over its width; walls let slide"),
                  ("reference_impact.csv", TANK, pressure,
                   "pressure on the far wall 15 mm above the floor; walls let slide"),
                  ("reference_trapped.csv", TRAPPED, trapped,
                   "front on the floor, kinetic energy, the largest region of enclosed air; walls let slide")],
}


def main():
    chosen = sys.argv[1:] or list(REFERENCES)
    unknown = [c for c in chosen if c not in REFERENCES]
    if unknown:
        sys.exit(f"reference.py: no reference is computed for {unknown[0]}; there are {', '.join(REFERENCES)}")
    for case in chosen:
        for name, scene, columns, what in REFERENCES[case]:
            folder = os.path.join(runs.ROOT, "output", "reference", case, name[:-4])
            scene.run(folder)
            head, rows = columns(scene, folder)
            path = os.path.join(runs.ROOT, "cases", case, name)
            with open(path, "w", encoding="utf-8") as file:
                form = "axisymmetric" if scene.axisymmetric else "plane"
                file.write(f"# Two-phase volume of fluid by Gerris, {form}: {what}.\n# Smallest cell "
                           f"{1e3 * scene.cell:.3g} mm. Made by `make reference CASE={case}`. SI units.\n{head}\n")
                file.writelines(",".join(f"{v:.6g}" for v in row) + "\n" for row in rows)
            print(os.path.relpath(path, runs.ROOT), len(rows), "times", flush=True)


if __name__ == "__main__":
    main()
