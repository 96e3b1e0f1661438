"""Tables of the work-precision study: CSV for machines, Markdown for reading."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from pathlib import Path

from coilspring import Scene
from validation import equalerror, penaltysweep
from validation.binding import EQUAL_ERROR
from validation.document import Block, Heading, Picture, Table, Text, to_markdown
from validation.machine import machine
from validation.metrics import Comparison
from validation.output import write_text
from validation.penaltysweep import PenaltyPoint, Sweep
from validation.tables import spread
from validation.workprecision import Point, Reference, Study
from validation.worksettings import PAIRS, PAPER_ELEMENTS, PAPER_LAW, STEPS, TITLES, Extent, Setting

HEADER = (
    *("scene", "model", "series", "elements_per_turn", "pairs_per_turn", "tangent", "sliding", "steps"),
    *("penalty", "reference"),
    *("outcome", "last_time", "curve_max", "curve_rms", "shape_max_mm", "shape_rms_mm"),
    *("reference_curve_error", "reference_shape_error_mm", "seconds", "seconds_q1", "seconds_q3"),
    *("ratio_to_paper_mesh", "iterations", "on_curve_front", "on_shape_front"),
)
CAPTIONS = {
    "curve": "Error of the load curve against CPU time. Filled symbols: the scenes' 50 steps; small open "
    "ones: other numbers of steps, whose error is that at their own points. The slower filled circles are "
    "haringx with the paper's tangent. Grey line: Pareto front of the runs of 50 steps and more.",
    "shape": "Error of the shape at full load against CPU time. Filled symbols: the scenes' 50 steps; "
    "small open ones: other numbers of steps. Grey line: Pareto front of all runs.",
    "penalty": "(a) Error of the load curve against hard contact of the same model, and (b) CPU time, over "
    "the penalty. Vertical line: the scenes' penalty. Crosses: the path ends at a limit point.",
}
MESH = Setting("straight", STEPS, PAPER_ELEMENTS, PAIRS)
BEAM = Setting(PAPER_LAW, STEPS, tangent="exact", sliding="ignore")


def write(
    studies: Sequence[Study], sweeps: Sequence[Sweep], extent: Extent, out: Path, *, drawn: bool
) -> None:
    """Write both tables; `drawn` tells whether the figures are there to be shown."""
    write_text(out / "workprecision.csv", data(studies, sweeps))
    write_text(out / "workprecision.md", markdown(studies, sweeps, extent, drawn))


def data(studies: Sequence[Study], sweeps: Sequence[Sweep]) -> str:
    """All points as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADER)
    for study in studies:
        writer.writerows(_row(study, point) for point in study.points)
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


def markdown(studies: Sequence[Study], sweeps: Sequence[Sweep], extent: Extent, drawn: bool) -> str:
    """The study for a reader."""
    blocks: list[Block] = [
        Heading(1, "Run time against error"),
        *_method(extent),
        Heading(2, EQUAL_ERROR),
        Text(equalerror.WORDS),
        equalerror.equal_error_table(studies),
        Heading(2, "What the paper's accuracy costs"),
        _paper_table(studies),
        Text(_PAPER),
        Heading(2, "The reference's own error"),
        _reference_table(studies),
        Text(_REFERENCE),
        *(_pictures() if drawn else []),
        Heading(2, "Pareto front of the load curve"),
        _front_table(studies, lambda study: study.curve_front),
        Heading(2, "Pareto front of the shape at full load"),
        _front_table(studies, lambda study: study.shape_front),
    ]
    if sweeps:
        picture = [Picture("workprecision-penalty.png", CAPTIONS["penalty"])] if drawn else []
        blocks += [
            Heading(2, "Penalty"),
            Text(penaltysweep.WORDS),
            *picture,
            penaltysweep.penalty_table(sweeps),
        ]
    if any(_pairs(study) for study in studies):
        blocks += [Heading(2, "Pairs a turn"), Text(_PAIRS), _pairs_table(studies)]
    return to_markdown(blocks)


