"""What the paper leaves open: changes against known scalings and derivatives, the raised load, the files."""

import csv
import math
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import equivbeam
import validation.sensitivity.run as sensitivity_run
from coilspring import (
    Contact,
    InputError,
    Load,
    Material,
    Scene,
    Spring,
    Supports,
    scene_text,
    spring_a,
    spring_b,
)
from coilspring.contact.law import PAIR_HISTORY
from coilspring.curves import compare_paths
from coilspring.scene.wire import round_section
from coilspring.solver.problem import Problem
from coilspring.solver.solve import follow_problem, output_times, scene_path
from equivbeam import model as beam
from equivbeam.laws.haringx import KAX, KFL, KSH
from equivbeam.solve import KERNELS as BEAM_KERNELS
from equivbeam.solve import beam_shape
from validation.cli import main
from validation.sensitivity.changes import (
    CHANGES,
    COLUMNS,
    CURVE,
    DEVIATION,
    NO_INPUT,
    Study,
    changes,
    farther,
    input_rows,
    sizes,
    together,
    worst,
)
from validation.sensitivity.changes import change as difference
from validation.sensitivity.inputs import AGAINST, INPUTS, LIKE, NOT_GIVEN, READING, VARIED, inputs_of
from validation.sensitivity.page import digest
from validation.sensitivity.run import sensitivity
from validation.sensitivity.topheight import TipCurve, raised
from validation.sensitivity.tornado import draw
from validation.study import paths
from validation.study.cases import PAPER_MESH, case
from validation.study.models import BEAM, MODELS, WIRE
from validation.study.paths import solve_beam, solve_wire
from wirefe import model as wire
from wirefe.contact.points import contact_points
from wirefe.mesh import mesh_wire
from wirefe.results.shape import WireShape
from wirefe.rod import straight_rod
from wirefe.solve import KERNELS as WIRE_KERNELS

BARE, CONTACT = "spring-b-no-contact", "spring-b"


def _followed(scene, problem, kernels):
    return follow_problem(problem, kernels, output_times(scene), scene.spring.wire_diameter)


def named(name):
    return next(item for item in INPUTS if item.name == name)


def change(scene, model, name):
    """Change by the first value of an input."""
    solve = solve_beam if model == BEAM else solve_wire
    first = named(name).variants(scene, model)[0]
    return difference(*(TipCurve.of(solve(each)) for each in (scene, first.scene)))


def test_deflection_without_contact_goes_with_one_over_the_modulus():
    """The beam of Spring B is linear; the wire at small load, too."""
    exact = 100.0 * (206.0 / 196.0 - 1.0)
    scene = spring_b().without_contact()
    by_beam = change(scene, BEAM, "E")
    np.testing.assert_allclose([by_beam[name] for name in CHANGES], [np.nan, exact, np.nan], rtol=1e-9)
    np.testing.assert_allclose(by_beam[CURVE], exact, rtol=1e-9)
    small = replace(scene, load=replace(scene.load, force=(0.0, -1e-3), steps=1))
    assert change(small, WIRE, "E")[CURVE] == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("factor", [0.96, 1.05])
def test_the_size_is_the_metric_of_the_comparison_and_its_sign_is_farther(factor):
    scene = spring_a().with_steps(10)
    other = replace(scene, material=replace(scene.material, E=206e3 * factor))
    paths = solve_beam(other), solve_beam(scene)
    found = difference(TipCurve.of(paths[1]), TipCurve.of(paths[0]))[CURVE]
    assert abs(found) == pytest.approx(100.0 * compare_paths(*paths).curve_max, rel=1e-12)
    assert np.sign(found) == np.sign(1.0 - factor)


def test_held_components_are_not_numbers_and_signs_follow_the_motion():
    base = np.array([[1.0, 0.0, -2.0], [2.0, 0.0, -4.0]])
    tips = np.array([[1.2, 0.0, -2.0], [1.8, 0.0, -5.0]])
    expected = [[10.0, np.nan, 0.0], [-10.0, np.nan, 25.0]]
    np.testing.assert_allclose(farther(tips, base), expected, atol=1e-12)


