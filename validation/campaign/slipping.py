"""Where a wire's coils slide off each other under Coulomb friction, for the verifier.

The unknowns are the wire's nodes, the normal forces of the pairs that touch and the load: Coulomb's law
takes those normal forces, and its tangent is unsymmetric. The distance along the path is prescribed in
place of the load, which may so pass through its highest value, a limit point.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from coilspring import EquilibriumPath
from validation.campaign.poses import NUDGE, moved, nudged, width
from validation.campaign.wire import WireForces, friction_of

SLIDES = 1e-3  # of its bound: a pair nearer to it slides on
TO_LIMIT = 10  # steps of the rate at the start to where the load would reach the limit point
MOST_STEPS = 8 * TO_LIMIT
LEAST_STEP = 1e-3  # of the first one
MOST_CORRECTIONS = 20
CLOSE = 1e-6  # of a step, at which a state counts as found


@dataclass(frozen=True)
class Slipping:
    """Pairs of a wire that touch, as they were where the last state was found.

    Attributes
    ----------
    forces : of the wire.
    mu : coefficient of friction.
    pairs : (pairs, 2) spheres.
    gap : (pairs, 3) from the lower to the upper centre.
    force : (pairs, 3) tangential force on the lower sphere.
    slides : (pairs,) of those that must slide, whatever they are pulled by; else the law decides.
    """

    forces: WireForces
    mu: float
    pairs: np.ndarray
    gap: np.ndarray
    force: np.ndarray
    slides: np.ndarray

    def vectors(self, rows: np.ndarray) -> np.ndarray:
        """Vectors (pairs, 3) from the lower to the upper centres."""
        centres = self.forces.centres(rows)
        return centres[self.pairs[:, 1]] - centres[self.pairs[:, 0]]

    def pull(self, w: np.ndarray) -> np.ndarray:
        """Tangential forces (pairs, 3) on the lower spheres if nothing slid any more."""
        n = w / np.linalg.norm(w, axis=1, keepdims=True)
        turned = _across(self.force, n)
        turned *= _ratio(np.linalg.norm(self.force, axis=1), np.linalg.norm(turned, axis=1))[:, None]
        return turned + self.forces.penalty * _across(w - self.gap, n)

    def law(self, w: np.ndarray, press: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Tangential forces (pairs, 3) by Coulomb's law with the normal forces `press`, and their
        derivatives in `w` and `press`."""
        pull, bound, moves = self.pull(w), self.mu * press, NUDGE * self.forces.d * np.eye(3)
        slope = np.stack([self.pull(w + one) - self.pull(w - one) for one in moves], axis=2)
        slope /= 2.0 * NUDGE * self.forces.d
        size = np.linalg.norm(pull, axis=1)
        t = pull * _ratio(np.ones_like(size), size)[:, None]
        slides = self.slides | (size > bound)
        across = np.eye(3) - t[:, :, None] * t[:, None, :]
        turning = _ratio(bound, size)[:, None, None] * (across @ slope)
        return (
            np.where(slides[:, None], bound[:, None] * t, pull),
            np.where(slides[:, None, None], turning, slope),
            np.where(slides[:, None], self.mu * t, 0.0),
        )

    def contact(self, rows: np.ndarray, press: np.ndarray) -> np.ndarray:
        """Gradient (nodes, 6) of the pairs' forces, and after it what their gaps (pairs,) are too wide by."""
        w = self.vectors(rows)
        h = np.linalg.norm(w, axis=1)
        force = self.law(w, press)[0] - (press / h)[:, None] * w
        return np.append(self.spread(rows, force), h - self.forces.d + self.depth(press))

    def contact_tangent(self, rows: np.ndarray, press: np.ndarray) -> np.ndarray:
        """Derivative of `contact` in the moves and spins of all nodes and in the normal forces."""
        size, d, w = 6 * len(rows), self.forces.d, self.vectors(rows)
        h = np.linalg.norm(w, axis=1)
        n = w / h[:, None]
        tangential, slope, rise = self.law(w, press)
        force = tangential - press[:, None] * n
        slope = slope - (press / h)[:, None, None] * (np.eye(3) - n[:, :, None] * n[:, None, :])
        J = np.zeros((size + len(press), size + len(press)))
        for node in np.unique(self.forces.attached[self.pairs]):
            for i in range(6):
                ends = [nudged(rows, node, i, step, d) for step in (NUDGE, -NUDGE)]
                change = (self.vectors(ends[0]) - self.vectors(ends[1])) / width(i, d)
                turned = (self.spread(ends[0], force) - self.spread(ends[1], force)) / width(i, d)
                pull = np.einsum("mij,mj->mi", slope, change)
                J[:, 6 * node + i] = np.append(turned + self.spread(rows, pull), (n * change).sum(axis=1))
        for m in range(len(press)):
            one = np.arange(len(press))[:, None] == m
            J[:size, size + m] = self.spread(rows, np.where(one, rise - n, 0.0))
            J[size + m, size + m] = self.depth(press)[m] / (self.forces.exponent * press[m])
        J[:, :size] *= ~self.forces.fixed.ravel()
        return J

    def spread(self, rows: np.ndarray, force: np.ndarray) -> np.ndarray:
        """Gradient (6 nodes,) of forces (pairs, 3) on the lower spheres and their opposites on the upper
        ones."""
        total = np.zeros((len(rows), 6))
        for (low, high), one in zip(self.pairs, force, strict=True):
            self.forces.add_force(total, rows, low, -one)
            self.forces.add_force(total, rows, high, one)
        return np.where(self.forces.fixed, 0.0, total).ravel()

    def depth(self, press: np.ndarray) -> np.ndarray:
        """Penetrations (pairs,) that go with normal forces."""
        size = (np.abs(press) / self.forces.penalty) ** (1.0 / self.forces.exponent)
        return np.sign(press) * size

    def of(self, chosen: np.ndarray) -> Slipping:
        """Some of the pairs."""
        mine = {name: getattr(self, name)[chosen] for name in ("pairs", "gap", "force", "slides")}
        return replace(self, **mine)

    def after(self, rows: np.ndarray, press: np.ndarray) -> Slipping:
        """The pairs as they are at a state that was found."""
        w = self.vectors(rows)
        return replace(self, gap=w, force=self.law(w, press)[0], slides=np.zeros(len(w), dtype=bool))


