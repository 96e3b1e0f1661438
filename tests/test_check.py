"""Closed-form numbers of springs, and the commands new and check."""

import json
import math
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import equivbeam
import wirefe
from coilspring import (
    CATALOGUE,
    CoilSection,
    Load,
    Material,
    Scene,
    Spring,
    Supports,
    load_scene,
    spring_a,
    spring_b,
)
from coilspring.scene.sizing import (
    POINTS,
    along,
    axial_rate,
    buckling_shortening,
    least_gap,
    sizes,
    wire_length,
)
from coilspring.scene.toml import scene_from_text, scene_text
from validation.cli import main
from validation.view.check import report
from validation.view.drawing import draw
from validation.view.held import held_wire

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.toml"))
SCENES = (*CATALOGUE, *map(str, EXAMPLES))
CYLINDER = Spring(2.0, 20.0, 8.0, 40.0)


def scene_of(spring=CYLINDER, force=-20.0, held=("ux", "rotz"), E=206e3):
    return Scene("scene", spring, Load((0.0, force)), Material(E), Supports(held))


@pytest.mark.parametrize("source", SCENES)
def test_a_scene_written_out_reads_back_the_same(source):
    scene = load_scene(source)
    assert scene_from_text(scene_text(scene)) == scene


def test_every_key_is_written_out():
    odd = replace(
        load_scene("spring-b"),
        name='quo"te \\ \t ünïcode \x7f \x1f 弹簧 🌀',
        spring=replace(CYLINDER, hand="right", ends="open", start_phase=0.1, end_turns=0.75),
        supports=Supports(("uy",), ("rotz",), "plate"),
        load=Load((1.0 / 3.0, -1e-300), 7),
        contact=replace(load_scene("spring-b").contact, enabled=False, sliding="coulomb", friction=0.3),
    )
    assert scene_from_text(scene_text(odd)) == odd


@pytest.mark.parametrize(
    "load", [Load(stages=((0.0, -5.0), (0.0, 0.0)), steps=3), Load(displacement=(-2.0,))]
)
def test_histories_are_written_out(load):
    scene = replace(load_scene("spring-b"), load=load)
    assert scene_from_text(scene_text(scene)) == scene


def test_the_axial_load_is_the_largest_of_a_history():
    scene = scene_of()
    staged = replace(scene, load=Load(stages=((0.0, -5.0), (0.0, -30.0), (0.0, 8.0))))
    assert sizes(staged).force == 30.0
    driven = replace(scene, load=Load(displacement=(-2.0, 0.0)))
    assert sizes(driven).shortening == pytest.approx(2.0)


@pytest.mark.parametrize("pressed", [False, True], ids=["forces", "displacement"])
def test_a_history_that_pulls_more_is_judged_by_what_compresses(pressed):
    """Where the largest magnitude pulled nothing was said of 70 N beyond solid, buckling and closing."""
    rate, slender = sizes(scene_of()).rate, replace(CYLINDER, active_coils=20.0, active_height=100.0)
    load = Load(stages=((0.0, 90.0), (0.0, -70.0), (0.0, 0.0)))
    if pressed:
        load = Load(displacement=(90.0 / rate, -1.01 * sizes(scene_of()).travel))
    scene = replace(scene_of(), load=load)
    found = sizes(scene)
    assert found.force == (math.inf if pressed else 70.0)
    assert found.pull == pytest.approx(90.0)
    assert found.stress == pytest.approx(sizes(scene_of(force=90.0)).stress)
    lines, warnings = report(scene)
    assert "                it also pulls, by up to 90 N: the stress is the larger one of both" in lines
    pulls = "the axial load pulls too, by up to 90 N: a force or displacement that compresses is negative"
    assert warnings[0] == pulls
    assert "beyond solid" in warnings[1]
    column = replace(scene_of(slender, held=()), load=Load(stages=((0.0, 90.0), (0.0, -50.0))))
    assert any("as a column it buckles" in text for text in report(column)[1])
    bare = replace(
        scene_of(Spring(2.0, (24.0, 16.0), 8.0, 60.0)), load=Load(stages=((0.0, 300.0), (0.0, -160.0)))
    )
    assert "coils close under the load, and contact is not enabled" in report(bare.without_contact())[1]