def test_small_changes_are_those_of_the_derivatives():
    """E at constant nu is E and G together; the penalty alone."""
    scene, share = spring_a(), 1e-5
    path = equivbeam.solve(scene)
    E, G, K = equivbeam.sensitivities(path, ["E", "G", "penalty"]).relative[-1]
    expected = {"E": E + G, "penalty": K}
    others = {
        "E": replace(scene, material=replace(scene.material, E=206e3 * (1.0 + share))),
        "penalty": scene.with_penalty(1e4 * (1.0 + share)),
    }
    for name, rates in expected.items():
        found = farther(solve_beam(others[name]).tips, solve_beam(scene).tips)[-1]
        np.testing.assert_allclose(found, 100.0 * share * rates / path.tips[-1], rtol=2e-3)


def by_shifted_mesh(scene, height):
    """The wire model whose reference point is another one from the start."""
    mesh = mesh_wire(scene.spring, PAPER_MESH["elements_per_turn"])
    up = np.array([0.0, height, 0.0])
    mesh = replace(mesh, reference=mesh.reference + up, arm=mesh.arm - up)
    top = len(mesh.points) - 1
    rod = straight_rod(mesh.points, round_section(scene.spring.wire_diameter, scene.material)).holding(0)
    rod = rod.holding(top, "uz", "rotx", "roty").loaded(top, force=(*scene.load.force, 0.0))
    data = wire.rod_model(rod, mesh.arm, contact_points(scene, mesh, 40, 4))
    start, pairs = wire.rest_state(rod, mesh.arm), len(data.contact.pairs)
    history = np.zeros(pairs, PAIR_HISTORY)
    size = wire.matrix_size(data)
    problem = Problem(
        data, wire.load_vector(rod), start, float(np.abs(start).max()), history, size, modified=True
    )
    return scene_path(scene, WIRE, {}, _followed(scene, problem, WIRE_KERNELS), WireShape(scene, data, mesh))


@pytest.mark.parametrize(("enabled", "error"), [(False, 1e-5), (True, 1e-3)])
def test_a_raised_load_on_the_wire(enabled, error):
    """Interpolated and exact differ where pairs close between the three paths, by 3e-4 of 0.9 mm."""
    scene = spring_a() if enabled else spring_a().without_contact()
    scene = scene.with_steps(10)
    exact = by_shifted_mesh(scene, 0.75).tips
    moved = np.abs(exact - solve_wire(scene).tips).max(axis=0)
    np.testing.assert_allclose(raised(scene, WIRE, 0.75).tips, exact, rtol=0.0, atol=error)
    assert (moved > [0.9, 0.7, 0.03]).all()


def test_a_raised_load_on_the_beam():
    """As if carried by one more half coil that does not give."""
    scene = spring_a().without_contact().with_steps(10)
    lever = 0.5 * scene.spring.pitch
    longer = replace(scene.spring, active_coils=15.0, active_height=scene.spring.active_height + lever)
    taller = replace(scene, spring=longer)
    data = beam.build_model(taller)
    data.rows[-1, [KAX, KSH, KFL]] *= 1e7
    run = _followed(taller, beam.beam_problem(data, beam.load_vector(data, taller)), BEAM_KERNELS)
    exact = scene_path(taller, BEAM, {}, run, beam_shape(taller, data, "haringx")).tips
    np.testing.assert_allclose(raised(scene, BEAM, lever).tips, exact, rtol=1e-5)


@pytest.mark.parametrize("held", [(), ("ux",)], ids=["free", "pinned"])
@pytest.mark.parametrize("rise", [0.0, 2.0])
def test_a_raised_axial_load(held, rise):
    """It turns no top of the beam: the three moments were all zero, and the tips no numbers."""
    scene = own("axial", load=Load((0.0, -20.0), steps=2), supports=Supports(held)).without_contact()
    straight = solve_beam(scene).tips
    np.testing.assert_allclose(raised(scene, BEAM, rise).tips, straight, atol=1e-12)
    leaning = replace(scene, load=Load((1e-5, -20.0), steps=2))
    np.testing.assert_allclose(raised(leaning, BEAM, rise).tips, straight, atol=1e-5)
    np.testing.assert_allclose(raised(scene, WIRE, rise).tips, solve_wire(scene).tips, atol=5e-3)


