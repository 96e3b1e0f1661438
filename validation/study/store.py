"""Results kept between runs: a folder of files by key, which several processes may share.

An entry is some named files in one, with their digest before them: what is damaged counts as missing.
"""

import hashlib
import io
import os
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from validation.study.files import OutputError, write_bytes, writing

VARIABLE = "COILCHECK_STORE"
MOST_BYTES = 256 * 2**20
SUFFIX = ".coilcheck"  # nothing without it is ever removed
DIGEST = 32  # bytes of a SHA-256


def default_folder() -> Path | None:
    """`$COILCHECK_STORE`, else a folder among the user's caches; None where the user has no home."""
    chosen = os.environ.get(VARIABLE)
    if chosen:
        return Path(chosen)
    caches = os.environ.get("LOCALAPPDATA" if os.name == "nt" else "XDG_CACHE_HOME")
    try:
        return Path(caches or Path.home() / ".cache") / "coilcheck"
    except RuntimeError:
        return None


@dataclass
class Store:
    """Entries of named files by key."""

    folder: Path | None  # where they are, made when the first is put; None keeps nothing
    most: int = MOST_BYTES  # of all entries together, beyond which the least recently used go
    trouble: str = ""  # why nothing more is kept, one sentence; empty while all is well

    def __post_init__(self) -> None:
        if self.folder is None:
            self.trouble = f"nothing is kept for the next time: no home folder, no ${VARIABLE}"

    def get(self, key: str) -> dict[str, bytes] | None:
        """Files of an entry; None where there is no such entry, whole and readable."""
        if self.folder is None:
            return None
        file = self.folder / (key + SUFFIX)
        try:
            data = file.read_bytes()
        except OSError:
            return None
        if hashlib.sha256(data[DIGEST:]).digest() != data[:DIGEST]:
            return None
        with suppress(OSError):  # where it can only be read, that is enough
            os.utime(file)
        with zipfile.ZipFile(io.BytesIO(data[DIGEST:])) as archive:
            files = {name: archive.read(name) for name in archive.namelist()}
        # names that lead elsewhere are not of this module
        return files if all(Path(name).name == name for name in files) else None

    def put(self, key: str, files: Mapping[str, bytes]) -> None:
        """Keep an entry; where that fails `trouble` says so, and nothing more is tried."""
        if self.trouble or self.folder is None:
            return
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w") as archive:
            for name, data in files.items():
                archive.writestr(zipfile.ZipInfo(name), data)
        payload = stream.getvalue()
        try:
            with writing(self.folder):
                self.folder.mkdir(parents=True, exist_ok=True)
                write_bytes(self.folder / (key + SUFFIX), hashlib.sha256(payload).digest() + payload)
                self._trim(self.folder)
        except OutputError as error:
            self.trouble = f"nothing is kept for the next time: {error}"

    @contextmanager
    def kept_if_interrupted(self) -> Iterator[None]:
        """Say of a block that was interrupted that what it has put here is kept, where that is so."""
        try:
            yield
        except KeyboardInterrupt as stop:
            said = () if self.trouble else ("what is solved is kept; the same command goes on",)
            raise KeyboardInterrupt(*stop.args, *said) from None

    def _trim(self, folder: Path) -> None:
        """Remove the least recently used, and what writers that were killed have left."""
        found = []
        for file in folder.glob(f"*{SUFFIX}*"):
            try:
                stat = file.stat()
            except FileNotFoundError:
                continue  # another process was faster
            found.append((stat.st_mtime, stat.st_size, file))
        excess = sum(size for _, size, _ in found) - self.most
        for _, size, file in sorted(found):
            if excess <= 0:
                return
            file.unlink(missing_ok=True)
            excess -= size
