"""All points of the work-precision study as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

from coilspring import Scene
from validation.study.metrics import Comparison
from validation.workprecision.penaltysweep import PenaltyPoint, Sweep
from validation.workprecision.points import Point, Reference, Study
from validation.workprecision.settings import PAIRS, PAPER_ELEMENTS, PAPER_LAW, STEPS, Setting

HEADER = (
    *("scene", "model", "series", "elements_per_turn", "pairs_per_turn", "tangent", "sliding", "steps"),
    *("penalty", "reference"),
    *("outcome", "last_time", "curve_max", "curve_rms", "shape_max_mm", "shape_rms_mm"),
    *("reference_curve_error", "reference_shape_error_mm", "seconds", "seconds_q1", "seconds_q3"),
    *("ratio_to_paper_mesh", "iterations", "on_curve_front", "on_shape_front"),
)
MESH = Setting("straight", STEPS, PAPER_ELEMENTS, PAIRS)
BEAM = Setting(PAPER_LAW, STEPS, tangent="exact", sliding="ignore")


def data(studies: Sequence[Study], sweeps: Sequence[Sweep]) -> str:
    """All points as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADER)
    for study in studies:
        writer.writerows(_row(study, point) for point in (*study.points, *study.peers))
    for sweep in sweeps:
        for model, points in sweep.points.items():
            writer.writerows(_penalty_row(sweep, model, point) for point in points)
    return text.getvalue()


def _penalty_row(sweep: Sweep, model: str, point: PenaltyPoint) -> tuple[object, ...]:
    """A row of the sweep, whose reference is the same model with hard contact."""
    setting = BEAM if model == "equivbeam" else MESH
    return _cells(sweep.scene, setting, point.penalty, "hard contact", point, sweep.own[model], (0, 0))


def _row(study: Study, point: Point) -> tuple[object, ...]:
    fronts = (int(point in study.curve_front), int(point in study.shape_front))
    contact = study.scene.contact
    penalty = contact.stiffness if contact.enabled else None
    return _cells(study.scene, point.setting, penalty, "finest wire", point, study.reference, fronts)


def _cells(
    scene: Scene,
    setting: Setting,
    penalty: float | None,
    reference: str,
    point: Point | PenaltyPoint,
    own: Comparison | Reference,
    fronts: tuple[int, int],
) -> tuple[object, ...]:
    error = point.error
    wire = (setting.mesh or "", setting.pairs or "")
    errors = (error.curve_max, error.curve_rms, error.shape_max, error.shape_rms)
    bounds = (own.curve, own.shape) if isinstance(own, Reference) else (own.curve_max, own.shape_max)
    times = (point.seconds.median, point.seconds.low, point.seconds.high, point.ratio.median)
    return (
        *(scene.name, setting.model, setting.series, *wire, setting.tangent, setting.sliding),
        *(setting.steps, "" if penalty is None else f"{penalty:g}", reference),
        *(point.outcome, f"{error.last_time:.6g}"),
        *(f"{number:.4g}" for number in (*errors, *bounds, *times)),
        *(point.iterations, *fronts),
    )
