"""What the command says: on standard output, and on a terminal while it works."""

import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from typing import Any, TextIO

import numpy as np

from coilspring import EquilibriumPath, Scene
from coilspring.curves import Comparison, Curve
from coilspring.words import counted, plain
from validation.study.files import writing
from validation.study.output import largest_stress

LIMIT_POINTS = {  # by whether UY is prescribed
    False: "a limit point is where the load is largest: to go on, prescribe load.displacement",
    True: "a limit point is where the prescribed displacement is largest: beyond it the spring snaps",
}
MANY = 64  # stations per turn: where wires slide off early, it is seen with these
PIPE_CLOSED = 141  # exit code, as of what the signal SIGPIPE ends
LONG = 0.01  # seconds, from which on compiling is mentioned
FIRST = "(making the kernels ready, once: about half a minute)"
SLIPPING = {  # without friction, by what stands for coils that touch
    "equivbeam": "circles may slide off one another where coils do not: wirefe with contact of wires tells",
    "spheres": "spheres may slide off one another where wires do not: see --geometry wires",
    "wires": "wires may slide off early where stations are few: see --pairs-per-turn 64, --accuracy 1e-3",
}


def say(*lines: str) -> None:
    """Print to stdout, whatever characters its encoding lacks; nothing without lines, or where it is closed.

    Where nobody reads any more (`| head`) the command ends at once, without a word, as others do.
    """
    if not lines or sys.stdout is None:
        return
    encoding = sys.stdout.encoding or "utf-8"
    text = "\n".join(lines).encode(encoding, "backslashreplace").decode(encoding)
    with writing("standard output"):
        try:
            print(text, flush=True)
        except BrokenPipeError:
            _discard(sys.stdout)
            raise SystemExit(PIPE_CLOSED) from None


def warn(line: str) -> None:
    """Print to stderr, after the name of the command; where it cannot be, there is the exit code alone."""
    if sys.stderr is None:
        return
    try:
        print("coilcheck:", " ".join(line.splitlines()), file=sys.stderr, flush=True)
    except OSError:
        _discard(sys.stderr)


def _discard(stream: TextIO) -> None:
    """Send nowhere what is left of a stream, and would be flushed at the end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


@contextmanager
def progress_shown(quiet: bool = False) -> Iterator[Callable[[str], None]]:
    """Show what is being done, on a terminal only."""
    if quiet or sys.stderr is None or not sys.stderr.isatty():
        yield lambda text: None
        return
    from rich.console import Console
    from rich.text import Text

    with Console(stderr=True).status("") as status:
        yield lambda text: status.update(Text(text))


def announcing(progress: Callable[[str], None], model: str, scene: Scene) -> Callable[[str], None]:
    """Progress that also says, as long as it is so, that a scene's kernels have to be compiled."""
    from coilspring.solver.startup import stored

    kernels = import_module(f"{model}.solve").scene_kernels(scene)
    return lambda text: progress(text if stored(kernels) else f"{text} {FIRST}")


def outcome_line(path: EquilibriumPath) -> str:
    """How a path ended, and after how many steps."""
    return f"{path.model}: {path.outcome}, {len(path.times)} of {counted(path.scene.load.rows, 'step')}"


def ended_early(*paths: EquilibriumPath, what_is_done: str = "written") -> str:
    """Why paths ended early, in one sentence; empty where all are complete."""
    missed = [f"{path.model}: {path.message}" for path in paths if path.outcome != "completed"]
    return f"{'; '.join(missed)}; what was reached is {what_is_done}" if missed else ""


def digest(path: EquilibriumPath) -> list[str]:
    """A path for a reader at the terminal."""
    lines = [outcome_line(path)]
    if len(path.times):
        ux, uy, rotz = path.tips[-1]
        force = f", axial force {path.loads[-1, 1]:.6g} N" if path.scene.load.displacement else ""
        tip = f"ux {ux:.6g} mm, uy {uy:.6g} mm, rotz {rotz:.6g} rad"
        lines.append(f"  tip at time {path.times[-1]:g}: {tip}{force}")
        far = int(np.abs(path.tips[:, 1]).argmax())
        if path.scene.load.rows > path.scene.load.steps and far < len(path.times) - 1:  # several stages
            lines.append(f"  largest uy {path.tips[far, 1]:.6g} mm, at time {path.times[far]:g}")
        if stress := largest_stress(path):
            at = f"at time {stress['time']:g} and turn {stress['turns']:.3g}"
            kind = "torsion, with Bergstraesser's factor"
            lines.append(f"  stress {stress['value']:.4g} MPa at most, {at} ({kind})")
    lines += [f"  {note}" for note in notes(path)]
    if path.accuracy is not None:
        options, contact = path.options, path.scene.contact
        mesh = f"{options['elements_per_turn']} {options['element']} elements per turn"
        if contact.enabled:
            kind = "spheres" if contact.geometry == "spheres" else "stations"
            mesh += f", {options['pairs_per_turn']} {kind} per turn"
        chosen = f"chosen for an accuracy of {path.accuracy:g}: {mesh}"
        lines.append(f"  {chosen}; estimated error {path.estimated_error:.2g}")
        lines.append(f"  {plain(path.other_seconds)} s CPU more for the choice and the estimate")
    count = counted(path.total_iterations, "iteration")
    ready = f" (and {plain(path.compile_seconds)} s to make the kernels ready)"
    compiled = ready if path.compile_seconds >= LONG else ""
    return [*lines, f"  {count}, {plain(path.solve_seconds)} s CPU{compiled}"]


