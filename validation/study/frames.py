"""A study's result is one DataFrame, a row for each run: its CSV file and its tables are views of it."""

from collections.abc import Callable, Mapping
from io import BytesIO
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pandas as pd

from validation.study.files import write_bytes
from validation.study.tables import Table

TIPS = ("ux_mm", "uy_mm", "rotz_rad")  # columns of a tip
Format = str | Callable[[Any], str]  # as str.format takes it, or a function of the value


def to_csv(data: pd.DataFrame, digits: int = 6) -> bytes:
    """A result as a CSV file, numbers to so many significant digits; what is missing is an empty cell."""
    return data.to_csv(index=False, float_format=f"%.{digits}g", lineterminator="\n").encode()


def write_csv(data: pd.DataFrame, file: Path, digits: int = 6) -> None:
    """Write a CSV file."""
    write_bytes(file, to_csv(data, digits))


def read_csv(file: Path | BytesIO) -> pd.DataFrame:
    """What `to_csv` wrote; words that pandas would take for missing stay words."""
    return pd.read_csv(file, keep_default_na=False, na_values=["", "nan"])


def frame_table(data: pd.DataFrame, formats: Mapping[str, Format] = MappingProxyType({})) -> Table:
    """The columns of a DataFrame as a table, by their formats; empty where there is no value."""
    texts = {}
    for name in data.columns:
        form = formats.get(str(name), "{}")
        texts[name] = data[name].map(form.format if isinstance(form, str) else form, na_action="ignore")
    rows = pd.DataFrame(texts, dtype=object).fillna("").itertuples(index=False, name=None)
    return Table(tuple(map(str, data.columns)), tuple(rows))


def view(data: pd.DataFrame, columns: Mapping[str, Callable[[Any], object]]) -> Table:
    """A table whose cells follow from several columns each: header -> function of a row, by attributes."""
    cells = (tuple(str(cell(row)) for cell in columns.values()) for row in data.itertuples())
    return Table(tuple(columns), tuple(cells))