@pytest.mark.parametrize("load", [replace(spring_b().load, steps=4), Load(displacement=-9.0, steps=4)])
def test_a_top_that_does_not_turn_has_rigid_turns_and_its_height_is_nothing(load):
    """Under a prescribed displacement neither was varied, and the largest effect was left out."""
    scene = replace(spring_b(), load=load)
    data = changes("b", scene, (named("reference_height"), named("rigid_turns")), lambda line: None).data
    assert set(data["outcome"]) == {"completed"}
    by = data.groupby("input")[CURVE].agg(lambda shares: shares.abs().min())
    assert by["reference_height"] == 0.0
    assert by["rigid_turns"] > 1.0


def test_why_a_height_is_not_varied_is_said():
    scene = replace(spring_a().without_contact(), load=Load(displacement=-9.0, steps=4))
    study = changes("a", scene, (named("reference_height"), named("rigid_turns")), lambda line: None)
    why = "varied if load.force is given or supports.top_held has rotz, got load.displacement"
    for name in ("reference_height", "rigid_turns"):
        assert f"{named(name).title}, {WIRE}: {why}" in study.left_out
    assert NO_INPUT not in set(study.data.query("model == @WIRE")["outcome"])  # which it is


def test_rigid_turns_leave_the_spring_as_it_is():
    """Turns, height and ends of the wire, and the height of the loaded point over the bottom end."""
    scene = spring_a()
    for variant in named("rigid_turns").variants(scene, WIRE):
        ends = []
        for spring, rise in ((scene.spring, 0.0), (variant.scene.spring, variant.rise)):
            points = spring.points(np.array(spring.phase_range))
            loaded = np.array([0.0, spring.active_height + rise, 0.0])
            ends.append((points[1] - points[0], loaded - points[0], points[0] * [1.0, 0.0, 1.0]))
        np.testing.assert_allclose(ends[0], ends[1], atol=1e-12)


def test_the_other_exponent_has_hertz_stiffness():
    scene = spring_b()
    contact = named("exponent").variants(scene, BEAM)[0].scene.contact
    assert contact.stiffness * LIKE**1.5 == pytest.approx(scene.contact.stiffness * LIKE)
    assert contact.sliding == "none"
    E, nu, d = scene.material.E, scene.material.nu, scene.spring.wire_diameter
    hertz = 4.0 / 3.0 * E / (2.0 * (1.0 - nu**2)) * math.sqrt(d / 4.0)
    assert contact.stiffness == pytest.approx(hertz, rel=0.1)


def test_estimates_take_each_input_once_and_leave_out_what_has_no_number():
    base = TipCurve(np.ones(1), np.array([[0.0, -1.0, 0.0]]), "completed", None)

    def by(percent, outcome="completed"):
        return base, TipCurve(np.ones(1), np.array([[0.0, -1.0 - 0.01 * percent, 0.0]]), outcome, None)

    found = {
        "E": {"3": by(3.0), "-2": by(-2.0), "50": by(50.0, "limit_point")},
        "nu": {"4": by(4.0)},
        "rigid_turns": {"-12": by(-12.0)},
    }
    rows = [
        row
        for name, changed in found.items()
        for row in input_rows(
            named(name), {(BEAM, value): pair for value, pair in changed.items()}, {BEAM: base, WIRE: base}
        )
    ]
    data = pd.DataFrame(rows, columns=COLUMNS)
    assert together(data, BEAM, (NOT_GIVEN,)) == pytest.approx(5.0)
    assert together(data, BEAM, (NOT_GIVEN, READING)) == pytest.approx(13.0)
    assert together(data, WIRE, (NOT_GIVEN, READING)) == 0.0
    assert worst(data, BEAM, (NOT_GIVEN,))[CURVE] == pytest.approx(4.0)
    assert list(sizes(data).index) == ["rigid_turns", "nu", "E"]
    deviation = data.set_index("value")[DEVIATION]
    assert deviation["4"] == pytest.approx(4.0)
    assert np.isnan(deviation["50"])


