"""Compiled kernels on disk, found by the content of all that they are compiled from.

numba's own cache compares a function with its source file alone. It knows nothing of the functions that it
calls, so that an edited law would go on running as it was. Here the name of an entry holds a digest of the
function as it is in memory: its code, the code of all functions that it calls, the values of the globals that
they read, how each is compiled, and by which compiler. The processor is in numba's own key. Entries of other
contents lie beside it: two checkouts share a folder, and an edit that is taken back finds the old entry.
"""

import hashlib
import os
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import _lru_cache_wrapper, cache
from pathlib import Path
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import llvmlite
import numba
import numpy as np
from numba.core import config
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.extending import _Intrinsic
from numba.experimental.structref import StructRefProxy

OPTIONS = "__compiled__"  # attribute of a function: how it is compiled
FLAGS = ("OPT", "BOUNDSCHECK", "DEBUGINFO_DEFAULT", "LOOP_VECTORIZE", "SLP_VECTORIZE", "ENABLE_AVX")
UNUSED_DAYS = 30  # after which an entry goes
MOST_ENTRIES = 1000  # about 100 kB each
DAY = 86_400.0
DIGITS = 32  # of a digest, in the names of files
FOREIGN = ("builtins", "math", "numba", "numpy")  # modules whose content is their version
PLAIN = (
    bool,
    int,
    float,
    str,
    bytes,
    type(None),
    BuiltinFunctionType,
    np.ufunc,
    numba.types.Type,
    _Intrinsic,
)


class _Entry(CompileResultCacheImpl):
    """How numba keeps a kernel, and where it finds it: in one folder for all, by its digest."""

    def __init__(self, function: Callable) -> None:
        self._lineno = function.__code__.co_firstlineno
        self._locator = self
        self._digest = content_digest(function)
        self._filename_base = self.get_filename_base(f"{function.__module__}.{function.__qualname__}", "")

    def ensure_cache_path(self) -> None:
        """Nothing to do: see `folder`."""

    def get_cache_path(self) -> str:
        return str(folder())

    def get_source_stamp(self) -> str:
        return self._digest

    def get_disambiguator(self) -> str:
        return self._digest[:DIGITS]


class KernelCache(FunctionCache):
    """Cache of one kernel, as a numba dispatcher asks for it."""

    _impl_class = _Entry

    def __init__(self, function: Callable) -> None:
        self._function = function

    def __getattr__(self, name: str) -> Any:
        """Take the digest when it is first asked for: all that the kernel calls is defined by then."""
        if "_impl" in vars(self):
            raise AttributeError(name)
        super().__init__(self._function)
        return getattr(self, name)

    @property
    def index(self) -> Path:
        """The file that numba looks at first."""
        return Path(self._cache_path) / f"{self._impl.filename_base}.nbi"

    @property
    def stored(self) -> bool:
        """Whether the disk holds anything of this kernel with this content."""
        return self.index.exists()

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The compiled kernel for a signature, or None."""
        try:
            found = super().load_overload(sig, target_context)
        except (AttributeError, ImportError):  # another version's, whose types were in another module
            for file in folder().glob(f"{self._impl.filename_base}*"):
                file.unlink(missing_ok=True)
            return None
        with suppress(OSError):  # note that the entry is in use, once a day
            if found is not None and time.time() - self.index.stat().st_mtime > DAY:
                os.utime(self.index)
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a compiled kernel; entries that nobody has used for long go. A full disk costs time only."""
        with suppress(OSError):
            super().save_overload(sig, data)
            trim(folder())

    def _index_key(self, sig: Any, codegen: Any) -> tuple:
        """Without what a closure holds: the digest has it, and pickles of it differ by process."""
        return sig, codegen.magic_tuple()


@cache
def folder() -> Path:
    """Folder of the entries: `$NUMBA_CACHE_DIR`, else among the user's caches, else among temporary files.

    The first that can be written to. None of them is part of the installation, which may be read-only.
    """
    for place in _places():
        with suppress(OSError):
            place.mkdir(parents=True, exist_ok=True, mode=0o700)
            with tempfile.TemporaryFile(dir=place):
                return place
    return Path(tempfile.mkdtemp(prefix="coilcheck-kernels-"))


def _places() -> Iterator[Path]:
    chosen = getattr(config, "CACHE_DIR", "")
    if chosen:
        yield Path(chosen) / "coilcheck"
    caches = os.environ.get("LOCALAPPDATA" if os.name == "nt" else "XDG_CACHE_HOME")
    with suppress(RuntimeError):  # a user without a home
        yield Path(caches or Path.home() / ".cache") / "coilcheck" / "kernels"
    user = os.getuid() if hasattr(os, "getuid") else 0
    shared = Path(tempfile.gettempdir()) / f"coilcheck-kernels-{user}"
    # compiled code of another user is not loaded
    if not shared.exists() or shared.stat().st_uid == user:
        yield shared


