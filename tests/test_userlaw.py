"""Laws that a user wrote: derivatives, agreement with the built-in law, contents, errors."""

from __future__ import annotations

import json
import math
import pickle
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType, SimpleNamespace

import numpy as np
import pandas as pd
import pytest

import equivbeam
from coilspring import EquilibriumNotFound, InputError, Load, load_path, spring_a, spring_b
from coilspring.compiling.kernelcache import folder
from equivbeam import element
from equivbeam.laws import law_of
from equivbeam.laws.haringx import KAX, KFL, KSH, L0, haringx_rows
from validation.cli import main

EXAMPLES = Path(__file__).parents[1] / "examples"
PAPER, RADIAL = EXAMPLES / "law_paper.py", EXAMPLES / "law_radial.py"
HEAD = """import math
import numpy as np


def parameters(coil):
    return 2.0, 3.0, 5.0, coil.length


"""
QUADRATIC = "(p[0] * (l - p[3]) ** 2 + p[1] * v**2 + p[2] * dtheta**2) / 2"

# every operation that has a derivative, in expressions that are smooth at the points below
EXPRESSIONS = [
    "l * v / dtheta - v / 3 + 2 / l - (1 - l) + (-v) + (+dtheta)",
    "l**2 + v**3 + dtheta**0.5 + l**p[0] + 2**v + l**v + l**0 + v**1 + np.power(l, 3) + np.square(v)",
    "math.sqrt(l) * np.exp(v) + math.log(l * dtheta) + np.expm1(v) * np.log1p(l) + math.pow(l, 2)",
    "math.sin(l) * np.cos(v) + math.tan(dtheta) + np.arcsin(v) * math.acos(v / 2) + math.atan(l * v)",
    "math.sinh(l) * np.cosh(v) + np.tanh(dtheta * l) + np.hypot(l, v) + math.hypot(l * v, dtheta)",
    "np.arctan2(v, l) + math.atan2(l * l, -v) + np.arctan2(-l, dtheta) + np.reciprocal(l + v)",
    "abs(v - l) * v + np.maximum(l, v) * dtheta + min(l, v, dtheta) * max(l, 3 * v) + np.sign(v) * l * v",
    "np.where(l > v, l * v, dtheta) + (l * l if dtheta < l else v) * math.pi + float(3) * l * p[2]",
    "float(l - v) ** 2 * dtheta + int(3 * l) * v + round(l, 1) * dtheta + bool(v) * (0.1 < l) * v * (l > v)",
]


def law_file(folder: Path, energy: str, name: str = "law.py") -> Path:
    """A file with the parameters above and an energy."""
    file = folder / name
    file.write_text(HEAD + energy)
    return file


def smooth(folder: Path, expression: str) -> Path:
    """A law that has a minimum at rest, of which an expression is a part that the table below reads."""
    return law_file(folder, f"def energy(l, v, dtheta, p):\n    return {expression}\n")


@pytest.mark.parametrize("expression", EXPRESSIONS)
def test_derivatives(tmp_path, expression):
    law = law_of(smooth(tmp_path, expression))
    p = (2.0, 3.0, 5.0, 1.3)
    points = np.random.default_rng(1).uniform((1.2, 0.2, 0.2), (1.8, 0.8, 0.8), (8, 3))
    rows = np.array([[0.0, 0.0, 0.0, 1.3, *p]])
    found = law.evaluated(rows, np.zeros(8, int), points)
    second = found[:, (4, 5, 6, 5, 7, 9, 6, 9, 8)].reshape(-1, 3, 3)
    for point, row, H in zip(points, found, second, strict=True):
        assert row[0] == pytest.approx(law.energy(*point, p), rel=1e-13, abs=1e-13)
        for axis in range(3):
            h = 1e-5 * np.eye(3)[axis]
            ahead, behind = (law.evaluated(rows, [0], (point + side * h)[None])[0] for side in (1, -1))
            assert row[1 + axis] == pytest.approx((ahead[0] - behind[0]) / 2e-5, rel=1e-6, abs=1e-7)
            assert H[axis] == pytest.approx((ahead[1:4] - behind[1:4]) / 2e-5, rel=1e-6, abs=1e-6)


