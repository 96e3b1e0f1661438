"""Which of the models is softer, over the start phase of the helix, which the paper does not give."""

import numpy as np
import pandas as pd

from coilspring import Scene
from coilspring.curves import COMPONENTS, compare_paths
from validation.study.cases import PAPER_MESH, case, turned
from validation.study.partialsolve import ending
from validation.study.paths import PathStore
from validation.study.tables import Table

DEGREES = tuple(range(0, 360, 30))
MANY_PAIRS = 20  # sphere pairs per turn so close that their places hardly matter
# the three contacts in which Spring A is turned: scene and sphere pairs per turn, by name
KINDS = {
    "bare": ("spring-a-no-contact", PAPER_MESH["pairs_per_turn"]),
    "few": ("spring-a", PAPER_MESH["pairs_per_turn"]),
    "many": ("spring-a", MANY_PAIRS),
}
SOFTER = tuple(f"{name}_softer" for name in COMPONENTS)


def over_phases(store: PathStore) -> pd.DataFrame:
    """Spring A at all start phases, a row for each of `KINDS` and `DEGREES` (`turned_by`)."""
    turns = [(name, *kind, degrees) for name, kind in KINDS.items() for degrees in DEGREES]
    return pd.DataFrame(
        {"contact": name} | turned_by(store, case(scene).scene, degrees, pairs)
        for name, scene, pairs, degrees in turns
    )


def turned_by(store: PathStore, scene: Scene, degrees: int, pairs: object) -> dict[str, object]:
    """The beam against the wire model at one start phase.

    ``ux``, ``uy``, ``rotz``: by how much the beam moves farther at full load, in parts of the wire model's
    tip; ``ux_softer`` and so on: number of substeps in which it does; ``difference``: the largest of the tip
    curves over the wire model's peak. Nothing of these where a path ends early, as ``outcome`` says.
    """
    scene = turned(scene, degrees) if degrees else scene
    beam, wire = store.partial_beam(scene), store.partial_wire(scene, pairs_per_turn=pairs)
    row: dict[str, object] = {"pairs_per_turn": pairs, "degrees": degrees, "outcome": "completed"}
    for path in (wire, beam):
        if path.outcome != "completed":
            return row | {"outcome": ending(path.outcome, path.critical_time)}
    mine, theirs = np.abs(beam.tips), np.abs(wire.tips)
    row |= zip(COMPONENTS, (mine[-1] / theirs[-1] - 1.0).tolist(), strict=True)
    row |= zip(SOFTER, np.count_nonzero(mine > theirs, axis=0).tolist(), strict=True)
    return row | {"difference": compare_paths(beam, wire).curve_max}


def phase_table(found: pd.DataFrame) -> Table:
    """A row for each phase: difference at full load and substeps in which the beam is softer."""
    columns = {"start phase (degrees)": [str(degrees) for degrees in DEGREES]}
    for name, rows in found.groupby("contact", sort=False):
        pairs = rows["pairs_per_turn"].iloc[0]
        title = "without contact" if name == "bare" else f"{pairs} pairs per turn"
        cells = [_cells(row) for row in rows.to_dict("records")]
        columns[f"{title}: UX / UY / ROTZ (%)"] = [farther for farther, _ in cells]
        columns[f"{title}: softer in substeps"] = [softer for _, softer in cells]
    return Table(tuple(columns), tuple(zip(*columns.values(), strict=True)))


def _cells(row: dict) -> tuple[str, str]:
    if row["outcome"] != "completed":
        return row["outcome"], ""
    farther = " / ".join(f"{100.0 * row[name]:+.2f}" for name in COMPONENTS)
    return farther, " / ".join(f"{row[name]:.0f}" for name in SOFTER)


def phase_facts(found: pd.DataFrame) -> dict[str, object]:
    """The same as facts: tuples over the phases that both models complete."""
    facts: dict[str, object] = {}
    done = found[found["outcome"] == "completed"]
    done = done.assign(softer=done[[*SOFTER]].min(axis=1).astype(int))
    for kind, rows in done.groupby("contact", sort=False):
        columns = rows[["degrees", "difference", "softer", *COMPONENTS]]
        facts |= {f"phases.{kind}.{name}": tuple(column.tolist()) for name, column in columns.items()}
    return facts
