"""Derivatives through the factored tangent against differences of solutions; fits find what was put in."""

from dataclasses import replace

import numpy as np
import pytest

import equivbeam
import wirefe
from coilspring import spring_a, spring_b
from coilspring.errors import InputError
from equivbeam.parameters import NAMES, values, varied

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
    for i, (name, value) in enumerate(zip(names, values(scene, options, names), strict=True)):
        tips = []
        for way in (-2.0, -1.0, 1.0, 2.0):
            new, chosen = varied(scene, options, (name,), np.array([value * (1.0 + 2e-5 * way)]))
            tips.append(equivbeam.solve(new, **chosen).tips[-1])
        a, b, c, d = tips
        slope = (8.0 * (c - b) - (d - a)) / (12.0 * 2e-5 * value)  # of fourth order
        scale = np.abs(slope * value).max() + 1e-3 * np.abs(path.tips[-1]).max()
        np.testing.assert_allclose(found.relative[-1, i], slope * value, atol=1e-6 * scale)


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
    np.testing.assert_array_less(found.errors, 1e-5 * found.values)


def test_calibration_to_the_wire_model():
    """Spring B without contact: 2.6 % of Haringx's law is its axial stiffness."""
    scene = spring_b().without_contact().with_steps(10)
    curve = wirefe.solve(scene, element="curved", elements_per_turn=8)
    found = equivbeam.calibrate(scene, curve, ["axial"])
    assert found.values[0] == pytest.approx(0.98, abs=0.01)
    assert found.rms_after < 0.3 * found.rms_before
    assert found.evaluations < 20


BAD = {
    "parameters must be one of": lambda: equivbeam.sensitivities(equivbeam.solve(spring_a(), steps=1), ["D"]),
    "needs a path without friction": lambda: equivbeam.sensitivities(
        equivbeam.solve(spring_b(), steps=1, sliding="scene"), ["E"]
    ),
    "needs a path of the model equivbeam": lambda: equivbeam.sensitivities(
        wirefe.solve(spring_b(), steps=1, elements_per_turn=4), ["E"]
    ),
    "curve must be a readable CSV file": lambda: equivbeam.calibrate(spring_a(), "no/such.csv", ["E"]),
    "factors must be 1 unless": lambda: equivbeam.solve(spring_a(), law="helix", factors=(1.0, 1.0, 1.1)),
}


@pytest.mark.parametrize("words", BAD)
def test_bad_input(words):
    with pytest.raises(InputError, match=words):
        BAD[words]()
