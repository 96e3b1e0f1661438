"""What ``coilcheck regress`` runs, and the files in which what was found is kept."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from coilspring import CATALOGUE, EquilibriumPath, InputError, Load, Scene
from coilspring.curves import COMPONENTS
from validation.study.cases import study_scenes
from validation.study.files import in_the_way, write_text
from validation.study.machine import machine, versions
from validation.study.models import LAWS, MODELS
from validation.study.partialsolve import partial_path
from validation.study.paths import solve_beam, solve_wire

SHIPPED = Path(__file__).with_name("baseline")  # of the runs on the catalogue's scenes
SHARES = (0.2, 0.4, 0.6, 0.8, 1.0)  # of the steps reached, at which the tips are kept
STRAIGHT = {"element": "straight", "elements_per_turn": 40}
COARSE, CURVED = ({"element": "curved", "elements_per_turn": count} for count in (4, 8))
USUAL: tuple[tuple[str, dict[str, Any]], ...] = (  # models and options by which every scene is solved
    *(("equivbeam", {"law": law}) for law in LAWS),
    *(("equivbeam", {"tangent": tangent}) for tangent in ("paper", "paper-printed")),
    *(("equivbeam", {"law": law, "steps": 1}) for law in LAWS),
    *(("wirefe", mesh) for mesh in (STRAIGHT, COARSE, CURVED)),
)
SOLVES = {"equivbeam": solve_beam, "wirefe": solve_wire}
Quantities = dict[str, Any]


@dataclass(frozen=True)
class Run:
    """One scene by one model with its options."""

    model: str
    scene: Scene
    options: Mapping[str, object]
    sensitive: bool = False  # whether rounding decides where its critical point is found

    @property
    def name(self) -> str:
        """Name by which a run is kept."""
        return ", ".join([self.scene.name, *(f"{name}={value}" for name, value in self.options.items())])

    def solve(self) -> EquilibriumPath:
        """The path, complete or as far as it was reached."""
        return partial_path(SOLVES[self.model], self.scene, **self.options)


def runs_of(scene: Scene) -> tuple[Run, ...]:
    """Every run of a user's scene that is watched; a model may refuse some."""
    sticks = scene.contact.enabled and scene.contact.sliding != "free"
    sticking = [("equivbeam", {"law": law, "sliding": "scene"}) for law in LAWS if sticks]
    return tuple(Run(model, scene, options) for model, options in (*USUAL, *sticking))


def runs() -> tuple[Run, ...]:
    """Every run that is watched: of the catalogue, and of a column that buckles at 0.7 of its load."""
    cases = {name: make() for name, make in CATALOGUE.items()}
    free = cases["spring-b"]
    free = replace(free, name="spring-b-free", contact=replace(free.contact, sliding="free"))
    slender = study_scenes()["slender-axial"]
    slender = replace(slender, name="slender-column", load=replace(slender.load, force=(0.0, -20.0)))
    found = [Run(model, scene, options) for scene in cases.values() for model, options in USUAL]
    for law in LAWS:
        found.append(Run("equivbeam", cases["spring-b"], {"law": law, "sliding": "scene"}))
        # soft circles let it telescope, at a limit point
        found += [Run("equivbeam", free, {"law": law, "penalty": penalty}) for penalty in (400.0, 600.0)]
    found.append(Run("wirefe", cases["spring-a"], CURVED | {"pairs_per_turn": 8}))
    found += [Run("wirefe", free, mesh) for mesh in (STRAIGHT, CURVED)]
    found += [Run("equivbeam", slender, {"law": law}) for law in LAWS]
    pressed = replace(cases["spring-b"], name="spring-b-pressed", load=Load(displacement=(-14.0,)))
    found += [Run("equivbeam", pressed, {"law": "haringx"}), Run("wirefe", pressed, COARSE)]
    # it bends gradually before it buckles: equal sources, compiled twice, differed by 2e-5 of time
    return (*found, Run("wirefe", slender, COARSE, sensitive=True))


def shipped_runs(name: str) -> tuple[Run, ...]:
    """The runs on a catalogue's scene that are among `runs`."""
    return tuple(run for run in runs() if run.scene.name == name)


def of_runs(kept: Mapping[str, Mapping[str, Any]], chosen: Sequence[Run]) -> dict[str, dict[str, Any]]:
    """What is kept of some runs."""
    names = {(run.model, run.name) for run in chosen}
    return {
        model: {**each, "runs": {name: row for name, row in each["runs"].items() if (model, name) in names}}
        for model, each in kept.items()
    }


def quantities(path: EquilibriumPath, sensitive: bool = False) -> Quantities:
    """What is kept of a path; `sensitive` is that of its `Run`."""
    reached, contact = len(path.times), path.scene.contact
    obeyed = path.model == "wirefe" or path.options["sliding"] == "scene"
    rows = sorted({max(round(share * reached) - 1, 0) for share in SHARES}) if reached else []
    forces = path.contact_forces[-1] if reached else np.zeros(0)
    peaks = np.abs(path.tips).max(axis=0, initial=0.0)
    return {
        "outcome": path.outcome,
        "steps_reached": reached,
        "critical_time": path.critical_time,
        # whether closed pairs stick, so that the answer depends on the substeps
        "remembers": contact.enabled and obeyed and contact.sliding != "free",
        "sensitive": sensitive,
        "times": path.times[rows].tolist(),
        **dict(zip(COMPONENTS, path.tips[rows].T.tolist(), strict=True)),
        "peaks": dict(zip(COMPONENTS, peaks.tolist(), strict=True)),
        "load_y": path.loads[rows, 1].tolist(),  # the answer, where UY is prescribed
        "contact_force": float(forces.sum()),
        # of each pair, counted from 1, summed: where coils touch
        "force_times_number": float(forces @ np.arange(1, forces.size + 1)),
        "max_penetration": float(path.max_penetration[-1]) if reached else 0.0,
        "total_iterations": int(path.total_iterations),
        "iterations": path.iterations.tolist(),
        "active_contacts": path.active_contacts.tolist(),
    }


def find(
    chosen: Sequence[Run], progress: Callable[[str], None]
) -> tuple[dict[str, dict[str, Quantities]], tuple[str, ...]]:
    """Quantities of every run, by model and name, and a sentence on each that its model refuses; `InputError`
    where all are refused."""
    found: dict[str, dict[str, Quantities]] = {model: {} for model in MODELS}
    refused: dict[str, str] = {}
    for run in chosen:
        progress(f"{run.model}: {run.name}")
        try:
            found[run.model][run.name] = quantities(run.solve(), run.sensitive)
        except InputError as error:
            refused.setdefault(str(error), f"left out: {run.model}, {run.name}: {error}")
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
    """Baselines by model, each with "made" and "runs"; `InputError` where they cannot be read."""
    kept = {}
    for model in MODELS:
        file = folder / f"{model}.json"
        try:
            kept[model] = json.loads(file.read_text(encoding="utf-8"))
            kept[model]["made"]["processor"], kept[model]["runs"].items()
        except FileNotFoundError:
            raise InputError(
                f"no baseline at {file}: name its folder by --baselines, or write it by --accept"
            ) from None
        except NotADirectoryError:
            raise InputError(f"--baselines must name a folder, but {in_the_way(folder)} is a file") from None
        except OSError as error:
            raise InputError(
                f"--baselines must name a folder that can be read, got {folder} ({error.strerror or error})"
            ) from error
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise InputError(f"{file} is no baseline: {error}; write it anew by --accept") from error
    return kept
