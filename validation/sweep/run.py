"""A sweep: the scenes of a grid on all cores, a row each, kept as they come and not solved twice."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from coilspring import EquilibriumPath, InputError, Scene
from coilspring.solver.startup import store
from coilspring.sweep import REFUSED, Outcome, outcomes
from validation.study.keys import run_key
from validation.study.output import write_bytes
from validation.sweep.grid import Point, Varied, points
from validation.sweep.table import COMPLETED, FILE, Row, Table, is_curve

CHUNK = 16  # springs handed to a worker at a time
PICTURE = "sweep.png"
DIGITS = 16  # of a row's key


@dataclass(frozen=True)
class Choice:
    """What solves a scene: a model and the options of its `solve`, of JSON's types or a law."""

    model: str
    options: Mapping[str, Any]

    @classmethod
    def of(cls, model: str, options: Mapping[str, Any]) -> Choice:
        """A choice for all scenes; a law is taken with its content."""
        if "law" not in options:
            return cls(model, options)
        from equivbeam.laws import law_of

        return cls(model, {**options, "law": law_of(options["law"])})

    def __call__(self, scene: Scene) -> EquilibriumPath:
        """The path of a scene."""
        return import_module(self.model).solve(scene, **self.options)


def sweep(
    folder: Path,
    scene: Scene,
    varied: Sequence[Varied],
    choose: Callable[[Scene], Choice],
    *,
    workers: int | None = None,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> list[Row]:
    """Solve all combinations of the values, and write ``sweep.csv``: a row for each, in their order.

    A row is on disk as soon as its scene is solved. Rows that are there already from the same scenes,
    options and sources are not solved again. `workers`: see `coilspring.sweep.outcomes`; `progress` is
    called with the number of scenes done and of all.
    """
    grid = list(points(scene, varied))
    tasks = [(point.scene, choose(point.scene)) if point.scene else None for point in grid]
    keys = [_key(point, task) for point, task in zip(grid, tasks, strict=True)]
    table = Table(folder, [each.key for each in varied], set(keys))
    missing = {i: task for i, task in enumerate(tasks) if task and keys[i] not in table.rows}
    done = len(grid) - len(missing)
    progress(done, len(grid))
    models = {choice.model for _, choice in missing.values()}

    def prepare() -> None:
        for model in models:
            store(import_module(f"{model}.solve").KERNELS)

    found = outcomes(iter(missing.values()), chunk=CHUNK, workers=workers, prepare=prepare)
    for i, outcome in zip(missing, found, strict=True):
        table.append(keys[i], grid[i].values, outcome)
        done += 1
        progress(done, len(grid))
    for point, key in zip(grid, keys, strict=True):
        if point.scene is None:
            table.keep(key, point.values, Outcome(REFUSED, point.refused))
    return table.write(keys)


def write_picture(folder: Path, rows: Sequence[Row], keys: Sequence[str], scene: Scene, model: str) -> None:
    """Write ``sweep.png`` where one number is varied; else remove what an earlier sweep has left there."""
    target = folder / PICTURE
    if not is_curve(rows, keys):
        target.unlink(missing_ok=True)
        return
    from validation.sweep.figure import draw

    by = keys[0].split(".")[1] if keys[0].startswith("load.") else ""
    prescribed = by == "displacement" or (bool(scene.load.displacement) and by not in ("force", "stages"))
    write_bytes(target, draw(rows, keys[0], scene.name, model, prescribed))


def _key(point: Point, task: tuple[Scene, Choice] | None) -> str:
    """Key of a row by all that it follows from."""
    if task is None:
        return f"{REFUSED} {point.values!r}"
    scene, choice = task
    return run_key(choice.model, scene, choice.options)[:DIGITS]


def digest(rows: Sequence[Row]) -> list[str]:
    """How many rows have which outcome, for a reader at the terminal."""
    found = Counter(row["outcome"] for row in rows)
    counts = ", ".join(f"{count} {outcome.replace('_', ' ')}" for outcome, count in found.most_common())
    return [f"{len(rows)} springs: {counts}"]


def ended_early(rows: Sequence[Row]) -> str:
    """What did not reach full load, in one sentence; empty where all did.

    Raises `InputError`: no scene could be solved.
    """
    count = sum(row["outcome"] != COMPLETED for row in rows)
    if all(row["outcome"] == REFUSED for row in rows):
        raise InputError(f"no scene can be solved: {rows[0]['message']}")
    return f"{count} of {len(rows)} scenes did not reach full load; {FILE} says why" if count else ""
