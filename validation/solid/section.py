"""Elasticity of a curved, twisted wire: finite elements on its section for all six end wrenches.

The section at arc length s moves as r + theta x X + w, X = (0, x, y) in Frenet's axes (t, n, b) of curvature
kappa and torsion tau; w is what the section deforms. With K = (tau, 0, kappa), g = 1 - kappa x, and
gamma = r' + K x r + t x theta, k = theta' + K x theta, the gradient of the displacement has the columns

    (gamma + k x X + w' + K x w - tau (x d/dy - y d/dx) w) / g,  dw/dx,  dw/dy.

A wrench W = (N, M) of the end is at the section W' = P^T W, where (gamma, k) = q' + P q of q = (r, theta).
In the displacements of Saint-Venant w = Phi(x, y) W(s) and (gamma, k) = F W(s), so that derivatives in s are
matrices P^T, and equilibrium is a problem on the section for Phi and F. docs/theory.md derives it.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse
from scipy.linalg import schur
from scipy.sparse.linalg import splu
from skfem import Basis, ElementTriP2, ElementVector, Mesh, MeshTri2

ROUND = 3  # refinements of the disk: 256 triangles of second order
ELEMENT = ElementVector(ElementTriP2(), 3)
CORNERS = (np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.full(3, 1.0 / 6.0))


@dataclass(frozen=True)
class SectionSolution:
    """Stresses of a section under unit wrenches (N_t, N_n, N_b, M_t, M_n, M_b)."""

    mesh: Mesh
    curvature: float
    torsion: float
    elasticity: np.ndarray  # (6, 6)
    warping: np.ndarray  # (dofs, 6)
    flexibility: np.ndarray  # (6, 6) of the wire per length: twice the strain energy of a wrench
    rod_flexibility: np.ndarray  # (6, 6) by the mean motion; it has the same energy over whole turns

    def stresses(self, wrench: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points (2, n) and stresses tt, nn, bb, tn, tb, nb (6, n) at the corners of the triangles."""
        basis = Basis(self.mesh, ELEMENT, quadrature=CORNERS)
        straight, along, rod = strains(basis, self.curvature, self.torsion)
        step = transport(self.curvature, self.torsion).T
        strain = straight @ self.warping + along @ (self.warping @ step) + rod @ self.rod_flexibility
        return points(basis).reshape(2, -1), self.elasticity @ (strain @ wrench).reshape(6, -1)


def disk() -> Mesh:
    """Triangles of second order in a circle of diameter 1."""
    return MeshTri2.init_circle(ROUND).scaled(0.5)


def solve(mesh: Mesh, curvature: float, torsion: float, nu: float, E: float = 1.0) -> SectionSolution:
    """Solve the section of a wire; `mesh` is centred, x points to the centre of curvature.

    `curvature` and `torsion` are of the line through the origin, per unit of the mesh.
    """
    basis = Basis(mesh, ELEMENT, intorder=5)
    straight, along, rod = strains(basis, curvature, torsion)
    C = elasticity(E, nu)
    weight = ((1.0 - curvature * points(basis)[0]) * basis.dx).ravel()
    D = sparse.kron(sparse.csr_matrix(C), sparse.diags(weight)).tocsr()
    step = transport(curvature, torsion).T
    warping, measured = _saint_venant(straight, along, rod, D, step, _mean_motion(basis))
    strain = straight @ warping + along @ (warping @ step) + rod @ measured
    return SectionSolution(mesh, curvature, torsion, C, warping, strain.T @ (D @ strain), measured)


def transport(curvature: float, torsion: float) -> np.ndarray:
    """P of (gamma, k) = q' + P q for motions q = (r, theta) in Frenet's axes, (6, 6)."""
    P = np.zeros((6, 6))
    P[:3, :3] = P[3:, 3:] = [[0.0, -curvature, 0.0], [curvature, 0.0, -torsion], [0.0, torsion, 0.0]]
    P[1, 5], P[2, 4] = -1.0, 1.0
    return P


def elasticity(E: float, nu: float) -> np.ndarray:
    """Hooke's law for tt, nn, bb and the shear strains tn, tb, nb, (6, 6)."""
    mu = E / 2.0 / (1.0 + nu)
    C = np.diag([2.0 * mu] * 3 + [mu] * 3)
    C[:3, :3] += E * nu / (1.0 + nu) / (1.0 - 2.0 * nu)
    return C


