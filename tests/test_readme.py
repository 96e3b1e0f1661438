"""Code of the README, the pages and the examples runs as printed; the site builds."""

import importlib.util
import re
import shlex
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import coilspring
import equivbeam
import wirefe
from coilspring.curves import compare_paths
from coilspring.scene.toml import scene_from_text
from validation.cli import main
from validation.cli.command import COMMANDS
from validation.study.template import significant
from validation.verification.randompage import classified, errors

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
RUN_BY_CI = ("main", "tests")  # marks of the README's commands, which set up an environment each


def blocks(text, language):
    """Mark and code of each block of a page."""
    found = re.findall(rf"(?:<!-- (\w+) -->\n)?```{language}\n(.*?)```", text, re.DOTALL)
    return [(mark, code) for mark, code in found]


def pages_with(language):
    found = [page for page in PAGES if blocks(page.read_text(encoding="utf-8"), language)]
    return pytest.mark.parametrize("page", found, ids=lambda page: page.stem)


def test_every_block_is_of_a_kind_that_is_tried():
    """Code in another language, or in none, would be run by nobody."""
    for page in PAGES:
        kinds = re.findall(r"^```(\w*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
        assert set(kinds[::2]) <= {"python", "bash", "toml", "text"}, page.name


@pages_with("python")
def test_python_blocks(page, capsys):
    for _, code in blocks(page.read_text(encoding="utf-8"), "python"):
        exec(compile(code, page.name, "exec"), {"__name__": "__main__"})
    if page.name == "README.md":
        assert "-19.904" in capsys.readouterr().out


@pages_with("toml")
def test_scene_files(page):
    for _, code in blocks(page.read_text(encoding="utf-8"), "toml"):
        scene_from_text(code)


@pages_with("bash")
def test_commands(page, tmp_path, monkeypatch, capsys):
    """In the page's order, in one folder; the file that a page shows takes the place of an edited one.

    A block of text is what the last command printed.
    """
    monkeypatch.chdir(tmp_path)
    text = page.read_text(encoding="utf-8")
    if "Save this as `my_law.py`" in text:
        Path("my_law.py").write_text(blocks(text, "python")[0][1], encoding="utf-8")
    for mark, code in blocks(text, "bash"):
        if mark in RUN_BY_CI or mark == "installs":
            assert mark != "installs" or code.strip() in README
            continue
        for line in code.splitlines():
            run_line(line, capsys)
            for _, scene in blocks(text, "toml") if "new" in line else ():
                Path("my.toml").write_text(scene, encoding="utf-8")
    for _, shown in blocks(text, "text"):
        assert without_seconds(shown) == without_seconds(capsys.readouterr().out)


def without_seconds(text):
    return re.sub(r"[\d.e-]+ s\b", "... s", text)


MODELS = {  # of the README's table: the runs of a model, and the law's columns of the random springs
    "wirefe --element curved --elements-per-turn 4": ("model == 'wirefe' and elements_per_turn == 4", None),
    "wirefe": ("series == 'straight' and elements_per_turn == 40", None),
    "equivbeam --law helix": ("series == 'helix' and sliding == scene_sliding", "helix_vector"),
    "equivbeam": ("series == 'haringx' and sliding == 'ignore' and tangent == 'exact'", "haringx_vector"),
}


def test_the_table_of_models_says_what_is_recorded():
    runs = pd.read_csv(ROOT / "reports/workprecision/workprecision.csv")
    runs = runs.query("steps == 50 and role == 'run'")
    runs = runs.assign(scene_sliding=np.where(runs["scene"] == "spring-b", "scene", "ignore"))
    springs = pd.read_csv(ROOT / "reports/errorbudget/randomsprings.csv")
    classes = [springs[~springs["contact"]], springs[springs["contact"] & (springs["closed"] > 3)]]
    for model, (chosen, law) in MODELS.items():
        found = runs.query(chosen)
        assert len(found) == 6, model
        random = [f"{c[law].median():.2g} ({c[law].quantile(0.95):.2g})" if law else "" for c in classes]
        cells = [f"`{model}`", span(100 * found["curve_max"]), *random, span(1000 * found["seconds"])]
        row = "| " + " | ".join(cells).replace("|  |  |", "| | |") + " |"
        assert row in README, f"the README's table lacks {row}"
    beams = pd.concat(runs.query(MODELS[model][0]) for model in MODELS if model.startswith("equivbeam"))
    counts = " ".join(README.split())
    assert f"A load curve of 50 steps takes {span(1000 * beams['seconds'])} ms (six springs" in counts
    assert f"{len(classes[0])} springs have no contact." in counts
    touching = int(springs["contact"].sum())
    assert f"Of {touching} with contact, {len(classes[1])} close more than three pairs and are in" in counts
    worst = errors(classified(springs), "helix_worst", 2, 3, kind="^(?!guided, )")
    median, high = significant(worst.median()), significant(worst.quantile(0.95))
    assert f"worst component is off by {median} % in the median and {high} % at the 95th percentile" in counts
    assert "error, random springs with more than 3 closed pairs (%)" in counts


def test_elements_for_forces_of_pairs():
    """The numbers of the page on contact."""
    page = (ROOT / "docs/contact.md").read_text(encoding="utf-8")
    sentence = r"With (\d+) elements per turn the largest force of a pair deviates by up to (\S+) % "
    sentence += r"for wires and (\S+) %"
    found = {elements: rest for elements, *rest in re.findall(sentence, page)}
    (few, spheres), (more, _) = found["4"], found["16"]
    said = f"with 4 curved elements per turn the largest is off by up to {few} %, with 16 by {more} %"
    assert said in " ".join(README.split())
    assert float(spheres) < 0.01


def test_what_a_straight_wire_leaves_out():
    """The numbers of the page on the wire as a solid."""
    page = (ROOT / "reports/solid/solid.md").read_text(encoding="utf-8")
    cells = re.search(r"\| wire model, beam \|(.*)\|", page)[1].split("|")
    off = span(np.array([float(cell.split()[0]) for cell in cells]))
    assert f"by 3D elasticity the wire model is then off by {off} % on the four cases" in " ".join(
        README.split()
    )


def span(values):
    """Least and largest, two digits."""
    return " to ".join(f"{float(f'{end:.2g}'):g}" for end in (values.min(), values.max()))


def test_links_of_the_readme():
    for link in re.findall(r"\]\((?!http)([^)#]+)", README):
        assert (ROOT / link).exists(), link


FILES = r"`((?:coilspring|equivbeam|wirefe|validation|tests|examples)/[\w/]+\.(?:py|toml))"


def test_files_that_pages_name():
    """Pages name files of the repository by their path."""
    for page in PAGES:
        for name in re.findall(FILES, page.read_text(encoding="utf-8")):
            assert (ROOT / name).exists(), f"{page.name} names {name}"


def test_every_command_is_in_the_table():
    table = (ROOT / "docs/api/validation.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"^\| `([\w-]+)", table, re.MULTILINE)) == sorted(COMMANDS)


def run_line(line, capsys):
    """One line of a shell: the command with its arguments, its output to a file where it says so."""
    words = shlex.split(line, comments=True)
    words, file = (words[:-2], words[-1]) if ">" in words else (words, None)
    assert Path(words[0]).name == "coilcheck"
    capsys.readouterr()
    assert main(words[1:]) == 0, line
    if file:
        Path(file).write_text(capsys.readouterr().out, encoding="utf-8")


@pytest.mark.parametrize("file", sorted((ROOT / "examples").glob("*.toml")), ids=lambda file: file.stem)
def test_example_scenes(file):
    scene = coilspring.load_scene(file)
    wire = wirefe.solve(scene)
    assert wire.active_contacts.max() > 0
    if scene.supports.seat == "rigid":  # the equivalent beam has no plates
        assert compare_paths(equivbeam.solve(scene), wire).curve_max < 0.03


def example(name):
    """A script of the examples, as a module."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "examples" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def own_spring(found):
    assert found.steps == 20
    assert 0.001 < found.curve_max < 0.02


def many_springs(found):
    assert set(found) == {"completed", "limit_point"}
    assert found == Counter(completed=108, limit_point=92)


def past_a_limit_point(found):
    turn, traced = found
    assert traced.times.max() == pytest.approx(turn, abs=2e-3)
    top, unstable = traced.times.argmax(), traced.negative_pivots > 0
    assert not unstable[:top].any()
    assert traced.times[-1] < turn - 0.01  # it went on, back,
    assert unstable[top:].sum() > 10  # through equilibria that no spring keeps,
    assert not unstable[-1]  # to those where it catches itself


@pytest.mark.parametrize("check", [own_spring, many_springs, past_a_limit_point])
def test_example_scripts(check):
    check(example(check.__name__).main())


def test_every_example_script_is_run():
    scripts = {file.stem for file in (ROOT / "examples").glob("*.py") if not file.stem.startswith("law_")}
    assert scripts == {"own_spring", "many_springs", "past_a_limit_point"}  # laws: see test_userlaw.py


def test_the_site_builds_without_warnings(tmp_path):
    mkdocs = shutil.which("mkdocs", path=str(Path(sys.executable).parent))
    if mkdocs is None:
        pytest.skip("mkdocs is not installed")
    done = subprocess.run(
        [mkdocs, "build", "-f", ".ci/mkdocs.yml", "--strict", "--site-dir", tmp_path / "site"],
        capture_output=True, text=True, cwd=ROOT, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "curve_max" in (tmp_path / "site/api/coilspring/index.html").read_text(encoding="utf-8")
    assert (tmp_path / "site/reports/paper/fig4.png").exists()
