"""Arguments of the command ``coilcheck``."""

import argparse
import re
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

from coilspring import CATALOGUE, InputError, Scene, load_scene
from coilspring.workers import WORKERS
from validation.cli.terminal import say
from validation.reproduce import ARTEFACTS
from validation.study.machine import versions
from validation.study.models import LAWS
from validation.study.output import WIRE_FILES
from validation.sweep.grid import number_of

MODEL_OPTIONS = {
    "equivbeam": ("law", "tangent", "sliding"),
    "wirefe": ("element", "elements_per_turn", "pairs_per_turn"),
}
# besides: what stands for the wire in contact, and what is for more than the path
OTHER_OPTIONS = {"equivbeam": (), "wirefe": ("geometry", *WIRE_FILES, "frequencies")}
MESH = ("element", "elements_per_turn")  # chosen by an accuracy
CHOSEN = ("law", *MESH)  # and besides the model, where it has one to choose
FITTED = (  # by calibrate
    *("axial", "shearing", "bending", "wire_diameter", "mean_diameter", "bottom_diameter", "top_diameter"),
    *("pitch", "E", "G", "penalty", "exponent", "offset"),
)
COMMON_OPTIONS = ("steps", "penalty", "geometry")
KEYWORDS = {"load.steps": "steps", "contact.stiffness": "penalty", "contact.geometry": "geometry"}
KEYWORDS |= {"parameters": "fit", "count": "frequencies"}  # of the library, by which it names options
UNREAD = {  # keys of a scene, or sections, that a model does not read, and how they are read
    "equivbeam": {
        "contact.geometry": "--model wirefe",
        **dict.fromkeys(("contact.sliding", "contact.friction"), "--sliding scene or --model wirefe"),
    },
    "wirefe": {"factors": "--model equivbeam"},
}
UNSWEPT = {"material.density": "solve --frequencies"}  # the same of any model
CAMPAIGN_RANGES = dict.fromkeys(("beams", "wires"), (0, 10_000_000))  # of the options of stability
CAMPAIGN_RANGES |= {"seed": (0, 2**32 - 1), "workers": WORKERS}
STUDY_SCENES = (*CATALOGUE, "cylinder-lateral", "slender-axial")  # of workprecision
EPILOG = """exit codes: 0 done; 1 something moved or is unexplained (regress, stability); 2 bad input;
3 a path ended early, what was reached is written by solve, compare, sweep, referee and view;
4 nothing could be written there; 130 interrupted; 141 nobody reads the output any more (| head)

example: coilcheck solve spring-a --model equivbeam"""


class _Parser(argparse.ArgumentParser):
    """Refuses with one sentence instead of a usage page."""

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As argparse's; what nobody knows is refused with the help of the command that was given."""
        found, unknown = self.parse_known_args(args, namespace)
        if unknown:
            said = f"unrecognized arguments: {' '.join(unknown)}"
            raise InputError(f"{said}; see {self.prog} {found.command} --help")
        return found

    def _print_message(self, message: str, file: Any = None) -> None:
        say(message.rstrip("\n"))

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message}; see {self.prog} --help")


class _Version(argparse.Action):
    """Prints the version; it is read here, not at every start."""

    def __call__(self, parser: argparse.ArgumentParser, *unused: object) -> NoReturn:
        say(f"coilcheck {versions()['coilcheck'] or '(a checkout)'}")
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
    words = tomllib.loads(Path(__file__).with_name("arguments.toml").read_text(encoding="utf-8"))
    for name, command in words["command"].items():
        purpose = command["purpose"]
        about = [f"{purpose[0].upper()}{purpose[1:]}.", *([command["more"]] if "more" in command else [])]
        epilog = f"example: coilcheck {command['example']}"
        added = commands.add_parser(
            name, help=purpose, description=" ".join(about), epilog=epilog, allow_abbrev=False
        )
        _add(added, command["options"], words, command.get("change", {}))
    return parser


def _add(parser: argparse._ActionsContainer, options: list, words: dict, changes: dict) -> None:
    """Add options, groups and alternatives to a command or a group."""
    for name in options:
        if isinstance(name, list):
            required = name[0] == "required"
            _add(parser.add_mutually_exclusive_group(required=required), name[required:], words, changes)
        elif name in words["group"]:
            group = words["group"][name]
            _add(parser.add_argument_group(group["title"]), group["options"], words, changes)
        else:
            keywords = words["option"][name] | changes.get(name, {})
            if isinstance(choices := keywords.get("choices"), str):
                keywords["choices"] = NAMES[choices]
            if keywords.get("type") == "some":
                names = keywords.pop("choices")
                keywords |= {"type": partial(_some, names), "help": f"some of {','.join(names)}"}
            elif "type" in keywords:
                keywords["type"] = READERS[keywords["type"]]
            listed = {key: ", ".join(each) for key, each in NAMES.items()}
            keywords["help"] = keywords["help"].format(**listed)
            if not keywords.keys() & {"metavar", "choices"}:
                keywords["action"] = "store_true"
            parser.add_argument(name, *keywords.pop("also", ()), **keywords)


