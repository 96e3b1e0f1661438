"""Data of the paper's curves: Figures 5, 7 and 8."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from validation.study.cases import PathStore, case
from validation.study.document import Table

Column = tuple[str, np.ndarray]
TIPS = ("ux_mm", "uy_mm", "rotz_rad")


def tip_curves(store: PathStore) -> Table:
    """Figure 5: tip displacements of Spring A, both models, with and without contact."""
    return _both_models(store, ("spring-a", "spring-a-no-contact"), TIPS)


def load_deflection(store: PathStore) -> Table:
    """Figure 7: deflection of Spring B, both models, with and without contact."""
    return _both_models(store, ("spring-b", "spring-b-no-contact"), TIPS[1:2])


def _both_models(store: PathStore, names: tuple[str, ...], tips: tuple[str, ...]) -> Table:
    times = store.beam(case(names[0]).scene).times
    force = np.hypot(*case(names[0]).scene.load.force)
    columns: list[Column] = [("time", times), ("load_N", times * force)]
    for name in names:
        scene = case(name).scene
        tag = "contact" if scene.contact.enabled else "no_contact"
        for model, solve in (("equivbeam", store.beam), ("wirefe", store.wire)):
            path = solve(scene)
            columns += [(f"{tip}_{tag}_{model}", path.tips[:, TIPS.index(tip)]) for tip in tips]
    return _table(columns, "{:.9g}".format)


def iteration_counts(store: PathStore) -> Table:
    """Figure 8: factorisations of the equivalent beam in every substep."""
    columns: list[Column] = []
    for name in ("spring-a", "spring-a-no-contact", "spring-b", "spring-b-no-contact"):
        scene = case(name).scene
        for tangent in ("paper", "exact"):
            path = store.beam(scene, tangent=tangent)
            columns.append((f"{name}_{tangent}_tangent", path.iterations))
    steps = np.arange(1, len(columns[0][1]) + 1)
    return _table([("substep", steps), ("time", steps / len(steps)), *columns], "{:g}".format)


def _table(columns: list[Column], text: Callable[[float], str]) -> Table:
    rows = zip(*(values.tolist() for _, values in columns), strict=True)
    return Table(tuple(name for name, _ in columns), tuple(tuple(map(text, row)) for row in rows))