def highest_load(forces: WireForces, path: EquilibriumPath, time: float, critical: float) -> float | None:
    """Highest time that equilibria reach from the last state of a path on, which belongs to `time`, where
    they tend to `critical`; None where they are lost, or reach no highest one near there."""
    pairs, press = _touching(forces, path)
    rows = path.states[-1].reshape(-1, 7)
    size, count = 6 * len(rows), len(press)
    load = np.zeros(size)
    load[-6:-4] = forces.load
    tangent = wire_tangent(forces, rows, count) + pairs.contact_tangent(rows, press)
    rate = np.linalg.solve(tangent, np.append(load, np.zeros(count)))
    # moves alone measure the distance: spins are of another unit
    control = (rate[:size].reshape(-1, 6) * [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]).ravel()
    control /= control @ rate[:size]
    step, times, distances = (critical - time) / TO_LIMIT, [time], [0.0]
    move, pairs = np.append(step * rate, step), replace(pairs, slides=np.zeros(count, dtype=bool))
    while len(times) <= MOST_STEPS:
        found = _settled(pairs, rows, press, times[-1], move, control, load)
        if found is None:
            move = 0.5 * move
            if control @ move[:size] < LEAST_STEP * step:
                return None
            continue
        closed = found[1] > 0.0
        if not closed.all():  # what opens is left out from the step's beginning on
            pairs, press = pairs.of(closed), press[closed]
            move = np.delete(move, size + np.flatnonzero(~closed))
            continue
        rows, press, move = found
        pairs = pairs.after(rows, press)
        times.append(times[-1] + move[-1])
        distances.append(distances[-1] + float(control @ move[:size]))
        if len(times) > 3 and times[-1] < times[-2]:
            return _peak(distances[-3:], times[-3:])
    return None


