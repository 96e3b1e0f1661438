"""The campaign's table: rows of texts, appended to a file and found again after an interruption."""

import io
import os
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import pandas as pd

from coilspring import EquilibriumPath
from validation.campaign.scenes import Case
from validation.campaign.verdict import Verdict
from validation.study.files import write_text, writing
from validation.study.keys import digest, source_files

NUMBERS = (
    "residual", "whole", "least", "normal", "friction", "branch", "bracket", "critical_shift", "passed",
    "confirmed", "jump", "invariance", "overlap", "place", "reaction", "stepped",
)  # fmt: skip
TIP = ("ux", "uy", "rotz", "contacts")
FORCE, DISPLACEMENT = "force", "displacement"
COLUMNS = (
    "id", "seed", "version", "class", "outcome", "reason", "corner", "variant", "steps", "penalty",
    "exponent", "geometry", "pairs", "sliding", "index", "coils", "slenderness", "taper", "by", "load",
    "held", "time", *TIP, "kind", *NUMBERS, "message", "seconds",
)  # fmt: skip
Row = dict[str, str]
Key = tuple[int, str]  # seed and id


def row_of(case: Case, path: EquilibriumPath | None, verdict: Verdict, **known: Any) -> Row:
    """Row of a verified case; `known` are further columns, among them the outcome where there is no path."""
    scene, contact, spring, options = case.scene, case.scene.contact, case.scene.spring, case.options
    bottom, top = spring.mean_diameter
    values: dict[str, Any] = {
        "id": case.id,
        "version": version(),
        "reason": "; ".join(verdict.complaints + verdict.stops),
        "corner": case.corner,
        "variant": options.get("law") or f"{options['element']} {options['elements_per_turn']}",
        "steps": scene.load.steps,
        "penalty": contact.stiffness if contact.enabled else 0.0,
        "exponent": contact.exponent,
        "geometry": contact.geometry if case.model == "wirefe" else "circles",
        "pairs": options.get("pairs_per_turn", 2),
        "sliding": contact.sliding if case.model == "wirefe" else "",
        "index": bottom / spring.wire_diameter,
        "coils": spring.active_coils,
        "slenderness": 2.0 * spring.active_height / (bottom + top),
        "taper": top / bottom,
        "by": DISPLACEMENT if scene.load.displacement else FORCE,
        "load": case.size,
        "held": " ".join(scene.supports.top_held),
        "time": 0.0,
    }
    if path is not None:
        reached = len(path.times) > 0
        values |= {"outcome": path.outcome, "message": path.message}
        values["time"] = path.critical_time or (path.times[-1] if reached else 0.0)
        if reached:
            values |= zip(TIP, (*path.tips[-1], float(path.active_contacts[-1])), strict=True)
    values |= verdict.numbers | known
    texts = dict.fromkeys(COLUMNS, "")
    for name, value in values.items():
        texts[name] = f"{value:.6g}" if isinstance(value, float) else str(value).replace("\n", " ")
    return texts


def row_text(row: Row) -> str:
    """All that is known of a case, a line for each column."""
    return "\n".join(f"{name:15} {value}" for name, value in row.items() if value)


def kept(target: Path, seeds: Sequence[int], version: str) -> set[Key]:
    """Keys of a file's rows of some seeds and one version; the others, and a last line that was cut, go."""
    data = read_rows(target)
    data = data[data["seed"].isin([str(seed) for seed in seeds]) & (data["version"] == version)]
    write_text(target, _csv(data))
    return set(zip(data["seed"].astype(int), data["id"], strict=True))


def append(rows: list[Row], target: Path) -> None:
    """Add rows at the end of a file; they are on disk when this returns."""
    with writing(target), target.open("a", encoding="utf-8", newline="") as stream:
        stream.write(_csv(pd.DataFrame(rows, columns=list(COLUMNS)), header=False))
        stream.flush()
        os.fsync(stream.fileno())


def sort(target: Path, wanted: list[Key]) -> pd.DataFrame:
    """Write a file in the order of seeds and ids, and return the rows of those wanted."""
    data = read_rows(target)
    data = data.set_index([data["seed"].astype(int), data["id"]]).sort_index()
    write_text(target, _csv(data))
    return data.loc[wanted].reset_index(drop=True)


def _csv(data: pd.DataFrame, header: bool = True) -> str:
    return data.to_csv(index=False, header=header, lineterminator="\n")


def read_rows(target: Path) -> pd.DataFrame:
    """Whole rows of a file, texts; none where there is no such file or its columns are others."""
    none = pd.DataFrame(columns=list(COLUMNS), dtype=str)
    if not target.exists():
        return none
    with writing(target):
        text = target.read_text(encoding="utf-8")
    whole = text[: text.rfind("\n") + 1]
    if whole.partition("\n")[0] != ",".join(COLUMNS):
        return none
    return pd.read_csv(io.StringIO(whole), dtype=str, keep_default_na=False).dropna()


@lru_cache(maxsize=1)
def version() -> str:
    """Digest of the sources of the models and of the campaign: a row is good for these alone."""
    packages = ("coilspring", "equivbeam", "wirefe", "validation.campaign")
    files = [file for name in packages for file in source_files(name)]
    return digest(file for file in files if file.stem != "page")[:12]  # a mere view
