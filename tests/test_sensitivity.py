"""Derivatives through the factored tangent against differences of solutions; fits find what was put in."""

from dataclasses import replace

import numpy as np
import pytest

import equivbeam
import wirefe
from coilspring import CoilSection, Load, Scene, Spring, Supports, spring_a, spring_b
from coilspring.errors import InputError
from equivbeam import curvefit
from equivbeam.sensitivity import NAMES, values, varied

SCENES = {
    "A": (spring_a(), {"law": "haringx"}),
    "A, k = 1.5, helix": (
        replace(spring_a(), contact=replace(spring_a().contact, exponent=1.5)),
        {"law": "helix"},
    ),
    "B": (spring_b(), {"law": "haringx"}),
}


@pytest.mark.parametrize("case", SCENES)
def test_against_differences_of_solutions(case):
    scene, options = SCENES[case]
    scene = scene.with_steps(4)
    names = NAMES if options["law"] == "haringx" else NAMES[:-3]
    names = tuple(name for name in names if name != "exponent" or scene.contact.exponent > 1.0)
    path = equivbeam.solve(scene, **options)
    found = equivbeam.sensitivities(path, names)
    assert found.tips.shape == (4, len(names), 3)
    for i, (name, value) in enumerate(zip(names, values(scene, names), strict=True)):
        tips = []
        for way in (-2.0, -1.0, 1.0, 2.0):
            new = varied(scene, (name,), np.array([value * (1.0 + 2e-5 * way)]))
            tips.append(equivbeam.solve(new, **options).tips[-1])
        a, b, c, d = tips
        slope = (8.0 * (c - b) - (d - a)) / (12.0 * 2e-5 * value)  # of fourth order
        scale = np.abs(slope * value).max() + 1e-3 * np.abs(path.tips[-1]).max()
        np.testing.assert_allclose(found.relative[-1, i], slope * value, atol=1e-6 * scale)


HARD = ("wire_diameter", "mean_diameter", "top_diameter", "pitch", "E", "G", "bending")


@pytest.mark.parametrize("exponent", [1.0, 2.5])
@pytest.mark.parametrize("K", [1e4, 1e5, 1e6, 1e7, 1e8])
def test_hard_contact(K, exponent):
    """Differences of the whole residual, over 6e-6 of a value, closed and opened pairs: 1.3 to 30 % off."""
    contact = replace(spring_a().contact, stiffness=K, exponent=exponent)
    scene = replace(spring_a(), contact=contact).with_steps(8)
    path = equivbeam.solve(scene)
    found = equivbeam.sensitivities(path, HARD)
    assert path.active_contacts.max() >= 5
    for i, (name, value) in enumerate(zip(HARD, found.values, strict=True)):
        high, low = (
            equivbeam.solve(varied(scene, (name,), np.array([value * (1.0 + way)]))).tips
            for way in (2e-6, -2e-6)
        )
        change = (high - low) / 4e-6
        np.testing.assert_allclose(
            found.relative[:, i] / np.abs(change).max(axis=0), change / np.abs(change).max(axis=0), atol=1e-6
        )


@pytest.mark.parametrize("tangent", ["paper", "paper-printed"])
def test_derivatives_do_not_depend_on_the_matrix_of_the_iteration(tangent):
    """With the paper's, which is no tangent, they were up to 30 % off, and rates 17 %."""
    scene = spring_a().with_steps(2)
    exact, other = (equivbeam.solve(scene, tangent=each) for each in ("exact", tangent))
    np.testing.assert_allclose(other.rates, exact.rates, rtol=1e-6)
    found, expected = (equivbeam.sensitivities(path, ("wire_diameter", "E")).tips for path in (other, exact))
    np.testing.assert_allclose(found, expected, rtol=1e-5)


def test_exponent_at_the_end_of_its_range():
    """One-sided: an exponent below 1 is refused."""
    found = equivbeam.sensitivities(equivbeam.solve(spring_a(), steps=1), ["exponent"])
    other = replace(spring_a(), contact=replace(spring_a().contact, exponent=1.0 + 1e-5))
    slope = (equivbeam.solve(other, steps=1).tips[-1] - equivbeam.solve(spring_a(), steps=1).tips[-1]) / 1e-5
    np.testing.assert_allclose(found.tips[-1, 0], slope, rtol=1e-3)


def test_calibration_finds_what_was_put_in(tmp_path):
    true = {"axial": 1.03, "bending": 0.96, "penalty": 3.0e3}
    scene = spring_a().with_steps(20)
    curve = equivbeam.solve(scene.with_penalty(3.0e3), factors=(1.03, 1.0, 0.96))
    curve.table.iloc[::2].to_csv(tmp_path / "curve.csv")
    found = equivbeam.calibrate(scene, tmp_path / "curve.csv", list(true))
    np.testing.assert_allclose(found.values, list(true.values()), rtol=1e-6)
    assert found.rms_after < 1e-8 < found.rms_before
    assert np.isnan(found.errors).all()  # there is no scatter to tell them


def test_calibration_to_the_wire_model(monkeypatch):
    """Spring B without contact: 2.6 % of Haringx's law is its axial stiffness."""
    scene = spring_b().without_contact().with_steps(10)
    curve, solved = wirefe.solve(scene, element="curved", elements_per_turn=8), []
    solve = curvefit.solve
    monkeypatch.setattr(curvefit, "solve", lambda *given, **by: solved.append(1) or solve(*given, **by))
    found = equivbeam.calibrate(scene, curve, ["axial"])
    assert found.evaluations == len(solved)
    assert found.values[0] == pytest.approx(0.98, abs=0.01)
    assert found.rms_after < 0.3 * found.rms_before
    assert found.evaluations < 20


