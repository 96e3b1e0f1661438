"""Stored results: whole entries or none, keys that follow every source, paths as they were solved."""

from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

import equivbeam
import wirefe
from coilspring import Contact, InputError, Material, load_path, load_scene, spring_a, spring_b
from coilspring.contact.law import PAIR_HISTORY
from coilspring.curves import compare_paths
from coilspring.pathfile import write_fields
from validation.study import keys, store
from validation.study.keys import run_key
from validation.study.partialsolve import partial_path
from validation.study.paths import PathStore
from validation.study.store import Store

FILES = {"a.csv": b"1,2\n", "b.bin": bytes(range(256))}


def test_an_entry_is_shared_and_comes_back_as_it_was(tmp_path):
    Store(tmp_path / "new" / "folder").put("key", FILES)
    assert Store(tmp_path / "new" / "folder").get("key") == FILES
    assert Store(tmp_path / "new" / "folder").get("other") is None
    assert [file.name for file in (tmp_path / "new" / "folder").iterdir()] == ["key.coilcheck"]


def damages(data):
    yield b""
    yield data[:20]
    yield data[:-1]
    yield data + b"\0"
    for place in range(0, len(data), 37):
        yield data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :]


def test_a_damaged_entry_counts_as_missing_and_is_replaced(tmp_path):
    kept = Store(tmp_path)
    kept.put("key", FILES)
    file = tmp_path / "key.coilcheck"
    whole = file.read_bytes()
    for damaged in damages(whole):
        file.write_bytes(damaged)
        assert kept.get("key") is None
    kept.put("key", FILES)
    assert file.read_bytes() == whole
    assert kept.get("key") == FILES
    assert kept.trouble == ""


@pytest.mark.parametrize("name", ["../a.csv", "/a.csv", "b/a.csv"])
def test_names_that_lead_elsewhere_are_refused(tmp_path, name):
    kept = Store(tmp_path)
    kept.put("key", {name: b"1"})
    assert kept.get("key") is None


def test_the_least_recently_used_go_first_and_nothing_else(tmp_path):
    foreign = tmp_path / "letter.txt"
    foreign.write_bytes(bytes(5000))
    kept = Store(tmp_path, most=3500)
    clock = 1_000_000
    for name in "abc":
        kept.put(name, {"f": bytes(1000)})
        clock += 1
        store.os.utime(tmp_path / f"{name}.coilcheck", (clock, clock))
    left_over = tmp_path / ".x.coilcheck.1234.part"  # of a writer that was killed
    left_over.write_bytes(b"")
    store.os.utime(left_over, (1, 1))
    assert kept.get("a") is not None
    kept.put("d", {"f": bytes(1000)})
    assert [name for name in "abcd" if kept.get(name) is not None] == ["a", "c", "d"]
    assert not left_over.exists()
    assert foreign.exists()


def test_a_store_that_cannot_be_written_says_so_once_and_is_no_obstacle(tmp_path):
    (tmp_path / "file").write_bytes(b"")
    kept = Store(tmp_path / "file" / "store")
    assert kept.get("key") is None
    assert kept.trouble == ""
    kept.put("key", FILES)
    said = kept.trouble
    assert str(tmp_path / "file" / "store") in said
    assert "\n" not in said
    (tmp_path / "file").unlink()
    kept.put("key", FILES)
    assert kept.trouble == said
    assert not list(tmp_path.iterdir())


def test_a_full_disk_leaves_nothing_partial(tmp_path, monkeypatch):
    def no_space(file, data):
        with file.open("wb") as stream:
            stream.write(data[:10])
        raise OSError(28, "No space left on device")

    kept = Store(tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(Path, "write_bytes", no_space)
        kept.put("key", FILES)
    assert "No space left" in kept.trouble
    assert not list(tmp_path.iterdir())


def test_where_the_store_is(tmp_path, monkeypatch):
    monkeypatch.setattr(store.os, "name", "posix")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "caches"))
    monkeypatch.setenv("COILCHECK_STORE", str(tmp_path / "chosen"))
    assert store.default_folder() == tmp_path / "chosen"
    monkeypatch.delenv("COILCHECK_STORE")
    assert store.default_folder() == tmp_path / "caches" / "coilcheck"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    assert store.default_folder() == tmp_path / ".cache" / "coilcheck"

    def homeless():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", homeless)
    assert store.default_folder() is None
    assert "COILCHECK_STORE" in Store(None).trouble


