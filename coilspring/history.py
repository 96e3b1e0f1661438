"""Loads over time: one force, several stages, or a test machine that prescribes a displacement.

A test machine is a spring between the top and a grip which moves: stiff against the scene's spring,
and no stiffer than rounding allows.
"""

from __future__ import annotations

import numpy as np

from coilspring.scene import Scene
from coilspring.sizing import axial_rate

STIFFNESS = 1e5  # of the test machine, in rates of the scene's spring


def machine_stiffness(scene: Scene) -> float:
    """Stiffness of the test machine that prescribes a displacement, N/mm; 0 where forces are given."""
    return STIFFNESS * axial_rate(scene) if scene.load.displacement else 0.0


def loads(scene: Scene, times: np.ndarray, tips: np.ndarray) -> np.ndarray:
    """Load on the top at displacements `tips` (steps, 3) found at times, shape (steps, 2), N.

    Of a prescribed displacement it is what the test machine measures.
    """
    if not (scene.load.stages or scene.load.displacement):
        return times[:, None] * np.array(scene.load.force)  # a traced path may go beyond time 1
    machine = machine_stiffness(scene)
    ends = grip(scene, machine)
    at = np.linspace(0.0, 1.0, len(ends))
    given = np.stack([np.interp(times, at, column) for column in ends.T], axis=1)
    given[:, 1] -= machine * tips[:, 1]
    return given


def grip(scene: Scene, machine: float) -> np.ndarray:
    """Load at the ends of the stages, the beginning included, shape (stages + 1, 2), N; of a test
    machine it is that on a top that has not moved."""
    load = scene.load
    ends = [(0.0, machine * way) for way in load.displacement] or load.stages or [load.force]
    return np.array([(0.0, 0.0), *ends])