def test_without_contact_no_coil_closes():
    """The formulas go on with the whole force, and no line speaks of coils that have closed."""
    spring = Spring(2.0, 16.0, 5.0, 25.0, start_phase=0.7)
    for load in (Load((0.0, -160.0)), Load(displacement=(-160.0 / axial_rate(scene_of(spring)),))):
        scene = replace(scene_of(spring), load=load).without_contact()
        found, (lines, warnings) = sizes(scene), report(scene)
        assert found.force == pytest.approx(160.0)
        assert found.stressed_by == found.force
        assert found.shortening == pytest.approx(160.0 / found.rate)
        assert "coils close under the load, and contact is not enabled" in warnings
        assert not any("solid" in line for line in (*lines[5:], *warnings))
        assert not any("has closed" in line or "give no more" in line for line in lines)


def test_coils_that_touch_at_rest_have_no_negative_gap():
    assert least_gap(Spring(2.0, 16.0, 5.0, 10.0)) == 0.0


@pytest.mark.parametrize("name", CATALOGUE)
def test_new_prints_a_scene_file(name, capsys):
    assert main(["new", name]) == 0
    text = capsys.readouterr().out
    assert scene_from_text(text) == CATALOGUE[name]()
    keys = [line for line in text.splitlines() if line and line[0] not in "#["]
    assert all("  # " in line or " # " in line for line in keys)
    # the kinds of coils that are only shown become valid by taking the marks away
    shown = re.sub(r"(?m)^# (?=\[\[|coils|pitch|mean_)", "", text)
    for key in ("mean_diameter", "active_coils", "active_height"):
        shown = re.sub(rf"(?m)^{key} = .*\n", "", shown, count=1)
    assert scene_from_text(shown).spring.sections == (CoilSection(2.0, (2.0, 4.0), (12.0, 9.0)),)


def test_numbers_of_a_cylinder_by_hand():
    found = sizes(scene_of())
    G, d, D, n = 206e3 / 2.6, 2.0, 20.0, 8.0
    assert found.rate == pytest.approx(G * d**4 / (8.0 * D**3 * n), rel=1e-14)
    assert found.closing == pytest.approx((found.rate * (40.0 - 16.0),) * 2, rel=1e-12)
    assert (found.total_coils, found.index) == (10.0, (10.0, 10.0))
    assert found.free_length == pytest.approx(40.0 + 4.0 + 2.0)
    assert found.solid_length == pytest.approx((n + 2.0 + 1.0) * d)
    assert found.travel == pytest.approx(24.0)
    assert found.least_gap == pytest.approx(3.0)
    assert found.helix_angle == pytest.approx(math.atan(5.0 / (math.pi * D)))
    length = n * math.hypot(math.pi * D, 5.0) + 2.0 * math.hypot(math.pi * D, 2.0)
    assert found.wire_length == pytest.approx(length, rel=1e-13)
    assert found.stress_factor == pytest.approx(10.5 / 9.25)
    assert found.stress == pytest.approx(10.5 / 9.25 * 8.0 * 20.0 * D / (math.pi * d**3))
    assert found.shortening == pytest.approx(20.0 / found.rate)


def test_ground_ends_are_solid_at_the_standards_length():
    """Half of the wire is gone at each tip: (n + 2) d of EN 15800, and the same travel."""
    rigid = sizes(scene_of())
    plates = replace(scene_of(), supports=Supports(("ux", "rotz"), seat="plate"))
    found = sizes(plates)
    assert found.solid_length == pytest.approx((8.0 + 2.0) * 2.0)
    assert found.free_length == pytest.approx(rigid.free_length - 2.0)
    assert found.travel == pytest.approx(rigid.travel)
    assert any("over the ground ends" in line for line in report(plates)[0])
    assert not any("ground" in line for line in report(scene_of())[0])
    assert any(line.startswith("the rate is that of rigid end turns") for line in report(plates)[1])


