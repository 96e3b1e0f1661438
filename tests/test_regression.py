"""Regression: a clean rerun passes, planted faults are caught and named, and baselines are guarded."""

import copy
import json
import re
import sys
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import equivbeam
import equivbeam.laws.haringx
import equivbeam.laws.helix
import equivbeam.model
import validation.regress.baselines
import validation.regress.run
import wirefe.contact.points
import wirefe.model
from coilspring import (
    CATALOGUE,
    EquilibriumNotFound,
    InputError,
    Load,
    Scene,
    Spring,
    load_scene,
    scene_text,
    spring_a,
)
from equivbeam import Refinements
from validation.cli import main
from validation.regress import timeratios
from validation.regress.baselines import COARSE, SHIPPED, Run, find, quantities, read, runs, runs_of
from validation.regress.run import Finding, Move, compare, regress
from validation.regress.run import _scene_moves as scene_moves
from validation.study import paths
from validation.study.cases import CASES
from validation.study.machine import _processor, machine
from validation.study.models import MODELS

# the models' modules, which their own functions `solve` hide
BEAM_SOLVE, WIRE_SOLVE = sys.modules["equivbeam.solve"], sys.modules["wirefe.solve"]
FAULT = 1.001  # 0.1 % off
MEASURE = timeratios.measure


def few(*parts):
    """Runs whose name or model holds one of the parts."""
    return [run for run in runs() if any(part in f"{run.model}: {run.name}," for part in parts)]


def only(name):
    """The run of that name."""
    return [run for run in runs() if run.name == name]


LAWS = few("law=haringx,", "law=helix,")
CURVED = [run for run in few("element=curved, elements_per_turn=4,") if "slender" not in run.name]


@pytest.fixture(autouse=True)
def no_timing(monkeypatch):
    """Ratios of times are not what is tested here."""
    monkeypatch.setattr(timeratios, "measure", lambda progress, scene: ({"a / b": 2.0}, ()))


@pytest.fixture(scope="module")
def before():
    """What the sound models find."""
    return found_now([*LAWS, *CURVED])


def found_now(chosen):
    return find(chosen, lambda line: None)[0]


def as_baseline(found, processor="here"):
    return {model: {"made": {"processor": processor}, "runs": found[model]} for model in MODELS}


def moved(before, chosen, processor="here"):
    """What moved in the chosen runs, with the quantities' names."""
    kept = {
        model: {run.name: rows[run.name] for run in chosen if run.model == model}
        for model, rows in before.items()
    }
    return compare(as_baseline(kept), found_now(chosen), processor)


def kinds(moves):
    return {move.quantity.split(" at ")[0] for move in moves}


def test_a_clean_rerun_finds_nothing(before):
    assert moved(before, [*LAWS, *CURVED]) == ()


@pytest.mark.parametrize("column", [0, 1, 2], ids=["Kax", "Ksh", "Kfl"])
def test_a_stiffness_of_the_papers_law_is_caught(before, column, monkeypatch):
    sound = equivbeam.laws.haringx.haringx_stiffness
    factors = np.where(np.arange(3) == column, FAULT, 1.0)
    monkeypatch.setattr(equivbeam.laws.haringx, "haringx_stiffness", lambda *given: sound(*given) * factors)
    moves = moved(before, LAWS)
    assert {"ux", "uy", "rotz"} & kinds(moves)
    assert not any("law=helix" in move.run for move in moves)
    assert "1e-07 allowed" in str(next(move for move in moves if move.quantity.startswith("u")))


@pytest.mark.parametrize("part", ["GJ", "EI", "GA", "EA"])
def test_a_stiffness_of_the_wire_is_caught(before, part, monkeypatch):
    places = (
        (wirefe.model, "round_section", CURVED),
        (equivbeam.laws.helix, "coil_section", few("law=helix,")),
    )
    for module, name, chosen in places:
        sound = getattr(module, name)
        with monkeypatch.context() as patch:
            patch.setattr(module, name, lambda *given, s=sound: off(s(*given), part))
            assert {"ux", "uy"} & kinds(moved(before, chosen))


