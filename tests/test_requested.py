"""Accuracy on request, measured: the page says what the recorded rows say, also if they said otherwise."""

import math
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from coilspring import InputError
from validation.study.template import statement
from validation.verification import requested, requestedpage
from validation.verification.requestedpage import FREE, HELD, OPEN, ROUGH, WIRES, WORDS, prepared, short
from validation.verification.requestedruns import (
    ACCURACIES,
    OTHERS,
    PLATES,
    REFUSED,
    SECTIONS,
    UNLOADED,
    springs,
)

ROOT = Path(__file__).parents[1]
FOUND = {"stations": 64.0, "estimated": 2e-5, "true": 1e-5, "seconds": 0.5, "cheapest": 0.2}
CONTACTS = {OPEN: "none", FREE: "spheres free", HELD: "spheres coulomb", WIRES: "wires free"}


@pytest.fixture(scope="module")
def recorded():
    return pd.read_csv(ROOT / requested.RECORD / requested.CSV)


def fake(count=10, seed=1, contacts=CONTACTS, **changes):
    """Rows of so many springs of each contact that all have one good answer, but for the changes."""
    head = {
        "sources": "0123",
        "kind": "guided, axial force",
        "coils": 4.0,
        "reference": "completed",
        "own": 1e-6,
    }
    rows = [
        {"seed": seed, "number": f"{number}{contact}", "contact": contact, "closed": int(coils != OPEN)}
        | {"asked": asked, "outcome": "completed", "level": 4} | head | FOUND | changes
        for coils, contact in contacts.items() for number in range(count) for asked in (1e-2, 1e-3, 1e-4)
    ]  # fmt: skip
    return pd.DataFrame(rows)


def refused(rows, chosen=slice(None)):
    """The rows with refusals in place of some answers."""
    rows = rows.copy()
    rows.loc[chosen, ["outcome", *FOUND]] = [REFUSED] + [math.nan] * len(FOUND)
    return rows


def said(name, rows):
    return statement(WORDS, name, prepared(rows))


def test_page_is_a_view_of_the_recorded_rows(recorded):
    assert (ROOT / requested.PAGE).read_text(encoding="utf-8") == requestedpage.page(recorded)


def perturbed(data):
    """Other springs, kinds, errors, estimates, times and refusals."""
    rng = np.random.default_rng(2)
    factors = rng.uniform(0.2, 5.0, (len(data), 4))
    seed = 9 if data.seed.isin(requestedpage.SEEN).any() else requestedpage.SEEN[0]
    data = data.assign(
        seed=seed, coils=data.coils + 0.25, contact=data.contact.replace("spheres free", "wires none")
    )
    kinds = {PLATES: UNLOADED} if (data.kind == PLATES).any() else {data.kind.iloc[0]: PLATES}
    data = data.assign(kind=data.kind.replace(kinds))
    data[["own", "estimated", "true", "seconds"]] *= factors
    data.loc[::7, "cheapest"] = math.nan
    return refused(data, data.index[::11])


@pytest.mark.parametrize("name", WORDS.blocks)
def test_sentences_follow_the_rows(name, recorded):
    before, after = said(name, recorded), said(name, perturbed(recorded))
    assert after != before
    pairs = list(zip(*(re.findall(r"\d+\.\d+", text) for text in (before, after)), strict=False))
    assert not pairs or sum(old != new for old, new in pairs) > len(pairs) / 2, pairs


def test_the_bound_is_compared_with_the_rate():
    assert said("failures", fake(100)).count("which is below 1 %") == 3
    assert said("failures", fake(10)).count("which is not below 1 %") == 3
    rows = fake(100)
    rows.loc[2, "true"] = 1.5e-4
    one = "1e-4, 1 of 400 answers is off by more than asked; the reference's own error {} explain it. The "
    assert one.format("cannot") in said("failures", rows)
    rows.loc[2, "own"] = 1e-4
    assert one.format("can") in said("failures", rows)
    rows.loc[rows.asked == 1e-3, "true"] = 2e-3
    assert "At 1e-3, 400 of 400 answers are off by more than asked; the reference's" in said("failures", rows)
    assert "can explain none of them" in said("failures", rows)
    rows.loc[rows.index[rows.asked == 1e-3][:3], "own"] = 1e-3
    assert "can explain 3 of them" in said("failures", rows)
    assert "100 %, which is not below" in said("failures", rows)


