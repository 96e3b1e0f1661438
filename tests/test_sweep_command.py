"""`coilcheck sweep`: grids of scenes, a row for each, and what is on disk is not solved twice."""

import csv
import json
import re
import time
from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest

import equivbeam
import wirefe
from coilspring import InputError, Load, Material, Scene, Spring, load_scene, scene_text, spring_a, spring_b
from coilspring.scene.profile import CoilSection
from coilspring.scene.toml import scene_from_table, scene_table, written_table
from coilspring.sweep import CRASHED
from validation.cli import main
from validation.sweep import run
from validation.sweep.choice import rounded_up
from validation.sweep.grid import Varied, points, read_varied
from validation.sweep.run import FILE, SETTINGS
from wirefe.solve import KERNELS, SEATED

ONE = ["--workers", "0", "--steps", "1"]
TABLE, AT_ONCE = scene_table(spring_b()), scene_table(spring_b().with_steps(1))
BEAM = run.Choice.of("equivbeam", {"law": "haringx"})
WIRE = run.Choice.of("wirefe", {"element": "curved", "elements_per_turn": 4})


def rows(folder):
    with open(folder / FILE, encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(lines))


def test_ranges_and_lists():
    texts = ["spring.wire_diameter=1.2:1.8:7", "load.force.1=-50,-10", "contact.enabled=true,false"]
    found = read_varied([*texts, "contact.geometry=wires,spheres", "load.steps=2:4:3"], TABLE)
    assert [each.values for each in found] == [
        (1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8),
        (-50, -10),
        (True, False),
        ("wires", "spheres"),
        (2, 3, 4),
    ]
    assert isinstance(found[4].values[1], int)
    assert [point.scene.load.steps for point in points(TABLE, found[4:])] == [2, 3, 4]


def test_the_last_key_is_the_fastest_and_a_key_takes_the_place_of_those_it_excludes():
    b = spring_b()
    grid = [Varied("material.G", (79e3, 80e3)), Varied("load.displacement", (-1.0, -2.0))]
    found = list(points(TABLE, grid))
    assert [point.values for point in found] == [(79e3, -1.0), (79e3, -2.0), (80e3, -1.0), (80e3, -2.0)]
    load = Load(displacement=(-2.0,))
    assert found[1].scene == replace(b, material=Material.from_moduli(b.material.E, 79e3), load=load)


