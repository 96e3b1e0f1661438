"""Natural frequencies of a loaded spring about an equilibrium.

The stiffness is the tangent of the equilibrium, with closed contact pairs and what holds them.
The mass is consistent: the wire moves with its nodes as its stations do (`wirefe.contact.stations`), end
turns included.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from coilspring.compiling.packing import pack
from coilspring.contact.transitions import GRAZING
from coilspring.errors import require_choice, require_integer
from coilspring.path import EquilibriumPath, require_step, shape_of
from wirefe.contact.stations import ARMS, POSITION, ROTATION, carried, rows, stations_in, turned_rows
from wirefe.model import matrix_size
from wirefe.results.linear import scattered
from wirefe.results.shape import WireShape

if TYPE_CHECKING:
    from scipy.sparse import csr_array

POINTS = 4  # Gauss points of an element
TOPS = ("held", "scene")
AXIAL, LATERAL, TORSIONAL, MIXED = "axial", "lateral", "torsional", "mixed"
MAIN = 0.7  # share of what coils move as a whole, that names a mode
MOST_SHIFT = 1e12  # times the largest eigenvalue found next to zero
LEAST = 0.2  # share of all motion that this is, at least
FEWEST_TURNS = 2.0  # of wire, end turns included: with fewer no mode has a name


class Mode(NamedTuple):
    """A natural mode: how the coils move in it, each as a whole.

    Attributes
    ----------
    frequency : Hz; nan where the equilibrium is unstable.
    kind : {"axial", "lateral", "torsional", "mixed"}
        Along the axis at rest (surge), across it, or turning about it, where seven tenths of what coils move
        as a whole are of this kind; else, and of fewer than two turns of wire, mixed.
    """

    frequency: float
    kind: str


def frequencies(path: EquilibriumPath, step: int = -1, *, count: int = 6, top: str = "held") -> np.ndarray:
    """Lowest natural frequencies about a stored equilibrium of the wire model.

    The stiffness is the tangent of the state for small vibrations in which pairs that touch stay closed and
    stick. What slides, or grazes, on the path sticks as it turns round, however little: so this is not the
    slope of the path, `EquilibriumPath.rates`, there.

    Parameters
    ----------
    path : of `wirefe.solve` or `wirefe.trace`; its material has the density.
    step : which of its equilibria.
    count : how many, fewer than the free degrees of freedom.
    top : {"held", "scene"}
        "held" between plates that do not move, or free where the scene leaves it free: with the mass of the
        top end turn alone, under a dead load that has none. A prescribed displacement is held either way.

    Returns
    -------
    (count,) frequencies in Hz, the lowest first; nan of modes in which the equilibrium is unstable.

    Raises
    ------
    InputError : the path is not of the wire model, or bad input, in one sentence.
    """
    return _about(shape_of(path, "wirefe", "frequencies"), path, step, count, top)[0]


def modes(path: EquilibriumPath, step: int = -1, *, count: int = 6, top: str = "held") -> list[Mode]:
    """Natural modes of the lowest frequencies; parameters and errors as of `frequencies`.

    Of modes with the same frequency any mixture may be found.
    """
    shape: WireShape = shape_of(path, "wirefe", "modes")
    found, motions = _about(shape, path, step, count, top)
    kinds = map(_kind, *_coil_motions(shape, path.states[step], motions))
    return [Mode(*each) for each in zip(found.tolist(), kinds, strict=True)]


def _about(
    shape: WireShape, path: EquilibriumPath, step: int, count: int, top: str
) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies (count,) about an equilibrium, and the modes (dofs, count); see `frequencies`."""
    state = path.states[require_step(path, step)]
    require_choice("top", top, TOPS)
    fixed = np.zeros(shape.size, dtype=bool)
    fixed[shape.data.held.placed] = True
    if top == "held":
        fixed[-6:] = True
    free = np.flatnonzero(~fixed)
    require_integer("count", count, 1, len(free) - 1)
    K = _stiffness(path, shape, step)
    found, vectors = lowest_modes(K, mass(shape, state), free, count)
    motions = np.zeros((shape.size, count))
    motions[free] = vectors
    return found, motions


