"""Sentences that hold a number or a verdict: each has an id, and is a function of the evidence behind it.

Evidence is a mapping of named facts. A page is a list of parts: blocks without numbers or verdicts, and
statements, which `rendered` turns into words. So a sentence changes when its evidence does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from validation.study.document import Block, Bullets, Text

Facts = Mapping[str, Any]  # numbers, words, tuples of numbers; None where there is none


@dataclass(frozen=True)
class Statement:
    """A paragraph or an item of a list.

    Attributes
    ----------
    id : its name, of which there is one.
    words : the sentence by the facts; it has no number of its own.
    """

    id: str
    words: Callable[[Facts], str]


def statement(id: str) -> Callable[[Callable[[Facts], str]], Statement]:
    """Make a function of the facts the statement of that id."""
    return lambda words: Statement(id, words)


Part = Block | Statement | tuple[Statement, ...]  # several statements are a list


def rendered(parts: Sequence[Part], facts: Facts) -> tuple[Block, ...]:
    """The blocks of a page."""
    return tuple(_block(part, facts) for part in parts)


def _block(part: Part, facts: Facts) -> Block:
    match part:
        case Statement(_, words):
            return Text(words(facts))
        case tuple():
            return Bullets(tuple(item.words(facts) for item in part))
        case _:
            return part


def within(parts: Iterable[Part]) -> tuple[Statement, ...]:
    """The statements of a page."""
    found: list[Statement] = []
    for part in parts:
        found += part if isinstance(part, tuple) else [part] if isinstance(part, Statement) else []
    return tuple(found)


def percent(share: float, digits: int = 2) -> str:
    """A share in per cent."""
    return f"{100.0 * share:.{digits}f} %"
