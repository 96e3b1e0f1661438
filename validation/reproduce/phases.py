"""Which of the models is softer, over the start phase of the helix, which the paper does not give."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from coilspring import Scene
from validation.study.cases import PAPER_MESH, PathStore, case, turned
from validation.study.document import Table
from validation.study.metrics import COMPONENTS, compare_paths
from validation.study.partialsolve import ending

DEGREES = tuple(range(0, 360, 30))
MANY_PAIRS = 20  # sphere pairs a turn so close that their places hardly matter
# the three contacts in which Spring A is turned: name, scene, sphere pairs a turn
KINDS = (
    ("bare", "spring-a-no-contact", PAPER_MESH["pairs_per_turn"]),
    ("few", "spring-a", PAPER_MESH["pairs_per_turn"]),
    ("many", "spring-a", MANY_PAIRS),
)


@dataclass(frozen=True)
class Turned:
    """The beam against the wire model at one start phase.

    Attributes
    ----------
    degrees : the start phase.
    outcome : "completed", or how and when a path ended; then nothing is compared.
    farther : by how much the beam moves farther at full load, in parts of the wire model's UX, UY, ROTZ.
    softer : number of substeps in which it moves farther, for each of them.
    apart : largest difference of the tip curves over the wire model's peak.
    """

    degrees: int
    outcome: str
    farther: tuple[float, ...] = ()
    softer: tuple[int, ...] = ()
    apart: float = float("nan")


def over_phases(store: PathStore) -> dict[str, tuple[Turned, ...]]:
    """Spring A at all start phases, by the names in `KINDS`."""
    return {
        name: tuple(turned_by(store, case(scene).scene, degrees, pairs) for degrees in DEGREES)
        for name, scene, pairs in KINDS
    }


def turned_by(store: PathStore, scene: Scene, degrees: int, pairs: object) -> Turned:
    """Both models of a scene at a start phase, the wire model with that many sphere pairs a turn."""
    scene = turned(scene, degrees) if degrees else scene
    beam, wire = store.beam_as_far(scene), store.wire_as_far(scene, pairs_per_turn=pairs)
    for path in (wire, beam):
        if path.outcome != "completed":
            return Turned(degrees, ending(path.outcome, path.critical_time))
    mine, theirs = np.abs(beam.tips), np.abs(wire.tips)
    return Turned(
        degrees,
        "completed",
        farther=tuple((mine[-1] / theirs[-1] - 1.0).tolist()),
        softer=tuple(np.count_nonzero(mine > theirs, axis=0).tolist()),
        apart=compare_paths(beam, wire).curve_max,
    )


def phase_table(found: Mapping[str, tuple[Turned, ...]]) -> Table:
    """A row for each phase: difference at full load and substeps in which the beam is softer."""
    titles = [_title(name, pairs) for name, _, pairs in KINDS]
    columns = ("UX / UY / ROTZ (%)", "softer in substeps")
    header = ("start phase (degrees)", *(f"{title}: {words}" for title in titles for words in columns))
    rows = zip(*found.values(), strict=True)
    return Table(header, tuple(_row(row) for row in rows))


def _title(name: str, pairs: object) -> str:
    return "without contact" if name == "bare" else f"{pairs} pairs a turn"


def _row(row: Sequence[Turned]) -> tuple[str, ...]:
    cells = [f"{row[0].degrees}"]
    for item in row:
        cells += [
            " / ".join(f"{100.0 * share:+.2f}" for share in item.farther) or item.outcome,
            " / ".join(map(str, item.softer)),
        ]
    return tuple(cells)


def phase_facts(found: Mapping[str, tuple[Turned, ...]]) -> dict[str, object]:
    """The same as facts: tuples over the phases that both models complete."""
    facts: dict[str, object] = {}
    for name, rows in found.items():
        done = [row for row in rows if row.farther]
        facts[f"phases.{name}.degrees"] = tuple(row.degrees for row in done)
        facts[f"phases.{name}.apart"] = tuple(row.apart for row in done)
        facts[f"phases.{name}.softer"] = tuple(min(row.softer) for row in done)
        for i, component in enumerate(COMPONENTS):
            facts[f"phases.{name}.{component}"] = tuple(row.farther[i] for row in done)
    return facts
