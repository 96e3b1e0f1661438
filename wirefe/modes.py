"""Natural frequencies of an unloaded wire."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from coilspring.errors import InputError, require_integer, require_number
from wirefe.beam import beams, deformations
from wirefe.poses import at_rest
from wirefe.rod import Rod
from wirefe.shape import turned

if TYPE_CHECKING:
    from scipy.sparse import csr_array


def natural_frequencies(rod: Rod, density: float, diameter: float, count: int) -> np.ndarray:
    """Lowest natural frequencies of small vibrations about the state at rest.

    Parameters
    ----------
    rod : a round wire, held against every rigid motion; its loads play no part.
    density : t/mm^3 (steel: 7.9e-9), which goes with mm, N, MPa.
    diameter : of the wire, mm.
    count : how many, fewer than the free dofs.

    Returns
    -------
    (count,) frequencies in Hz, the lowest first.

    Raises
    ------
    InputError : bad input, in one sentence.
    """
    from scipy.sparse.linalg import eigsh

    require_number("density", density, 1e-15, 1e3)
    require_number("diameter", diameter, 1e-6, 1e6)
    free = np.flatnonzero(~rod.held)
    require_integer("count", count, 1, len(free) - 1)
    _refuse_loose(rod)
    K = linear_stiffness(rod)[free][:, free]
    M = consistent_mass(rod, density, diameter)[free][:, free]
    squares = eigsh(K.tocsc(), k=count, M=M.tocsc(), sigma=0.0, return_eigenvectors=False)
    return np.sqrt(np.sort(squares)) / (2.0 * math.pi)


def linear_stiffness(rod: Rod) -> csr_array:
    """Stiffness matrix at rest, dofs 6 node + (ux, uy, uz, rotx, roty, rotz), held ones included."""
    from scipy.sparse import coo_array

    count = len(rod.stiffness)
    state, strain0 = _at_rest(rod)
    g, H = np.empty((count, 12)), np.empty((count, 12, 12))
    beams(state, np.zeros(3), rod.triads, strain0, rod.stiffness, g, H)
    dofs = 6 * np.arange(count)[:, None] + np.arange(12)
    rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
    return coo_array((H.ravel(), (rows.ravel(), columns.ravel())), shape=(rod.held.size,) * 2).tocsr()


def consistent_mass(rod: Rod, density: float, diameter: float) -> csr_array:
    """Consistent mass matrix: translation, rotary inertia of bending and of torsion.

    Displacements and rotations are linear in the arc length; scikit-fem integrates.
    """
    from scipy.sparse import csr_array
    from skfem import Basis, BilinearForm, ElementLineP1, ElementVector, MeshLine
    from skfem.helpers import dot

    _, strain0 = _at_rest(rod)
    # the deformation measure at rest is the tangent times the element's length
    lengths = np.linalg.norm(strain0[:, :3], axis=1)
    t = _tangents(rod)
    area, inertia = math.pi * diameter**2 / 4.0, math.pi * diameter**4 / 64.0
    rotary = inertia * (np.eye(3) + t[:, :, None] * t[:, None, :])  # polar, 2 I, about the tangent

    @BilinearForm
    def kinetic(u, v, _):
        turning = np.einsum("eij,ieq,jeq->eq", rotary, u[3:], v[3:])
        return density * (area * dot(u[:3], v[:3]) + turning)

    line = MeshLine(np.concatenate(([0.0], np.cumsum(lengths))))
    return csr_array(kinetic.assemble(Basis(line, ElementVector(ElementLineP1(), 6))))


def _at_rest(rod: Rod) -> tuple[np.ndarray, np.ndarray]:
    """State, and deformation measures of the elements."""
    state, strain0 = at_rest(rod.points).ravel(), np.empty((len(rod.triads), 6))
    deformations(state, np.zeros(3), rod.triads, strain0)
    return state, strain0


def _tangents(rod: Rod) -> np.ndarray:
    """First axis of the elements' frames half way, shape (elements, 3)."""
    first, second = rod.triads[:, 0], rod.triads[:, 1]
    sign = np.sign(np.einsum("ei,ei->e", first, second))[:, None]
    middle = first + sign * second
    middle /= np.linalg.norm(middle, axis=1)[:, None]
    return turned(middle, np.array([1.0, 0.0, 0.0]))


def _refuse_loose(rod: Rod) -> None:
    """Refuse a rod that can move without strain: a rigid motion that is zero in all held dofs."""
    middle = rod.points.mean(axis=0)
    offset = (rod.points - middle) / max(np.ptp(rod.points, axis=0).max(), 1e-300)
    motions = np.zeros((len(offset), 6, 6))
    motions[:] = np.eye(6)
    for axis in range(3):
        motions[:, :3, 3 + axis] = np.cross(np.eye(3)[axis], offset)
    if np.linalg.matrix_rank(motions[rod.held]) < 6:
        raise InputError("rod must be held against every rigid motion, got one that can move freely")
