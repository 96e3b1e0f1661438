"""The command line as scripts see it: exit codes, files, and one sentence where something is wrong."""

import builtins
import csv
import errno
import importlib
import json
import math
import mmap
import os
import re
import resource
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import coilspring
import equivbeam
import wirefe
from coilspring import EquilibriumNotFound, Load, spring_a, spring_b
from coilspring.scene.toml import scene_from_table, scene_text
from validation.cli import main
from validation.cli.arguments import MODEL_OPTIONS, command_line
from validation.study.files import OutputError, claimed, json_bytes, write_files, write_text
from validation.study.machine import versions
from validation.study.models import LAWS
from validation.study.output import path_files, summary
from validation.view.overlay import picture

PARSERS = command_line()._subparsers._group_actions[0].choices  # by command
COLUMNS = "time,load_x,load_y,ux,uy,rotz,iterations,active_contacts,max_penetration,max_overlap,rate"
SUMMARY_KEYS = {
    *("outcome", "message", "last_time", "critical_time", "total_iterations", "solve_seconds"),
    *("compile_seconds", "model", "options", "versions", "scene", "scene_table", "warnings"),
    *("stability_checks", "pair_evaluations", "residual_history"),
}


def refuse_constant(name):
    raise AssertionError(f"{name} is not JSON")


def read_json(file):
    return json.loads(file.read_text(encoding="utf-8"), parse_constant=refuse_constant)


def read_rows(file):
    with open(file, encoding="utf-8", newline="") as lines:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(lines)]


def sentence(capsys):
    """The one line on stderr, without its prefix."""
    error = capsys.readouterr().err
    assert error.startswith("coilcheck: ")
    assert error.count("\n") == 1
    assert error.endswith("\n")
    return error.removeprefix("coilcheck: ").strip()


def test_solve_writes_the_path_with_full_precision(tmp_path, capsys):
    assert main(["solve", "spring-a", "--model", "equivbeam", "--steps", "5", "--out", str(tmp_path)]) == 0
    assert sorted(file.name for file in tmp_path.iterdir()) == ["path.csv", "summary.json"]
    assert (tmp_path / "path.csv").read_bytes().split(b"\n")[0].decode() == COLUMNS
    path = equivbeam.solve(coilspring.load_scene("spring-a"), steps=5)
    assert read_rows(tmp_path / "path.csv") == path.table.to_dict("records")
    output = capsys.readouterr()
    assert output.err == ""
    assert "equivbeam: completed, 5 of 5 steps" in output.out
    assert f"written to {tmp_path}" in output.out


@pytest.mark.parametrize("model", MODEL_OPTIONS)
def test_the_summary_says_how_it_was_solved(model, tmp_path):
    arguments = ["solve", "spring-b", "--model", model, "--steps", "5", "--penalty", "2e4"]
    assert main([*arguments, "--out", str(tmp_path)]) == 0
    found = read_json(tmp_path / "summary.json")
    assert found.keys() >= SUMMARY_KEYS
    assert found["outcome"] == "completed"
    assert (found["scene"], found["model"], found["last_time"]) == ("spring-b", model, 1.0)
    assert found["critical_time"] is None
    found["options"].pop("pairs_found", None)  # of the wire model, beside its options
    assert found["options"].keys() == {"steps", "penalty", *MODEL_OPTIONS[model]}
    assert (found["options"]["steps"], found["options"]["penalty"]) == (5, 2e4)
    rows = read_rows(tmp_path / "path.csv")
    assert sum(row["iterations"] for row in rows) == found["total_iterations"]
    assert found["versions"] == versions()
    assert found["versions"].keys() == {"python", "numpy", "numba", "scipy", "coilcheck"}


def test_options_reach_the_model(tmp_path):
    beam = ["--model", "equivbeam", "--law", "haringx", "--tangent", "paper", "--sliding", "scene"]
    assert (
        main(["solve", "spring-a-no-contact", *beam, "--steps", "10", "--out", str(tmp_path / "beam")]) == 0
    )
    options = read_json(tmp_path / "beam" / "summary.json")["options"]
    assert (options["law"], options["tangent"], options["sliding"]) == ("haringx", "paper", "scene")
    wire = ["--model", "wirefe", "--element", "straight", "--elements-per-turn", "8", "--pairs-per-turn", "2"]
    assert main(["solve", "spring-b-no-contact", *wire, "--steps", "2", "--out", str(tmp_path / "wire")]) == 0
    options = read_json(tmp_path / "wire" / "summary.json")["options"]
    assert (options["element"], options["elements_per_turn"], options["pairs_per_turn"]) == ("straight", 8, 2)


@pytest.mark.parametrize("steps", [50, 1])
def test_a_path_that_ends_early_is_written_as_far_as_it_goes(steps, tmp_path, capsys):
    arguments = ["solve", "spring-b", "--model", "equivbeam", "--penalty", "400", "--steps", str(steps)]
    assert main([*arguments, "--out", str(tmp_path)]) == 3
    assert "limit point at time 0.98" in sentence(capsys)
    rows = read_rows(tmp_path / "path.csv")
    assert [row["time"] for row in rows] == [i / steps for i in range(1, steps) if i / steps < 0.98376]
    found = read_json(tmp_path / "summary.json")
    assert found["outcome"] == "limit_point"
    assert found["last_time"] == (rows[-1]["time"] if rows else 0.0)
    assert found["critical_time"] == pytest.approx(0.98375, abs=1e-4)
    assert found["total_iterations"] > sum(row["iterations"] for row in rows)
    assert found["residual_history"]