def off(section, part):
    return replace(section, **{part: FAULT * getattr(section, part)})


@pytest.mark.parametrize(
    ("module", "name", "chosen"),
    [(equivbeam.model, "BeamModel", LAWS), (wirefe.contact.points, "ContactArrays", CURVED)],
    ids=MODELS,
)
def test_a_contact_stiffness_is_caught(before, module, name, chosen, monkeypatch):
    sound, of_b = getattr(module, name), [run for run in chosen if run.name.startswith("spring-b, ")]
    monkeypatch.setattr(module, name, lambda **given: sound(**given | {"kc": FAULT * given["kc"]}))
    assert "max_penetration" in kinds(moved(before, of_b))


@pytest.mark.parametrize("solve", [BEAM_SOLVE, WIRE_SOLVE], ids=MODELS)
def test_one_more_iteration_a_step_is_caught(before, solve, monkeypatch):
    sound = solve.follow_load

    def slower(*given, **options):
        run = sound(*given, **options)
        return replace(run, track=replace(run.track, iterations=run.track.iterations + 1))

    monkeypatch.setattr(solve, "follow_load", slower)
    chosen = LAWS if solve is BEAM_SOLVE else CURVED
    moves = moved(before, chosen)
    assert kinds(moves) == {"iterations", "total_iterations"}
    reached = [run for run in chosen if before[run.model][run.name]["steps_reached"]]
    assert {move.run for move in moves} == {f"{run.model}, {run.name}" for run in reached}
    if solve is WIRE_SOLVE:
        assert "+50 in all, 50 steps moved, 0 allowed a step" in str(moves[0])


def test_a_predictor_switched_off_is_caught(before, monkeypatch):
    sound = BEAM_SOLVE.follow_load
    monkeypatch.setattr(
        BEAM_SOLVE, "follow_load", lambda *given, **options: sound(*given, **options | {"predictor": False})
    )
    assert "iterations" in kinds(moved(before, LAWS))


@pytest.mark.parametrize("which", ["all", "one"])
def test_a_contact_side_swapped_is_caught(before, which, monkeypatch):
    sound = equivbeam.model._circles

    def swapped(scene, count):
        attached, offset = sound(scene, count)
        offset[slice(None) if which == "all" else 8, 0] *= -1.0
        return attached, offset

    monkeypatch.setattr(equivbeam.model, "_circles", swapped)
    moves = moved(before, LAWS)
    assert {"contact_force", "force_times_number", "outcome"} & kinds(moves)
    assert not any("no-contact" in move.run for move in moves)


@pytest.mark.parametrize("name", list(vars(Refinements())))
def test_a_refinement_of_the_helix_law_switched_off_is_caught(before, name, monkeypatch):
    monkeypatch.setattr(equivbeam.model, "ALL", Refinements(**{name: False}))
    moves = moved(before, few("law=helix,"))
    assert {"ux", "uy", "rotz"} & kinds(moves)


def test_another_processor_may_count_one_more_a_step(before):
    later = copy.deepcopy(before)
    for row in later["wirefe"].values():
        row["iterations"] = [count + 1 for count in row["iterations"]]
        row["total_iterations"] += row["steps_reached"]
        row["ux"] = [value * (1.0 + 5e-7) for value in row["ux"]]
    kept = as_baseline(before)
    assert compare(kept, later, "elsewhere") == ()
    assert kinds(compare(kept, later, "here")) == {"iterations", "total_iterations", "ux"}
    for row in later["wirefe"].values():
        row["iterations"] = [count + 1 for count in row["iterations"]]
    assert kinds(compare(kept, later, "elsewhere")) == {"iterations"}


