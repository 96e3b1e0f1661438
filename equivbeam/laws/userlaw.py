"""A law of a half coil that a user wrote: two functions, in a file, a module or an object.

``parameters(coil) -> tuple`` gives the numbers of a half coil (`HalfCoil`), ``energy(l, v, dtheta, p)`` its
strain energy. It is compiled for jets (`equivbeam.laws.jets`), which carry the derivatives along, so that the
law has the same response as the built-in ones.
"""

from __future__ import annotations

import hashlib
import linecache
import math
import numbers
import pickle
import sys
import sysconfig
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, lru_cache
from itertools import count
from pathlib import Path
from types import FrameType, FunctionType
from typing import Any

import numpy as np

from coilspring.compiling.kernelcache import content_digest
from coilspring.errors import InputError
from coilspring.scene.material import Material
from coilspring.scene.spring import Spring
from coilspring.words import shown
from equivbeam.element import Response
from equivbeam.laws.halfcoil import HalfCoil, spring_coils
from equivbeam.laws.haringx import KAX, KFL, KSH, L0
from equivbeam.laws.lawchecks import checked_rest, state_text
from equivbeam.laws.lawcompile import FIRST, compiled_law, why_not_compiled

DIGITS = 16  # of a digest, in the name of a law
MOST_OPERATIONS = 5_000_000  # of Python, in an energy at rest


KNOWN: dict[str, UserLaw] = {}  # laws of this process by what paths keep of them


