"""Stresses along the wire at equilibria of the wire model, nominal and with the curvature's factors.

The force in an element is the same all along it, and the moment at a point x of it is that at its end x2 plus
(x2 - x) x force; contact between the nodes, of coils and of plates, adds to them (`wirefe.results.between`).
So section forces balance what acts on the wire between nodes too, however few there are.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from coilspring.errors import require_choice
from coilspring.path import EquilibriumPath, require_step, shape_of
from coilspring.scene import Scene
from coilspring.scene.profile import TWO_PI
from coilspring.scene.sizing import bending_factor, stress_factor
from coilspring.scene.spring import BESIDE
from wirefe.contact.stations import carried, fixed_to_sections, of_wires, rows, stations_in, turned_rows
from wirefe.element.beam import end_forces
from wirefe.element.rotations import cross_rows
from wirefe.mesh import WireMesh
from wirefe.model import WireModel
from wirefe.results.between import Between, at_plates, at_stations, beyond_sections

PER_TURN = 32  # sections of a turn, at least: what varies once a turn is 0.5 % larger between them at most
INSIDE = 2.0 * BESIDE  # rad: so far inside an element is what belongs to its end
FORCES = ("axial_force", "shear_force", "torsion", "bending_moment")
STRESSES = ("torsion_stress", "bending_stress", "shear_corrected", "bending_corrected", "equivalent")


class Wire(Protocol):
    """What stresses are found from: a wire, its mesh and contact, see `wirefe.results.shape.WireShape`."""

    @property
    def scene(self) -> Scene: ...

    @property
    def data(self) -> WireModel: ...

    @property
    def mesh(self) -> WireMesh: ...

    def histories(self, given: np.ndarray | None, states: np.ndarray) -> np.ndarray: ...

    def pair_gaps(self, states: np.ndarray) -> np.ndarray: ...


@dataclass(frozen=True)
class WireStress:
    """Section forces and stresses along the wire, each (..., sections): of one state, or of several.

    Attributes
    ----------
    turns : (sections,) of wire from the first active point; elastic end turns are beyond the active coils. A
        node of the mesh has two sections, below it and above: forces of contact act between them. At other
        points of contact forces are the means of both sides.
    axial_force, torsion : along and about the wire, N, N mm; with their signs.
    shear_force, bending_moment : across it; sizes.
    bending_in : bending moment in the plane of the coil, N mm; with its sign.
    torsion_stress : 16 |T| / (pi d^3), MPa: of a closely coiled spring under an axial force 8 F D / (pi d^3).
    bending_stress : 32 M / (pi d^3), MPa.
    shear_corrected : the first one with Bergstraesser's factor (EN 13906-1). The shear force is in it as far
        as it goes with the torsion, 2 T / D; the direct shear of another one is not.
    bending_corrected : the second one with the factor of torsion springs (EN 13906-3) on bending in the
        plane of the coil, and the axial force over the wire's area.
    equivalent : after von Mises, of the last two as if they were at one point of the section: a bound, but
        for that direct shear.
    """

    turns: np.ndarray
    axial_force: np.ndarray
    shear_force: np.ndarray
    torsion: np.ndarray
    bending_moment: np.ndarray
    bending_in: np.ndarray
    torsion_stress: np.ndarray
    bending_stress: np.ndarray
    shear_corrected: np.ndarray
    bending_corrected: np.ndarray
    equivalent: np.ndarray

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """Columns of ``stress.csv`` by name."""
        return {name: getattr(self, name) for name in ("turns", *FORCES, *STRESSES)}

    def largest(self, name: str = "shear_corrected") -> tuple[float, float]:
        """The largest of a stress, MPa, and at how many turns from the first active point it is.

        Raises
        ------
        InputError : `name` is no stress.
        """
        values = getattr(self, require_choice("name", name, STRESSES))
        place = int(np.argmax(values))
        return float(values[place]), float(self.turns[place])


def stress(path: EquilibriumPath, step: int = -1) -> WireStress:
    """Stresses along the wire at a stored step of a path of the wire model.

    Returns
    -------
    WireStress
        Arrays (sections,), 32 sections a turn at least: turns from the first active point, forces, N,
        moments, N mm, and stresses, MPa.

    Raises
    ------
    InputError : the path is not of the wire model, or has no such step.
    """
    wire: Wire = shape_of(path, "wirefe", "stress")
    step = require_step(path, step)
    histories = None if path.histories is None else path.histories[step][None]
    found = stresses(wire, path.states[step][None], histories)
    fields = {name: value if name == "turns" else value[0] for name, value in vars(found).items()}
    return WireStress(**fields)


class Sections(NamedTuple):
    """Where the wire is cut, and what a section takes of the nodes of its element, see
    `wirefe.contact.stations`."""

    element: np.ndarray  # (sections,)
    phases: np.ndarray  # (sections,)
    node: np.ndarray  # (sections,)
    parts: np.ndarray  # (sections, 15)
    inward: np.ndarray  # (sections, 3) towards the middle of the coil at rest, of any length
    coil_index: np.ndarray  # (sections,) D/d


def stresses(wire: Wire, states: np.ndarray, histories: np.ndarray | None) -> WireStress:
    """Stresses along the wire in several states (states, n), found with contact histories (None: of no pair);
    what is found is (states, sections)."""
    spring, cut = wire.scene.spring, sections_of(wire)
    force, moment, t = resultants(wire, states, histories, cut)
    frame = axes(states, cut, t)
    along, across = (np.einsum("snij,snj->sni", frame, vector) for vector in (force, moment))
    d = spring.wire_diameter
    unit = unit_stress(d)
    torsion, bending_in = across[..., 0], across[..., 2]
    bending = np.hypot(across[..., 1], bending_in)
    shear = shear_corrected(unit, cut.coil_index, torsion)
    bent = 2.0 * unit * np.hypot(across[..., 1], bending_factor(cut.coil_index) * bending_in)
    normal = bent + np.abs(along[..., 0]) * 4.0 / (math.pi * d**2)
    return WireStress(
        turns=cut.phases / TWO_PI,
        axial_force=along[..., 0],
        shear_force=np.hypot(along[..., 1], along[..., 2]),
        torsion=torsion,
        bending_moment=bending,
        bending_in=bending_in,
        torsion_stress=unit * np.abs(torsion),
        bending_stress=2.0 * unit * bending,
        shear_corrected=shear,
        bending_corrected=normal,
        equivalent=np.sqrt(normal**2 + 3.0 * shear**2),
    )


def largest_stresses(wire: Wire, states: np.ndarray, histories: np.ndarray | None) -> np.ndarray:
    """The largest `shear_corrected` of several states, (states,), MPa: torsion alone is found for it."""
    cut = sections_of(wire)
    _, moment, t = resultants(wire, states, histories, cut)
    unit = unit_stress(wire.scene.spring.wire_diameter)
    return shear_corrected(unit, cut.coil_index, (moment * t).sum(axis=-1)).max(axis=1)


def unit_stress(d: float) -> float:
    """Shear stress of a wire of diameter `d` under a torsion of 1 N mm, MPa."""
    return 16.0 / (math.pi * d**3)


def shear_corrected(unit: float, index: np.ndarray, torsion: np.ndarray) -> np.ndarray:
    """Shear stress with Bergstraesser's factor, of torsions (states, sections), MPa."""
    return unit * stress_factor(index) * np.abs(torsion)


