"""Grids of scenes: all combinations of several values for some keys of a scene file."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from copy import deepcopy
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from coilspring import InputError, Scene
from coilspring.scene.scene import SECTIONS
from coilspring.scene.schema import keys_of
from coilspring.scene.toml import allowed_keys, refuse_unknown, scene_from_table

MOST = 100_000  # scenes of a grid
DIGITS = 12  # of a value within a range, which is then what a user would write


@dataclass(frozen=True)
class Varied:
    """A key of a scene file, as ``spring.wire_diameter`` or ``load.force.1``, and its values."""

    key: str
    values: tuple[Any, ...]


@dataclass(frozen=True)
class Point:
    """A point of a grid: the values of the keys and the scene, or why there is none."""

    values: tuple[Any, ...]
    scene: Scene | None
    refused: str = ""


def read_varied(texts: Sequence[str], table: Mapping[str, Any]) -> list[Varied]:
    """Keys and values of ``KEY=FIRST:LAST:COUNT`` or ``KEY=VALUE,VALUE,...`` for a scene of these keys.

    Raises `InputError`: a key that scenes, or this one, do not have; a text that is no range and no list.
    """
    found: list[Varied] = []
    for text in texts:
        key, equals, values = text.partition("=")
        try:
            if not equals:
                raise InputError("must be KEY=FIRST:LAST:COUNT or KEY=VALUE,VALUE,...")
            _require_key(key, table)
            for other in found:
                _refuse_same(key, other.key)
            found.append(Varied(key, _different(_values(values))))
        except InputError as error:
            raise InputError(f"--vary {text!r}: {error}") from None
    count = math.prod(len(each.values) for each in found)
    if count > MOST:
        raise InputError(f"--vary must make at most {MOST} scenes, got {count}")
    return found


def _require_key(key: str, table: Mapping[str, Any]) -> None:
    """Refuse a key that the file of a scene, as `table` has it, cannot have."""
    section, *path = key.split(".")
    if section not in SECTIONS:
        others = [name for name, record in SECTIONS.items() if section in allowed_keys(record)]
        meant = f"did you mean {others[0]}.{key}? " if others else ""
        raise InputError(f"unknown section {section!r}; {meant}allowed: {', '.join(SECTIONS)}")
    record = SECTIONS[section]
    name = path[0] if path else ""
    if not name:
        keys = allowed_keys(record)
        raise InputError(
            f"must name a key of [{section}], as {section}.{keys[0]}; allowed: {', '.join(keys)}"
        )
    refuse_unknown(f"[{section}]", {name: None}, allowed_keys(record), record)
    value, place = table[section].get(name), f"{section}.{name}"
    for step in path[1:]:
        value = dict(enumerate(value)) if isinstance(value, list) else value
        items = {str(item): each for item, each in value.items()} if isinstance(value, dict) else {}
        if step not in items:
            names = ", ".join(f"{place}.{item}" for item in items)
            allowed = (
                f"allowed: {names}" if items else f"it has no items{_in_place(name, record, table[section])}"
            )
            raise InputError(f"unknown item {step!r} of {place} in this scene; {allowed}")
        value, place = items[step], f"{place}.{step}"


def _refuse_same(key: str, other: str) -> None:
    """Refuse a key that sets what the `other` varied one sets, or takes its place."""
    if key == other:
        raise InputError(f"{key} is varied twice: give all its values in one list or range")
    if f"{key}.".startswith(f"{other}.") or f"{other}.".startswith(f"{key}."):
        raise InputError(f"{key} is varied already, by {other}")
    (section, name), (other_section, other_name) = (each.split(".")[:2] for each in (key, other))
    if section == other_section and other_name in _beside(SECTIONS[section], name):
        raise InputError(f"{other} and {key} exclude each other: vary one")


def _in_place(name: str, record: type, keys: Mapping[str, Any]) -> str:
    """Which key a scene has in the place of one, in words; empty where it has that, or none."""
    beside = _beside(record, name) if name not in keys else ()
    others = " and ".join(key for key in keys if key in beside)
    return f": the scene has {others} in its place" if others else ""


def _values(text: str) -> tuple[Any, ...]:
    """Values of a range or of a list."""
    parts = [part.strip() for part in text.split(":" if ":" in text else ",")]
    if ":" not in text:
        if "" in parts:
            raise InputError("values must be numbers, texts, true or false, with commas between")
        return tuple({"true": True, "false": False}.get(part, number_of(part)) for part in parts)
    given = [item for item in map(number_of, parts) if not isinstance(item, str) and math.isfinite(item)]
    if len(given) != 3 or len(parts) != 3:
        raise InputError("a range must be FIRST:LAST:COUNT, three numbers, as 1.2:1.8:7")
    first, last, count = given
    if not isinstance(count, int) or not 2 <= count <= MOST:
        raise InputError(f"the COUNT of a range must be an integer in [2, {MOST}], got {parts[2]}")
    values = [float(f"{value:.{DIGITS}g}") for value in np.linspace(first, last, count)]
    whole = isinstance(first, int) and isinstance(last, int) and all(map(float.is_integer, values))
    return tuple(map(int, values)) if whole else tuple(values)  # a number of steps is an integer


def number_of(text: str) -> int | float | str:
    """The number that `text` says; else the text, for the library to refuse with the range."""
    if "_" in text:  # Python reads 1_9 as 19, where 1.9 may be meant
        return text
    for kind in (int, float):
        with suppress(ValueError):
            return kind(text)
    return text


def _different(values: tuple[Any, ...]) -> tuple[Any, ...]:
    """Values that are all different: the same scene would be solved again."""
    ((value, count),) = Counter(values).most_common(1)
    if count > 1:
        raise InputError(f"values must be different, got {value} more than once")
    return values


def points(table: Mapping[str, Any], varied: Sequence[Varied]) -> Iterator[Point]:
    """All combinations of values in a scene of these keys, those of the last key fastest."""
    for values in product(*(each.values for each in varied)):
        try:
            yield Point(values, _changed(table, [each.key for each in varied], values))
        except InputError as error:
            yield Point(values, None, str(error))


def require_any(grid: Sequence[Point]) -> None:
    """Refuse a grid without any scene, by what its first point is refused for."""
    if not any(point.scene for point in grid):
        raise InputError(f"no scene can be solved: {grid[0].refused}")


def _changed(table: Mapping[str, Any], keys: Sequence[str], values: Sequence[Any]) -> Scene:
    """The scene with other values of some keys; a key takes the place of those that exclude it."""
    changed = dict(table)
    for section in {key.partition(".")[0] for key in keys}:
        changed[section] = deepcopy(table[section])
    for key, value in zip(keys, values, strict=True):
        section, *path, last = key.split(".")
        place = changed[section]
        if not path:
            for other in _excluded(SECTIONS[section], last):
                place.pop(other, None)
        for step in path:
            place = place[int(step)] if isinstance(place, list) else place[step]
        place[int(last) if isinstance(place, list) else last] = value
    return scene_from_table(changed)


def _excluded(record: type, name: str) -> set[str]:
    """Keys, other than tables, that cannot stand in a file beside one of this name."""
    return _beside(record, name) - {key for key, item in keys_of(record).items() if item.item}


def _beside(record: type, name: str) -> set[str]:
    """Keys of which one at most stands in a file, without this name itself."""
    groups = [{key, *item.instead} for key, item in keys_of(record).items()]
    return set().union(*(group for group in groups if name in group)) - {name}
