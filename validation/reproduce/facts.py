"""The facts that the report's sentences are computed from, by name: numbers of the paths and of the paper.

Paths of both models, their differences, the mesh's own error and the times are the evidence.
``reports/paper/facts.json`` keeps the facts for the findings.
"""

from dataclasses import replace

import numpy as np
import pandas as pd

from coilspring import EquilibriumPath, Material, Scene
from coilspring.curves import Comparison, compare_paths, over_peak
from coilspring.solver.equilibrium.newton import DECREMENT
from validation.reproduce.phases import MANY_PAIRS, phase_facts
from validation.study.cases import CASES, FINE_MESH, PAPER_MESH, PaperCase, case
from validation.study.paths import PathStore
from validation.view.shapes import overlaps

# Richardson: an error that falls with the square of the element length is this multiple of the
# difference to the finer mesh
_REFINED = FINE_MESH["elements_per_turn"] / PAPER_MESH["elements_per_turn"]
RICHARDSON = _REFINED**2 / (_REFINED**2 - 1.0)
ERRORS = ("curve_max", "curve_rms", "shape_max", "shape_rms")  # of a comparison
OVERLOAD = 1.2  # of the paper's load
STEPS = (10, 20, 50, 200)  # substeps over which the no-sliding rule's dependence is measured
A, B, BARE_A, BARE_B = (case(f"spring-{name}").scene for name in ("a", "b", "a-no-contact", "b-no-contact"))
WIRES_A, WIRES_B = (scene.overridden(geometry="wires") for scene in (A, B))  # in place of spheres
# what the paper's words are taken to mean
THRESHOLDS = {
    "threshold.match": 0.05,  # of the peak: as much as 5 % in the modulus, which the paper does not give
    "threshold.superimposed": 0.1,  # wire diameters between circles that a picture does not tell apart
    "threshold.overlap": 0.1,  # wire diameters that run into each other
    "threshold.low": 0.25,  # of the coils: the bottom ones
    "threshold.expensive": 60.0,  # s
    "threshold.cheap": 0.1,  # of the wire model's time: a small part
    "threshold.little": 1.25,  # "little affecting": a factor below
    "threshold.not_little": 1.75,  # and what is not little
    "threshold.doubled": (1.5, 2.5),  # "almost doubles"
    "threshold.great": 2.0,  # "a great difference", "a growing number": at least this factor
    "threshold.sixth": 6.0,  # "less than 1/6"
    "threshold.twentieth": (15.5, 25.0),  # "about 1/20"
}
# facts of the solution times by their columns
TIMES = {
    **{"wire": "wire_seconds", "beam": "beam_seconds", "beam_paper": "beam_paper_tangent_seconds"},
    **{"ratio": "ratio", "ratio_low": "ratio_q1", "ratio_high": "ratio_q3"},
}
MACHINE = {"date": "measured", **{name: name for name in ("processor", "cores", "system", "versions")}}
BY_WIRES = "wires."  # before the name of a fact that is another one with contact of wires
ENDS = 10  # substeps at the beginning and the end, whose iterations are compared


def facts(store: PathStore, times: pd.DataFrame, phases: pd.DataFrame) -> dict[str, object]:
    """All facts, of types that JSON has; solves what `store` does not hold yet.

    Parameters
    ----------
    times : solution times of the cases (`validation.reproduce.times`).
    phases : Spring A at other start phases (`validation.reproduce.phases`).
    """
    models = ("wire", "beam")  # the paper's Table 3, s
    found: dict[str, object] = {**THRESHOLDS, **_settings(store)}
    found["timing.rounds"] = int(times["rounds"].min())
    found |= {f"paper.{c.name}.{model}": getattr(c, f"paper_{model}") for c in CASES for model in models}
    found |= _contact(store)
    for item in CASES:
        found |= {f"{item.name}.{name}": value for name, value in _case(store, item).items()}
    for row in times.to_dict("records"):
        found |= {f"{row['case']}.time.{name}": row[column] for name, column in TIMES.items()}
        found |= {f"machine.{name}": str(row[column]) for name, column in MACHINE.items()}
    found |= _limits(store) | _bare_b(store) | _iterations(store) | phase_facts(phases)
    return found | {f"{BY_WIRES}{name}": value for name, value in _by_wires(store).items()}


def frictionless(scene: Scene) -> Scene:
    """The scene with coils that slide on each other."""
    return replace(scene, contact=replace(scene.contact, sliding="free"))


def mesh_error(store: PathStore, scene: Scene) -> Comparison:
    """Richardson estimate of the error of the paper's mesh."""
    found = compare_paths(store.wire(scene), store.wire(scene, **FINE_MESH))
    return replace(found, **{name: RICHARDSON * getattr(found, name) for name in ERRORS})


def converged_error(store: PathStore, scene: Scene) -> float:
    """Largest difference of the beam's tips from the wire's on an infinitely fine mesh, over the peak."""
    coarse, fine = store.wire(scene).tips, store.wire(scene, **FINE_MESH).tips
    tips = coarse + RICHARDSON * (fine - coarse)
    return float(np.nanmax(np.abs(over_peak(store.beam(scene).tips, tips))))


