"""Natural frequencies of an unloaded wire."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from coilspring.errors import InputError, require_integer, require_number
from wirefe.contact.stations import turned_rows
from wirefe.element.beam import beams
from wirefe.element.poses import at_rest
from wirefe.rod import Rod

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
    require_number("density", density, 1e-15, 1e3)
    require_number("diameter", diameter, 1e-6, 1e6)
    free = np.flatnonzero(~rod.held)
    require_integer("count", count, 1, len(free) - 1)
    _refuse_loose(rod)
    return lowest_frequencies(linear_stiffness(rod), consistent_mass(rod, density, diameter), free, count)


def lowest_frequencies(K: csr_array, M: csr_array, free: np.ndarray, count: int) -> np.ndarray:
    """The lowest `count` in Hz by stiffness and mass of the `free` dofs; nan of modes that are unstable."""
    from scipy.sparse.linalg import eigsh

    K, M = (matrix[free][:, free].tocsc() for matrix in (K, M))
    squares = eigsh(K, k=count, M=M, sigma=0.0, v0=np.ones(len(free)), return_eigenvectors=False)
    with np.errstate(invalid="ignore"):
        return np.sqrt(np.sort(squares)) / (2.0 * math.pi)


def linear_stiffness(rod: Rod) -> csr_array:
    """Stiffness matrix at rest, dofs 6 node + (ux, uy, uz, rotx, roty, rotz), held ones included."""
    count = len(rod.stiffness)
    g, H = np.empty((count, 12)), np.empty((count, 12, 12))
    beams(at_rest(rod.points).ravel(), np.zeros(3), rod.triads, rod.strain0, rod.stiffness, g, H)
    dofs = 6 * np.arange(count)[:, None] + np.arange(12)
    return scattered(H, dofs, dofs, rod.held.size)


def scattered(values: np.ndarray, rows: np.ndarray, columns: np.ndarray, size: int) -> csr_array:
    """A sparse matrix (size, size) of dense blocks, by the rows and columns of each."""
    from scipy.sparse import coo_array

    row, column = np.broadcast_arrays(rows[:, :, None], columns[:, None, :])
    return coo_array((values.ravel(), (row.ravel(), column.ravel())), shape=(size, size)).tocsr()


def consistent_mass(rod: Rod, density: float, diameter: float) -> csr_array:
    """Consistent mass matrix: translation, rotary inertia of bending and of torsion.

    Displacements and rotations are linear in the arc length; scikit-fem integrates.
    """
    from scipy.sparse import csr_array
    from skfem import Basis, BilinearForm, ElementLineP1, ElementVector, MeshLine
    from skfem.helpers import dot

    lengths = np.linalg.norm(rod.strain0[:, :3], axis=1)
    t = _tangents(rod)
    area, inertia = math.pi * diameter**2 / 4.0, math.pi * diameter**4 / 64.0
    rotary = inertia * (np.eye(3) + t[:, :, None] * t[:, None, :])  # polar, 2 I, about the tangent

    @BilinearForm
    def kinetic(u, v, _):
        turning = np.einsum("eij,ieq,jeq->eq", rotary, u[3:], v[3:])
        return density * (area * dot(u[:3], v[:3]) + turning)

    line = MeshLine(np.concatenate(([0.0], np.cumsum(lengths))))
    return csr_array(kinetic.assemble(Basis(line, ElementVector(ElementLineP1(), 6))))


def _tangents(rod: Rod) -> np.ndarray:
    """First axis of the elements' frames half way, shape (elements, 3)."""
    first, second = rod.triads[:, 0], rod.triads[:, 1]
    sign = np.sign(np.einsum("ei,ei->e", first, second))[:, None]
    middle = first + sign * second
    middle /= np.linalg.norm(middle, axis=1)[:, None]
    return turned_rows(middle, np.array([1.0, 0.0, 0.0]))


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