def test_branches_loops_and_helpers(tmp_path):
    text = """
def half(x, y=3):
    z = x * x
    if y > 1:
        return z / 2, 0
    return z / 2, 1.0


def stiffness(p, k):
    return p[k]


def energy(l, v, dtheta, p):
    "A docstring."
    u: float = 0.0
    if l < p[3]:
        u = l - p[3]
    elif not l == p[3]:
        u += l - p[3]
    a, b = half(u)
    i = 0
    total = stiffness(p, 0) * a + b
    while i < 1:
        i += 1
        for k in range(1, 3):
            if k == 2:
                x = dtheta
            else:
                x = v
            w, _ = half(y=2, x=x)
            total += stiffness(p, k) * w
            continue
    return total
"""
    plain = law_file(tmp_path, f"def energy(l, v, dtheta, p):\n    return {QUADRATIC}\n", "plain.py")
    rows = np.array([[0.0, 0.0, 0.0, 1.3, 2.0, 3.0, 5.0, 1.3]])
    points = np.random.default_rng(2).normal(1.0, 0.5, (8, 3))
    found, expected = (
        law_of(file).evaluated(rows, np.zeros(8, int), points) for file in (law_file(tmp_path, text), plain)
    )
    np.testing.assert_allclose(found, expected, rtol=1e-14, atol=1e-14)


@pytest.mark.parametrize("scene", [spring_a(), spring_b()], ids=lambda scene: scene.name)
def test_paper_law_from_a_file(scene):
    built_in, found = equivbeam.solve(scene), equivbeam.solve(scene, law=PAPER)
    np.testing.assert_allclose(found.tips, built_in.tips, rtol=0.0, atol=1e-10)
    np.testing.assert_array_equal(found.iterations, built_in.iterations)
    rows = law_of(PAPER).rows(scene.spring, scene.material)
    np.testing.assert_allclose(rows[:, :4], haringx_rows(scene.spring, scene.material), rtol=1e-14)


def test_time_beside_the_built_in_law():
    ratios = []
    for _ in range(5):
        built_in, found = (equivbeam.solve(spring_a(), law=law).solve_seconds for law in ("haringx", PAPER))
        ratios.append(found / built_in)
    assert np.median(ratios) < 3.0


def test_radial_law_starts_as_the_papers():
    rows = law_of(RADIAL).rows(spring_b().spring, spring_b().material)
    np.testing.assert_allclose(rows[:, [KAX, KSH, KFL, L0]], law_of(PAPER).rows(
        spring_b().spring, spring_b().material)[:, [KAX, KSH, KFL, L0]], rtol=1e-12)  # fmt: skip

    # the rate of the stiffness is that of cos p / D^3 at constant length of wire
    def stiffness(length, wire):
        D = 2.0 / math.pi * math.sqrt(wire**2 - length**2)
        return 0.5 * math.pi * D / wire / D**3

    coil_length, D = rows[0, L0], 2.0 * float(spring_b().spring.radius(np.array([0.5 * math.pi]))[0])
    wire, h = math.hypot(coil_length, 0.5 * math.pi * D), 1e-5
    ahead, behind = stiffness(coil_length + h, wire), stiffness(coil_length - h, wire)
    rate = (ahead - behind) / (2 * h) / stiffness(coil_length, wire)
    assert rows[0, -1] == pytest.approx(rate, rel=1e-6)


def coupled(l, v, dtheta, p):  # noqa: E741
    x = l - p[3]
    return (
        (p[0] * x**2 + p[1] * v**2 + p[2] * dtheta**2) / 2 + 0.4 * v * dtheta + 0.3 * x * dtheta + 0.2 * x * v
    )


def softer(coil):
    return 0.5 * coil.E / 1e4, 20.0, 400.0, coil.length


def test_coupled_law_of_an_object(check_derivatives):
    """The element's gradient and Hessian where all three variables are coupled."""
    law = law_of(SimpleNamespace(parameters=softer, energy=coupled))
    rows = law.rows(spring_a().spring, spring_a().material)[:1]
    state = np.array([0.1, 0.2, 0.05, 0.2, 1.3, -0.1])

    def energy(step):
        g, K = np.empty(6), np.empty((6, 6))
        c, s, l, v, turn = element.measures(*(state + step))  # noqa: E741
        r = element.Response(*law.evaluated(rows, [0], np.array([[l, v, turn]]))[0].tolist())
        element.gradient(r, c, s, l, v, g)
        element.hessian(r, c, s, l, v, K)
        return r.U, g, K

    check_derivatives(energy, 6, tolerance=1e-8)


def test_two_laws_in_one_process_and_an_edit(tmp_path):
    file = tmp_path / "law.py"
    file.write_text(PAPER.read_text())
    first = equivbeam.solve(spring_a(), steps=2, law=str(file))
    file.write_text(PAPER.read_text().replace("axial * (l", "1.1 * axial * (l"))
    second, other = (equivbeam.solve(spring_a(), steps=2, law=each) for each in (file, PAPER))
    assert abs(second.tips[-1, 1]) < 0.999 * abs(first.tips[-1, 1])
    np.testing.assert_array_equal(other.tips, first.tips)
    assert first.options["law"] == f"law.py@{other.options['law'].partition('@')[2]}" != second.options["law"]