def test_an_item_of_a_list_and_of_a_table():
    (point,) = points(TABLE, [Varied("spring.mean_diameter.1", (7.0,))])
    assert point.scene.spring.mean_diameter == (12.0, 7.0)
    sections = (CoilSection(2.0, (2.0, 4.0), (12.0, 12.0)), CoilSection(3.0, (4.0, 4.0), (12.0, 9.0)))
    table = scene_table(Scene("two", Spring.of_sections(1.5, sections), Load((0.0, -10.0))))
    (varied,) = read_varied(["spring.sections.1.coils=4"], table)
    (point,) = points(table, [varied])
    assert [each.coils for each in point.scene.spring.sections] == [2.0, 4.0]
    (point,) = points(table, [Varied("spring.sections.1.coils", (-4,))])
    assert point.refused.startswith("spring.sections[1].coils must be ")  # counted as they are varied
    (point,) = points(table, [Varied("spring.mean_diameter", (9.0,))])
    assert point.scene is None
    assert "[spring] takes one of " in point.refused
    assert ", got mean_diameter and sections" in point.refused


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("spring.wire=1:2:3", "unknown key 'wire' in [spring]; did you mean wire_diameter? allowed: wire_"),
        ("wire_diameter=1:2:3", "did you mean spring.wire_diameter? allowed: material, spring, load, supp"),
        (
            "load.force.7=1",
            "unknown item '7' of load.force in this scene; allowed: load.force.0, load.force.1",
        ),
        (
            "load.stages.0=1",
            "'0' of load.stages in this scene; it has no items: the scene has force in its place",
        ),
        ("spring=1", "must name a key of [spring], as spring.wire_diameter; allowed: wire_diameter, "),
        ("load.=1", "must name a key of [load], as load.force; allowed: force, "),
        ("spring.wire_diameter", "must be KEY=FIRST:LAST:COUNT or KEY=VALUE,VALUE,..."),
        ("spring.wire_diameter=1:2", "a range must be FIRST:LAST:COUNT, three numbers, as 1.2:1.8:7"),
        ("spring.wire_diameter=1:nan:2", "a range must be FIRST:LAST:COUNT, three numbers"),
        ("spring.wire_diameter=1_2:2:3", "a range must be FIRST:LAST:COUNT, three numbers"),
        ("spring.wire_diameter=1:2:1", "the COUNT of a range must be an integer in [2, 100000], got 1"),
        ("load.force.1=-3,-4,-3.0", "values must be different, got -3 more than once"),
        ("load.force.1=-3:-3:3", "values must be different, got -3 more than once"),
        ("spring.hand=left,left", "values must be different, got left more than once"),
        ("spring.wire_diameter=1,,2", "values must be numbers, texts, true or false, with commas between"),
    ],
)
def test_what_cannot_be_varied_is_refused_with_what_can(text, words, tmp_path, capsys):
    assert main(["sweep", "spring-b", "--vary", text, *ONE, "--out", str(tmp_path / "new")]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"coilcheck: --vary {text!r}: ")
    assert words in said
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        (["load.force.1=-1", "load.force.1=-2"], "load.force.1 is varied twice: give all its val"),
        (["spring.mean_diameter=9", "spring.mean_diameter.0=8"], "is varied already, by spring.mean_diam"),
        (
            ["load.force.1=-1", "load.displacement=-2"],
            "load.force.1 and load.displacement exclude each other: v",
        ),
        (
            ["load.displacement=-2", "load.force.1=-1"],
            "load.displacement and load.force.1 exclude each other: v",
        ),
        (
            ["material.G=8e4", "load.steps=1", "material.nu=0.3"],
            "material.G and material.nu exclude each other",
        ),
        (
            ["spring.outer_diameter=9", "spring.inner_diameter=8"],
            "r and spring.inner_diameter exclude each oth",
        ),
        (
            ["spring.mean_diameter.0=9", "spring.outer_diameter=8"],
            "r.0 and spring.outer_diameter exclude each ",
        ),
        (["load.force.1=-2:-1:400", "material.E=2e5:3e5:400"], "at most 100000 scenes, got 160000"),
    ],
)
def test_keys_that_exclude_each_other_and_grids_too_large_are_refused(texts, words):
    with pytest.raises(InputError, match="--vary") as refused:
        read_varied(texts, TABLE)
    assert words in str(refused.value)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            "contact.stiffness=1e3,1e4 --penalty 5 --model wirefe",
            "--penalty cannot stand beside --vary conta",
        ),
        ("load.steps=1,2 --steps 3", "--steps cannot stand beside --vary load.steps, which sets the same"),
        (
            "contact.geometry=wires,spheres --geometry wires --model wirefe",
            "--geometry cannot stand beside -",
        ),
        (
            "load.force.1=-1,-2 --geometry wires",
            "--geometry belongs to --model wirefe, got --model equivbeam",
        ),
        (
            "contact.geometry=wires,spheres",
            "--vary contact.geometry has no effect on equivbeam: it goes with ",
        ),
        (
            "contact.geometry=wires,spheres --sliding scene",
            "no effect on equivbeam: it goes with --model wir",
        ),
        (
            "contact.sliding=free,none",
            "no effect on equivbeam: it goes with --sliding scene or --model wirefe",
        ),
        ("contact.sliding=free,none --sliding ignore", "it goes with --sliding scene or --model wirefe"),
        ("factors.axial=1,1.1 --model wirefe", "no effect on wirefe: it goes with --model equivbeam"),
        ("factors.axial=1,1.1 --accuracy 1e-2", "no effect on wirefe: it goes with --model equivbeam"),
        ("material.density=7800,7900 --model wirefe", "no effect on a sweep: it goes with solve --freq"),
        ("material.density=7800,7900 --accuracy 1e-2", "no effect on a sweep: it goes with solve --freq"),
    ],
)
def test_what_would_be_ignored_is_refused(options, words, tmp_path, capsys):
    assert main(["sweep", "spring-b", "--out", str(tmp_path / "new"), "--vary", *options.split()]) == 2
    said = capsys.readouterr().err
    assert said.startswith("coilcheck: --")
    assert words in said
    assert said.count("\n") == 1
    assert not (tmp_path / "new").exists()


