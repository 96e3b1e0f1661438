"""The page on the beam's tangents: what a run becomes in its tables."""

from dataclasses import replace

import pytest

from coilspring import spring_a, spring_b
from validation.verification import tangents


def test_outcomes_and_iterations():
    path = tangents.follow(spring_a(), "exact", 5)
    assert tangents.result(path) == str(path.total_iterations)
    scene = spring_b()
    early = tangents.follow(replace(scene, load=replace(scene.load, force=(0.0, -220.0))), "exact", 5)
    assert tangents.result(early) == "**limit point** at 0.934"


def test_the_page_has_all_runs(monkeypatch):
    monkeypatch.setattr(tangents, "ROUNDS", 2)
    monkeypatch.setattr(tangents, "CASES", ("spring-b-no-contact",))
    _, table = tangents.by_case()
    assert [row[1] for row in table.rows] == list(tangents.TANGENTS)
    assert table.rows[0][-1] == "1.0"  # over itself
    counts = [int(row[2]) for row in table.rows]
    assert counts[0] < counts[1]  # exact and paper


@pytest.mark.parametrize(("steps", "penalties"), [((5,), (1e4,))])
def test_a_row_for_each_number_of_steps(monkeypatch, steps, penalties):
    monkeypatch.setattr(tangents, "STEPS", steps)
    monkeypatch.setattr(tangents, "PENALTIES", penalties)
    table = tangents.by_steps()[-1]
    assert [row[:3] for row in table.rows] == [("spring-a", "1e+04", "5"), ("spring-b", "1e+04", "5")]
