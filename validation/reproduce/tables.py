"""Tables 1-3 of the paper, with its own numbers beside ours."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd

from coilspring import Scene, spring_a, spring_b
from coilspring.scene.wire import SHEAR_FACTOR
from validation.reproduce.times import ITERATIONS
from validation.study.cases import PAPER_MESH, case
from validation.study.document import Table
from validation.study.frames import view
from validation.study.timing import spread

NOT_GIVEN = ("not given", "not given")
Rows = dict[str, tuple[str, tuple[str, str]]]  # by feature, ours of a scene and the paper's of A and B


def table1() -> Table:
    """Properties of the springs, read from the scenes, beside the paper's; and what the paper leaves out."""
    return _beside_paper(_properties)


def table2() -> Table:
    """The wire model as it was run, beside the paper's FE model."""
    return _beside_paper(_mesh)


def _beside_paper(rows: Callable[[Scene], Rows]) -> Table:
    a, b = rows(spring_a()), rows(spring_b())
    header = ("feature", "spring A", "spring B", "paper A", "paper B")
    return Table(header, tuple((name, ours, b[name][0], *paper) for name, (ours, paper) in a.items()))


def _properties(scene: Scene) -> Rows:
    spring, load, material = scene.spring, scene.load, scene.material
    first, last = spring.phase_range
    low, end, high = spring.height(np.array([first, 0.0, last]))
    bottom, top = (2.0 * spring.radius(np.array([0.0, spring.phase_end]))).tolist()
    rows = {
        "wire diameter (mm)": (spring.wire_diameter, ("1.5", "1.5")),
        "mean bottom coil diameter (mm)": (bottom, ("10", "12")),
        "mean top coil diameter (mm)": (top, ("10", "6")),
        "number of active coils": (spring.active_coils, ("14.5", "7.5")),
        "number of non-active coils": (2.0 * spring.end_turns, ("2", "2")),
        "pitch of non-active coils (mm)": ((end - low) / spring.end_turns, ("1.5", "1.5")),
        "active height of spring (mm)": (spring.active_height, ("28.6", "28.6")),
        "total height of spring (mm)": (high - low, ("31.6", "31.6")),
        "Fx at time 1 (N)": (load.force[0], ("-9", "0")),
        "Fy at time 1 (N)": (load.force[1], ("-4", "-200")),
        "Young's modulus (MPa)": (material.E, NOT_GIVEN),
        "Poisson's ratio": (material.nu, NOT_GIVEN),
        "shear factor of the wire": (SHEAR_FACTOR, NOT_GIVEN),
    }
    return {name: (f"{value:.7g}", paper) for name, (value, paper) in rows.items()}


def _mesh(scene: Scene) -> Rows:
    contact = scene.contact
    sliding = "no sliding" if contact.sliding == "none" else "frictionless"
    held = ["UZ", "ROTX", "ROTY", *(name.upper() for name in scene.supports.top_held)]
    element = f"3D beam, 2 nodes, {PAPER_MESH['element']}, shear-flexible"
    spheres = ("sphere to sphere", "sphere to sphere, no sliding")
    top = ("UZ, ROTX, ROTY", "UZ, ROTX, ROTY, UX, ROTZ")
    return {
        "element type": (element, ("2D Beam", "2D Beam")),
        "elements per turn": (str(PAPER_MESH["elements_per_turn"]), ("40", "40")),
        "contact element": (f"sphere to sphere, {sliding}", spheres),
        "contact elements per turn": (str(PAPER_MESH["pairs_per_turn"]), ("4", "4")),
        "bottom node, constrained": ("ALL", ("ALL", "ALL")),
        "top node, constrained": (", ".join(held), top),
        "contact stiffness of a pair (N/mm^exponent)": (f"{contact.stiffness:g}", NOT_GIVEN),
        "contact exponent": (f"{contact.exponent:g}", NOT_GIVEN),
        "substeps": (str(scene.load.steps), NOT_GIVEN),
    }


def table3(times: pd.DataFrame) -> Table:
    """Solution times for reading: the ratio first, then its parts, medians with quartiles."""
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
                str(getattr(row, name)) for name in ITERATIONS
            ),
            "paper: FE / proposed model (s)": lambda row: (
                f"{row.paper_wire_seconds:g} / {row.paper_beam_seconds:g}"
            ),
        },
    )
