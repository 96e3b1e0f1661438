"""The accuracy ladder: all checks pass, and the page says what they found."""

from validation.ladder import Check, observed_order, write_page

CHECKS = (
    "G1,",
    "G2,",
    "G3,",
    "G4,",
    "G5,",
    "G8,",
    "G9,",
    "G10,",
    "G11,",
    "G13,",
    "Love",
    "spring rate",
    "natural",
    "Rodr",
)


def test_page(tmp_path):
    assert write_page(tmp_path / "page.md")
    rows = [
        row for row in (tmp_path / "page.md").read_text(encoding="utf-8").splitlines() if row.startswith("| ")
    ]
    assert {len(row.split(" | ")) for row in rows} == {10}
    for name in CHECKS:
        assert any(row.startswith(f"| {name}") for row in rows), name
    assert "**no**" not in "".join(rows)
    for count in (4, 16, 40, 80, 160):
        assert sum(f"| {count} straight" in row or f"| {count} curved" in row for row in rows) == 4


def test_a_check_that_fails_says_so():
    check = Check("a", "b", (2.0, 0.0), "own", 1e-3, (2.0, 0.004), "c")
    assert check.error == 2e-3
    assert not check.passed
    assert "**no**" in check.row


def test_observed_order():
    assert observed_order([1.0, 0.25, 0.0625]) == 2.0
