"""Code of the README and the examples runs as printed."""

import re
from pathlib import Path

import pytest

import coilspring
import equivbeam
import wirefe
from validation.cli import main
from validation.metrics import compare_paths

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


def test_python_blocks(capsys):
    blocks = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
    assert len(blocks) == 3
    for block in blocks:
        exec(compile(block, "README.md", "exec"), {})
    assert "-19.8" in capsys.readouterr().out


def test_commands(tmp_path, monkeypatch, capsys):
    """The lines of the usage block; the two main commands are what CI runs."""
    monkeypatch.chdir(tmp_path)
    lines = re.findall(r"^\.venv/bin/coilcheck (.*?)\s*(?:#.*)?$", TEXT, re.MULTILINE)
    assert len(lines) == 5
    for line in lines[:2]:
        assert main(line.split()) == 0
    command, _, file = lines[3].partition(" > ")
    capsys.readouterr()
    assert main(command.split()) == 0
    Path(file).write_text(capsys.readouterr().out, encoding="utf-8")
    assert main(lines[4].split()) == 0
    assert (tmp_path / "coilcheck-out/solve-spring-b/path.csv").exists()
    assert (tmp_path / "coilcheck-out/compare-spring-a/compare.json").exists()


@pytest.mark.parametrize("file", sorted((ROOT / "examples").glob("*.toml")), ids=lambda file: file.stem)
def test_example_scenes(file):
    scene = coilspring.load_scene(file)
    beam, wire = equivbeam.solve(scene), wirefe.solve(scene)
    assert compare_paths(beam, wire).curve_max < 0.03
    assert wire.active_contacts.max() > 0
