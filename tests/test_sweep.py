"""Sweeps: order kept, every spring accounted for, and nothing asked of the script that starts one."""

import os
import re
import signal
import subprocess
import sys
from dataclasses import replace
from functools import partial
from itertools import islice, repeat
from pathlib import Path

import numpy as np
import pytest

import equivbeam
import wirefe
from coilspring import InputError, load_scene, spring_a, spring_b
from coilspring.scene import Contact
from coilspring.sweep import outcomes
from coilspring.workers import processes
from equivbeam.solve import KERNELS as BEAM_KERNELS
from wirefe.solve import KERNELS, SEATED

MODELS = [
    pytest.param(equivbeam, {"steps": 1}, 130, id="equivbeam"),
    pytest.param(wirefe, {"steps": 1, "element": "curved", "elements_per_turn": 4}, 30, id="wirefe"),
]


def scenes(model, count):
    a, b = spring_a(), spring_b()
    yield a
    yield replace(a, spring=replace(a.spring, active_coils=14.3))  # not a multiple of half a coil
    if model is equivbeam:
        yield replace(b, contact=Contact(stiffness=200.0))  # telescopes at a limit point
    else:
        yield replace(b, contact=Contact(geometry="spheres"))  # spheres slide off each other
    yield from (replace(a, spring=replace(a.spring, mean_diameter=d)) for d in np.linspace(8.0, 11.0, count))