def points(basis: Basis) -> np.ndarray:
    """Points of integration (2, elements, points)."""
    return np.asarray(basis.global_coordinates())


def strains(
    basis: Basis, curvature: float, torsion: float
) -> tuple[sparse.csr_matrix, sparse.csr_matrix, np.ndarray]:
    """Strains at the points of integration: of w and of w' (sparse, by dofs), and of (gamma, k)."""
    x, y = points(basis)
    g, K, size = 1.0 - curvature * x, np.array([torsion, 0.0, curvature]), (6, *x.shape)
    rows = np.arange(6 * x.size).reshape(size)
    still = np.zeros((3, *x.shape))
    held: tuple[list[Any], list[Any]] = ([], [])
    for (shape,), dofs in zip(basis.basis, basis.dofs.element_dofs, strict=True):
        w, (wx, wy) = np.asarray(shape) + still, np.moveaxis(shape.grad, 1, 0) + np.stack((still, still))
        turn = np.cross(K, w, axisb=0, axisc=0) - torsion * (x * wy - y * wx)
        for kept, strain in zip(held, (_strain(turn / g, wx, wy), _strain(w / g, still, still)), strict=True):
            column = np.broadcast_to(dofs[:, None], size)
            kept.append(
                sparse.csr_matrix((strain.ravel(), (rows.ravel(), column.ravel())), (rows.size, basis.N))
            )
    rod = [_strain(motion / g, still, still).ravel() for motion in _rigid(x, y)]
    return sum(held[0][1:], held[0][0]), sum(held[1][1:], held[1][0]), np.stack(rod, axis=1)


def _strain(wt: np.ndarray, wx: np.ndarray, wy: np.ndarray) -> np.ndarray:
    """Strains tt, nn, bb, tn, tb, nb of a gradient with these columns."""
    return np.stack((wt[0], wx[1], wy[2], wt[1] + wx[0], wt[2] + wy[0], wx[2] + wy[1]))


def _rigid(x: np.ndarray, y: np.ndarray) -> list[np.ndarray]:
    """Six rigid motions r and theta x X at points, each (3, ...)."""
    zero, one = np.zeros_like(x), np.ones_like(x)
    shifts = [np.stack([one if i == j else zero for i in range(3)]) for j in range(3)]
    return [*shifts, np.stack((zero, -y, x)), np.stack((y, zero, zero)), np.stack((-x, zero, zero))]


def _mean_motion(basis: Basis) -> np.ndarray:
    """Means of w and X x w over the section, which must vanish, (dofs, 6)."""
    motions = np.stack([motion * basis.dx for motion in _rigid(*points(basis))])
    means = np.zeros((basis.N, 6))
    for (shape,), dofs in zip(basis.basis, basis.dofs.element_dofs, strict=True):
        np.add.at(
            means, dofs, np.einsum("jiep,iep->ej", motions, np.asarray(shape) + np.zeros_like(motions[0]))
        )
    return means


def _saint_venant(
    straight: Any, along: Any, rod: np.ndarray, D: Any, step: np.ndarray, means: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Phi and F: a problem for each vector of Schur's form of `step`, in which columns follow each other."""
    S, A = D @ straight, D @ along
    stiff, mixed, mass = straight.T @ S, straight.T @ A, along.T @ A
    skew, ends = mixed - mixed.T, rod.T @ (D @ rod)
    pull, drag = straight.T @ (D @ rod), along.T @ (D @ rod)
    T, Z = schur(step, "complex")
    square, count = T @ T, len(means)
    warping, measured = np.zeros((count, 6), dtype=complex), np.zeros((6, 6), dtype=complex)
    for j, rate in enumerate(np.diag(T)):
        matrix = sparse.bmat(
            [
                [stiff + rate * skew - rate**2 * mass, pull - rate * drag, means],
                [(pull + rate * drag).T, ends, None],
                [means.T, None, None],
            ]
        )
        before = warping[:, :j] @ T[:j, j]
        force = mass @ (warping[:, :j] @ square[:j, j]) - skew @ before + drag @ (measured[:, :j] @ T[:j, j])
        right = np.concatenate((force, Z[:, j] - drag.T @ before, np.zeros(6)))
        found = splu(matrix.tocsc()).solve(right)
        warping[:, j], measured[:, j] = found[:count], found[count : count + 6]
    return (warping @ Z.conj().T).real, (measured @ Z.conj().T).real
