"""Small scenes drawn at random from a table of features, for relations.py. Scene N is always the same one. Combinations
that the program refuses are not drawn, so that every refusal of one is a failure."""
import itertools
import random

import numpy as np

D0 = 0.04  # m; speeds are about 1 m/s, drops have a radius of 5 spacings


class Scene:
    """What has been drawn: options by name, and what the checks ask."""

    def __init__(self, number):
        self.draw = random.Random(number)
        self.options = {}
        self.bodies = []
        self.kind = self.draw.choice(("2", "2", "3", "axisymmetric"))
        self.rings, self.dim = self.kind == "axisymmetric", 3 if self.kind == "3" else 2
        self.place = self.draw.choice(("free", "free", "free", "periodic", "tank", "tank", "mirror"))
        self.steps = 40 if self.dim == 2 else 20
        self.g = np.zeros(3)
        self.set("dimension", self.kind)
        self.box()
        getattr(self, self.place)()
        for feature in (self.forces, self.liquids, self.tension, self.methods, self.grading, self.carried):
            feature()
        if self.bodies:
            self.set("bodies", ",".join(self.bodies))

    def set(self, name, *values):
        self.options[f"-{name}"] = ",".join(str(v) for v in values)

    def has(self, name):
        return f"-{name}" in self.options

    def odds(self, chance):
        return self.draw.random() < chance

    def vector(self, across, up):
        """A vector of the scene's dimensions: one across, one up."""
        return (round(across, 4), round(up, 4)) if self.dim == 2 else (round(across, 4), 0, round(up, 4))

    def box(self):
        """Its corners: about the origin where the liquid is free, else the floor of a tank."""
        self.up, self.across = ("y", ("x",)) if self.dim == 2 else ("z", ("x", "y"))
        half = {"free": (4, 4), "mirror": (3.2, 3.2), "tank": (0.8, 0.2), "periodic": (0.8, 0.28)}[self.place]
        if self.dim == 3 and self.place in ("tank", "periodic"):
            half = (0.4, half[1])
        low = -4 if self.place == "free" else -0.8 if self.place == "periodic" and self.kind == "2" else 0
        high = {"free": 4, "mirror": 3.2}.get(self.place, 0.8 if self.dim == 3 or low < 0 else 1.6)
        least = [0.0 if self.rings or self.place == "mirror" else -x for x in half]
        self.width = half[0] - least[0]
        self.low = tuple(least[:self.dim - 1]) + (low,)
        self.set("box_lower", *self.low)
        self.set("box_upper", *half[:self.dim - 1], high)

    def body(self, name, shape, **more):
        self.bodies.append(name)
        self.set(f"{name}_shape", shape)
        for key, value in more.items():
            self.set(f"{name}_{key}", *(value if isinstance(value, tuple) else (value,)))

    def moves(self, name, center):
        """A velocity field of a body, without divergence."""
        rate = round(self.draw.uniform(1, 4), 3)
        kind = self.draw.choice(("uniform", "strain", "uniform" if self.rings else "rotation", "shear"))
        if kind == "shear" and self.rings:
            kind = "strain"
        self.set(f"{name}_velocity_type", "strain" if kind == "shear" else kind)
        if kind == "uniform":
            self.uniform(name)
        elif kind == "strain":
            self.set(f"{name}_strain_rate", *((rate, -2 * rate) if self.rings else (rate, -rate) if self.dim == 2 else
                                              (rate, 0, -rate)))
            self.set(f"{name}_strain_center", *center)
        elif kind == "rotation":
            self.set(f"{name}_rotation_rate", *((rate,) if self.dim == 2 else (0.5, rate, 0.3)))
            self.set(f"{name}_rotation_center", *center)
        elif kind == "shear":
            rates = [0] * self.dim**2
            rates["xyz".index(self.up)] = rate
            self.set(f"{name}_strain_rate", *rates)
            self.set(f"{name}_strain_center", *center)

    def free(self):
        """Liquid that touches nothing."""
        what = self.draw.choice(("drop", "drop", "pair", "pair", "sheet", "block", "thread"))
        radius, side = (0.2, 0.3) if self.dim == 2 else (0.16, 0.24)
        if what == "thread" and self.kind == "2":
            what = "ellipsoid"
        if what == "pair":
            other = round(radius * self.draw.choice((1, 1, 0.6)), 4)
            off = 0 if self.rings else round(self.draw.choice((0, 0.5, 1)) * other, 4)
            up = radius + other + 1.2 * D0
            self.body("a", "sphere", radius=radius, center=self.vector(0, 0))
            self.body("b", "sphere", radius=other, center=self.vector(off, up))
            self.set("b_velocity", *self.vector(0, -self.draw.choice((1, 3))))
        elif what == "sheet":
            thick = self.draw.choice((3, 4)) * D0  # two even rows shake: their kinetic energy grows 5 times in a step
            self.body("a", "box", lower=self.vector(0 if self.rings else -0.4, 0), upper=self.vector(0.4, thick))
            if self.dim == 3:
                self.set("a_lower", -0.4, -0.4, 0)
                self.set("a_upper", 0.4, 0.4, thick)
            self.moves("a", self.vector(0, thick / 2))
        elif what == "thread":
            self.body("a", "cylinder", radius=0.14, height=0.6, axis=self.up, center=self.vector(0, 0))
            self.moves("a", self.vector(0, 0))
        elif what == "block":
            low = 0 if self.rings else -side
            self.body("a", "box", lower=(low, -side) if self.dim == 2 else (-side,) * 3,
                      upper=(side, side) if self.dim == 2 else (side, side * 0.6, side))
            self.moves("a", self.vector(0, 0))
        elif what == "ellipsoid":
            self.body("a", "ellipsoid", radii=(0.32, 0.16), center=(0, 0))
            self.moves("a", (0, 0))
        else:
            self.body("a", "sphere", radius=1.2 * radius, center=self.vector(0, 0))
            if self.kind != "2" and self.odds(0.5):
                self.set("a_wave_amplitude", 0.02)
            self.moves("a", self.vector(0, 0))
        if self.kind == "2" and what in ("drop", "block") and self.odds(0.3):  # it meets a body that nothing holds
            self.set("solids", "ball")
            self.set("ball_shape", self.draw.choice(("sphere", "box")))
            if self.options["-ball_shape"] == "sphere":
                self.set("ball_radius", 0.12)
                self.set("ball_center", 0.05, 0.52)
            else:
                self.set("ball_lower", -0.1, 0.4)
                self.set("ball_upper", 0.15, 0.6)
            self.set("ball_mass", self.draw.choice((15, 45, 400)))
            self.set("ball_velocity", 0, -1)

    def periodic(self):
        """A box whose opposite faces are one; of rings those along the axis."""
        for d in (self.across if not self.rings else ()) + (self.up,):
            self.set(f"box_{d}", "periodic")
        low = 0 if self.rings else -0.3
        what = self.draw.choice(("full", "full", "drop", "layer"))
        if self.rings and what == "full":
            what = "layer"
        if self.dim == 3 and what == "drop":
            what = "full"
        if what == "full":
            self.body("a", "box")
            self.draw.choice((self.vortices, self.uniform))("a")
        elif what == "layer" and self.rings:
            self.body("a", "box", upper=(0.3, 1.6))
            self.set("a_velocity", 0, 1)
        elif what == "layer":
            self.body("a", "box", lower=(-0.8, -0.3) if self.dim == 2 else (-0.4, -0.28, 0.2),
                      upper=(0.8, 0.3) if self.dim == 2 else (0.4, 0.28, 0.6))
            self.set("a_velocity", *self.vector(1, 0))
        else:
            self.body("a", "box", lower=(low, 1.2 if self.rings else 0.6), upper=(0.3, 1.6 if self.rings else 0.8))
            self.set("a_velocity", *self.vector(0, 2))

    def vortices(self, name):
        self.set(f"{name}_velocity_type", "formula")
        k = f"2*pi/{self.width!r}"
        self.set(f"{name}_velocity_formula",
                 f"0-cos({k}*x)*sin({k}*y),sin({k}*x)*cos({k}*y)" + ",0" * (self.dim == 3))

    def uniform(self, name):
        self.set(f"{name}_velocity", *((0, 0.5) if self.rings else (1, 0.5) if self.dim == 2 else (1, 0.5, 0.2)))

    def tank(self):
        """Liquid between walls, with weight."""
        for d in self.across if not self.rings else ("xmax",):
            self.set(f"box_{d}", "wall")
        self.set(f"box_{self.up}min", "wall")
        right, back = (0.8, ()) if self.dim == 2 else (0.4, (0.2,))
        what = self.draw.choice(("film", "film", "column", "rest"))
        wide, high = (0.2, 0.6) if what == "column" else (right, 0.3)
        self.body("a", "box", upper=(wide,) + back + (high,))
        self.g[self.dim - 1] = -self.draw.choice((1, 9.81))
        if what == "film":
            low = 0.3 + 1.2 * D0
            if self.odds(0.5):
                self.body("b", "sphere", radius=0.14, center=self.vector(0, low + 0.14))
            else:
                self.body("b", "box", lower=((0 if self.rings else -0.15,) + ((-0.1,) if back else ()) + (low,)),
                          upper=((0.15,) + ((0.1,) if back else ()) + (low + 0.2,)))
            self.set("b_velocity", *self.vector(0, -2))
        if what == "rest" and self.kind == "2" and self.odds(0.6):
            self.set("solids", "ball")
            self.set("ball_shape", "sphere")
            self.set("ball_radius", 0.12)
            self.set("ball_center", 0.1, 0.3)
            self.set("ball_mass", self.draw.choice((20, 45, 80)))

    def mirror(self):
        """A part of a symmetric scene between mirrors, without weight."""
        for d in (() if self.rings else self.across) + (self.up,):
            self.set(f"box_{d}min", "symmetry")
        self.body("a", "sphere", radius=0.32 if self.dim == 2 else 0.24, center=self.low)
        rate = round(self.draw.uniform(0.5, 3), 3)
        self.set("a_velocity_type", "strain")
        self.set("a_strain_rate", *((rate, -2 * rate) if self.rings else (rate, -rate) if self.dim == 2 else
                                    (rate, 0, -rate)))

    def forces(self):
        if self.place == "free" and self.odds(0.3):
            self.g[self.dim - 1] = -9.81
            if not self.rings and self.odds(0.5):
                self.g[0] = 3
        elif self.place == "free" and not self.has("solids") and self.odds(0.2):
            self.set("central_force_rate", 2)
        if self.g.any():
            self.set("gravity", *self.g[:self.dim])

    def liquids(self):
        """Viscosity and density of each body."""
        for name in self.bodies:
            viscosity = self.draw.choice((0, 1, 1, 10, 300))
            self.set(f"{name}_viscosity", viscosity)
            if viscosity and self.odds(0.25):
                model = self.draw.choice(("power_law", "carreau", "herschel_bulkley"))
                self.set(f"{name}_viscosity_model", model)
                self.set(f"{name}_viscosity_exponent", self.draw.choice((0.5, 0.8, 1.2)))
                if model == "carreau":
                    self.set(f"{name}_viscosity_time", 0.5)
                elif model == "herschel_bulkley":
                    self.set(f"{name}_yield_stress", 20)
        if len(self.bodies) > 1 and not self.has("solids") and self.odds(0.4):
            self.set("b_density", self.draw.choice((800, 1150, 1500)))
        if self.odds(0.2):
            self.set("viscosity_form", "morris")

    def tension(self):
        model = self.draw.choice(("curvature", "curvature", "none", "cahn_hilliard"))
        if model == "none":
            return
        if model == "cahn_hilliard" and not self.rings:
            self.set("tension_type", model)
        for name in self.bodies:
            self.set(f"{name}_tension", self.draw.choice((10, 40)))
        if len(self.bodies) > 1 and not self.has("tension_type") and self.odds(0.4):
            self.set("interface_tension", 15)
        elif self.place == "tank" and not self.has("tension_type") and self.odds(0.5):
            self.set("wall_contact_angle", self.draw.choice((60, 120)))

    def methods(self):
        """Schemes, forms, kernels, packings, solvers."""
        if not self.has("interface_tension") and not self.rings and not self.has("solids"):
            scheme = self.draw.choice(("consistent",) * 5 + ("density_invariant", "weakly_compressible"))
            if scheme == "density_invariant" and (self.place != "free" or self.has("b_density")):
                scheme = "weakly_compressible"  # as printed films, vortices and unlike liquids are known to blow up
            if scheme != "consistent":
                self.set("scheme", scheme)
            elif self.odds(0.25):
                self.set("pressure_gradient", "conserved")
                self.set("shifting_conserved", 1)
        if self.odds(0.3):
            self.set("kernel_type", self.draw.choice(("wendland_c2", "quintic_spline")))
        if self.options.get("-scheme") == "density_invariant" or not self.rings and not self.has("solids") and (
                self.odds(0.15)):  # as printed it is unstable on a lattice
            self.set("packing_type", "poisson")
        else:
            self.set("packing_jitter", self.draw.choice((0, 0.1, 0.3)))
        self.set("packing_seed", self.draw.randrange(1000))
        if self.odds(0.3):
            self.set("pc_type", self.draw.choice(("jacobi", "gamg")))
        self.set("viscosity_solver", self.draw.choice(("auto", "auto", "implicit")))

    def grading(self):
        """Particles of two sizes where the program knows them."""
        if self.odds(0.4) and not any(name in option for option in self.options for name in (
                "solids", "scheme", "interface", "viscosity_model", "packing_type", "conserved", "tension_type")):
            if self.conserves():
                return
            self.set("spacing_coarse", 2 * D0)
            self.set("fine", "near")
            self.set("near_shape", "sphere")
            self.set("near_radius", 0.15)
            self.set("near_center", *self.options.get("-a_center", ",".join("0" * self.dim)).split(","))

    def carried(self):
        """What particles carry: heat, on which weight, viscosity and tension depend, and a solute."""
        if self.options.get("-scheme", "consistent") != "consistent" or not self.odds(0.4):
            return
        for name in self.bodies:
            self.set(f"{name}_temperature", self.draw.choice((290, 320)))
            self.set(f"{name}_thermal_conductivity", self.draw.choice((0, 4e3, 4e5)))
            self.set(f"{name}_concentration", self.draw.choice((0, 1)))
            self.set(f"{name}_diffusivity", self.draw.choice((0, 1e-3)))
            if self.options.get(f"-{name}_type") != "emitter":
                self.set(f"{name}_temperature_gradient", *self.vector(0 if self.rings else 5, 20))
            for law, value in (("thermal_expansion", 1e-3), ("viscosity_activation", 1500)):
                if self.odds(0.3):
                    self.set(f"{name}_{law}", value)
            if not {"-interface_tension", "-tension_type"} & set(self.options) and self.has(f"{name}_tension"):
                self.set(f"{name}_tension_temperature", self.draw.choice((0, -0.2)))
        if self.options.get(f"-box_{self.up}min") == "wall":
            self.set(f"box_{self.up}min_{self.draw.choice(('temperature', 'heat_flux'))}", 350)
        if self.has("ball_shape"):
            self.set("ball_temperature", 340)
        if self.odds(0.3):
            self.set("surface_heat_transfer", 1e4)
            self.set("ambient_temperature", 300)

    def conserves(self):
        """Whether all forces but the curvature's are between pairs of particles."""
        return self.options.get("-pressure_gradient") == "conserved" or (
            self.options.get("-scheme") == "density_invariant")

    def text(self):
        return " ".join(f"{name} {value}" for name, value in self.options.items())


