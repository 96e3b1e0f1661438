"""Recorded evidence as facts: those of the reproduction, cells and sentences of the studies' pages."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from validation.reproduce import facts
from validation.study.document import Block, Bullets, Heading, Table, Text, from_markdown

ROOT = Path(__file__).parents[2]  # of a checkout
REPRODUCTION = ROOT / "reports" / "paper" / facts.FILE
NUMBER = r"[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?"


class Records(Mapping[str, Any]):
    """Facts by key.

    ``spring-a.curve``: a fact of the reproduction.
    ``tangents > Fifty steps > spring-a | paper > iterations``: page, heading, neighbouring cells of one row,
    column; the row ``*`` gives the cells of all rows.
    ``contact > Friction > {} % with no sliding``: page, heading, and the number in a sentence.

    A cell is a number where it begins with one, else its text.

    Raises
    ------
    KeyError : there is not exactly one.
    """

    def __getitem__(self, key: str) -> Any:
        match key.split(" > "):
            case [name]:
                return _reproduction()[name]
            case [page, heading, sentence]:
                return _in_sentence(_section(page, heading), sentence, key)
            case [page, heading, row, column]:
                return _in_table(_section(page, heading), row, column, key)
        raise KeyError(key)

    def __iter__(self) -> Iterator[str]:
        return iter(_reproduction())

    def __len__(self) -> int:
        return len(_reproduction())


@cache
def _reproduction() -> dict[str, Any]:
    found = json.loads(REPRODUCTION.read_text(encoding="utf-8"))
    return {name: tuple(value) if isinstance(value, list) else value for name, value in found.items()}


@cache
def _page(name: str) -> list[Block]:
    places = [ROOT / "docs" / f"{name}.md", *(ROOT / "reports").glob(f"*/{name}.md")]
    return from_markdown(next(file for file in places if file.is_file()).read_text(encoding="utf-8"))


@cache
def _section(page: str, heading: str) -> list[Block]:
    """What stands between a heading and the next one."""
    blocks = _page(page)
    heads = [i for i, block in enumerate(blocks) if isinstance(block, Heading)]
    begin = next((i for i in heads if getattr(blocks[i], "text", "") == heading), None)
    if begin is None:
        raise KeyError(f"no heading {heading!r} in {page}")
    return blocks[begin + 1 : next((i for i in heads if i > begin), len(blocks))]


def _in_table(section: list[Block], row: str, column: str, key: str) -> Any:
    tables = [block for block in section if isinstance(block, Table) and column in block.header]
    if row == "*":
        return tuple(_value(cells[table.header.index(column)]) for table in tables for cells in table.rows)
    wanted = tuple(row.split(" | "))
    found = [
        cells[table.header.index(column)] for table in tables for cells in table.rows if _has(cells, wanted)
    ]
    return _value(_only(found, key))


def _has(cells: tuple[str, ...], wanted: tuple[str, ...]) -> bool:
    """Whether the cells hold the wanted ones, side by side."""
    count = len(wanted)
    return any(cells[i : i + count] == wanted for i in range(len(cells) - count + 1))


def _in_sentence(section: list[Block], sentence: str, key: str) -> float:
    texts = [block.text for block in section if isinstance(block, Text)]
    texts += [item for block in section if isinstance(block, Bullets) for item in block.items]
    begin, end = (r"\s+".join(map(re.escape, part.split(" "))) for part in sentence.split("{}"))
    found = [match for text in texts for match in re.findall(f"{begin}({NUMBER}){end}", text)]
    return float(_only(found, key))


def _only(found: list[str], key: str) -> str:
    if len(found) != 1:
        raise KeyError(f"{len(found)} places for {key}")
    return found[0]


def _value(cell: str) -> Any:
    number = re.match(NUMBER, cell)
    return float(number[0]) if number else cell
