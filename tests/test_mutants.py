"""Scene files with anything changed in them give a scene or one sentence: no traceback, no hang."""

import csv
import json
import re
import tempfile
from datetime import timedelta
from pathlib import Path

import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st

from coilspring import CATALOGUE, InputError, load_scene, scene_text
from coilspring.scene.toml import scene_from_text
from validation.cli import main
from validation.study.scenewarnings import warnings
from validation.view.check import report

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.toml"))
TEXTS = [scene_text(make()) for make in CATALOGUE.values()]
TEXTS += [file.read_text(encoding="utf-8") for file in EXAMPLES]
LINES = [line for text in TEXTS for line in text.splitlines() if "=" in line]
KEYS = sorted({line.partition("=")[0].strip(" #") for line in LINES})
HEADERS = (
    *("[spring]", "[[spring.sections]]", "[load]", "[contact]", "[supports]", "[material]"),
    *("[[load]]", "[a.b]", "[]"),
)
DEADLINE = timedelta(seconds=20)  # of one mutant: what takes longer hangs
MANY = settings(
    max_examples=700,
    deadline=DEADLINE,
    derandomize=True,
    database=None,
    suppress_health_check=list(HealthCheck),
)
FEW = settings(MANY, max_examples=150, phases=(Phase.explicit, Phase.generate))

huge = ["1" + "0" * 400, "0x" + "f" * 5000, "9" * 5000, "1e400", "-nan", "0b1", "1_0", "1__0", "+.5"]
numbers = st.one_of(
    st.floats(0.5, 40.0).map(lambda number: f"{number:.2f}"),
    st.integers(-3, 30).map(str),
    st.floats().map(repr),
    st.integers(-(10**30), 10**30).map(str),
    st.sampled_from(huge),
)
texts = st.text(max_size=20).map(lambda text: json.dumps(text, ensure_ascii=False))
odd = ["", "true", "1979-05-27", "07:32:00", "[", "]", "'", '"""', "{ a = 1 }", "#", "=", "\\"]
known = ['"free"', '"none"', '"coulomb"', '["ux"]', "[]", '"open"', '"right"', "0.5", "[10.0, 12.0]"]
values = st.one_of(
    numbers,
    st.sampled_from(known),
    texts,
    st.sampled_from(odd),
    st.lists(numbers, max_size=3).map(lambda items: f"[{', '.join(items)}]"),
    st.lists(st.one_of(texts, numbers), max_size=3).map(lambda items: f"[[{', '.join(items)}], 1]"),
)
keys = st.one_of(
    st.sampled_from(KEYS), st.text(max_size=8), st.sampled_from(["sections", "spring.sections", "a.b.c", ""])
)
ANY = ("scale", "value", "key", "new", "table", "lose", "twice", "move")
MILD = ("scale", "scale", "scale", "value")


@st.composite
def scaled(draw, value):
    """A value with one of its numbers made larger or smaller."""
    places = list(re.finditer(r"-?\d+(\.\d+)?", value.partition("#")[0]))
    if not places:
        return value
    place = draw(st.sampled_from(places))
    number = float(place[0]) * draw(
        st.one_of(st.floats(0.25, 4.0), st.sampled_from([-1.0, 0.0, 0.5, 2.0, 1e6]))
    )
    return f"{value[: place.start()]}{number:.3g}{value[place.end() :]}"


@st.composite
def mutants(draw, kinds=ANY):
    """Bytes of a scene file with one to three changes."""
    lines = draw(st.sampled_from(TEXTS)).splitlines()
    for _ in range(draw(st.integers(1, 3))):
        kind = draw(st.sampled_from(kinds))
        keyed = [place for place, line in enumerate(lines) if "=" in line and line[0] != "#"]
        if kind in ("scale", "value", "key") and keyed:
            place = draw(st.sampled_from(keyed))
            key, _, value = lines[place].partition("=")
            if kind == "key":
                lines[place] = f"{draw(keys)} ={value}"
            else:
                lines[place] = f"{key}= {draw(values if kind == 'value' else scaled(value))}"
            continue
        place = draw(st.integers(0, len(lines)))
        if kind == "new":
            lines.insert(place, f"{draw(keys)} = {draw(values)}")
        elif kind == "table":
            headed = [place for place, line in enumerate(lines) if line.startswith("[")]
            if headed and draw(st.booleans()):
                place = draw(st.sampled_from(headed))
                lines[place] = draw(
                    st.sampled_from([f"[{lines[place]}]", f"{lines[place].strip('[]')} = 3", *HEADERS])
                )
            else:
                lines.insert(place, draw(st.sampled_from(HEADERS)))
        elif lines:
            line = lines[place - 1]
            if kind != "twice":
                del lines[place - 1]
            if kind != "lose":
                lines.insert(draw(st.integers(0, len(lines))), line)
    data = "\n".join(lines).encode("utf-8", "surrogatepass")
    return draw(damaged(data)) if kinds == ANY and draw(st.integers(0, 7)) == 7 else data


