"""The numbers behind the page on the helix law's refinements, with errors in place of solves."""

import math

import numpy as np
import pandas as pd
import pytest

from coilspring import spring_a, spring_b
from equivbeam import Refinements
from equivbeam.laws.helix import L0, helix_response, helix_rows
from validation.verification import ablation
from validation.verification.ablation import FOUR, Cases, tables


@pytest.fixture
def counted(monkeypatch):
    """An error is the number of refinements that are switched on."""

    def count(reference, refinements=None):
        return float(sum(vars(refinements or Refinements()).values()))

    monkeypatch.setattr(ablation, "law_error", count)
    monkeypatch.setattr(ablation, "phase_error", lambda scene, degrees: math.nan)


def test_refinements_come_one_after_the_other_and_go_alone(counted):
    numbers = list(ablation.case_numbers(spring_a().with_steps(2)))
    whole = len(ablation.STAGES)
    added = [value for table, _, value in numbers if table == "refinements"]
    assert added == list(range(whole + 1))
    less = [value for table, row, value in numbers if table == "law" and row.startswith("without")]
    assert less == [whole - 1] * whole
    found = {row: value for table, row, value in numbers if table == "reference with"}
    assert 0.0 < found["8 elements per turn"] < found["twice the pairs per turn"] < 1.0
    assert not [row for table, row, _ in numbers if table == "outside"]  # Spring A's coils slide


@pytest.mark.parametrize("switch", [*ablation.STAGES][1:])
def test_what_goes_with_large_deformation(switch):
    """Without it a half coil that is pressed along its axis answers the same with the others and without."""

    def answers(**on):
        rows = helix_rows(spring_b().spring, spring_b().material, Refinements(**({"ends": False} | on)))
        found = [helix_response(rows, i, 0.9 * rows[i, L0], 0.0, 0.0) for i in range(len(rows))]
        return np.array([(each.N, each.N_l, each.N_v, each.N_m) for each in found])

    assert np.array_equal(*(answers(large=False, **{switch: on}) for on in (False, True)))
    same = np.allclose(*(answers(**{switch: on}) for on in (False, True)), rtol=1e-9)
    assert same == (switch not in ablation.GROUP)


def test_a_group_is_no_single_refinement():
    """However bad the law is without it; its row says what it is."""
    four = pd.read_csv(FOUR)
    case = "Spring B w/o contacts"
    assert Cases(four).law(case, "large") > 2.0 * Cases(four).law(case)
    assert Cases(four).needed(case) == "`held`, `shear`"
    assert "without `large` and its group" in [row[0] for row in tables(four)["law"].rows]
    springs = pd.read_csv(ablation.randomsprings.CSV)
    assert "Without `large` and its group the error is 0.11 and 2.56 %" in ablation.page(four, springs)
    four.loc[(four["row"] == "without `held`") & (four["case"] == case), "value"] = 0.2
    assert "on Spring B for `shear`." in ablation.page(four, springs)


def test_every_refinement_has_a_switch():
    assert set(ablation.STAGES) == set(vars(Refinements()))


def test_pairs_outside_the_plane(counted):
    numbers = list(ablation.case_numbers(spring_b().with_steps(2)))
    share = next(value for table, _, value in numbers if table == "outside")
    assert 0.0 < share < 100.0


def test_numbers_stand_by_table_and_row(counted, monkeypatch):
    """Cases beside each other, as the page has them; what a case has not is left out."""
    monkeypatch.setattr(ablation, "CASES", ablation.CASES[1::2])
    monkeypatch.setattr(ablation, "rod_numbers", lambda: [("rod", "exact rod", "100 N", -6.0)])
    data = ablation.measured()
    assert list(data["table"].unique()) == ["refinements", "law", "reference with", "rod"]
    assert data.groupby(["table", "row"], sort=False).size().tolist()[:-1] == [2] * (len(data) // 2)
    assert not data["row"].str.contains("phase").any()


def test_the_page_has_every_number_of_its_tables():
    data = pd.read_csv(FOUR)
    rows = {row[0]: row[1:] for row in tables(data)["law"].rows}
    cases = Cases(data)
    printed = [float(cell) for cell in rows["helix law"]]
    np.testing.assert_allclose(printed, [cases.law(case) for case in cases.titles], atol=5.1e-4)
    phases = rows["helix law, start phase 45 degrees"]
    assert [cell == "" for cell in phases] == ["w/o" not in case for case in cases.titles]
