"""Files: whole or not at all, and one sentence where they cannot be written."""

import fcntl
import itertools
import json
import math
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]  # of the checkout, or of the packages where they are installed
FACTS = "facts.json"  # of a study: the numbers by name that findings are computed from
TEMPORARY = "the folder for temporary files"  # as a message has it


class OutputError(RuntimeError):
    """Something could not be written; one sentence."""


@contextmanager
def writing(target: str | Path) -> Iterator[None]:
    """Turn an `OSError` of the block into an `OutputError` that names `target`."""
    try:
        yield
    except OSError as error:
        raise OutputError(f"cannot write to {target}: {error.strerror or error}") from error


def prepare(folder: Path, target: Path | None = None) -> None:
    """Make sure that `folder` exists and takes files, before work is spent on what goes there; `target` is
    what a message names, by default the folder."""
    named = target or folder
    with writing(named):
        if other := in_the_way(folder):
            place = "it" if other == named else other
            raise OutputError(f"cannot write to {named}: {place} is a file, not a folder")
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass


def in_the_way(folder: Path) -> Path | None:
    """The file in the place of a folder, or of one above it; None where there is none."""
    return next((each for each in (folder, *folder.parents) if each.exists() and not each.is_dir()), None)


@contextmanager
def claimed(folder: Path) -> Iterator[None]:
    """`prepare` a folder and keep other runs out of it: files of two runs would not belong together.

    A run that fails before it has written anything leaves no new folder behind.
    """
    with writing(folder):
        new = not folder.exists()
        prepare(folder)
        handle = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise OutputError(
                f"cannot write to {folder}: another run is writing there; wait for it, or give another --out"
            ) from None
        except OSError:
            pass  # a file system without locks
        yield
    except BaseException:
        if new:
            with suppress(OSError):  # there is something in it
                folder.rmdir()
        raise
    finally:
        os.close(handle)


def write_text(target: Path, text: str) -> None:
    """Write a whole file or none."""
    write_bytes(target, text.encode("utf-8"))


def write_bytes(target: Path, data: bytes) -> None:
    """Write a whole file or none."""
    with _whole(target) as temporary:
        temporary.write_bytes(data)


def write_files(files: Mapping[str, bytes], folder: Path) -> None:
    """Write files by name, all or none; one that stands there with the same content is left as it is.

    They take their places when all are written, the last one first.
    """
    with ExitStack() as places:
        for name, data in files.items():
            target = folder / name
            if content_of(target) != data:
                places.enter_context(_whole(target)).write_bytes(data)


def content_of(target: Path) -> bytes | None:
    """What a file holds; None where there is none."""
    with writing(target):
        return target.read_bytes() if target.is_file() else None


@contextmanager
def _whole(target: Path) -> Iterator[Path]:
    """A file to write to, which becomes `target` at the end: a partial one is never seen under its name."""
    temporary = target.with_name(f".{target.name}.{os.getpid()}.part")
    with writing(target):
        try:
            yield temporary
            os.replace(temporary, target)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise


def write_facts(facts: Mapping[str, object], folder: Path) -> None:
    """Keep the numbers of a study that findings are computed from, by name."""
    folder.mkdir(parents=True, exist_ok=True)
    write_bytes(folder / FACTS, json_bytes(facts))


def json_bytes(value: object) -> bytes:
    """A file of `json_text`."""
    return (json_text(value) + "\n").encode("utf-8")


def json_text(value: object) -> str:
    """Strict JSON; what is not a finite number becomes null."""
    return json.dumps(_plain(value), indent=2, allow_nan=False)


def keep(target: Path) -> Path:
    """Keep a file under another name, NAME.1.csv and so on, unless it is kept already; that name."""
    names = (target.with_name(f"{target.stem}.{number}{target.suffix}") for number in itertools.count(1))
    with writing(target):
        content = target.read_bytes()
        kept = next(n for n in names if not n.exists() or (n.is_file() and n.read_bytes() == content))
        if not kept.exists():
            write_bytes(kept, content)
    return kept


def _plain(value: object) -> object:
    """`value` in the types of JSON."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
