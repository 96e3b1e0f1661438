"""Data of the paper's curves, Figures 5, 7 and 8, as DataFrames that the figures draw."""

from __future__ import annotations

import numpy as np
import pandas as pd

from validation.study.cases import PathStore, case

TIPS = ("ux_mm", "uy_mm", "rotz_rad")
CONTACT = ("contact", "no_contact")
TANGENTS = ("paper", "exact")


def tip_curves(store: PathStore) -> pd.DataFrame:
    """Figure 5: tip displacements of Spring A, both models, with and without contact."""
    return _both_models(store, "spring-a", TIPS)


def load_deflection(store: PathStore) -> pd.DataFrame:
    """Figure 7: deflection of Spring B, both models, with and without contact."""
    return _both_models(store, "spring-b", TIPS[1:2])


def _both_models(store: PathStore, name: str, tips: tuple[str, ...]) -> pd.DataFrame:
    times = store.beam(case(name).scene).times
    columns = {"time": times, "load_N": times * np.hypot(*case(name).scene.load.force)}
    for tag, end in zip(CONTACT, ("", "-no-contact"), strict=True):
        scene = case(name + end).scene
        for model, solve in (("equivbeam", store.beam), ("wirefe", store.wire)):
            path = solve(scene)
            columns |= {f"{tip}_{tag}_{model}": path.tips[:, TIPS.index(tip)] for tip in tips}
    return pd.DataFrame(columns)


def iteration_counts(store: PathStore) -> pd.DataFrame:
    """Figure 8: factorisations of the equivalent beam in every substep."""
    columns: dict[str, np.ndarray] = {}
    for name in ("spring-a", "spring-a-no-contact", "spring-b", "spring-b-no-contact"):
        for tangent in TANGENTS:
            columns[f"{name}_{tangent}_tangent"] = store.beam(case(name).scene, tangent=tangent).iterations
    counts = pd.DataFrame(columns)
    steps = np.arange(1, len(counts) + 1)
    counts.insert(0, "substep", steps)
    counts.insert(1, "time", steps / len(counts))
    return counts
