"""What the report is made of: evidence, verdicts, shapes, spreads of times, and the document itself."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from jinja2 import UndefinedError

import validation.reproduce.facts as facts_module
from test_statements import NAMES, NUMBER
from validation.reproduce import report
from validation.reproduce.claims import DIFFERS, VERDICTS, claim_table
from validation.reproduce.facts import B, facts, frictionless, mesh_error
from validation.reproduce.figures import load_figure, tip_figure
from validation.reproduce.phases import SOFTER, over_phases, phase_table, turned_by
from validation.study import cases, paths, timing
from validation.study.cases import EXACT_ROD
from validation.study.tables import Table
from validation.study.template import statement, template, unwrapped
from validation.view import shapes

STORE = paths.PathStore(lambda line: None)


@pytest.fixture(scope="module")
def phases() -> pd.DataFrame:
    return over_phases(STORE)


def measured() -> pd.DataFrame:
    """Times that nobody measured: the paper's, as if they were ours."""
    rows = []
    for case in cases.CASES:
        seconds = {"wire_seconds": case.paper_wire, "beam_seconds": case.paper_beam}
        seconds |= {"beam_paper_tangent_seconds": case.paper_beam, "ratio": case.paper_wire / case.paper_beam}
        spreads = {
            key: n for name, value in seconds.items() for key, n in timing.quartiles(name, [value]).items()
        }
        rows.append({"case": case.name, "reduction_percent": 1.0, "paper_reduction_percent": 1.0, **spreads})
        rows[-1] |= dict.fromkeys(("wire_iterations", "beam_iterations", "beam_paper_tangent_iterations"), 1)
        rows[-1] |= {
            "rounds": 5,
            "paper_wire_seconds": case.paper_wire,
            "paper_beam_seconds": case.paper_beam,
        }
        rows[-1] |= dict.fromkeys(("measured", "processor", "cores", "system", "versions"), "none")
    return pd.DataFrame(rows)


def page(phases: pd.DataFrame) -> str:
    """The report as Markdown."""
    return report.compose(facts(STORE, measured(), phases), STORE, measured(), phases, True, ())


def test_every_number_and_verdict_of_the_report_is_a_statement():
    """Text between the blocks defines and names; captions too."""
    source = Path(report.__file__).with_name("report.md").read_text(encoding="utf-8")
    plain = re.sub(r"{% block .*?{% endblock %}|{[#%{].*?[#%}]}", "", source, flags=re.DOTALL)
    assert len(re.findall(r"{% block ", source)) == len(report.REPORT.blocks) > 15
    assert len(plain.split()) > 300
    assert not NUMBER.findall(NAMES.sub("", plain))
    assert not [word for word in (*VERDICTS, "matches", "faster") if word in plain]


def test_lines_of_a_paragraph_are_joined():
    text = (
        "# A\n\none\ntwo, 3.\n4 five\n\n- six\n  seven\n- eight\n\n| a |\n| - |\n| b |\n\n1. nine\n2. ten\n"
    )
    assert unwrapped(text) == (
        "# A\n\none two, 3. 4 five\n\n- six seven\n- eight\n\n| a |\n| - |\n| b |\n\n1. nine\n2. ten"
    )


def test_what_a_template_names_and_nobody_gives_is_an_error(tmp_path):
    (tmp_path / "page.md").write_text("{% block one %}{{ f['a'] }}{% endblock %}")
    source = template(tmp_path / "page.md")
    assert statement(source, "one", {"a": 1}) == "1"
    with pytest.raises(UndefinedError):
        statement(source, "one", {})


def test_the_headline_follows_the_curves(phases, monkeypatch):
    """The evidence itself is changed: every curve is off by half of its peak."""
    assert "**The proposed model matches the wire model where " in page(phases)
    sound = facts_module.compare_paths
    monkeypatch.setattr(facts_module, "compare_paths", lambda *each: replace(sound(*each), curve_max=0.5))
    assert "**The proposed model does not match the wire model (Spring A, " in page(phases)
    assert claim_table(facts(STORE, measured(), phases)).rows[0][3] == DIFFERS


def test_a_path_that_ends_is_not_compared():
    """Frictionless Spring B, whose wire model ends at a limit point."""
    row = turned_by(STORE, frictionless(B), 0, 4)
    assert row.keys() == {"pairs_per_turn", "degrees", "outcome"}
    assert row["outcome"].startswith("limit point at t = 0.65")


