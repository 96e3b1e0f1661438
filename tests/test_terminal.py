"""What the command says at the terminal: progress, whatever the encoding, and a closed output."""

import json
import math
import os
import re
import subprocess
import sys
from contextlib import nullcontext
from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest

import equivbeam
import wirefe
from coilspring import (
    Contact,
    Factors,
    Load,
    Scene,
    Spring,
    Supports,
    load_scene,
    scene_text,
    spring_a,
    spring_b,
)
from coilspring.compiling.compiled import kernel
from coilspring.curves import compare_paths
from coilspring.solver.startup import stored
from coilspring.sweep import outcome_of
from validation.cli import main
from validation.cli.terminal import FIRST, announcing, deviation, digest, notes, progress_shown
from validation.study import output
from validation.study.lawwarning import law_warning
from validation.study.partialsolve import partial_path
from wirefe.solve import KERNELS


def test_progress_is_shown_on_a_terminal_only(monkeypatch, capsys):
    with progress_shown() as progress:
        progress("working")
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setenv("TERM", "xterm")
    with progress_shown() as progress:
        progress("working [on it]")
    output = capsys.readouterr()
    assert output.out == ""
    assert "working [on it]" in output.err


@pytest.mark.parametrize("command", ["check", "solve", "compare", "sweep"])
def test_the_first_compilation_is_announced(command, monkeypatch, tmp_path):
    """It is half a minute in which nothing else is said; kernels on the disk are not spoken of."""
    more = {"solve": ["--model", "wirefe"], "sweep": ["--vary", "load.force.1=-1,-2", "--workers", "0"]}
    steps = ["--steps", "1"] if command != "check" else []
    call = [command, "spring-a", *steps, *more.get(command, []), "--out", str(tmp_path)]
    for missing in (False, True):
        lines: list[str] = []
        monkeypatch.setattr(
            "validation.cli.command.progress_shown", lambda *_, to=lines: nullcontext(to.append)
        )
        monkeypatch.setattr("coilspring.solver.startup.stored", lambda kernels, missing=missing: not missing)
        assert main(call) == 0
        first = [line for line in lines if line.startswith(("solving with", "0 of 2", "2 of 2"))]
        assert first
        assert all(("making the kernels ready" in line) == missing for line in first)


def test_the_first_compilation_of_the_kernels_for_plates_is_announced(monkeypatch):
    monkeypatch.setattr("coilspring.solver.startup.stored", lambda kernels: kernels == KERNELS)
    lines: list[str] = []
    for scene in (spring_a(), load_scene("examples/plates.toml")):
        announcing(lines.append, "wirefe", scene)("solving")
    assert lines == ["solving", f"solving {FIRST}"]


def test_kernels_are_on_the_disk_once_they_were_compiled():
    kernels = import_module("equivbeam.solve").KERNELS
    equivbeam.solve(spring_a(), steps=1)
    assert stored(kernels)
    unknown = kernel(lambda x: 2.0 * x + len("never compiled"))
    assert not stored(kernels._replace(work=unknown))


def run_apart(folder, *options, **settings):
    """The command in a process of its own, with the output folder `folder`."""
    arguments = ["solve", "spring-a", "--model", "equivbeam", "--steps", "1", "--out", str(folder), *options]
    return subprocess.run(
        [sys.executable, "-m", "validation.cli", *arguments], stderr=subprocess.PIPE, check=False, **settings
    )


def test_output_survives_a_narrow_encoding(tmp_path):
    narrow = os.environ | {"PYTHONIOENCODING": "ascii"}
    done = run_apart(tmp_path / "弹簧", stdout=subprocess.PIPE, env=narrow)
    assert done.returncode == 0
    assert b"\\u5f39\\u7c27" in done.stdout
    assert done.stderr == b""


@pytest.mark.parametrize("option", [(), ("--help",)])
def test_where_nobody_reads_any_more_the_command_ends_quietly(option, tmp_path):
    """As what `| head` ends, by the signal SIGPIPE; it was exit code 4 and a sentence, or a traceback."""
    reader, writer = os.pipe()
    os.close(reader)
    done = run_apart(tmp_path, *option, stdout=writer)
    os.close(writer)
    assert (done.returncode, done.stderr) == (141, b"")
    assert (tmp_path / "summary.json").exists() == (not option)


def run_in_shell(command, streams, stderr=subprocess.PIPE):
    """The command with its streams as a shell has it."""
    call = ["sh", "-c", f'"$0" -m validation.cli {command} {streams}', sys.executable]
    return subprocess.run(call, stdout=subprocess.PIPE, stderr=stderr, check=False)