def test_what_is_read_is_varied(tmp_path):
    """Sliding by the beam where it is asked for; the other options stand beside what they do not set."""
    call = ["sweep", "spring-b", "--vary", "contact.sliding=free,none", "--workers", "0", "--steps", "2"]
    assert main([*call, "--sliding", "scene", "--penalty", "2e4", "--out", str(tmp_path)]) == 0
    free, held = (row["uy"] for row in rows(tmp_path))
    assert free != held
    assert main([*call[:2], "--vary", "load.force.1=-9", "--geometry", "wires", "--accuracy", "1e-2",
                 *call[4:], "--out", str(tmp_path)]) == 0  # fmt: skip


@pytest.mark.parametrize(
    ("scene", "vary", "idle"),
    [
        ("spring-b-no-contact", "contact.stiffness=1e3,1e4", ["contact.stiffness"]),
        ("spring-b-no-contact", "contact.geometry=wires,spheres --model wirefe", ["contact.geometry"]),
        ("spring-b", "contact.stiffness=1e3,1e4 --vary contact.enabled=true,false", []),
        ("spring-b", "spring.active_coils=7,7.3 --vary spring.hand=left,right", ["spring.hand"]),
        ("spring-b", "contact.stiffness=1e3", []),
    ],
)
def test_what_moves_nothing_in_any_scene_is_said(scene, vary, idle, tmp_path, capsys):
    """Rows were alike without a word."""
    assert main(["sweep", scene, "--vary", *vary.split(), *ONE, "--out", str(tmp_path)]) in (0, 3)
    said = [line for line in capsys.readouterr().out.splitlines() if line.startswith("warning")]
    assert said == [f"warning: {key} has no effect on any scene of the grid" for key in idle]


def test_what_of_a_scene_is_left_out_is_said_once(tmp_path, capsys):
    """As `solve` says it; nothing was said."""
    target = tmp_path / "own.toml"
    text = scene_text(spring_b()).replace("axial = 1.0", "axial = 1.1")
    target.write_text(text, encoding="utf-8")
    call, grid = [str(target), *ONE[2:], "--out", str(tmp_path)], ["--vary", "load.force.1=-30,-40"]
    for options in (["equivbeam"], ["equivbeam", "--sliding", "scene"], ["wirefe"]):
        said = []
        for command in (["solve", *call], ["sweep", *call, *grid, "--workers", "0"]):
            assert main([*command, "--model", *options]) == 0
            out = capsys.readouterr().out.splitlines()
            said.append([line.strip() for line in out if "without the scene's" in line])
        assert said[0] == said[1]
        assert len(said[0]) == ("--sliding" not in options)


def test_a_row_for_each_scene_in_order_and_invalid_ones_say_why(tmp_path, capsys):
    grid = ["--vary", "spring.active_coils=7,7.3", "--vary", "load.force.1=-100,-50"]
    assert main(["sweep", "spring-b", *grid, "--workers", "0", "--steps", "2", "--out", str(tmp_path)]) == 3
    found = rows(tmp_path)
    assert list(found[0])[:4] == ["spring.active_coils", "load.force.1", "outcome", "time"]
    assert [(row["spring.active_coils"], row["load.force.1"]) for row in found] == [
        ("7", "-100"), ("7", "-50"), ("7.3", "-100"), ("7.3", "-50"),
    ]  # fmt: skip
    assert [row["outcome"] for row in found] == ["completed", "completed", "refused", "refused"]
    assert found[2]["message"].startswith("spring.active_coils must be a multiple of 0.5")
    assert (found[2]["uy"], found[2]["time"], found[2]["key"]) == ("", "", "")
    b = spring_b()
    scene = replace(b, spring=replace(b.spring, active_coils=7.0), load=Load((0.0, -100.0), 2))
    path, row = equivbeam.solve(scene), found[0]
    assert [float(row[name]) for name in ("ux", "uy", "rotz")] == path.tips[-1].tolist()
    assert float(row["load_y"]) == -100.0
    assert float(row["max_contact_force"]) == path.contact_forces[-1].max() > 0.0
    assert float(row["rate"]) == path.rates[-1]
    assert row["max_stress"] == ""  # of the wire model alone
    assert int(row["iterations"]) == path.total_iterations
    said = capsys.readouterr()
    assert "4 springs: 2 completed, 2 refused" in said.out
    why = "spring.active_coils must be a multiple of 0.5 in [0.5, 1000] for the equivalent beam, got 7.3"
    early = f"2 of 4 scenes did not reach full load: 2 cannot be solved (the first: {why})"
    assert said.err == f"coilcheck: {early}; sweep.csv says why\n"


