"""Where a law does not hold on a path that was followed, in words for its message."""

from __future__ import annotations

import math

import numpy as np

from coilspring.scene import Scene
from coilspring.scene.sizing import solid_height
from coilspring.solver.cautions import worst
from equivbeam.halfcoils import half_coils, nearest_crossing, wire_lengths
from equivbeam.laws import name_of
from equivbeam.laws.helix import HIGH, LOW
from equivbeam.laws.userlaw import UserLaw
from equivbeam.shape import BeamShape, element_measures

# Share of the travel to solid up to which a force is trusted. Of 24 random guided cylinders the force at a
# prescribed height is within 2.4 % of the wire model's (32 pairs per turn) up to 0.90; at 0.95 and few coils
# errors reach 32 %.
TRUSTED = 0.90
ADVICE = ": use wirefe with 16 or more pairs per turn"
IN_PLANE = 1e-9  # rad
TOUCHING = 1e-9  # of the height: less travel is rounding
# Share of its wire's length up to which the length of a half coil is trusted, and times that at rest, which
# is a large share where coils are steep. Of 43 random springs of 2 to 10 coils that are pulled, UY by haringx
# is within 9.4 % of the wire model's before (12.7 % with 2 coils), and off by 10 % at shares of 0.31 to 0.50;
# by helix it is within 9.3 % on these, and within 10 % on 21 others that were drawn to 0.67 at least. At 0.69
# it was seen to lose its stability, where the wire does not.
TAUT, TAUT_HELIX, LONGER = 0.30, 0.65, 1.1
# Wire diameters by which gaps of circles may differ from those of the wire where it crosses the working
# plane; gaps that matter are below the second.
BESIDE, NEAR = 0.08, 0.2


def warning(shape: BeamShape, law: str | UserLaw, states: np.ndarray, times: np.ndarray) -> str:
    """What of the states (steps, n) at some times the model does not hold for, and what to use instead."""
    if not len(states):
        return ""
    scene, lengths, said = shape.scene, element_measures(states)[..., 0], ""
    drawn = _straight(shape.data.rows, lengths, times) if law == "helix" else ""
    if drawn := drawn or taut(scene, law, states, times):
        said = f"; but{drawn}"
    # coils that close bit by bit from their ends, which circles do not see
    height = scene.spring.active_height
    travel, shortened = height - solid_height(scene.spring), height - lengths.sum(axis=1)
    row, when = worst(shortened, times)
    within = TRUSTED * travel < shortened[row] < height  # else the top has passed the bottom
    if scene.contact.enabled and travel > TOUCHING * height and within:
        said += (
            f"; but{when} it is {shortened[row] / travel:.0%} of the travel to solid, where coils close bit "
            f"by bit and the beam's force may be far off{ADVICE}"
        )
    return said + _beside(shape, states, times)


def _beside(shape: BeamShape, states: np.ndarray, times: np.ndarray) -> str:
    """Where circles, which stand at the nodes, are not where a wire that begins beside the working plane
    crosses it: by how much the gap of a pair is wrong, in the state with the least one and in the lowest."""
    spring, (first, _) = shape.scene.spring, shape.data.pairs.T
    off = spring.start_phase - math.pi * nearest_crossing(spring)
    if not len(first) or abs(off) <= IN_PLANE:
        return ""
    phases = spring.circle_phases()
    ends = (len(shape.data.attached) - len(shape.data.rows) - 1) // 2  # circles of an end turn
    number = np.round((phases[:-2] + off) / math.pi).astype(int) + ends  # of the circle that stands for it
    _, pairs, crossings = np.intersect1d(first, number, return_indices=True)
    own = shape.pair_gaps(states)
    rows = np.unique([int(np.argmin(own.min(axis=1))), int(np.argmin(states[:, -2]))])
    centres = np.stack([shape.centreline(state, phases) for state in states[rows]])[..., :2]
    wire = np.linalg.norm(centres[:, 2:] - centres[:, :-2], axis=-1)[:, crossings] - spring.wire_diameter
    own = own[rows][:, pairs]
    wrong = np.where(np.minimum(wire, own) < NEAR * spring.wire_diameter, np.abs(wire - own), 0.0)
    row, when = worst(wrong.max(axis=1, initial=0.0), times[rows])
    if wrong[row].max(initial=0.0) < BESIDE * spring.wire_diameter:
        return ""
    pair = int(np.argmax(wrong[row]))
    return (
        f"; but{when} a gap of circles is {own[row, pair]:.2g} mm, and {wire[row, pair]:.2g} mm where the "
        "wire, which begins beside the working plane, crosses it: contact may be wrong: use wirefe"
    )


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
