"""The page on the laws' errors: ``python -m validation.verification.ablation``.

``--page`` writes it of recorded numbers. Its words are in ``fourcases.md``, what each refinement of the helix
law is worth on the paper's four cases, and in ``randomsprings.md``.
"""

import argparse
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import equivbeam
import wirefe
from coilspring import EquilibriumPath, Scene
from coilspring.curves import compare_paths
from equivbeam import Refinements
from validation.study import template
from validation.study.cases import CASES, EXACT_ROD, turned
from validation.study.files import write_facts, write_text
from validation.study.frames import frame_table, read_csv, write_csv
from validation.study.partialsolve import partial_path
from validation.study.provenance import write_provenance
from validation.study.tables import Table
from validation.verification import randompage, randomsprings

PAGE = Path("docs/error-budget.md")
FOUR = Path("reports/errorbudget/fourcases.csv")
DIGITS = {"refinements": 3, "law": 3, "reference with": 3, "rod": 4}  # of each table on the page
DOUBLED = 2.0  # from which on a refinement is said to be needed
WORDS = template.template(Path(__file__).with_name("fourcases.md"))
TABLES = ("refinements", "law", "reference with", "outside", "rod")
CONVERGED: dict[str, Any] = {"element": "curved", "elements_per_turn": 16}
NOTHING = Refinements(**dict.fromkeys(vars(Refinements()), False))
# switches of the refinements, in the order in which they are added, and their names in the tables
STAGES = {
    "large": "Love's axial law, free winding",
    "held": "winding fixed",
    "shear": "wire shear",
    "stretch": "wire stretch",
    "taper": "taper",
    "lateral": "lateral by wire theory",
    "spread": "bending spread",
    "current": "at the current angle",
    "ends": "effect of fixed ends",
}

# Without `large` the axial rate is Haringx' constant one, which these do not enter: a group goes with it.
GROUP = ("held", "shear", "stretch", "taper", "ends")


def error(path: EquilibriumPath, reference: EquilibriumPath) -> float:
    """Largest error of the load curve, per cent of the reference's peak."""
    return 100.0 * compare_paths(path, reference).curve_max


def law_error(reference: EquilibriumPath, refinements: Refinements | None = None) -> float:
    """Error of the helix law with some of its refinements, by default all, per cent."""
    options = {"law": "helix", "sliding": "scene", "refinements": refinements or Refinements()}
    return error(partial_path(equivbeam.solve, reference.scene, **options), reference)


def case_numbers(scene: Scene) -> Iterator[tuple[str, str, float]]:
    """Table, row and value of all numbers of a case; not a number where a case has none."""
    reference = partial_path(wirefe.solve, scene, **CONVERGED)
    on = NOTHING
    yield "refinements", "Haringx, the paper's law", law_error(reference, on)
    for switch, name in STAGES.items():
        on = replace(on, **{switch: True})
        yield "refinements", f"+ {name}", law_error(reference, on)
    yield "law", "helix law", law_error(reference)
    for switch in STAGES:
        less = replace(Refinements(), **{switch: False})
        yield "law", f"without `{switch}`", law_error(reference, less)
    for degrees in (45, 90, 270):
        yield "law", f"helix law, start phase {degrees} degrees", phase_error(scene, degrees)
    pairs = reference.options["pairs_per_turn"]
    coarse = partial_path(wirefe.solve, scene, element="curved", elements_per_turn=8, pairs_per_turn=pairs)
    yield "reference with", "8 elements per turn", error(coarse, reference)
    if scene.contact.enabled:
        more = partial_path(wirefe.solve, scene, **CONVERGED, pairs_per_turn=2 * pairs)  # type: ignore[operator]
        yield "reference with", "twice the pairs per turn", error(more, reference)
    if scene.contact.enabled and scene.contact.sliding == "none":
        yield "outside", "normal forces", outside_share(reference)


def phase_error(scene: Scene, degrees: float) -> float:
    """Error of the law at another start phase, the wire model's the same, per cent.

    With contact each phase has its spheres elsewhere: other phases are other contact models.
    """
    if scene.contact.enabled:
        return math.nan
    scene = turned(scene, degrees)
    wire = wirefe.solve(scene, **CONVERGED)
    return error(equivbeam.solve(scene, law="helix"), wire)


