"""Tables of the work-precision study for a reader."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from validation.study.document import Table
from validation.study.timing import spread
from validation.workprecision.points import Point, Study
from validation.workprecision.settings import PAIRS, STEPS, TITLES


def paper_table(studies: Sequence[Study]) -> Table:
    header = (
        *("scene", "paper's mesh (ms)", "its error (%)", "paper's model (ms)", "its error (%)"),
        *("fastest as accurate as the paper's mesh", "its time (ms)", "part of the mesh's time"),
    )
    return Table(header, tuple(_paper_row(study) for study in studies))


def _paper_row(study: Study) -> tuple[str, ...]:
    mesh = next(point for point in study.points if point.setting.is_paper_mesh)
    model = next(point for point in study.points if point.setting.is_paper_model)
    best = as_accurate(study, mesh)
    return (
        TITLES[study.scene.name],
        *(spread(study.paper, 1e3), _percent(mesh.error.curve_max)),
        *(spread(model.seconds, 1e3), _percent(model.error.curve_max)),
        *(best.setting.label, spread(best.seconds, 1e3), f"1/{1.0 / best.ratio.median:.3g}"),
    )


def as_accurate(study: Study, mesh: Point) -> Point:
    """The fastest run of the whole curve whose error is at most that of `mesh`."""
    able = [
        point
        for point in study.points
        if point.competes
        and point.setting.steps >= STEPS
        and point.error.curve_max <= max(mesh.error.curve_max, study.reference.curve)
    ]
    return min(able, key=lambda point: point.ratio.median, default=mesh)


def reference_table(studies: Sequence[Study]) -> Table:
    header = (
        *("scene", "curve, half the mesh (of the peak)", "curve, half the steps (of the peak)"),
        *("shape, half the mesh (mm)", "shape, half the steps (mm)", "from the exact rod (of the peak)"),
    )
    rows = []
    for study in studies:
        own = study.reference
        changes = (
            own.by_mesh.curve_max,
            own.by_steps.curve_max,
            own.by_mesh.shape_max,
            own.by_steps.shape_max,
        )
        exact = "no exact solution" if own.exact is None else f"{own.exact:.1e}"
        rows.append((TITLES[study.scene.name], *(f"{change:.1e}" for change in changes), exact))
    return Table(header, tuple(rows))


def front_table(studies: Sequence[Study], chosen: Callable[[Study], tuple[Point, ...]]) -> Table:
    header = ("scene", "setting", "time (ms)", "part of the paper's mesh", "curve (%)", "shape (mm)")
    rows = []
    for study in studies:
        for point in chosen(study):
            share = f"{point.ratio.median:.3g}"
            errors = (_percent(point.error.curve_max), f"{point.error.shape_max:.2g}")
            name = TITLES[study.scene.name]
            rows.append((name, point.setting.label, spread(point.seconds, 1e3), share, *errors))
    return Table(header, tuple(rows))


def peer_table(studies: Sequence[Study]) -> Table:
    """OpenSees beside the wire model with the same mesh and steps."""
    header = (
        *("scene", "elements a turn", "steps", "outcome", "OpenSees (ms)", "wire model (ms)"),
        *("OpenSees / wire model", "OpenSees, curve (%)", "wire model, curve (%)"),
    )
    rows = []
    for study in studies:
        for point in study.peers:
            same = replace(point.setting, series="straight")
            wire = next(other for other in study.points if other.setting == same)
            beside = study.paper if same.is_paper_mesh else wire.seconds
            rows.append(
                (
                    *(TITLES[study.scene.name], str(same.mesh), str(same.steps)),
                    *(point.outcome.replace("_", " "), spread(point.seconds, 1e3), spread(beside, 1e3)),
                    f"{point.ratio.median / wire.ratio.median:.3g}",
                    *(f"{100.0 * each.error.curve_max:.4f}" for each in (point, wire)),
                )
            )
    return Table(header, tuple(rows))


def differing_pairs(study: Study) -> list[Point]:
    """Points that differ in the number of pairs alone, where coils touch at all."""
    if not study.reference.path.active_contacts.any():
        return []
    others = {point.setting for point in study.points if point.setting.pairs not in (0, PAIRS)}
    meshes = {(setting.series, setting.mesh, setting.steps) for setting in others}
    return [
        point
        for point in study.points
        if (point.setting.series, point.setting.mesh, point.setting.steps) in meshes
    ]


def pairs_table(studies: Sequence[Study]) -> Table:
    header = ("scene", "pairs a turn", "outcome", "time (ms)", "curve (%)", "shape (mm)")
    rows = []
    for study in studies:
        for point in sorted(differing_pairs(study), key=lambda each: each.setting.pairs):
            errors = (_percent(point.error.curve_max), f"{point.error.shape_max:.2g}")
            time = spread(point.seconds, 1e3)
            name = TITLES[study.scene.name]
            rows.append((name, str(point.setting.pairs), point.outcome, time, *errors))
    return Table(header, tuple(rows))


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g}"