def notes(path: EquilibriumPath) -> list[str]:
    """What a reader must know to compare a path with another model's."""
    contact, said = path.scene.contact, left_out(path.scene, path.model, path.options)
    if path.model == "equivbeam" and path.options["law"] == "haringx":
        from validation.study.lawwarning import law_warning  # imports the model, which is there by now

        said += [f"{warning}: see --law helix" for warning in [law_warning(path.scene)] if warning]
    if path.outcome == "limit_point" and not _passed_bottom(path):
        said.append(LIMIT_POINTS[bool(path.scene.load.displacement)])
    critical = path.outcome in ("limit_point", "bifurcation")
    if critical and contact.sliding == "free" and _ends_touching(path) and path.accuracy is None:
        kind = contact.geometry if path.model == "wirefe" else path.model
        stations = path.options.get("pairs_per_turn")
        if kind != "wires" or (isinstance(stations, int) and stations < MANY):
            said.append(SLIPPING[kind])
    if path.outcome == "interpenetration" and path.model == "wirefe" and contact.geometry == "spheres":
        said.append("between spheres coils may pass each other: see --geometry wires")
    if path.outcome == "completed" and "; " in path.message:
        said.append(path.message.partition("; ")[2].removeprefix("but "))
    return said


def left_out(scene: Scene, model: str, options: Mapping[str, Any]) -> list[str]:
    """What of a scene a model does not have, with these options of its `solve`."""
    said, sliding = [], scene.contact.sliding if scene.contact.enabled else "free"
    if model == "equivbeam" and sliding != "free" and options.get("sliding") != "scene":
        said.append(
            f"without the scene's sliding = \"{sliding}\", as the paper's model: --sliding scene has it"
        )
    if model == "wirefe" and scene.factors.given:
        said.append("without the scene's [factors], which are of the equivalent beam's stiffnesses alone")
    return said


def _ends_touching(path: EquilibriumPath) -> bool:
    """Whether coils touch where the path ends, be it before the first step."""
    return path.last_state is not None and bool((path.shape.pair_gaps(path.last_state[None]) < 0.0).any())


def _passed_bottom(path: EquilibriumPath) -> bool:
    """Whether the top is below the bottom, as no spring's: there is no way to go on from there."""
    return bool(len(path.tips)) and path.tips[-1, 1] < -path.scene.spring.active_height


def deviation(found: Comparison, wire: EquilibriumPath) -> list[str]:
    """Deviation from the wire model's path for a reader at the terminal, and that path's own error."""
    if found.steps == 0:
        return ["no step was reached by both models: nothing to compare"]
    prescribed = bool(wire.scene.load.displacement)
    error = wire.estimated_error
    own = "not estimated, as --accuracy X does" if error is None else f"{100.0 * error:.2g} % (estimated)"
    names = {name: "force" if prescribed and name == "uy" else name for name in found.component_max}
    worst = max(names, key=found.component_max.__getitem__)
    # of a component that hardly moves the share is large though nothing is wrong
    units = {"ux": "mm", "uy": "N" if prescribed else "mm", "rotz": "rad"}
    peaks = {}
    for name, values in Curve.of(wire).by_name.items():
        row = int(np.abs(values).argmax())
        time = float(wire.times[row])
        beyond = f" at time {time:g}, beyond these steps" if time > found.last_time else ""
        peaks[name] = f"{np.abs(values[row]):.3g} {units[name]}{beyond}"
    return [
        f"difference over {counted(found.steps, 'common step')}: "
        f"curve {100 * found.curve_max:.3g} % at most ({names[worst]}), {100 * found.curve_rms:.3g} % rms; "
        f"shape at time {found.last_time:g} {found.shape_max:.3g} mm at most, {found.shape_rms:.3g} mm rms",
        *(
            f"  {label:<5} {100 * found.component_max[name]:.3g} % at most, "
            f"{100 * found.component_rms[name]:.3g} % rms of the wire model's peak, {peaks[name]}"
            for name, label in names.items()
        ),
        f"  the wire model's own error, by its mesh: {own}",
    ]
