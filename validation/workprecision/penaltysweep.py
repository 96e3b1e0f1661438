"""What the penalty costs: time and error of both models, each against itself with hard contact.

Hard contact is a penalty of `HARD`. With exponent 1 the penetration, and with it the error, falls in
proportion to the penalty; so what a tenth of `HARD` changes is more than the reference's own error.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd

from coilspring import EquilibriumPath, Scene
from validation.study.cases import solve_beam, solve_wire
from validation.study.metrics import compare_paths
from validation.study.partialsolve import partial_path
from validation.study.timing import announced, interleaved, quartiles
from validation.workprecision.results import row
from validation.workprecision.settings import PAIRS, PAPER_ELEMENTS, PAPER_LAW, Setting

SCENES = ("spring-a", "spring-b")
PENALTIES = (1e2, 1e3, 1e4, 1e5, 1e6)  # N/mm
HARD, LESS_HARD = 1e8, 1e7  # N/mm
MESH = Setting("straight", PAPER_ELEMENTS, PAIRS, geometry="spheres")
BEAM = Setting(PAPER_LAW, tangent="exact", sliding="ignore")
SOLVES = {BEAM: solve_beam, MESH: solve_wire}


def penalty_rows(scene: Scene, rounds: int, progress: Callable[[str], None]) -> pd.DataFrame:
    """Errors and times of both models; all penalties of both run in turn, round after round."""

    def solved(setting: Setting, penalty: float) -> EquilibriumPath:
        return partial_path(SOLVES[setting], scene, penalty=penalty)

    progress(f"{scene.name}: hard contact")
    hard = {setting: solved(setting, HARD) for setting in SOLVES}
    own = {setting: compare_paths(solved(setting, LESS_HARD), path) for setting, path in hard.items()}
    paths = {(setting, penalty): solved(setting, penalty) for setting in SOLVES for penalty in PENALTIES}
    runs = {run: lambda run=run: solved(*run).solve_seconds for run in paths}
    seconds = interleaved(runs, announced(rounds, progress, f"{scene.name}: penalties"))
    paper = seconds[MESH, scene.contact.stiffness]
    rows = []
    for (setting, penalty), path in paths.items():
        taken = seconds[setting, penalty]
        found = row(
            "penalty", scene, setting, compare_paths(path, hard[setting]), outcome=path.outcome,
            iterations=path.total_iterations, **quartiles("seconds", taken), rounds=rounds,
            ratio_to_paper_mesh=float(np.median(taken / paper)),
            reference_curve_error=own[setting].curve_max, reference_shape_error_mm=own[setting].shape_max,
            on_curve_front=0, on_shape_front=0,
        )  # fmt: skip
        rows.append(found | {"penalty": penalty})
    return pd.DataFrame(rows)
