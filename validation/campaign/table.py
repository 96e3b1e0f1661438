"""The campaign's table: rows appended to a file as they come, and found again after an interruption."""

from __future__ import annotations

import csv
import io
import os
from functools import lru_cache
from pathlib import Path

from validation.campaign.scenes import Case
from validation.campaign.verdict import Verdict
from validation.study.keys import digest, source_files
from validation.study.output import write_text, writing

NUMBERS = (
    "residual", "least", "branch", "bracket", "critical_shift", "passed", "confirmed", "friction",
    "invariance", "overlap", "place", "reaction", "stepped",
)  # fmt: skip
FORCE, DISPLACEMENT = "force", "displacement"
COLUMNS = (
    "id", "seed", "version", "class", "outcome", "reason", "corner", "variant", "steps", "penalty",
    "exponent", "sliding", "index", "coils", "slenderness", "taper", "by", "load", "held", "time", "ux", "uy",
    "rotz", "contacts", "kind", *NUMBERS, "message", "seconds",
)  # fmt: skip


class Row(dict[str, str]):
    """One case, all columns as texts."""

    @classmethod
    def of(
        cls,
        case: Case,
        seed: int,
        verdict_class: str,
        outcome: str,
        message: str,
        time: float,
        tip: tuple[float, ...],
        kind: str,
        verdict: Verdict,
        seconds: float,
    ) -> Row:
        """Row of a judged case."""
        scene, contact, spring = case.scene, case.scene.contact, case.scene.spring
        bottom, top = spring.mean_diameter
        options = case.options
        variant = options.get("law") or f"{options['element']} {options['elements_per_turn']}"
        values = {
            "id": case.id,
            "seed": seed,
            "version": version(),
            "class": verdict_class,
            "outcome": outcome,
            "reason": "; ".join(verdict.complaints + verdict.apart),
            "corner": case.corner,
            "variant": variant,
            "steps": scene.load.steps,
            "penalty": _short(contact.stiffness if contact.enabled else 0.0),
            "exponent": _short(contact.exponent),
            "sliding": contact.sliding if case.model == "wirefe" else "",
            "index": _short(bottom / spring.wire_diameter),
            "coils": _short(spring.active_coils),
            "slenderness": _short(2.0 * spring.active_height / (bottom + top)),
            "taper": _short(top / bottom),
            "by": DISPLACEMENT if scene.load.displacement else FORCE,
            "load": _short(case.size),
            "held": " ".join(scene.supports.top_held),
            "time": _short(time),
            "kind": kind,
            **dict(zip(("ux", "uy", "rotz", "contacts"), map(_short, tip), strict=False)),
            "message": message,
            "seconds": f"{seconds:.3f}",
        }
        values |= {name: _short(verdict.numbers[name]) for name in NUMBERS if name in verdict.numbers}
        return cls({name: str(values.get(name, "")).replace("\n", " ") for name in COLUMNS})

    def text(self) -> str:
        """All that is known of the case, a line for each column."""
        return "\n".join(f"{name:15} {value}" for name, value in self.items() if value)

    def line(self) -> str:
        """The row as it stands in the file."""
        stream = io.StringIO()
        csv.DictWriter(stream, COLUMNS, lineterminator="\n").writerow(self)
        return stream.getvalue()


class Table:
    """Rows of one seed and version, in a file."""

    def __init__(self, target: Path, seed: int, version: str) -> None:
        self.target = target
        kept = [row for row in read_rows(target) if (row["seed"], row["version"]) == (str(seed), version)]
        self.rows = {row["id"]: row for row in kept}
        # what belongs to another seed or version, and a last line that was cut, are left out
        self._write(list(self.rows.values()))

    def __contains__(self, name: str) -> bool:
        return name in self.rows

    def append(self, rows: list[Row]) -> None:
        """Add rows at the end of the file; they are on disk when this returns."""
        with writing(self.target), self.target.open("a", encoding="utf-8", newline="") as stream:
            stream.write("".join(row.line() for row in rows))
            stream.flush()
            os.fsync(stream.fileno())
        self.rows |= {row["id"]: row for row in rows}

    def sort(self, wanted: list[str]) -> list[Row]:
        """Write the file in the order of the ids, and return the rows of those wanted."""
        self._write([self.rows[name] for name in sorted(self.rows)])
        return [self.rows[name] for name in wanted]

    def _write(self, rows: list[Row]) -> None:
        write_text(self.target, ",".join(COLUMNS) + "\n" + "".join(row.line() for row in rows))


def read_rows(target: Path) -> list[Row]:
    """Whole rows of a file; none where there is no such file or its columns are others."""
    if not target.exists():
        return []
    with writing(target):
        text = target.read_text(encoding="utf-8")
    whole = text[: text.rfind("\n") + 1]
    reader = csv.DictReader(io.StringIO(whole))
    if tuple(reader.fieldnames or ()) != COLUMNS:
        return []
    return [Row(row) for row in reader if None not in row and None not in row.values()]


@lru_cache(maxsize=1)
def version() -> str:
    """Digest of the sources of the models and of the campaign: a row is good for these alone."""
    packages = ("coilspring", "equivbeam", "wirefe", "validation.campaign")
    files = [file for name in packages for file in source_files(name)]
    return digest(file for file in files if file.name != "page.py")[:12]  # which only shows what was found


def _short(value: float) -> str:
    return f"{value:.6g}"