def _stiffness(path: EquilibriumPath, shape: WireShape, step: int) -> csr_array:
    """Tangent stiffness at a stored equilibrium for motions so small that pairs neither open nor slide.

    Pairs begin them as they begin the next substep of the path: after a slide, or a graze, they hold their
    force with their whole tangential stiffness.
    """
    state, contact = path.states[step], shape.data.contact
    given = None if path.histories is None else path.histories[step, None]
    (history,) = shape.accepted(state[None], shape.histories(given, state[None]))
    history["bound"] *= 2.0  # it is the force of what slid, but for rounding
    touching = contact._replace(d=(1.0 + 2.0 * GRAZING) * contact.d)  # and so near is what grazes
    return tangent_stiffness(replace(shape, data=shape.data._replace(contact=touching)), state, history)


def _coil_motions(shape: WireShape, state: np.ndarray, motions: np.ndarray) -> np.ndarray:
    """Squares of what coils move as a whole in each mode, along the axis, across it and about it, and of all
    motion of the wire, weighed by mass, shape (4, modes).

    Means over a turn about every point of the wire: what turns with the coils cancels in them. Without two
    turns it does not, and they are 0.
    """
    phases, weights = _quadrature(shape)
    node, parts = carried(shape.scene.spring, shape.mesh, phases)
    move, _, _ = _motions(rows(state[None])[0], node, parts)
    u = np.einsum("pij,pjm->ipm", move, motions[6 * node[:, None] + np.arange(12)])
    whole = np.einsum("p,ipm->m", weights, u**2)
    if np.ptp(phases) < FEWEST_TURNS * 2.0 * math.pi:
        return np.array([0.0 * whole, 0.0 * whole, 0.0 * whole, whole])
    at = shape.scene.spring.points(phases)
    about = (at[:, :1] * u[2] - at[:, 2:] * u[0]) / np.hypot(at[:, :1], at[:, 2:])
    low, high = (np.searchsorted(phases, phases + side * math.pi) for side in (-1.0, 1.0))
    sums = np.cumsum(np.pad(weights[:, None] * np.stack((*u, about)), ((0, 0), (1, 0), (0, 0))), axis=1)
    of = np.cumsum(np.append(0.0, weights))
    x, y, z, round_axis = (sums[:, high] - sums[:, low]) / (of[high] - of[low])[:, None]
    return np.array([weights @ y**2, weights @ (x**2 + z**2), weights @ round_axis**2, whole])


def _kind(along: float, across: float, about: float, whole: float) -> str:
    """Name of a mode by the squares of what its coils move, and of all motion."""
    coils = along + across + about
    if coils < LEAST * whole:
        return MIXED
    squares = {AXIAL: along, LATERAL: across, TORSIONAL: about}
    kind = max(squares, key=squares.__getitem__)
    return kind if squares[kind] >= MAIN * coils else MIXED


def tangent_stiffness(shape: WireShape, state: np.ndarray, history: np.ndarray) -> csr_array:
    """Tangent stiffness at a state and its contact history, dofs 6 node + (dx, spin), held ones uncoupled."""
    plan, size = shape.data.plan, shape.size
    flat = np.empty(matrix_size(shape.data))
    shape.assemble(*pack(shape.data), state, 0.0, history, state, np.empty(size), flat)
    blocks = flat.reshape(-1, 6, 6)
    first = np.repeat(plan.order, np.diff(plan.start))  # the node eliminated first has the rows
    nodes = np.arange(len(plan.order))
    diagonal, across = np.split(blocks, [len(nodes)])
    values = np.concatenate((diagonal, across, np.swapaxes(across, 1, 2)))
    row = 6 * np.concatenate((nodes, first, plan.column))
    column = 6 * np.concatenate((nodes, plan.column, first))
    return scattered(values, row[:, None] + np.arange(6), column[:, None] + np.arange(6), size)


