"""Arguments of the command ``coilcheck``."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NoReturn

from coilspring import CATALOGUE, InputError, Scene, load_scene
from validation.reproduce import ARTEFACTS
from validation.study.machine import versions
from validation.study.texts import number_of

MODEL_OPTIONS = {
    "equivbeam": ("law", "tangent", "sliding"),
    "wirefe": ("element", "elements_per_turn", "pairs_per_turn"),
}
FILE_OPTIONS = {
    "equivbeam": (),
    "wirefe": ("vtu", "vtu_series", "stress", "frequencies"),
}  # what a model can write besides the path
CHOSEN = ("law", "element", "elements_per_turn")  # by an accuracy, besides the model
LAWS = ("haringx", "helix")  # of a half coil; or a file
FITTED = (  # by calibrate
    *("axial", "shearing", "bending", "wire_diameter", "mean_diameter", "bottom_diameter", "top_diameter"),
    *("pitch", "E", "G", "penalty", "exponent"),
)
COMMON_OPTIONS = ("steps", "penalty", "geometry")
CAMPAIGN_RANGES = {  # of the options of stability
    "beams": (0, 10_000_000),
    "wires": (0, 10_000_000),
    "seed": (0, 2**32 - 1),
    "workers": (0, 1000),
}
STUDY_SCENES = (*CATALOGUE, "cylinder-lateral", "slender-axial")  # of workprecision
PEERS = ("opensees", "calculix")  # of referee
SCENE_HELP = f"{', '.join(CATALOGUE)}, or a TOML file"
EPILOG = """exit codes: 0 done; 1 something moved or is unexplained (regress, stability); 2 bad input;
3 a path ended early, what was reached is written; 4 nothing could be written there; 130 interrupted

example: coilcheck solve spring-a --model equivbeam"""


class _Parser(argparse.ArgumentParser):
    """Refuses with one sentence instead of a usage page."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message}; see {self.prog} --help")


class _Version(argparse.Action):
    """Prints the version; it is read here, not at every start."""

    def __call__(self, parser: argparse.ArgumentParser, *unused: object) -> NoReturn:
        print("coilcheck", versions()["coilcheck"] or "(a checkout)")
        parser.exit()


def command_line() -> argparse.ArgumentParser:
    """Parser of the whole command line; an option that was not given is None, or False."""
    parser = _Parser(
        prog="coilcheck",
        description="Cross-validation of two models of helical compression springs whose coils touch.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and exit")
    commands = parser.add_subparsers(metavar="COMMAND", dest="command", required=True)
    for add in (
        _add_scene_files, _add_reproduce, _add_solutions, _add_calibrate, _add_studies, _add_programs
    ):  # fmt: skip
        add(commands)
    return parser


def given(arguments: argparse.Namespace, names: Sequence[str]) -> dict:
    """The options among `names` that were given, by name."""
    found = {name: getattr(arguments, name) for name in names}
    return {name: value for name, value in found.items() if value is not None and value is not False}


def scene_of(arguments: argparse.Namespace) -> Scene:
    """The scene with the steps and the penalty asked for."""
    return load_scene(arguments.scene).overridden(**given(arguments, COMMON_OPTIONS))


def refuse_chosen(arguments: argparse.Namespace, names: Sequence[str] = CHOSEN) -> None:
    """Refuse options that an accuracy chooses."""
    for name in given(arguments, names) if arguments.accuracy is not None else ():
        flag = "--" + name.replace("_", "-")
        raise InputError(f"{flag} is chosen by --accuracy: give one of them")


def refuse_other_models(arguments: argparse.Namespace) -> None:
    """Refuse options that belong to another model than the one asked for, or that an accuracy chooses."""
    refuse_chosen(arguments)
    for other, names in MODEL_OPTIONS.items():
        known = [name for name in names + FILE_OPTIONS[other] if hasattr(arguments, name)]
        for name in given(arguments, known) if other != arguments.model else ():
            flag = "--" + name.replace("_", "-")
            got = "--accuracy" if arguments.accuracy is not None else f"--model {arguments.model}"
            raise InputError(f"{flag} belongs to --model {other}, got {got}")


def scenes_of(arguments: argparse.Namespace) -> dict[str, Scene]:
    """Scenes of a study by name, their catalogue's or their file's; that of the geometry asked for is added.

    Raises
    ------
    InputError : a file that cannot be read, or two of one name.
    """
    geometry = arguments.geometry
    found: dict[str, Scene] = {}
    for file in arguments.scenes:
        name = file if file in CATALOGUE else Path(file).stem
        name += f"-{geometry}" if geometry else ""
        if name in found:
            raise InputError(f"SCENE must be files of different names, got {name} twice")
        found[name] = replace(load_scene(file).overridden(geometry=geometry), name=name)
    return found


