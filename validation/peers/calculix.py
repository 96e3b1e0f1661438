"""A scene's wire model as an input deck of CalculiX, and its run.

B32R beams with a circular section, which CalculiX expands to C3D20R solids; SPRINGA between sphere
centres with the penalty as a table of force over elongation; stiff beams for the rigid top.
"""

import os
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from coilspring import InputError, Scene
from validation.peers.layout import NODES_PER_TURN, PeerCurve, amplitudes, layout, refuse
from validation.study.template import template

STIFF = 1e4  # modulus of the stiff beams over the wire's
POINTER = 10.0  # length of the beam whose end gives ROTZ, in wire diameters
JOB = "scene"
FILE = f"{JOB}.inp"
INSTALL = "ccx is not installed: apt-get install calculix-ccx (Debian), or see calculix.de"


def deck(scene: Scene) -> str:
    """Input deck of a scene in mm, N, MPa; "no sliding" is left out, springs have no memory.

    The top is no rigid body, which would leave the last point of the wire a hinge, as beams have rotations in
    knots only: stiff beams go from the reference point to all that moves with it, and to a pointer above it,
    whose end gives ROTZ. `InputError` for what is not given to this peer.
    """
    refuse(scene, "calculix")
    wire, d = layout(scene, NODES_PER_TURN), scene.spring.wire_diameter
    count = len(wire.points)
    if count % 2 == 0:
        raise InputError(
            f"spring.active_coils must be a multiple of 1/{NODES_PER_TURN // 2} for calculix, "
            f"got {scene.spring.active_coils!r}"
        )
    normals = np.cross(np.gradient(wire.points, axis=0), (0.0, 1.0, 0.0))  # at each node towards the axis
    # numbers of nodes: those of the wire, the top reference point, the pointer's end, the spheres' centres
    top, spheres = count + 1, count + 3 + np.arange(len(wire.spheres))
    ends_of = (wire.attached < 0, wire.attached >= count)
    lower, upper = ([*zip(spheres[at], wire.spheres[at], strict=True)] for at in ends_of)
    pointer = (top + 1, wire.reference + np.array([0.0, POINTER * d, 0.0]))
    ends = [(count, wire.points[-1]), pointer, *upper]
    middles = enumerate(ends, count + 3 + len(spheres))
    number = np.where((wire.attached >= 0) & (wire.attached < count), wire.attached + 1, spheres)
    text = DECK.render(
        name=" ".join(scene.name.encode("ascii", "replace").decode().split())[:60],
        **{"scene": scene, "wire": wire, "d": d, "stiff": STIFF, "top": top, "steps": scene.load.rows},
        amplitudes=amplitudes(scene),
        elements=[(i // 2 + 1, (i + 1, i + 2, i + 3)) for i in range(0, count - 2, 2)],
        normals=normals / np.linalg.norm(normals, axis=1)[:, None],
        new_nodes=[(top, wire.reference), pointer, *lower, *upper],
        stiff_beams=[(middle, end, 0.5 * (wire.reference + point)) for middle, (end, point) in middles],
        clamped=[number for number, _ in lower],
        held=scene.supports.top_held,
        pairs=[(tag, *number[pair], d - wire.rest(pair)) for tag, pair in enumerate(wire.pairs, count)],
    )
    return text + "\n"


def row(first: object, values: Sequence[float]) -> str:
    """A line of the deck."""
    return f"{first}, " + ", ".join(f"{value:.12g}" for value in values)


DECK = template(Path(__file__).with_name("calculix.inp"), [row])


def run(scene: Scene) -> PeerCurve:
    """Load curve by the installed ``ccx``, as far as it gets; `InputError` where it is missing."""
    text, seconds = execute(deck(scene))
    times, tips, reaction = read(text, POINTER * scene.spring.wire_diameter)
    times = np.rint(times * scene.load.rows) / scene.load.rows  # which it prints with seven digits
    return PeerCurve("calculix", times, tips, seconds, reaction=reaction if scene.load.displacement else None)


def execute(deck: str) -> tuple[str, float]:
    """What ``ccx`` prints into its .dat file for an input deck, and its CPU seconds; see `run`."""
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


def read(text: str, length: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, UX, UY, ROTZ of the top and the axial force there, where it is printed, from a .dat file.

    At each time it has the top reference point and the end of the pointer, `length` above it at rest.
    """
    times: list[float] = []
    rows: dict[str, list[list[float]]] = {"displacements": [], "forces": []}
    kind = "displacements"
    for line in text.splitlines():
        words = line.split()
        if "time" in words:
            kind = words[0]
            times += [float(words[-1])] if kind == "displacements" else []
        elif len(words) == 4:
            rows[kind].append([float(word) for word in words[1:3]])
    top, pointer = np.array(rows["displacements"]).reshape(-1, 2, 2)[: len(times)].swapaxes(0, 1)
    x, y = (pointer - top).T
    turned = np.unwrap(np.arctan2(-x, length + y))
    forces = np.array(rows["forces"]).reshape(-1, 2)[:, 1]
    return np.array(times[: len(top)]), np.column_stack((top, turned)), forces
