#!/usr/bin/python3
"""How often the bar of an answer contains the right value.

    coverage.py [--budget 40] [--case NAME] [--readme]
    make coverage [BUDGET=40] [CASE=sessile]

Asks src/answers/answer.py for quantities of cases/ whose value is known, exactly or by a volume-of-fluid computation,
with a budget that is too small for most, and prints value, bar, right value and whether the bar contains it. Writes
output/coverage/coverage.csv; --readme puts the table into tests/answers/README.md.
"""
import argparse
import csv
import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "..", "verify"), os.path.join(HERE, ".."),
                os.path.join(HERE, "..", "..", "src", "answers")]
import numpy as np  # noqa: E402
import answer  # noqa: E402
import physics  # noqa: E402
import runner  # noqa: E402
import quantity  # noqa: E402
import runs  # noqa: E402
from isph import tables  # noqa: E402

OUTPUT = os.path.join(runs.ROOT, "output", "coverage")
COLUMNS = ("kind", "scene", "quantity", "value", "bar", "right", "inside", "confidence", "seconds")
REFERENCE = 0.01  # error of the volume-of-fluid computations: what half their cells change
README = os.path.join(HERE, "README.md")


def reference(case, name, take):
    """A value of the curves of a volume-of-fluid computation in cases/."""
    return quantity.Quantity(take).of({k: v for k, v in tables.read_table(
        os.path.join(runs.ROOT, "cases", case, name)).items()})


def channel():
    """Kinetic energy (J/m) of the plane flow between walls of cases/poiseuille at its end: the sum of its modes."""
    y, g, nu, t, height, length = np.linspace(0, 1e-3, 4001), 1e-4, 1e-6, 0.6, 1e-3, 5e-4
    u = g / (2 * nu) * y * (height - y)
    for n in range(1, 40, 2):
        u -= 4 * g * height**2 / (nu * (n * math.pi)**3) * np.sin(n * math.pi * y / height) * math.exp(
            -nu * (n * math.pi / height)**2 * t)
    return 0.5 * 1000 * length * np.trapz(u * u, y)


def sheared(time):
    """Kinetic energy (J/m) of the plane flow of cases/couette, where one wall moves: the sum of its modes."""
    y, nu, height, length, speed = np.linspace(0, 1e-3, 4001), 1e-6, 1e-3, 5e-4, 1.25e-5
    u = speed * y / height
    for n in range(1, 60):
        u += 2 * speed * (-1)**n / (n * math.pi) * np.sin(n * math.pi * y / height) * math.exp(
            -nu * (n * math.pi / height)**2 * time)
    return 0.5 * 1000 * length * np.trapz(u * u, y)


def pulsing(time):
    """Kinetic energy (J/m) of the ellipse of cases/central_force, of 1000 kg/m3 and pi m2, whose flow is a strain."""
    (a, b), (later, _) = physics.ellipse(-0.5, 1, [0, time, time + 1e-4])[1:]
    strain = math.log(later / a) / 1e-4
    return 0.5 * 1000 * strain**2 * math.pi * a * b * (a * a + b * b) / 4


def shear():
    """Forces (N/m) along x on the wall that moves in cases/couette and on the floor of cases/poiseuille, at the end."""
    mu, nu, time, height, length = 1e-3, 1e-6, 0.6, 1e-3, 5e-4
    left = [math.exp(-nu * (n * math.pi / height)**2 * time) for n in range(1, 60)]
    dragged = -mu * 1.25e-5 / height * (1 + 2 * sum(left)) * length
    return dragged, 1e-4 * 1000 * height / 2 * length * (1 - sum(
        8 / (n * math.pi)**2 * e for n, e in enumerate(left, 1) if n % 2))


def film(time):
    """Kinetic energy (J/m) of the film of cases/film_on_slope."""
    z = np.linspace(0, 2e-3, 4001)
    return 0.5 * 1000 * 4e-3 * np.trapz(runner.module_of("film_on_slope").speed(z, time)**2, z)


def bubble():
    """Largest kinetic energy (J/m) of the liquid around the bubble of cases/breathing_bubble."""
    inner, outer, rho, times = 0.01, 0.02, 1000, np.arange(0, 0.048, 2e-6)
    rate, _ = runner.module_of("breathing_bubble").breathing(2, {
        "-hole_radius": inner, "-shell_radius": outer, "-shell_density": rho, "-gas_pressure": 1e4,
        "-gas_pressure_start": 10706.9})
    r, u = physics.integrate(rate, (inner, 0), 0, times, 1).T
    return (math.pi * rho * (r * u)**2 * np.log(np.sqrt(outer**2 - inner**2 + r**2) / r)).max()


