"""Time at equal error: each law of the half coil against the fastest run of the wire model as good."""

from __future__ import annotations

from collections.abc import Sequence

from equivbeam.laws import LAWS
from validation.study.cases import CASES
from validation.study.document import Table
from validation.study.timing import spread
from validation.workprecision.points import Point, Study
from validation.workprecision.settings import PAPER_LAW, STEPS, TITLES

WORDS = (
    "The paper compares times at unequal errors: its 'reduction' is that of its model against one FE mesh. "
    "Here each law of the half coil, in the scenes' 50 steps and the helix law with their rule of sliding, "
    "stands against the fastest run of the wire model that gives the whole curve with at most the law's "
    "error. 4 elements a turn are the fewest the wire model takes, so its error can be far below the law's. "
    "*Reduction*: time that the beam saves; ratios are formed of medians over the paper's mesh."
)
PAPER_REDUCTION = {case.name: f"{case.paper_reduction:g}" for case in CASES}


def equal_error_table(studies: Sequence[Study]) -> Table:
    """A row for each scene and law."""
    header = (
        *("scene", "law", "its error (%)", "its time (ms)", "wire model, as good at least"),
        *("its error (%)", "its time (ms)", "wire model / beam at equal error", "reduction (%)"),
        *("reduction against the paper's mesh (%)", "paper's reduction (%)"),
    )
    rows = []
    for study in studies:
        for series in LAWS:
            beam = _beam(study, series)
            if beam is not None:
                pair = _pair(beam, cheapest_wire(study, beam))
                rows.append((TITLES[study.scene.name], series, *pair, _paper(study)))
    return Table(header, tuple(rows))


def cheapest_wire(study: Study, beam: Point) -> Point | None:
    """The fastest run of the wire model with at most the error of `beam`; None where there is none."""
    most = max(beam.error.curve_max, study.reference.curve)
    able = [
        point
        for point in study.points
        if point.competes and point.setting.mesh and point.setting.steps >= STEPS
        if point.error.curve_max <= most
    ]
    return min(able, key=lambda point: point.ratio.median, default=None)


def _beam(study: Study, series: str) -> Point | None:
    """A series' run: the paper's law as the paper has it, the helix law by the scene's sliding."""
    found = {
        point.setting.sliding: point
        for point in study.points
        if (point.setting.series, point.setting.steps, point.setting.tangent) == (series, STEPS, "exact")
    }
    return found.get("ignore") if series == PAPER_LAW else found.get("scene", found.get("ignore"))


def _pair(beam: Point, wire: Point | None) -> tuple[str, ...]:
    mine = (f"{100.0 * beam.error.curve_max:.2g}", spread(beam.seconds, 1e3))
    against = f"{100.0 * (1.0 - beam.ratio.median):.1f}"
    if wire is None:
        return (*mine, "none", "", "", "", "", against)
    share = beam.ratio.median / wire.ratio.median
    theirs = (f"{100.0 * wire.error.curve_max:.2g}", spread(wire.seconds, 1e3))
    name = wire.setting.label.removesuffix(f", {STEPS} steps")
    return (*mine, name, *theirs, f"{1.0 / share:.3g}", f"{100.0 * (1.0 - share):.1f}", against)


def _paper(study: Study) -> str:
    return PAPER_REDUCTION.get(study.scene.name, "not in the paper")
