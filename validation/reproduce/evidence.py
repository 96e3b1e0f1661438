"""What the report rests on: paths of both models, their differences, the mesh's own error, timings.

`validation.reproduce.facts` turns it into the numbers that sentences are computed from.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from coilspring import EquilibriumPath, Scene
from validation.reproduce.phases import over_phases
from validation.study.cases import CASES, FINE_MESH, PAPER_MESH, Case, PathStore, case
from validation.study.metrics import Comparison, compare_paths, peaks

# Richardson: an error that falls with the square of the element length is this multiple of the
# difference to the finer mesh
_REFINED = FINE_MESH["elements_per_turn"] / PAPER_MESH["elements_per_turn"]
RICHARDSON = _REFINED**2 / (_REFINED**2 - 1.0)
ERRORS = ("curve_max", "curve_rms", "shape_max", "shape_rms")  # of a comparison
OVERLOAD = 1.2  # of the paper's load
STEPS = (10, 20, 50, 200)  # substeps over which the no-sliding rule's dependence is measured


@dataclass(frozen=True)
class CaseEvidence:
    """One case."""

    case: Case
    wire: EquilibriumPath  # the wire model on the paper's mesh
    fine: EquilibriumPath  # the wire model on a finer one
    beam: EquilibriumPath  # the equivalent beam with its exact tangent
    paper: EquilibriumPath  # the equivalent beam with the paper's tangent
    error: Comparison  # the beam against the wire model on the paper's mesh
    mesh_error: Comparison  # Richardson estimate of the error of the paper's mesh

    @property
    def converged_tips(self) -> np.ndarray:
        """Tips of the wire model extrapolated to an infinitely fine mesh, shape (steps, 3)."""
        return self.wire.tips + RICHARDSON * (self.fine.tips - self.wire.tips)

    @property
    def converged_error(self) -> float:
        """Largest difference of the beam's tips from `converged_tips`, over their peak, worst component."""
        tips = self.converged_tips
        return float((np.abs(self.beam.tips - tips) / peaks(tips)).max())


@dataclass(frozen=True)
class WireContact:
    """A case whose wire model has contact of wires in place of the paper's spheres."""

    wire: EquilibriumPath
    error: Comparison  # the beam against it
    sticking: Comparison  # the same where the beam's circles stick


@dataclass(frozen=True)
class Evidence:
    """Everything the report's sentences are computed from."""

    cases: Mapping[str, CaseEvidence]  # by name of the scene
    times: pd.DataFrame  # solution times of the cases (`validation.reproduce.times`)
    frictionless: EquilibriumPath  # wire model of Spring B with sliding contact, as far as it goes
    sticking: Comparison  # equivalent beam of Spring B without sliding, against the wire model
    stepped: Mapping[int, float]  # wire model of Spring B without sliding, UY at full load by substeps
    overloaded: EquilibriumPath  # equivalent beam of Spring B beyond its full load, as far as it goes
    phases: pd.DataFrame  # both models of Spring A at other start phases (`validation.reproduce.phases`)
    by_wires: Mapping[str, WireContact]  # the cases with contact, by name of the scene

    @property
    def overload(self) -> float:
        """Where the overloaded beam ends, in parts of the paper's load."""
        share = self.overloaded.scene.load.force[1] / self.cases["spring-b"].case.scene.load.force[1]
        return share * (self.overloaded.critical_time or 1.0)


def gather(store: PathStore, times: pd.DataFrame) -> Evidence:
    """Collect the evidence; solves what `store` does not hold yet."""
    scene = case("spring-b").scene
    return Evidence(
        cases={item.name: _case(store, item) for item in CASES},
        times=times,
        frictionless=store.partial_wire(frictionless(scene)),
        sticking=compare_paths(store.beam(scene, sliding="scene"), store.wire(scene)),
        stepped={n: float(store.wire(scene, steps=n).tips[-1, 1]) for n in STEPS},
        overloaded=store.partial_beam(overloaded(scene)),
        phases=over_phases(store),
        by_wires={c.name: _by_wires(store, c.scene) for c in CASES if c.scene.contact.enabled},
    )


def frictionless(scene: Scene) -> Scene:
    """The scene with coils that slide on each other."""
    return replace(scene, contact=replace(scene.contact, sliding="free"))


def overloaded(scene: Scene) -> Scene:
    """The scene under a load that is larger by `OVERLOAD`."""
    fx, fy = scene.load.force
    return replace(scene, load=replace(scene.load, force=(OVERLOAD * fx, OVERLOAD * fy)))


def _by_wires(store: PathStore, scene: Scene) -> WireContact:
    wire = store.wire(scene.overridden(geometry="wires"))
    sticking = store.beam(scene, sliding="scene")
    return WireContact(wire, compare_paths(store.beam(scene), wire), compare_paths(sticking, wire))


def _case(store: PathStore, item: Case) -> CaseEvidence:
    scene = item.scene
    wire, fine = store.wire(scene), store.wire(scene, **FINE_MESH)
    beam, mesh = store.beam(scene), compare_paths(wire, fine)
    return CaseEvidence(
        case=item,
        wire=wire,
        fine=fine,
        beam=beam,
        paper=store.beam(scene, tangent="paper"),
        error=compare_paths(beam, wire),
        mesh_error=replace(mesh, **{name: RICHARDSON * getattr(mesh, name) for name in ERRORS}),
    )