def test_coils_that_have_closed_give_no_more():
    """A cone under twice its first closing force, by quadrature of each coil's way."""
    d, G = 2.0, 206e3 / 2.6
    cone = scene_of(Spring(d, (24.0, 16.0), 8.0, 60.0), force=-160.0)
    found = sizes(cone)
    first, last = found.closing
    assert first < 160.0 < last
    D = np.linspace(24.0, 16.0, 400_001)
    gap = 7.5 - np.sqrt(d**2 - 0.5**2)  # a coil above is 0.5 mm narrower all round
    way = np.minimum(8.0 * D**3 * 160.0 / (G * d**4), gap)
    assert found.shortening == pytest.approx(8.0 * np.mean(way), rel=1e-3)
    stress = (D / d + 0.5) / (D / d - 0.75) * 8.0 * D / (math.pi * d**3)
    carried = np.minimum(160.0, G * d**4 * gap / (8.0 * D**3))
    assert found.stress == pytest.approx((stress * carried).max(), rel=3e-3)
    driven = sizes(replace(cone, load=Load(displacement=(-found.shortening,))))
    assert driven.force == pytest.approx(160.0, rel=1e-3)
    beyond = replace(cone, load=Load(displacement=(-1.01 * found.travel,)))
    assert math.isinf(sizes(beyond).force)
    lines, warnings = report(beyond)
    assert any("beyond solid" in warning for warning in warnings)
    way, solid = (f"{factor * found.travel:.3g} mm" for factor in (1.01, 1.0))
    assert f"  axial load    no force shortens it by {way}: it is solid at {solid}" in lines
    assert not any("inf" in line for line in lines if "axial load" in line or "stress" in line)


def test_a_way_to_solid_is_not_beyond_it():
    for coils in (8.0, 9.5, 11.5):
        scene = scene_of(Spring(2.0, 20.0, coils, 7.3 * coils))
        solid = replace(scene, load=Load(displacement=(-sizes(scene).travel,)))
        assert sizes(solid).force == pytest.approx(sizes(scene).closing[1], rel=1e-6)


def test_what_pulls_or_pushes_sideways_closes_nothing():
    pulled = sizes(scene_of(force=20.0))
    assert (pulled.force, pulled.shortening) == (-20.0, pytest.approx(-20.0 / pulled.rate))
    longer = sizes(replace(scene_of(), load=Load(displacement=(5.0,))))
    assert (longer.force, longer.shortening) == (pytest.approx(-5.0 * longer.rate), -5.0)
    lines, _ = report(Scene("across", CYLINDER, Load((-9.0, 0.0))))
    assert any("axial load    0 N, which shortens it by 0 mm" in line for line in lines)
    touching = sizes(scene_of(Spring(2.0, 20.0, 8.0, 16.0)))
    assert (touching.shortening, touching.stress) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("load", "held", "said"),
    [
        (Load((-9.0, -4.0)), (), "of the axial load alone, the sideways force of 9 N is not in it (8 F D"),
        (Load(stages=((0.0, -4.0), (-5.0, -4.0), (0.0, 0.0))), (), "the sideways force of 5 N is not in it"),
        (Load((-9.0, 0.0)), (), "not by this formula, which knows axial loads alone: solve --model wirefe"),
        (Load((-9.0, -4.0)), ("ux",), " MPa (8 F D"),  # the support takes it
    ],
)
def test_the_stress_says_that_it_leaves_a_sideways_force_out(load, held, said):
    lines, _ = report(Scene("across", CYLINDER, load, supports=Supports(held)))
    (stress,) = (line for line in lines if line.startswith("  stress"))
    assert said in stress
    assert not any(" 0 MPa" in line for line in lines)


@pytest.mark.parametrize(
    ("force", "said"), [(-50.0, "13906-1)"), (-65.0, ", of 59.4 N: a coil that has closed carries no more")]
)
def test_the_stress_says_which_force_it_is_of(force, said):
    """Beside a load beyond solid it stood as the stress of that load."""
    lines, _ = report(scene_of(force=force))
    (stress,) = (line for line in lines if line.startswith("  stress"))
    assert stress.endswith(said)


def test_a_model_that_leaves_the_scenes_sliding_out_says_so():
    assert any("--sliding scene" in line for line in report(spring_b())[0])
    assert not any("--sliding scene" in line for line in report(spring_a())[0])


