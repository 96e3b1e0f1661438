"""The facts that the report's sentences are computed from, by name: numbers of the evidence and of the paper.

``reports/paper/facts.json`` keeps them for the findings.
"""

from __future__ import annotations

import numpy as np

from coilspring import EquilibriumPath, Material
from coilspring.solver.newton import DECREMENT
from validation.reproduce.evidence import OVERLOAD, CaseEvidence, Evidence
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
    found: dict[str, object] = {**THRESHOLDS, **_settings(evidence)}
    found |= {f"paper.{c.name}.{model}": getattr(c, f"paper_{model}") for c in CASES for model in models}
    found |= _contact(evidence)
    for item in evidence.cases.values():
        found |= {f"{item.case.name}.{name}": value for name, value in _case(item).items()}
    for row in evidence.times.to_dict("records"):
        found |= {f"{row['case']}.time.{name}": row[column] for name, column in TIMES.items()}
        found |= {f"machine.{name}": str(row[column]) for name, column in MACHINE.items()}
    found |= _limits(evidence) | _bare_b(evidence) | _iterations(evidence) | phase_facts(evidence.phases)
    return found | {f"{BY_WIRES}{name}": value for name, value in _by_wires(evidence).items()}


def _settings(evidence: Evidence) -> dict[str, object]:
    item, material = evidence.cases["spring-a"], Material()
    load, contact = item.case.scene.load, item.case.scene.contact
    pair = item.beam.contact_forces[-1].max() / item.beam.penetrations[-1].max() ** contact.exponent
    return {
        "setting.steps": load.steps,
        "setting.elements": PAPER_MESH["elements_per_turn"],
        "setting.fine_elements": FINE_MESH["elements_per_turn"],
        "setting.pairs": PAPER_MESH["pairs_per_turn"],
        "setting.many_pairs": MANY_PAIRS,
        "setting.stations": evidence.by_wires["spring-a"].wire.options["pairs_per_turn"],
        "setting.decrement": DECREMENT,
        "setting.ends": ENDS,
        **{f"material.{name}": getattr(material, name) for name in ("E", "nu", "G")},
        "contact.stiffness": contact.stiffness,
        "contact.exponent": contact.exponent,
        "contact.beam": float(pair) / contact.stiffness,
        "wire.diameter": item.case.scene.spring.wire_diameter,
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


def _overlaps(path: EquilibriumPath) -> np.ndarray:
    return overlaps(path.circle_centres(-1), path.scene.spring.wire_diameter)


def _contact(evidence: Evidence) -> dict[str, object]:
    """What contact changes of Spring A."""
    bare = _overlaps(evidence.cases["spring-a-no-contact"].wire)
    return {
        "overlap.without": float(bare.max()),
        "overlap.with": float(_overlaps(evidence.cases["spring-a"].wire).max()),
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
    return found | {"overlap.with": float(_overlaps(evidence.by_wires["spring-a"].wire).max())}


def _limits(evidence: Evidence) -> dict[str, object]:
    """Where Spring B's coils slide off each other."""
    path, sticking, over = evidence.frictionless, evidence.cases["spring-b"].wire, evidence.overloaded
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
        "sticking.shape": evidence.sticking.shape_max,
        "sticking.steps": tuple(evidence.stepped),
        "sticking.uy": tuple(evidence.stepped.values()),
    }


def _bare_b(evidence: Evidence) -> dict[str, object]:
    """Spring B without contact: how far UY is from proportional, and what becomes of its coils."""
    item = evidence.cases["spring-b-no-contact"]
    spring, found = item.case.scene.spring, dict[str, object]()
    for model, path in (("wire", item.wire), ("beam", item.beam)):
        uy, heights = path.tips[:, 1], path.circle_centres(-1)[:, 1]
        found[f"linear.{model}"] = float(np.abs(uy - path.times * uy[-1]).max() / abs(uy[-1]))
        found[f"telescope.{model}"] = int(np.count_nonzero(heights[2:] < heights[:-2]))
        found[f"under.{model}"] = spring.active_height + float(uy[-1])
    return found | {
        "telescope.crossings": heights.size - 2,
        "telescope.lowest": float(item.wire.centreline(-1)[:, 1].min()),
        "telescope.bottom": float(spring.height(np.array(spring.phase_range[0]))),
        "under.height": spring.active_height,
    }


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
