"""What the report is made of: evidence, verdicts, shapes, spreads of times, and the document itself."""

from __future__ import annotations

import numpy as np
import pytest

from validation import cases, shapes, timing
from validation.claims import Claim
from validation.document import Picture, Table, Text, to_html, to_markdown
from validation.evidence import Evidence, gather
from validation.exactrod import EXACT_ROD

PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def evidence() -> Evidence:
    return gather(cases.PathStore(lambda line: None), timing.Measurement((), {}))


def test_a_verdict_is_one_of_three():
    with pytest.raises(ValueError, match="maybe"):
        Claim("text", "statement", "1", "maybe", "")


def test_mesh_error_estimate_meets_the_exact_rod(evidence):
    for name, tips in EXACT_ROD.items():
        item, exact = evidence.cases[name], tips[1.0]
        moved = np.array(exact) != 0.0
        true = np.abs(item.wire.tips[-1] / np.where(moved, exact, 1.0) - 1.0)[moved].max()
        assert item.mesh_error.curve_max == pytest.approx(true, rel=0.1)


def test_spring_b_needs_no_sliding(evidence):
    path = evidence.frictionless
    assert path.outcome == "limit_point"
    assert path.critical_time == pytest.approx(0.65, abs=0.01)
    assert path.times[-1] < path.critical_time


def test_overlaps():
    circles = np.array([[0.0, 0.0], [9.0, 0.0], [0.0, 1.4], [9.0, 1.5]])
    assert shapes.overlaps(circles, 1.5) == pytest.approx([0.1, 0.0])


def test_bands_cover_their_share_of_the_wire():
    points = np.zeros((2 * shapes.POINTS_PER_TURN + 1, 3))
    pieces = shapes.bands(points)
    assert len(pieces) == 2 * shapes.BANDS_PER_TURN
    share = sum(len(piece) - 1 for piece in pieces) / (len(points) - 1)
    assert share == pytest.approx(shapes.BAND_SHARE)


def test_spread_is_median_and_quartiles():
    assert timing.Spread.of([4.0, 1.0, 2.0, 3.0, 5.0]) == timing.Spread(3.0, 2.0, 4.0)


def test_document(tmp_path):
    (tmp_path / "a.png").write_bytes(PNG)
    blocks = (Text("**bold** & `code`"), Table(("x|y",), (("<1>",),)), Picture("a.png", "Figure 1. Caption."))
    page = to_html([(blocks, tmp_path)], "title")
    assert "<strong>bold</strong> &amp; <code>code</code>" in page
    assert "&lt;1&gt;" in page
    assert "data:image/png;base64,iVBORw0KGgo=" in page
    text = to_markdown(blocks)
    assert "| x\\|y |" in text
    assert "![Figure 1](a.png)" in text