def test_the_figure_has_a_key_of_what_is_drawn_and_letters_of_several_panels():
    base, moved = (TipCurve(np.ones(1), np.array([[0.0, y, 0.0]]), "completed", None) for y in (-1.0, -1.03))
    found = {(model, "3"): (base, moved) for model in MODELS}
    rows = pd.DataFrame(input_rows(named("E"), found, dict.fromkeys(MODELS, base)), columns=COLUMNS)
    rows["case"] = "mine"
    study = Study("mine", rows, (named("E"),), 1.0)

    def said(*studies):
        figure = draw(studies)
        titles = [axes.get_title() for axes in figure.axes if axes.get_visible()]
        return titles, [text.get_text().partition(" ")[0] for text in figure.legends[0].get_texts()]

    assert said(study) == (["mine"], ["equivalent", "wire", "deviation"])
    ended = replace(study, data=rows.assign(outcome="limit_point"), deviation=None)
    assert said(ended) == (["mine"], ["equivalent", "wire", "a"])
    alone = replace(study, data=rows.assign(outcome=rows["outcome"].where(rows["model"] == WIRE, NO_INPUT)))
    assert said(alone) == (["mine"], ["wire", "deviation"])  # the beam's bars are nowhere
    assert said(study, study)[0] == ["(a) mine", "(b) mine"]
    starred = replace(study, inputs=(replace(named("E"), kind=AGAINST),))
    assert said(starred)[1] == ["equivalent", "wire", "deviation", "the"]


def test_crosses_stand_beside_the_bars():
    """At zero they would cover a short bar, which starts there."""
    base, moved = (TipCurve(np.ones(1), np.array([[0.0, y, 0.0]]), "completed", None) for y in (-1.0, -1.03))
    found = {(model, "3"): (base, moved) for model in MODELS}
    found |= {(WIRE, "4"): (base, TipCurve(np.ones(0), np.zeros((0, 3)), "limit_point", 0.5))}
    rows = pd.DataFrame(input_rows(named("E"), found, dict.fromkeys(MODELS, base)), columns=COLUMNS)
    axes = draw((Study("mine", rows.assign(case="mine"), (named("E"),), 1.0),)).axes[0]
    (cross,) = (line for line in axes.lines if line.get_marker() == "x")
    bars = [axes.transData.transform((patch.get_x() + patch.get_width(), 0.0))[0] for patch in axes.patches]
    assert cross.get_transform().transform(cross.get_xydata())[0, 0] > max(bars)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Both cases of Spring B, from the command line."""
    out = tmp_path_factory.mktemp("sensitivity")
    assert main(["sensitivity", "--only", f"{BARE},{CONTACT}", "--out", str(out)]) == 0
    return out


def rows_of(folder):
    with open(folder / "sensitivity.csv", encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(lines))


def test_a_row_for_every_input_case_and_model(folder):
    rows = rows_of(folder)
    assert all(None not in row and None not in row.values() for row in rows)  # as many cells as columns
    found = {(row["case"], row["model"], row["input"]) for row in rows}
    assert found == {
        (name, model, item.name) for name in (BARE, CONTACT) for model in MODELS for item in INPUTS
    }
    for row in rows:
        values = named(row["input"]).variants(case(row["case"]).scene, row["model"])
        assert (row["outcome"] == NO_INPUT) == (not values)
        assert (row["curve_change_percent"] != "") == (row["outcome"] == "completed")


def test_limit_points_are_named_and_have_no_number(folder):
    """A modulus 5 % lower brings the end of the frictionless beam, 1.028 times the load, below it."""
    short = [row for row in rows_of(folder) if row["outcome"] not in ("completed", NO_INPUT)]
    assert [(row["case"], row["model"], row["value"], row["outcome"]) for row in short] == [
        (CONTACT, BEAM, "196 GPa", "limit_point"),
        (CONTACT, WIRE, "2", "interpenetration"),  # of sphere pairs per turn: wires pass between them
    ]
    assert float(short[0]["critical_time"]) == pytest.approx(1.028 * 196.0 / 206.0, abs=1e-3)
    page = (folder / "sensitivity.md").read_text(encoding="utf-8")
    title = "moduli E and G"
    assert f"| {title} | beam | 196 GPa | limit point at t = 0.978 |  |  |  |  |  |" in page
    assert f"Spring B, beam, {title}: 196 GPa: **limit point at t = 0.978**" in page
    assert "at least" in page
    assert "nan" not in page


def test_the_tables_are_sorted_by_size(folder):
    page = (folder / "sensitivity.md").read_text(encoding="utf-8")
    table = page.split("## Spring B w/o contacts")[1].split("\n\n")[2].splitlines()[2:]
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table]
    sizes = {row[0]: 0.0 for row in cells}
    for row in cells:
        sizes[row[0]] = max(sizes[row[0]], abs(float(row[6])))
    assert len(sizes) > 4
    assert list(sizes.values()) == sorted(sizes.values(), reverse=True)


def test_the_figure_is_there_twice(folder):
    assert (folder / "sensitivity.png").read_bytes().startswith(b"\x89PNG")
    assert ElementTree.parse(folder / "sensitivity.svg").getroot().tag.endswith("svg")


def test_bad_input(tmp_path, capsys):
    assert main(["sensitivity", "--only", "spring-c", "--out", str(tmp_path)]) == 2
    assert "must be names of spring-a," in capsys.readouterr().err
    with pytest.raises(InputError, match=r"only must hold names of spring-a, .* got 'spring-c'"):
        sensitivity(tmp_path, ["spring-c"])


def own(name, coils=2.5, **parts):
    """A short spring of a user's; contact of wires, which its load does not close."""
    spring = Spring(wire_diameter=1.5, mean_diameter=10.0, active_coils=coils, active_height=7.0)
    return Scene(name, spring, **{"load": Load((2.0, -20.0), steps=2)} | parts)