def sections_of(wire: Wire) -> Sections:
    """Sections of the wire, evenly in each element from end to end: so at the wire's ends, where moments are
    often largest, and on both sides of nodes, where forces of contact act."""
    at, spring = wire.mesh.phases, wire.scene.spring
    steps = np.diff(at)
    real = np.flatnonzero(steps > 0.0)  # the hold of a tip on a plate has no length
    each = max(math.ceil(PER_TURN * steps[0] / TWO_PI - 1e-9), 1)
    phases = np.linspace(at[real], at[real + 1], each + 1, axis=1)
    # at nodes the tangent at rest may be a mean with that of the end turn, or of the next section
    inside = np.clip(phases, at[real, None] + INSIDE, at[real + 1, None] - INSIDE).ravel()
    carriers = carried(spring, wire.mesh, inside)
    phases = phases.ravel()
    index = 2.0 * spring.radius(phases) / spring.wire_diameter
    return Sections(np.repeat(real, each + 1), phases, *carriers, spring.inward(inside), index)


def resultants(
    wire: Wire, states: np.ndarray, histories: np.ndarray | None, cut: Sections
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Forces and moments that the wire above exerts on sections, and unit tangents, (states, sections, 3)."""
    data, nodes, element = wire.data.elements, rows(states), cut.element
    ends = np.empty((len(states), len(data.triads), 12))
    end_forces(
        np.ascontiguousarray(states), data.arm, data.triads, data.strain0, data.stiffness, data.second, ends
    )
    x, t = stations_in(states, cut.node, cut.parts)
    above = nodes[:, 1:, :3].copy()  # the elements' second ends
    above[:, -1] += turned_rows(nodes[:, -1, 3:], data.arm)
    force = ends[:, element, 6:9]
    moment = ends[:, element, 9:12] + cross_rows(above[:, element] - x, force)
    for where, acting in _between(wire, states, histories):
        more = beyond_sections(acting, wire.mesh, states[where], cut.element, cut.phases)
        force[where] += more[..., :3]
        moment[where] += more[..., 3:] - cross_rows(x[where], more[..., :3])
    return force, moment, t / np.linalg.norm(t, axis=-1, keepdims=True)


def _between(
    wire: Wire, states: np.ndarray, histories: np.ndarray | None
) -> Iterator[tuple[np.ndarray, Between]]:
    """What acts on the wire between its nodes, and in which of the states, (states,)."""
    if of_wires(wire.data.contact.parts):
        own = wire.histories(histories, states)
        touch = np.asarray((own["closed"] | (wire.pair_gaps(states) < 0.0)).any(axis=1))
        if touch.any():
            yield touch, at_stations(wire.data, states[touch], own[touch])
    if len(wire.data.plates.node):
        yield np.ones(len(states), dtype=bool), at_plates(wire.data, states)


def axes(states: np.ndarray, cut: Sections, t: np.ndarray) -> np.ndarray:
    """The sections' axes as rows: tangent, towards the middle of the coil, and across both, (states,
    sections, 3, 3)."""
    b = cross_rows(t, fixed_to_sections(rows(states), cut.node, cut.parts, cut.inward))
    b /= np.linalg.norm(b, axis=-1, keepdims=True)
    return np.stack((t, cross_rows(b, t), b), axis=-2)
