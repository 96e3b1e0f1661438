"""Where a wire's coils slide off each other under Coulomb friction, for the verifier.

The unknowns are the wire's nodes, the normal forces of the pairs that touch and the load: Coulomb's law
takes those normal forces, and its tangent is unsymmetric. The distance along the path is prescribed in
place of the load, which may so pass through its highest value, a limit point.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from coilspring import EquilibriumPath
from validation.campaign.poses import NUDGE, differences, moved
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
        n = w / _sizes(w)
        turned = _tangential(self.force, n)
        turned *= _ratio(_sizes(self.force), _sizes(turned))
        return turned + self.forces.penalty * _tangential(w - self.gap, n)

    def law(self, w: np.ndarray, press: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Tangential forces (pairs, 3) by Coulomb's law with the normal forces `press`, and their
        derivatives in `w` and `press`."""
        pull, bound, h = self.pull(w), self.mu * press[:, None], NUDGE * self.forces.d
        slope = np.stack([self.pull(w + step) - self.pull(w - step) for step in h * np.eye(3)], axis=2)
        slope /= 2.0 * h
        size = _sizes(pull)
        t = _ratio(pull, size)
        slides = self.slides[:, None] | (size > bound)
        transverse = np.eye(3) - t[:, :, None] * t[:, None, :]
        turning = _ratio(bound, size)[..., None] * (transverse @ slope)
        return (
            np.where(slides, bound * t, pull),
            np.where(slides[..., None], turning, slope),
            np.where(slides, self.mu * t, 0.0),
        )

    def contact(self, rows: np.ndarray, press: np.ndarray) -> np.ndarray:
        """Gradient (6 nodes,) of the pairs' forces, and after it what their gaps (pairs,) are too wide by."""
        w = self.vectors(rows)
        h = _sizes(w)
        gradient = self.spread(rows, press[:, None] * w / h - self.law(w, press)[0])
        return np.append(gradient, h[:, 0] - self.forces.d + self.depth(press))

    def tangent(self, rows: np.ndarray, press: np.ndarray) -> np.ndarray:
        """Derivative of `contact` in the moves and spins of all nodes and in the normal forces."""
        size, w = 6 * len(rows), self.vectors(rows)
        h = _sizes(w)
        n = w / h
        force, slope, rise = self.law(w, press)
        gradient = press[:, None] * n - force
        slope = slope - (press[:, None] / h)[..., None] * (np.eye(3) - n[:, :, None] * n[:, None, :])

        def held(at: np.ndarray) -> np.ndarray:
            return np.append(self.spread(at, gradient), self.vectors(at))

        J = np.zeros((size + len(press), size + len(press)))
        touched = np.unique(self.forces.attached[self.pairs])
        for node, i, change in differences(held, rows, self.forces.d, touched):
            moves = change[size:].reshape(-1, 3)
            pulled = self.spread(rows, -np.einsum("mij,mj->mi", slope, moves))
            J[:, 6 * node + i] = np.append(change[:size] + pulled, (n * moves).sum(axis=1))
        for m, one in enumerate(np.eye(len(press))):
            J[:size, size + m] = self.spread(rows, one[:, None] * (n - rise))
        J[size:, size:] = np.diag(self.depth(press) / (self.forces.exponent * press))
        J[:, :size] *= ~self.forces.fixed.ravel()
        return J

    def spread(self, rows: np.ndarray, gradient: np.ndarray) -> np.ndarray:
        """Gradient (6 nodes,) from that at the lower spheres, 0 where the wire is held."""
        return np.where(self.forces.fixed, 0.0, self.forces.spread(rows, self.pairs, gradient)).ravel()

    def depth(self, press: np.ndarray) -> np.ndarray:
        """Penetrations (pairs,) that go with normal forces."""
        return np.sign(press) * (np.abs(press) / self.forces.penalty) ** (1.0 / self.forces.exponent)

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
    tangent = np.pad(forces.element_tangent(rows), (0, count)) + pairs.tangent(rows, press)
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
        if len(times) > 3 and times[-1] < times[-2]:  # the top of a parabola through the last three
            curve = np.polynomial.Polynomial.fit(distances[-3:], times[-3:], 2)
            return float(curve(curve.deriv().roots()[0]))
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
    forces, size, count = pairs.forces, len(load), len(load) + len(press)
    most, move = float(np.abs(move[:size]).max()), move.copy()
    rows, press, time = moved(rows, move[:size]), press + move[size:count], time + move[count]
    matrix = np.zeros((count + 1, count + 1))
    matrix[:size, count], matrix[count, :size] = -load, control
    wire = np.pad(forces.element_tangent(rows), (0, len(press)))
    for _ in range(MOST_CORRECTIONS):
        left = pairs.contact(rows, press)
        left[:size] += forces.element_forces(rows).ravel() - time * load
        left[:size] *= ~forces.fixed.ravel()
        matrix[:count, :count] = wire + pairs.tangent(rows, press)
        change = np.linalg.solve(matrix, np.append(-left, 0.0))
        if not np.isfinite(change).all() or np.abs(change[:size]).max() > most:
            return None
        rows, press = moved(rows, change[:size]), press + change[size:count]
        move, time = move + change, time + change[count]
        if np.abs(change[:size]).max() <= CLOSE * most:
            return rows, press, move
    return None


def _sizes(v: np.ndarray) -> np.ndarray:
    return np.linalg.norm(v, axis=1, keepdims=True)


def _tangential(v: np.ndarray, n: np.ndarray) -> np.ndarray:
    return v - (v * n).sum(axis=1, keepdims=True) * n


def _ratio(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.divide(a, b, out=np.zeros_like(a), where=b > 0.0)