@pytest.mark.parametrize("command", ["--help", "--version", "check spring-a"])
def test_where_the_standard_output_is_closed_nothing_is_said(command):
    """It was a traceback."""
    done = run_in_shell(command, ">&-")
    assert (done.returncode, done.stdout, done.stderr) == (0, b"", b"")


@pytest.mark.parametrize("streams", ["", ">&2", "2>&-", ">&- 2>&-", "2>/dev/full"])
def test_an_error_that_cannot_be_said_keeps_its_exit_code(streams):
    """It was 1, which is for findings, or said where results are."""
    reader, writer = os.pipe()
    os.close(reader)
    done = run_in_shell("solve spring-a", streams, stderr=writer)
    os.close(writer)
    assert (done.returncode, done.stdout) == (2, b"")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no file that is always full")
@pytest.mark.parametrize("option", [(), ("--help",)])
def test_a_standard_output_that_is_full_is_exit_4(option, tmp_path):
    with open("/dev/full", "w") as full:
        done = run_apart(tmp_path, *option, stdout=full)
    assert done.returncode == 4
    assert done.stderr == b"coilcheck: cannot write to standard output: No space left on device\n"


def test_one_iteration_is_singular():
    scene = spring_a()
    for steps, words in ((1, " 1 iteration,"), (2, "iterations,")):
        path = replace(equivbeam.solve(scene, steps=steps), total_iterations=steps)
        assert words in digest(path)[-1]


def test_the_largest_stress_is_that_of_the_whole_path():
    """A load that is taken back ends without stress."""
    path = wirefe.solve(load_scene("examples/stages.toml"), element="curved", elements_per_turn=4, steps=5)
    most = path.max_stress.argmax()
    assert path.max_stress[-1] < 0.5 * path.max_stress[most]
    said = f"stress {path.max_stress[most]:.4g} MPa at most, at time {path.times[most]:g}"
    _, turns = wirefe.stress(path, int(most)).largest()
    assert any(f"{said} and turn {turns:.3g} (" in line for line in digest(path))
    found = output.summary(path)["largest_stress"]
    assert found == {"value": path.max_stress[most], "time": path.times[most], "turns": turns}
    assert output.summary(equivbeam.solve(spring_a(), steps=1))["largest_stress"] is None
    assert outcome_of(path.scene, lambda scene: path).max_stress == path.max_stress[most]


def test_the_largest_deflection_is_said_where_the_load_is_taken_back():
    scene = load_scene("examples/stages.toml")
    path = wirefe.solve(scene, element="curved", elements_per_turn=4, steps=5)
    far = int(np.abs(path.tips[:, 1]).argmax())
    said = f"  largest uy {path.tips[far, 1]:.6g} mm, at time {path.times[far]:g}"
    assert far < len(path.times) - 1
    assert said in digest(path)
    assert not any("largest uy" in line for line in digest(equivbeam.solve(spring_b(), steps=2)))
    back = equivbeam.solve(spring_a(), steps=5)
    back = replace(back, states=back.states[::-1])  # of one stage: it may go to and fro
    assert not any("largest uy" in line for line in digest(back))


def test_kernels_are_told_where_they_took_time():
    path = equivbeam.solve(spring_b(), steps=2)
    assert "kernels" not in digest(replace(path, compile_seconds=1e-6))[-1]
    slow = replace(path, compile_seconds=104.2, solve_seconds=1234.0)
    assert digest(slow)[-1].endswith(" 1200 s CPU (and 100 s to make the kernels ready)")


def test_advice_at_a_limit_point_is_of_the_load():
    path = partial_path(wirefe.solve, replace(spring_b(), load=Load((0.0, -400.0), 10)))
    prescribed = replace(
        path, outcome="limit_point", scene=replace(path.scene, load=Load(displacement=(-9.0,)))
    )
    said = "\n".join(notes(prescribed))
    assert "where the prescribed displacement is largest" in said
    assert "prescribe load.displacement" not in said


ADVICE = {"spheres": "--geometry wires", "wires": "--pairs-per-turn"}


@pytest.mark.parametrize("geometry", ADVICE)
def test_advice_at_a_limit_point_is_of_the_scenes_contact(geometry):
    """Never to make pairs stick, which is another spring; without contact none."""
    scene = replace(spring_b(), load=Load((0.0, -400.0), 10), contact=Contact(geometry=geometry))
    path = partial_path(wirefe.solve, scene, element="curved", elements_per_turn=8)
    assert path.outcome == "limit_point"
    said = "\n".join(notes(path))
    assert "a limit point is where the load is largest" in said
    assert [flag in said for flag in ADVICE.values()] == [kind == geometry for kind in ADVICE]
    assert "none" not in said


