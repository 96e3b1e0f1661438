"""The wire model in other codes: what they are given, what they answer, and what is said without them."""

import importlib.util
import json
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import wirefe
from coilspring import Contact, InputError, Load, Scene, Spring, load_scene, scene_text, spring_a, spring_b
from validation.cli import main
from validation.peers import calculix, comparison, page, timing
from validation.peers.comparison import PeerComparison
from validation.peers.layout import PeerCurve, layout
from validation.study.partialsolve import EndedEarly
from wirefe.contact.points import contact_points
from wirefe.mesh import mesh_wire

ROOT = Path(__file__).parents[1]
needs_opensees = pytest.mark.skipif(
    importlib.util.find_spec("openseespy") is None, reason="openseespy is not installed"
)
needs_calculix = pytest.mark.skipif(shutil.which("ccx") is None, reason="ccx is not installed")


@pytest.mark.parametrize("scene", [spring_a(), spring_b()], ids=lambda scene: scene.name)
def test_the_peers_get_the_spheres_and_pairs_of_the_wire_model(scene):
    ours = layout(scene, 40)
    mesh = mesh_wire(scene.spring, 40)
    theirs = contact_points(scene, mesh, 40, 4)
    centres = mesh.nodes[theirs.attached] + theirs.parts
    np.testing.assert_allclose(ours.spheres[ours.pairs], centres[theirs.pairs], atol=1e-12)
    np.testing.assert_allclose(ours.points, mesh.points, atol=1e-12)
    assert len(layout(scene.without_contact(), 40).pairs) == 0


def cards(deck):
    """Keyword lines of a deck, each with its data lines."""
    found = []
    for line in deck.splitlines():
        if line.startswith("*"):
            found.append((line, []))
        else:
            found[-1][1].append([word.strip() for word in line.split(",")])
    return found


def test_the_springs_of_the_deck_are_the_penalty():
    """Positions from the deck alone: no force beyond a diameter, K per mm below it."""
    scene = spring_b()
    found = cards(calculix.deck(scene))
    nodes = {
        int(row[0]): np.array(row[1:4], float)
        for key, rows in found
        if key.startswith("*NODE") and "PRINT" not in key
        for row in rows
    }
    ends = [rows[0] for key, rows in found if "SPRINGA" in key]
    tables = [np.array(rows[1:], float) for key, rows in found if key.startswith("*SPRING,")]
    assert len(ends) == len(tables) == len(layout(scene, 40).pairs)
    for (_, first, second), (force, stretch) in zip(ends, (table.T for table in tables), strict=True):
        length = np.linalg.norm(nodes[int(second)] - nodes[int(first)])
        for depth in (0.0, 0.2, 1.0):
            pushed = np.interp(1.5 - depth - length, stretch, force)
            assert pushed == pytest.approx(-1e4 * depth, abs=1e-6)
        assert np.interp(0.0, stretch, force) == pytest.approx(0.0, abs=1e-6)


def test_loads_and_supports_of_the_deck():
    found = dict(cards(calculix.deck(spring_b().with_steps(4))))
    top = str(len(layout(spring_b(), 40).points) + 1)
    assert [row for row in found["*BOUNDARY"] if row[0] == top] == [
        [top, "1", "1"], [top, "3", "5"], [top, "6", "6"],
    ]  # fmt: skip
    assert found["*CLOAD, AMPLITUDE=TOP2"] == [[top, "2", "1."]]
    assert found["*AMPLITUDE, NAME=TOP2"] == [["0", "0"], ["1", "-200"]]
    assert [row[0] for row in found["*TIME POINTS, NAME=ROWS"]] == ["0.25", "0.5", "0.75", "1"]


def test_rotation_is_read_from_the_pointer():
    """A pointer of 15 mm that turns past half a turn."""
    text = ""
    for time, angle in ((0.5, 2.0), (1.0, 4.0)):
        x, y = -15.0 * np.sin(angle), 15.0 * (np.cos(angle) - 1.0)
        text += f" displacements (vx,vy,vz) for set TIP and time  {time:E}\n\n"
        text += f" 7 1.0 -2.0 0.0\n 8 {1.0 + x:.9E} {-2.0 + y:.9E} 0.0\n"
    times, tips, forces = calculix.read(text, 15.0)
    np.testing.assert_array_equal(times, [0.5, 1.0])
    np.testing.assert_allclose(tips, [[1.0, -2.0, 2.0], [1.0, -2.0, 4.0]], atol=1e-8)
    assert forces.size == 0
    assert calculix.read("", 15.0)[1].shape == (0, 3)