def test_estimates_and_errors_turn():
    assert "The median of the estimate over the error is" in said("estimates", fake())
    assert "smaller than the error for 0 of 120 answers" in said("estimates", fake())
    rows = fake(estimated=5e-6)
    assert "0.5 at 1e-2" in said("estimates", rows)
    assert "smaller than the error for 120 of 120 answers" in said("estimates", rows)
    assert "No answer is off" in said("worst", rows)
    rows.loc[(rows.contact == "wires free") & (rows.asked == 1e-4), "true"] = 3e-4
    rows.loc[2, "true"] = math.inf
    text = said("worst", rows)
    assert f"11 answers are off by more than asked (1 with {OPEN}, 10 with {WIRES})" in text
    assert "The largest finite error is 3 times" in text
    assert "1 path of these ends otherwise than the reference" in text


def test_the_reference_is_exact_enough_or_not():
    assert "1e-6, which is smaller than the error" in said("reference", fake())
    assert "2e-3, which is not smaller than the error" in said("reference", fake(own=2e-3))
    assert "infinite" in said("reference", fake(own=math.inf))
    assert said("reference", fake(contacts={OPEN: "none"})) == "No spring has wires that slide freely."


def test_times_turn():
    rows = fake()
    rows.loc[rows.contact == "spheres coulomb", "seconds"] = 3.0
    assert f"longest for {HELD}, 15 in the median" in said("time", rows)
    rows.loc[rows.contact == "wires free", "seconds"] = 5.0
    assert f"longest for {WIRES}, 25 in the median" in said("time", rows)
    assert "For every answer there is a single run" in said("slowest", rows)
    rows.loc[0, "cheapest"] = math.nan
    assert "For 1 answer no single run is exact enough" in said("slowest", rows)


def test_seeds_that_were_used_are_said_to_be():
    assert "None of these seeds" in said("seen", fake(seed=1))
    both = pd.concat((fake(seed=1), fake(seed=20)))
    assert "chosen: 20. Springs of these seeds do not test" in said("seen", both)
    assert "80 springs of 2 seeds (1 and 20)" in said("population", both)


def test_contacts_that_no_spring_has():
    assert "None has wires with friction or sticking wires: of these" in said("contact", fake())
    rough = pd.concat(
        fake(seed=seed, contacts={ROUGH: f"wires {how}"}) for seed, how in enumerate(("coulomb", "none"))
    )
    assert "None has" not in said("contact", rough)
    assert f"20 springs have {ROUGH}" in said("contact", rough)


def test_the_limits_say_what_the_springs_have_not(recorded):
    absent = " or ".join(requestedpage.absent(prepared(recorded)))
    limits = " ".join((ROOT / "docs/limits.md").read_text(encoding="utf-8").split())
    said = re.findall(r"None of its springs has (.*?): how often it fails", limits)
    assert said == ([absent] if absent else [])


@pytest.mark.parametrize(
    "rows",
    [
        refused(fake()),
        refused(fake(), fake().asked == 1e-4),
        refused(fake(), fake().contact == "wires free"),
        fake(cheapest=math.nan),
        fake(own=math.inf, true=math.inf),
        fake(true=0.0),
        fake(1, contacts={FREE: "spheres free"}),
    ],
    ids=["nothing", "coarse only", "no wires", "no times", "otherwise", "exact", "one"],
)
def test_a_page_of_whatever_is_found(rows):
    text = requestedpage.page(rows)
    words = "\n".join(line for line in text.splitlines() if not line.startswith("|"))
    assert not re.search(r"\bnan\b|None(?! of| has)|\{|  | [.,]|0 of 0 answers", words)


