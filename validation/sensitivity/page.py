"""Page of the sensitivity study; words in ``page.md``, and in ``own.md`` of a user's scenes."""

from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import pandas as pd

from validation.sensitivity import changes
from validation.sensitivity.changes import CURVE, DEVIATION, Study
from validation.sensitivity.inputs import INPUTS, KINDS, NAMES, OPEN, SILENT, VARIED
from validation.study.files import write_text
from validation.study.models import MODELS
from validation.study.partialsolve import ending
from validation.study.tables import Table
from validation.study.template import page, template

WORDS, OWN_WORDS = (template(Path(__file__).with_name(name)) for name in ("page.md", "own.md"))
TITLES = {item.name: item.title for item in INPUTS}
ESTIMATES = (
    *("case", "model", "largest single, not given (%)", "largest single, with readings (%)"),
    *("together, not given (%)", "together, with readings (%)", "deviation of the models (%)"),
)
OWN_HEADER = ("input", "here", "range and why")
INPUT_HEADER = ("input", "the paper", "kind", "our default", "range and why")
CHANGE_HEADER = (
    *("input", "model", "value", "UX (%)", "UY (%)", "ROTZ (%)", "curve (%)", "at"),
    "deviation of the models (%)",
)


def write(studies: Sequence[Study], out: Path, own: bool = False) -> None:
    """Write ``sensitivity.md``: of the paper's cases, or of a user's scenes."""
    if own:
        cases = [_own(study) for study in studies if not study.data.empty]
        text = page(OWN_WORDS, cases=cases, early=changes.ended_early(studies))
    else:
        inputs = ((item.title, item.paper, item.kind, item.default, item.reason) for item in INPUTS)
        text = page(
            WORDS,
            estimates=Table(ESTIMATES, tuple(_estimate(s, model) for s in studies for model in MODELS)),
            inputs=Table(INPUT_HEADER, tuple(inputs)),
            kinds=KINDS,
            cases=[_case(study) for study in studies],
        )
    write_text(out / "sensitivity.md", text)


def digest(study: Study) -> list[str]:
    """A case for a reader at the terminal."""
    left_out = [f"{study.name}, {line}" for line in study.left_out]
    if study.data.empty:
        return left_out
    own = study.inputs != INPUTS
    total = _total(study.data, (VARIED,) if own else SILENT)
    what = "the inputs that are varied move" if own else "what the paper does not give moves"
    deviation = "" if study.deviation is None else f"; the models deviate by {study.deviation:.2f} %"
    return [*left_out, f"{study.name}: {what} the curves by {total:.1f} % together{deviation}"]


def _own(study: Study) -> dict[str, Any]:
    """What the page says of a user's scene."""
    data, estimates = study.data, []
    for model in sorted(set(changes.values(data)["model"])):
        row, together = changes.worst(data, model, (VARIED,)), _together(data, model, (VARIED,))
        most = f"{abs(row[CURVE]):.1f} % at most ({_change(row)})"
        estimates.append(f"{NAMES[model]}: {most}, {together} % together")
    inputs = Table(OWN_HEADER, tuple((item.title, item.default, item.own) for item in study.inputs))
    return _facts(study) | {"inputs": inputs, "estimates": estimates}


def _total(data: pd.DataFrame, kinds: Sequence[str] = SILENT) -> float:
    """What all inputs of some kinds move together, in the model that they move more, %."""
    return max(changes.together(data, model, kinds) for model in MODELS)


def _change(row: pd.Series) -> str:
    return f"{TITLES[row['input']]}: {row['value']}"


def _ending(row: pd.Series) -> str:
    return ending(row["outcome"], None if pd.isna(row["critical_time"]) else row["critical_time"])


def _estimate(study: Study, model: str) -> tuple[str, ...]:
    data = study.data
    singles = (changes.worst(data, model, kinds) for kinds in (SILENT, OPEN))
    return (
        *(study.title, NAMES[model]),
        *(f"{abs(row[CURVE]):.1f} ({_change(row)})" for row in singles),
        *(_together(data, model, kinds) for kinds in (SILENT, OPEN)),
        f"{study.deviation:.2f}",
    )


def _together(data: pd.DataFrame, model: str, kinds: Sequence[str]) -> str:
    """Sum of squares; more where a value that ends short of full load is in it without a number."""
    total = f"{changes.together(data, model, kinds):.1f}"
    mine = changes.values(data).query("model == @model and kind in @kinds")
    return total if (mine["outcome"] == changes.COMPLETED).all() else f"at least {total}"


def _case(study: Study) -> dict[str, Any]:
    """What the page says of a case of the paper."""
    data = study.data
    most = data.loc[data.loc[data["kind"].isin(OPEN), DEVIATION].idxmax()]
    return _facts(study) | {"total": _total(data), "most": most[DEVIATION], "most_by": _change(most)}


def _facts(study: Study) -> dict[str, Any]:
    """What the pages say of any scene."""
    data = study.data
    present = changes.values(data)
    ended = present[present["outcome"] != changes.COMPLETED]
    tips = present.groupby("model")[list(changes.BASE_TIPS)].first()
    axial = ("FY", "N") if study.prescribed else ("UY", "mm")
    where = (
        f"{NAMES[model]} UX {ux:.3f} mm, {axial[0]} {uy:.3f} {axial[1]}, ROTZ {rotz:.4f} rad"
        for model, ux, uy, rotz in tips.itertuples()
    )
    rows: list[tuple[str, ...]] = []
    for name, model in product(changes.sizes(data).index, MODELS):
        rows += _rows(present[(present["input"] == name) & (present["model"] == model)])
    absent = data[(data["outcome"] == changes.NO_INPUT) & data["model"].isin(tips.index)]
    lacking = absent["model"].map(NAMES).groupby(absent["input"], sort=False).agg(" and ".join)
    return {
        "study": study,
        "ended": [(f"{NAMES[row['model']]}, {_change(row)}", _ending(row)) for _, row in ended.iterrows()],
        "tips": "; ".join(where),
        "table": Table(CHANGE_HEADER, tuple(rows)),
        "absent": ", ".join(f"{TITLES[name]} ({models})" for name, models in lacking.items()),
    }


def _rows(group: pd.DataFrame) -> Iterator[tuple[str, ...]]:
    """Of one input and model, the values that reach farthest to either side and those that end early."""
    known = group[CURVE].dropna()
    ends = {known.idxmin(), known.idxmax()} if len(known) else set()
    for index, row in group.iterrows():
        head = (TITLES[row["input"]], NAMES[row["model"]], row["value"])
        if row["outcome"] != changes.COMPLETED:
            yield (*head, _ending(row), *[""] * 5)
        elif index in ends:
            moved = [_signed(row[name]) for name in (*changes.CHANGES, CURVE)]
            place = row[CURVE] and f"{row['curve_component'].upper()}, t = {row['curve_time']:g}"
            deviation = "" if pd.isna(row[DEVIATION]) else f"{row[DEVIATION]:.2f}"
            yield (*head, *moved, place or "", deviation)


def _signed(percent: float) -> str:
    if pd.isna(percent):
        return "held"
    return f"{percent:+.2f}" if percent else "0"