def sliding_pairs(forces: WireForces, path: EquilibriumPath) -> np.ndarray:
    """Which pairs of those that touch at the last state of a path slide."""
    return _touching(forces, path)[0].slides


def _touching(forces: WireForces, path: EquilibriumPath) -> tuple[Slipping, np.ndarray]:
    """Pairs that touch at the last state of a path and their normal forces; those at their bounds slide
    on."""
    known, force = friction_of(path, -1)
    hit = path.gaps[-1] < 0.0
    none = np.zeros(int(hit.sum()), dtype=bool)
    pairs = Slipping(forces, path.scene.contact.coefficient, known[hit], force[hit], force[hit], none)
    w = pairs.vectors(path.states[-1].reshape(-1, 7))
    press = forces.penalty * (forces.d - np.linalg.norm(w, axis=1)) ** forces.exponent
    slides = np.linalg.norm(force[hit], axis=1) > (1.0 - SLIDES) * pairs.mu * press
    return replace(pairs, gap=w, slides=slides), press


def _settled(
    pairs: Slipping,
    rows: np.ndarray,
    press: np.ndarray,
    time: float,
    move: np.ndarray,
    control: np.ndarray,
    load: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Equilibrium from the guess of a step, as far along the path: nodes, normal forces (below zero where a
    pair would have to be pulled), and the step made."""
    size, count = len(load), len(load) + len(press)
    most, move = float(np.abs(move[:size]).max()), move.copy()
    rows, press, time = moved(rows, move[:size]), press + move[size:count], time + move[count]
    matrix = np.zeros((count + 1, count + 1))
    matrix[:size, count], matrix[count, :size] = -load, control
    wire, free = wire_tangent(pairs.forces, rows, len(press)), ~pairs.forces.fixed.ravel()
    for _ in range(MOST_CORRECTIONS):
        left = pairs.contact(rows, press)
        left[:size] = free * (left[:size] + pairs.forces.element_forces(rows).ravel() - time * load)
        matrix[:count, :count] = wire + pairs.contact_tangent(rows, press)
        change = np.linalg.solve(matrix, np.append(-left, 0.0))
        if not np.isfinite(change).all() or np.abs(change[:size]).max() > most:
            return None
        rows, press = moved(rows, change[:size]), press + change[size:count]
        move, time = move + change, time + change[count]
        if np.abs(change[:size]).max() <= CLOSE * most:
            return rows, press, move
    return None


def wire_tangent(forces: WireForces, rows: np.ndarray, pairs: int) -> np.ndarray:
    """Derivative of the elements' forces, by central differences, with room for normal forces; 1 where
    held."""
    nodes, d = len(rows), forces.d
    J: np.ndarray = np.zeros((nodes, 6, nodes, 6))
    for first in range(3):  # an element joins two nodes: every third may be moved at once
        some = np.arange(first, nodes, 3)
        for i in range(6):
            ends = [forces.element_forces(nudged(rows, some, i, h, d)) for h in (NUDGE, -NUDGE)]
            change = (ends[0] - ends[1]) / width(i, d)
            for node in some:
                near = slice(max(node - 1, 0), node + 2)
                J[near, :, node, i] = change[near]
    held, size = forces.fixed.ravel(), 6 * nodes
    J = J.reshape(size, size)
    J[held], J[:, held] = 0.0, 0.0
    J[held, held] = 1.0
    return np.pad(J, (0, pairs))


def _peak(distances: list[float], times: list[float]) -> float:
    """Top of the parabola through three times on the path, the middle one the highest."""
    curve = np.polynomial.Polynomial.fit(distances, times, 2)
    return float(curve(curve.deriv().roots()[0]))


def _across(v: np.ndarray, n: np.ndarray) -> np.ndarray:
    return v - (v * n).sum(axis=1, keepdims=True) * n


def _ratio(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.divide(a, b, out=np.zeros_like(a), where=b > 0.0)