def _add_scene_files(commands: argparse._SubParsersAction) -> None:
    purpose = "a commented scene file of a catalogue scene, to be changed, on standard output"
    new = _command(commands, "new", purpose, "coilcheck new spring-b", writes=False)
    new.add_argument("name", choices=tuple(CATALOGUE), metavar="NAME", help=", ".join(CATALOGUE))

    purpose = "what a scene describes: its numbers, warnings as of EN 13906-1, and which models represent it"
    check = _command(commands, "check", purpose, "coilcheck check spring-b --draw")
    check.add_argument("scene", metavar="SCENE", help=SCENE_HELP)
    _add_flag(check, "--draw", "write spring.png; implied by --out")


def _add_reproduce(commands: argparse._SubParsersAction) -> None:
    purpose = "the paper's tables and figures by both models, and a report"
    command = _command(commands, "reproduce", purpose, "coilcheck reproduce --only table3,fig5")
    command.description = (
        f"{command.description}"
        " Solved runs and finished artifacts are kept for the next time: in $COILCHECK_STORE, by default the "
        "folder coilcheck among the user's caches, 256 MiB at most."
    )
    _add_only(command, ARTEFACTS)
    drawn = command.add_mutually_exclusive_group()
    _add_flag(drawn, "--no-render", "tables and data only, no pictures")
    what = "springs.html too: both models' springs, to be turned in a browser (extra: interactive)"
    _add_flag(drawn, "--interactive", what)
    _add_flag(command, "--time", "measure the solution times of Table 3 even where they are stored")


def _add_solutions(commands: argparse._SubParsersAction) -> None:
    purpose = "the load path of one scene by one model"
    solve = _command(commands, "solve", purpose, "coilcheck solve spring-b --model wirefe --steps 20")
    which = solve.add_mutually_exclusive_group(required=True)
    which.add_argument("--model", choices=tuple(MODEL_OPTIONS), help="which model")
    _add_accuracy(which, "the wire model and its mesh are chosen")
    _add_scene(solve)
    what = "write wire.vtu too (wirefe): the deformed wire at the last step reached, with section forces"
    _add_flag(solve, "--vtu", what)
    what = "write wire.pvd too (wirefe), a VTU file for every step, to be seen by coilcheck view or ParaView"
    _add_flag(solve, "--vtu-series", what)

    what = "write stress.csv too (wirefe): stresses along the wire at the last step reached"
    _add_flag(solve, "--stress", what)

    what = "natural frequencies (wirefe) about the last step reached, both ends held, in summary.json too"
    solve.add_argument("--frequencies", type=number_of, metavar="N", help=what)

    purpose = "one scene by both models: the equivalent beam against the wire model"
    compare = _command(commands, "compare", purpose, "coilcheck compare my-spring.toml --out results")
    _add_scene(compare)
    _add_accuracy(compare, "the wire model's mesh is chosen, and the beam compared with that")
    what = "write compare.png: both load curves and shapes; and curve.png: force and rate over deflection"
    _add_flag(compare, "--draw", what)
    what = "measured curve (columns force, deflection) beside the models, in curve.png"
    compare.add_argument("--measured", metavar="FILE.csv", help=what)

    _add_sweep(commands)
    for command, file in ((solve, "summary.json"), (compare, "compare.json")):
        said = command.add_mutually_exclusive_group()
        _add_flag(said, "--json", f"print what {file} holds, and nothing else")
        _add_flag(said, "--quiet", "print nothing but errors")


def _add_sweep(commands: argparse._SubParsersAction) -> None:
    purpose = "many scenes by one model: a scene file's keys with several values each, in all combinations"
    sweep = _command(
        commands, "sweep", purpose, "coilcheck sweep spring-b --vary spring.wire_diameter=1.5:1.7:5"
    )
    sweep.description = (
        f"{sweep.description} sweep.csv has a row for each scene, in order, the first key slowest; the same "
        "command goes on where it was interrupted."
    )
    values = sweep.add_argument_group("what is varied")
    what = "a key of scene files, as spring.wire_diameter or load.force.1, and COUNT equal steps or a list"
    form = "KEY=FIRST:LAST:COUNT|KEY=A,B,C"
    values.add_argument("--vary", action="append", required=True, metavar=form, help=what)
    what = "which model; default equivbeam"
    which = sweep.add_mutually_exclusive_group()
    which.add_argument("--model", choices=tuple(MODEL_OPTIONS), default="equivbeam", help=what)
    _add_accuracy(which, "the cheapest law or mesh that does on a sample of the scenes is chosen")
    how = "processes; default one for each core, 0 for none besides this one"
    sweep.add_argument("--workers", type=number_of, metavar="N", help=how)
    _add_scene(sweep)


