"""The accuracy ladder: all checks pass, and the page says what they found."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

from coilspring import Material, spring_a
from validation.study import template
from validation.verification.accuracy import EXACT_RING, SPRING_A, WORDS, goehner, rod, write_page
from validation.verification.case import KINDS, UNVERIFIED, VerificationCase, component_errors, observed_order
from validation.verification.rodcases import CASES, ELASTICAS
from validation.verification.springcases import HELIX, ROUND, TURN, WRENCH, WRENCH_LOAD, rates

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
    facts = json.loads((tmp_path / "facts.json").read_text(encoding="utf-8"))
    assert sum(facts[kind] for kind in KINDS) == facts["checks"] == len(rows) - 2
    for kind, count in {"exact": 14, "published": 1, "own": 22, UNVERIFIED: 3}.items():
        assert facts[kind] == count
        assert f'{count} "{kind}" ({KINDS[kind]})' in page


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
    assert case.checked()["error"] == 2e-3  # a component that the target does not move is over the largest
    assert not case.checked()["passed"]
    assert "| 2, 0.004 | 2.0e-03 |  | **no** | c |" in template.page(WORDS, checks=[case.checked()])


def test_each_component_is_over_its_own_target():
    """A rotation that is off counts, however large the displacements beside it are."""
    np.testing.assert_allclose(component_errors((20.0, 1.1), np.array([20.0, 1.0])), [0.0, 0.1])
    np.testing.assert_allclose(component_errors((20.0, 2e-2), np.array([20.0, 0.0])), [0.0, 1e-3])


def test_a_case_is_of_one_kind():
    kinds = {replace(WRENCH, source=source).kind() for source in ("exact (Love)", "book, not verified here")}
    assert kinds == {"exact", UNVERIFIED}
    with pytest.raises(ValueError, match="source must begin with one of"):
        replace(WRENCH, source="found somewhere").kind()


@pytest.mark.parametrize("load", ELASTICAS)
def test_elasticas_by_elliptic_integrals(load):
    root = np.sqrt(load)

    def length(k):
        return ellipk(k * k) - ellipkinc(np.arcsin(np.sqrt(0.5) / k), k * k) - root

    k = brentq(length, np.sqrt(0.5) * (1.0 + 1e-12), 1.0 - 1e-12, xtol=1e-15)
    across = 1.0 - 2.0 / root * (ellipe(k * k) - ellipeinc(np.arcsin(np.sqrt(0.5) / k), k * k))
    along = np.sqrt(4.0 * k * k - 2.0) / root - 1.0
    np.testing.assert_allclose(ELASTICAS[load], (along, across), atol=6e-9)
    assert (along, across) == pytest.approx(next(c.target for c in CASES if f"EI = {load:g}," in c.data))


def test_the_helix_under_a_wrench_in_closed_form():
    """Its strains are constant, so its end is an exponential; the moment at the other end depends on it."""
    force, moment = map(np.array, WRENCH_LOAD)
    (start, end), (first, second) = HELIX.points(np.array([0.0, 6.0 * np.pi])), HELIX.derivatives(np.zeros(1))
    t, b = (vector / np.linalg.norm(vector) for vector in (first[0], np.cross(first[0], second[0])))
    frame = np.stack((t, np.cross(b, t), b), axis=-1)
    slope = HELIX.pitch / (2.0 * np.pi)
    curvatures = np.array([-slope, 0.0, 5.0]) / (25.0 + slope**2)  # left-handed
    tip, twist = end, np.zeros((4, 4))
    for _ in range(20):
        couple = frame.T @ (moment + np.cross(tip - start, force))
        turns = curvatures + couple / (ROUND.GJ, ROUND.EI, ROUND.EI)
        twist[:3, :3] = np.cross(turns, np.eye(3)).T
        twist[:3, 3] = [1.0, 0.0, 0.0] + frame.T @ force / (ROUND.EA, ROUND.GA, ROUND.GA)
        tip = start + frame @ expm(3.0 * TURN * twist)[:3, 3]
    np.testing.assert_allclose(tip - end, WRENCH.target, rtol=0.0, atol=1e-9)


def test_a_case_tells_its_order():
    def solve(count):
        return 2.0 + 1.0 / count**2, 1.0 / count

    case = VerificationCase("a", "b", (2.0, 0.0), "own", 1.0, "c", solve, mesh=64, meshes=(4, 8, 16))
    assert case.checked()["order"] == pytest.approx(1.0)  # of the second component, over the first
    assert replace(case, components=1).checked()["order"] == pytest.approx(2.0)
    assert replace(case, fine=1 << 20, components=1).checked()["order"] == pytest.approx(2.0)


def test_observed_order():
    assert observed_order([1.0, 0.25, 0.0625]) == 2.0
