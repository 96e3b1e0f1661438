"""Findings, each computed from recorded evidence: ``python -m validation.reproduce.findings``.

Their words are in ``findings.md``; here is what these read of the records.
"""

import json
import textwrap
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pandas as pd

from validation.peers.timing import SCENES
from validation.reproduce.claims import CASE_NAMES, FUNCTIONS
from validation.study.files import FACTS, ROOT, write_text
from validation.study.frames import read_csv
from validation.study.models import MODELS
from validation.study.template import Facts, page, template

REPORTS = ROOT / "reports"
REPRODUCTION = REPORTS / "paper" / FACTS
PAGE = Path("docs/findings.md")
WIDTH = 110
MESH = ("scene", "role", "series", "elements_per_turn", "pairs_per_turn", "steps")
ROWS = {  # columns that name a row of a study's numbers
    "sensitivity/sensitivity": ("case", "model", "input", "value"),
    "errorbudget/fourcases": ("table", "row", "case"),
    "workprecision/workprecision": MESH,
}


class Records(dict[Any, Any]):
    """Recorded numbers as facts by key: those of the reproduction, and of other studies when asked for.

    ``spring-a.curve``: a fact of the reproduction.
    ``tangents: spring-a.exact``: a fact of another study, by its folder.
    ``("errorbudget/fourcases", "value", "law", "helix law", "Spring B")``: a cell of a study's
    numbers, by the file, the column, and what the row has in the columns of `ROWS`.

    Raises
    ------
    KeyError : there is not exactly one.
    """

    def __init__(self) -> None:
        super().__init__(_facts(REPRODUCTION))

    def __missing__(self, key: str | tuple[Any, ...]) -> Any:
        if isinstance(key, tuple):
            file, column, *row = key
            found = _rows(file).loc[[tuple(row)], column]
            if len(found) != 1:
                raise KeyError(f"{len(found)} rows with {row} in {file}")
            return found.item()
        study, _, name = key.partition(": ")
        return _facts(REPORTS / study / FACTS)[name]


@cache
def _facts(file: Path) -> dict[str, Any]:
    if not file.is_file():
        raise KeyError(f"no facts in {file}")
    found = json.loads(file.read_text(encoding="utf-8"))
    return {name: tuple(value) if isinstance(value, list) else value for name, value in found.items()}


@cache
def _rows(file: str) -> pd.DataFrame:
    return read_csv(REPORTS / f"{file}.csv").set_index(list(ROWS[file]), drop=False)


def varied(f: Facts, column: str, spring: str, model: str, name: str, value: str) -> Any:
    """A column of the sensitivity study: one value of one input in one model."""
    return f["sensitivity/sensitivity", column, spring, model, name, value]


def largest(
    f: Facts, spring: str, name: str, values: Sequence[str], column: str, models: Sequence[str] = MODELS
) -> float:
    """Largest change by some values of an input, in either model, %."""
    return max(abs(varied(f, column, spring, model, name, value)) for model in models for value in values)


def cell(f: Facts, table: str, row: str, case: str) -> float:
    """A number of the error budget of the four cases, %."""
    return f["errorbudget/fourcases", "value", table, row, case]


def random_errors(f: Facts, group: str) -> list[float]:
    """Median and 95th percentile of a law's error on random springs, %."""
    return [f[f"errorbudget: {group}.{name}"] for name in ("median", "percentile")]


def peers(f: Facts, name: str) -> list[float]:
    """A number of the comparison with OpenSees, of each case that it solves."""
    return [f[f"referee: opensees.{scene}.{name}"] for scene in SCENES]


def measured(f: Facts, element: str, elements: int, column: str) -> float:
    """A number of the work-precision study: Spring B on a wire mesh, 50 steps."""
    return f["workprecision/workprecision", column, "spring-b", "run", element, elements, 4, 50]


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
