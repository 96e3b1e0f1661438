"""Keys of a scene file, declared as metadata on the fields of the dataclasses that hold their values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, field, fields
from typing import Any

from coilspring.errors import InputError, require_choice, require_integer, require_number, shown

Check = Callable[[str, object], Any]  # of a name for messages and a value; returns the value to keep


@dataclass(frozen=True)
class Key:
    """One key of a scene file."""

    comment: str = ""  # written beside it
    check: Check | None = None  # of the value alone; None where the dataclass checks it with others
    instead: tuple[str, ...] = ()  # keys that can take its place
    absent: str | None = None  # text in its place where it has its default; None where that is written
    required: bool = False  # in a file, unless one of `instead` is there; fields without default always are
    aliases: Mapping[str, str] = field(default_factory=dict)  # patterns meant for it; what makes it of those
    item: type | None = None  # dataclass of the tables that are its value


def key(comment: str, check: Check | None = None, **others: Any) -> dict[str, Key]:
    """Metadata of a field that is a key of scene files; see `Key`."""
    return {"key": Key(comment, check, **others)}


def keyed(default: Any, comment: str, check: Check | None = None, **others: Any) -> Any:
    """A field with a default that is a key of scene files; see `Key`."""
    return field(default=default, metadata=key(comment, check, **others))


def keys_of(record: Any) -> Mapping[str, Key]:
    """Keys of a dataclass by name, in the order of a file."""
    return {item.name: item.metadata["key"] for item in fields(record) if "key" in item.metadata}


def missing(record: type) -> set[str]:
    """Names of the fields without a default."""
    return {item.name for item in fields(record) if item.default is item.default_factory is MISSING}


def required(record: type) -> list[str]:
    """Names of the keys that a file must have."""
    return [name for name, item in keys_of(record).items() if item.required or name in missing(record)]


def keep_checked(record: object, section: str) -> None:
    """Check the fields of a frozen dataclass, and keep what the checks return.

    Numbers become floats: an integer kept as such would compile the models' kernels a second time.
    """
    for name, item in keys_of(type(record)).items():
        if item.check is not None:
            object.__setattr__(record, name, item.check(f"{section}.{name}", getattr(record, name)))


def number(low: float, high: float) -> Check:
    """A finite number in [low, high]."""
    return lambda name, value: require_number(name, value, low, high)


def integer(low: int, high: int) -> Check:
    """An integer in [low, high]."""
    return lambda name, value: require_integer(name, value, low, high)


def choice(*choices: str) -> Check:
    """One of some texts."""
    return lambda name, value: require_choice(name, value, choices)


def switch(name: str, value: object) -> bool:
    """True or false."""
    if not isinstance(value, bool):
        raise InputError(f"{name} must be true or false, got {shown(value)}")
    return value


def some_of(*choices: str) -> Check:
    """Some of several texts, kept in their usual order, each once."""

    def check(name: str, value: object) -> tuple[str, ...]:
        if not isinstance(value, list | tuple):
            raise InputError(f"{name} must be a list with items of {', '.join(choices)}, got {shown(value)}")
        given = [require_choice(name, item, choices) for item in value]
        return tuple(item for item in choices if item in given)

    return check
