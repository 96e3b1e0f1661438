"""Springs to be turned in a browser: the file, when it is made anew, and what is said where it cannot be."""

import importlib.util
import re
import sys

import pytest

from validation.cli import main
from validation.reproduce import reproduction
from validation.view import htmlscene, process

needs_extra = pytest.mark.skipif(
    any(importlib.util.find_spec(name) is None for name in htmlscene.NEEDED),
    reason="the extra interactive is not installed",
)
ONLY = ["--only", "table1", "--interactive"]


@pytest.fixture
def extra(monkeypatch):
    """The extra is there, or so it seems."""
    monkeypatch.setattr(htmlscene, "NEEDED", ())


@pytest.mark.parametrize("name", htmlscene.NEEDED)
def test_without_the_extra_one_sentence_says_how_to_install_it(name, tmp_path, monkeypatch, capsys):
    found = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda each: None if each == name else found("json"))
    assert main(["reproduce", *ONLY, "--out", str(tmp_path / "new")]) == 2
    error = capsys.readouterr().err
    assert "pip install -e '.[interactive]'" in error
    assert name.replace("_", "-") in error
    assert error.count("\n") == 1
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(
    ("code", "reason"), [("import os; os.abort()", "it ended with status -6"), ("pass", "it wrote no file")]
)
def test_where_pyvista_cannot_export_a_sentence_says_so(code, reason, extra, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(process, "COMMAND", (sys.executable, "-c", code))
    assert main(["reproduce", *ONLY, "--out", str(tmp_path)]) == 0
    assert f"no springs.html: pyvista could not export the springs here ({reason}" in capsys.readouterr().out
    assert [file.name for file in tmp_path.iterdir()] == ["table1.csv"]


def test_it_is_made_anew_where_the_sources_changed(extra, tmp_path, monkeypatch):
    """And is linked only as long as it was made from the sources as they are."""
    made = []
    code = "import sys, pathlib; pathlib.Path(sys.argv[1], 'springs.html').write_text('<title>v</title>')"
    monkeypatch.setattr(process, "COMMAND", (sys.executable, "-c", code))
    sound = htmlscene.page
    monkeypatch.setattr(htmlscene, "page", lambda *given: made.append(given[1]) or sound(*given))
    for _ in range(2):
        reproduction.reproduce(tmp_path, only=("table1",), turned=True)
    assert len(made) == 1
    assert htmlscene.is_made(tmp_path, made[0])
    assert not htmlscene.is_made(tmp_path, "another")
    monkeypatch.setattr(reproduction, "sources", lambda *packages: "changed")
    reproduction.reproduce(tmp_path, only=("table1",), turned=True)
    assert len(set(made)) == 2


def test_it_does_not_go_without_pictures(tmp_path, capsys):
    assert main(["reproduce", "--no-render", "--interactive", "--out", str(tmp_path / "new")]) == 2
    assert "--no-render" in capsys.readouterr().err


@needs_extra
def test_the_file_holds_the_springs_and_nothing_from_elsewhere(tmp_path, capsys):
    assert main(["reproduce", *ONLY, "--out", str(tmp_path)]) == 0
    assert "no springs.html" not in capsys.readouterr().out
    page = (tmp_path / htmlscene.FILE).read_text(encoding="utf-8")
    assert f"<title>{htmlscene.TITLE}</title>" in page
    assert not re.search(r'<(script|link)[^>]*(src|href)="', page)
    scene = vtk_scene(page)
    actors = [each for each in walk(scene) if each.get("type", "").endswith("Actor")]
    # beam, wire and rest of four springs, their names, and three words that tell the colours
    assert len(actors) == 4 * 3 + 4 + 3


def vtk_scene(page):
    """The scene that is embedded in the page."""
    import base64
    import io
    import json
    import zipfile

    data = base64.b64decode(re.search(r'const base64Str = "([^"]+)"', page)[1])
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return json.loads(archive.read("index.json"))["scene"]


def walk(node):
    yield node
    for each in node.get("dependencies") or ():
        yield from walk(each)
