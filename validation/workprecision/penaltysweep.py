"""What the penalty costs: time and error of both models, each against itself with hard contact.

Hard contact is a penalty of `HARD`. With exponent 1 the penetration, and with it the error, falls in
proportion to the penalty; so what a tenth of `HARD` changes is more than the reference's own error.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from coilspring import Scene
from validation.study.cases import PAPER_MESH, solve_beam, solve_wire
from validation.study.document import Table
from validation.study.metrics import Comparison, compare_paths
from validation.study.partialsolve import as_far
from validation.study.timing import Spread, spread
from validation.workprecision.settings import PAPER_LAW, TITLES

SCENES = ("spring-a", "spring-b")
PENALTIES = (1e2, 1e3, 1e4, 1e5, 1e6)  # N/mm
HARD, LESS_HARD = 1e8, 1e7  # N/mm
SOLVES = {"equivbeam": solve_beam, "wirefe": solve_wire}
NAMES = {"equivbeam": f"beam {PAPER_LAW}", "wirefe": f"wire straight {PAPER_MESH['elements_per_turn']}"}
WORDS = (
    "Each model against itself with hard contact: a penalty of 1e8 N/mm, which differs from one of 1e7 by "
    "the reference's own error. Error and time as above; the error is that of the part of the path that was "
    "reached. Penalty: of a sphere pair at 4 pairs a turn."
)


@dataclass(frozen=True)
class PenaltyPoint:
    """One model with one penalty.

    Attributes
    ----------
    penalty : N/mm.
    outcome : of the path.
    error : distance from the model's path with hard contact.
    ratio : its time over that of the paper's mesh with the scene's penalty, formed within each round.
    seconds : CPU seconds of the solve.
    iterations : factorisations.
    """

    penalty: float
    outcome: str
    error: Comparison
    ratio: Spread
    seconds: Spread
    iterations: int


@dataclass(frozen=True)
class Sweep:
    """Both models over the penalty on one scene.

    Attributes
    ----------
    scene : with its own penalty.
    points : of each model, in the order of `PENALTIES`.
    own : what a tenth of the hard penalty changes, of each model.
    """

    scene: Scene
    points: dict[str, tuple[PenaltyPoint, ...]]
    own: dict[str, Comparison]


def sweep(scene: Scene, rounds: int, progress: Callable[[str], None]) -> Sweep:
    """Errors and times of both models; all penalties of both run in turn, round after round."""
    progress(f"{scene.name}: hard contact")
    hard = {model: as_far(solve, scene, penalty=HARD) for model, solve in SOLVES.items()}
    own = {
        model: compare_paths(as_far(solve, scene, penalty=LESS_HARD), hard[model])
        for model, solve in SOLVES.items()
    }
    runs = [(model, penalty) for model in SOLVES for penalty in PENALTIES]
    paths = [as_far(SOLVES[model], scene, penalty=penalty) for model, penalty in runs]
    timed = []
    for number in range(rounds):
        progress(f"{scene.name}: penalties, round {number + 1} of {rounds}")
        timed.append([as_far(SOLVES[model], scene, penalty=k).solve_seconds for model, k in runs])
    seconds = np.array(timed).T
    ratios = seconds / seconds[runs.index(("wirefe", scene.contact.stiffness))]
    points: dict[str, tuple[PenaltyPoint, ...]] = dict.fromkeys(SOLVES, ())
    for (model, penalty), path, ratio, times in zip(runs, paths, ratios, seconds, strict=True):
        error = compare_paths(path, hard[model])
        found = (path.outcome, error, Spread.of(ratio), Spread.of(times), path.total_iterations)
        points[model] += (PenaltyPoint(penalty, *found),)
    return Sweep(scene, points, own)


def penalty_table(sweeps: Sequence[Sweep]) -> Table:
    """A row for each scene, model and penalty."""
    asked = ("scene", "setting", "penalty (N/mm)")
    header = (*asked, "outcome", "time (ms)", "iterations", "curve (%)", "reference's own error (%)")
    rows = []
    for each in sweeps:
        for model, points in each.points.items():
            own = f"{100.0 * each.own[model].curve_max:.1g}"
            for point in points:
                numbers = (spread(point.seconds, 1e3), str(point.iterations))
                error = f"{100.0 * point.error.curve_max:.2g}"
                where = (TITLES[each.scene.name], NAMES[model], f"{point.penalty:.0e}".replace("+0", ""))
                rows.append((*where, _ending(point), *numbers, error, own))
    return Table(header, tuple(rows))


def _ending(point: PenaltyPoint) -> str:
    if point.outcome == "completed":
        return "completed"
    return f"{point.outcome.replace('_', ' ')} after t = {point.error.last_time:.2f}"
