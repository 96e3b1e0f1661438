"""The wire model and a peer on one scene: curves, difference and time side by side."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

import wirefe
from coilspring import EquilibriumPath, InputError, Scene
from validation.peers import calculix
from validation.peers.installed import MISSING, opensees
from validation.peers.layout import Curve
from validation.study.metrics import COMPONENTS, answered, peaks
from validation.study.partialsolve import partial_path

FREE = "frictionless in both codes, since springs without a history do not know when a pair closed"


@dataclass(frozen=True)
class PeerComparison:
    """One scene in both codes.

    Attributes
    ----------
    scene : what both have solved.
    wire : path of the wire model, complete or not.
    peer : curve of the peer, complete or not.
    remark : in what the scene differs from the one asked for; empty where it does not.
    """

    scene: Scene
    wire: EquilibriumPath
    peer: Curve
    remark: str = ""

    @property
    def rows(self) -> int:
        """Steps that both have reached."""
        return min(len(self.wire.times), len(self.peer.times))

    @property
    def difference(self) -> float:
        """Largest over steps and components, over the component's peak in the wire model.

        Where UY is prescribed the axial force takes its place.
        """
        if self.rows == 0:
            return float("nan")
        ours, theirs = (
            np.column_stack(list(answers.values()))[: self.rows]
            for answers in (answered(self.wire), self.peer.answers)
        )
        return float((np.abs(theirs - ours) / peaks(ours)).max())

    @property
    def names(self) -> dict[str, str]:
        """Names of the components for a reader: UY that is prescribed is answered by a force."""
        return {name: name for name in COMPONENTS} | ({"uy": "force"} if self.scene.load.displacement else {})

    def csv(self) -> str:
        """Both curves, one row a step that either has reached."""
        import pandas as pd

        both = ((answered(self.wire), "wirefe"), (self.peer.answers, self.peer.code))
        curves = [
            pd.DataFrame(answers).rename(columns=lambda name, code=code: f"{self.names[name]}_{code}")
            for answers, code in both
        ]
        data = pd.concat(curves, axis=1)
        data.insert(0, "time", np.arange(1, len(data) + 1) / self.scene.load.rows)
        return data.to_csv(index=False, lineterminator="\n", float_format="%.9g")

    def lines(self) -> list[str]:
        """For a reader at the terminal."""
        wire, peer = self.wire, self.peer
        share = 100.0 * self.difference
        return [
            *([self.remark] if self.remark else []),
            self._line("wirefe", wire.times, answered(wire), wire.solve_seconds),
            self._line(peer.code, peer.times, peer.answers, peer.seconds),
            f"difference over {self.rows} common steps: {share:.2g} % of the curve's peak"
            if self.rows
            else "no step in common",
        ]

    def _line(self, code: str, times: np.ndarray, answers: dict[str, np.ndarray], seconds: float) -> str:
        if len(times) == 0:
            return f"{code}: no step reached, {seconds:.2g} s CPU"
        units = {"ux": "mm", "uy": "mm", "force": "N", "rotz": "rad"}
        last = {self.names[name]: answer[-1] for name, answer in answers.items()}
        shown = (f"{name} {value:.6g} {units[name]}" for name, value in last.items())
        return f"{code}: at time {times[-1]:g} {', '.join(shown)}; {seconds:.2g} s CPU"


def compare(scene: Scene, peer: str) -> PeerComparison:
    """Solve a scene with the wire model and with a peer, on 40 points a turn.

    Parameters
    ----------
    peer : one of `PEERS`.

    Raises
    ------
    InputError : the peer is not installed, or what it is not given.
    """
    remark = ""
    contact = scene.contact
    if peer == "calculix" and contact.enabled and contact.sliding == "none":
        scene, remark = replace(scene, contact=replace(contact, sliding="free")), FREE
    curve = PEERS[peer](scene)
    wirefe.solve(scene.with_steps(1).without_contact())  # makes the kernels ready
    return PeerComparison(scene, partial_path(wirefe.solve, scene), curve, remark)


def _opensees(scene: Scene) -> Curve:
    module = opensees()
    if module is None:
        raise InputError(MISSING)
    return module.run(scene, scene.load.steps, module.tolerance(scene))


PEERS: dict[str, Callable[[Scene], Curve]] = {"opensees": _opensees, "calculix": calculix.run}
