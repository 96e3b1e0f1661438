"""What each refinement of the helix law is worth on the paper's four cases, for the error budget."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

import equivbeam
import wirefe
from coilspring import EquilibriumPath
from equivbeam import Refinements
from validation.study.cases import CASES
from validation.study.exactrod import EXACT_ROD
from validation.study.metrics import compare_paths
from validation.study.partialsolve import as_far

COLUMNS = ("table", "row", "case", "value")
CONVERGED: dict[str, Any] = {"element": "curved", "elements_per_turn": 16}
NOTHING = Refinements(**dict.fromkeys(vars(Refinements()), False))


@dataclass(frozen=True)
class Stage:
    """One refinement: its switch, its name in the tables and what it is."""

    switch: str
    name: str
    meaning: str


STAGES = (
    Stage(
        "large",
        "Love's axial law, free winding",
        "a half coil is a uniform helix in large deformation, its radius and angle follow the load; "
        "its ends turn freely about the axis",
    ),
    Stage("held", "winding held", "the ends of a half coil do not turn about the axis"),
    Stage("shear", "wire shear", "transverse shear of the wire"),
    Stage("stretch", "wire stretch", "axial stretch of the wire"),
    Stage(
        "taper",
        "taper",
        "radius of a half coil by its axial flexibility, the mean of r^3 over it",
    ),
    Stage(
        "lateral",
        "lateral by wire theory",
        "lateral and bending flexibility of the wire averaged over a turn, at rest",
    ),
    Stage("spread", "bending spread", "bending acts along the half coil, not in its middle: l^2 Cfl / 12"),
    Stage(
        "current",
        "at the current angle",
        "lateral and bending flexibility follow the length of the half coil",
    ),
    Stage(
        "ends",
        "what held ends do",
        "the axis tilts and stands off where the wire is held, and turns in the half coils of a cone; it is "
        "how the start phase enters",
    ),
)


@dataclass(frozen=True)
class Reference:
    """A wire path that the law is judged by, and the column's title."""

    title: str
    path: EquilibriumPath


def references() -> list[Reference]:
    """The four cases by the converged wire model."""
    return [Reference(case.title, as_far(wirefe.solve, case.scene, **CONVERGED)) for case in CASES]


def error(reference: Reference, **options: Any) -> float:
    """Largest error of the load curve of the helix law, per cent of the reference's peak."""
    chosen = {"law": "helix", "sliding": "scene"} | options
    path = as_far(equivbeam.solve, reference.path.scene, **chosen)
    return 100.0 * compare_paths(path, reference.path).curve_max


def ladder(found: Sequence[Reference]) -> list[tuple[str, list[float]]]:
    """Errors with one refinement after the other."""
    rows = [("Haringx, the paper's law", [error(item, refinements=NOTHING) for item in found])]
    on = NOTHING
    for stage in STAGES:
        on = replace(on, **{stage.switch: True})
        rows.append((f"+ {stage.name}", [error(item, refinements=on) for item in found]))
    return rows


def without_one(found: Sequence[Reference]) -> list[tuple[str, list[float]]]:
    """Errors of the whole law with one refinement left out."""
    whole = Refinements()
    rows = [("helix law", [error(item) for item in found])]
    for stage in STAGES:
        less = replace(whole, **{stage.switch: False})
        rows.append((f"without `{stage.switch}`", [error(item, refinements=less) for item in found]))
    return rows


def reference_errors(found: Sequence[Reference]) -> list[tuple[str, list[float]]]:
    """What the mesh and the number of pairs change in the references themselves, per cent."""
    mesh, pairs = [], []
    for item in found:
        scene, options = item.path.scene, dict[str, Any](item.path.options)
        count = options["pairs_per_turn"]
        coarse = as_far(wirefe.solve, scene, element="curved", elements_per_turn=8, pairs_per_turn=count)
        mesh.append(100.0 * compare_paths(coarse, item.path).curve_max)
        other = as_far(wirefe.solve, scene, **CONVERGED, pairs_per_turn=2 * count)
        pairs.append(100.0 * compare_paths(other, item.path).curve_max if scene.contact.enabled else math.nan)
    return [("8 elements a turn", mesh), ("twice the pairs a turn", pairs)]


def phase_errors(found: Sequence[Reference]) -> list[tuple[str, list[float]]]:
    """Errors of the law at other start phases, the wire model's the same, without contact.

    With contact each phase has its spheres elsewhere: other phases are other contact models.
    """
    rows = []
    for degrees in (45, 90, 270):
        phase = math.radians(degrees)
        rows.append((f"helix law, start phase {degrees} degrees", [_turned(item, phase) for item in found]))
    return rows


def _turned(reference: Reference, phase: float) -> float:
    """Error at another start phase, per cent; nothing with contact."""
    scene = reference.path.scene
    scene = replace(scene, spring=replace(scene.spring, start_phase=phase))
    if scene.contact.enabled:
        return math.nan
    wire = wirefe.solve(scene, **CONVERGED)
    return 100.0 * compare_paths(equivbeam.solve(scene, law="helix"), wire).curve_max


def rod_tips() -> list[tuple[str, str, str, float]]:
    """UY of Spring B without contact, mm, and of the exact rod."""
    scene = CASES[3].scene.with_steps(2)
    options: dict[str, dict[str, Any]] = {
        "helix law": {"law": "helix"},
        "without `taper`": {"law": "helix", "refinements": Refinements(taper=False)},
        "Haringx": {},
    }
    exact = EXACT_ROD["spring-b-no-contact"]
    tips = {"exact rod": np.array([exact[time][1] for time in (0.5, 1.0)])}
    tips |= {name: equivbeam.solve(scene, **chosen).tips[:, 1] for name, chosen in options.items()}
    return [
        ("rod", name, load, float(uy))
        for name, values in tips.items()
        for load, uy in zip(("100 N", "200 N"), values, strict=True)
    ]


def outside_share(reference: Reference) -> float:
    """Share of a wire path's last normal forces in pairs outside the working plane, per cent."""
    path = reference.path
    pairs: np.ndarray = path.shape.data.contact.pairs  # type: ignore[attr-defined]
    # spheres stand at phases k pi / 2 from the bottom end on, which is a crossing of the plane
    odd = pairs[:, 0] % 2 == 1
    forces = path.contact_forces[-1]
    return float(100.0 * forces[odd].sum() / forces.sum())


def measured() -> pd.DataFrame:
    """All numbers of the four cases, a row each: its table, row and case."""
    found = references()
    titles = [item.title for item in found]
    tables = {
        "refinements": ladder(found),
        "law": [*without_one(found), *phase_errors(found)],
        "reference with": reference_errors(found),
    }
    numbers = [
        (table, name, title, value)
        for table, rows in tables.items()
        for name, values in rows
        for title, value in zip(titles, values, strict=True)
        if not math.isnan(value)
    ]
    spring_b = next(item for item in found if item.title == "Spring B")
    numbers.append(("outside", "normal forces", spring_b.title, outside_share(spring_b)))
    return pd.DataFrame([*numbers, *rod_tips()], columns=list(COLUMNS))