def test_the_wire_model_and_the_reaction_to_a_displacement(tmp_path):
    grid = ["--vary", "load.displacement=-2,-4", "--model", "wirefe"]
    mesh = ["--element", "curved", "--elements-per-turn", "4"]
    assert main(["sweep", "spring-b", *grid, *mesh, *ONE, "--out", str(tmp_path)]) == 0
    scene = replace(spring_b(), load=Load(displacement=(-4.0,), steps=1))
    path = wirefe.solve(scene, element="curved", elements_per_turn=4)
    assert [float(row["load_y"]) for row in rows(tmp_path)][1] == path.loads[-1, 1] < -20.0
    assert not (tmp_path / "sweep.png").exists()


def test_a_picture_where_one_number_has_three_values(tmp_path):
    call = ["sweep", "spring-b", "--vary", "load.force.1=-30:-60:3", *ONE, "--out", str(tmp_path)]
    assert main(call) == 0
    assert (tmp_path / "sweep.png").read_bytes().startswith(b"\x89PNG")
    assert main([*call, "--vary", "spring.hand=left,right"]) == 0
    assert sorted(file.name for file in tmp_path.iterdir()) == [
        *("sweep.1.csv", "sweep.1.json", FILE, SETTINGS)
    ]


def test_where_no_scene_can_be_solved_the_first_reason_is_said(tmp_path, capsys):
    grid = ["--vary", "load.force.1=-100,-50", "--model", "wirefe", "--elements-per-turn", "3"]
    assert main(["sweep", "spring-b", *grid, *ONE, "--out", str(tmp_path)]) == 2
    assert "no scene can be solved: --elements-per-turn must be" in capsys.readouterr().err
    assert main(["sweep", "spring-b", *grid[:2], "--element", "curved"]) == 2
    assert "--element belongs to --model wirefe, got --model equivbeam" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("vary", "reason"),
    [
        ("contact.friction=0.1,0.2", "contact.friction goes with contact.sliding"),
        ("spring.wire_diameter=1_9", "spring.wire_diameter must be a number in [1e-06, 1e+06], got '1_9'"),
        ("contact.exponent=0.5,9", "contact.exponent must be a finite number in [1, 5], got 0.5"),
    ],
)
def test_with_an_accuracy_the_reason_is_the_same(vary, reason, tmp_path, capsys):
    """It was: --accuracy needs a scene of the grid that can be solved, got none."""
    for how in (["--accuracy", "1e-2"], ["--model", "wirefe"]):
        call = ["sweep", "spring-a", "--vary", vary, *how, *ONE]
        assert main([*call, "--out", str(tmp_path)]) == 2
        assert capsys.readouterr().err.startswith(f"coilcheck: no scene can be solved: {reason}")


def test_points_of_one_scene_have_rows_with_values_of_their_own(tmp_path):
    """Both had those of the later one."""
    target, out = tmp_path / "own.toml", tmp_path / "out"
    target.write_text(scene_text(spring_b()).replace("top_held = []", 'top_held = ["ux", "rotz"]'))
    held = [f"--vary=supports.top_held.{item}=ux,rotz" for item in (0, 1)]
    assert main(["sweep", str(target), *held, *ONE, "--out", str(out)]) == 3
    found = [[row[f"supports.top_held.{item}"] for item in (0, 1)] for row in rows(out)]
    assert found == [["ux", "ux"], ["ux", "rotz"], ["rotz", "ux"], ["rotz", "rotz"]]
    assert [row["outcome"] == "refused" for row in rows(out)] == [True, False, False, True]


