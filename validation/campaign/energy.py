"""Potential energy of the equivalent beam in plain numpy, for the verifier: shares nothing with the solver.

Written from docs/theory.md, section 2. Forces are the hand-written gradient of the energy, the Hessian their
derivative by complex steps, which is exact to rounding. A state holds x, y, theta of all nodes, flat.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from scipy.linalg import solve_triangular

from coilspring import Scene
from equivbeam.laws import law_of
from validation.campaign.laws import haringx_law, helix_law
from validation.campaign.plainlaw import plain_law

Law = Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, ...]]
LAWS: dict[str, Callable[[Scene], Law]] = {"haringx": haringx_law, "helix": helix_law}
TINY = 1e-30  # of a complex step
PAIRS_A_TURN = 2  # in the plane; the scene's stiffness is that of a pair at 4 a turn


@dataclass(frozen=True, kw_only=True)
class BeamEnergy:
    """Energy of one scene at load factor t: U + C - t f . u.

    Attributes
    ----------
    rest : (3 nodes,) state at rest.
    law : (l, v, dtheta) of all half coils -> energy, N, T, M of each.
    d, stiffness, exponent : of the contact.
    free : indices of the free degrees of freedom.
    force : (free,) load at time 1.
    size : length that turns rotations into displacements, mm.
    carriers : (2, pairs) nodes that carry the circles of each pair.
    offsets : (2, pairs, 2) from the nodes to the circles' centres at rest.
    displacement : UY of the top that is prescribed at time 1, mm; 0 under a force. `force` then is what this
        motion does to the spring at rest, linearly, and measures residuals alone.
    """

    rest: np.ndarray
    law: Law
    d: float
    stiffness: float
    exponent: float
    free: np.ndarray
    force: np.ndarray
    size: float
    carriers: np.ndarray
    offsets: np.ndarray
    displacement: float = 0.0

    @property
    def top(self) -> int:
        """Freedom of the top's y."""
        return self.rest.size - 2

    def residual(self, state: np.ndarray, time: float, closed: np.ndarray | None = None) -> np.ndarray:
        """Forces out of balance on the free degrees of freedom."""
        return self.gradient(state, closed) - (0.0 if self.displacement else time * self.force)

    def rate(self, state: np.ndarray, closed: np.ndarray | None = None) -> np.ndarray:
        """What time does to the free degrees of freedom: less the derivative of the residual."""
        if not self.displacement:
            return self.force
        return -self.displacement * self._stiffness(state, closed)[self.free, self.top]

    def placed(self, state: np.ndarray, time: float) -> np.ndarray:
        """The state with the top where it is prescribed."""
        if self.displacement:
            state[self.top] = self.rest[self.top] + time * self.displacement
        return state

    def driven(self, displacement: float) -> BeamEnergy:
        """The same spring with UY of its top prescribed."""
        free = self.free[self.free != self.top]
        made = replace(self, free=free, force=np.zeros(free.size), displacement=displacement)
        return replace(made, force=made.rate(self.rest, made._open))

    def energy(self, state: np.ndarray) -> float:
        """Strain and contact energy."""
        l, v, turn = measures(state[self._element_places])[:3]  # noqa: E741
        strain = self.law(l, v, turn)[0].sum()
        depth = np.maximum(self.d - self._distances(state[self._pair_places], slice(None)), 0.0)
        return float(strain + (self.stiffness * depth ** (self.exponent + 1.0)).sum() / (self.exponent + 1.0))

    def gradient(self, state: np.ndarray, closed: np.ndarray | None = None) -> np.ndarray:
        """Internal forces on the free degrees of freedom; `closed`: the pairs that count as closed."""
        return self.forces(state, closed)[self.free]

    def forces(self, state: np.ndarray, closed: np.ndarray | None = None) -> np.ndarray:
        """Internal forces on all degrees of freedom."""
        total = np.zeros(self.rest.size)
        np.add.at(total, self._element_places, self._element_forces(state[self._element_places]))
        places, forces = self._pair_part(state, closed)
        np.add.at(total, places, forces(state[places]))
        return total

    def gradients(self, states: np.ndarray) -> np.ndarray:
        """Internal forces in many states, (states, free)."""
        total = np.zeros(states.shape)
        every = np.arange(self._pair_places.shape[1])
        for places in (self._element_places, self._pair_places):
            x = states[:, places].swapaxes(0, 1)  # (coordinate, state, item)
            if places is self._element_places:
                forces = self._element_forces(x)
            else:
                closed = self._distances(x, every) < self.d
                forces = np.where(closed, self._pair_forces(x, every), 0.0)
            np.add.at(total.T, places, forces.swapaxes(1, 2))
        return total[:, self.free]

    def hessian(self, state: np.ndarray, closed: np.ndarray | None = None) -> np.ndarray:
        """Second derivatives in the free degrees of freedom, dense."""
        dense = self._stiffness(state, closed)[np.ix_(self.free, self.free)]
        return 0.5 * (dense + dense.T)

    def _stiffness(self, state: np.ndarray, closed: np.ndarray | None) -> np.ndarray:
        """Second derivatives in all degrees of freedom."""
        total = np.zeros((self.rest.size, self.rest.size))
        _add_blocks(total, self._element_places, _jacobian(self._element_forces, state[self._element_places]))
        places, forces = self._pair_part(state, closed)
        if places.size:
            _add_blocks(total, places, _jacobian(forces, state[places]))
        return total

    def closed(self, state: np.ndarray) -> np.ndarray:
        """Which pairs touch.

        Given to `gradient` and `hessian`, these pairs push where they overlap and pull where they do not,
        so that nothing has a kink there.
        """
        return self._distances(state[self._pair_places], slice(None)) < self.d

    def _pair_part(
        self, state: np.ndarray, closed: np.ndarray | None
    ) -> tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]:
        """Freedoms of the closed pairs and their forces."""
        index = np.flatnonzero(self.closed(state) if closed is None else closed)
        return self._pair_places[:, index], partial(self._pair_forces, index=index)

    @cached_property
    def rest_factor(self) -> np.ndarray:
        """Cholesky factor of the Hessian at rest with all pairs open, in which stiffness is measured."""
        return np.linalg.cholesky(self.hessian(self.rest, self._open))

    @property
    def _open(self) -> np.ndarray:
        """All pairs open."""
        return np.zeros(self._pair_places.shape[1], dtype=bool)

    def relative(self, matrix: np.ndarray) -> np.ndarray:
        """The matrix in units of that at rest: its eigenvalues are ratios of stiffness."""
        half = solve_triangular(self.rest_factor, matrix, lower=True)
        whole = solve_triangular(self.rest_factor, half.T, lower=True)
        return 0.5 * (whole + whole.T)

    def share(self, residuals: np.ndarray) -> np.ndarray:
        """Residuals (free, ...) over the load at time 1, both in the energy norm of the spring at rest."""
        left, whole = (solve_triangular(self.rest_factor, b, lower=True) for b in (residuals, self.force))
        return np.linalg.norm(left, axis=0) / np.linalg.norm(whole)

    def moved(self, step: np.ndarray) -> float:
        """A step over what the load at time 1 moves the spring at rest, both in its energy norm."""
        whole = solve_triangular(self.rest_factor, self.force, lower=True)
        return float(np.linalg.norm(self.rest_factor.T @ step) / np.linalg.norm(whole))

    def least(self, state: np.ndarray) -> float:
        """Least eigenvalue of the Hessian in units of that at rest; positive where stable."""
        return float(np.linalg.eigvalsh(self.relative(self.hessian(state)))[0])

    @cached_property
    def _element_places(self) -> np.ndarray:
        first = 3 * np.arange(self.rest.size // 3 - 1)
        return np.arange(6)[:, None] + first[None]

    def _element_forces(self, x: np.ndarray) -> np.ndarray:
        """Forces (6, ...) of the half coils, equations (7)-(9)."""
        l, v, turn, c, s = measures(x)  # noqa: E741
        _, N, T, M = self.law(l, v, turn)
        fx, fy, arm = T * c - N * s, T * s + N * c, 0.5 * (T * l - N * v)
        return np.stack((-fx, -fy, arm - M, fx, fy, arm + M))

    def _distances(self, x: np.ndarray, index: np.ndarray | slice) -> np.ndarray:
        """Distances of the centres of pairs, real."""
        return np.linalg.norm(self._pair_vectors(x, index)[0], axis=0)

    @cached_property
    def _pair_places(self) -> np.ndarray:
        axis = np.arange(3)[:, None]
        return np.concatenate((3 * self.carriers[0] + axis, 3 * self.carriers[1] + axis))

    def _pair_vectors(self, x: np.ndarray, index: np.ndarray | slice) -> tuple[np.ndarray, ...]:
        """Vectors (2, ...) between the centres of the pairs, and from the nodes to the centres."""
        arms = []
        for theta, offset in zip((x[2], x[5]), self.offsets[:, index], strict=True):
            c, s, ox, oy = np.cos(theta), np.sin(theta), offset[:, 0], offset[:, 1]
            arms.append(np.stack((c * ox - s * oy, s * ox + c * oy)))
        return x[3:5] + arms[1] - x[0:2] - arms[0], arms[0], arms[1]

    def _pair_forces(self, x: np.ndarray, index: np.ndarray) -> np.ndarray:
        """Forces (6, ...) of the contact pairs on their nodes, with the moments r x F."""
        g, low, high = self._pair_vectors(x, index)
        px, py = self._pulls(g)
        return np.stack((-px, -py, low[1] * px - low[0] * py, px, py, high[0] * py - high[1] * px))

    def _pulls(self, g: np.ndarray) -> np.ndarray:
        """Derivative of the contact energy in the vectors between centres."""
        h = np.sqrt((g * g).sum(axis=0))
        sign = np.where(h.real < self.d, 1.0, -1.0)
        return -sign * self.stiffness * (sign * (self.d - h)) ** self.exponent * g / h


def beam_energy(scene: Scene, law: str) -> BeamEnergy:
    """The scene's equivalent beam."""
    spring, contact = scene.spring, scene.contact
    count = round(2 * spring.active_coils)
    rest = np.zeros((count + 1, 3))
    rest[:, 1] = np.linspace(0.0, spring.active_height, count + 1)
    carriers, offsets = _pairs(scene, count)
    if not contact.enabled:
        carriers, offsets = carriers[:, :0], offsets[:, :0]
    held = [3 * count + {"ux": 0, "rotz": 2}[name] for name in scene.supports.top_held]
    free = np.setdiff1d(np.arange(3, 3 * count + 3), held)
    force = np.zeros(rest.size)
    force[-3:-1] = scene.load.force
    return BeamEnergy(
        rest=rest.ravel(),
        law=LAWS[law](scene) if law in LAWS else plain_law(scene, law_of(law)),  # type: ignore[arg-type]
        carriers=carriers,
        offsets=offsets,
        d=spring.wire_diameter,
        stiffness=contact.stiffness * 4.0 / PAIRS_A_TURN,
        exponent=contact.exponent,
        free=free,
        force=force[free],
        size=max(spring.mean_diameter),
    )


def _pairs(scene: Scene, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Carriers and offsets of the circles one turn apart, those of one rigid end left out."""
    spring = scene.spring
    bottom, top = spring.mean_diameter
    ends = int(2 * spring.end_turns + 1e-9)
    side = 1 if math.cos(spring.start_phase) >= 0.0 else -1
    circles = []
    for i in range(-ends, count + ends + 1):
        node = min(max(i, 0), count)
        radius = 0.5 * (bottom + (top - bottom) * node / count)
        # circles of the end turns lie half a wire diameter apart in height
        circles.append((node, side * (-1) ** (i % 2) * radius, 0.5 * spring.wire_diameter * (i - node)))
    low, high = circles[:-2], circles[2:]
    kept = [(a, b) for a, b in zip(low, high, strict=True) if a[0] != b[0]]
    table = np.array(kept, dtype=float).reshape(-1, 2, 3).transpose(1, 0, 2)
    return table[..., 0].astype(int), table[..., 1:]


def measures(x: np.ndarray) -> tuple[np.ndarray, ...]:
    """(B1): l, v, dtheta, cosine and sine of the mean rotation, from the 6 coordinates of each half coil."""
    mean = 0.5 * (x[2] + x[5])
    c, s = np.cos(mean), np.sin(mean)
    ax, ay = x[3] - x[0], x[4] - x[1]
    return ay * c - ax * s, ax * c + ay * s, x[5] - x[2], c, s


def _jacobian(forces: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> np.ndarray:
    """Derivatives (coordinates, coordinates, items) of the forces by complex steps."""
    count = np.arange(len(x))
    moved = np.repeat(x[:, None].astype(complex), len(x), axis=1)  # (coordinate, step, item)
    moved[count, count] += 1j * TINY
    return forces(moved).imag / TINY


def _add_blocks(total: np.ndarray, places: np.ndarray, blocks: np.ndarray) -> None:
    rows = np.broadcast_to(places[:, None], blocks.shape)
    columns = np.broadcast_to(places[None], blocks.shape)
    np.add.at(total, (rows, columns), blocks)