def sinking():
    """Speed (m/s) of the ball of cases/sinking_ball in its tube: Haberman and Sayre (1958)."""
    ball = runner.module_of("sinking_ball")
    return -2 / 9 * ball.EXCESS * ball.G * ball.RADIUS**2 / (ball.VISCOSITY * ball.haberman_sayre(
        ball.RADIUS / ball.TUBE))


def swing():
    """Half a period (s) of the drop of cases/oscillating_drop/rings.opts, and its height (m) above its middle then:
    Lamb, art. 275 and 355, small amplitudes."""
    damping = 5 * 3.5e-3 / (1100 * 2e-3**2)
    half = math.pi / math.sqrt(8 * 0.067 / (1100 * 2e-3**3) - damping**2)
    return half, 2e-3 - 0.06e-3 * math.exp(-damping * half)


def segment(degrees):
    """Height and chord (m) of the segment of a circle that half a circle of 2 mm becomes at a contact angle."""
    t = math.radians(degrees)
    radius = math.sqrt(math.pi / 2 * 4e-6 / (t - math.sin(t) * math.cos(t)))
    return radius * (1 - math.cos(t)), 2 * radius * math.sin(t)


def rows():
    """(kind, case, file, further options, [(quantity, right value), ...])."""
    energy = 0.25 * math.exp(-16 * math.pi**2 * 0.01)
    ellipse = physics.ellipse(100, 0, [0, 0.0076])
    angle = [("wetting", "contact_angle", "case.opts", f"-wall_contact_angle {degrees}\n-time_end 0.15\n-gauge_spread",
              [("highest:end", segment(degrees)[0]), ("contact_diameter_ymin:end", segment(degrees)[1]),
               ("contact_angle_ymin:end", degrees)]) for degrees in (60, 120)]
    half, high = swing()
    box, deep, wall = "reference_box.csv", "reference.csv", "reference.csv"
    return [
        ("flow", "taylor_green", "case.opts", "", [("kinetic_energy:end", energy),
                                                   ("kinetic_energy:at=0.5", 0.25 * (energy / 0.25)**0.5)]),
        ("flow", "poiseuille", "case.opts", "", [("kinetic_energy:end", channel())]),
        ("flow", "standing_wave", "case.opts", "-time_end 1.5", [("kinetic_energy:max", 0.25 * 1000 * 9.81 * 1e-4)]),
        ("flow", "stretching_drop", "case.opts", "", [("highest:end", float(ellipse[-1][0]))]),
        ("flow", "central_force", "case.opts", "-time_end 10", [
            (f"highest:at={t}", float(physics.ellipse(-0.5, 1, [0, t])[-1][1])) for t in (4, 9)]),
        ("force", "film_at_rest", "tank.opts", "-gauge_forces", [
            ("force_ymin_y:mean=5,10", -1000 * 2 * 0.9), ("force_xmax_x:mean=5,10", 500 * 0.9**2)]),
        # radii of potential flow, see cases/rayleigh_plateau/check.py
        ("thread", "rayleigh_plateau", "rings.opts", "-thread_viscosity 0\n-gauge_neck y\n-time_end 44e-3", [
            ("neck_diameter:at=35.6988e-3", 2 * 0.6657e-3), ("neck_diameter:at=40.28e-3", 1e-3)]),
        *angle,
        ("wetting", "sessile_drop", "rings.opts", "-time_end 0.4", [("highest:end", 2.5644e-3)]),
        ("wetting", "dry_wall", "rings.opts", "", [
            (q, reference("dry_wall", wall, q.replace("highest", "height"))) for q in (
                "highest:at=1e-3", "highest:at=0.5e-3", "kinetic_energy:at=0.5e-3", "kinetic_energy:at=1e-3")]),
        ("impact", "deep_pool", "rings.opts", "", [
            (f"{q}", reference("deep_pool", deep, q)) for q in ("crater_depth:max", "kinetic_energy:at=5e-3",
                                                                "crater_diameter:at=10e-3")]),
        ("impact", "drop_impact", "axisymmetric.opts", "-time_end 36e-3", [
            (f"{q}", reference("drop_impact", box, q)) for q in (
                "crater_depth:max", "crater_depth:at=5e-3", "crater_diameter:at=10e-3", "kinetic_energy:at=5e-3",
                "kinetic_energy:at=10e-3", "crown_height:max")]),
        ("flow", "couette", "case.opts", "-series_interval 0.01", [
            ("kinetic_energy:end", sheared(0.6)), ("kinetic_energy:at=0.1", sheared(0.1))]),
        ("force", "film_at_rest", "tank.opts", "-gauge_points 1,0.3", [
            ("point_1_pressure:mean=5,10", 1000 * (0.9 - 0.3)), ("potential_energy:end", 1000 * 2 * 0.9**2 / 2)]),
        ("wetting", "laplace_jump", "circle.opts", "-gauge_points 0,0", [
            ("surface_energy:end", 0.067 * 2 * math.pi * 2e-3), ("point_1_pressure:mean=40e-3,80e-3", 0.067 / 2e-3)]),
        ("flow", "stretching_drop", "case.opts", "-series_interval 2e-4", [
            ("kinetic_energy:end", 0.5 * 1000 * 100**2 * math.pi / 2)]),
        ("flow", "central_force", "case.opts", "-time_end 4.5", [("kinetic_energy:at=4", pulsing(4))]),
        ("flow", "standing_wave", "case.opts", "-time_end 0.35", [
            ("kinetic_energy:time_of_max", math.pi / 2 / math.sqrt(9.81 * 2 * math.pi * math.tanh(math.pi)))]),
        ("flow", "free_fall", "case.opts", "", [("highest:at=0.1", 0.078 + 2 * 0.1 - 0.5 * 9.81 * 0.1**2)]),
        ("flow", "film_on_slope", "case.opts", "", [("kinetic_energy:end", film(0.2)),
                                                    ("kinetic_energy:at=0.05", film(0.05))]),
        ("flow", "square_patch", "case.opts", "", [("kinetic_energy:at=1", 1000 / 12)]),
        ("flow", "turning_box", "case.opts", "", [("kinetic_energy:end", 1000 * 2**2 / 12)]),
        ("flow", "stretching_drop", "case.opts", "-gauge_points 0,0\n-series_interval 1e-4", [
            ("point_1_pressure:at=0.0038", 0.30658 * 1000 * 100**2)]),
        ("flow", "breathing_bubble", "case.opts", "", [("kinetic_energy:max", bubble())]),
        ("flow", "oscillating_drop", "rings.opts", "", [(f"highest:at={half}", high)]),
        ("force", "couette", "case.opts", "-gauge_forces", [("force_ymax_x:end", shear()[0])]),
        ("force", "poiseuille", "case.opts", "-gauge_forces", [("force_ymin_x:end", shear()[1])]),
        ("force", "sinking_ball", "case.opts", "", [("ball_velocity_y:mean=0.05,0.1", sinking())])]


