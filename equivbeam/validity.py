"""Where a law does not hold on a path that was followed, in words for its message."""

from __future__ import annotations

import numpy as np

from coilspring.scene import Scene
from coilspring.scene.sizing import solid_height
from coilspring.solver.outcome import worst
from equivbeam.halfcoils import half_coils, wire_lengths
from equivbeam.laws import name_of
from equivbeam.laws.helix import HIGH, LOW
from equivbeam.laws.userlaw import UserLaw
from equivbeam.shape import element_measures

# Share of the travel to solid up to which a force is trusted. Of 24 random guided cylinders the force at a
# prescribed height is within 2.4 % of the wire model's (32 pairs per turn) up to 0.90; at 0.95 and few coils
# errors reach 32 %.
TRUSTED = 0.90
ADVICE = ": use wirefe with 16 or more pairs per turn"
# Share of its wire's length up to which the length of a half coil is trusted, and times that at rest, which
# is a large share where coils are steep. Of 43 random springs of 2 to 10 coils that are pulled, UY by haringx
# is within 9.4 % of the wire model's before (12.7 % with 2 coils), and off by 10 % at shares of 0.31 to 0.50;
# by helix it is within 9.3 % on these, and within 10 % on 21 others that were drawn to 0.67 at least. At 0.69
# it was seen to lose its stability, where the wire does not.
TAUT, TAUT_HELIX, LONGER = 0.30, 0.65, 1.1


def warning(scene: Scene, law: str | UserLaw, rows: np.ndarray, states: np.ndarray, times: np.ndarray) -> str:
    """What of the states (steps, n) at some times the law does not hold for, and what to use instead."""
    if not len(states):
        return ""
    lengths, said = element_measures(states)[..., 0], ""
    drawn = _straight(rows, lengths, times) if law == "helix" else ""
    if drawn := drawn or taut(scene, law, states, times):
        said = f"; but{drawn}"
    # coils that close bit by bit from their ends, which circles do not see
    height = scene.spring.active_height
    travel, shortened = height - solid_height(scene.spring), height - lengths.sum(axis=1)
    row, when = worst(shortened, times)
    within = TRUSTED * travel < shortened[row] < height  # else the top has passed the bottom
    if scene.contact.enabled and travel > 0.0 and within:
        said += (
            f"; but{when} it is {shortened[row] / travel:.0%} of the travel to solid, where coils close bit "
            f"by bit and the beam's force may be far off{ADVICE}"
        )
    return said


def _straight(rows: np.ndarray, lengths: np.ndarray, times: np.ndarray) -> str:
    """When a half coil leaves the range of the helix law, or nothing."""
    beyond = (lengths < rows[:, LOW]) | (lengths > rows[:, HIGH])
    row, when = worst(beyond.sum(axis=1), times)
    if not beyond[row].any():
        return ""
    coil = int(np.argmax(beyond[row]))
    return (
        f"{when} half coil {coil + 1} is drawn to a length of {lengths[row, coil]:.3g} mm, "
        "where its wire is all but straight and the helix law no longer holds"
    )


def taut(scene: Scene, law: str | UserLaw, states: np.ndarray, times: np.ndarray) -> str:
    """When half coils are drawn to so much of their wire's length that the law is not trusted, or nothing."""
    if not len(states):
        return ""
    lengths, wires = element_measures(states)[..., 0], wire_lengths(scene.spring)
    rest, share = half_coils(scene.spring).lengths, TAUT_HELIX if law == "helix" else TAUT
    beyond = lengths > np.maximum(share * wires, LONGER * rest)
    beyond &= (lengths.sum(axis=1) > rest.sum())[:, None]  # a spring that is pressed has some such, bent
    shares = np.where(beyond, lengths / wires, 0.0)
    row, when = worst(shares.max(axis=1), times)
    if (largest := shares[row].max()) == 0.0:
        return ""
    helix = law != "helix" and largest < TAUT_HELIX and not scene.factors.given
    other = "law helix or " if helix else ""
    return (
        f"{when} half coils are drawn to {largest:.0%} of the length of their wire, where law {name_of(law)} "
        f"may be far off: use {other}wirefe"
    )