def test_compare_writes_both_runs_and_their_difference(tmp_path, capsys):
    assert main(["compare", "spring-a", "--steps", "10", "--sliding", "scene", "--out", str(tmp_path)]) == 0
    found = read_json(tmp_path / "compare.json")
    assert found["steps"] == 10
    assert 0.0 < found["curve_rms"] < found["curve_max"] < 0.005
    assert 0.0 < found["shape_rms"] < found["shape_max"] < 0.1
    for model in MODEL_OPTIONS:
        assert found[model] == str(tmp_path / model)
        assert read_json(tmp_path / model / "summary.json")["model"] == model
        assert len(read_rows(tmp_path / model / "path.csv")) == 10
    beam, wire = (read_rows(tmp_path / model / "path.csv") for model in ("equivbeam", "wirefe"))
    worst = max(
        max(abs(b[key] - w[key]) for b, w in zip(beam, wire, strict=True)) / max(abs(w[key]) for w in wire)
        for key in ("ux", "uy", "rotz")
    )
    assert found["curve_max"] == pytest.approx(worst, rel=1e-12)
    said = capsys.readouterr().out
    assert "10 common steps" in said
    for name in ("ux", "uy", "rotz"):
        largest, rms = (100.0 * found[f"component_{kind}"][name] for kind in ("max", "rms"))
        peak = max(abs(row[name]) for row in wire)
        of = f"of the wire model's peak, {peak:.3g} {'rad' if name == 'rotz' else 'mm'}\n"
        assert re.search(rf"{name} +{largest:.3g} % at most, {rms:.3g} % rms {of}", said)


def free_spring_b(folder):
    """Spring B with sliding spheres, which has a limit point in the wire model alone."""
    file = folder / "free.toml"
    file.write_text(
        "[spring]\nwire_diameter = 1.5\nmean_diameter = [12, 6]\nactive_coils = 7.5\nactive_height = 28.6\n"
        '[load]\nforce = [0, -200]\n[supports]\ntop_held = ["ux", "rotz"]\n'
        '[contact]\ngeometry = "spheres"\n'
    )
    return str(file)


