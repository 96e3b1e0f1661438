"""Keys of a scene file, as ``keys.toml`` lists them for the dataclasses that hold their values."""

import re
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, field, fields
from pathlib import Path
from typing import Any

from coilspring.errors import InputError, require_choice, require_integer, require_number
from coilspring.words import shown


@dataclass(frozen=True)
class Key:
    """One key of a scene file; see ``keys.toml``."""

    comment: str = ""
    instead: tuple[str, ...] = ()
    absent: str | None = None
    required: bool = False
    aliases: Mapping[str, str] = field(default_factory=dict)
    meant: Mapping[str, str] = field(default_factory=dict)
    item: str = ""
    checks: Mapping[str, Any] = field(default_factory=dict)  # by their names in `CHECKS`

    def check(self, name: str, value: object) -> Any:
        """The value to keep, or `InputError`; `name` is for the message."""
        try:
            for kind, allowed in self.checks.items():
                value = CHECKS[kind](name, value, allowed)
        except InputError as error:
            found = [text for pattern, text in self.meant.items() if re.search(pattern, str(value).lower())]
            raise InputError("; ".join((str(error), *found))) from None
        return value


def _switch(name: str, value: object, _: bool) -> bool:
    """True or false."""
    if not isinstance(value, bool):
        raise InputError(f"{name} must be true or false, got {shown(value)}")
    return value


def _some(name: str, value: object, choices: tuple[str, ...]) -> tuple[str, ...]:
    """Some of several texts, each once, kept in their usual order."""
    if not isinstance(value, list | tuple):
        raise InputError(f"{name} must be a list with items of {', '.join(choices)}, got {shown(value)}")
    given = [require_choice(name, item, choices) for item in value]
    if len(set(given)) < len(given):
        raise InputError(f"{name} must name each of {', '.join(choices)} at most once, got {shown(value)}")
    return tuple(item for item in choices if item in given)


CHECKS: dict[str, Callable[[str, object, Any], Any]] = {
    "number": lambda name, value, allowed: require_number(name, value, *allowed),
    "integer": lambda name, value, allowed: require_integer(name, value, *allowed),
    "choice": require_choice,
    "some": _some,
    "switch": _switch,
}


def _key(words: Mapping[str, Any]) -> Key:
    plain: dict[str, Any] = {
        name: tuple(value) if isinstance(value, list) else value for name, value in words.items()
    }
    checks = {name: plain.pop(name) for name in plain.keys() & CHECKS.keys()}
    return Key(**plain, checks=checks)


TABLES = tomllib.loads(Path(__file__).with_name("keys.toml").read_text(encoding="utf-8"))
KEYS = {table: {name: _key(words) for name, words in keys.items()} for table, keys in TABLES.items()}


def keys_of(record: type) -> Mapping[str, Key]:
    """Keys of a dataclass by name, in the order of a file."""
    return KEYS[record.__name__.lower()]


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
    for name, item in KEYS[section].items():
        object.__setattr__(record, name, item.check(f"{section}.{name}", getattr(record, name)))
