"""Values in texts that a user gives."""

from contextlib import suppress


def number_of(text: str) -> int | float | str:
    """The number that `text` says; else the text, for the library to refuse with the range."""
    for kind in (int, float):
        with suppress(ValueError):
            return kind(text)
    return text