def test_compare_says_what_the_beam_leaves_out_and_draws(tmp_path, capsys):
    assert main(["compare", "spring-b", "--steps", "5", "--draw", "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert 'without the scene\'s sliding = "none"' in said
    assert "% at most (uy)" in said
    assert read_json(tmp_path / "compare.json")["notes"][0].startswith(
        "equivbeam: without the scene's sliding"
    )
    assert (tmp_path / "compare.png").read_bytes().startswith(b"\x89PNG")
    assert main(["compare", "spring-b", "--steps", "5", "--sliding", "scene", "--out", str(tmp_path)]) == 0
    assert "without the scene's sliding" not in capsys.readouterr().out


@pytest.mark.parametrize("load", [{}, {"load": Load(displacement=(-5.0,))}], ids=["force", "driven"])
def test_an_axial_load_is_drawn_as_force_against_deflection(load):
    """And the difference below; no panel for what is held."""
    scene = replace(spring_b(), **load).with_steps(4)
    beam, wire = equivbeam.solve(scene), wirefe.solve(scene, element="curved", elements_per_turn=8)
    plots = {axes.get_ylabel().partition(" ")[0]: axes for axes in picture(beam, wire).axes}
    assert set(plots) == {"force", "beam", "Y"}
    curve, below = plots["force"], plots["beam"]
    assert (curve.get_ylabel(), below.get_xlabel()) == ("force −FY (N)", "deflection −UY (mm)")
    for line, path in zip(curve.get_lines(), (beam, wire), strict=True):
        np.testing.assert_array_equal(line.get_xdata()[1:], -path.tips[:, 1])
        np.testing.assert_array_equal(line.get_ydata()[1:], -path.loads[:, 1])
    answers = [path.loads[:, 1] if load else path.tips[:, 1] for path in (beam, wire)]
    share = -100.0 * (answers[0] - answers[1]) / np.abs(answers[1]).max()
    np.testing.assert_allclose(below.get_lines()[0].get_ydata()[1:], share, atol=1e-12)
    assert ("force" if load else "deflection") in below.get_ylabel()


def test_one_step_is_no_steps(tmp_path, capsys):
    assert main(["compare", "spring-a", "--steps", "1", "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "equivbeam: completed, 1 of 1 step\n" in said
    assert "difference over 1 common step: " in said


def test_few_steps_are_marked_and_a_model_without_any_has_no_key():
    beam = equivbeam.solve(spring_a().with_steps(4))
    wire = wirefe.solve(spring_a().with_steps(20), element="curved", elements_per_turn=4)
    figure = picture(beam, wire)
    assert [line.get_marker() for line in figure.axes[0].get_lines()] == ["o", "None"]
    assert len(figure.legends[0].get_texts()) == 3
    figure = picture(beam.select(slice(0)), wire)
    assert len(figure.axes[0].get_lines()) == 1
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["wire model (FE)", "at rest"]


def test_pictures_of_driven_and_staged_loads_and_of_nothing_in_common(tmp_path, capsys):
    lines = scene_text(spring_a()).splitlines()
    text = "\n".join(line for line in lines if not line.startswith("force"))
    for name, load in (
        ("driven", "displacement = [-2.0, -1.0]"),
        ("staged", "stages = [[0.0, -6.0], [0.0, 0.0]]"),
        ("turned", "stages = [[0.0, -6.0], [0.5, -6.0]]"),
    ):
        file = tmp_path / f"{name}.toml"
        file.write_text(text.replace("[load]", f"[load]\n{load}"), encoding="utf-8")
        out = tmp_path / name
        assert main(["compare", str(file), "--steps", "2", "--draw", "--out", str(out)]) == 0
        assert (out / "compare.png").stat().st_size > 10_000
        said = capsys.readouterr().out
        assert (", axial force " in said) == (name == "driven")
        why = "curve.png is not drawn: load.stages must be in one direction where force is taken over"
        assert (why in said) == (name == "turned") != (out / "curve.png").exists()
    out = tmp_path / "nothing"
    assert main(["compare", free_spring_b(tmp_path), "--steps", "1", "--draw", "--out", str(out)]) == 3
    assert (out / "compare.png").is_file()
    assert main(["compare", "spring-a", "--steps", "1", "--out", str(out)]) == 0
    assert not (out / "compare.png").exists()


def test_a_run_leaves_nothing_of_the_wire_of_the_run_before(tmp_path):
    wire = ["--model", "wirefe", "--elements-per-turn", "8", "--vtu", "--vtu-series", "--out", str(tmp_path)]
    assert main(["solve", "spring-a", "--steps", "4", *wire]) == 0
    assert main(["solve", "spring-a", "--steps", "2", *wire]) == 0
    assert sorted(file.name for file in (tmp_path / "wire").iterdir()) == ["0001.vtu", "0002.vtu"]
    (tmp_path / "wire" / "mine.vtu").touch()
    assert main(["solve", "spring-a", "--steps", "2", "--model", "equivbeam", "--out", str(tmp_path)]) == 0
    assert sorted(file.name for file in tmp_path.iterdir()) == ["path.csv", "summary.json", "wire"]
    assert [file.name for file in (tmp_path / "wire").iterdir()] == ["mine.vtu"]


def test_a_driven_spring_shows_its_force(tmp_path, capsys):
    file = tmp_path / "driven.toml"
    text = scene_text(spring_a()).replace("force = ", "displacement = [-2.0] # ")
    file.write_text(text, encoding="utf-8")
    assert main(["solve", str(file), "--model", "equivbeam", "--steps", "2", "--out", str(tmp_path)]) == 0
    assert ", axial force -" in capsys.readouterr().out


def test_compare_of_a_path_that_ends_early_compares_the_common_part(tmp_path, capsys):
    assert main(["compare", free_spring_b(tmp_path), "--steps", "10", "--out", str(tmp_path)]) == 3
    assert sentence(capsys).startswith("wirefe: limit point at time 0.6")
    found = read_json(tmp_path / "compare.json")
    assert found["outcomes"] == {"equivbeam": "completed", "wirefe": "limit_point"}
    assert (found["steps"], found["last_time"]) == (6, 0.6)
    assert 0.0 < found["curve_max"] < 0.1
    assert len(read_rows(tmp_path / "equivbeam" / "path.csv")) == 10
    assert len(read_rows(tmp_path / "wirefe" / "path.csv")) == 6


def test_compare_with_nothing_in_common_says_null(tmp_path, capsys):
    assert main(["compare", free_spring_b(tmp_path), "--steps", "1", "--out", str(tmp_path)]) == 3
    output = capsys.readouterr()
    assert "nothing to compare" in output.out
    assert output.err.count("\n") == 1
    found = read_json(tmp_path / "compare.json")
    assert {found[key] for key in ("curve_max", "curve_rms", "shape_max", "shape_rms")} == {None}
    assert (tmp_path / "wirefe" / "path.csv").read_text() == COLUMNS + ",max_stress\n"


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ("", ["COMMAND", "required"]),
        ("telescope", ["telescope", "solve", "compare"]),
        ("solve", ["SCENE", "required"]),
        ("solve spring-a", ["--model", "--accuracy", "required"]),
        ("sweep spring-a --vary load.steps=1,2 --penalty -1", ["--penalty must be", "got -1"]),
        ("solve --model equivbeam", ["SCENE", "required"]),
        ("solve spring-a --model fem", ["--model", "fem", "equivbeam", "wirefe"]),
        ("solve spring-a --mod equivbeam", ["--model"]),
        ("solve spring-a --model equivbeam --speed 3", ["--speed"]),
        ("solve spring-a spring-b --model equivbeam", ["spring-b"]),
        ("solve spring-c --model equivbeam", ["spring-c", "spring-a", "TOML"]),
        ("solve spring-a --model equivbeam --steps", ["--steps", "expected one argument"]),
        ("solve spring-a --model equivbeam --steps 0", ["--steps must", "[1, 100000]", "0"]),
        ("solve spring-a --model equivbeam --steps -5", ["--steps must", "[1, 100000]", "-5"]),
        ("solve spring-a --model equivbeam --steps 2.5", ["--steps must", "integer in [1, 100000]", "2.5"]),
        ("solve spring-a --model equivbeam --steps 1_0", ["--steps must", "integer in [1, 100000]", "'1_0'"]),
        ("solve spring-a --model equivbeam --steps ten", ["--steps must", "integer in [1, 100000]", "'ten'"]),
        ("solve spring-a --model equivbeam --penalty 0", ["--penalty must", "[1e-09, 1e+12]", "0"]),
        ("solve spring-a --model equivbeam --penalty nan", ["--penalty must", "[1e-09, 1e+12]", "nan"]),
        ("solve spring-a --model equivbeam --penalty stiff", ["--penalty must", "[1e-09, 1e+12]", "'stiff'"]),
        ("solve spring-a --model equivbeam --law hooke", ["--law", "hooke", "haringx"]),
        ("solve spring-a --model equivbeam --tangent none", ["--tangent", "paper-printed"]),
        ("solve spring-a --model equivbeam --sliding free", ["--sliding", "ignore", "scene"]),
        ("solve spring-a --model wirefe --element cubic", ["--element", "straight"]),
        (
            "solve spring-a --model wirefe --elements-per-turn 41",
            ["1/41", "--elements-per-turn = 41, got"],
        ),
        ("solve spring-a --model wirefe --elements-per-turn many", ["--elements-per-turn must", "'many'"]),
        ("solve spring-a --model wirefe --pairs-per-turn 0", ["--pairs-per-turn must", "0"]),
        ("solve spring-a --model equivbeam --element straight", ["--element", "--model wirefe"]),
        ("solve spring-a --model equivbeam --pairs-per-turn 4", ["--pairs-per-turn", "--model wirefe"]),
        ("solve spring-a --model equivbeam --geometry wires", ["--geometry belongs to --model wirefe"]),
        ("solve spring-a --model wirefe --law haringx", ["--law", "--model equivbeam"]),
        ("new", ["NAME", "required"]),
        ("new spring-c", ["NAME", "spring-c", "spring-b-no-contact"]),
        ("new spring-a --out here", ["--out"]),
        ("check", ["SCENE", "required"]),
        ("check spring-c", ["SCENE", "spring-c", "TOML"]),
        ("check spring-a --model equivbeam", ["--model"]),
        ("compare", ["SCENE", "required"]),
        ("compare spring-a --model equivbeam", ["--model"]),
        ("compare spring-a --steps x", ["--steps must", "[1, 100000]", "'x'"]),
        ("reproduce spring-a", ["spring-a"]),
        ("reproduce --only table9", ["--only", "table9", "fig8"]),
        ("reproduce --only table1,,fig4", ["--only", "''"]),
        ("reproduce --only", ["--only", "expected one argument"]),
        ("reproduce --only fig5 --time", ["--time goes with table3", "fig5"]),
    ],
)
def test_bad_arguments_are_refused_in_one_sentence(arguments, parts, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(arguments.split()) == 2
    message = sentence(capsys)
    assert [part for part in parts if part not in message] == []
    assert not list(tmp_path.rglob("*.*"))


def test_the_choices_offered_are_those_of_the_models():
    scene = coilspring.load_scene("spring-a-no-contact").with_steps(1)
    solvers = dict.fromkeys(("tangent", "sliding"), equivbeam.solve) | {"element": wirefe.solve}
    assert tuple(equivbeam.laws.LAWS) == LAWS
    for name, solve in solvers.items():
        for choice in next(action.choices for action in PARSERS["solve"]._actions if action.dest == name):
            assert solve(scene, **{name: choice}).outcome == "completed"


@pytest.mark.parametrize("command", ["", *PARSERS])
def test_every_help_has_an_example_that_parses(command, capsys):
    with pytest.raises(SystemExit) as ended:
        main([*command.split(), "--help"])
    assert ended.value.code == 0
    example = capsys.readouterr().out.partition("example: coilcheck ")[2].split()
    assert command_line().parse_args(example).command == (command or "solve")


def test_help_imports_nothing_heavy():
    code = (
        "import sys\n"
        "from validation.cli import main\n"
        "try:\n    main(['--help'])\n"
        "except SystemExit:\n    pass\n"
        "print({'numba', 'scipy', 'pandas', 'matplotlib', 'pyvista', 'rich'} & sys.modules.keys())\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "set()"


@pytest.mark.parametrize(
    ("arguments", "folder"),
    [
        (["solve", "spring-a", "--model", "equivbeam"], "solve-spring-a"),
        (["solve", "my.spring.toml", "--model", "equivbeam"], "solve-my.spring"),
        (["compare", "spring-b"], "compare-spring-b"),
    ],
)
def test_the_default_folder_is_named_after_command_and_scene(arguments, folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.spring.toml").write_text(
        "[spring]\nwire_diameter = 1\nmean_diameter = 9\nactive_coils = 3\nactive_height = 9\n"
        "[load]\nforce = [0, -1]\n"
    )
    assert main([*arguments, "--steps", "2"]) == 0
    assert [file.name for file in (tmp_path / "coilcheck-out").iterdir()] == [folder]


def test_an_unwritable_folder_is_noticed_before_solving(tmp_path, monkeypatch, capsys):
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    monkeypatch.setattr(equivbeam, "solve", lambda *_, **__: pytest.fail("solved in vain"))
    for out in (blocked, blocked / "below"):
        for arguments in (
            ["solve", "spring-a", "--model", "equivbeam"],
            ["compare", "spring-a"],
            ["reproduce"],
        ):
            assert main([*arguments, "--out", str(out)]) == 4
            assert str(out) in sentence(capsys)


def test_a_file_that_cannot_be_replaced_is_exit_4_and_leaves_nothing_partial(tmp_path, capsys):
    (tmp_path / "path.csv").mkdir()
    assert main(["solve", "spring-a", "--model", "equivbeam", "--steps", "1", "--out", str(tmp_path)]) == 4
    assert "path.csv" in sentence(capsys)
    assert [file.name for file in tmp_path.iterdir()] == ["path.csv"]


def test_a_failed_write_keeps_the_old_file(tmp_path, monkeypatch):
    target = tmp_path / "summary.json"
    target.write_text("old")

    def no_space(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", no_space)
    with pytest.raises(OutputError, match=r"summary\.json: No space left on device"):
        write_text(target, "new")
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


WRITERS = [
    ("solve", "spring-b", "--model", "equivbeam", "--steps", "1"),
    ("compare", "spring-b", "--steps", "1"),
    ("reproduce", "--only", "table1"),
    ("workprecision", "--quick"),
    ("sensitivity",),
    ("stability",),
    ("regress",),
    ("export", "spring-b", "--to", "calculix"),
    ("referee", "spring-b", "--with", "opensees"),
]


@pytest.mark.parametrize("command", WRITERS, ids=lambda command: command[0])
def test_a_folder_is_written_by_one_run_at_a_time(command, tmp_path, capsys):
    with claimed(tmp_path):
        assert main([*command, "--out", str(tmp_path)]) == 4
    assert capsys.readouterr().err == (
        f"coilcheck: cannot write to {tmp_path}: another run is writing there; "
        "wait for it, or give another --out\n"
    )
    assert [file for file in tmp_path.iterdir() if file.is_file()] == []


def test_a_run_beside_another_is_refused_until_that_has_ended(tmp_path, capsys):
    """Two processes: the first waits in the middle of its work."""
    code = (
        "import sys, wirefe; from validation import cli; solve = wirefe.solve\n"
        "def waiting(*a, **k): print(flush=True); input(); return solve(*a, **k)\n"
        "wirefe.solve = waiting; sys.exit(cli.main(sys.argv[1:]))"
    )
    command = ["compare", "spring-b", "--steps", "2", "--quiet", "--out", str(tmp_path)]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen([sys.executable, "-c", code, *command], **pipes) as first:
        first.stdout.readline()
        assert main(command) == 4
        assert main(["solve", "spring-b", "--model", "wirefe", "--out", str(tmp_path / "wirefe")]) == 4
        assert not (tmp_path / "compare.json").exists()
        first.communicate(b"\n")
    assert first.returncode == 0
    assert read_json(tmp_path / "compare.json")["steps"] == 2
    assert main(command) == 0
    assert capsys.readouterr().err.count("another run is writing there") == 2


def test_json_stays_json_whatever_the_numbers():
    found = json_bytes({"nan": math.nan, "list": (math.inf, 1.5), "text": "Feder 弹簧"})
    assert json.loads(found) == {"nan": None, "list": [None, 1.5], "text": "Feder 弹簧"}


def test_a_path_without_rows_is_a_header(tmp_path):
    with pytest.raises(EquilibriumNotFound) as caught:
        equivbeam.solve(coilspring.load_scene("spring-b"), steps=1, penalty=400.0)
    write_files(path_files(path := caught.value.path, summary(path)), tmp_path)
    assert (tmp_path / "path.csv").read_text() == COLUMNS + "\n"


def test_a_top_below_the_bottom_has_nowhere_to_go_on(tmp_path, capsys):
    soft = tmp_path / "soft.toml"
    spring = "wire_diameter = 1.0\nmean_diameter = 11.0\nactive_coils = 6.5\nactive_height = 30.0"
    soft.write_text(f"[spring]\n{spring}\n[load]\nforce = [3.0, -25.0]\nsteps = 10\n")
    assert main(["solve", str(soft), "--model", "wirefe", "--out", str(tmp_path)]) == 3
    output = capsys.readouterr()
    assert "limit_point" in output.out
    assert "passed the bottom" in output.err
    assert "prescribe load.displacement" not in output.out


def test_a_study_that_cannot_go_on_names_scene_and_model(monkeypatch, capsys):
    def study(arguments):
        equivbeam.solve(spring_b(), steps=1, penalty=400.0)

    monkeypatch.setitem(importlib.import_module("validation.cli.command").COMMANDS, "check", study)
    assert main(["check", "spring-a"]) == 3
    assert sentence(capsys).startswith("spring-b: equivbeam: ")


def fake_reproduce(monkeypatch, run):
    module = ModuleType("validation.reproduce.reproduction")
    module.reproduce = run
    monkeypatch.setitem(sys.modules, "validation.reproduce.reproduction", module)


def test_reproduce_passes_its_arguments_on(tmp_path, monkeypatch, capsys):
    calls = []

    def run(*given):
        calls.append(given)
        return ("times are old",)

    fake_reproduce(monkeypatch, run)
    out = str(tmp_path / "new" / "folder")
    assert main(["reproduce", "--out", out]) == 0
    assert capsys.readouterr().out == f"times are old\nwritten to {out}\n"
    assert main(["reproduce", "--out", out, "--no-render", "--only", "fig4,table1"]) == 0
    assert main(["reproduce", "--out", out, "--time"]) == 0
    assert [given[4] for given in calls] == [False, False, True]
    calls.pop()
    assert [given[:3] for given in calls] == [
        (tmp_path / "new" / "folder", None, True),
        (tmp_path / "new" / "folder", ("table1", "fig4"), False),
    ]
    assert calls[0][3]("working") is None


@pytest.mark.parametrize(
    ("error", "code", "said"),
    [
        (KeyboardInterrupt(), 130, "interrupted"),
        (PermissionError(13, "Permission denied"), 4, "Permission denied"),
        (coilspring.InputError("field must be\nright"), 2, "field must be right"),
    ],
)
def test_what_ends_a_command_has_its_exit_code_and_one_line(error, code, said, tmp_path, monkeypatch, capsys):
    def end(*_):
        raise error

    fake_reproduce(monkeypatch, end)
    assert main(["reproduce", "--out", str(tmp_path)]) == code
    assert said in sentence(capsys)


def test_the_real_reproduce_takes_what_the_command_passes():
    reproduce = importlib.import_module("validation.reproduce.reproduction").reproduce
    names = reproduce.__code__.co_varnames[: reproduce.__code__.co_argcount]
    assert names == ("out", "only", "render", "progress", "time", "turned")


def test_json_is_what_the_file_holds_and_quiet_is_nothing(tmp_path, capsys):
    solve = ["solve", "spring-b", "--model", "equivbeam", "--steps", "3", "--out", str(tmp_path)]
    compare = ["compare", "spring-b", "--steps", "3", "--out", str(tmp_path)]
    for command, file in ((solve, "summary.json"), (compare, "compare.json")):
        assert main([*command, "--json"]) == 0
        output = capsys.readouterr()
        assert json.loads(output.out) == read_json(tmp_path / file)
        assert output.err == ""
        assert main([*command, "--quiet"]) == 0
        assert capsys.readouterr() == ("", "")


def test_quiet_still_says_what_went_wrong(tmp_path, capsys):
    free = tmp_path / "free.toml"
    main(["new", "spring-b"])
    text = capsys.readouterr().out.replace('sliding = "none"', 'sliding = "free"')
    free.write_text(text, encoding="utf-8")
    assert main(["solve", str(free), "--model", "wirefe", "--quiet", "--out", str(tmp_path)]) == 3
    output = capsys.readouterr()
    assert output.out == ""
    assert output.err.startswith("coilcheck: wirefe: ")


def test_a_run_says_what_it_takes_the_place_of(tmp_path, capsys):
    call = ["solve", "spring-a", "--steps", "1", "--out", str(tmp_path)]
    said = []
    for options in (["equivbeam"], ["equivbeam"], ["equivbeam", "--law", "helix"], ["wirefe"]):
        assert main([*call, "--model", *options]) == 0
        said.append([line for line in capsys.readouterr().out.splitlines() if "in place of" in line])
    assert said[:2] == [[], []]
    assert said[2] == ["in place of a run by equivbeam (law haringx), which was there"]
    assert said[3][0].startswith("in place of a run by equivbeam (law helix")
    assert main([*call, "--model", "equivbeam"]) == 0  # which knows none of the options of a mesh
    mesh = "(element straight, elements_per_turn 40, pairs_per_turn 4)"  # but no results
    assert f"in place of a run by wirefe {mesh}, which was there" in capsys.readouterr().out
    assert main([*call, "--model", "wirefe"]) == 0
    capsys.readouterr()
    call[1] = "spring-b"
    assert main([*call, "--model", "wirefe"]) == 0
    assert "in place of a run of spring-a by wirefe, which was there" in capsys.readouterr().out
    (tmp_path / "summary.json").write_text('{"model": "wirefe", "options": []}')
    assert main([*call, "--model", "equivbeam"]) == 0
    assert "in place of" not in capsys.readouterr().out


@pytest.mark.parametrize("folder", ["", "equivbeam"], ids=["solve", "compare"])
def test_files_of_no_run_are_kept_under_another_name(folder, tmp_path, capsys):
    """They were overwritten or removed without a word; what is the same is kept once."""
    there = tmp_path / folder
    there.mkdir(exist_ok=True)
    command = ["compare"] if folder else ["solve", "--model", "equivbeam"]
    said = []
    for text in ("mine", "mine", "other", None):
        if text:
            (there / "summary.json").unlink(missing_ok=True)
            (there / "path.csv").write_text(text)
            (there / "stress.csv").write_text(text)
        assert main([*command, "spring-b", "--steps", "1", "--out", str(tmp_path)]) == 0
        said.append([line for line in capsys.readouterr().out.splitlines() if "path.csv" in line])
        assert (there / "stress.csv").exists() == bool(text)  # a run has no stresses of the one before
        assert read_rows(there / "path.csv")
    what = "path.csv, which was there and is of no run, is kept in"
    assert said == [[f"{what} {there / name}"] for name in ("path.1.csv", "path.1.csv", "path.2.csv")] + [[]]
    assert [(there / f"path.{number}.csv").read_text() for number in (1, 2)] == ["mine", "other"]


def test_a_comparison_beside_it_does_not_make_a_file_one_of_a_run(tmp_path, capsys):
    """And a run removes nothing of the comparison."""
    assert main(["compare", "spring-b", "--steps", "1", "--draw", "--out", str(tmp_path)]) == 0
    (tmp_path / "path.csv").write_text("mine")
    assert main(["solve", "spring-b", "--model", "equivbeam", "--steps", "1", "--out", str(tmp_path)]) == 0
    assert f"is kept in {tmp_path / 'path.1.csv'}" in capsys.readouterr().out
    assert (tmp_path / "path.1.csv").read_text() == "mine"
    assert (tmp_path / "compare.png").exists()


@pytest.mark.parametrize("earlier", [False, True], ids=["of no run", "of a run"])
def test_a_file_that_cannot_be_read_is_exit_4(earlier, tmp_path, monkeypatch, capsys):
    call = ["solve", "spring-b", "--model", "equivbeam", "--steps", "1", "--out", str(tmp_path)]
    (tmp_path / "path.csv").write_text("mine")
    assert main(call) == 0
    if not earlier:
        (tmp_path / "summary.json").unlink()
    capsys.readouterr()

    def denied(_):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Path, "read_bytes", denied)
    assert main(call) == 4
    name = "summary.json" if earlier else "path.csv"
    assert sentence(capsys) == f"cannot write to {tmp_path / name}: Permission denied"


def test_what_is_removed_is_said(tmp_path, capsys):
    call = ["solve", "spring-a", "--model", "wirefe", "--steps", "1", "--out", str(tmp_path)]
    for options, said in (["--stress", "--vtu"], False), ([], True), ([], False):
        assert main([*call, *options]) == 0
        line = "stress.csv, wire.vtu of the run that was there: removed"
        assert (line in capsys.readouterr().out.splitlines()) == said
    assert sorted(file.name for file in tmp_path.iterdir()) == ["path.csv", "summary.json"]


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ("check spring-a --out", "--out"),
        ("solve spring-a --model equivbeam --out", "--out"),
        ("compare spring-a --measured", "--measured"),
        ("regress spring-a --baselines", "--baselines/--baseline"),
        ("view spring-a --movie", "--movie"),
        ("view", "SCENE|RUN"),
        ("study-law", "FILE.py"),
        ("calibrate spring-a --fit axial", "MEASURED.csv"),
    ],
)
def test_no_name_of_a_place_is_refused(arguments, name, tmp_path, monkeypatch, capsys):
    """As of a shell's variable that is not set: it was the folder one is in, or ignored."""
    monkeypatch.chdir(tmp_path)
    assert main([*arguments.split(), ""]) == 2
    assert sentence(capsys).startswith(f"argument {name}: must be the name of a file or folder, got ''")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("room", [0, 4, None], ids=["none", "for a part", "not in memory"])
def test_a_solve_goes_on_where_there_is_no_room_for_its_mailbox(room, monkeypatch):
    """Room is the system's limit, whichever call meets it; no file stays open."""
    from coilspring.solver import interrupt

    def no_memory(*_):
        raise OSError(errno.ENOMEM, "Cannot allocate memory")

    interrupt._mailbox.cache_clear()
    limits, opened = resource.getrlimit(resource.RLIMIT_FSIZE), len(os.listdir("/proc/self/fd"))
    if room is None:
        monkeypatch.setattr(mmap, "mmap", no_memory)
    else:
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, limits[1]))
    try:
        assert interrupt.interruptible(lambda flag: flag.tolist()) == [0]
        assert len(os.listdir("/proc/self/fd")) == opened
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        interrupt._mailbox.cache_clear()


