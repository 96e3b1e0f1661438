"""The command ``coilcheck``."""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, nullcontext
from dataclasses import asdict
from pathlib import Path

from coilspring import CATALOGUE, EquilibriumNotFound, EquilibriumPath, InputError, Scene, load_scene
from coilspring.errors import require_integer
from coilspring.scenefile import SECTIONS
from coilspring.scenetext import scene_text
from validation.arguments import (
    CAMPAIGN_RANGES,
    COMMON_OPTIONS,
    FILE_OPTIONS,
    MODEL_OPTIONS,
    command_line,
)
from validation.metrics import Comparison, compare_paths
from validation.output import (
    OutputError,
    claimed,
    json_bytes,
    json_text,
    path_files,
    prepare,
    series_files,
    summary,
    vtu_file,
    write_files,
    writing,
)
from validation.reached import as_far

COMPLETED, REGRESSED, BAD_INPUT, NOT_COMPLETED, NOT_WRITTEN, INTERRUPTED = 0, 1, 2, 3, 4, 130


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code."""
    try:
        arguments = command_line().parse_args(argv)
        return COMMANDS[arguments.command](arguments)
    except InputError as error:
        return _fail(BAD_INPUT, str(error))
    except EquilibriumNotFound as error:
        return _fail(NOT_COMPLETED, error.message)
    except OutputError as error:
        return _fail(NOT_WRITTEN, str(error))
    except KeyboardInterrupt:
        return _fail(INTERRUPTED, "interrupted")


def _fail(code: int, message: str) -> int:
    print("coilcheck:", " ".join(message.splitlines()), file=sys.stderr)
    return code


def new(arguments: argparse.Namespace) -> int:
    """Print a scene file."""
    _say(scene_text(CATALOGUE[arguments.name]()).rstrip("\n"))
    return COMPLETED


def check(arguments: argparse.Namespace) -> int:
    """Say what a scene describes."""
    scene = load_scene(arguments.scene)
    lines, warnings = importlib.import_module("validation.check").report(scene)
    lines += [f"warning: {warning}" for warning in warnings]
    if hasattr(arguments, "draw") or hasattr(arguments, "out"):
        folder = _folder(arguments)
        prepare(folder)
        importlib.import_module("validation.drawing").draw(scene, folder / "spring.png")
        lines.append(f"drawn in {folder / 'spring.png'}")
    _say(*lines)
    return COMPLETED


def reproduce(arguments: argparse.Namespace) -> int:
    """Make the paper's tables and figures."""
    folder = _folder(arguments)
    with claimed(folder), _progress() as progress:
        run = importlib.import_module("validation.reproduce").reproduce
        with writing(folder):
            remarks = run(
                folder,
                getattr(arguments, "only", None),
                not hasattr(arguments, "no_render"),
                progress,
                hasattr(arguments, "time"),
            )
    _say(*remarks, f"written to {folder}")
    return COMPLETED


def solve(arguments: argparse.Namespace) -> int:
    """Solve one scene with one model."""
    model = arguments.model
    for other, names in MODEL_OPTIONS.items():
        for name in _given(arguments, names + FILE_OPTIONS[other]) if other != model else ():
            flag = "--" + name.replace("_", "-")
            raise InputError(f"{flag} belongs to --model {other}, got --model {model}")
    scene = _scene(arguments)
    folder = _folder(arguments)
    with claimed(folder):
        with _progress(hasattr(arguments, "quiet")) as progress:
            path = _run(scene, model, arguments, progress)
        files = path_files(path)
        if hasattr(arguments, "vtu") and len(path.times):
            files |= vtu_file(path)
        if hasattr(arguments, "vtu_series") and len(path.times):
            prepare(folder / "wire")
            files |= series_files(path)
        write_files(files, folder)
    _conclude(arguments, summary(path), [*_digest(path), f"written to {folder}"])
    return _verdict(path)


