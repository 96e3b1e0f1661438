"""The compiled code that runs is that of the sources as they are: no edit is answered by an old kernel."""

import json
import os
import pickle
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from coilspring.compiling import kernelcache
from coilspring.compiling.compiled import kernel, part
from coilspring.compiling.kernelcache import content_digest
from coilspring.contact import kinematics as pairvectors
from equivbeam import kernels as beam
from equivbeam.laws import haringx
from wirefe import kernels as wire

ROOT = Path(__file__).parents[1]
PACKAGES = ("coilspring", "equivbeam", "wirefe", "validation")
SCENE = """
[spring]
wire_diameter = 2.0
mean_diameter = 20.0
active_coils = 2.0
active_height = 16.0
[load]
force = [0.0, -1.0]
steps = 1
[supports]
top_held = ["ux", "rotz"]
[contact]
enabled = false
"""
SCRIPT = """
import json, coilspring, equivbeam, wirefe

if __name__ == "__main__":
    scene = coilspring.load_scene("scene.toml")
    print(json.dumps([MODEL.solve(scene).tips[-1, 1], next(MODEL.sweep([scene], workers=1)).tip[1]]))
"""
EDITS = {
    "equivbeam": [("equivbeam/laws/haringx.py", "= rows[i, KAX], rows", "= 2.0 * rows[i, KAX], rows")],
    "wirefe": [
        ("wirefe/element/beam.py", "e0[n]), K[n], Q", "e0[n]), 2.0 * K[n], Q"),
        ("wirefe/element/beam.py", "stiffness(K[n], Q", "stiffness(2.0 * K[n], Q"),
    ],
}


@pytest.fixture
def checkout(tmp_path):
    """A copy of the packages, beside a scene."""
    for package in PACKAGES:
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "scene.toml").write_text(SCENE)
    return tmp_path


def tips(checkout, model):
    """Tips by Python, by a worker process and by the command line."""
    environment = os.environ | {"PYTHONPATH": str(checkout)}
    run = {"capture_output": True, "text": True, "check": True, "cwd": checkout, "env": environment}
    (checkout / "script.py").write_text(SCRIPT.replace("MODEL", model))
    found = json.loads(subprocess.run([sys.executable, "script.py"], **run).stdout)
    command = f"-c|from validation.cli import main; main()|solve|scene.toml|--model|{model}|--out|out"
    subprocess.run([sys.executable, *command.split("|")], **run)
    return np.array([*found, float((checkout / "out/path.csv").read_text().splitlines()[1].split(",")[4])])


def edit(file, old, new):
    """Edit a file; its time may not tell."""
    text = file.read_text()
    assert old in text
    before = file.stat().st_mtime
    file.write_text(text.replace(old, new))
    os.utime(file, (before - 10.0, before - 10.0))


@pytest.mark.parametrize("model", ["equivbeam", pytest.param("wirefe", marks=pytest.mark.slow)])
def test_an_edited_law_is_the_one_that_runs(model, checkout):
    """Called functions in other files than the kernels'; from Python, a worker and the command line."""
    before = tips(checkout, model)
    np.testing.assert_allclose(before, before[0], rtol=1e-12)
    for file, old, new in EDITS[model]:
        edit(checkout / file, old, new)
    np.testing.assert_allclose(tips(checkout, model), 0.5 * before, rtol=1e-3)  # a little nonlinear


def test_the_digest_knows_all_that_a_kernel_reads(monkeypatch):
    kernels = (beam.assemble, beam.displacement_bound, wire.assemble, wire.displacement_bound)
    before = [content_digest(each) for each in kernels]
    assert len(set(before)) == len(kernels)
    assert [content_digest(each) for each in kernels] == before
    with monkeypatch.context() as patch:
        patch.setattr(pairvectors, "TOUCH", 0.1)  # a number in a module that kernels import
        changed = [content_digest(each) != was for each, was in zip(kernels, before, strict=True)]
    assert changed == [False, True, False, True]
    with monkeypatch.context() as patch:
        patch.setattr(haringx, "KAX", 1)
        changed = [content_digest(each) != was for each, was in zip(kernels, before, strict=True)]
    assert changed == [True, False, False, False]
    monkeypatch.setattr(kernelcache.numba, "__version__", "0")
    assert not {content_digest(each) for each in kernels} & set(before)