@pytest.fixture
def edited(tmp_path, monkeypatch):
    """Makes the packages look as if a statement had been added to a source."""
    files = keys.source_files

    def edit(name):
        def seen(package):
            found = files(package)
            return [copy if file.name == name else file for file in found]

        source = next(f for package in PACKAGES for f in files(package) if f.name == name)
        copy = tmp_path / name
        copy.write_bytes(source.read_bytes() + b"added = 1\n")
        monkeypatch.setattr(keys, "source_files", seen)
        keys.sources.cache_clear()

    yield edit
    keys.sources.cache_clear()


PACKAGES = ("coilspring", "equivbeam", "wirefe", "validation")


@pytest.mark.parametrize(
    ("source", "changed"),
    [
        ("newton.py", {"equivbeam", "wirefe"}),
        ("haringx.py", {"equivbeam"}),
        ("chain.py", {"wirefe"}),
        ("pathfile.py", {"equivbeam", "wirefe"}),
        ("style.py", set()),
    ],
)
def test_a_statement_of_a_source_changes_the_keys_that_rest_on_it(edited, source, changed):
    scene = spring_a()
    before = {model: run_key(model, scene, {}) for model in ("equivbeam", "wirefe")}
    whole = keys.sources(*PACKAGES)
    edited(source)
    assert {model for model in before if run_key(model, scene, {}) != before[model]} == changed
    assert keys.sources(*PACKAGES) != whole


def test_sources_of_parts_of_a_package_count(tmp_path, monkeypatch):
    package = tmp_path / "somepackage"
    (package / "part").mkdir(parents=True)
    for file in (package / "__init__.py", package / "part" / "a.py", package / "b.py"):
        file.write_bytes(b"x = 1\n")
    (package / "data.npz").write_bytes(b"")
    monkeypatch.syspath_prepend(tmp_path)
    assert len(keys.source_files("somepackage")) == 3
    assert keys.source_files("somepackage.b") == [package / "b.py"]
    before = keys.digest(keys.source_files("somepackage"))
    (package / "part" / "a.py").write_bytes(b"x = 2\n")
    assert keys.digest(keys.source_files("somepackage")) != before
    with pytest.raises(ModuleNotFoundError, match="nopackage"):
        keys.sources("nopackage")


SOURCE = '''"""Doubles."""


def double(x, y=2):
    """Twice, or as often as said."""
    return x * y  # a product
'''


@pytest.mark.parametrize(
    ("old", "new", "same"),
    [
        ("  # a product", "  # of two", True),
        ("Twice, or", "Often, and", True),
        ('    """Twice, or as often as said."""\n', "", True),
        ("x, y=2", "\n    x,\n    y=2,\n", True),
        ("y=2", "y=3", False),
        ("y=2", "y=2.0", False),
        ("x * y", "y * x", False),
        ("return x * y", 'return "Twice, or as often as said."', False),
    ],
)
def test_keys_follow_what_a_source_does_not_how_it_is_written(tmp_path, old, new, same):
    file = tmp_path / "a.py"
    file.write_text(SOURCE)
    before = keys.digest([file])
    assert SOURCE.replace(old, new) != SOURCE
    file.write_text(SOURCE.replace(old, new))
    assert (keys.digest([file]) == before) is same


def test_of_a_template_each_byte_counts(tmp_path):
    file = tmp_path / "page.md"
    file.write_text("# Title\n")
    before = keys.digest([file])
    file.write_text("# Title \n")
    assert keys.digest([file]) != before