def compare(arguments: argparse.Namespace) -> int:
    """Solve one scene with both models and compare them."""
    scene = _scene(arguments)
    folder = _folder(arguments)
    with ExitStack() as claims:
        for each in (folder, *(folder / model for model in MODEL_OPTIONS)):
            claims.enter_context(claimed(each))
        with _progress(hasattr(arguments, "quiet")) as progress:
            paths = {model: _run(scene, model, arguments, progress) for model in MODEL_OPTIONS}
        comparison = compare_paths(paths["equivbeam"], paths["wirefe"])
        found = {
            "scene": scene.name,
            **asdict(comparison),
            **{model: str((folder / model).resolve()) for model in paths},
            "outcomes": {model: path.outcome for model, path in paths.items()},
        }
        files = {"compare.json": json_bytes(found)}
        for model, path in paths.items():
            files |= {f"{model}/{name}": data for name, data in path_files(path).items()}
        write_files(files, folder)
    lines = [line for path in paths.values() for line in _digest(path)]
    _conclude(arguments, found, [*lines, _apart(comparison), f"written to {folder}"])
    return _verdict(*paths.values())


def workprecision(arguments: argparse.Namespace) -> int:
    """Measure run time against error of both models."""
    folder = _folder(arguments)
    extent = next((name for name in ("quick", "full") if hasattr(arguments, name)), "normal")
    with claimed(folder), _progress() as progress:
        progress("loading both models")
        run = importlib.import_module("validation.workprecision").workprecision
        with writing(folder):
            studies = run(folder, getattr(arguments, "only", None), extent, progress)
    report = importlib.import_module("validation.workreport")
    _say(*(report.digest(study) for study in studies), f"written to {folder}")
    return COMPLETED


def sensitivity(arguments: argparse.Namespace) -> int:
    """Vary what the paper leaves open in both models."""
    folder = _folder(arguments)
    with claimed(folder), _progress() as progress:
        progress("loading both models")
        run = importlib.import_module("validation.sensitivity").sensitivity
        with writing(folder):
            studies = run(folder, getattr(arguments, "only", None), progress)
    page = importlib.import_module("validation.sensitivitypage")
    _say(*(page.digest(study) for study in studies), f"written to {folder}")
    return COMPLETED


def regress(arguments: argparse.Namespace) -> int:
    """Compare what both models find with stored baselines."""
    folder = _folder(arguments)
    with _progress() as progress:
        progress("loading both models")
        regression = importlib.import_module("validation.regression")
        accept, times = hasattr(arguments, "accept"), hasattr(arguments, "time")
        with writing(folder):
            finding = regression.regress(folder, arguments.baseline, accept, times, progress)
    _say(*map(str, finding.moves), regression.verdict(finding), f"written to {folder}")
    if finding.moves and not accept:
        return _fail(REGRESSED, f"{regression.verdict(finding)}; where that is meant: regress --accept")
    return COMPLETED


def stability(arguments: argparse.Namespace) -> int:
    """Judge sampled scenes of both models."""
    options = _given(arguments, ("case", "scheduler"))
    for name, number in _given(arguments, tuple(CAMPAIGN_RANGES)).items():
        options[name] = require_integer(name, number, *CAMPAIGN_RANGES[name])
    folder = _folder(arguments)
    with nullcontext() if "case" in options else claimed(folder), _progress() as progress:
        progress("loading both models")
        campaign = importlib.import_module("validation.campaign.run").campaign
        with writing(folder):
            code = campaign(folder, **options, progress=lambda done, of: progress(f"{done} of {of} scenes"))
    if "case" not in options:
        _say(f"written to {folder}")
    return _fail(REGRESSED, "not every outcome is explained") if code else COMPLETED


def people(arguments: argparse.Namespace) -> int:
    """Hand a scene to another program, or to the eye."""
    with _progress() as progress:
        run = importlib.import_module("validation.commands_people").COMMANDS[arguments.command]
        lines = run(arguments, _folder(arguments), progress)
    _say(*lines)
    return COMPLETED


COMMANDS = {
    "new": new,
    "check": check,
    "reproduce": reproduce,
    "solve": solve,
    "compare": compare,
    "workprecision": workprecision,
    "sensitivity": sensitivity,
    "stability": stability,
    "regress": regress,
    "export": people,
    "referee": people,
    "view": people,
}


