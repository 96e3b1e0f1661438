"""The wire's elements and contact points for the verifier, in plain numpy."""

import math

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from coilspring import Scene, Spring
from validation.campaign.coils import NUDGE, TURN, coil_shape, end_pitch
from validation.campaign.poses import TINY, like, product, rotated, stepped, strain

SHEAR_FACTOR = 0.9
AT_NODE = 1e-9  # elements: a station that near to a node moves with it alone
GAUSS = np.polynomial.legendre.leggauss(16)
PIECES = 256  # of a turn: a chain that tells how an element deforms to second order
STRAIN = 1e-4  # of a length, or rad, with which differences are taken
Poses = tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def helix(spring: Spring, phases: np.ndarray, order: int = 0, below: bool = False) -> np.ndarray:
    """Wire at the phases, end turns included, or its derivative of some order in the phase, (..., 3); where
    two sections meet see `coil_shape`."""
    inner = np.clip(phases, 0.0, TURN * spring.active_coils)
    beyond = phases - inner
    active = np.abs(beyond) < 0.5 * NUDGE
    low, high = end_pitch(spring)
    ends = np.where(beyond < 0.0, low, high) / TURN  # rise of the end turns a radian
    radius, height = coil_shape(spring, inner)
    slope = coil_shape(spring, inner, 1, below)[0] * active
    rise = height + beyond * ends
    if order:
        rise = np.where(active, coil_shape(spring, inner, order, below)[1], ends * (order == 1))
    spiral = 1j**order * radius + order * 1j ** (order - 1) * slope
    point = spiral * np.exp(1j * (phases + spring.start_phase))
    return np.stack((point.real, rise, (1.0 if spring.hand == "left" else -1.0) * point.imag), axis=-1)


def end_frames(spring: Spring, phases: np.ndarray, points: np.ndarray, bent: bool) -> np.ndarray:
    """Quaternions (4, 2, elements) of the end triads: Frenet's of the element's own coils, or one along the
    chord."""
    if not bent:
        chords = np.diff(points, axis=0)
        one = _quaternions(chords, np.cross(chords, [0.0, 0.0, 1.0]))
        return np.stack((one, one), axis=1)
    ends = [(phases[:-1], False), (phases[1:], True)]
    return np.stack(
        [_quaternions(helix(spring, at, 1, below), helix(spring, at, 2, below)) for at, below in ends], axis=1
    )


def straight(scene: Scene, points: np.ndarray) -> np.ndarray:
    """Stiffness (6, 6, elements) of straight pieces with residual bending flexibility."""
    EA, GA, GJ, EI = rigidities(scene)
    length = np.linalg.norm(np.diff(points, axis=0), axis=1)
    shear = 1.0 / (1.0 / GA + length**2 / (12.0 * EI))
    K = np.zeros((6, 6, length.size))
    K[np.arange(6), np.arange(6)] = np.array(np.broadcast_arrays(EA, shear, shear, GJ, EI, EI)) / length
    return K


