"""The command ``coilcheck``."""

import argparse
import signal
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict
from importlib import import_module
from pathlib import Path

from coilspring import CATALOGUE, EquilibriumNotFound, EquilibriumPath, InputError, Scene, load_scene
from coilspring.curves import compare_paths
from coilspring.errors import require_integer
from coilspring.measured import Measured, measured
from coilspring.scene.scene import SECTIONS
from coilspring.scene.toml import scene_text
from validation.calibration import difference
from validation.cli import INTERRUPTED, studies
from validation.cli.arguments import (
    MESH,
    MODEL_OPTIONS,
    command_line,
    flagged,
    given,
    refuse_chosen,
    refuse_other_models,
    scene_of,
)
from validation.cli.terminal import (
    announcing,
    deviation,
    digest,
    ended_early,
    notes,
    progress_shown,
    say,
    warn,
)
from validation.study import output
from validation.study.files import OutputError, claimed, json_bytes, json_text, prepare
from validation.study.partialsolve import EndedEarly, partial_path
from validation.study.scenewarnings import warnings

MOST_FREQUENCIES = 100
ADAPTIVE = "wirefe"  # the model that an accuracy is for
COMPLETED, REGRESSED, BAD_INPUT, NOT_COMPLETED, NOT_WRITTEN = 0, 1, 2, 3, 4


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code."""
    arguments = argparse.Namespace()
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends like Ctrl-C, and so do its workers
    try:
        command_line().parse_args(argv, arguments)
        return COMMANDS[arguments.command](arguments)
    except InputError as error:
        return _fail(BAD_INPUT, flagged(str(error), arguments))
    except EquilibriumNotFound as error:
        return _fail(NOT_COMPLETED, f"{error.path.scene.name}: {error.path.model}: {error.message}")
    except EndedEarly as error:
        return _fail(NOT_COMPLETED, str(error))
    except OutputError as error:
        return _fail(NOT_WRITTEN, str(error))
    except KeyboardInterrupt as stop:
        said = "; ".join(map(str, stop.args))
        return _fail(INTERRUPTED, f"interrupted: {said}" if said else "interrupted")


def _fail(code: int, message: str) -> int:
    warn(message)
    return code


def new(arguments: argparse.Namespace) -> int:
    """Print a scene file."""
    say(scene_text(CATALOGUE[arguments.name]()).rstrip("\n"))
    return COMPLETED


def check(arguments: argparse.Namespace) -> int:
    """Say what a scene describes."""
    scene = load_scene(arguments.scene)
    with progress_shown() as progress:
        progress("loading both models")
        from validation.view.check import report

        lines, warnings = report(scene, announcing(progress, "equivbeam", scene))
        lines += [f"warning: {warning}" for warning in warnings]
        if arguments.draw or arguments.out:
            folder = _folder(arguments)
            prepare(folder)
            progress("drawing")
            from validation.view.drawing import draw

            draw(scene, folder / "spring.png")
            lines.append(f"drawn in {folder / 'spring.png'}")
    say(*lines)
    return COMPLETED


def solve(arguments: argparse.Namespace) -> int:
    """Solve one scene with one model, or as accurately as asked for."""
    model = arguments.model = arguments.model or ADAPTIVE
    refuse_other_models(arguments)
    scene, count = scene_of(arguments), arguments.frequencies
    if count is not None:
        require_integer("frequencies", count, 1, MOST_FREQUENCIES)
    folder = _folder(arguments)
    with claimed(folder):
        with progress_shown(arguments.quiet) as progress:
            path = _run(scene, model, arguments, progress)
        found, lines = output.summary(path), digest(path)
        if count:
            found |= {"frequencies": None, "modes": None}
        if count and len(path.times):
            from wirefe import modes

            lowest = modes(path, count=count)
            found["frequencies"], found["modes"] = map(list, zip(*lowest, strict=True))
            listed = ", ".join(f"{mode.frequency:.4g} ({mode.kind})" for mode in lowest)
            lines.append(f"  natural frequencies {listed} Hz, both ends held")
        asked = [name for name in ("frequencies", *output.WIRE_FILES) if getattr(arguments, name)]
        if asked and not len(path.times):
            left = ", ".join(f"--{name.replace('_', '-')}" for name in asked)
            lines.append(f"  no step was reached, so there is nothing for {left}: more --steps may reach one")
        files = output.path_files(path, found)
        for name, make in output.WIRE_FILES.items() if len(path.times) else ():
            files |= make(path) if getattr(arguments, name) else {}
        if any(name.startswith("wire/") for name in files):
            prepare(folder / "wire")
        lines += [f"written to {folder}", *output.replaced(folder, found)]
        lines += output.write_runs({folder: files})
    return _concluded(arguments, found, lines, path)


def compare(arguments: argparse.Namespace) -> int:
    """Solve one scene with both models and compare them."""
    refuse_chosen(arguments, MESH)
    scene = scene_of(arguments)
    curve = measured(arguments.measured, scene) if arguments.measured else None
    folder = _folder(arguments)
    with ExitStack() as claims:
        for each in (folder, *(folder / model for model in MODEL_OPTIONS)):
            claims.enter_context(claimed(each))
        with progress_shown(arguments.quiet) as progress:
            paths = {model: _run(scene, model, arguments, progress) for model in MODEL_OPTIONS}
            compared = paths if curve is None else _to_compare(paths, curve, arguments, progress)
        comparison = compare_paths(paths["equivbeam"], paths["wirefe"])
        found = {
            "scene": scene.name,
            **asdict(comparison),
            **{model: str((folder / model).resolve()) for model in paths},
            "warnings": [*warnings(scene), *(difference.warnings(compared, curve) if curve else [])],
            **{name: getattr(paths[ADAPTIVE], name) for name in ("accuracy", "estimated_error")},
            "outcomes": {model: path.outcome for model, path in paths.items()},
            "notes": [f"{model}: {note}" for model, path in paths.items() for note in notes(path)],
        }
        if curve is not None:
            found["measured"] = {"file": arguments.measured, **difference.summary(compared, curve)}
        pictures, lines = _pictures(arguments.draw, scene, paths, compared, curve)
        lines += [f"written to {folder}"]
        runs = {folder: {"compare.json": json_bytes(found), **pictures}}
        for model, path in paths.items():
            summary = output.summary(path)
            runs[folder / model] = output.path_files(path, summary)
            lines += output.replaced(folder / model, summary)
        lines += output.write_runs(runs)
    said = [line for path in paths.values() for line in digest(path)]
    said += deviation(comparison, paths[ADAPTIVE])
    if curve is not None:
        said += difference.lines(compared, curve)
    return _concluded(arguments, found, [*said, *lines], *paths.values())


def _pictures(
    draw: bool,
    scene: Scene,
    paths: Mapping[str, EquilibriumPath],
    compared: Mapping[str, EquilibriumPath],
    curve: Measured | None,
) -> tuple[dict[str, bytes], list[str]]:
    """Figures asked for or of a measured curve, and a sentence on what is not drawn."""
    files, undrawn = {}, difference.undirected(scene) if draw else ""
    if draw:
        from validation.view.overlay import overlay

        files["compare.png"] = overlay(*paths.values())
    if curve is not None or (draw and not undrawn):
        from validation.calibration.figure import load_curves

        files["curve.png"] = load_curves(paths, curve, compared=compared)
    return files, [f"curve.png is not drawn: {undrawn}"] if undrawn else []


def long_command(arguments: argparse.Namespace) -> int:
    """Run a study, or hand a scene to another program or to the eye."""
    with progress_shown() as progress:
        lines, failure = studies.COMMANDS[arguments.command](arguments, _folder(arguments), progress)
    say(*lines)
    code = REGRESSED if arguments.command in ("regress", "stability") else NOT_COMPLETED
    return _fail(code, failure) if failure else COMPLETED


COMMANDS = {each.__name__: each for each in (new, check, solve, compare)}
COMMANDS |= dict.fromkeys(studies.COMMANDS, long_command)


def _folder(arguments: argparse.Namespace) -> Path:
    """Where to write; of a scene, by its catalogue name or its file's name."""
    if getattr(arguments, "out", None):
        return arguments.out
    name = arguments.command
    scene, *others = getattr(arguments, "scenes", None) or [getattr(arguments, "scene", None)]
    if scene and not others:
        name += f"-{Path(scene).stem}"
    if arguments.command == "study-law":
        name += f"-{Path(arguments.laws[0]).stem}"
    return Path("coilcheck-out", name)


