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
    def converged_error(self) -> float:
        """Largest difference of the beam's tips from the wire's on an infinitely fine mesh, over the peak."""
        tips = self.wire.tips + RICHARDSON * (self.fine.tips - self.wire.tips)
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
    overloaded: EquilibriumPath  # equivalent beam of Spring B under `OVERLOAD`, as far as it goes
    phases: pd.DataFrame  # both models of Spring A at other start phases (`validation.reproduce.phases`)
    by_wires: Mapping[str, WireContact]  # the cases with contact, by name of the scene


def gather(store: PathStore, times: pd.DataFrame) -> Evidence:
    """Collect the evidence; solves what `store` does not hold yet."""
    scene = case("spring-b").scene
    fx, fy = scene.load.force
    overload = replace(scene.load, force=(OVERLOAD * fx, OVERLOAD * fy))
    return Evidence(
        cases={item.name: _case(store, item) for item in CASES},
        times=times,
        frictionless=store.partial_wire(frictionless(scene)),
        sticking=compare_paths(store.beam(scene, sliding="scene"), store.wire(scene)),
        stepped={n: float(store.wire(scene, steps=n).tips[-1, 1]) for n in STEPS},
        overloaded=store.partial_beam(replace(scene, load=overload)),
        phases=over_phases(store),
        by_wires={c.name: _by_wires(store, c.scene) for c in CASES if c.scene.contact.enabled},
    )


def frictionless(scene: Scene) -> Scene:
    """The scene with coils that slide on each other."""
    return replace(scene, contact=replace(scene.contact, sliding="free"))


def _by_wires(store: PathStore, scene: Scene) -> WireContact:
    wire = store.wire(scene.overridden(geometry="wires"))
    sticking = store.beam(scene, sliding="scene")
    return WireContact(wire, compare_paths(store.beam(scene), wire), compare_paths(sticking, wire))


def _case(store: PathStore, item: Case) -> CaseEvidence:
    wire, fine = store.wire(item.scene), store.wire(item.scene, **FINE_MESH)
    beam, paper = store.beam(item.scene), store.beam(item.scene, tangent="paper")
    mesh = compare_paths(wire, fine)
    mesh = replace(mesh, **{name: RICHARDSON * getattr(mesh, name) for name in ERRORS})
    return CaseEvidence(item, wire, fine, beam, paper, compare_paths(beam, wire), mesh)