_PAPER = (
    "The paper's mesh: straight elements, 40 a turn. The paper's model: the equivalent beam with the law "
    "haringx, here with the exact tangent. Fastest: among the runs of the whole curve whose error is at most "
    "that of the paper's mesh."
)
_REFERENCE = (
    "Without sliding (Spring B) the answer remembers the accepted substeps, so that the steps decide the "
    "reference's error. The exact rod's numbers have six digits after the point, which is 4e-7 of Spring A's "
    "rotation."
)
_PAIRS = (
    f"The number of sphere pairs is part of the contact model: the scenes have {PAIRS} a turn, as the paper. "
    "Others change the answer by this much, which no mesh can tell, and are on neither front."
)


def _method(extent: Extent) -> list[Block]:
    here = machine()
    return [
        Text(
            f"Reference: curved wire elements, {extent.reference} a turn, {extent.finest} steps; its own "
            "error is the change to half its mesh plus the change to half its steps, and is the floor of the "
            "figures. Curve error: largest difference at the same load over the reference's peak, worst "
            "component, at the points that a run has. Shape error: largest distance of the centres of the "
            "contact circles at full load. Only equilibria count: a run that does not reach full load is on "
            "neither front. The equivalent beam's error is that of its model, the wire model's that of "
            "its mesh."
        ),
        Text(
            f"Time: CPU time of the solve alone, one thread, kernels warm; medians of {extent.rounds} "
            "interleaved rounds with quartiles. Ratios to the paper's FE mesh are formed within each round; "
            "times are these ratios times the median time of the paper's mesh. "
            f"Front of the load curve: runs of at least {STEPS} steps, which give all of the curve; of the "
            "shape: any number of steps. A slower run is on a front where its error is at least a tenth "
            "smaller; times within a tenth of each other are taken as one."
        ),
        Text(f"Measured {here['date']} on {here['processor']}; {here['versions']}."),
    ]


def _paper_table(studies: Sequence[Study]) -> Table:
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


def digest(study: Study) -> str:
    """A scene for a reader at the terminal."""
    mesh = next(point for point in study.points if point.setting.is_paper_mesh)
    best = as_accurate(study, mesh)
    front = ", ".join(point.setting.label.removesuffix(f", {STEPS} steps") for point in study.curve_front)
    return (
        f"{study.scene.name}: as accurate as the paper's mesh in 1/{1.0 / best.ratio.median:.3g} of its time "
        f"by {best.setting.label}; front of the load curve: {front}"
    )


def _reference_table(studies: Sequence[Study]) -> Table:
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


def _pictures() -> list[Block]:
    return [Picture(f"workprecision-{name}.png", CAPTIONS[name]) for name in ("curve", "shape")]


def _front_table(studies: Sequence[Study], chosen: Callable[[Study], tuple[Point, ...]]) -> Table:
    header = ("scene", "setting", "time (ms)", "part of the paper's mesh", "curve (%)", "shape (mm)")
    rows = []
    for study in studies:
        for point in chosen(study):
            share = f"{point.ratio.median:.3g}"
            errors = (_percent(point.error.curve_max), f"{point.error.shape_max:.2g}")
            name = TITLES[study.scene.name]
            rows.append((name, point.setting.label, spread(point.seconds, 1e3), share, *errors))
    return Table(header, tuple(rows))


def _pairs(study: Study) -> list[Point]:
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


def _pairs_table(studies: Sequence[Study]) -> Table:
    header = ("scene", "pairs a turn", "outcome", "time (ms)", "curve (%)", "shape (mm)")
    rows = []
    for study in studies:
        for point in sorted(_pairs(study), key=lambda each: each.setting.pairs):
            errors = (_percent(point.error.curve_max), f"{point.error.shape_max:.2g}")
            time = spread(point.seconds, 1e3)
            name = TITLES[study.scene.name]
            rows.append((name, str(point.setting.pairs), point.outcome, time, *errors))
    return Table(header, tuple(rows))


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g}"
