"""The equivalent beam of a scene: its data, and their places in the packed arrays."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from coilspring.compiling.packing import Table, Vector, Wholes, WholeTable, viewer
from coilspring.contact.law import PAIR_HISTORY, PairLaw, tangential_stiffness
from coilspring.errors import InputError
from coilspring.scene import HELD_CHOICES, Scene
from coilspring.solver.problem import Problem
from coilspring.solver.stages import Top
from equivbeam.band import ROW
from equivbeam.halfcoils import half_coil_count, nearest_crossing
from equivbeam.laws import LAWS, USER, law_rows
from equivbeam.laws.haringx import L0
from equivbeam.laws.helix import Refinements
from equivbeam.options import EXACT, TANGENTS, BeamOptions

PAIRS_PER_TURN = 2
ALL = Refinements()
CHOSEN = BeamOptions()  # where no others are


class BeamModel(NamedTuple):
    """Arrays of one equivalent beam; node i stands at half coil i of the axis, node 0 is clamped."""

    law: int  # of the half coils, see `equivbeam.laws`
    rows: Table  # (elements, columns) parameters of the half coils, as the law reads them
    fixed: Vector  # (3,) degrees of freedom of the last node that are fixed: 1.0 or 0.0
    attached: Wholes  # (circles,) node to which each circle is attached
    offset: Table  # (circles, 2) from the node to the circle's centre, at rest
    pairs: WholeTable  # (pairs, 2) circles that may touch
    reach: float  # largest distance of a circle from its node
    d: float  # wire diameter: the distance of centres at which a pair touches
    kc: float  # penalty of a pair
    kt: float  # its tangential stiffness
    k: float  # exponent
    mu: float  # coefficient of friction; infinite where closed pairs do not slide
    tangent: int  # EXACT, PAPER or PRINTED


view = viewer(BeamModel)


def build_model(scene: Scene, options: BeamOptions = CHOSEN) -> BeamModel:
    """Arrays of the equivalent beam of `scene`; `InputError` for what the model cannot represent."""
    spring, contact = scene.spring, scene.contact
    scene.supports.require_supported("equivbeam")
    if spring.sections and options.tangent != "exact":
        raise InputError(
            f"tangent must be exact where the spring has sections: the paper's matrix is for half coils of "
            f"one length, got {options.tangent!r}"
        )
    count = half_coil_count(spring)
    attached, offset = _circles(scene, count)
    index = np.arange(attached.size - 2)
    pairs = np.stack((index, index + 2), axis=1)
    # pairs within one rigid end never move against each other
    relative = attached[pairs[:, 0]] != attached[pairs[:, 1]]
    pairs = pairs[relative] if contact.enabled else pairs[:0]
    fixed = [name in scene.supports.top_held for name in HELD_CHOICES]
    kc = contact.pair_stiffness(PAIRS_PER_TURN)
    return BeamModel(
        law=LAWS[options.law] if isinstance(options.law, str) else USER,
        rows=law_rows(options.law, spring, scene.material, options.refinements or ALL, scene.factors),
        fixed=np.array(fixed, dtype=float),
        attached=attached,
        offset=offset,
        pairs=np.ascontiguousarray(pairs),
        reach=float(np.hypot(offset[:, 0], offset[:, 1]).max()),
        d=spring.wire_diameter,
        kc=kc,
        kt=tangential_stiffness(kc, contact.exponent, spring.wire_diameter),
        k=float(contact.exponent),
        mu=contact.coefficient if options.sliding == "scene" else 0.0,
        tangent=TANGENTS[options.tangent],
    )


def _circles(scene: Scene, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Attached nodes and offsets of the contact circles, end turns included, from bottom to top.

    Circles know the start phase only by the side on which the wire begins.
    """
    spring = scene.spring
    ends = math.floor(2 * spring.end_turns + 1e-9)
    half = np.arange(-ends, count + ends + 1)
    phases = half * math.pi
    first = 1.0 if nearest_crossing(spring) % 2 == 0 else -1.0
    attached = np.clip(half, 0, count)
    side = np.where(half % 2 == 0, first, -first)
    rise = spring.height(phases) - spring.height(attached * math.pi)
    return attached, np.stack((side * spring.radius(phases), rise), axis=1)


def rest_state(model: BeamModel) -> np.ndarray:
    """Positions and rotations (x, y, theta) of all nodes at rest, flat."""
    state = np.zeros((len(model.rows) + 1, 3))
    state[1:, 1] = np.cumsum(model.rows[:, L0])
    return state.ravel()


def with_tangent(model: BeamModel) -> BeamModel:
    """The model with the exact tangent as its matrix."""
    return model._replace(tangent=EXACT)


def load_vector(model: BeamModel, scene: Scene) -> np.ndarray:
    """Load at time 1 on the free nodes, flat; fixed degrees of freedom have none."""
    load = np.zeros(3 * len(model.rows))
    load[-3:-1] = np.array(scene.load.force) * (1.0 - model.fixed[:2])
    return load


def matrix_size(model: BeamModel) -> int:
    """Length of the banded matrix, see `equivbeam.band`."""
    return 3 * len(model.rows) * ROW


def beam_problem(data: BeamModel, load: np.ndarray) -> Problem:
    """The beam at rest under a load vector at time 1, as the path follower takes it."""
    x, free = 3 * len(data.rows), 3 * (len(data.rows) - 1)  # of the last node
    start = rest_state(data)
    return Problem(
        data=data,
        load=load,
        start=start,
        span=float(np.abs(start.reshape(-1, 3)[:, :2]).max()),
        history=np.zeros(len(data.pairs), PAIR_HISTORY),  # no pair has ever closed
        matrix_size=matrix_size(data),
        law=PairLaw.of(data),
        dofs_per_node=(2, 1),
        top=Top((x, x + 1), (free, free + 1), (free + 1) * ROW),
    )