def test_global_of_an_object_is_part_of_its_content():
    space = {"FACTOR": 1.0}
    source = "def energy(l, v, dtheta, p):\n    return FACTOR * 1.0\n"
    exec(compile(source, "<test>", "exec"), space)
    digests = []
    for factor in (1.0, 2.0):
        space["FACTOR"] = factor
        digests.append(law_of(SimpleNamespace(parameters=softer, energy=space["energy"])).digest)
    assert digests[0] != digests[1]


def law_that_reads(held):
    """The paper's law, whose stiffnesses are multiplied by what something holds."""
    space = {}
    exec(compile(PAPER.read_text(), "<test>", "exec"), space)

    def parameters(coil):
        *stiffnesses, length = space["parameters"](coil)
        return *(held["factor"] * stiffness for stiffness in stiffnesses), length

    return SimpleNamespace(parameters=parameters, energy=space["energy"])


def test_laws_that_read_other_values_are_other_laws():
    """Also where compiled code could not read them; and by their content, not by their place in memory."""
    for held in (dict, pd.Series):
        soft, stiff, again = (law_that_reads(held({"factor": factor})) for factor in (1.0, 2.0, 1.0))
        assert law_of(soft) == law_of(again) != law_of(stiff)
        one, two = (equivbeam.solve(spring_a(), steps=1, law=law).tips[-1, 1] for law in (soft, stiff))
        assert abs(two) < 0.9 * abs(one)
    itself = {"factor": 1.0}
    itself["more"] = itself
    with pytest.raises(InputError, match="got a value that holds itself"):
        law_of(law_that_reads(itself))
    with pytest.raises(
        InputError, match=r"parameters must read .* got a mappingproxy, which cannot be pickled"
    ):
        law_of(law_that_reads(MappingProxyType({"factor": 1.0})))


READS = {
    "a class": "class Wire:\n    def factor(self): return {0}\nfactor = lambda: Wire().factor()",
    "an object": "class Wire:\n    def factor(self): return {0}\nw = Wire()\nfactor = lambda: w.factor()",
    "its state": "class Wire: pass\nwire = Wire()\nwire.f = {0}\nfactor = lambda: wire.f",
    "kept results": "from functools import lru_cache\n@lru_cache\ndef factor(): return {0}",
    "a module": "import json\nfactor = lambda: json.loads('{0}')",
}


@pytest.mark.parametrize("source", READS.values(), ids=READS)
def test_laws_that_read_other_code_are_other_laws(source, monkeypatch):
    """As in a notebook, in which a class is defined again under its name; also where what runs is a module of
    Python, as under its profiler."""
    monkeypatch.setitem(sys.modules, "__main__", json)

    def law(factor):
        space = {"__name__": "__main__", "base": law_that_reads({"factor": 1.0}).parameters}
        exec(f"{source.format(factor)}\ndef parameters(coil): return factor(), *base(coil)[1:]", space)
        return law_of(SimpleNamespace(parameters=space["parameters"], energy=coupled))

    assert law(1.5) == law(1.5) != law(2.5)


def test_a_mark_that_an_editor_writes_first_is_no_part_of_a_law(tmp_path):
    file = tmp_path / PAPER.name
    file.write_text(PAPER.read_text(), encoding="utf-8-sig")
    assert law_of(file) == law_of(PAPER)


def test_sweep_and_pickle(tmp_path):
    file = tmp_path / "law.py"
    file.write_text(RADIAL.read_text())
    law = law_of(file)
    outcomes = list(equivbeam.sweep([spring_a(), spring_b()], workers=2, law=file, steps=1))
    for scene, outcome in zip((spring_a(), spring_b()), outcomes, strict=True):
        assert outcome.tip == tuple(equivbeam.solve(scene, law=law, steps=1).tips[-1])
    again = pickle.loads(pickle.dumps(law))
    assert again == law
    assert again is law  # one process has one of each content


@pytest.mark.parametrize("law", ["haringx", "helix", str(PAPER)])
def test_a_path_has_its_rates_in_another_process(tmp_path, law):
    path = equivbeam.solve(spring_a(), law=law, steps=2)
    (tmp_path / "path").write_bytes(pickle.dumps(path))
    code = (
        "import pickle, sys\n"
        "path = pickle.load(open(sys.argv[1], 'rb'))\n"
        "print(repr(path.table['rate'].tolist()))\n"
    )
    command = [sys.executable, "-c", code, str(tmp_path / "path")]
    found = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    assert found == f"{path.table['rate'].tolist()!r}\n"


