"""The page on the wire model's contact: what is measured of a run, and the page as a view of the runs."""

from dataclasses import asdict

import numpy as np
import pandas as pd
import pytest

from validation.verification import contact
from validation.verification.contact import NONE, Run, difference, measured

FAKE = {
    **{
        "ux": -20.0,
        "uy": -8.0,
        "rotz": 1.0,
        "outcome": "completed",
        "critical time": np.nan,
        "overlap": 0.03,
    },
    **{
        "penetration": 0.001,
        "force": 14.0,
        "forces": 50.0,
        "factorisations": 69,
        "pairs found": 0,
        "unlisted": 0,
    },
    **{"work": 0.0, "largest slip": 0.0, "last slip": 0.0, "couple": 0.0, "moment": 250.0, "seconds": 1.0},
}


def fake(runs, **changes):
    """Rows of runs that all have one answer; `changes` are functions of the run."""
    rows = [
        asdict(run) | FAKE | {name.replace("_", " "): change(run) for name, change in changes.items()}
        for run in runs
    ]
    return pd.DataFrame(rows)


def table(text, head):
    """Cells of the first table whose header begins so."""
    lines = text[text.index(f"| {head}") :].split("\n\n")[0].splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return pd.DataFrame(cells[2:], columns=cells[0])


def test_a_run_is_measured():
    data = measured([Run("B", NONE, steps=2), Run("A", 0.1, steps=2)])
    assert list(data["outcome"]) == ["completed"] * 2
    assert data["uy"][0] == pytest.approx(-15.374, abs=1e-2)
    assert data["work"][0] < 1e-3 * data["work"][1]
    assert 0.03 < data["overlap"][0] < 0.06
    assert data["penetration"][0] < 0.01
    assert (data["unlisted"] == 0).all()
    assert data["force"][0] == pytest.approx(1e4 * data["penetration"][0], rel=1e-9)


def test_differences_are_of_the_components_that_move():
    tips = pd.DataFrame({"ux": [0.0, 1e-12], "uy": [2.0, 2.2], "rotz": [0.1, 0.1]})
    np.testing.assert_allclose(difference(tips, tips.iloc[0]), [0.0, 0.1], atol=1e-12)


LIMIT = {"traced": 7, "limit": 0.6473, "first": 3, "second": 7, "circ": 96.0}


def wires(**changes):
    """Runs of spheres and wires that all have one answer, but for the changes."""
    names, changes = ("geometry", "phases", "cycles"), {"work": lambda run: 0.1} | changes
    return {name: fake(contact.RUNS[name], **changes) for name in names}


def every(**groups):
    """Runs that all have one answer but for the groups given."""
    return {name: fake(group) for name, group in contact.RUNS.items()} | wires() | groups


def page(**groups):
    """The page of runs that all have one answer but for the groups given."""
    return contact.page(every(**groups), LIMIT)


def test_the_pairs_are_compared_with_the_finest():
    data = fake(
        contact.RUNS["pairs"], uy=lambda run: -8.0 - 0.08 / run.pairs, seconds=lambda run: 0.1 * run.pairs
    )
    text = page(pairs=data, friction=fake(contact.RUNS["friction"], last_slip=lambda run: 0.3))
    rows = table(text, "spring | pairs per turn").set_index(["spring", "pairs per turn"])
    assert rows.loc[("A", "40"), "difference to 40"] == "0"
    assert rows.loc[("A", "4"), "difference to 40"] == "0.22 %"
    assert rows.loc[("B", "20"), "time over that of 4"] == "5.0"
    left = "4 pairs per turn leave 0.030 mm of overlap on Spring {}, 40 pairs 0.030 mm. Its tips with 4 "
    left += "pairs are 0.22 % from those with 40 pairs, which are 0.025 % from those with 20."
    assert all(left.format(name) in text for name in "AB")
    rough = data.assign(uy=data["uy"].where((data["spring"] == "B") | (data["pairs"] != 20), -8.1))
    moved = page(pairs=rough).split("4 pairs per turn leave")
    assert ["so that 40 pairs do not tell what 4 cost" in part for part in moved] == [False, True, False]
    assert "0.030 mm for the largest slip of Spring A with mu = 0.05, 0.30 mm" in text