def test_a_run_has_its_own_key():
    scene = spring_a()
    scenes = [
        scene,
        spring_b(),
        scene.with_steps(49),
        scene.with_penalty(1.0001e4),
        replace(scene, material=Material(nu=0.29)),
        replace(scene, contact=Contact(geometry="spheres", sliding="none")),
        replace(scene, spring=replace(scene.spring, start_phase=0.1)),
    ]
    options = [{}, {"steps": 10}, {"tangent": "exact"}, {"tangent": "paper"}]
    runs = [("wirefe", scene, {})] + [("equivbeam", s, o) for s in scenes for o in options]
    assert len({run_key(*run) for run in runs}) == len(runs)
    assert run_key("equivbeam", spring_a(), {"a": 1, "b": 2}) == run_key("equivbeam", scene, {"b": 2, "a": 1})


FREE = replace(spring_b(), contact=Contact(geometry="spheres"))
RUNS = {
    "beam": ("equivbeam", spring_a(), {}),
    "beam, paper's tangent": ("equivbeam", spring_b(), {"tangent": "paper", "steps": 7}),
    "beam, helix, no sliding": ("equivbeam", spring_b(), {"law": "helix", "sliding": "scene"}),
    "beam at a limit point": ("equivbeam", FREE, {"penalty": 400.0}),
    "wire": ("wirefe", load_scene("spring-a-no-contact"), {"elements_per_turn": 8}),
    "wire, no sliding": ("wirefe", spring_b(), {"element": "curved", "elements_per_turn": 8}),
    "wire at a limit point": ("wirefe", FREE, {"element": "curved", "elements_per_turn": 8}),
    "wire with pairs found": (
        "wirefe",
        spring_b(),
        {"steps": 3, "penalty": 1e2, "element": "curved", "elements_per_turn": 40, "pairs_per_turn": 40},
    ),
}


@pytest.mark.parametrize("name", RUNS)
def test_a_path_comes_back_as_it_was_solved(name, tmp_path):
    model, scene, options = RUNS[name]
    path = partial_path({"equivbeam": equivbeam.solve, "wirefe": wirefe.solve}[model], scene, **options)
    path.save(tmp_path / "path.npz")
    back = load_path(tmp_path / "path.npz")
    assert (path.outcome == "completed") == ("limit" not in name)
    assert (path.options.get("pairs_found", 0) > 0) == ("found" in name)
    for field in set(vars(path)) & set(path.__dataclass_fields__) - {"shape"}:
        one, other = getattr(path, field), getattr(back, field)
        if isinstance(one, np.ndarray):
            assert one.dtype == other.dtype
            # kernels compiled for aligned records take no others
            assert one.dtype.isalignedstruct == other.dtype.isalignedstruct
        np.testing.assert_array_equal(other, one, err_msg=field)
    assert path.scene == back.scene
    assert path.options == back.options
    for quantity in (
        lambda p: p.tips,
        lambda p: p.contact_forces,
        lambda p: p.gaps,
        lambda p: p.friction.force,
        lambda p: p.centreline(-1),
    ):
        np.testing.assert_array_equal(quantity(back), quantity(path))


def test_no_object_is_ever_unpickled(tmp_path):
    file = tmp_path / "a.npz"
    np.savez(file, scene=np.array([{}], dtype=object))
    with pytest.raises(InputError, match=r"must be a saved path, got .*a\.npz.*allow_pickle"):
        load_path(file)


NO_PATH = {
    "stress needs a path of the model wirefe, got None": lambda: wirefe.stress(None),
    "frequencies needs a path of the model wirefe, got 3": lambda: wirefe.frequencies(3),
    "modes needs a path of the model wirefe, got 3": lambda: wirefe.modes(3),
    "sensitivities needs a path of the model equivbeam, got 'E'": lambda: equivbeam.sensitivities("E", ["E"]),
    "path must be an EquilibriumPath, got None": lambda: compare_paths(None, None),
    "file must be a path of the disk or a binary stream, got None": lambda: load_path(None),
}


@pytest.mark.parametrize("words", NO_PATH)
def test_what_is_no_path_is_refused_in_one_sentence(words):
    with pytest.raises(InputError, match=words):
        NO_PATH[words]()


