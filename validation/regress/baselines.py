"""What ``coilcheck regress`` runs, and the files in which what was found is kept."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from coilspring import CATALOGUE, EquilibriumPath, InputError, Scene
from validation.study.cases import solve_beam, solve_wire
from validation.study.machine import machine, versions
from validation.study.output import write_text
from validation.study.partialsolve import partial_path
from validation.study.scenes import study_scenes

MODELS = ("equivbeam", "wirefe")
SHIPPED = Path(__file__).with_name("baseline")  # of the runs on the catalogue's scenes
SHARES = (0.2, 0.4, 0.6, 0.8, 1.0)  # of the steps reached, at which the tips are kept

CURVES = ("ux", "uy", "rotz")
FORCES = ("contact_force", "contact_moment", "max_penetration")
COUNTS = ("iterations", "active_contacts")
Quantities = dict[str, Any]


@dataclass(frozen=True)
class Run:
    """One scene by one model with its options."""

    name: str
    model: str
    scene: Scene
    options: Mapping[str, object]
    sensitive: bool = False  # whether rounding decides where its critical point is found

    def solve(self) -> EquilibriumPath:
        """The path, complete or as far as it was reached."""
        return partial_path(
            solve_beam if self.model == "equivbeam" else solve_wire, self.scene, **self.options
        )


def runs_of(scene: Scene) -> tuple[Run, ...]:
    """Every run of a user's scene that is watched; a model may refuse some."""
    contact = scene.contact
    held = ("haringx", "helix") if contact.enabled and contact.sliding != "free" else ()
    return (*_usual(scene), *(_run("equivbeam", scene, law=law, sliding="scene") for law in held))


def _usual(scene: Scene) -> list[Run]:
    """Both laws, also in one step, the paper's matrices, and three meshes."""
    found = [_run("equivbeam", scene, law=law) for law in ("haringx", "helix")]
    found += [_run("equivbeam", scene, tangent=tangent) for tangent in ("paper", "paper-printed")]
    found += [_run("equivbeam", scene, law=law, steps=1) for law in ("haringx", "helix")]
    found += [_run("wirefe", scene, element="straight", elements_per_turn=40)]
    found += [_run("wirefe", scene, element="curved", elements_per_turn=mesh) for mesh in (4, 8)]
    return found


def runs() -> tuple[Run, ...]:
    """Every run on the catalogue's scenes that is watched."""
    cases = {name: make() for name, make in CATALOGUE.items()}
    free = cases["spring-b"]
    free = replace(free, name="spring-b-free", contact=replace(free.contact, sliding="free"))
    found = []
    for scene in cases.values():
        found += _usual(scene)
    for law in ("haringx", "helix"):
        found += [_run("equivbeam", cases["spring-b"], law=law, sliding="scene")]
        # soft circles let it telescope, at a limit point
        found += [_run("equivbeam", free, law=law, penalty=penalty) for penalty in (400.0, 600.0)]
    found += [_run("wirefe", cases["spring-a"], element="curved", elements_per_turn=8, pairs_per_turn=8)]
    found += [_run("wirefe", free, element="straight", elements_per_turn=40)]
    found += [_run("wirefe", free, element="curved", elements_per_turn=8)]
    slender = _slender()
    found += [_run("equivbeam", slender, law=law) for law in ("haringx", "helix")]
    # it bends gradually before it buckles: equal sources, compiled twice, differed by 2e-5 of time
    column = _run("wirefe", slender, element="curved", elements_per_turn=4)
    found += [replace(column, sensitive=True)]
    return tuple(found)


def _slender() -> Scene:
    """A column that buckles, at about 0.7 of its load."""
    scene = study_scenes()["slender-axial"]
    return replace(scene, name="slender-column", load=replace(scene.load, force=(0.0, -20.0)))


def _run(model: str, scene: Scene, **options: object) -> Run:
    listed = ", ".join(f"{name}={value}" for name, value in options.items())
    return Run(f"{scene.name}, {listed}", model, scene, options)