class Vessel(Scene):
    """Scenes of what has its own hooks, together: gas, open faces with an outside, emitters, bodies that move freely, a
    spacing that follows the liquid, in tanks with walls, mirrors and periodic faces."""

    def __init__(self, number):
        self.draw = random.Random(f"vessel {number}")
        self.options, self.bodies, self.solids = {}, [], []
        self.kind = self.draw.choice(("2", "2", "2", "3", "axisymmetric"))
        self.rings, self.dim = self.kind == "axisymmetric", 3 if self.kind == "3" else 2
        self.place = self.draw.choice(("closed", "closed", "outlet", "outlet", "jet"))
        self.steps = 40 if self.dim == 2 else 20
        self.up, self.across = ("y", ("x",)) if self.dim == 2 else ("z", ("x", "y"))
        self.wide, self.high = (0.8, 1.2) if self.dim == 2 else (0.4, 0.8)
        self.set("dimension", self.kind)
        getattr(self, self.place)()
        self.set("bodies", ",".join(self.bodies))
        if self.solids:
            self.set("solids", ",".join(self.solids))
        for feature in (self.liquids, self.surfaces, self.numerics, self.following, self.carried):
            feature()

    def corner(self, across, up):
        """A corner of a box: in space as deep as the scene where it is as wide, else half as deep."""
        return (across, up) if self.dim == 2 else (across, max(-0.2, min(0.2, across)), up)

    def sides(self, kinds):
        """The sides of the box: one of the kinds on the left; in space mirrors, walls or periodic faces along y."""
        left = "axis" if self.rings else self.draw.choice(kinds)
        low = 0 if left in ("axis", "symmetry") else -self.wide
        self.low = (low,) + ((-0.2,) if self.dim == 3 else ())
        self.set("box_lower", *self.low, 0)
        self.set("box_upper", *self.corner(self.wide, self.high))
        self.set(f"box_{self.up}min", "wall")
        if left == "periodic":
            self.set("box_x", "periodic")
        elif left != "axis":
            self.set("box_xmin", left)
        if self.dim == 3:
            self.set("box_y", self.draw.choice(("periodic", "wall", "symmetry")))
        self.set("gravity", *self.vector(0, -self.draw.choice((2, 9.81))))
        return left

    def pool(self, level):
        self.body("a", "box", upper=self.corner(self.wide, level))

    def closed(self):
        """Gas over a pool, in it, and what falls or pours in."""
        left, level = self.sides(("wall", "symmetry", "periodic")), 0.44
        if left != "periodic":
            self.set("box_xmax", "wall")
        self.set(f"box_{self.up}max", self.draw.choice(("wall", "wall", "symmetry", "open")))
        self.pool(level)
        self.set("gas", "true")
        self.set("gas_pressure", self.draw.choice((1000, 101325)))
        if self.odds(0.3):
            self.set("gas_exponent", self.draw.choice((0, 1)))
        if self.odds(0.3):
            self.set("gas_pressure_start", self.draw.choice((1100, 101000)))
        if self.odds(0.6):
            self.set("a_holes", "bubble")
            self.set("bubble_shape", "sphere")
            self.set("bubble_radius", 0.11)
            self.set("bubble_center", *self.vector(0, 0.2))
            if self.odds(0.5):
                self.set("bubble_pressure", float(self.options["-gas_pressure"]) + self.draw.choice((0, 500)))
        self.falls(level)

    def falls(self, level):
        what = self.draw.choice(("drop", "emitter", "free", "free", "nothing"))
        if what == "drop":
            self.body("b", "sphere", radius=0.14, center=self.vector(0, round(level + 0.19, 4)))
            self.set("b_velocity", *self.vector(0, -1))
        elif what == "emitter":
            self.emitter(self.vector(0, -self.draw.choice((1, 2))), level + 0.12, level + 0.24)
        elif what == "free" and not self.rings and "symmetry" not in self.options.values():
            self.raft(level)

    def emitter(self, velocity, low, high):
        """A jet that comes down."""
        self.body("jet", "box", lower=(0 if self.low[0] == 0 else -0.12,) + ((-0.12,) if self.dim == 3 else ()) + (
            round(low, 4),), upper=(0.12,) + ((0.12,) if self.dim == 3 else ()) + (round(high, 4),))
        self.set("jet_type", "emitter")
        self.set("jet_velocity", *velocity)
        self.how_it_comes()

    def how_it_comes(self):
        if self.odds(0.3):
            self.set("jet_nozzle", 0.08)
        if self.odds(0.3):
            self.set("jet_modulation", 0.3)
            self.set("jet_modulation_frequency", 5)
        if self.odds(0.2):
            self.set("jet_start", 0.02)
        if self.odds(0.2):
            self.set("jet_count", self.draw.choice((1, 3)))

    def raft(self, level):
        self.solids.append("ball")
        heavy = self.draw.choice((0.3, 0.6, 2))
        if self.odds(0.5):
            self.set("ball_shape", "sphere")
            self.set("ball_radius", 0.12)
            self.set("ball_center", *self.vector(0.3 if self.dim == 2 else 0.1, level))
            self.set("ball_mass", round(heavy * (45 if self.dim == 2 else 7.2), 3))
        else:
            self.set("ball_shape", "box")
            self.set("ball_lower", *self.vector(0.2, level - 0.08)[:1], *((-0.1,) if self.dim == 3 else ()),
                     round(level - 0.08, 4))
            self.set("ball_upper", 0.36, *((0.1,) if self.dim == 3 else ()), round(level + 0.08, 4))
            self.set("ball_mass", round(heavy * (25.6 if self.dim == 2 else 5.1), 3))
        if self.odds(0.3):
            self.set("ball_velocity", *self.vector(0.3, 0))
        if self.odds(0.3):
            self.set("ball_friction", 0.3)
            self.set("ball_restitution", 0.5)

    def outlet(self):
        """Liquid that leaves to an outside with a level or a pressure, and what feeds it."""
        self.sides(("wall", "symmetry"))
        level = 0.44
        kind = self.draw.choice(("level", "level", "pressure", "weir"))
        if kind == "weir":  # no level is held: it falls over the edge
            self.set("box_xmax", "open")
            self.set("box_xmax_level", 0.08)
        elif kind == "level":
            self.set("box_xmax", "open")
            self.set("box_xmax_level", self.draw.choice((level, level - 0.08, 0.2)))
        else:
            self.set("box_xmax", "wall")
            self.set(f"box_{self.up}min", "open")
            self.set(f"box_{self.up}min_pressure", self.draw.choice((-500, 500)))  # less than what stands on it
        self.pool(level)
        if self.odds(0.3):
            self.set("a_velocity", *self.vector(0.3, 0) if not self.rings else (0, 0))
        self.falls(level)

    def jet(self):
        """An emitter of a plane jet, on to a pool or a body."""
        self.sides(("wall", "open", "periodic") if not self.rings else ("axis",))
        self.options.pop("-box_y", None)
        self.emitter(self.vector(0, -1), 0.72 - 0.1 * (self.dim == 3), 0.84 - 0.1 * (self.dim == 3))
        if self.odds(0.6):
            self.body("a", "box", upper=self.corner(self.wide, 0.24))
            if self.odds(0.5) and not self.rings:  # no mirror is there
                self.raft(0.24)
        elif self.odds(0.6):
            self.solids.append("plate")
            self.set("plate_lower", -0.2 if not self.rings else 0, *((-0.2,) if self.dim == 3 else ()), 0.26)
            self.set("plate_upper", 0.2, *((0.2,) if self.dim == 3 else ()), 0.38)

    def liquids(self):
        viscosity = self.draw.choice((0, 1, 1, 10, 300))
        for name in self.bodies:
            self.set(f"{name}_viscosity", viscosity if self.odds(0.7) else 1)

    def surfaces(self):
        if self.odds(0.5):
            for name in self.bodies:
                self.set(f"{name}_tension", 10)
            if self.odds(0.3):
                self.set("wall_contact_angle", self.draw.choice((60, 120)))

    def numerics(self):
        if self.odds(0.2):
            self.set("kernel_type", self.draw.choice(("wendland_c2", "quintic_spline")))
        if self.odds(0.2):
            self.set("pc_type", self.draw.choice(("jacobi", "gamg")))
        if self.odds(0.2):
            self.set("viscosity_solver", "implicit")
        self.set("packing_jitter", self.draw.choice((0, 0.1)))
        self.set("packing_seed", self.draw.randrange(1000))

    def following(self):
        narrow = self.dim == 3 and {"periodic", "symmetry"} & set(self.options.values())  # for the coarse kernel
        if self.odds(0.4) and not narrow:
            self.set("spacing_coarse", 2 * D0)
            self.set("spacing_follow", self.draw.choice(("surface", "curvature", "auto")))