def rod_numbers() -> Iterator[tuple[str, str, str, float]]:
    """UY of Spring B without contact, mm, and of the exact rod."""
    scene = CASES[3].scene.with_steps(2)
    options: dict[str, dict[str, Any]] = {
        "helix law": {"law": "helix"},
        "without `taper`": {"law": "helix", "refinements": Refinements(taper=False)},
        "Haringx": {},
    }
    exact = EXACT_ROD["spring-b-no-contact"]
    tips = {"exact rod": np.array([exact[time][1] for time in (0.5, 1.0)])}
    tips |= {name: equivbeam.solve(scene, **chosen).tips[:, 1] for name, chosen in options.items()}
    for name, (half, whole) in tips.items():
        yield from (("rod", name, "100 N", float(half)), ("rod", name, "200 N", float(whole)))


def outside_share(path: EquilibriumPath) -> float:
    """Share of a wire path's last normal forces in pairs outside the working plane, per cent."""
    pairs: np.ndarray = path.shape.pair_law.pairs
    # spheres stand at phases k pi / 2 from the bottom end on, which is a crossing of the plane
    odd = pairs[:, 0] % 2 == 1
    forces = path.contact_forces[-1]
    return float(100.0 * forces[odd].sum() / forces.sum())


def measured() -> pd.DataFrame:
    """All numbers of the four cases, a row each: its table, row and case."""
    numbers = [
        (table, row, case.title, value) for case in CASES for table, row, value in case_numbers(case.scene)
    ]
    data = pd.DataFrame([*numbers, *rod_numbers()], columns=["table", "row", "case", "value"])
    place = data.groupby(["table", "row"], sort=False).ngroup()
    tables = data["table"].map(TABLES.index)
    return data.iloc[np.lexsort((place, tables))].dropna(ignore_index=True)


class Cases:
    """The numbers of the four cases by table, row and case."""

    def __init__(self, data: pd.DataFrame) -> None:
        self.values = data.set_index(["table", "row", "case"])["value"].to_dict()
        self.titles = [case for table, row, case in self.values if (table, row) == ("law", "helix law")]

    def law(self, case: str, without: str = "") -> float:
        """Error of the law, or of the law without a refinement, per cent."""
        return self.values["law", f"without `{without}`" if without else "helix law", case]

    def needed(self, case: str) -> str:
        """Single refinements without which the error at least doubles."""
        single = [name for name in STAGES if name != "large"]
        names = [f"`{name}`" for name in single if self.law(case, name) >= DOUBLED * self.law(case)]
        return ", ".join(names) or "none"

    def most_moved(self, switch: str) -> float:
        """Most by which leaving a refinement out changes the error of the law, per cent of the peak."""
        return max(abs(self.law(case, switch) - self.law(case)) for case in self.titles)

    def off_the_rod(self, row: str, load: str) -> float:
        """Error of a law against the exact rod, per cent."""
        return 100.0 * (self.values["rod", row, load] / self.values["rod", "exact rod", load] - 1.0)


def tables(data: pd.DataFrame) -> dict[str, Table]:
    """Tables of the four cases, their rows and columns in the order of the data."""
    found = {}
    for name, digits in DIGITS.items():
        rows = data[data["table"] == name]
        wide = rows.pivot(index="row", columns="case", values="value")
        wide = wide.loc[rows["row"].unique(), rows["case"].unique()]
        formats = dict.fromkeys(wide.columns, f"{{:.{digits}f}}")
        wide = wide.rename(index={"without `large`": "without `large` and its group"})
        found[name] = frame_table(wide.rename_axis(name).reset_index(), formats)
    return found


def page(four: pd.DataFrame, springs: pd.DataFrame) -> str:
    """The whole page, a view of the recorded numbers."""
    first = template.page(WORDS, f=Cases(four), tables=tables(four), stages=STAGES, group=GROUP)
    return f"{first}\n{randompage.page(springs)}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Solve everything, unless only the page is wanted; write numbers, figure and page."""
    command = "python -m validation.verification.ablation"
    parser = argparse.ArgumentParser(prog=command, description=__doc__)
    words = "write the page of the recorded numbers, solve nothing"
    parser.add_argument("--page", action="store_true", help=words)
    if not parser.parse_args(arguments).page:
        FOUR.parent.mkdir(parents=True, exist_ok=True)
        write_csv(measured(), FOUR)
        write_csv(randomsprings.study(), randomsprings.CSV, digits=4)
        write_provenance(command, FOUR.parent)
    springs = read_csv(randomsprings.CSV)
    randompage.write_figure(springs)
    write_facts(randompage.facts(springs), FOUR.parent)
    write_text(PAGE, page(read_csv(FOUR), springs))


if __name__ == "__main__":
    main()
