"""The report in one HTML file: the reproduction's page and those of the other studies as they are found.

Nothing is computed here: markdown-it-py renders, pictures are embedded. A study is a folder with a page in
Markdown, its pictures and its provenance; it stands beside the report's folder, or else among the results
that come with the sources.
"""

import base64
import html
import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from markdown_it import MarkdownIt

from validation.study.files import ROOT
from validation.study.provenance import provenance_table

PAGE = "report.md"
STYLE = Path(__file__).with_name("page.css")
PIXELS = 2.0  # on the screen for a point in print: letters of figures as large as the text
LONG = 30  # rows: a longer table is folded
STORED = ROOT / "reports"
FIGURES = "## Figures\n"
PROVENANCE = """## Provenance

What made the results above. The digests are of the sources' names and contents, the first digits of SHA-256;
comments, docstrings and layout of Python files do not count.
The reproduction's solution times are kept with the machine: their own date stands below Table 3.

{}
"""


class Study(NamedTuple):
    """A study besides the reproduction."""

    name: str  # of its command, its folder and its page
    title: str  # of its section
    shows: str  # what a reader finds there


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
        words = f"Not among the results found here: `coilcheck {study.name}` shows {study.shows}."
    else:
        page = (folder / f"{study.name}.md").read_text(encoding="utf-8")
        words = re.sub("^#", "##", page.partition("\n")[2], flags=re.MULTILINE)
    return f"## {study.title}\n\n{words}"


def to_html(sections: Sequence[tuple[str, Path]], title: str) -> str:
    """Sections in Markdown as one page; the pictures of each are read from its folder and embedded."""
    markdown = MarkdownIt("commonmark", {"html": False}).enable("table")
    body = "".join(_rendered(markdown, *section) for section in sections)
    chapters = re.findall(r'<h2 id="(.*?)">(.*?)</h2>', body)
    links = "".join(f'<a href="#{anchor}">{words}</a> ' for anchor, words in chapters)
    body = body.replace("</h1>", f"</h1>\n<nav>{links}</nav>", 1)
    return (
        "<!DOCTYPE html>\n"
        f'<html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title>'
        f"<style>\n{STYLE.read_text(encoding='utf-8')}</style></head>\n<body>\n{body}</body></html>\n"
    )


def _rendered(markdown: MarkdownIt, text: str, folder: Path) -> str:
    text = re.sub(r"\[([\d.]+), ([\d.]+)\]", "[\\1,&nbsp;\\2]", text)  # quartiles stay on one line
    page = markdown.render(text)
    page = re.sub(r"<h(\d)>(.*?)</h\d>", _heading, page)
    page = re.sub(r"<table>.*?</table>", _folded, page, flags=re.DOTALL)
    figure = r"<figure>\1<figcaption>\2</figcaption></figure>"
    page = re.sub(r"<p>(<img [^>]*>)</p>\s*<p><em>(.*?)</em></p>", figure, page)
    return re.sub(r'<img src="(.*?)" alt="(.*?)" />', lambda found: _image(folder / found[1], found[2]), page)


def _heading(found: re.Match[str]) -> str:
    level, words = found.groups()
    anchor = re.sub(r"[^a-z0-9]+", "-", html.unescape(words).lower()).strip("-")
    return f'<h{level} id="{anchor}">{words}</h{level}>'


def _folded(found: re.Match[str]) -> str:
    """A table that scrolls where it is wide, and opens on request where it is long."""
    table, rows = f'<div class="table">{found[0]}</div>', found[0].count("<tr>") - 1
    return table if rows <= LONG else f"<details><summary>Table of {rows} rows</summary>{table}</details>"


def _image(file: Path, name: str) -> str:
    """The drawing itself where there is an SVG, which stays sharp; else the PNG; both as wide as printed."""
    drawing = file.with_suffix(".svg")
    if not drawing.is_file():
        data = file.read_bytes()
        text = base64.b64encode(data).decode()
        return f'<img alt="{name}" style="{_width(_points(data))}" src="data:image/png;base64,{text}">'
    text = drawing.read_text(encoding="utf-8")
    text = re.sub(r"<metadata>.*?</metadata>", "", text[text.index("<svg") :], flags=re.DOTALL)
    tag, rest = text.split(">", 1)
    size = re.search(r'viewBox="0 0 (\S+)', tag)
    width = _width(float(size[1]) if size else None)
    tag = re.sub(r' (width|height)="[^"]*"', "", tag)
    tag = tag.replace("<svg", f'<svg role="img" aria-label="{name}" style="{width}"')
    return f"{tag}>{rest}"


def _width(points: float | None) -> str:
    return f"width: min(100%, {PIXELS * points:.0f}px)" if points else "max-width: 100%"


def _points(png: bytes) -> float | None:
    """Printed width of a PNG, pt; None where it has none."""
    place = png.find(b"pHYs")
    if place < 0:
        return None
    pixels, per_metre = (int.from_bytes(png[i : i + 4], "big") for i in (16, place + 4))
    return pixels / per_metre / 0.0254 * 72.0
