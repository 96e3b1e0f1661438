"""The sensitivity study as a page."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import pandas as pd

from validation.sensitivity.changes import (
    BASE_TIPS,
    CHANGES,
    COMPLETED,
    CURVE,
    DEFAULT_DEVIATION,
    DEVIATION,
    sizes,
    together,
    values,
    worst,
)
from validation.sensitivity.inputs import BEAM, INPUTS, KINDS, MODELS, NOT_GIVEN, READING, WIRE
from validation.study.cases import case
from validation.study.document import Block, Bullets, Heading, Picture, Table, Text, to_markdown
from validation.study.output import write_text
from validation.study.partialsolve import ending

TITLES = {item.name: item.title for item in INPUTS}
SILENT, OPEN = (NOT_GIVEN,), (NOT_GIVEN, READING)
NAMES = {BEAM: "beam", WIRE: "wire model"}
INTRO = (
    "Written by `coilcheck sensitivity`; every number is computed there. One input at a time takes another "
    "value, in both models where both have it; the rest stays as in every other run of the project. Wire "
    "model: the paper's mesh. A change is positive where the top moves farther. *Curve*: the largest change "
    "of UX, UY or ROTZ at any load, in per cent of the component's peak with our default."
)
CLOSING = (
    "So the paper's curves cannot verify ours to less than this, since inputs are missing. The difference of "
    "the two models can be verified much more finely, because most inputs change both alike (last column of "
    "the tables below)."
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
    "within. *Not given*: the paper says nothing on the input; *with readings*: also inputs whose "
    "description leaves room. Inputs that the paper's own result speaks against, and the wire as a solid "
    "body, are in the tables below alone. Values that end short of full load have no number and are in no "
    "estimate. "
    "*Deviation of the models*: largest difference of the two load curves with our defaults."
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
ESTIMATES = (
    *("case", "model", "largest single, not given (%)", "largest single, with readings (%)"),
    *("together, not given (%)", "together, with readings (%)", "deviation of the models (%)"),
)


def write(studies: Sequence[pd.DataFrame], out: Path) -> None:
    """Write ``sensitivity.md``."""
    write_text(out / "sensitivity.md", to_markdown(page(studies)))


def page(studies: Sequence[pd.DataFrame]) -> list[Block]:
    """The study for a reader."""
    inputs = tuple((item.title, item.paper, item.kind, item.default, item.reason) for item in INPUTS)
    return [
        Heading(1, "What the paper leaves open"),
        Text(INTRO),
        Picture("sensitivity.png", CAPTION),
        Heading(2, "Possible distance of our curves from the authors'"),
        Text(HOW_FAR),
        Table(ESTIMATES, tuple(_estimate(data, model) for data in studies for model in MODELS)),
        Bullets(tuple(sentence for data in studies for sentence in _findings(data))),
        Text(CLOSING),
        Heading(2, "What is open, in which range, and why"),
        Table(("input", "the paper", "kind", "our default", "range and why"), inputs),
        Text("; ".join(f"*{kind}*: {words}" for kind, words in KINDS.items()) + "."),
        *(block for data in studies for block in _case(data)),
        Heading(2, "What was not varied"),
        Bullets(NOT_VARIED),
    ]


def _title(data: pd.DataFrame) -> str:
    return case(data["case"].iloc[0]).title


def _change(row: pd.Series) -> str:
    return f"{TITLES[row['input']]}: {row['value']}"


def _ending(row: pd.Series) -> str:
    return ending(row["outcome"], None if pd.isna(row["critical_time"]) else row["critical_time"])


def _estimate(data: pd.DataFrame, model: str) -> tuple[str, ...]:
    singles = (worst(data, model, kinds) for kinds in (SILENT, OPEN))
    return (
        *(_title(data), NAMES[model]),
        *(f"{abs(row[CURVE]):.1f} ({_change(row)})" for row in singles),
        *(_together(data, model, kinds) for kinds in (SILENT, OPEN)),
        f"{data[DEFAULT_DEVIATION].iloc[0]:.2f}",
    )


def _together(data: pd.DataFrame, model: str, kinds: Sequence[str]) -> str:
    """Sum of squares; more where a value that ends short of full load is in it without a number."""
    total = f"{together(data, model, kinds):.1f}"
    mine = values(data).query("model == @model and kind in @kinds")
    return total if (mine["outcome"] == COMPLETED).all() else f"{total} or more"


def _findings(data: pd.DataFrame) -> Iterator[str]:
    """What the tables say of a case."""
    title, total, default = _title(data), _total(data), data[DEFAULT_DEVIATION].iloc[0]
    most = data.loc[data.loc[data["kind"].isin(OPEN), DEVIATION].idxmax()]
    yield (
        f"{title}: what is not given moves the curves by {total:.0f} % together, "
        f"{total / default:.0f} times the {default:.2f} % by which the two models differ. That "
        f"difference is at most {most[DEVIATION]:.2f} % with any value of an input that is not given or can "
        f"be read otherwise ({_change(most)})."
    )
    for _, row in values(data).iterrows():
        if row["outcome"] != COMPLETED:
            yield f"{title}, {NAMES[row['model']]}, {_change(row)}: **{_ending(row)}**, hence no number."


def _total(data: pd.DataFrame) -> float:
    """What all inputs that are not given move together, in the model that they move more, %."""
    return max(together(data, model, SILENT) for model in MODELS)


def digest(data: pd.DataFrame) -> str:
    """A case for a reader at the terminal."""
    return (
        f"{data['case'].iloc[0]}: what the paper does not give moves the curves by {_total(data):.1f} % "
        f"together; the models deviate by {data[DEFAULT_DEVIATION].iloc[0]:.2f} %"
    )


def _case(data: pd.DataFrame) -> list[Block]:
    """Heading and table of one case, largest inputs first."""
    header = (
        "input",
        "model",
        "value",
        "UX (%)",
        "UY (%)",
        "ROTZ (%)",
        "curve (%)",
        "at",
        "deviation of the models (%)",
    )
    present = values(data).groupby(["input", "model"], sort=False)
    rows = [
        row
        for name in sizes(data).index
        for model in MODELS
        if (name, model) in present.groups
        for row in _rows(present.get_group((name, model)))
    ]
    absent = [
        f"{item.title} ({' and '.join(NAMES[model] for model in lacking)})"
        for item in INPUTS
        if (lacking := [model for model in MODELS if (item.name, model) not in present.groups])
    ]
    tips = data.groupby("model")[list(BASE_TIPS)].first()
    where = (
        f"{NAMES[model]} UX {ux:.3f} mm, UY {uy:.3f} mm, ROTZ {rotz:.4f} rad"
        for model, (ux, uy, rotz) in ((model, tips.loc[model]) for model in MODELS)
    )
    return [
        Heading(2, _title(data)),
        Text(
            f"At full load with our defaults: {'; '.join(where)}. Of more than two "
            "values the table has those that reach farthest to either side; the CSV file has all."
        ),
        Table(header, tuple(rows)),
        Text(f"No input here: {', '.join(absent)}."),
    ]


def _rows(changes: pd.DataFrame) -> Iterator[tuple[str, ...]]:
    """Of one input and model, the values that reach farthest to either side and those that end early."""
    known = changes[CURVE].dropna()
    ends = {known.idxmin(), known.idxmax()} if len(known) else set()
    for index, row in changes.iterrows():
        head = (TITLES[row["input"]], NAMES[row["model"]], row["value"])
        if row["outcome"] != COMPLETED:
            yield (*head, _ending(row), *[""] * 5)
        elif index in ends:
            place = f"{row['curve_component'].upper()}, t = {row['curve_time']:g}" if row[CURVE] else ""
            deviation = "" if pd.isna(row[DEVIATION]) else f"{row[DEVIATION]:.2f}"
            yield (*head, *(_signed(row[name]) for name in (*CHANGES, CURVE)), place, deviation)


def _signed(percent: float) -> str:
    if pd.isna(percent):
        return "held"
    return f"{percent:+.2f}" if percent else "0"
