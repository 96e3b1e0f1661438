"""Loads over time: one force, several stages, or a prescribed displacement of the top."""

from __future__ import annotations

import numpy as np

from coilspring.scene.scene import Load


def stage_ends(load: Load) -> np.ndarray:
    """Forces at the ends of the stages, the beginning included, shape (stages + 1, 2), N; of a prescribed
    displacement its UX, left at 0, and UY, mm."""
    ends = [(0.0, way) for way in load.displacement] or load.stages or [load.force]
    return np.array([(0.0, 0.0), *ends])


def given_loads(load: Load, times: np.ndarray) -> np.ndarray:
    """Forces on the top at some times, shape (steps, 2), N."""
    if not load.stages:
        return times[:, None] * np.array(load.force)  # a traced path may go beyond time 1
    ends = stage_ends(load)
    at = np.linspace(0.0, 1.0, len(ends))
    return np.stack([np.interp(times, at, column) for column in ends.T], axis=1)
