"""The page on `wirefe` against OpenSees: its tables and what they mean."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from importlib import metadata
from pathlib import Path

import numpy as np

from validation.study import template
from validation.study.document import Table
from validation.study.machine import machine

STEPS = 50  # the equal steps of the paper
LADDER = (1, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30, STEPS)
AGREEMENT = 0.002  # of the tip: between the codes, and of few steps with 50
HEADER = (
    *("ratio", "scene", "steps chosen", "steps", "wirefe, s", "OpenSees, s", "iterations"),
    "tip difference, %",
)
TIP_HEADER = ("scene", "code", "UX, mm", "UY, mm", "ROTZ, rad")


@dataclass(frozen=True)
class Duel:
    """Both codes, each in its own number of steps, over all rounds; pairs are (wirefe, OpenSees)."""

    scene: str
    kind: str
    steps: tuple[int, int]
    seconds: np.ndarray  # (rounds, 2)
    iterations: tuple[int, int]
    tips: tuple[np.ndarray, np.ndarray]

    @property
    def difference(self) -> float:
        """Largest relative difference of the tips."""
        return distance(self.tips[1], self.tips[0])

    @property
    def ratio(self) -> float:
        """OpenSees' time over wirefe's, median of the rounds."""
        wire, peer = self.seconds.T
        return float(np.median(peer / wire))

    def row(self) -> tuple[str, ...]:
        """Row of the table of times."""
        wire, peer = self.seconds.T
        return (
            spread(peer / wire, ".1f"),
            self.scene,
            self.kind,
            f"{self.steps[0]} / {self.steps[1]}",
            spread(wire, ".3f"),
            spread(peer, ".2f"),
            f"{self.iterations[0]} / {self.iterations[1]}",
            f"{100.0 * self.difference:.4f}",
        )

    def tip_rows(self) -> list[tuple[str, ...]]:
        """Rows of the table of tips, one a code."""
        return [
            (self.scene, code, f"{tip[0]:.4f}", f"{tip[1]:.4f}", f"{tip[2]:.5f}")
            for code, tip in zip(("wirefe", "OpenSees"), self.tips, strict=True)
        ]


def distance(tip: np.ndarray, reference: np.ndarray) -> float:
    """Largest relative difference of the components that are not held."""
    free = np.abs(reference) > 1e-9
    return float(np.max(np.abs(tip - reference)[free] / np.abs(reference[free])))


def spread(values: np.ndarray, form: str) -> str:
    """Median (min-max)."""
    return f"{np.median(values):{form}} ({values.min():{form}}-{values.max():{form}})"


def facts(duels: Sequence[Duel]) -> dict[str, object]:
    """The date, median ratios of the times, and the difference of the tips in equal steps, per cent."""
    found: dict[str, object] = {"opensees.made": date.today().isoformat()}
    found |= {f"opensees.{duel.scene}.{duel.kind}": duel.ratio for duel in duels}
    equal = [duel for duel in duels if duel.kind == "equal"]
    return found | {f"opensees.{duel.scene}.difference": 100.0 * duel.difference for duel in equal}


def page(duels: Sequence[Duel], repeats: int, tolerance: float) -> str:
    """The Markdown page: two tables and what they mean."""
    equal = [duel for duel in duels if duel.kind == "equal"]
    return template.page(
        template.template(Path(__file__).with_name("opensees.md")),
        where=machine(),
        openseespy=metadata.version("openseespy"),
        times=Table(HEADER, tuple(duel.row() for duel in duels)),
        tips=Table(TIP_HEADER, tuple(row for duel in equal for row in duel.tip_rows())),
        repeats=repeats,
        steps=STEPS,
        ladder=", ".join(map(str, LADDER)),
        tolerance=f"{tolerance:g}",
        agreement=f"{100.0 * AGREEMENT:g}",
    )
