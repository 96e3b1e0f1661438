"""The page on the beam's tangents: what a run becomes in its tables."""

from dataclasses import replace

import pandas as pd

from coilspring import spring_a, spring_b
from validation.verification import tangents


def test_outcomes_and_iterations():
    path = tangents.follow(spring_a(), "exact", 5)
    assert tangents.result(path) == str(path.total_iterations)
    scene = spring_b()
    early = tangents.follow(replace(scene, load=replace(scene.load, force=(0.0, -220.0))), "exact", 5)
    assert tangents.result(early) == "**limit point** at 0.934"


def test_the_page_says_if_a_run_ends_early():
    fifty = pd.DataFrame({"case": ["spring-a"], "CPU, ms": [1.0], "over exact": [1.0]})
    steps = pd.DataFrame({name: ["12", "34"] for name in tangents.TANGENTS})
    assert "Iterations to full load, which all 6 runs reach. What helps" in tangents.page(fifty, steps)
    steps.loc[1, "paper"] = "**limit point** at 0.934"
    text = tangents.page(fifty, steps)
    assert "or in bold what happened instead and when: 1 of 6 runs end before it. What helps" in text


def test_the_page_has_all_runs(monkeypatch):
    monkeypatch.setattr(tangents, "ROUNDS", 2)
    monkeypatch.setattr(tangents, "CATALOGUE", ("spring-b-no-contact",))
    rows = tangents.by_case()
    assert list(rows["tangent"]) == list(tangents.TANGENTS)
    assert rows["over exact"][0] == 1.0  # over itself
    counts = rows["iterations"]
    assert counts[0] < counts[1]  # exact and paper


def test_a_row_for_each_number_of_steps(monkeypatch):
    monkeypatch.setattr(tangents, "STEPS", (5,))
    monkeypatch.setattr(tangents, "PENALTIES", (1e4,))
    rows = tangents.by_steps()[["case", "penalty, N/mm", "steps"]].to_numpy().tolist()
    assert rows == [["spring-a", "1e+04", 5], ["spring-b", "1e+04", 5]]
