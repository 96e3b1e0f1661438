"""Data of the paper's curves, Figures 5, 7 and 8, as DataFrames that the figures draw."""

import numpy as np
import pandas as pd

from validation.study.cases import CASES, case
from validation.study.frames import TIPS
from validation.study.paths import PathStore

CONTACT = ("contact", "no_contact")
TANGENTS = ("paper", "exact")


def both_models(store: PathStore, name: str, tips: tuple[str, ...]) -> pd.DataFrame:
    """Figures 5 and 7: displacements of a spring's tip, both models, with and without contact."""
    times = store.beam(case(name).scene).times
    columns = {"time": times, "load_N": times * np.hypot(*case(name).scene.load.force)}
    for tag, end in zip(CONTACT, ("", "-no-contact"), strict=True):
        for model, solve in (("equivbeam", store.beam), ("wirefe", store.wire)):
            path = solve(case(name + end).scene)
            columns |= {f"{tip}_{tag}_{model}": path.tips[:, TIPS.index(tip)] for tip in tips}
    return pd.DataFrame(columns)


def iteration_counts(store: PathStore) -> pd.DataFrame:
    """Figure 8: factorisations of the equivalent beam in every substep."""
    counts = {
        f"{item.name}_{tangent}_tangent": store.beam(item.scene, tangent=tangent).iterations
        for item in CASES
        for tangent in TANGENTS
    }
    steps = np.arange(1, len(next(iter(counts.values()))) + 1)
    return pd.DataFrame({"substep": steps, "time": steps / len(steps)} | counts)