def _add_calibrate(commands: argparse._SubParsersAction) -> None:
    purpose = "the equivalent beam fitted to a measured load curve"
    example = "coilcheck calibrate my.toml measured.csv --fit axial,wire_diameter"
    command = _command(commands, "calibrate", purpose, example)
    command.add_argument("scene", metavar="SCENE", help=SCENE_HELP)
    what = "CSV file with columns force, deflection (N, mm; along the load), or those of path.csv"
    command.add_argument("measured", metavar="MEASURED.csv", help=what)
    what = f"what to fit, of those that stand for each other the first: {', '.join(FITTED)}"
    command.add_argument("--fit", metavar="NAMES", required=True, help=what)
    _add_law(command)


def _add_studies(commands: argparse._SubParsersAction) -> None:
    purpose = "run time against error of both models, for every mesh, law and number of steps"
    example = "coilcheck workprecision my.toml spring-a --quick"
    command = _command(commands, "workprecision", purpose, example)
    _add_scenes(command, f"{SCENE_HELP}; default those of --only")
    _add_only(command, STUDY_SCENES)
    size = command.add_mutually_exclusive_group()
    _add_flag(size, "--quick", "few meshes, few rounds: about a minute")
    _add_flag(size, "--full", "meshes up to 320 elements per turn")
    _add_flag(size, "--page", "page and figures of the numbers recorded in the folder, measure nothing")

    purpose = "effect of what the paper leaves open, or of the inputs of scenes, on both models' curves"
    command = _command(commands, "sensitivity", purpose, "coilcheck sensitivity my.toml")
    _add_scenes(command, f"{SCENE_HELP}; default those of --only")
    _add_only(command, tuple(CATALOGUE))

    purpose = "sampled scenes by both models, each path verified; exit code 1 where an outcome is unexplained"
    command = _command(commands, "stability", purpose, "coilcheck stability --beams 2000 --wires 100")
    scenes = command.add_argument_group("what is verified; a campaign that was interrupted goes on")
    scenes.add_argument("--beams", type=number_of, metavar="N", help="equivalent-beam scenes; default 20000")
    scenes.add_argument("--wires", type=number_of, metavar="N", help="wire scenes; default 1000")
    scenes.add_argument("--seed", type=number_of, metavar="N", help="of the sequence of scenes; default 1")
    scenes.add_argument("--seeds", metavar="N,N", help="several of them, on one page: 1,2,3")
    scenes.add_argument("--case", metavar="ID", help="verify one case again, and write nothing")
    how = "processes; default one for each core, 0 for none besides this one"
    command.add_argument("--workers", type=number_of, metavar="N", help=how)
    where = "address of a Dask scheduler, whose workers verify the scenes (extra: dask)"
    command.add_argument("--scheduler", metavar="ADDRESS", help=where)

    purpose = "what both models find now against stored baselines; exit code 1 where something moved"
    command = _command(commands, "regress", purpose, "coilcheck regress my.toml --baselines my-baselines")
    _add_scenes(command, f"{SCENE_HELP}; default the scenes of the baselines that come with coilcheck")
    where = "folder of the baselines, which of scenes is yours; default the one that comes with coilcheck"
    command.add_argument("--baselines", "--baseline", type=Path, metavar="DIR", help=where)
    _add_flag(command, "--accept", "write what is found as the new baselines")
    _add_flag(command, "--time", "measure and compare the models' ratios of time too")

    purpose = "errors, time, stability and limits of a law of a half coil that you wrote, on one page"
    command = _command(commands, "study-law", purpose, "coilcheck study-law my_law.py --quick")
    what = "Python files with parameters(coil), energy(l, v, dtheta, p); a page each"
    command.add_argument("law", nargs="+", metavar="FILE.py", help=what)
    _add_flag(command, "--quick", "few springs and scenes: about a minute")


