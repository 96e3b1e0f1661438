"""Contact pairs of the wire for the verifier: their energy, written from docs/theory.md, differentiated here.

A contact point moves with one node (a sphere) or two (a station of the wire). A pair has a gap h, which
presses, and a slip L from where it touched first, which sticks or rubs. Complex steps of h and of L^2 / 2 in
the displacements and spins of a pair's four nodes give its forces, central differences of those its tangent.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from coilspring import EquilibriumPath
from validation.campaign.poses import TINY, assembled, differences, like, rotated, stepped, summed
from validation.campaign.wireparts import Points

SMALL_CHORD = 1e-4  # square of a chord below which a series stands for the arc
# Wire diameters of slip left at least: the direction of 1e-9, as stiff pairs allow, is rounding, which would
LEAST_SLIP = 1e-4  # decide the sign of the determinant.
FINEST = 1e-10  # wire diameters of slip, before which no pair reaches its bound
SLIDES = 1e-6  # of its slip: by so much less than the law of sticking says, a pair slides
Poses = list[tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Law:
    """What presses and rubs: F = penalty * depth^exponent, and sticking * slip across it, at most mu F."""

    d: float
    penalty: float
    exponent: float
    mu: float

    @property
    def sticking(self) -> float:
        """Tangential stiffness: that of a depth of d if the law were linear."""
        return self.penalty * self.d**self.exponent / self.d


@dataclass(frozen=True)
class Pairs:
    """Pairs that touch or are held in a state, and what each remembers."""

    points: Points  # of all of the wire, as is the law
    law: Law
    index: np.ndarray  # (pairs, 2) contact points
    rest_overlap: np.ndarray  # (pairs,) by how much wires run into each other at rest
    weight: np.ndarray  # (pairs,) of the law's stiffness, across the wires and along them
    held: np.ndarray  # (pairs,) whether there is a tangential force
    slides: np.ndarray  # (pairs,) whether it is at its bound
    arcs: np.ndarray  # (pairs,) whether spheres resist the arc: under friction, and where they graze
    # (pairs,) of the stiffness of sticking that is left; 1 but for pairs that are released, or just touch
    share: np.ndarray
    # (pairs, 3) of wires: the material points that touched first, from the stations, in their sections at
    # rest; of spheres: the vector between the centres when they did, and the normal
    one: np.ndarray
    two: np.ndarray

    def of(self, chosen: np.ndarray) -> Self:
        """Some of the pairs."""
        names = ("index", "rest_overlap", "weight", "held", "slides", "arcs", "share", "one", "two")
        return replace(self, **{name: getattr(self, name)[chosen] for name in names})

    @property
    def nodes(self) -> np.ndarray:
        """Nodes (4, pairs) of the pairs: two of each contact point."""
        return self.points.node[self.index].reshape(-1, 4).T

    def poses(self, rows: np.ndarray) -> Poses:
        """Positions and quaternions of the pairs' nodes in one or many states."""
        near = [np.moveaxis(rows[..., node, :], -1, 0) for node in self.nodes]
        return [(each[:3], each[3:]) for each in near]

    def depth(self, rows: np.ndarray) -> np.ndarray:
        """Penetrations (..., pairs) in one or many states, below zero where open."""
        return self.law.d - self.gap(self.poses(rows))[0]

    def steps_to_opening(self, rows: np.ndarray, before: np.ndarray) -> np.ndarray:
        """Steps (pairs,) like the last one, to a state from the one before, after which the normal force that
        falls in proportion is zero; infinite where it does not fall."""
        last, first = (np.maximum(self.depth(each), 0.0) ** self.law.exponent for each in (rows, before))
        falls, steps = (last > 0.0) & (last < first), np.full(len(last), np.inf)
        steps[falls] = last[falls] / (first - last)[falls]
        return steps

    def gap(self, poses: Poses) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Gaps (..., pairs), longer by overlaps at rest, normals (3, ...), and vectors between the points."""
        points = self.points
        low, high = (self._sum(side, poses, points.weight, points.arm) for side in (0, 1))
        w = across = high - low
        if points.wires:
            one, two = (self._sum(side, poses, points.slope_weight, points.slope_arm) for side in (0, 1))
            along = one + two
            across = w - along * (w * along).sum(axis=0) / (along * along).sum(axis=0)
        h = np.sqrt((across * across).sum(axis=0))
        return h + self.rest_overlap, across / h, w

    def slip(self, poses: Poses) -> np.ndarray:
        """Vectors (3, ...) by which pairs have slipped since they touched first, as far as they resist it:
        of spheres under friction as long as the arc."""
        _, n, w = self.gap(poses)
        if self.points.wires:
            return _across(w + self._section(1, poses, self.two.T) - self._section(0, poses, self.one.T), n)
        reference = like(w, self.two.T)
        stuck = _across(w - like(w, self.one.T), reference)
        if not self.arcs.any():
            return stuck
        chord = n - reference
        square = (chord * chord).sum(axis=0)
        near = np.abs(square) < SMALL_CHORD
        safe = np.sqrt(np.where(near, 1.0, square))
        ratio = np.where(
            near,
            1.0 + square / 24.0 + 3.0 * square**2 / 640.0 + 5.0 * square**3 / 7168.0,
            2.0 * np.arcsin(0.5 * safe) / safe,
        )
        return np.where(self.arcs, self.law.d * ratio * chord, stuck)

    def gradient(self, rows: np.ndarray) -> np.ndarray:
        """Gradient (nodes, 6) of the pairs' energies; of what slides, Coulomb's force along its slip."""
        dh, dS = self._slopes(rows[self.nodes])
        press, _, ratio, _, _ = self._sizes(rows)
        return summed(self.nodes, ratio * dS - press * dh, len(rows))

    def tangent(self, rows: np.ndarray) -> np.ndarray:
        """Derivative (6 nodes, 6 nodes) of the gradient, with the pairs that touch and slide as they do."""
        near = rows[self.nodes]  # (4, pairs, 7)
        press, rise, ratio, by_gap, by_slip = self._sizes(rows)
        dh, dS = self._slopes(near)
        d2h, d2S = np.moveaxis(differences(self._slopes, near, self.law.d), 0, 2)
        K = rise * dh[:, None] * dh + by_gap * dS[:, None] * dh + by_slip * dS[:, None] * dS
        return assembled(self.nodes, K + ratio * d2S - press * d2h, len(rows))

    def forces(self, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Normal forces (pairs,) and tangential ones (pairs, 3) on the lower bodies."""
        poses = self.poses(rows)
        h, n, _ = self.gap(poses)
        slip = self.slip(poses)
        press, _, ratio, _, _ = self._sizes(rows)
        if not self.points.wires:
            # of the length of the arc, along it
            arc = np.sqrt((slip * slip).sum(axis=0)) * _along(slip, n) * self.law.d / h
            slip = np.where(self.arcs, arc, slip)
        return press, (ratio * slip).T

    def renewed(self, rows: np.ndarray) -> Self:
        """The pairs with what has slid taken off their references: they are at their bounds."""
        poses = self.poses(rows)
        n, slip = self.gap(poses)[1], self.slip(poses)
        length = np.sqrt((slip * slip).sum(axis=0))
        least = LEAST_SLIP * self.law.d / np.maximum(length, LEAST_SLIP * self.law.d)
        stiffness = self.weight * self.law.sticking * np.where(self.slides, self.share, 1.0)
        left = np.where(self.slides, np.maximum(self._sizes(rows)[2] / stiffness, least), 1.0)
        if self.points.wires:
            half = 0.5 * (1.0 - left) * slip
            one = self.one + self._at_rest(0, poses, half)
            return replace(self, one=one, two=self.two - self._at_rest(1, poses, half))
        # the normal turned back to where the arc is what the bound allows
        angle = left * length / self.law.d
        normal = np.where(self.slides, np.cos(angle) * n - np.sin(angle) * _along(slip, n), self.two.T)
        return replace(self, two=normal.T)

    def _slopes(self, near: np.ndarray) -> np.ndarray:
        """Derivatives (2, 24, ..., pairs) of gaps and half the slips' squares in moves and spins of
        the nodes."""
        poses = stepped(near)
        h = self.gap(poses)[0]
        half = 0.5 * (self.slip(poses) ** 2).sum(axis=0) if self.held.any() else 0.0 * h
        return np.stack((h.imag / TINY, half.imag / TINY * self.held))

    def _sizes(self, rows: np.ndarray) -> tuple[np.ndarray, ...]:
        """Of each pair: the normal force and its derivative by the penetration, the tangential force over the
        slip and its derivatives by the gap and by half of the slip's square."""
        poses = self.poses(rows)
        h, vectors = self.gap(poses)[0], self.slip(poses)
        depth, none = np.maximum(self.law.d - h, 0.0), np.zeros(len(h))
        K, k = self.weight * self.law.penalty, self.law.exponent
        press = K * depth**k
        rise = np.where(depth > 0.0, K * k * depth ** (k - 1.0), 0.0)
        ratio = self.weight * self.law.sticking * self.share * self.held
        if not self.slides.any():
            return press, rise, ratio, none, none
        length = np.sqrt((vectors * vectors).sum(axis=0))
        length = np.where(length > 0.0, length, 1.0)
        arm = none + 1.0 if self.points.wires else h / self.law.d  # arcs are measured on the arm d
        bound = self.law.mu * press * arm
        change = self.law.mu * (-rise * arm + (0.0 if self.points.wires else press / self.law.d))
        s = self.slides
        return (
            press, rise, np.where(s, bound / length, ratio), np.where(s, change / length, 0.0),
            np.where(s, -bound / length**3, 0.0),
        )  # fmt: skip

    def _sum(self, side: int, poses: Poses, weight: np.ndarray, arm: np.ndarray) -> np.ndarray:
        """Sum over the two nodes of a point of weighted positions and arms turned with the node."""
        k = self.index[:, side]
        return np.add(*(
            weight[k, slot] * x + rotated(q, like(x, arm[k, slot].T))
            for slot, (x, q) in enumerate(poses[2 * side : 2 * side + 2])
        ))  # fmt: skip

    def _section(self, side: int, poses: Poses, vectors: np.ndarray) -> np.ndarray:
        """Vectors (3, pairs) fixed to sections at rest, as turned now."""
        turn = self.points.turn[self.index[:, side]].T
        one, two = (rotated(q, like(x, vectors)) for x, q in poses[2 * side : 2 * side + 2])
        return turn[0] * one + turn[1] * two

    def _at_rest(self, side: int, poses: Poses, vectors: np.ndarray) -> np.ndarray:
        """Vectors (pairs, 3) at rest which the sections turn into those given, (3, pairs)."""
        count = vectors.shape[1]
        columns = [self._section(side, poses, np.repeat(one[:, None], count, axis=1)) for one in np.eye(3)]
        return np.linalg.solve(np.stack(columns).transpose(2, 1, 0), vectors.T[..., None])[..., 0]