def test_advice_is_no_longer_given_where_it_was_taken():
    scene = replace(spring_b(), load=Load((0.0, -400.0), 10), contact=Contact(geometry="wires"))
    path = partial_path(wirefe.solve, scene, element="curved", elements_per_turn=8, pairs_per_turn=64)
    assert path.outcome == "limit_point"
    assert "--pairs-per-turn" not in "\n".join(notes(path))


def test_advice_where_spheres_let_coils_pass():
    path = partial_path(wirefe.solve, spring_b(), element="curved", elements_per_turn=4)
    through = "between spheres coils may pass each other: see --geometry wires"
    assert through not in notes(path)
    assert through in notes(replace(path, outcome="interpenetration"))


def test_the_wire_models_own_error_stands_beside_a_comparison():
    scene = spring_a().without_contact().with_steps(4)
    beam, wire = equivbeam.solve(scene), wirefe.solve_to(scene, 1e-3)
    said = deviation(compare_paths(beam, wire), wire)
    assert (
        said[-1]
        == f"  the wire model's own error, by its mesh: {100 * wire.estimated_error:.2g} % (estimated)"
    )
    assert deviation(compare_paths(beam, wire), replace(wire, estimated_error=None))[-1].endswith(
        "--accuracy X does"
    )


@pytest.mark.parametrize("steps", [1, 10])
def test_a_bifurcation_of_wires_that_touch_may_be_for_want_of_stations(steps):
    """At 0.607, where with 128 stations there is none; in one step no state before it is written."""
    spring = Spring(1.5, 10.0, active_coils=14.5, active_height=60.0)
    scene = Scene("column", spring, Load((0.0, -150.0), steps), supports=Supports(("ux", "rotz")))
    path = partial_path(wirefe.solve, scene)
    assert (path.outcome, len(path.times)) == ("bifurcation", 0 if steps == 1 else 6)
    assert any("stations are few" in note for note in notes(path))
    enough = replace(path, options=path.options | {"pairs_per_turn": 64})
    assert not any("stations are few" in note for note in notes(enough))
    assert wirefe.solve(scene, pairs_per_turn=128).outcome == "completed"


def test_what_was_asked_for_of_no_step_is_said_to_be_missing(tmp_path, capsys):
    """Spring B's spheres without friction end at a limit point: in one step no state is written."""
    (tmp_path / "b.toml").write_text(scene_text(spring_b()).replace('sliding = "none"', 'sliding = "free"'))
    asked = ["--frequencies", "3", "--stress", "--vtu"]
    call = ["solve", str(tmp_path / "b.toml"), "--model", "wirefe", "--steps", "1", "--out", str(tmp_path)]
    assert main([*call, *asked]) == 3
    assert "nothing for --frequencies, --vtu, --stress: more --steps" in capsys.readouterr().out
    assert json.loads((tmp_path / "summary.json").read_text())["frequencies"] is None
    assert main(call) == 3
    assert "nothing for" not in capsys.readouterr().out


def test_where_coils_begin_is_said_to_matter_to_the_law(tmp_path, capsys):
    """Of 2.5 coils that begin out of the working plane: the paper's law has UX and ROTZ wrong by half."""
    spring = Spring(1.5, 10.0, active_coils=2.5, active_height=9.0, start_phase=math.pi / 2.0)
    scene = Scene("phase", spring, Load((3.0, -20.0), 1), contact=Contact(enabled=False))
    wire = wirefe.solve(scene, element="curved", elements_per_turn=8).tips[-1]
    tips = {law: equivbeam.solve(scene, law=law).tips[-1] for law in ("haringx", "helix")}
    told = float(re.search(r"differs by ([0-9.]+) % in rotz from law helix", law_warning(scene))[1])
    assert told == pytest.approx(100.0 * abs(tips["haringx"][2] / tips["helix"][2] - 1.0), rel=0.1)
    assert told > 40.0
    assert tips["helix"] == pytest.approx(wire, rel=0.02)
    file = tmp_path / "phase.toml"
    file.write_text(scene_text(scene))
    for command in (["check"], ["solve", "--model", "equivbeam", "--out", str(tmp_path / "out")]):
        assert main([command[0], str(file), *command[1:]]) == 0
        assert (
            "% in rotz from law helix, which knows where coils begin: see --law helix"
            in capsys.readouterr().out
        )
    assert not any("law helix" in note for note in notes(equivbeam.solve(scene, law="helix")))
    assert law_warning(spring_a()) == law_warning(spring_b()) == ""
    assert law_warning(replace(scene, factors=Factors(bending=0.9))) == ""  # the law was fitted
    held = Load(stages=((50.0, -3.0), (100.0, 0.0)), steps=1)  # the larger force is borne by the support
    assert law_warning(replace(spring_a(), load=held, supports=Supports(("ux",)))) == ""