def test_friction_that_ends_early_has_no_number():
    data = fake(
        contact.RUNS["friction"],
        work=lambda run: 0.0 if run.mu in (0.0, NONE) else 1.0 + 1.0 / run.steps,
        couple=lambda run: {0.1: 25.0, 0.3: 50.0, NONE: 125.0}.get(run.mu, 0.0),
        outcome=lambda run: "limit point" if (run.spring, run.mu) == ("B", 0.0) else "completed",
        critical_time=lambda run: 0.65,
    )
    text = page(friction=data)
    rows = table(text, "spring | mu").set_index(["spring", "mu"])
    assert rows.loc[("B", "0"), "UX"] == "limit point at t = 0.6500"
    assert rows.loc[("B", "0"), "change of the tips"] == ""
    assert rows.loc[("A", "0.1"), "change of the work, N mm"] == "0.095"
    assert rows.loc[("A", "no sliding"), "work of friction, N mm"] == "0"
    assert "a moment of 250 N mm" in text
    assert "10 % of it with mu = 0.1, 20 % with 0.3 and 50 % with no sliding" in text


def test_forces_of_pairs_are_compared_with_those_of_the_finest_mesh():
    off = {"wires": 0.4, "spheres": 0.004}
    data = fake(
        contact.RUNS["forces"],
        force=lambda run: 10.0 * (1.0 - off[run.geometry] / run.elements + off[run.geometry] / 64),
        forces=lambda run: 50.125 if (run.geometry, run.elements) == ("wires", 4) else 50.0,
    )
    text = page(forces=data)
    rows = table(text, "spring | contact | elements").set_index(["spring", "contact", "elements per turn"])
    assert rows.loc[("valve", "32 stations", "4"), "its deviation"] == "-9.38 %"
    assert rows.loc[("A", "4 spheres", "8"), "its deviation"] == "-0.04 %"
    assert ("A", "4 spheres", "64") not in rows.index
    words = " ".join(text.split())
    assert "With 4 elements per turn the largest force of a pair deviates by up to 9.4 % for wires" in words
    assert "and 0.094 % for spheres, the sum of forces by 0.25 % and 0, the tip by 0 and 0." in words


def test_the_page_follows_the_runs():
    text = page()
    assert "found 0 pairs. Arc length finds 7" in text
    assert "(t = 0.6473, arc length" in text
    pairs = fake(contact.RUNS["pairs"])
    pairs.loc[0, "pairs found"] = 5
    assert "found 5 pairs" in page(pairs=pairs)
    assert list(table(text, "spring | k")["K, N/mm^k"].unique()) == ["10000", "100000", "1e+06"]
    assert len(table(text, "spring | mu | K")) == len(contact.RUNS["search"])


def test_facts_are_those_of_the_rows():
    """What findings read: the fewest pairs, the last steps of friction, the last search."""
    pairs, search = (
        fake(runs, uy=lambda run: -8.0 - 0.08 / run.pairs)
        for runs in (contact.RUNS["pairs"], contact.RUNS["search"])
    )
    friction = fake(contact.RUNS["friction"], couple=lambda run: 125.0 if run.mu == NONE else 0.0)
    found = contact.facts(every(pairs=pairs, friction=friction, search=search), LIMIT)
    assert found["pairs.count"] == 4
    assert found["pairs.A.overlap"] == 0.03
    assert (found["friction.couples"], found["search.along"]) == (50.0, 96.0)
    assert (found["search.pairs"], found["search.outcome"]) == (80, "completed")


def test_wires_are_what_spheres_are_compared_with():
    """Spheres 1 % off in UY and with twice the work; those of frictionless B end early."""
    ended = {
        "outcome": lambda run: "limit point" if (run.geometry, run.mu) == ("spheres", 0.0) else "completed"
    }
    runs = wires(
        uy=lambda run: -8.08 if run.geometry == "spheres" else -8.0,
        work=lambda run: 0.2 if run.geometry == "spheres" else 0.1,
        critical_time=lambda run: 0.65,
        **ended,
    )
    text = page(**runs)
    rows = table(text, "spring | mu | contact").set_index(["spring", "mu", "contact"])
    assert rows.loc[("A", "0.1", "4 spheres"), "difference to 64 stations"] == "1 %"
    assert rows.loc[("B", "0", "20 spheres"), "UX"] == "limit point at t = 0.6500"
    assert table(text, "contact | work")["difference to 64 stations"].tolist()[0] == "+100.0 %"
    found = contact.facts(every(**runs), LIMIT)
    assert found["spheres.B.0.4.outcome"] == "limit point"
    assert found["spheres.A.0.3.4.difference"] == pytest.approx(1.0)
    assert found["coulomb.A.4.coefficients"] == [0.1, 0.2, 0.3]
    assert found["coulomb.A.4.differences"] == pytest.approx([1.0] * 3)
    assert (found["cycle.spheres.4"], found["cycle.wires.64"]) == (0.2, 0.1)