def test_another_processor_may_cut_a_step_back_more_often(before):
    earlier = copy.deepcopy(before)
    row = next(iter(earlier["wirefe"].values()))
    row["iterations"] = [60, *[1] * (len(row["iterations"]) - 1)]
    row["total_iterations"] = sum(row["iterations"])
    later = copy.deepcopy(earlier)
    row = next(iter(later["wirefe"].values()))
    row["iterations"][0] += 17
    row["total_iterations"] += 17
    assert compare(as_baseline(earlier), later, "elsewhere") == ()
    assert kinds(compare(as_baseline(earlier), later, "here")) == {"iterations", "total_iterations"}
    row["iterations"][0] = 81
    assert kinds(compare(as_baseline(earlier), later, "elsewhere")) == {"iterations"}


def test_kinds_of_processors_with_one_name_are_told_apart(monkeypatch):
    here = machine()["processor"]
    monkeypatch.setattr("llvmlite.binding.get_host_cpu_name", lambda: "another")
    _processor.cache_clear()
    assert machine()["processor"] != here
    _processor.cache_clear()


def test_without_sliding_another_processor_may_choose_other_substeps(before):
    later = copy.deepcopy(before)
    for row in later["wirefe"].values():
        row["uy"] = [value * (1.0 + 5e-5) for value in row["uy"]]
    found = compare(as_baseline(before), later, "elsewhere")
    assert {move.run.split(", ")[1] for move in found} == {
        "spring-a",
        "spring-a-no-contact",
        "spring-b-no-contact",
    }


@pytest.mark.parametrize(
    ("change", "quantity"),
    [
        ({"outcome": "limit_point"}, "outcome"),
        ({"steps_reached": 49}, "steps_reached"),
        ({"critical_time": 0.5}, "critical_time"),
        ({"contact_force": 1e-3}, "contact_force"),
        ({"extra": 1}, "extra"),
        ({"load_y": [1.0] * 5}, "load_y"),
    ],
)
def test_every_other_quantity_is_judged(before, change, quantity):
    later = copy.deepcopy(before)
    name = "spring-a-no-contact, law=haringx"
    later["equivbeam"][name].update(change)
    found = compare(as_baseline(before), later, "here")
    assert kinds(found) == {quantity}
    assert found[0].run == f"equivbeam, {name}"


def test_a_critical_time_is_judged_by_its_own_tolerance(before):
    later = copy.deepcopy(before)
    row = later["equivbeam"]["spring-b-free, law=haringx, penalty=400.0"]
    assert row["outcome"] == "limit_point"
    row["critical_time"] += 5e-7
    kept = as_baseline(before)
    assert compare(kept, later, "elsewhere") == ()
    assert "+5e-07 of time, 1e-07 allowed" in str(compare(kept, later, "here")[0])


def test_where_rounding_decides_the_critical_time_is_judged_loosely():
    before = found_now([run for run in runs() if run.sensitive])
    later = copy.deepcopy(before)
    (row,) = later["wirefe"].values()
    assert row["critical_time"] is not None
    row["critical_time"] += 5e-5
    row["total_iterations"] += 70
    assert compare(as_baseline(before), later, "here") == ()
    row["critical_time"] += 1e-3
    assert kinds(compare(as_baseline(before), later, "here")) == {"critical_time"}


def test_what_moved_is_said_with_its_unit(before):
    later = copy.deepcopy(before)
    row = later["equivbeam"]["spring-b, law=haringx"]
    row["uy"][-1] *= 1.01
    row["contact_force"] *= 1.01
    row["max_penetration"] *= 1.01
    moves = {move.quantity.split()[0]: move for move in compare(as_baseline(before), later, "here")}
    for name, unit in (("uy", "mm"), ("contact_force", "N"), ("max_penetration", "mm")):
        assert re.search(rf" was -?[\d.]+ {unit}, is -?[\d.]+ {unit} \(", str(moves[name]))


def test_runs_without_a_baseline_and_the_reverse_count(before):
    later = copy.deepcopy(before)
    later["wirefe"]["new"] = later["wirefe"].pop("spring-a, element=curved, elements_per_turn=4")
    found = compare(as_baseline(before), later, "here")
    assert [(move.before, move.now) for move in found] == [
        ("in the baselines", "missing"),
        ("not in the baselines", "new"),
    ]


