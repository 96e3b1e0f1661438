"""A disk that fills up, and two runs into one folder: one sentence, and what stood there before stays."""

import json
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

from validation.cli import main

ROOT = Path(__file__).parents[1]
BEAM = ["solve", "spring-a", "--model", "equivbeam"]
WIRE = ["solve", "spring-b", "--model", "wirefe", "--element", "curved", "--elements-per-turn", "4"]
COMMANDS = [
    BEAM,
    WIRE,
    ["compare", "spring-a", "--element", "curved", "--elements-per-turn", "4"],
    ["check", "spring-b"],
    ["reproduce", "--only", "table1,table2", "--no-render"],
    ["stability", "--beams", "3", "--wires", "0", "--workers", "0"],
]


def contents(folder):
    return {file.relative_to(folder): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def refused(capsys, folder):
    """The one line of a command that could not write."""
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 1
    assert str(folder) in said
    assert "No space left on device" in said


def full_after(files):
    """`Path.write_bytes` of a disk that takes some files, and a piece of the next."""
    write, left = Path.write_bytes, iter(range(files))

    def write_bytes(path, data):
        if next(left, None) is None:
            write(path, data[:10])
            raise OSError(28, "No space left on device")
        return write(path, data)

    return write_bytes


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: "-".join(command[:4:3]))
def test_a_disk_that_fills_up_keeps_what_was_there(command, tmp_path, monkeypatch, capsys, own_store):
    """At every file of a run: exit 4, nothing partial, no file of an earlier run gone."""
    assert main([*command, "--out", str(tmp_path)]) == 0
    before = contents(tmp_path)
    again = [*command, "--steps", "7"] if command[0] in ("solve", "compare") else command
    capsys.readouterr()
    for files in range(len(before)):
        with monkeypatch.context() as patch:
            patch.setattr(Path, "write_bytes", full_after(files))
            code = main([*again, "--out", str(tmp_path)])
        after = contents(tmp_path)
        assert set(after) == set(before)
        if code == 0:  # what was left to write fitted
            break
        assert code == 4
        refused(capsys, tmp_path)
        if command[0] in ("solve", "compare"):
            assert after == before


def test_a_first_run_on_a_full_disk_leaves_nothing(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(Path, "write_bytes", full_after(1))
    assert main([*BEAM, "--out", str(tmp_path)]) == 4
    refused(capsys, tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_campaign_goes_on_where_the_disk_was_full(tmp_path, monkeypatch, capsys):
    """Rows are kept as they come: those of before the full disk are not judged again."""
    command = ["stability", "--wires", "0", "--workers", "0", "--out", str(tmp_path)]
    assert main([*command, "--beams", "2"]) == 0
    rows = (tmp_path / "stability.csv").read_text().splitlines()
    with monkeypatch.context() as patch:
        patch.setattr("os.fsync", lambda _: (_ for _ in ()).throw(OSError(28, "No space left on device")))
        capsys.readouterr()
        assert main([*command, "--beams", "4"]) == 4
    refused(capsys, tmp_path)
    assert main([*command, "--beams", "4"]) == 0
    again = (tmp_path / "stability.csv").read_text().splitlines()
    assert len(again) == 5
    assert again[: len(rows)] == rows  # with the seconds that they took then


def test_a_folder_that_is_a_device_is_refused(capsys):
    assert main([*BEAM, "--out", "/dev/full"]) == 4
    assert "/dev/full" in capsys.readouterr().err


def test_two_solves_at_once_into_one_folder(tmp_path):
    """Each ends well or says that the other is writing there; the files are one run's, whole."""
    children = [
        subprocess.Popen(
            [sys.executable, "-m", "validation.cli", *BEAM, "--steps", steps, "--out", tmp_path],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            cwd=ROOT,
        )
        for steps in ("3", "5")
    ]
    said = [(child.communicate()[1], child.returncode) for child in children]
    assert (b"", 0) in said
    for error, code in said:
        assert code == 0 or (code == 4 and error.endswith(b"wait for it, or give another --out\n"))
    assert {file.name for file in tmp_path.iterdir()} == {"path.csv", "summary.json"}
    assert len(pd.read_csv(tmp_path / "path.csv")) in (3, 5)
    assert json.loads((tmp_path / "summary.json").read_text())["outcome"] == "completed"