def test_options_and_defaults_of_called_functions_count():
    def called(x, factor=2.0):
        return factor * x

    def caller(x):
        return called(x)

    digests = {content_digest(kernel(caller))}
    called = part(called)
    digests.add(content_digest(kernel(caller)))
    called.__defaults__ = (3.0,)
    digests.add(content_digest(kernel(caller)))
    assert len(digests) == 3


def test_what_cannot_be_told_is_refused():
    secret = object()

    def reads():
        return secret

    with pytest.raises(TypeError, match="whose content is unknown"):
        content_digest(reads)


def test_entries_that_nobody_uses_go(tmp_path, monkeypatch):
    names = [f"module.function-{digit * 32}.py311" for digit in "abc"]
    for name, days in zip(names, (0, 10, 40), strict=True):
        for end in (".nbi", ".1.nbc"):
            (tmp_path / (name + end)).write_text("")
            os.utime(tmp_path / (name + end), (time.time() - days * 86_400,) * 2)
    kernelcache.trim(tmp_path)
    assert {file.name[:49] for file in tmp_path.iterdir()} == {name[:49] for name in names[:2]}
    monkeypatch.setattr(kernelcache, "MOST_ENTRIES", 1)
    kernelcache.trim(tmp_path)
    assert {file.name[:49] for file in tmp_path.iterdir()} == {names[0][:49]}


def test_an_entry_whose_types_are_in_another_module_now_is_compiled_anew(tmp_path, monkeypatch):
    """It ended the command with a traceback."""
    monkeypatch.setattr(kernelcache, "folder", lambda: tmp_path)

    def doubled(x):
        return 2.0 * x

    stored = kernel(doubled)
    assert stored(1.0) == 2.0
    with stored._cache.index.open("rb") as file:
        version = pickle.load(file)
    stored._cache.index.write_bytes(pickle.dumps(version) + b"ccoilspring.solver.system\n_Elsewhere\n.")
    renewed, read = kernel(doubled), kernel(doubled)
    assert renewed(1.0) == read(1.0) == 2.0
    assert not renewed.stats.cache_hits
    assert read.stats.cache_hits


def test_where_no_home_can_be_written_kernels_are_kept_elsewhere(tmp_path):
    code = "from coilspring.compiling.kernelcache import folder; print(folder())"
    environment = os.environ | {
        "XDG_CACHE_HOME": "/proc/none",
        "TMPDIR": str(tmp_path),
        "NUMBA_CACHE_DIR": "",
    }
    run = {"capture_output": True, "text": True, "check": True, "cwd": ROOT, "env": environment}
    found = Path(subprocess.run([sys.executable, "-c", code], **run).stdout.strip())
    assert found.parent == tmp_path
    assert found.stat().st_mode & 0o077 == 0


HANDS_ON = """
from coilspring.compiling.compiled import kernel

@kernel
def f(a, n):
    total = 0.0
    for i in range(n):
        good = a[i] > 0.0 and a[i] < 1.0
        total += min(a[i], 1.0) * (a[i] if good and i > 1 else -1.0)
        total += a[i] + max(total, a[i] if good or i < 3 else 2.0)
    return total

f.compile("float64(float64[::1], int64)")
"""


def test_kernels_are_the_same_code_in_each_process(tmp_path):
    """Names are hashed anew in each process; numba's own order of what blocks hand on changes with it."""
    file = tmp_path / "hands_on.py"
    file.write_text(HANDS_ON)
    found = set()
    for seed in range(4):
        settings = {
            "PYTHONHASHSEED": str(seed),
            "NUMBA_DUMP_LLVM": "1",
            "NUMBA_CACHE_DIR": str(tmp_path / str(seed)),
        }
        run = subprocess.run(
            [sys.executable, str(file)], env=os.environ | settings, capture_output=True, text=True, check=True
        )
        handed = [line for line in run.stdout.splitlines() if "$phi" in line]
        assert len(handed) > 20
        found.add("\n".join(handed))
    assert len(found) == 1
