"""A scene's wire model as an input deck of CalculiX, and its run.

B32R beams with a circular section, which CalculiX expands to C3D20R solids; SPRINGA between sphere
centres with the penalty as a table of force over elongation; stiff beams for the rigid top.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from coilspring import InputError, Scene
from validation.peers.layout import Curve, Layout, layout, refuse

NODES_PER_TURN = 40  # 20 elements of three nodes
STIFF = 1e4  # modulus of the stiff beams over the wire's
POINTER = 10.0  # length of the beam whose end tells ROTZ, in wire diameters
JOB = "scene"
FILE = f"{JOB}.inp"
INSTALL = "ccx is not installed: apt-get install calculix-ccx (Debian), or see calculix.de"


def deck(scene: Scene) -> str:
    """Input deck of a scene, in mm, N and MPa; "no sliding" is left out, springs have no memory.

    Raises
    ------
    InputError : what is not given to this peer.
    """
    refuse(scene, "calculix")
    wire = layout(scene, NODES_PER_TURN)
    if len(wire.points) % 2 == 0:
        raise InputError(
            f"spring.active_coils must be a multiple of 1/{NODES_PER_TURN // 2} for calculix, "
            f"got {scene.spring.active_coils!r}"
        )
    blocks = [_head(scene), _wire(scene, wire), _ends(scene, wire), _springs(scene, wire), _step(scene, wire)]
    return "\n".join(line for block in blocks for line in block) + "\n"


def _head(scene: Scene) -> list[str]:
    name = " ".join(scene.name.encode("ascii", "replace").decode().split())
    return ["*HEADING", f"scene {name[:60]}: mm, N, MPa"]


def _node(number: int, point: np.ndarray) -> str:
    return f"{number}, " + ", ".join(f"{x:.12g}" for x in point)


def _wire(scene: Scene, wire: Layout) -> list[str]:
    """Nodes 1 .. n and three-node beams, with the normal at each node towards the axis."""
    count = len(wire.points)
    tangents = np.gradient(wire.points, axis=0)
    normals = np.cross(tangents, (0.0, 1.0, 0.0))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    elements = [(i // 2 + 1, (i + 1, i + 2, i + 3)) for i in range(0, count - 2, 2)]
    d = scene.spring.wire_diameter
    return [
        "*NODE, NSET=WIRE",
        *(_node(i, point) for i, point in enumerate(wire.points, 1)),
        "*ELEMENT, TYPE=B32R, ELSET=BEAMS",
        *(f"{tag}, {', '.join(map(str, nodes))}" for tag, nodes in elements),
        "*NORMAL",
        *(f"{tag}, " + _node(node, normals[node - 1]) for tag, nodes in elements for node in nodes),
        "*MATERIAL, NAME=STEEL",
        "*ELASTIC",
        f"{scene.material.E:.12g}, {scene.material.nu:.12g}",
        "*BEAM SECTION, ELSET=BEAMS, MATERIAL=STEEL, SECTION=CIRC",
        f"{d:.12g}, {d:.12g}",
        "0.6, 0., 0.8",
    ]


def _ends(scene: Scene, wire: Layout) -> list[str]:
    """The clamped bottom, and stiff beams from the top reference point to all that moves with it.

    A rigid body would leave the last point of the wire a hinge: beams have rotations in knots only.
    """
    count = len(wire.points)
    top, pointer = count + 1, count + 2
    spheres = [(count + 3 + i, point, wire.attached[i]) for i, point in enumerate(wire.spheres)]
    lower = [(number, point) for number, point, node in spheres if node < 0]
    upper = [(number, point) for number, point, node in spheres if node >= count]
    above = wire.reference + np.array([0.0, POINTER * scene.spring.wire_diameter, 0.0])
    ends = [(count, wire.points[-1]), (pointer, above), *upper]
    new = [(top, wire.reference), (pointer, above), *lower, *upper]
    held = scene.supports.top_held
    return [
        "*NODE",
        *(_node(number, point) for number, point in new),
        *_stiff_beams(scene, wire, count + 3 + len(spheres), ends),
        "*BOUNDARY",
        "1, 1, 6",
        *(f"{number}, 1, 3" for number, _ in lower),
        *([f"{top}, 1, 1"] if "ux" in held else []),
        f"{top}, 3, 5",
        *([f"{top}, 6, 6"] if "rotz" in held else []),
        "*NSET, NSET=TIP",
        f"{top}, {pointer}",
    ]


def _stiff_beams(scene: Scene, wire: Layout, first: int, ends: list[tuple[int, np.ndarray]]) -> Iterator[str]:
    """Beams from the top reference point to nodes; `first` is the number of the first middle node."""
    top, d = len(wire.points) + 1, scene.spring.wire_diameter
    yield "*NODE"
    for middle, (_, point) in enumerate(ends, first):
        yield _node(middle, 0.5 * (wire.reference + point))
    yield "*ELEMENT, TYPE=B32R, ELSET=STIFF"
    for middle, (end, _) in enumerate(ends, first):
        yield f"{middle}, {top}, {middle}, {end}"
    yield from ("*MATERIAL, NAME=STIFF", "*ELASTIC")
    yield f"{STIFF * scene.material.E:.12g}, {scene.material.nu:.12g}"
    yield "*BEAM SECTION, ELSET=STIFF, MATERIAL=STIFF, SECTION=CIRC"
    yield f"{d:.12g}, {d:.12g}"
    yield "0.36, 0.48, 0.8"  # along none of the beams


def _springs(scene: Scene, wire: Layout) -> list[str]:
    """One SPRINGA a pair: no force until the centres are a diameter apart, then the penalty."""
    count, d, stiffness = len(wire.points), scene.spring.wire_diameter, scene.contact.stiffness
    number = {
        i: int(node) + 1 if 0 <= node < count else count + 3 + i for i, node in enumerate(wire.attached)
    }
    lines = []
    for tag, pair in enumerate(wire.pairs, count):
        closed = d - wire.rest(pair)
        lines += [
            f"*ELEMENT, TYPE=SPRINGA, ELSET=PAIR{tag}",
            f"{tag}, {number[pair[0]]}, {number[pair[1]]}",
            f"*SPRING, ELSET=PAIR{tag}, NONLINEAR",
            "",
            f"{-stiffness * d:.12e}, {closed - d:.12e}",  # numbers without a point would be freedoms
            f"{0.0:.12e}, {closed:.12e}",
            f"{0.0:.12e}, {closed + 100.0 * d:.12e}",
        ]
    return lines


def _step(scene: Scene, wire: Layout) -> list[str]:
    top, step = len(wire.points) + 1, 1.0 / scene.load.steps
    forces = [f"{top}, {axis}, {force:.12g}" for axis, force in enumerate(scene.load.force, 1) if force]
    return [
        "*TIME POINTS, NAME=ROWS",
        *(f"{row / scene.load.steps:.12g}," for row in range(1, scene.load.steps + 1)),
        "*STEP, NLGEOM, INC=100000",
        "*STATIC",
        f"{step:.12g}, 1., 1e-5, {step:.12g}",
        "*CLOAD",
        *forces,
        "*NODE PRINT, NSET=TIP, TIME POINTS=ROWS",
        "U",
        "*END STEP",
    ]


def run(scene: Scene) -> Curve:
    """Load curve by the installed ``ccx``, as far as it gets.

    Raises
    ------
    InputError : ccx is missing, or what is not given to it.
    """
    text, seconds = execute(deck(scene))
    return Curve("calculix", *read(text, POINTER * scene.spring.wire_diameter), seconds)


def execute(deck: str) -> tuple[str, float]:
    """What ``ccx`` prints into its .dat file for an input deck, and the CPU seconds it takes.

    Raises
    ------
    InputError : ccx is missing.
    """
    program = shutil.which("ccx")
    if program is None:
        raise InputError(INSTALL)
    with tempfile.TemporaryDirectory(prefix="coilcheck-") as folder:
        file = Path(folder, FILE)
        file.write_text(deck, encoding="ascii")
        before = os.times()
        subprocess.run([program, JOB], cwd=folder, capture_output=True, check=False)
        after = os.times()
        printed = file.with_suffix(".dat")
        text = printed.read_text(encoding="ascii") if printed.exists() else ""
    return text, sum(after[2:4]) - sum(before[2:4])  # of subprocesses


def read(text: str, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Times and UX, UY, ROTZ of the top from a .dat file.

    At each time it has the top reference point and the end of the pointer, `length` above it at rest.
    """
    times, rows = [], []
    for line in text.splitlines():
        words = line.split()
        if "time" in words:
            times.append(float(words[-1]))
        elif len(words) == 4:
            rows.append([float(word) for word in words[1:3]])
    top, pointer = np.array(rows).reshape(-1, 2, 2)[: len(times)].swapaxes(0, 1)
    x, y = (pointer - top).T
    turned = np.unwrap(np.arctan2(-x, length + y))
    return np.array(times[: len(top)]), np.column_stack((top, turned))