def test_a_phase_that_is_not_completed_is_told_and_not_counted(phases):
    broken = phases.copy()
    place = broken.index[(broken["contact"] == "many") & (broken["degrees"] == 30)][0]
    broken.loc[place, "outcome"] = "limit point at t = 0.500"
    assert facts(STORE, measured(), broken)["phases.many.degrees"] == (0, *range(60, 360, 30))
    assert "limit point at t = 0.500" in phase_table(broken).rows[1]


def test_the_sign_changes_with_the_phase(phases):
    """Spring A without contact: the beam is softer all along at 30 degrees, as the paper says."""
    bare = phases[phases["contact"] == "bare"].set_index("degrees")
    assert bare.loc[30, list(SOFTER)].tolist() == [50, 50, 50]
    assert bare.loc[90, "uy"] == pytest.approx(0.019, abs=1e-3)
    assert bare.loc[270, "uy"] == pytest.approx(-0.017, abs=1e-3)


def test_mesh_error_estimate_meets_the_exact_rod():
    for name, tips in EXACT_ROD.items():
        scene, exact = cases.case(name).scene, tips[1.0]
        moved = np.array(exact) != 0.0
        true = np.abs(STORE.wire(scene).tips[-1] / np.where(moved, exact, 1.0) - 1.0)[moved].max()
        assert mesh_error(STORE, scene).curve_max == pytest.approx(true, rel=0.1)


def test_spring_b_needs_no_sliding():
    path = STORE.partial_wire(frictionless(B))
    assert path.outcome == "limit_point"
    assert path.critical_time == pytest.approx(0.65, abs=0.01)
    assert path.times[-1] < path.critical_time


@pytest.mark.parametrize(
    ("name", "draw", "panels"), [("fig5", tip_figure, range(3, 6)), ("fig7", load_figure, [1])]
)
def test_differences_are_the_same_before_contact(name, draw, panels):
    """With contact and without it is the same spring until its coils touch."""
    data = pd.read_csv(Path(__file__).parents[1] / f"reports/paper/{name}.csv")
    apart = np.ptp(data.filter(like="uy_mm_").filter(like="wirefe").to_numpy(), axis=1)
    touching = int(np.flatnonzero(apart > 1e-6)[0])
    assert touching > 10
    figure = draw(data)
    for place in panels:
        contact, bare = (line.get_ydata() for line in figure.axes[place].lines[:2])
        np.testing.assert_allclose(contact[:touching], bare[:touching], rtol=1e-5, atol=1e-5)
        assert abs(contact[-1] - bare[-1]) > 0.1


def test_overlaps():
    circles = np.array([[0.0, 0.0], [9.0, 0.0], [0.0, 1.4], [9.0, 1.5]])
    assert shapes.overlaps(circles, 1.5) == pytest.approx([0.1, 0.0])


def test_bands_cover_their_share_of_the_wire():
    points = np.zeros((2 * shapes.POINTS_PER_TURN + 1, 3))
    pieces = shapes.bands(points)
    assert len(pieces) == 2 * shapes.BANDS_PER_TURN
    share = sum(len(piece) - 1 for piece in pieces) / (len(points) - 1)
    assert share == pytest.approx(shapes.BAND_SHARE)
    both = pieces + shapes.spaces(points)
    assert sum(len(piece) - 1 for piece in both) == len(points) - 1  # both models together, once each


def test_the_frame_of_a_picture_holds_the_wires():
    points = np.array([[-10.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 30.0, 0.0]])
    centre, half = shapes.picture_frame(points, 1.5)
    seen = (points - centre) @ shapes.view()[:2].T
    assert np.abs(seen).max() == pytest.approx(half - 1.5)


def test_spread_is_median_and_quartiles():
    assert timing.quartiles("s", [4.0, 1.0, 2.0, 3.0, 5.0]) == {"s": 3.0, "s_q1": 2.0, "s_q3": 4.0}


def test_a_table_as_a_csv_file():
    table = Table(("case", "µ, words"), (("a", ""), ('a "b"', "x, y")))
    assert table.csv() == 'case,"µ, words"\na,\n"a ""b""","x, y"\n'.encode()
