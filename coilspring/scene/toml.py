"""Scenes as TOML files, read and written by the keys that their dataclasses declare."""

import difflib
import json
import re
import tomllib
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from coilspring.errors import InputError
from coilspring.scene.catalogue import CATALOGUE
from coilspring.scene.profile import CoilSection
from coilspring.scene.scene import SECTIONS, Scene
from coilspring.scene.schema import keys_of, missing, required
from coilspring.words import shown

ITEMS: dict[str, type] = {"coilsection": CoilSection}  # tables in sections
AS_WRITTEN = ("material", "spring", "supports")  # may have other keys or another order than what is stored
REQUIRED = [section for section in SECTIONS if section in missing(Scene)]
MOST_BYTES = 1_000_000
# of the errors of tomllib, which name the line alone; and what begins a section or a value
TWICE = re.compile(r"Cannot (overwrite a value|declare .* twice) \(at (line (?P<line>\d+)|end)")
GIVEN = re.compile(r"\s*((?:\[\[[^\[\]=,]+\]\]|\[[^\[\]=,]+\])(?=\s*(?:#|$))|[^=#\[\]{}]+?(?=\s*=))")
COLUMN = 36  # at which comments begin
HEAD = """\
# A scene for coilcheck: one spring, how it is held, and its load. Units are mm, N, MPa and rad.
# Keys that are left out take the values in brackets; `coilcheck check FILE` says what a file describes.
"""


def load_scene(source: str | Path) -> Scene:
    """Scene of the catalogue by name, or of a TOML file by path.

    Raises
    ------
    InputError : unknown name, unreadable or truncated file, or a refused value, in one sentence.
    """
    if not isinstance(source, str | Path):
        raise InputError(f"SCENE must be the name of a scene or of a TOML file, got {shown(source)}")
    if str(source) in CATALOGUE:
        return CATALOGUE[str(source)]()
    path = Path(source)
    try:
        with path.open("rb") as file:
            data = file.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:  # a path with a zero byte is a ValueError
        raise InputError(
            f"SCENE must be one of {', '.join(CATALOGUE)} or a readable TOML file, "
            f"got {str(source)!r} ({getattr(error, 'strerror', None) or error})"
        ) from None
    try:
        return scene_from_text(_decoded(data), path.stem)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _decoded(data: bytes) -> str:
    if len(data) > MOST_BYTES:
        raise InputError(f"the file must be a scene of at most {MOST_BYTES} bytes, but it has more")
    try:
        return data.decode("utf-8-sig")  # some editors write a mark first
    except UnicodeDecodeError as error:
        raise InputError(f"the file must be UTF-8 text, but it is not from byte {error.start} on") from None


def scene_from_text(text: str, default_name: str = "scene") -> Scene:
    """Scene of a TOML text; see `load_scene`."""
    try:
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # a number of thousands of digits is a ValueError
        raise InputError(
            "the file must be complete TOML (numbers as 2.5, texts in quotes), but it is not: "
            f"{_given_twice(text, str(error)) or error}"
        ) from None
    return scene_from_table(table, default_name)


def _given_twice(text: str, error: str) -> str:
    """The key or section that a text gives twice, by where its reader stops; empty where none is found."""
    if not (found := TWICE.match(error)):
        return ""
    section, given = ("", 0), []
    for number, line in enumerate(text.replace("\r\n", "\n").split("\n"), 1):
        if number > int(found["line"] or number):
            break
        if each := GIVEN.match(line):
            if (name := each[1]).startswith("["):
                section = name, number if name.startswith("[[") else 0  # of which there may be several
            given.append((section, name))
            last = number
    if not given or given[-1] not in given[:-1]:  # a value may end some lines below its key
        return ""
    (head, _), name = given[-1]
    where = "" if head in ("", name) else f" in {head[:60]}"
    return f"{shown(name)}{where} is given twice, the second time in line {last}"


def scene_table(scene: Scene) -> dict[str, Any]:
    """Keys of a scene as its file has them, which `scene_from_table` takes."""
    return tomllib.loads(scene_text(scene))


def written_table(scene: Scene, source: str) -> dict[str, Any]:
    """The same, with some sections as they are in the file `source`, which no option changes.

    Where one of their keys is varied the others stay: the outer diameter, or G beside E.
    """
    written = tomllib.loads(scene_text(scene) if source in CATALOGUE else _decoded(Path(source).read_bytes()))
    return scene_table(scene) | {name: written[name] for name in AS_WRITTEN if name in written}


def scene_from_table(table: Mapping[str, Any], default_name: str = "scene") -> Scene:
    """Scene of the keys of a file; see `load_scene`."""
    refuse_unknown("top level", table, [*keys_of(Scene), *SECTIONS], Scene)
    keys = {name: _section(name, record, table) for name, record in SECTIONS.items()}
    parts = {name: _record(name, record, keys[name]) for name, record in SECTIONS.items()}
    return Scene(name=table.get("name", default_name), **parts)