class Channel(Vessel):
    """Scenes with a periodic axis, along which walls, driven and free solids, contact lines and liquid slide."""

    def __init__(self, number):
        self.draw = random.Random(f"channel {number}")
        self.options, self.bodies, self.solids = {}, [], []
        self.kind = self.draw.choice(("2", "2", "3"))
        self.rings, self.dim = False, 3 if self.kind == "3" else 2
        self.steps = 40 if self.dim == 2 else 20
        self.up, self.across, self.wide, self.high = "yz"[self.dim - 2], "xy"[:self.dim - 1], 0.6, 0.8
        self.set("dimension", self.kind)
        self.sides(("periodic",))
        self.set(f"box_{self.up}min_velocity", *self.vector(self.draw.choice((0, 0.3)), 0))
        covered = self.draw.choice((0.3, 0.6))  # of the way along the floor
        self.body("a", "box", upper=self.corner(covered, 0.4))
        if covered < 0.6:  # contact lines
            self.set("a_lower", *self.corner(-covered, 0))
            self.set("a_tension", 120)
            self.set("wall_contact_angle", self.draw.choice((60, 120)))
            self.set("wall_contact_hysteresis", self.draw.choice((0, 40)))
        self.set("a_velocity", *self.vector(self.draw.choice((0, 0.2)), 0))
        self.set("a_viscosity", self.draw.choice((1, 10)))
        if self.odds(0.7):
            self.solids.append("plate")
            self.set("plate_lower", *self.corner(-0.12, 0.16))
            self.set("plate_upper", *self.corner(0.12, 0.28))
            self.set("plate_velocity", *self.vector(self.draw.choice((-0.5, 0.5)), 0))
        elif covered == 0.6:
            self.raft(0.4)
        if self.solids:
            self.set("solids", ",".join(self.solids))
        self.set("bodies", "a")
        self.numerics()
        self.carried()


def elastic(number):
    """Scenes of the other families whose liquids have polymers; the next one where the program refuses a scene then."""
    drawn = map((Scene, Vessel, Channel)[number % 3], itertools.count(1000 * number))
    scene = next(s for s in drawn if not s.options.keys() & {"-scheme", "-viscosity_form"})
    for name in scene.bodies:
        model = scene.draw.choice(("oldroyd_b", "giesekus", "fene_p"))
        scene.set(f"{name}_polymer_model", model)
        scene.set(f"{name}_polymer_modulus", scene.draw.choice((30, 1000)))
        scene.set(f"{name}_relaxation_time", scene.draw.choice((0.01, 1)))
        if model != "oldroyd_b":
            scene.set(f"{name}_polymer_{'mobility' if model == 'giesekus' else 'extensibility'}",
                      0.2 if model == "giesekus" else 20)
        scene.set(f"{name}_viscosity", max(1, float(scene.options.get(f"-{name}_viscosity", 0))))
    return scene


# each with the number of its scenes in the tests
FAMILIES = {"random": (Scene, 200), "vessel": (Vessel, 40), "channel": (Channel, 20), "elastic": (elastic, 30)}
