"""The report in one HTML file: the reproduction's page and those of the other studies as they are found.

Nothing is computed here. A study is a folder with a page in Markdown, its pictures and its provenance; it
stands beside the report's folder, or else among the results that come with the sources.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

from validation.study.html import to_html
from validation.study.provenance import provenance_table

PAGE = "report.md"
STORED = Path(__file__).parents[2] / "reports"  # of a checkout
FIGURES = "## Figures\n"
PROVENANCE = """## Provenance

What made the results above. The digests are of the sources' names and contents, the first digits of SHA-256.
The reproduction's solution times are kept with the machine: their own date stands below Table 3.

{}
"""


class Study(NamedTuple):
    """A study besides the reproduction."""

    name: str  # of its command, its folder and its page
    title: str  # of its section
    tells: str  # what a reader finds there


STUDIES = (
    Study("workprecision", "Work and precision", "what a given accuracy costs with either model"),
    Study("stability", "Stability map", "whether sampled springs are solved, and where their paths end"),
    Study("sensitivity", "Sensitivity", "the effect of what the paper leaves open on the curves"),
)


def assemble(page: str, out: Path, scene: str | None = None) -> bytes:
    """``report.html`` of the reproduction's page, Markdown with pictures in `out`, and of the studies found.

    The page links `scene`, a file there with the springs to be turned in a browser.
    """
    found = {study: folder for study in STUDIES if (folder := _folder(study, out)) is not None}
    if scene is not None:
        words = f"The springs of Figures 4 and 6 [can be turned in space]({scene}), a file beside this one."
        page = page.replace(FIGURES, f"{FIGURES}\n{words}\n", 1)
    sections = [(page, out)]
    sections += [(_section(study, found.get(study)), found.get(study, out)) for study in STUDIES]
    folders = [("Reproduction", out), *((study.title, folder) for study, folder in found.items())]
    sections.append((PROVENANCE.format(provenance_table(folders)), out))
    return to_html(sections, page.partition("\n")[0].lstrip("# ")).encode()


def _folder(study: Study, out: Path) -> Path | None:
    places = (out.absolute().parent / study.name, STORED / study.name)
    return next((place for place in places if (place / f"{study.name}.md").is_file()), None)


def _section(study: Study, folder: Path | None) -> str:
    """The study's page one level down, under the section's title."""
    if folder is None:
        words = f"Not among the results found here: `coilcheck {study.name}` shows {study.tells}."
    else:
        page = (folder / f"{study.name}.md").read_text(encoding="utf-8")
        words = re.sub("^#", "##", page.partition("\n")[2], flags=re.MULTILINE)
    return f"## {study.title}\n\n{words}"
