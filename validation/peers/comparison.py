"""The wire model and a peer on one scene: curves, difference and time side by side."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from types import ModuleType
from typing import TypeVar

import numpy as np

import wirefe
from coilspring import EquilibriumPath, InputError, Scene
from coilspring.curves import Curve, compare_curves
from validation.peers import calculix
from validation.peers.layout import NODES_PER_TURN, PeerCurve, layout, refuse
from validation.study.partialsolve import partial_path

MISSING = (
    "openseespy is missing or cannot be loaded: pip install -e '.[peers]' and, on Debian, "
    "apt-get install libblas3 liblapack3"
)
FREE = "frictionless in both codes, since springs without a history do not know when a pair closed"
Value = TypeVar("Value")
UNITS = {"ux": "mm", "uy": "mm", "force": "N", "rotz": "rad"}


@dataclass(frozen=True)
class PeerComparison:
    """One scene in both codes."""

    scene: Scene  # what both have solved
    wire: EquilibriumPath  # of the wire model, complete or not
    peer: PeerCurve  # complete or not
    remark: str = ""  # in what the scene differs from the one asked for

    @property
    def rows(self) -> int:
        """Steps that both have reached."""
        return min(len(self.wire.times), len(self.peer.times))

    @property
    def differences(self) -> dict[str, float]:
        """Largest over steps of each answered component, over its peak in the wire model."""
        return compare_curves(self.peer.curve, self.wire).component_max

    @property
    def difference(self) -> float:
        """The largest of them; not a number without a common step."""
        return compare_curves(self.peer.curve, self.wire).curve_max

    @property
    def early(self) -> list[str]:
        """A sentence on each code that ended before full load."""
        peer, steps = self.peer, self.scene.load.rows
        said = [f"wirefe: {self.wire.message}"] if self.wire.outcome != "completed" else []
        if len(peer.times) < steps:
            said.append(
                f"{peer.code} ended early, after {len(peer.times)} of {steps} steps, and does not say why"
            )
        return said

    def _named(self) -> list[tuple[str, dict[str, np.ndarray]]]:
        """Codes, and what they answer by names for a reader: UY that is prescribed is answered by a force."""
        both = (("wirefe", Curve.of(self.wire).by_name), (self.peer.code, self.peer.curve.by_name))
        return [(code, self._for_a_reader(found)) for code, found in both]

    def _for_a_reader(self, found: dict[str, Value]) -> dict[str, Value]:
        """What is found of components, by names for a reader."""
        uy = "force" if self.scene.load.displacement else "uy"
        return {uy if name == "uy" else name: value for name, value in found.items()}

    def csv(self) -> bytes:
        """Both curves, one row a step that either has reached."""
        import pandas as pd

        from validation.study.frames import to_csv

        both = [pd.DataFrame(found).add_suffix(f"_{code}") for code, found in self._named()]
        data = pd.concat(both, axis=1)
        data.insert(0, "time", np.arange(1, len(data) + 1) / self.scene.load.rows)
        return to_csv(data, digits=9)

    def lines(self) -> list[str]:
        """For a reader at the terminal."""
        lines = [self.remark] if self.remark else []
        ends = ((self.wire.times, self.wire.solve_seconds), (self.peer.times, self.peer.seconds))
        for (code, answers), (times, seconds) in zip(self._named(), ends, strict=True):
            reached = "no step reached,"
            if len(times):
                last = (f"{name} {answer[-1]:.6g} {UNITS[name]}" for name, answer in answers.items())
                reached = f"at time {times[-1]:g} {', '.join(last)};"
            lines.append(f"{code}: {reached} {seconds:.2g} s CPU")
        lines += self.early
        if not self.rows:
            return [*lines, "no step in common"]
        found = self._for_a_reader(self.differences)
        each = ", ".join(f"{name} {100.0 * share:.2g} %" for name, share in found.items())
        return [*lines, f"difference over {self.rows} common steps, of each one's peak: {each}"]


def compare(scene: Scene, peer: str) -> PeerComparison:
    """Solve a scene with the wire model and with a peer of `PEERS`, on 40 points a turn.

    `InputError` where the peer is not installed, and for what it is not given.
    """
    remark, contact = "", scene.contact
    if peer == "calculix" and contact.enabled and contact.sliding == "none":
        scene, remark = replace(scene, contact=replace(contact, sliding="free")), FREE
    curve = PEERS[peer](scene)
    wirefe.solve(scene.with_steps(1).without_contact())  # makes the kernels ready
    return PeerComparison(scene, partial_path(wirefe.solve, scene), curve, remark)


def opensees() -> ModuleType | None:
    """`validation.peers.opensees`; None where openseespy is missing or cannot be loaded."""
    try:
        import validation.peers.opensees as module
    except (ImportError, RuntimeError):  # the latter where its libraries are missing
        return None
    return module


def _opensees(scene: Scene) -> PeerCurve:
    module = opensees()
    if module is None:
        refuse(scene, "opensees")  # before anyone installs it for nothing
        layout(scene, NODES_PER_TURN)
        raise InputError(MISSING)
    return module.run(scene, scene.load.steps, module.tolerance(scene))


PEERS: dict[str, Callable[[Scene], PeerCurve]] = {"opensees": _opensees, "calculix": calculix.run}
