"""The report and its tables: Tables 1-3 of the paper, deviations, what was assumed; words: ``report.md``."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from coilspring import EquilibriumPath, Material, Scene, spring_a, spring_b
from coilspring.curves import compare_paths
from coilspring.scene.wire import SHEAR_FACTOR
from validation.reproduce.claims import FUNCTIONS, claim_table
from validation.reproduce.facts import converged_error, mesh_error
from validation.reproduce.phases import phase_table
from validation.reproduce.times import ITERATIONS
from validation.study.cases import CASES, EXACT_ROD, PAPER_MESH, case
from validation.study.frames import view
from validation.study.partialsolve import ending
from validation.study.paths import PathStore
from validation.study.style import TIP_LABELS
from validation.study.tables import Table
from validation.study.template import Facts, page, template
from validation.study.timing import spread

REPORT = template(Path(__file__).with_name("report.md"), FUNCTIONS)
MODULUS_CHANGES = (0.95, 1.05)
POISSON_RATIOS = (0.28, 0.32)
PENALTY_FACTORS = (0.1, 1.0, 10.0)
NOT_GIVEN = ("not given", "not given")
Rows = dict[str, tuple[str, tuple[str, str]]]  # by feature, ours of a scene and the paper's of A and B


def compose(
    facts: Facts,
    store: PathStore,
    times: pd.DataFrame,
    phases: pd.DataFrame,
    pictured: bool,
    warnings: Sequence[str],
) -> str:
    """The report as Markdown: sentences of the facts, tables of the paths, the times and the start phases.

    `pictured`: whether the PNG files of all figures stand beside it; `warnings`: what did not go as planned.
    """
    shown = {
        "claims": claim_table(facts),
        "errors": error_table(store),
        "exact_rod": exact_table(store),
        "phases": phase_table(phases),
        "table1": table1(),
        "table2": table2(),
        "table3": table3(times),
        "material": material_table(store),
        "penalty": penalty_table(store),
    }
    return page(REPORT, f=facts, tables=shown, pictured=pictured, warnings=warnings)


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
            "paper: FE / proposed model (s)": "{0.paper_wire_seconds:g} / {0.paper_beam_seconds:g}".format,
        },
    )


def error_table(store: PathStore) -> Table:
    """The models' differences and the mesh's own, a row for each case."""
    header = (
        *("case", "beam against wire model: curve max / rms (%)", "shape max / rms (mm)"),
        *("wire mesh's own error: curve max / rms (%)", "shape max / rms (mm)"),
        "beam against mesh-converged wire model: curve max (%)",
    )
    rows = []
    for item in CASES:
        cells, scene = [item.title], item.scene
        for error in (compare_paths(store.beam(scene), store.wire(scene)), mesh_error(store, scene)):
            cells.append(f"{100.0 * error.curve_max:.2f} / {100.0 * error.curve_rms:.2f}")
            cells.append(f"{error.shape_max:.3f} / {error.shape_rms:.3f}")
        rows.append((*cells, f"{100.0 * converged_error(store, scene):.2f}"))
    return Table(header, tuple(rows))


def exact_table(store: PathStore) -> Table:
    """Both models' tips against the exact rod's, where there is one."""
    header = ("case", "tip at full load", "exact rod", "wire model", "error (%)", "beam", "error (%)")
    rows = []
    for name, tips in EXACT_ROD.items():
        paths = store.wire(case(name).scene), store.beam(case(name).scene)
        found = zip(TIP_LABELS, tips[1.0], *(path.tips[-1] for path in paths), strict=True)
        for title, exact, *ours in (row for row in found if row[1]):
            cells = [text for tip in ours for text in (f"{tip:.4f}", f"{100.0 * (tip / exact - 1.0):+.2f}")]
            rows.append((case(name).title, title, f"{exact:.4f}", *cells))
    return Table(header, tuple(rows))


def material_table(store: PathStore) -> Table:
    """Tip displacements of the equivalent beam for other materials, against the default's."""
    E, nu = Material().E, Material().nu
    materials = {f"E {100.0 * (share - 1.0):+.0f} %": Material(E * share, nu) for share in MODULUS_CHANGES}
    materials |= {f"nu = {other:g}": Material(E, other) for other in POISSON_RATIOS}
    rows = []
    for item in CASES:
        base = store.beam(item.scene)
        paths = [store.partial_beam(replace(item.scene, material=other)) for other in materials.values()]
        rows.append((item.title, *(_change(path, base) for path in paths)))
    return Table(("change of UX / UY at full load (%)", *materials), tuple(rows))


def penalty_table(store: PathStore) -> Table:
    """Tips and penetration of both models for softer and harder contact."""
    header = ("case", "model", "K (N/mm)", "UY (mm)", "change of UX / UY (%)", "largest penetration (µm)")
    rows = []
    for item in CASES[::2]:  # with contact
        for model, solve in (("beam", store.partial_beam), ("wire model", store.partial_wire)):
            base = solve(item.scene)
            for factor in PENALTY_FACTORS:
                penalty = factor * item.scene.contact.stiffness
                path = solve(item.scene.with_penalty(penalty))
                uy, depth = f"{path.tips[-1, 1]:.3f}", f"{1e3 * path.max_penetration[-1]:.2g}"
                if path.outcome != "completed":
                    uy = depth = ""
                rows.append((item.title, model, f"{penalty:g}", uy, _change(path, base), depth))
    return Table(header, tuple(rows))


def _change(path: EquilibriumPath, base: EquilibriumPath) -> str:
    """Change of UX and UY at full load in %, a held UX left out; or how and when the path ended."""
    if path.outcome != "completed":
        return ending(path.outcome, path.critical_time)
    pairs = zip(path.tips[-1, :2], base.tips[-1, :2], strict=True)
    return " / ".join(f"{100.0 * (new / old - 1.0):+.2f}" for new, old in pairs if old)