def _some(names: tuple[str, ...], text: str) -> tuple[str, ...]:
    """What of all names a text asks for, in the order of the names."""
    asked = text.split(",")
    for name in asked:
        if name not in names:
            raise argparse.ArgumentTypeError(f"must be names of {','.join(names)}, got {name!r}")
    return tuple(name for name in names if name in asked)


def _law(text: str) -> str:
    """The name of a law, or of a file that may hold one."""
    if text not in LAWS and not text.endswith(".py"):
        raise argparse.ArgumentTypeError(f"must be {', '.join(LAWS)} or a Python file, got {text!r}")
    return text


def _place(text: str) -> str:
    """Where something is; nothing, as a shell's variable that is not set, would be the folder one is in."""
    if not text:
        raise argparse.ArgumentTypeError("must be the name of a file or folder, got ''")
    return text


def _path(text: str) -> Path:
    return Path(_place(text))


READERS: dict[str, Callable[[str], Any]] = {"number": number_of, "path": _path, "place": _place, "law": _law}
NAMES = {"catalogue": tuple(CATALOGUE), "models": tuple(MODEL_OPTIONS), "fitted": FITTED}
NAMES |= {"artefacts": ARTEFACTS, "studied": STUDY_SCENES}


def given(arguments: argparse.Namespace, names: Sequence[str]) -> dict:
    """The options among `names` that were given, by name."""
    found = {name: getattr(arguments, name) for name in names}
    return {name: value for name, value in found.items() if value is not None and value is not False}


def scene_of(arguments: argparse.Namespace) -> Scene:
    """The scene with the steps, the penalty and the geometry asked for."""
    return load_scene(arguments.scene).overridden(**given(arguments, COMMON_OPTIONS))


def flag(name: str) -> str:
    """What a user types for an option."""
    return "--" + name.replace("_", "-")


def flagged(message: str, arguments: argparse.Namespace) -> str:
    """A message of the library with what the user has typed in place of its keywords."""
    key, space, why = message.partition(" ")
    name = KEYWORDS.get(key, key)
    said = flag(name) + space + why if name in arguments and given(arguments, [name]) else message
    return re.sub(r"(?<![\w-])\w+_per_turn\b", lambda found: flag(found[0]), said)


def refuse_chosen(arguments: argparse.Namespace, names: Sequence[str] = CHOSEN) -> None:
    """Refuse options that an accuracy chooses."""
    for name in given(arguments, names) if arguments.accuracy is not None else ():
        what = "law and mesh" if "law" in names else "the mesh"
        said = f"{flag(name)} cannot stand beside --accuracy, which chooses {what}"
        mesh = "give the wire model a mesh, as --element curved --elements-per-turn 8"
        raise InputError(f"{said}: leave out {flag(name)}; or leave out --accuracy and {mesh}")


def refuse_other_models(arguments: argparse.Namespace, chosen: Sequence[str] = CHOSEN) -> None:
    """Refuse options that belong to another model than the one asked for, or that an accuracy chooses."""
    refuse_chosen(arguments, chosen)
    for other, names in MODEL_OPTIONS.items():
        known = [name for name in names + OTHER_OPTIONS[other] if hasattr(arguments, name)]
        for name in given(arguments, known) if other != arguments.model else ():
            got = "--accuracy" if arguments.accuracy is not None else f"--model {arguments.model}"
            raise InputError(f"{flag(name)} belongs to --model {other}, got {got}")


def refuse_varied(arguments: argparse.Namespace, keys: Sequence[str]) -> None:
    """Refuse to vary keys of a scene that an option sets for all scenes, or that the model does not read.

    With an accuracy that is the wire model, against which it is taken, whatever is chosen for it.
    """
    unread = UNSWEPT | UNREAD[arguments.model]
    for key in keys:
        if key in KEYWORDS and given(arguments, [KEYWORDS[key]]):
            raise InputError(f"{flag(KEYWORDS[key])} cannot stand beside --vary {key}, which sets the same")
        read = unread.get(key) or unread.get(key.partition(".")[0])
        if read and f"--sliding {arguments.sliding}" not in read:
            of = "a sweep" if key in UNSWEPT else arguments.model
            raise InputError(f"--vary {key} has no effect on {of}: it goes with {read}")


def by_name(what: str, files: Sequence[str]) -> dict[str, str]:
    """Files by name, without folder and suffix; `InputError` for two of one name."""
    found: dict[str, str] = {}
    for file in files:
        name = Path(file).stem
        if name in found:
            raise InputError(f"{what} must be files of different names, got {name} twice")
        found[name] = file
    return found


def scenes_of(arguments: argparse.Namespace) -> dict[str, Scene]:
    """Scenes of a study by name (their catalogue's or their file's, and the geometry); empty for the paper's.

    Raises `InputError`: two of one name, scenes beside --only, or a geometry without scenes.
    """
    geometry, only = arguments.geometry, getattr(arguments, "only", None)
    found: dict[str, Scene] = {}
    for stem, file in by_name("SCENE", arguments.scenes).items():
        name = stem + (f"-{geometry}" if geometry else "")
        found[name] = replace(load_scene(file).overridden(geometry=geometry), name=name)
    if found and only:
        raise InputError(f"SCENE or --only, not both, got {', '.join(found)} and {','.join(only)}")
    if geometry and not found:
        raise InputError(f"--geometry must go with SCENE, got {geometry} alone")
    return found
