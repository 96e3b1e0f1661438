"""Recorded numbers as facts: those of the reproduction, and those that the other studies keep beside them."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from validation.study.output import FACTS

ROOT = Path(__file__).parents[2]  # of a checkout
REPORTS = ROOT / "reports"
REPRODUCTION = REPORTS / "paper" / FACTS


class Records(Mapping[str, Any]):
    """Facts by key.

    ``spring-a.curve``: a fact of the reproduction.
    ``tangents: spring-a.exact``: a fact of another study, by its folder.
    ``errorbudget/fourcases > table=law | row=helix law | case=Spring B > value``: a cell of a study's
    numbers, by the file, what the row has, and the column. A cell is a number where it can be read as one.

    Raises
    ------
    KeyError : there is not exactly one.
    """

    def __getitem__(self, key: str) -> Any:
        match key.split(" > "):
            case [name] if ": " in name:
                study, _, name = name.partition(": ")
                return _facts(REPORTS / study / FACTS)[name]
            case [name]:
                return _facts(REPRODUCTION)[name]
            case [file, row, column]:
                return _cell(REPORTS / f"{file}.csv", row, column)
        raise KeyError(key)

    def __iter__(self) -> Iterator[str]:
        return iter(_facts(REPRODUCTION))

    def __len__(self) -> int:
        return len(_facts(REPRODUCTION))


@cache
def _facts(file: Path) -> dict[str, Any]:
    if not file.is_file():
        raise KeyError(f"no facts in {file}")
    found = json.loads(file.read_text(encoding="utf-8"))
    return {name: tuple(value) if isinstance(value, list) else value for name, value in found.items()}


@cache
def _rows(file: Path) -> list[dict[str, str]]:
    with file.open(encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(lines))


def _cell(file: Path, row: str, column: str) -> Any:
    wanted = dict(part.split("=", 1) for part in row.split(" | "))
    found = [cells[column] for cells in _rows(file) if wanted.items() <= cells.items()]
    if len(found) != 1:
        raise KeyError(f"{len(found)} rows with {row} in {file}")
    try:
        return float(found[0])
    except ValueError:
        return found[0]
