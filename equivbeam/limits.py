"""Where a state of the equivalent beam leaves the range of its law, in words for a path's message."""

from __future__ import annotations

import numpy as np

from coilspring.scene import Load, Scene
from coilspring.sizing import solid_height
from equivbeam.across.model import is_axial
from equivbeam.helix import HIGH, LOW
from equivbeam.rendering import element_lengths

# Share of the way to solid up to which a force is trusted, by the plane. Of 24 random guided cylinders the
# force at a prescribed height is within 2.4 % of the wire model's (32 pairs a turn) up to 0.90 in the working
# plane, and within 2.3 % up to 0.95 across; at 0.95 and 0.96 errors reach 32 and 12 %, of few coils.
TRUSTED = {"working": 0.90, "across": 0.95}


def caution(scene: Scene, law: str, plane: str, rows: np.ndarray, states: np.ndarray) -> str:
    """What of the last state the law does not hold for, and what to use instead; or nothing.

    Parameters
    ----------
    law, plane : options of the path.
    rows : of the model, for the helix law.
    states : of the path, (steps, n).
    """
    if not len(states):
        return ""
    lengths = element_lengths(states[-1:])[0]
    said = _straight(rows, lengths) if law == "helix" else ""
    if scene.contact.enabled:
        said += _solid(scene, law, plane, float(lengths.sum())) + _plane(scene, law, plane)
    return said


def _straight(rows: np.ndarray, lengths: np.ndarray) -> str:
    beyond = np.flatnonzero((lengths < rows[:, LOW]) | (lengths > rows[:, HIGH]))
    if not beyond.size:
        return ""
    return (
        f"; but half coil {beyond[0] + 1} is drawn to a length of {lengths[beyond[0]]:.3g} mm, where its "
        "wire is all but straight and the helix law no longer holds"
    )


def _solid(scene: Scene, law: str, plane: str, height: float) -> str:
    """Coils that close bit by bit from their ends, which circles do not see."""
    spring = scene.spring
    shortened, travel = spring.active_height - height, spring.active_height - solid_height(spring)
    if travel <= 0.0 or shortened <= TRUSTED[plane] * travel:
        return ""
    within = law == "haringx" and is_axial(scene) and shortened <= TRUSTED["across"] * travel
    better = "law='helix', or " if within else ""
    return (
        f"; but it is {shortened / travel:.0%} of the way to solid, where coils close bit by bit and the "
        f"beam's force may be far off: use {better}wirefe with pairs_per_turn of 16 or more"
    )


def _plane(scene: Scene, law: str, plane: str) -> str:
    """An axial load whose coils meet first in the plane across, where the beam is not."""
    if plane == "across" or not _presses_axially(scene.load):
        return ""
    if is_axial(scene) and law == "haringx":
        return "; the coils meet first across the working plane, where law='helix' lays a spring so loaded"
    if not is_axial(scene) and law == "helix":
        return (
            "; the coils meet first across the working plane, where the beam is laid only with closed end "
            "turns and a top held in ux and rotz"
        )
    return ""


def _presses_axially(load: Load) -> bool:
    forces = load.stages or (load.force,)
    return not any(x for x, _ in forces) and min(load.displacement or [y for _, y in forces]) < 0.0
