"""Values in texts that a user gives."""

from __future__ import annotations


def number_of(text: str) -> int | float | str:
    """The number that `text` says; else the text, for the library to refuse with the range."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