GRID = [Varied("load.force.1", (-40.0, -60.0, -80.0, -100.0))]


def solved_again(folder, grid, choose=lambda scene: BEAM):
    """Rows of a sweep, and how many scenes it has solved."""
    done = []
    found = run.sweep(
        folder,
        AT_ONCE,
        grid,
        list(points(AT_ONCE, grid)),
        choose,
        workers=0,
        progress=lambda *count: done.append(count),
    )
    return found, len(done) - 1


def test_an_interrupted_sweep_keeps_its_rows_and_goes_on(tmp_path):
    def interrupt(done, of):
        if done == 2:
            raise KeyboardInterrupt

    said = f"2 of 4 rows are in {tmp_path / FILE}; the same command goes on"
    with pytest.raises(KeyboardInterrupt, match=re.escape(said)):
        run.sweep(
            tmp_path,
            AT_ONCE,
            GRID,
            list(points(AT_ONCE, GRID)),
            lambda scene: BEAM,
            workers=0,
            progress=interrupt,
        )
    assert [row["load.force.1"] for row in rows(tmp_path)] == ["-40.0", "-60.0"]
    text = (tmp_path / FILE).read_text().replace("the load path", "READ: the load path", 1)
    (tmp_path / FILE).write_text(text[:-40])  # and the last line is cut
    found, count = solved_again(tmp_path, GRID)
    assert count == 3
    assert found[0]["message"].startswith("READ: ")
    assert rows(tmp_path) == found
    fresh, count = solved_again(tmp_path / "fresh", GRID) if not (tmp_path / "fresh").mkdir() else ([], 0)
    assert count == 4
    assert fresh[1:] == found[1:]


@pytest.mark.parametrize(("first", "workers"), [(-10.0, 1), (-20.0, 2)], ids=["in order", "the later first"])
def test_a_spring_of_the_wire_model_is_kept_while_another_is_solved(first, workers, tmp_path):
    """Sixteen were handed out together, and all of them lost where the sweep was interrupted."""

    class Waiting(run.Choice):
        def __call__(self, scene):
            end = time.monotonic() + 20.0
            while len((tmp_path / FILE).read_text().splitlines()) < 2:  # the columns, and the row before
                assert time.monotonic() < end
                time.sleep(0.01)
            return run.Choice.__call__(self, scene)

    grid, after = [Varied("load.force.1", (-10.0, -20.0))], Waiting(WIRE.model, WIRE.options)
    found = run.sweep(
        tmp_path,
        AT_ONCE,
        grid,
        list(points(AT_ONCE, grid)),
        lambda scene: WIRE if scene.load.force[1] == first else after,
        workers=workers,
    )
    assert [row["outcome"] for row in found] == ["completed", "completed"]
    assert [float(row["load_y"]) for row in found] == [-10.0, -20.0]


def test_nothing_stored_is_solved_again_unless_the_scene_or_the_options_differ(tmp_path):
    first, count = solved_again(tmp_path, GRID)
    assert count == 4
    finer = [Varied("load.force.1", (-30.0, *GRID[0].values))]
    found, count = solved_again(tmp_path, finer)
    assert (found[1:], count) == (first, 1)
    helix = run.Choice.of("equivbeam", {"law": "helix"})
    found, count = solved_again(tmp_path, GRID, lambda scene: helix)
    assert count == 4
    assert [row["uy"] for row in found] != [row["uy"] for row in first]
    text = (tmp_path / FILE).read_text().replace("completed", CRASHED, 1)
    (tmp_path / FILE).write_text(text)
    assert solved_again(tmp_path, GRID, lambda scene: helix) == (found, 1)


