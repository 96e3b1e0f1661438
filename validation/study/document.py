"""A report as a list of blocks: written as Markdown, read from it, bound as one HTML page; tables as CSV."""

from __future__ import annotations

import base64
import csv
import html
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

STYLE = """
body { font: 16px/1.5 Georgia, 'Times New Roman', serif; color: #1a1a1a; max-width: 62rem;
       margin: 2rem auto; padding: 0 1.2rem; }
h1, h2, h3 { font-family: Helvetica, Arial, sans-serif; line-height: 1.25; }
h2 { margin-top: 2.4rem; border-bottom: 1px solid #bbb; }
div.table { overflow-x: auto; }
table { border-collapse: collapse; font: 13.5px/1.4 Helvetica, Arial, sans-serif; margin: 0.8rem 0; }
th, td { padding: 0.3rem 0.6rem; text-align: left; vertical-align: top; border-bottom: 1px solid #ddd; }
th { border-bottom: 2px solid #444; }
figure { margin: 1.2rem 0; }
figure img, figure svg { height: auto; }
nav { font: 14px/1.6 Helvetica, Arial, sans-serif; }
nav a { margin-right: 1.2em; white-space: nowrap; }
summary { font: 14px/1.6 Helvetica, Arial, sans-serif; cursor: pointer; }
figcaption, p.note { font-size: 14px; color: #444; }
code { font-size: 90%; }
"""


@dataclass(frozen=True)
class Heading:
    """A heading of level 1 to 6."""

    level: int
    text: str


@dataclass(frozen=True)
class Text:
    """A paragraph; ``**bold**``, ``*italic*``, ``[words](address)`` and `` `code` `` are understood."""

    text: str


@dataclass(frozen=True)
class Bullets:
    """A list of short paragraphs."""

    items: tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """A table of texts; also what the CSV files hold."""

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Picture:
    """A PNG file beside the report, and its caption; HTML takes the SVG of that name where there is one."""

    file: str
    caption: str


Block = Heading | Text | Bullets | Table | Picture
PIXELS = 2.0  # on the screen for a point in print: letters of figures as large as the text
LONG = 30  # rows: a longer table is folded in HTML


def to_csv(table: Table) -> str:
    """A table as CSV."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows((table.header, *table.rows))
    return text.getvalue()


def to_markdown(blocks: Sequence[Block]) -> str:
    """The blocks as Markdown; pictures are linked."""
    return "\n\n".join(_markdown(block) for block in blocks) + "\n"


def _markdown(block: Block) -> str:
    match block:
        case Heading(level, text):
            return f"{'#' * level} {text}"
        case Text(text):
            return text
        case Bullets(items):
            return "\n".join(f"- {item}" for item in items)
        case Picture(file, caption):
            return f"![{caption.split('.')[0]}]({file})\n\n*{caption}*"
        case Table(header, rows):
            lines = [header, tuple("---" for _ in header), *rows]
            return "\n".join(
                "| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in lines
            )


def from_markdown(text: str) -> list[Block]:
    """The blocks of a page that `to_markdown` wrote."""
    blocks: list[Block] = []
    for part in text.strip().split("\n\n"):
        if part.startswith("#"):
            marks, _, words = part.partition(" ")
            blocks.append(Heading(len(marks), words))
        elif part.startswith("- "):
            blocks.append(Bullets(tuple(line.removeprefix("- ") for line in part.split("\n"))))
        elif part.startswith("| "):
            header, _, *rows = (_cells(line) for line in part.split("\n"))
            blocks.append(Table(header, tuple(rows)))
        elif found := re.fullmatch(r"!\[.*\]\((\S+)\)", part):
            blocks.append(Picture(found[1], ""))
        elif blocks and blocks[-1] == Picture(getattr(blocks[-1], "file", ""), ""):
            blocks[-1] = Picture(blocks[-1].file, part.removeprefix("*").removesuffix("*"))
        else:
            blocks.append(Text(part))
    return blocks


def _cells(line: str) -> tuple[str, ...]:
    inner = line.removeprefix("| ").removesuffix(" |")
    return tuple(cell.replace("\\|", "|") for cell in inner.split(" | "))


def to_html(sections: Sequence[tuple[Sequence[Block], Path]], title: str) -> str:
    """Blocks as one HTML page; the pictures of each section are read from its folder and embedded."""
    body = "\n".join(_html(block, folder) for blocks, folder in sections for block in blocks)
    chapters = [b.text for blocks, _ in sections for b in blocks if isinstance(b, Heading) and b.level == 2]
    links = "".join(f'<a href="#{_anchor(text)}">{_inline(text)}</a> ' for text in chapters)
    body = body.replace("</h1>", f"</h1>\n<nav>{links}</nav>", 1)
    return (
        "<!DOCTYPE html>\n"
        f'<html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title>'
        f"<style>{STYLE}</style></head>\n<body>\n{body}\n</body></html>\n"
    )


def _html(block: Block, folder: Path) -> str:
    match block:
        case Heading(level, text):
            return f'<h{level} id="{_anchor(text)}">{_inline(text)}</h{level}>'
        case Text(text):
            return f"<p>{_inline(text)}</p>"
        case Bullets(items):
            return "<ul>" + "".join(f"<li>{_inline(item)}</li>" for item in items) + "</ul>"
        case Picture(file, caption):
            image = _image(folder / file, html.escape(caption.split(".")[0]))
            return f"<figure>{image}<figcaption>{_inline(caption)}</figcaption></figure>"
        case Table(header, rows):
            head = "".join(f"<th>{_inline(cell)}</th>" for cell in header)
            body = "".join(
                "<tr>" + "".join(f"<td>{_inline(cell)}</td>" for cell in row) + "</tr>" for row in rows
            )
            table = f'<div class="table"><table><tr>{head}</tr>{body}</table></div>'
            if len(rows) <= LONG:
                return table
            return f"<details><summary>Table of {len(rows)} rows</summary>{table}</details>"


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
    """Printed width of a PNG, pt; None where it does not tell."""
    place = png.find(b"pHYs")
    if place < 0:
        return None
    pixels, per_metre = (int.from_bytes(png[i : i + 4], "big") for i in (16, place + 4))
    return pixels / per_metre / 0.0254 * 72.0


def _anchor(text: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")


def _inline(text: str) -> str:
    text = re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", html.escape(text))
    text = re.sub(r"\*(?=\S)([^*]+?)(?<=\S)\*", r"<em>\1</em>", text)
    text = re.sub(r"\[([^\]]+)\]\(([^)\s]+)\)", r'<a href="\2">\1</a>', text)
    text = re.sub(r"\[([\d.]+), ([\d.]+)\]", r"[\1,&nbsp;\2]", text)  # quartiles
    return re.sub(r"`(.+?)`", r"<code>\1</code>", text)
