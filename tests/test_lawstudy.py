"""The study of a user's law: its pieces are done once, and its page follows from its rows."""

from __future__ import annotations

from concurrent.futures import Executor, Future
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from coilspring import spring_b
from equivbeam.laws import law_of
from equivbeam.laws.halfcoil import spring_coils
from validation.campaign.laws import PlainEnergy, coils_of, plain_law
from validation.campaign.run import verified
from validation.cli import main
from validation.lawstudy import checks, page, run, springs
from validation.study import template
from validation.study.cases import CASES, study_scenes

EXAMPLES = Path(__file__).parents[1] / "examples"
PAPER, RADIAL = EXAMPLES / "law_paper.py", EXAMPLES / "law_radial.py"
BRANCHED = """
def parameters(coil):
    return 2.0, 3.0, 5.0, coil.length

def energy(l, v, dtheta, p):
    x = l - p[3]
    more = x**4 if x < 0 else 2 * x**4
    return (p[0] * x**2 + p[1] * v**2 + p[2] * dtheta**2) / 2 + more + 0.3 * x * v * dtheta
"""


class Serial(Executor):
    """Does its work in this process."""

    def submit(self, function, *arguments, **named):
        done: Future = Future()
        done.set_result(function(*arguments, **named))
        return done


@pytest.fixture
def small(monkeypatch, tmp_path):
    """A study of few springs and scenes, with a store of its own."""
    monkeypatch.setattr(run, "processes", lambda count: Serial())
    monkeypatch.setenv("COILCHECK_STORE", str(tmp_path / "store"))
    monkeypatch.setattr(run, "QUICK", (springs.Extent((0,), 1), 2))
    monkeypatch.setattr(run, "KINDS", run.KINDS[3:5])
    monkeypatch.setattr(springs, "study_scenes", lambda: {"spring-b": study_scenes()["spring-b-no-contact"]})
    monkeypatch.setattr(springs, "CASES", CASES[2:3])
    monkeypatch.setattr(springs, "ROUNDS", 1)


def test_study(small, tmp_path, capsys):
    """All parts, the second time from the store; the page's verdicts are those of its rows."""
    out = tmp_path / "out"
    assert main(["study-law", str(PAPER), "--quick", "--out", str(out)]) == 0
    said = capsys.readouterr().out
    text, data = (out / "law.md").read_text(), pd.read_csv(out / "law.csv")
    assert "every outcome is explained" in said
    assert all(line in text for line in said.splitlines()[:-1])
    assert set(data["part"]) == {
        "derivatives",
        "limits",
        "half coil",
        "cases",
        "place",
        "springs",
        "stability",
    }
    cases = data[data["part"] == "cases"]
    np.testing.assert_allclose(cases["law_error"], cases["haringx_error"], rtol=1e-4)
    lines: list[str] = []
    run.study_law(run.tried(PAPER), tmp_path / "again", lines.append, quick=True)
    assert not [line for line in lines if "random springs" in line or "solve" in line or "stability" in line]
    assert (tmp_path / "again/law.csv").read_bytes() == (out / "law.csv").read_bytes()
    lines.clear()
    run.study_law(run.tried(RADIAL), tmp_path / "other", lines.append, quick=True)
    assert not [line for line in lines if "wire model" in line]  # its curves serve every law
    assert [line for line in lines if "random springs, part" in line]


@pytest.mark.parametrize(
    ("kept", "said"),
    [(True, ": what is solved is kept; the same command goes on"), (False, "")],
    ids=["with a store", "without"],
)
def test_an_interrupted_study_says_what_is_kept(kept, said, small, tmp_path, monkeypatch, capsys):
    def interrupt(*given):
        raise KeyboardInterrupt

    monkeypatch.setattr(run, "_place", interrupt)
    if not kept:
        monkeypatch.setattr(run, "default_folder", lambda: None)
    assert main(["study-law", str(PAPER), "--quick", "--out", str(tmp_path / "out")]) == 130
    assert capsys.readouterr().err == f"coilcheck: interrupted{said}\n"


