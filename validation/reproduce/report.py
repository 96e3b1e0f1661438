"""The report on the reproduction: its tables; its words are in ``report.md``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from validation.reproduce import tables
from validation.reproduce.claims import FUNCTIONS, claim_table
from validation.reproduce.evidence import Evidence
from validation.reproduce.phases import phase_table
from validation.study.cases import PathStore
from validation.study.template import Facts, page, template

REPORT = template(Path(__file__).with_name("report.md"), FUNCTIONS)


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
        "errors": tables.error_table(evidence),
        "exact_rod": tables.exact_table(evidence),
        "phases": phase_table(evidence.phases),
        "table1": tables.table1(),
        "table2": tables.table2(),
        "table3": tables.table3(evidence.times),
        "material": tables.material_table(store),
        "penalty": tables.penalty_table(store),
    }
    return page(REPORT, f=facts, tables=shown, pictured=pictured, notes=notes)
