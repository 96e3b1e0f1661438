"""The page of the work-precision study, and its files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from validation.study.document import Block, Heading, Picture, Text, to_markdown
from validation.study.machine import machine, versions
from validation.study.output import write_text
from validation.workprecision import equalerror, penaltysweep, tables
from validation.workprecision.csvfile import data
from validation.workprecision.penaltysweep import Sweep
from validation.workprecision.points import Study
from validation.workprecision.settings import PAIRS, STEPS, Extent

CAPTIONS = {
    "curve": "Error of the load curve against CPU time. Filled symbols: the scenes' 50 steps; small open "
    "ones: other numbers of steps, whose error is that at their own points. The slower filled circles are "
    "haringx with the paper's tangent. Grey line: Pareto front of the runs of 50 steps and more.",
    "shape": "Error of the shape at full load against CPU time. Filled symbols: the scenes' 50 steps; "
    "small open ones: other numbers of steps. Grey line: Pareto front of all runs.",
    "penalty": "(a) Error of the load curve against hard contact of the same model, and (b) CPU time, over "
    "the penalty. Vertical line: the scenes' penalty. Crosses: the path ends at a limit point.",
}


def write(
    studies: Sequence[Study], sweeps: Sequence[Sweep], extent: Extent, out: Path, *, drawn: bool
) -> None:
    """Write both tables; `drawn` tells whether the figures are there to be shown."""
    write_text(out / "workprecision.csv", data(studies, sweeps))
    write_text(out / "workprecision.md", markdown(studies, sweeps, extent, drawn))


def markdown(studies: Sequence[Study], sweeps: Sequence[Sweep], extent: Extent, drawn: bool) -> str:
    """The study for a reader."""
    blocks: list[Block] = [
        Heading(1, "Run time against error"),
        *_method(extent),
        Heading(2, "Time at equal error"),
        Text(equalerror.WORDS),
        equalerror.equal_error_table(studies),
        Heading(2, "What the paper's accuracy costs"),
        tables.paper_table(studies),
        Text(_PAPER),
        Heading(2, "The reference's own error"),
        tables.reference_table(studies),
        Text(_REFERENCE),
        *(_pictures() if drawn else []),
        Heading(2, "Pareto front of the load curve"),
        tables.front_table(studies, lambda study: study.curve_front),
        Heading(2, "Pareto front of the shape at full load"),
        tables.front_table(studies, lambda study: study.shape_front),
    ]
    blocks += [Heading(2, "OpenSees"), *_peer(studies, extent)]
    if sweeps:
        picture = [Picture("workprecision-penalty.png", CAPTIONS["penalty"])] if drawn else []
        blocks += [
            Heading(2, "Penalty"),
            Text(penaltysweep.WORDS),
            *picture,
            penaltysweep.penalty_table(sweeps),
        ]
    if any(tables.differing_pairs(study) for study in studies):
        blocks += [Heading(2, "Pairs a turn"), Text(_PAIRS), tables.pairs_table(studies)]
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


_NO_PEER = (
    "Not in these figures: OpenSees was not installed where they were measured "
    "(`pip install -e '.[peers]'` adds it)."
)


def _peer(studies: Sequence[Study], extent: Extent) -> list[Block]:
    if not any(study.peers for study in studies):
        return [Text(_NO_PEER)]
    version = versions("openseespy")["openseespy"]
    words = (
        f"The wire model of straight elements in another code, openseespy {version}: same nodes, section, "
        "supports, sphere pairs and penalty, so that its error is that of the mesh, too. Its time is that of "
        f"the analysis without the building of the model; timed rounds beside the paper's mesh: "
        f"{extent.peer_rounds}. It has no shape here and is on no front."
    )
    return [Text(words), tables.peer_table(studies)]


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


def digest(study: Study) -> str:
    """A scene for a reader at the terminal."""
    mesh = next(point for point in study.points if point.setting.is_paper_mesh)
    best = tables.as_accurate(study, mesh)
    front = ", ".join(point.setting.label.removesuffix(f", {STEPS} steps") for point in study.curve_front)
    return (
        f"{study.scene.name}: as accurate as the paper's mesh in 1/{1.0 / best.ratio.median:.3g} of its time "
        f"by {best.setting.label}; front of the load curve: {front}"
    )


def _pictures() -> list[Block]:
    return [Picture(f"workprecision-{name}.png", CAPTIONS[name]) for name in ("curve", "shape")]
