"""The page on the laws' errors: ``python -m validation.verification.ablation``.

``--page`` writes it of recorded numbers. Its words are in ``fourcases.md`` and ``randomsprings.md``.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from validation.study import template
from validation.study.document import Table
from validation.study.frames import frame_table, write_csv
from validation.study.output import write_facts, write_text
from validation.study.provenance import write_provenance
from validation.verification import randomfigure, randompage, randomsprings
from validation.verification.fourcases import STAGES, measured

PAGE = Path("docs/error-budget.md")
FOUR = Path("reports/errorbudget/fourcases.csv")
DIGITS = {"refinements": 3, "law": 3, "reference with": 3, "rod": 4}  # of each table
DOUBLED = 2.0  # from which on a refinement is said to be needed
WORDS = template.template(Path(__file__).with_name("fourcases.md"))


class Cases:
    """The numbers of the four cases by table, row and case."""

    def __init__(self, data: pd.DataFrame) -> None:
        self._values = data.set_index(["table", "row", "case"])["value"].to_dict()
        self.titles = [case for table, row, case in self._values if (table, row) == ("law", "helix law")]

    def value(self, table: str, row: str, case: str) -> float:
        """Any number."""
        return self._values[table, row, case]

    def law(self, case: str, without: str = "") -> float:
        """Error of the law, or of the law without a refinement, per cent."""
        return self.value("law", f"without `{without}`" if without else "helix law", case)

    def needed(self, case: str) -> str:
        """Refinements without which the error at least doubles."""
        names = [f"`{name}`" for name in STAGES if self.law(case, name) >= DOUBLED * self.law(case)]
        return ", ".join(names) or "none"

    def most_moved(self, switch: str) -> float:
        """Most by which leaving a refinement out changes the error of the law, per cent of the peak."""
        return max(abs(self.law(case, switch) - self.law(case)) for case in self.titles)

    def off_the_rod(self, row: str, load: str) -> float:
        """Error of a law against the exact rod, per cent."""
        return 100.0 * (self.value("rod", row, load) / self.value("rod", "exact rod", load) - 1.0)


def tables(data: pd.DataFrame) -> dict[str, Table]:
    """Tables of the four cases, their rows and columns in the order of the data."""
    found = {}
    for name, digits in DIGITS.items():
        rows = data[data["table"] == name]
        wide = rows.pivot(index="row", columns="case", values="value")
        wide = wide.loc[rows["row"].unique(), rows["case"].unique()]
        formats = dict.fromkeys(wide.columns, f"{{:.{digits}f}}")
        found[name] = frame_table(wide.rename_axis(name).reset_index(), formats)
    return found


def page(four: pd.DataFrame, springs: pd.DataFrame) -> str:
    """The whole page, a view of the recorded numbers."""
    first = template.page(WORDS, f=Cases(four), tables=tables(four), stages=STAGES)
    return f"{first}\n{randompage.page(springs)}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Solve everything, unless only the page is wanted; write numbers, figure and page."""
    parser = argparse.ArgumentParser(prog="python -m validation.verification.ablation", description=__doc__)
    parser.add_argument(
        "--page", action="store_true", help="write the page of the recorded numbers, solve nothing"
    )
    if not parser.parse_args(arguments).page:
        FOUR.parent.mkdir(parents=True, exist_ok=True)
        write_csv(measured(), FOUR)
        write_csv(randomsprings.study(), randomsprings.CSV, digits=4)
        write_provenance("python -m validation.verification.ablation", FOUR.parent)
    springs = randomsprings.read_csv()
    randomfigure.write(springs)
    write_facts(randompage.facts(springs), FOUR.parent)
    write_text(PAGE, page(pd.read_csv(FOUR), springs))


if __name__ == "__main__":
    main()
