"""The deformed wire and its contact forces at every step, as pictures need them."""

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from coilspring import InputError, Scene
from validation.study.partialsolve import partial_path

HINT = "make it with coilcheck solve SCENE --model wirefe --vtu-series"


@dataclass(frozen=True)
class Frames:
    """The wire between its rigid ends, at rest and at every step."""

    diameter: float  # of the wire, mm
    times: np.ndarray  # (frames,) of the load, the first 0
    points: np.ndarray  # (frames, nodes, 3), mm
    forces: np.ndarray  # (frames, nodes) largest normal force of a pair at each node, N

    @property
    def touched(self) -> np.ndarray:
        """Nodes that something touches at some step."""
        return np.flatnonzero(self.forces.max(axis=0) > 0.0)


def of_scene(scene: Scene, progress: Callable[[str], None] = lambda line: None) -> Frames:
    """Solve a scene with the wire model, as far as it goes."""
    progress("loading wirefe")
    import wirefe
    from wirefe.results.export import section_results

    progress("solving with wirefe")
    path = partial_path(wirefe.solve, scene)
    if len(path.times) == 0:
        raise InputError(f"{scene.name} has no step to show: {path.message}")
    found = (section_results(path, step) for step in range(len(path.times)))
    steps = ((each.points, each.displacement, each.pair_force) for each in found)
    return _frames(scene.spring.wire_diameter, path.times, steps)


def of_run(folder: Path) -> Frames:
    """Read the series of VTU files of a run; `InputError` where the folder does not hold one."""
    import meshio

    if not (folder / "wire.pvd").is_file():
        raise InputError(f"{folder} holds no wire.pvd: {HINT}")
    try:
        sets = list(ElementTree.parse(folder / "wire.pvd").getroot().iter("DataSet"))
        meshes = [meshio.read(folder / each.attrib["file"], file_format="vtu") for each in sets]
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        steps = (
            (mesh.points, mesh.point_data["displacement"], mesh.point_data["pair_force"]) for mesh in meshes
        )
        times = [float(each.attrib["timestep"]) for each in sets]
        return _frames(float(summary["wire_diameter"]), times, steps)
    except (OSError, KeyError, ValueError, IndexError, ElementTree.ParseError, meshio.ReadError) as error:
        raise InputError(f"{folder} is not a whole run ({error}): {HINT}") from error


def _frames(diameter: float, times: Iterable[float], steps: Iterable[tuple[np.ndarray, ...]]) -> Frames:
    """Points, displacements and forces of the steps, behind a frame at rest."""
    points, displacements, forces = (np.stack(part) for part in zip(*steps, strict=True))
    points = np.concatenate((points[:1] - displacements[:1], points))
    return Frames(diameter, np.array([0.0, *times]), points, np.pad(forces, ((1, 0), (0, 0))))
