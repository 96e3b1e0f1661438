"""The campaign's table: a row of texts for each case, found again after an interruption."""

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import pandas as pd

from coilspring import EquilibriumPath
from validation.campaign.scenes import Case
from validation.campaign.verdict import Verdict
from validation.study.keys import digest, source_files
from validation.study.rows import Row, whole_rows, write

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
    found = whole_rows(target, COLUMNS)
    rows = [row for row in found if row["seed"] in map(str, seeds) and row["version"] == version]
    write(rows, target, COLUMNS)
    return {key_of(row) for row in rows}


def sort(target: Path, wanted: list[Key]) -> pd.DataFrame:
    """Write a file in the order of seeds and ids, and return the rows of those wanted."""
    rows = {key_of(row): row for row in sorted(whole_rows(target, COLUMNS), key=key_of)}
    write(rows.values(), target, COLUMNS)
    return pd.DataFrame([rows[key] for key in wanted], columns=list(COLUMNS), dtype=str)


def key_of(row: Row) -> Key:
    """Seed and id of a row."""
    return int(row["seed"]), row["id"]


@lru_cache(maxsize=1)
def version() -> str:
    """Digest of the sources of the models and of the campaign: a row is good for these alone."""
    packages = ("coilspring", "equivbeam", "wirefe", "validation.campaign", "validation.study.sections")
    files = [file for name in packages for file in source_files(name)]
    return digest(file for file in files if file.stem != "page")[:12]  # a mere view
