"""The sensitivity study as data: a CSV file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from validation.sensitivity.inputs import INPUTS, MODELS
from validation.sensitivity.results import Change, Study
from validation.study.document import Table, to_csv
from validation.study.metrics import COMPONENTS
from validation.study.output import write_text

NO_INPUT = "not an input"
HEADER = (
    *("case", "model", "input", "kind", "default", "value", "outcome", "critical_time"),
    *("base_ux_mm", "base_uy_mm", "base_rotz_rad", "ux_mm", "uy_mm", "rotz_rad"),
    *("ux_change_percent", "uy_change_percent", "rotz_change_percent"),
    *("curve_change_percent", "curve_component", "curve_time", "models_apart_percent"),
)


def write(studies: Sequence[Study], out: Path) -> None:
    """Write ``sensitivity.csv``."""
    write_text(out / "sensitivity.csv", data(studies))


def data(studies: Sequence[Study]) -> str:
    """A row for every case, input, model and value, also where a model has no such input."""
    rows: list[tuple[str, ...]] = []
    for study in studies:
        for item in INPUTS:
            for model in MODELS:
                head = (study.case.name, model, item.name, item.kind, item.default)
                found = study.of(item, model)
                rows += ((*head, *_row(study, change)) for change in found)
                if not found:
                    rows.append((*head, "", NO_INPUT, *[""] * (len(HEADER) - 7)))
    return to_csv(Table(HEADER, tuple(rows)))


def _row(study: Study, change: Change) -> tuple[str, ...]:
    curve = change.curve
    critical = "" if curve.critical_time is None else f"{curve.critical_time:.6f}"
    base = _numbers(change.base.tips[-1], ".9g")
    head = (change.value, curve.outcome, critical, *base)
    if not change.completed:
        return (*head, *[""] * (len(HEADER) - 5 - len(head)))
    step, component = change.place
    apart = study.apart_with(change)
    return (
        *head, *_numbers(curve.tips[-1], ".9g"), *_numbers(change.at_full, ".6g"),
        f"{change.largest:.6g}", COMPONENTS[component], f"{curve.times[step]:g}",
        "" if apart is None else f"{apart:.6g}",
    )  # fmt: skip


def _numbers(values: np.ndarray, form: str) -> tuple[str, ...]:
    return tuple("" if np.isnan(value) else format(value, form) for value in values.tolist())