def test_what_is_no_saved_path_is_refused_in_one_sentence(tmp_path):
    file = tmp_path / "path.npz"
    with pytest.raises(InputError, match="No such file"):
        load_path(file)
    whole = BytesIO()
    equivbeam.solve(spring_a(), steps=1).save(whole)
    for data in (b"", b"text", whole.getvalue()[:-100], b"\x93NUMPY"):
        file.write_bytes(data)
        with pytest.raises(InputError, match="must be a saved path"):
            load_path(file)
    with np.load(BytesIO(whole.getvalue())) as entries:
        np.savez(
            file,
            **dict(entries)
            | {"numbers": np.frombuffer(b'{"model": "antigravity", "options": {}}', np.uint8)},
        )
    with pytest.raises(InputError, match="must be one of equivbeam, wirefe, got 'antigravity'"):
        load_path(file)


def test_a_path_of_another_version_is_refused(tmp_path):
    """Its pairs, or what was remembered of them, were others; or its fields were."""
    file, path = tmp_path / "path.npz", equivbeam.solve(spring_a(), steps=1)
    words = [(name, PAIR_HISTORY[name]) for name in PAIR_HISTORY.names if name != "whole"]
    other = np.zeros(path.histories.shape, np.dtype(words, align=True))
    pairs = ({"histories": path.histories[:, 1:]}, {"histories": other}, {"least_gaps": None})
    for changed in (*pairs, {"speed": 1.0}, {"more": path.times}, {"outcome": "lost"}):
        write_fields(path.__getstate__() | changed, file)
        with pytest.raises(InputError, match=r"must be a path saved by this version, got .*path\.npz"):
            load_path(file)
    for missing in ("model", "message"):
        write_fields({name: value for name, value in path.__getstate__().items() if name != missing}, file)
        with pytest.raises(InputError, match=r"must be a path saved by this version, got .*path\.npz"):
            load_path(file)


def test_a_traced_path_comes_back(tmp_path):
    path = partial_path(wirefe.trace, load_scene("spring-a-no-contact"), elements_per_turn=8, points=3)
    path.save(tmp_path / "path.npz")
    back = load_path(tmp_path / "path.npz")
    np.testing.assert_array_equal(back.tips, path.tips)
    assert (back.histories, back.options) == (None, path.options)


def test_a_path_says_what_it_is():
    path = equivbeam.solve(spring_b(), steps=2)
    first, second, third, last = str(path).splitlines()
    assert first == "spring-b by equivbeam (law haringx, tangent exact, sliding ignore)"
    assert second == f"completed: {path.message}"
    assert third.startswith("time 1: UX 0 mm, UY -15.37")
    closed = f"{path.active_contacts[-1]} of {path.gaps.shape[1]} contact pairs closed"
    assert last.startswith(closed)
    assert last.endswith(" s")
    assert f"{path.total_iterations} iterations" in last


@pytest.mark.parametrize("damaged", [False, True])
def test_a_run_is_solved_once_complete_or_not(tmp_path, damaged):
    scene = spring_b().with_steps(5)

    def asked():
        lines = []
        paths = PathStore(lines.append, Store(tmp_path))
        found = (
            paths.beam(scene),
            paths.wire(scene, elements_per_turn=8),
            paths.partial_wire(replace(FREE, load=scene.load), elements_per_turn=8),
        )
        return [path.outcome for path in found], sum(line.startswith("solve ") for line in lines)

    ends = ["completed", "completed", "limit_point"]
    assert asked() == (ends, 3)
    assert asked() == (ends, 0)
    if damaged:
        file = max(tmp_path.iterdir(), key=lambda file: file.stat().st_size)
        file.write_bytes(file.read_bytes()[:-100])
        assert asked() == (ends, 1)
        assert asked() == (ends, 0)


def test_templates_and_data_are_sources_too():
    """What is stored is made anew where the words of a page are changed."""
    names = {file.name for file in keys.source_files("validation")}
    assert {"keys.py", "report.md", "inputs.toml"} <= names


def test_a_text_is_no_path(tmp_path):
    file = tmp_path / "my.toml"
    file.write_text('name = "mine"')
    with pytest.raises(InputError, match=r"file must be a saved path, got .*my\.toml' \(it is no archive\)$"):
        load_path(file)