def test_flat_coils_of_a_cone_nest():
    cone = Spring(1.0, (30.0, 10.0), 5.0, 20.0, end_turns=0.0)  # each coil is 2 mm narrower all round
    found = sizes(scene_of(cone))
    assert found.solid_length == pytest.approx(1.0)
    assert found.travel == pytest.approx(20.0)
    steel = 206e3 / 2.6 / 8.0
    assert found.closing == pytest.approx((steel * 4.0 / 30.0**3, steel * 4.0 / 10.0**3))
    assert least_gap(cone) == pytest.approx(math.hypot(2.0, 4.0) - 1.0)
    steep = replace(cone, mean_diameter=(14.0, 10.0))  # 0.4 mm
    assert sizes(scene_of(steep)).travel == pytest.approx(20.0 - 5.0 * math.sqrt(1.0 - 0.16))


@pytest.mark.parametrize("coils", [0.02, 0.25])
def test_coils_do_not_pass_inside_one_another_where_a_short_section_widens_them_a_little(coils):
    """By 0.5 mm all round, of a wire of 3 mm, though that is up to 25 mm per turn of this section."""
    cylinders = CoilSection(3.0, 4.5, 20.0), CoilSection(3.0, 4.5, 21.0)
    sections = cylinders[0], CoilSection(coils, 4.5, (20.0, 21.0)), cylinders[1]
    scene = scene_of(Spring.of_sections(3.0, sections), force=1500.0)
    found, steel = sizes(scene), 206e3 / 2.6 / 8.0 * 3.0**4
    assert not any("inside one another" in warning for warning in report(scene)[1])
    assert found.closing[1] == pytest.approx(steel * (4.5 - math.sqrt(8.75)) / 20.0**3)
    assert found.travel == pytest.approx(9.0 + coils * (4.5 - math.sqrt(8.75)))
    # many short sections that make a cone are that cone
    ends = np.linspace(30.0, 10.0, 21)
    cone = [CoilSection(0.25, 4.0, pair) for pair in pairwise(ends)]
    assert sizes(scene_of(Spring.of_sections(1.0, cone, end_turns=0.0))).solid_length == pytest.approx(1.0)


@pytest.mark.parametrize("source", SCENES)
def test_the_rate_is_that_of_the_models(source):
    """Without contact and with small loads: the paper's cos p and the wire's stretch are left out."""
    guided = Supports(("ux", "rotz"))
    scene = replace(load_scene(source).without_contact(), load=Load((0.0, -1e-3), 1), supports=guided)
    rate = sizes(scene).rate
    for path in (equivbeam.solve(scene), wirefe.solve(scene, element="curved", elements_per_turn=8)):
        assert -1e-3 / path.tips[-1, 1] == pytest.approx(rate, rel=0.015)  # 1.3 % found


@pytest.mark.parametrize("source", SCENES)
def test_the_wire_is_as_long_as_drawn(source):
    spring = load_scene(source).spring
    phases = np.linspace(*spring.phase_range, 200_001)
    drawn = np.linalg.norm(np.diff(spring.points(phases), axis=0), axis=1).sum()
    assert wire_length(spring) == pytest.approx(drawn, rel=1e-6)


@pytest.mark.parametrize(
    ("height", "coils", "held", "target"),
    [
        (28.6, 14.5, (), 2.5815398),
        (60.0, 20.0, ("ux", "rotz"), 25.0106006),
        (100.0, 30.0, ("ux", "rotz"), 12.0505847),
    ],
)
def test_buckling_by_the_standard(height, coils, held, target):
    """The numbers of tests/test_column.py, to which the equivalent beam tends; D = 10."""
    spring = Spring(1.0, 10.0, coils, height, end_turns=0.0)
    assert buckling_shortening(scene_of(spring, held=held)) == pytest.approx(target, rel=1e-7)


@pytest.mark.parametrize(("held", "tolerance"), [((), 2e-4), (("rotz",), 1e-3), (("ux",), 4e-3)])
def test_buckling_of_the_equivalent_beam(held, tolerance):
    """The standard rounds the length of a column clamped and pinned, 0.699, to 0.7."""
    scene = scene_of(Spring(1.0, 10.0, 30.0, 120.0, end_turns=0.0), held=held)
    found = equivbeam.buckling(scene, inclined=False).shortening
    assert buckling_shortening(scene) == pytest.approx(found, rel=tolerance)


