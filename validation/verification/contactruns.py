"""Runs of the wire model with contact, and what is measured of each: a row of a DataFrame."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial import cKDTree

import wirefe
from coilspring import Contact, EquilibriumPath, Load, Scene, load_scene, spring_a, spring_b
from validation.study.partialsolve import partial_path
from wirefe.model import ContactArrays
from wirefe.shape import contact_centres

NONE = np.inf  # no sliding
CYCLE = Path("examples/stages.toml")
TIPS = ("UX", "UY", "ROTZ")
HELD = 1e-9  # tips below are the rounding of fixed degrees of freedom


SPRINGS: dict[str, Callable[[], Scene]] = {
    "A": spring_a,
    "B": spring_b,
    # a progressive valve spring, its load put on and taken off
    "cycle": lambda: replace(load_scene(CYCLE), load=Load(stages=((0.0, -80.0), (0.0, 0.0)), steps=100)),
}


@dataclass(frozen=True)
class Run:
    """One run: the spring, its coefficient of friction, contact pairs per turn, F = K depth^k, N/mm^k."""

    spring: str
    mu: float  # 0 for none, infinite for no sliding
    pairs: int = 4
    k: float = 1.0
    K: float = 1e4
    steps: int = 50
    geometry: str = "spheres"
    degrees: float = 0.0  # start phase
    curved: bool = False  # as many elements per turn as pairs; else 40 straight ones

    @property
    def scene(self) -> Scene:
        """The scene that is solved."""
        sliding = {0.0: "free", NONE: "none"}.get(self.mu, "coulomb")
        friction = self.mu if sliding == "coulomb" else None
        contact = Contact(
            stiffness=self.K, exponent=self.k, sliding=sliding, friction=friction, geometry=self.geometry
        )
        scene = SPRINGS[self.spring]()
        spring = replace(scene.spring, start_phase=math.radians(self.degrees))
        return replace(scene, spring=spring, contact=contact)

    def solved(self) -> EquilibriumPath:
        """Its path, as far as it goes."""
        mesh = {"element": "curved", "elements_per_turn": self.pairs} if self.curved else {}
        steps = {} if self.spring == "cycle" else {"steps": self.steps}
        return partial_path(wirefe.solve, self.scene, pairs_per_turn=self.pairs, **steps, **mesh)


def measured(runs: Iterable[Run], repeats: int = 1) -> pd.DataFrame:
    """A row for each run; ``seconds`` is the least CPU time of the repeats."""
    rows = []
    for run in runs:
        paths = [run.solved() for _ in range(repeats)]
        seconds = min(path.solve_seconds for path in paths)
        rows.append(asdict(run) | measures(paths[0]) | {"seconds": seconds})
    return pd.DataFrame(rows)


def measures(path: EquilibriumPath) -> dict[str, Any]:
    """Numbers of a path at its last step; works, overlaps and the largest slip of all its steps."""
    (x, y), (fx, fy) = path.top[-1, :2], path.loads[-1]
    return dict(zip(TIPS, path.tips[-1], strict=True)) | {
        "outcome": path.outcome.replace("_", " "),
        "critical time": path.critical_time,
        "overlap": overlap(path),
        "penetration": path.max_penetration[-1],
        "force": path.contact_forces[-1].max(),
        "factorisations": path.total_iterations,
        "pairs found": path.options["pairs_found"],
        "unlisted": unlisted(path),
        "work": float(path.friction.work[-1].sum()),
        "largest slip": path.friction.slip.max(),
        "last slip": path.friction.slip[-1].max(),
        "couple": couple(path),
        "moment": abs(float(x * fy - y * fx)),
    }


def difference(tips: pd.DataFrame, reference: pd.Series) -> pd.Series:
    """Largest difference of a tip's component over that component, of those that the reference moves."""
    moved = [name for name in TIPS if abs(reference[name]) > HELD]
    return ((tips[moved] - reference[moved]).abs() / reference[moved].abs()).astype(float).max(axis=1)


def overlap(path: EquilibriumPath, points_per_turn: int = 160) -> float:
    """Largest overlap of wires of neighbouring coils anywhere at the last step, mm.

    Distances of points of the centreline from the straight pieces half a turn to one and a half turns on;
    points of one rigid end turn do not count with each other.
    """
    line = path.centreline(-1, points_per_turn)
    ends, half = round(path.scene.spring.end_turns * points_per_turn), points_per_turn // 2
    least = np.inf
    for ahead in range(half, 3 * half):
        distance = to_pieces(line[: -ahead - 1], line[ahead:-1], line[ahead + 1 :])
        inside = np.arange(len(distance))
        active = (inside + ahead >= ends) & (inside < len(line) - ends)
        least = min(least, float(distance[active].min()))
    return max(path.scene.spring.wire_diameter - least, 0.0)


def to_pieces(points: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Distance of each point from its piece between `first` and `second`."""
    along, out = second - first, points - first
    share = np.clip((out * along).sum(axis=1) / (along * along).sum(axis=1), 0.0, 1.0)
    return np.linalg.norm(out - share[:, None] * along, axis=1)


def centres(path: EquilibriumPath, step: int) -> tuple[ContactArrays, np.ndarray]:
    """Contact arrays and the spheres' centres at a stored step."""
    contact = path.shape.data.contact  # type: ignore[attr-defined]
    return contact, contact_centres(contact, path.states[step][None])[0]


def couple(path: EquilibriumPath) -> float:
    """Size of the sum of the couples g x f_t that the tangential forces leave at the last step, N mm."""
    contact, places = centres(path, -1)
    gap = places[contact.pairs[:, 1]] - places[contact.pairs[:, 0]]
    return float(np.linalg.norm(np.cross(gap, path.friction.force[-1]).sum(axis=0)))


def unlisted(path: EquilibriumPath) -> int:
    """Overlaps of spheres, over all stored states, that are no pair of the model."""
    count = 0
    for step in range(len(path.times)):
        contact, places = centres(path, step)
        low, high = cKDTree(places).query_pairs(contact.d, output_type="ndarray").T
        apart = (high - low > contact.near) & (contact.attached[low] != contact.attached[high])
        listed = np.isin(low * len(places) + high, contact.pairs @ [len(places), 1])
        count += int((apart & ~listed).sum())
    return count


def limit_point() -> dict[str, Any]:
    """Where frictionless Spring B goes at its limit point: the closed pair that moves most, and how far along
    the wire."""
    path = wirefe.trace(Run("B", 0.0).scene, points=160, element="curved", elements_per_turn=8)
    limit = int(np.argmax(np.diff(path.times) < 0.0))
    contact, before = centres(path, limit - 3)
    _, after = centres(path, limit + 1)
    lower, upper = contact.pairs.T
    moved = (after[upper] - after[lower]) - (before[upper] - before[lower])
    most = int(np.argmax(np.linalg.norm(moved, axis=1) * (path.gaps[limit + 1] < 0.0)))
    along = np.cross([0.0, 1.0, 0.0], after[lower[most]])
    share = abs(moved[most] @ along) / np.linalg.norm(along) / np.linalg.norm(moved[most])
    return {
        **{"traced": path.options["pairs_found"], "limit": path.times[limit]},
        **{"first": lower[most], "second": upper[most], "circ": 100.0 * share},
    }