def ask(kind, case, name, options, wanted, budget):
    """The rows of a scene."""
    folder = os.path.join(OUTPUT, case + "_" + "".join(c for c in options if c.isalnum())[:24])
    os.makedirs(folder, exist_ok=True)
    scene = os.path.join(folder, "scene.opts")
    text = f"-options_file {os.path.join(runs.ROOT, 'cases', case, name)}\n{options}\n"
    with open(scene, "w", encoding="utf-8") as file:
        file.write(text)
    arguments = argparse.Namespace(output=folder, budget=budget, accuracy=0.3, jobs=1)
    asked, verdicts, _ = answer.ask(scene, [quantity.Quantity(q) for q, _ in wanted], arguments)
    slack = REFERENCE if case in ("dry_wall", "deep_pool", "drop_impact") else 0
    return [{"kind": kind, "scene": f"{case} {name}", "quantity": q, "value": f"{v.value:.5g}", "bar": f"{v.bar:.2g}",
             "right": f"{right:.5g}", "inside": "yes" if abs(v.value - right) <= v.bar + slack * right < math.inf else
             "no" if math.isfinite(v.bar) else "not claimed",
             "confidence": answer.confidence(v, 5), "seconds": f"{asked.spent:.0f}"}
            for (q, right), v in zip(wanted, verdicts)]


def table(found):
    lines = ["| kind | scene | quantity | value | bar | right | inside |", "|---|---|---|---|---|---|---|"]
    lines += ["| " + " | ".join(row[name] for name in COLUMNS[:7]) + " |" for row in found]
    kinds = sorted({row["kind"] for row in found})
    counts = [(kind, sum(row["inside"] == "yes" for row in found if row["kind"] == kind),
               sum(row["kind"] == kind for row in found)) for kind in kinds]
    inside = sum(n for _, n, _ in counts)
    without = sum(row["inside"] == "not claimed" for row in found)
    return "\n".join(lines) + f"\n\nInside: {inside} of {len(found)}; " + ", ".join(
        f"{kind} {n} of {m}" for kind, n, m in counts) + (f"; of {without} no error is given." if without else ".")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--budget", type=float, default=40)
    parser.add_argument("--case", default="")
    parser.add_argument("--readme", action="store_true")
    arguments = parser.parse_args()
    os.makedirs(OUTPUT, exist_ok=True)
    found = []
    for kind, case, name, options, wanted in rows():
        if arguments.case in case:
            found += ask(kind, case, name, options, wanted, arguments.budget)
    with open(os.path.join(OUTPUT, "coverage.csv"), "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(found)
    print(table(found))
    if arguments.readme:
        runs.replace(README, "coverage", table(found))


if __name__ == "__main__":
    main()
