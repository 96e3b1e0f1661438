"""Rows of a study as they come, texts in a CSV file: a run that was interrupted goes on from them."""

import csv
import io
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence, Sized
from contextlib import contextmanager
from pathlib import Path

from validation.study.files import content_of, write_text, writing

Row = dict[str, str]  # texts by column


def whole_rows(file: Path, columns: Sequence[str]) -> list[Row]:
    """Rows of a file, without a line that was cut; none where there is no file or its columns are others."""
    text = (content_of(file) or b"").decode("utf-8", errors="replace")  # it may be of another program
    try:
        lines = [*csv.reader(io.StringIO(text[: text.rfind("\n") + 1]))]
    except csv.Error:
        return []
    if lines[:1] != [list(columns)]:
        return []
    return [dict(zip(columns, line, strict=True)) for line in lines[1:] if len(line) == len(columns)]


def write(rows: Iterable[Mapping[str, object]], file: Path, columns: Sequence[str]) -> None:
    """Write a file of the rows, whole or not at all."""
    write_text(file, ",".join(columns) + "\n" + _lines(rows, columns))


def append(
    rows: Iterable[Mapping[str, object]], file: Path, columns: Sequence[str], *, synced: bool = True
) -> None:
    """Add rows at the end of a file that `write` began.

    They are on the disk when this returns; unless `synced`, where a row takes less time to find than to
    get there, the system puts them there later, and a loss of power may take the last ones.
    """
    with writing(file), file.open("a", encoding="utf-8", newline="") as stream:
        stream.write(_lines(rows, columns))
        stream.flush()
        if synced:
            os.fsync(stream.fileno())


@contextmanager
def kept_if_interrupted(file: Path, done: Sized, of: int) -> Iterator[None]:
    """Say of a block that was interrupted how many of its rows are in the file: those `done` by then."""
    try:
        yield
    except KeyboardInterrupt:
        said = f"{len(done)} of {of} rows are in {file}; the same command goes on"
        raise KeyboardInterrupt(said) from None


def _lines(rows: Iterable[Mapping[str, object]], columns: Sequence[str]) -> str:
    stream = io.StringIO()
    csv.DictWriter(stream, columns, lineterminator="\n").writerows(rows)
    return stream.getvalue()
