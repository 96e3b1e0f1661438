"""The deformed wire and its contact forces at every step, as pictures need them."""

import json
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from coilspring import EquilibriumPath, InputError, Scene, Spring
from coilspring.scene.profile import TWO_PI
from coilspring.scene.toml import scene_from_table
from validation.study.partialsolve import EndedEarly, partial_path

HINT = "make it with coilcheck solve SCENE --model wirefe --vtu-series"
READ = ("displacement", "rotation", "pair_force")  # of a VTU file
END_POINTS = 40  # of a turn that is rigid


@dataclass(frozen=True)
class Frames:
    """The whole wire, end turns included, at rest and at every step."""

    diameter: float  # of the wire, mm
    times: np.ndarray  # (frames,) of the load, the first 0
    points: np.ndarray  # (frames, points, 3): the nodes between those of rigid end turns, mm
    forces: np.ndarray  # (frames, points) largest normal force of a pair at each node, N

    @property
    def touched(self) -> np.ndarray:
        """Points that something touches at some step."""
        return np.flatnonzero(self.forces.max(axis=0) > 0.0)


def solved(scene: Scene, progress: Callable[[str], None] = lambda line: None) -> EquilibriumPath:
    """Path of a scene by the wire model, as far as it goes; raises `EndedEarly` before the first step."""
    progress("loading wirefe")
    import wirefe

    progress("solving with wirefe")
    path = partial_path(wirefe.solve, scene)
    if len(path.times) == 0:
        raise EndedEarly(f"{scene.name} has no step to show: {path.message}")
    return path


def of_path(path: EquilibriumPath) -> Frames:
    """Frames of a path of the wire model."""
    from wirefe.results.export import section_results

    found = (section_results(path, step) for step in range(len(path.times)))
    steps = ((each.points, each.displacement, each.rotation, each.pair_force) for each in found)
    return _frames(path.scene, path.times, steps)


def of_run(folder: Path) -> Frames:
    """Read the series of VTU files of a run; `InputError` where the folder does not hold one."""
    import meshio

    try:
        series = (folder / "wire.pvd").read_bytes()
    except OSError as error:
        raise InputError(
            f"{folder} holds no wire.pvd that can be read ({error.strerror or error}): {HINT}"
        ) from error
    try:
        sets = list(ElementTree.fromstring(series).iter("DataSet"))
        # `meshio.read` would end the process at a damaged file
        meshes = [meshio.vtu.read(folder / each.attrib["file"]) for each in sets]
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        steps = ((mesh.points, *(mesh.point_data[name] for name in READ)) for mesh in meshes)
        times = [float(each.attrib["timestep"]) for each in sets]
        return _frames(scene_from_table(summary["scene_table"]), times, steps)
    except (OSError, LookupError, TypeError, ValueError, ElementTree.ParseError, meshio.ReadError) as error:
        raise InputError(f"{folder} is not a whole run ({error}): {HINT}") from error


def _frames(scene: Scene, times: Iterable[float], steps: Iterable[tuple[np.ndarray, ...]]) -> Frames:
    """Points, displacements, rotations and forces of the steps, behind a frame at rest."""
    points, displacements, rotations, forces = (np.stack(part) for part in zip(*steps, strict=True))
    points = np.concatenate((points[:1] - displacements[:1], points))
    forces = np.pad(forces, ((1, 0), (0, 0)))
    if scene.supports.seat != "plate":  # there the end turns have nodes
        turns = np.pad(rotations, ((1, 0), (0, 0), (0, 0)))
        below, above = (_end_turn(scene.spring, points[:, end], turns[:, end], end) for end in (0, -1))
        points = np.concatenate((below, points, above), axis=1)
        forces = np.pad(forces, ((0, 0), (below.shape[1], above.shape[1])))
    return Frames(scene.spring.wire_diameter, np.array([0.0, *times]), points, forces)


def _end_turn(spring: Spring, nodes: np.ndarray, rotations: np.ndarray, end: int) -> np.ndarray:
    """Points of a rigid end turn, (frames, points, 3), mm: they move with the node, (frames, 3), where the
    active wire begins (end 0) or ends (-1), and turn with its rotation vector, (frames, 3)."""
    from scipy.spatial.transform import Rotation

    joint, tip = ((0.0, spring.phase_range[0]), (spring.phase_end, spring.phase_range[1]))[end]
    phases = np.linspace(joint, tip, math.ceil(abs(tip - joint) / TWO_PI * END_POINTS - 1e-9) + 1)[1:]
    rest = spring.points(np.append(joint, phases))
    arms = (rest[1:] - rest[0])[:: 1 if end else -1]  # along the wire
    return nodes[:, None] + np.stack([Rotation.from_rotvec(each).apply(arms) for each in rotations])
