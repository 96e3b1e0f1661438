"""The one report: the reproduction's page, bound with those of the other studies as they are found.

Nothing is computed here. A study is a folder with a page in Markdown, its pictures and its provenance; it
stands beside the report's folder, or else among the results that come with the sources.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from validation.study.document import Block, Heading, Text, from_markdown, to_html, to_markdown
from validation.study.provenance import provenance_table
from validation.workprecision import EQUAL_ERROR

PAGE = "report.md"
STORED = Path(__file__).parents[2] / "reports"  # of a checkout
FIGURES = "Figures"
BESIDE = "Table 3. Solution time"  # heading that the times at equal error follow


@dataclass(frozen=True)
class Study:
    """A study besides the reproduction.

    Attributes
    ----------
    name : of its command, its folder and its page.
    title : of its section.
    tells : what a reader finds there.
    """

    name: str
    title: str
    tells: str


STUDIES = (
    Study("workprecision", "Work and precision", "what a given accuracy costs with either model"),
    Study("stability", "Stability map", "whether sampled springs are solved, and where their paths end"),
    Study("sensitivity", "Sensitivity", "how far what the paper leaves open moves the curves"),
)


def bound(page: str, out: Path, scene: str | None = None) -> dict[str, bytes]:
    """``report.md`` and ``report.html`` from the reproduction's page and the studies found.

    Parameters
    ----------
    page : the reproduction, Markdown.
    out : folder of its pictures, and of the report.
    scene : file there with the springs to be turned in a browser, which the HTML page links.
    """
    blocks = from_markdown(page)
    title = blocks[0].text if isinstance(blocks[0], Heading) else ""
    found = {study: folder for study in STUDIES if (folder := _folder(study, out)) is not None}
    for study, folder in found.items():
        blocks = _with_equal_error(blocks, _blocks(study, folder))
    sections = [(_with_scene(blocks, scene), out)]
    for study in STUDIES:
        folder = found.get(study, out)
        sections.append((_section(study, folder) if study in found else _missing(study), folder))
    sections.append((_provenance(found, out), out))
    html = to_html(sections, title)
    return {PAGE: to_markdown(blocks).encode(), "report.html": html.encode()}


def _folder(study: Study, out: Path) -> Path | None:
    places = (out.absolute().parent / study.name, STORED / study.name)
    return next((place for place in places if (place / f"{study.name}.md").is_file()), None)


def _blocks(study: Study, folder: Path) -> list[Block]:
    return from_markdown((folder / f"{study.name}.md").read_text(encoding="utf-8"))


def _section(study: Study, folder: Path) -> list[Block]:
    """The study's page one level down, under the section's title."""
    lowered = [
        replace(block, level=block.level + 1) if isinstance(block, Heading) else block
        for block in _blocks(study, folder)[1:]
    ]
    return [Heading(2, study.title), *lowered]


def _missing(study: Study) -> list[Block]:
    words = f"Not among the results found here: `coilcheck {study.name}` tells {study.tells}."
    return [Heading(2, study.title), Text(words)]


def _with_equal_error(blocks: Sequence[Block], study: Sequence[Block]) -> list[Block]:
    """The times at equal error, where `study` has them, behind those of Table 3."""
    if Heading(2, EQUAL_ERROR) not in study or Heading(3, BESIDE) not in blocks:
        return list(blocks)
    begin = study.index(Heading(2, EQUAL_ERROR)) + 1
    part = study[begin : _next_heading(study, begin)]
    place = _next_heading(blocks, blocks.index(Heading(3, BESIDE)) + 1)
    return [*blocks[:place], Heading(3, EQUAL_ERROR), *part, *blocks[place:]]


def _with_scene(blocks: Sequence[Block], scene: str | None) -> list[Block]:
    """The figures with a link to the springs that can be turned."""
    if scene is None or Heading(2, FIGURES) not in blocks:
        return list(blocks)
    place = blocks.index(Heading(2, FIGURES)) + 1
    words = f"The springs of Figures 4 and 6 [can be turned in space]({scene}), a file beside this one."
    return [*blocks[:place], Text(words), *blocks[place:]]


def _next_heading(blocks: Sequence[Block], begin: int) -> int:
    later = range(begin, len(blocks))
    return next((i for i in later if isinstance(blocks[i], Heading)), len(blocks))


def _provenance(found: dict[Study, Path], out: Path) -> list[Block]:
    folders = [("Reproduction", out), *((study.title, folder) for study, folder in found.items())]
    return [
        Heading(2, "Provenance"),
        Text(
            "What made the results above. The digests are of the sources' names and contents, the first "
            "digits of SHA-256. The reproduction's solution times are kept with the machine: their own date "
            "stands below Table 3."
        ),
        provenance_table(folders),
    ]