@pytest.fixture
def small(monkeypatch, tmp_path):
    """The command with a few runs and baselines in `tmp_path`; returns its arguments."""
    names = ("spring-a-no-contact, law=haringx", "spring-b, element=curved, elements_per_turn=4")
    chosen = [run for name in names for run in only(name)]
    monkeypatch.setattr(validation.regress.run, "runs", lambda: chosen)
    return ["regress", "--out", str(tmp_path / "out"), "--baselines", str(tmp_path / "base")]


def test_one_run_is_no_plural():
    assert Finding((), 1, accepted=True, first=True).verdict == "1 baseline written"
    assert Finding((), 1, accepted=False).verdict == "1 run: nothing moved"


def test_the_command_accepts_and_then_passes(small, tmp_path, capsys):
    assert main([*small, "--accept"]) == 0
    assert "2 baselines written" in capsys.readouterr().out
    assert sorted(file.name for file in (tmp_path / "base").iterdir()) == [
        "equivbeam.json",
        "times.json",
        "wirefe.json",
    ]
    kept = read(tmp_path / "base")
    assert kept["wirefe"]["made"].keys() == {"date", "processor", "versions"}
    assert main(small) == 0
    assert "2 runs: nothing moved" in capsys.readouterr().out
    assert (
        (tmp_path / "out" / "regress.md").read_text().startswith("# Regression\n\n**2 runs: nothing moved.**")
    )


def test_the_command_says_what_moved_until_it_is_accepted(small, monkeypatch, tmp_path, capsys):
    assert main([*small, "--accept"]) == 0
    sound = equivbeam.laws.haringx.haringx_stiffness
    monkeypatch.setattr(equivbeam.laws.haringx, "haringx_stiffness", lambda *given: sound(*given) * FAULT)
    capsys.readouterr()
    assert main(small) == 1
    output = capsys.readouterr()
    assert "equivbeam, spring-a-no-contact, law=haringx: ux at time" in output.out
    assert output.err.count("\n") == 1
    assert "quantities moved" in output.err
    assert "| rotz at time" in (tmp_path / "out" / "regress.md").read_text()
    assert main([*small, "--accept"]) == 0
    assert "quantities moved; accepted as the new baselines" in capsys.readouterr().out
    assert main(small) == 0


def test_times_are_judged_on_request_only(small, monkeypatch, capsys):
    assert main([*small, "--accept"]) == 0
    ratios = {"a / b": 3.5, "new": 1.0}
    monkeypatch.setattr(timeratios, "measure", lambda progress, scene: (ratios, ()))
    assert main(small) == 0
    assert main([*small, "--time"]) == 1
    assert "times: a / b was 2, is 3.5 (factor 1.75, 1.5 allowed)" in capsys.readouterr().out


def test_the_shipped_baselines_are_written_from_the_root_of_the_checkout_alone(
    small, tmp_path, monkeypatch, capsys
):
    """From any folder they were, within an installed package; there it is not advised either."""
    monkeypatch.setattr(validation.regress.baselines, "SHIPPED", tmp_path / "base")
    command = small[:-2]
    for folder, code in ((tmp_path, 2), (Path(__file__).parents[1], 0)):
        monkeypatch.chdir(folder)
        assert main([*command, "--accept"]) == code
        assert (tmp_path / "base").exists() == (code == 0)
    assert "the baselines that come with coilcheck are written anew from the root" in capsys.readouterr().err
    monkeypatch.setattr(validation.regress.run, "compare", lambda *_: (Move("", "", "", "", ""),))
    for folder, advised in ((tmp_path, False), (Path(__file__).parents[1], True)):
        monkeypatch.chdir(folder)
        assert main(command) == 1
        assert ("regress --accept" in capsys.readouterr().err) == advised