def test_inputs_of_ones_own_scene_are_about_its_own_values():
    brass = replace(
        own("brass"),
        material=Material(E=110e3, nu=0.35),
        spring=replace(own("brass").spring, start_phase=1.0, end_turns=0.75),
    )
    inputs = {item.name: item for item in inputs_of(brass)}
    assert inputs["penalty"].default == "K = 10000 N/mm"
    hertz = inputs_of(replace(brass, contact=Contact(exponent=1.5)))
    assert "K = 10000 N/mm^1.5" in [item.default for item in hertz]
    assert {item.kind for item in inputs.values()} == {VARIED}
    assert (inputs["E"].default, inputs["pairs"].default) == ("110 GPa", "32 wires")
    found = {name: item.variants(brass, WIRE) for name, item in inputs.items()}
    assert [each.scene.material.E for each in found["E"]] == pytest.approx([104.5e3, 115.5e3])
    assert [each.scene.material.nu for each in found["nu"]] == pytest.approx([0.32, 0.38])
    assert [each.scene.spring.end_turns for each in found["rigid_turns"]] == [0.5, 1.0]
    assert found["start_phase"][0].scene.spring.start_phase == pytest.approx(1.0 + math.radians(30.0))
    assert [each.options["pairs_per_turn"] for each in found["pairs"]] == [16, 64]
    assert [name for name, values in found.items() if not values] == ["sphere_place"]
    for scene in (own("m", load=Load(displacement=-2.0)), own("s", load=Load(stages=((0.0, -9.0),)))):
        inputs = {item.name: item for item in inputs_of(scene)}
        for name in ("reference_height", "rigid_turns"):
            with pytest.raises(InputError, match=r"varied if load\.force is given"):
                inputs[name].variants(scene, WIRE)
    plates = replace(own("p", load=Load((0.0, -20.0))), supports=Supports(("ux", "rotz"), seat="plate"))
    assert next(item for item in INPUTS if item.name == "end_contact").variants(plates, WIRE) == ()


def test_scenes_of_ones_own_beside_what_they_cannot_be_given(tmp_path, monkeypatch):
    """A displacement whose force goes with the modulus, and a scene that no beam represents."""
    monkeypatch.setattr(sensitivity_run, "make_ready", lambda: None)
    few = ("E", "pairs", "element")
    chosen = sensitivity_run.inputs_of
    monkeypatch.setattr(
        sensitivity_run, "inputs_of", lambda scene: tuple(i for i in chosen(scene) if i.name in few)
    )
    machine = own("machine", load=Load(displacement=-1.0, steps=2), supports=Supports(("ux", "rotz")))
    thirds = own("odd", coils=2.3, contact=Contact(sliding="none"))
    studies = sensitivity(tmp_path, scenes={"machine": machine, "odd": thirds})
    rows = studies[0].data.set_index(["model", "input", "value"])[CURVE]
    for model in MODELS:  # the force of a given displacement is in proportion to the stiffness
        assert rows[model, "E", "216.3 GPa"] == pytest.approx(5.0, rel=1e-6)
    said = [line for study in studies for line in digest(study)]
    assert said[1].startswith("odd, equivbeam: spring.active_coils must be a multiple of 0.5")
    assert (studies[0].resolution, studies[1].resolution) == (None, pytest.approx(0.0, abs=1e-6))
    text = (tmp_path / "sensitivity.md").read_text(encoding="utf-8")
    assert "- Left out: equivbeam: spring.active_coils must be" in text
    assert text.count("UY is prescribed") == text.count("Closed pairs stick or slide with friction") == 1
    for absent in ("nan", "the paper", "authors", "Spring A"):
        assert absent not in text
    assert (tmp_path / "sensitivity.png").is_file()
    with pytest.raises(InputError, match=r"nobody: no model has a load curve to vary: equivbeam: "):
        sensitivity(tmp_path, scenes={"nobody": own("nobody", coils=2.31)})


