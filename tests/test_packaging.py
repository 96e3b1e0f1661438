"""Imports point down and stay light; compiled code is read from the cache by the next process."""

import os
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import pytest

from coilspring.solver.interrupt import signals_noted
from coilspring.workers import processes

ROOT = Path(__file__).parents[1]


def run(code, **environment):
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT,
        env={**os.environ, **environment},
    ).stdout  # fmt: skip


@pytest.mark.parametrize("package", ["equivbeam", "wirefe", "coilspring"])
def test_imports_are_light(package):
    heavy = "{'pyvista', 'vtk', 'matplotlib', 'skfem', 'pandas', 'meshio'}"
    assert run(f"import sys, {package}; print(sorted({heavy} & set(sys.modules)))").strip() == "[]"


def test_templates_and_data_are_installed():
    """What stands beside the modules and is read by them is package data."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    patterns = settings["tool"]["setuptools"]["package-data"]["*"]
    packages = [ROOT / name for name in ("coilspring", "equivbeam", "wirefe", "validation")]
    files = [file for package in packages for file in package.rglob("*.*") if "__pycache__" not in file.parts]
    data = [file for file in files if file.suffix != ".py" and file.is_file()]
    assert len(data) > 6
    assert not [file for file in data if not any(file.match(pattern) for pattern in patterns)]


@pytest.mark.parametrize("command", ["lint-imports", "ruff check .", "ruff format --check .", "mypy"])
def test_house_rules(command):
    """Layers of the packages, lint, format and types, as configured in pyproject.toml."""
    name, *arguments = command.split()
    tool = Path(sys.executable).parent / name
    if not tool.exists():
        pytest.skip(f"{name} is not installed")
    done = subprocess.run([tool, *arguments], capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


MISSES = """
import coilspring, equivbeam, wirefe
from coilspring.solver.equilibrium.newton import compiled_equilibrium
scene = coilspring.spring_b()
for model in models:
    model.solve(scene, steps=2)
kernels = compiled_equilibrium(), *[model.kernels.assemble for model in models]
print([sum(kernel.stats.cache_misses.values()) for kernel in kernels])
"""


@pytest.mark.parametrize(
    "models", ["[equivbeam]", pytest.param("[equivbeam, wirefe]", marks=pytest.mark.slow)]
)
def test_second_process_hits_the_cache(models, tmp_path):
    """What misses would be compiled, and written, anew by every process."""
    code, cache = MISSES.replace("models", models), {"NUMBA_CACHE_DIR": str(tmp_path)}
    assert set(eval(run(code, **cache))) == {1}
    written = {file: file.stat().st_mtime_ns for file in tmp_path.rglob("*.nb*")}
    assert any("follow" in file.name for file in written)
    assert set(eval(run(code, **cache))) == {0}
    assert {file: file.stat().st_mtime_ns for file in tmp_path.rglob("*.nb*")} == written


def test_a_campaign_that_is_terminated_leaves_no_workers(tmp_path):
    arguments = ["stability", "--beams", "4000", "--wires", "0", "--workers", "2", "--out", str(tmp_path)]
    command = [sys.executable, "-m", "validation.cli", *arguments]
    with subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, start_new_session=True) as child:
        try:
            rows = tmp_path / "stability.csv"
            assert _within(240.0, lambda: rows.is_file() or child.poll() is not None)
            assert child.poll() is None
            child.terminate()
            _, words = child.communicate(timeout=30)
        finally:
            child.kill()
    assert child.returncode == 130
    assert words.splitlines()[-1].endswith(f" of 4000 rows are in {rows}; the same command goes on".encode())
    assert _within(10.0, lambda: not _group_lives(child.pid))


def test_a_signal_while_workers_start_ends_them(monkeypatch):
    """The thread that minds them cannot be waited for before it runs."""
    from loky import process_executor

    start, pools = process_executor._ExecutorManagerThread.start, []

    def interrupted(thread):
        signal.raise_signal(signal.SIGINT)
        start(thread)

    monkeypatch.setattr(process_executor._ExecutorManagerThread, "start", interrupted)
    with pytest.raises(KeyboardInterrupt), processes(1) as pool:
        pools.append(pool)
    assert not pools  # nothing was begun


def test_a_signal_while_modules_are_imported_for_workers_waits():
    """Amid an import, an exception may be lost."""
    code = """
import signal, sys
from coilspring.workers import processes
class Interrupted:
    def find_spec(name, path, target=None):
        if name == "loky":
            signal.raise_signal(signal.SIGINT)
sys.meta_path.insert(0, Interrupted)
try:
    with processes(1):
        print("not interrupted")
except KeyboardInterrupt:
    print("loky" in sys.modules)
"""
    assert run(code).strip() == "True"


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="a system without masks of signals")
def test_a_signal_while_handlers_are_restored_leaves_none_behind(monkeypatch):
    restore, before = signal.signal, signal.signal(signal.SIGTERM, signal.default_int_handler)

    def interrupted(number, handler):
        restore(number, handler)
        if (number, handler) == (signal.SIGINT, signal.default_int_handler):
            signal.raise_signal(signal.SIGINT)

    try:
        monkeypatch.setattr(signal, "signal", interrupted)
        with pytest.raises(KeyboardInterrupt), signals_noted():
            pass
        assert signal.getsignal(signal.SIGTERM) is signal.default_int_handler
    finally:
        restore(signal.SIGTERM, before)


def _within(seconds, happens):
    """Whether it happens in so much time."""
    end = time.monotonic() + seconds
    while not happens():
        if time.monotonic() >= end:
            return False
        time.sleep(0.1)
    return True


def _group_lives(leader):
    try:
        os.killpg(leader, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.parametrize("model", ["wirefe", "equivbeam"])
def test_interrupted_by_a_signal(model, tmp_path):
    """Ctrl-C amid compiled work: exit code 130 and one line, soon."""
    arguments = ["solve", "spring-a", "--model", model, "--steps", "100000", "--out", str(tmp_path)]
    code = (
        f"import signal, sys, coilspring, {model}\n"
        # a parent may have had its children ignore the signal
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from validation.cli import main\n"
        f"{model}.solve(coilspring.spring_a(), steps=1)\n"  # the kernels are ready from here on
        "print('ready', flush=True)\n"
        f"sys.exit(main({arguments!r}))"
    )
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, "-c", code], cwd=ROOT, **pipes) as child:
        assert child.stdout.readline() == "ready\n"
        time.sleep(1.0)
        child.send_signal(signal.SIGINT)
        _, words = child.communicate(timeout=30)
    assert child.returncode == 130
    assert len(words.strip().splitlines()) == 1
