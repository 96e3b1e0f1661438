"""A sweep: the scenes of a grid on all cores, a row each, kept as they come and not solved twice."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import cache
from importlib import import_module
from inspect import signature
from pathlib import Path
from typing import Any

from coilspring import EquilibriumPath, InputError, Scene
from coilspring.curves import COMPONENTS
from coilspring.solver.interface import Kernels
from coilspring.sweep import CRASHED, REFUSED, Outcome, outcomes_as_they_come
from coilspring.words import counted
from validation.study.files import content_of, json_bytes, keep, write_bytes
from validation.study.keys import run_key
from validation.study.machine import versions
from validation.study.rows import Row, append, kept_if_interrupted, whole_rows, write
from validation.sweep.grid import Point, Varied, number_of, require_any

CHUNK = {"equivbeam": 16, "wirefe": 1}  # springs handed to a worker at a time: lost where it is interrupted
FILE, PICTURE, SETTINGS = "sweep.csv", "sweep.png", "sweep.json"
DIGITS = 16  # of a row's key
LEAST = 3  # values that make a curve
UNASKED = dict.fromkeys(("accuracy", "estimated_error", "sampled"))  # where nothing was chosen by an accuracy
RESULTS = (
    *("outcome", "time", "load_x", "load_y", *COMPONENTS, "rate"),
    *("iterations", "active_contacts", "max_penetration", "max_contact_force", "max_stress"),
    *("critical_time", "message", "key"),
)


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
    table: Mapping[str, Any],
    varied: Sequence[Varied],
    grid: Sequence[Point],
    choose: Callable[[Scene], Choice],
    *,
    workers: int | None = None,
    progress: Callable[[int, int], None] = lambda done, of: None,
    about: Mapping[str, object] = UNASKED,
) -> list[Row]:
    """Solve the scenes of a grid, and write ``sweep.csv``: a row for each point, in their order; and
    ``sweep.json``: the scene, the values, how they are solved, and what else is known `about` them.

    A row is in the file as soon as its scene is solved. Rows that are there already from the same scenes,
    options and sources are not solved again; a file with any others is kept under another name, see
    `kept_files`. `table` has the keys of the scene that is `varied`; `workers`: see
    `coilspring.sweep.outcomes`; `progress` is called with the number of scenes done and of all.
    """
    require_any(grid)  # before anything that is there is replaced
    tasks = [(point.scene, choose(point.scene)) if point.scene else None for point in grid]
    keys = [_key(point, task) for point, task in zip(grid, tasks, strict=True)]
    target, columns = folder / FILE, (*(each.key for each in varied), *RESULTS)
    wanted = set(keys)
    found = (row for row in whole_rows(target, columns) if row["outcome"] != CRASHED)
    rows = {row["key"]: row for row in found if row["key"] in wanted}
    if _holds_more(target, columns, wanted):
        _keep(folder)
    write(rows.values(), target, columns)
    scene = {"scene": table.get("name"), "scene_table": table}
    values = {"varied": {each.key: each.values for each in varied}}
    settings = scene | values | _settings(task for task in tasks if task) | dict(about)
    write_bytes(folder / SETTINGS, json_bytes(settings | {"versions": versions()}))
    missing = {i: task for i, task in enumerate(tasks) if task and keys[i] not in rows}
    done = len(grid) - len(missing)
    progress(done, len(grid))
    chunk = min((CHUNK[choice.model] for _, choice in missing.values()), default=1)
    numbers, jobs = list(missing), iter(missing.values())
    with kept_if_interrupted(target, rows, len(grid)):
        for number, outcome in outcomes_as_they_come(jobs, chunk=chunk, workers=workers, kernels=_kernels):
            i = numbers[number]
            row = _row(columns, keys[i], grid[i], outcome)
            append([row], target, columns, synced=False)  # the beam finds a thousand a second
            rows[keys[i]] = row
            done += 1
            progress(done, len(grid))
    ordered = _ordered(columns, grid, keys, rows)
    write(ordered, target, columns)
    return ordered


def _kernels(scene: Scene, choice: Choice) -> Kernels:
    """Kernels with which a scene is solved."""
    return import_module(f"{choice.model}.solve").scene_kernels(scene, **choice.options)


def _settings(tasks: Iterable[tuple[Scene, Choice]]) -> dict[str, object]:
    """Model and options, defaults too, by which all scenes are solved; and values of those that differ."""
    each = [(choice.model, _options(scene, choice)) for scene, choice in tasks]
    models = {model for model, _ in each}
    values: dict[str, list[object]] = {}
    for _, options in each:
        for name, value in options.items():
            values.setdefault(name, []).append(value if isinstance(value, int | float) else str(value))
    shared = {name for name, found in values.items() if len(found) == len(each) and len(set(found)) == 1}
    return {
        "model": models.pop() if len(models) == 1 else None,
        "options": {name: found[0] for name, found in values.items() if name in shared},
        "differing": {name: [*dict.fromkeys(v)] for name, v in values.items() if name not in shared},
    }


def _options(scene: Scene, choice: Choice) -> dict[str, object]:
    """Options by which a scene is solved, defaults too; that of pairs per turn follows from its geometry."""
    options = _defaults(choice.model) | dict(choice.options)
    if choice.model == "wirefe":
        from wirefe.contact.points import PER_TURN

        options.setdefault("pairs_per_turn", PER_TURN[scene.contact.geometry])
    return options


@cache
def _defaults(model: str) -> dict[str, object]:
    """Options of a model's `solve` that are not the scene's unless given."""
    known = signature(import_module(model).solve).parameters.values()
    return {each.name: each.default for each in known if each.default not in (None, each.empty)}


def _key(point: Point, task: tuple[Scene, Choice] | None) -> str:
    """Key of a row by all that it follows from."""
    if task is None:
        return f"{REFUSED} {point.values!r}"
    scene, choice = task
    return run_key(choice.model, scene, choice.options)[:DIGITS]


def _holds_more(file: Path, columns: Sequence[str], wanted: Collection[str]) -> bool:
    """Whether a file has other columns, or solved rows other than those `wanted`."""
    text = (content_of(file) or b"").decode("utf-8", errors="replace")
    head, *lines = text.splitlines() or [""]
    if head != ",".join(columns):
        return bool(text.strip())
    whole = lines if text.endswith("\n") else lines[:-1]  # one that was interrupted is found again
    keys = {line.rpartition(",")[2] for line in whole}
    return not keys - {""} <= set(wanted)


def _keep(folder: Path) -> None:
    """Keep a file of another sweep, and how its rows were solved, unless it is kept already."""
    settings = keep(folder / FILE).with_suffix(".json")
    if (folder / SETTINGS).is_file() and not settings.exists():
        (folder / SETTINGS).replace(settings)


def kept_files(folder: Path) -> set[Path]:
    """Files of earlier sweeps in a folder, which later ones have not overwritten."""
    return set(folder.glob(f"{Path(FILE).stem}.*.csv"))


@contextmanager
def kept_sweeps(folder: Path) -> Iterator[list[str]]:
    """Lines on the files that a block has kept of earlier sweeps: there as it ends, and said where it is
    interrupted."""
    before = kept_files(folder)
    lines: list[str] = []
    try:
        yield lines
    except KeyboardInterrupt as stop:
        raise KeyboardInterrupt(*stop.args, *_kept_since(folder, before)) from None
    lines += _kept_since(folder, before)


def _kept_since(folder: Path, before: set[Path]) -> list[str]:
    return [f"the sweep that was there is kept in {file}" for file in kept_files(folder) - before]


def _ordered(
    columns: Sequence[str], grid: Sequence[Point], keys: Sequence[str], rows: Mapping[str, Row]
) -> list[Row]:
    """A row for each point, with its own values: points of one scene are found under one key."""
    return [
        rows[key] | _texts(dict(zip(columns, point.values, strict=False)))
        if point.scene
        else _row(columns, key, point, Outcome(REFUSED, point.refused))
        for point, key in zip(grid, keys, strict=True)
    ]


def _row(columns: Sequence[str], key: str, point: Point, found: Outcome) -> Row:
    """A row; nothing where there is no value."""
    values = dict(zip(columns, point.values, strict=False))
    if found.outcome not in (REFUSED, CRASHED):
        values |= asdict(found) | {"time": found.last_time, "iterations": found.total_iterations}
        values |= zip(("load_x", "load_y"), found.load or (), strict=False)
        values |= zip(COMPONENTS, found.tip or (), strict=False)
    values |= {"outcome": found.outcome, "message": " ".join(found.message.split())}
    values["key"] = "" if found.outcome == REFUSED else key  # which is soon found again
    return dict.fromkeys(columns, "") | _texts({name: values.get(name) for name in columns})


def _texts(values: Mapping[str, object]) -> Row:
    """Values as a scene file has them, to the last digit, where there are any."""
    return {
        name: str(value).lower() if isinstance(value, bool) else str(value)
        for name, value in values.items()
        if value is not None
    }


def write_picture(folder: Path, rows: Sequence[Row], keys: Sequence[str], scene: Scene, model: str) -> None:
    """Write ``sweep.png`` where one number is varied and enough of its values reach full load.

    Else remove what an earlier sweep has left there.
    """
    whole = {row[keys[0]] for row in rows if row["outcome"] == "completed"}
    if len(keys) > 1 or len(whole) < LEAST or any(isinstance(number_of(text), str) for text in whole):
        (folder / PICTURE).unlink(missing_ok=True)
        return
    from validation.sweep.figure import draw

    by = keys[0].split(".")[1] if keys[0].startswith("load.") else ""
    prescribed = by == "displacement" or (bool(scene.load.displacement) and by not in ("force", "stages"))
    write_bytes(folder / PICTURE, draw(rows, keys[0], scene.name, model, prescribed))


def digest(rows: Sequence[Row], keys: Sequence[str]) -> list[str]:
    """How many rows have which outcome, and which of the varied keys move nothing, for a reader at the
    terminal."""
    found = Counter(row["outcome"] for row in rows)
    counts = ", ".join(f"{count} {outcome.replace('_', ' ')}" for outcome, count in found.most_common())
    idle = [f"warning: {key} has no effect on any scene of the grid" for key in keys if _is_idle(rows, key)]
    return [f"{counted(len(rows), 'spring')}: {counts}", *idle]


def _is_idle(rows: Sequence[Row], key: str) -> bool:
    """Whether a key has several values, and each row comes once with every one of them."""
    count = len({row[key] for row in rows})
    others = {tuple(text for name, text in row.items() if name not in (key, "key")) for row in rows}
    return count > 1 and count * len(others) == len(rows)


def ended_early(rows: Sequence[Row]) -> str:
    """What did not reach full load, in one sentence; empty where all did.

    Raises `InputError`: no scene could be solved.
    """
    count = sum(row["outcome"] != "completed" for row in rows)
    refused = [row["message"] for row in rows if row["outcome"] == REFUSED]
    if len(refused) == len(rows):
        raise InputError(f"no scene can be solved: {refused[0]}")
    why = f"{len(refused)} cannot be solved (the first: {refused[0]}); " if refused else ""
    return f"{count} of {len(rows)} scenes did not reach full load: {why}{FILE} says why" if count else ""
