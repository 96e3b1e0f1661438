"""Findings, each computed from recorded evidence: ``python -m validation.reproduce.findings``.

Their words are in ``findings.md``; here is what these read of the records.
"""

import csv
import json
import textwrap
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from validation.peers.timing import SCENES
from validation.reproduce.claims import CASE_NAMES, FUNCTIONS
from validation.study.files import FACTS, write_text
from validation.study.models import MODELS
from validation.study.template import Facts, page, template

ROOT = Path(__file__).parents[2]  # of a checkout
REPORTS = ROOT / "reports"
REPRODUCTION = REPORTS / "paper" / FACTS
PAGE = Path("docs/findings.md")
WIDTH = 110


class Records(dict[str, Any]):
    """Recorded numbers as facts by key: those of the reproduction, and of other studies when asked for.

    ``spring-a.curve``: a fact of the reproduction.
    ``tangents: spring-a.exact``: a fact of another study, by its folder.
    ``errorbudget/fourcases > table=law | row=helix law | case=Spring B > value``: a cell of a study's
    numbers, by the file, what the row has, and the column. A cell is a number where it can be read as one.

    Raises
    ------
    KeyError : there is not exactly one.
    """

    def __init__(self) -> None:
        super().__init__(_facts(REPRODUCTION))

    def __missing__(self, key: str) -> Any:
        match key.split(" > "):
            case [name] if ": " in name:
                study, _, name = name.partition(": ")
                return _facts(REPORTS / study / FACTS)[name]
            case [file, row, column]:
                return _cell(REPORTS / f"{file}.csv", row, column)
        raise KeyError(key)


@cache
def _facts(file: Path) -> dict[str, Any]:
    if not file.is_file():
        raise KeyError(f"no facts in {file}")
    found = json.loads(file.read_text(encoding="utf-8"))
    return {name: tuple(value) if isinstance(value, list) else value for name, value in found.items()}


@cache
def _rows(file: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(file.read_text(encoding="utf-8").splitlines()))


def _cell(file: Path, row: str, column: str) -> Any:
    wanted = dict(part.split("=", 1) for part in row.split(" | "))
    found = [cells[column] for cells in _rows(file) if wanted.items() <= cells.items()]
    if len(found) != 1:
        raise KeyError(f"{len(found)} rows with {row} in {file}")
    try:
        return float(found[0])
    except ValueError:
        return found[0]


def varied(f: Facts, column: str, spring: str, model: str, name: str, value: str) -> Any:
    """A column of the sensitivity study: one value of one input in one model."""
    row = f"case={spring} | model={model} | input={name} | value={value}"
    return f[f"sensitivity/sensitivity > {row} > {column}"]


def largest(
    f: Facts, spring: str, name: str, values: Sequence[str], column: str, models: Sequence[str] = MODELS
) -> float:
    """Largest change by some values of an input, in either model, %."""
    return max(abs(varied(f, column, spring, model, name, value)) for model in models for value in values)


def cell(f: Facts, table: str, row: str, case: str) -> float:
    """A number of the error budget of the four cases, %."""
    return f[f"errorbudget/fourcases > table={table} | row={row} | case={case} > value"]


def random_errors(f: Facts, group: str) -> list[float]:
    """Median and 95th percentile of a law's error on random springs, %."""
    return [f[f"errorbudget: {group}.{name}"] for name in ("median", "percentile")]


def peers(f: Facts, name: str) -> list[float]:
    """A number of the comparison with OpenSees, of each case that it solves."""
    return [f[f"referee: opensees.{scene}.{name}"] for scene in SCENES]


def measured(f: Facts, element: str, elements: int, column: str) -> float:
    """A number of the work-precision study: Spring B on a wire mesh, 50 steps."""
    mesh = f"series={element} | elements_per_turn={elements} | pairs_per_turn=4 | steps=50"
    return f[f"workprecision/workprecision > scene=spring-b | {mesh} | role=run > {column}"]


def solids(f: Facts, model: str, wire: str) -> list[float]:
    """Difference of a model from the wire as a solid body, Spring A and B without contact, %."""
    return [f[f"solid: standing.spring-{spring}-no-contact.{model}.{wire}"] for spring in "ab"]


def nearer(mine: Sequence[float], others: Sequence[float]) -> str:
    """On which of Springs A and B the first of two models is nearer."""
    found = [f"Spring {name}" for name, one, other in zip("AB", mine, others, strict=True) if one < other]
    return "neither spring" if not found else "both springs" if len(found) == 2 else f"{found[0]} alone"


def reach(outcome: str) -> str:
    """How far a path goes, in words."""
    return "reaches full load" if outcome == "completed" else f"ends ({outcome})"


def paper_ratios(f: Facts) -> list[float]:
    """The paper's times of FE over those of its model."""
    return [f[f"paper.{name}.wire"] / f[f"paper.{name}.beam"] for name in CASE_NAMES]


def quarter_turn(f: Facts) -> float:
    """Largest difference of the models where the helix starts a quarter turn out of the plane."""
    pairs = zip(f["phases.bare.degrees"], f["phases.bare.difference"], strict=True)
    return max(difference for angle, difference in pairs if angle % 180 == 90)


RECORDED = (cell, largest, measured, paper_ratios, peers, quarter_turn, random_errors, solids, varied)
FINDINGS = template(Path(__file__).with_name("findings.md"), (*FUNCTIONS, *RECORDED, nearer, reach))


def findings(facts: Facts) -> str:
    """The page as Markdown, its paragraphs broken into lines."""
    fill = textwrap.TextWrapper(WIDTH, break_long_words=False, break_on_hyphens=False)
    text = ""
    for line in page(FINDINGS, f=facts).splitlines():
        fill.subsequent_indent = "   " if line[:1].isdigit() else ""
        text += fill.fill(line) + "\n"
    return text


if __name__ == "__main__":
    write_text(PAGE, findings(Records()))