def test_export_writes_the_deck_and_says_what_is_left_out(tmp_path, capsys):
    assert main(["export", "spring-b", "--to", "calculix", "--out", str(tmp_path)]) == 0
    assert (tmp_path / "scene.inp").read_text(encoding="ascii") == calculix.deck(load_scene("spring-b"))
    assert "frictionless" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("old", "new", "field"),
    [
        ('sliding = "none"', 'sliding = "coulomb"\nfriction = 0.3', "contact.sliding"),
        ("exponent = 1.0", "exponent = 1.5", "contact.exponent"),
        ("active_coils = 7.5", "active_coils = 7.525", "spring.active_coils"),
    ],
)
def test_what_a_peer_is_not_given_is_refused(old, new, field, tmp_path, capsys):
    main(["new", "spring-b"])
    text = capsys.readouterr().out
    assert old in text
    (tmp_path / "scene.toml").write_text(text.replace(old, new), encoding="utf-8")
    arguments = ["export", str(tmp_path / "scene.toml"), "--to", "calculix", "--out", str(tmp_path)]
    assert main(arguments) == 2
    assert capsys.readouterr().err.startswith(f"coilcheck: {field} must be ")


@pytest.mark.parametrize(
    ("peer", "install"), [("opensees", "pip install"), ("calculix", "apt-get install calculix-ccx")]
)
def test_without_the_peer_one_sentence_says_how_to_install_it(peer, install, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.setitem(sys.modules, "openseespy", None)
    monkeypatch.delitem(sys.modules, "validation.peers.opensees", raising=False)
    assert main(["referee", "spring-a", "--with", peer, "--out", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert install in error
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    ("old", "new", "field"),
    [
        ('geometry = "spheres"', 'geometry = "wires"', "contact.geometry"),
        ("active_coils = 7.5", "active_coils = 7.51", "spring.active_coils"),
    ],
)
@pytest.mark.parametrize("peer", comparison.PEERS)
def test_a_scene_is_refused_before_anyone_installs_the_peer(
    peer, old, new, field, tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.setattr(comparison, "opensees", lambda: None)
    text = scene_text(spring_b())
    assert old in text
    (tmp_path / "scene.toml").write_text(text.replace(old, new), encoding="utf-8")
    assert main(["referee", str(tmp_path / "scene.toml"), "--with", peer, "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err.startswith(f"coilcheck: {field} must be ")


def difference(scene, peer, steps, folder):
    """In a process of its own: OpenSees prints past Python."""
    command = [sys.executable, "-m", "validation.cli", "referee", scene, "--with", peer]
    subprocess.run([*command, "--steps", steps, "--out", folder], check=True, capture_output=True, cwd=ROOT)
    found = json.loads((folder / f"{peer}.json").read_text(encoding="utf-8"))
    assert found["steps"] == int(steps)
    return found["curve_max"]


@needs_opensees
@pytest.mark.parametrize("scene", ["spring-b", "spring-b-no-contact"])
def test_opensees_agrees(scene, tmp_path):
    """Spring B closes its coils without sliding: 0.2 % is the promise, 0.02 % what is found."""
    assert difference(scene, "opensees", "25", tmp_path) < 2e-4


@needs_calculix
def test_calculix_agrees_as_far_as_its_solids_are_beams(tmp_path):
    assert 1e-4 < difference("spring-b-no-contact", "calculix", "2", tmp_path) < 0.02


def test_referee_says_that_a_path_ended_early(tmp_path, monkeypatch, capsys):
    """Frictionless spheres of Spring B slide off each other: exit code 3, and why."""
    curve = PeerCurve("calculix", np.array([0.5]), np.array([[0.0, -10.0, 0.0]]), 1.0)
    monkeypatch.setitem(comparison.PEERS, "calculix", lambda scene: curve)
    arguments = ["referee", "spring-b", "--with", "calculix", "--steps", "2", "--out", str(tmp_path)]
    assert main(arguments) == 3
    said = capsys.readouterr()
    assert "wirefe: limit point" in said.out
    assert "wirefe: limit point" in said.err
    early = json.loads((tmp_path / "calculix.json").read_text(encoding="utf-8"))["ended_early"]
    assert early[0].startswith("wirefe: limit point")
    assert early[1].startswith("calculix ended early, after 1 of 2 steps")


def short(**load):
    """Two and a half coils, contact of spheres, which the loads here do not close; a free top."""
    spring = Spring(wire_diameter=1.5, mean_diameter=10.0, active_coils=2.5, active_height=8.0)
    return Scene("short", spring, Load(**load), contact=Contact(geometry="spheres"))


MACHINE = {"displacement": (-3.0, -1.0), "steps": 2}
STAGES = {"stages": ((-8.0, -60.0), (4.0, -80.0), (0.0, -20.0)), "steps": 2}


def test_stages_and_displacements_of_the_deck():
    found = dict(cards(calculix.deck(short(**STAGES))))
    top = str(len(layout(short(**STAGES), 40).points) + 1)
    thirds = ["0", "0.333333333333", "0.666666666667", "1"]
    for axis, forces in (("1", ["0", "-8", "4", "0"]), ("2", ["0", "-60", "-80", "-20"])):
        points = [[time, force] for time, force in zip(thirds, forces, strict=True)]
        assert found[f"*AMPLITUDE, NAME=TOP{axis}"] == points
        assert found[f"*CLOAD, AMPLITUDE=TOP{axis}"] == [[top, axis, "1."]]
    assert len(found["*TIME POINTS, NAME=ROWS"]) == 6
    found = dict(cards(calculix.deck(short(**MACHINE))))
    assert found["*AMPLITUDE, NAME=TOP2"] == [["0", "0"], ["0.5", "-3"], ["1", "-1"]]
    assert found["*BOUNDARY, AMPLITUDE=TOP2"] == [[top, "2", "2", "1."]]
    assert not [key for key in found if key.startswith("*CLOAD")]


def test_the_force_of_a_prescribed_displacement_is_read():
    text = " displacements (vx,vy,vz) for set TIP and time  0.1E+01\n\n 7 0. -2. 0.\n 8 0. -2. 0.\n"
    text += " forces (fx,fy,fz) for set TOP and time  0.1E+01\n\n 7 0.5 -48. 1.\n"
    times, tips, forces = calculix.read(text, 15.0)
    assert (times.tolist(), tips.tolist(), forces.tolist()) == ([1.0], [[0.0, -2.0, 0.0]], [-48.0])


def alone(peer, **load):
    """A peer beside the wire model, in a process of its own."""
    code = (
        "import sys; sys.path.insert(0, 'tests')\n"
        "import numpy as np; from test_peers import short; from validation.peers.comparison import compare\n"
        f"found = compare(short(**{load!r}), {peer!r})\n"
        "assert found.rows == len(found.wire.times) == found.scene.load.rows\n"
        "print(found.difference, *found.peer.curve.answers.T.ravel())"
    )
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, cwd=ROOT)
    difference, *answers = map(float, run.stdout.split())
    return difference, np.reshape(answers, (3, -1))


@needs_opensees
@pytest.mark.parametrize(
    "load", [MACHINE, pytest.param(STAGES, marks=pytest.mark.slow)], ids=["displacement", "stages"]
)
def test_opensees_agrees_under_a_test_machine_and_in_stages(load):
    """Measured 2e-5 in UX and the force; of ROTZ, 0.0016 rad under a test machine, 2e-3."""
    assert alone("opensees", **load)[0] < 4e-3


@pytest.mark.slow
@needs_calculix
def test_calculix_agrees_under_a_test_machine_and_in_stages():
    """Its solids are 0.9 % softer; what its reaction does as a force is the displacement again."""
    _, (_, force, _) = alone("calculix", **MACHINE)
    ours = wirefe.solve(short(**MACHINE)).loads[:, 1]
    np.testing.assert_allclose(force, ours, rtol=0.012)
    _, (_, uy, _) = alone("calculix", stages=((0.0, force[1]), (0.0, force[3])), steps=2)
    np.testing.assert_allclose(uy[[1, 3]], MACHINE["displacement"], rtol=4e-4)  # of its stop test
    assert alone("calculix", **STAGES)[0] < 0.015


def test_contact_of_wires_is_refused_with_what_takes_its_place():
    scene = short(**MACHINE).overridden(geometry="wires")
    with pytest.raises(InputError, match=r'contact\.geometry must be "spheres" for calculix.*--geometry sph'):
        calculix.deck(scene)
    calculix.deck(scene.without_contact())
    with pytest.raises(InputError, match=r"supports\.seat"):
        calculix.deck(load_scene(ROOT / "examples" / "plates.toml"))


def compared(steps, reached, factor=1.0):
    """Spring B by the wire model, and a peer that answers the same times a factor, as far as it goes."""
    wire = wirefe.solve(spring_b(), steps=steps)
    curve = PeerCurve("opensees", wire.times[:reached], factor * wire.tips[:reached], 2.0)
    return PeerComparison(spring_b().with_steps(steps), wire, curve)


def test_the_difference_goes_as_far_as_both_over_the_peak_of_the_wire_model():
    assert compared(4, 4, 1.001).difference == pytest.approx(1e-3)
    ended = compared(4, 2, 1.001)
    reached = np.abs(ended.wire.tips[:, 1]) / np.abs(ended.wire.tips[:, 1]).max()
    assert reached[1] < 0.8  # as `compare` has it, the peak is that of the wire model's whole path
    assert ended.difference == pytest.approx(1e-3 * reached[1])
    nothing = compared(4, 0)
    assert np.isnan(nothing.difference)
    assert nothing.lines()[-1] == "no step in common"
    assert nothing.lines()[-2] == "opensees ended early, after 0 of 4 steps, and does not say why"
    assert compared(4, 4).early == []
    off = compared(4, 4, np.array([1.0, 1.001, 1.27]))
    assert off.lines()[-1] == "difference over 4 common steps, of each one's peak: uy 0.1 %"  # no other moves
    assert "opensees: no step reached" in nothing.lines()[1]


def test_curves_stand_side_by_side():
    rows = compared(4, 2).csv().decode().splitlines()
    assert rows[0] == "time,ux_wirefe,uy_wirefe,rotz_wirefe,ux_opensees,uy_opensees,rotz_opensees"
    assert len(rows) == 5
    assert rows[2].startswith("0.5,")
    assert rows[3].endswith(",,,")  # a step that the peer has not reached


def test_the_page_has_both_codes_at_the_last_common_step():
    text = page.page("opensees", {"spring-b": compared(4, 2, 1.001)})
    first, second = (line for line in text.splitlines() if "| wirefe |" in line or "| opensees |" in line)
    cells = [cell.strip() for cell in first.strip("|").split("|")]
    assert cells[:5] == ["spring-b", "4", "2", "0.5", "wirefe"]
    assert "| 0.0731 | 2 |" in second  # 0.1 % of 73.1 % of the peak
    assert "steps, opensees" in text
    assert "- spring-b does not reach full load: opensees ended early, after 2 of 4 steps" in text
    assert "full load:" not in page.page("opensees", {"spring-b": compared(4, 4)})


def answering(code, fewest, iterations=1, factor=1.0):
    """A code that needs so many steps, takes a second for each beyond ten or short of it, and answers the
    same tip times a factor; half of it where the steps are too few."""

    def run(steps):
        share = np.arange(1, steps + 1)[:, None] / steps
        tips = share * [-2.0 * factor, -4.0, 0.0] * (1.0 if steps >= fewest else 0.5)
        return PeerCurve(code, share[:, 0], tips, 1.0 + abs(steps - 10), iterations * steps)

    return run


def test_each_code_is_timed_in_the_steps_that_suit_it():
    runs, calls = {"wirefe": answering("wirefe", 3), "opensees": answering("opensees", 15, 2, 1.001)}, []

    def counted(code):
        return lambda steps: calls.append((code, steps)) or runs[code](steps)

    data = timing.timed("spring", {code: counted(code) for code in runs}, range(4)).set_index("kind")
    assert data["wirefe_steps"].to_dict() == {"equal": 50, "fewest": 3, "fastest": 10}
    assert data["opensees_steps"].to_dict() == {"equal": 50, "fewest": 15, "fastest": 15}
    assert data["ratio"].to_dict() == {"equal": 1.0, "fewest": 6.0 / 8.0, "fastest": 6.0}
    assert data["opensees_iterations"].to_dict() == {"equal": 100, "fewest": 30, "fastest": 30}
    np.testing.assert_allclose(data["difference"], 1e-3)
    assert calls.count(("opensees", 15)) == 1 + 4  # timed once in a round, though it is chosen twice
    last = calls[-5:]
    assert calls[-20:] == last * 4
    assert len(set(last)) == 5


def test_a_code_without_the_reference_is_not_timed():
    """Half of a path in 50 steps, if at the same tip; fewer steps that end early are no choice."""

    def half(steps):
        whole = answering("opensees", 1)(steps)
        return replace(whole, times=whole.times[: steps // 2], tips=whole.tips[steps - steps // 2 :])

    with pytest.raises(EndedEarly, match="opensees did not reach full load on spring in 50 steps"):
        timing.timed("spring", {"wirefe": answering("wirefe", 1), "opensees": half}, range(1))
    some = timing.sufficient(lambda steps: (answering("opensees", 1) if steps > 5 else half)(steps), "spring")
    assert list(some) == [6, 8, 10, 15, 20, 30, 50]


@pytest.fixture
def peer(monkeypatch):
    """OpenSees, whose answers are the wire model's, UX and UY a thousandth larger, and take 7 s; its
    arguments."""
    calls = []

    def run(scene, steps, tolerance, halvings):
        calls.append((scene.name, steps, tolerance, halvings))
        path = wirefe.solve(scene, steps=steps)
        return PeerCurve("opensees", path.times, path.tips * peer.factor, 7.0, 9)

    peer = SimpleNamespace(run=run, tolerance=lambda scene: 2e-9, TOLERANCE=1e-10, factor=1.001, calls=calls)
    monkeypatch.setattr(timing, "opensees", lambda: peer)
    monkeypatch.setattr(timing, "versions", lambda name: {name: "3.7"})
    monkeypatch.setattr(timing, "COUNTS", (5, 50))
    monkeypatch.setattr(timing, "ROUNDS", 1)
    return peer


def test_page_and_facts_of_the_times(peer, tmp_path, capsys):
    assert timing.main(tmp_path) == 0
    assert {call[0] for call in peer.calls} == set(timing.SCENES)
    assert {call[2:] for call in peer.calls} == {(2e-9, 0)}
    found = json.loads((tmp_path / "facts.json").read_text())
    recorded = json.loads((ROOT / page.FOLDER / "facts.json").read_text())
    assert found.keys() == recorded.keys()
    for scene in timing.SCENES:
        assert found[f"opensees.{scene}.difference"] == pytest.approx(0.1)
        assert found[f"opensees.{scene}.equal"] > 10.0
    text = (tmp_path / "opensees.md").read_text()
    assert (ROOT / page.FOLDER / "opensees.md").is_file()
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines()]
    times = [line for line in lines if len(line) == 8 and line[1] == "spring-a"]
    assert [line[2] for line in times] == ["equal", "fewest", "fastest"]
    assert times[0][3] == "50 / 50"
    assert times[1][3] == "5 / 5"
    assert times[0][5] == "7000 [7000, 7000]"
    assert times[0][6].endswith("/ 9")
    assert times[0][7] == "0.1000"
    wire, other = (line for line in lines if line[0] == "spring-a" and len(line) == 5)
    assert (wire[1], other[1]) == ("wirefe", "opensees")
    assert float(other[3]) == pytest.approx(1.001 * float(wire[3]), abs=1e-4)
    assert "out of 5, 50 in which each" in text
    assert "within 0.2 % of its own" in text
    assert "below 1e-10 of the full load" in text
    assert "openseespy 3.7." in text
    assert "spring-a, round 1 of 1" in capsys.readouterr().out


def test_other_tips_are_written_and_told_by_the_exit_code(peer, tmp_path, monkeypatch):
    monkeypatch.setattr(timing, "SCENES", ("spring-b-no-contact",))
    peer.factor = 1.003
    assert timing.main(tmp_path) == 1
    assert "0.3000" in (tmp_path / "opensees.md").read_text()


def test_nothing_is_timed_without_opensees(monkeypatch, tmp_path):
    monkeypatch.setattr(timing, "opensees", lambda: None)
    with pytest.raises(InputError, match="pip install"):
        timing.main(tmp_path)
    assert not list(tmp_path.iterdir())
