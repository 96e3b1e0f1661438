"""The wire model: its data, and their places in the packed arrays.

State: a row (x, y, z, q0..q3) for each node. In a spring node 0 moves with the bottom end and is held;
the last row is the top end's reference point, from which the wire's last point stands off rigidly.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import accumulate
from typing import NamedTuple, get_type_hints

import numpy as np

from coilspring.compiling.packing import Stack, Table, Vector, Wholes, viewer
from coilspring.contact.law import tangential_stiffness
from coilspring.scene import SEATS, Scene
from coilspring.scene.solidwire import wire_flexibility
from coilspring.scene.wire import round_section
from coilspring.solver.stages import Top
from wirefe.chain import ChainPlan, plan_chain
from wirefe.contact.overlap import NO_STATIONS, Stations, place_stations
from wirefe.contact.plates import NO_PLATES, PlateArrays, join_top, place_plates
from wirefe.contact.points import NO_CONTACT, NONE_FOUND, ContactArrays, contact_points
from wirefe.contact.stations import ROTATION, of_wires
from wirefe.contact.wireforces import COUPLINGS
from wirefe.element.poses import ROW, at_rest
from wirefe.mesh import WireMesh, mesh_wire, refuse_kinks
from wirefe.rod import Rod, curved_rod, straight_rod, straight_solid_rod


class ElementArrays(NamedTuple):
    """The chain of elements."""

    stiffness: Stack  # (elements, 6, 6)
    second: Stack  # (elements, 6, 36) second derivatives of the deformation; none of straight elements
    strain0: Table  # (elements, 6) deformation measure at rest
    triads: Stack  # (elements, 2, 4) quaternions of the end frames at rest
    arm: Vector  # (3,) from the last node to the wire's last point
    block: Wholes  # (elements,) block of each element's coupling
    flip: Wholes  # 1 where the first node has the rows


class HeldArrays(NamedTuple):
    """Held dofs, numbered 6 node + dof, and their rows and columns in the couplings' blocks."""

    dof: Wholes
    block: Wholes
    place: Wholes  # row or column in the block
    row: Wholes  # 1 where it is a row
    placed: Wholes  # dofs that are held, and those that move as prescribed


class WireModel(NamedTuple):
    """Arrays of one wire; kernels view only the part they need."""

    elements: ElementArrays
    held: HeldArrays
    contact: ContactArrays
    plan: ChainPlan
    plates: PlateArrays = NO_PLATES
    stations: Stations = NO_STATIONS


PARTS = get_type_hints(WireModel).values()
# numbers of each part's first field in the packed arrays
_, HELD, CONTACT, PLAN, PLATES, STATIONS, _ = accumulate((len(each._fields) for each in PARTS), initial=0)

view_elements = viewer(ElementArrays)
view_held = viewer(HeldArrays, HELD)
view_contact = viewer(ContactArrays, CONTACT)
view_plan = viewer(ChainPlan, PLAN)
view_plates = viewer(PlateArrays, PLATES)
view_stations = viewer(Stations, STATIONS)


def build_model(
    scene: Scene,
    elements_per_turn: int,
    pairs_per_turn: int,
    element: str = "straight",
    found: np.ndarray = NONE_FOUND,
) -> tuple[WireModel, WireMesh, Rod]:
    """Arrays of the wire model of `scene`, its mesh and its wire as a rod.

    `found` are pairs of contact points that touch besides those one turn apart.
    """
    seat = scene.supports.require_supported("wirefe", SEATS)
    mesh = mesh_wire(scene.spring, elements_per_turn, seat == "plate")
    rod = _wire(scene, mesh, element)
    top = len(mesh.points) - 1
    rod = rod.holding(top, "uz", "rotx", "roty", *scene.supports.top_held)
    rod = rod.loaded(top, force=(*scene.load.force, 0.0))
    contact = contact_points(scene, mesh, elements_per_turn, pairs_per_turn, found)
    plates = NO_PLATES
    if seat == "plate":
        law, d = scene.contact, scene.spring.wire_diameter
        linear = tangential_stiffness(law.stiffness, law.exponent, d)
        plates = place_plates(scene.spring, mesh, linear, rod)
    stations = place_stations(scene.spring, mesh)
    data = rod_model(rod, mesh.arm, contact, plates)._replace(stations=stations)
    if scene.load.displacement:
        placed = np.union1d(data.held.placed, [6 * top + 1])
        data = data._replace(held=data.held._replace(placed=placed))
    return data, mesh, rod


