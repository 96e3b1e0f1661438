"""The wire model of a scene: its data, and their places in the packed arrays.

State: a row (x, y, z, q0..q3) for each node. Node 0 moves with the bottom end and is fixed; the last
row is the top end's reference point, from which the wire's last point stands off rigidly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coilspring.compiled import kernel
from coilspring.packing import heads, stack, table, vector
from coilspring.scene import Scene
from coilspring.wire import round_section
from wirefe.beam import deformations
from wirefe.chain import ChainPlan, plan_chain
from wirefe.elements import element_properties
from wirefe.mesh import WireMesh, mesh_wire, place_spheres

ROW = 7  # numbers of a node in the state
HELD_ALWAYS = (2, 3, 4)  # UZ, ROTX, ROTY of the top reference point


class WireModel(NamedTuple):
    """Arrays of one wire; free nodes are 1..elements, numbered from 0 in the matrix."""

    stiffness: np.ndarray  # (elements, 6, 6)
    strain0: np.ndarray  # (elements, 6) deformation measure at rest
    triads: np.ndarray  # (elements, 2, 4) quaternions of the end frames at rest
    arm: np.ndarray  # (3,) from the top reference point to the wire's last point
    force: np.ndarray  # (3,) dead load on the top reference point at time 1
    height: float  # of the top reference point at rest
    held: np.ndarray  # (6,) freedoms of the top reference point that are held
    carrier: np.ndarray  # (spheres,) node that carries each sphere
    offset: np.ndarray  # (spheres, 3) from its carrier at rest
    pairs: np.ndarray  # (pairs, 2)
    reach: float  # largest offset
    d: float
    kc: float
    k: float
    stick: int  # 1 where closed pairs are kept from sliding
    element_block: np.ndarray  # (elements,) block of each element's coupling; -1 for the first
    element_flip: np.ndarray
    pair_block: np.ndarray  # (pairs,) block of each pair's coupling; -1 where one side is the ground
    pair_flip: np.ndarray
    plan: ChainPlan


def build_model(
    scene: Scene, elements_per_turn: int, pairs_per_turn: int, element: str = "straight"
) -> tuple[WireModel, WireMesh]:
    """Arrays of the wire model of `scene`, and its mesh."""
    mesh = mesh_wire(scene.spring, elements_per_turn)
    spheres = place_spheres(scene, mesh, elements_per_turn, pairs_per_turn)
    count = len(mesh.elements)
    coupled = np.concatenate((mesh.elements[1:], spheres.carrier[spheres.pairs])) - 1
    free = np.all(coupled >= 0, axis=1)
    touched = np.unique(coupled[count - 1 :])
    last = np.union1d(touched[touched >= 0], [count - 1])
    plan, found, turned = plan_chain(count, coupled[free], last)
    block = np.full(len(coupled), -1)
    flip = np.zeros(len(coupled), dtype=bool)
    block[free], flip[free] = found, turned
    held = np.zeros(6)
    held[list(HELD_ALWAYS)] = 1.0
    for name in scene.supports.top_held:
        held[{"ux": 0, "rotz": 5}[name]] = 1.0
    section = round_section(scene.spring.wire_diameter, scene.material)
    triads, stiffness = element_properties(element, scene.spring, section, mesh)
    model = WireModel(
        stiffness=stiffness,
        strain0=_strain_at_rest(mesh, triads),
        triads=triads,
        arm=mesh.arm,
        force=np.array([*scene.load.force, 0.0]),
        height=scene.spring.active_height,
        held=held,
        carrier=spheres.carrier,
        offset=spheres.arm,
        pairs=np.ascontiguousarray(spheres.pairs),
        reach=float(np.linalg.norm(spheres.arm, axis=1).max()),
        d=scene.spring.wire_diameter,
        kc=spheres.stiffness,
        k=float(scene.contact.exponent),
        stick=int(scene.contact.sliding == "none"),
        element_block=np.concatenate(([-1], block[: count - 1])),
        element_flip=np.concatenate(([False], flip[: count - 1])),
        pair_block=block[count - 1 :],
        pair_flip=flip[count - 1 :],
        plan=plan,
    )
    return model, mesh


def _strain_at_rest(mesh: WireMesh, triads: np.ndarray) -> np.ndarray:
    turns = np.zeros_like(triads)
    turns[..., 0] = 1.0
    e0 = np.empty((len(mesh.elements), 6))
    deformations(mesh.points[mesh.elements], turns, triads, e0)
    return e0


def rest_state(mesh: WireMesh) -> np.ndarray:
    """State at rest, flat."""
    state = np.zeros((len(mesh.points), ROW))
    state[:, :3] = mesh.points
    state[-1, :3] = mesh.reference
    state[:, 3] = 1.0
    return state.ravel()


def load_vector(model: WireModel, mesh: WireMesh) -> np.ndarray:
    """Load at time 1 in the free freedoms, flat; held ones carry none."""
    load = np.zeros(mesh.freedoms.size)
    load[mesh.freedoms[:3, -1]] = model.force * (1.0 - model.held[:3])
    return load[6:]


def matrix_size(model: WireModel) -> int:
    """Length of the matrix: 6 x 6 blocks, the nodes' diagonal ones first, then couplings and fill."""
    return 36 * model.plan.blocks


PLAN = 19  # number of the plan's first field in the packed arrays


@kernel
def view(reals, ints):
    """The model's fields, in their order, in the packed arrays."""
    head = heads(ints)
    return WireModel(
        stack(reals, head[0]), table(reals, head[1]), stack(reals, head[2]), vector(reals, head[3]),
        vector(reals, head[4]), reals[head[5, 0]], vector(reals, head[6]), vector(ints, head[7]),
        table(reals, head[8]), table(ints, head[9]), reals[head[10, 0]], reals[head[11, 0]],
        reals[head[12, 0]], reals[head[13, 0]], ints[head[14, 0]], vector(ints, head[15]),
        vector(ints, head[16]), vector(ints, head[17]), vector(ints, head[18]), view_plan(ints),
    )  # fmt: skip


@kernel
def view_plan(ints):
    """The elimination plan in the packed arrays."""
    head = heads(ints)
    return ChainPlan(
        vector(ints, head[PLAN]), vector(ints, head[PLAN + 1]), vector(ints, head[PLAN + 2]),
        vector(ints, head[PLAN + 3]), vector(ints, head[PLAN + 4]), ints[head[PLAN + 5, 0]],
    )  # fmt: skip
