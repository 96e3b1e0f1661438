"""Tables 1-3 of the paper, with its own numbers beside ours."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from coilspring import Scene, spring_a, spring_b
from coilspring.scene.wire import SHEAR_FACTOR
from validation.study.cases import PAPER_MESH
from validation.study.document import Table
from validation.study.timing import Measurement, Timing, spread

BESIDE = ("feature", "spring A", "spring B", "paper A", "paper B")
NOT_GIVEN = ("not given", "not given")


def table1() -> Table:
    """Properties of the springs, read from the scenes, beside the paper's."""
    a, b = _properties(spring_a()), _properties(spring_b())
    paper = {
        "wire diameter (mm)": ("1.5", "1.5"),
        "mean bottom coil diameter (mm)": ("10", "12"),
        "mean top coil diameter (mm)": ("10", "6"),
        "number of active coils": ("14.5", "7.5"),
        "number of non-active coils": ("2", "2"),
        "pitch of non-active coils (mm)": ("1.5", "1.5"),
        "active height of spring (mm)": ("28.6", "28.6"),
        "total height of spring (mm)": ("31.6", "31.6"),
        "Fx at time 1 (N)": ("-9", "0"),
        "Fy at time 1 (N)": ("-4", "-200"),
    }
    return Table(BESIDE, tuple((name, a[name], b[name], *paper.get(name, NOT_GIVEN)) for name in a))


def _properties(scene: Scene) -> dict[str, str]:
    """What Table 1 lists, and what it leaves out."""
    spring = scene.spring
    first, last = spring.phase_range
    low, end, high = spring.height(np.array([first, 0.0, last]))
    bottom, top = (2.0 * spring.radius(np.array([0.0, spring.phase_end]))).tolist()
    values = {
        "wire diameter (mm)": spring.wire_diameter,
        "mean bottom coil diameter (mm)": bottom,
        "mean top coil diameter (mm)": top,
        "number of active coils": spring.active_coils,
        "number of non-active coils": 2.0 * spring.end_turns,
        "pitch of non-active coils (mm)": (end - low) / spring.end_turns,
        "active height of spring (mm)": spring.active_height,
        "total height of spring (mm)": high - low,
        "Fx at time 1 (N)": scene.load.force[0],
        "Fy at time 1 (N)": scene.load.force[1],
        "Young's modulus (MPa)": scene.material.E,
        "Poisson's ratio": scene.material.nu,
        "shear factor of the wire": SHEAR_FACTOR,
    }
    return {name: f"{value:.7g}" for name, value in values.items()}


def table2() -> Table:
    """The wire model as it was run, beside the paper's FE model."""
    a, b = _mesh(spring_a()), _mesh(spring_b())
    paper = {
        "element type": ("2D Beam", "2D Beam"),
        "elements per turn": ("40", "40"),
        "contact element": ("sphere to sphere", "sphere to sphere, no sliding"),
        "contact elements per turn": ("4", "4"),
        "bottom node, constrained": ("ALL", "ALL"),
        "top node, constrained": ("UZ, ROTX, ROTY", "UZ, ROTX, ROTY, UX, ROTZ"),
    }
    return Table(BESIDE, tuple((name, a[name], b[name], *paper.get(name, NOT_GIVEN)) for name in a))


def _mesh(scene: Scene) -> dict[str, str]:
    contact = scene.contact
    sliding = ", no sliding" if contact.sliding == "none" else ", frictionless"
    held = ["UZ", "ROTX", "ROTY", *(name.upper() for name in scene.supports.top_held)]
    return {
        "element type": f"3D beam, 2 nodes, {PAPER_MESH['element']}, shear-flexible",
        "elements per turn": str(PAPER_MESH["elements_per_turn"]),
        "contact element": f"sphere to sphere{sliding}",
        "contact elements per turn": str(PAPER_MESH["pairs_per_turn"]),
        "bottom node, constrained": "ALL",
        "top node, constrained": ", ".join(held),
        "contact stiffness of a pair (N/mm^exponent)": f"{contact.stiffness:g}",
        "contact exponent": f"{contact.exponent:g}",
        "substeps": str(scene.load.steps),
    }


def table3(timings: Sequence[Timing]) -> Table:
    """Solution times for reading: the ratio first, then its parts, medians with quartiles."""
    header = (
        "case",
        "wire model / beam",
        "reduction (%)",
        "paper's reduction (%)",
        "wire model (ms)",
        "beam (ms)",
        "beam, paper's tangent (ms)",
        "iterations: wire model / beam / beam, paper's tangent",
        "paper: FE / proposed model (s)",
    )
    return Table(header, tuple(_times(item) for item in timings))


def _times(timing: Timing) -> tuple[str, ...]:
    case = timing.case
    return (
        case.title,
        spread(timing.ratio, 1.0),
        f"{timing.reduction:.1f}",
        f"{case.paper_reduction:g}",
        spread(timing.wire, 1e3),
        spread(timing.beam, 1e3),
        spread(timing.beam_paper, 1e3),
        " / ".join(str(count) for count in timing.iterations),
        f"{case.paper_wire:g} / {case.paper_beam:g}",
    )


def table3_data(measured: Measurement) -> Table:
    """The same for machines: one number a cell, seconds; q1 and q3 are the quartiles."""
    spreads = ("ratio", "wire_seconds", "beam_seconds", "beam_paper_tangent_seconds")
    header = ["case", "reduction_percent", "paper_reduction_percent"]
    header += [f"{name}{part}" for name in spreads for part in ("", "_q1", "_q3")]
    header += ["wire_iterations", "beam_iterations", "beam_paper_tangent_iterations", "rounds"]
    header += ["paper_wire_seconds", "paper_beam_seconds", "measured", "processor"]
    origin = (measured.machine["date"], measured.machine["processor"])
    rows = []
    for item in measured.timings:
        case = item.case
        numbers: list[float] = [item.reduction, case.paper_reduction]
        for value in (item.ratio, item.wire, item.beam, item.beam_paper):
            numbers += [value.median, value.low, value.high]
        numbers += [*item.iterations, item.rounds, case.paper_wire, case.paper_beam]
        rows.append((case.name, *(f"{number:.6g}" for number in numbers), *origin))
    return Table(tuple(header), tuple(rows))
