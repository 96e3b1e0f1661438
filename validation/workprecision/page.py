"""The page of the work-precision study and its figures: views of its recorded result."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from coilspring import InputError
from validation.study import provenance
from validation.study.document import Block, Heading, Picture, Text, to_markdown
from validation.study.output import write_files, write_text
from validation.workprecision import results, tables
from validation.workprecision.settings import PAIRS, STEPS

CAPTIONS = {
    "curve": "Error of the load curve against CPU time. Filled symbols: the scenes' 50 steps; small open "
    "ones: more steps. Crosses: haringx with the "
    "paper's tangent. Grey line: Pareto front of the runs of 50 steps and more.",
    "shape": "Error of the shape at full load against CPU time. Filled symbols: the scenes' 50 steps; "
    "small open ones: other numbers of steps. Grey line: Pareto front of all runs.",
    "penalty": "(a) Error of the load curve against hard contact of the same model, and (b) CPU time, over "
    "the penalty. Vertical line: the scenes' penalty. Crosses: the path ends at a limit point.",
}


_EQUAL = (
    "The paper compares times at unequal errors: its 'reduction' is that of its model against one FE mesh. "
    "Here each law of the half coil, in the scenes' 50 steps and the helix law with their rule of sliding, "
    "stands against the fastest run of the wire model that gives the whole curve with at most the law's "
    "error. 4 elements per turn are the fewest of the wire model, so its error can be far below the law's. "
    "*Reduction*: time that the beam saves; ratios are formed of medians over the paper's mesh."
)
_PAPER = (
    "The paper's mesh: straight elements, 40 per turn. The paper's model: the equivalent beam with the law "
    "haringx, here with the exact tangent. Fastest: among the runs of the whole curve whose error is at most "
    "that of the paper's mesh."
)
_REFERENCE = (
    "With sticking contact (Spring B) the answer depends on the accepted substeps, so the steps decide the "
    "reference's error. The exact rod's numbers have six digits after the point, which is 4e-7 of Spring A's "
    "rotation."
)
_PAIRS = (
    f"The number of sphere pairs is part of the contact model: the scenes have {PAIRS} per turn, as the "
    "paper. Others change the answer by this much, whatever the mesh, and are on neither front."
)
_PENALTY = (
    "Each model against itself with hard contact: a penalty of 1e8 N/mm, which differs from one of 1e7 by "
    "the reference's own error. Error and time as above; the error is that of the part of the path that was "
    "reached. Penalty: of a sphere pair at 4 pairs per turn."
)
_NO_PEER = (
    "Not in these figures: OpenSees was not installed where they were measured "
    "(`pip install -e '.[peers]'` adds it)."
)


def write(out: Path, drawn: bool = False) -> pd.DataFrame:
    """Write page and, where wanted, figures of the result recorded in a folder; the result.

    Raises
    ------
    InputError : where none is recorded.
    """
    if not (out / results.FILE).is_file() or not (out / provenance.FILE).is_file():
        raise InputError(f"no {results.FILE} with {provenance.FILE} in {out}: measure first")
    rows = results.read(out)
    made = json.loads((out / provenance.FILE).read_text(encoding="utf-8"))
    if drawn:
        from validation.workprecision import figures

        write_files(figures.files(rows), out)
    write_text(out / "workprecision.md", markdown(rows, made, drawn))
    return rows


def markdown(rows: pd.DataFrame, made: Mapping[str, str], drawn: bool) -> str:
    """The study for a reader; `made`: where and when it was measured."""
    blocks: list[Block] = [
        Heading(1, "Run time against error"),
        *_method(rows),
        Text(f"Measured {made['date']} on {made['processor']}; {made['versions']}."),
        Heading(2, "Time at equal error"),
        Text(_EQUAL),
        tables.equal_error_table(rows),
        Heading(2, "What the paper's accuracy costs"),
        tables.paper_table(rows),
        Text(_PAPER),
        Heading(2, "The reference's own error"),
        tables.reference_table(rows),
        Text(_REFERENCE),
        *(_picture(kind) for kind in ("curve", "shape") if drawn),
        Heading(2, "Pareto front of the load curve"),
        tables.front_table(rows, "curve"),
        Heading(2, "Pareto front of the shape at full load"),
        tables.front_table(rows, "shape"),
        Heading(2, "OpenSees"),
        *_peer(rows, made),
    ]
    if (rows["role"] == "penalty").any():
        picture = [_picture("penalty")] if drawn else []
        blocks += [Heading(2, "Penalty"), Text(_PENALTY), *picture, tables.penalty_table(rows)]
    if len(tables.differing_pairs(rows)):
        blocks += [Heading(2, "Pairs per turn"), Text(_PAIRS), tables.pairs_table(rows)]
    return to_markdown(blocks)


def _picture(kind: str) -> Picture:
    return Picture(f"workprecision-{kind}.png", CAPTIONS[kind])


def _method(rows: pd.DataFrame) -> list[Block]:
    halved = rows[rows["role"] == "half mesh"].iloc[0]
    rounds = rows.loc[rows["role"] == "run", "rounds"].iloc[0]
    return [
        Text(
            f"Reference: curved wire elements, {2 * halved.elements_per_turn} per turn, {halved.steps} "
            "steps. Its own error is the change to half its mesh plus that to half its steps: the floor of "
            "the figures. Curve error: largest difference at the same load over the reference's peak, worst "
            "component, at the points that a run has. Shape error: largest distance of the centres of the "
            "contact circles at full load. Only equilibria count: a run that does not reach full load is on "
            "neither front. The equivalent beam's error is that of its model, the wire model's that of "
            "its mesh."
        ),
        Text(
            f"Time: CPU time of the solve alone, one thread, kernels warm; medians of {rounds:.0f} "
            "interleaved rounds with quartiles. Ratios to the paper's FE mesh are formed within each round; "
            "times are these ratios times the median time of the paper's mesh. "
            f"Front of the load curve: runs of at least {STEPS} steps, which give all of the curve; of the "
            "shape: any number of steps. A slower run is on a front where its error is at least a tenth "
            "smaller; times within a tenth of each other are taken as one."
        ),
    ]


def _peer(rows: pd.DataFrame, made: Mapping[str, str]) -> list[Block]:
    peers = rows[rows["role"] == "opensees"]
    if peers.empty:
        return [Text(_NO_PEER)]
    words = (
        f"The wire model of straight elements in another code, openseespy {made['openseespy']}: same nodes, "
        "section, supports, sphere pairs and penalty, so that its error is that of the mesh, too. Its time "
        "is that of the analysis without the building of the model; timed rounds beside the paper's mesh: "
        f"{peers['rounds'].iloc[0]:.0f}. It has no shape here and is on no front."
    )
    return [Text(words), tables.peer_table(rows)]


def digest(rows: pd.DataFrame) -> list[str]:
    """A line on each scene for a reader at the terminal."""
    lines = []
    for scene, part in results.by_scene(rows):
        best = results.fastest(part, results.of_paper(part)[0].curve_max)
        front = part[part["on_curve_front"] == 1].sort_values("seconds").itertuples()
        labels = [results.setting_of(row).label.removesuffix(f", {STEPS} steps") for row in front]
        lines.append(
            f"{scene}: as accurate as the paper's mesh in 1/{1.0 / best.ratio_to_paper_mesh:.3g} of its time "
            f"by {results.setting_of(best).label}; front of the load curve: {', '.join(labels)}"
        )
    return lines