@dataclass(frozen=True)
class UserLaw:
    """A law of a half coil by its two functions; equal laws have one content."""

    name: str  # of its file or object
    digest: str  # of its content: the file, or the code of the functions and what they read
    # path and text of the file it comes from, by which another process gets it; None for an object
    source: tuple[str, str] | None = field(compare=False, repr=False)
    parameters: Callable[[HalfCoil], tuple] = field(compare=False, repr=False)
    energy: FunctionType = field(compare=False, repr=False)

    def __str__(self) -> str:
        """As paths and keys keep it: name and content."""
        return f"{self.name}@{self.digest[:DIGITS]}"

    def __reduce__(self) -> tuple:
        if self.source is not None:
            return law_of_text, self.source
        return _law_of_functions, (self.name, self.parameters, self.energy)

    def response(self, columns: int) -> Callable:
        """Response of a half coil whose table of parameters has so many columns; a part of kernels."""
        return self._compiled(columns)[0]

    def _compiled(self, columns: int) -> tuple[Callable, Callable]:
        """See `equivbeam.laws.lawcompile.compiled_law`."""
        return compiled_law(self.name, self.digest[:DIGITS], self.energy, columns)

    def evaluated(self, rows: np.ndarray, index: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Energy and derivatives, as in `Response`, at points (l, v, dtheta) of the half coils `index`."""
        out = np.empty((len(points), len(Response._fields)))
        rows, points = np.ascontiguousarray(rows), np.ascontiguousarray(points)
        index = np.asarray(index, dtype=np.int64)
        self._refusing(lambda: self._compiled(rows.shape[1])[1](rows, index, points, out))
        return out

    def _refusing(self, compiled: Callable[[], object]) -> None:
        """Do what compiles the energy; what is wrong with that is said in one sentence."""
        try:
            compiled()
        except InputError:
            raise
        except Exception as error:  # numba has many kinds
            raise InputError(f"law {self.name}: {why_not_compiled(self.energy, error)}") from None

    def columns(self, spring: Spring, material: Material) -> int:
        """How many columns the table of parameters has; `InputError` for parameters that are no numbers."""
        return FIRST + len(self._numbers(spring_coils(spring, material)[0]))

    def rows(self, spring: Spring, material: Material) -> np.ndarray:
        """Table of parameters: stiffnesses and length at rest as in the paper's law, then the law's own.

        `InputError` for parameters that are no numbers, or an energy that no spring at rest can have.
        """
        if spring.wire_rigidity != "beam":
            raise InputError(
                f"spring.wire_rigidity must be beam with law {self.name}, which knows E and G alone, got "
                f"{spring.wire_rigidity!r}"
            )
        coils = spring_coils(spring, material)
        values = [self._numbers(coil) for coil in coils]
        for coil, each in zip(coils, values, strict=True):
            if len(each) != len(values[0]):
                raise InputError(
                    f"law {self.name}: parameters must be as many for every half coil, got {len(values[0])} "
                    f"for half coil 1 and {len(each)} for half coil {coil.index + 1}"
                )
        lengths = np.array([coil.length for coil in coils])
        own = np.array(values, dtype=float).reshape(len(coils), -1)
        rows = np.column_stack((np.zeros((len(coils), L0)), lengths, own))
        self._try(coils[0], values[0])
        rows[:, [KAX, KSH, KFL]] = checked_rest(self, rows)
        return rows

    def _numbers(self, coil: HalfCoil) -> list[float]:
        """Parameters of a half coil."""
        where = f"law {self.name}: parameters of half coil {coil.index + 1}"
        found = _called(where, self.parameters, coil)
        values = list(found) if isinstance(found, tuple | list | np.ndarray) else [found]
        if not all(_is_number(value) and math.isfinite(value) for value in values):
            raise InputError(f"{where} must be finite numbers, got {shown(found)}")
        return [float(value) for value in values]

    def _try(self, coil: HalfCoil, values: list[float]) -> None:
        """The energy at rest as plain Python, whose errors are the clearest."""
        # first, so that nothing runs that calls itself or prints
        self._refusing(lambda: self._compiled(FIRST + len(values)))
        place = f"energy of half coil {coil.index + 1} at rest {state_text(coil.length, 0, 0)}"
        where = f"law {self.name}: {place}"
        with np.errstate(all="ignore"):
            found = _called(where, _ending, self.energy, coil.length, 0.0, 0.0, tuple(values))
        if not _is_number(found):
            raise InputError(f"{where} must be a number, got {shown(found)}")


def law_of_file(file: Path) -> UserLaw:
    """The law in a file, as the file is now."""
    if file.suffix != ".py":
        raise InputError(f"law must be a Python file, named *.py, got {shown(str(file))}")
    try:
        return law_of_text(str(file), file.read_text(encoding="utf-8-sig"))  # some editors write a mark first
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or error  # the text of an OSError names the file again
        raise InputError(
            f"law must be a Python file that can be read, got {str(file)!r} ({reason})"
        ) from None


@lru_cache(maxsize=64)
def law_of_text(file: str, text: str) -> UserLaw:
    """The law in the text of a file."""
    name, found = Path(file).name, hashlib.sha256(text.encode()).hexdigest()
    place = f"<law {file} {found[:DIGITS]}>"  # each content is a source of its own for `inspect`
    linecache.cache[place] = (len(text), None, text.splitlines(True), place)
    space: dict[str, Any] = {"__name__": f"law_{Path(file).stem}", "__file__": file}
    _called(f"law {name}", lambda: exec(compile(text, place, "exec"), space))
    functions = [_function(name, space.get(each), each) for each in ("parameters", "energy")]
    law = UserLaw(name, found, (file, text), *functions)
    return KNOWN.setdefault(str(law), law)


def law_of_object(given: Any) -> UserLaw:
    """The law of a module or an object, as its functions are in memory now."""
    name = Path(getattr(given, "__file__", "") or getattr(given, "__name__", type(given).__name__)).name
    return _law_of_functions(name, getattr(given, "parameters", None), getattr(given, "energy", None))


def _law_of_functions(name: str, parameters: Any, energy: Any) -> UserLaw:
    parameters, energy = _function(name, parameters, "parameters"), _function(name, energy, "energy")
    found = hashlib.sha256()
    for function in (parameters, energy):
        try:
            found.update(content_digest(function, _described, _is_installed).encode())
        except (TypeError, RecursionError) as error:
            got = "a value that holds itself" if isinstance(error, RecursionError) else error
            raise InputError(
                f"law {name}: {function.__name__} must read numbers, arrays, or what can be pickled, so that "
                f"laws can be told apart, got {got}"
            ) from None
    law = UserLaw(name, found.hexdigest(), None, parameters, energy)
    return KNOWN.setdefault(str(law), law)


def _described(value: Any) -> str:
    """Content of a class, or of an object, that parameters read and compiled code could not."""
    kind = value if isinstance(value, type) else type(value)
    lines = [f"{kind.__module__}.{kind.__qualname__}"]
    if not _is_installed(kind.__module__):
        members = [getattr(each, "fget", getattr(each, "__func__", each)) for each in vars(kind).values()]
        functions = [each for each in members if isinstance(each, FunctionType)]
        lines += [content_digest(each, _described, _is_installed) for each in functions]
    if value is not kind:
        lines.append(_state(value, kind.__qualname__))
    return " ".join(lines)


def _state(value: Any, kind: str) -> str:
    """Digest of what an object holds."""
    try:
        return hashlib.sha256(pickle.dumps(value)).hexdigest()
    except Exception:  # of many kinds
        if not hasattr(value, "__dict__"):
            raise TypeError(f"a {kind}, which cannot be pickled") from None
    return content_digest(vars(value), _described, _is_installed)


@cache
def _is_installed(module: str) -> bool:
    """Whether a module is of Python or of an installed package, whose functions do not change.

    Never `__main__`: under ``python -m cProfile script.py`` that is the profiler, not the script.
    """
    if module == "__main__":
        return False
    file = getattr(sys.modules.get(module), "__file__", None)
    if file is None:
        return module in sys.builtin_module_names
    places = (sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib"))
    return any(Path(file).is_relative_to(place) for place in places)


def _function(name: str, given: Any, role: str) -> FunctionType:
    """One of the law's functions, with the arguments that it must have."""
    wanted = ("coil",) if role == "parameters" else ("l", "v", "dtheta", "p")
    text = f"{role}({', '.join(wanted)})"
    if not isinstance(given, FunctionType):
        raise InputError(f"law {name} must have a function {text}, got {shown(given)}")
    code = given.__code__
    if code.co_argcount != len(wanted) or code.co_kwonlyargcount or code.co_flags & (0x04 | 0x08):
        names = ", ".join(code.co_varnames[: code.co_argcount])
        raise InputError(f"law {name}: {role} must take {len(wanted)} arguments, {text}, got {role}({names})")
    return given


def _is_number(value: Any) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, bool)