def _scene(arguments: argparse.Namespace) -> Scene:
    """The scene with the steps and the penalty asked for."""
    return load_scene(arguments.scene).overridden(**_given(arguments, COMMON_OPTIONS))


def _given(arguments: argparse.Namespace, names: Sequence[str]) -> dict:
    return {name: getattr(arguments, name) for name in names if hasattr(arguments, name)}


def _folder(arguments: argparse.Namespace) -> Path:
    """Where to write; of a scene, by its catalogue name or its file's name."""
    if hasattr(arguments, "out"):
        return arguments.out
    name = arguments.command
    if hasattr(arguments, "scene"):
        scene = arguments.scene
        name += f"-{scene if scene in CATALOGUE else Path(scene).stem}"
    return Path("coilcheck-out", name)


def _run(
    scene: Scene, model: str, arguments: argparse.Namespace, progress: Callable[[str], None]
) -> EquilibriumPath:
    """The path of one model, complete or as far as it was reached."""
    progress(f"loading {model}")
    run = importlib.import_module(model).solve
    progress(f"solving with {model}")
    try:
        return as_far(run, scene, **_given(arguments, MODEL_OPTIONS[model]))
    except InputError as error:
        raise _in_file(arguments.scene, error) from None


def _in_file(scene: str, error: InputError) -> InputError:
    """What a model refuses, with the scene file where it names a key of one."""
    if scene not in CATALOGUE and str(error).partition(".")[0] in SECTIONS:
        return InputError(f"{scene}: {error}")
    return error


def _verdict(*paths: EquilibriumPath) -> int:
    """Exit code of solved scenes; what was not completed is said on stderr."""
    missed = [f"{path.model}: {path.message}" for path in paths if path.outcome != "completed"]
    if missed:
        return _fail(NOT_COMPLETED, f"{'; '.join(missed)}; what was reached is written")
    return COMPLETED


def _digest(path: EquilibriumPath) -> list[str]:
    """A path for a reader at the terminal."""
    lines = [f"{path.model}: {path.outcome}, {len(path.times)} of {path.scene.load.rows} steps"]
    if len(path.times):
        ux, uy, rotz = path.tips[-1]
        lines.append(f"  tip at time {path.times[-1]:g}: ux {ux:.6g} mm, uy {uy:.6g} mm, rotz {rotz:.6g} rad")
    lines.append(
        f"  {path.total_iterations} iterations, {path.solve_seconds:.2g} s CPU "
        f"(and {path.compile_seconds:.2g} s to make the kernels ready)"
    )
    return lines


def _apart(found: Comparison) -> str:
    if found.steps == 0:
        return "no step was reached by both models: nothing to compare"
    return (
        f"difference over {found.steps} common steps: "
        f"curve {100 * found.curve_max:.3g} % at most, {100 * found.curve_rms:.3g} % rms; "
        f"shape at time {found.last_time:g} {found.shape_max:.3g} mm at most, {found.shape_rms:.3g} mm rms"
    )


def _conclude(arguments: argparse.Namespace, found: dict, lines: list[str]) -> None:
    """Print a result as asked for: for a reader, as JSON, or not at all."""
    if hasattr(arguments, "json"):
        _say(json_text(found))
    elif not hasattr(arguments, "quiet"):
        _say(*lines)


def _say(*lines: str) -> None:
    """Print to stdout, whatever characters its encoding lacks."""
    encoding = sys.stdout.encoding or "utf-8"
    text = "\n".join(lines).encode(encoding, "backslashreplace").decode(encoding)
    with writing("standard output"):
        print(text, flush=True)


@contextmanager
def _progress(quiet: bool = False) -> Iterator[Callable[[str], None]]:
    """Show what is being done, on a terminal only."""
    if quiet or not sys.stderr.isatty():
        yield lambda text: None
        return
    from rich.console import Console
    from rich.text import Text

    with Console(stderr=True).status("") as status:
        yield lambda text: status.update(Text(text))


if __name__ == "__main__":
    sys.exit(main())