def damaged(data):
    """What happens to files on their way."""
    place = st.integers(0, len(data))
    return st.one_of(
        place.map(lambda at: data[:at]),
        st.tuples(place, st.binary(min_size=1, max_size=8)).map(
            lambda cut: data[: cut[0]] + cut[1] + data[cut[0] :]
        ),
        st.sampled_from([data.replace(b"\n", b"\r\n"), b"\xef\xbb\xbf" + data, data + b"\0", data[::-1]]),
        st.sampled_from(["utf-16", "utf-32"]).map(lambda code: data.decode("utf-8", "ignore").encode(code)),
    )


def read(file):
    """The scene of a file, or None and the words that refuse it."""
    try:
        return load_scene(file), ""
    except InputError as error:
        return None, str(error)


def is_a_sentence(text):
    return len(text.splitlines()) == 1 and text.isprintable()


def test_mutants_give_a_scene_or_a_sentence(tmp_path):
    file, found = tmp_path / "mutant.toml", {"scenes": 0, "refusals": 0}

    @MANY
    @given(mutants())
    def check(data):
        file.write_bytes(data)
        scene, words = read(file)
        if scene is None:
            found["refusals"] += 1
            assert words.startswith(f"{file}: ")
            assert is_a_sentence(words)
            assert len(words) < 500 + len(str(file))
            return
        found["scenes"] += 1
        assert scene_from_text(scene_text(scene)) == scene
        lines, warnings = report(scene)
        assert all(is_a_sentence(line) for line in (*lines[1:], *warnings))

    check()
    assert min(found.values()) > 100, found


@pytest.mark.parametrize("options", [("equivbeam", ()), ("wirefe", ("--elements-per-turn", "8"))])
def test_mutants_are_solved_or_refused_and_written_whole(options, capsys):
    codes = {0: 0, 2: 0, 3: 0}
    for scene in ("spring-a", "examples/plates.toml"):  # compiles: the deadline is a solve's
        main(["solve", scene, "--model", options[0], "--steps", "1"])

    @FEW
    @given(mutants(MILD))
    def check(data):
        with tempfile.TemporaryDirectory() as folder:
            file, out = Path(folder, "mutant.toml"), Path(folder, "out")
            file.write_bytes(data)
            scene, _ = read(file)
            assume(scene is None or scene.spring.active_coils + scene.spring.end_turns < 60.0)
            capsys.readouterr()
            code = main(
                ["solve", str(file), "--model", options[0], "--steps", "2", *options[1], "--out", str(out)]
            )
            codes[code] += 1
            said = capsys.readouterr().err.splitlines()
            warned = [line for line in said if line.startswith("coilcheck: warning: ")]
            assert warned == (
                [] if code == 2 else [f"coilcheck: warning: {text}" for text in warnings(scene)]
            )
            assert len(said) - len(warned) == (code != 0)
            files = sorted(each.name for each in out.iterdir()) if out.exists() else []
            assert files == ([] if code == 2 else ["path.csv", "summary.json"])
            if code != 2:
                is_whole(out, scene.with_steps(2).load.rows, code)

    check()
    assert min(codes[0], codes[2]) > 20, codes


def is_whole(out, rows, code):
    """What was written says itself how far it goes."""
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    with open(out / "path.csv", encoding="utf-8", newline="") as lines:
        times = [float(row["time"]) for row in csv.DictReader(lines)]
    assert (summary["outcome"] == "completed") == (code == 0)
    assert len(times) == rows if code == 0 else len(times) < rows
    assert summary["last_time"] == (times[-1] if times else 0.0)
