"""Results of a peer on the catalogue's scenes, as committed in ``reports/referee``.

``python -m validation.peers.page opensees`` (or ``calculix``) writes them anew.
"""

import sys
from pathlib import Path

import numpy as np

from coilspring import CATALOGUE
from validation.peers.comparison import PeerComparison, compare
from validation.study import template
from validation.study.files import write_bytes, write_text
from validation.study.machine import machine, versions

FOLDER = Path("reports", "referee")


def tip(values: np.ndarray) -> str:
    """Cells of UX, UY, mm, and ROTZ, rad."""
    return " | ".join(f"{value + 0.0:.4f}" for value in values)


WORDS = template.template(Path(__file__).with_name("page.md"), [tip])


def page(code: str, comparisons: dict[str, PeerComparison]) -> str:
    """Markdown page of a peer's results."""
    peer = f", openseespy {versions('openseespy')['openseespy']}" if code == "opensees" else ""
    return template.page(WORDS, code=code, host=machine(), peer_version=peer, comparisons=comparisons)


def main(code: str) -> None:
    """Solve the four scenes and write their page and curves."""
    comparisons = {}
    for name, scene in CATALOGUE.items():
        comparisons[name] = compare(scene(), code)
        print(name, *comparisons[name].lines(), sep="\n", flush=True)
        write_bytes(FOLDER / f"referee-{code}-{name}.csv", comparisons[name].csv())
    write_text(FOLDER / f"referee-{code}.md", page(code, comparisons))


if __name__ == "__main__":
    main(sys.argv[1])
