"""`reproduce`: what it writes, what it solves for that, and what it does where something fails."""

from __future__ import annotations

import csv
import json
import re
import subprocess
import sys

import pytest

from coilspring import CATALOGUE, InputError
from test_statements import VERDICTS
from validation.reproduce import ARTEFACTS, artifacts, claims, reproduction, times
from validation.reproduce.findings import REPRODUCTION
from validation.study import paths
from validation.study.machine import machine
from validation.view import process

NAMES = ("table1", "table2", "table3", "fig4", "fig5", "fig6", "fig7", "fig8")
PNG = b"\x89PNG\r\n\x1a\n"


def read(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.reader(file))


@pytest.fixture
def solved(monkeypatch, own_store):
    """Names of the solves that were made; nothing was solved before."""
    made = []

    def recorded(original):
        def solve(scene, **options):
            made.append((original.__name__, scene.name, *options.values()))
            return original(scene, **options)

        solve.__name__ = original.__name__
        return solve

    for original in (paths.solve_beam, paths.solve_wire):
        monkeypatch.setattr(paths, original.__name__, recorded(original))
    return made


def solves(lines):
    return [line for line in lines if line.startswith("solve ")]


@pytest.fixture(scope="module")
def everything(tmp_path_factory):
    """A whole run without pictures, timed in the least number of rounds."""
    out = tmp_path_factory.mktemp("whole")
    budget, times.BUDGET = times.BUDGET, 0.0
    try:
        reproduction.reproduce(out, render=False)
    finally:
        times.BUDGET = budget
    return out


def test_items_are_those_of_the_contract():
    assert ARTEFACTS == NAMES
    assert {*artifacts.MAKERS, *artifacts.SPRINGS} == {*NAMES, "report"}


def test_tables_1_and_2_solve_nothing_and_equal_the_paper(tmp_path, solved):
    reproduction.reproduce(tmp_path, only=("table1", "table2"))
    assert solved == []
    assert sorted(path.name for path in tmp_path.iterdir()) == ["table1.csv", "table2.csv"]
    table1 = read(tmp_path / "table1.csv")
    given = [row for row in table1[1:] if "not given" not in row]
    assert len(given) == 10
    assert all(row[1:3] == row[3:5] for row in given)
    table2 = {row[0]: row[1:] for row in read(tmp_path / "table2.csv")}
    assert table2["elements per turn"] == ["40"] * 4
    assert table2["top node, constrained"][:2] == table2["top node, constrained"][2:]


def test_each_item_solves_what_it_needs_once(tmp_path, solved):
    reproduction.reproduce(tmp_path, only=("fig4", "fig5"), render=False)
    scenes = ("spring-a", "spring-a-no-contact")
    both = [(model, name) for model in ("solve_beam", "solve_wire") for name in scenes]
    assert sorted(call[:2] for call in solved) == both
    solved.clear()
    lines = []
    reproduction.reproduce(tmp_path, only=("fig8",), render=False, progress=lines.append)
    assert {call[0] for call in solved} == {"solve_beam"}
    assert len(solved) == len(set(solved)) == len(solves(lines))
    # four scenes by two tangents, of which Spring A with the exact one is there
    assert len(solved) == 8 - len(scenes)


def test_figure_data(tmp_path):
    reproduction.reproduce(tmp_path, only=("fig7", "fig8"), render=False)
    rows = read(tmp_path / "fig7.csv")
    last = dict(zip(rows[0], map(float, rows[-1]), strict=True))
    assert len(rows) == 51
    assert last["time"] == 1.0
    assert last["load_N"] == 200.0
    assert last["uy_mm_contact_equivbeam"] == pytest.approx(-15.372, abs=1e-3)
    rows = read(tmp_path / "fig8.csv")
    spent = rows[0].index("spring-b-no-contact_exact_tangent")
    assert sum(int(row[spent]) for row in rows[1:]) == 1
    assert not list(tmp_path.glob("*.png"))