def _across(vectors: np.ndarray, n: np.ndarray) -> np.ndarray:
    """The parts of vectors (3, ...) across the normals."""
    return vectors - n * (vectors * n).sum(axis=0)


def _along(slip: np.ndarray, n: np.ndarray) -> np.ndarray:
    """Directions (3, pairs) of slips across the normals, or zero."""
    part = _across(slip, n)
    return part / np.maximum(np.sqrt((part * part).sum(axis=0)), TINY)


def fresh_pairs(points: Points, law: Law, rest: np.ndarray, index: np.ndarray) -> Pairs:
    """Pairs of contact points that remember nothing."""
    count = len(index)
    no, zero = np.zeros(count, bool), np.zeros((count, 3))
    made = Pairs(
        points, law, index, np.zeros(count), points.spacings(index), no, no, no, np.ones(count), zero, zero
    )
    return replace(made, rest_overlap=np.maximum(made.depth(rest), 0.0)) if points.wires else made


def known_pairs(points: Points, law: Law, rest: np.ndarray, path: EquilibriumPath, row: int) -> Pairs:
    """Pairs of a path's row: those of the model and what each remembers, and all others that touch."""
    assert path.histories is not None
    index = path.shape.pair_law.pairs
    history = path.histories[row]
    held = history["closed"] & (history["released"] < 1.0) & (law.mu > 0.0)
    one, two = (history["arms"][:, :3], history["arms"][:, 3:]) if points.wires else (
        history["vector"], history["normal"],
    )  # fmt: skip
    rows = path.states[row].reshape(-1, 7)
    more = points.missing(rows, index, law.d)

    def padded(values: np.ndarray) -> np.ndarray:
        return np.concatenate((values, np.zeros((len(more), *values.shape[1:]), values.dtype)))

    made = replace(
        fresh_pairs(points, law, rest, np.concatenate((index, more)).astype(int)),
        held=padded(held), arcs=padded(history["grazes"]) | np.isfinite(law.mu),
        share=1.0 - padded(history["released"]), one=padded(one), two=padded(two),
    )  # fmt: skip
    if not held.any() or not np.isfinite(law.mu):
        return made
    # by Coulomb's law those slide of which sticking would take more than the bound; none in less than FINEST
    normal, force = made.forces(rows)
    finest = FINEST * law.d * law.sticking * made.weight
    softer = np.where(normal > 0.0, np.minimum(law.mu * normal / finest, 1.0), 1.0)
    made = replace(made, share=made.share * softer)
    force = made.forces(rows)[1]
    slides = made.held & (np.linalg.norm(force, axis=1) > (1.0 - SLIDES) * law.mu * normal)
    return replace(made, slides=slides)
