"""A path as far as it was reached, where its end is a result and not an error."""

from collections.abc import Callable

from coilspring import EquilibriumNotFound, EquilibriumPath, Scene


class EndedEarly(RuntimeError):
    """Nothing can be had of scenes whose paths end early; one sentence."""


def partial_path(solve: Callable[..., EquilibriumPath], scene: Scene, **options: object) -> EquilibriumPath:
    """Path of `scene` by a model's `solve`, complete or not; its outcome says why it ended."""
    try:
        return solve(scene, **options)
    except EquilibriumNotFound as error:
        return error.path


def ending(outcome: str, critical_time: float | None) -> str:
    """How and when a path ended short of full load."""
    time = "" if critical_time is None else f" at t = {critical_time:.3f}"
    return f"{outcome.replace('_', ' ')}{time}"