def test_table_3_without_rendering_imports_no_drawing(tmp_path, own_store):
    code = (
        "import sys, pathlib\n"
        "from validation.reproduce import times\n"
        "from validation.reproduce.reproduction import reproduce\n"
        "times.BUDGET, times.LEAST_ROUNDS = 0.0, 1\n"
        "lines = []\n"
        f"reproduce(pathlib.Path({str(tmp_path)!r}), ('table3',), False, lines.append)\n"
        "drawing = {'matplotlib', 'pyvista', 'vtk', 'vtkmodules'} & set(sys.modules)\n"
        "assert not drawing, drawing\n"
        "assert sum(line.startswith('solve') for line in lines) == 12, lines\n"
    )
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert child.returncode == 0, child.stderr
    rows = read(tmp_path / "table3.csv")
    assert [row[0] for row in rows[1:]] == list(CATALOGUE)
    assert {row[rows[0].index("processor")] for row in rows[1:]} == {machine()["processor"]}
    for row in rows[1:]:
        values = dict(zip(rows[0], row, strict=True))
        assert float(values["reduction_percent"]) == pytest.approx(
            100 - 100 / float(values["ratio"]), abs=1e-3
        )
        assert float(values["ratio"]) > 1.0


@pytest.mark.parametrize(
    ("code", "timeout", "reason"),
    [
        ("raise SystemExit(3)", 60.0, "status 3"),
        ("import time; time.sleep(60)", 0.1, "longer"),
        ("", 60.0, "no picture"),
    ],
)
def test_where_rendering_fails_the_picture_is_painted(tmp_path, monkeypatch, code, timeout, reason):
    monkeypatch.setattr(process, "COMMAND", (sys.executable, "-c", code))
    monkeypatch.setattr(artifacts, "RENDERING", timeout)
    lines = []
    reproduction.reproduce(tmp_path, only=("fig6",), progress=lines.append)
    notes = [line for line in lines if "pyvista could not render" in line]
    assert len(notes) == 1
    assert reason in notes[0]
    for name in ("fig6.png", "fig6-plane.png"):
        assert (tmp_path / name).read_bytes().startswith(PNG)
        assert (tmp_path / name).stat().st_size < 300_000


def test_an_interpreter_that_cannot_be_started_is_no_obstacle(tmp_path, monkeypatch):
    monkeypatch.setattr(process, "COMMAND", (str(tmp_path / "missing"),))
    reproduction.reproduce(tmp_path, only=("fig4",))
    assert (tmp_path / "fig4.png").read_bytes().startswith(PNG)


def test_curves_are_drawn(tmp_path):
    """Even where they were made without pictures before."""
    reproduction.reproduce(tmp_path, only=("fig5", "fig7", "fig8"), render=False)
    assert not list(tmp_path.glob("*.png"))
    reproduction.reproduce(tmp_path, only=("fig5", "fig7", "fig8"))
    for name in ("fig5", "fig7", "fig8"):
        assert 10_000 < (tmp_path / f"{name}.png").stat().st_size < 300_000


def test_pictures_that_pyvista_did_not_render_are_not_kept(tmp_path, monkeypatch, own_store):
    monkeypatch.setattr(process, "COMMAND", (str(tmp_path / "missing"),))
    for folder in ("one", "two"):
        lines = []
        reproduction.reproduce(tmp_path / folder, only=("fig4",), progress=lines.append)
        assert any("pyvista could not render" in line for line in lines)
    assert solves(lines) == []


def test_interrupt_leaves_finished_pieces(tmp_path):
    def progress(line):
        if line == "fig8":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        reproduction.reproduce(tmp_path, only=("table1", "fig8"), render=False, progress=progress)
    assert [path.name for path in tmp_path.iterdir()] == ["table1.csv"]


