"""The deformed wire and its contact forces at every step, as pictures need them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from coilspring import InputError, Scene
from validation.study.partialsolve import partial_path

HINT = "make it with coilcheck solve SCENE --model wirefe --vtu-series"


@dataclass(frozen=True)
class Frames:
    """The wire between its rigid ends, at rest and at every step.

    Attributes
    ----------
    diameter : of the wire, mm.
    times : (frames,) of the load, the first 0.
    points : (frames, nodes, 3), mm.
    forces : (frames, nodes) largest normal force of a pair at each node, N.
    """

    diameter: float
    times: np.ndarray
    points: np.ndarray
    forces: np.ndarray

    @property
    def touched(self) -> np.ndarray:
        """Nodes that something touches at some step."""
        return np.flatnonzero(self.forces.max(axis=0) > 0.0)


def of_scene(scene: Scene) -> Frames:
    """Solve a scene with the wire model, as far as it goes."""
    import wirefe
    from wirefe.export import section_results

    path = partial_path(wirefe.solve, scene)
    if len(path.times) == 0:
        raise InputError(f"{scene.name} has no step to show: {path.message}")
    found = [section_results(path, step) for step in range(len(path.times))]
    return _frames(
        scene.spring.wire_diameter,
        list(path.times),
        [each.points for each in found],
        [each.displacement for each in found],
        [each.pair_force for each in found],
    )


def of_run(folder: Path) -> Frames:
    """Read the series of VTU files of a run.

    Raises
    ------
    InputError : the folder holds none, or files that are not those of a run.
    """
    import meshio

    if not (folder / "wire.pvd").is_file():
        raise InputError(f"{folder} holds no wire.pvd: {HINT}")
    try:
        sets = list(ElementTree.parse(folder / "wire.pvd").getroot().iter("DataSet"))
        meshes = [meshio.read(folder / each.attrib["file"], file_format="vtu") for each in sets]
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        return _frames(
            float(summary["wire_diameter"]),
            [float(each.attrib["timestep"]) for each in sets],
            [mesh.points for mesh in meshes],
            [mesh.point_data["displacement"] for mesh in meshes],
            [mesh.point_data["pair_force"] for mesh in meshes],
        )
    except (OSError, KeyError, ValueError, IndexError, ElementTree.ParseError, meshio.ReadError) as error:
        raise InputError(f"{folder} is not a whole run ({error}): {HINT}") from error


def _frames(
    diameter: float,
    times: list[float],
    points: list[np.ndarray],
    displacements: list[np.ndarray],
    forces: list[np.ndarray],
) -> Frames:
    """The steps behind a frame at rest."""
    rest = points[0] - displacements[0]
    return Frames(
        diameter=diameter,
        times=np.array([0.0, *times]),
        points=np.stack([rest, *points]),
        forces=np.vstack((np.zeros(len(rest)), *forces)),
    )
