"""Accuracy on request, measured on random springs: ``python -m validation.verification.requested``.

``--out FOLDER`` has ``requested.csv``, a row for each spring and accuracy as it comes: the same command goes
on where it was interrupted, also with more seeds. A table by kind of load is printed. ``--page`` writes the
page of the recorded rows and solves nothing; the rows of files that it names are recorded first, in place of
those before. What is measured: `validation.verification.requestedruns`.
"""

import argparse
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from coilspring import InputError
from validation.study.files import write_text
from validation.study.frames import read_csv
from validation.study.rows import Row, append, whole_rows, write
from validation.verification.requestedpage import page, prepared, summary
from validation.verification.requestedruns import ACCURACIES, COLUMNS, EACH, SEED, rows, springs

CSV = "requested.csv"
PAGE, RECORD = Path("docs/accuracy-on-request.md"), Path("reports/requested")


def study(folder: Path, each: int = EACH, seeds: Iterable[int] = (SEED,)) -> pd.DataFrame:
    """Write the rows of all springs, `each` of every kind and seed; those that are there already are kept."""
    folder.mkdir(parents=True, exist_ok=True)
    target = folder / CSV
    known = _complete(whole_rows(target, COLUMNS))
    write((row for found in known.values() for row in found), target, COLUMNS)
    for seed in seeds:
        for drawn, scene in springs(each, seed=seed):
            if (str(drawn.seed), drawn.kind, str(drawn.number)) not in known:
                found = pd.DataFrame(rows(drawn, scene)).astype(object).fillna("")
                append(found.to_dict("records"), target, COLUMNS)
    return read_csv(target)


def _complete(found: Iterable[Row]) -> dict[tuple[str, ...], list[Row]]:
    """Rows of each spring that has all accuracies: a run may have ended amid those of one."""
    springs: dict[tuple[str, ...], list[Row]] = {}
    for row in found:
        springs.setdefault((row["seed"], row["kind"], row["number"]), []).append(row)
    asked = set(ACCURACIES)
    return {key: rows for key, rows in springs.items() if {float(row["asked"]) for row in rows} == asked}


def record(files: Iterable[Path], folder: Path = RECORD) -> None:
    """Write the rows of several runs to one file, letter for letter.

    Raises
    ------
    InputError : the files have other columns, or a spring is in two of them.
    """
    heads, bodies = zip(*(file.read_text(encoding="utf-8").split("\n", 1) for file in files), strict=True)
    if len(set(heads)) > 1:
        raise InputError("rows of runs must have the same columns")
    folder.mkdir(parents=True, exist_ok=True)
    frame = pd.concat([read_csv(file) for file in files])
    if frame.duplicated(["seed", "kind", "number", "asked"]).any():
        raise InputError("a spring must be in one run alone, got one that is in two")
    write_text(folder / CSV, "\n".join((heads[0], "".join(bodies))))


def main(arguments: Sequence[str] | None = None) -> None:
    """Solve the springs and print a table, or write the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--out", type=Path, default=Path("coilcheck-out/requested"))
    parser.add_argument("--each", type=int, default=EACH, help="springs of every kind of load and seed")
    parser.add_argument("--seed", type=int, nargs="+", default=[SEED], help="one or more, of random springs")
    words = "write the page of the recorded rows; those of FILEs are recorded first"
    parser.add_argument("--page", type=Path, nargs="*", metavar="FILE", help=words)
    chosen = parser.parse_args(arguments)
    if chosen.page is None:
        with np.errstate(divide="ignore"):
            table = summary(prepared(study(chosen.out, chosen.each, chosen.seed)), "kind")
        print(table.to_string(index=False, float_format="%.3g"))
        return
    if chosen.page:
        record(chosen.page)
    write_text(PAGE, page(read_csv(RECORD / CSV)))


if __name__ == "__main__":
    main()
