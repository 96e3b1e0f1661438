"""Forces and stiffness of the equivalent beam in plain numpy, for the verifier.

Written from docs/theory.md, section 2, without the solver's code; of a user's law its two Python functions
are called, without the derivatives that the solver makes of them. The stiffness is the derivative of the
forces by complex steps. A state holds x, y, theta of all nodes, flat.
"""

import math
from collections.abc import Callable
from functools import cached_property

import numpy as np
from scipy.linalg import solve_triangular

from coilspring import Scene, Spring
from equivbeam.laws.userlaw import UserLaw
from validation.campaign.coils import coil_shape, end_pitch, half_coils
from validation.campaign.laws import Law, haringx_law, helix_law, plain_law

LAWS: dict[str, Callable[[Scene], Law]] = {"haringx": haringx_law, "helix": helix_law}
TINY = 1e-30  # of a complex step
Closed = np.ndarray | bool | None  # which pairs count as closed; None: those that touch
PAIRS_A_TURN = 2  # in the plane; the scene's stiffness is that of a pair at 4 a turn


class BeamEnergy:
    """Gradient and Hessian of one scene's energy by a law at load factor t: U + C - t f . u."""

    def __init__(self, scene: Scene, law: str | UserLaw) -> None:
        spring, contact = scene.spring, scene.contact
        phases = half_coils(spring)
        count = phases.size - 1
        rest = np.zeros((count + 1, 3))
        rest[:, 1] = coil_shape(spring, phases)[1]
        self.rest = rest.ravel()
        self.top = self.rest.size - 2  # degree of freedom of the top's y
        # (l, v, dtheta) of all half coils -> N, T, M of each
        self.law = plain_law(scene, law) if isinstance(law, UserLaw) else LAWS[law](scene)
        self.d, self.exponent = spring.wire_diameter, contact.exponent
        self.stiffness = contact.stiffness * 4.0 / PAIRS_A_TURN
        node, offset = circles(spring)
        # circles i and i + 2 are pairs, those of one rigid end left out
        low = np.flatnonzero(node[:-2] != node[2:]) if contact.enabled else np.zeros(0, int)
        pairs = np.stack((low, low + 2))
        self.attached = node[pairs]  # (2, pairs) nodes to which the circles of each pair are attached
        self.offsets = offset[pairs]  # (2, pairs, 2) from the nodes to the circles' centres at rest
        held = [3 * count + {"ux": 0, "rotz": 2}[name] for name in scene.supports.top_held]
        self.free = np.setdiff1d(np.arange(3, 3 * count + 3), held)
        self.displacement = 0.0  # prescribed UY of the top at time 1, mm
        if scene.load.displacement:
            (self.displacement,) = scene.load.displacement
            # what this motion does to the spring at rest, linearly: it measures residuals alone
            self.free = self.free[self.free != self.top]
            self.force = self.rate(self.rest, False)
        else:
            force = np.zeros(self.rest.size)
            force[-3:-1] = scene.load.force
            self.force = force[self.free]  # load at time 1

    def placed(self, state: np.ndarray, time: float) -> np.ndarray:
        """The state with the top where it is prescribed."""
        if self.displacement:
            state[self.top] = self.rest[self.top] + time * self.displacement
        return state

    def residual(self, states: np.ndarray, times: float | np.ndarray, closed: Closed = None) -> np.ndarray:
        """Forces out of balance on the free degrees of freedom, of one or many states and times."""
        left = self.forces(states, closed)[..., self.free]
        return left if self.displacement else left - np.multiply.outer(times, self.force)

    def rate(self, state: np.ndarray, closed: Closed = None) -> np.ndarray:
        """What time does to the free degrees of freedom: less the derivative of the residual."""
        return self.force if not self.displacement else self._rate(self.tangent(state, closed))

    def forces(self, states: np.ndarray, closed: Closed = None) -> np.ndarray:
        """Internal forces on all degrees of freedom, of one or many states. Pairs that count as `closed` pull
        where they do not overlap, so that nothing has a kink there."""
        total = np.zeros(states.shape)
        values = self._item_forces(np.moveaxis(states.T[self._places], 1, -1), closed)
        np.add.at(total.T, self._places, np.moveaxis(values, -1, 1))
        return total

    def tangent(self, state: np.ndarray, closed: Closed = None) -> np.ndarray:
        """Derivative of the forces in all degrees of freedom, dense."""
        return self._expanded(state, closed)[1]

    def hessian(self, state: np.ndarray, closed: Closed = None) -> np.ndarray:
        """The tangent in the free degrees of freedom, which is symmetric."""
        return self._hessian(self.tangent(state, closed))

    def linearized(
        self, state: np.ndarray, time: float, closed: Closed = None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residual, Hessian and rate of one state, together."""
        forces, tangent = self._expanded(state, closed)
        left, H = forces[self.free], self._hessian(tangent)
        if self.displacement:
            return left, H, self._rate(tangent)
        return left - time * self.force, H, self.force

    def _expanded(self, state: np.ndarray, closed: Closed) -> tuple[np.ndarray, np.ndarray]:
        """Forces on all degrees of freedom, and their dense derivative."""
        x = np.repeat(state[self._places][:, None].astype(complex), 6, axis=1)  # (coordinate, step, item)
        x[np.arange(6), np.arange(6)] += 1j * TINY
        found, size = self._item_forces(x, closed), self.rest.size
        forces = np.bincount(self._places.ravel(), found[:, 0].real.ravel(), size)
        return forces, np.bincount(self._cells, found.imag.ravel() / TINY, size**2).reshape(size, size)

    def _hessian(self, tangent: np.ndarray) -> np.ndarray:
        dense = tangent[self.free][:, self.free]
        return 0.5 * (dense + dense.T)

    def _rate(self, tangent: np.ndarray) -> np.ndarray:
        return -self.displacement * tangent[self.free, self.top]

    def closed(self, state: np.ndarray, depth: float = 0.0) -> np.ndarray:
        """Which pairs touch, by more than a depth in wire diameters."""
        return self.depths(state) > depth * self.d

    def depths(self, states: np.ndarray) -> np.ndarray:
        """Penetrations (..., pairs) in one or many states, below zero where open."""
        near = np.moveaxis(states.T[self._pair_places], 1, -1)
        return self.d - np.linalg.norm(self._gaps(near)[0], axis=0)

    @cached_property
    def rest_factor(self) -> np.ndarray:
        """Cholesky factor of the Hessian at rest with all pairs open, in which stiffness is measured."""
        return np.linalg.cholesky(self.hessian(self.rest, False))

    @cached_property
    def load_norm(self) -> float:
        """What the load at time 1 makes of the spring at rest, in its energy norm."""
        return float(np.linalg.norm(self.reduced(self.force)))

    def reduced(self, forces: np.ndarray) -> np.ndarray:
        """Forces (free, ...), whose Euclidean norm then is the energy norm of the spring at rest."""
        return solve_triangular(self.rest_factor, forces, lower=True)

    def relative(self, matrix: np.ndarray) -> np.ndarray:
        """The matrix in units of that at rest: its eigenvalues are ratios of stiffness."""
        whole = self.reduced(self.reduced(matrix).T)
        return 0.5 * (whole + whole.T)

    def least(self, matrix: np.ndarray) -> float:
        """Least eigenvalue of a Hessian in units of that at rest; positive where stable."""
        return float(np.linalg.eigvalsh(self.relative(matrix))[0])

    @cached_property
    def _places(self) -> np.ndarray:
        """Degrees of freedom (6, items) of the half coils, then of the pairs."""
        elements = np.arange(6)[:, None] + 3 * np.arange(self.rest.size // 3 - 1)
        return np.concatenate((elements, self._pair_places), axis=1)

    @cached_property
    def _cells(self) -> np.ndarray:
        """Where the derivatives of the items' forces, (6, 6, items), stand in the tangent, all flat."""
        return (self._places[:, None] * self.rest.size + self._places).ravel()

    @cached_property
    def _pair_places(self) -> np.ndarray:
        return np.concatenate(3 * self.attached[:, None] + np.arange(3)[:, None])

    def _item_forces(self, x: np.ndarray, closed: Closed) -> np.ndarray:
        """Forces (6, ..., items) of the half coils and the pairs by their coordinates."""
        count = self.rest.size // 3 - 1
        pairs = self._pair_forces(x[..., count:], closed)
        return np.concatenate((self._element_forces(x[..., :count]), pairs), axis=-1)

    def _element_forces(self, x: np.ndarray) -> np.ndarray:
        """Forces (6, ...) of the half coils by (B1) and (7)-(9), from l, v, dtheta."""
        mean = 0.5 * (x[2] + x[5])
        c, s = np.cos(mean), np.sin(mean)
        ax, ay = x[3] - x[0], x[4] - x[1]
        l, v = ay * c - ax * s, ax * c + ay * s  # noqa: E741
        N, T, M = self.law(l, v, x[5] - x[2])
        fx, fy, moment = T * c - N * s, T * s + N * c, 0.5 * (T * l - N * v)
        return np.array((-fx, -fy, moment - M, fx, fy, moment + M))

    def _gaps(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Vectors (2, ...) between the centres of the pairs, and from both nodes to the centres."""
        low, high = (turned(x[i], *offset.T) for i, offset in zip((2, 5), self.offsets, strict=True))
        return x[3:5] + high - x[0:2] - low, low, high

    def _pair_forces(self, x: np.ndarray, closed: Closed) -> np.ndarray:
        """Forces (6, ...) of the contact pairs on their nodes, with the moments r x F."""
        g, low, high = self._gaps(x)
        h = np.sqrt((g * g).sum(axis=0))
        sign = np.where(h.real < self.d, 1.0, -1.0)
        size = -sign * self.stiffness * (sign * (self.d - h)) ** self.exponent / h
        px, py = np.where(h.real < self.d if closed is None else closed, size, 0.0) * g
        return np.array((-px, -py, low[1] * px - low[0] * py, px, py, high[0] * py - high[1] * px))


def circles(spring: Spring) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of all circles, half a turn apart, end turns included, and offsets (circles, 2) from them."""
    count, ends = round(2 * spring.active_coils), int(2 * spring.end_turns + 1e-9)
    index = np.arange(-ends, count + ends + 1)
    node = np.clip(index, 0, count)
    # of a wire that begins half way between both sides, the one at a smaller phase
    begin = math.floor(0.5 - spring.start_phase / math.pi + 1e-9)
    side = np.where((index + begin) % 2 == 0, 1.0, -1.0)
    radius, (low, high) = coil_shape(spring, node * math.pi)[0], end_pitch(spring)
    # circles of the end turns lie half their pitch apart in height
    rise = 0.5 * np.where(index < 0, low, high) * (index - node)
    return node, np.stack((side * radius, rise), axis=-1)


def turned(angle: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Vectors (2, ...) turned by an angle, real or complex."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array((c * x - s * y, s * x + c * y))
