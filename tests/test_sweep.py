"""Sweeps: order kept, every spring accounted for."""

from dataclasses import replace

import numpy as np

import equivbeam
from coilspring import spring_a, spring_b
from coilspring.scene import Contact


def scenes():
    a, b = spring_a(), spring_b()
    yield a
    yield replace(a, spring=replace(a.spring, active_coils=14.3))  # not a multiple of half a coil
    yield replace(b, contact=Contact(stiffness=200.0))  # telescopes at a limit point
    yield from (replace(a, spring=replace(a.spring, mean_diameter=d)) for d in np.linspace(8.0, 11.0, 130))


def test_order_and_outcomes():
    seen = []
    found = list(equivbeam.sweep(scenes(), workers=2, progress=seen.append, steps=1))
    assert [outcome.outcome for outcome in found[:3]] == ["completed", "refused", "limit_point"]
    assert "active_coils" in found[1].message
    assert 0.8 < found[2].critical_time < 1.0
    assert len(found) == 133
    assert seen[-1] == 133
    assert seen == sorted(seen)
    for scene, outcome in list(zip(scenes(), found, strict=True))[::40]:
        if outcome.outcome == "completed":
            np.testing.assert_array_equal(equivbeam.solve(scene, steps=1).tips[-1], outcome.tip)
