"""Both laws against the wire model on random springs: the rows of ``randomsprings.csv``."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import equivbeam
import wirefe
from coilspring import EquilibriumPath, Scene
from coilspring.curves import COMPONENTS, Curve, over_peak
from coilspring.scene.sizing import middle_diameter
from equivbeam.laws.userlaw import UserLaw
from validation.study.models import LAWS
from validation.study.partialsolve import partial_path
from validation.verification.randomscenes import Drawn, population

CSV = Path("reports/errorbudget/randomsprings.csv")
SEEDS, EACH = (0, 1, 2), 40  # springs of every kind and seed
HELIX_FIRST = LAWS[::-1]  # as the recorded columns stand
ELEMENTS = 8  # curved, a turn
PAIRS = 32  # stations a turn, in contact
PAPER_PAIRS = 4  # a turn: how closed pairs are counted
NEGLIGIBLE = 1e-3  # of the largest component; ROTZ times the mean coil radius


def study(seeds: Iterable[int] = SEEDS, each: int = EACH) -> pd.DataFrame:
    """A row for each spring of the seeds, `each` of every kind of load and support."""
    return pd.DataFrame([row(drawn) for seed in seeds for drawn in population(seed, each)])


def row(drawn: Drawn) -> dict[str, Any]:
    """What a spring is, and both laws' errors on it, per cent.

    ``closed`` is the largest number of quarter turns on which pairs are closed at once; ``reference`` what
    twice the elements and, with contact, half the stations move the wire model by.
    """
    scene, spring, diameter = drawn.scene, drawn.scene.spring, middle_diameter(drawn.scene.spring)
    wire, other = reference(scene), reference(scene, elements=16, pairs=PAIRS // 2)
    found: dict[str, Any] = {
        **{"seed": drawn.seed, "kind": drawn.kind, "number": drawn.number, "shape": drawn.shape},
        **{"index": diameter / spring.wire_diameter, "coils": spring.active_coils},
        **{"slenderness": spring.active_height / diameter, "phase": math.degrees(spring.start_phase)},
        **{"contact": scene.contact.enabled, "closed": closed(wire), "wire": wire.outcome},
        "reference": curve_errors(Curve.of(other), Curve.of(wire), 0.5 * diameter)["vector"],
    }
    for law in HELIX_FIRST:
        found |= law_row(law, law, scene, Curve.of(wire))
    return found


def reference(scene: Scene, elements: int = ELEMENTS, pairs: int = PAIRS) -> EquilibriumPath:
    """The wire model's path, as far as it goes."""
    options = {"element": "curved", "elements_per_turn": elements}
    if scene.contact.enabled:
        options["pairs_per_turn"] = pairs
    return partial_path(wirefe.solve, scene, **options)


def closed(wire: EquilibriumPath) -> int:
    """Largest number of quarter turns, each a pair of the paper's, on which pairs are closed at once."""
    pairs: np.ndarray = wire.shape.pair_law.pairs
    quarters = pairs[:, 0] * PAPER_PAIRS // PAIRS
    return max((len(np.unique(quarters[gaps < 0.0])) for gaps in wire.gaps), default=0)


def law_row(name: str, law: str | UserLaw, scene: Scene, wire: Curve) -> dict[str, Any]:
    """Outcome and errors of a law on a spring, by columns of the law's name."""
    path = partial_path(equivbeam.solve, scene, law=law)
    found = curve_errors(Curve.of(path), wire, 0.5 * middle_diameter(scene.spring))
    return {name: path.outcome} | {f"{name}_{key}": value for key, value in found.items()}


def curve_errors(curve: Curve, wire: Curve, radius: float) -> dict[str, float]:
    """Largest errors as far as both curves go, over the wire model's peak there, per cent.

    ``vector`` is of the displacement (UX, UY), or of the axial force where UY is prescribed; the others of a
    component alone, and not a number where the wire model hardly moves it, ROTZ times the mean coil radius.
    ``steps`` both have.
    """
    common = min(len(curve.times), len(wire.times))
    found = dict.fromkeys(("vector", *COMPONENTS), math.nan) | {"steps": common}
    if common == 0:
        return found
    mine, theirs = (each.answers[:common] for each in (curve, wire))
    off, sizes = np.abs(over_peak(mine, theirs)).max(axis=0), np.abs(theirs).max(axis=0) * (1.0, 1.0, radius)
    for place, name in enumerate(COMPONENTS):
        if sizes[place] > NEGLIGIBLE * sizes.max():
            found[name] = 100.0 * float(off[place])
    largest, size = (np.linalg.norm(values[:, :2], axis=1).max() for values in (mine - theirs, theirs))
    return found | {"vector": 100.0 * float(largest / size)}
