"""Tables 1-3 of the paper, with its own numbers beside ours."""

from __future__ import annotations

import numpy as np
import pandas as pd

from coilspring import Scene, spring_a, spring_b
from coilspring.scene.wire import SHEAR_FACTOR
from validation.study.cases import PAPER_MESH, case
from validation.study.document import Table
from validation.study.frames import view
from validation.study.timing import spread

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


def table3(times: pd.DataFrame) -> Table:
    """Solution times for reading: the ratio first, then its parts, medians with quartiles."""
    counts = [f"{part}_iterations" for part in ("wire", "beam", "beam_paper_tangent")]
    return view(
        times,
        {
            "case": lambda row: case(row.case).title,
            "wire model / beam": lambda row: spread(row, "ratio"),
            "reduction (%)": lambda row: f"{row.reduction_percent:.1f}",
            "paper's reduction (%)": lambda row: f"{row.paper_reduction_percent:g}",
            "wire model (ms)": lambda row: spread(row, "wire_seconds", 1e3),
            "beam (ms)": lambda row: spread(row, "beam_seconds", 1e3),
            "beam, paper's tangent (ms)": lambda row: spread(row, "beam_paper_tangent_seconds", 1e3),
            "iterations: wire model / beam / beam, paper's tangent": lambda row: " / ".join(
                str(getattr(row, name)) for name in counts
            ),
            "paper: FE / proposed model (s)": lambda row: (
                f"{row.paper_wire_seconds:g} / {row.paper_beam_seconds:g}"
            ),
        },
    )