def _section(section: str, record: type, table: Mapping[str, object]) -> Mapping[str, object]:
    """Keys of a section of a file, with those refused that cannot be."""
    if section not in table and section in REQUIRED:
        sections = " and ".join(f"[{name}]" for name in REQUIRED)
        raise InputError(f"section [{section}] is missing; {sections} are required")
    keys = table.get(section, {})
    if not isinstance(keys, dict):
        raise InputError(f"{section} must be a section [{section}] with keys, got {shown(keys)}")
    _refuse_keys(section, f"[{section}]", record, keys)
    return keys


def _record(name: str, record: type, table: Mapping[str, object]) -> Any:
    """The dataclass of a table called `name` in messages."""
    items = {key: ITEMS[item.item] for key, item in keys_of(record).items() if item.item}
    values = dict(table)
    for key in items.keys() & table.keys():
        values[key] = _tables(f"{name}.{key}", items[key], table[key])
    return record.from_keys(values) if hasattr(record, "from_keys") else record(**values)


def _tables(name: str, record: type, tables: object) -> list[dict[str, Any]]:
    """The tables of an array, with those refused that cannot be: the dataclass they are in reads them."""
    if not isinstance(tables, list):
        raise InputError(f"{name} must be tables [[{name}]], got {shown(tables)}")
    for number, table in enumerate(tables):
        item = f"{name}[{number}]"
        if not isinstance(table, dict):
            raise InputError(f"{item} must be a table with {', '.join(keys_of(record))}, got {shown(table)}")
        _refuse_keys(item, f"{item} of [[{name}]]", record, table)
    return tables


def _refuse_keys(name: str, where: str, record: type, table: Mapping[str, object]) -> None:
    """Refuse keys that are unknown, that exclude each other, or that are missing."""
    known = keys_of(record)
    refuse_unknown(where, table, allowed_keys(record), record)
    for key, item in known.items():
        both = [other for other in (key, *item.instead) if other in table]
        if len(both) > 1:
            group = ", ".join((key, *item.instead))
            raise InputError(f"{where} takes one of {group}, got {' and '.join(both)}")
    for key in required(record):
        if not table.keys() & {key, *known[key].instead}:
            needed = ", or ".join((", ".join(required(record)), *known[key].instead))
            raise InputError(f"{name}.{key} is missing; {where} requires {needed}")


def allowed_keys(record: type) -> list[str]:
    """Names of a dataclass's keys in a file, and of those that can take their place."""
    known = keys_of(record)
    return list(dict.fromkeys([*known, *(other for item in known.values() for other in item.instead)]))


def refuse_unknown(where: str, table: Mapping[str, object], allowed: list[str], record: type) -> None:
    """Refuse the first key of a table that is not allowed, with what is likely meant."""
    for key in table:
        if key not in allowed:
            near = _near(key[:100], table, allowed, record)
            meant = f"did you mean {near}? " if near else ""
            raise InputError(f"unknown key {shown(key)} in {where}; {meant}allowed: {', '.join(allowed)}")


def _near(unknown: str, table: Mapping[str, object], allowed: list[str], record: type) -> str:
    """What is likely meant by an unknown key of a table, or nothing."""
    for key, item in keys_of(record).items():
        for pattern, made in item.aliases.items():
            if re.fullmatch(pattern, unknown.lower()) and not table.keys() & set(item.instead):
                return key + made
    return "".join(difflib.get_close_matches(unknown, allowed, n=1))


def scene_text(scene: Scene) -> str:
    """Commented TOML text of a scene, which reads back as the same scene."""
    sections = [_table_text(f"[{section}]", section, getattr(scene, section)) for section in SECTIONS]
    return "\n".join((HEAD + _lines(scene), *sections))


def _table_text(head: str, name: str, record: Any) -> str:
    """Text of a table, and of the arrays of tables in it."""
    tables = [
        _table_text(f"[[{name}.{key}]]", f"{name}.{key}", table)
        for key, item in keys_of(type(record)).items()
        if item.item
        for table in getattr(record, key)
    ]
    return "\n".join((f"{head}\n{_lines(record)}", *tables))


def _lines(record: Any) -> str:
    """Lines of the keys of a dataclass that are no tables."""
    text, defaults = "", {item.name: item.default for item in fields(record)}
    given = {name for name, default in defaults.items() if getattr(record, name) != default}
    for key, item in keys_of(type(record)).items():
        if given & set(item.instead):
            continue
        if item.absent is not None and key not in given:
            text += item.absent
        elif not item.item:
            text += f"{key} = {_toml(getattr(record, key))}".ljust(COLUMN - 1) + f" # {item.comment}\n"
    return text


def _toml(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        # JSON's escapes are TOML's, but for pairs of them, and one that it leaves out
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, tuple):
        return f"[{', '.join(map(_toml, value))}]"
    return repr(value)