def quantities(path: EquilibriumPath, sensitive: bool = False) -> Quantities:
    """What is kept of a path; `sensitive` is that of its `Run`.

    ``contact_moment`` is the sum of force times number of the pair, which tells where coils touch;
    ``remembers`` whether closed pairs stick, so that the answer depends on the substeps.
    """
    reached = len(path.times)
    rows = sorted({max(round(share * reached) - 1, 0) for share in SHARES}) if reached else []
    forces = path.contact_forces[-1] if reached else np.zeros(0)
    peaks = np.abs(path.tips).max(axis=0, initial=0.0)
    return {
        "outcome": path.outcome,
        "steps_reached": reached,
        "critical_time": path.critical_time,
        "remembers": _path_dependent(path),
        "sensitive": sensitive,
        "times": [float(time) for time in path.times[rows]],
        **{name: [float(tip) for tip in path.tips[rows, i]] for i, name in enumerate(CURVES)},
        "peaks": dict(zip(CURVES, peaks.tolist(), strict=True)),
        "contact_force": float(forces.sum()),
        "contact_moment": float(forces @ np.arange(1, forces.size + 1)),
        "max_penetration": float(path.max_penetration[-1]) if reached else 0.0,
        "total_iterations": int(path.total_iterations),
        "iterations": [int(count) for count in path.iterations],
        "active_contacts": [int(count) for count in path.active_contacts],
    }


def _path_dependent(path: EquilibriumPath) -> bool:
    contact = path.scene.contact
    obeyed = path.model == "wirefe" or path.options["sliding"] == "scene"
    return contact.enabled and obeyed and contact.sliding != "free"


def find(
    chosen: Sequence[Run], progress: Callable[[str], None], keep: Callable[[dict], None] = lambda found: None
) -> tuple[dict[str, dict[str, Quantities]], tuple[str, ...]]:
    """Quantities of every run, by model and name, and a sentence on each that its model refuses.

    Parameters
    ----------
    keep : given what was found, whatever ends this.

    Raises
    ------
    InputError : all are refused.
    """
    found: dict[str, dict[str, Quantities]] = {model: {} for model in MODELS}
    refused: dict[str, str] = {}
    try:
        for run in chosen:
            progress(f"{run.model}: {run.name}")
            try:
                found[run.model][run.name] = quantities(run.solve(), run.sensitive)
            except InputError as error:
                refused.setdefault(str(error), f"left out: {run.model}, {run.name}: {error}")
    finally:
        keep(found)
    if not any(found.values()):
        raise InputError("; ".join(refused) or "there is nothing to run")
    return found, tuple(refused.values())


def write(found: Mapping[str, Mapping[str, Quantities]], folder: Path) -> None:
    """Write one file a model: one run a line, so that a changed line is a changed run."""
    for model, rows in found.items():
        runs = ",\n".join(f"  {json.dumps(name)}: {json.dumps(row)}" for name, row in rows.items())
        text = f'{{\n "made": {json.dumps(made())},\n "runs": {{\n{runs}\n }}\n}}\n'
        write_text(folder / f"{model}.json", text)


def made() -> dict[str, object]:
    """When and where numbers were found, and by what versions."""
    here = machine()
    return {"date": here["date"], "processor": here["processor"], "versions": versions()}


def read(folder: Path) -> dict[str, dict[str, Any]]:
    """Baselines by model, each with "made" and "runs".

    Raises
    ------
    InputError : where they are not there or cannot be read.
    """
    return {model: _read(folder / f"{model}.json") for model in MODELS}


def _read(file: Path) -> dict[str, Any]:
    if not file.is_file():
        raise InputError(f"no baseline at {file}: name its folder by --baselines, or write it by --accept")
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))
        kept["made"]["processor"], kept["runs"].items()
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{file} is no baseline: {error}; write it anew by --accept") from error
    return kept