def test_a_run_is_traced_to_its_scene_and_says_which_keys_it_replaces(tmp_path, capsys):
    """A file that was edited, and another file of the same name, were replaced without a word."""
    file, other = tmp_path / "a.toml", tmp_path / "other.toml"
    file.write_text(scene_text(spring_a()), encoding="utf-8")
    thick = scene_text(spring_a()).replace("wire_diameter = 1.5", "wire_diameter = 1.6")
    other.write_text(thick, encoding="utf-8")
    call = ["--model", "wirefe", "--steps", "1", "--out", str(tmp_path)]
    said = []
    for source, more in ((file, []), (file, []), (other, []), (other, ["--geometry", "wires"])):
        assert main(["solve", str(source), *call, *more]) == 0
        said.append([line for line in capsys.readouterr().out.splitlines() if "in place of" in line])
    assert said[:2] == [[], []]
    assert said[2] == ["in place of a run by wirefe (spring.wire_diameter 1.5), which was there"]
    assert said[3] == [
        "in place of a run by wirefe (pairs_per_turn 4, contact.geometry spheres), which was there"
    ]
    found = read_json(tmp_path / "summary.json")["scene_table"]
    assert scene_from_table(found) == coilspring.load_scene(other).overridden(steps=1, geometry="wires")


def test_a_comparison_says_what_it_takes_the_place_of(tmp_path, capsys):
    said = []
    for scene in ("spring-a", "spring-a", "spring-b"):
        assert main(["compare", scene, "--steps", "1", "--out", str(tmp_path)]) == 0
        said.append([line for line in capsys.readouterr().out.splitlines() if "in place of" in line])
    models = ("equivbeam", "wirefe")
    assert said[:2] == [[], []]
    assert said[2] == [f"in place of a run of spring-a by {model}, which was there" for model in models]


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("solve spring-a --model equivbeam --out afile", "afile: it is a file, not a folder"),
        ("solve spring-a --model equivbeam --out afile/a/b", "afile/a/b: afile is a file, not a folder"),
        ("view spring-a --movie afile/a.gif", "afile/a.gif: afile is a file, not a folder"),
        ("view spring-a --movie /proc/a.gif", "/proc/a.gif: No such file or directory"),
        ("regress spring-a --accept --baselines afile", "afile/spring-a: afile is a file, not a f"),
    ],
)
def test_a_file_in_the_place_of_a_folder_is_told(command, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("afile").touch()
    assert main(command.split()) == 4
    assert sentence(capsys).startswith(f"cannot write to {said}")


LONG = "a" * 300  # longer than a file system takes, and so of no use for root either


@pytest.mark.parametrize(
    ("command", "code", "said"),
    [
        (f"solve spring-a --model equivbeam --out {LONG}", 4, f"cannot write to {LONG}: "),
        (f"reproduce --only table1 --out {LONG}", 4, f"cannot write to {LONG}: "),
        (f"view spring-a --movie {LONG}/a.gif", 4, f"cannot write to {LONG}/a.gif: "),
        (f"regress spring-a --accept --baselines {LONG}", 4, f"cannot write to {LONG}/spring-a: "),
        (f"regress --baselines {LONG}", 2, f"--baselines must name a folder that can be read, got {LONG} ("),
        (f"view {LONG} --movie a.gif", 2, f"SCENE must be one of {', '.join(coilspring.CATALOGUE)} or a "),
        ("view . --movie a.gif", 2, ". holds no wire.pvd that can be read (Is a directory): "),
    ],
)
def test_a_place_that_cannot_be_used_is_one_sentence(command, code, said, tmp_path, monkeypatch, capsys):
    """What is read is bad input; of two places that are written, the one that cannot be is named."""
    monkeypatch.chdir(tmp_path)
    Path("wire.pvd").mkdir()
    assert main(command.split()) == code
    message = sentence(capsys)
    assert message.startswith(said)
    assert ("File name too long" in message) == (LONG in command)


def test_the_help_says_what_the_equivalent_stress_and_the_modes_are(capsys):
    with pytest.raises(SystemExit):
        main(["solve", "--help"])
    said = " ".join(capsys.readouterr().out.split())
    assert "equivalent: after von Mises, an upper bound" in said
    assert "axial, lateral or torsional" in said


def test_the_help_says_that_a_selection_is_without_the_report(capsys):
    with pytest.raises(SystemExit):
        main(["reproduce", "--help"])
    assert "The report is of all tables and figures: --only leaves it out." in " ".join(
        capsys.readouterr().out.split()
    )


def test_a_law_that_is_not_there_is_named_once(capsys):
    assert main(["solve", "spring-a", "--model", "equivbeam", "--law", "nosuch.py"]) == 2
    said = "--law must be a Python file that can be read, got 'nosuch.py' (No such file or directory)"
    assert sentence(capsys) == said


def test_an_interruption_while_the_command_is_imported_is_one_sentence(monkeypatch, capsys):
    """It waits for the end of an import, which would say that it is broken, as numpy's does."""

    def interrupt(name, *rest):
        if name == "validation.cli.command":
            signal.raise_signal(signal.SIGINT)
            imported.append(name)
        return found(name, *rest)

    found, imported = builtins.__import__, []
    monkeypatch.setattr(builtins, "__import__", interrupt)
    assert main(["new", "spring-a"]) == 130
    assert imported
    assert capsys.readouterr().err == "coilcheck: interrupted\n"
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())


def test_unknown_words_are_answered_with_the_help_of_their_command(capsys):
    assert main(["calibrate", "spring-a", "m.csv", "--fit", "axial", "offset"]) == 2
    assert capsys.readouterr().err.endswith(
        "unrecognized arguments: offset; see coilcheck calibrate --help\n"
    )
    assert main(["solve", "spring-a", "--accuracy", "1e-3", "--elements_per_turn", "4"]) == 2
    assert "unrecognized arguments: --elements_per_turn 4; see coilcheck solve" in capsys.readouterr().err
