"""Views of a study's data: tables and CSV files of a DataFrame."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from validation.study.document import Table
from validation.study.output import write_text

Format = str | Callable[[Any], str]  # as str.format takes it, or a function of the value


def formatted(data: pd.DataFrame, formats: Mapping[str, Format]) -> pd.DataFrame:
    """The data as texts, columns by their formats; empty where there is no value."""
    texts = {}
    for name in data.columns:
        form = formats.get(str(name), "{}")
        texts[name] = data[name].map(form.format if isinstance(form, str) else form, na_action="ignore")
    return pd.DataFrame(texts, dtype=object).fillna("")


def frame_table(data: pd.DataFrame, formats: Mapping[str, Format] | None = None) -> Table:
    """The columns of a DataFrame as a table."""
    texts = formatted(data, formats or {})
    return Table(tuple(map(str, texts.columns)), tuple(texts.itertuples(index=False, name=None)))


def write_csv(data: pd.DataFrame, file: Path, digits: int = 6) -> None:
    """Write a CSV file, numbers to so many significant digits."""
    write_text(file, data.to_csv(index=False, float_format=f"%.{digits}g", lineterminator="\n"))
