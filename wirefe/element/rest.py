"""Elements at rest: end triads and stiffness of straight and of curved pieces of wire."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from coilspring.scene.wire import Section
from wirefe.element.beam import deformation_rates
from wirefe.element.poses import at_rest
from wirefe.element.rotations import cross_rows, quaternion_from_matrix

if TYPE_CHECKING:
    from wirefe.rod import Curve

# Of a wire whose flexibility varies: at parameters of its curve, (n, 6, 6) in Frenet's axes there.
Flexibility = Callable[[np.ndarray], np.ndarray]
ELEMENTS = ("straight", "curved")
# Gauss points of the flexibility along an element: exact to rounding up to a quarter of a turn.
GAUSS = np.polynomial.legendre.leggauss(12)
KINK = 1e-13  # of the largest parameter, well above its rounding: how far inside its ends an element begins


def straight_elements(points: np.ndarray, section: Section) -> tuple[np.ndarray, np.ndarray]:
    """End triads (elements, 2, 4) and stiffness (elements, 6, 6) in (v, theta) between points."""
    t, lengths = _chords(points)
    # The section is round: any second axis will do, here the one across the tangent and the coordinate axis
    # that is least along it.
    second = np.cross(np.eye(3)[np.abs(t).argmin(axis=1)], t)
    second /= np.linalg.norm(second, axis=1)[:, None]
    triads = quaternion_from_matrix(np.stack((t, second, np.cross(t, second)), axis=-1))
    return np.stack((triads, triads), axis=1), straight_stiffness(section, lengths)


def _chords(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors between points, and their distances."""
    chords = np.diff(points, axis=0)
    lengths = np.linalg.norm(chords, axis=1)
    return chords / lengths[:, None], lengths


def straight_stiffness(section: Section, lengths: np.ndarray) -> np.ndarray:
    """Stiffness of straight elements in (v, theta), shape (elements, 6, 6).

    Shear carries the bending flexibility L^2/(12 EI) that constant strains leave out, which makes
    the element exact for small loads at its ends (MacNeal 1978, residual bending flexibility).
    """
    K = np.zeros((len(lengths), 6, 6))
    shear = 1.0 / (1.0 / section.GA + lengths**2 / (12.0 * section.EI))
    for i, rigidity in enumerate((section.EA, shear, shear, section.GJ, section.EI, section.EI)):
        K[:, i, i] = rigidity / lengths
    return K


def straight_solid_elements(
    points: np.ndarray, flexibility: np.ndarray, inward: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """As `straight_elements`, of a wire that is not the same in all directions; see `straight_solid_rod`."""
    t, lengths = _chords(points)
    b = np.cross(t, inward)
    b /= np.linalg.norm(b, axis=1)[:, None]
    triads = quaternion_from_matrix(np.stack((t, np.cross(b, t), b), axis=-1))
    bent = flexibility.copy()
    for shear, moment in ((1, 5), (2, 4)):
        bent[:, shear, shear] += lengths**2 / 12.0 * flexibility[:, moment, moment]
    return np.stack((triads, triads), axis=1), np.linalg.inv(lengths[:, None, None] * bent)


def curved_elements(
    curve: Curve, section: Section | Flexibility, phases: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """End triads and stiffness of elements that carry the exact linear flexibility of their piece of wire.

    The triads are Frenet's, in which a uniform helix is a constant strain: a spring that deforms
    into another helix is then represented exactly.
    """
    # at each end from within the element: the curve may have kinks between elements
    inset = KINK * np.abs(phases).max()
    frames = frenet_frames(curve, np.stack((phases[:-1] + inset, phases[1:] - inset), axis=1).ravel())
    triads = quaternion_from_matrix(frames).reshape(-1, 2, 4)
    points = curve.points(phases)
    flexibility = end_flexibility(curve, section, phases, points)
    # K in (v, theta) from the flexibility of the second end's motion: d(v, theta) = J d
    J = np.empty((len(triads), 6, 6))
    deformation_rates(at_rest(points).ravel(), triads, J)
    inverse = np.linalg.inv(J)
    K = np.swapaxes(inverse, 1, 2) @ np.linalg.inv(flexibility) @ inverse
    return triads, 0.5 * (K + np.swapaxes(K, 1, 2))


def end_flexibility(
    curve: Curve, section: Section | Flexibility, phases: np.ndarray, points: np.ndarray
) -> np.ndarray:
    """Motion (dx, spin) of each element's second end by a wrench there, the first held, (elements, 6, 6)."""
    nodes, weights = GAUSS
    half = 0.5 * np.diff(phases)[:, None]
    at = phases[:-1, None] + half * (1.0 + nodes)
    first, _ = curve.derivatives(at.ravel())
    speed = np.linalg.norm(first, axis=1)
    along = (half * weights) * speed.reshape(at.shape)
    # a section carries the force n and the moment m + r x n, with r from it to the second end
    r = points[1:, None] - curve.points(at.ravel()).reshape(*at.shape, 3)
    R = cross_rows(np.eye(3), r[..., None, :])  # R x = r x x
    F = np.empty((*at.shape, 6, 6))
    if isinstance(section, Section):
        t = (first / speed[:, None]).reshape(*at.shape, 3)
        tt = t[..., :, None] * t[..., None, :]
        stretch = np.eye(3) / section.GA + (1.0 / section.EA - 1.0 / section.GA) * tt
        bend = np.eye(3) / section.EI + (1.0 / section.GJ - 1.0 / section.EI) * tt
        mutual = np.float64(0.0)
    else:
        axes = frenet_frames(curve, at.ravel()).reshape(*at.shape, 3, 3)
        back, local = np.swapaxes(axes, -1, -2), section(at.ravel()).reshape(F.shape)
        stretch, mutual, bend = (
            axes @ local[..., i : i + 3, j : j + 3] @ back for i, j in ((0, 0), (0, 3), (3, 3))
        )
    F[..., :3, 3:] = mutual - R @ bend
    F[..., 3:, :3] = np.swapaxes(F[..., :3, 3:], -1, -2)
    if mutual.ndim:
        stretch = stretch + mutual @ R
    F[..., :3, :3] = stretch - R @ F[..., 3:, :3]
    F[..., 3:, 3:] = bend
    return np.einsum("eq,eqij->eij", along, F)


def frenet_frames(curve: Curve, phases: np.ndarray) -> np.ndarray:
    """Tangent, normal and binormal as columns, shape (len(phases), 3, 3)."""
    first, second = curve.derivatives(phases)
    t = first / np.linalg.norm(first, axis=1)[:, None]
    b = cross_rows(first, second)
    b /= np.linalg.norm(b, axis=1)[:, None]
    return np.stack((t, cross_rows(b, t), b), axis=-1)