def _run(
    scene: Scene, model: str, arguments: argparse.Namespace, progress: Callable[[str], None]
) -> EquilibriumPath:
    """The path of one model, complete or as far as it was reached."""
    progress(f"loading {model}")
    package = import_module(model)  # it alone: numba takes its time
    progress = announcing(progress, model, scene)
    names: Sequence[str] = MODEL_OPTIONS[model]
    solver, options = package.solve, given(arguments, names)
    if model == ADAPTIVE and arguments.accuracy is not None:
        solver, options = package.solve_to, given(arguments, ("accuracy", "pairs_per_turn"))
        options["progress"] = lambda line: progress(f"solving with {model}: {line}")
    progress(f"solving with {model}")
    try:
        return partial_path(solver, scene, **options)
    except InputError as error:
        if arguments.scene in CATALOGUE or str(error).partition(".")[0] not in SECTIONS:
            raise
        raise InputError(f"{arguments.scene}: {error}") from None  # a key of that file


def _to_compare(
    paths: Mapping[str, EquilibriumPath],
    curve: Measured,
    arguments: argparse.Namespace,
    progress: Callable[[str], None],
) -> dict[str, EquilibriumPath]:
    """The paths to compare with a measured curve: solved once more where the scene's steps do not do."""
    compared = {}
    for model, path in paths.items():
        options, scene = given(arguments, MODEL_OPTIONS[model]), difference.scene_for(path.scene, curve)
        if model == ADAPTIVE:  # an accuracy may have chosen the mesh
            options = {name: path.options[name] for name in MODEL_OPTIONS[model]}
        if scene != path.scene:
            progress(f"solving with {model} for the measured curve")
            path = partial_path(import_module(model).solve, scene, **options)
        compared[model] = path
    return compared


def _concluded(arguments: argparse.Namespace, found: dict, lines: list[str], *paths: EquilibriumPath) -> int:
    """Print a result as asked for: for a reader, as JSON, or not at all; the exit code of solved scenes.

    What makes the scene doubtful is said on stderr unless JSON holds it; so is what was not completed.
    """
    if arguments.json:
        say(json_text(found))
    elif not arguments.quiet:
        for warning in found["warnings"]:
            warn(f"warning: {warning}")
        say(*lines)
    early = ended_early(*paths)
    return _fail(NOT_COMPLETED, early) if early else COMPLETED
