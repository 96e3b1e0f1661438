"""The accuracy ladder: all checks pass, and the page says what they found."""

from dataclasses import replace

import pytest

from coilspring import Material, spring_a
from validation.study import template
from validation.verification.accuracy import EXACT_RING, SPRING_A, WORDS, goehner, rod, write_page
from validation.verification.case import VerificationCase, observed_order
from validation.verification.springcases import rates

CHECKS = (
    *("G1,", "G2,", "G3,", "G4,", "G5,", "G8,", "G9,", "G10,", "G11,", "G13,"),
    *("Love", "spring rate", "natural", "Rodr"),
)


def test_page(tmp_path):
    assert write_page(tmp_path / "page.md", tmp_path)
    page, _, curvature = (tmp_path / "page.md").read_text(encoding="utf-8").partition("\n## ")
    rows = [row for row in page.splitlines() if row.startswith("| ")]
    assert {len(row.split(" | ")) for row in rows} == {10}
    for name in CHECKS:
        assert any(row.startswith(f"| {name}") for row in rows), name
    assert "**no**" not in "".join(rows)
    for count, found in {4: 2, 16: 4, 40: 4, 80: 4, 160: 4}.items():
        assert sum(f"| {count} straight" in row or f"| {count} curved" in row for row in rows) == found
    assert "move too far by 1.7 %" in curvature


def test_a_rod_with_shear_is_softer_than_a_solid_wire():
    """By 0.743 over the index squared and more; Goehner's term is nearly exact."""
    for index, exact in EXACT_RING.items():
        assert goehner(index) == pytest.approx(exact, rel=2e-3)
        assert 0.74 < (rod(index) / exact - 1.0) * index**2 < 0.79
    spring, G = spring_a().spring, Material().G
    formula_rate = G * spring.wire_diameter**4 / (8.0 * 10.0**3 * spring.active_coils)
    # the wire model's own rate; the pitch is the rest
    assert formula_rate / rates(16)[0] == pytest.approx(rod(SPRING_A), rel=2e-3)


def test_a_check_that_fails_says_so():
    case = VerificationCase(
        "a", "b", (2.0, 0.0), "own", 1e-3, "c", lambda count: (2.0, 0.004 * count), mesh=1
    )
    assert case.checked()["error"] == 2e-3
    assert not case.checked()["passed"]
    assert "| 2, 0.004 | 2.0e-03 |  | **no** | c |" in template.page(WORDS, checks=[case.checked()])


def test_a_case_tells_its_order():
    def solve(count):
        return 2.0 + 1.0 / count**2, 1.0 / count

    case = VerificationCase("a", "b", (2.0, 0.0), "own", 1.0, "c", solve, mesh=64, meshes=(4, 8, 16))
    assert case.checked()["order"] == pytest.approx(1.0)
    assert replace(case, components=1).checked()["order"] == pytest.approx(2.0)
    assert replace(case, fine=1 << 20, components=1).checked()["order"] == pytest.approx(2.0)


def test_observed_order():
    assert observed_order([1.0, 0.25, 0.0625]) == 2.0
