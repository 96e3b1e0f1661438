"""Potential energy of the equivalent beam in the plane across, for judging: shares nothing with the solver.

Written from docs/theory.md, section 2, as `validation.campaign.energy` is, which does what both planes share.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from coilspring import Scene
from validation.campaign.energy import PlaneEnergy, measures
from validation.campaign.laws import Helices, Pair, helices_of, helix_law, reach, wound

NODES = 4  # that a pair couples


@dataclass(frozen=True)
class Side:
    """The circles on one side of all pairs, each a sum over the four nodes of its pair.

    Attributes
    ----------
    weights : (4, pairs) shares of the nodes in carrying it.
    bow : (4, pairs) rise with the rotations of the nodes, mm.
    offset : (2, pairs) from what carries it at rest, in the plane.
    """

    weights: np.ndarray
    bow: np.ndarray
    offset: np.ndarray


@dataclass(frozen=True, kw_only=True)
class AcrossEnergy(PlaneEnergy):
    """`PlaneEnergy` in the plane across.

    Attributes
    ----------
    first : (pairs,) lowest of the four nodes of each pair.
    sides : lower and upper circles.
    beside : (pairs,) distance of the centres at rest beside the plane.
    lean, grow : (3, pairs) factors of chi and of rho - rho0 of the elements between the four nodes.
    helices, ends : of these elements, each (3, pairs).
    """

    first: np.ndarray
    sides: tuple[Side, Side]
    beside: np.ndarray
    lean: np.ndarray
    grow: np.ndarray
    helices: Helices
    ends: Pair

    @cached_property
    def _pair_places(self) -> np.ndarray:
        return np.arange(3 * NODES)[:, None] + 3 * self.first

    def _of(self, index: np.ndarray | slice) -> AcrossEnergy:
        """What belongs to some pairs."""
        sides = [Side(s.weights[:, index], s.bow[:, index], s.offset[:, index]) for s in self.sides]
        h = self.helices
        return replace(
            self,
            sides=(sides[0], sides[1]),
            beside=self.beside[index],
            lean=self.lean[:, index],
            grow=self.grow[:, index],
            helices=replace(h, s=h.s[:, index], L=h.L[:, index], u0=h.u0[:, index]),
            ends=(self.ends[0][:, index], self.ends[1][:, index]),
        )

    def wound(self, l: np.ndarray) -> tuple[np.ndarray, ...]:  # noqa: E741
        """`validation.campaign.laws.wound` at lengths (3, ..., pairs)."""
        h = self.helices
        helices = replace(h, s=_over(h.s, l), L=_over(h.L, l), u0=_over(h.u0, l))
        return wound(helices, (_over(self.ends[0], l), _over(self.ends[1], l)), l)

    def _pair_vectors(self, x: np.ndarray, index: np.ndarray | slice) -> tuple[np.ndarray, ...]:
        """Vectors (3, ...) between the centres of the pairs."""
        mine = self._of(index)
        g: Any = 0.0
        for side, sign in zip(mine.sides, (-1.0, 1.0), strict=True):
            g = g + sign * (_carried(side, x) + _arm(side, x))
        chi, _, rho, _ = mine.wound(_lengths(x)[0])
        rise = -(_over(mine.lean, chi) * chi).sum(axis=0)
        out = mine.beside + (_over(mine.grow, rho) * rho).sum(axis=0)
        return (np.stack((g[0], g[1] + rise, out + 0.0 * g[0])),)

    def _pair_forces(self, x: np.ndarray, index: np.ndarray) -> np.ndarray:
        """Forces (12, ...) of the contact pairs on their nodes."""
        mine, total = self._of(index), np.zeros(x.shape, dtype=x.dtype)
        px, py, pz = self._pulls(self._pair_vectors(x, index)[0])
        for side, sign in zip(mine.sides, (-1.0, 1.0), strict=True):
            across, along = _arm(side, x)
            for k in range(NODES):
                total[3 * k] += sign * side.weights[k] * px
                total[3 * k + 1] += sign * side.weights[k] * py
                turned = side.weights[k] * (across * py - along * px) + side.bow[k] * py
                total[3 * k + 2] += sign * turned
        l, v, c, s = _lengths(x)  # noqa: E741
        _, chi1, _, rho1 = mine.wound(l)
        pull = _over(mine.grow, rho1) * rho1 * pz - _over(mine.lean, chi1) * chi1 * py
        for j in range(NODES - 1):
            for node, sign in ((j, -1.0), (j + 1, 1.0)):
                total[3 * node] -= sign * s[j] * pull[j]
                total[3 * node + 1] += sign * c[j] * pull[j]
                total[3 * node + 2] -= 0.5 * v[j] * pull[j]
        return total


def across_energy(scene: Scene) -> AcrossEnergy:
    """The scene's equivalent beam in the plane across."""
    spring, contact = scene.spring, scene.contact
    count = round(2 * spring.active_coils)
    phases = np.concatenate(([0.0], (np.arange(count) + 0.5) * math.pi, [count * math.pi]))
    rest = np.zeros((count + 2, 3))
    rest[:, 1] = spring.active_height * phases / phases[-1]
    helices = helices_of(scene, phases)
    ends = reach(helices)[2]
    free = np.setdiff1d(np.arange(3, rest.size), (rest.size - 3, rest.size - 1))
    force = np.zeros(rest.size)
    force[-2] = scene.load.force[1]
    first, sides, beside, lean, grow = _pairs(scene, count)
    between = first + np.arange(NODES - 1)[:, None]
    return AcrossEnergy(
        rest=rest.ravel(),
        law=helix_law(scene, phases, 0.5 * math.pi),
        d=spring.wire_diameter,
        stiffness=contact.stiffness,
        exponent=contact.exponent,
        free=free,
        force=force[free],
        size=max(spring.mean_diameter),
        first=first,
        sides=sides,
        beside=beside,
        lean=lean,
        grow=grow,
        helices=replace(helices, s=helices.s[between], L=helices.L[between], u0=helices.u0[between]),
        ends=(ends[0][between], ends[1][between]),
    )


