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
from validation.study.metrics import COMPONENTS, NEGLIGIBLE
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
        """Largest over steps and components, over the component's peak in the wire model."""
        if self.rows == 0:
            return float("nan")
        ours, theirs = self.wire.tips[: self.rows], self.peer.tips[: self.rows]
        peaks = np.abs(ours).max(axis=0)
        moved = peaks > NEGLIGIBLE * peaks.max()
        return float((np.abs(theirs - ours)[:, moved] / peaks[moved]).max())

    def csv(self) -> str:
        """Both curves, one row a step that either has reached."""
        import pandas as pd

        both = ((self.wire.tips, "wirefe"), (self.peer.tips, self.peer.code))
        curves = [
            pd.DataFrame(tips, columns=[f"{name}_{code}" for name in COMPONENTS]) for tips, code in both
        ]
        data = pd.concat(curves, axis=1)
        data.insert(0, "time", np.arange(1, len(data) + 1) / self.scene.load.steps)
        return data.to_csv(index=False, lineterminator="\n", float_format="%.9g")

    def lines(self) -> list[str]:
        """For a reader at the terminal."""
        wire, peer = self.wire, self.peer
        share = 100.0 * self.difference
        return [
            *([self.remark] if self.remark else []),
            _line("wirefe", wire.times, wire.tips, wire.solve_seconds),
            _line(peer.code, peer.times, peer.tips, peer.seconds),
            f"difference over {self.rows} common steps: {share:.2g} % of the curve's peak"
            if self.rows
            else "no step in common",
        ]


def _line(code: str, times: np.ndarray, tips: np.ndarray, seconds: float) -> str:
    if len(times) == 0:
        return f"{code}: no step reached, {seconds:.2g} s CPU"
    ux, uy, rotz = tips[-1]
    return (
        f"{code}: at time {times[-1]:g} ux {ux:.6g} mm, uy {uy:.6g} mm, rotz {rotz:.6g} rad; "
        f"{seconds:.2g} s CPU"
    )


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
