"""Results of a peer on the catalogue's scenes, as committed in ``reports/referee``.

``python -m validation.peers.page opensees`` (or ``calculix``) writes them anew.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pandas as pd

from coilspring import CATALOGUE
from validation.peers.comparison import PeerComparison, compare
from validation.study import template
from validation.study.frames import frame_table
from validation.study.machine import machine, versions
from validation.study.output import write_text

FOLDER = Path("reports", "referee")
TIPS = ("UX, mm", "UY, mm", "ROTZ, rad")
WORDS = template.template(Path(__file__).with_name("page.md"))


def page(code: str, comparisons: dict[str, PeerComparison]) -> str:
    """Markdown page of a peer's results."""
    rows = pd.DataFrame([row for name, found in comparisons.items() for row in _rows(name, found)]).fillna("")
    peer = f", openseespy {versions('openseespy')['openseespy']}" if code == "opensees" else ""
    return template.page(WORDS, code=code, host=machine(), peer_version=peer, table=frame_table(rows))


def _rows(name: str, found: PeerComparison) -> Iterator[dict[str, str]]:
    """Both codes at the last common step."""
    wire, peer, last = found.wire, found.peer, found.rows - 1
    head = {"scene": name, "steps, wirefe": str(len(wire.times)), f"steps, {peer.code}": str(len(peer.times))}
    head["time"] = f"{wire.times[last]:g}"
    for code, tips, seconds, difference in (
        ("wirefe", wire.tips, wire.solve_seconds, ""),
        (peer.code, peer.tips, peer.seconds, f"{100.0 * found.difference:.4f}"),
    ):
        tip = {title: f"{x + 0.0:.4f}" for title, x in zip(TIPS, tips[last], strict=True)}
        row = {**head, "code": code, **tip, "difference of the curves, %": difference}
        yield row | {"CPU, s": f"{seconds:.3g}"}
        head = dict.fromkeys(head, "")


def main(code: str) -> None:
    """Solve the four scenes and write their page and curves."""
    comparisons = {}
    for name, scene in CATALOGUE.items():
        comparisons[name] = compare(scene(), code)
        print(name, *comparisons[name].lines(), sep="\n", flush=True)
        write_text(FOLDER / f"referee-{code}-{name}.csv", comparisons[name].csv())
    write_text(FOLDER / f"referee-{code}.md", page(code, comparisons))


if __name__ == "__main__":
    main(sys.argv[1])
