"""A table of texts, as pages and CSV files hold it."""

import csv
import io
from dataclasses import dataclass


@dataclass(frozen=True)
class Table:
    """A table of texts. As a text it is Markdown."""

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def __str__(self) -> str:
        lines = (self.header, ("---",) * len(self.header), *self.rows)
        return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in lines)

    def csv(self) -> bytes:
        """The table as a CSV file."""
        stream = io.StringIO()
        csv.writer(stream, lineterminator="\n").writerows((self.header, *self.rows))
        return stream.getvalue().encode()
