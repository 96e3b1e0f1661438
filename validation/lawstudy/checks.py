"""The law by itself: derivatives against differences, closed forms, and how far a half coil holds."""

from typing import Any

import numpy as np

import equivbeam
from coilspring import Load, Scene, Spring, spring_a, spring_b
from coilspring.scene.sizing import axial_rate, buckling_shortening
from equivbeam.column import lateral_stiffness
from equivbeam.laws.halfcoil import spring_coils
from equivbeam.laws.haringx import KAX, L0, haringx_rows
from equivbeam.laws.lawchecks import SECOND, U
from equivbeam.laws.userlaw import UserLaw
from validation.campaign.laws import PlainEnergy

STATES = 40  # random ones of every half coil
SPREAD = (0.2, 0.15, 0.1)  # of l and v over l0, and of dtheta, rad
SLENDERNESS = (3.0, 4.0, 6.0, 8.0)
DIRECTIONS = {
    "shortened": (-1.0, 0.0, 0.0),
    "drawn out": (1.0, 0.0, 0.0),
    "sheared": (0.0, 1.0, 0.0),
    "bent": (0.0, 0.0, 1.0),
}
FARTHEST = {"shortened": 0.95, "drawn out": 3.0, "sheared": 2.0, "bent": 1.5}  # over l0, or rad
POINTS = 2000
Row = dict[str, Any]


def derivatives(law: UserLaw) -> list[Row]:
    """Largest deviations from derivatives by differences, over the stiffness at rest."""
    rows = []
    for scene in (spring_a(), spring_b()):
        coils, table = spring_coils(scene.spring, scene.material), law.rows(scene.spring, scene.material)
        plain = PlainEnergy(law, coils)
        rng = np.random.default_rng(1)
        x = rng.normal(size=(3, STATES, len(coils))) * np.reshape(SPREAD, (3, 1, 1)) * plain.size[:, None]
        x[0] += plain.size[0]
        index = np.tile(np.arange(len(coils)), STATES)
        found = law.evaluated(table, index, x.reshape(3, -1).T)
        energy, g, H = (each.reshape(-1, STATES * len(coils)) for each in plain.derivatives(x, second=True))
        scale = plain.size[:, index]
        rest = np.max(table[:, :L0] * plain.size.T**2, axis=1)[index]
        pairs = (scale[:, None] * scale[None]).reshape(9, -1)
        off = {
            "energy": np.abs(found[:, U] - energy[0]) / rest,
            "gradient": np.abs((found[:, 1:4].T - g) * scale).max(axis=0) / rest,
            "Hessian": np.abs((found[:, SECOND].T - H) * pairs).max(axis=0) / rest,
        }
        known = np.isfinite(off["Hessian"])
        for what, each in off.items():
            row = {"spring": scene.name, "what": what, "states": int(known.sum())}
            rows.append(row | {"deviation": float(each[known].max())})
    return rows


def limits(law: UserLaw) -> list[Row]:
    """Rate at rest against G d^4 / (8 D^3 n), buckling and lateral stiffness against Haringx's column."""
    force, both = Load((0.0, -1.0)), (law, "haringx")
    rows: list[tuple] = []
    cylinders = {
        f"D/d = 10, pitch {k:g} d": Spring(1.0, (10.0, 10.0), 10.0, 10.0 * k) for k in (1.05, 2.0, 4.0)
    }
    for name, spring in {"Spring A": spring_a().spring, **cylinders}.items():
        scene = Scene("rate", spring, force)
        tables = law.rows(spring, scene.material), haringx_rows(spring, scene.material)
        rates = [1.0 / float((1.0 / table[:, KAX]).sum()) for table in tables]  # of half coils in series
        rows.append(("axial rate at rest (N/mm)", name, axial_rate(scene), rates))
    for slenderness in SLENDERNESS:
        name, height = f"L/D = {slenderness:g}, clamped and free", 10.0 * slenderness
        scene = Scene("column", Spring(1.0, (10.0, 10.0), 0.5 * height, height, end_turns=0.0), force)
        formula, buckled = buckling_shortening(scene), [equivbeam.buckling(scene, law=each) for each in both]
        shares = [each and each.shortening * (1.0 / height) for each in buckled]
        rows.append(("buckling, shortening over L", name, formula and formula * (1.0 / height), shares))
        lateral = [_lateral(each, scene) for each in both]
        rows.append(("lateral stiffness at 10 % (N/mm)", name, None, lateral))
    return [
        {"what": what, "spring": name, "found": found, "formula": formula, "haringx": haringx}
        for what, name, formula, (found, haringx) in rows
    ]


def _lateral(law: UserLaw | str, scene: Scene) -> float | None:
    try:
        return lateral_stiffness(scene, 0.1 * scene.spring.active_height, law=law)
    except ValueError:  # it has buckled
        return None


def holds(law: UserLaw) -> list[Row]:
    """How far the middle half coil of the paper's springs can be moved until its energy fails."""
    rows = []
    for scene in (spring_a(), spring_b()):
        table = law.rows(scene.spring, scene.material)
        middle, length = len(table) // 2, float(table[len(table) // 2, L0])
        size = np.array([length, length, 1.0])
        for name, direction in DIRECTIONS.items():
            shares = np.linspace(0.0, FARTHEST[name], POINTS)[:, None]
            points = np.array([length, 0.0, 0.0]) + shares * np.array(direction) * size
            found = law.evaluated(table, np.full(POINTS, middle), points)
            finite = np.isfinite(found).all(axis=1)
            matrices = np.where(finite[:, None], found[:, SECOND], 0.0).reshape(-1, 3, 3)
            least = np.linalg.eigvalsh(matrices * size[:, None] * size)[:, 0]
            bad = np.flatnonzero(~(finite & (least > 0.0)))
            first = int(bad[0]) if bad.size else POINTS - 1
            what = "holds" if not bad.size else "is not stable" if finite[first] else "is not finite"
            unit = "rad" if name == "bent" else "l0"
            row = {"spring": scene.name, "direction": name, "share": float(shares[first, 0])}
            rows.append(row | {"unit": unit, "what": what})
    return rows
