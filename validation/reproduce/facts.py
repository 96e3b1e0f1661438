"""The facts that the report's sentences are computed from, by name: numbers of the evidence and of the paper.

``reports/paper/facts.json`` keeps them for the findings.
"""

from __future__ import annotations

import numpy as np

from coilspring import EquilibriumPath, Material
from coilspring.solver.newton import DECREMENT
from validation.reproduce.evidence import CaseEvidence, Evidence
from validation.reproduce.phases import MANY_PAIRS, phase_facts
from validation.study.cases import CASES, FINE_MESH, PAPER_MESH
from validation.view.shapes import overlaps

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


def facts(evidence: Evidence) -> dict[str, object]:
    """All facts, of types that JSON has."""
    models = ("wire", "beam")  # the paper's Table 3, s
    paper = {f"paper.{c.name}.{model}": getattr(c, f"paper_{model}") for c in CASES for model in models}
    found: dict[str, object] = {**THRESHOLDS, **_settings(evidence), **paper, **_contact(evidence)}
    for item in evidence.cases.values():
        found |= {f"{item.case.name}.{name}": value for name, value in _case(item).items()}
    for row in evidence.times.to_dict("records"):
        found |= {f"{row['case']}.time.{name}": row[column] for name, column in TIMES.items()}
        found |= {f"machine.{name}": str(row[column]) for name, column in MACHINE.items()}
    found |= _limits(evidence) | _bare_b(evidence) | _iterations(evidence) | phase_facts(evidence.phases)
    return found | {f"{BY_WIRES}{name}": value for name, value in _by_wires(evidence).items()}


def _settings(evidence: Evidence) -> dict[str, object]:
    scene = evidence.cases["spring-a"].case.scene
    beam = evidence.cases["spring-a"].beam
    pair = beam.contact_forces[-1].max() / beam.penetrations[-1].max() ** scene.contact.exponent
    material = Material()
    return {
        "setting.steps": scene.load.steps,
        "setting.elements": PAPER_MESH["elements_per_turn"],
        "setting.fine_elements": FINE_MESH["elements_per_turn"],
        "setting.pairs": PAPER_MESH["pairs_per_turn"],
        "setting.many_pairs": MANY_PAIRS,
        "setting.stations": evidence.by_wires["spring-a"].wire.options["pairs_per_turn"],
        "setting.decrement": DECREMENT,
        "setting.ends": ENDS,
        "material.E": material.E,
        "material.nu": material.nu,
        "material.G": material.G,
        "contact.stiffness": scene.contact.stiffness,
        "contact.exponent": scene.contact.exponent,
        "contact.beam": float(pair) / scene.contact.stiffness,
        "wire.diameter": scene.spring.wire_diameter,
        "timing.rounds": int(evidence.times["rounds"].min()),
    }


def _case(item: CaseEvidence) -> dict[str, object]:
    return {
        "title": item.case.title,
        "curve": item.error.curve_max,
        "shape": item.error.shape_max,
        "mesh": item.mesh_error.curve_max,
        "wire": tuple(item.wire.tips[-1].tolist()),
        "beam": tuple(item.beam.tips[-1].tolist()),
        "iterations": item.beam.total_iterations,
        "paper_iterations": item.paper.total_iterations,
    }


def _contact(evidence: Evidence) -> dict[str, object]:
    """What contact changes of Spring A."""
    with_contact, without = (evidence.cases[name] for name in ("spring-a", "spring-a-no-contact"))
    diameter = with_contact.case.scene.spring.wire_diameter
    bare, touching = (overlaps(item.wire.circle_centres(-1), diameter) for item in (without, with_contact))
    return {
        "overlap.without": float(bare.max()),
        "overlap.with": float(touching.max()),
        "overlap.pair": int(np.argmax(bare)),
        "overlap.pairs": int(bare.size),
    }


def _by_wires(evidence: Evidence) -> dict[str, object]:
    """What other facts are with contact of wires."""
    found: dict[str, object] = {"sticking.shape": evidence.by_wires["spring-b"].sticking.shape_max}
    for name, item in evidence.by_wires.items():
        found[f"{name}.curve"] = item.error.curve_max
        found[f"{name}.shape"] = item.error.shape_max
        found[f"{name}.wire"] = tuple(item.wire.tips[-1].tolist())
    path = evidence.by_wires["spring-a"].wire
    overlap = overlaps(path.circle_centres(-1), path.scene.spring.wire_diameter)
    return found | {"overlap.with": float(overlap.max())}


def _limits(evidence: Evidence) -> dict[str, object]:
    """Where Spring B's coils slide off each other."""
    path, sticking = evidence.frictionless, evidence.cases["spring-b"].wire
    return {
        "limit.outcome": path.outcome.replace("_", " "),
        "limit.time": path.critical_time,
        "limit.load": abs(path.scene.load.force[1]),
        "limit.last": float(path.times[-1]),
        "limit.uy": float(path.tips[-1, 1]),
        "limit.closed": int(path.active_contacts[-1]),
        "limit.difference": float(abs(path.tips[-1, 1] - sticking.tips[len(path.times) - 1, 1])),
        "limit.beam": evidence.overload if evidence.overloaded.critical_time is not None else None,
        "limit.beam_outcome": evidence.overloaded.outcome.replace("_", " "),
        "sticking.shape": evidence.sticking.shape_max,
        "sticking.steps": tuple(evidence.stepped),
        "sticking.uy": tuple(evidence.stepped.values()),
    }


def _bare_b(evidence: Evidence) -> dict[str, object]:
    """Spring B without contact: linearity, and what becomes of its coils."""
    item = evidence.cases["spring-b-no-contact"]
    spring, paths = item.case.scene.spring, (item.wire, item.beam)
    heights = [path.circle_centres(-1)[:, 1] for path in paths]
    crossed = [int(np.count_nonzero(height[2:] < height[:-2])) for height in heights]
    return {
        "linear.wire": _curvature(item.wire),
        "linear.beam": _curvature(item.beam),
        "telescope.wire": crossed[0],
        "telescope.beam": crossed[1],
        "telescope.crossings": heights[0].size - 2,
        "telescope.lowest": float(item.wire.centreline(-1)[:, 1].min()),
        "telescope.bottom": float(spring.height(np.array(spring.phase_range[0]))),
        "under.wire": spring.active_height + float(item.wire.tips[-1, 1]),
        "under.beam": spring.active_height + float(item.beam.tips[-1, 1]),
        "under.height": spring.active_height,
    }


def _curvature(path: EquilibriumPath) -> float:
    """Largest deviation of UY from proportionality, over its last value."""
    values = path.tips[:, 1]
    return float(np.abs(values - path.times * values[-1]).max() / abs(values[-1]))


def _iterations(evidence: Evidence) -> dict[str, object]:
    """Figure 8."""
    a, b = evidence.cases["spring-a"], evidence.cases["spring-b"]
    closed = b.paper.active_contacts > 0
    first = int(np.argmax(closed)) if closed.any() else closed.size
    found: dict[str, object] = {
        "first.time": float(b.paper.times[first]) if first < closed.size else 1.0,
        "first.most": int(b.paper.iterations[1:first].max()),
        "first.start": int(b.paper.iterations[0]),
        "first.exact": int(b.beam.iterations[:first].sum()),
    }
    for name, path in (("paper", a.paper), ("exact", a.beam)):
        found[f"growth.{name}.begin"] = float(path.iterations[:ENDS].mean())
        found[f"growth.{name}.end"] = float(path.iterations[-ENDS:].mean())
    return found