def test_what_does_not_buckle():
    assert buckling_shortening(scene_of(replace(CYLINDER, active_height=20.0))) is None
    across = Scene("across", CYLINDER, Load((-1.0, -5.0)), supports=Supports(("uy",)))
    assert buckling_shortening(across) is None
    assert sizes(across).force == 0.0


def test_first_coils_close_as_the_model_says():
    """Spring B: 62 N in the wire model, whose coils next to the closed end turns touch a little sooner."""
    first, _ = sizes(load_scene("spring-b")).closing
    path = wirefe.solve(load_scene("spring-b"))
    touched = -path.loads[np.flatnonzero(path.active_contacts)[0], 1]
    assert touched == pytest.approx(first, rel=0.1)


WARNINGS = [
    ({}, {"E": 206.0}, "E is 206 MPa, which looks like GPa"),
    (
        {"wire_diameter": 0.002, "mean_diameter": 0.02, "active_height": 0.04},
        {"force": -1e-6},
        "the wire diameter is 0.002 mm, which looks like metres",
    ),
    ({"mean_diameter": 7.0}, {}, "index D/d is 3.5, outside 4 to 20"),
    ({"mean_diameter": (30.0, 44.0)}, {}, "index D/d is 15 to 22, outside"),
    ({"active_coils": 1.5, "active_height": 6.0}, {}, "1.5 active coils, less than 2"),
    ({"active_coils": 1.0, "active_height": 6.0}, {}, "1 active coil, less than 2"),
    ({"active_height": 80.0}, {"held": ("ux", "rotz")}, "helix angle up to 9.04 degrees, above 7.5"),
    ({}, {"force": 5.0}, "the axial load pulls"),
    ({"active_coils": 20.0, "active_height": 100.0}, {"held": ()}, "slenderness 5: as a column it buckles"),
    ({"active_height": 16.0}, {}, "coils touch at rest"),
    (
        {"start_phase": -90.0},
        {},
        "the start phase is -90 rad, which looks like degrees: -90 degrees are -1.5708 rad",
    ),
    ({"mean_diameter": (40.0, 8.0)}, {}, "coils pass inside one another without touching"),
    ({}, {"force": -60.0 - 5.0}, "beyond solid: the last coil closes at 59.4 N"),
]


@pytest.mark.parametrize(("spring", "scene", "warning"), WARNINGS, ids=[row[2][:20] for row in WARNINGS])
def test_warnings(spring, scene, warning):
    _, found = report(scene_of(replace(CYLINDER, **spring), **scene))
    assert [text for text in found if warning in text], found
    assert not [text for text in report(scene_of())[1] if warning.split()[0] in text]


def test_moduli_that_are_of_no_metal_are_told():
    """From E and G, the second in the wrong unit or of another material."""
    odd = replace(scene_of(), material=Material.from_moduli(185e3, 100e3))
    assert "Poisson's ratio is -0.075: most metals have 0.2 to 0.45" in report(odd)[1]
    assert not report(replace(odd, material=Material.from_moduli(185e3, 70e3)))[1]


