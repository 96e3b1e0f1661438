"""What becomes of a case: its class, the reason where it is unexplained, and the numbers behind it."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import equivbeam
import wirefe
from coilspring import EquilibriumPath, Scene
from validation.campaign.scenes import Case, scaled_load
from validation.study.partialsolve import partial_path

CRITICAL = ("limit_point", "bifurcation")
# Outcomes that the verifier finds by its own means.
VERIFIED = ("completed", *CRITICAL, "jump", "interpenetration")
UNDECIDED, ITERATION, REFUSED, UNEXPLAINED = "undecided", "iteration", "refused", "unexplained"
CLASSES = (*VERIFIED, UNDECIDED, ITERATION, REFUSED, UNEXPLAINED)
SOLVERS: dict[str, Callable[..., EquilibriumPath]] = {"equivbeam": equivbeam.solve, "wirefe": wirefe.solve}


@dataclass
class Verdict:
    """Findings of one case; the first complaint is the reason."""

    complaints: list[str] = field(default_factory=list)
    stops: list[str] = field(default_factory=list)  # runs that end for reasons of the iteration
    numbers: dict[str, float] = field(default_factory=dict)
    # runs that differ from the path beyond a time from which on one of the two says that others are possible
    others: list[EquilibriumPath] = field(default_factory=list)

    def ask(self, name: str, value: float, most: float, what: str) -> None:
        """Keep the largest value of a name; complain where it is above the bound or no number."""
        self.numbers[name] = max(value, self.numbers.get(name, value))
        if not value <= most:
            self.complain(f"{what}: {value:.2e}, above {most:.0e}")

    def stable(self, least: float, time: float) -> None:
        """Keep the least stiffness, in units of that at rest; complain where it is not positive."""
        self.numbers["least"] = min(least, self.numbers.get("least", least))
        if not least > 0.0:
            self.complain(f"unstable at time {time:.6g}: least stiffness {least:.2e} of that at rest")

    def complain(self, what: str) -> None:
        """Keep what is wrong."""
        self.complaints.append(what)

    def class_of(self, outcome: str) -> str:
        """Class of a case: its outcome, unless something is wrong, a run stops by the iteration, or there are
        others."""
        if self.complaints:
            return UNEXPLAINED
        return ITERATION if self.stops else UNDECIDED if self.others else outcome

    def stop(self, name: str, path: EquilibriumPath) -> bool:
        """Whether a run ends for reasons of the iteration, which is kept."""
        stuck = path.outcome == "not_converged"
        if stuck:
            self.stops.append(f"{name}: {path.message}")
        return stuck


def reached(case: Case, scene: Scene | None = None, **options: object) -> EquilibriumPath:
    """Path of the case, complete or not; in another scene or with other options where given."""
    return partial_path(SOLVERS[case.model], scene or case.scene, **(dict(case.options) | options))


def under(scene: Scene, share: float) -> Scene:
    """The scene under a share of its load."""
    return replace(scene, load=scaled_load(scene.load, share, share))
