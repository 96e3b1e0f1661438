"""Where a study's numbers come from: the command, the day, the machine, versions and sources."""

from __future__ import annotations

import json
from pathlib import Path

from validation.study.document import Table
from validation.study.keys import sources
from validation.study.machine import machine
from validation.study.output import write_bytes

FILE = "provenance.json"
MODELS = ("coilspring", "equivbeam", "wirefe")
DIGITS = 12  # of a digest, as shown


def provenance(command: str, **more: object) -> bytes:
    """What makes results now, as JSON; `command` makes them again; `more` is kept with it."""
    made = {
        "command": command,
        **machine(),
        "models": models(),
        "study": sources("validation")[:DIGITS],
        **more,
    }
    return (json.dumps(made, indent=2) + "\n").encode()


def write_provenance(command: str, out: Path, **more: object) -> None:
    """Write ``provenance.json`` beside a study's results."""
    write_bytes(out / FILE, provenance(command, **more))


def models() -> str:
    """Digest of the models' sources as they are."""
    return sources(*MODELS)[:DIGITS]


def provenance_table(studies: list[tuple[str, Path]]) -> Table:
    """A row for each study by title and folder."""
    header = (
        *("study", "command", "finished", "machine", "versions"),
        *("sources of the models", "sources of the study", "models as they are now"),
    )
    return Table(header, tuple((title, *_row(folder / FILE)) for title, folder in studies))


def _row(file: Path) -> tuple[str, ...]:
    if not file.is_file():
        return "not recorded", "", "", "", "", "", "not known"
    made = json.loads(file.read_text(encoding="utf-8"))
    same = "yes" if made["models"] == models() else "no: the command makes it anew"
    place = f"{made['processor']}, {made['cores']} cores, {made['system']}"
    digests = (f"`{made['models']}`", f"`{made['study']}`")
    return f"`{made['command']}`", made["date"], place, made["versions"], *digests, same