@pytest.mark.parametrize("command", ["solve --model equivbeam", "compare"])
def test_what_check_warns_of_is_said_by_runs(command, tmp_path, capsys):
    """On stderr and in the JSON; what concerns the formulas of `check` alone is not."""
    scene = scene_of(replace(CYLINDER, mean_diameter=7.0, active_height=80.0), force=-50.0)
    file, out = tmp_path / "scene.toml", tmp_path / "out"
    file.write_text(scene_text(scene))
    run = [*command.split(), str(file), "--steps", "2", "--out", str(out)]
    assert main(run) == 0
    said = capsys.readouterr()
    expected = "index D/d is 3.5, outside 4 to 20 (EN 13906-1)"
    assert said.err == f"coilcheck: warning: {expected}\n"
    assert expected not in said.out
    name = "summary.json" if "solve" in command else "compare.json"
    assert json.loads((out / name).read_text())["warnings"] == [expected]
    assert main([*run, "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")
    assert main([*run, "--json"]) == 0
    said = capsys.readouterr()
    assert (json.loads(said.out)["warnings"], said.err) == ([expected], "")
    assert sum("degrees" in text or expected in text for text in report(scene)[1]) == 2


def test_a_sound_spring_is_not_warned_about():
    assert report(scene_of(replace(CYLINDER, start_phase=6.28)))[1] == []
    assert report(scene_of(replace(CYLINDER, mean_diameter=(35.9, 20.0)), force=-5.0))[1] == []


def test_contact_that_is_needed_is_missed():
    scene = scene_of(force=-65.0)
    cone = replace(scene, spring=replace(CYLINDER, mean_diameter=(24.0, 14.0)))
    assert report(cone)[1] == []
    assert "contact is not enabled" in report(cone.without_contact())[1][-1]


def test_check_says_what_the_models_make_of_a_scene(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "mine.toml"
    text = scene_text(scene_of(replace(CYLINDER, active_coils=8.3, active_height=41.5)))
    file.write_text(text.replace('seat = "rigid"', 'seat = "plate"'))
    assert main(["check", str(file)]) == 0
    out = capsys.readouterr().out
    assert "equivbeam     supports.seat is unsupported by equivbeam" in out
    assert "wirefe        represents it" in out
    file.write_text(text)
    assert main(["check", str(file)]) == 0
    out = capsys.readouterr().out
    assert "equivbeam     spring.active_coils must be a multiple of 0.5" in out
    assert "wirefe        represents it" in out
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.toml"]


@pytest.mark.parametrize("source", ["spring-b", str(EXAMPLES[0])])
def test_check_prints_its_numbers_and_draws_on_request(source, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["check", source, "--draw"]) == 0
    plain = capsys.readouterr().out
    folder = tmp_path / "coilcheck-out" / f"check-{Path(source).stem}"
    assert f"drawn in {folder.relative_to(tmp_path) / 'spring.png'}" in plain
    found = sizes(load_scene(source))
    assert f"rate          {found.rate:.4g} N/mm (G d^4 / 8 D^3 n of EN 13906-1" in plain
    assert f"free {found.free_length:.4g} mm, solid {found.solid_length:.4g} mm" in plain
    with Image.open(folder / "spring.png") as picture:
        assert picture.size == (2007, 1320)  # 170 mm at 300 dots an inch
        assert len(np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0)) > 20
    assert main(["check", source, "--out", str(tmp_path / "here")]) == 0
    assert [path.name for path in (tmp_path / "here").iterdir()] == ["spring.png"]
    assert main(["check", source, "--out", __file__]) == 4


@pytest.mark.parametrize(
    "spring",
    [
        Spring(1e-6, 1e9, 1000.0, 1e9, end_turns=100.0),
        Spring(1.0, 2.0, 0.5, 0.5, end_turns=0.0, start_phase=1.0),
        Spring(1.0, 40.0, 5.0, 5.0),
    ],
)
def test_any_spring_is_drawn(spring, tmp_path):
    draw(scene_of(spring, held=()), tmp_path / "spring.png")
    assert (tmp_path / "spring.png").stat().st_size > 1000


def test_coils_are_looked_at_along_all_sections():
    scene = scene_of(
        Spring.of_sections(1.0, [CoilSection(2.0, 2.0, (8.0, 12.0)), CoilSection(1.0, (2.0, 3.0), 12.0)])
    )
    coils = along(scene)
    np.testing.assert_allclose(coils.turns[[0, POINTS - 1, POINTS, -1]], [0.0, 2.0, 2.0, 3.0])
    np.testing.assert_allclose(np.interp([0.5, 1.0, 2.9], coils.turns, coils.diameter), [9.0, 10.0, 12.0])
    np.testing.assert_allclose(np.interp([1.9, 2.5], coils.turns, coils.pitch), [2.0, 2.5])


def test_a_spring_that_is_pulled_grows_longer():
    lines, _ = report(scene_of(force=20.0))
    (said,) = (line for line in lines if "axial load" in line)
    assert said.startswith("  axial load    20 N, which lengthens it by ")
    assert said.endswith(" mm, by the same formula")


def test_coils_that_are_drawn_far_are_told_as_a_solve_tells():
    scene = scene_of(force=900.0)
    (said,) = (line for line in report(scene)[0] if "equivbeam" in line)
    words = "where law haringx may be far off: use "
    assert words in said
    assert said.split("; ")[-1] in equivbeam.solve(scene).message
    solved: list[str] = []
    for force in (-20.0, 20.0):
        assert not solved  # a load that compresses alone is judged in closed form
        assert "drawn" not in "".join(report(scene_of(force=force), solved.append)[0])
    assert len(solved) == 1


@pytest.mark.parametrize("coils", [0.5, 1.0, 1.5])
@pytest.mark.parametrize("held", [("ux", "rotz"), ("ux",), ()])
def test_the_rate_of_few_coils_is_that_of_the_wire_as_it_is_held(coils, held):
    """By the wire model to 1e-5. A guided half coil is twice as stiff as formulas have it; check says so."""
    scene = scene_of(Spring(2.0, 18.0, coils, 4.0 + 4.0 * coils), force=-1e-4, held=held)
    path = wirefe.solve(scene, steps=1, element="curved", elements_per_turn=8)
    rate = held_wire(scene).rate
    assert -1e-4 / path.tips[-1, 1] == pytest.approx(rate, rel=1e-5)
    told = [warning for warning in report(scene)[1] if f"a rate of {rate:.4g} N/mm" in warning]
    assert len(told) == (abs(sizes(scene).rate / rate - 1.0) > 0.1)
    if coils == 0.5 and "rotz" in held:
        assert rate > 1.9 * sizes(scene).rate


@pytest.mark.parametrize("coils", [1.5, 2.0, 2.5, 3.5, 4.0, 5.5, 10.5])
@pytest.mark.parametrize("diameter", [18.0, (18.0, 14.0)])
@pytest.mark.parametrize("held", [("ux", "rotz"), ()])
def test_the_stress_between_rigid_ends_is_that_of_the_wire_model(coils, diameter, held):
    """To 0.5 %. It is larger than by the formula; check says so."""
    scene = scene_of(Spring(2.0, diameter, coils, 4.0 * coils), force=-1e-3, held=held)
    scene = scene.without_contact()
    path = wirefe.solve(scene, steps=1, element="curved", elements_per_turn=16)
    wire = held_wire(scene)
    assert wire.stress * sizes(scene).stress == pytest.approx(path.max_stress[-1], rel=5e-3)
    assert f"has {wire.stress:.3f} times the stress of the formula" in " ".join(report(scene)[0])


def test_the_stress_between_rigid_ends_is_what_the_limits_say():
    """Of guided cylinders, as the page has it; other indices change it by less than 1 %."""
    page = " ".join((Path(__file__).parents[1] / "docs/limits.md").read_text(encoding="utf-8").split())
    said = r"With index (\d+) and a pitch angle of (\d+) degrees it is (.+?coils), and (.+?coils)"
    cases = re.findall(said, page)
    assert len(cases) == 2
    for index, angle, *lists in cases:
        for one in lists:
            more, coils = ([*map(float, re.findall(r"[\d.]+", part))] for part in one.split("% more at"))
            found = [excess(float(index), float(angle), count) for count in coils]
            assert [round(each) for each in found] == more
            for other in (6.0, 15.0):
                changed = [excess(other, float(angle), count) for count in coils]
                np.testing.assert_allclose(changed, found, rtol=0.0, atol=1.0)


def excess(index, angle, coils):
    """By how much the stress in the wire of a guided cylinder exceeds the formula's, %."""
    pitch = 2.0 * np.pi * index * np.tan(np.radians(angle))
    return 100.0 * (held_wire(scene_of(Spring(2.0, 2.0 * index, coils, coils * pitch))).stress - 1.0)


def test_what_plates_do_to_the_stress_is_not_told():
    spring = Spring(2.0, 18.0, 4.5, 18.0, ends="closed")
    assert "times the stress of the formula" in " ".join(report(scene_of(spring))[0])
    assert "times the stress of the formula" not in " ".join(
        report(replace(scene_of(spring), supports=Supports(seat="plate")))[0]
    )


@pytest.mark.parametrize("number", [np.float64(-1.5), np.float32(-1.5), np.array([-1.5]), np.int64(-2)])
def test_a_displacement_may_be_a_number_of_numpy(number):
    assert Load(displacement=number) == Load(displacement=(float(np.squeeze(number)),))