def _wire(scene: Scene, mesh: WireMesh, element: str) -> Rod:
    """The elastic wire, held at the bottom."""
    spring, on_plates = scene.spring, scene.supports.seat == "plate"
    solid = spring.wire_rigidity == "solid"
    section = round_section(spring.wire_diameter, scene.material)
    flexibility = wire_flexibility(spring, scene.material)
    last = len(mesh.points) - on_plates  # on plates the last node is the top end
    points, phases = mesh.points[:last], mesh.phases[:last]
    if element == "curved":
        refuse_kinks(spring, mesh)
        rod = curved_rod(spring, phases, flexibility if solid else section)
    elif solid:
        middles = 0.5 * (phases[:-1] + phases[1:])
        rod = straight_solid_rod(points, flexibility(middles), spring.inward(middles))
    else:
        rod = straight_rod(points, section)
    return join_top(rod).holding(0, "ux", "uz", "roty") if on_plates else rod.holding(0)


def rod_model(
    rod: Rod, arm: np.ndarray, contact: ContactArrays = NO_CONTACT, plates: PlateArrays = NO_PLATES
) -> WireModel:
    """Arrays of a rod whose last point stands off from its last node by `arm`, with contact points."""
    count = len(rod.stiffness)
    chain = np.stack((np.arange(count), np.arange(1, count + 1)), axis=1)
    touching = _pair_couplings(contact)
    couplings = np.concatenate((chain, touching, plates.couplings(count)))
    plan, held, block, flip = _topology(count, couplings.tobytes(), rod.held.tobytes())
    high = count + len(touching)  # number of the first coupling with the top end
    reach, span = contact.reaches(count)
    return WireModel(
        ElementArrays(rod.stiffness, rod.second, rod.strain0, rod.triads, arm, block[:count], flip[:count]),
        held,
        contact._replace(reach=reach, span=span, block=block[count:high], flip=flip[count:high]),
        plan,
        plates._replace(block=block[high:], flip=flip[high:]),
    )


@lru_cache
def _topology(
    count: int, couplings: bytes, held: bytes
) -> tuple[ChainPlan, HeldArrays, np.ndarray, np.ndarray]:
    """Plan, held dofs, block and flip of each coupling of `count` elements: the same in most of a sweep."""
    nodes = np.frombuffer(couplings, dtype=np.int64).reshape(-1, 2)
    coupled = nodes[:, 0] != nodes[:, 1]
    last = np.union1d(nodes[count:], [count])
    block, flip = np.zeros(len(nodes), dtype=np.int64), np.zeros(len(nodes), dtype=bool)
    plan, block[coupled], flip[coupled] = plan_chain(count + 1, nodes[coupled], last)
    dofs = np.flatnonzero(np.frombuffer(held, dtype=bool))
    arrays = _held_arrays(dofs, nodes[coupled], block[coupled], flip[coupled])
    for array in (*plan[:-1], *arrays, block, flip):
        array.flags.writeable = False
    return plan, arrays, block, flip


def _pair_couplings(contact: ContactArrays) -> np.ndarray:
    """Couplings of the pairs' nodes: one of two spheres, six of two stations, some of a node with itself."""
    nodes = contact.attached[contact.pairs]
    if not of_wires(contact.parts):
        return nodes
    second = nodes + (contact.parts[contact.pairs, ROTATION] > 0.0)
    four = np.stack((nodes[:, 0], second[:, 0], nodes[:, 1], second[:, 1]), axis=1)
    return four[:, COUPLINGS].reshape(-1, 2)


def _held_arrays(held: np.ndarray, couplings: np.ndarray, block: np.ndarray, flip: np.ndarray) -> HeldArrays:
    blocks, each = np.unique(block, return_index=True)
    ends, flipped = couplings[each], flip[each]
    dof, c, end = np.nonzero(ends[None] == (held // 6)[:, None, None])
    return HeldArrays(held, blocks[c], held[dof] % 6, (end == 0) == flipped[c], held)


def rest_state(rod: Rod, arm: np.ndarray) -> np.ndarray:
    """State at rest, flat."""
    rows = at_rest(rod.points)
    rows[-1, :3] -= arm
    return rows.ravel()


def load_vector(rod: Rod) -> np.ndarray:
    """Load at time 1, flat; held dofs carry none."""
    return np.where(rod.held, 0.0, rod.loads).ravel()


def top_place(rod: Rod) -> Top:
    """Where the x and y of the top end's reference point are."""
    node = len(rod.points) - 1
    return Top((ROW * node, ROW * node + 1), (6 * node, 6 * node + 1), 36 * node + 7)


def matrix_size(model: WireModel) -> int:
    """Length of the matrix: 6 x 6 blocks, the nodes' diagonal ones first, then couplings and fill."""
    return 36 * model.plan.blocks