def curved(
    scene: Scene, phases: np.ndarray, points: np.ndarray, poses: Poses
) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness of curved pieces, the inverse of their exact linear flexibility, (6, 6, elements), and second
    derivatives of (v, theta) in the amplitudes of strains by a unit of each, (6, 6, 6, elements)."""
    nodes, weights = GAUSS
    along = np.diff(phases)[:, None, None, None]
    sections = 0.5 * along * weights[:, None, None] * _flexibility(scene, phases, points, 0.5 * (1.0 + nodes))
    low, (x, q) = poses
    (moved,) = stepped(np.concatenate((x, q)).T[None])
    J = strain((low[0][:, None], low[1][:, None]), moved).imag.transpose(2, 0, 1) / TINY
    inverse = np.linalg.inv(J)
    wrench = np.linalg.inv(sections.sum(axis=1)) @ inverse  # at the upper end, by a unit of each
    K = (inverse.transpose(0, 2, 1) @ wrench).transpose(1, 2, 0)
    return K, _second(_chain(scene, phases, points, wrench), poses)


def _chain(scene: Scene, phases: np.ndarray, points: np.ndarray, wrench: np.ndarray) -> np.ndarray:
    """Twists (two for each piece, 6, 6, elements) of the upper end, in their order, by a unit of each wrench.

    Two make what a piece does, to the fourth order (Blanes & Moan 2006, Appl. Numer. Math. 56, 1519).
    """
    steps, offset = np.diff(phases), np.array([-1.0, 1.0]) * math.sqrt(3.0) / 6.0
    pieces = math.ceil(PIECES * steps.max() / TURN)
    shares = (np.arange(pieces)[:, None] + 0.5 + offset) / pieces
    rates = _flexibility(scene, phases, points, shares.ravel()) @ wrench[:, None]
    both = rates.reshape(-1, pieces, 2, 6, 6) * (steps / pieces)[:, None, None, None, None]
    near, far = 0.25 + math.sqrt(3.0) / 6.0, 0.25 - math.sqrt(3.0) / 6.0
    twists = np.einsum("ab,epbij->paije", [[near, far], [far, near]], both)
    return twists.reshape(2 * pieces, 6, 6, -1)


def _second(twists: np.ndarray, poses: Poses) -> np.ndarray:
    """Second derivatives (6, 6, 6, elements) of (v, theta) in the amplitudes of six motions, each a chain of
    small twists (chain, 6, 6 motions, elements) of the upper end."""
    low, (place, frame) = poses
    size = STRAIN * np.concatenate((np.full(3, np.linalg.norm(place - low[0], axis=0).mean()), np.ones(3)))
    real = np.array([1.0, -1.0])[:, None] * size  # (2, 6)
    x = np.zeros((3, 2, 6, 6, place.shape[1]), dtype=complex)
    q = np.zeros((4, *x.shape[1:]), dtype=complex)
    q[0] = 1.0
    for twist in twists[::-1]:
        move = real[None, :, :, None, None] * twist[:, None, :, None] + 1j * TINY * twist[:, None, None]
        dx, spin = move[:3], move[3:]
        square = (spin**2).sum(axis=0)
        turn = np.concatenate(((1.0 - square / 8.0)[None], 0.5 * (1.0 - square / 24.0) * spin))
        x, q = rotated(turn, x) + dx + 0.5 * np.cross(spin, dx, axis=0), product(turn, q)
    e = strain((like(x, low[0]), like(x, low[1])), (like(x, place) + x, product(q, like(x, frame))))
    slopes = e.imag / TINY
    return (slopes[:, 0] - slopes[:, 1]) / (2.0 * size[:, None, None])


class Points:
    """Contact points: spheres at nodes, or stations along the wire. Each is a sum over two nodes of weighted
    positions and turned arms.

    Between the nodes, at `points`, the wire is a cubic along the turned tangents at rest. With T(P) the place
    of a point P that moves with a node, and s the share between the nodes A and B,

        (1 - s) Ta(P) + s Tb(P) - s (1 - s)^2 (Tb(A) - Ta(A)) + s^2 (1 - s) (Tb(B) - Ta(B)).
    """

    def __init__(self, spring: Spring, points: np.ndarray, per_turn: int, wires: bool) -> None:
        self.wires = wires  # stations of a wire with tangents, in place of spheres
        self.per_turn = per_turn  # their number; up to half a turn along the wire nothing touches
        # where the wire begins and ends, and where they are, in their spacings from the first active point on
        self.ends = -spring.end_turns * per_turn, (spring.active_coils + spring.end_turns) * per_turn
        count, last = len(points) - 1, TURN * spring.active_coils
        first, end = math.ceil(self.ends[0] - 1e-9), math.floor(self.ends[1] + 1e-9)
        self.at = np.arange(first, end + 1)
        phases = self.at * TURN / per_turn
        place = np.clip(phases, 0.0, last) / last * count
        low = np.minimum(place.astype(int), count - 1)
        s = np.where(np.abs(place - np.rint(place)) < AT_NODE, np.rint(place), place) - low
        # (points, 2), the same node twice where there is one alone
        self.node = np.stack((np.where(s == 1.0, low + 1, low), np.where(s == 0.0, low, low + 1)), axis=1)
        P, A, B = helix(spring, phases), points[low], points[low + 1]
        origins = np.concatenate((points[:-1], [[0.0, spring.active_height, 0.0]]))[np.stack((low, low + 1))]
        arms = np.stack((P, A, B))[None] - origins[:, None]  # (node, of P A B, points, 3)
        # by node: the shares of P, A and B, and their derivatives in s
        one, dip, rise = np.ones_like(s), s * (1.0 - s) ** 2, s**2 * (1.0 - s)
        shares = np.array([[1.0 - s, dip, -rise], [s, -dip, rise]])
        ddip, drise = (1.0 - s) * (1.0 - 3.0 * s), s * (2.0 - 3.0 * s)
        changes = np.array([[-one, ddip, -drise], [one, -ddip, drise]])
        self.turn = np.stack((1.0 - s, s), axis=1)  # (points, 2) shares of both rotations in the section's
        self.weight = shares.sum(axis=1).T  # (points, 2) of the positions
        self.arm = np.einsum("njp,njpi->pni", shares, arms)  # (points, 2, 3) of the positions
        before, after = (helix(spring, phases + side * NUDGE, 1) for side in (-1.0, 1.0))
        slope = 0.5 * (before + after)  # pieces meet at an angle
        speed = np.linalg.norm(slope, axis=1, keepdims=True)
        inside = (phases > 0.0) & (phases < last)
        per_length = np.where(inside, count / last, 0.0)[:, None] / speed
        slope_arm = per_length * np.einsum("njp,njpi->npi", changes, arms)
        slope_arm += self.turn.T[..., None] * (slope / speed)
        # the same of the tangents
        self.slope_weight = (per_length[:, 0] * changes.sum(axis=1)).T
        self.slope_arm = slope_arm.swapaxes(0, 1)

    def arms(self, nodes: int) -> np.ndarray:
        """Largest arms about each of the nodes, mm; 0 about the first, which is held."""
        largest = np.zeros(nodes)
        np.maximum.at(largest, self.node, np.linalg.norm(self.arm, axis=2))
        largest[0] = 0.0
        return largest

    def places(self, rows: np.ndarray) -> np.ndarray:
        """Where they are in a state, (points, 3)."""
        return self._summed(rows, self.weight, self.arm)

    def _summed(self, rows: np.ndarray, weight: np.ndarray, arm: np.ndarray) -> np.ndarray:
        """Sums (points, 3) over the two nodes of weighted positions and turned arms."""
        slots = zip(self.node.T, weight.T, arm.swapaxes(0, 1), strict=True)
        return sum(w[:, None] * rows[i, :3] + rotated(rows[i, 3:].T, arm.T).T for i, w, arm in slots)

    def touching(self, places: np.ndarray, d: float) -> np.ndarray:
        """Pairs (n, 2) of points as near as d, more than half a turn apart along the wire."""
        pairs = cKDTree(places).query_pairs(d, output_type="ndarray")
        return self._elastic(pairs[pairs[:, 1] - pairs[:, 0] > self.per_turn // 2])

    def missing(self, rows: np.ndarray, known: np.ndarray, d: float) -> np.ndarray:
        """Pairs (n, 2) that touch and are not known: of stations those one coil apart, and those that touch
        on farther coils."""
        count = len(self.node)
        low = np.arange(max(count - self.per_turn, 0))
        beside = np.stack((low, low + self.per_turn), axis=1)
        pairs = self._elastic(beside) if self.wires else self.touching(self.places(rows), d)
        pairs = pairs[~np.isin(pairs @ [count, 1], known @ [count, 1])]
        return np.concatenate((pairs, self._farther(rows, known, d))) if self.wires else pairs

    def _farther(self, rows: np.ndarray, known: np.ndarray, d: float) -> np.ndarray:
        """Stations between which wires touch, beyond the next coil; each without a known pair on that one."""
        places, slopes = self.places(rows), self._summed(rows, self.slope_weight, self.slope_arm)
        half = 0.5 * float(np.linalg.norm(np.diff(places, axis=0), axis=1).max())
        found = cKDTree(places).query_pairs(math.hypot(d, half), output_type="ndarray")
        low, high = found[found[:, 1] - found[:, 0] > 1.5 * self.per_turn].T
        w, tau = places[high] - places[low], slopes[low] + slopes[high]
        along = (w * tau).sum(axis=1) / np.linalg.norm(tau, axis=1)
        touch = (np.abs(along) <= half) & ((w * w).sum(axis=1) - along**2 < d**2)
        found = self._elastic(np.stack((low[touch], high[touch]), axis=1))
        return found[~np.isin(self._coil(found), self._coil(known))]

    def _coil(self, pairs: np.ndarray) -> np.ndarray:
        """One number of the first point and of the coil on which the second is, of each pair."""
        coils = np.rint((pairs[:, 1] - pairs[:, 0]) / self.per_turn)
        return pairs[:, 0] * len(self.node) + coils

    def spacings(self, pairs: np.ndarray) -> np.ndarray:
        """Spacings of stations that pairs (n, 2) stand for: of those one coil apart where the wire ends
        half of one and what is left of it."""
        low, (begin, end) = self.at[pairs[:, 0]], self.ends
        below = np.where(low == self.at[0], low - begin, 0.5)
        above = np.where(low == self.at[-1] - self.per_turn, end - self.per_turn - low, 0.5)
        beside = self.wires & (pairs[:, 1] - pairs[:, 0] == self.per_turn)
        return np.where(beside, np.maximum(below + above, 0.5), 1.0)

    def _elastic(self, pairs: np.ndarray) -> np.ndarray:
        """The pairs of which not both points are of one rigid end."""
        low, high = self.node[pairs.T]
        return pairs[(low[:, 0] != low[:, 1]) | (low.sum(axis=1) != high.sum(axis=1))]


def rigidities(scene: Scene) -> tuple[float, float, float, float]:
    """EA, GA, GJ and EI of the wire."""
    d, E, G = scene.spring.wire_diameter, scene.material.E, scene.material.G
    area, second = math.pi * d**2 / 4.0, math.pi * d**4 / 64.0
    return E * area, SHEAR_FACTOR * G * area, 2.0 * G * second, E * second


def _flexibility(scene: Scene, phases: np.ndarray, points: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """Flexibility (elements, shares, 6, 6) per phase of sections at shares of the elements: motion of the
    upper end against the lower one, for force and moment there."""
    EA, GA, GJ, EI = rigidities(scene)
    at = phases[:-1, None] + np.diff(phases)[:, None] * shares
    tangent = helix(scene.spring, at, 1)
    speed = np.linalg.norm(tangent, axis=-1, keepdims=True)
    along = (tangent / speed)[..., None] * (tangent / speed)[..., None, :]
    transverse = np.eye(3) - along
    C, A = np.zeros((*at.shape, 6, 6)), np.tile(np.eye(6), (*at.shape, 1, 1))
    C[..., :3, :3], C[..., 3:, 3:] = along / EA + transverse / GA, along / GJ + transverse / EI
    # columns: moments in the section of unit forces at the upper end
    arm = points[1:, None] - helix(scene.spring, at)
    A[..., 3:, :3] = np.cross(arm[..., None, :], np.eye(3)).swapaxes(-1, -2)
    return speed[..., None] * (A.swapaxes(-1, -2) @ C @ A)


def _quaternions(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Quaternions (4, n) of the triads along `first`, with `second` in their first plane."""
    e1 = first / np.linalg.norm(first, axis=-1, keepdims=True)
    e3 = np.cross(e1, second)
    e3 /= np.linalg.norm(e3, axis=-1, keepdims=True)
    triads = np.stack((e1, np.cross(e3, e1), e3), axis=-1)
    return Rotation.from_matrix(triads).as_quat()[:, [3, 0, 1, 2]].T
