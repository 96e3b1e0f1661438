"""Section forces, contact forces and VTU files of the deformed wire."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coilspring.path import EquilibriumPath, require_step, shape_of
from wirefe.contact.points import ContactArrays
from wirefe.contact.stations import ARMS, POSITION, SLOPES, of_wires, turned_rows
from wirefe.element.beam import deformations
from wirefe.element.poses import ROW
from wirefe.results.shape import WireShape, contact_vectors

POINT_DATA = ("displacement", "rotation", "contact_force", "pair_force")  # of a VTU file


@dataclass(frozen=True)
class SectionResults:
    """What the wire carries at one equilibrium: between its rigid ends, or on plates all of it.

    Forces and moments are means over an element in the frame that moves along it: first axis the
    wire's tangent (straight element: its chord), the others across (curved element: normal, binormal).

    Attributes
    ----------
    points : (nodes, 3) of the deformed wire, mm; the first and the last belong to the rigid ends.
    displacement : (nodes, 3) from rest, mm.
    rotation : (nodes, 3) rotation vectors from rest, of at most half a turn, rad.
    contact_force : (nodes, 3) normal contact force on each node, N; the forces on the spheres of a
        rigid end are summed at its node. What holds a pair from sliding is not in it, nor are plates.
    pair_force : (nodes,) largest normal force of a pair that touches at each node, N; where coils are
        pressed from both sides it does not cancel. Spheres of a rigid end are at no node.
    force : (elements, 3) axial force and two shear forces, N.
    moment : (elements, 3) torsion and two bending moments, N mm.
    curvature_change : (elements, 3) twist and two bending curvatures, less those at rest, 1/mm.
    """

    points: np.ndarray
    displacement: np.ndarray
    rotation: np.ndarray
    contact_force: np.ndarray
    pair_force: np.ndarray
    force: np.ndarray
    moment: np.ndarray
    curvature_change: np.ndarray

    @property
    def cells(self) -> dict[str, np.ndarray]:
        """Scalars of the elements: shear, bending and curvature (its change) are magnitudes."""
        return {
            "axial_force": self.force[:, 0],
            "shear_force": np.linalg.norm(self.force[:, 1:], axis=1),
            "torsion": self.moment[:, 0],
            "bending_moment": np.linalg.norm(self.moment[:, 1:], axis=1),
            "curvature": np.linalg.norm(self.curvature_change[:, 1:], axis=1),
            "twist": self.curvature_change[:, 0],
        }


def section_results(path: EquilibriumPath, step: int) -> SectionResults:
    """Section forces, curvature changes and contact forces at a stored step of a path of the wire model.

    Contact between nodes acts on the nodes here; `wirefe.stress` has it where it is.

    Raises
    ------
    InputError : the path is not of the wire model, or has no such step.
    """
    from scipy.spatial.transform import Rotation

    shape: WireShape = shape_of(path, "wirefe", "section_results")
    state = path.states[require_step(path, step)]
    data, rows = shape.data.elements, state.reshape(-1, ROW)
    points, turns = rows[:, :3].copy(), rows[:, 3:]
    points[-1] += turned_rows(turns[-1], data.arm)
    strain = np.empty_like(data.strain0)
    deformations(state, data.arm, data.triads, strain)
    strain -= data.strain0
    rates = np.zeros_like(data.stiffness)
    if len(data.second):
        rates = np.einsum("eijk,ek->eij", data.second.reshape(-1, 6, 6, 6), strain)
    eta = strain - 0.5 * np.einsum("eij,ej->ei", rates, strain)
    wrench = np.einsum("eij,ej->ei", data.stiffness, eta)
    force = wrench - np.einsum("eij,ei->ej", rates, wrench)
    # the first three at rest are the tangent times the element's length
    lengths = np.linalg.norm(data.strain0[:, :3], axis=1)
    wire = np.count_nonzero(lengths)  # the hold of a tip on a plate has none
    nodes = slice(wire + 1)
    return SectionResults(
        points=points[nodes],
        displacement=(points - shape.mesh.points)[nodes],
        rotation=Rotation.from_quat(np.roll(turns, -1, axis=1)).as_rotvec()[nodes],
        contact_force=_contact_force(shape, state[None], path.contact_forces[step])[nodes],
        pair_force=_pair_force(shape, len(rows), path.contact_forces[step])[nodes],
        force=force[:wire, :3],
        moment=wrench[:wire, 3:],
        curvature_change=strain[:wire, 3:] / lengths[:wire, None],
    )


def write_vtu(path: EquilibriumPath, step: int, file: str | Path) -> None:
    """Write the deformed wire at a stored step as line cells, mm and N; rigid end turns are left out.

    Point data: displacement, rotation (vector), contact_force, pair_force. Cell data: axial_force,
    shear_force, torsion, bending_moment, curvature and twist (changes from rest).
    """
    import meshio

    found = section_results(path, step)
    nodes = np.arange(len(found.points))
    mesh = meshio.Mesh(
        found.points,
        [("line", np.stack((nodes[:-1], nodes[1:]), axis=1))],
        point_data={name: getattr(found, name) for name in POINT_DATA},
        cell_data={name: [values] for name, values in found.cells.items()},
    )
    mesh.write(file, file_format="vtu")


def _contact_force(shape: WireShape, states: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Sum of the pairs' normal forces on the nodes that move their contact points, shape (nodes, 3)."""
    data = shape.data.contact
    total = np.zeros((states.shape[1] // ROW, 3))
    closed = normal > 0.0
    push = contact_vectors(data, states)[0, closed]
    push *= (normal[closed] / np.linalg.norm(push, axis=1))[:, None]
    for side, sign in zip(data.pairs[closed].T, (-1.0, 1.0), strict=True):
        share = _second_share(data)[side, None]
        np.add.at(total, data.attached[side], sign * (1.0 - share) * push)
        shared = share[:, 0] > 0.0
        np.add.at(total, data.attached[side[shared]] + 1, (sign * share * push)[shared])
    return total


def _pair_force(shape: WireShape, count: int, normal: np.ndarray) -> np.ndarray:
    """Largest normal force of the pairs at each of `count` nodes, of stations at the nearer one; those on
    rigid end turns are at none."""
    data = shape.data.contact
    largest, share = np.zeros(count), _second_share(data)
    there = np.all(data.parts[:, :3] == 0.0, axis=1)
    if of_wires(data.parts):
        there = (share > 0.0) | np.all(data.parts[:, ARMS:SLOPES] == 0.0, axis=1)
    node = data.attached + (share > 0.5)
    for side in data.pairs.T:
        shown = there[side]
        np.maximum.at(largest, node[side[shown]], normal[shown])
    return largest


def _second_share(data: ContactArrays) -> np.ndarray:
    """Share of the second node in the motion of each contact point."""
    return data.parts[:, POSITION] if of_wires(data.parts) else np.zeros(len(data.parts))