def test_how_the_scenes_were_solved_stands_beside_them(tmp_path, capsys):
    call = ["sweep", "spring-b", "--vary", "load.force.1=-20,-30", *ONE, "--out", str(tmp_path)]
    call += ["--penalty", "2e4"]
    assert main(call) == 0
    plain = json.loads((tmp_path / SETTINGS).read_text())
    assert plain["scene"] == "spring-b"
    assert scene_from_table(plain["scene_table"]) == spring_b().overridden(steps=1, penalty=2e4)
    assert plain["overridden"] == {"steps": 1, "penalty": 2e4}
    assert plain["varied"] == {"load.force.1": [-20, -30]}
    assert plain["model"] == "equivbeam"
    assert plain["options"] == {"law": "haringx", "tangent": "exact", "sliding": "ignore"}
    assert plain["accuracy"] is plain["estimated_error"] is None
    assert main([*call, "--accuracy", "5e-3"]) == 0
    found = json.loads((tmp_path / SETTINGS).read_text())
    assert (found["model"], found["accuracy"], found["sampled"]) == ("wirefe", 5e-3, 2)
    assert 0.0 < found["estimated_error"] <= 2.5e-3
    count = found["options"]["elements_per_turn"]
    said = f"accuracy of 0.005: wirefe, {count} curved elements per turn; error up to "
    assert said + f"{found['estimated_error']:.2g} on 2 scenes" in capsys.readouterr().out
    assert json.loads((tmp_path / "sweep.1.json").read_text()) == plain


def test_a_grid_has_one_mesh_with_and_without_plates(tmp_path, capsys):
    call = ["sweep", "spring-b-no-contact", "--vary", "supports.seat=rigid,plate", "--accuracy", "1e-2"]
    assert main([*call, "--steps", "1", "--workers", "0", "--out", str(tmp_path)]) == 0
    found = json.loads((tmp_path / SETTINGS).read_text())["options"]
    assert found["element"] == "curved"
    assert f"wirefe, {found['elements_per_turn']} curved elements per turn" in capsys.readouterr().out


def test_options_that_differ_from_scene_to_scene_are_told_apart(tmp_path):
    def choose(scene):
        return (
            WIRE if scene.contact.geometry == "spheres" else replace(WIRE, options={"elements_per_turn": 8})
        )

    grid = [Varied("contact.geometry", ("wires", "spheres")), Varied("spring.active_coils", (7.5, -1.0))]
    run.sweep(tmp_path, AT_ONCE, grid, list(points(AT_ONCE, grid)), choose, workers=0)
    found = json.loads((tmp_path / SETTINGS).read_text())
    assert (found["model"], found["options"]) == ("wirefe", {})
    assert found["differing"] == {
        "elements_per_turn": [8, 4],
        "element": ["straight", "curved"],
        "pairs_per_turn": [32, 4],  # those of stations and spheres, unless asked otherwise
    }
    for options, pairs in ({}, 4), ({"pairs_per_turn": 8}, 8):
        choice = run.Choice.of("wirefe", options)
        run.sweep(
            tmp_path, AT_ONCE, GRID[:1], list(points(AT_ONCE, GRID[:1])), lambda _, c=choice: c, workers=0
        )
        found = json.loads((tmp_path / SETTINGS).read_text())["options"]
        assert found == {"elements_per_turn": 40, "element": "straight", "pairs_per_turn": pairs}


def test_kernels_of_plates_are_stored_before_a_worker_needs_them(tmp_path, monkeypatch):
    kernels = []
    monkeypatch.setattr("coilspring.sweep.store", kernels.append)
    table = scene_table(load_scene("examples/plates.toml").with_steps(1))
    grid = [Varied("supports.seat", ("plate", "rigid"))]
    found = run.sweep(
        tmp_path, table, grid, list(points(table, grid)), lambda scene: run.Choice.of("wirefe", {}), workers=1
    )
    assert [row["outcome"] for row in found] == ["completed", "completed"]
    assert kernels == [SEATED, KERNELS]


def test_each_scene_may_have_a_solver_of_its_own(tmp_path):
    def choose(scene):
        return WIRE if scene.load.force[1] < -70.0 else BEAM

    found, _ = solved_again(tmp_path, GRID, choose)
    scenes = [replace(spring_b(), load=Load((0.0, float(row["load.force.1"])), 1)) for row in found]
    solved = [choose(scene)(scene) for scene in scenes]
    assert [path.model for path in solved] == ["equivbeam", "equivbeam", "wirefe", "wirefe"]
    assert [float(row["uy"]) for row in found] == [path.tips[-1, 1] for path in solved]