def test_a_scene_of_which_no_path_reaches_full_load_is_left_out(tmp_path, monkeypatch, capsys):
    """Exit code 3, as of any path that ends early; alone it leaves nothing, and what else is done is kept."""
    monkeypatch.setattr(sensitivity_run, "make_ready", lambda: None)
    chosen = sensitivity_run.inputs_of
    monkeypatch.setattr(
        sensitivity_run, "inputs_of", lambda scene: tuple(i for i in chosen(scene) if i.name == "E")
    )
    monkeypatch.chdir(tmp_path)
    loose = own("loose", coils=2.5, contact=Contact(geometry="spheres"), load=Load((0.0, -400.0)))
    for scene in (loose, own("mine", load=Load((0.0, -9.0), steps=2))):
        (tmp_path / f"{scene.name}.toml").write_text(scene_text(scene), encoding="utf-8")
    ends = "loose: equivbeam ends short of full load: limit point at t = "
    assert main(["sensitivity", "loose.toml", "--out", "alone"]) == 3
    assert capsys.readouterr().err.startswith(f"coilcheck: {ends}")
    assert not (tmp_path / "alone").exists()
    for scenes in (["loose.toml", "mine.toml"], ["mine.toml", "loose.toml"]):
        assert main(["sensitivity", *scenes, "--out", "both"]) == 3
        captured = capsys.readouterr()
        assert captured.err.startswith(f"coilcheck: {ends}")
        assert "mine: the inputs that are varied move" in captured.out
        assert {row["case"] for row in rows_of(tmp_path / "both")} == {"mine"}
        text = (tmp_path / "both" / "sensitivity.md").read_text(encoding="utf-8")
        assert f"Left out, since no path reaches full load: {ends}" in text
        assert "## loose" not in text


def test_a_component_that_hardly_moves_is_not_counted():
    """ROTZ of 2e-5 rad beside a millimetre."""
    path = solve_wire(own("axial", load=Load((0.0, -20.0), steps=1)))
    assert 0.0 < abs(path.tips[-1, 2]) * 3.5 < 0.01 * abs(path.tips[-1, 1])
    assert TipCurve.of(path).counted[1:] == (True, False)
    found = difference(TipCurve.of(path), TipCurve.of(path))
    assert np.isnan(found["rotz_change_percent"])
    assert TipCurve.of(solve_wire(spring_a(), steps=1)).counted == (True, True, True)


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        ("spring-a --only spring-b", "SCENE or --only, not both, got spring-a and spring-b"),
        ("nowhere.toml", "nowhere.toml"),
        ("--geometry wires", "--geometry must go with SCENE, got wires alone"),
    ],
)
def test_bad_scenes_are_refused_in_one_sentence(arguments, part, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["sensitivity", *arguments.split()]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert part in message
    assert not list(tmp_path.iterdir())


def test_what_was_solved_before_an_interrupt_is_kept(tmp_path, monkeypatch):
    monkeypatch.setenv("COILCHECK_STORE", str(tmp_path / "store"))
    solved = []
    for name in ("solve_beam", "solve_wire"):
        solve = getattr(paths, name)
        monkeypatch.setattr(paths, name, lambda *given, of=solve, **by: solved.append(1) or of(*given, **by))

    def progress(line):
        if len(solved) > 4:
            raise KeyboardInterrupt

    scene = case(BARE).scene.with_steps(2)
    with pytest.raises(KeyboardInterrupt, match="what is solved is kept; the same command goes on"):
        sensitivity(tmp_path / "out", progress=progress, scenes={"bare": scene})
    before = len(solved)
    sensitivity(tmp_path / "out", scenes={"bare": scene})
    whole = len(solved)
    assert before < whole
    sensitivity(tmp_path / "out", scenes={"bare": scene})
    assert len(solved) == whole
    assert len(list((tmp_path / "store").glob("*.coilcheck"))) == whole