def _settings(store: PathStore) -> dict[str, object]:
    beam, material, contact = store.beam(A), Material(), A.contact
    pair = beam.contact_forces[-1].max() / beam.penetrations[-1].max() ** contact.exponent
    return {
        "setting.steps": A.load.steps,
        "setting.elements": PAPER_MESH["elements_per_turn"],
        "setting.fine_elements": FINE_MESH["elements_per_turn"],
        "setting.pairs": PAPER_MESH["pairs_per_turn"],
        "setting.many_pairs": MANY_PAIRS,
        "setting.stations": store.wire(WIRES_A).options["pairs_per_turn"],
        "setting.decrement": DECREMENT,
        "setting.ends": ENDS,
        **{f"material.{name}": getattr(material, name) for name in ("E", "nu", "G")},
        "contact.stiffness": contact.stiffness,
        "contact.exponent": contact.exponent,
        "contact.beam": float(pair) / contact.stiffness,
        "wire.diameter": A.spring.wire_diameter,
    }


def _case(store: PathStore, item: PaperCase) -> dict[str, object]:
    wire, beam = store.wire(item.scene), store.beam(item.scene)
    error = compare_paths(beam, wire)
    return {
        "title": item.title,
        "curve": error.curve_max,
        "shape": error.shape_max,
        "mesh": mesh_error(store, item.scene).curve_max,
        "wire": tuple(wire.tips[-1].tolist()),
        "beam": tuple(beam.tips[-1].tolist()),
        "iterations": beam.total_iterations,
        "paper_iterations": store.beam(item.scene, tangent="paper").total_iterations,
    }


def _overlaps(path: EquilibriumPath) -> np.ndarray:
    return overlaps(path.circle_centres(-1), path.scene.spring.wire_diameter)


def _contact(store: PathStore) -> dict[str, object]:
    """What contact changes of Spring A."""
    bare = _overlaps(store.wire(BARE_A))
    return {
        "overlap.without": float(bare.max()),
        "overlap.with": float(_overlaps(store.wire(A)).max()),
        "overlap.pair": int(np.argmax(bare)),
        "overlap.pairs": int(bare.size),
    }


def _by_wires(store: PathStore) -> dict[str, object]:
    """What other facts are with contact of wires."""
    sticking = compare_paths(store.beam(B, sliding="scene"), store.wire(WIRES_B))
    found: dict[str, object] = {"sticking.shape": sticking.shape_max}
    for scene, by_wires in ((A, WIRES_A), (B, WIRES_B)):
        wire = store.wire(by_wires)
        error = compare_paths(store.beam(scene), wire)
        found[f"{scene.name}.curve"] = error.curve_max
        found[f"{scene.name}.shape"] = error.shape_max
        found[f"{scene.name}.wire"] = tuple(wire.tips[-1].tolist())
    return found | {"overlap.with": float(_overlaps(store.wire(WIRES_A)).max())}


def _limits(store: PathStore) -> dict[str, object]:
    """Where Spring B's coils slide off each other."""
    path, sticking = store.partial_wire(frictionless(B)), store.wire(B)
    fx, fy = B.load.force
    more = replace(B.load, force=(OVERLOAD * fx, OVERLOAD * fy))
    over = store.partial_beam(replace(B, load=more))
    return {
        "limit.outcome": path.outcome.replace("_", " "),
        "limit.time": path.critical_time,
        "limit.load": abs(path.scene.load.force[1]),
        "limit.last": float(path.times[-1]),
        "limit.uy": float(path.tips[-1, 1]),
        "limit.closed": int(path.active_contacts[-1]),
        "limit.difference": float(abs(path.tips[-1, 1] - sticking.tips[len(path.times) - 1, 1])),
        "limit.beam": None if over.critical_time is None else OVERLOAD * over.critical_time,
        "limit.beam_outcome": over.outcome.replace("_", " "),
        "sticking.shape": compare_paths(store.beam(B, sliding="scene"), sticking).shape_max,
        "sticking.steps": STEPS,
        "sticking.uy": tuple(float(store.wire(B, steps=n).tips[-1, 1]) for n in STEPS),
    }


def _bare_b(store: PathStore) -> dict[str, object]:
    """Spring B without contact: how far UY is from proportional, and what becomes of its coils."""
    spring, found = BARE_B.spring, dict[str, object]()
    for model, path in (("wire", store.wire(BARE_B)), ("beam", store.beam(BARE_B))):
        uy, heights = path.tips[:, 1], path.circle_centres(-1)[:, 1]
        found[f"linear.{model}"] = float(np.abs(uy - path.times * uy[-1]).max() / abs(uy[-1]))
        found[f"telescope.{model}"] = int(np.count_nonzero(heights[2:] < heights[:-2]))
        found[f"under.{model}"] = spring.active_height + float(uy[-1])
    return found | {
        "telescope.crossings": heights.size - 2,
        "telescope.lowest": float(store.wire(BARE_B).centreline(-1)[:, 1].min()),
        "telescope.bottom": float(spring.height(np.array(spring.phase_range[0]))),
        "under.height": spring.active_height,
    }


def _iterations(store: PathStore) -> dict[str, object]:
    """Figure 8."""
    paper, exact = store.beam(B, tangent="paper"), store.beam(B)
    closed = paper.active_contacts > 0
    first = int(np.argmax(closed)) if closed.any() else closed.size
    found: dict[str, object] = {
        "first.time": float(paper.times[first]) if first < closed.size else 1.0,
        "first.most": int(paper.iterations[1:first].max()),
        "first.start": int(paper.iterations[0]),
        "first.exact": int(exact.iterations[:first].sum()),
    }
    for tangent in ("paper", "exact"):
        counts = store.beam(A, tangent=tangent).iterations
        found[f"growth.{tangent}.begin"] = float(counts[:ENDS].mean())
        found[f"growth.{tangent}.end"] = float(counts[-ENDS:].mean())
    return found
