"""Where a state of the equivalent beam leaves the range of its law, in words for a path's message."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from coilspring.scene import Scene
from coilspring.scene.sizing import solid_height
from coilspring.solver.solve import Run
from equivbeam.laws.helix import HIGH, LOW
from equivbeam.laws.lawchecks import not_finite
from equivbeam.laws.userlaw import UserLaw
from equivbeam.shape import element_measures

# Share of the travel to solid up to which a force is trusted. Of 24 random guided cylinders the force at a
# prescribed height is within 2.4 % of the wire model's (32 pairs per turn) up to 0.90; at 0.95 and few coils
# errors reach 32 %.
TRUSTED = 0.90


def caution(scene: Scene, law: str | UserLaw, rows: np.ndarray, states: np.ndarray) -> str:
    """What of the last state the law does not hold for, and what to use instead; or nothing.

    Parameters
    ----------
    law : option of the path.
    rows : of the model.
    states : of the path, (steps, n).
    """
    if not len(states):
        return ""
    lengths = element_measures(states[-1:])[0, :, 0]
    said = _straight(rows, lengths) if law == "helix" else ""
    if scene.contact.enabled:
        said += _solid(scene, float(lengths.sum()))
    return said


def judged(law: str | UserLaw, rows: np.ndarray, run: Run) -> Run:
    """The run; where it ended at a state beyond which a user's law is not defined, that is why it ended."""
    if isinstance(law, str) or run.outcome == "completed":
        return run
    where = not_finite(law, rows, element_measures(run.track.last[None])[0])
    return replace(run, outcome="not_converged", message=where, critical_time=None) if where else run


def _straight(rows: np.ndarray, lengths: np.ndarray) -> str:
    beyond = np.flatnonzero((lengths < rows[:, LOW]) | (lengths > rows[:, HIGH]))
    if not beyond.size:
        return ""
    return (
        f"; but half coil {beyond[0] + 1} is drawn to a length of {lengths[beyond[0]]:.3g} mm, where its "
        "wire is all but straight and the helix law no longer holds"
    )


def _solid(scene: Scene, height: float) -> str:
    """Coils that close bit by bit from their ends, which circles do not see."""
    spring = scene.spring
    shortened, travel = spring.active_height - height, spring.active_height - solid_height(spring)
    if travel <= 0.0 or shortened <= TRUSTED * travel:
        return ""
    return (
        f"; but it is {shortened / travel:.0%} of the travel to solid, where coils close bit by bit and the "
        f"beam's force may be far off: use wirefe with pairs_per_turn of 16 or more"
    )