AXIAL = Scene(
    "guided", Spring(2.0, 16.0, 8.0, 40.0), Load((0.0, -40.0), 10), supports=Supports(top_held=("ux", "rotz"))
)
# parameters that are fitted to an axial curve, how many it determines, which it does not, which stay
RANKS = {
    "bending": (["bending"], 0, ("bending",), ("bending",)),
    "traded": (["axial", "wire_diameter"], 1, ("axial", "wire_diameter"), ("wire_diameter",)),
    "in their order": (["wire_diameter", "axial"], 1, ("wire_diameter", "axial"), ("axial",)),
    "one of two": (["penalty", "axial"], 1, ("penalty",), ("penalty",)),
    "one of three": (["bending", "G", "E"], 1, ("bending", "E"), ("bending", "E")),
}


@pytest.mark.parametrize("noise", [0.0, 1e-5])
@pytest.mark.parametrize("case", RANKS)
def test_calibration_names_what_a_curve_does_not_determine(case, noise):
    names, rank, undetermined, fixed = RANKS[case]
    curve = equivbeam.solve(AXIAL, factors=(1.1, 1.0, 1.0)).table
    curve["uy"] *= 1.0 + noise * np.cos(np.arange(10))
    found = equivbeam.calibrate(AXIAL, curve, names)
    assert (found.rank, found.undetermined, found.fixed) == (rank, undetermined, fixed)
    lost = np.array([name in undetermined for name in names])
    np.testing.assert_array_equal(np.isnan(found.errors), lost | (noise == 0.0))  # without scatter
    at_start = np.array([name in fixed for name in names])
    np.testing.assert_array_equal(found.values == values(AXIAL, tuple(names)), at_start)
    if rank:
        assert found.rms_after < noise + 1e-12 < found.rms_before
    text = str(found)
    assert text.count("does not determine") + text.count("does not tell") == len(undetermined)
    assert all(set(others) <= set(undetermined) - set(fixed) for others in found.instead)
    assert f"{rank} of {len(names)} parameters fitted" in text


def test_one_number_leaves_no_standard_error():
    curve = equivbeam.solve(AXIAL.with_steps(1), factors=(1.1, 1.0, 1.0))
    found = equivbeam.calibrate(AXIAL, curve, ["axial"])
    assert found.values[0] == pytest.approx(1.1)
    assert np.isnan(found.errors[0])
    assert found.undetermined == ()
    assert "unknown" in str(found)


def test_standard_errors_tell_the_scatter():
    curve = equivbeam.solve(AXIAL, factors=(1.1, 1.0, 1.0)).table
    off = []
    for row in np.random.default_rng(1).normal(scale=0.01, size=(40, 10)):  # mm
        found = equivbeam.calibrate(AXIAL, curve.assign(uy=curve["uy"] + row), ["axial"])
        off.append((found.values[0] - 1.1) / found.errors[0])
    assert 0.7 < np.sqrt(np.mean(np.square(off))) < 1.5


BAD = {
    "parameters must be one of": lambda: equivbeam.sensitivities(equivbeam.solve(spring_a(), steps=1), ["D"]),
    "needs a path without friction": lambda: equivbeam.sensitivities(
        equivbeam.solve(spring_b(), steps=1, sliding="scene"), ["E"]
    ),
    "sensitivities needs a path of the model equivbeam, got wirefe": lambda: equivbeam.sensitivities(
        wirefe.solve(spring_b(), steps=1, elements_per_turn=4), ["E"]
    ),
    "curve must be a readable CSV file": lambda: equivbeam.calibrate(spring_a(), "no/such.csv", ["E"]),
    "factors must be 1 unless": lambda: equivbeam.solve(spring_a(), law="helix", factors=(1.0, 1.0, 1.1)),
}


@pytest.mark.parametrize("words", BAD)
def test_bad_input(words):
    with pytest.raises(InputError, match=words):
        BAD[words]()


@pytest.mark.parametrize("name", ["pitch", "mean_diameter", "bottom_diameter", "top_diameter"])
def test_what_each_section_has_of_its_own_is_no_parameter(name):
    coils = [CoilSection(1.5, (4.2, 6.0), 22.0), CoilSection(4.0, 6.0, 22.0)]
    scene = replace(spring_b(), spring=Spring.of_sections(3.2, coils))
    path = equivbeam.solve(scene, steps=1)
    said = f"^{name} cannot be fitted or varied where the spring has sections.* then wire_diameter, E, G, "
    with pytest.raises(InputError, match=said):
        equivbeam.sensitivities(path, ["wire_diameter", name])
    with pytest.raises(InputError, match=said):
        equivbeam.calibrate(scene, path, [name])
    assert np.isfinite(equivbeam.sensitivities(path, ["wire_diameter", "G"]).tips).all()


@pytest.mark.parametrize("names", [[], ["E", "E"], "E", None, 3, {"E"}, [["E"]]])
def test_parameters_to_fit_are_a_list_of_different_names(names):
    with pytest.raises(InputError, match="parameters must be a list of different names"):
        equivbeam.calibrate(AXIAL, equivbeam.solve(AXIAL), names)
    with pytest.raises(InputError, match="parameters must be a list of different names"):
        equivbeam.sensitivities(equivbeam.solve(AXIAL), names)


def test_a_curve_that_is_none_is_refused():
    with pytest.raises(InputError, match=r"^curve must be a path, a table or a CSV file, got None$"):
        equivbeam.calibrate(AXIAL, None, ["axial"])