def test_a_path_by_functions_that_go_nowhere_else_can_be_pickled(tmp_path):
    """Its states do not need them; where the law is not known, rates are differences from row to row."""

    def parameters(coil):
        return 100.0, 20.0, 400.0, coil.length

    def energy(l, v, dtheta, p):  # noqa: E741
        return (p[0] * (l - p[3]) ** 2 + p[1] * v**2 + p[2] * dtheta**2) / 2

    scene = replace(spring_a(), load=Load((0.0, -1.0), steps=2))
    path = equivbeam.solve(scene, law=SimpleNamespace(parameters=parameters, energy=energy))
    assert pickle.loads(pickle.dumps(path)).rates.tolist() == path.rates.tolist()


def test_stored_path(tmp_path):
    path = equivbeam.solve(spring_b(), law=PAPER, steps=2)
    path.save(tmp_path / "path.npz")
    code = (
        "import sys, coilspring, equivbeam\n"
        f"path = coilspring.load_path({str(tmp_path / 'path.npz')!r})\n"
        "assert path.table['uy'].iloc[-1] < -10, path.table\n"
        "try:\n    equivbeam.sensitivities(path, ['E'])\n"
        "except coilspring.InputError as error:\n    assert 'must be loaded first' in str(error), error\n"
        "else:\n    sys.exit('not refused')\n"
        f"equivbeam.solve(path.scene, law={str(PAPER)!r}, steps=1)\n"
        f"path = coilspring.load_path({str(tmp_path / 'path.npz')!r})\n"
        "assert equivbeam.sensitivities(path, ['E']).tips.shape == (2, 1, 3)\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
    same = equivbeam.sensitivities(load_path(tmp_path / "path.npz"), ["E"])
    np.testing.assert_allclose(same.tips, equivbeam.sensitivities(
        equivbeam.solve(spring_b(), steps=2), ["E"]).tips, rtol=1e-6, atol=1e-12)  # fmt: skip


def test_next_process_reads_the_kernel_from_disk(tmp_path):
    """The law's kernels are compiled once for its content."""
    file = tmp_path / "law.py"
    file.write_text(f"# {time.time()}\n{PAPER.read_text()}")
    code = f"import equivbeam, coilspring; equivbeam.solve(coilspring.spring_a(), law={str(file)!r}, steps=1)"
    written = []
    for _ in range(2):
        subprocess.run([sys.executable, "-c", code], check=True)
        entries = folder().glob(f"*{law_of(file).digest[:16]}*.nb[ic]")
        written.append({(entry.name, entry.stat().st_mtime_ns) for entry in entries})
    assert len(written[0]) == 4  # index and code of two kernels
    assert written[0] == written[1]


DEF = "def energy(l, v, dtheta, p):\n    "
ERRORS = {
    "def energy(l, v, dtheta):\n    return 0": "energy must take 4 arguments",
    "x = 1": "must have a function energy",
    "def energy(l, v, dtheta, p) return": "line 9: expected ':'",
    f"{DEF}return math.log(l - p[3] - 1)": "half coil 1 at rest (l = 1.90667 mm",
    f"{DEF}return np.log(l - p[3] - 1)": "half coil 1 is not finite",
    f"{DEF}return Q": "line 10: NameError",
    "raise SystemExit(7)": "line 9: SystemExit: 7",
    f"{DEF}raise SystemExit(7)": "line 10: SystemExit: 7",
    f"{DEF}return 'a'": "must be a number, got 'a'",
    f"{DEF}return {QUADRATIC} + 0.1 * l": "half coil 1 has no minimum at rest",
    f"{DEF}return {QUADRATIC} - 2 * v**2": "stiffness that is not positive at rest",
    f"{DEF}return max(l - p[3], 0.0) ** 2 + v**2 + dtheta**2": "stiffness that is not positive at rest",
    f"{DEF}return {QUADRATIC} + abs(v)": "half coil 1 has a kink at (l = 1.90667",
    f"{DEF}u = {QUADRATIC}\n    if l < 0.8 * p[3]: u += 0.8 * p[3] - l\n    return u": "kink at (l = 1.525",
    f"{DEF}return np.interp(l, [0, 1], [0, 1])": "line 10: np.interp has no derivative",
    f"{DEF}with np.errstate():\n        return l": "line 10: energy cannot be compiled: Unsupported context",
    f"{DEF}return {QUADRATIC} + math.gamma(l)": "line 10: math.gamma has no derivative",
    f"{DEF}while True: pass": "line 10: TimeoutError: it takes more than 5000000 operations",
    f"def f(x):\n    print(x)\n    return x\n{DEF}return {QUADRATIC} + f(0 * l)": "f must not print",
    f"say = print\n{DEF}say(l)\n    return {QUADRATIC}": "energy must not print",
    "def make():\n    def energy(l, v, dtheta, p):\n        return k * l\n    return energy\n    k = 1.0\n"
    "energy = make()": "Cell is empty",
    f"{DEF}return energy(l, v, dtheta, p) if v > 0 else l": "must not call itself",
}


@pytest.mark.parametrize(("text", "message"), ERRORS.items(), ids=ERRORS.values())
def test_errors(tmp_path, capsys, text, message):
    file = law_file(tmp_path, text + "\n")
    with pytest.raises(InputError) as error:
        equivbeam.solve(spring_b(), law=file, steps=1)
    assert str(error.value).startswith("law law.py")
    assert message in str(error.value)
    assert "\n" not in str(error.value)
    code = main(
        ["solve", "spring-b", "--model", "equivbeam", "--law", str(file), "--out", str(tmp_path / "out")]
    )
    assert code == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ("return 1.0, None", "parameters of half coil 1 must be finite numbers"),
        ("return (1.0,) * (1 + coil.index)", "got 1 for half coil 1 and 2 for half coil 2"),
        ("return coil.pitch", "line 2: AttributeError"),
    ],
)
def test_wrong_parameters(tmp_path, parameters, message):
    file = tmp_path / "law.py"
    file.write_text(
        f"def parameters(coil):\n    {parameters}\n\ndef energy(l, v, dtheta, p):\n    return l\n"
    )
    with pytest.raises(InputError, match=r"law law\.py") as error:
        equivbeam.solve(spring_b(), law=file)
    assert message in str(error.value)


