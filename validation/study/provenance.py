"""Where a study's numbers come from: the command, the day, the machine, versions and sources."""

import json
from pathlib import Path

from validation.study.files import json_bytes, write_bytes
from validation.study.keys import sources
from validation.study.machine import machine
from validation.study.models import MODELS
from validation.study.tables import Table

FILE = "provenance.json"
PACKAGES = ("coilspring", *MODELS)  # of which the models are made
DIGITS = 12  # of a digest, as shown


def provenance(command: str, **more: object) -> bytes:
    """What makes results now, as JSON; `command` makes them again; `more` is kept with it."""
    study = sources("validation")[:DIGITS]
    return json_bytes({"command": command, **machine(), "models": models(), "study": study, **more})


def write_provenance(command: str, out: Path, **more: object) -> None:
    """Write ``provenance.json`` beside a study's results."""
    write_bytes(out / FILE, provenance(command, **more))


def models() -> str:
    """Digest of the models' sources as they are."""
    return sources(*PACKAGES)[:DIGITS]


def provenance_table(studies: list[tuple[str, Path]]) -> Table:
    """A row for each study by title and folder."""
    header = (
        *("study", "command", "finished", "machine", "versions"),
        *("sources of the models", "sources of the study", "models as they are now"),
    )
    rows: list[tuple[str, ...]] = []
    for title, folder in studies:
        if not (folder / FILE).is_file():
            rows.append((title, "not recorded", "", "", "", "", "", "not known"))
            continue
        made = json.loads((folder / FILE).read_text(encoding="utf-8"))
        same = "yes" if made["models"] == models() else "no: the command makes it anew"
        place = f"{made['processor']}, {made['cores']} cores, {made['system']}"
        command, *digests = (f"`{made[name]}`" for name in ("command", "models", "study"))
        rows.append((title, command, made["date"], place, made["versions"], *digests, same))
    return Table(header, tuple(rows))
