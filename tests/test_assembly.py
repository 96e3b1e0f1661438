"""The report in one file: Markdown as HTML, sections of the studies found, figures and provenance."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from PIL import Image

from validation.reproduce import assembly
from validation.reproduce.assembly import LONG, assemble, to_html
from validation.study.provenance import FILE, models, write_provenance
from validation.study.tables import Table

REPORTS = Path(__file__).parents[1] / "reports"
PAGE = """# The title

## Verdict

**Right.**

### Table 3. Solution time

| case | reduction (%) |
| --- | --- |
| Spring A | 98 |

Measured once.

## Figures

![Figure 5](fig5.png)

*Figure 5. Curves.*
"""
WORK = """# Run time against error

## Time at equal error

| scene | reduction (%) |
| --- | --- |
| Spring A | planted |

## Another

![Shape](a.png)

*Shape. Words.*
"""
DRAWING = (
    '<?xml version="1.0"?>\n<svg width="9pt" viewBox="0 0 9.5 4">'
    '<metadata>who</metadata><path d="M 0 0"/></svg>\n'
)
PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture
def out(tmp_path, monkeypatch):
    """Folder of a report with its figure; nothing is found but what stands beside it."""
    monkeypatch.setattr(assembly, "STORED", tmp_path / "nowhere")
    folder = tmp_path / "reproduce"
    folder.mkdir()
    (folder / "fig5.png").write_bytes(PNG)
    return folder


def work(folder):
    beside = folder.parent / "workprecision"
    beside.mkdir()
    (beside / "workprecision.md").write_text(WORK, encoding="utf-8")
    (beside / "a.png").write_bytes(PNG)
    return beside


def html(out):
    return assemble(PAGE, out).decode()


def test_every_block_is_rendered(tmp_path):
    (tmp_path / "a.png").write_bytes(PNG)
    blocks = [
        "## Title # 1",
        "A paragraph, **bold**, *word* and `code` < 3.",
        "- one\n- two - three",
        str(Table(("a|b", "c"), (("1", ""), ("| x |", "2")))),
        "![Figure 1](a.png)\n\n*Figure 1. Caption (of it).*",
    ]
    page = to_html([("\n\n".join(blocks), tmp_path)], "t").partition("<body>")[2]
    assert '<h2 id="title-1">Title # 1</h2>' in page
    assert "<p>A paragraph, <strong>bold</strong>, <em>word</em> and <code>code</code> &lt; 3.</p>" in page
    assert re.findall(r"<li>(.*?)</li>", page) == ["one", "two - three"]
    assert re.findall(r"<t[hd]>(.*?)</t[hd]>", page) == ["a|b", "c", "1", "", "| x |", "2"]
    assert re.search(r'<figure><img alt="Figure 1" .*?><figcaption>Figure 1. Caption \(of it\).</fig', page)


def test_a_study_that_is_missing_is_said_in_a_sentence(out):
    page = html(out)
    for study in assembly.STUDIES:
        assert f"<code>coilcheck {study.name}</code> shows {study.shows}" in page


def test_sections_in_their_order_one_level_down(out):
    work(out)
    heads = re.findall(r"<h(\d) id=\"[a-z0-9-]*\">(.*?)</h", html(out))
    assert heads == [
        *(("1", "The title"), ("2", "Verdict"), ("3", "Table 3. Solution time")),
        *(("2", "Figures"), ("2", "Work and precision")),
        *(("3", "Time at equal error"), ("3", "Another"), ("2", "Stability map")),
        *(("2", "Sensitivity"), ("2", "Provenance")),
    ]


def test_a_drawing_is_taken_inline_before_its_pixels(out):
    assert html(out).count("data:image/png") == 1
    (out / "fig5.svg").write_text(DRAWING, encoding="utf-8")
    page = html(out)
    assert "data:image/png" not in page
    start = '<svg role="img" aria-label="Figure 5" style="width: min(100%, 19px)" viewBox="0 0 9.5 4">'
    assert f'{start}<path d="M 0 0"/></svg>' in page
    assert "who" not in page


def test_pixels_are_as_wide_as_the_drawing_would_be(out):
    """A picture of 300 pixels at 300 dots an inch is an inch, which is 144 pixels of the screen."""
    Image.new("L", (300, 10)).save(out / "fig5.png", dpi=(300, 300))
    assert 'style="width: min(100%, 144px)" src="data:image/png' in html(out)


def test_quartiles_are_not_torn_apart():
    page = to_html([("2.67 [2.32, 2.72], [words](a.html)", Path())], "t")
    assert '2.67 [2.32,\xa02.72], <a href="a.html">words</a>' in page


def test_springs_to_be_turned_are_linked_on_request(out):
    page = assemble(PAGE, out, "springs.html").decode()
    link = page.index('<a href="springs.html">')
    assert page.index('id="figures"') < link < page.index("<figure>")
    assert "springs.html" not in html(out)


def test_results_beside_come_before_stored_ones(out, monkeypatch):
    monkeypatch.setattr(assembly, "STORED", REPORTS)
    assert "<td>planted</td>" not in html(out)
    work(out)
    assert "<td>planted</td>" in html(out)


def test_the_report_on_stored_results_stands_alone(monkeypatch):
    page = assemble((REPORTS / "paper" / "report.md").read_text(encoding="utf-8"), REPORTS / "paper")
    text = page.decode()
    assert len(text) < 5e6
    links = re.findall(r'(?:src|href)="([^"]*)"', text)
    assert all(link.startswith(("data:", "#")) for link in links)
    anchors = set(re.findall(r'<h\d id="([^"]*)"', text))
    chapters = re.findall(r'<a href="#([^"]*)"', text)
    assert chapters
    assert set(chapters) <= anchors


def test_provenance_tells_results_of_other_models(out):
    beside = work(out)
    assert "not recorded" in html(out)
    write_provenance("coilcheck workprecision --quick", beside)
    page = html(out)
    assert "<code>coilcheck workprecision --quick</code>" in page
    assert f"<code>{models()}</code>" in page
    assert "<td>yes</td>" in page
    made = json.loads((beside / FILE).read_text()) | {"models": "0" * 12}
    (beside / FILE).write_text(json.dumps(made))
    page = html(out)
    assert "<td>yes</td>" not in page
    assert "no: the command makes it anew" in page


def test_long_tables_are_folded(tmp_path):
    for count, folded in ((LONG, False), (LONG + 1, True)):
        page = to_html([(str(Table(("a",), (("1",),) * count)), tmp_path)], "title")
        assert ("<details>" in page) is folded
