"""A law of a half coil that a user wrote: two functions, in a file, a module or an object.

``parameters(coil) -> tuple`` gives the numbers of a half coil (`HalfCoil`), ``energy(l, v, dtheta, p)`` its
strain energy. It is compiled for jets (`equivbeam.laws.jets`), which carry the derivatives along, so that the
law has the same response as the built-in ones.
"""

from __future__ import annotations

import hashlib
import inspect
import linecache
import math
import numbers
import re
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from types import CellType, FunctionType, ModuleType
from typing import Any, cast

import numpy as np
from numba.np.unsafe.ndarray import to_fixed_tuple

from coilspring.compiling.compiled import kernel, part
from coilspring.compiling.kernelcache import codes, content_digest, is_foreign
from coilspring.errors import InputError
from coilspring.scene.material import Material
from coilspring.scene.spring import Spring
from coilspring.words import shown
from equivbeam.element import Response
from equivbeam.halfcoils import half_coils
from equivbeam.laws import jets
from equivbeam.laws.haringx import KAX, KFL, KSH, L0
from equivbeam.laws.lawchecks import checked_rest, state_text

FIRST = 4  # column of the first parameter: stiffnesses and length at rest come before
DIGITS = 16  # of a digest, in the name of a law
ALLOWED = "a law is plain arithmetic, elementary functions of numpy and math, branches and loops over a range"


@dataclass(frozen=True)
class HalfCoil:
    """What a law knows of a half coil.

    Attributes
    ----------
    mean_diameter : mean coil diameter D in the middle of the half coil, mm.
    wire_diameter : d, mm.
    length : axial length at rest, mm.
    wire_length : length of its wire, of a helix of the mean diameter, mm.
    helix_angle : angle of that helix, rad.
    start_phase, end_phase : where it begins and ends, from the working plane about the axis, rad.
    hand : "left" or "right".
    E, G : moduli, MPa.
    index : number of the half coil from the bottom, from 0.
    """

    mean_diameter: float
    wire_diameter: float
    length: float
    wire_length: float
    helix_angle: float
    start_phase: float
    end_phase: float
    hand: str
    E: float
    G: float
    index: int


def spring_coils(spring: Spring, material: Material) -> list[HalfCoil]:
    """The half coils of a spring, from the bottom."""
    at = half_coils(spring)
    diameters, phases = 2.0 * spring.radius(at.middles), (at.phases + spring.start_phase).tolist()
    return [
        HalfCoil(
            mean_diameter=D,
            wire_diameter=spring.wire_diameter,
            length=length,
            wire_length=math.hypot(length, 0.5 * math.pi * D),
            helix_angle=math.atan(2.0 * length / (math.pi * D)),
            start_phase=phases[index],
            end_phase=phases[index + 1],
            hand=spring.hand,
            E=material.E,
            G=material.G,
            index=index,
        )
        for index, (D, length) in enumerate(zip(diameters.tolist(), at.lengths.tolist(), strict=True))
    ]


KNOWN: dict[str, UserLaw] = {}  # laws of this process by what paths keep of them