@pytest.mark.parametrize(("model", "options", "count"), MODELS)
def test_order_and_outcomes(model, options, count):
    seen = []
    found = list(model.sweep(scenes(model, count), workers=2, progress=seen.append, **options))
    assert [outcome.outcome for outcome in found[:3]] == ["completed", "refused", "limit_point"]
    assert "active_coils" in found[1].message
    assert 0.6 < found[2].critical_time < 1.0
    assert len(found) == count + 3
    assert seen[-1] == count + 3
    assert seen == sorted(seen)
    springs = list(scenes(model, count))
    for scene, outcome in [*zip(springs, found, strict=True)][:: count // 3]:
        assert outcome.outcome == "completed"
        path = model.solve(scene, **options)
        np.testing.assert_array_equal(path.tips[-1], outcome.tip)
        assert outcome.load == scene.load.force
        assert outcome.active_contacts == path.active_contacts[-1] > 0
        assert outcome.max_penetration == path.max_penetration[-1] > 0.0
        assert outcome.max_contact_force == path.contact_forces[-1].max() > 0.0
        assert outcome.rate == path.rates[-1] > 0.0
        assert outcome.max_stress == (None if path.max_stress is None else path.max_stress.max())


def test_each_scene_has_a_solver_of_its_own_and_a_crash_costs_no_other():
    def crash(scene):
        raise ZeroDivisionError("of one\nspring")

    a = spring_a()
    solvers = [partial(equivbeam.solve, steps=1), crash, partial(equivbeam.solve, steps=2, law="helix")]
    found = list(outcomes(zip([a, a, a], solvers, strict=True), chunk=2, workers=1))
    assert [each.outcome for each in found] == ["completed", "crashed", "completed"]
    assert found[1].message == "ZeroDivisionError: of one spring"
    np.testing.assert_array_equal(found[0].tip, equivbeam.solve(a, steps=1).tips[-1])
    np.testing.assert_array_equal(found[2].tip, equivbeam.solve(a, steps=2, law="helix").tips[-1])


def test_kernels_are_stored_before_a_worker_needs_them(monkeypatch):
    """Plates have two of their own, which each worker would compile."""
    kernels = []
    monkeypatch.setattr("coilspring.sweep.store", kernels.append)
    springs = [spring_a(), load_scene("examples/plates.toml"), "of no scene"]
    found = wirefe.sweep(springs, workers=1, steps=1, elements_per_turn=8)
    assert [each.outcome for each in found] == ["completed", "completed", "refused"]
    assert kernels == [KERNELS, SEATED]


def test_an_option_that_the_model_does_not_have_is_refused_at_once():
    with pytest.raises(TypeError, match="law"):
        wirefe.sweep([spring_b()], law="helix")


@pytest.mark.parametrize(
    ("model", "option", "words"),
    [
        (equivbeam, {"law": "zzz"}, "law must be one of haringx, helix"),
        (equivbeam, {"tangent": "paper", "law": "helix"}, "tangent must be exact with law helix"),
        (
            equivbeam,
            {"factors": (2.0, 1.0, 1.0), "law": "helix"},
            "factors must be 1 unless the law is haringx",
        ),
        (equivbeam, {"factors": (0.0, 1.0, 1.0)}, "factors.axial must be"),
        (equivbeam, {"steps": 0}, "load.steps must be an integer"),
        (equivbeam, {"penalty": -1}, "contact.stiffness must be"),
        (wirefe, {"steps": "2"}, "load.steps must be an integer"),
        (wirefe, {"geometry": "cubes"}, "contact.geometry must be one of"),
        (wirefe, {"element": "foo"}, "element must be one of straight, curved"),
        (wirefe, {"elements_per_turn": -1}, "elements_per_turn must be an integer in [4, "),
        (wirefe, {"pairs_per_turn": 0}, "pairs_per_turn must be an integer in [1, "),
        (wirefe, {"pairs_per_turn": 1, "geometry": "wires"}, "pairs_per_turn must be an integer in [2, "),
        (wirefe, {"workers": -1}, "workers must be"),
    ],
)
def test_an_option_that_is_bad_for_any_scene_is_refused_before_one_is_drawn(model, option, words):
    drawn = []
    springs = (drawn.append(None) or scene for scene in repeat(spring_a()))
    with pytest.raises(InputError, match=re.escape(words)):
        model.sweep(springs, **option)
    assert drawn == []


def test_an_option_that_is_bad_for_some_scenes_refuses_those():
    a = spring_a()
    third = replace(a, spring=replace(a.spring, active_coils=14.0 + 1.0 / 3.0))
    found = list(wirefe.sweep([third, a], workers=0, steps=1, element="curved", elements_per_turn=4))
    assert [each.outcome for each in found] == ["refused", "completed"]
    assert "active_coils" in found[0].message


def test_a_users_law_is_stored_before_a_worker_needs_it(monkeypatch):
    """Each worker would compile it."""
    kernels = []
    monkeypatch.setattr("coilspring.sweep.store", kernels.append)
    springs, law = [spring_a(), spring_b(), "of no scene"], Path("examples/law_paper.py")
    found = equivbeam.sweep(springs, workers=1, steps=1, law=law)
    assert [each.outcome for each in found] == ["completed", "completed", "refused"]
    first, second = kernels
    assert first == second
    assert first.assemble is not BEAM_KERNELS.assemble
    path = equivbeam.solve(spring_a(), steps=1, law=law)
    assert first.assemble is path.shape.assemble


def test_scenes_are_drawn_as_they_are_needed():
    drawn = []
    endless = (drawn.append(None) or scene for scene in repeat(spring_a()))
    found = equivbeam.sweep(endless, workers=1, steps=1)
    assert drawn == []
    assert next(found).outcome == "completed"
    assert len(drawn) < 1000
    found.close()


@pytest.mark.parametrize(("count", "started"), [(0, []), (1, [1]), (65, [2])])
def test_no_worker_is_started_that_has_nothing_to_do(count, started, monkeypatch):
    """As many were started as were asked for, up to a thousand."""
    counts = []
    monkeypatch.setattr("coilspring.sweep.processes", lambda n: counts.append(n) or processes(n))
    found = list(equivbeam.sweep(repeat(spring_a(), count), workers=4, steps=1))
    assert [each.outcome for each in found] == ["completed"] * count
    assert counts == started


def test_sweeps_side_by_side():
    one, two = (equivbeam.sweep(repeat(spring_a()), workers=1, steps=steps) for steps in (1, 2))
    for a, b in islice(zip(one, two, strict=True), 70):
        np.testing.assert_allclose(a.tip, b.tip, rtol=1e-4)
    one.close()
    assert next(two).outcome == "completed"
    two.close()


@pytest.mark.parametrize("scenes", ["spring-a", spring_a(), None], ids=["name", "scene", "nothing"])
def test_what_are_no_scenes_is_refused(scenes):
    with pytest.raises(InputError, match="scenes must be an iterable of "):
        equivbeam.sweep(scenes)


def test_what_is_no_scene_among_scenes_is_refused_there():
    found = list(equivbeam.sweep([spring_a(), "spring-a"], workers=1, steps=1))
    assert [each.outcome for each in found] == ["completed", "refused"]
    assert "scene must be a coilspring.Scene, got 'spring-a'" in found[1].message


SCRIPT = """
import sys
from itertools import repeat
import equivbeam
from coilspring import spring_a
assert "loky" not in sys.modules
for found in equivbeam.sweep(repeat(spring_a(), COUNT), workers=2, steps=1):
    print(found.outcome, flush=True)
"""


@pytest.mark.parametrize("source", ["file", "standard input"])
def test_a_script_needs_no_guard(source, tmp_path):
    text = SCRIPT.replace("COUNT", "3")
    file = tmp_path / "script.py"
    file.write_text(text)
    call = {"input": text} if source == "standard input" else {}
    done = subprocess.run(
        [sys.executable, "-" if call else file], **call, capture_output=True, text=True, check=False
    )
    assert (done.stdout, done.stderr) == ("completed\n" * 3, "")


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="a system without masks of signals")
def test_workers_begin_with_interrupts_blocked():
    """Before they can ignore them: Ctrl-C ended those that still started, each with a traceback."""
    with processes(2) as pool:
        assert signal.SIGINT in pool.submit(signal.pthread_sigmask, signal.SIG_BLOCK, []).result()
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])


def test_an_interrupt_ends_a_sweep_at_once_and_quietly():
    """Of the whole group, as Ctrl-C on a terminal is: one traceback, of the script."""
    code = SCRIPT.replace("COUNT", "10**9")
    run = subprocess.Popen(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert run.stdout.readline() == "completed\n"
    os.killpg(run.pid, signal.SIGINT)
    _, said = run.communicate(timeout=30)
    assert run.returncode == -signal.SIGINT
    assert said.count("Traceback") == 1
    assert said.endswith("KeyboardInterrupt\n")


@pytest.mark.parametrize("workers", [-1, 1.5, "2"])
def test_bad_numbers_of_workers(workers):
    with pytest.raises(InputError, match=r"workers must be an integer in \[0, 1000\]"):
        list(equivbeam.sweep([spring_a()], workers=workers))
