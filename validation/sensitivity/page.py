"""The sensitivity study as a page."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from validation.sensitivity.inputs import BEAM, INPUTS, KINDS, MODELS, NOT_GIVEN, READING, WIRE, OpenInput
from validation.sensitivity.results import Change, Study
from validation.study.document import Block, Bullets, Heading, Picture, Table, Text, to_markdown
from validation.study.metrics import COMPONENTS
from validation.study.output import write_text
from validation.study.partialsolve import ending

SILENT, OPEN = (NOT_GIVEN,), (NOT_GIVEN, READING)
NAMES = {BEAM: "beam", WIRE: "wire model"}
INTRO = (
    "Written by `coilcheck sensitivity`; every number is computed there. One input at a time takes another "
    "value, in both models where both have it; the rest stays as in every other run of the project. Wire "
    "model: the paper's mesh. A change is positive where the top moves farther. *Curve*: the largest change "
    "of UX, UY or ROTZ at any load, in per cent of the component's peak with our default."
)
CLOSING = (
    "So the paper's curves cannot be used to judge ours more finely than this: not for want of accuracy, but "
    "of inputs. The difference of the two models can be judged much more finely, because most inputs move "
    "both alike (last column of the tables below)."
)
CAPTION = (
    "Largest change of the load curve by each open input. Values of the inputs that reach farthest stand at "
    "the bars' ends; inputs that move nothing by 0.005 % are left out. Star: the paper's own result speaks "
    "against it. Grey: largest difference of the two models with our defaults, to either side. Cross: a "
    "value of the input ends at a limit point, or otherwise short of full load, and has no bar."
)
HOW_FAR = (
    "Two estimates, neither of which is a bound. *Largest single*: the largest change by one input. "
    "*Together*: the root of the sum of squares of all inputs' largest changes, which holds where they are "
    "independent and small, and where the authors' values are as likely to be at the ends of our ranges as "
    "within. *Not given*: the paper says nothing on the input; *with readings*: also inputs that the paper "
    "tells in words that leave room. Inputs that the paper's own result speaks against are in the tables "
    "below alone. Values that end short of full load have no number and are in no estimate. *The models "
    "apart*: largest difference of the two load curves with our defaults."
)
NOT_VARIED = (
    "The wire's shear factor (0.9; books have 6/7 to 0.9), which is no input of a scene.",
    "The finite stiffness of the paper's 'pseudo-rigid' ends: both models' ends are rigid. The rigid turns "
    "stand for it.",
    "How the stiffness of a conical half coil is averaged: the paper says 'average properties', which "
    "could be the mean of the diameters (ours) or of the stiffnesses.",
    "Steps, stop test and tangent: without friction an equilibrium does not depend on them.",
    "The friction of the beam's circles, the number of its pairs and its law, which the paper gives.",
)


def write(studies: Sequence[Study], out: Path) -> None:
    """Write ``sensitivity.md``."""
    write_text(out / "sensitivity.md", to_markdown(page(studies)))


def page(studies: Sequence[Study]) -> list[Block]:
    """The study for a reader."""
    return [
        Heading(1, "What the paper leaves open"),
        Text(INTRO),
        Picture("sensitivity.png", CAPTION),
        Heading(2, "How far our curves could be from the authors'"),
        Text(HOW_FAR),
        _estimates(studies),
        Bullets(tuple(_findings(studies))),
        Text(CLOSING),
        Heading(2, "What is open, in which range, and why"),
        _inputs(),
        Text("; ".join(f"*{kind}*: {words}" for kind, words in KINDS.items()) + "."),
        *(block for study in studies for block in _case(study)),
        Heading(2, "What was not varied"),
        Bullets(NOT_VARIED),
    ]


def _estimates(studies: Sequence[Study]) -> Table:
    header = (
        *("case", "model", "largest single, not given (%)", "largest single, with readings (%)"),
        *("together, not given (%)", "together, with readings (%)", "the models apart (%)"),
    )
    rows = []
    for study in studies:
        for model in MODELS:
            singles = (_single(study.worst(model, kinds)) for kinds in (SILENT, OPEN))
            sums = (_together(study, model, kinds) for kinds in (SILENT, OPEN))
            rows.append((study.case.title, NAMES[model], *singles, *sums, f"{study.apart:.2f}"))
    return Table(header, tuple(rows))


def _single(change: Change) -> str:
    return f"{abs(change.largest):.1f} ({_what(change)})"


def _what(change: Change) -> str:
    return f"{change.input.title}: {change.value}"


def _together(study: Study, model: str, kinds: Sequence[str]) -> str:
    """Sum of squares; more where a value that ends short of full load is in it without a number."""
    total = f"{study.together(model, kinds):.1f}"
    short = [c for c in study.changes if c.model == model and c.input.kind in kinds and not c.completed]
    return f"{total} or more" if short else total


def _findings(studies: Sequence[Study]) -> Iterator[str]:
    """What the tables say, case by case."""
    for study in studies:
        title, total = study.case.title, _total(study)
        kept = {
            apart: change
            for change in study.changes
            if change.input.kind in OPEN and (apart := study.apart_with(change)) is not None
        }
        most = max(kept)
        yield (
            f"{title}: what is not given moves the curves by {total:.0f} % together, "
            f"{total / study.apart:.0f} times the {study.apart:.2f} % by which the two models differ. That "
            f"difference is at most {most:.2f} % with any value of an input that is not given or can be read "
            f"otherwise ({_what(kept[most])})."
        )
        for change in study.changes:
            if not change.completed:
                where = f"{title}, {NAMES[change.model]}, {_what(change)}"
                yield f"{where}: **{_ending(change)}**, hence no number."


def _total(study: Study) -> float:
    """What all inputs that are not given move together, in the model that they move more, %."""
    return max(study.together(model, SILENT) for model in MODELS)


def digest(study: Study) -> str:
    """A case for a reader at the terminal."""
    return (
        f"{study.case.name}: what the paper does not give moves the curves by {_total(study):.1f} % "
        f"together; the models are {study.apart:.2f} % apart"
    )


def _ending(change: Change) -> str:
    return ending(change.curve.outcome, change.curve.critical_time)


def _inputs() -> Table:
    header = ("input", "the paper", "kind", "our default", "range and why")
    return Table(
        header, tuple((item.title, item.paper, item.kind, item.default, item.reason) for item in INPUTS)
    )


def _case(study: Study) -> list[Block]:
    """Heading and table of one case, largest inputs first."""
    header = (
        *("input", "model", "value", "UX (%)", "UY (%)", "ROTZ (%)", "curve (%)", "at", "models apart (%)"),
    )
    rows = [row for item in study.ranked() for model in MODELS for row in _rows(study, item, model)]
    absent = [
        f"{item.title} ({' and '.join(NAMES[model] for model in lacking)})"
        for item in INPUTS
        if (lacking := [model for model in MODELS if not study.of(item, model)])
    ]
    return [
        Heading(2, study.case.title),
        Text(
            f"At full load with our defaults: {_tips(study, BEAM)}; {_tips(study, WIRE)}. Of more than two "
            "values the table has those that reach farthest to either side; the CSV file has all."
        ),
        Table(header, tuple(rows)),
        Text(f"No input here: {', '.join(absent)}."),
    ]


def _rows(study: Study, item: OpenInput, model: str) -> Iterator[tuple[str, ...]]:
    found = study.of(item, model)
    done = [change for change in found if change.completed]
    ends = [min(done, key=lambda c: c.largest), max(done, key=lambda c: c.largest)] if done else []
    for change in found:
        if not change.completed:
            yield (
                item.title,
                NAMES[model],
                change.value,
                _ending(change),
                *[""] * 5,
            )
        elif change in ends:
            step, component = change.place
            where = (
                ""
                if change.largest == 0.0
                else f"{COMPONENTS[component].upper()}, t = {change.curve.times[step]:g}"
            )
            apart = study.apart_with(change)
            yield (
                item.title, NAMES[model], change.value, *map(_signed, change.at_full.tolist()),
                _signed(change.largest), where, "" if apart is None else f"{apart:.2f}",
            )  # fmt: skip


def _signed(percent: float) -> str:
    if np.isnan(percent):
        return "held"
    return f"{percent:+.2f}" if percent else "0"


def _tips(study: Study, model: str) -> str:
    ux, uy, rotz = study.bases[model].tips[-1].tolist()
    return f"{NAMES[model]} UX {ux:.3f} mm, UY {uy:.3f} mm, ROTZ {rotz:.4f} rad"