@dataclass(frozen=True)
class UserLaw:
    """A law of a half coil by its two functions; equal laws have one content."""

    name: str  # of its file or object
    digest: str  # of its content: the file, or the code of the functions and what they read
    # path and text of the file it comes from, by which another process gets it; None for an object
    source: tuple[str, str] | None = field(compare=False, repr=False)
    parameters: Callable[[HalfCoil], tuple] = field(compare=False, repr=False)
    energy: Callable = field(compare=False, repr=False)

    def __str__(self) -> str:
        """As paths and keys keep it: name and content."""
        return f"{self.name}@{self.digest[:DIGITS]}"

    def __reduce__(self) -> tuple:
        if self.source is not None:
            return law_of_text, self.source
        return _law_of_functions, (self.name, self.parameters, self.energy)

    def response(self, columns: int) -> Callable:
        """Response of a half coil whose table of parameters has so many columns; a part of kernels."""
        return _compiled(self, columns)[0]

    def evaluated(self, rows: np.ndarray, index: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Energy and derivatives, as in `Response`, at points (l, v, dtheta) of the half coils `index`."""
        out = np.empty((len(points), len(Response._fields)))
        try:
            rows, points = np.ascontiguousarray(rows), np.ascontiguousarray(points)
            _compiled(self, rows.shape[1])[1](rows, np.asarray(index, dtype=np.int64), points, out)
        except InputError:
            raise
        except Exception as error:  # numba has many kinds
            raise InputError(f"law {self.name}: {_uncompiled(self.energy, error)}") from None
        return out

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
        place = f"energy of half coil {coil.index + 1} at rest {state_text(coil.length, 0, 0)}"
        where = f"law {self.name}: {place}"
        with np.errstate(all="ignore"):
            found = _called(where, self.energy, coil.length, 0.0, 0.0, tuple(values))
        if not _is_number(found):
            raise InputError(f"{where} must be a number, got {shown(found)}")


def law_of_file(file: Path) -> UserLaw:
    """The law in a file, as the file is now."""
    if file.suffix != ".py":
        raise InputError(f"law must be a Python file, named *.py, got {shown(str(file))}")
    try:
        return law_of_text(str(file), file.read_text(encoding="utf-8"))
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
            found.update(content_digest(function).encode())
        except TypeError:  # it reads what has no content, a module of another package
            found.update(inspect.getsource(function).encode())
    law = UserLaw(name, found.hexdigest(), None, parameters, energy)
    return KNOWN.setdefault(str(law), law)


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


@lru_cache(maxsize=256)
def _compiled(law: UserLaw, columns: int) -> tuple[Callable, Callable]:
    """The response of a law, and a kernel that makes a table of it."""
    content = f"{law.digest[:DIGITS]}_{jets.CONTENT}"
    energy, variables, lifted = _part_of(law.energy, law.name, content, ()), jets.variables, jets.lifted
    count, fixed = columns - FIRST, cast("Any", to_fixed_tuple)

    def response(law, rows, i, l, v, dth):  # noqa: E741
        l, v, dth = variables(l, v, dth)  # noqa: E741
        u = lifted(energy(l, v, dth, fixed(rows[i, FIRST:], count)))
        return Response(u.value, u.l, u.v, u.m, u.ll, u.lv, u.lm, u.vv, u.mm, u.vm)

    response.__name__ = response.__qualname__ = f"response_{content}"
    part(response)

    def tabulate(rows, index, points, out):
        for k in range(index.size):
            r = response(0, rows, index[k], points[k, 0], points[k, 1], points[k, 2])
            for j in range(out.shape[1]):
                out[k, j] = r[j]

    tabulate.__qualname__ = f"tabulate_{content}"
    return response, kernel(tabulate)


def _part_of(function: Any, law: str, content: str, callers: tuple[FunctionType, ...]) -> Callable:
    """A copy of a law's function as a part of kernels, with copies of those that it calls.

    Names hold the law's content: compiled code of two laws that came from the disk must not be mistaken for
    each other.
    """
    if function in callers:
        raise InputError(f"law {law}: {function.__name__} must not call itself")
    read = {name for code in codes(function.__code__) for name in code.co_names}

    def known(value: Any) -> Any:
        if isinstance(value, FunctionType) and not is_foreign(value.__module__):
            return _part_of(value, law, content, (*callers, function))
        if isinstance(value, ModuleType) and not is_foreign(value.__name__):
            copied = ModuleType(value.__name__)
            vars(copied).update({name: known(each) for name, each in vars(value).items() if name in read})
            return copied
        return value

    space = {name: known(each) if name in read else each for name, each in function.__globals__.items()}
    cells = tuple(CellType(known(cell.cell_contents)) for cell in function.__closure__ or ())
    copied = FunctionType(function.__code__, space, function.__name__, function.__defaults__, cells)
    copied.__qualname__, copied.__module__ = f"{function.__name__}_{content}", __name__
    return part(copied)


def _is_number(value: Any) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, bool)


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


def _uncompiled(energy: Callable, error: Exception) -> str:
    """Why an energy cannot be compiled, with the line of its file, from what numba says."""
    text, file = re.sub(r"\x1b\[\d*m", "", str(error)), energy.__code__.co_filename
    place = re.search(rf'{re.escape(file)}(?:", line | \()(\d+)', text)
    number = int(place.group(1)) if place else 0
    line = f"line {number}: " if place else ""
    # of the calls with jets the innermost one in the law's own line: those beyond are in numba's code
    source, space = linecache.getline(file, number), energy.__globals__
    named = [re.search(rf"[\w.]*\b{name}\b", source) for name in re.findall(r">>> (\w+)\(.*\bjet\b", text)]
    called = [each.group() for each in named if each]
    foreign = [name for name in called if not isinstance(space.get(name), FunctionType)]
    refused = foreign or re.findall(r"built-in function (\w+)>", text)
    if refused:
        return f"{line}{refused[-1]} has no derivative here: {ALLOWED}"
    before = [each.strip(' "') for each in text[: place.start() if place else None].splitlines()]
    skipped = ("During", "File", ">>>", "Failed in", "^", "[", "-")
    reasons = [each for each in before if each and not each.startswith(skipped)] or [type(error).__name__]
    return f"{line}energy cannot be compiled: {reasons[-1 if place else 0]}: {ALLOWED}"