def test_what_was_solved_before_an_interrupt_is_not_solved_again(tmp_path, solved):
    def progress(line):
        if line.startswith("solve ") and len(solved) == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match="what is solved is kept; the same command goes on"):
        reproduction.reproduce(tmp_path, only=("fig8",), render=False, progress=progress)
    reproduction.reproduce(tmp_path, only=("fig8",), render=False)
    assert len(solved) == len(set(solved)) == 8


def test_unknown_item_is_refused_before_anything_is_written(tmp_path):
    with pytest.raises(InputError, match="fig9"):
        reproduction.reproduce(tmp_path / "new", only=("table1", "fig9"))
    assert not (tmp_path / "new").exists()


def test_springs_to_be_turned_are_linked_where_they_are_there(everything, monkeypatch):
    linked, html = [], (everything / "report.html").read_bytes()
    monkeypatch.setattr(reproduction, "assemble", lambda page, out, scene: linked.append(scene) or html)
    for there in (False, True):
        monkeypatch.setattr(reproduction, "is_made", lambda folder, mark, there=there: there)
        reproduction.reproduce(everything, render=False)
    assert linked == [None, "springs.html"]


def test_whole_run_without_pictures(everything):
    written = {path.name for path in everything.iterdir()}
    assert {f"{name}.csv" for name in NAMES} | {"report.md", "report.html", "claims.csv"} <= written
    assert not [name for name in written if name.endswith((".png", ".part"))]
    page = (everything / "report.html").read_text(encoding="utf-8")
    assert page.index("Verdict") < page.index("sentence by sentence") < page.index("What was assumed")
    text = (everything / "report.md").read_text(encoding="utf-8")
    assert "![" not in text
    assert "nan" not in text.lower()


def contents(folder):
    return {file.name: file.read_bytes() for file in folder.iterdir()}


def test_second_run_makes_nothing_and_writes_the_same(everything, tmp_path):
    """In a process of its own, to another folder: without the compiler, the models and all drawing."""
    code = (
        "import sys, pathlib\n"
        "from validation.reproduce.reproduction import reproduce\n"
        "lines = []\n"
        f"said = reproduce(pathlib.Path({str(tmp_path)!r}), None, False, lines.append)\n"
        "heavy = {'numba', 'scipy', 'pandas', 'matplotlib', 'pyvista', 'equivbeam', 'wirefe'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)\n"
        f"assert lines == [*{NAMES!r}, 'report'], lines\n"
        "print(*said)\n"
    )
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert child.returncode == 0, child.stderr
    assert f"measured on {machine()['date']} on {machine()['processor']}; --time" in child.stdout
    assert contents(tmp_path) == contents(everything)


def test_second_run_touches_only_what_was_changed(everything, tmp_path):
    reproduction.reproduce(tmp_path, render=False)
    before = {file: file.stat().st_mtime_ns for file in tmp_path.iterdir()}
    changed = tmp_path / "fig5.csv"
    changed.write_text("by somebody")
    reproduction.reproduce(tmp_path, render=False)
    assert contents(tmp_path) == contents(everything)
    after = {file: file.stat().st_mtime_ns for file in tmp_path.iterdir()}
    assert {file for file in before if before[file] != after[file]} == {changed}


def test_pieces_made_anew_from_stored_runs_are_the_same(everything, tmp_path, monkeypatch):
    monkeypatch.setattr(reproduction, "DRAWING", ("numpy",))  # another key for every piece
    lines = []
    reproduction.reproduce(tmp_path, render=False, progress=lines.append)
    assert "loading both models" in lines
    assert solves(lines) == []
    assert contents(tmp_path) == contents(everything)