def trim(place: Path) -> None:
    """Remove the entries that have not been used for long, and the oldest of too many."""
    ages: dict[str, float] = {}
    for file in place.glob("*-*.nb[ic]*"):
        with suppress(OSError):  # another process was faster
            entry = file.name[: file.name.rindex("-") + 1 + DIGITS]
            ages[entry] = max(ages.get(entry, 0.0), file.stat().st_mtime)
    newest = sorted(ages, key=lambda entry: -ages[entry])
    limit = time.time() - UNUSED_DAYS * DAY
    for number, entry in enumerate(newest):
        if number >= MOST_ENTRIES or ages[entry] < limit:
            for file in place.glob(f"{entry}*"):
                with suppress(OSError):
                    file.unlink()


def _unknown(value: Any) -> str:
    """What has a content of no known kind."""
    raise TypeError(f"a compiled function reads {value!r}, whose content is unknown")


def _never(module: str) -> bool:
    """No functions are known by their names."""
    return False


def content_digest(
    function: Any, other: Callable[[Any], str] = _unknown, known: Callable[[str], bool] = _never
) -> str:
    """Digest of all that a kernel is compiled from, or that a Python function or a value reads.

    `other` describes values that compiled code cannot read; functions of `known` modules do not change.

    Raises
    ------
    TypeError : a compiled function reads a global whose content is unknown.
    """
    found = hashlib.sha256()
    versions = (numba.__version__, llvmlite.__version__, np.__version__)
    found.update(repr((versions, [getattr(config, flag, None) for flag in FLAGS])).encode())
    for line in _Content(other, known).of(function):
        found.update(line.encode() + b"\n")
    return found.hexdigest()


def is_foreign(module: str) -> bool:
    """Whether a module is one that compiled code knows by its version."""
    return module.partition(".")[0] in FOREIGN


class _Content:
    """Lines that differ where the content of functions and values does."""

    def __init__(self, other: Callable[[Any], str], known: Callable[[str], bool]) -> None:
        self._other, self._known = other, known
        self._seen: set[int] = set()

    def of(self, value: Any) -> Iterator[str]:
        """Lines of a value."""
        value = getattr(value, "py_func", value)  # of a dispatcher
        if isinstance(value, _lru_cache_wrapper):
            value = value.__wrapped__
        if isinstance(value, FunctionType):
            yield f"function {value.__module__}.{value.__qualname__}"
            if id(value) not in self._seen and not self._known(value.__module__):
                self._seen.add(id(value))
                yield from self._of_function(value)
        elif isinstance(value, np.ndarray | np.generic) and value.dtype != object:
            array = np.ascontiguousarray(value)
            yield f"array {array.dtype.descr} {array.shape} {hashlib.sha256(array.tobytes()).hexdigest()}"
        elif isinstance(value, tuple | list):
            yield f"tuple {len(value)}"
            for item in value:
                yield from self.of(item)
        elif isinstance(value, dict):
            yield f"dict {len(value)}"
            for item in value.items():
                yield from self.of(item)
        elif isinstance(value, set | frozenset):
            yield f"set {sorted(map(repr, value))}"  # the order of a set changes with the process
        elif isinstance(value, type) and issubclass(value, tuple) and hasattr(value, "_fields"):
            yield f"record {value.__qualname__} {value._fields}"  # type: ignore[attr-defined]
        elif isinstance(value, type) and issubclass(value, StructRefProxy):
            yield f"struct {value.__qualname__}"
        elif isinstance(value, PLAIN) or (isinstance(value, type) and is_foreign(value.__module__)):
            yield repr(value)
        else:
            yield self._other(value)

    def _of_function(self, function: FunctionType) -> Iterator[str]:
        """A function's code and options, and all that it reads from outside."""
        for name, option in getattr(function, OPTIONS, {}).items():
            yield f"option {name} {sorted(option) if isinstance(option, set) else option}"
        yield from self.of(function.__defaults__ or ())
        for cell in function.__closure__ or ():
            yield from self.of(cell.cell_contents)
        for code in codes(function.__code__):
            yield f"code {code.co_code.hex()} {code.co_names} {code.co_varnames[: code.co_argcount]}"
            for constant in code.co_consts:
                if not isinstance(constant, CodeType) and constant is not function.__doc__:
                    yield from self.of(constant)
            yield from self._of_names(function.__globals__, code.co_names)

    def _of_names(self, space: Mapping[str, Any], names: Sequence[str]) -> Iterator[str]:
        """What code finds under its names in a name space, and in the modules that it finds there."""
        for name in names:
            if name not in space:
                continue  # a builtin, or an attribute of something else
            value = space[name]
            yield f"name {name}"
            if not isinstance(value, ModuleType):
                yield from self.of(value)
            elif is_foreign(value.__name__):
                yield f"module {value.__name__}"
            elif id(value) not in self._seen:
                self._seen.add(id(value))
                yield from self._of_names(vars(value), names)
                self._seen.discard(id(value))


def codes(code: CodeType) -> Iterator[CodeType]:
    """A code object and those nested in it."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from codes(constant)