def test_solid_wire_is_refused():
    scene = spring_a()
    solid = replace(scene, spring=replace(scene.spring, wire_rigidity="solid"))
    with pytest.raises(InputError, match=r"wire_rigidity must be beam with law law_paper\.py"):
        equivbeam.solve(solid, law=PAPER)


def test_no_law(tmp_path):
    for given in ("love", 3, None, "missing.py", tmp_path):
        with pytest.raises(InputError, match="law must be"):
            equivbeam.solve(spring_a(), law=given)
    scene = tmp_path / "scene.toml"
    scene.write_text("x = 1\n")  # is Python, too
    with pytest.raises(InputError, match=r"law must be a Python file, named \*\.py, got "):
        law_of(scene)
    # by the name of its file, without the digest of its content
    with pytest.raises(InputError, match=r"factors must be 1 unless .* with 'law_paper\.py'$"):
        equivbeam.solve(spring_a(), law=PAPER, factors=(1.0, 1.0, 0.9))
    with pytest.raises(InputError, match=r"tangent must be exact with law law_paper\.py, got 'paper'"):
        equivbeam.solve(spring_a(), law=PAPER, tangent="paper")


def test_energy_that_ends_on_the_way(tmp_path):
    more = "(l - p[3]) ** 4 * (l / p[3] - 0.9) ** 4 * np.log(l / p[3] - 0.9)"
    file = law_file(tmp_path, f"def energy(l, v, dtheta, p):\n    return {QUADRATIC} + {more}\n")
    with pytest.raises(EquilibriumNotFound, match=r"energy of half coil .* is not finite at") as error:
        equivbeam.solve(spring_b().without_contact(), law=file)
    assert error.value.outcome == "not_converged"


@pytest.mark.slow
def test_laws_of_other_processes_are_not_mixed_up(tmp_path):
    """Compiled in a process of its own each, and read from the disk by a third."""
    files = []
    for factor in (2, 3, 4):
        files.append(tmp_path / f"law{factor}.py")
        files[-1].write_text(PAPER.read_text().replace("shear * v**2", f"{factor} * shear * v**2"))
    code = (
        "import sys, equivbeam, coilspring\n"
        "scene = coilspring.spring_a().without_contact()\n"
        "print([equivbeam.solve(scene, law=file, steps=1).tips[-1].tolist() for file in sys.argv[1:]])"
    )

    def run(*laws: Path) -> list:
        command = [sys.executable, "-c", code, *map(str, laws)]
        return eval(subprocess.run(command, check=True, capture_output=True, text=True).stdout)

    alone = [run(file)[0] for file in files]
    assert run(*files) == alone
    assert len({tuple(tip) for tip in alone}) == 3
