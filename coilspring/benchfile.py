"""Columns of a CSV file as test benches write it, in N and mm."""

from __future__ import annotations

import csv
import math
import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from coilspring.curves import COMPONENTS
from coilspring.errors import InputError
from coilspring.scene.load import MOST_FORCE
from coilspring.scene.profile import LONGEST
from coilspring.words import shown

if TYPE_CHECKING:
    import pandas as pd

PATH_COLUMNS = ("time", "load_x", "load_y", *COMPONENTS)
KNOWN = {  # names of measured columns, in lower case
    "force": ("force", "load", "f", "standard force", "kraft", "standardkraft", "prüfkraft", "federkraft"),
    "deflection": (
        *("deflection", "travel", "stroke", "compression", "displacement", "extension", "s"),
        *("compressive extension", "standard travel", "weg", "standardweg", "federweg"),
    ),
}
NAMES = {name: kind for kind, names in KNOWN.items() for name in names}
UNITS = {  # in N or mm; read in upper or lower case
    "force": {"N": 1.0, "kN": 1e3},
    "deflection": {"mm": 1.0, "cm": 10.0, "m": 1e3, "um": 1e-3, "µm": 1e-3},
}
HEADER = re.compile(
    r"(?P<name>[a-zäöüß]+(?: [a-z]+)?)(?:\s*(?:[\[(/_]|\bin\b)\s*(?P<unit>[^\])]+?)\s*[\])]?)?"
)
RANGES = {  # most of a column's numbers, and their unit
    **dict.fromkeys(("force", "load_x", "load_y"), (MOST_FORCE, "N")),
    **dict.fromkeys(("deflection", "ux", "uy"), (LONGEST, "mm")),
}
NUMBER = re.compile(r"[-+]?[\d.,]+(e[-+]?\d+)?", re.IGNORECASE)  # in either decimal sign
EXAMPLE = (
    "a line with the names of the columns, as force,deflection or Force [kN],Travel [cm], or those of "
    "path.csv"
)


@dataclass(frozen=True)
class CurveTable:
    """A load curve by columns."""

    columns: dict[str, np.ndarray]  # force, N, and deflection, mm, or those of path.csv; no others
    places: list[str]  # what messages call the rows: the lines of a file
    file: str = ""  # that it was read from

    def __post_init__(self) -> None:
        """Refuse numbers that are not finite, or that no load of a scene has."""
        for name, values in self.columns.items():
            most, unit = RANGES.get(name, (math.inf, ""))
            if (beyond := np.abs(values) > most).any():
                i = int(np.argmax(beyond))
                raise InputError(
                    f"{self.places[i]} must have a {name} in [{-most:g}, {most:g}] {unit}, "
                    f"got {values[i]:g} {unit}"
                )
            if not np.isfinite(values).all():
                raise InputError(f"curve must hold finite numbers, got others in column {name}")


Source: TypeAlias = "Mapping[str, np.ndarray] | pd.DataFrame | str | Path | CurveTable"


def read_table(source: Source) -> CurveTable:
    """The curve of a file or of columns; one that was read is returned as it is.

    Raises
    ------
    InputError : an unreadable file, an unknown unit, or what is no number, in one sentence.
    """
    if isinstance(source, CurveTable):
        return source
    if not isinstance(source, str | Path):
        if not hasattr(source, "keys"):
            raise InputError(f"curve must be a path, a table or a CSV file, got {shown(source)}")
        return CurveTable(*_given(source))
    text = _text(Path(source))
    with named(str(source)):
        return CurveTable(*_parsed(text), str(source))


def _given(source: Mapping[str, np.ndarray] | pd.DataFrame) -> tuple[dict[str, np.ndarray], list[str]]:
    """Columns of a table, and what messages call its rows."""
    heads = _heads([str(name) for name in source])
    try:
        with np.errstate(over="ignore"):  # such numbers are refused later
            found = {
                name: scale * np.asarray(source[key], dtype=float)
                for key, (name, scale) in zip(source, heads, strict=True)
                if name
            }
    except (TypeError, ValueError):
        raise InputError("curve must hold numbers, got texts") from None
    shapes = {values.shape for values in found.values()}
    if any(len(shape) != 1 for shape in shapes) or len(shapes) > 1:
        raise InputError(
            f"curve must have columns of numbers, all of one length, got shapes {sorted(shapes)}"
        )
    rows = max((values.size for values in found.values()), default=0)
    return found, [f"row {i}" for i in range(1, rows + 1)]


@contextmanager
def named(file: str) -> Iterator[None]:
    """Put a file's name before what is wrong with it."""
    try:
        yield
    except (InputError, csv.Error) as error:
        raise InputError(f"{file}: {error}" if file else str(error)) from None