@pytest.mark.parametrize(
    ("files", "said"),
    [
        (["law_paper.py", "law_paper.py"], "FILE.py must be files of different names, got law_paper twice"),
        (["law_paper.py", "other/law_paper.py"], "FILE.py must be files of different names, got law_paper t"),
        (["law_paper.py", "scene.py"], "law scene.py must have a function parameters(coil), got None"),
    ],
)
def test_all_laws_are_checked_before_one_is_studied(files, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for place in (Path(), Path("other")):
        place.mkdir(exist_ok=True)
        (place / "law_paper.py").write_bytes(PAPER.read_bytes())
    Path("scene.py").touch()
    monkeypatch.setattr(run, "study_law", lambda *_, **__: pytest.fail("studied in vain"))
    assert main(["study-law", *files, "--out", "out"]) == 2
    assert capsys.readouterr().err.startswith(f"coilcheck: {said}")
    assert not Path("out").exists()


def test_verifier_differentiates_the_plain_energy(tmp_path):
    (tmp_path / "law.py").write_text(BRANCHED)
    scene, rng = spring_b(), np.random.default_rng(3)
    for file, whole in ((RADIAL, True), (tmp_path / "law.py", False)):
        law = law_of(file)
        coils = coils_of(scene)
        for mine, theirs in zip(coils, spring_coils(scene.spring, scene.material), strict=True):
            ours, others = vars(mine), vars(theirs)
            assert {name: ours[name] for name in ("hand", "index")} == {
                name: others[name] for name in ("hand", "index")
            }
            numbers = [name for name in ours if name != "hand"]
            assert [ours[name] for name in numbers] == pytest.approx(
                [others[name] for name in numbers], rel=1e-12
            )
        energy = PlainEnergy(law, coils)
        x = rng.normal(size=(3, 4, len(coils))) * 0.1 * energy.size[:, None]
        x[0] += energy.size[0]
        U, g, H = energy.derivatives(x, second=True)
        assert energy._whole == whole
        index = np.tile(np.arange(len(coils)), 4)
        found = law.evaluated(law.rows(scene.spring, scene.material), index, x.reshape(3, -1).T)
        np.testing.assert_allclose(U.ravel(), found[:, 0], rtol=1e-13)
        np.testing.assert_allclose(g.reshape(3, -1).T, found[:, 1:4], rtol=1e-9, atol=1e-9)
        second = found[:, (4, 5, 6, 5, 7, 9, 6, 9, 8)]
        np.testing.assert_allclose(H.reshape(9, -1).T, second, rtol=1e-6, atol=1e-7 * np.abs(second).max())
        N, _, _ = plain_law(scene, law)(*(x[:, :1] + 1e-30j * np.array([1.0, 0.0, 0.0])[:, None, None]))
        np.testing.assert_allclose(N.imag[0] / 1e-30, H[0, 0, 0], rtol=1e-9)


def test_a_wrong_derivative_is_found(monkeypatch):
    """What the solver uses is compared with what the verifier makes of the plain function."""
    law = law_of(RADIAL)
    wrong = law_of(EXAMPLES / "law_paper.py")
    assert verified("b000001", 1, law)["class"] == "completed"
    monkeypatch.setattr("validation.campaign.energy.plain_law", lambda scene, _: plain_law(scene, wrong))
    assert "no equilibrium" in verified("b000001", 1, law)["reason"]


def test_how_far_a_half_coil_holds(tmp_path):
    (tmp_path / "law.py").write_text(
        "from math import log\n\ndef parameters(coil):\n    return coil.length, 1.0\n\n"
        "def energy(l, v, dtheta, p):\n    x = l / p[0] - 1\n"
        "    return x**2 - x**3 / 3 + v**2 + (dtheta**2 + v * dtheta) * p[1]\n"
    )
    rows = pd.DataFrame(checks.holds(law_of(tmp_path / "law.py"))).set_index(["spring", "direction"])
    assert rows.loc[("spring-b", "drawn out"), "what"] == "is not stable"
    assert rows.loc[("spring-b", "drawn out"), "share"] == pytest.approx(1.0, abs=2e-3)
    assert rows.loc[("spring-b", "sheared"), "what"] == "holds"


def row(kind: str, closed: int, law: float, outcome: str = "completed") -> dict:
    """A random spring on which haringx is off by 4 % and helix by 1."""
    found = {"seed": 0, "kind": kind, "number": 0, "shape": "cone", "contact": closed > 0, "closed": closed}
    found |= {"wire": "completed"}
    for name, error in (("haringx", 4.0), ("helix", 1.0), ("law", law)):
        found |= {name: outcome} | {f"{name}_{part}": error for part in ("vector", "ux", "uy", "rotz")}
    return found


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (4.0, "is that of haringx"),
        (5.0, "larger than"),
        (2.5, "takes away 50 %"),
        (0.5, "below that of helix"),
    ],
)
def test_verdict_follows_the_rows(error, words):
    kinds = ["free top, lateral"] * 6 + ["guided, axial force"] * 6
    data = springs.frame([row(kind, 0, error) for kind in kinds])
    assert words in template.statement(page.WORDS, "gain", {"springs": data})


def test_what_breaks_first():
    rows = [row("free top, lateral", 0, 1.0) for _ in range(8)]
    rows += [row("guided, axial force", 0, 6.0 if number < 3 else 1.0) for number in range(8)]
    holds = pd.DataFrame(
        {"spring": ["a"], "direction": ["bent"], "share": [1.0], "unit": ["rad"], "what": ["holds"]}
    )
    sentence = template.statement(page.WORDS, "breaks", {"springs": springs.frame(rows), "half coil": holds})
    assert "guided, axial force, without contact, where 3 of 8 springs" in sentence
    assert "no half coil" in sentence


def test_a_path_that_ends_early_is_marked_beside_its_error_and_time():
    names = [*page.COMPARED, *springs.MESHES]
    values = {"error": 1.0, "ms": 2.0, "outcome": "completed"}
    place = pd.DataFrame({"scene": "spring-b", "series": names} | values)
    place.loc[1, "outcome"] = "limit_point"
    assert [page.early(row) != "" for row in place.itertuples()] == [False, True, *[False] * (len(names) - 2)]
    (axes,) = [axes for axes in page.draw(place).axes if axes.get_title() == "spring-b"]
    assert [line.get_fillstyle() for line in axes.lines[:3]] == ["full", "none", "full"]
