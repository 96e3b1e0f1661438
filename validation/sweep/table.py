"""The table of a sweep: rows of texts, appended to a file as they come and found again by their keys."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from coilspring.sweep import CRASHED, REFUSED, Outcome
from validation.study.output import write_text, writing
from validation.study.texts import number_of

FILE = "sweep.csv"
COMPLETED = "completed"
LEAST = 3  # values that make a curve
RESULTS = (
    *("outcome", "time", "load_x", "load_y", "ux", "uy", "rotz", "iterations", "active_contacts"),
    *("max_penetration", "max_contact_force", "critical_time", "message", "key"),
)
Row = dict[str, str]


def is_curve(rows: Sequence[Row], keys: Sequence[str]) -> bool:
    """Whether one number is varied, and enough of its values reach full load."""
    whole = [row[keys[0]] for row in rows if row["outcome"] == COMPLETED]
    return (
        len(keys) == 1
        and len(set(whole)) >= LEAST
        and not any(isinstance(number_of(text), str) for text in whole)
    )


class Table:
    """Rows by key, in a file of a folder."""

    def __init__(self, folder: Path, varied: Sequence[str], wanted: set[str]) -> None:
        self.target = folder / FILE
        self.columns = (*varied, *RESULTS)
        self.rows = {row["key"]: row for row in _read(self.target, self.columns) if row["key"] in wanted}
        # what belongs to another sweep is left out, as is a last line that was cut: it has no whole key
        write_text(self.target, self._text(self.rows.values(), header=True))

    def append(self, key: str, values: Sequence[Any], outcome: Outcome) -> None:
        """Add a row, also at the end of the file."""
        row = self.keep(key, values, outcome)
        with writing(self.target), self.target.open("a", encoding="utf-8", newline="") as stream:
            stream.write(self._text([row]))

    def keep(self, key: str, values: Sequence[Any], outcome: Outcome) -> Row:
        """Add a row, to be written with all others."""
        found = dict(zip(self.columns, values, strict=False)) | _results(outcome)
        found["key"] = "" if outcome.outcome == REFUSED else key  # which is soon found again
        self.rows[key] = {name: _text(found.get(name)) for name in self.columns}
        return self.rows[key]

    def write(self, keys: Sequence[str]) -> list[Row]:
        """Write the file with the rows in the order of the keys, and return them."""
        rows = [self.rows[key] for key in keys]
        write_text(self.target, self._text(rows, header=True))
        return rows

    def _text(self, rows: Iterable[Row], header: bool = False) -> str:
        stream = io.StringIO()
        writer = csv.DictWriter(stream, self.columns, lineterminator="\n")
        if header:
            writer.writeheader()
        writer.writerows(rows)
        return stream.getvalue()


def _text(value: Any) -> str:
    """A value as a scene file has it, to the last digit; nothing where there is none."""
    if isinstance(value, bool):
        return str(value).lower()
    return "" if value is None else str(value)


def _results(found: Outcome) -> dict[str, Any]:
    """Values of the columns `RESULTS` that there are."""
    said = {"outcome": found.outcome, "message": " ".join(found.message.split())}
    if found.outcome in (REFUSED, CRASHED):
        return said
    values = {"time": found.last_time, "iterations": found.total_iterations}
    values |= zip(("load_x", "load_y"), found.load or (), strict=False)
    values |= zip(("ux", "uy", "rotz"), found.tip or (), strict=False)
    return asdict(found) | values | said


def _read(target: Path, columns: Sequence[str]) -> list[Row]:
    """Whole rows of a file that need not be found again; none where its columns are others."""
    if not target.exists():
        return []
    with writing(target):
        text = target.read_text(encoding="utf-8")
    rows = (row for row in csv.DictReader(io.StringIO(text)) if list(row) == list(columns))
    return [row for row in rows if row["outcome"] != CRASHED]