def _add_programs(commands: argparse._SubParsersAction) -> None:
    purpose = "the wire model of a scene as an input deck for another program"
    command = _command(commands, "export", purpose, "coilcheck export spring-a --to calculix --out deck")
    command.add_argument("--to", choices=("calculix",), required=True, help="which program")
    _add_common(command)

    purpose = "one scene by the wire model and by another finite-element code, which has to be installed"
    command = _command(commands, "referee", purpose, "coilcheck referee spring-a --with opensees")
    command.add_argument("--with", dest="peer", choices=PEERS, required=True, help="which code")
    what = "rods beside hexahedra of calculix: 6 x 6 flexibility of 3 coils, full load without contact"
    command.add_argument("--solid", action="store_true", help=what)
    _add_common(command)

    purpose = "the wire as it deforms, in a window with a slider over the steps or as a movie"
    command = _command(commands, "view", purpose, "coilcheck view spring-a --movie a.gif", writes=False)
    where = f"{SCENE_HELP}, or the folder of a run with wire.pvd (solve --vtu-series)"
    command.add_argument("scene", metavar="SCENE|RUN", help=where)
    command.add_argument("--movie", type=Path, metavar="FILE", help="write a GIF, without a window")


def _command(
    commands: argparse._SubParsersAction, name: str, purpose: str, example: str, writes: bool = True
) -> argparse.ArgumentParser:
    command = commands.add_parser(
        name,
        help=purpose,
        description=f"{purpose[0].upper()}{purpose[1:]}.",
        epilog=f"example: {example}",
        allow_abbrev=False,
    )
    if writes:
        where = "where to write; default coilcheck-out/COMMAND[-SCENE]"
        command.add_argument("--out", type=Path, metavar="DIR", help=where)
    return command


def _add_common(command: argparse.ArgumentParser) -> None:
    """The scene, and what may take the place of its numbers."""
    command.add_argument("scene", metavar="SCENE", help=SCENE_HELP)
    both = command.add_argument_group("options of both models")
    both.add_argument("--steps", type=number_of, metavar="N", help="equal steps of time; default the scene's")
    both.add_argument("--penalty", type=number_of, metavar="X", help="contact stiffness; default the scene's")
    _add_geometry(both)


def _add_geometry(command: argparse._ActionsContainer) -> None:
    what = "contact of the wire model; default the scene's (the catalogue's: spheres)"
    command.add_argument("--geometry", choices=("wires", "spheres"), help=what)


def _add_scenes(command: argparse.ArgumentParser, what: str) -> None:
    """Scenes of a study, and the geometry of their contact."""
    command.add_argument("scenes", nargs="*", metavar="SCENE", help=what)
    _add_geometry(command.add_argument_group("options of both models"))


def _add_scene(command: argparse.ArgumentParser) -> None:
    """The scene and the options of both models, whose defaults are the models' own."""
    _add_common(command)
    beam = command.add_argument_group("options of equivbeam")
    _add_law(beam)
    beam.add_argument("--tangent", choices=("exact", "paper", "paper-printed"), help="default exact")
    beam.add_argument("--sliding", choices=("ignore", "scene"), help="the scene's sliding; default ignore")
    wire = command.add_argument_group("options of wirefe")
    wire.add_argument("--element", choices=("straight", "curved"), help="beam element; default straight")
    wire.add_argument("--elements-per-turn", type=number_of, metavar="N", help="default 40")
    wire.add_argument("--pairs-per-turn", type=number_of, metavar="N", help="sphere pairs; default 4")


def _add_law(command: argparse._ActionsContainer) -> None:
    what = "law of a half coil: haringx (default), helix or a Python file with one"
    command.add_argument("--law", type=_law, metavar="|".join((*LAWS, "FILE.py")), help=what)


def _add_accuracy(command: argparse._ActionsContainer, chosen: str) -> None:
    what = f"relative error of the load curve, 1e-5 to 1e-2: {chosen}"
    command.add_argument("--accuracy", type=number_of, metavar="X", help=what)


def _add_flag(command: argparse._ActionsContainer, name: str, what: str) -> None:
    command.add_argument(name, action="store_true", help=what)


def _add_only(command: argparse.ArgumentParser, names: tuple[str, ...]) -> None:
    """What of all to make, in the order of the names."""

    def read(text: str) -> tuple[str, ...]:
        asked = text.split(",")
        for name in asked:
            if name not in names:
                raise argparse.ArgumentTypeError(f"must be names of {','.join(names)}, got {name!r}")
        return tuple(name for name in names if name in asked)

    command.add_argument("--only", type=read, metavar="NAMES", help=f"some of {','.join(names)}")


def _law(text: str) -> str:
    """The name of a law, or of a file that may hold one."""
    if text not in LAWS and not text.endswith(".py"):
        raise argparse.ArgumentTypeError(f"must be {', '.join(LAWS)} or a Python file, got {text!r}")
    return text
