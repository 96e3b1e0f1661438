"""The report on the reproduction: its tables; its words are in ``report.md``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from validation.reproduce import assumptions, tables
from validation.reproduce.claims import FUNCTIONS, claim_table, curves
from validation.reproduce.evidence import CaseEvidence, Evidence
from validation.reproduce.phases import phase_table
from validation.study.cases import PathStore
from validation.study.document import Table
from validation.study.scenes import EXACT_ROD
from validation.study.template import Facts, page, template


def compose(evidence: Evidence, facts: Facts, store: PathStore, pictured: bool, notes: Sequence[str]) -> str:
    """The report as Markdown.

    Parameters
    ----------
    evidence : what the tables show.
    facts : what the sentences are computed from.
    store : of the paths behind the tables of assumptions.
    pictured : whether the PNG files of all figures stand beside the report.
    notes : what did not go as planned, one sentence each.
    """
    shown = {
        "claims": claim_table(facts),
        "errors": error_table(evidence),
        "exact_rod": exact_table(evidence),
        "phases": phase_table(evidence.phases),
        "table1": tables.table1(),
        "table2": tables.table2(),
        "table3": tables.table3(evidence.times),
        "material": assumptions.material_table(store),
        "penalty": assumptions.penalty_table(store),
    }
    return page(REPORT, f=facts, tables=shown, pictured=pictured, notes=notes)


def error_table(evidence: Evidence) -> Table:
    """The models' differences and the mesh's own, a row for each case."""
    rows = []
    for item in evidence.cases.values():
        cells = [item.case.title]
        for error in (item.error, item.mesh_error):
            cells.append(f"{100.0 * error.curve_max:.2f} / {100.0 * error.curve_rms:.2f}")
            cells.append(f"{error.shape_max:.3f} / {error.shape_rms:.3f}")
        rows.append((*cells, f"{100.0 * item.converged_error:.2f}"))
    header = (
        *("case", "beam against wire model: curve max / rms (%)", "shape max / rms (mm)"),
        *("wire mesh's own error: curve max / rms (%)", "shape max / rms (mm)"),
        "beam against mesh-converged wire model: curve max (%)",
    )
    return Table(header, tuple(rows))


def exact_table(evidence: Evidence) -> Table:
    """Both models' tips against the exact rod's, where there is one."""
    header = ("case", "tip at full load", "exact rod", "wire model", "error (%)", "beam", "error (%)")
    return Table(header, tuple(row for item in evidence.cases.values() for row in _exact_rows(item)))


def _exact_rows(item: CaseEvidence) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    exact = EXACT_ROD.get(item.case.name, {}).get(1.0, ())
    names = ("UX (mm)", "UY (mm)", "ROTZ (rad)")
    for name, value, *tips in zip(names, exact, item.wire.tips[-1], item.beam.tips[-1], strict=False):
        if value:
            errors = [(f"{tip:.4f}", f"{100.0 * (tip / value - 1.0):+.2f}") for tip in tips]
            rows.append((item.case.title, name, f"{value:.4f}", *errors[0], *errors[1]))
    return rows


def far_off(f: Facts) -> str:
    """The cases in which the models do not match."""
    far = (f"{name}.title" for name, value in curves(f).items() if value >= f["threshold.match"])
    return ", ".join(f[title] for title in far)


def nearest_phases(f: Facts) -> list[int]:
    """The two start phases at which the models are nearest, degrees."""
    ranked = sorted(zip(f["phases.few.difference"], f["phases.few.degrees"], strict=True))
    return sorted(angle for _, angle in ranked[:2])


REPORT = template(Path(__file__).with_name("report.md"), (*FUNCTIONS, far_off, nearest_phases))