def test_times_are_measured_again_on_request_and_on_another_machine(everything, tmp_path, monkeypatch):
    def rounds(**options):
        lines = []
        said = reproduction.reproduce(tmp_path, ("table3",), False, lines.append, **options)
        return sum(line.startswith("timing") for line in lines), len(said)

    monkeypatch.setattr(times, "BUDGET", 0.0)
    monkeypatch.setattr(times, "LEAST_ROUNDS", 1)
    whole = read(everything / "table3.csv")
    assert rounds() == (0, 1)
    assert read(tmp_path / "table3.csv") == whole
    monkeypatch.setattr(reproduction, "timed_on", lambda: ["another"])
    assert rounds() == (1, 0)
    assert rounds() == (0, 1)
    assert rounds(time=True) == (1, 0)
    again = read(tmp_path / "table3.csv")
    ratio, iterations = (whole[0].index(name) for name in ("ratio", "wire_iterations"))
    assert [row[iterations] for row in again] == [row[iterations] for row in whole]
    assert [row[ratio] for row in again[1:]] != [row[ratio] for row in whole[1:]]


def test_two_runs_at_once_into_one_folder(tmp_path, own_store):
    """Both end well, with the files of one; nothing half written is left."""
    code = (
        "import pathlib\n"
        "from validation.reproduce.reproduction import reproduce\n"
        f"reproduce(pathlib.Path({str(tmp_path)!r}), ('table1', 'fig7', 'fig8'), False)\n"
    )
    children = [subprocess.Popen([sys.executable, "-c", code], stderr=subprocess.PIPE) for _ in range(2)]
    for child in children:
        assert (child.communicate()[1], child.returncode) == (b"", 0)
    assert sorted(contents(tmp_path)) == ["fig7.csv", "fig8.csv", "table1.csv"]
    written = contents(tmp_path)
    assert not [file for file in own_store.iterdir() if file.suffix != ".coilcheck"]
    lines = []
    reproduction.reproduce(tmp_path, ("table1", "fig7", "fig8"), False, lines.append)
    assert "loading both models" not in lines
    assert contents(tmp_path) == written


def test_where_nothing_can_be_kept_the_run_goes_on(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("COILCHECK_STORE", str(tmp_path / "file" / "store"))
    for _ in range(2):
        lines = []
        said = reproduction.reproduce(tmp_path / "out", ("fig7",), False, lines.append)
        assert len(said) == 1
        assert str(tmp_path / "file" / "store") in said[0]
        assert len(solves(lines)) == 4
    assert (tmp_path / "out" / "fig7.csv").is_file()


def test_the_page_says_what_its_facts_say(everything):
    """Verdicts of a whole run are those expected; what rests on seconds is judged by those of the run."""
    rows = read(everything / "claims.csv")[1:]
    known = json.loads((everything / "facts.json").read_text(encoding="utf-8"))
    assert rows == [[*claims.assessed(name, known), claims.by_wires(name, known)] for name in claims.CLAIMS]
    assert all(all(row) for row in rows)
    found = {name: row[3] for name, row in zip(claims.CLAIMS, rows, strict=True)}
    expected = {name: row[0] for name, row in VERDICTS.items() if name not in BY_SECONDS}
    assert {name: found[name] for name in expected} == expected
    page = (everything / "report.md").read_text(encoding="utf-8")
    for verdict in set(expected.values()):
        mechanical = sum(found[name] == verdict for name in claims.SOURCES["mechanics"][1])
        assert re.search(rf"on mechanics: [^;]*\b{verdict} {mechanical}\b", page)


# rest on times of this machine now
BY_SECONDS = {"cost", "competitive", "doubles_fe", "doubles_beam", "a_against_b"}


def test_the_facts_of_a_run_are_kept(everything):
    known = json.loads((everything / "facts.json").read_text(encoding="utf-8"))
    assert known["setting.steps"] == 50
    stored = json.loads(REPRODUCTION.read_text(encoding="utf-8"))
    assert set(known) == set(stored)
    for name, value in stored.items():
        if not re.search(r"\.time\.|^machine|^timing|linear.beam", name):  # the same on every machine
            assert known[name] == (
                pytest.approx(value, rel=1e-4) if isinstance(value, int | float) else known[name]
            )
    rows = read(everything / "phases.csv")
    bare = dict(zip(rows[0], rows[2], strict=True))
    assert (bare["degrees"], bare["outcome"], float(bare["uy_softer"])) == ("30", "completed", 50.0)
