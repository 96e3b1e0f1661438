"""The page on the laws' errors: ``python -m validation.verification.ablation``.

``--page`` writes it of recorded numbers.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd

from validation.study.document import Block, Bullets, Heading, Table, Text, to_markdown
from validation.study.frames import write_csv
from validation.study.output import write_facts, write_text
from validation.study.provenance import write_provenance
from validation.verification import randomfigure, randompage, randomsprings
from validation.verification.fourcases import STAGES, measured

PAGE = Path("docs/error-budget.md")
FOUR = Path("reports/errorbudget/fourcases.csv")
DOUBLED, NEEDED = 2.0, "at least doubles"  # from which on a refinement is said to be needed

HEAD = (
    "Written by `python -m validation.verification.ablation`, with `--page` of the recorded numbers: "
    "[the four cases](../reports/errorbudget/fourcases.csv), "
    "[the random springs](../reports/errorbudget/randomsprings.csv). "
    "None compares with a measured spring. The law is in [theory.md](theory.md), section 2."
)
CASES_TEXT = (
    "Largest error of the load curve in per cent of the peak, worst component, 50 steps. Reference: wire "
    "model, 16 curved elements and 4 sphere pairs per turn. Both models have the scene's rule of sliding."
)


class Cases:
    """The numbers of the four cases by table, row and case."""

    def __init__(self, data: pd.DataFrame) -> None:
        self._values = data.set_index(["table", "row", "case"])["value"].to_dict()
        self.titles = [case for table, row, case in self._values if (table, row) == ("law", "helix law")]

    def law(self, case: str, row: str = "helix law") -> float:
        """Error of the law, or of the law without a refinement, per cent."""
        return self._values["law", row, case]

    def value(self, table: str, row: str, case: str) -> float:
        """Any number."""
        return self._values[table, row, case]

    def moved(self, case: str, switch: str) -> float:
        """By how much leaving a refinement out changes the error of the law, per cent of the peak."""
        return abs(self.law(case, f"without `{switch}`") - self.law(case))


A, B = "Spring A w/o contacts", "Spring B w/o contacts"
A4, B4 = "Spring A", "Spring B"
PAPER = "Haringx, the paper's law"


def _bare(cases: Cases) -> str:
    needed = {case: _needed(cases, case) for case in (A, B)}
    return (
        f"Without contact the helix law is {cases.law(A):.2f} % from the wire model on Spring A and "
        f"{cases.law(B):.2f} % on Spring B. Leaving a refinement out {NEEDED} that on Spring A for "
        f"{needed[A]}, on Spring B for {needed[B]}."
    )


def _needed(cases: Cases, case: str) -> str:
    names = [
        f"`{stage.switch}`"
        for stage in STAGES
        if cases.law(case, f"without `{stage.switch}`") >= DOUBLED * cases.law(case)
    ]
    return ", ".join(names) or "none"


def _taper(cases: Cases) -> str:
    words = []
    for load in ("100 N", "200 N"):
        exact = cases.value("rod", "exact rod", load)
        with_it, less = (
            100.0 * (cases.value("rod", row, load) / exact - 1.0) for row in ("helix law", "without `taper`")
        )
        side = "closer to" if abs(with_it) < abs(less) else "farther from"
        words.append(f"{side} the rod at {load} ({with_it:+.3f} % in place of {less:+.3f} %)")
    return (
        f"Taper brings the law {' and '.join(words)}; at 200 N Spring B without contact has telescoped "
        "through itself. It costs nothing in the solve and is kept."
    )


def _small(cases: Cases) -> str:
    stretch, current = (
        max(cases.moved(case, switch) for case in cases.titles) for switch in ("stretch", "current")
    )
    return (
        f"Stretch moves no error of these springs by more than {stretch:.3f} %, the current angle none by "
        f"more than {current:.3f} %; they cost nothing either."
    )


def _pairs(cases: Cases) -> str:
    moved = abs(cases.value("refinements", PAPER, A4) - cases.law(A4))
    pairs = cases.value("reference with", "twice the pairs per turn", A4)
    side = "less" if moved < pairs else "more"
    return (
        f"On Spring A in contact the refinements together move the error by {moved:.3f} %: {side} than "
        f"twice the number of sphere pairs moves the wire model, {pairs:.3f} %."
    )


def _ends(cases: Cases) -> str:
    errors = {k: cases.law(A, f"helix law, start phase {k} degrees") for k in (45, 90, 270)}
    return (
        "The effect of fixed ends is how the start phase enters an in-plane model. At 90 and 270 degrees, "
        "where the tilt of the axis lies in the working plane, the error on Spring A without contact is "
        f"{errors[90]:.3f} and {errors[270]:.3f} %; at 45 degrees, where both planes are coupled, "
        f"{errors[45]:.3f} %."
    )


def _meets(cases: Cases) -> str:
    share = cases.value("outside", "normal forces", B4)
    return (
        f"{share:.0f} % of the normal forces of Spring B in contact at full load are in pairs of the wire "
        f"model outside the working plane, in which the beam's circles lie. In contact the helix law is "
        f"{cases.law(B4):.2f} % from the wire model, without contact {cases.law(B):.2f} %."
    )


SENTENCES: dict[str, Callable[[Cases], str]] = {
    "without contact": _bare,
    "taper": _taper,
    "small refinements": _small,
    "pairs of spring A": _pairs,
    "start phase": _ends,
    "plane of contact": _meets,
}


def four_cases(data: pd.DataFrame) -> list[Block]:
    """The part of the page on the paper's four cases."""
    cases = Cases(data)
    return [
        Heading(2, "The paper's four cases"),
        Text(CASES_TEXT),
        _table(data, "refinements", 3),
        Text("The whole law, and with one refinement left out (their names are below):"),
        _table(data, "law", 3),
        Text("What the reference itself changes by, per cent of its peak:"),
        _table(data, "reference with", 3),
        Text("UY of Spring B without contact, mm, and of the exact rod:"),
        _table(data, "rod", 4),
        Heading(2, "What the refinements are"),
        Bullets(tuple(f"**{stage.name}** (`{stage.switch}`): {stage.meaning}." for stage in STAGES)),
        Heading(2, "What these numbers say"),
        Bullets(tuple(sentence(cases) for sentence in SENTENCES.values())),
    ]


def _table(data: pd.DataFrame, name: str, digits: int) -> Table:
    """A table of the four cases, its rows and columns in the order of the data."""
    rows = data[data["table"] == name]
    wide = rows.pivot(index="row", columns="case", values="value")
    wide = wide.loc[rows["row"].unique(), rows["case"].unique()]
    cells = (
        (str(row), *("" if pd.isna(value) else f"{value:.{digits}f}" for value in values))
        for row, values in zip(wide.index, wide.to_numpy(), strict=True)
    )
    return Table((name, *wide.columns), tuple(cells))


def page(four: pd.DataFrame, springs: pd.DataFrame) -> str:
    """The whole page, a view of the recorded numbers."""
    head = (Heading(1, "Error budget of the helix law"), Text(HEAD))
    return to_markdown([*head, *four_cases(four), *randompage.part(springs)])


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
