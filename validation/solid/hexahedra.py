"""Coils of a spring as hexahedra for CalculiX (C3D20R): input deck and what it answers.

The bottom section is clamped, the top one rigid with the reference point on the axis at its height.
"""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from coilspring import Scene, Spring
from validation.peers.calculix import execute
from validation.study.template import template

CORE = 0.55  # half diagonal of the square in the middle of the section, over the wire's radius
DECK = template(Path(__file__).with_suffix(".inp"))


class Fineness(NamedTuple):
    """Of a mesh."""

    square: int  # quadrilaterals along an edge of the square
    rings: int  # from there to the surface
    length: float  # of the elements along the wire, over its diameter


COARSE, MIDDLE, FINE = Fineness(2, 1, 0.8), Fineness(3, 1, 0.8), Fineness(4, 2, 0.6)
FIRST = 0.1  # of the load: the first increment
MOST_INCREMENTS = 40


class SolidMesh(NamedTuple):
    """Nodes (n, 3) and elements (m, 20) from 0, nodes of both ends, and the reference point (3,)."""

    nodes: np.ndarray
    elements: np.ndarray
    bottom: np.ndarray
    top: np.ndarray
    reference: np.ndarray


def section_grid(fineness: Fineness) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 2) of a disk of diameter 1 and quadrilaterals (m, 8), corners first: a square and its rim."""
    m, k = 2 * fineness.square + 1, 2 * fineness.rings + 1
    u, v = np.meshgrid(np.linspace(-1.0, 1.0, m), np.linspace(0.0, 1.0, k), indexing="ij")
    edge, arc = CORE * math.sqrt(0.5), 0.25 * math.pi * u
    side = (1.0 - v)[..., None] * np.stack((edge + 0.0 * u, edge * u), axis=-1)
    side += v[..., None] * np.stack((np.cos(arc), np.sin(arc)), axis=-1)
    u, v = np.meshgrid(np.linspace(-edge, edge, m), np.linspace(-edge, edge, m), indexing="ij")
    turns = [np.array([[c, s], [-s, c]]) for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    blocks = [np.stack((u, v), axis=-1), *(np.swapaxes(side, 0, 1) @ turn for turn in turns)]
    points: list[list[float]] = []
    quads = []
    for block in blocks:
        number = len(points) + np.arange(block[..., 0].size).reshape(block.shape[:2])
        points += block.reshape(-1, 2).tolist()
        a, b, c = slice(0, -2, 2), slice(1, None, 2), slice(2, None, 2)
        around = ((a, a), (c, a), (c, c), (a, c), (b, a), (c, b), (b, c), (a, b))
        quads.append(np.stack([number[i, j] for i, j in around], axis=-1).reshape(-1, 8))
    # without unused and double points
    used, cells = np.unique(np.concatenate(quads), return_inverse=True)
    nodes = 0.5 * np.array(points)[used]
    _, first, same = np.unique(np.round(nodes, 9), axis=0, return_index=True, return_inverse=True)
    return nodes[first], same.ravel()[cells.reshape(-1, 8)]


def mesh_coils(spring: Spring, coils: float, fineness: Fineness) -> SolidMesh:
    """The first active coils of a spring."""
    at, quads = section_grid(fineness)
    d, end = spring.wire_diameter, 2.0 * math.pi * coils
    speed = np.linalg.norm(spring.derivatives(np.linspace(0.0, end, 50))[0], axis=1).mean()
    count = math.ceil(speed * end / d / fineness.length)
    phases = np.linspace(0.0, end, 2 * count + 1)
    first, second = spring.derivatives(phases)
    t = first / np.linalg.norm(first, axis=1)[:, None]
    b = np.cross(first, second)
    b /= np.linalg.norm(b, axis=1)[:, None]
    n = np.cross(b, t)
    across = d * (at[:, 0, None] * n[:, None] + at[:, 1, None] * b[:, None])
    every = (spring.points(phases)[:, None] + across).reshape(-1, 3)
    low = quads + 2 * len(at) * np.arange(count)[:, None, None]
    up = low + 2 * len(at)
    middle = low[..., :4] + len(at)
    hexahedra = np.concatenate((low[..., :4], up[..., :4], low[..., 4:], up[..., 4:], middle), axis=-1)
    used, elements = np.unique(hexahedra.reshape(-1, 20), return_inverse=True)
    reference = np.array([0.0, float(spring.height(np.array([end]))[0]), 0.0])
    ends = (np.flatnonzero(used < len(at)), np.flatnonzero(used >= 2 * count * len(at)))
    return SolidMesh(every[used], elements.reshape(-1, 20), *ends, reference)


def deck(mesh: SolidMesh, E: float, nu: float, steps: Sequence[str]) -> str:
    """Input deck; the reference point and its rotation are the last two nodes, both in the set TIP."""
    nodes = np.concatenate((mesh.nodes, [mesh.reference, mesh.reference])).tolist()
    elements = [(i, *cell) for i, cell in enumerate((mesh.elements + 1).tolist(), 1)]
    shape = {"mesh": mesh, "nodes": nodes, "elements": elements, "reference": len(mesh.nodes) + 1}
    return DECK.render(shape, E=E, nu=nu, steps=steps)


PRINT = ["*NODE PRINT, NSET=TIP", "U", "*END STEP"]


def flexibility(mesh: SolidMesh, E: float, nu: float) -> tuple[np.ndarray, float]:
    """Motion (u, rotation) of the reference point by unit forces and moments there, (6, 6); CPU seconds."""
    reference = len(mesh.nodes) + 1
    steps = []
    for dof in range(6):
        load = f"{reference + dof // 3}, {dof % 3 + 1}, 1."
        steps += ["*STEP", "*STATIC", "*CLOAD, OP=NEW", load, *PRINT]
    text, seconds = execute(deck(mesh, E, nu, steps))
    found = read(text).reshape(-1, 6)
    return 0.5 * (found + found.T), seconds


def deflection(scene: Scene, fineness: Fineness) -> np.ndarray:
    """UX, UY, ROTZ of a scene's top at full load in large deflection, no contact, (3,).

    nan where CalculiX does not reach full load in `MOST_INCREMENTS`: ends that turn take it many small ones.
    """
    mesh = mesh_coils(scene.spring, scene.spring.active_coils, fineness)
    reference = len(mesh.nodes) + 1
    dofs = {"ux": (0, 1), "uy": (0, 2), "rotz": (1, 3)}
    held = [(0, 3), (1, 1), (1, 2), *(dofs[name] for name in scene.supports.top_held)]
    loads = [f"{reference}, {axis}, {value:.12g}" for axis, value in enumerate(scene.load.force, 1) if value]
    boundary = [f"{reference + node}, {dof}, {dof}" for node, dof in held]
    step = [f"*STEP, NLGEOM, INC={MOST_INCREMENTS}", "*STATIC", f"{FIRST}, 1., 1e-4, 0.25", "*CLOAD", *loads]
    steps = ["*BOUNDARY", *boundary, *step, *PRINT]
    text, _ = execute(deck(mesh, scene.material.E, scene.material.nu, steps))
    times = [float(line.split()[-1]) for line in text.splitlines() if "time" in line]
    if not times or times[-1] < 1.0:
        return np.full(3, np.nan)
    return read(text).reshape(-1, 6)[-1, [0, 1, 5]]


def read(text: str) -> np.ndarray:
    """Displacements printed in a .dat file, (rows, 3)."""
    rows = [line.split()[1:] for line in text.splitlines() if len(line.split()) == 4]
    return np.array(rows, dtype=float).reshape(-1, 3)
