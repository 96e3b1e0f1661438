"""Keys of stored results: digests of all that a result follows from."""

import ast
import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from coilspring import Scene
from validation.study.machine import versions

KINDS = ("py", "md", "toml", "inp", "txt", "css")  # of files: code, templates, data


def key(kind: str, **parts: object) -> str:
    """Key of a result of some kind by its parts, of JSON's types or laws, whose text is their content."""
    return hashlib.sha256(json.dumps([kind, parts], sort_keys=True, default=str).encode()).hexdigest()


def run_key(model: str, scene: Scene, options: Mapping[str, object]) -> str:
    """Key of a run: `scene` and `options` of its `solve`, the sources of all it rests on, versions.

    `model` is "equivbeam" or "wirefe"; options are of JSON's types, or a `UserLaw`.
    """
    used = sources("coilspring", model)
    return key("run", model=model, scene=asdict(scene), options=options, sources=used, versions=versions())


@cache
def sources(*names: str) -> str:
    """Digest of the sources of packages and modules, as they are when first asked for; none is imported."""
    return digest(file for name in names for file in source_files(name))


def source_files(name: str) -> list[Path]:
    """The file of a module, or all of a package with its templates and data."""
    spec = find_spec(name)
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError(f"no module named {name!r}", name=name)
    origin = Path(spec.origin)
    if not spec.submodule_search_locations:
        return [origin]
    return sorted(file for kind in KINDS for file in origin.parent.rglob(f"*.{kind}"))


def digest(files: Iterable[Path]) -> str:
    """Digest of names and contents; of Python files the code, without comments, docstrings and layout."""
    found = hashlib.sha256()
    for file in files:
        data = file.read_bytes()
        data = _code(data) if file.suffix == ".py" else data
        found.update(f"{file.name} {len(data)}\n".encode() + data)
    return found.hexdigest()


@cache
def _code(source: bytes) -> bytes:
    """Digest of what a Python source does."""
    words: list[str] = []
    _append(ast.parse(source), words)
    return hashlib.sha256(" ".join(words).encode()).digest()


def _append(part: object, words: list[str]) -> None:
    """Append a syntax tree in words, without places and without strings that stand alone, as docstrings do.

    What is empty is left out: later versions of Python add fields.
    """
    if isinstance(part, ast.AST):
        words.append(type(part).__name__)
        for name in part._fields:
            value = getattr(part, name)
            if value is not None and value != []:
                words.append(name)
                _append(value, words)
        words.append(";")
    elif isinstance(part, list):
        for each in part:
            if not _stands_alone(each):
                _append(each, words)
        words.append("]")
    else:
        words.append(repr(part))


def _stands_alone(statement: object) -> bool:
    """Whether a statement is a mere string."""
    return (
        isinstance(statement, ast.Expr)
        and isinstance(statement.value, ast.Constant)
        and isinstance(statement.value.value, str)
    )