def test_two_models_agree_on_the_stiffness_of_a_sweep(tmp_path):
    """Before coils touch UY goes with d^-4 in both models: by the textbook's rate, and by finite elements."""
    grid = [Varied("spring.wire_diameter", (0.9, 1.2))]
    ratios = []
    for choice in (BEAM, WIRE):
        (tmp_path / choice.model).mkdir()
        table = scene_table(replace(spring_b().without_contact(), load=Load((0.0, -0.1), 1)))
        scenes = list(points(table, grid))
        thin, thick = run.sweep(
            tmp_path / choice.model, table, grid, scenes, lambda scene, c=choice: c, workers=0
        )
        ratios.append(float(thin["uy"]) / float(thick["uy"]))
    np.testing.assert_allclose(ratios, (1.2 / 0.9) ** 4, rtol=5e-3)


def test_a_scene_file_is_found_again_by_its_content(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(scene_text(spring_a()))
    call = ["sweep", str(file), "--vary", "load.force.1=-2,-4", *ONE, "--out", str(tmp_path / "out")]
    assert main(call) == 0
    keys = [row["key"] for row in rows(tmp_path / "out")]
    assert main(call) == 0
    assert keys == [row["key"] for row in rows(tmp_path / "out")]
    file.write_text(scene_text(spring_a()).replace("E = 206000.0", "E = 207000.0"))
    assert load_scene(file).material.E == 207000.0
    assert main(call) == 0
    assert not set(keys) & {row["key"] for row in rows(tmp_path / "out")}


def test_the_outer_diameter_of_a_file_stays_where_the_wire_varies(tmp_path):
    """It was the mean diameter that stayed: uy at d 2.2 was off by 2 %."""
    target = tmp_path / "own.toml"
    target.write_text(
        "[spring]\nwire_diameter = 2.0\nouter_diameter = [26.0, 16.0]\nactive_coils = 5.5\n"
        "active_height = 40.0\n[load]\nforce = [0.0, -60.0]\n",
        encoding="utf-8",
    )
    table = written_table(load_scene(target), str(target))
    varied = read_varied(["spring.wire_diameter=2.0,2.2", "spring.outer_diameter.1=14,16"], table)
    found = [point.scene.spring.mean_diameter for point in points(table, varied)]
    assert found == [(24.0, 12.0), (24.0, 14.0), (23.8, 11.8), (23.8, 13.8)]


@pytest.mark.parametrize(
    ("vary", "old", "new"),
    [
        ("material.E=190000", "E = 206000", "E = 190000"),  # uy was off by 8 %, as if nu had stayed
        ("material.G=70000", "G = 79000", "G = 70000"),
        ("material.nu=0.2", "G = 79000", "nu = 0.2"),
        ("supports.top_held.1=uy", '"rotz", "ux"', '"rotz", "uy"'),
        ("supports.seat=plate", "[supports]", '[supports]\nseat = "plate"'),
        ("load.displacement=-2.0", "force = [-5.0, -60.0]", "displacement = -2.0"),
        ("contact.friction=0.2", "friction = 0.1", "friction = 0.2"),
        ("factors.bending=0.9", "[factors]", "[factors]\nbending = 0.9"),
    ],
)
def test_a_scene_of_a_sweep_is_that_of_the_file_with_this_key(vary, old, new, tmp_path):
    target = tmp_path / "own.toml"
    text = (
        '[material]\nE = 206000\nG = 79000\n[supports]\ntop_held = ["rotz", "ux"]\n[factors]\naxial = 1.1\n'
        "[spring]\nwire_diameter = 2.0\nmean_diameter = 16.0\nactive_coils = 6.0\nactive_height = 32.0\n"
        '[load]\nforce = [-5.0, -60.0]\nsteps = 7\n[contact]\nsliding = "coulomb"\nfriction = 0.1\n'
    )
    target.write_text(text, encoding="utf-8")
    table = written_table(load_scene(target).overridden(steps=3, penalty=2e4), str(target))
    ((point,), edited) = points(table, read_varied([vary], table)), text.replace(old, new)
    assert edited != text
    target.write_text(edited, encoding="utf-8")
    assert point.scene == load_scene(target).overridden(steps=3, penalty=2e4)


@pytest.mark.parametrize(
    "other",
    [b"my,own,data", b"my,own\r\n\xe4,2\r\n", None],
    ids=["a line of something else", "another table", "the rows of another sweep"],
)
def test_what_a_sweep_finds_in_its_place_is_kept(tmp_path, other):
    if other is None:
        solved_again(tmp_path, [Varied("load.force.1", (-20.0,))])
    else:
        (tmp_path / FILE).write_bytes(other)
    old = (tmp_path / FILE).read_bytes()
    found, count = solved_again(tmp_path, GRID)
    assert count == 4
    assert [file.read_bytes() for file in run.kept_files(tmp_path)] == [old]
    assert solved_again(tmp_path, GRID) == (found, 0)
    (tmp_path / FILE).write_text((tmp_path / FILE).read_text()[:-40])  # its own rows, the last one cut
    solved_again(tmp_path, GRID)
    assert len(run.kept_files(tmp_path)) == 1
    larger = [*GRID, Varied("spring.hand", ("left", "right"))]
    for grid in (larger, GRID, larger, GRID):  # each is kept once
        solved_again(tmp_path, grid)
    assert len(run.kept_files(tmp_path)) == 3


def test_a_sweep_of_which_nothing_can_be_solved_replaces_nothing(tmp_path, capsys):
    call = ["sweep", "spring-b", *ONE, "--out", str(tmp_path), "--vary"]
    assert main([*call, "load.force.1=-30,-40"]) == 0
    files = {file: file.read_bytes() for file in tmp_path.iterdir()}
    capsys.readouterr()
    assert main([*call, "spring.active_coils=-1,-2"]) == 2
    assert "no scene can be solved: spring.active_coils must be" in capsys.readouterr().err
    assert {file: file.read_bytes() for file in tmp_path.iterdir()} == files


def test_a_sweep_says_where_the_one_before_is_kept(tmp_path, capsys):
    for force in ("-30,-40", "-40", "-40,-50"):
        call = ["sweep", "spring-b", "--vary", f"load.force.1={force}", *ONE, "--out", str(tmp_path)]
        assert main(call) == 0
        said = f"the sweep that was there is kept in {tmp_path / 'sweep.1.csv'}"
        assert (said in capsys.readouterr().out) == (force == "-40")


def test_an_interrupted_sweep_says_where_the_one_before_is_kept(tmp_path, monkeypatch, capsys):
    """It was in sweep.1.csv without a word, then and later."""

    def interrupt(text):
        if text == "1 of 2 scenes":
            raise KeyboardInterrupt

    call = ["sweep", "spring-b", *ONE, "--out", str(tmp_path), "--vary"]
    assert main([*call, "load.force.1=-20"]) == 0
    monkeypatch.setattr("validation.cli.command.progress_shown", lambda: nullcontext(interrupt))
    capsys.readouterr()
    assert main([*call, "load.force.1=-30,-40"]) == 130
    rows_there = f"1 of 2 rows are in {tmp_path / FILE}; the same command goes on"
    kept = f"the sweep that was there is kept in {tmp_path / 'sweep.1.csv'}"
    assert capsys.readouterr().err == f"coilcheck: interrupted: {rows_there}; {kept}\n"


@pytest.mark.parametrize("workers", [-1, 1001])
def test_as_many_workers_are_refused_by_command_and_library(workers, tmp_path, capsys):
    said = f"workers must be an integer in [0, 1000], got {workers}"
    call = ["sweep", "spring-b", "--vary", "load.steps=1,2", "--workers", str(workers)]
    assert main([*call, "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err == f"coilcheck: --{said}\n"
    assert not list(tmp_path.iterdir())  # before anything is written
    for model in (equivbeam, wirefe):
        with pytest.raises(InputError, match=re.escape(said)):
            next(model.sweep([spring_b()], workers=workers))


@pytest.mark.parametrize("number", [1e-5, 1.04e-5, 9.99e-5, 0.1, 0.0123, 0.999])
def test_an_accuracy_that_is_offered_can_be_asked_for(number):
    found = rounded_up(number)
    assert number < found <= 1.11 * number
    assert float(f"{found:g}") == float(f"{found:.1e}") == found
