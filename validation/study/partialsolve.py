"""A path as far as it was reached, where its end is a result and not an error."""

from __future__ import annotations

from collections.abc import Callable

from coilspring import EquilibriumNotFound, EquilibriumPath, Scene


def as_far(solve: Callable[..., EquilibriumPath], scene: Scene, **options: object) -> EquilibriumPath:
    """Path of `scene` by a model's `solve`, complete or not; its outcome says why it ended."""
    try:
        return solve(scene, **options)
    except EquilibriumNotFound as error:
        return error.path
