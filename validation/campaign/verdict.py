"""What becomes of a case: its class, the reason where it is unexplained, and the numbers behind it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import equivbeam
import wirefe
from coilspring import EquilibriumPath, Scene
from coilspring.solver.solve import HELD
from validation.campaign.scenes import Case, scaled_load
from validation.study.partialsolve import partial_path

RIGHT, CONFIRMED, THROUGH, ENDED, DEVIATES = "completed", "critical", "interpenetration", "ended", "deviation"
REFUSED, UNEXPLAINED = "refused", "unexplained"
CLASSES = (RIGHT, CONFIRMED, THROUGH, ENDED, DEVIATES, REFUSED, UNEXPLAINED)
CRITICAL = ("limit_point", "bifurcation")
SOLVERS: dict[str, Callable[..., EquilibriumPath]] = {"equivbeam": equivbeam.solve, "wirefe": wirefe.solve}
MANY = 200  # steps of the fine run, nearly


@dataclass
class Verdict:
    """Findings of one case; the first complaint is the reason.

    `differences` are those complaints that two histories of contact would explain; `deviations` have been
    explained so: pairs keep where they were when a substep ended.
    """

    complaints: list[str] = field(default_factory=list)
    differences: list[str] = field(default_factory=list)
    numbers: dict[str, float] = field(default_factory=dict)
    deviations: list[str] = field(default_factory=list)

    def ask(self, name: str, value: float, most: float, what: str) -> None:
        """Keep the largest value of a name; it differs where it is above the bound or no number."""
        self.numbers[name] = max(value, self.numbers.get(name, value))
        if not value <= most:
            self.differ(f"{what}: {value:.2e}, above {most:.0e}")

    def take(self, other: Verdict, by_history: bool) -> None:
        """Take over a comparison with another run; `by_history`: contact histories explain what differs."""
        excused = other.differences if by_history else []
        self.deviations += excused
        self.complaints += [what for what in other.complaints if what not in excused]
        for name, value in () if excused else other.numbers.items():
            self.numbers[name] = max(value, self.numbers.get(name, value))

    def differ(self, what: str) -> None:
        """Another run has another answer."""
        self.complaints.append(what)
        self.differences.append(what)

    def complain(self, what: str) -> None:
        """Something is wrong that has no number."""
        self.complaints.append(what)


def reached(case: Case, scene: Scene | None = None, **options: object) -> EquilibriumPath:
    """Path of the case, complete or not; in another scene or with other options where given."""
    return partial_path(SOLVERS[case.model], scene or case.scene, **(dict(case.options) | options))


def ended(path: EquilibriumPath) -> bool:
    """Whether the path ends for what friction held: its bounds, or a pair that opened."""
    return path.outcome == "not_converged" and path.message.startswith(HELD)


def fine_steps(case: Case) -> int:
    """Steps of the fine run: the multiple of the case's next to 200, whose times so are among its own."""
    steps = case.scene.load.steps
    return steps * max(round(MANY / steps), 2)


def under(scene: Scene, share: float) -> Scene:
    """The scene under a share of its load."""
    return replace(scene, load=scaled_load(scene.load, share, share))