def test_an_interrupted_run_keeps_the_baselines(small, monkeypatch, tmp_path, capsys):
    assert main([*small, "--accept"]) == 0
    kept = read(tmp_path / "base")
    sound = Run.solve

    def stopped(run):
        if run.model == "wirefe":
            raise KeyboardInterrupt
        return sound(run)

    monkeypatch.setattr(Run, "solve", stopped)
    capsys.readouterr()
    assert main([*small, "--accept"]) == 130
    assert capsys.readouterr().err == "coilcheck: interrupted\n"
    assert read(tmp_path / "out") == read(tmp_path / "base") == kept  # as before


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        ("--baselines nowhere", "no baseline at nowhere"),
        ("--baselines broken", "is no baseline"),
        ("--accept extra", "extra"),
        ("spring-b --geometry wires", "must name a folder of yours unless SCENE is one of"),
        ("spring-b --geometry wires", "spring-b-no-contact, got spring-b with --geometry wires"),
        ("spring-a.toml", "spring-b, spring-b-no-contact, got spring-a.toml"),
        ("spring-a --accept", "--accept must go with --baselines DIR where SCENE is given, got spring-a"),
        ("--geometry wires", "--geometry must go with SCENE, got wires alone"),
        ("spring-a spring-a --baselines mine", "got spring-a twice"),
        ("spring-a --baselines mine", "no baseline at mine/spring-a/equivbeam.json"),
        ("--baselines afile", "--baselines must name a folder, but afile is a file"),
        ("spring-a spring-b --baselines afile", "--baselines must name a folder, but afile is a file"),
        ("--tolerance 1", "--tolerance"),
    ],
)
def test_bad_input_is_refused_in_one_sentence(arguments, part, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "afile").touch()
    (tmp_path / "spring-a.toml").write_text(scene_text(spring_a().with_steps(3)), encoding="utf-8")
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "equivbeam.json").write_text('{"made": 3, "runs": {}}')
    assert main(["regress", *arguments.split()]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert part in message
    assert not (tmp_path / "coilcheck-out").exists()


def test_times_that_were_never_kept_are_bad_input(small, tmp_path):
    assert main([*small, "--accept"]) == 0
    (tmp_path / "base" / "times.json").unlink()
    with pytest.raises(InputError, match="no ratios of times"):
        timeratios.compare(tmp_path / "base", {"a / b": 1.0})


def test_the_stored_baselines_are_those_of_the_runs():
    kept = read(SHIPPED)
    watched = runs()
    assert len({(run.model, run.name) for run in watched}) == len(watched)
    for model in MODELS:
        assert list(kept[model]["runs"]) == [run.name for run in watched if run.model == model]
    assert json.loads((SHIPPED / timeratios.FILE).read_text())["ratios"]


def test_the_library_compares_without_the_command(tmp_path):
    chosen = only("spring-a-no-contact, law=haringx")
    assert regress(tmp_path / "out", tmp_path / "base", accept=True, chosen=chosen).accepted
    finding = regress(tmp_path / "out", tmp_path / "base", chosen=chosen)
    assert (finding.moves, finding.compared, finding.accepted) == ((), 1, False)


def test_a_law_without_a_path_is_made_ready_too(monkeypatch):
    """An edit that ends Spring B's path is told as what moved, not as an error of the command."""
    solve = equivbeam.solve
    short = partial(solve, penalty=600.0)  # a limit point before full load
    with pytest.raises(EquilibriumNotFound):
        short(CATALOGUE["spring-b"](), steps=1)
    monkeypatch.setattr(paths.equivbeam, "solve", short)
    monkeypatch.setattr(paths, "background", lambda code: nullcontext())
    paths.make_ready.__wrapped__()


@pytest.mark.parametrize("name", timeratios.RUNS)
def test_what_is_timed_reaches_full_load(name):
    for case in CASES:
        assert timeratios.RUNS[name](case.scene) > 0.0


@pytest.fixture
def own(tmp_path, monkeypatch):
    """A short spring in a file of the user's, who is elsewhere; returns the command's arguments."""
    text = scene_text(replace(spring_a(), name="a spring"))
    for old, new in (
        *(("active_coils = 14.5", "active_coils = 2.25"), ("active_height = 28.6", "active_height = 7.0")),
        *(("steps = 50", "steps = 3"), ('geometry = "spheres"', 'geometry = "wires"')),
    ):
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(validation.regress.run, "make_ready", lambda: None)
    return ["regress", "mine.toml", "--baselines", "kept"]


def test_a_scene_of_ones_own_from_any_folder(own, tmp_path, capsys):
    """The beam refuses it, in one sentence; contact is that of wires, with as many stations as they need."""
    assert main([*own, "--accept"]) == 0
    said = capsys.readouterr().out
    assert said.count("left out: equivbeam, mine, law=haringx: spring.active_coils must be") == 1
    assert "mine: 3 baselines written" in said
    kept = read(tmp_path / "kept" / "mine")
    assert list(kept["wirefe"]["runs"]) == [
        "mine, element=straight, elements_per_turn=40",
        "mine, element=curved, elements_per_turn=4",
        "mine, element=curved, elements_per_turn=8",
    ]
    (run,) = [run for run in runs_of(load_scene("mine.toml")) if run.name.endswith("turn=8")]
    assert run.solve().options["pairs_per_turn"] == 32
    assert main(own) == 0
    report = (tmp_path / "coilcheck-out" / "regress-mine" / "regress.md").read_text(encoding="utf-8")
    assert report.startswith("# Regression\n\n**3 runs: nothing moved.**\n\nleft out: equivbeam")
    text = (tmp_path / "mine.toml").read_text(encoding="utf-8")
    (tmp_path / "mine.toml").write_text(text.replace("E = 206000.0", "E = 206206.0"), encoding="utf-8")
    assert main(own) == 1
    captured = capsys.readouterr()
    assert "wirefe, mine, element=curved, elements_per_turn=4: ux at time" in captured.out
    scene = "the scene: material.E was 206000.0, is 206206.0 (the baselines are of another scene)\n"
    assert captured.out.count("the scene: ") == captured.out.count(scene) == 1
    assert captured.err.startswith("coilcheck: mine: 3 runs: ")


def test_keys_of_a_scene_are_named_with_numbers_as_people_write_them():
    """25.7 - 1.6 is 24.1, and a mean diameter given as such is the same."""
    given = {"active_coils": 5.5, "active_height": 40.0}
    thick, thin, mean = (
        Scene("mine", spring, Load((0.0, -10.0)))
        for spring in (
            Spring.of_diameter(1.6, outer_diameter=25.7, **given),
            Spring.of_diameter(1.6, outer_diameter=25.8, **given),
            Spring(1.6, 24.1, **given),
        )
    )
    (move,) = scene_moves(thin, thick)
    assert (move.quantity, move.before, move.now) == ("spring.mean_diameter", "[24.2, 24.2]", "[24.1, 24.1]")
    assert list(scene_moves(mean, thick)) == []


def test_the_geometry_asked_for_has_baselines_of_its_own(own, tmp_path):
    assert main([*own, "--accept"]) == 0
    assert main([*own, "--geometry", "spheres", "--accept"]) == 0
    assert sorted(folder.name for folder in (tmp_path / "kept").iterdir()) == ["mine", "mine-spheres"]


def test_a_folder_of_baselines_tells_of_which_scenes_they_are(own, tmp_path, capsys):
    """Without their files: those are compared as they were."""
    command, mine, *kept = own
    assert main([*own, "--accept"]) == 0
    assert main([command, "spring-a-no-contact", *kept, "--accept"]) == 0
    (tmp_path / mine).unlink()
    capsys.readouterr()
    assert main([command, *kept]) == 0
    said = capsys.readouterr().out
    assert "mine: 3 runs: nothing moved" in said
    assert "spring-a-no-contact: 9 runs: nothing moved" in said


def test_the_shipped_baselines_are_found_from_anywhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    chosen = only("spring-a-no-contact, law=haringx")
    monkeypatch.setattr(validation.regress.run, "runs", lambda: chosen)
    monkeypatch.setattr(validation.regress.run, "make_ready", lambda: None)
    found = []
    monkeypatch.setattr(validation.regress.run, "compare", lambda kept, *_: found.append(kept) or ())
    assert main(["regress"]) == 0
    assert found == [read(SHIPPED)]
    assert (tmp_path / "coilcheck-out" / "regress" / "regress.md").is_file()


def test_a_scene_of_the_catalogue_has_the_shipped_baselines(tmp_path, monkeypatch, capsys):
    """Those of its runs alone, and its ratios of times."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(validation.regress.run, "make_ready", lambda: None)
    names = ["spring-a-no-contact", "spring-b"]
    short = [run for run in few("law=haringx,") if run.scene.name in names]
    monkeypatch.setattr(validation.regress.baselines, "runs", lambda: short)
    timed, found = [], []
    monkeypatch.setattr(timeratios, "measure", lambda progress, scene: timed.append(scene.name) or ({}, ()))
    monkeypatch.setattr(
        validation.regress.run, "compare", lambda kept, now, _: found.append((kept, now)) or ()
    )
    assert main(["regress", "spring-b", "--time"]) == 0
    assert timed == ["spring-b"]
    ((kept, now),) = found
    of_b = [run.name for run in short if run.scene.name == "spring-b"]
    assert len(of_b) > 1
    assert sorted(now["equivbeam"]) == sorted(kept["equivbeam"]["runs"]) == sorted(of_b)
    assert kept["equivbeam"]["runs"].items() <= read(SHIPPED)["equivbeam"]["runs"].items()
    assert main(["regress", *names]) == 0
    assert len(list((tmp_path / "coilcheck-out").rglob("regress.md"))) == 3
    assert "spring-a-no-contact: 2 runs: nothing moved" in capsys.readouterr().out


def test_a_scene_that_does_not_reach_full_load_has_no_ratios():
    """`measure` as it is, which `no_timing` has replaced in its module."""
    scene = CATALOGUE["spring-b"]().with_penalty(400.0).with_steps(1)
    scene = replace(scene, name="soft", contact=replace(scene.contact, sliding="free"))
    ratios, (said,) = MEASURE(lambda line: None, scene)
    assert ratios == {}
    assert said.startswith("soft has no ratios of times: ")


def test_the_force_of_a_prescribed_displacement_is_compared():
    """Displacements are given then: a change of all forces by 7 % moved nothing but iterations."""
    scene = replace(spring_a(), name="pressed", load=Load(displacement=(-9.0,), steps=4))
    watched = [Run(model, scene, options) for model, options in (("equivbeam", {}), ("wirefe", COARSE))]
    before = found_now(watched)
    softer = replace(scene, material=replace(scene.material, E=0.9999 * scene.material.E))
    after = found_now([replace(run, scene=softer) for run in watched])
    found = compare(as_baseline(before), after, "here")
    assert {move.run for move in found if move.quantity.startswith("load_y at time")} == {
        f"{run.model}, {run.name}" for run in watched
    }


def test_baselines_without_a_quantity_are_compared_in_the_others(before):
    """All of an older version's moved by what they lacked, and nothing else was looked at."""
    older, name = copy.deepcopy(before), "spring-a-no-contact, law=haringx"
    for runs_ in older.values():
        for row in runs_.values():
            del row["load_y"]
    older["equivbeam"][name]["ux"][0] += 1e-3
    found = compare(as_baseline(older), before, "here")
    assert kinds(found) == {"load_y", "ux"}
    assert sum(move.quantity != "load_y" for move in found) == 1


def test_a_force_that_was_nothing_moves_by_all_of_it(before):
    """A side force to which an axial one was added was divided by nothing."""
    older, name = copy.deepcopy(before), "spring-a-no-contact, law=haringx"
    row = older["equivbeam"][name]
    row["load_y"] = [0.0] * len(row["load_y"])
    assert "load_y" in kinds(compare(as_baseline(older), before, "here"))


def test_the_shipped_baselines_have_all_quantities():
    kept = read(SHIPPED)
    names = {frozenset(row) for model in MODELS for row in kept[model]["runs"].values()}
    (run,) = only("spring-a-no-contact, law=haringx")
    assert names == {frozenset(quantities(run.solve()))}