def test_numbers_as_accuracies_are_written():
    values = [1e-2, 1e-4, 1.23e-4, 0.123, 2.46, 12.3, 99.7, 102.0, 0.0, math.inf, math.nan]
    assert [*map(short, values)] == [
        "1e-2",
        "1e-4",
        "1.2e-4",
        "0.12",
        "2.5",
        "12",
        "100",
        "102",
        "0",
        "infinite",
        "",
    ]


def test_springs_are_what_the_page_says():
    """Rigid ends and one load but in kinds of their own; whole and half coils, as `docs/limits.md` says."""
    found = [(drawn, scene) for drawn, scene in springs(6)]
    assert len({(drawn.seed, drawn.kind, drawn.number) for drawn, _ in found}) == len(found) == 6 * 11
    for drawn, scene in found:
        back = len(scene.load.stages or scene.load.displacement or (0.0,))
        assert (scene.supports.seat == "plate") == (drawn.kind == PLATES)
        assert back == (2 if drawn.kind == UNLOADED else 1)
        assert 2.0 * scene.spring.active_coils % 1.0 == 0.0
        if drawn.kind == SECTIONS:
            assert scene.spring.sections
        if drawn.kind in OTHERS and not scene.load.displacement:
            (x, y), *_ = scene.load.stages or (scene.load.force,)
            assert y < -10.0 * abs(x)
    assert max(len(scene.spring.sections) for drawn, scene in found if drawn.kind == SECTIONS) > 2


@pytest.fixture
def solved(monkeypatch):
    """Seeds of the springs that were solved, one after the other; all have one good answer."""
    seeds = []

    def three(drawn, scene):
        seeds.append(drawn.seed)
        row = {"seed": drawn.seed, "kind": drawn.kind, "number": drawn.number, "level": 4}
        found = {"outcome": "completed", "own": 1e-7, "contact": "none", "closed": 0}
        rows = [row | found | FOUND | {"asked": asked} for asked in ACCURACIES]
        return [*rows[:2], rows[2] | {"outcome": REFUSED, "true": math.nan}]

    monkeypatch.setattr(requested, "rows", three)
    return seeds


def test_several_seeds_go_on_where_they_were_interrupted(tmp_path, solved):
    arguments = ["--out", str(tmp_path), "--each", "1", "--seed"]
    requested.main([*arguments, "1"])
    requested.main([*arguments, "1", "2"])
    assert solved == [1] * 11 + [2] * 11
    assert len(pd.read_csv(tmp_path / requested.CSV)) == 66


@pytest.mark.parametrize("left", [1, 2, 3, 4], ids=lambda left: f"{left} lines")
@pytest.mark.parametrize("cut", [0, 1, 30], ids=["between rows", "before the end of a line", "amid a row"])
def test_a_spring_of_which_rows_are_missing_is_solved_again(left, cut, tmp_path, solved):
    """The first three lines are the columns and two of the three rows of the first spring."""
    whole = requested.study(tmp_path, 1, (1,))
    file = tmp_path / requested.CSV
    text = file.read_text()
    lines = text.splitlines(keepends=True)
    part = "".join(lines[:left])
    file.write_text(part[: len(part) - cut])
    solved.clear()
    pd.testing.assert_frame_equal(requested.study(tmp_path, 1, (1,)), whole)
    assert len(solved) == (10 if (left, cut) == (4, 0) else 11)
    assert file.read_text() == text


def test_rows_of_runs_are_recorded_letter_for_letter(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("docs").mkdir()
    files = [Path(f"{seed}.csv") for seed in (1, 2)]
    for seed, file in enumerate(files, 1):
        fake(seed=seed).to_csv(file, index=False)
    requested.main(["--page", *map(str, files)])
    first, second = (file.read_text() for file in files)
    assert (requested.RECORD / requested.CSV).read_text() == first + second.partition("\n")[2]
    assert "80 springs of 2 seeds" in requested.PAGE.read_text()
    with pytest.raises(InputError, match="one that is in two"):
        requested.record([files[0], files[0]])
    fake().drop(columns="own").to_csv(files[1], index=False)
    with pytest.raises(InputError, match="the same columns"):
        requested.record(files)
    assert "80 springs of 2 seeds" in requested.PAGE.read_text()