def mass(shape: WireShape, state: np.ndarray) -> csr_array:
    """Consistent mass matrix at a state, t: translation, and rotary inertia of bending and of torsion."""
    scene, spring = shape.scene, shape.scene.spring
    phases, weights = _quadrature(shape)
    node, parts = carried(spring, shape.mesh, phases)
    move, spin, t = _motions(rows(state[None])[0], node, parts)
    d = spring.wire_diameter
    line = scene.material.density * 1e-12 * math.pi * d**2 / 4.0 * weights  # t
    rotary = d**2 / 16.0 * (np.eye(3) + t[:, :, None] * t[:, None, :])  # polar, twice as much, about the wire
    values = np.einsum("p,pij,pik->pjk", line, move, move)
    values += np.einsum("p,pij,pil,plk->pjk", line, spin, rotary, spin)
    dofs = 6 * node[:, None] + np.arange(12)
    return scattered(values, dofs, dofs, shape.size)


def _quadrature(shape: WireShape) -> tuple[np.ndarray, np.ndarray]:
    """Phases along the whole wire, and the length of wire that each stands for, mm."""
    spring, mesh = shape.scene.spring, shape.mesh
    step = mesh.phases[1] - mesh.phases[0]
    low, high = spring.phase_range
    ends = [
        np.linspace(a, b, math.ceil((b - a) / step) + 1) for a, b in ((low, 0.0), (spring.phase_end, high))
    ]
    edges = np.unique(np.concatenate((mesh.phases, *ends)))
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    half = 0.5 * np.diff(edges)[:, None]
    phases = (edges[:-1, None] + half * (1.0 + nodes)).ravel()
    slant = spring.tangents(phases)
    return phases, (half * weights).ravel() * np.linalg.norm(slant, axis=1)


def _motions(
    nodes: np.ndarray, node: np.ndarray, parts: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Motion and spin of points by (dx, spin) of their nodes, (points, 3, 12), and tangents, (points, 3)."""
    move, spin = np.zeros((2, len(node), 3, 12))
    upper = np.minimum(node + 1, len(nodes) - 1)
    for side, own in ((0, node), (1, upper)):
        first = 6 * side
        share, turn = (
            parts[:, column] if side else 1.0 - parts[:, column] for column in (POSITION, ROTATION)
        )
        arm = turned_rows(nodes[own, 3:], parts[:, ARMS + 3 * side : ARMS + 3 * side + 3])
        move[:, :, first : first + 3] = share[:, None, None] * np.eye(3)
        move[:, :, first + 3 : first + 6] = np.cross(np.eye(3), arm[:, None]).swapaxes(1, 2)
        spin[:, :, first + 3 : first + 6] = turn[:, None, None] * np.eye(3)
    t = stations_in(nodes.reshape(1, -1), node, parts)[1][0]
    return move, spin, t / np.linalg.norm(t, axis=-1, keepdims=True)


def lowest_modes(K: csr_array, M: csr_array, free: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The lowest `count` frequencies, Hz, by stiffness and mass of the `free` dofs, nan where unstable; and
    the modes, (free, count).

    Iteration finds the eigenvalues next to a shift. Those next to zero are the lowest, unless negative ones
    are missing among them: then the shift is below all.
    """
    from scipy.sparse.linalg import eigsh

    K, M = (matrix[free][:, free].tocsc() for matrix in (K, M))
    start = np.ones(len(free))
    squares, vectors = eigsh(K, k=count, M=M, sigma=0.0, v0=start)
    if _below(K) > np.count_nonzero(squares < 0.0):
        least = shift = 2.0 * np.abs(squares).max()
        while _below(K + shift * M) > 0 and shift < MOST_SHIFT * least:  # else without mass
            shift *= 4.0
        squares, vectors = eigsh(K, k=count, M=M, sigma=-shift, v0=start)
    order = np.argsort(squares)
    with np.errstate(invalid="ignore"):
        return np.sqrt(squares[order]) / (2.0 * math.pi), vectors[:, order]


def _below(K: csr_array) -> int:
    """How many eigenvalues of a symmetric matrix are negative: as many as pivots (Sylvester)."""
    from scipy.sparse.linalg import splu

    factors = splu(
        K, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True, "Equil": False}
    )
    return int(np.count_nonzero(factors.U.diagonal() < 0.0))
