"""A study's result is one DataFrame, a row for each run: its CSV file and its tables are views of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from validation.study.document import Table

if TYPE_CHECKING:
    import pandas as pd


def to_csv(rows: pd.DataFrame, digits: int = 6) -> bytes:
    """A result as a CSV file, numbers to so many digits; what is missing is an empty cell."""
    return rows.to_csv(index=False, float_format=f"%.{digits}g", lineterminator="\n").encode()


def read_csv(file: Path | BytesIO) -> pd.DataFrame:
    """What `to_csv` wrote; words that pandas would take for missing stay words."""
    import pandas as pd

    return pd.read_csv(file, keep_default_na=False, na_values=["", "nan"])


def view(rows: pd.DataFrame, columns: Mapping[str, Callable[[Any], object]]) -> Table:
    """A table for a reader: a cell is what a column's function makes of a row of the study's result.

    Parameters
    ----------
    rows : the study's result, or a part of it.
    columns : header -> function of a row, which has the columns of `rows` as attributes.
    """
    cells = (tuple(str(cell(row)) for cell in columns.values()) for row in rows.itertuples())
    return Table(tuple(columns), tuple(cells))