def _ending(function: FunctionType, *arguments: Any) -> Any:
    """What a function gives, or `TimeoutError` after more operations in its file than a law needs: a compiled
    loop that does not end could not be interrupted."""
    operations, before = count(), sys.gettrace()

    def trace(frame: FrameType, event: str, argument: Any) -> Any:
        if frame.f_code.co_filename != function.__code__.co_filename:
            return None
        frame.f_trace_opcodes = True
        if next(operations) > MOST_OPERATIONS:
            raise TimeoutError(f"it takes more than {MOST_OPERATIONS} operations")
        return trace

    sys.settrace(trace)
    try:
        return function(*arguments)
    finally:
        sys.settrace(before)


def _called(where: str, function: Callable, *arguments: Any) -> Any:
    """What a function of a law's file gives; its errors, with their lines, in one sentence."""
    try:
        return function(*arguments)
    except InputError as error:
        reason = str(error)
    except SyntaxError as error:
        reason = f"line {error.lineno}: {error.msg}"
    except (Exception, SystemExit) as error:  # a file that ends the program does not end this one
        frames = traceback.extract_tb(error.__traceback__)
        places = [frame.lineno for frame in frames if "<law " in frame.filename]
        line = f"line {places[-1]}: " if places else ""
        reason = " ".join(f"{line}{type(error).__name__}: {error}".split())
    raise InputError(f"{where}: {reason}")