def _text(file: Path) -> str:
    """Text of a file; spreadsheets write UTF-16, too, and old programs Latin-1."""
    try:
        data = file.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"curve must be a readable CSV file, got {shown(str(file))} ({reason})") from None
    try:
        return data.decode("utf-16" if data.startswith((BOM_UTF16_LE, BOM_UTF16_BE)) else "utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _parsed(text: str) -> tuple[dict[str, np.ndarray], list[str]]:
    """Columns of a text, and its lines; those above the names, as benches write them, are passed over."""
    lines = [(i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip(" ;,\t")]
    heads, separator, rows = _header(lines)
    if rows and (units := _unit_row(rows[0][1], heads)):
        heads, rows = units, rows[1:]
    wanted = [(column, name, scale) for column, (name, scale) in enumerate(heads) if name]
    _refuse_two_signs(rows, [column for column, _, _ in wanted])
    values = [
        [scale * _number(i, row, column, separator, len(heads)) for column, _, scale in wanted]
        for i, row in rows
    ]
    table = np.array(values).reshape(-1, len(wanted)).T
    places = [f"line {i}" for i, _ in rows]
    return {name: column for (_, name, _), column in zip(wanted, table, strict=True)}, places


def _refuse_two_signs(rows: list[tuple[int, list[str]]], columns: list[int]) -> None:
    """Refuse both commas and points in numbers: one separates thousands, but reads as a decimal sign."""
    first: dict[str, str] = {}
    for line, cells in rows:
        for cell in (cells[column].strip(' "') for column in columns if column < len(cells)):
            for sign in ".," if NUMBER.fullmatch(cell) else "":
                if sign in cell:
                    first.setdefault(sign, f"{shown(cell)} in line {line}")
    if len(first) > 1:
        found = " and ".join(dict.fromkeys(first.values()))
        raise InputError(f"numbers must have one decimal sign and no thousands separators, got {found}")


def _header(lines: list[tuple[int, str]]) -> tuple[list[tuple[str, float]], str, list[tuple[int, list[str]]]]:
    """Names and units of the columns, what separates them, and the cells of the lines below, numbered."""
    half = ""  # what is wrong with the first line that has one column of the two
    for place, (number, line) in enumerate(lines):
        separator = next((mark for mark in ";\t" if mark in line), ",")
        cells = next(csv.reader([line], delimiter=separator))
        names = {name for name, _ in map(_head, cells)}
        for kind in KNOWN if names & KNOWN.keys() and not half else ():
            if kind not in names:
                found = ", ".join(cell.strip() for cell in cells)
                half = f"line {number} has no column {kind} ({', '.join(KNOWN[kind])}), found {shown(found)}"
        if names >= {"force", "deflection"} or ("time" in names and names & {*COMPONENTS}):
            rows = [(i, next(csv.reader([row], delimiter=separator))) for i, row in lines[place + 1 :]]
            return _heads(cells), separator, rows
    raise InputError(half or f"curve must have {EXAMPLE}, got {shown(lines[0][1] if lines else '')}")


def _head(cell: str) -> tuple[str, str | None]:
    """Name of a column as this module has it, empty where it is none of a curve, and its unit."""
    plain = cell.strip().strip('"').lower()
    words, _, last = plain.rpartition(" ")
    if (kind := NAMES.get(words.strip(), "")) and _known(kind, last):
        return kind, last  # as in Force kN
    match = HEADER.fullmatch(plain)
    name = plain if plain in PATH_COLUMNS else NAMES.get(match["name"], "") if match else ""
    return name, match["unit"] if match and name in UNITS else None


def _heads(cells: list[str]) -> list[tuple[str, float]]:
    """Name of each column, empty where it is none of a curve, and the unit of its numbers in N or mm."""
    heads = [(name, _scale(name, unit) if unit else 1.0) for name, unit in map(_head, cells)]
    names = [name for name, _ in heads]
    used = KNOWN if {*names} >= KNOWN.keys() else PATH_COLUMNS
    for kind in (*UNITS, *used):
        if names.count(kind) > 1:
            raise InputError(f"curve must have one column {kind}, got several")
    return [(name if name in used else "", scale) for name, scale in heads]


def _known(name: str, unit: str) -> float | None:
    """A unit in N or mm; None of one that is not read."""
    plain = unit.strip().lower().replace("μ", "µ")
    return next((scale for known, scale in UNITS[name].items() if known.lower() == plain), None)


def _scale(name: str, unit: str) -> float:
    """A unit in N or mm."""
    if scale := _known(name, unit):
        return scale
    raise InputError(f"column {name} must be in {' or '.join(UNITS[name])}, got {shown(unit)}")


def _unit_row(cells: list[str], heads: list[tuple[str, float]]) -> list[tuple[str, float]] | None:
    """The columns with the units of a line below their names, or nothing where it is no such line."""
    units = [(cell.strip(' []()"'), *head) for cell, head in zip(cells, heads, strict=False)]
    used = [cell for cell, name, _ in units if name and cell]
    if not used or any(re.search(r"\d", cell) for cell in used):
        return None
    return [(name, _scale(name, cell) if name in UNITS and cell else scale) for cell, name, scale in units]


def _number(line: int, cells: list[str], column: int, separator: str, columns: int) -> float:
    """A number of a line; a decimal comma is one where columns are separated by something else."""
    if separator == "," and any(cell.strip() for cell in cells[columns:]):  # a comma at the end is none
        raise InputError(
            f"line {line} has {len(cells)} numbers below {columns} names: with decimal commas the columns "
            "must be separated by semicolons or tabs"
        )
    cell = cells[column].strip().strip('"') if column < len(cells) else ""
    text = cell if separator == "," or "." in cell else cell.replace(",", ".")
    try:
        value = float(text.replace("_", "?"))  # which Python would read past
    except ValueError:
        raise InputError(
            f"line {line} must have a number in column {column + 1}, got {shown(cell)}"
        ) from None
    if not math.isfinite(value):
        raise InputError(f"line {line} must have a finite number in column {column + 1}, got {shown(cell)}")
    return value
