"""Equilibrium paths in the store: arrays and numbers are kept, the shape is built anew by the model."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from coilspring import EquilibriumPath, Scene
from coilspring.path import Shape
from validation.study.keys import key, sources
from validation.study.machine import versions

ARRAYS = ("times", "states", "iterations", "memories")
NUMBERS = (
    "outcome", "message", "critical_time", "critical_bracket", "end_bracket", "total_iterations",
    "stability_checks", "pair_evaluations", "residual_history", "solve_seconds", "compile_seconds",
)  # fmt: skip


def run_key(model: str, scene: Scene, options: Mapping[str, object]) -> str:
    """Key of a run: scene, options, the sources of the model and of what it rests on, versions.

    Parameters
    ----------
    model : "equivbeam" or "wirefe".
    scene, options : what its `solve` is called with; options of JSON's types.
    """
    used = sources("coilspring", model, __name__)
    return key("run", model=model, scene=asdict(scene), options=options, sources=used, versions=versions())


def packed(path: EquilibriumPath) -> dict[str, bytes]:
    """A followed path, complete or not, as files of an entry."""
    numbers = {name: getattr(path, name) for name in NUMBERS} | {"options": dict(path.options)}
    arrays = {name: getattr(path, name) for name in ARRAYS} | {"found": _pairs_found(path)}
    if path.last_state is not None:
        arrays["last_state"] = path.last_state
    files = {f"{name}.npy": _npy(array) for name, array in arrays.items()}
    return files | {"numbers.json": json.dumps(numbers, default=np.generic.item).encode()}


def unpacked(
    files: Mapping[str, bytes], model: str, scene: Scene, options: Mapping[str, object]
) -> EquilibriumPath:
    """The path of an entry; `scene` and `options` are those of its key."""
    numbers = json.loads(files["numbers.json"])
    arrays: dict[str, Any] = {
        name.removesuffix(".npy"): _array(data) for name, data in files.items() if name.endswith(".npy")
    }
    found = arrays.pop("found")
    solved = scene.overridden(options.get("steps"), options.get("penalty"))  # type: ignore[arg-type]
    shape = _shape(model, solved, numbers["options"], found)
    numbers["residual_history"] = tuple(numbers["residual_history"])
    if numbers["end_bracket"] is not None:
        numbers["end_bracket"] = tuple(numbers["end_bracket"])
    return EquilibriumPath(scene=solved, model=model, shape=shape, **numbers, **arrays)


def _shape(model: str, scene: Scene, options: Mapping[str, object], found: np.ndarray) -> Shape:
    """The model's reader of states, as its `solve` makes it."""
    if model == "equivbeam":
        from equivbeam.solve import beam_shape

        return beam_shape(scene, options)
    from wirefe.shape import WireShape
    from wirefe.solve import scene_problem

    mesh_options = {name: options[name] for name in ("element", "elements_per_turn", "pairs_per_turn")}
    problem, mesh, _ = scene_problem(scene, **mesh_options, found=found)  # type: ignore[arg-type]
    return WireShape(scene, problem.data, mesh)


def _pairs_found(path: EquilibriumPath) -> np.ndarray:
    """Sphere pairs that the wire model's search has found: the last ones of its pairs."""
    count = path.options.get("pairs_found", 0)
    if not isinstance(count, int) or not count:
        return np.zeros((0, 2), dtype=np.int64)
    return path.shape.data.contact.pairs[-count:]  # type: ignore[attr-defined]


def _npy(array: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=False)
    return stream.getvalue()


def _array(data: bytes) -> np.ndarray:
    return np.load(io.BytesIO(data), allow_pickle=False)
