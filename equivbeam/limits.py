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
    """What of the last of the states (steps, n) the law does not hold for, and what to use instead."""
    if not len(states):
        return ""
    lengths, said = element_measures(states[-1:])[0, :, 0], ""
    beyond = (lengths < rows[:, LOW]) | (lengths > rows[:, HIGH]) if law == "helix" else np.zeros(1)
    if beyond.any():
        coil = int(np.argmax(beyond))
        said = (
            f"; but half coil {coil + 1} is drawn to a length of {lengths[coil]:.3g} mm, where its "
            "wire is all but straight and the helix law no longer holds"
        )
    # coils that close bit by bit from their ends, which circles do not see
    height = scene.spring.active_height
    travel, shortened = height - solid_height(scene.spring), height - float(lengths.sum())
    if scene.contact.enabled and travel > 0.0 and shortened > TRUSTED * travel:
        said += (
            f"; but it is {shortened / travel:.0%} of the travel to solid, where coils close bit by bit and "
            "the beam's force may be far off: use wirefe with pairs_per_turn of 16 or more"
        )
    return said


def judged(law: str | UserLaw, rows: np.ndarray, run: Run) -> Run:
    """The run; where it ended at a state beyond which a user's law is not defined, that is why it ended."""
    if isinstance(law, str) or run.outcome == "completed":
        return run
    where = not_finite(law, rows, element_measures(run.track.last[None])[0])
    return replace(run, outcome="not_converged", message=where, critical_time=None) if where else run