def _pairs(scene: Scene, count: int) -> tuple:
    """First nodes, sides, distances beside the plane, and the factors of angles and radii."""
    spring, last = scene.spring, count + 1
    ends = int(4 * spring.end_turns + 1e-9)
    circles = [_circle(scene, k, count) for k in range(-ends, 2 * count + ends + 1)]
    kept = [
        (a, b)
        for a, b in zip(circles[:-4], circles[4:], strict=True)
        if scene.contact.enabled and not (a["rigid"] and b["rigid"] and a["node"] == b["node"])
    ]
    first = np.array([min(a["node"], last - 3) for a, _ in kept], dtype=int)
    sides = []
    for which in range(2):
        side = Side(np.zeros((4, len(kept))), np.zeros((4, len(kept))), np.zeros((2, len(kept))))
        for m, pair in enumerate(kept):
            circle, k = pair[which], pair[which]["node"] - first[m]
            side.offset[:, m] = circle["offset"]
            side.weights[k, m] = 1.0 if circle["rigid"] or circle["inside"] else 0.5
            if side.weights[k, m] == 0.5:
                side.weights[k + 1, m] = 0.5
                side.bow[k : k + 2, m] = circle["bow"] * np.array([-1.0, 1.0])
        sides.append(side)
    beside = np.array([b["beside"] - a["beside"] for a, b in kept])
    lean, grow = np.zeros((3, len(kept))), np.zeros((3, len(kept)))
    for m, (a, b) in enumerate(kept):
        if a["inside"]:
            continue
        arm = 0.5 * (abs(a["beside"]) + abs(b["beside"]))
        low = a["phase"]
        for e, factor in ((low, 1.0), (low + 1, -2.0), (low + 2, 1.0)):
            lean[min(max(e, 0), count) - first[m], m] += factor * arm
        for circle, sign in ((a, -1.0), (b, 1.0)):
            if not circle["rigid"]:
                grow[circle["node"] - first[m], m] += sign * np.sign(circle["beside"])
    return first, (sides[0], sides[1]), beside, lean, grow


def _circle(scene: Scene, k: int, count: int) -> dict:
    """The circle at the phase k pi / 2: the node that carries it, or the one below, and where it stands."""
    spring = scene.spring
    bottom, top = spring.mean_diameter
    phase, end = 0.5 * math.pi * k, math.pi * count
    share = min(max(phase / end, 0.0), 1.0)
    radius = 0.5 * (bottom + (top - bottom) * share)
    rigid, inside = not 0 < k < 2 * count, k % 2 == 1
    node = (0 if k <= 0 else count + 1) if rigid else (k + 1) // 2
    side = 1.0 if node % 2 == 1 else -1.0  # of the node at pi/2 + (node - 1) pi
    rise = spring.wire_diameter * (phase - end * share) / (2.0 * math.pi)
    return {
        "node": node,
        "phase": k // 2,
        "rigid": rigid,
        "inside": inside,
        "offset": (round(math.sin(phase)) * radius, rise),
        "beside": round(math.cos(phase)) * radius,
        "bow": -side * radius / math.pi,
    }


def _over(factors: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Factors (3, pairs) against values (3, ..., pairs)."""
    return factors.reshape(3, *(1,) * (values.ndim - 2), -1)


def _carried(side: Side, x: np.ndarray) -> np.ndarray:
    """Where the circles of a side are carried, (2, ...), their arms left out."""
    w, bow = side.weights, side.bow
    return np.stack((
        sum(w[k] * x[3 * k] for k in range(NODES)),
        sum(w[k] * x[3 * k + 1] + bow[k] * x[3 * k + 2] for k in range(NODES)),
    ))  # fmt: skip


def _arm(side: Side, x: np.ndarray) -> np.ndarray:
    """Arms in the plane, (2, ...), turned."""
    theta = sum(side.weights[k] * x[3 * k + 2] for k in range(NODES))
    c, s, (inside, rise) = np.cos(theta), np.sin(theta), side.offset
    return np.stack((c * inside - s * rise, s * inside + c * rise))


def _lengths(x: np.ndarray) -> tuple[np.ndarray, ...]:
    """Length, shear, cosine and sine (3, ...) of the elements between the four nodes."""
    found = [measures(x[3 * j : 3 * j + 6]) for j in range(NODES - 1)]
    l, v, _, c, s = (np.stack(each) for each in zip(*found, strict=True))  # noqa: E741
    return l, v, c, s
