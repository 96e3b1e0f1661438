"""The wire's elements and spheres for the verifier, in plain numpy."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial.transform import Rotation

from coilspring import Scene, Spring
from validation.campaign.poses import TINY, product, strain

SHEAR_FACTOR = 0.9
GAUSS = np.polynomial.legendre.leggauss(16)
Poses = tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def helix(spring: Spring, phases: np.ndarray, order: int = 0) -> np.ndarray:
    """Wire at the phases, end turns included, or its derivative of some order in the phase, (..., 3)."""
    end = 2.0 * math.pi * spring.active_coils
    inner = np.clip(phases, 0.0, end)
    bottom, top = spring.mean_diameter
    slope = 0.5 * (top - bottom) / end
    rise = inner / end * spring.active_height + (phases - inner) / (2.0 * math.pi) * spring.wire_diameter
    if order:
        rise = np.full(phases.shape, spring.active_height / end if order == 1 else 0.0)
    spiral = 1j**order * (0.5 * bottom + slope * inner) + order * 1j ** (order - 1) * slope
    point = spiral * np.exp(1j * (phases + spring.start_phase))
    return np.stack((point.real, rise, (1.0 if spring.hand == "left" else -1.0) * point.imag), axis=-1)


def end_frames(spring: Spring, phases: np.ndarray, points: np.ndarray, bent: bool) -> np.ndarray:
    """Quaternions (4, 2, elements) of the end triads: Frenet's, or one along the chord."""
    if not bent:
        chords = np.diff(points, axis=0)
        one = _quaternions(chords, np.cross(chords, [0.0, 0.0, 1.0]))
        return np.stack((one, one), axis=1)
    all_frames = _quaternions(helix(spring, phases, 1), helix(spring, phases, 2))
    return np.stack((all_frames[:, :-1], all_frames[:, 1:]), axis=1)


def straight(scene: Scene, points: np.ndarray) -> np.ndarray:
    """Stiffness (6, 6, elements) of straight pieces with residual bending flexibility."""
    EA, GA, GJ, EI = _rigidities(scene)
    length = np.linalg.norm(np.diff(points, axis=0), axis=1)
    shear = 1.0 / (1.0 / GA + length**2 / (12.0 * EI))
    rows = np.broadcast_arrays(EA, shear, shear, GJ, EI, EI, length)
    K = np.zeros((6, 6, length.size))
    K[np.arange(6), np.arange(6)] = np.array(rows[:6]) / length
    return K


def curved(scene: Scene, phases: np.ndarray, points: np.ndarray, poses: Poses) -> np.ndarray:
    """Stiffness of curved pieces: the inverse of their exact linear flexibility in (v, theta)."""
    flexibility = _flexibility(scene, phases, points)
    steps = np.zeros((6, 6, 1), dtype=complex)
    steps[np.arange(6), np.arange(6)] = 1j * TINY
    spins = np.concatenate((np.ones((1, 6, 1)), 0.5 * steps[3:]))
    (x1, q1), (x2, q2) = poses
    moved = (x2[:, None] + steps[:3], product(spins, q2[:, None]))
    J = strain((x1[:, None], q1[:, None]), moved).imag.transpose(2, 0, 1) / TINY
    return np.linalg.inv(J @ flexibility @ J.transpose(0, 2, 1)).transpose(1, 2, 0)


def spheres(
    spring: Spring, points: np.ndarray, reference: np.ndarray, elements_per_turn: int, pairs_per_turn: int
) -> tuple[np.ndarray, np.ndarray]:
    """Nodes that carry the spheres, and offsets from them at rest."""
    turn, last = 2.0 * math.pi, len(points) - 1
    low = math.ceil(-spring.end_turns * pairs_per_turn - 1e-9)
    high = math.floor((spring.active_coils + spring.end_turns) * pairs_per_turn + 1e-9)
    index = np.arange(low, high + 1)
    attached = np.clip(index * (elements_per_turn // pairs_per_turn), 0, last)
    origins = np.concatenate((points[:-1], reference[None]))
    return attached, helix(spring, index * turn / pairs_per_turn) - origins[attached]


def _rigidities(scene: Scene) -> tuple[float, float, float, float]:
    d, E, G = scene.spring.wire_diameter, scene.material.E, scene.material.G
    area, second = math.pi * d**2 / 4.0, math.pi * d**4 / 64.0
    return E * area, SHEAR_FACTOR * G * area, 2.0 * G * second, E * second


def _flexibility(scene: Scene, phases: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Flexibility (elements, 6, 6) of the upper end against the lower one, for force and moment there."""
    EA, GA, GJ, EI = _rigidities(scene)
    half = 0.5 * np.diff(phases)[:, None]
    at = phases[:-1, None] + half * (1.0 + GAUSS[0])
    tangent = helix(scene.spring, at, 1)
    speed = np.linalg.norm(tangent, axis=-1, keepdims=True)
    along = (tangent / speed)[..., None] * (tangent / speed)[..., None, :]
    transverse = np.eye(3) - along
    C, A = np.zeros((*at.shape, 6, 6)), np.tile(np.eye(6), (*at.shape, 1, 1))
    C[..., :3, :3], C[..., 3:, 3:] = along / EA + transverse / GA, along / GJ + transverse / EI
    # columns: moments in the section of unit forces at the upper end
    arm = points[1:, None] - helix(scene.spring, at)
    A[..., 3:, :3] = np.cross(arm[..., None, :], np.eye(3)).swapaxes(-1, -2)
    weight = (half * GAUSS[1] * speed[..., 0])[..., None, None]
    return (weight * (A.swapaxes(-1, -2) @ C @ A)).sum(axis=1)


def _quaternions(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Quaternions (4, n) of the triads along `first`, with `second` in their first plane."""
    e1 = first / np.linalg.norm(first, axis=-1, keepdims=True)
    e3 = np.cross(e1, second)
    e3 /= np.linalg.norm(e3, axis=-1, keepdims=True)
    triads = np.stack((e1, np.cross(e3, e1), e3), axis=-1)
    return Rotation.from_matrix(triads).as_quat()[:, [3, 0, 1, 2]].T
